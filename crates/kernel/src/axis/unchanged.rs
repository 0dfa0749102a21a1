//! Bound of the force of an axis that rests while its reading does not change.
//!
//! ```text
//!   force │            ╭╌╌ what the loop would integrate of the error that it sees
//!         │      ╭─────╯
//!         │ ─────╯     └── what friction bears, or a little more than at the last change
//!         └──────────────► time
//!           rests  0.5 s
//! ```
//!
//! An axis that sticks stays where it is: that takes no more force than friction bears, and within
//! the margin above it the reading changes by a count. An axis whose encoder is stuck would be
//! pushed to the end of its travel by the integrated error.
use crate::config::AxisControl;

/// Time during which the error is integrated without a bound, s.
const INTEGRATION_S: f64 = 0.5;
/// Force afterwards, as a share of the breakaway force: friction differs from the machine's file.
const STICTION_SHARE: f64 = 0.4;
/// The same as a share of the drive's peak force, where the file states no friction.
const PEAK_SHARE: f64 = 0.02;
/// Margin over the force at the last change of the reading, as a share of the force above.
const MARGIN_SHARE: f64 = 0.25;

/// A reading since its last change.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unchanged {
    reading: f64,
    /// Largest force beyond the weight after [`INTEGRATION_S`], N.
    bound: f64,
    /// Force that friction bears for certain, N.
    stiction: f64,
    /// Periods since the last change.
    periods: u32,
    /// Periods in [`INTEGRATION_S`].
    integration: u32,
}

impl Unchanged {
    pub(super) fn new(control: &AxisControl, period_s: f64) -> Self {
        let breakaway = control.friction.breakaway.value();
        let by_peak = PEAK_SHARE * control.peak_force.value();
        let stiction = if breakaway > 0.0 { STICTION_SHARE * breakaway } else { by_peak };
        let integration = (INTEGRATION_S / period_s) as u32;
        Self { reading: f64::NAN, bound: stiction, stiction, periods: 0, integration }
    }

    /// Returns the largest force beyond the weight that the drive may give, N; infinite while the
    /// axis moves. `force` is that of the period before.
    pub(super) fn bound(&mut self, rests: bool, reading: f64, force: f64) -> f64 {
        if !rests || reading != self.reading {
            self.reading = reading;
            self.bound = self.stiction.max(force.abs() + MARGIN_SHARE * self.stiction);
            self.periods = 0;
            return f64::INFINITY;
        }
        self.periods = self.periods.saturating_add(1);
        if self.periods > self.integration { self.bound } else { f64::INFINITY }
    }
}
