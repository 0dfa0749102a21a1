//! What a cycle keeps of its words beside levels and times: those of taps, and the shift of back
//! boring.
//!
//! | word | meaning | left out |
//! |---|---|---|
//! | `A` | spindle angle at which the thread begins at R, degrees | 0 |
//! | `J` | way out: up to 20 so many times S, above 20 rev/min | as fast as in |
//! | `I` | acceleration on the way out: up to 1 that share of what the drives give, above 1 rev/s² | all of it |
//! | `Q` | depth of each peck, above 0; Q0 ends it | all the way at once |

use crate::call::{CycleHole, CycleTap, ReturnSpeed, Sense};
use canon::ReturnAcceleration;
use diag::Span;
/// What only G87 has: the shift along X, Y, Z (one of which is where the counterbore ends).
pub(crate) type Shift = [f64; 3];

/// Whether the next tap, or this one, is rigid by M29 or by its code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rigid {
    /// It is not.
    Off,
    /// M29 was here; its cycle has not come yet.
    Ordered(Span),
    /// Its cycle is in force.
    Cycling,
}

/// The words of a tapping cycle that no other cycle has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TapWords {
    pub(crate) start_angle_deg: f64,
    pub(crate) return_speed: ReturnSpeed,
    pub(crate) return_acceleration: ReturnAcceleration,
    pub(crate) peck: Option<f64>,
    /// I or J of Brother's G77 and G78, mm.
    pub(crate) lead_mm: Option<f64>,
}

impl Default for TapWords {
    fn default() -> Self {
        Self {
            start_angle_deg: 0.0,
            return_speed: ReturnSpeed::Times(1.0),
            return_acceleration: ReturnAcceleration::AsSet,
            peck: None,
            lead_mm: None,
        }
    }
}

impl TapWords {
    /// One hole of the cycle.
    pub(crate) const fn call(
        &self,
        hole: CycleHole,
        sense: Sense,
        dwell_s: f64,
        overrides: (bool, bool),
    ) -> CycleTap {
        let &Self { start_angle_deg, return_speed, return_acceleration, peck, lead_mm } = self;
        CycleTap {
            hole,
            sense,
            dwell_s,
            start_angle_deg,
            return_speed,
            return_acceleration,
            peck,
            overrides,
            feed_stated: false,
            lead_mm,
        }
    }
}
