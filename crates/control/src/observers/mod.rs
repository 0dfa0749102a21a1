//! What looks on and changes nothing: the judge, the safety checks, the recorder of the report, the
//! trace, the log.
mod beside;
mod tool_use;
mod trace;

pub(crate) use beside::{BATCH, Observing};
pub use tool_use::{ToolUseCount, use_up};
pub use trace::TraceThread;

use crate::Timings;
use crate::job::Session;
use crate::services::supervision::SupervisedStroke;
use bus::Sample;
use canon::{Op, OpKind, ProgramFrame, ToolUse};
use kernel::{Event, EventKind, WaitFor};
use report::Recorder;
use std::collections::BTreeMap;
use verify::{IdleTurns, Judge, Watch};

/// More warnings than a person reads.
const MOST_WARNINGS: usize = 100;

/// What is said of a person's confirmation where no person is there.
pub fn confirmed(what: WaitFor, line: u32) -> String {
    let what = match what {
        WaitFor::Operator { optional } => format!("M{}", u8::from(optional)),
        other => other.to_string(),
    };
    format!("operator: confirmed automatically ({what} at line {line})")
}

/// Looks at everything that happens, and changes nothing.
pub trait Observer: Send {
    /// What was heard and commanded in a period.
    fn sample(&mut self, sample: &Sample);
    /// What the kernel has said.
    fn event(&mut self, event: &Event);
    /// What the program says in this line ((MSG,…), (PRINT,…)): when it is planned, a little before
    /// it is executed.
    fn message(&mut self, _line: u32, _text: &str) {}
}

/// What judges a workpiece, through all that is done to it.
#[derive(Clone)]
pub struct Workpiece {
    /// Judges what is cut.
    pub judge: Judge,
    /// Looks for what may never happen.
    pub watch: Watch,
}

impl Workpiece {
    /// Nothing has been done to it.
    pub fn new(judge: verify::Config) -> Self {
        Self { watch: Watch::new(judge.clone()), judge: Judge::new(judge) }
    }

    /// What was heard and commanded in a period.
    pub fn sample(&mut self, sample: &Sample) {
        self.judge.sample(sample);
        self.watch.sample(sample);
    }
}

/// The observers of a run.
pub struct Observers {
    /// Judges what is cut.
    pub judge: Judge,
    /// Looks for what may never happen.
    pub watch: Watch,
    /// Looks at a wheel's idle turns.
    pub idle: Option<IdleTurns>,
    /// Keeps what pictures need.
    pub recorder: Recorder,
    /// Keeps everything.
    pub trace: Option<TraceThread>,
    /// Whatever else looks on: a log, a screen.
    pub others: Vec<Box<dyn Observer>>,
    /// Counts what each tool cuts.
    pub tool_use: Option<ToolUseCount>,
    /// Measures how long the run and its judge take.
    pub timings: Timings,
    /// Periods in which drills and taps were at the spindle drive's limit, by the index of their
    /// operation.
    pub(super) saturated: BTreeMap<u32, u32>,
    /// Warnings at run time.
    pub(super) warnings: Vec<Event>,
    /// What supervision by torque saw of each stroke.
    pub(super) supervised: Vec<SupervisedStroke>,
    /// What a person would have confirmed.
    pub(super) confirmed: Vec<String>,
}

impl Observers {
    /// Judge this workpiece; keep no trace, print nothing.
    pub fn new(session: &Session, Workpiece { judge, watch }: Workpiece) -> Self {
        Self {
            watch,
            judge,
            idle: None,
            recorder: Recorder::new(&session.tools),
            trace: None,
            others: Vec::new(),
            tool_use: None,
            timings: Timings::new(false),
            saturated: BTreeMap::new(),
            warnings: Vec::new(),
            supervised: Vec::new(),
            confirmed: Vec::new(),
        }
    }

    /// What each tool has cut so far, by its number.
    pub(super) fn tool_use(&self) -> BTreeMap<u32, ToolUse> {
        self.tool_use.as_ref().map(|count| count.so_far().clone()).unwrap_or_default()
    }

    /// An operation is planned.
    pub(super) fn op(&mut self, index: u32, op: &Op, frame: ProgramFrame) {
        if let OpKind::Message(text) = &op.kind {
            for other in &mut self.others {
                other.message(op.span.line, text);
            }
        }
        self.judge.op(index, op);
        self.judge.frame(index, frame);
        if let Some(idle) = &mut self.idle {
            idle.op(index, op);
        }
        self.watch.op(index, op);
        if let Some(count) = &mut self.tool_use {
            count.op(index, op);
        }
        self.recorder.op(index, op);
        self.recorder.frame(index, frame);
    }

    /// What was heard and commanded in a period.
    pub(super) fn sample(&mut self, sample: &Sample) {
        let Self { timings, judge, .. } = self;
        timings.judging(|| judge.sample(sample));
        if let Some(idle) = &mut self.idle {
            idle.sample(sample);
        }
        self.watch.sample(sample);
        self.recorder.sample(sample);
        if let Some(trace) = &mut self.trace {
            trace.push(sample);
        }
        if let Some(count) = &mut self.tool_use {
            count.sample(sample);
        }
        for other in &mut self.others {
            other.sample(sample);
        }
        if sample.feedback.spindles[0].saturated {
            *self.saturated.entry(sample.report.op).or_insert(0) += 1;
        }
    }

    /// What the kernel has said.
    pub(super) fn event(&mut self, event: &Event) {
        for other in &mut self.others {
            other.event(event);
        }
        if let EventKind::ConfirmedAutomatically(what) = event.kind
            && self.confirmed.len() < MOST_WARNINGS
        {
            self.confirmed.push(confirmed(what, event.line));
        }
        if let EventKind::TapSupervised(seen) = event.kind {
            self.supervised.push(SupervisedStroke { op: event.op, line: event.line, seen });
        }
        let warns = matches!(
            event.kind,
            EventKind::FollowingWarning { .. } | EventKind::SyncWarning { .. }
        );
        if warns && self.warnings.len() < MOST_WARNINGS {
            self.warnings.push(*event);
        }
    }
}
