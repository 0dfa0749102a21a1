//! Whether what was cut is good, is not, or could not be judged.
/// Whether a feature is good.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within every tolerance asked.
    Pass,
    /// Out of at least one.
    Fail {
        /// One sentence with the numbers: everything that is wrong, gravest first.
        reason: String,
    },
    /// Nothing is known to be wrong, and the judge lacks what it would need to find it right.
    NotJudged {
        /// What could not be judged, and why.
        reason: String,
    },
}

impl Verdict {
    /// `Pass` if nothing was found, else all findings as one sentence.
    pub(crate) fn from_findings(findings: &[String]) -> Self {
        if findings.is_empty() { Self::Pass } else { Self::Fail { reason: findings.join("; ") } }
    }

    /// The same of a feature that could not be judged as a whole: it may be bad, but never good.
    pub(crate) fn unless(findings: &[String], not_judged: Option<String>) -> Self {
        match (Self::from_findings(findings), not_judged) {
            (Self::Pass, Some(reason)) => Self::NotJudged { reason },
            (verdict, _) => verdict,
        }
    }

    /// Good.
    pub const fn is_pass(&self) -> bool {
        matches!(self, Self::Pass)
    }

    /// `"pass"`, `"fail"` or `"not judged"`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail { .. } => "fail",
            Self::NotJudged { .. } => "not judged",
        }
    }

    /// Why it is not good.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Pass => None,
            Self::Fail { reason } | Self::NotJudged { reason } => Some(reason),
        }
    }
}
