//! Numbers without a point that make no sense as they are read: thousandths where whole millimetres
//! are meant, or the other way round.
//!
//! ```text
//!   G0 X50 Y-30        read as increments: 0.05 mm, -0.03 mm     and nothing in the program is larger: whole units are meant
//!   G0 X50000 Y-30000  read as whole units: 50 m                 beyond any machine: increments are meant
//! ```
//!
//! Only Fanuc's controls and their variants count so. Read are the first lines, letters alone, as
//! for [`other_dialect`](crate::evidence::other_dialect).
use crate::{
    evidence::line::{BYTES, LINES, SplitLine},
    setup::Setup,
};
use diag::{Diagnostic, Span};

/// Axis words without a point have to be so many before anything is said of them.
const LEAST_WORDS: usize = 4;
/// Nothing larger than this, mm: no part is so small, nor its clearances.
const SMALL_MM: f64 = 1.0;
/// No machine is larger than this, mm.
const LARGE_MM: f64 = 10_000.0;

/// What axis words without a point come to.
struct Lengths {
    /// How many there are, and how many have a point.
    words: usize,
    with_point: usize,
    /// The largest: as written, its line, its number.
    largest: (String, Span, f64),
    inch: bool,
}

/// Why a program's numbers without a point look like whole units, if they do.
pub fn counts_whole_units(source: &[u8], setup: &Setup) -> Option<String> {
    let lengths = lengths(source)?;
    let mm = lengths.as_increments(setup);
    (mm < SMALL_MM).then(|| lengths.reason(mm))
}

/// What is said of a program whose numbers without a point make no sense as they are read.
pub(crate) fn meant_otherwise(source: &[u8], setup: &Setup) -> Option<Diagnostic> {
    if setup.dialect.grammar() != gcode::Grammar::Fanuc {
        return None;
    }
    let lengths = lengths(source)?;
    let (mm, other) = if setup.whole_units_without_point {
        let unit = if lengths.inch { units::MM_PER_INCH } else { 1.0 };
        (lengths.largest.2 * unit, "increments")
    } else {
        (lengths.as_increments(setup), "calculator")
    };
    let is_odd = if setup.whole_units_without_point { mm > LARGE_MM } else { mm < SMALL_MM };
    if !is_odd {
        return None;
    }
    let text =
        format!("numbers without a point seem to be meant otherwise: {}", lengths.reason(mm));
    let help = format!(
        "--decimal-point {other} reads them the other way, as decimal_point = \"{other}\" under [control.fanuc] of the \
         machine's file does"
    );
    Some(Diagnostic::warning("I1068", lengths.largest.1, text).with_help(help))
}

impl Lengths {
    /// The largest in mm, as so many least input increments.
    fn as_increments(&self, setup: &Setup) -> f64 {
        let per_unit = setup.increments.per_unit();
        let inch = units::MM_PER_INCH / 10.0;
        self.largest.2 / per_unit * if self.inch { inch } else { 1.0 }
    }

    fn reason(&self, mm: f64) -> String {
        let (words, all) = (self.words, self.words + self.with_point);
        let (written, line) = (&self.largest.0, self.largest.1.line);
        let mm = crate::codes::spelling::short(mm);
        format!(
            "{words} of {all} axis words have none, and the largest of them, {written} in line {line}, is {mm} mm"
        )
    }
}

/// Those of the first lines; none, if they are few, or fewer than those with a point.
fn lengths(source: &[u8]) -> Option<Lengths> {
    let mut all = Lengths {
        words: 0,
        with_point: 0,
        largest: (String::new(), Span::default(), 0.0),
        inch: false,
    };
    let mut start = 0_u32;
    for (number, text) in source.split(|byte| *byte == b'\n').take(LINES).enumerate() {
        if start > BYTES {
            break;
        }
        let line =
            SplitLine::read(text, Span { file: 0, line: number as u32 + 1, start, end: start });
        start += text.len() as u32 + 1;
        let code = |tenths: &[f64]| {
            let is_one = |(letter, number, _): &(char, String, Span)| {
                *letter == 'G' && number.parse().is_ok_and(|number: f64| tenths.contains(&number))
            };
            line.words.iter().any(is_one)
        };
        all.inch |= code(&[20.0, 70.0]) && !line.has("PQ");
        if code(&[4.0, 10.0, 65.0, 66.0]) || line.code.contains('#') {
            continue;
        }
        for (letter, number, span) in &line.words {
            let Ok(value) = number.parse::<f64>() else { continue };
            if !"XYZUVW".contains(*letter) || value == 0.0 {
                continue;
            }
            if number.contains('.') {
                all.with_point += 1;
                continue;
            }
            all.words += 1;
            if value.abs() > all.largest.2 {
                all.largest = (format!("{letter}{number}"), *span, value.abs());
            }
        }
    }
    (all.words >= LEAST_WORDS && all.words > all.with_point).then_some(all)
}
