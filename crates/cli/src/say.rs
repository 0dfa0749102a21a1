//! Words to standard output and standard error.
//!
//! `print!` panics when its reader has gone (`leadscrew check part.ngc | head -1`) or the disk
//! that takes the output is full. Here a reader that has gone away is no error, and anything else
//! is one sentence.
//!
//! A terminal obeys control characters: a name of a file or a message of a program could retitle
//! it, clear it or write over what was said. So they are written as the characters that picture
//! them; only what this program itself colours goes out as it is.
use control::Refused;
use std::borrow::Cow;
use std::io::{self, ErrorKind, IsTerminal, Write};

/// To standard output.
pub(crate) fn out(text: &str) -> Result<(), Refused> {
    coloured_out(&shown(text))
}

/// To standard output, as it stands: what [`shown`] has been through, and then been coloured; or
/// what is read by a program.
pub(crate) fn coloured_out(text: &str) -> Result<(), Refused> {
    let mut out = io::stdout().lock();
    written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// What became of something written to standard output.
pub(crate) fn written(result: io::Result<()>) -> Result<(), Refused> {
    match result {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Refused::because(format!("cannot write to standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// To standard error. If that fails, it cannot be told.
pub(crate) fn err(text: &str) {
    coloured_err(&shown(text));
}

/// To standard error, as it stands: what [`shown`] has been through, and then been coloured.
pub(crate) fn coloured_err(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

/// A text whose control characters are seen and not obeyed; lines and tabs stay.
pub(crate) fn shown(text: &str) -> Cow<'_, str> {
    if text.chars().any(is_obeyed) {
        text.chars().map(|c| if is_obeyed(c) { picture(c) } else { c }).collect()
    } else {
        text.into()
    }
}

fn is_obeyed(c: char) -> bool {
    c.is_control() && !matches!(c, '\n' | '\t')
}

/// U+2400 and on picture the ASCII control characters; those of Latin-1 have no picture.
fn picture(c: char) -> char {
    match u32::from(c) {
        code @ ..=0x1F => char::from_u32(0x2400 + code).unwrap_or(char::REPLACEMENT_CHARACTER),
        0x7F => '\u{2421}',
        _ => char::REPLACEMENT_CHARACTER,
    }
}

/// Standard output for what programs read, byte by byte; a terminal gets it as [`shown`] has it.
pub(crate) struct Data {
    out: io::BufWriter<io::StdoutLock<'static>>,
    is_terminal: bool,
}

/// Begin to write data.
pub(crate) fn data() -> Data {
    let out = io::stdout().lock();
    Data { is_terminal: out.is_terminal(), out: io::BufWriter::new(out) }
}

impl Write for Data {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.is_terminal {
            self.out.write_all(shown(&String::from_utf8_lossy(bytes)).as_bytes())?;
            return Ok(bytes.len());
        }
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_pictured() {
        for (text, expected) in [
            ("plain, 0.8 µm\n\tand on", "plain, 0.8 µm\n\tand on"),
            ("\u{1b}[31mred\u{1b}[0m", "␛[31mred␛[0m"),
            ("\u{1b}]0;title\u{7}", "␛]0;title␇"),
            ("over\rwritten\u{8}\u{7f}", "over␍written␈␡"),
            ("\u{9b}31m", "\u{fffd}31m"),
        ] {
            assert_eq!(shown(text), expected);
        }
    }
}
