//! Axes by letter, and where they stand: positions, planes, circles, and the ratio of two spindles.
use crate::{Angle, AxisKind, Coordinate, Length};

/// An axis by its letter, in the order used wherever axes are numbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Axis {
    /// First linear axis.
    X,
    /// Second linear axis.
    Y,
    /// Third linear axis, as a rule along the spindle.
    Z,
    /// Rotation about X.
    A,
    /// Rotation about Y.
    B,
    /// Rotation about Z.
    C,
    /// Parallel to X.
    U,
    /// Parallel to Y.
    V,
    /// Parallel to Z.
    W,
}

impl Axis {
    /// All of them, in order.
    pub const ALL: [Self; 9] =
        [Self::X, Self::Y, Self::Z, Self::A, Self::B, Self::C, Self::U, Self::V, Self::W];

    /// Its place in [`Axis::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// By its letter, in upper or lower case.
    pub fn from_letter(letter: char) -> Option<Self> {
        Self::ALL.into_iter().find(|axis| axis.letter() == letter.to_ascii_uppercase())
    }

    /// What it does: A, B and C turn, the others move straight on.
    pub const fn kind(self) -> AxisKind {
        match self {
            Self::A | Self::B | Self::C => AxisKind::Rotary,
            _ => AxisKind::Linear,
        }
    }

    /// Its letter.
    pub const fn letter(self) -> char {
        ['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'][self as usize]
    }
}

/// Machine coordinates of all nine axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Position {
    /// X, Y, Z.
    pub linear: [Length; 3],
    /// A, B, C.
    pub rotary: [Angle; 3],
    /// U, V, W.
    pub parallel: [Length; 3],
}

impl Position {
    /// A point of the three linear axes, in millimetres; the others at zero.
    pub const fn xyz(x: f64, y: f64, z: f64) -> Self {
        Self {
            linear: [Length::mm(x), Length::mm(y), Length::mm(z)],
            rotary: [Angle::ZERO; 3],
            parallel: [Length::ZERO; 3],
        }
    }

    /// Coordinate of an axis.
    pub const fn along(&self, axis: Axis) -> Coordinate {
        let i = axis.index();
        match i {
            0..=2 => Coordinate::linear(self.linear[i]),
            6..=8 => Coordinate::linear(self.parallel[i - 6]),
            _ => Coordinate::rotary(self.rotary[i - 3]),
        }
    }

    /// The same point with one axis moved, to where [`Position::along`] then says it is.
    #[must_use]
    pub const fn with(mut self, axis: Axis, value: Coordinate) -> Self {
        let i = axis.index();
        match i {
            0..=2 => self.linear[i] = value.of_linear(),
            6..=8 => self.parallel[i - 6] = value.of_linear(),
            _ => self.rotary[i - 3] = value.of_rotary(),
        }
        self
    }
}

/// Working plane; a cycle drills along its normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Plane {
    /// G17.
    #[default]
    XY,
    /// G18.
    ZX,
    /// G19.
    YZ,
}

impl Plane {
    /// First axis, second axis, normal: a right-handed frame.
    pub const fn axes(self) -> [Axis; 3] {
        match self {
            Self::XY => [Axis::X, Axis::Y, Axis::Z],
            Self::ZX => [Axis::Z, Axis::X, Axis::Y],
            Self::YZ => [Axis::Y, Axis::Z, Axis::X],
        }
    }

    /// The axis along which a cycle drills.
    pub const fn normal(self) -> Axis {
        self.axes()[2]
    }
}

/// Which circle, in the plane's first and second axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Arc {
    /// The plane.
    pub plane: Plane,
    /// Centre in machine coordinates, along the plane's first and second axis.
    pub centre: [Length; 2],
    /// Angle swept, counter-clockwise positive as seen against the normal; more than one turn is
    /// allowed.
    pub sweep: Angle,
}

/// Turns of the follower in so many turns of the master, in whole numbers, so that nothing drifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ratio {
    /// Turns of the follower; negative turns it the other way.
    pub follower: i32,
    /// Turns of the master meanwhile; above zero.
    pub master: i32,
}

impl Ratio {
    /// Turns of the follower per turn of the master.
    pub fn value(self) -> f64 {
        f64::from(self.follower) / f64::from(self.master)
    }

    /// The gear of a few turns about which this one winds slowly: 3600:7201 about 1:2, or itself.
    /// `None`: there is none.
    pub fn settled(self) -> Option<Self> {
        /// Turns of the master after which a gear begins anew.
        const FEW: i32 = 8;
        /// Share of a turn that it may wind in one.
        const SLOWLY: f64 = 0.01;
        if self.master <= FEW {
            return Some(self);
        }
        let value = self.value();
        (1..=FEW).find_map(|master| {
            let follower = libm::round(value * f64::from(master));
            let off = follower / f64::from(master) - value;
            (follower != 0.0 && off.abs() <= SLOWLY * value.abs())
                .then_some(Self { follower: follower as i32, master })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_axis_stands_where_it_was_put_and_no_other_one_moves() {
        let origin = Position::default();
        for axis in Axis::ALL {
            for value in [-250.0, -0.125, 30.0, 359.5, 1e5] {
                let moved = origin.with(axis, Coordinate::new(value));
                for other in Axis::ALL {
                    let expected = if other == axis { value } else { 0.0 };
                    let found = moved.along(other).value();
                    assert!(
                        (found - expected).abs() <= 1e-12 * value.abs(),
                        "{axis:?} {other:?} {found}"
                    );
                }
            }
        }
        let turned = origin.with(Axis::A, Coordinate::rotary(Angle::deg(90.0)));
        assert_eq!(turned.rotary[0], Angle::deg(90.0));
        let moved = origin.with(Axis::W, Coordinate::linear(Length::mm(90.0)));
        assert_eq!(moved.parallel[2], Length::mm(90.0));
    }

    #[test]
    fn a_gear_winds_about_the_one_of_a_few_turns_that_is_near() {
        let settled = |master, follower| Ratio { follower, master }.settled();
        assert_eq!(settled(1, 2), Some(Ratio { follower: 2, master: 1 }));
        assert_eq!(settled(2, 5), Some(Ratio { follower: 5, master: 2 }));
        assert_eq!(settled(3600, 7201), Some(Ratio { follower: 2, master: 1 }));
        assert_eq!(settled(1000, -2501), Some(Ratio { follower: -5, master: 2 }));
        assert_eq!(settled(100, 294), None);
    }
}
