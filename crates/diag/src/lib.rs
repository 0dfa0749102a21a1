//! What was found wrong, and where: a diagnostic is data with spans; renderers live at the edge.
//!
//! Everything that reads text (programs, machine files, tool tables) and everything that judges a
//! program before motion reports in this one type, so that all findings of a run can be shown at
//! once, as carets, JSON or SARIF, without the finder knowing which.
#![no_std]
extern crate alloc;
use alloc::boxed::Box;
use alloc::{string::String, vec::Vec};

/// A stretch of source text. Lines count from 1; offsets are bytes from the start of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// Which source: 0 is the program itself, others are the subprogram files it opened.
    pub file: u16,
    /// Line on which the stretch begins, counted from 1; 0 where there is no place.
    pub line: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The stretch from the beginning of `self` to the end of `other`.
    #[must_use]
    pub const fn to(self, other: Self) -> Self {
        Self { end: other.end, ..self }
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; nothing will go wrong.
    Note,
    /// Legal, and likely to hurt.
    Warning,
    /// The program or file is refused.
    Error,
}

/// A second place that explains the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub span: Span,
    /// What is to be seen there.
    pub text: String,
}

/// A word of a block, with the number that works.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RemedyWord {
    /// Its letter.
    pub letter: char,
    /// The number that works, as the program writes it.
    pub number: String,
    /// The number that does not: only a word that says it is meant. `None`: the word stays in
    /// force, so that it may stand in a block before, and be written into this one.
    pub instead_of: Option<String>,
    /// The code that is in force where this word is meant, such as `G94`; empty: any.
    pub with: &'static str,
}

/// What a finding says of the number that works, for a program that writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remedy {
    /// The block that is changed.
    pub span: Span,
    /// Its words that change together.
    pub words: Vec<RemedyWord>,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable code, such as `"G0103"`: letter of the finder, four digits.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// One short sentence: expected what, found what, with the number that would work.
    pub message: String,
    /// Where.
    pub span: Span,
    /// Other places that explain it.
    pub labels: Vec<Label>,
    /// Why it matters and what to do, when the message alone does not say so.
    pub help: Option<String>,
    /// The words that make it go, where that is known.
    pub remedy: Option<Box<Remedy>>,
}

impl Diagnostic {
    /// An error at a place.
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, span, message.into())
    }

    /// A warning at a place.
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, span, message.into())
    }

    /// A note at a place.
    pub fn note(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Note, code, span, message.into())
    }

    fn new(severity: Severity, code: &'static str, span: Span, message: String) -> Self {
        Self { code, severity, message, span, labels: Vec::new(), help: None, remedy: None }
    }

    /// The same finding, with what to do about it.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The same finding, with another place that explains it.
    #[must_use]
    pub fn with_label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// The same finding, with the words that make it go, written into the block that it is about.
    #[must_use]
    pub fn with_remedy(mut self, words: Vec<RemedyWord>) -> Self {
        self.remedy = Some(Box::new(Remedy { span: self.span, words }));
        self
    }

    /// Whether the program or file is refused for it.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
