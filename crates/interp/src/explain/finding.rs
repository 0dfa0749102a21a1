//! One row of the list of findings.
use crate::dialect::Dialect;

/// One kind of finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Its stable code.
    pub code: &'static str,
    /// What it means, for every program that causes it.
    pub sentence: &'static str,
    /// A program that causes it; empty where none fits on a page.
    pub wrong: &'static str,
    /// One that does what was meant.
    pub right: &'static str,
    /// The dialect of both.
    pub dialect: Dialect,
}

/// A row of the shared language.
pub(super) const fn row(
    code: &'static str,
    sentence: &'static str,
    wrong: &'static str,
    right: &'static str,
) -> Finding {
    Finding { code, sentence, wrong, right, dialect: Dialect::LinuxCnc }
}

impl Finding {
    /// The same in another dialect.
    pub(super) const fn of(mut self, dialect: Dialect) -> Self {
        self.dialect = dialect;
        self
    }
}
