//! Drilling: G81, and G82, which waits at the bottom.
//!
//! ```text
//!   G81 X Y Z R          feed to the bottom, out fast        where the dialect has it so, P waits in G81 too
//!   G82 X Y Z R P        feed to the bottom, wait, out fast
//! ```
//!
//! Source: NISTIR 6556, sections 3.5.16.2 and 3.5.16.3.
use crate::{
    call::{Call, CycleHole, Sink, out::Out},
    cycles::holes::pattern::{Pattern, at_level},
    modes::Cycle,
};

/// From the bottom to the clear level.
pub(crate) fn out<S: Sink>(pattern: &Pattern, hole: &CycleHole, out: &mut Out<'_, S>) {
    if pattern.cycle == Cycle::DrillDwell || pattern.dwell > 0.0 {
        out.say(&Call::Dwell(pattern.dwell));
    }
    if hole.throw_rpm.is_some() {
        out.say(&Call::ThrowChips(*hole));
    }
    out.say(&Call::Rapid(at_level(hole, pattern.clear)));
}
