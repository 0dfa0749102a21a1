//! What stands on a tape before its program and after it: blank tape, text for people, marks of old
//! systems.
//!
//! ```text
//!   NUL NUL setup of part 7  %  O0007 …  M30  %  NUL NUL
//!   └──── leader ─────────┘                     └ trailer
//! ```

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
/// is where the text begins; `is_text` says whether what stands there is that, and no part of a
/// program, also by whether a numbered program stands behind the sign.
pub(crate) fn leader(
    source: &[u8],
    from: usize,
    is_text: impl FnOnce(&[u8], bool) -> bool,
) -> Option<core::ops::Range<usize>> {
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
    is_text(&source[from..sign], is_numbered).then_some(from..sign)
}
