//! Places, lengths and feeds in the words of the program: its unit, its work offset, diameters
//! where X counts so.
//!
//! | what | with G21, G54 | with G20, G54 | without a frame |
//! |---|---|---|---|
//! | place | X312.4 of G54 | X12.2992 of G54 | 312.4 mm (machine coordinate) |
//! | length | 62.4 mm | 2.4567 in | 62.4 mm |
//! | feed | 600 mm/min | 23.62 in/min | 600 mm/min |
//!
//! A place is where something is or would be. Advice is what to write instead: under G91, and in U,
//! V and W of a Fanuc lathe, that is a way from where the block begins.
//!
//! Under a rotation of the work offset X and Y have no words of their own: machine coordinates are
//! said.
use crate::findings::number;
use alloc::{format, string::String};
use canon::{Axis, LengthUnit, Position, ProgramFrame};
use core::ops::Deref;
use diag::RemedyWord;

/// How a block is written, and from where its incremental words count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WrittenFrame {
    pub(crate) written: ProgramFrame,
    /// Where the axes stand before the block, machine coordinates.
    pub(crate) from: Position,
}

impl Deref for WrittenFrame {
    type Target = ProgramFrame;

    fn deref(&self) -> &ProgramFrame {
        &self.written
    }
}

/// Which way a number may be rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rounding {
    /// To the nearest.
    Nearest,
    /// Towards higher machine coordinates.
    Up,
    /// Towards lower ones.
    Down,
}

impl Rounding {
    /// `value` in steps of the unit that is printed.
    fn of(self, value: f64, steps: f64) -> f64 {
        // a thousandth of a step is the noise of converting there and back
        match self {
            Self::Nearest => value,
            Self::Up => libm::ceil(value * steps - 1e-3) / steps,
            Self::Down => libm::floor(value * steps + 1e-3) / steps,
        }
    }
}

/// One inch over one millimetre: what F, K or Z is off by where G20 and G21 are mixed up.
const INCH: f64 = units::MM_PER_INCH;

/// Relative error within which a ratio is taken for that of inches to millimetres.
const LIKE_INCHES: f64 = 0.03;

/// What to ask where a number is off by the ratio of inches to millimetres.
pub(crate) const WHICH_UNIT: &str =
    "the numbers differ by 25.4: is this block in inches (G20) or in millimetres (G21)?";

/// Whether one number is the other in the other unit.
pub(crate) fn is_other_unit(found: f64, expected: f64) -> bool {
    let ratio = (found / expected).abs();
    let near = |wanted: f64| (ratio / wanted - 1.0).abs() < LIKE_INCHES;
    near(INCH) || near(1.0 / INCH)
}

/// A number in the program's unit: three decimals of a millimetre, four of an inch.
fn in_unit(frame: &ProgramFrame, value: f64) -> String {
    frame.unit.number(value)
}

/// A coordinate as the program writes it, such as `X312.4`; machine coordinates where it cannot
/// write it.
pub(crate) fn word(frame: &ProgramFrame, axis: Axis, machine: f64) -> String {
    let value = match frame.written(axis, machine) {
        Some(value) if is_rotary(axis) => number(value),
        Some(value) => in_unit(frame, value),
        None => number(machine),
    };
    format!("{}{value}", axis.letter())
}

/// A coordinate that works, in the word that the program would write: rounded into what works.
pub(crate) fn advice(frame: &WrittenFrame, axis: Axis, machine: f64, rounding: Rounding) -> String {
    let Advised { letter, number, is_way } = advised(frame, axis, machine, rounding);
    let way = if is_way { " (incremental)" } else { "" };
    format!("{letter}{number}{way}")
}

/// A word to write.
pub(crate) struct Advised {
    pub(crate) letter: char,
    pub(crate) number: String,
    /// It is a way from where the block begins.
    is_way: bool,
}

/// The same, as letter and number.
pub(crate) fn advised(
    frame: &WrittenFrame,
    axis: Axis,
    machine: f64,
    rounding: Rounding,
) -> Advised {
    let inches = frame.unit == LengthUnit::Inch && !is_rotary(axis);
    let steps = if inches { 1e4 } else { 1e3 };
    let said = |letter: char, value: f64| {
        let value = rounding.of(value, steps);
        let number = if inches { in_unit(frame, value) } else { number(value) };
        Advised { letter, number, is_way: false }
    };
    let from = match axis {
        Axis::A | Axis::B | Axis::C => frame.from.rotary[axis.index() - 3].in_deg(),
        _ => frame.from.along(axis).value(),
    };
    if let Some((letter, way)) = frame.increment(axis, machine - from) {
        return Advised { is_way: true, ..said(letter, way) };
    }
    said(axis.letter(), frame.written(axis, machine).unwrap_or(machine))
}

/// A word instead of the one that says what does not work.
pub(crate) fn instead(works: Advised, found: Advised) -> RemedyWord {
    let Advised { letter, number, .. } = works;
    RemedyWord { letter, number, instead_of: Some(found.number), with: "" }
}

/// Words that stay in force: letter, number, and the code with which it is meant.
pub(crate) fn modal<const N: usize>(
    words: [(char, String, &'static str); N],
) -> alloc::vec::Vec<RemedyWord> {
    let word = |(letter, number, with)| RemedyWord { letter, number, instead_of: None, with };
    words.into_iter().map(word).collect()
}

/// A coordinate with the work offset in which it is written.
pub(crate) fn place(frame: &ProgramFrame, axis: Axis, machine: f64) -> String {
    match frame.work_offset_code() {
        Some(code) if frame.written(axis, machine).is_some() => {
            let diameter =
                if axis == Axis::X && frame.x_is_diameter { " (a diameter)" } else { "" };
            format!("{} of {code}{diameter}", word(frame, axis, machine))
        }
        None if !is_rotary(axis) => {
            let value = frame.written(axis, machine).unwrap_or(machine);
            let diameter = if axis == Axis::X && frame.x_is_diameter { "a diameter, " } else { "" };
            let unit = frame.unit.symbol();
            format!("{} {unit} ({diameter}machine coordinate)", in_unit(frame, value))
        }
        _ => {
            let unit = axis.kind().unit();
            format!("{}{unit} (machine coordinate)", number(machine))
        }
    }
}

/// A length and its unit.
pub(crate) fn length(frame: &ProgramFrame, mm: f64) -> String {
    format!("{} {}", bare_length(frame, mm), frame.unit.symbol())
}

/// A length and its unit, rounded up: no less works.
pub(crate) fn length_at_least(frame: &ProgramFrame, mm: f64) -> String {
    let steps = if frame.unit == LengthUnit::Inch { 1e4 } else { 1e3 };
    let value = Rounding::Up.of(mm / frame.unit.in_mm(), steps);
    format!("{} {}", in_unit(frame, value), frame.unit.symbol())
}

/// A length in the program's unit, as after a letter.
pub(crate) fn bare_length(frame: &ProgramFrame, mm: f64) -> String {
    in_unit(frame, mm / frame.unit.in_mm())
}

/// A feed and its unit, from mm/min.
pub(crate) fn feed(frame: &ProgramFrame, mm_per_min: f64) -> String {
    format!("{} {}/min", bare_length(frame, mm_per_min), frame.unit.symbol())
}

/// A feed that still works, rounded down: whole mm/min, hundredths of an in/min.
pub(crate) fn feed_that_works(frame: &ProgramFrame, mm_per_min: f64) -> String {
    let steps = match frame.unit {
        LengthUnit::Millimetre => 1.0,
        LengthUnit::Inch => 100.0,
    };
    let value = libm::floor(mm_per_min / frame.unit.in_mm() * steps + 1e-6) / steps;
    in_unit(frame, value)
}

/// A length that still works, mm, rounded down as it is said: to thousandths of a millimetre, to
/// ten-thousandths of an inch.
pub(crate) fn floor_in_unit(frame: &ProgramFrame, mm: f64) -> f64 {
    let steps = if frame.unit == LengthUnit::Inch { 1e4 } else { 1e3 };
    libm::floor(mm / frame.unit.in_mm() * steps) / steps * frame.unit.in_mm()
}

/// Whether an axis turns.
pub(crate) const fn is_rotary(axis: Axis) -> bool {
    matches!(axis.kind(), units::AxisKind::Rotary)
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::Counting;

    #[test]
    fn a_place_is_said_in_the_frame_and_unit_of_the_block() {
        let origin = Position::xyz(-100.0, 0.0, 0.0);
        let mut frame = ProgramFrame { work_offset: 1, origin, ..ProgramFrame::default() };
        assert_eq!(place(&frame, Axis::X, 150.0), "X250 of G54");
        frame.unit = LengthUnit::Inch;
        assert_eq!(place(&frame, Axis::X, 154.0), "X10 of G54");
        assert_eq!(length(&frame, 1.27), "0.05 in");
        assert_eq!(feed(&frame, 2540.0), "100 in/min");
        frame.x_is_diameter = true;
        assert_eq!(place(&frame, Axis::X, -87.3), "X1 of G54 (a diameter)");
        assert_eq!(place(&ProgramFrame::default(), Axis::X, 1.5), "1.5 mm (machine coordinate)");
    }

    #[test]
    fn a_coordinate_that_works_is_rounded_into_what_works() {
        let frame =
            ProgramFrame { work_offset: 1, unit: LengthUnit::Inch, ..ProgramFrame::default() };
        for limit in [250.0, 199.9, 123.456, -250.0, -199.9] {
            let inward = if limit > 0.0 { -1.0 } else { 1.0 };
            let rounding = if inward > 0.0 { Rounding::Up } else { Rounding::Down };
            let frame = WrittenFrame { written: frame, ..WrittenFrame::default() };
            let text = advice(&frame, Axis::X, limit, rounding);
            let inches: f64 = text[1..].parse().unwrap_or(f64::NAN);
            let beyond = (inches * units::MM_PER_INCH - limit) * -inward;
            assert!((-0.003..=1e-6).contains(&beyond), "{text} for {limit}");
        }
    }

    #[test]
    fn advice_to_an_incremental_block_is_a_way_from_where_it_begins() {
        let written = ProgramFrame {
            work_offset: 1,
            counting: Counting::Incremental,
            ..ProgramFrame::default()
        };
        let mut frame = WrittenFrame { written, from: Position::xyz(0.0, 0.0, 50.0) };
        assert_eq!(advice(&frame, Axis::Z, 2.0, Rounding::Up), "Z-48 (incremental)");
        frame.written.unit = LengthUnit::Inch;
        assert_eq!(advice(&frame, Axis::Z, 2.0, Rounding::Up), "Z-1.8897 (incremental)");
        frame.written = ProgramFrame {
            work_offset: 1,
            counting: Counting::IncrementalLetters,
            x_is_diameter: true,
            ..ProgramFrame::default()
        };
        assert_eq!(advice(&frame, Axis::X, 12.0, Rounding::Up), "U24 (incremental)");
    }

    #[test]
    fn the_ratio_of_inches_to_millimetres_is_known_both_ways() {
        assert!(is_other_unit(1.27, 0.05) && is_other_unit(0.05, 1.27));
        assert!(!is_other_unit(1.25, 1.0) && !is_other_unit(20.0, 1.0));
    }
}
