//! What hob and work did, as a row of passes: each time the hob has turned by one of its threads, a
//! tooth is generated.
//!
//! ```text
//!   phase of the hob, threads     n − 1         n         n + 1
//!                                   ├┬┬┬┬┬┬┬┬┬┬┬┼┬┬┬┬┬┬┬┬┬┬┬┤   looks: SLICES a thread
//!   tooth n mod z                   from root to tip and beyond: along these looks its flanks are formed
//! ```
//!
//! A look is where the work stood beside the rack, and how far the rack stood from the work's axis.
//! What they differ by over the threads that form a tooth is its profile deviation, along the
//! normal of the flank: `e·cos α_t ± Δa·sin α_t`.
use super::Generator;
use bus::{Sample, State};
use core::f64::consts::PI;
use std::collections::VecDeque;
use units::Time;

/// Samples of the motion while the hob turns by one of its threads.
const SLICES: f64 = 8.0;
/// Looks that form a tooth: a thread before its middle and a thread after.
const LOOKS: usize = 17;
const MIDDLE: usize = LOOKS / 2;
/// The hob forms a tooth while its distance changes by no more than this, mm.
const STEADY_MM: f64 = 0.02;
/// Passes that are kept.
const MOST_PASSES: usize = 1 << 20;

/// A tooth that has just been generated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    pub(super) tooth: usize,
    /// Distance of the axes, mm.
    pub(super) distance: f64,
    pub(super) z: f64,
    pub(super) time: Time,
    /// Angle of the work, rev.
    pub(super) work: f64,
    /// Where the tooth's middle is in the work at Z0, rev, with the whole turns taken off.
    pub(super) flank: f64,
    /// Profile deviation, its slope over it and what is left beside the slope, µm.
    pub(super) profile: [f64; 3],
}

/// Where the rack stood beside the work.
#[derive(Clone, Copy, Debug)]
struct Look {
    flank: f64,
    distance: f64,
    /// The pass whose middle it is.
    pass: Option<usize>,
}

/// What was recorded in a period.
#[derive(Clone, Copy, Debug)]
struct Moment {
    /// Angles of hob and work, rev.
    hob: f64,
    work: f64,
    z: f64,
    distance: f64,
}

/// Follows hob and work.
#[derive(Clone, Debug)]
pub(super) struct PassTrack {
    rack: Generator,
    before: Option<Moment>,
    pub(super) passes: Vec<Pass>,
    looks: VecDeque<Look>,
    pub(super) faulted: bool,
    /// Largest and smallest Y in the blank's height.
    pub(super) y: Option<[f64; 2]>,
    /// Turns of the hob in M3's sense, and in M4's.
    pub(super) turned: [f64; 2],
}

impl PassTrack {
    pub(super) const fn new(rack: Generator) -> Self {
        Self {
            rack,
            before: None,
            passes: Vec::new(),
            looks: VecDeque::new(),
            faulted: false,
            y: None,
            turned: [0.0; 2],
        }
    }

    pub(super) fn sample(&mut self, sample: &Sample, axis_x: f64) {
        self.faulted |= matches!(sample.report.state, State::Faulted);
        let now = Moment {
            hob: sample.spindle(self.rack.spindles[0]).value(),
            work: sample.spindle(self.rack.spindles[1]).value(),
            z: sample.axis(2).value() - self.rack.tool_length,
            distance: sample.axis(0).value() - axis_x,
        };
        let Some(before) = self.before.replace(now).filter(|_| !self.faulted) else { return };
        if self.rack.reaches(now.distance) && self.rack.is_within(now.z) {
            let y = sample.axis(1).value();
            let [low, high] = self.y.unwrap_or([y, y]);
            self.y = Some([low.min(y), high.max(y)]);
            let by = now.hob - before.hob;
            self.turned[usize::from(by < 0.0)] += by.abs();
        }
        self.between(before, now, sample.feedback.time);
    }

    /// Looks between two records.
    fn between(&mut self, before: Moment, now: Moment, time: Time) {
        let Generator { threads, sense, twist, .. } = self.rack;
        let teeth = f64::from(self.rack.teeth);
        let (a, b) = (before.hob * threads * SLICES, now.hob * threads * SLICES);
        let mut n = a.min(b).ceil();
        while n < a.max(b) {
            let part = (n - a) / (b - a);
            let at = |of: fn(&Moment) -> f64| of(&before) + part * (of(&now) - of(&before));
            let (work, z, distance) = (at(|m| m.work), at(|m| m.z), at(|m| m.distance));
            let thread = n / SLICES;
            let turned = sense * (thread / teeth).fract() - work.fract() - (twist * z).fract();
            let flank = turned - turned.round();
            let mut look = Look { flank, distance, pass: None };
            if thread.fract() == 0.0 && self.rack.reaches(distance) && self.rack.is_within(z) {
                look.pass = Some(self.passes.len()).filter(|count| *count < MOST_PASSES);
                if look.pass.is_some() {
                    let tooth = thread.rem_euclid(teeth) as usize;
                    let profile = [0.0; 3];
                    self.passes.push(Pass { tooth, distance, z, time, work, flank, profile });
                }
            }
            self.look(look);
            n += 1.0;
        }
    }

    fn look(&mut self, look: Look) {
        self.looks.push_back(look);
        if self.looks.len() > LOOKS {
            self.looks.pop_front();
        }
        if self.looks.len() < LOOKS {
            return;
        }
        if let Some(pass) = self.looks[MIDDLE].pass
            && let Some(pass) = self.passes.get_mut(pass)
        {
            pass.profile = profile(&self.looks, &self.rack);
        }
    }
}

/// Deviation of the worse flank over the looks that form a tooth: total, slope, form; µm. Where the
/// hob is fed in or taken off it forms none.
fn profile(looks: &VecDeque<Look>, rack: &Generator) -> [f64; 3] {
    let Some(centre) = looks.get(MIDDLE).copied() else { return [0.0; 3] };
    let middle = centre.flank;
    let forms = move |look: &Look| (look.distance - centre.distance).abs() <= STEADY_MM;
    let (sin, cos) = rack.transverse_rad.sin_cos();
    let circle = PI * rack.pitch_diameter;
    [-1.0, 1.0].into_iter().fold([0.0; 3], |worst, side| {
        let formed = looks.iter().enumerate().filter(move |(_, look)| forms(look));
        let at = formed.map(|(i, look)| {
            // a look belongs to another tooth by whole teeth, which is no deviation
            let beside = look.flank - middle;
            let beside = (beside - beside.round()) * circle;
            let along = (i as f64 - MIDDLE as f64) / MIDDLE as f64;
            (along, (beside * cos * side + look.distance * sin) * 1e3)
        });
        let found = spread(at);
        if found[0] > worst[0] { found } else { worst }
    })
}

/// Largest less smallest; the same of the least-squares line over −1 to 1; of what is left beside
/// it.
fn spread(points: impl Iterator<Item = (f64, f64)> + Clone) -> [f64; 3] {
    let count = points.clone().count() as f64;
    let mean = points.clone().map(|p| p.1).sum::<f64>() / count;
    let (top, bottom) =
        points.clone().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 * (p.1 - mean), sum.1 + p.0 * p.0));
    let slope = if bottom > 0.0 { top / bottom } else { 0.0 };
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = values.fold(ends, |[low, high], v| [low.min(v), high.max(v)]);
        (high - low).max(0.0)
    };
    [
        range(&mut points.clone().map(|p| p.1)),
        (2.0 * slope).abs(),
        range(&mut points.map(|p| p.1 - mean - slope * p.0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_split_into_slope_and_form() {
        let line = (-8..=8).map(|i| (f64::from(i) / 8.0, 3.0 * f64::from(i) / 8.0));
        let [total, slope, form] = spread(line);
        assert!((total - 6.0).abs() < 1e-9 && (slope - 6.0).abs() < 1e-9 && form < 1e-9);
        let wave = (-8..=8).map(|i| (f64::from(i) / 8.0, if i % 2 == 0 { 1.0 } else { -1.0 }));
        let [total, slope, form] = spread(wave);
        assert!((total - 2.0).abs() < 1e-9 && slope < 1e-9 && (form - 2.0).abs() < 1e-9);
    }
}
