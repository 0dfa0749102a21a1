//! Text of bounded size from a file, and places in it.
//!
//! ```text
//!   byte offset ──(line starts, binary search)──► diag::Span { line, start, end }
//! ```
//!
//! Every reader here first takes the whole text, never more than its limit plus one byte: a device
//! that never ends, or a file that grows while it is read, cannot fill the memory.
use crate::{Error, regular};
use diag::{Diagnostic, Span};
use std::{
    fs::File,
    io::{self, Read},
    ops::Range,
    path::Path,
};

/// Bytes a machine file, tool table or parameter file may have.
pub const SMALL_FILE_LIMIT: u64 = 1 << 20;
/// Bytes of a part program that is held in memory: a run keeps up to twelve times as much of its
/// meaning. What only reads, as `check` does, takes longer ones piece by piece.
pub const PROGRAM_LIMIT: u64 = 256 << 20;

/// The bytes of a file, `what` it is (for the sentence), and how many it may have.
///
/// # Errors
/// When the file cannot be opened or read, or is larger than `limit`.
pub fn read_bytes(path: &Path, what: &'static str, limit: u64) -> Result<Vec<u8>, Error> {
    let file = open(path).map_err(|cause| Error::file("read", path, cause))?;
    read_stream(file, path, what, limit)
}

/// Opens a file that is to be read: the one place where files are opened that a user names, which
/// waits for no named pipe ([`regular`]). Who reads it has a limit. A pipe that a process holds
/// open, such as a shell's `<(…)`, has its writer: what is named by its place in `/dev` or `/proc`
/// is opened whatever it is.
///
/// # Errors
/// It cannot be opened, or is no file.
pub fn open(path: &Path) -> io::Result<File> {
    if path.starts_with("/dev") || path.starts_with("/proc") {
        return File::open(path);
    }
    regular::open(path)
}

/// The bytes of a stream such as standard input, as [`read_bytes`]; `path` names it in sentences.
///
/// # Errors
/// When the stream cannot be read or is longer than `limit`.
pub fn read_stream(
    stream: impl Read,
    path: &Path,
    what: &'static str,
    limit: u64,
) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    let read = stream.take(limit.saturating_add(1)).read_to_end(&mut bytes);
    read.map_err(|cause| Error::file("read", path, cause))?;
    if bytes.len() as u64 > limit {
        return Err(Error::TooLarge { path: path.to_owned(), what, limit });
    }
    Ok(bytes)
}

/// The text of a file, as [`read_bytes`]; a byte order mark at its start is dropped.
///
/// # Errors
/// As [`read_bytes`], and when the bytes are not UTF-8.
pub fn read_text(path: &Path, what: &'static str, limit: u64) -> Result<String, Error> {
    utf8(path, read_bytes(path, what, limit)?)
}

/// Bytes of a file as text; a byte order mark at its start is dropped.
pub(crate) fn utf8(path: &Path, bytes: Vec<u8>) -> Result<String, Error> {
    let text = String::from_utf8(bytes).map_err(|e| Error::NotText {
        path: path.to_owned(),
        offset: e.utf8_error().valid_up_to(),
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Findings that are shown of one file: a file of another kind would give thousands.
pub const MOST_FINDINGS: usize = 100;

/// The findings in the order of the text, [`MOST_FINDINGS`] at most and a word about the rest.
pub(crate) fn in_order(mut findings: Vec<Diagnostic>) -> Vec<Diagnostic> {
    findings.sort_by_key(|d| d.span.start);
    let rest = findings.len().saturating_sub(MOST_FINDINGS);
    findings.truncate(MOST_FINDINGS);
    if let Some(last) = findings.last().filter(|_| rest > 0) {
        findings.push(Diagnostic::note("S0408", last.span, format!("{rest} more findings follow")));
    }
    findings
}

/// Where the lines of a text begin.
pub(crate) struct Lines {
    starts: Vec<usize>,
    file: u16,
}

impl Lines {
    pub(crate) fn of(text: &str, file: u16) -> Self {
        let after_newline =
            text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Self { starts: std::iter::once(0).chain(after_newline).collect(), file }
    }

    /// The span of a stretch of bytes.
    pub(crate) fn span(&self, bytes: &Range<usize>) -> Span {
        let line = self.starts.partition_point(|start| *start <= bytes.start);
        let small = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Span {
            file: self.file,
            line: small(line),
            start: small(bytes.start),
            end: small(bytes.end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_knows_the_line_it_begins_on() {
        let lines = Lines::of("ab\ncd\n", 0);
        let at = |n: usize| lines.span(&(n..n)).line;
        assert_eq!([at(0), at(2), at(3), at(5), at(6)], [1, 1, 2, 2, 3]);
    }

    #[test]
    fn a_file_over_the_limit_is_refused_with_the_limit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("long.toml");
        std::fs::write(&path, "x".repeat(11)).unwrap();
        let sentence = read_text(&path, "a machine file", 10).unwrap_err().to_string();
        assert!(sentence.ends_with("is larger than the 10 bytes that a machine file may have"));
        assert_eq!(read_text(&path, "a machine file", 11).unwrap().len(), 11);
    }

    #[test]
    #[cfg(unix)]
    fn a_named_pipe_is_no_file_and_nobody_waits_for_it() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("pipe.ngc");
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let sentence = read_bytes(&path, "a program", 10).unwrap_err().to_string();
        assert!(
            sentence.contains("named pipe") && sentence.contains("by the name -"),
            "{sentence}"
        );
    }

    #[test]
    fn a_stream_that_never_ends_is_read_to_the_limit() {
        let endless = std::io::repeat(b'G');
        let refused = read_stream(endless, Path::new("<stdin>"), "a program", 1000).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "<stdin> is larger than the 1000 bytes that a program may have"
        );
    }

    #[test]
    fn a_binary_file_is_refused_with_the_place() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tool.toml");
        std::fs::write(&path, b"ab\xff").unwrap();
        let sentence = read_text(&path, "a tool table", 10).unwrap_err().to_string();
        assert!(sentence.ends_with("is not text: byte 2 is not UTF-8"), "{sentence}");
    }

    #[test]
    fn of_very_many_findings_the_first_are_shown_and_the_rest_counted() {
        let found = (0..250).map(|n| {
            let place = Span { start: 1000 - n, ..Span::default() };
            Diagnostic::error("S0402", place, "unknown key")
        });
        let shown = in_order(found.collect());
        assert_eq!(shown.len(), MOST_FINDINGS + 1);
        assert_eq!(shown[0].span.start, 751);
        assert_eq!(shown[MOST_FINDINGS].message, "150 more findings follow");
    }

    #[test]
    fn a_missing_file_is_named() {
        let sentence = read_text(Path::new("/nowhere/m.toml"), "", 1).unwrap_err().to_string();
        assert_eq!(sentence, "cannot read /nowhere/m.toml: there is no such file or folder");
    }
}
