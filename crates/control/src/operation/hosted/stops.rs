//! Requests that stop: they wait in no queue. Each acts at once by its flag
//! ([`StopLane`](servo::StopLane)) on what moves, whatever else is asked for; what the control
//! makes of it follows before the next job, and many that ask for the same are one. What was asked
//! for before a stop and has not begun does not begin after it.
use super::refusal::RefusalData;
use crate::operation::{Accepted, Request, SequenceOrder};
use servo::{LaneStop, StopLane};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Where an answer goes.
type Answered = Box<dyn FnOnce(Result<Accepted, RefusalData>) + Send>;

/// Askers of one kind of stop that wait for its answer; the next one's stop acts all the same.
const MOST_ASKERS: usize = 4096;

/// The stops, in the order in which they are dealt with.
const KINDS: [LaneStop; 4] =
    [LaneStop::EmergencyStop, LaneStop::Stop, LaneStop::FeedHold, LaneStop::JogStop];

/// See the module's header.
pub(super) struct Stops {
    lane: Arc<StopLane>,
    /// The emergency stop chain is within reach; the one of a machine in another process is its
    /// own.
    has_chain: bool,
    is_asked: AtomicBool,
    askers: Mutex<[Vec<Answered>; KINDS.len()]>,
    /// How often each kind was asked for.
    counts: [AtomicU64; KINDS.len()],
}

/// How often each kind of stop had been asked for at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StopMark([u64; KINDS.len()]);

/// Which stop a request is; `None`: it is none.
pub(super) const fn kind(request: &Request) -> Option<LaneStop> {
    match request {
        Request::EmergencyStop(true) => Some(LaneStop::EmergencyStop),
        Request::Stop => Some(LaneStop::Stop),
        Request::FeedHold => Some(LaneStop::FeedHold),
        Request::JogStop => Some(LaneStop::JogStop),
        _ => None,
    }
}

/// What a request sets going.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Begins {
    Nothing,
    /// A program, or blocks that are typed.
    Program,
    /// What is moved by hand.
    Manual,
    /// The way of an engaged tool out of its thread.
    Retract,
    /// Drives that may be switched on.
    Drives,
}

/// What a request sets going; a new request has to say it.
const fn begins(request: &Request) -> Begins {
    match request {
        Request::Start
        | Request::ManualDataInput(_)
        | Request::Sequence(
            SequenceOrder::GoOn
            | SequenceOrder::Undo
            | SequenceOrder::Step
            | SequenceOrder::StepBack,
        )
        | Request::Resume
        | Request::Confirm => Begins::Program,
        Request::Home(_)
        | Request::Jog(..)
        | Request::TurnSpindle(..)
        | Request::OrientSpindle(..) => Begins::Manual,
        Request::Retract | Request::Recover => Begins::Retract,
        Request::Power(true) | Request::EmergencyStop(false) => Begins::Drives,
        Request::Power(false)
        | Request::EmergencyStop(true)
        | Request::JogStop
        | Request::Load(_)
        | Request::LoadAs(..)
        | Request::Search(..)
        | Request::FeedHold
        | Request::Stop
        | Request::Sequence(
            SequenceOrder::Done(_) | SequenceOrder::Carousel(_) | SequenceOrder::Pocket(..),
        )
        | Request::ToolIsFree
        | Request::BeginWorkpiece(_)
        | Request::EndWorkpiece
        | Request::AcknowledgeState
        | Request::Reset
        | Request::SingleBlock(_)
        | Request::OptionalStop(_)
        | Request::Flood(_)
        | Request::Mist(_)
        | Request::BlockSkip(..)
        | Request::FeedOverride(_)
        | Request::RapidOverride(_)
        | Request::SpindleOverride(_)
        | Request::TouchOff(..)
        | Request::SetWorkOffset(..)
        | Request::EditTool(..)
        | Request::RenewTool(_)
        | Request::LimitTool(..) => Begins::Nothing,
    }
}

/// Whether a stop is meant for what a request sets going.
const fn concerns(stop: LaneStop, request: &Request) -> bool {
    match (stop, begins(request)) {
        (_, Begins::Nothing) => false,
        (LaneStop::EmergencyStop | LaneStop::NotTaken, _) => true,
        (LaneStop::Stop, begun) => !matches!(begun, Begins::Drives),
        (LaneStop::FeedHold, begun) => matches!(begun, Begins::Program),
        (LaneStop::JogStop, begun) => matches!(begun, Begins::Manual),
    }
}

impl Stops {
    pub(super) fn new(lane: Arc<StopLane>, has_chain: bool) -> Self {
        Self {
            lane,
            has_chain,
            is_asked: AtomicBool::default(),
            askers: Mutex::default(),
            counts: Default::default(),
        }
    }

    /// The stops that were asked for until now.
    pub(super) fn mark(&self) -> StopMark {
        StopMark(self.counts.each_ref().map(|count| count.load(Ordering::Acquire)))
    }

    /// The stop that has come since a mark and is meant for what this request would begin.
    pub(super) fn since(&self, mark: StopMark, request: &Request) -> Option<LaneStop> {
        let counts = KINDS.into_iter().zip(self.mark().0).zip(mark.0);
        let mut came = counts.filter(|((_, count), before)| count != before);
        came.find_map(|((stop, _), _)| concerns(stop, request).then_some(stop))
    }

    fn askers(&self) -> MutexGuard<'_, [Vec<Answered>; KINDS.len()]> {
        self.askers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stop, and wait for what the control makes of it.
    pub(super) fn ask(&self, stop: LaneStop, answer: Answered) -> Result<(), RefusalData> {
        let at = KINDS.iter().position(|kind| *kind == stop).unwrap_or(0); // all kinds are there
        // held until the flag is set: it never acts after the control has dealt with the request
        let mut askers = self.askers();
        self.counts[at].fetch_add(1, Ordering::Release);
        self.act(stop);
        if askers[at].len() == MOST_ASKERS {
            return Err(RefusalData::busy(MOST_ASKERS));
        }
        askers[at].push(answer);
        self.is_asked.store(true, Ordering::Release);
        Ok(())
    }

    /// The control in this thread has dealt with a stop between two periods: its flag does not act
    /// on what begins before the next one. A stop that is asked for meanwhile is dealt with before.
    pub(super) fn is_dealt_with(&self, request: &Request) {
        match kind(request) {
            // its flag stops at once, where the chain opens in the next period
            None | Some(LaneStop::EmergencyStop | LaneStop::NotTaken) => {}
            Some(stop) => self.lane.withdraw(stop),
        }
    }

    fn act(&self, stop: LaneStop) {
        if stop == LaneStop::EmergencyStop && !self.has_chain {
            self.lane.ask(LaneStop::Stop);
            self.lane.ask(LaneStop::JogStop);
        } else {
            self.lane.ask(stop);
        }
    }

    /// The requests that wait, each with all who have asked for it.
    pub(super) fn take(&self) -> Vec<(Request, Vec<Answered>)> {
        if !self.is_asked.swap(false, Ordering::AcqRel) {
            return Vec::new();
        }
        let askers = std::mem::take(&mut *self.askers());
        let asked = KINDS.into_iter().zip(askers).filter(|(_, askers)| !askers.is_empty());
        asked.map(|(stop, askers)| (request(stop), askers)).collect()
    }
}

const fn request(stop: LaneStop) -> Request {
    match stop {
        LaneStop::EmergencyStop | LaneStop::NotTaken => Request::EmergencyStop(true),
        LaneStop::Stop => Request::Stop,
        LaneStop::FeedHold => Request::FeedHold,
        LaneStop::JogStop => Request::JogStop,
    }
}
