//! What a control keeps of a machine from run to run: TOML that a person can read, with whose it is
//! and a mark of the whole.
//!
//! ```text
//!   version = 3
//!   machine = "tapping-center"
//!   mark = "5bd1e995"              of what it depends on in the machine's file: another mark, and it is no longer true
//!   …
//!   # end 7a1b2c3d                 mark of all that stands above: whether it was cut short or edited
//! ```
//!
//! Marks are FNV-1a of 32 bits (Fowler, Noll, Vo). The file is written beside its name and renamed:
//! a reader finds the old one or the new one. What is known of a machine that has been changed
//! since is refused: it would be corrected by another machine's figures.
use crate::{Error, output, read_text, text::Lines};
use diag::Diagnostic;
use serde::{Serialize, de::DeserializeOwned};
use std::ops::Range;
use std::path::Path;

/// Begins the last line.
const END: &str = "# end ";

/// FNV-1a of 32 bits.
pub(crate) fn mark(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// Whose it is, in the layout of which version.
pub(crate) struct Whose<'a> {
    pub(crate) version: u32,
    pub(crate) machine: &'a str,
    pub(crate) mark: &'a str,
}

/// One kind of such files.
pub(crate) trait KeptFile: Serialize + DeserializeOwned {
    /// With its article.
    const WHAT: &'static str;
    /// The version that is written.
    const VERSION: u32;
    /// Longest file, bytes.
    const LONGEST: u64;
    /// Codes of findings: it is damaged, it is another machine's, the machine has been changed
    /// since.
    const CODES: [&'static str; 3];
    /// What to do where it is not this machine's.
    const INSTEAD: &'static str;

    /// Whose it is.
    fn whose(&self) -> Whose<'_>;
    /// What in it cannot be, in a sentence.
    fn makes_sense(&self) -> Result<(), String>;

    /// Its text.
    fn text(&self) -> String {
        let mut text = toml::to_string(self).unwrap_or_default(); // tables of numbers and words: always possible
        let end = mark(&text);
        text += &format!("{END}{end:08x}\n");
        text
    }

    /// Read it from text.
    ///
    /// # Errors
    /// What is wrong with it: nothing of a damaged file is used.
    fn read(text: &str) -> Result<Self, Vec<Diagnostic>> {
        let wrong = |at: Range<usize>, sentence: String| {
            vec![Diagnostic::error(Self::CODES[0], Lines::of(text, 0).span(&at), sentence)]
        };
        let read: Self = toml::from_str(text)
            .map_err(|e| wrong(e.span().unwrap_or(0..0), e.message().to_owned()))?;
        let found = read.whose().version;
        if found != Self::VERSION {
            let expected = Self::VERSION;
            return Err(wrong(0..0, format!("expected version {expected}, found {found}")));
        }
        let end = text.trim_end().rfind('\n').map_or(0, |at| at + 1);
        let Some(said) = text[end..].trim_end().strip_prefix(END) else {
            return Err(wrong(end..text.len(), "the file has no end: it was cut short".into()));
        };
        if u32::from_str_radix(said, 16) != Ok(mark(&text[..end])) {
            let sentence = "the file has been changed since it was written".into();
            return Err(wrong(end..text.len(), sentence));
        }
        read.makes_sense().map_err(|sentence| wrong(0..0, sentence))?;
        Ok(read)
    }

    /// Read one for this machine; `None` if there is no file.
    ///
    /// # Errors
    /// It cannot be read, is damaged, or belongs to another machine or to this one before it was
    /// changed.
    fn read_for(path: &Path, machine: &str, mark: u32) -> Result<Option<Self>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let text = read_text(path, Self::WHAT, Self::LONGEST)?;
        let read = Self::read(&text).and_then(|read| {
            let trouble = read.not_of(machine, mark);
            trouble.map_or(Ok(read), |(key, code, sentence)| {
                let at = text.find(key).unwrap_or(0);
                let span = Lines::of(&text, 0).span(&(at..at + key.len()));
                Err(vec![Diagnostic::error(code, span, sentence)])
            })
        });
        let help = |found: Vec<Diagnostic>| {
            found.into_iter().map(|finding| finding.with_help(Self::INSTEAD)).collect()
        };
        read.map(Some).map_err(|found| Error::refused(path, text, help(found)))
    }

    /// Why it is not this machine's: the key that says so, code, sentence.
    fn not_of(&self, machine: &str, mark: u32) -> Option<(&'static str, &'static str, String)> {
        let (whose, now) = (self.whose(), format!("{mark:08x}"));
        if whose.machine != machine {
            let sentence = format!("this is of {}, and the machine is {machine}", whose.machine);
            return Some(("machine", Self::CODES[1], sentence));
        }
        (whose.mark != now).then(|| {
            let sentence = format!(
                "the machine's file has been changed since this was found out (mark {}, now {now})",
                whose.mark
            );
            ("mark", Self::CODES[2], sentence)
        })
    }

    /// Write it, whole or not at all.
    ///
    /// # Errors
    /// The file system refuses.
    fn write(&self, path: &Path) -> Result<(), Error> {
        output::write_file(path, self.text().as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_is_the_published_one() {
        // FNV-1a test suite of its authors: "" and "foobar"
        assert_eq!((mark(""), mark("foobar")), (0x811c_9dc5, 0xbf9c_f968));
    }
}
