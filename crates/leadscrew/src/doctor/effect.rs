//! What lateness does to a thread.
use units::{Lead, Length, Spin, Time};

/// Lead that effects are shown for: M6's.
const LEAD: Lead = Lead::mm_per_rev(1.0);

/// What a setpoint that comes late does to a tap.
///
/// Drives go on with the setpoint before it. The axis of a tap with lead `p` under a spindle that
/// turns at `n` is then behind its thread by `p · n · lateness`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Highest speed at which the machine taps.
    pub speed: Spin,
    /// Lead of the tap.
    pub lead: Lead,
}

impl Effect {
    /// On a machine that taps at this speed at most.
    pub const fn at(speed: Spin) -> Self {
        Self { speed, lead: LEAD }
    }

    /// How far the axis is behind the thread.
    pub fn behind(&self, late: Time) -> Length {
        self.lead * (self.speed * late)
    }
}
