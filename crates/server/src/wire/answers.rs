//! What requests are answered, and what has happened.
use super::lists::AlarmBody;
use super::values::Shown;
use crate::page_words::on_page;
use control::operation::hosted::{FindingData, Journaled};
use control::operation::{Accepted, Event, said_of};
use serde::Serialize;

/// A request is accepted.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct AcceptedBody {
    /// True.
    pub accepted: bool,
    /// What is to be known of it, in sentences.
    pub notes: Vec<String>,
}

impl AcceptedBody {
    /// Of what the control has answered.
    pub(crate) fn of(accepted: &Accepted, shown: Shown<'_>) -> Self {
        Self {
            accepted: true,
            notes: accepted.notes.iter().map(|note| on_page(&shown(note))).collect(),
        }
    }
}

/// Something is refused; every answer that is no success has this form.
#[derive(Clone, Debug, Default, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RefusalBody {
    /// False.
    pub accepted: bool,
    /// Why, in a sentence.
    pub reason: String,
    /// What would make it possible, where the reason does not say it.
    pub remedy: Option<String>,
    /// Of a program that is refused: what is wrong with it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[ts(optional, as = "Option<Vec<FindingData>>")]
    pub findings: Vec<FindingData>,
}

/// Something has happened.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct EventBody {
    /// Its number.
    #[ts(type = "number")]
    pub id: u64,
    /// Machine time.
    pub time_s: f64,
    /// `execution`, `mode`, `drives_ready`, `alarm`, `notice`, `feature`.
    pub event: &'static str,
    /// What the program does now.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub execution: Option<&'static str>,
    /// What leads the axes now.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub mode: Option<&'static str>,
    /// What has stopped the machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub alarm: Option<AlarmBody>,
    /// A sentence: of a notice, or of a feature and its verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub text: Option<String>,
}

impl EventBody {
    /// Of an event of the control.
    pub(crate) fn of(journaled: &Journaled, shown: Shown<'_>) -> Self {
        let mut body = Self {
            id: journaled.id,
            time_s: journaled.time.value(),
            event: "notice",
            execution: None,
            mode: None,
            alarm: None,
            text: None,
        };
        match &*journaled.event {
            Event::Execution(execution) => {
                body.event = "execution";
                body.execution = Some(execution.name());
            }
            Event::Mode(mode) => {
                body.event = "mode";
                body.mode = Some(mode.name());
            }
            Event::DrivesReady => body.event = "drives_ready",
            Event::Alarm(alarm) => {
                body.event = "alarm";
                body.alarm = Some(AlarmBody::of(alarm, shown));
            }
            Event::Notice(text) => body.text = Some(on_page(&shown(text))),
            Event::Feature(feature) => {
                body.event = "feature";
                body.text = Some(said_of(feature));
            }
        }
        body
    }
}

/// What has happened since an event.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct EventsBody {
    /// Oldest first.
    pub events: Vec<EventBody>,
    /// Number of the last event that there is.
    #[ts(type = "number")]
    pub last: u64,
    /// How many are no longer kept.
    #[ts(type = "number")]
    pub lost: u64,
}

/// Who commands.
#[derive(Clone, Debug, Default, PartialEq, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct OperatorBody {
    /// Name of the session that does.
    pub holder: Option<String>,
    /// Name of the session that asks for it.
    pub asked_by: Option<String>,
    /// When it is handed over without an answer.
    pub hands_over_in_s: Option<f64>,
}

/// A session.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct SessionBody {
    /// Its id, a secret: sent as `x-leadscrew-session`.
    pub session: String,
    /// Its name.
    pub name: String,
    /// `operator`, `viewer`.
    pub role: &'static str,
    /// It has the right to command now.
    pub commands: bool,
}
