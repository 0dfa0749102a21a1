//! What must be on the disk before a tap, or another tool that is tied to a spindle, may touch the
//! work.
//!
//! ```text
//!   positioning          at the hole, spindle held           in, braking      bottom            out
//!   ── request Inward ─► acknowledged? ── yes ─────────────► In ─ Outward ──► acknowledged? ──► … ── Out ──►
//!      (θ₀ foreseen)          │ no: wait, alarm after RECORD_WAIT                 no: wait, TURN_WAIT at most
//!                             └ not written: alarm at once
//! ```
//!
//! The turn at the bottom is asked for while the tap still brakes on its way in, so that it is on
//! the disk before the tap turns back and the tap waits for no disk. A disk that takes longer than
//! [`TURN_WAIT`] does not keep a tap in its hole.
//!
//! The kernel has no files. It says what to write as a [`RecordRequest`] and goes in only after
//! [`crate::Kernel::acknowledge`]. Between two holes the spindle is held at the angle at which the
//! last tap left it, so θ₀ of the next one is known while the axes are still on their way, and no
//! tap waits. Where it comes otherwise, the request is renewed at the hole.
use alloc::collections::VecDeque;
use motion::{TapPlan, TiedCut, WayOut};
use units::{Angle, Lead, LeadGrowth, Length, Spin, Time};

/// How long a tap waits for its record.
pub const RECORD_WAIT: Time = Time::s(2.0);
/// How long before the bottom the turn is asked for, at least; and how long a tap waits there for a
/// disk that hangs.
pub(crate) const TURN_AHEAD: Time = Time::s(0.05);
pub(crate) const TURN_WAIT: Time = Time::s(0.5);
/// And how often it looks meanwhile.
pub(crate) const TURN_AGAIN: Time = Time::s(0.01);
/// Requests that have not been taken yet; there are never more than three.
const MOST_REQUESTS: usize = 8;
/// A foreseen angle is right within this, rev.
const SAME_ANGLE: f64 = 1e-6;
/// Two strokes lie on one line within this, mm.
const SAME_LINE: f64 = 1e-6;

/// A tool in the work, as it must be known to take it out. Coordinates are those of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WorkRecord {
    /// What it cuts, unless it taps.
    pub cut: Option<TiedCut>,
    /// The axis that takes it off the work first, where it is clear, and on which side that is; a
    /// tap has none.
    pub retreat: Option<(u8, Length, f64)>,
    /// Index of the op.
    pub op: u32,
    /// Its program line.
    pub line: u32,
    /// The tool in the spindle.
    pub tool: u32,
    /// Index of the axis along the thread; where there is no thread, of the infeed axis.
    pub axis: u8,
    /// Which spindle leads.
    pub spindle: u8,
    /// Angle of the spindle …
    pub theta0: Angle,
    /// … to which this place of the axis belongs.
    pub z0: Length,
    /// Axis travel per positive turn; zero where there is no thread.
    pub lead: Lead,
    /// By how much that grows with each turn of a turned thread.
    pub growth: LeadGrowth,
    /// Where the way out ends.
    pub start: Length,
    /// Where the spindle turns back.
    pub bottom: Length,
    /// Where the material begins.
    pub surface: Length,
    /// Highest speed, signed as on the way in.
    pub spin: Spin,
}

/// What the writer of sync records is to put on the disk.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RecordRequest {
    /// The tap is about to go in; to be acknowledged by this number.
    Inward(u32, WorkRecord),
    /// It is about to turn back; to be acknowledged by this number.
    Outward(u32),
    /// It is out.
    Out,
}

/// Requests on their way to the writer of sync records, and which of them are on the disk.
#[derive(Clone, Debug)]
pub(crate) struct RecordRequests {
    on: bool,
    requests: VecDeque<RecordRequest>,
    asked: Option<WorkRecord>,
    /// Number of the last request, and of the last one to go in.
    number: u32,
    inward: u32,
    acknowledged: bool,
    /// Number of the request to turn back, and whether it is on the disk.
    turn: Option<(u32, bool)>,
    refused: bool,
}

/// Whether a tap may go in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Permission {
    /// It may.
    Granted,
    /// Not yet.
    Waiting,
    /// Never: the record could not be written.
    Refused,
}

impl WorkRecord {
    /// Of a plan, for a coupling that has the axis at the plan's start when the spindle is at this
    /// angle.
    pub(crate) fn of(plan: &TapPlan, op: u32, line: u32, tool: u32, theta0: Angle) -> Self {
        let start = plan.start.along(plan.axis).of_linear();
        Self {
            cut: None,
            retreat: None,
            op,
            line,
            tool,
            axis: plan.axis.index() as u8,
            spindle: plan.spindle,
            theta0,
            z0: start,
            lead: plan.lead,
            growth: LeadGrowth::ZERO,
            start,
            bottom: plan.bottom,
            surface: plan.surface,
            spin: plan.spin,
        }
    }

    /// Of a way out.
    pub(crate) fn of_way_out(way_out: &WayOut, op: u32, line: u32, tool: u32) -> Self {
        let (infeed, clear) = (way_out.infeed.index() as u8, way_out.clear);
        let record = Self {
            cut: Some(way_out.cut),
            retreat: Some((infeed, clear, way_out.outward)),
            op,
            line,
            tool,
            axis: infeed,
            spindle: way_out.spindle,
            theta0: Angle::ZERO,
            z0: clear,
            lead: Lead::ZERO,
            growth: LeadGrowth::ZERO,
            start: clear,
            bottom: clear,
            surface: clear,
            spin: Spin::ZERO,
        };
        let Some(pass) = &way_out.pass else { return record };
        Self {
            axis: pass.axis.index() as u8,
            theta0: pass.angle,
            z0: pass.start,
            lead: pass.lead,
            growth: pass.growth,
            start: pass.from,
            bottom: pass.end,
            surface: pass.surface,
            spin: pass.spin,
            ..record
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = (self.theta0 - other.theta0).value().abs() < SAME_ANGLE;
        near && Self { theta0: other.theta0, ..*self } == *other
    }

    /// On the same line of the same operation.
    fn continues(&self, other: &Self) -> bool {
        let off = other.z0 + other.lead * (self.theta0 - other.theta0) - self.z0;
        let taps = self.cut.is_none() && other.cut.is_none();
        taps && self.op == other.op && self.lead == other.lead && off.value().abs() < SAME_LINE
    }
}

impl RecordRequests {
    pub(crate) fn new() -> Self {
        Self {
            on: false,
            requests: VecDeque::with_capacity(MOST_REQUESTS),
            asked: None,
            number: 0,
            inward: 0,
            acknowledged: false,
            turn: None,
            refused: false,
        }
    }

    pub(crate) const fn begin(&mut self) {
        self.on = true;
    }

    pub(crate) const fn is_on(&self) -> bool {
        self.on
    }

    pub(crate) fn take(&mut self) -> Option<RecordRequest> {
        self.requests.pop_front()
    }

    pub(crate) fn acknowledge(&mut self, number: u32) {
        if let Some((_, on_disk)) = self.turn.as_mut().filter(|(turn, _)| *turn == number) {
            *on_disk = true;
            return;
        }
        self.acknowledged |= number == self.inward && self.asked.is_some();
    }

    pub(crate) const fn refuse(&mut self) {
        self.refused = true;
    }

    /// Ask for a record, if it is not the one that was asked for already; whether the tap may go
    /// in.
    pub(crate) fn ask(&mut self, record: &WorkRecord) -> Permission {
        if !self.on {
            return Permission::Granted;
        }
        if self.refused {
            return Permission::Refused;
        }
        self.turn = None;
        let mut record = *record;
        let before = self.asked;
        if let Some(before) = before.filter(|before| record.continues(before)) {
            // a further peck: the way out ends where the first one began
            record.start = before.start;
            record.z0 = before.z0;
            record.theta0 = before.theta0;
        }
        if !before.is_some_and(|before| record.is_like(&before)) {
            self.inward = self.next_number();
            // what is on the disk already leads out on the same line
            self.acknowledged &= before.is_some_and(|before| record.continues(&before));
            self.asked = Some(record);
            self.request(RecordRequest::Inward(self.inward, record));
        }
        if self.acknowledged { Permission::Granted } else { Permission::Waiting }
    }

    /// The tap is about to turn back; whether that is on the disk. What cannot be written keeps no
    /// tap in its hole.
    pub(crate) fn turn(&mut self) -> Permission {
        if !self.on || self.asked.is_none() || self.refused {
            return Permission::Granted;
        }
        let Some((_, on_disk)) = self.turn else {
            let number = self.next_number();
            self.turn = Some((number, false));
            self.request(RecordRequest::Outward(number));
            return Permission::Waiting;
        };
        if on_disk { Permission::Granted } else { Permission::Waiting }
    }

    const fn next_number(&mut self) -> u32 {
        self.number = self.number.wrapping_add(1);
        self.number
    }

    /// The tap is out.
    pub(crate) fn out(&mut self) {
        if self.on && self.asked.is_some() {
            self.asked = None;
            self.acknowledged = false;
            self.request(RecordRequest::Out);
        }
    }

    fn request(&mut self, request: RecordRequest) {
        if self.requests.len() == MOST_REQUESTS {
            self.requests.pop_front();
        }
        self.requests.push_back(request);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(op: u32, start: f64, bottom: f64) -> WorkRecord {
        WorkRecord {
            cut: None,
            retreat: None,
            op,
            line: 7,
            tool: 3,
            axis: 2,
            spindle: 0,
            theta0: Angle::rev(5.0),
            z0: Length::mm(start),
            lead: Lead::mm_per_rev(-1.0),
            growth: LeadGrowth::ZERO,
            start: Length::mm(start),
            bottom: Length::mm(bottom),
            surface: Length::ZERO,
            spin: Spin::rpm(1000.0),
        }
    }

    fn requests() -> RecordRequests {
        let mut requests = RecordRequests::new();
        requests.begin();
        requests
    }

    #[test]
    fn nobody_who_writes_means_nobody_who_waits() {
        assert_eq!(RecordRequests::new().ask(&record(1, 5.0, -10.0)), Permission::Granted);
    }

    #[test]
    fn a_tap_waits_for_its_own_acknowledgement() {
        let mut requests = requests();
        let first = record(1, 5.0, -10.0);
        assert_eq!(requests.ask(&first), Permission::Waiting);
        assert_eq!(requests.take(), Some(RecordRequest::Inward(1, first)));
        requests.acknowledge(9);
        assert_eq!(requests.ask(&first), Permission::Waiting);
        requests.acknowledge(1);
        assert_eq!(requests.ask(&first), Permission::Granted);
        assert_eq!(requests.take(), None);
    }

    #[test]
    fn an_angle_that_was_not_foreseen_is_asked_for_anew() {
        let mut requests = requests();
        let first = record(1, 5.0, -10.0);
        requests.ask(&first);
        requests.acknowledge(1);
        let other = WorkRecord { theta0: Angle::rev(6.0), ..first };
        assert_eq!(requests.ask(&other), Permission::Waiting);
        requests.acknowledge(1);
        assert_eq!(requests.ask(&other), Permission::Waiting);
        requests.acknowledge(2);
        assert_eq!(requests.ask(&other), Permission::Granted);
    }

    #[test]
    fn a_further_peck_on_the_same_line_does_not_wait_and_leads_out_to_the_first_ones_start() {
        let mut requests = requests();
        let first = record(1, 5.0, -4.0);
        requests.ask(&first);
        requests.acknowledge(1);
        requests.take();
        let second = WorkRecord { theta0: Angle::rev(13.0), ..record(1, -3.0, -8.0) };
        assert_eq!(requests.ask(&second), Permission::Granted);
        let Some(RecordRequest::Inward(2, written)) = requests.take() else {
            panic!("nothing to write")
        };
        let expected = WorkRecord { bottom: Length::mm(-8.0), ..first };
        assert_eq!(written, expected);
    }

    #[test]
    fn what_could_not_be_written_is_never_granted() {
        let mut requests = requests();
        requests.ask(&record(1, 5.0, -10.0));
        requests.refuse();
        requests.acknowledge(1);
        assert_eq!(requests.ask(&record(1, 5.0, -10.0)), Permission::Refused);
    }

    #[test]
    fn a_tap_turns_back_once_that_is_on_the_disk_and_a_further_peck_asks_anew() {
        let mut requests = requests();
        let first = record(1, 5.0, -4.0);
        requests.ask(&first);
        requests.acknowledge(1);
        requests.take();
        assert_eq!((requests.turn(), requests.turn()), (Permission::Waiting, Permission::Waiting));
        assert_eq!((requests.take(), requests.take()), (Some(RecordRequest::Outward(2)), None));
        requests.acknowledge(1);
        assert_eq!(requests.turn(), Permission::Waiting);
        requests.acknowledge(2);
        assert_eq!(requests.turn(), Permission::Granted);
        let second = WorkRecord { theta0: Angle::rev(13.0), ..record(1, -3.0, -8.0) };
        assert_eq!(requests.ask(&second), Permission::Granted);
        assert_eq!(requests.turn(), Permission::Waiting);
        requests.acknowledge(4);
        assert_eq!(requests.turn(), Permission::Granted);
    }

    #[test]
    fn a_disk_that_refuses_keeps_no_tap_in_its_hole() {
        let mut requests = requests();
        requests.ask(&record(1, 5.0, -10.0));
        requests.acknowledge(1);
        assert_eq!(requests.turn(), Permission::Waiting);
        requests.refuse();
        assert_eq!(
            (requests.turn(), RecordRequests::new().turn()),
            (Permission::Granted, Permission::Granted)
        );
    }

    #[test]
    fn after_a_hole_the_next_one_asks_again() {
        let mut requests = requests();
        requests.ask(&record(1, 5.0, -10.0));
        requests.acknowledge(1);
        requests.out();
        requests.out();
        requests.take();
        assert_eq!((requests.take(), requests.take()), (Some(RecordRequest::Out), None));
        assert_eq!(requests.ask(&record(2, 5.0, -10.0)), Permission::Waiting);
    }
}
