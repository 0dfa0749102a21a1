//! A program for another kind of machine than a mill: a printer, a lathe. Its letters alone tell.
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
