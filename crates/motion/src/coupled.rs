//! Steps that couple: an electronic gear between spindles, and what is superposed on an axis by a
//! spindle's turn.
//!
//! ```text
//!   Engage   follower = ratio·θ (+ axis/lead) + phase     coarse: same speed; fine: same phase; then locked
//!   Superpose   axis or spindle += g(θ)                   faded in, exchanged and faded out smoothly
//!   Release  the follower is a spindle of its own again
//! ```
//!
//! The functions g are tables over one turn of the master, or over the few after which a gear
//! begins anew. A step is `Copy` and short, so it names its table by a number; what feeds the
//! kernel hands it the tables themselves before the steps.
use units::{Angle, Axis, Lead, Ratio};

/// Names a table that the kernel has been given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TableId(pub u16);

/// A spindle that follows another one, and an axis beside it where a helix is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GearStep {
    /// The spindle that follows.
    pub follower: u8,
    /// The spindle that leads.
    pub master: u8,
    /// Follower's turns per master's turns.
    pub ratio: Ratio,
    /// A second master: the follower turns once more for each lead that this axis travels from
    /// zero.
    pub axis: Option<(Axis, Lead)>,
    /// Angle of the follower while the masters are at zero.
    pub phase: Angle,
}

/// What a superposition moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Superposed {
    /// A linear axis.
    Axis(Axis),
    /// A geared spindle's phase; where the spindle is its own master, its swing about an even turn.
    Spindle(u8),
}

/// Begin, exchange or end what is superposed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Superpose {
    /// On what.
    pub on: Superposed,
    /// The spindle whose angle is the table's argument.
    pub master: u8,
    /// Which function from now on; `None`: none.
    pub table: Option<TableId>,
    /// Turns of the master that the table spans, one or more.
    pub turns: f64,
    /// Turns of the master over which it fades in or out, at least; the limits of moves at approach
    /// speed may ask for more.
    pub over: Angle,
}
