//! Thread classes: how wide an internal thread may be.
//!
//! ```text
//!   finer ◄──────────────────────────► coarser
//!   metric, ISO 965-1:      4H   5H   6H   7H      tolerance zone begins at the basic size
//!   unified, ASME B1.1:          3B   2B   1B
//! ```
use canon::Family;
use std::fmt;
use std::str::FromStr;

/// Class of an internal thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ThreadClass {
    /// Metric, finest judged.
    H4,
    /// Metric.
    H5,
    /// Metric, the ordinary one.
    H6,
    /// Metric, coarse.
    H7,
    /// Unified, fine.
    B3,
    /// Unified, the ordinary one.
    B2,
    /// Unified, coarse.
    B1,
}

impl ThreadClass {
    /// The classes of a family, finest first.
    pub const fn of(family: Family) -> &'static [Self] {
        match family {
            Family::Metric => &[Self::H4, Self::H5, Self::H6, Self::H7],
            Family::Unified => &[Self::B3, Self::B2, Self::B1],
        }
    }

    /// Which family it belongs to.
    pub const fn family(self) -> Family {
        match self {
            Self::H4 | Self::H5 | Self::H6 | Self::H7 => Family::Metric,
            Self::B3 | Self::B2 | Self::B1 => Family::Unified,
        }
    }

    /// The class of the other family that serves the same purpose, so that one class can be asked
    /// of a program with both kinds of thread: 4H, 5H ~ 3B; 6H ~ 2B; 7H ~ 1B.
    #[must_use]
    pub const fn in_family(self, family: Family) -> Self {
        match (family, self) {
            (Family::Metric, Self::B3) => Self::H5,
            (Family::Metric, Self::B2) => Self::H6,
            (Family::Metric, Self::B1) => Self::H7,
            (Family::Unified, Self::H4 | Self::H5) => Self::B3,
            (Family::Unified, Self::H6) => Self::B2,
            (Family::Unified, Self::H7) => Self::B1,
            (_, already) => already,
        }
    }

    /// Its name, such as `"6H"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::H4 => "4H",
            Self::H5 => "5H",
            Self::H6 => "6H",
            Self::H7 => "7H",
            Self::B3 => "3B",
            Self::B2 => "2B",
            Self::B1 => "1B",
        }
    }
}

impl fmt::Display for ThreadClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A class name that is not one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownClass(String);

impl fmt::Display for UnknownClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected a thread class 4H, 5H, 6H, 7H, 1B, 2B or 3B, found \"{}\"", self.0)
    }
}

impl std::error::Error for UnknownClass {}

impl FromStr for ThreadClass {
    type Err = UnknownClass;

    fn from_str(text: &str) -> Result<Self, UnknownClass> {
        [Family::Metric, Family::Unified]
            .into_iter()
            .flat_map(Self::of)
            .find(|class| class.name().eq_ignore_ascii_case(text.trim()))
            .copied()
            .ok_or_else(|| UnknownClass(text.chars().take(20).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_is_read_back_from_its_name() {
        for family in [Family::Metric, Family::Unified] {
            for class in ThreadClass::of(family) {
                assert_eq!(class.name().parse(), Ok(*class));
                assert_eq!(class.in_family(family), *class);
            }
        }
        assert_eq!("6h".parse(), Ok(ThreadClass::H6));
    }

    #[test]
    fn an_unknown_class_is_refused_with_the_ones_there_are() {
        let refused = "6G".parse::<ThreadClass>().unwrap_err().to_string();
        assert_eq!(refused, "expected a thread class 4H, 5H, 6H, 7H, 1B, 2B or 3B, found \"6G\"");
    }

    #[test]
    fn six_h_asks_two_b_of_an_inch_thread() {
        assert_eq!(ThreadClass::H6.in_family(Family::Unified), ThreadClass::B2);
    }
}
