//! Learning over holes: what one stroke missed is given to the next one in advance.
//!
//! ```text
//!   hole k     e_k(p) │   ╭╮            p: time within the stroke, in and out apart
//!                     │───╯╰──╮╭───
//!                     └───────╰╯──► p
//!   hole k+1   u_k+1 = Q·( u_k + γ·e_k )      added to the setpoint with its first two derivatives
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | e | planned less measured place of one drive | mm or rev |
//! | u | correction of its setpoint | as e |
//! | γ | gain of learning | — |
//! | Q | low-pass run forward and backward over the stroke: no phase | — |
//! | T | from setpoint to place: the closed loop with its feed-forwards | — |
//!
//! **Convergence** (Bristow, Tharayil, Alleyne: A survey of iterative learning control, IEEE
//! Control Systems 26(3), 2006, eq. 18): the error shrinks from hole to hole where |Q·(1 − γT)|
//! < 1. Feed-forward makes T ≈ 1 well below the screw's resonance, so there the factor is about 1 −
//! γ; above the bandwidth of Q nothing is learnt. What is left is (1 − Q)/(1 − Q(1 − γT)) of the
//! first error.
//!
//! **Storage.** u is a uniform cubic B-spline: twice differentiable, so that speed and force can be
//! fed forward. Q is two second-order Butterworth sections each way, |Q| = 1/(1 + (f/f₀)⁸).
//!
//! **Guard.** That of all learning by repetition ([`crate::iteration`]); the score of a stroke is
//! the rms of the sync error in the material. Taps go on learning as long as the tool is used:
//! there is no floor.
use crate::iteration::{Basis, IterationProgress, Taught, Terms};
use core::f64::consts::PI;
use units::{Angle, Lead, Length, Spin, Time};

/// Cells of a correction, over in and out together.
pub const CELLS: usize = 2048;
/// A stroke is worse than the best one beyond a quarter and a tenth of a micrometre.
const TERMS: Terms = Terms { worse: 1.25, noise: 0.1e-3, floor: 0.0, idle: None };
/// Share of an overrun that strokes after the first one teach.
const LATER: f64 = 0.5;
/// Cells over which a correction fades at the stroke's two ends, where spindle and axis stand.
const FADE: usize = 16;
/// No correction is larger than this share of a lead.
const MOST_LEADS: f64 = 0.1;

/// Which strokes are alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeKey {
    /// The tool.
    pub tool: u32,
    /// Axis travel per revolution.
    pub lead: Lead,
    /// Speed inwards, signed.
    pub spin: Spin,
    /// Speed outwards, signed.
    pub return_spin: Spin,
    /// Revolutions from start to bottom.
    pub turns: Angle,
    /// Time in, and time out.
    pub times: (Time, Time),
}

impl StrokeKey {
    /// The same tool, speeds and stroke, but for what rounding makes of them.
    pub fn is_like(&self, other: &Self) -> bool {
        const ROUNDING: f64 = 1e-6;
        let same = |a: f64, b: f64| (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
        self.tool == other.tool
            && same(self.lead.value(), other.lead.value())
            && same(self.spin.value(), other.spin.value())
            && same(self.return_spin.value(), other.return_spin.value())
            && same(self.turns.value(), other.turns.value())
            && same(self.times.0.value(), other.times.0.value())
            && same(self.times.1.value(), other.times.1.value())
    }
}

/// How it learns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Learning {
    /// γ of the first stroke.
    pub gain: f64,
    /// Bandwidth of Q, Hz: well below the resonance of the axis.
    pub bandwidth_hz: f64,
}

/// A correction at one time of the stroke: itself and its first two derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// mm or rev.
    pub u: f64,
    /// Per second.
    pub rate: f64,
    /// Per second twice.
    pub accel: f64,
}

/// One drive's correction, and the errors of the stroke under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// In force.
    pub cells: [f64; CELLS],
    /// Of the best stroke so far.
    pub best: [f64; CELLS],
    errors: [f64; CELLS],
    counts: [u16; CELLS],
}

impl Channel {
    const NEW: Self =
        Self { cells: [0.0; CELLS], best: [0.0; CELLS], errors: [0.0; CELLS], counts: [0; CELLS] };

    fn at(&self, place: f64, cell_s: f64) -> Correction {
        let whole = libm::floor(place);
        let f = place - whole;
        let cell = |offset: isize| {
            let index = whole as isize + offset;
            usize::try_from(index).ok().and_then(|i| self.cells.get(i)).copied().unwrap_or(0.0)
        };
        let (a, b, c, d) = (cell(-1), cell(0), cell(1), cell(2));
        let g = 1.0 - f;
        let (f2, f3) = (f * f, f * f * f);
        let value = (g * g * g * a
            + (3.0 * f3 - 6.0 * f2 + 4.0) * b
            + (3.0 * (f + f2 - f3) + 1.0) * c
            + f3 * d)
            / 6.0;
        let rate = (f2 * (d - c) + (1.0 + 2.0 * f * g) * (c - b) + g * g * (b - a)) / 2.0;
        let accel = g * (a - 2.0 * b + c) + f * (b - 2.0 * c + d);
        Correction { u: value, rate: rate / cell_s, accel: accel / (cell_s * cell_s) }
    }

    fn note(&mut self, place: f64, error: f64) {
        let index = libm::round(place);
        if index >= 0.0
            && let Some(sum) = self.errors.get_mut(index as usize)
        {
            *sum += error;
            self.counts[index as usize] = self.counts[index as usize].saturating_add(1);
        }
    }

    fn forget_errors(&mut self) {
        self.errors = [0.0; CELLS];
        self.counts = [0; CELLS];
    }

    /// u ← Q·(u + γ·e) over the cells in use.
    fn update(&mut self, used: usize, gain: f64, filter: &LowPass, most: f64) {
        let used = used.min(CELLS);
        let mut last = 0.0;
        for i in 0..used {
            // a cell that no period fell into takes its neighbour's error
            if self.counts[i] > 0 {
                last = self.errors[i] / f64::from(self.counts[i]);
            }
            self.cells[i] += gain * last;
        }
        filter.both_ways(&mut self.cells[..used]);
        for i in 0..used {
            let edge = i.min(used - 1 - i);
            let x = (edge as f64 / FADE as f64).min(1.0);
            self.cells[i] = (self.cells[i] * x * x * (3.0 - 2.0 * x)).clamp(-most, most);
        }
    }
}

/// Two Butterworth sections of second order.
#[derive(Clone, Copy, Debug)]
struct LowPass {
    sections: [[f64; 5]; 2],
}

impl LowPass {
    fn new(bandwidth_hz: f64, cell_s: f64) -> Self {
        // bilinear with the bandwidth prewarped; a fourth-order Butterworth has Q of 0.5412
        // and 1.3066
        let w = (PI * bandwidth_hz * cell_s).min(0.45 * PI);
        let k = libm::tan(w);
        let section = |q: f64| {
            let n = 1.0 / (1.0 + k / q + k * k);
            [
                k * k * n,
                2.0 * k * k * n,
                k * k * n,
                2.0 * (k * k - 1.0) * n,
                (1.0 - k / q + k * k) * n,
            ]
        };
        Self { sections: [section(0.541_196_1), section(1.306_563)] }
    }

    fn both_ways(&self, cells: &mut [f64]) {
        for section in &self.sections {
            pass(section, cells.iter_mut());
            pass(section, cells.iter_mut().rev());
        }
    }
}

fn pass<'a>(c: &[f64; 5], cells: impl Iterator<Item = &'a mut f64>) {
    let (mut s1, mut s2) = (0.0, 0.0);
    for cell in cells {
        let x = *cell;
        let y = c[0] * x + s1;
        s1 = c[1] * x - c[3] * y + s2;
        s2 = c[2] * x - c[4] * y;
        *cell = y;
    }
}

/// What has been learnt of one kind of stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct LearningRecord {
    /// Of what.
    pub key: StrokeKey,
    /// Correction of the feed axis, mm.
    pub feed: Channel,
    /// Correction of the spindle, rev.
    pub spindle: Channel,
    /// Strokes that it has learnt from.
    pub strokes: u32,
    /// Score of the very first stroke, without correction.
    pub first: Option<Length>,
    /// Gain, best score, strikes.
    pub progress: IterationProgress,
    /// Turns by which an encoder-following spindle must be braked earlier than planned.
    pub early: Angle,
}

/// Corrections as splines over the time within the stroke: the basis of a motion that goes in and
/// out.
struct Splines<'a> {
    feed: &'a mut Channel,
    spindle: &'a mut Channel,
    used: usize,
    filter: LowPass,
    /// Of a correction of the feed, mm.
    most: f64,
}

impl Basis for Splines<'_> {
    fn keep(&mut self) {
        self.feed.best = self.feed.cells;
        self.spindle.best = self.spindle.cells;
    }

    fn bring_back(&mut self) {
        self.feed.cells = self.feed.best;
        self.spindle.cells = self.spindle.best;
    }

    fn correct(&mut self, gain: f64) {
        self.feed.update(self.used, gain, &self.filter, self.most);
        self.spindle.update(self.used, gain, &self.filter, MOST_LEADS);
    }
}

impl LearningRecord {
    /// Nothing learnt yet.
    pub const fn new(key: StrokeKey, gain: f64) -> Self {
        Self {
            key,
            feed: Channel::NEW,
            spindle: Channel::NEW,
            strokes: 0,
            first: None,
            progress: IterationProgress::new(gain),
            early: Angle::ZERO,
        }
    }

    /// Begin again with another kind of stroke, in place.
    pub fn reset(&mut self, key: StrokeKey, gain: f64) {
        self.key = key;
        for channel in [&mut self.feed, &mut self.spindle] {
            channel.cells = [0.0; CELLS];
            channel.best = [0.0; CELLS];
            channel.forget_errors();
        }
        (self.strokes, self.first) = (0, None);
        (self.progress, self.early) = (IterationProgress::new(gain), Angle::ZERO);
    }

    /// Time that one cell stands for.
    pub fn cell(&self) -> Time {
        (self.key.times.0 + self.key.times.1) / (CELLS - 4) as f64
    }

    /// Best score so far.
    pub fn best(&self) -> Option<Length> {
        self.progress.best.map(Length::mm)
    }

    /// A stroke begins.
    pub fn begin(&mut self) {
        self.feed.forget_errors();
        self.spindle.forget_errors();
    }

    /// Corrections of feed and spindle at a time of the stroke, the way out counted on from the way
    /// in.
    pub fn correction(&self, at: Time) -> (Correction, Correction) {
        let cell_s = self.cell().value();
        let place = at.value() / cell_s;
        (self.feed.at(place, cell_s), self.spindle.at(place, cell_s))
    }

    /// Take the errors (planned less measured) of this period.
    pub fn note(&mut self, at: Time, feed: Length, spindle: Angle) {
        let place = at.value() / self.cell().value();
        self.feed.note(place, feed.value());
        self.spindle.note(place, spindle.value());
    }

    /// The stroke is over, with a score: learn from it.
    pub fn finish(&mut self, score: Length, learning: &Learning) -> Taught {
        self.strokes += 1;
        self.first.get_or_insert(score);
        let cell_s = self.cell().value();
        let cells = libm::ceil((self.key.times.0 + self.key.times.1).value() / cell_s) as usize + 1;
        let mut splines = Splines {
            feed: &mut self.feed,
            spindle: &mut self.spindle,
            used: cells.min(CELLS),
            filter: LowPass::new(learning.bandwidth_hz, cell_s),
            most: MOST_LEADS * self.key.lead.value().abs(),
        };
        self.progress.learn(&mut splines, score.value(), &TERMS)
    }

    /// An encoder-following stroke went beyond its bottom by so much (negative: it fell short): the
    /// stopping angle of this spindle at this speed is longer than planned by as many turns. What
    /// braking overruns does not depend on when it begins, so one stroke teaches all of it.
    pub fn overran(&mut self, by: Length) {
        let turns: Angle = by / self.key.lead.abs();
        self.stopped_late(self.early + turns, by);
    }

    /// A stroke of a spindle that slowed down to a creep on its way has shown how much longer than
    /// planned its stopping angle is, and went beyond its bottom by so much. The first stroke
    /// teaches all of it, later ones only what is not their own chance.
    pub fn stopped_late(&mut self, by: Angle, overrun: Length) {
        const MOST: Angle = Angle::rev(20.0);
        let share = if self.strokes == 0 { 1.0 } else { LATER };
        self.early = (self.early + (by - self.early) * share).max(-MOST).min(MOST);
        self.strokes += 1;
        self.first.get_or_insert(overrun.abs());
        let overrun = overrun.abs().value();
        self.progress.best = Some(self.progress.best.map_or(overrun, |best| best.min(overrun)));
    }
}

#[cfg(test)]
#[path = "learning_tests.rs"]
mod tests;
