//! Places and lengths as the program writes them, and what findings of two crates say in the same
//! words: those before motion, and those of the judge.
//!
//! ```text
//!   the rapid in line 12 takes T1 (an end mill) 5 mm into the stock at X10 Y20 Z-5 of G54
//! ```
use crate::{Axis, LengthUnit, ProgramFrame, Tool, ToolKind};
use alloc::{format, string::String};
use core::fmt::{self, Display};
use units::Length;

/// Values from here on have an exponent.
const LARGE: f64 = 1e9;

/// A number for people: so many decimals at most, no zeros at the end.
fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// A number for people: three decimals at most, no zeros at the end.
pub fn number(value: f64) -> String {
    if value.abs() >= LARGE { format!("{value:e}") } else { rounded(value, 3) }
}

impl LengthUnit {
    /// A number in this unit: three decimals of a millimetre, four of an inch.
    pub fn number(self, value: f64) -> String {
        match self {
            Self::Millimetre => number(value),
            Self::Inch => rounded(value, 4),
        }
    }
}

/// Where X, Y and Z stand, as a program writes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WrittenPlace {
    /// In `unit`.
    at: [f64; 3],
    unit: LengthUnit,
    /// The work offset; `None`: machine coordinates.
    code: Option<&'static str>,
}

impl WrittenPlace {
    /// A length in the same unit, with its symbol.
    pub fn length(&self, length: Length) -> String {
        let value = length.value() / self.unit.in_mm();
        format!("{} {}", self.unit.number(value), self.unit.symbol())
    }
}

impl Display for WrittenPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at.map(|value| self.unit.number(value));
        match self.code {
            Some(code) => write!(f, "X{x} Y{y} Z{z} of {code}"),
            None => write!(f, "X{x} Y{y} Z{z} {} (machine coordinates)", self.unit.symbol()),
        }
    }
}

impl ProgramFrame {
    /// Where X, Y and Z of the machine stand, in the words of the program: `X10 Y20 Z-5 of G54`;
    /// machine coordinates where it has no words for it.
    pub fn place(&self, axes: [Length; 3]) -> WrittenPlace {
        let [x, y, z] = [0, 1, 2].map(|i| self.written(Axis::ALL[i], axes[i].value()));
        let unit = self.unit;
        match (x, y, z, self.work_offset_code()) {
            (Some(x), Some(y), Some(z), code @ Some(_)) => {
                WrittenPlace { at: [x, y, z], unit, code }
            }
            _ => WrittenPlace { at: axes.map(|at| self.length(at)), unit, code: None },
        }
    }
}

impl Tool {
    /// Such as "a drill".
    pub const fn kind_name(&self) -> &'static str {
        match self.kind {
            ToolKind::Drill { .. } => "a drill",
            ToolKind::SpotDrill { .. } => "a spot drill",
            ToolKind::EndMill(_) => "an end mill",
            ToolKind::Tap(_) => "a tap",
            ToolKind::PolygonCutter(_) => "a polygon cutter",
            ToolKind::Insert(_) => "an insert of a lathe",
            ToolKind::Hob(_) => "a hob",
            ToolKind::Probe(_) => "a touch probe",
            ToolKind::Other if self.stand_in => "a stand-in that the table does not describe",
            ToolKind::Other => "another tool",
        }
    }

    /// Its number and what it is: "T3 (a tap)".
    pub fn name(&self) -> String {
        format!("T{} ({})", self.number, self.kind_name())
    }
}

/// A rapid that takes a tool into the stock; its text is a clause.
#[derive(Clone, Copy, Debug)]
pub struct RapidIntoStock<'a> {
    /// Where it is then.
    pub place: WrittenPlace,
    /// Line of the rapid, where the finding does not show it.
    pub line: Option<u32>,
    /// The tool.
    pub tool: &'a Tool,
    /// How deep it is in what stands there.
    pub depth: Length,
}

impl Display for RapidIntoStock<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line.map_or_else(String::new, |line| format!(" in line {line}"));
        let (tool, depth, place) = (self.tool.name(), self.place.length(self.depth), self.place);
        write!(f, "the rapid{line} takes {tool} {depth} into the stock at {place}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Position;
    use alloc::string::ToString;
    use units::Angle;

    #[test]
    fn a_place_is_said_in_the_programs_frame_or_in_the_machines() {
        let origin = Position::xyz(-100.0, 0.0, 40.0);
        let mut frame = ProgramFrame { work_offset: 2, origin, ..ProgramFrame::default() };
        let axes = [-87.3, 10.0, 35.0].map(Length::mm);
        assert_eq!(frame.place(axes).to_string(), "X12.7 Y10 Z-5 of G55");
        assert_eq!(frame.place(axes).length(Length::mm(0.8)), "0.8 mm");
        frame.unit = LengthUnit::Inch;
        assert_eq!(frame.place(axes).to_string(), "X0.5 Y0.3937 Z-0.1969 of G55");
        assert_eq!(frame.place(axes).length(Length::mm(0.8)), "0.0315 in");
        frame.rotation = Angle::deg(5.0);
        let machine = "X-3.437 Y0.3937 Z1.378 in (machine coordinates)";
        assert_eq!(frame.place(axes).to_string(), machine);
    }

    #[test]
    fn numbers_have_no_zeros_at_the_end_and_no_negative_zero() {
        assert_eq!(number(1.2004), "1.2");
        assert_eq!(number(-0.000_01), "0");
        assert_eq!(number(2e9), "2e9");
        assert_eq!(rounded(120.0, 0), "120");
    }
}
