//! LinuxCNC's tool table: a tool a line, words in any order, a comment after a semicolon.
//!
//! ```text
//!   T3 P3 Z+105.25 D6 ;M6x1 tap
//!   │  │  │        │   └ what it is, see `comment`
//!   │  │  │        └ diameter
//!   │  │  └ length offset; offsets of other axes (X Y A B C U V W) have no effect here
//!   │  └ pocket
//!   └ number              I J Q (angles and orientation of a turning tool) have no effect either
//! ```
//!
//! Lengths are in the machine's unit, which the table does not state: who reads it says it. A
//! diameter that is what the comment says in inches, in a table that is read in millimetres, is
//! remarked upon.
//!
//! | code | what was found |
//! |---|---|
//! | S0501 | a word that cannot be read |
//! | S0502 | a word that comes twice, or a tool that does |
//! | S0503 | a line without T |
//! | S0504 | a number out of bounds |
//! | S0505 | the table of LinuxCNC before 2.4 |
//! | S0506 | words without effect (warning) |
//! | S0507 | a tap whose thread is not named (warning) |
//! | S0508 | a table in inches that is read in millimetres (warning) |
use super::{LONGEST, MOST_TOOLS, ToolTable, comment, without_doubles};
use crate::text::{Lines, in_order};
use canon::{Insert, InsertEdges, InsertPoint, PolygonCutter, Tool, ToolKind};
use diag::{Diagnostic, Span};
use std::ops::Range;
use units::{Length, MM_PER_INCH};

/// Unit of a table's lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableUnit {
    /// mm.
    Millimetre,
    /// in.
    Inch,
}

impl TableUnit {
    const fn length(self, value: f64) -> Length {
        match self {
            Self::Millimetre => Length::mm(value),
            Self::Inch => Length::mm(value * MM_PER_INCH),
        }
    }
}

pub(super) fn parse(text: &str, file: u16, unit: TableUnit) -> Result<ToolTable, Vec<Diagnostic>> {
    let mut reader = Reader { lines: Lines::of(text, file), unit, findings: Vec::new() };
    let mut tools = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if line.trim_start().starts_with("TOOLNO") || line.trim_start().starts_with("POCKET") {
            let message = "this is the table of LinuxCNC before 2.4: expected lines such as `T1 P1 Z100 D6 ;drill`";
            let finding = Diagnostic::error("S0505", reader.span(start, line.trim_end()), message);
            return Err(vec![finding]);
        }
        if tools.len() == MOST_TOOLS {
            let message = format!("the table has more than {MOST_TOOLS} tools");
            reader.refuse("S0504", reader.span(start, line.trim_end()), message);
            break;
        }
        tools.extend(reader.line(start, line));
        start += line.len();
    }
    let Reader { mut findings, .. } = reader;
    let lines = tools.iter().map(|(tool, place)| (tool.number, place.line)).collect();
    let library = without_doubles(tools, "S0502").unwrap_or_else(|doubles| {
        findings.extend(doubles);
        canon::ToolLibrary::default()
    });
    if findings.iter().any(Diagnostic::is_error) {
        return Err(in_order(findings));
    }
    Ok(ToolTable { library, remarks: in_order(findings), lines })
}

/// A line to write; lengths in mm, angles in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct TableLine {
    /// Number of the tool.
    pub number: u32,
    /// Pocket in the magazine.
    pub pocket: u32,
    /// Offsets along X Y Z A B C U V W.
    pub offset: [f64; 9],
    /// Diameter.
    pub diameter_mm: f64,
    /// Front and back angle of a turning tool.
    pub angles_deg: [f64; 2],
    /// Orientation of a turning tool.
    pub orientation: u32,
    /// What the tool is.
    pub remark: String,
}

/// The text of a table, which LinuxCNC reads too. Words that are zero are left out, but for Z and
/// D.
pub fn to_tbl(lines: &[TableLine]) -> String {
    let mut text = String::new();
    for line in lines {
        let [x, y, z, a, b, c, u, v, w] = line.offset;
        let [front, back] = line.angles_deg;
        let turning = f64::from(line.orientation);
        let words =
            [('X', x), ('Y', y), ('Z', z), ('A', a), ('B', b), ('C', c), ('U', u), ('V', v)];
        let more = [('W', w), ('D', line.diameter_mm), ('I', front), ('J', back), ('Q', turning)];
        text += &format!("T{} P{}", line.number, line.pocket);
        for (letter, value) in words.into_iter().chain(more) {
            if value != 0.0 || matches!(letter, 'Z' | 'D') {
                text += &format!(" {letter}{value}");
            }
        }
        let remark = line.remark.replace(['\n', '\r'], " ");
        text += &format!(" ;{remark}\n");
    }
    text
}

struct Reader {
    lines: Lines,
    unit: TableUnit,
    findings: Vec<Diagnostic>,
}

/// Letters of a line, and their numbers.
type Words = [Option<f64>; 26];

impl Reader {
    fn span(&self, start: usize, text: &str) -> Span {
        self.lines.span(&Range { start, end: start + text.len() })
    }

    fn refuse(&mut self, code: &'static str, place: Span, message: impl Into<String>) {
        self.findings.push(Diagnostic::error(code, place, message));
    }

    /// One line; `start` is the offset of its first byte.
    fn line(&mut self, start: usize, line: &str) -> Option<(Tool, Span)> {
        let (words, remark) = line.split_once(';').unwrap_or((line, ""));
        if words.trim().is_empty() {
            return None;
        }
        let place = self.span(start + words.len() - words.trim_start().len(), words.trim());
        let before = self.findings.len();
        let words = self.words(start, words);
        if self.findings.len() > before {
            return None;
        }
        self.tool(&words, remark.trim(), place).map(|tool| (tool, place))
    }

    fn words(&mut self, start: usize, text: &str) -> Words {
        let mut words = [None; 26];
        let mut rest = text;
        while let Some(at) = rest.find(|c: char| !c.is_whitespace()) {
            let word = &rest[at..];
            let word = &word[..word.find(char::is_whitespace).unwrap_or(word.len())];
            let place = self.span(start + (text.len() - rest.len()) + at, word);
            rest = &rest[at + word.len()..];
            match letter_and_number(word) {
                None => self.refuse(
                    "S0501",
                    place,
                    format!("expected a letter and a number such as T1 or Z100.5, found `{word}`"),
                ),
                Some((letter, _)) if words[letter].is_some() => {
                    let letter = char::from(b'A' + letter as u8);
                    self.refuse("S0502", place, format!("{letter} comes twice in this line"));
                }
                Some((letter, number)) => words[letter] = Some(number),
            }
        }
        words
    }

    fn tool(&mut self, words: &Words, remark: &str, place: Span) -> Option<Tool> {
        let word = |letter: u8| words[usize::from(letter - b'A')];
        let Some(number) = word(b'T') else {
            self.refuse("S0503", place, "expected the tool's number T in this line");
            return None;
        };
        let before = self.findings.len();
        let number = self.whole('T', number, place)?;
        if number == 0 {
            return None; // T0 is the empty spindle: some tables list it
        }
        let pocket = word(b'P').map_or(Some(number), |p| self.whole('P', p, place))?;
        let length = self.length('Z', word(b'Z'), -LONGEST, place);
        let diameter = self.length('D', word(b'D'), Length::ZERO, place);
        if self.findings.len() > before {
            return None;
        }
        self.warn_of_words_without_effect(words, place);
        let understood = comment::understand(remark);
        if understood.thread_missing {
            let message = "the comment says tap and no thread: \"M6 tap\" or \"1/4-20 UNC tap\" would be understood";
            self.findings.push(Diagnostic::warning("S0507", place, message));
        }
        if self.unit == TableUnit::Millimetre && comment::is_in_inches(remark, diameter.value()) {
            let message = format!(
                "D{} is the diameter of \"{remark}\" in inches, and the table is read in millimetres: --tool-unit inch reads it in inches",
                diameter.value()
            );
            self.findings.push(Diagnostic::warning("S0508", place, message));
        }
        let kind = match understood.kind {
            ToolKind::PolygonCutter(cutter) => {
                ToolKind::PolygonCutter(PolygonCutter { radius: diameter / 2.0, ..cutter })
            }
            // of a lathe's tool D is twice its nose radius
            ToolKind::Insert(insert)
                if diameter > Length::ZERO && insert.edges != InsertEdges::Square =>
            {
                ToolKind::Insert(Insert {
                    point: Some(InsertPoint::Nose(diameter / 2.0)),
                    ..insert
                })
            }
            kind => kind,
        };
        let stated = Some(diameter).filter(|d| *d > Length::ZERO);
        let is_insert = matches!(kind, ToolKind::Insert(_)); // a length in its comment is its width
        Some(Tool {
            number,
            pocket,
            length,
            diameter: stated.or(understood.diameter.filter(|_| !is_insert)).unwrap_or(Length::ZERO),
            kind,
            description: remark.to_owned(),
            wear: canon::ToolWear::default(),
            life: canon::ToolLife::default(),
            body: canon::Body::default(),
            stand_in: false,
        })
    }

    fn whole(&mut self, letter: char, number: f64, place: Span) -> Option<u32> {
        let fits = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
        if !fits {
            let most = u32::MAX;
            let message = format!("{letter} is {number}: expected a whole number from 0 to {most}");
            self.refuse("S0504", place, message);
        }
        fits.then_some(number as u32)
    }

    fn length(&mut self, letter: char, number: Option<f64>, least: Length, place: Span) -> Length {
        let length = number.map_or(Length::ZERO, |n| self.unit.length(n));
        if !(least..=LONGEST).contains(&length) {
            let (low, high) = (least.value(), LONGEST.value());
            let message = format!("{letter} is {}: expected {low} to {high} mm", length.value());
            self.refuse("S0504", place, message);
        }
        length
    }

    fn warn_of_words_without_effect(&mut self, words: &Words, place: Span) {
        let idle = (b'A'..=b'Z').filter(|letter| !b"TPZD".contains(letter));
        let idle =
            idle.filter(|letter| words[usize::from(letter - b'A')].is_some_and(|n| n != 0.0));
        let names = idle.map(|letter| char::from(letter).to_string()).collect::<Vec<_>>();
        if !names.is_empty() {
            let message =
                format!("without effect: {}; only T, P, Z and D are used", names.join(", "));
            self.findings.push(Diagnostic::warning("S0506", place, message));
        }
    }
}

/// `Z+105.25` is (25, 105.25).
fn letter_and_number(word: &str) -> Option<(usize, f64)> {
    const LETTERS: &[u8] = b"TPDXYZABCUVWIJQ";
    let letter = word.bytes().next()?.to_ascii_uppercase();
    let number = word.get(1..)?;
    let plain = number.bytes().all(|b| b.is_ascii_digit() || b"+-.".contains(&b));
    let number = number.parse::<f64>().ok().filter(|n| plain && n.is_finite())?;
    LETTERS.contains(&letter).then(|| (usize::from(letter - b'A'), number))
}
