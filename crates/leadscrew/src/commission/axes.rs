//! The step `axes`: friction, weight, masses, spring and play of each linear axis, from its own
//! drive's signals.
use super::axis_model::{AxisFit, AxisParameters, AxisSamples, fit_axis, place, stretches};
use super::least_squares::Estimate;
use super::motion::{AxisSignals, Bench};
use super::result::{MeasuredValue, StepResult};
use super::strokes::StrokePlan;
use control::Refused;
use report::CommissionPicture;
use std::f64::consts::TAU;
use store::machine::{Axis, Motor};
use units::AxisKind;

/// A slide is looked at from this multiple of its Stribeck speed on.
const STRIBECK_SPEEDS: f64 = 4.0;
/// Nor slower than this, m/s.
const LEAST_SPEED: f64 = 8e-3;
/// Jerk of strokes where the file states no limit, m/s³.
const USUAL_JERK: f64 = 800.0;
/// Standard gravity (CGPM 1901), m/s².
const GRAVITY: f64 = 9.806_65;

/// What the model may be off by beside noise, as a share: the motion between two readings is a
/// cubic, a guideway's friction a straight line. Taken from simulated machines.
const MASS_MODEL: f64 = 1e-3;
const SPRING_MODEL: f64 = 4e-3;
const FRICTION_MODEL: f64 = 0.01;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StrokeCounts {
    /// Pairs of slow strokes with a sweep.
    pub slow_pairs: usize,
    /// Pairs of fast strokes.
    pub fast_pairs: usize,
}

impl Default for StrokeCounts {
    fn default() -> Self {
        Self { slow_pairs: 10, fast_pairs: 15 }
    }
}

/// What the file says of an axis.
fn believed(axis: &Axis) -> AxisParameters {
    let (motor, table) = (axis.drive.motor_mass().value(), axis.moving_mass.value());
    let stiffness = axis.structure.stiffness.value() * 1e3;
    let reduced = motor * table / (motor + table);
    AxisParameters {
        motor_mass: motor,
        table_mass: table,
        stiffness,
        damping: 2.0 * axis.structure.damping_ratio * (stiffness * reduced).sqrt(),
        play: axis.structure.backlash.value() * 1e-3,
        coulomb: axis.friction.coulomb.value(),
        viscous: axis.friction.viscous_n_s_per_m,
        weight: table * GRAVITY * axis.weight_share,
        delay: axis.drive.measured_torque.map_or(0.0, |measured| measured.delay.value()),
    }
}

/// Measures all linear axes, one after the other.
///
/// # Errors
/// The machine cannot be run.
pub(crate) fn measure(bench: &Bench, effort: StrokeCounts) -> Result<StepResult, Refused> {
    let mut result = StepResult::new("axes");
    for (index, axis) in bench.machine.file().axes.iter().enumerate() {
        let Some(axis) = axis else { continue };
        if axis.letter.kind() == AxisKind::Rotary {
            let says = format!("{} turns: the strokes are for linear axes", axis.letter.letter());
            result.not_judged.push(says);
            continue;
        }
        measure_axis(bench, index, axis, effort, &mut result)?;
    }
    Ok(result)
}

fn measure_axis(
    bench: &Bench,
    index: usize,
    axis: &Axis,
    effort: StrokeCounts,
    result: &mut StepResult,
) -> Result<(), Refused> {
    let letter = axis.letter.letter();
    let Some(window) = bench.window(index) else { return Ok(()) };
    let jerk = axis.jerk_feed.value() * 1e-3;
    let plan = StrokePlan {
        letter,
        window: window.inner(),
        fastest: axis.feed_most.value(),
        acceleration: bench.planned_acceleration(index),
        jerk: if jerk.is_finite() { jerk } else { USUAL_JERK },
        slow_pairs: effort.slow_pairs,
        fast_pairs: effort.fast_pairs,
    };
    let careful = bench.careful()?;
    let signals = bench.run(&careful, &format!("strokes of {letter}"), &plan.text())?;
    result.lasts_s += signals.line.len() as f64 * signals.period_s;
    if let Some(alarm) = signals.alarms.first() {
        result.alarms.push(format!("{letter}: {alarm}"));
        return Ok(());
    }
    let Some(heard) = signals.axis(index) else { return Ok(()) };
    result.moved.push(super::result::AxisExcursion::of(letter, heard, axis, window));
    if heard.force_n.len() < heard.position_mm.len() {
        let says = format!("{letter}: its drive says no force: `measured_torque` is not stated");
        result.not_judged.push(says);
        return Ok(());
    }
    let at_motor = !heard.motor_mm.is_empty()
        || matches!(axis.position_from, store::machine::PositionFrom::Motor { .. });
    let mut samples = samples(heard, signals.period_s);
    match reading(&heard.force_n, &heard.asked_n) {
        Some(reading) => {
            samples.force.iter_mut().for_each(|force| *force /= reading.value);
            result.findings.push(MeasuredValue {
                key: String::new(),
                name: format!("{letter}: force that the drive says, over the commanded one"),
                unit: "",
                value: reading,
                old: Some(1.0),
                effect_um: None,
                effect_of: "",
                by: "strokes",
            });
        }
        None => result.not_judged.push(format!(
            "{letter}: its drive takes no force, so that the newtons are those of its own reading"
        )),
    }
    let stribeck = axis.friction.stribeck_speed.value() * 1e-3;
    let least = LEAST_SPEED.max(STRIBECK_SPEEDS * stribeck);
    match fit_axis(&samples, &believed(axis), least) {
        Some(fit) => {
            result.findings.extend(findings(axis, &fit, at_motor));
            result.pictures.extend(pictures(axis, &samples, &fit, least));
        }
        None => result.not_judged.push(format!("{letter}: too little motion to fit anything to")),
    }
    Ok(())
}

/// Longest time from a commanded force to its reading, periods.
const LATEST: usize = 160;
/// Periods that are averaged for the comparison.
const AVERAGED: usize = 8;
/// Least correlation of a drive that does as it is commanded.
const CORRELATED: f64 = 0.8;

/// What a drive says of its force, over what was commanded; `None`: it takes no force. The motor's
/// torque constant is never quite what the drive believes. The control's feed-forward is in
/// commanded newtons, and so are all values here.
pub(crate) fn reading(measured: &[f64], asked: &[f64]) -> Option<Estimate> {
    let mean = |values: &[f64], at: usize| -> f64 {
        values[at..at + AVERAGED].iter().sum::<f64>() / AVERAGED as f64
    };
    let said: Vec<f64> = measured.chunks_exact(AVERAGED).map(|c| mean(c, 0)).collect();
    let sums = |late: usize| {
        let first = LATEST / AVERAGED + 1;
        let mut sums = [0.0_f64; 5];
        for (i, said) in said.iter().enumerate().skip(first) {
            let asked = mean(asked, i * AVERAGED - late);
            let parts = [1.0, asked, *said, asked * asked, asked * said];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        }
        sums
    };
    let slope = |[n, a, s, aa, as_]: [f64; 5]| {
        let square = aa - a * a / n;
        (square, (as_ - a * s / n) / square)
    };
    let best = (0..LATEST).max_by(|one, other| {
        let of = |late| slope(sums(late)).1;
        of(*one).total_cmp(&of(*other))
    })?;
    let of_best = sums(best);
    let (square, gain) = slope(of_best);
    let [n, _, s, ..] = of_best;
    let said_square: f64 = said.iter().map(|said| (said - s / n).powi(2)).sum();
    let left = (said_square - gain * gain * square).max(0.0);
    let correlation = 1.0 - left / said_square;
    let half = 2.0 * (left / n / square).sqrt();
    (square > 0.0 && correlation > CORRELATED * CORRELATED)
        .then_some(Estimate { value: gain, half })
}

fn samples(heard: &AxisSignals, period_s: f64) -> AxisSamples {
    let has_motor = heard.motor_mm.len() == heard.position_mm.len();
    let position = if has_motor { &heard.motor_mm } else { &heard.position_mm };
    AxisSamples {
        period_s,
        position: position.iter().map(|mm| mm * 1e-3).collect(),
        force: heard.force_n.clone(),
    }
}

/// What was found, as keys of the machine's file, with what each means at the tool.
fn findings(axis: &Axis, found: &AxisFit, at_motor: bool) -> Vec<MeasuredValue> {
    let file = believed(axis);
    let fit = &found.fit;
    let p = &found.parameters;
    let letter = axis.letter.letter();
    let key = |what: &str| format!("axes.{}.{what}", letter.to_ascii_lowercase());
    // what a force that the control does not know of moves: its loops, and the screw's spring
    let loops = &axis.loops;
    let mass = file.motor_mass + file.table_mass;
    let loop_stiffness = mass * loops.position_gain_per_s * TAU * loops.velocity_bandwidth_hz;
    let accel = axis.acceleration.value() * 1e-3;
    let rapid = axis.feed_most.value() * 1e-3;
    let um_of = |newton: f64| newton.abs() * (1.0 / loop_stiffness + 1.0 / p.stiffness) * 1e6;
    let finding =
        |key: String, what: &str, unit: &'static str, value: Estimate, old: f64| MeasuredValue {
            key,
            name: format!("{letter}: {what}"),
            unit,
            value,
            old: Some(old),
            effect_um: None,
            effect_of: "",
            by: "strokes",
        };
    let one = |i: usize| fit.of(|list| list[i]).widened(FRICTION_MODEL);
    let mut all = Vec::new();
    let coulomb = one(place::COULOMB);
    all.push(
        finding(key("friction.coulomb_n"), "Coulomb friction", "N", coulomb, file.coulomb).with(
            um_of(2.0 * (coulomb.value - file.coulomb)),
            "spike at a reversal: twice the error over the stiffness of loop and screw",
        ),
    );
    let static_n = axis.friction.static_force.value();
    let scaled = coulomb.times(static_n / file.coulomb.max(1e-9));
    all.push(
        finding(
            key("friction.static_n"),
            "breakaway friction, by the same factor",
            "N",
            scaled,
            static_n,
        )
        .with(um_of(scaled.value - static_n), "start out of rest"),
    );
    let viscous = one(place::VISCOUS);
    all.push(
        finding(
            key("friction.viscous_n_s_per_m"),
            "viscous friction",
            "N·s/m",
            viscous,
            file.viscous,
        )
        .with(um_of((viscous.value - file.viscous) * rapid), "following error at the fastest feed"),
    );
    let total = fit.of(|list| list[place::MOTOR] + list[place::TABLE]).widened(MASS_MODEL);
    let inertia_um = um_of((total.value - mass) * accel);
    all.push(
        finding(String::new(), "moved mass with motor and screw", "kg", total, mass)
            .with(inertia_um, "following error at full acceleration"),
    );
    if file.weight > 0.0 {
        let weight = fit.of(|list| list[place::WEIGHT]).widened(MASS_MODEL);
        all.push(
            finding(String::new(), "weight", "N", weight, file.weight)
                .with(um_of(weight.value - file.weight), "sag when the brake opens"),
        );
        let share = fit.of(|list| 100.0 * list[place::WEIGHT] / (list[place::TABLE] * GRAVITY));
        let share = Estimate { value: share.value.min(100.0), ..share };
        let old = axis.weight_share * 100.0;
        all.push(finding(key("weight_percent"), "share of the weight", "%", share, old));
    }
    if !at_motor {
        return all; // a scale sees the table: the spring lies before it
    }
    all.extend(spring(axis, found, &finding, &key));
    all
}

/// Masses on either side of the spring, the spring, its play.
fn spring(
    axis: &Axis,
    found: &AxisFit,
    finding: &dyn Fn(String, &str, &'static str, Estimate, f64) -> MeasuredValue,
    key: &dyn Fn(&str) -> String,
) -> Vec<MeasuredValue> {
    let (file, fit, p) = (believed(axis), &found.fit, &found.parameters);
    let accel = axis.acceleration.value() * 1e-3;
    let pull = file.table_mass * accel + file.coulomb;
    let mut all = Vec::new();
    let table = fit.of(|list| list[place::TABLE]).widened(SPRING_MODEL);
    all.push(finding(key("moving_mass_kg"), "mass beyond the screw", "kg", table, file.table_mass));
    let motor = fit.of(|list| list[place::MOTOR]).widened(MASS_MODEL);
    all.push(match axis.drive.motor {
        Motor::BallScrew { lead, rotating_inertia, .. } => {
            let per_kg = (lead.value() * 1e-3 / TAU).powi(2);
            let old = rotating_inertia.value();
            let what = "inertia of motor and screw";
            let inertia = motor.times(per_kg);
            finding(key("drive.rotating_inertia_kg_m2"), what, "kg·m²", inertia, old)
        }
        Motor::Linear { motor_mass, .. } => {
            let old = motor_mass.value();
            finding(key("drive.motor_mass_kg"), "mass of the motor", "kg", motor, old)
        }
    });
    let hz = |list: &[f64]| (list[place::STIFFNESS] / list[place::TABLE]).sqrt() / TAU;
    let old_hz = (file.stiffness / file.table_mass).sqrt() / TAU;
    all.push(finding(
        String::new(),
        "antiresonance",
        "Hz",
        fit.of(hz).widened(SPRING_MODEL),
        old_hz,
    ));
    let stiffness = fit.of(|list| list[place::STIFFNESS]).times(1e-6).widened(SPRING_MODEL);
    let stretch = pull * (1.0 / p.stiffness - 1.0 / file.stiffness).abs() * 1e6;
    all.push(
        finding(
            key("structure.stiffness_n_per_um"),
            "stiffness of the screw",
            "N/µm",
            stiffness,
            file.stiffness * 1e-6,
        )
        .with(stretch, "stretch at full acceleration that is taken to be another"),
    );
    let ratio = fit.of(|list| {
        let (m1, m2) = (list[place::MOTOR], list[place::TABLE]);
        list[place::DAMPING] / (2.0 * (list[place::STIFFNESS] * m1 * m2 / (m1 + m2)).sqrt())
    });
    let old = axis.structure.damping_ratio;
    all.push(finding(key("structure.damping_ratio"), "damping ratio of the screw", "", ratio, old));
    if found.play_shows {
        // shown and not written: its interval does not hold often enough
        let play = fit.of(|list| list[place::PLAY]).times(1e6);
        let old = file.play * 1e6;
        all.push(
            finding(String::new(), "play of the screw", "µm", play, old)
                .with((play.value - old).abs(), "error of position after a reversal"),
        );
    }
    all
}

/// Speeds at which the picture of friction has points, of each sense.
const FRICTION_POINTS: usize = 16;

/// Friction over speed, as measured and as fitted.
fn pictures(
    axis: &Axis,
    samples: &AxisSamples,
    found: &AxisFit,
    least: f64,
) -> Vec<CommissionPicture> {
    let p = &found.parameters;
    let t = samples.period_s;
    let x = &samples.position;
    let over = 40;
    let late = (p.delay / t).round() as usize;
    let mass = p.motor_mass + p.table_mass;
    let mut points: Vec<(f64, f64)> = Vec::new();
    for stretch in stretches(samples, least) {
        let mut n = stretch.start + over;
        while n + over + late + 2 < stretch.end {
            let speed = |n: usize| (x[n + 1] - x[n - 1]) / (2.0 * t);
            let (from, to) = (speed(n), speed(n + over));
            let force = samples.force[n + late..n + late + over].iter().sum::<f64>() / over as f64;
            let v = (x[n + over] - x[n]) / (over as f64 * t);
            let accel = (to - from) / (over as f64 * t);
            points.push((v, force - mass * accel - p.weight));
            n += over;
        }
    }
    let fastest = points.iter().map(|point| point.0.abs()).fold(1e-3, f64::max);
    let width = 2.0 * fastest / (2 * FRICTION_POINTS) as f64;
    let mut bins = vec![(0.0, 0.0, 0_u32); 2 * FRICTION_POINTS + 1];
    for (v, f) in points {
        let at = ((v + fastest) / width) as usize;
        let bin = &mut bins[at.min(2 * FRICTION_POINTS)];
        *bin = (bin.0 + v, bin.1 + f, bin.2 + 1);
    }
    let measured = bins.iter().filter(|bin| bin.2 > 4).map(|bin| {
        let count = f64::from(bin.2);
        (bin.0 / count * 1e3, bin.1 / count)
    });
    let law = |coulomb: f64, viscous: f64| -> Vec<(f64, f64)> {
        let at = |v: f64| (v * 1e3, coulomb * v.signum() + viscous * v);
        [-fastest, -1e-6, 1e-6, fastest].map(at).to_vec()
    };
    let file = believed(axis);
    vec![CommissionPicture::Friction {
        letter: axis.letter.letter(),
        measured: measured.collect(),
        fitted: law(p.coulomb, p.viscous),
        file: law(file.coulomb, file.viscous),
    }]
}
