//! An angle at which a spindle shall stop, and how it comes there.
//!
//! ```text
//!              0                    shortest   from 350° to 10°: 20° on
//!        from ╱                     forward    from 10° to 350°: 340° on
//!     270 ───●─── 90   ─► to        backward   from 350° to 10°: 340° back
//!            │
//!           180
//! ```
use crate::Angle;

/// The direction in which a spindle turns to an angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TurnDirection {
    /// Half a turn at most.
    #[default]
    Shortest,
    /// As M3 turns.
    Forward,
    /// As M4 turns.
    Backward,
}

/// An angle at which a spindle shall stop, and how it comes there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Orientation {
    /// Within a turn.
    pub angle: Angle,
    /// From where the spindle stands.
    pub direction: TurnDirection,
}

impl Orientation {
    /// By the shorter way.
    pub const fn shortest(angle: Angle) -> Self {
        Self { angle, direction: TurnDirection::Shortest }
    }

    /// The angle, counted on through whole turns, at which a spindle that stands at `from` comes
    /// there. One that is no further than `near` from it turns no whole turn, whatever its
    /// direction.
    pub fn from(self, from: Angle, near: Angle) -> Angle {
        let turns = (self.angle - from).value();
        let least = turns - libm::round(turns);
        let turned = match self.direction {
            _ if libm::fabs(least) <= near.value() => least,
            TurnDirection::Shortest => least,
            TurnDirection::Forward => turns - libm::floor(turns),
            TurnDirection::Backward => turns - libm::ceil(turns),
        };
        from + Angle::rev(turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 7 turns and `from` degrees to `to`: the way, °.
    fn way(from: f64, to: f64, direction: TurnDirection) -> f64 {
        let stands = Angle::rev(7.0) + Angle::deg(from);
        let to = Orientation { angle: Angle::deg(to), direction };
        (to.from(stands, Angle::deg(0.2)) - stands).in_deg()
    }

    #[test]
    fn a_spindle_turns_to_its_angle_by_the_shorter_way_or_as_it_is_told() {
        use TurnDirection::{Backward, Forward, Shortest};
        for (from, to, shortest, forward, backward) in [
            (350.0, 10.0, 20.0, 20.0, -340.0),
            (10.0, 350.0, -20.0, 340.0, -20.0),
            (90.0, 210.0, 120.0, 120.0, -240.0),
        ] {
            for (direction, expected) in
                [(Shortest, shortest), (Forward, forward), (Backward, backward)]
            {
                let found = way(from, to, direction);
                assert!((found - expected).abs() < 1e-9, "{from} to {to} {direction:?}: {found}");
            }
        }
    }

    #[test]
    fn one_that_stands_there_already_makes_no_whole_turn() {
        for direction in [TurnDirection::Forward, TurnDirection::Backward] {
            assert!((way(90.1, 90.0, direction) + 0.1).abs() < 1e-9);
            assert!((way(89.9, 90.0, direction) - 0.1).abs() < 1e-9);
            assert!(way(90.0, 90.0, direction).abs() < 1e-9);
        }
    }
}
