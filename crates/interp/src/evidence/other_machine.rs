//! A program for another kind of machine than a mill: a printer, a lathe, a machine for gears,
//! polygons or cams. Its letters alone tell.
use crate::evidence::line::{BYTES, LINES, SplitLine};
use diag::{Diagnostic, Span};

/// What a program for a 3D printer has, and no machine tool.
const PRINTERS: [(&str, &str); 8] = [
    ("M105", "the temperature is asked for"),
    ("M108", "how fast filament comes"),
    ("M104", "the temperature of the nozzle"),
    ("M109", "the temperature of the nozzle"),
    ("M140", "the temperature of the bed"),
    ("M190", "the temperature of the bed"),
    ("M82", "how filament is counted"),
    ("M83", "how filament is counted"),
];

/// E of a move.
const FILAMENT: &str = "filament on a move";

/// Bytes at the end in which a program's end is looked for.
const TAIL: usize = 4096;

/// A program for a 3D printer: one sentence, in the place of all that would follow.
pub(crate) fn printer(source: &[u8]) -> Option<Diagnostic> {
    let (mut start, mut seen) = (0_u32, Vec::<(&str, String, Span)>::new());
    for (number, text) in source.split(|byte| *byte == b'\n').take(LINES).enumerate() {
        if start > BYTES {
            break;
        }
        let line =
            SplitLine::read(text, Span { file: 0, line: number as u32 + 1, start, end: start });
        start += text.len() as u32 + 1;
        let mut add = |what: &'static str, written: String, span| {
            if seen.iter().all(|(known, ..)| *known != what) {
                seen.push((what, written, span));
            }
        };
        for (letter, number, span) in &line.words {
            let written = format!("{letter}{number}");
            if let Some((_, what)) = PRINTERS.iter().find(|(code, _)| *code == written) {
                add(what, written, *span);
            } else if *letter == 'E'
                && line
                    .number('G')
                    .is_some_and(|(g, _)| matches!(g.trim_start_matches('0'), "" | "1"))
            {
                add(FILAMENT, written, *span);
            }
        }
    }
    // builders of machine tools have M codes of these numbers as well: filament decides
    if seen.len() < 2 || seen.iter().all(|(what, ..)| *what != FILAMENT) {
        return None;
    }
    let (_, _, span) = seen[0];
    let named: Vec<_> = seen
        .iter()
        .map(|(what, written, span)| format!("{what} ({written} in line {})", span.line))
        .collect();
    let text = format!("this is a program for a 3D printer: {}", named.join(", "));
    Some(
        Diagnostic::error("I0910", span, text)
            .with_help("Leadscrew leads machines that cut; what else stands in it was not read"),
    )
}

/// Whether a program turns: it never names Y, and has a code of lathes, or an arc in the plane of X
/// and Z.
pub fn is_turned(source: &[u8]) -> bool {
    let mut turns = false;
    for text in source[..source.len().min(BYTES as usize)].split(|byte| *byte == b'\n') {
        let line = SplitLine::read(text, Span::default());
        if line.has("Y") {
            return false;
        }
        turns |= line.has("XZIK");
        turns |= line.words.iter().any(|(letter, number, _)| {
            *letter == 'G' && matches!(number.parse(), Ok(7.0 | 8.0 | 18.0 | 33.0 | 76.0 | 96.0))
        });
    }
    turns
}

/// Work that takes a machine made for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpecialWork {
    /// A gear, by a hob.
    Gear,
    /// A polygon, by a cutter that turns with the work.
    Polygon,
    /// A cam, by a grinding wheel.
    Cam,
}

/// Finds the words of such work: a hob's G81, G51.2 and G251, G151 and Toyoda's sampling.
pub fn special_work(source: &[u8]) -> Option<SpecialWork> {
    lines(source).find_map(|line| {
        line.words.iter().filter(|(letter, ..)| *letter == 'G').find_map(|(_, number, _)| {
            match (number.parse::<f64>().ok()? * 10.0).round() as i32 {
                810 if line.has("TL") => Some(SpecialWork::Gear),
                512 | 2510 if line.has("PQ") => Some(SpecialWork::Polygon),
                1510 if line.has("P") => Some(SpecialWork::Cam),
                530 if line.code.matches('G').count() == 2 && line.has("SP") => {
                    Some(SpecialWork::Cam)
                }
                _ => None,
            }
        })
    })
}

/// G codes, in tenths, that Grbl and its kin have, with the drilling cycles and the compensations
/// of Mach3's posts.
const OF_SENDERS: [i32; 56] = [
    0, 10, 20, 30, 40, 100, 170, 180, 190, 200, 210, 280, 281, 300, 301, 310, 382, 383, 384, 385,
    400, 410, 420, 430, 431, 490, 500, 510, 520, 530, 540, 550, 560, 570, 580, 590, 610, 640, 730,
    800, 810, 820, 830, 850, 860, 890, 900, 901, 910, 911, 920, 921, 930, 940, 980, 990,
];

/// True if a text has nothing but what Grbl and its kin read: no codes of other controls, no
/// parameters, no O-words.
pub fn is_for_a_sender(source: &[u8]) -> bool {
    lines(source).all(|line| {
        let is_known = |(letter, number, _): &(char, String, Span)| match number.parse::<f64>() {
            Ok(value) if *letter == 'G' => OF_SENDERS.contains(&((value * 10.0).round() as i32)),
            _ => *letter != 'O',
        };
        line.code.starts_with('$') || !line.code.contains('#') && line.words.iter().all(is_known)
    })
}

/// True if a text has a word of this letter and number.
pub fn has_word(source: &[u8], letter: char, value: f64) -> bool {
    let is_it = |(c, number, _): &(char, String, Span)| {
        *c == letter && number.parse::<f64>().is_ok_and(|number| number == value)
    };
    lines(source).any(|line| line.words.iter().any(is_it))
}

/// True if a text has a word of this letter.
pub(crate) fn has_letter(source: &[u8], letter: char) -> bool {
    lines(source)
        .any(|line| line.words.iter().any(|(c, number, _)| *c == letter && !number.is_empty()))
}

/// True if a text has lengths without a decimal point, which count increments on Fanuc's controls.
pub fn has_whole_lengths(source: &[u8]) -> bool {
    let is_whole = |(letter, number, _): &(char, String, Span)| {
        "XYZUVWIJKR".contains(*letter)
            && !number.contains('.')
            && number.parse::<f64>().is_ok_and(|number| number != 0.0)
    };
    lines(source).any(|line| line.words.iter().any(is_whole))
}

/// The first lines of a text.
fn lines(source: &[u8]) -> impl Iterator<Item = SplitLine> + '_ {
    let head = &source[..source.len().min(BYTES as usize)];
    head.split(|byte| *byte == b'\n').map(|text| SplitLine::read(text, Span::default()))
}

/// True if a text stops at rest, as a program does that is whole: its last words move rapidly, stop
/// the spindle or the coolant, or go home; one that was cut off mostly stops in a cut.
pub fn stops_at_rest(source: &[u8]) -> bool {
    let tail = &source[source.len().saturating_sub(TAIL)..];
    for text in tail.rsplit(|byte| *byte == b'\n') {
        let line = SplitLine::read(text, Span::default());
        for (letter, number, _) in line.words.iter().rev() {
            match (letter, number.parse::<f64>()) {
                ('M', Ok(5.0 | 9.0)) | ('G', Ok(0.0 | 28.0 | 30.0 | 53.0)) => return true,
                ('G', Ok(1.0 | 2.0 | 3.0 | 73.0 | 81.0..90.0)) => return false,
                _ => {}
            }
        }
    }
    false
}

/// The last line of a text that has neither M2 nor M30, M99 nor `%` in its last lines.
pub fn unended(source: &[u8]) -> Option<u32> {
    let tail = &source[source.len().saturating_sub(TAIL)..];
    let ends = tail.split(|byte| *byte == b'\n').any(|text| {
        let line = SplitLine::read(text, Span::default());
        let stops = |(letter, number, _): &(char, String, Span)| {
            *letter == 'M' && matches!(number.parse(), Ok(2.0 | 30.0 | 99.0))
        };
        line.code.contains('%') || line.words.iter().any(stops) || line.code.starts_with('O')
    });
    let last = source.iter().rposition(|byte| !byte.is_ascii_whitespace())?;
    let number = memchr::memchr_iter(b'\n', &source[..last]).count() as u32 + 1;
    (!ends).then_some(number)
}
