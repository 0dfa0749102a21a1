//! Strokes of one axis that show its friction, its masses and its spring.
//!
//! ```text
//!   v │   ╭╌╌╌╮            ╭──────╮
//!     │──╯    ╰──   slow, with a sweep on top; fast, plain; in both senses
//! ```
//!
//! A sweep is made of short blocks of one direction whose feeds take turns: the slide never turns
//! back, so friction stays what it is, and the speed swings with up to 20 µm.
use super::motion::Window;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Frequencies of the sweep, Hz.
const SWEEP_HZ: (f64, f64) = (45.0, 260.0);
/// Farthest that a sweep moves from an even motion, m.
const SWING_M: f64 = 20e-6;
/// Time of a slow stroke with its sweep, s.
const SWEEP_S: f64 = 2.4;
/// Even motion before and after a sweep, s.
const EVEN_S: f64 = 0.3;
/// Speed of slow strokes, mm/s.
const SLOW: f64 = 50.0;
/// Share of the slow speed by which a sweep may change it.
const MODULATED: f64 = 0.3;

/// How an axis is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StrokePlan {
    /// Its letter.
    pub(crate) letter: char,
    /// Where it may be.
    pub(crate) window: Window,
    /// Fastest feed, mm/s.
    pub(crate) fastest: f64,
    /// Acceleration, m/s².
    pub(crate) acceleration: f64,
    /// Jerk, m/s³.
    pub(crate) jerk: f64,
    /// Pairs of slow strokes.
    pub(crate) slow_pairs: usize,
    /// Pairs of fast strokes.
    pub(crate) fast_pairs: usize,
}

impl StrokePlan {
    /// Speed of fast strokes, mm/s: a third of the way is for gaining and losing it.
    pub(crate) fn fast(&self) -> f64 {
        let length = (self.window.to - self.window.from) * 1e-3;
        self.fastest.min((self.acceleration * length / 3.0).sqrt() * 1e3)
    }

    /// Speed of slow strokes, mm/s.
    pub(crate) fn slow(&self) -> f64 {
        SLOW.min(self.fastest / 2.0).min((self.window.to - self.window.from) / (SWEEP_S + 1.0))
    }

    /// The program.
    pub(crate) fn text(&self) -> String {
        let mut program = Strokes { text: String::new(), plan: *self, at: 0.0 };
        let _ = writeln!(program.text, "G8\nG21 G90 G17 G94");
        let Window { from, to } = self.window;
        program.rapid(f64::midpoint(from, to));
        for pair in 0..self.slow_pairs {
            let rises = pair % 2 == 0;
            program.slow(1.0, rises);
            program.slow(-1.0, rises);
        }
        let speeds = [1.0, 0.5, 1.0];
        for pair in 0..self.fast_pairs {
            let speed = self.fast() * speeds[pair % speeds.len()];
            program.feed(to, speed);
            program.feed(from, speed);
        }
        program.text += "M2\n";
        program.text
    }
}

struct Strokes {
    text: String,
    plan: StrokePlan,
    at: f64,
}

impl Strokes {
    fn rapid(&mut self, to: f64) {
        self.at = to;
        let _ = writeln!(self.text, "G53 G0 {}{to:.4}", self.plan.letter);
    }

    fn feed(&mut self, to: f64, mm_per_s: f64) {
        self.at = to;
        let _ = writeln!(self.text, "G53 G1 {}{to:.5} F{:.3}", self.plan.letter, mm_per_s * 60.0);
    }

    /// A slow stroke in this sense, with a sweep that rises or falls.
    fn slow(&mut self, sense: f64, rises: bool) {
        let plan = self.plan;
        let speed = plan.slow();
        let middle = f64::midpoint(plan.window.from, plan.window.to);
        let half = speed * (SWEEP_S / 2.0 + EVEN_S);
        self.feed(middle - sense * half, speed);
        let _ = writeln!(self.text, "G4 P0.05");
        self.feed(self.at + sense * speed * EVEN_S, speed);
        let mut t = 0.0;
        while t < SWEEP_S {
            let share = if rises { t / SWEEP_S } else { 1.0 - t / SWEEP_S };
            let hz = SWEEP_HZ.0 * (SWEEP_HZ.1 / SWEEP_HZ.0).powf(share);
            let lasts = 0.5 / hz;
            let by = self.speed_change(hz).min(2.0 * MODULATED * speed);
            for side in [1.0, -1.0] {
                let speed = speed + side * by / 2.0;
                self.feed(self.at + sense * speed * lasts, speed);
                t += lasts;
            }
        }
        self.feed(self.at + sense * speed * EVEN_S, speed);
    }

    /// From one block of a sweep to the next, mm/s: what acceleration, jerk and the swing's size
    /// allow in half a period.
    fn speed_change(&self, hz: f64) -> f64 {
        let lasts = 0.5 / hz;
        let most = SWING_M * (TAU * hz).powi(2);
        let accel = self.plan.acceleration.min(most);
        let jerk = self.plan.jerk;
        let change = if accel < jerk * lasts / 2.0 {
            accel * (lasts - accel / jerk)
        } else {
            jerk * lasts * lasts / 4.0
        };
        change * 1e3
    }
}
