//! Pieces along which no motion is possible.
use super::cell::bounds;
use crate::{AXES, Limits, Piece, Shape};

/// Longest piece, mm or °: a million turns of a metre's radius are shorter.
const LONGEST: f64 = 1e12;

/// Why a piece cannot be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LawRefusal {
    /// Its length is not a number above zero, or beyond 10¹² mm.
    Length(f64),
    /// Its feed is not above zero.
    Feed(f64),
    /// The axis of this index must move along it, and one of its limits is not above zero.
    Limit(usize),
}

impl core::fmt::Display for LawRefusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length(length) => write!(
                f,
                "a path of {length} mm cannot be followed: above 0 and up to {LONGEST:e} mm can"
            ),
            Self::Feed(feed) => {
                write!(f, "a feed of {feed} mm/s never arrives: it must be above 0")
            }
            Self::Limit(axis) => {
                let letter = ["X", "Y", "Z", "A", "B", "C", "U", "V", "W"][*axis];
                write!(
                    f,
                    "{letter} must move, and its speed, acceleration or jerk is limited to nothing: each must be above 0"
                )
            }
        }
    }
}

impl core::error::Error for LawRefusal {}

pub(super) fn check(piece: &Piece, limits: &Limits) -> Result<(), LawRefusal> {
    let length = piece.length();
    if !(length > 0.0 && length <= LONGEST) {
        return Err(LawRefusal::Length(length));
    }
    if piece.feed.is_nan() || piece.feed <= 0.0 {
        return Err(LawRefusal::Feed(piece.feed));
    }
    let bounds = bounds(piece, limits);
    let ends = [piece.at(0.0), piece.at(length / 2.0), piece.at(length)];
    for k in 0..AXES {
        let moves = ends.iter().any(|d| d.q1[k] != 0.0 || d.q2[k] != 0.0);
        let sound = [bounds.speed[k], bounds.accel[k], bounds.jerk[k]].iter().all(|x| *x > 0.0);
        if ends.iter().any(|d| !(d.q[k].is_finite() && d.q1[k].is_finite())) {
            return Err(LawRefusal::Length(length));
        }
        if moves && !sound {
            return Err(LawRefusal::Limit(k));
        }
    }
    Ok(())
}
