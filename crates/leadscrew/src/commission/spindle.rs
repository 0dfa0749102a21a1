//! The step `spindle`: inertia and friction by torque and speed, and what a drive that makes its
//! own ramps does when it is commanded another speed.
//!
//! ```text
//!   order  ──┐                 T = J·α + c₀·sgn ω + c₁·ω        by the measured torque
//!            └────────
//!   speed  ─────╲              θ(t): even, a parabola from the delay on, even
//!            │d│  ╲____        delay and ramp of each change, by the angle itself
//! ```
use super::axes::reading;
use super::least_squares::{Estimate, Fit, MOST_STEPS, Residuals, fit};
use super::motion::{Bench, Signals, SpindleSignals};
use super::result::{MeasuredValue, StepResult};
use control::Refused;
use report::CommissionPicture;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use store::machine::Spindle;

/// Shares of the tapping speed to which the spindle is run.
const SPEEDS: [f64; 3] = [0.34, 0.67, 1.0];
/// Times that it is run to each.
const TIMES: usize = 4;
/// Even running before and after a ramp, s.
const EVEN_S: f64 = 0.25;
/// Time over which torque and speed are averaged, s.
const BLOCK_S: f64 = 10e-3;
/// Speeds below this share of the fastest say nothing of friction.
const LEAST_SHARE: f64 = 0.05;

/// Measures the first spindle.
///
/// # Errors
/// The machine cannot be run.
pub(crate) fn measure(bench: &Bench) -> Result<StepResult, Refused> {
    let mut result = StepResult::new("spindle");
    let Some(spindle) = bench.machine.file().spindles.first() else {
        result.not_judged.push("the machine has no spindle".into());
        return Ok(result);
    };
    let careful = bench.careful()?;
    let own = spindle.own_ramps.is_some();
    let signals = bench.run(&careful, "ramps of the spindle", &program(spindle))?;
    result.lasts_s = signals.line.len() as f64 * signals.period_s;
    if let Some(alarm) = signals.alarms.first() {
        result.alarms.push(format!("{}: {alarm}", spindle.name));
        return Ok(result);
    }
    torque(spindle, &signals, &mut result);
    if own {
        let late = f64::from(bench.machine.file().control.command_delay_periods);
        ramps(spindle, &signals, late * signals.period_s, &mut result);
    }
    Ok(result)
}

/// Runs up and down, several times to each speed.
fn program(spindle: &Spindle) -> String {
    let most = spindle.tapping_max.in_rpm();
    let mut text = String::from("G21 G90 G17 G94\n");
    // a third of the torque is what a careful file leaves
    let accel = spindle.own_ramps.map_or_else(
        || 0.25 * spindle.peak_torque.value() / spindle.inertia.value() / TAU,
        |own| 0.7 * own.deceleration.value().min(own.acceleration.value()),
    );
    for share in SPEEDS {
        let rpm = most * share;
        let dwell = rpm / 60.0 / accel + 2.0 * EVEN_S + 0.3;
        for turn in 0..TIMES {
            let sense = if turn % 2 == 0 { "M3" } else { "M4" };
            let _ = writeln!(text, "S{rpm:.0} {sense}\nG4 P{dwell:.2}\nM5\nG4 P{dwell:.2}");
        }
    }
    text + "M2\n"
}

fn finding(
    key: &str,
    name: String,
    unit: &'static str,
    value: Estimate,
    old: f64,
) -> MeasuredValue {
    MeasuredValue {
        key: if key.is_empty() { String::new() } else { format!("spindles.0.{key}") },
        name,
        unit,
        value,
        old: Some(old),
        effect_um: None,
        effect_of: "",
        by: "ramps",
    }
}

/// Inertia and friction from torque and speed.
fn torque(spindle: &Spindle, signals: &Signals, result: &mut StepResult) {
    let name = &spindle.name;
    let heard = &signals.spindle;
    if heard.torque_n_m.len() < heard.angle_rev.len() {
        result.not_judged.push(format!("{name}: its drive says no torque"));
        return;
    }
    let gain = if spindle.own_ramps.is_some() {
        result.not_judged.push(format!(
            "{name}: its drive takes no torque: its newton metres are those of its own reading"
        ));
        1.0
    } else if let Some(gain) = reading(&heard.torque_n_m, &heard.asked_n_m) {
        let says = format!("{name}: torque that the drive says, over the commanded one");
        result.findings.push(finding("", says, "", gain, 1.0));
        gain.value
    } else {
        1.0
    };
    let Some(found) = fit_torque(spindle, heard, signals.period_s, gain) else {
        result.not_judged.push(format!("{name}: too little motion to fit anything to"));
        return;
    };
    let inertia = found.of(|p| p[0]);
    let old = spindle.inertia.value();
    let share = (inertia.value / old - 1.0).abs();
    let degrees = share * spindle.peak_torque.value() * spindle.planned_share
        / (old * spindle.loops.position_gain_per_s * TAU * spindle.loops.velocity_bandwidth_hz);
    let um = if spindle.own_ramps.is_some() { 0.0 } else { degrees / TAU * 1e3 };
    result.findings.push(
        finding("inertia_kg_m2", format!("{name}: inertia"), "kg·m²", inertia, old)
            .with(um, "lag of the spindle while it gains speed, at 1 mm of lead"),
    );
    let coulomb = found.of(|p| p[1].max(0.0));
    let old = spindle.friction.coulomb.value();
    let what = format!("{name}: constant friction");
    result.findings.push(finding("friction.coulomb_n_m", what, "N·m", coulomb, old));
    let viscous = found.of(|p| p[2].max(0.0));
    let old = spindle.friction.viscous_n_m_s_per_rad;
    let what = format!("{name}: viscous friction");
    result.findings.push(finding(
        "friction.viscous_n_m_s_per_rad",
        what,
        "N·m·s/rad",
        viscous,
        old,
    ));
    result.pictures.push(CommissionPicture::Ramp {
        name: name.clone(),
        speed: thinned(heard, signals.period_s),
        commanded: thinned_commands(heard, signals.period_s),
    });
}

/// T = J·α + c₀·sgn ω + c₁·ω by means over blocks, late by a delay.
fn fit_torque(spindle: &Spindle, heard: &SpindleSignals, t: f64, gain: f64) -> Option<Fit> {
    let block = ((BLOCK_S / t).round() as usize).max(2);
    let least = LEAST_SHARE * spindle.tapping_max.in_rad_per_s();
    let speed =
        |n: usize| (heard.angle_rev[n] - heard.angle_rev[n - block]) * TAU / (block as f64 * t);
    let latest = 2 * block + (0.1 / t) as usize;
    // sums, so that a mean may begin between two readings
    let mut sums = vec![0.0];
    for torque in &heard.torque_n_m {
        sums.push(sums.last().copied().unwrap_or(0.0) + torque / gain);
    }
    let sum = |at: f64| {
        let (whole, part) = (at.floor() as usize, at.fract());
        sums[whole] + part * (sums[whole + 1] - sums[whole])
    };
    let mut rows = Vec::new();
    let mut n = 2 * block;
    while n + latest + block < heard.angle_rev.len() {
        let (before, here, after) = (speed(n), speed(n + block / 2), speed(n + block));
        let alpha = (after - before) / (block as f64 * t);
        if here.abs() > least && before * after > 0.0 {
            rows.push((n, alpha, here));
        }
        n += block;
    }
    // speeds before and after are means over a block each: the torque between them is weighed by a
    // triangle over both
    let torque = |n: usize, late: f64| {
        let n = n as f64 + late + 1.0;
        let b = block as f64;
        let steps = block.min(16);
        let mean = |k: usize| {
            let from = n - b + b * (k as f64 + 0.5) / steps as f64;
            (sum(from + b) - sum(from)) / b
        };
        (0..steps).map(mean).sum::<f64>() / steps as f64
    };
    let residuals = |p: &[f64]| {
        let late = (p[3].abs() / t).min(latest as f64 - block as f64);
        let value = |(n, alpha, omega): &(usize, f64, f64)| {
            torque(*n, late) - p[0] * alpha - p[1] * omega.signum() - p[2] * omega
        };
        let values: Vec<f64> = rows.iter().map(value).collect();
        let blocks = (0..values.len()).step_by(10).map(|i| i..(i + 10).min(values.len()));
        Residuals { blocks: blocks.collect(), values }
    };
    let delay = spindle.measured_torque.map_or(0.0, |measured| measured.delay.value());
    let begin = [spindle.inertia.value(), 0.1, 1e-3, delay.max(1e-4)];
    if rows.len() < 40 {
        return None;
    }
    fit(&begin, &[true; 4], &[1e-4, 1e-2, 1e-5, 1e-4], &residuals, MOST_STEPS)
}

/// Points of a picture.
const POINTS: usize = 1200;

fn thinned(heard: &SpindleSignals, t: f64) -> Vec<(f64, f64)> {
    let step = (heard.angle_rev.len() / POINTS).max(40);
    let angle = &heard.angle_rev;
    let at = |n: usize| ((n as f64) * t, (angle[n] - angle[n - 40]) / (40.0 * t) * 60.0);
    (40..angle.len()).step_by(step).map(at).collect()
}

fn thinned_commands(heard: &SpindleSignals, t: f64) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for (n, pair) in heard.commanded.windows(2).enumerate() {
        if pair[0] != pair[1] {
            points.push((n as f64 * t, pair[0] * 60.0));
            points.push((n as f64 * t, pair[1] * 60.0));
        }
    }
    points
}

/// What one change of speed showed.
#[derive(Clone, Copy, Debug)]
struct SpeedRamp {
    gains: bool,
    delay: f64,
    rate: f64,
}

/// Delay and ramps of a drive that makes its own.
fn ramps(spindle: &Spindle, signals: &Signals, known_s: f64, result: &mut StepResult) {
    let Some(own) = spindle.own_ramps else { return };
    let name = &spindle.name;
    let all = changes(&signals.spindle, signals.period_s);
    let found: Vec<SpeedRamp> =
        all.iter().filter_map(|step| ramp(signals, step, spindle)).collect();
    let of = |gains: bool| -> Vec<SpeedRamp> {
        found.iter().copied().filter(|ramp| ramp.gains == gains).collect()
    };
    let (up, down) = (of(true), of(false));
    if up.len() < 3 || down.len() < 3 {
        result.not_judged.push(format!(
            "{name}: {} ramps up and {} down could be read, 3 of each are needed",
            up.len(),
            down.len()
        ));
        return;
    }
    let delays: Vec<f64> = found.iter().map(|ramp| ramp.delay - known_s).collect();
    let delay = mean(&delays).times(1e3);
    let old = own.delay.value() * 1e3;
    let speed = spindle.tapping_max.value();
    // at 1 mm of lead
    let early = |seconds: f64| (seconds * speed).abs() * 1e3;
    result.findings.push(
        finding("drive.delay_ms", format!("{name}: delay"), "ms", delay, old)
            .with(early((delay.value - old) * 1e-3), "way on at a reversal, at 1 mm of lead"),
    );
    let stop = |rate: f64| speed * speed / (2.0 * rate) * 1e3;
    for (key, what, ramps, old) in [
        ("drive.acceleration_rev_per_s2", "ramp up", &up, own.acceleration.value()),
        ("drive.deceleration_rev_per_s2", "ramp down", &down, own.deceleration.value()),
    ] {
        let rates: Vec<f64> = ramps.iter().map(|ramp| ramp.rate).collect();
        let rate = mean(&rates);
        let one = finding(key, format!("{name}: {what}"), "rev/s²", rate, old);
        let um = (stop(rate.value) - stop(old)).abs();
        result.findings.push(if key.contains("decel") {
            one.with(um, "stopping angle at the fastest tap, at 1 mm of lead")
        } else {
            one
        });
    }
    // three deviations of what differs from ramp to ramp
    let scatter = |values: &[f64]| {
        let centre = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|v| (v - centre).powi(2)).sum::<f64>();
        (square / (values.len() - 1) as f64).sqrt()
    };
    let spread = |values: &[f64]| {
        let deviation = scatter(values);
        let half = 2.0 * deviation / (2.0 * (values.len() - 1) as f64).sqrt();
        Estimate { value: deviation, half }
    };
    let repeats = spread(&delays).times(1e3);
    let what = format!("{name}: delay, one deviation");
    result.findings.push(finding("", what, "ms", repeats, own.repeats_delay.value() * 1e3));
    let shares: Vec<f64> = [&up, &down]
        .iter()
        .flat_map(|ramps| {
            let centre = ramps.iter().map(|ramp| ramp.rate).sum::<f64>() / ramps.len() as f64;
            ramps.iter().map(move |ramp| 100.0 * ramp.rate / centre)
        })
        .collect();
    let what = format!("{name}: ramps, one deviation");
    result.findings.push(finding("", what, "%", spread(&shares), own.repeats_share * 100.0));
}

/// A mean with its interval.
fn mean(values: &[f64]) -> Estimate {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|v| (v - value).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    // Student's quantile for 95 % of n − 1 degrees of freedom, within 1 % from 3 on
    let freedom = (count - 1.0).max(1.0);
    let quantile = 1.96 + 2.4 / freedom + 4.0 / freedom.powi(2);
    Estimate { value, half: quantile * (square / count).sqrt() }
}

/// A change of the commanded speed: the period in which it begins, and both speeds.
#[derive(Clone, Copy, Debug)]
struct Change {
    at: usize,
    from: f64,
    to: f64,
}

/// A speed that changes on within this time is one change, s.
const ONE_CHANGE_S: f64 = 5e-3;

/// Where another speed is commanded.
fn changes(heard: &SpindleSignals, t: f64) -> Vec<Change> {
    let (even, one) = ((EVEN_S / t) as usize, (ONE_CHANGE_S / t) as usize);
    let mut all: Vec<(Change, usize)> = Vec::new();
    for (n, pair) in heard.commanded.windows(2).enumerate().filter(|(_, p)| p[0] != p[1]) {
        match all.last_mut() {
            Some((change, last)) if n + 1 - *last <= one => (change.to, *last) = (pair[1], n + 1),
            _ => all.push((Change { at: n + 1, from: pair[0], to: pair[1] }, n + 1)),
        }
    }
    all.into_iter().map(|(change, _)| change).filter(|change| change.at > even).collect()
}

/// Delay and rate of the change of speed that is commanded in this period.
fn ramp(signals: &Signals, step: &Change, spindle: &Spindle) -> Option<SpeedRamp> {
    let (t, heard) = (signals.period_s, &signals.spindle);
    let own = spindle.own_ramps?;
    let Change { at, from: old, to: new } = *step;
    let one = (ONE_CHANGE_S / t) as usize;
    let gains = new.abs() > old.abs();
    let change = new - old;
    let believed = if gains { own.acceleration.value() } else { own.deceleration.value() };
    let even = (EVEN_S / t) as usize;
    let end = heard.commanded[at + one..].iter().position(|speed| *speed != new);
    let end = end.map_or(heard.angle_rev.len(), |length| at + one + length);
    let longest = at + even + ((2.0 * change.abs() / believed) / t) as usize;
    let range = at - even..end.min(longest);
    let zero = heard.angle_rev[at];
    // every fourth reading: nothing is lost, the next ones are known by the last
    let points: Vec<(f64, f64)> =
        range.step_by(4).map(|n| ((n as f64 - at as f64) * t, heard.angle_rev[n] - zero)).collect();
    let model = |p: &[f64], time: f64| {
        let (from, rate, before, after) = (p[2], p[3] * change.signum(), p[1], p[4]);
        let lasts = ((after - before) / rate).max(0.0);
        let into = (time - from).clamp(0.0, lasts);
        let beyond = (time - from - lasts).max(0.0);
        p[0] + before * time.min(from) + before * into + rate * into * into / 2.0 + after * beyond
    };
    let residuals = |p: &[f64]| {
        let values = points.iter().map(|(time, angle)| angle - model(p, *time)).collect();
        Residuals { values, blocks: Vec::new() }
    };
    let begin = [0.0, old, own.delay.value(), believed, new];
    let scales = [1e-3, 1e-2, 1e-4, 1e-1, 1e-2];
    let found = fit(&begin, &[true; 5], &scales, &residuals, MOST_STEPS)?;
    let [_, _, delay, rate, _] = found.values[..] else { return None };
    // a ramp that the model does not describe is none
    let describes =
        found.rms * f64::from(spindle.encoder_counts_per_rev) < 20.0 || found.rms < 2e-3;
    (describes && rate > 0.0).then_some(SpeedRamp { gains, delay, rate })
}
