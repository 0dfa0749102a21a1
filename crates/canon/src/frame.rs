//! How a program writes places and lengths, so that advice can be given in its own words.
//!
//! ```text
//!   machine = R(rotation) · (program + added) + origin + tool          mm; see `interp`'s frames
//!
//!   X250 of G54      the same place as machine X-40, where G54 has its zero at X-290
//! ```
//!
//! Operations carry machine coordinates in millimetres and nothing else; this is what was in force
//! when one of them was written. Nothing is computed from it but words.
use crate::{Axis, Position};
use units::{Angle, Length, MM_PER_INCH};

/// Unit in which a program writes lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// G21.
    #[default]
    Millimetre,
    /// G20.
    Inch,
}

impl LengthUnit {
    /// Millimetres in one of it.
    pub const fn in_mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Inch => MM_PER_INCH,
        }
    }

    /// Its symbol.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "in",
        }
    }
}

/// From where the axis words of a block count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Counting {
    /// From zero.
    #[default]
    Absolute,
    /// From where each axis stood (G91).
    Incremental,
    /// From where each axis stood, by letters of their own: U, V, W of Fanuc's lathes.
    IncrementalLetters,
}

/// The program's frame and units when an operation was written. The default is the machine's own:
/// millimetres, no offsets.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProgramFrame {
    /// Unit of lengths.
    pub unit: LengthUnit,
    /// Which work offset is in force: 1 is G54, 7 to 9 are G59.1 to G59.3; 0: machine coordinates.
    pub work_offset: u8,
    /// Zero of that work offset.
    pub origin: Position,
    /// G92 and G52, within the rotation.
    pub added: Position,
    /// Rotation of X and Y about Z.
    pub rotation: Angle,
    /// The tool length offset that is in force.
    pub tool: Position,
    /// X words are diameters.
    pub x_is_diameter: bool,
    /// From where its words count.
    pub counting: Counting,
}

impl ProgramFrame {
    /// Code of the work offset, such as "G54"; `None`: machine coordinates.
    pub const fn work_offset_code(&self) -> Option<&'static str> {
        const CODES: [&str; 9] =
            ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
        match self.work_offset {
            n @ 1..=9 => Some(CODES[n as usize - 1]),
            _ => None,
        }
    }

    /// How a block in machine coordinates is written (G53): in the program's unit, without any
    /// offset.
    #[must_use]
    pub fn of_machine(self) -> Self {
        Self { unit: self.unit, x_is_diameter: self.x_is_diameter, ..Self::default() }
    }

    /// Coordinate of an axis as the program would write it, in its unit (degrees for a rotary
    /// axis), where the machine's is `value` mm; `None` where the frame is turned about Z so that X
    /// and Y mix.
    pub fn written(&self, axis: Axis, value: f64) -> Option<f64> {
        if self.rotation != Angle::ZERO && matches!(axis, Axis::X | Axis::Y) {
            return None;
        }
        if matches!(axis, Axis::A | Axis::B | Axis::C) {
            let of = |at: &Position| at.rotary[axis.index() - 3].in_deg();
            return Some(value - of(&self.origin) - of(&self.tool) - of(&self.added));
        }
        let of = |at: &Position| at.along(axis).value();
        let radius = value - of(&self.origin) - of(&self.tool) - of(&self.added);
        let factor = if axis == Axis::X && self.x_is_diameter { 2.0 } else { 1.0 };
        Some(radius * factor / self.unit.in_mm())
    }

    /// A way along an axis as the program would write it in an incremental word, from its length in
    /// mm (degrees for a rotary axis), with the letter; `None`: the block does not count so, or X
    /// and Y mix.
    pub fn increment(&self, axis: Axis, way: f64) -> Option<(char, f64)> {
        let letter = match (self.counting, axis) {
            (Counting::Absolute, _) => return None,
            (Counting::IncrementalLetters, Axis::X) => 'U',
            (Counting::IncrementalLetters, Axis::Y) => 'V',
            (Counting::IncrementalLetters, Axis::Z) => 'W',
            (Counting::IncrementalLetters, Axis::C) => 'H',
            _ => axis.letter(),
        };
        if self.rotation != Angle::ZERO && matches!(axis, Axis::X | Axis::Y) {
            return None;
        }
        if matches!(axis, Axis::A | Axis::B | Axis::C) {
            return Some((letter, way));
        }
        let factor = if axis == Axis::X && self.x_is_diameter { 2.0 } else { 1.0 };
        Some((letter, way * factor / self.unit.in_mm()))
    }

    /// A length in the program's unit.
    pub fn length(&self, length: Length) -> f64 {
        length.value() / self.unit.in_mm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_written_in_the_work_offset_with_the_tools_length_and_in_the_programs_unit() {
        let frame = ProgramFrame {
            unit: LengthUnit::Inch,
            work_offset: 2,
            origin: Position::xyz(100.0, 0.0, -200.0),
            tool: Position::xyz(0.0, 0.0, 50.8),
            ..ProgramFrame::default()
        };
        assert_eq!(frame.work_offset_code(), Some("G55"));
        assert_eq!(frame.written(Axis::X, 354.0), Some(10.0));
        let z = frame.written(Axis::Z, -200.0 + 50.8 + 25.4).unwrap_or(f64::NAN);
        assert!((z - 1.0).abs() < 1e-12, "{z}");
    }

    #[test]
    fn x_of_a_lathe_is_a_diameter_and_no_other_axis_is() {
        let frame = ProgramFrame { work_offset: 1, x_is_diameter: true, ..ProgramFrame::default() };
        assert_eq!(frame.written(Axis::X, 12.5), Some(25.0));
        assert_eq!(frame.written(Axis::Z, 12.5), Some(12.5));
    }

    #[test]
    fn an_increment_is_a_way_in_the_letters_and_unit_of_its_block() {
        let frame = ProgramFrame {
            counting: Counting::Incremental,
            unit: LengthUnit::Inch,
            ..ProgramFrame::default()
        };
        assert_eq!(frame.increment(Axis::Z, -50.8), Some(('Z', -2.0)));
        let lathe = ProgramFrame {
            counting: Counting::IncrementalLetters,
            x_is_diameter: true,
            ..ProgramFrame::default()
        };
        assert_eq!(lathe.increment(Axis::X, 1.5), Some(('U', 3.0)));
        assert_eq!(lathe.increment(Axis::Z, 1.5), Some(('W', 1.5)));
        assert_eq!(ProgramFrame::default().increment(Axis::Z, 1.0), None);
    }

    #[test]
    fn under_a_rotation_x_and_y_have_no_words_of_their_own() {
        let frame = ProgramFrame { rotation: Angle::deg(30.0), ..ProgramFrame::default() };
        assert_eq!(frame.written(Axis::X, 1.0), None);
        assert_eq!(frame.written(Axis::Z, 1.0), Some(1.0));
    }
}
