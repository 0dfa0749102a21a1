//! Coordinates of axes: in millimetres of a linear axis, in degrees of a rotary one. Servo loops,
//! profiles and monitors compute with them without asking which; text is made of them by their axis
//! alone.
//!
//! A coordinate is not a length:
//!
//! ```compile_fail
//! # use units::{Coordinate, Length};
//! let sum = Coordinate::new(10.0) + Length::mm(1.0);
//! ```
//!
//! It does not say its unit, as it does not know it:
//!
//! ```compile_fail
//! # use units::Coordinate;
//! # extern crate std;
//! let text = std::format!("{}", Coordinate::new(10.0));
//! ```
//!
//! Its axis knows:
//!
//! ```
//! # use units::{Axis, Coordinate};
//! # extern crate std;
//! assert_eq!(std::format!("{}", Axis::X.reading(Coordinate::new(12.3))), "12.300 mm");
//! assert_eq!(std::format!("{:.1}", Axis::B.reading(Coordinate::new(30.0))), "30.0°");
//! ```
use core::fmt;

use crate::quantity::{measure, product};
use crate::{Accel, Angle, Axis, Jerk, Length, Speed, Spin, SpinAccel, SpinJerk, Time};

measure!(/// Where an axis is, or how far it goes: mm of a linear axis, ° of a rotary one.
    Coordinate, new, "the axis' own unit: mm of a linear one, ° of a rotary one");
measure!(/// Rate of [`Coordinate`].
    CoordinateSpeed, new, "mm/s of a linear axis, °/s of a rotary one");
measure!(/// Rate of [`CoordinateSpeed`].
    CoordinateAccel, new, "mm/s² of a linear axis, °/s² of a rotary one");
measure!(/// Rate of [`CoordinateAccel`].
    CoordinateJerk, new, "mm/s³ of a linear axis, °/s³ of a rotary one");

product!(CoordinateSpeed * Time = Coordinate);
product!(CoordinateAccel * Time = CoordinateSpeed);
product!(CoordinateJerk * Time = CoordinateAccel);

/// In from a quantity of either kind, and out again where the kind of the axis is known by what is
/// done with it.
macro_rules! kinds {
    ($name:ident: $linear:ident, $rotary:ident) => {
        impl $name {
            /// Of a linear axis.
            pub const fn linear(value: $linear) -> Self {
                Self(value.value())
            }
            /// Of a rotary axis.
            pub const fn rotary(value: $rotary) -> Self {
                Self(value.value() * DEG_PER_REV)
            }
            /// Of an axis that is linear because of what it does: it taps, it follows a spindle, it
            /// carries a wheel.
            pub const fn of_linear(self) -> $linear {
                $linear(self.0)
            }
            /// Of an axis that is rotary because of what it does.
            pub const fn of_rotary(self) -> $rotary {
                $rotary(self.0 / DEG_PER_REV)
            }
        }
    };
}

/// Degrees in a turn.
const DEG_PER_REV: f64 = 360.0;

kinds!(Coordinate: Length, Angle);
kinds!(CoordinateSpeed: Speed, Spin);
kinds!(CoordinateAccel: Accel, SpinAccel);
kinds!(CoordinateJerk: Jerk, SpinJerk);

impl CoordinateSpeed {
    /// From mm/min of a linear axis, °/min of a rotary one: the programmer's unit.
    pub const fn per_min(value: f64) -> Self {
        Self(value / 60.0)
    }
    /// In mm/min of a linear axis, °/min of a rotary one.
    pub const fn in_per_min(self) -> f64 {
        self.0 * 60.0
    }
}

/// What an axis does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AxisKind {
    /// It moves straight on.
    Linear,
    /// It turns.
    Rotary,
}

impl AxisKind {
    /// Its name: `"linear"`, `"rotary"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Rotary => "rotary",
        }
    }

    /// Unit of its [`Coordinate`] after a number, with the space where one belongs there: `" mm"`,
    /// `"°"`.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Linear => " mm",
            Self::Rotary => "°",
        }
    }

    /// Unit of its [`CoordinateSpeed`] after a number: `" mm/s"`, `"°/s"`.
    pub const fn speed_unit(self) -> &'static str {
        match self {
            Self::Linear => " mm/s",
            Self::Rotary => "°/s",
        }
    }

    /// Unit of its [`Coordinate`] in names of keys and columns: `"mm"`, `"deg"`.
    pub const fn unit_name(self) -> &'static str {
        match self {
            Self::Linear => "mm",
            Self::Rotary => "deg",
        }
    }
}

/// A [`Coordinate`] as its axis reads it. Three decimals, unless others are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Of a linear axis.
    Linear(Length),
    /// Of a rotary axis.
    Rotary(Angle),
}

/// A [`CoordinateSpeed`] as its axis reads it. Three decimals, unless others are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedReading {
    /// Of a linear axis.
    Linear(Speed),
    /// Of a rotary axis.
    Rotary(Spin),
}

impl AxisKind {
    /// What a coordinate of such an axis says.
    pub const fn reading(self, at: Coordinate) -> Reading {
        match self {
            Self::Linear => Reading::Linear(at.of_linear()),
            Self::Rotary => Reading::Rotary(at.of_rotary()),
        }
    }

    /// What a speed of such an axis says.
    pub const fn speed_reading(self, speed: CoordinateSpeed) -> SpeedReading {
        match self {
            Self::Linear => SpeedReading::Linear(speed.of_linear()),
            Self::Rotary => SpeedReading::Rotary(speed.of_rotary()),
        }
    }
}

impl Axis {
    /// What a coordinate of this axis says.
    pub const fn reading(self, at: Coordinate) -> Reading {
        self.kind().reading(at)
    }

    /// What a speed of this axis says.
    pub const fn speed_reading(self, speed: CoordinateSpeed) -> SpeedReading {
        self.kind().speed_reading(speed)
    }
}

/// A number with its unit.
fn write(f: &mut fmt::Formatter<'_>, value: f64, unit: &str) -> fmt::Result {
    let decimals = f.precision().unwrap_or(3);
    if f.sign_plus() {
        write!(f, "{value:+.decimals$}{unit}")
    } else {
        write!(f, "{value:.decimals$}{unit}")
    }
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear(length) => write(f, length.value(), AxisKind::Linear.unit()),
            Self::Rotary(angle) => write(f, angle.in_deg(), AxisKind::Rotary.unit()),
        }
    }
}

impl fmt::Display for SpeedReading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear(speed) => write(f, speed.value(), AxisKind::Linear.speed_unit()),
            Self::Rotary(spin) => {
                write(f, spin.value() * DEG_PER_REV, AxisKind::Rotary.speed_unit())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::format;

    #[test]
    fn a_coordinate_says_the_unit_of_its_axis() {
        for axis in Axis::ALL {
            let rotary = matches!(axis.letter(), 'A'..='C');
            let expected = if rotary { "-30.500°" } else { "-30.500 mm" };
            assert_eq!(format!("{}", axis.reading(Coordinate::new(-30.5))), expected, "{axis:?}");
            let expected = if rotary { "+20.0°/s" } else { "+20.0 mm/s" };
            let speed = Coordinate::new(5.0) / Time::s(0.25);
            assert_eq!(format!("{:+.1}", axis.speed_reading(speed)), expected, "{axis:?}");
            assert_eq!(axis.kind().unit_name(), if rotary { "deg" } else { "mm" });
        }
    }

    #[test]
    fn a_quarter_of_a_turn_is_90_of_a_rotary_axis() {
        let at = Coordinate::rotary(Angle::rev(0.25));
        assert_eq!(at, Coordinate::new(90.0));
        assert_eq!(at.of_rotary(), Angle::deg(90.0));
        assert_eq!(CoordinateSpeed::rotary(Spin::rpm(10.0)), CoordinateSpeed::new(60.0));
        assert_eq!(Coordinate::linear(Length::mm(90.0)).of_linear(), Length::mm(90.0));
    }
}
