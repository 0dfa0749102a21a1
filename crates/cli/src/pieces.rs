//! Programs too long to be held in memory, read piece by piece.
//!
//! ```text
//!   file  ──► 1 MiB, up to the end of its last line ──► interpreter, planner, remarks ──► printed
//!               ▲                                                                            │
//!               └───────────── the begin of the next line is kept ◄──────────────────────────┘
//! ```
//!
//! So the first findings of a program of any length are there at once, and memory stays what a
//! piece needs.
use crate::say;
use control::Refused;
use control::job::Session;
use control::job::mill_stock::MilledStock;
use control::job::options::ProgramOptions;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Programs up to this size are read whole.
pub(crate) const WHOLE: u64 = 4 << 20;
/// Size of a piece, as far as whole lines allow.
const PIECE: usize = 1 << 20;
/// So much is kept of a line that is longer than a piece: it is refused for its length.
const KEPT: usize = 1 << 17;
/// Longest line that is passed over: a file without lines is no program.
const LONGEST_LINE: usize = 64 << 20;

/// Whether every piece of a program needs nothing but the one before.
fn suits(path: &Path, setup: &interp::Setup) -> Result<bool, Refused> {
    let mut pieces = Pieces::open(path)?;
    while let Some(piece) = pieces.next()? {
        if !interp::can_be_read_in_pieces(piece.text, setup) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// What a program meets, if it is read in pieces.
pub(crate) fn session(options: &ProgramOptions, path: &Path) -> Result<Option<Session>, Refused> {
    let long = path.metadata().is_ok_and(|data| data.is_file() && data.len() > WHOLE);
    if !long {
        return Ok(None);
    }
    let mut session = Session::load(options, path, b"")?;
    session.is_stated_by(&head(path, MilledStock::LOOKED_AT)?);
    Ok(suits(path, &session.interp_setup())?.then_some(session))
}

/// So many whole lines of a program.
pub(crate) struct Piece<'a> {
    pub(crate) text: &'a [u8],
    /// It is not the last one.
    pub(crate) more_follows: bool,
}

/// A file, piece by piece.
pub(crate) struct Pieces {
    path: PathBuf,
    file: File,
    buffer: Vec<u8>,
    /// Bytes of the buffer that were handed out already.
    used: usize,
    at_end: bool,
    /// The last piece was handed out.
    finished: bool,
}

impl Pieces {
    /// At the beginning of a file.
    pub(crate) fn open(path: &Path) -> Result<Self, Refused> {
        let file = store::open(path).map_err(|e| unreadable(path, &e))?;
        let buffer = Vec::with_capacity(PIECE + (PIECE >> 3));
        Ok(Self { path: path.to_owned(), file, buffer, used: 0, at_end: false, finished: false })
    }

    /// The next piece; none after the last one.
    pub(crate) fn next(&mut self) -> Result<Option<Piece<'_>>, Refused> {
        self.buffer.drain(..self.used);
        self.used = 0;
        self.fill().map_err(|e| unreadable(&self.path, &e))?;
        while !self.at_end && memchr::memchr(b'\n', &self.buffer).is_none() {
            self.cut_line().map_err(|e| unreadable(&self.path, &e))?;
        }
        if self.finished {
            return Ok(None);
        }
        self.finished = self.at_end;
        let whole_lines = memchr::memrchr(b'\n', &self.buffer).map(|newline| newline + 1);
        self.used = match whole_lines {
            Some(end) if !self.at_end => end,
            _ => self.buffer.len(),
        };
        let more_follows = !self.at_end;
        Ok(Some(Piece { text: &self.buffer[..self.used], more_follows }))
    }

    /// Of the line that fills the buffer keep the begin, and read on behind its end.
    fn cut_line(&mut self) -> io::Result<()> {
        self.buffer.truncate(KEPT);
        let mut more = vec![0; KEPT];
        let mut cut = 0;
        while !self.at_end {
            if cut > LONGEST_LINE {
                return Err(io::Error::other(format!(
                    "a line is longer than {LONGEST_LINE} bytes: it is no program"
                )));
            }
            let read = match self.file.read(&mut more) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                read => read?,
            };
            self.at_end = read == 0;
            cut += read;
            if let Some(end) = memchr::memchr(b'\n', &more[..read]) {
                self.buffer.extend_from_slice(&more[end..read]);
                break;
            }
        }
        self.fill()
    }

    /// Read on until there is a piece, and one byte more to know whether anything follows.
    fn fill(&mut self) -> io::Result<()> {
        while !self.at_end && self.buffer.len() <= PIECE {
            let wanted = (PIECE + 1 - self.buffer.len()) as u64;
            let read = (&self.file).take(wanted).read_to_end(&mut self.buffer)?;
            self.at_end = read == 0;
        }
        Ok(())
    }
}

fn unreadable(path: &Path, error: &io::Error) -> Refused {
    Refused::because(format!("cannot read {}: {error}", path.display()))
}

/// The first bytes of a file.
///
/// # Errors
/// It cannot be read.
pub(crate) fn head(path: &Path, most: usize) -> Result<Vec<u8>, Refused> {
    let mut head = Vec::new();
    let file = store::open(path).map_err(|error| unreadable(path, &error))?;
    let read = file.take(most as u64).read_to_end(&mut head);
    read.map_err(|error| unreadable(path, &error))?;
    Ok(head)
}

/// Lines of a file by their numbers, which rise: for what is found at its end.
pub(crate) fn lines(path: &Path, numbers: &[u32]) -> Result<Vec<Vec<u8>>, Refused> {
    let mut found = Vec::new();
    let mut line = 1;
    let mut pieces = Pieces::open(path)?;
    while let Some(piece) = pieces.next()? {
        for text in piece.text.split_inclusive(|byte| *byte == b'\n') {
            while numbers.get(found.len()) == Some(&line) {
                found.push(text.trim_ascii_end().to_vec());
            }
            if found.len() == numbers.len() {
                return Ok(found);
            }
            line += 1;
        }
    }
    Ok(found)
}

/// `canon --format linuxcnc` of a long program.
pub(crate) fn listing(
    path: &Path,
    setup: &interp::Setup,
    show: impl Fn(&[diag::Diagnostic], &[u8]),
) -> Result<bool, Refused> {
    let mut listing = interp::Listing::new(say::data());
    let (mut rest, mut good) = (None, true);
    let mut pieces = Pieces::open(path)?;
    while let Some(piece) = pieces.next()? {
        let mut interpreter =
            interp::Interpreter::of_piece(piece.text, setup, rest.as_ref(), piece.more_follows);
        while interpreter.step(&mut listing) == interp::Progress::More {
            if interpreter.has_errors() || listing.has_failed() {
                break;
            }
        }
        rest = Some(interpreter.rest());
        show(interpreter.diagnostics(), piece.text);
        good &= !interpreter.has_errors();
        if !good || listing.has_failed() || interpreter.has_ended() {
            break;
        }
    }
    say::written(listing.finish().map(drop))?;
    Ok(good)
}

/// The operations of a long program, each as `line` writes it.
pub(crate) fn operations(
    path: &Path,
    setup: &interp::Setup,
    line: impl Fn(&canon::Op) -> String,
    show: impl Fn(&[diag::Diagnostic], &[u8]),
) -> Result<bool, Refused> {
    let mut out = say::data();
    let (mut rest, mut good, mut written) = (None, true, Ok(()));
    let mut pieces = Pieces::open(path)?;
    while let Some(piece) = pieces.next()? {
        let mut ops = interp::Ops::of_piece(piece.text, setup, rest.take(), piece.more_follows);
        for op in ops.by_ref() {
            written = writeln!(out, "{}", line(&op));
            if written.is_err() {
                break;
            }
        }
        let found = ops.diagnostics();
        show(&found, piece.text);
        good &= !found.iter().any(diag::Diagnostic::is_error);
        if written.is_err() {
            break;
        }
        rest = Some(ops.rest());
    }
    say::written(written.and_then(|()| out.flush()))?;
    Ok(good)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    #[test]
    fn pieces_are_whole_lines_and_all_of_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.ngc");
        for ending in ["\n", ""] {
            let mut text = String::new();
            for i in 0..200_000 {
                let _ = writeln!(text, "G1 X{i}");
            }
            text = text.trim_end().to_owned() + ending;
            std::fs::write(&path, &text).unwrap();
            let (mut all, mut ends) = (Vec::new(), Vec::new());
            let mut pieces = Pieces::open(&path).unwrap();
            while let Some(piece) = pieces.next().unwrap() {
                all.extend_from_slice(piece.text);
                ends.push((piece.text.ends_with(b"\n"), piece.more_follows));
            }
            assert_eq!(all, text.as_bytes());
            let last = ends.pop();
            assert_eq!(last, Some((!ending.is_empty(), false)));
            assert!(!ends.is_empty() && ends.iter().all(|end| *end == (true, true)));
        }
        let found = lines(&path, &[1, 2, 2, 150_001]).unwrap();
        assert_eq!(found, [&b"G1 X0"[..], b"G1 X1", b"G1 X1", b"G1 X150000"]);
    }
}
