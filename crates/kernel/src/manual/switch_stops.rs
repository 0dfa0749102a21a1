//! Moves by hand that a limit switch has ended.
//!
//! ```text
//!   key held:    jog ─ ended ─ jog ─ ended ─ jog ─ ended          1 s
//!                        │                           └──────────────────► said again
//!                      said once
//! ```
//!
//! A key that is held renews its jog ten times a second, and each is ended at once.
use bus::AXES;
use units::Axis;

/// Time without such an end after which the next one is said again, s.
const QUIET_S: f64 = 1.0;

/// Ends by limit switches, of each axis towards smaller and larger coordinates.
#[derive(Clone, Debug)]
pub(super) struct SwitchStops {
    /// Time since the last one, s.
    since_s: [[f64; 2]; AXES],
    unsaid: [bool; AXES],
}

impl Default for SwitchStops {
    fn default() -> Self {
        Self { since_s: [[f64::INFINITY; 2]; AXES], unsaid: [false; AXES] }
    }
}

impl SwitchStops {
    /// A servo period passes.
    pub(super) fn advance(&mut self, period_s: f64) {
        for since_s in self.since_s.as_flattened_mut() {
            *since_s += period_s;
        }
    }

    /// The switch at the end towards larger coordinates, or the other one, has ended a move.
    pub(super) fn ended(&mut self, axis: usize, is_upper: bool) {
        let since_s = &mut self.since_s[axis][usize::from(is_upper)];
        self.unsaid[axis] |= *since_s > QUIET_S;
        *since_s = 0.0;
    }

    /// The next axis of which it is to be said.
    pub(super) fn take(&mut self) -> Option<Axis> {
        let index = self.unsaid.iter().position(|unsaid| *unsaid)?;
        self.unsaid[index] = false;
        Some(Axis::ALL[index])
    }
}
