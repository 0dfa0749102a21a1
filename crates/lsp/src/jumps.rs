//! Where Fanuc's jumps lead: the block N of a GOTO, the END of a DO, the DO of an END.
//!
//! A GOTO searches its own program, first behind its block, then from the program's begin.
use crate::document::Document;
use diag::Span;
use gcode::{Block, Control, Grammar, Parser, Value};

/// What the jump of a block leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// This block.
    Block(Span),
    /// The program has no block of this number.
    Missing(u32),
}

/// A block's jump.
#[derive(Clone, Copy, PartialEq)]
enum Jump {
    GoTo(u32),
    Loop,
}

/// Where the block at a byte of a line (from 0) leads, if it jumps to a place that is written in
/// it.
pub(crate) fn target(document: &Document, line: usize, byte: usize) -> Option<Target> {
    let text = &document.text;
    let (mut parser, mut block) = (Parser::with_grammar(text, 0, Grammar::Fanuc), Block::new());
    let mut jump = None;
    // N words of the program at hand: before the jump, and behind it
    let mut numbers: [Vec<(u32, Span)>; 2] = [Vec::new(), Vec::new()];
    let mut open: Vec<(u8, Span)> = Vec::new();
    while parser.next(&mut block) {
        if block.o.is_some() {
            if jump.is_some() {
                break;
            }
            numbers[0].clear();
            open.clear();
        }
        let span = block.span;
        let here = jump.is_none() && span.line as usize == line + 1 && byte <= span.end as usize;
        if let Some(number) = block.number {
            numbers[usize::from(jump.is_some())].push((number as u32, span));
        }
        match block.control {
            Some(Control::GoTo(to) | Control::IfGoTo { to, .. }) if here => {
                jump = Some((Jump::GoTo(plain(to)?), span));
            }
            Some(Control::While { level, .. }) => {
                if here {
                    jump = Some((Jump::Loop, span));
                }
                open.push((level, span));
            }
            Some(Control::End(level)) => {
                let (begun, begin) = open.pop()?;
                if here {
                    return (begun == level).then_some(Target::Block(begin));
                }
                if jump == Some((Jump::Loop, begin)) {
                    return (begun == level).then_some(Target::Block(span));
                }
            }
            _ if here => return None,
            _ => {}
        }
    }
    let (Jump::GoTo(number), _) = jump? else { return None };
    let [before, behind] = &numbers;
    let found = behind.iter().chain(before).find(|(known, _)| *known == number);
    Some(found.map_or(Target::Missing(number), |(_, span)| Target::Block(*span)))
}

/// A number that is written, not computed.
fn plain(value: Value) -> Option<u32> {
    match value {
        Value::Number(number) if number.fract() == 0.0 && (0.0..4e9).contains(&number) => {
            Some(number as u32)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lsp_types::PositionEncodingKind;

    fn leads(text: &str, line: usize, of: &str) -> Option<Target> {
        let document = Document::new(text.to_owned(), &PositionEncodingKind::UTF16);
        let (from, to) = document.line(line);
        let at = from + text[from..to].find(of).unwrap_or(0);
        target(&document, line, at)
    }

    fn line_of(target: Option<Target>) -> Option<u32> {
        match target {
            Some(Target::Block(span)) => Some(span.line),
            _ => None,
        }
    }

    #[test]
    fn goto_searches_behind_itself_and_then_from_the_begin_of_its_program() {
        let text = "O1\nN10 G0 X1.\nGOTO 20\nN20 X2.\nN10 X3.\nIF [#1 GT 0] GOTO 10\nGOTO 77\nM30\nO2\nN77 M99\nGOTO#1\n";
        assert_eq!(line_of(leads(text, 2, "GOTO")), Some(4));
        assert_eq!(line_of(leads(text, 5, "GOTO")), Some(2));
        assert_eq!(leads(text, 6, "GOTO"), Some(Target::Missing(77)));
        assert_eq!((leads(text, 10, "GOTO"), leads(text, 1, "G0")), (None, None));
    }

    #[test]
    fn do_and_end_lead_to_each_other() {
        let text = "O1\nWHILE [#1 LT 3] DO1\nDO2\nG0 X1.\nEND2\nEND1\nM30\n";
        let pairs = [(1, 6), (2, 5), (4, 3), (5, 2)];
        for (line, other) in pairs {
            assert_eq!(line_of(leads(text, line, "D")), Some(other), "{line}");
        }
        assert_eq!(leads("O1\nDO1\nEND2\nM30\n", 2, "END"), None);
        assert_eq!(leads("O1\nDO1\nM30\n", 1, "DO"), None);
        assert_eq!(leads("O1\nEND1\nM30\n", 1, "END"), None);
    }

    #[test]
    fn a_line_may_hold_several_blocks() {
        let text = "O1\nN5 G0 X1.; GOTO 30; N30 X2.\nM30\n";
        assert!(matches!(leads(text, 1, "GOTO"), Some(Target::Block(span)) if span.start > 20));
        assert_eq!(leads(text, 1, "N5"), None);
    }
}
