//! Cycles that only these controls have, or write in their own way.
//!
//! ```text
//!   circle      G12, G13: a round pocket from its centre
//!   lathe       cycles of four moves, drilling on a lathe
//!   turning     G70 to G73: along a profile of the tape
//!   grooving    G74, G75: pecking
//!   threading   G76: a thread in several passes
//!   growing     G34: a thread whose lead grows
//! ```
pub(crate) mod circle;
pub(crate) mod grooving;
pub(crate) mod growing;
pub(crate) mod lathe;
pub(crate) mod lengths;
pub(crate) mod threading;
pub(crate) mod turning;
