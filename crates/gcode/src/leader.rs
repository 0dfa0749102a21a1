//! What stands on a tape before its program and after it: blank tape, text for people, marks of old
//! systems.
//!
//! ```text
//!   NUL NUL setup of part 7  %  O0007 …  M30  %  NUL NUL
//!   └──── leader ─────────┘                     └ trailer
//! ```
use crate::block::{Block, Word};
use crate::expression::Value;
use crate::fanuc::Grammar;
use crate::parser::Parser;

/// A text without the byte by which old systems marked the end of a file (Ctrl-Z), and what they
/// filled it up with.
pub(crate) fn before_end_mark(source: &[u8]) -> &[u8] {
    let is_filling = |byte: &u8| matches!(byte, 0x1A | 0 | b' ' | b'\t' | b'\r' | b'\n');
    let text = source.iter().rposition(|byte| !is_filling(byte)).map_or(0, |last| last + 1);
    let behind = &source[text..];
    match memchr::memchr(0x1A, behind).or_else(|| memchr::memchr(0, behind)) {
        Some(mark) if text > 0 || behind[mark] == 0x1A => &source[..text + mark],
        _ => source,
    }
}

/// The leader of a tape: text for people before the line that begins with the percent sign. `from`
/// is where the text begins. It is none where what stands there can be a program: a block, without
/// a numbered program behind the sign; a numbered program; or its end.
pub(crate) fn leader(
    source: &[u8],
    from: usize,
    grammar: Grammar,
) -> Option<core::ops::Range<usize>> {
    if grammar != Grammar::Fanuc {
        return None;
    }
    let is_sign = |at: &usize| {
        let before = &source[from..*at];
        let begin = memchr::memrchr(b'\n', before).map_or(0, |end| end + 1);
        before[begin..].iter().all(|byte| byte.is_ascii_whitespace() || *byte == 0)
    };
    let sign = memchr::memchr_iter(b'%', &source[from..]).map(|at| from + at).find(is_sign)?;
    let behind = &source[sign + 1..];
    let lines = behind.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.into_iter().find(|line| !(line.is_empty() || line.starts_with(b"(")))?;
    let is_numbered = matches!(first, [b'O' | b'o' | b':' | b'<', ..]);
    let before = &source[from..sign];
    let mut parser = Parser::of_part(before, 0, grammar);
    let (mut block, mut is_text) = (Block::new(), false);
    while parser.next(&mut block) {
        let ends = |word: &Word| {
            let code =
                matches!(word.value, Value::Number(n) if [2.0, 30.0, 98.0, 99.0].contains(&n));
            word.letter == b'M' && code
        };
        let is_program = block.o.is_some() || block.words.iter().any(ends);
        let is_block =
            !block.words.is_empty() || block.control.is_some() || !block.assignments.is_empty();
        if !block.faulty && (is_program || is_block && !is_numbered) {
            return None;
        }
        is_text |= block.faulty || is_block;
    }
    is_text.then_some(from..sign)
}
