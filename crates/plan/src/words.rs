//! Places, lengths and feeds in the words of the program: its unit, its work offset, diameters where X counts so.
//!
//! | what | with G21, G54 | with G20, G54 | without a frame |
//! |---|---|---|---|
//! | place | X312.4 of G54 | X12.2992 of G54 | 312.4 mm (machine coordinate) |
//! | length | 62.4 mm | 2.4567 in | 62.4 mm |
//! | feed | 600 mm/min | 23.62 in/min | 600 mm/min |
//!
//! Under a rotation of the work offset X and Y have no words of their own: machine coordinates are said.
use crate::findings::number;
use alloc::{format, string::String};
use canon::{Axis, LengthUnit, ProgramFrame};

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
    match frame.unit {
        LengthUnit::Millimetre => number(value),
        LengthUnit::Inch => {
            let text = format!("{value:.4}");
            let text = text.trim_end_matches('0').trim_end_matches('.');
            if text == "-0" { "0".into() } else { text.into() }
        }
    }
}

/// A coordinate as the program writes it, such as `X312.4`; machine coordinates where it cannot write it.
pub(crate) fn word(frame: &ProgramFrame, axis: Axis, machine: f64) -> String {
    let value = match frame.written(axis, machine) {
        Some(value) if is_rotary(axis) => number(value),
        Some(value) if frame.work_offset != 0 => in_unit(frame, value),
        _ => number(machine),
    };
    format!("{}{value}", axis.letter())
}

/// A coordinate that works as the program writes it, rounded to the side of `inward`: that of a positive or a negative
/// number.
pub(crate) fn word_within(frame: &ProgramFrame, axis: Axis, machine: f64, inward: f64) -> String {
    let Some(value) = frame.written(axis, machine).filter(|_| frame.work_offset != 0) else {
        return format!("{}{}", axis.letter(), number(machine));
    };
    let steps = if frame.unit == LengthUnit::Inch && !is_rotary(axis) { 1e4 } else { 1e3 };
    let value = if inward > 0.0 {
        libm::ceil(value * steps - 1e-3) / steps
    } else {
        libm::floor(value * steps + 1e-3) / steps
    };
    let value = if is_rotary(axis) { number(value) } else { in_unit(frame, value) };
    format!("{}{value}", axis.letter())
}

/// A coordinate with the work offset in which it is written.
pub(crate) fn place(frame: &ProgramFrame, axis: Axis, machine: f64) -> String {
    match frame.work_offset_code() {
        Some(code) if frame.written(axis, machine).is_some() => {
            let diameter =
                if axis == Axis::X && frame.x_is_diameter { " (a diameter)" } else { "" };
            format!("{} of {code}{diameter}", word(frame, axis, machine))
        }
        _ => {
            let unit = if is_rotary(axis) { "°" } else { " mm" };
            format!("{}{unit} (machine coordinate)", number(machine))
        }
    }
}

/// A length and its unit.
pub(crate) fn length(frame: &ProgramFrame, mm: f64) -> String {
    format!("{} {}", bare_length(frame, mm), frame.unit.symbol())
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

/// Whether an axis turns.
pub(crate) const fn is_rotary(axis: Axis) -> bool {
    matches!(axis, Axis::A | Axis::B | Axis::C)
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::Position;

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
            let text = word_within(&frame, Axis::X, limit, inward);
            let inches: f64 = text[1..].parse().unwrap_or(f64::NAN);
            let beyond = (inches * units::MM_PER_INCH - limit) * -inward;
            assert!((-0.003..=1e-6).contains(&beyond), "{text} for {limit}");
        }
    }

    #[test]
    fn the_ratio_of_inches_to_millimetres_is_known_both_ways() {
        assert!(is_other_unit(1.27, 0.05) && is_other_unit(0.05, 1.27));
        assert!(!is_other_unit(1.25, 1.0) && !is_other_unit(20.0, 1.0));
    }
}
