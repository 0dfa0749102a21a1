//! A refusal as data, for a client elsewhere: the sentence, what mends it, findings in a program.
use super::loads::BrokenOff;
use crate::Refused;
use crate::operation::Refusal;
use diag::Severity;
use servo::LaneStop;

/// Findings that are handed on.
const MOST_FINDINGS: usize = 200;

/// What stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// The control's state: the same request may be accepted later.
    State,
    /// The request itself.
    Request,
    /// Too much is asked of the control at once, or it is being switched off.
    Busy,
}

/// Something that was found in a program.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct FindingData {
    /// Line, from 1; 0: none.
    pub line: u32,
    /// Column in bytes, from 1; 0 in a file that the program draws in.
    pub column: u32,
    /// Its code in the list of diagnostics.
    pub code: String,
    /// `error`, `warning`, `note`.
    pub severity: &'static str,
    /// The sentence.
    pub message: String,
    /// What to do, if that is known.
    pub help: Option<String>,
}

/// Why a request was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusalData {
    /// What stands in the way.
    pub kind: RefusalKind,
    /// Why.
    pub reason: String,
    /// What would make it possible, where the reason does not say it.
    pub remedy: Option<String>,
    /// Of a program that is refused: what is wrong with it.
    pub findings: Vec<FindingData>,
}

impl RefusalData {
    /// Why, and what would make it possible.
    pub(super) fn sentence(&self) -> String {
        let remedy = self.remedy.as_ref().map_or_else(String::new, |remedy| format!(": {remedy}"));
        format!("{}{remedy}", self.reason)
    }

    fn of_kind(kind: RefusalKind, reason: impl Into<String>, remedy: Option<&str>) -> Self {
        let remedy = remedy.map(str::to_owned);
        Self { kind, reason: reason.into(), remedy, findings: Vec::new() }
    }

    pub(super) fn busy(most: usize) -> Self {
        let reason = format!("{most} requests wait for the control already");
        Self::of_kind(RefusalKind::Busy, reason, Some("wait for their answers"))
    }

    pub(super) fn unkept(why: &str) -> Self {
        let reason = format!("it is in force, but {why}");
        let remedy = "free the disk, and ask again: until then it is lost with the control";
        Self::of_kind(RefusalKind::Request, reason, Some(remedy))
    }

    pub(super) fn broken_off(why: BrokenOff) -> Self {
        let reason = format!("it was broken off by {}, before it was read and judged", why.by());
        Self::of_kind(RefusalKind::State, reason, None)
    }

    pub(super) fn overtaken(stop: LaneStop) -> Self {
        let by = match stop {
            LaneStop::EmergencyStop | LaneStop::NotTaken => "an emergency stop",
            LaneStop::Stop => "a stop",
            LaneStop::FeedHold => "a feed hold",
            LaneStop::JogStop => "a stop of what is moved by hand",
        };
        let reason = format!("{by} was asked for after it, before it had begun");
        Self::of_kind(RefusalKind::State, reason, Some("ask for it again"))
    }

    pub(super) fn ended() -> Self {
        Self::of_kind(RefusalKind::Busy, "the control is being switched off", None)
    }
}

impl From<&Refusal> for RefusalData {
    fn from(refusal: &Refusal) -> Self {
        match refusal {
            Refusal::State(need) => {
                let (reason, remedy) = need.reason();
                Self { remedy, ..Self::of_kind(RefusalKind::State, reason, None) }
            }
            Refusal::Request(refused) => Self {
                findings: findings(refused),
                ..Self::of_kind(RefusalKind::Request, refused.sentence(), None)
            },
        }
    }
}

fn findings(refused: &Refused) -> Vec<FindingData> {
    let Refused::Findings { findings, text, .. } = refused else { return Vec::new() };
    let column = |span: &diag::Span| {
        let before = text.get(..span.start as usize).filter(|_| span.file == 0)?;
        let line = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
        u32::try_from(before.len() - line + 1).ok()
    };
    let shown = findings.iter().take(MOST_FINDINGS);
    shown
        .map(|finding| FindingData {
            line: finding.span.line,
            column: column(&finding.span).unwrap_or(0),
            code: finding.code.to_owned(),
            severity: match finding.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Note => "note",
            },
            message: finding.message.clone(),
            help: finding.help.clone(),
        })
        .collect()
}
