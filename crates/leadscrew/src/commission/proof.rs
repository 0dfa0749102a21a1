//! The step `proof`: circles and tapping in air with the file before and after, as the slides and
//! the spindle really moved.
//!
//! ```text
//!   circularity   largest less smallest radius of a turn (ISO 230-4, G), by where the slides were
//!   radial        largest and smallest radius less the programmed one (ISO 230-4, F)
//!   air taps      largest distance of the feed from angle times lead; overrun at the bottom
//! ```
//!
//! What is judged is the machine, not what its control believes of it: on a simulated machine where
//! table and nose really were, else by their encoders.
use super::motion::{Bench, Window};
use crate::{Machine, Program, Run, RunOptions};
use bus::{Sample, State};
use control::Refused;
use control::job::ProgramOptions;
use control::observers::Observer;
use kernel::Event;
use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};

/// Radii of the circles, mm.
const RADII: [f64; 3] = [20.0, 50.0, 150.0];
/// Feeds of the circles, mm/min.
const FEEDS: [f64; 3] = [1000.0, 3000.0, 6000.0];
/// Part of a turn that is left out at either end: the ways in and out.
const ENDS: f64 = 0.03;
/// Taps in air.
const TAPS: usize = 20;
/// The tap of the built-in tool table that is taken: M6.
const TAP: u32 = 3;
/// Lead of the taps, mm/rev.
const LEAD: f64 = 1.0;
/// Depth of the taps, mm.
const DEPTH: f64 = 12.0;
/// Points of a circle that are drawn.
const POINTS: usize = 720;

/// A circle as it came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Circle {
    /// Programmed radius, mm.
    pub radius_mm: f64,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Largest less smallest radius, µm.
    pub circularity_um: f64,
    /// Largest and smallest radius less the programmed one, µm.
    pub radial_um: [f64; 2],
    /// Angle, degrees, and radius less the programmed one, µm.
    pub points: Vec<(f64, f64)>,
}

/// Taps in air as they came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AirTaps {
    /// How many.
    pub count: usize,
    /// Largest distance of the feed from its place by the spindle's angle, µm.
    pub sync_error_um: f64,
    /// Largest way beyond the programmed bottom, µm.
    pub overrun_um: f64,
    /// Standard deviation of the turning points, µm.
    pub repeats_um: f64,
}

/// What a machine does with a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proof {
    /// Circles in X and Y, the smallest and slowest first.
    pub circles: Vec<Circle>,
    /// Taps along Z; `None`: the machine has none, or they ended with an alarm.
    pub taps: Option<AirTaps>,
    /// Alarms.
    pub alarms: Vec<String>,
    /// Machine time, s.
    pub lasts_s: f64,
}

#[derive(Clone, Copy)]
struct CirclePlace {
    line: u32,
    state: State,
    axes: [f64; 3],
    spindle_rev: f64,
}

struct CirclePlaces(Arc<Mutex<Vec<CirclePlace>>>);

impl Observer for CirclePlaces {
    fn sample(&mut self, sample: &Sample) {
        let mut places = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        places.push(CirclePlace {
            line: sample.report.line,
            state: sample.report.state,
            axes: [0, 1, 2].map(|axis| sample.axis(axis).value()),
            spindle_rev: sample.spindle(0).value(),
        });
    }

    fn event(&mut self, _event: &Event) {}
}

impl Bench {
    /// Circles and taps in air with this file on the plant.
    ///
    /// # Errors
    /// The machine cannot be run.
    pub fn prove(&self, with: &Machine) -> Result<Proof, Refused> {
        let mut proof = Proof::default();
        if let (Some(x), Some(y)) = (self.window(0), self.window(1)) {
            self.circles(with, x, y, &mut proof)?;
        }
        // a lathe's spindle turns the work
        let taps = !with.file().is_lathe && !with.file().spindles.is_empty();
        if let Some(z) = self.window(2).filter(|_| taps) {
            self.taps(with, z, &mut proof)?;
        }
        Ok(proof)
    }

    fn circles(
        &self,
        with: &Machine,
        x: Window,
        y: Window,
        proof: &mut Proof,
    ) -> Result<(), Refused> {
        let (x, y) = (x.inner(), y.inner());
        let centre = [f64::midpoint(x.from, x.to), f64::midpoint(y.from, y.to)];
        let room = (x.to - x.from).min(y.to - y.from) / 2.0;
        let mut text = String::from("G8\nG21 G90 G17 G94\n");
        let mut asked = Vec::new();
        let fastest = self.machine.file().axes.iter().flatten().take(2);
        let fastest = fastest.map(|a| a.feed_most.in_per_min()).fold(f64::MAX, f64::min);
        for radius in RADII.into_iter().filter(|radius| *radius <= room) {
            for feed in FEEDS.map(|feed| feed.min(fastest)) {
                // a turn that begins away from the reversals
                let (sin, cos) = 20f64.to_radians().sin_cos();
                let (sx, sy) = (centre[0] + radius * cos, centre[1] + radius * sin);
                let _ = writeln!(text, "G53 G0 X{sx:.4} Y{sy:.4}\nG4 P0.2");
                // work coordinates: offsets of the file
                let zero = self.machine.file().setup.g54.linear.map(units::Length::value);
                let (wx, wy) = (sx - zero[0], sy - zero[1]);
                let (i, j) = (centre[0] - sx, centre[1] - sy);
                asked.push((text.lines().count() as u32 + 1, radius, feed));
                let _ = writeln!(text, "G3 X{wx:.4} Y{wy:.4} I{i:.4} J{j:.4} F{feed:.0}");
            }
        }
        text += "M2\n";
        let places = self.places(with, "circles", &text, proof)?;
        for (line, radius_mm, feed) in asked {
            let all: Vec<CirclePlace> = places.iter().copied().filter(|p| p.line == line).collect();
            let cut = (all.len() as f64 * ENDS) as usize;
            let Some(even) = all.get(cut..all.len() - cut).filter(|even| even.len() > POINTS)
            else {
                continue;
            };
            proof.circles.push(circle(even, centre, radius_mm, feed));
        }
        Ok(())
    }

    fn taps(&self, with: &Machine, z: Window, proof: &mut Proof) -> Result<(), Refused> {
        let file = self.machine.file();
        let z = z.inner();
        let top = f64::midpoint(z.from, z.to);
        let most = file.axes[2].as_ref().map_or(0.0, |axis| axis.feed_most.in_per_min());
        let rpm = (file.spindles[0].tapping_max.in_rpm() * 0.5).min(0.5 * most / LEAD).floor();
        let mut text =
            format!("G8\nG21 G90 G17 G94\nT{TAP} M6\nG53 G0 Z{top:.3}\nS{rpm:.0} M3\nG4 P0.3\n");
        let rests = text.lines().count() as u32;
        let zero = file.setup.g54.linear[2].value();
        let bottom = top - DEPTH;
        let mut lines = Vec::new();
        for _ in 0..TAPS {
            lines.push(text.lines().count() as u32 + 1);
            let _ = writeln!(text, "G33.1 Z{:.3} K{LEAD}", bottom - zero);
        }
        text += "M5\nM2\n";
        let places = self.places(with, "taps in air", &text, proof)?;
        proof.taps = taps(&places, &lines, (rests, top, bottom));
        Ok(())
    }

    fn places(
        &self,
        with: &Machine,
        name: &str,
        text: &str,
        proof: &mut Proof,
    ) -> Result<Vec<CirclePlace>, Refused> {
        let options = ProgramOptions {
            plant: Some(self.plant()?),
            dialect: Some(interp::Dialect::LinuxCnc),
            ..ProgramOptions::on(with.source())
        };
        let job = Program::of(name, text).on(options)?;
        let asked = RunOptions { seed: Some(self.seed), ..RunOptions::default() };
        let mut run = Run::prepare(job, &asked)?;
        let to = Arc::new(Mutex::new(Vec::new()));
        run.observers.push(Box::new(CirclePlaces(Arc::clone(&to))));
        run.prove(&mut |_| ())?;
        let finished = run.execute(&mut |_| ())?;
        proof.alarms.extend(finished.outcome.faults.iter().map(ToString::to_string));
        proof.lasts_s += finished.outcome.cycle_time.value();
        drop(finished);
        let mut places = to.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(std::mem::take(&mut *places))
    }
}

/// Radii about the programmed centre.
fn circle(places: &[CirclePlace], centre: [f64; 2], radius_mm: f64, feed: f64) -> Circle {
    let polar = |place: &CirclePlace| {
        let (x, y) = (place.axes[0] - centre[0], place.axes[1] - centre[1]);
        (y.atan2(x).to_degrees().rem_euclid(360.0), (x.hypot(y) - radius_mm) * 1e3)
    };
    let all: Vec<(f64, f64)> = places.iter().map(polar).collect();
    let least = all.iter().map(|p| p.1).fold(f64::MAX, f64::min);
    let most = all.iter().map(|p| p.1).fold(f64::MIN, f64::max);
    let step = (all.len() / POINTS).max(1);
    Circle {
        radius_mm,
        feed_mm_per_min: feed,
        circularity_um: most - least,
        radial_um: [most, least],
        points: all.into_iter().step_by(step).collect(),
    }
}

/// How far Z is from the spindle's angle times the lead, and from its bottom.
fn taps(
    places: &[CirclePlace],
    lines: &[u32],
    (rests, top, bottom): (u32, f64, f64),
) -> Option<AirTaps> {
    // what is off at rest, touching off takes away
    let off = places.iter().rfind(|place| place.line == rests)?.axes[2] - top;
    let bottom = bottom + off;
    let mut found = AirTaps::default();
    let mut turns = Vec::new();
    for line in lines {
        let coupled = |p: &&CirclePlace| {
            p.line == *line && matches!(p.state, State::TapIn | State::TapBottom | State::TapOut)
        };
        let all: Vec<&CirclePlace> = places.iter().filter(coupled).collect();
        if all.len() < 20 {
            continue;
        }
        // a spindle that follows its own lead has a constant distance from it: the mean is where it
        // was coupled
        let off = |p: &CirclePlace| p.axes[2] + LEAD * p.spindle_rev;
        let mean = all.iter().map(|p| off(p)).sum::<f64>() / all.len() as f64;
        let most = all.iter().map(|p| (off(p) - mean).abs()).fold(0.0, f64::max);
        found.sync_error_um = found.sync_error_um.max(most * 1e3);
        let deepest = all.iter().map(|p| p.axes[2]).fold(f64::MAX, f64::min);
        turns.push((bottom - deepest) * 1e3);
    }
    if turns.len() < 2 {
        return None;
    }
    found.count = turns.len();
    found.overrun_um = turns.iter().copied().fold(f64::MIN, f64::max);
    let mean = turns.iter().sum::<f64>() / turns.len() as f64;
    let square = turns.iter().map(|turn| (turn - mean).powi(2)).sum::<f64>();
    found.repeats_um = (square / (turns.len() - 1) as f64).sqrt();
    Some(found)
}
