//! An axis at rest whose reading does not change.
//!
//! ```text
//!   force │            ╭╌╌ what the loop would gather of the error that it sees
//!         │      ╭─────╯
//!         │ ─────╯     └── what friction bears, or a little more than when the reading changed last
//!         └──────────────► time
//!           rests  half a second
//! ```
//!
//! One that sticks stays where it is by no more than friction bears, and gives way by a count
//! before it moves. One whose encoder does not count any more would be pushed to the end of its
//! travel.
use crate::config::AxisControl;

/// So long the loop may gather what it sees, s.
const GATHERS_S: f64 = 0.5;
/// Share of its breakaway force that the drive may give from then on, and of the drive's most where
/// friction is not known.
const STICKS: f64 = 0.4;
const UNKNOWN_FRICTION: f64 = 0.02;
/// And this share of that more than when the reading changed last: within it, an axis that sticks
/// gives way by a count.
const GIVES: f64 = 0.25;

/// What is known of a reading that stays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unchanged {
    reading: f64,
    /// Force beyond the weight that may be given once it has stayed for long.
    most: f64,
    /// What friction bears.
    friction: f64,
    /// Periods since it changed, and so many of them are long.
    periods: u32,
    long: u32,
}

impl Unchanged {
    pub(super) fn new(control: &AxisControl, period_s: f64) -> Self {
        let breakaway = control.friction.breakaway.value();
        let unknown = UNKNOWN_FRICTION * control.peak_force.value();
        let friction = if breakaway > 0.0 { STICKS * breakaway } else { unknown };
        let long = (GATHERS_S / period_s) as u32;
        Self { reading: f64::NAN, most: friction, friction, periods: 0, long }
    }

    /// Force beyond the weight that the drive may give; infinite as a rule. `force` is that of the
    /// period before.
    pub(super) fn borne(&mut self, rests: bool, reading: f64, force: f64) -> f64 {
        if !rests || reading != self.reading {
            self.reading = reading;
            self.most = self.friction.max(force.abs() + GIVES * self.friction);
            self.periods = 0;
            return f64::INFINITY;
        }
        self.periods = self.periods.saturating_add(1);
        if self.periods > self.long { self.most } else { f64::INFINITY }
    }
}
