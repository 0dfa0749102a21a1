//! What a machine file states of measured errors of an axis; read in `machine/compensation.rs`.
use sync::DeviationTable;
use units::{Coordinate, CoordinateAccel, CoordinateSpeed};

/// What takes up the play of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakesUpPlay {
    /// The control.
    Control,
    /// The drive, by itself.
    Drive,
}

/// Measured errors of an axis, and the compensation of them.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedDeviations {
    /// Measured errors, with the play.
    pub table: DeviationTable,
    /// What takes up the play; `None`: no play is stated.
    pub takes_up: Option<TakesUpPlay>,
    /// Speed and acceleration that a change of flank takes.
    pub reversal: (CoordinateSpeed, CoordinateAccel),
    /// Way back at which the flank changes: what the guideway gives before it slides.
    pub turns_after: Coordinate,
}
