//! What was refused, and how it is said: the program ends with exit code 2.
use crate::render::{self, Source};
use crate::say;
use crate::subprograms::Drawn;
use diag::Diagnostic;

/// Why nothing was done.
#[derive(Debug)]
pub(crate) enum Refused {
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
    pub(crate) fn because(sentence: impl Into<String>) -> Self {
        Self::Sentence(sentence.into())
    }

    /// A text that draws in no others.
    pub(crate) fn text(name: String, text: impl Into<Vec<u8>>, findings: Vec<Diagnostic>) -> Self {
        Self::program(name, text.into(), Vec::new(), findings)
    }

    /// A program and the files that it draws in.
    pub(crate) const fn program(
        name: String,
        text: Vec<u8>,
        drawn: Vec<Drawn>,
        findings: Vec<Diagnostic>,
    ) -> Self {
        Self::Findings { name, text, drawn, findings }
    }

    /// In one line.
    pub(crate) fn sentence(&self) -> String {
        match self {
            Self::Sentence(sentence) => sentence.clone(),
            Self::Findings { name, findings, .. } => match findings.first() {
                Some(first) => format!("{name} is refused: {}", first.message),
                None => format!("{name} is refused"),
            },
        }
    }

    /// As `check --format json` prints findings: an array of objects.
    pub(crate) fn json(&self) -> String {
        format!("{:#}\n", serde_json::Value::Array(self.findings_as_json()))
    }

    /// Each finding as an object; one sentence is a finding without a place.
    pub(crate) fn findings_as_json(&self) -> Vec<serde_json::Value> {
        match self {
            Self::Sentence(sentence) => vec![render::sentence_json(sentence)],
            Self::Findings { name, text, drawn, findings } => {
                let source = Source { name, text, drawn };
                findings.iter().map(|finding| render::json(finding, &source)).collect()
            }
        }
    }

    /// Tell the user.
    pub(crate) fn say(&self) {
        match self {
            Self::Sentence(sentence) => say::err(&format!("error: {sentence}\n")),
            Self::Findings { name, text, drawn, findings } => {
                say::err(&render::text(findings, &Source { name, text, drawn }));
                let errors = findings.iter().filter(|f| f.is_error()).count();
                let plural = if errors == 1 { "error" } else { "errors" };
                say::err(&format!("{name}: refused, {errors} {plural}\n"));
            }
        }
    }
}

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
