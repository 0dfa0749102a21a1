//! What a report needs to remember of a run: fed period by period, in a room that does not grow.
//!
//! ```text
//!   canon::Op ──► taps still to come ─┐
//!   bus::Sample ─┬────────────────────┴─► the tap in progress ─► kept: the first, the worst few
//!                ├─► track: the tool's path, thinned
//!                ├─► shares: seconds per state and tool
//!                └─► timeline: spindle speed, lowest and highest per bin
//! ```

mod chips;
mod floating;
pub(crate) mod frames;
mod lines;
mod pace;
mod series;
mod shares;
mod tap;
#[cfg(test)]
mod tests;
mod track;

pub(crate) use chips::{ChipRow, Chips, Hop};
pub(crate) use floating::{Floating, Moment};
use frames::Frames;
use lines::Lines;
pub(crate) use lines::Turning;
pub use pace::AxisLimits;
pub(crate) use pace::{CLASSES, Limiter, Pace, class_bounds};
pub(crate) use series::Series;
pub(crate) use shares::{Shares, SharesByTool};
pub(crate) use tap::TapTrace;
pub(crate) use track::{Point, Track};

use crate::Measure;
use crate::run::Origin;
use bus::{Sample, State};
use canon::{Axis, LengthUnit, Op, OpKind, ProgramFrame, Tap, ToolLibrary};
use std::collections::BTreeMap;
use units::{Angle, Length, Time};

/// Taps whose curves are kept beside the first's: those with the largest synchronisation error.
pub const WORST_KEPT: usize = 3;
/// Tool changes that are marked on the timeline.
const CHANGES: usize = 200;

/// Remembers of a run what its report shows.
#[derive(Clone, Debug, Default)]
pub struct Recorder {
    /// Tool length by tool number.
    lengths: BTreeMap<u32, Length>,
    /// Taps that have been announced and not yet begun.
    announced: BTreeMap<u32, Tap>,
    current: Option<TapTrace>,
    pub(crate) first: Option<TapTrace>,
    pub(crate) worst: Vec<TapTrace>,
    pub(crate) track: Track,
    /// Speeds along it, and what limited them.
    pub(crate) pace: Box<Pace>,
    pub(crate) shares: SharesByTool,
    pub(crate) spindle: Series,
    pub(crate) changes: Vec<(Time, u32)>,
    /// Chip removals.
    pub(crate) chips: Chips,
    /// The first tap that is tied to nothing.
    pub(crate) floating: Floating,
    pub(crate) taps: usize,
    /// Taps in which the spindle's drive was at its limit.
    pub(crate) saturated: usize,
    /// The longest time it was so in one of them.
    pub(crate) saturated_longest: Time,
    /// How the program wrote what it ordered.
    pub(crate) frames: Frames,
    /// What its lines took.
    pub(crate) lines: Lines,
    /// Something was turned: with a single point (X is its radius), or with a tool that turns
    /// itself.
    turns: Option<bool>,
    /// Unit in which lengths are shown; `None`: the program's.
    unit: Option<LengthUnit>,
    periods: u64,
    tool: Option<u32>,
    /// Its length.
    length: Length,
    rapid: bool,
    previous: Option<(Time, Angle)>,
}

impl Recorder {
    /// A recorder for a run with these tools: their lengths turn axis positions into those of the
    /// tip.
    pub fn new(tools: &ToolLibrary) -> Self {
        let lengths = tools.iter().map(|tool| (tool.number, tool.worn_length())).collect();
        Self { lengths, rapid: true, ..Self::default() }
    }

    /// Say what the axes can do, so that the report can say what limited them.
    #[must_use]
    pub fn limited(mut self, limits: AxisLimits) -> Self {
        self.pace.limits(limits);
        self
    }

    /// Show lengths in this unit, whatever the program writes.
    #[must_use]
    pub const fn shown_in(mut self, unit: Option<LengthUnit>) -> Self {
        self.unit = unit;
        self
    }

    /// How lengths are shown: as the program writes them, unless a unit was asked for.
    pub fn measure(&self) -> Measure {
        Measure { unit: self.unit.or_else(|| self.frames.unit()).unwrap_or_default() }
    }

    /// Say how the program has written the operation that was announced last.
    pub fn frame(&mut self, index: u32, frame: ProgramFrame) {
        self.frames.put(index, frame);
    }

    /// Zero of the work offset in which an operation was programmed, in machine coordinates;
    /// `None`: the interpreter has not reported one, or it is turned.
    pub fn zero_of(&self, op: u32) -> Option<canon::Position> {
        self.frames.of(op).filter(|frame| frame.work_offset > 0).and_then(frames::zero)
    }

    /// The work offset in which everything was cut, if there is only one and it is not turned.
    pub fn origin(&self) -> Option<Origin> {
        let frame = self.frames.only().filter(|frame| frame.work_offset > 0)?;
        Some(Origin { name: frames::name(frame), at: frames::zero(frame)? })
    }

    /// Whether the path is a lathe's, and if so whether its X is shown as a diameter: of two
    /// spindles that turn against each other X is the distance of their axes.
    pub(crate) fn turned_by_diameter(&self) -> Option<bool> {
        let by_words = self.frames.only().is_some_and(|frame| frame.x_is_diameter);
        (self.turns.is_some() || by_words).then(|| self.turns.unwrap_or(true))
    }

    /// Announce an operation, before the machine begins it. `index` counts from 0 in program order.
    pub fn op(&mut self, index: u32, op: &Op) {
        self.chips.op(index, op);
        self.pace.op(index, op);
        self.frames.op(&op.kind);
        self.lines.op(index, op);
        match &op.kind {
            OpKind::Threading(_) => self.turns = Some(true),
            OpKind::Polygon(_) | OpKind::Cam(_) | OpKind::Hob(_) => self.turns = Some(false),
            _ => {}
        }
        if let OpKind::Tap(tap) = &op.kind {
            self.announced.insert(index, *tap);
        }
    }

    /// Record a servo period.
    pub fn sample(&mut self, sample: &Sample) {
        self.periods += 1;
        let now = sample.feedback.time;
        let state = sample.report.state;
        if let Some((before, was)) = self.previous {
            let period = now - before;
            let turning = self.lines.turning(sample);
            self.shares.push(state, turning, sample.feedback.tool, period);
            self.lines.push(sample, period);
            if period > Time::ZERO {
                let angle = sample.feedback.spindles[0].angle;
                let spin = sample.truth.as_ref().map_or((angle - was) / period, |t| t.spins[0]);
                self.spindle.push(now.value(), spin.in_rpm());
            }
        }
        self.previous = Some((now, sample.feedback.spindles[0].angle));
        self.tip(sample);
        self.chips.sample(sample, self.length);
        if let Some(tap) = self.announced.get(&sample.report.op) {
            self.floating.sample(tap, sample);
        }
        if matches!(state, State::TapIn | State::TapBottom | State::TapOut) {
            self.tapping(sample);
        } else if self.current.is_some() && !matches!(state, State::Paused | State::Held) {
            self.end_tap(state != State::Faulted);
        }
    }

    fn tip(&mut self, sample: &Sample) {
        let Some(tool) = sample.feedback.tool else { return };
        let lifted = self.tool != Some(tool);
        if lifted {
            self.tool = Some(tool);
            self.length = self.lengths.get(&tool).copied().unwrap_or(Length::ZERO);
            if self.changes.len() < CHANGES {
                self.changes.push((sample.feedback.time, tool));
            }
        }
        let z = sample.axis(Axis::Z.index()).of_linear() - self.length;
        let at =
            [sample.axis(Axis::X.index()).value(), sample.axis(Axis::Y.index()).value(), z.value()];
        match sample.report.state {
            State::Rapid => self.rapid = true,
            State::Feed | State::TapIn | State::TapBottom | State::TapOut => self.rapid = false,
            // standing still belongs to the move before it
            State::Idle
            | State::Manual
            | State::Dwell
            | State::SpindleWait
            | State::Settle
            | State::ToolChange
            | State::Couple
            | State::Measure
            | State::Paused
            | State::Held
            | State::Recovering
            | State::Faulted
            | State::Ended => {}
        }
        let report = &sample.report;
        let line = if self.lines.is_elsewhere(report.op) { 0 } else { report.line };
        let point = Point { at, rapid: self.rapid, lifted, class: 0, line };
        self.track.push(point);
        self.pace.sample(sample, point);
    }

    fn tapping(&mut self, sample: &Sample) {
        let op = sample.report.op;
        if self.current.as_ref().is_some_and(|trace| trace.op != op) {
            self.end_tap(true);
        }
        if self.current.is_none() {
            let Some(tap) = self.announced.remove(&op) else { return };
            while self.announced.first_key_value().is_some_and(|(&before, _)| before < op) {
                self.announced.pop_first(); // it will not come any more
            }
            self.current = Some(TapTrace::begin(op, &tap, sample));
        }
        if let Some(trace) = &mut self.current {
            trace.push(sample);
        }
    }

    fn end_tap(&mut self, in_step: bool) {
        let Some(mut trace) = self.current.take() else { return };
        trace.end(in_step);
        self.taps += 1;
        self.saturated += usize::from(trace.saturated_for > Time::ZERO);
        self.saturated_longest = self.saturated_longest.max(trace.saturated_for);
        if self.first.is_none() {
            self.first = Some(trace.clone());
        }
        let place = self.worst.iter().position(|kept| trace.is_worse_than(kept));
        self.worst.insert(place.unwrap_or(self.worst.len()), trace);
        self.worst.truncate(WORST_KEPT);
    }

    /// The taps whose curves were kept: the worst ones, worst first, and the first of the run at
    /// the end if it is not among them. A tap in progress counts as one that did not come out.
    pub(crate) fn kept_taps(&self) -> Vec<&TapTrace> {
        let mut kept: Vec<&TapTrace> = self.current.iter().chain(&self.worst).collect();
        if let Some(first) = &self.first
            && kept.iter().all(|trace| trace.op != first.op)
        {
            kept.push(first);
        }
        kept
    }

    /// Servo periods recorded.
    pub const fn periods(&self) -> u64 {
        self.periods
    }
}
