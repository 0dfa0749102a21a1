//! What can go wrong with a file, each in one sentence that names the file.
//!
//! Two kinds: the file system refuses (missing, forbidden, full), or the content does. The second
//! keeps the text and every [`Diagnostic`], so that the renderer can draw the carets.
use diag::Diagnostic;
use std::{
    fmt, io,
    path::{Path, PathBuf},
};

/// Why a file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file system refused.
    #[error("cannot {action} {}: {}", path.display(), in_words(cause))]
    File {
        /// What was attempted: `"read"`, `"write"`, `"create"`, …
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system answered.
        cause: io::Error,
    },
    /// More bytes than a file of this kind may have.
    #[error("{} is larger than the {limit} bytes that {what} may have", path.display())]
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// What it was read as, such as "a machine file".
        what: &'static str,
        /// Bytes allowed.
        limit: u64,
    },
    /// The bytes are not UTF-8 text.
    #[error("{} is not text: byte {offset} is not UTF-8", path.display())]
    NotText {
        /// Which file.
        path: PathBuf,
        /// Where the first such byte stands, counted from 0.
        offset: usize,
    },
    /// The text was understood, and refused.
    #[error("{0}")]
    Refused(Box<Refusal>),
    /// Neither an embedded machine nor a file.
    #[error("there is no machine `{name}` and no file of that name: {remedy}")]
    NoSuchMachine {
        /// What was asked for.
        name: String,
        /// What could be meant, or what there is.
        remedy: String,
    },
    /// A trace that Parquet could not write or read.
    #[error("cannot {action} the trace {}: {cause}", path.display())]
    Trace {
        /// `"write"` or `"read"`.
        action: &'static str,
        /// Which file.
        path: PathBuf,
        /// What the format's library answered.
        cause: String,
    },
}

/// A file whose content was refused, with all that was found at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Which file.
    pub path: PathBuf,
    /// What it said.
    pub text: String,
    /// What is wrong with it, in the order of the text.
    pub findings: Vec<Diagnostic>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(first) = self.findings.first() {
            write!(f, ":{}: {}", first.span.line, first.message)?;
        }
        match self.findings.len() {
            0 | 1 => Ok(()),
            n => write!(f, " (the first of {n} findings)"),
        }
    }
}

impl Error {
    pub(crate) fn file(action: &'static str, path: &Path, cause: io::Error) -> Self {
        Self::File { action, path: path.to_owned(), cause }
    }

    pub(crate) fn refused(path: &Path, text: String, findings: Vec<Diagnostic>) -> Self {
        Self::Refused(Box::new(Refusal { path: path.to_owned(), text, findings }))
    }
}

/// The system's answer without its number, where the kind says it in plain words.
fn in_words(cause: &io::Error) -> String {
    match cause.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::IsADirectory => "it is a folder".into(),
        io::ErrorKind::NotADirectory => "a part of its path is not a folder".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".into(),
        io::ErrorKind::StorageFull => "the disk is full".into(),
        _ => cause.to_string(),
    }
}
