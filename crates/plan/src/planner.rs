//! From operations to steps, one op at a time; what a machine cannot do is refused and named.
//!
//! ```text
//!            ┌──────────────── Planner ────────────────┐
//!   Op ────► │ judge (travel, feed, spindle, tool, tap) │──► Diagnostic, all of them
//!            │ plan  (path × profile)                   │
//!            │ outbox (order, waiting, planned time)    │──► Step
//!            └──────────────────────────────────────────┘
//! ```
//!
//! A program is planned twice: once by [`preflight`], which keeps the findings and the time and
//! throws the steps away, and, if nothing is refused, again beside the running machine. An op that
//! is refused makes no step; the planner goes on as though it had been done, so that one mistake
//! does not hide the next.
//!
//! **Spindle.** An M3 or M4 stays in force over taps and orientations, which leave the spindle at
//! rest; it is told to turn again as early as possible before the next cut, and the first cut
//! awaits its speed.
//!
//! **Tool change.** The spindle is stopped, Z goes to the change position, then X and Y where the
//! machine has one for them, the tool is changed. The program does not know that they have moved
//! ([`tool_change`]).
use crate::cams::Cams;
use crate::coupled::Table;
use crate::findings::{Findings, number};
use crate::holes::Holes;
use crate::limits::{MachineLimits, Options};
use crate::outbox::Outbox;
use crate::settings::OperatorSettings;
use crate::signals;
use crate::stroke::{Stroke, StrokeRequest};
use crate::way_out::CameFrom;
use crate::words::WrittenFrame;
use crate::{Sample, Step, StepKind};
use alloc::{boxed::Box, format, vec::Vec};
use canon::{Axis, Op, OpKind, PathMode, Position, ProgramFrame, ToolLibrary};
use diag::{Diagnostic, Span};
use motion::{Path, SurfaceSpeed};
use units::{Length, Spin, Time, Torque};

mod cam;
mod changer;
mod chips;
mod contact;
mod coupled;
mod deep;
mod empty_spindle;
mod moves;
mod probe;
mod refuse;
mod sequence;
mod signal_check;
mod spindle;
mod spindle_override;
mod surface;
mod tap;
mod thread;
mod tool_change;
mod unsynchronised;
pub use changer::{Changer, SequenceMark};
use refuse::wild;

/// Moves shorter than this are no moves: a picometre.
const NOTHING: f64 = 1e-9;

/// Where a machine stands when a program begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Machine coordinates of the axes.
    pub position: Position,
    /// The tool in the spindle; 0 is none.
    pub tool: u32,
}

/// One spindle as the planner has ordered it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct SpindleState {
    /// What the program wants: M3, M4, M5 with S.
    ordered: Spin,
    /// What the kernel has been told.
    told: Spin,
    /// Whether a step waits for `told` to be reached.
    awaited: bool,
    /// Chips are being thrown off until then.
    throwing: bool,
    /// G96 is in force: `ordered` is its speed where the program has X.
    surface: Option<SurfaceSpeed>,
    /// The kernel has been told that.
    told_surface: Option<SurfaceSpeed>,
    /// G96 is in force, and a thread is being cut: `ordered` is the speed of its pass, and holds
    /// until something else than a pass or a rapid comes.
    held_surface: Option<SurfaceSpeed>,
}

impl SpindleState {
    /// An order has not reached the kernel yet.
    fn is_open(&self) -> bool {
        self.surface != self.told_surface || (self.surface.is_none() && self.told != self.ordered)
    }

    /// From now on it shall stand, or turn at a speed in revolutions.
    const fn order(&mut self, spin: Spin) {
        self.ordered = spin;
        (self.surface, self.held_surface) = (None, None);
    }
}

/// From operations to steps. See the module's header.
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools)] // each on its own: any of them may hold with any other
pub struct Planner {
    pub(crate) limits: MachineLimits,
    options: Options,
    /// Moves are judged and then forgotten: no law of time is found for them.
    only_judges: bool,
    tools: ToolLibrary,
    /// The first spindle turns the work, and the tool stands.
    turns_work: bool,
    /// How the program writes places now: findings are said in its words.
    frame: WrittenFrame,
    /// Where the program has the axes.
    programmed: Position,
    /// Where X, Y and Z really are, if a tool change has taken them there.
    away: tool_change::Away,
    tool: u32,
    /// A changer that a sequence works.
    changing: Option<changer::Changing>,
    /// Called by T, and not in the spindle yet.
    selected: Option<empty_spindle::SelectedTool>,
    spindles: Vec<SpindleState>,
    mode: PathMode,
    holes: Holes,
    stroke: Option<deep::UnpeckedHole>,
    /// The tool against the stock, if that is known.
    contact: Option<contact::Contact>,
    /// In and out.
    last_strokes: [Option<(StrokeRequest, Stroke)>; 2],
    warned_still: bool,
    /// Where each axis was said to be beyond its travel.
    beyond_at: [Option<f64>; Axis::ALL.len()],
    /// The last tap left the spindle reversed: forward again after the rapid back.
    reversed_along: Option<Axis>,
    /// Stretches of a turned thread that has not ended.
    chain: Vec<thread::Waiting>,
    /// How the axes came to where they are.
    came_from: CameFrom,
    coupled: coupled::Coupled,
    cams: Cams,
    /// What the wheel has lost of its radius, by the model of its wear.
    worn: Length,
    cam: Option<cam::Cam>,
    /// Profiles and speeds whose phase error the program measures.
    will_measure: Vec<(u32, Spin)>,
    /// Tables that steps name and that have not been taken yet.
    tables: Vec<Table>,
    next_table: u16,
    findings: Findings,
    /// Where each drive was hottest so far.
    hottest: [(Torque, Span); crate::heat::SPINDLES],
    pub(crate) outbox: Outbox,
    /// The operator's feed override acts.
    overridden: bool,
    /// What becomes of the spindle override.
    spindle_override: spindle_override::SpindleOverride,
    /// What the operator wants of moves to come.
    pub(crate) wanted: OperatorSettings,
}

/// Whether a wheel that follows a cam goes back before this.
const fn leaves_cam(kind: &OpKind) -> bool {
    match kind {
        OpKind::Rapid { .. }
        | OpKind::Line { .. }
        | OpKind::Arc { .. }
        | OpKind::Spline { .. }
        | OpKind::Probe(_)
        | OpKind::Tap(_)
        | OpKind::Threading(_)
        | OpKind::Hole(_)
        | OpKind::Spindle { .. }
        | OpKind::Polygon(_)
        | OpKind::PolygonMeasure { .. }
        | OpKind::PolygonEnd
        | OpKind::Hob(_)
        | OpKind::HobEnd
        | OpKind::ChangeTool { .. }
        | OpKind::Pause { .. }
        | OpKind::UserCode(_)
        | OpKind::End => true,
        OpKind::Cam(_)
        | OpKind::Dwell { .. }
        | OpKind::Coolant { .. }
        | OpKind::Output(_)
        | OpKind::Input(_)
        | OpKind::SelectTool { .. }
        | OpKind::PathMode(_)
        | OpKind::Overrides { .. }
        | OpKind::Message(_) => false,
    }
}

/// What is known of a program before it runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Preflight {
    /// All findings, in the order of the program.
    pub findings: Vec<Diagnostic>,
    /// Planned time from start to end.
    pub duration: Time,
}

impl Preflight {
    /// Whether the program is refused.
    pub fn is_refused(&self) -> bool {
        self.findings.iter().any(Diagnostic::is_error)
    }
}

/// Plan a whole program without moving: everything that is wrong with it, and how long it takes.
pub fn preflight<'a>(mut planner: Planner, ops: impl IntoIterator<Item = &'a Op>) -> Preflight {
    let mut ignore = |_| {};
    for (index, op) in (0..).zip(ops) {
        planner.push(index, op, &mut ignore);
    }
    planner.finish(&mut ignore);
    Preflight { findings: planner.take_findings(), duration: planner.duration() }
}

/// The op that is being planned, and where its steps go.
struct Job<'a> {
    index: u32,
    span: Span,
    emit: &'a mut dyn FnMut(Step),
}

impl Job<'_> {
    fn step(&self, kind: StepKind) -> Step {
        Step { op: self.index, line: self.span.line, kind }
    }
}

impl Planner {
    /// For a machine, its tools and the place where it stands.
    pub fn new(limits: MachineLimits, tools: ToolLibrary, options: Options, start: Start) -> Self {
        let spindles = limits
            .spindles
            .iter()
            .map(|_| SpindleState { awaited: true, ..SpindleState::default() });
        let mode = limits.joining.mode;
        Self {
            spindles: spindles.collect(),
            limits,
            options,
            only_judges: false,
            tools,
            turns_work: false,
            frame: WrittenFrame::default(),
            programmed: start.position,
            away: tool_change::Away::default(),
            tool: start.tool,
            changing: None,
            selected: None,
            mode,
            holes: Holes::default(),
            stroke: None,
            contact: None,
            last_strokes: [None; 2],
            warned_still: false,
            beyond_at: [None; Axis::ALL.len()],
            reversed_along: None,
            chain: Vec::new(),
            came_from: CameFrom::default(),
            coupled: coupled::Coupled::default(),
            cams: Cams::default(),
            worn: Length::ZERO,
            cam: None,
            will_measure: Vec::new(),
            tables: Vec::new(),
            next_table: 0,
            findings: Findings::default(),
            hottest: Default::default(),
            outbox: Outbox::default(),
            overridden: true,
            spindle_override: spindle_override::SpindleOverride::default(),
            wanted: OperatorSettings::default(),
        }
    }

    /// One that finds what is wrong and no more: it hands on no cuts, and its
    /// [`duration`](Self::duration) counts none. A move takes a thousandth of the time that joining
    /// it to its neighbours takes.
    #[must_use]
    pub fn only_judging(self) -> Self {
        Self { only_judges: true, ..self }
    }

    /// One that joins moves and times them side by side, of a program that is planned ahead of its
    /// run: the same steps, later. An operator's wishes cannot be followed then.
    #[must_use]
    pub fn side_by_side(mut self, both: crate::SideBySide) -> Self {
        self.outbox.side_by_side(both);
        self
    }

    /// One that plans no moves that go on into one another, and keeps a sample of them:
    /// [`take_sample`](Self::take_sample). Its [`duration`](Self::duration) counts none of them.
    #[must_use]
    pub fn sampling(mut self) -> Self {
        self.outbox.sample = Some(Box::default());
        self
    }

    /// The sample, after the last op.
    pub fn take_sample(&mut self) -> Option<Sample> {
        let mut sample = self.outbox.sample.take()?;
        sample.finish();
        Some(*sample)
    }

    /// Of a machine whose first spindle turns the work: G96 acts there.
    #[must_use]
    pub fn turning_work(self) -> Self {
        Self { turns_work: true, ..self }
    }

    /// The frame and units in which the ops that follow are written: findings are said in them.
    pub const fn written_in(&mut self, frame: ProgramFrame) {
        self.frame.written = frame;
    }

    /// Plans one op. Its steps, and those of ops that waited for it, go to `emit` in order.
    pub fn push(&mut self, index: u32, op: &Op, emit: &mut impl FnMut(Step)) {
        let mut job = Job { index, span: op.span, emit };
        self.findings.begin(op.span);
        if leaves_cam(&op.kind) {
            self.cam_end(&mut job);
        }
        if !matches!(op.kind, OpKind::Threading(_)) {
            self.end_thread(job.emit);
        }
        self.say_tool(&mut job);
        self.aim_surface(&job, &op.kind);
        self.lock_spindle_override(&mut job, &op.kind);
        let before = self.programmed.linear;
        self.frame.from = self.programmed;
        match &op.kind {
            OpKind::Rapid { to } => self.rapid(&mut job, to),
            OpKind::Line { to, feed } => {
                self.hole_is_fed(to);
                self.cut(&mut job, to, *feed, |from| Path::Line { from, to: *to });
            }
            OpKind::Arc { to, arc, feed } => {
                if self.arc_is_sound(&job, to, arc) {
                    self.cut(&mut job, to, *feed, |from| Path::Arc { from, to: *to, arc: *arc });
                } else if wild(to).is_none() {
                    self.programmed = *to;
                }
            }
            OpKind::Spline { to, spline, feed } => self.spline(&mut job, to, spline, *feed),
            OpKind::Tap(tap) => self.tap(&mut job, tap),
            OpKind::Threading(order) => self.threading(&mut job, order),
            OpKind::Hole(hole) => {
                self.judge_hole(&job, hole);
                self.hole_begins(hole, op.span);
                if let Some(tool) = self.tools.get(self.tool) {
                    self.holes.drill(hole, tool, op.span);
                } else if self.tool == 0 {
                    self.findings.add_once(crate::findings::no_drill(op.span));
                }
            }
            OpKind::Dwell { time } => self.dwell(&mut job, *time),
            OpKind::Spindle { spindle, order } => self.spindle(&mut job, *spindle, order),
            OpKind::Polygon(polygon) => {
                self.forget_bar();
                self.polygon(&mut job, polygon);
            }
            OpKind::PolygonMeasure { looks } => self.polygon_measure(&mut job, *looks),
            OpKind::PolygonEnd | OpKind::HobEnd => self.polygon_end(&mut job),
            OpKind::Hob(hob) => {
                self.forget_bar();
                self.hob(&mut job, hob);
            }
            OpKind::Cam(order) => self.cam(&mut job, order),
            OpKind::Coolant { mist, flood } => {
                let step = job.step(StepKind::Coolant { mist: *mist, flood: *flood });
                self.after_spindle(&mut job, step);
            }
            OpKind::Output(output) => {
                self.check_output(&job, output);
                let step = job.step(StepKind::Output(signals::output(output)));
                self.after_spindle(&mut job, step);
            }
            OpKind::Input(wait) => {
                self.check_input(&job, wait);
                self.tell_spindles(&mut job);
                self.hand_on(&mut job, StepKind::Input(signals::input(wait)));
            }
            OpKind::Probe(order) => self.probe(&mut job, order),
            OpKind::UserCode(code) => {
                self.tell_spindles(&mut job);
                self.hand_on(&mut job, StepKind::UserCode(code.number));
            }
            OpKind::ChangeTool { number } => self.change_tool(&mut job, *number),
            OpKind::PathMode(mode) => self.mode = *mode,
            OpKind::Pause { optional } => {
                self.tell_spindles(&mut job);
                self.hand_on(&mut job, StepKind::Pause { optional: *optional });
            }
            OpKind::End if op.ends_typed() => self.end_typed(&mut job),
            OpKind::End => self.end(&mut job),
            OpKind::Overrides { feed, spindle } => {
                self.allow_spindle_override(&mut job, *spindle);
                if core::mem::replace(&mut self.overridden, *feed) != *feed {
                    let step = job.step(StepKind::FeedOverride(*feed));
                    self.after_spindle(&mut job, step);
                }
            }
            OpKind::SelectTool { number } => self.select_tool(op.span, *number),
            OpKind::Message(_) => {}
        }
        self.follow_surface(&op.kind);
        self.follow_hob(&op.kind, &before);
        self.feel_heat(op.span);
        if !matches!(op.kind, OpKind::Threading(_)) {
            self.came_from.moved(&before, &self.programmed.linear);
        }
    }

    /// The program is over: hand on what still waits.
    pub fn finish(&mut self, emit: &mut impl FnMut(Step)) {
        self.end_thread(emit);
        self.judge_thread();
        self.judge_hobbed();
        self.outbox.release([], &self.limits, emit);
        self.say_heat();
    }

    /// The cams that programs may call, and what is sent of them.
    pub const fn cams(&mut self) -> &mut Cams {
        &mut self.cams
    }

    /// What the wheel has lost of its radius so far, by the model of its wear: so much farther it
    /// was sent.
    pub const fn worn(&self) -> Length {
        self.worn
    }

    /// The tables that steps so far have named, each once: the kernel needs them before the steps.
    pub fn take_tables(&mut self) -> Vec<Table> {
        core::mem::take(&mut self.tables)
    }

    /// What has been found since the last call.
    pub fn take_findings(&mut self) -> Vec<Diagnostic> {
        self.findings.take()
    }

    /// Planned time of all ops so far.
    pub fn duration(&self) -> Time {
        self.outbox.elapsed(&self.limits)
    }

    /// Where the axes are when all ops so far are done.
    pub fn position(&self) -> Position {
        self.away.instead_of(self.programmed)
    }

    fn dwell(&mut self, job: &mut Job, time: Time) {
        if !(time >= Time::ZERO && time.is_finite()) {
            let text =
                format!("expected a dwell of zero seconds or more, found {}", number(time.value()));
            self.findings.add(Diagnostic::error("M0312", job.span, text));
            return;
        }
        if self.time_is_refused(job, time.value()) {
            return;
        }
        self.tell_spindles(job);
        self.hand_on(job, StepKind::Dwell(time));
    }

    fn end(&mut self, job: &mut Job) {
        for state in &mut self.spindles {
            state.order(Spin::ZERO);
        }
        self.tell_spindles(job);
        if self.spindles.iter().any(|state| state.throwing) {
            self.await_spindles(job); // the last hole's chips too
        }
        self.hand_on(job, StepKind::End);
    }

    /// Hand on a step at once, after all that waits.
    fn hand_on(&mut self, job: &mut Job, kind: StepKind) {
        self.outbox.release([], &self.limits, job.emit);
        let step = job.step(kind);
        self.outbox.hand_on(step, &self.limits, job.emit);
    }
}
