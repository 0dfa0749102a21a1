//! What was refused, and why: one sentence, or findings with their places in a text.
use crate::job::drawn::Drawn;
use diag::Diagnostic;

/// Why nothing was done.
#[derive(Debug)]
pub enum Refused {
    /// One sentence.
    Sentence(String),
    /// Findings in a text.
    Findings {
        /// Name of the text, as the user typed it.
        name: String,
        /// The text.
        text: Vec<u8>,
        /// Files that it draws in.
        drawn: Vec<Drawn>,
        /// What is wrong with it.
        findings: Vec<Diagnostic>,
    },
}

impl Refused {
    /// From anything that says what it is.
    pub fn because(sentence: impl Into<String>) -> Self {
        Self::Sentence(sentence.into())
    }

    /// A text that draws in no others.
    pub fn text(name: String, text: impl Into<Vec<u8>>, findings: Vec<Diagnostic>) -> Self {
        Self::program(name, text.into(), Vec::new(), findings)
    }

    /// A program and the files that it draws in.
    pub const fn program(
        name: String,
        text: Vec<u8>,
        drawn: Vec<Drawn>,
        findings: Vec<Diagnostic>,
    ) -> Self {
        Self::Findings { name, text, drawn, findings }
    }

    /// In one line.
    pub fn sentence(&self) -> String {
        match self {
            Self::Sentence(sentence) => sentence.clone(),
            Self::Findings { name, findings, .. } => match findings.iter().find(|f| f.is_error()) {
                Some(first) => format!("{name} is refused: {}", first.message),
                None => format!("{name} is refused"),
            },
        }
    }
}

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.sentence())
    }
}

impl std::error::Error for Refused {}

impl From<store::Error> for Refused {
    fn from(error: store::Error) -> Self {
        match error {
            store::Error::Refused(refusal) => {
                let name = refusal.path.display().to_string();
                Self::text(name, refusal.text, refusal.findings)
            }
            other => Self::Sentence(other.to_string()),
        }
    }
}
