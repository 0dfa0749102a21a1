//! What each request needs: the control's own table, for clients that say before they ask what
//! would be refused.
use control::job::restart::From as Begin;
use control::operation::{Jog, Need, Request, SequenceOrder, ToolField};
use serde::Serialize;
use units::{Angle, Coordinate, CoordinateSpeed, Spin};

/// A request, and what it needs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RequestNeeds {
    /// Its name, as in `POST request`.
    pub request: &'static str,
    /// Of one that switches something whose needs differ: which way.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[ts(optional)]
    pub on: Option<bool>,
    /// Names of what has to be so, in the order in which it is looked at; `unmet` of the status
    /// says which is not so now.
    pub needs: Vec<&'static str>,
}

impl RequestNeeds {
    /// Of every request.
    pub(crate) fn all() -> Vec<Self> {
        samples().iter().map(Self::of).collect()
    }

    fn of(request: &Request) -> Self {
        let (request, on, needs) = (name(request), switched(request), request.needs());
        Self { request, on, needs: needs.iter().map(Need::name).collect() }
    }
}

/// One of each kind.
fn samples() -> Vec<Request> {
    let (axis, text) = (canon::Axis::X, String::new());
    vec![
        Request::Power(true),
        Request::Power(false),
        Request::EmergencyStop(true),
        Request::EmergencyStop(false),
        Request::Home(None),
        Request::Jog(axis, Jog::Continuous(CoordinateSpeed::ZERO)),
        Request::Jog(axis, Jog::Increment(Coordinate::ZERO)),
        Request::Jog(axis, Jog::To(Coordinate::ZERO)),
        Request::Jog(axis, Jog::Handwheel(Coordinate::ZERO)),
        Request::JogStop,
        Request::TurnSpindle(0, Spin::ZERO),
        Request::OrientSpindle(0, Angle::ZERO),
        Request::Load(text.clone().into()),
        Request::Search(Begin::Line(1), false),
        Request::Start,
        Request::ManualDataInput(text),
        Request::FeedHold,
        Request::Resume,
        Request::Confirm,
        Request::Stop,
        Request::Retract,
        Request::Recover,
        Request::ToolIsFree,
        Request::Sequence(SequenceOrder::GoOn),
        Request::Sequence(SequenceOrder::Undo),
        Request::Sequence(SequenceOrder::Step),
        Request::Sequence(SequenceOrder::StepBack),
        Request::Sequence(SequenceOrder::Done(0)),
        Request::Sequence(SequenceOrder::Carousel(1)),
        Request::Sequence(SequenceOrder::Pocket(1, 0)),
        Request::BeginWorkpiece(None),
        Request::EndWorkpiece,
        Request::AcknowledgeState,
        Request::Reset,
        Request::SingleBlock(true),
        Request::OptionalStop(true),
        Request::Flood(true),
        Request::Mist(true),
        Request::BlockSkip(1, true),
        Request::FeedOverride(1.0),
        Request::RapidOverride(1.0),
        Request::SpindleOverride(1.0),
        Request::TouchOff(axis, Coordinate::ZERO),
        Request::SetWorkOffset(1, axis, Coordinate::ZERO),
        Request::EditTool(1, ToolField::Length, 0.0),
        Request::RenewTool(1),
        Request::LimitTool(1, None),
    ]
}

/// As a client writes it.
const fn name(request: &Request) -> &'static str {
    match request {
        Request::Power(_) => "power",
        Request::EmergencyStop(_) => "emergency_stop",
        Request::Home(_) => "home",
        Request::Jog(_, Jog::Continuous(_)) => "jog_continuous",
        Request::Jog(_, Jog::Increment(_)) => "jog_increment",
        Request::Jog(_, Jog::To(_)) => "jog_to",
        Request::Jog(_, Jog::Handwheel(_)) => "handwheel",
        Request::JogStop => "jog_stop",
        Request::TurnSpindle(..) => "turn_spindle",
        Request::OrientSpindle(..) => "orient_spindle",
        Request::Load(_) | Request::LoadAs(..) => "load",
        Request::Search(..) => "search",
        Request::Start => "start",
        Request::ManualDataInput(_) => "manual_data_input",
        Request::FeedHold => "feed_hold",
        Request::Resume => "resume",
        Request::Confirm => "confirm",
        Request::Stop => "stop",
        Request::Retract => "retract",
        Request::Recover => "recover",
        Request::ToolIsFree => "tool_is_free",
        Request::Sequence(SequenceOrder::GoOn) => "sequence_go_on",
        Request::Sequence(SequenceOrder::Undo) => "sequence_undo",
        Request::Sequence(SequenceOrder::Step) => "sequence_step",
        Request::Sequence(SequenceOrder::StepBack) => "sequence_step_back",
        Request::Sequence(SequenceOrder::Done(_)) => "sequence_done",
        Request::Sequence(SequenceOrder::Carousel(_)) => "carousel_is_at",
        Request::Sequence(SequenceOrder::Pocket(..)) => "set_pocket",
        Request::BeginWorkpiece(_) => "begin_workpiece",
        Request::EndWorkpiece => "end_workpiece",
        Request::AcknowledgeState => "acknowledge_state",
        Request::Reset => "reset",
        Request::SingleBlock(_) => "single_block",
        Request::OptionalStop(_) => "optional_stop",
        Request::Flood(_) => "flood",
        Request::Mist(_) => "mist",
        Request::BlockSkip(..) => "block_skip",
        Request::FeedOverride(_) => "feed_override",
        Request::RapidOverride(_) => "rapid_override",
        Request::SpindleOverride(_) => "spindle_override",
        Request::TouchOff(..) => "touch_off",
        Request::SetWorkOffset(..) => "set_work_offset",
        Request::EditTool(..) => "edit_tool",
        Request::RenewTool(_) => "renew_tool",
        Request::LimitTool(..) => "limit_tool",
    }
}

/// Which way, where the two ways need different things.
const fn switched(request: &Request) -> Option<bool> {
    match request {
        Request::Power(on)
        | Request::EmergencyStop(on)
        | Request::Flood(on)
        | Request::Mist(on) => Some(*on),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::RequestBody;
    use utoipa::PartialSchema;

    #[test]
    fn every_request_that_a_client_can_write_says_what_it_needs() {
        let schema = serde_json::to_string(&RequestBody::schema()).expect("a schema");
        let all = RequestNeeds::all();
        for known in &all {
            assert!(schema.contains(&format!("\"{}\"", known.request)), "{}", known.request);
        }
        let written = schema.matches("\"request\":{").count();
        let mut names: Vec<_> = all.iter().map(|known| known.request).collect();
        names.dedup();
        assert_eq!(written, names.len(), "{names:?}");
    }

    #[test]
    fn a_start_needs_a_program_drives_and_homed_axes() {
        let all = RequestNeeds::all();
        let start = all.iter().find(|known| known.request == "start").expect("a start");
        for need in ["program_loaded", "power_on", "homed", "no_alarm"] {
            assert!(start.needs.contains(&need), "{need}: {:?}", start.needs);
        }
    }
}
