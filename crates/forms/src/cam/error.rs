//! Why a cam cannot be ground.
use std::fmt;
use units::{Angle, Length};

/// What is wrong, and in which row of the table if it is in one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamError {
    /// Row of the lift table, counted from 0.
    pub row: Option<usize>,
    /// What.
    pub problem: Problem,
}

/// What can be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Problem {
    /// Fewer or more rows than a table may have.
    Rows {
        /// How many there are, at least.
        count: usize,
    },
    /// An angle or a lift is not a finite number.
    NotFinite,
    /// The angle does not rise.
    NotRising {
        /// The angle before.
        before: Angle,
        /// The angle in this row.
        found: Angle,
    },
    /// The angle rises by another step than before.
    Gap {
        /// The angle that was expected.
        expected: Angle,
        /// The angle found.
        found: Angle,
    },
    /// The table does not close.
    NotAWholeTurn {
        /// Where it begins.
        from: Angle,
        /// Where it ends.
        to: Angle,
    },
    /// First and last row are the same angle, and differ.
    NotPeriodic {
        /// Lift in the first row.
        first: Length,
        /// Lift in the last one.
        last: Length,
    },
    /// The lift jumps.
    Jump {
        /// By so much.
        by: Length,
        /// While its neighbours change by at most so much.
        neighbours: Length,
    },
    /// Base and lift together leave no radius.
    NoRadius {
        /// The smallest base radius that works.
        base: Length,
    },
    /// The follower asks for a contour that would be cut away under itself.
    Undercut {
        /// At this angle of the follower.
        at: Angle,
        /// The smallest base radius that works with a flat follower, or the largest roller that
        /// does.
        works: Undercut,
    },
    /// The wheel does not fit into a hollow.
    WheelTooBig {
        /// At this angle of the follower.
        at: Angle,
        /// The largest wheel radius that works.
        largest: Length,
    },
    /// A figure that must be above zero is not.
    NotPositive {
        /// Which.
        what: &'static str,
    },
}

/// What would work instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Undercut {
    /// A flat follower needs a base radius of at least this.
    Base(Length),
    /// A roller may be at most this large.
    Roller(Length),
}

impl CamError {
    pub(crate) const fn of(problem: Problem) -> Self {
        Self { row: None, problem }
    }

    pub(crate) const fn in_row(row: usize, problem: Problem) -> Self {
        Self { row: Some(row), problem }
    }
}

impl fmt::Display for CamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let deg = |a: Angle| a.in_deg();
        match self.problem {
            Problem::Rows { count } => {
                let (fewest, most) = (super::lift::FEWEST_ROWS, super::MOST_ROWS);
                write!(f, "expected {fewest} to {most} rows, found ")?;
                if count > most { f.write_str("more") } else { write!(f, "{count}") }
            }
            Problem::NotFinite => f.write_str("expected a finite angle and a finite lift"),
            Problem::NotRising { before, found } => {
                write!(f, "expected an angle above {:.4}°, found {:.4}°", deg(before), deg(found))
            }
            Problem::Gap { expected, found } => write!(
                f,
                "expected the angle {:.4}° as the step before it asks for, found {:.4}°",
                deg(expected),
                deg(found)
            ),
            Problem::NotAWholeTurn { from, to } => write!(
                f,
                "expected rows over a whole turn, found {:.4}° to {:.4}°",
                deg(from),
                deg(to)
            ),
            Problem::NotPeriodic { first, last } => write!(
                f,
                "the table is not periodic: its first row has the lift {:.6} mm, and its last one, a turn later, {:.6} mm",
                first.value(),
                last.value()
            ),
            Problem::Jump { by, neighbours } => write!(
                f,
                "the lift jumps by {:.4} mm, while its neighbours change by at most {:.4} mm",
                by.value(),
                neighbours.value()
            ),
            Problem::NoRadius { base } => {
                write!(
                    f,
                    "base and lift leave no radius: expected a base above {:.3} mm",
                    base.value()
                )
            }
            Problem::Undercut { at, works: Undercut::Base(base) } => write!(
                f,
                "a flat follower at {:.2}° asks for an undercut contour: expected a base radius of at least {:.3} mm",
                deg(at),
                base.value()
            ),
            Problem::Undercut { at, works: Undercut::Roller(roller) } => write!(
                f,
                "the roller at {:.2}° asks for an undercut contour: expected a roller radius of at most {:.3} mm",
                deg(at),
                roller.value()
            ),
            Problem::WheelTooBig { at, largest } => write!(
                f,
                "the wheel does not fit into the hollow at {:.2}°: expected a wheel radius below {:.3} mm",
                deg(at),
                largest.value()
            ),
            Problem::NotPositive { what } => write!(f, "expected {what} above zero"),
        }
    }
}

impl std::error::Error for CamError {}
