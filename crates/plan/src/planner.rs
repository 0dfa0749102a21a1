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
//! A program is planned twice: once by [`preflight`], which keeps the findings and the time and throws the steps
//! away, and, if nothing is refused, again beside the running machine. An op that is refused makes no step; the
//! planner goes on as though it had been done, so that one mistake does not hide the next.
//!
//! **Spindle.** An M3 or M4 stays in force over taps and orientations, which leave the spindle at rest; it is told
//! to turn again as early as possible before the next cut, and the first cut awaits its speed.
//!
//! **Tool change.** The spindle is stopped, Z goes to the change position, the tool is changed. The program does
//! not know that Z has moved: a rapid that leaves Z where the program has it stays at the change position; the first op that
//! cuts brings Z back first.
use crate::cams::Cams;
use crate::coupled::Table;
use crate::findings::{Findings, number};
use crate::holes::Holes;
use crate::limits::{MachineLimits, Options};
use crate::motion::{Along, along, coordinate};
use crate::outbox::Outbox;
use crate::path::Path;
use crate::run::{Alone, Order};
use crate::step::{Move, Step, StepKind};
use crate::stroke::{Stroke, StrokeRequest};
use alloc::{format, vec::Vec};
use canon::{Axis, Feed, Op, OpKind, PathMode, Position, ToolLibrary};
use diag::{Diagnostic, Span};
use path::geometry::{self, Segment};
use units::{Length, Spin, Time};

mod cam;
mod chips;
mod coupled;
mod refuse;
mod spindle;
mod tap;
mod unsynchronised;
use refuse::{clipped, wild};

/// Share of P for merging collinear moves, where Q is not stated, and the most of it that Q may take.
const MERGED: f64 = 0.02;
const MERGED_MOST: f64 = 0.3;

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
}

/// From operations to steps. See the module's header.
#[derive(Clone, Debug)]
pub struct Planner {
    limits: MachineLimits,
    options: Options,
    tools: ToolLibrary,
    /// Where the program has the axes.
    programmed: Position,
    /// Where Z really is, if a tool change has lifted it.
    lifted: Option<Length>,
    tool: u32,
    spindles: Vec<SpindleState>,
    mode: PathMode,
    holes: Holes,
    /// In and out.
    last_strokes: [Option<(StrokeRequest, Stroke)>; 2],
    warned_still: bool,
    /// The last tap left the spindle reversed: forward again after the rapid back.
    reversed_along: Option<Axis>,
    coupled: coupled::Coupled,
    cams: Cams,
    cam: Option<cam::Cam>,
    /// Profiles and speeds whose phase error the program measures.
    will_measure: Vec<(u32, Spin)>,
    /// Tables that steps name and nobody has taken yet.
    tables: Vec<Table>,
    next_table: u16,
    findings: Findings,
    outbox: Outbox,
}

/// Whether a wheel that follows a cam goes back before this.
const fn leaves_cam(kind: &OpKind) -> bool {
    match kind {
        OpKind::Rapid { .. }
        | OpKind::Line { .. }
        | OpKind::Arc { .. }
        | OpKind::Tap(_)
        | OpKind::Hole(_)
        | OpKind::Spindle { .. }
        | OpKind::Polygon(_)
        | OpKind::PolygonEnd
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

/// A path as the crate `path` has it.
fn curves(path: &Path) -> impl Iterator<Item = geometry::Curve> {
    let point = |position: &Position| Axis::ALL.map(|axis| coordinate(position, axis));
    let (from, to, length) = (point(path.from()), point(path.to()), path.length());
    core::iter::once(match path {
        Path::Line { .. } => geometry::Curve::Line(geometry::Line { from, to, length }),
        Path::Arc { arc, .. } => {
            let [first, second, _] = arc.plane.axes().map(Axis::index);
            geometry::Curve::Arc(geometry::Arc {
                from,
                to,
                plane: [first, second],
                centre: arc.centre.map(Length::value),
                sweep: arc.sweep.in_rad(),
                length,
            })
        }
    })
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
            tools,
            programmed: start.position,
            lifted: None,
            tool: start.tool,
            mode,
            holes: Holes::default(),
            last_strokes: [None; 2],
            warned_still: false,
            reversed_along: None,
            coupled: coupled::Coupled::default(),
            cams: Cams::default(),
            cam: None,
            will_measure: Vec::new(),
            tables: Vec::new(),
            next_table: 0,
            findings: Findings::default(),
            outbox: Outbox::default(),
        }
    }

    /// Plan one op. Steps of it, and of ops before it that had to wait for it, go to `emit`, in order.
    pub fn push(&mut self, index: u32, op: &Op, emit: &mut impl FnMut(Step)) {
        let mut job = Job { index, span: op.span, emit };
        if leaves_cam(&op.kind) {
            self.cam_end(&mut job);
        }
        match &op.kind {
            OpKind::Rapid { to } => self.rapid(&mut job, to),
            OpKind::Line { to, feed } => {
                self.cut(&mut job, to, *feed, |from| Path::Line { from, to: *to });
            }
            OpKind::Arc { to, arc, feed } => {
                if self.arc_is_sound(&job, to, arc) {
                    self.cut(&mut job, to, *feed, |from| Path::Arc { from, to: *to, arc: *arc });
                } else if wild(to).is_none() {
                    self.programmed = *to;
                }
            }
            OpKind::Tap(tap) => self.tap(&mut job, tap),
            OpKind::Hole(hole) => {
                if let Some(tool) = self.tools.get(self.tool) {
                    self.holes.drill(hole, tool, op.span);
                } else if self.tool == 0 {
                    self.findings.add_once(crate::findings::no_drill(op.span));
                }
            }
            OpKind::Dwell { time } => self.dwell(&mut job, *time),
            OpKind::Spindle { spindle, order } => self.spindle(&mut job, *spindle, order),
            OpKind::Polygon(polygon) => self.polygon(&mut job, polygon),
            OpKind::PolygonEnd => self.polygon_end(&mut job),
            OpKind::Cam(order) => self.cam(&mut job, order),
            OpKind::Coolant { mist, flood } => {
                let step = job.step(StepKind::Coolant { mist: *mist, flood: *flood });
                self.after_spindle(&mut job, step);
            }
            OpKind::Output(output) => {
                let step = job.step(StepKind::Output(*output));
                self.after_spindle(&mut job, step);
            }
            OpKind::Input(wait) => {
                self.tell_spindles(&mut job);
                self.hand_on(&mut job, StepKind::Input(*wait));
            }
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
            OpKind::End => self.end(&mut job),
            OpKind::SelectTool { .. } | OpKind::Overrides { .. } | OpKind::Message(_) => {}
        }
    }

    /// The program is over: hand on what still waits.
    pub fn finish(&mut self, emit: &mut impl FnMut(Step)) {
        self.outbox.release(&[], &self.limits, emit);
    }

    /// The cams that programs may call, and what is sent of them.
    pub const fn cams(&mut self) -> &mut Cams {
        &mut self.cams
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
        match self.lifted {
            Some(z) => self.programmed.with(Axis::Z, z),
            None => self.programmed,
        }
    }

    fn rapid(&mut self, job: &mut Job, to: &Position) {
        let from = self.position();
        let reversed = self.reversed_along.take();
        let is_back = reversed.is_some_and(|axis| to.with(axis, from.along(axis)) == from);
        if reversed.is_some() && !is_back {
            self.tell_spindles(job);
        }
        let stays_up = self.lifted.filter(|_| to.linear[2] == self.programmed.linear[2]);
        self.programmed = *to;
        self.lifted = stays_up;
        let path = Path::Line { from, to: self.position() };
        if self.is_refused(job, &path) {
            return;
        }
        if !is_back {
            return self.rapid_along(job, path);
        }
        // out of the work first, and only then forward again
        if let Some(step) = self.rapid_step(job, path) {
            self.hand_on(job, step.kind);
        }
        self.tell_spindles(job);
    }

    /// A rapid that has been judged; after a spindle order that is still open. Where paths are blended it is a part of them.
    fn rapid_along(&mut self, job: &mut Job, path: Path) {
        let busy = self.is_open()
            || self.outbox.is_waiting()
            || self.spindles.iter().any(|state| state.throwing);
        if self.joins_rapids() && !busy {
            let Some(bound) = self.bound(job, &path, true, f64::INFINITY) else { return };
            if !self.motion_is_refused(job, &bound, path.length(), bound.speed) {
                let alone = Alone::PerTime(bound.speed);
                self.run_on(job, path, bound, alone, (f64::INFINITY, true));
            }
        } else if let Some(step) = self.rapid_step(job, path) {
            self.after_spindle(job, step);
        }
    }

    fn rapid_step(&mut self, job: &Job, path: Path) -> Option<Step> {
        let length = path.length();
        let bound = self.bound(job, &path, true, f64::INFINITY)?;
        let profile = bound.profile(length, bound.speed);
        if self.profile_is_refused(job, &profile, 1.0) {
            return None;
        }
        let rapid = Move {
            path,
            profile,
            rapid: true,
            per_revolution: false,
            exact_stop: true,
            floats: false,
        };
        Some(job.step(StepKind::Move(rapid)))
    }

    /// A cutting move; `make` builds its path from where the axes are.
    fn cut(
        &mut self,
        job: &mut Job,
        to: &Position,
        feed: Feed,
        make: impl FnOnce(Position) -> Path,
    ) {
        self.come_down(job);
        let path = make(self.programmed);
        self.programmed = *to;
        let turning = self.spindles.first().map_or(Spin::ZERO, |s| s.ordered.abs());
        let refused = self.is_refused(job, &path);
        if self.feed_is_refused(job, feed, turning) || refused {
            return;
        }
        let (length, n) = (path.length(), turning.value());
        let wanted = match feed {
            Feed::PerTime(speed) => speed.value(),
            Feed::PerRevolution(lead) => lead.value() * n,
            Feed::Duration(time) => length / time.value(),
        };
        let Some(bound) = self.bound(job, &path, false, wanted) else { return };
        if wanted > bound.axis_speed * (1.0 + 1e-9) {
            self.findings.add_once(clipped(job.span, wanted, bound.axis_speed));
        }
        if self.motion_is_refused(job, &bound, length, wanted) {
            return;
        }
        self.tell_spindles(job);
        self.await_spindles(job);
        let alone = match feed {
            Feed::PerTime(_) => Alone::PerTime(wanted),
            Feed::PerRevolution(lead) => Alone::PerRevolution(lead.value(), n),
            Feed::Duration(time) => Alone::Lasting(time.value()),
        };
        let along = match alone {
            Alone::PerRevolution(lead, _) => lead,
            Alone::PerTime(_) | Alone::Lasting(_) => wanted,
        };
        self.run_on(job, path, bound, alone, (along, false));
    }

    /// Go on with a move: `feed` per second or revolution, and whether it is a rapid.
    fn run_on(
        &mut self,
        job: &mut Job,
        path: Path,
        bound: Along,
        alone: Alone,
        (feed, rapid): (f64, bool),
    ) {
        let (tolerance, merge) = self.joined_within();
        for curve in curves(&path) {
            let (op, line) = (job.index, job.span.line);
            let segment = Segment { curve, feed, rapid, tolerance, merge, op, line };
            self.outbox.run_on(Order { segment, path, bound, alone }, &self.limits, job.emit);
        }
        if matches!(self.mode, PathMode::ExactStop) {
            self.outbox.end_run(&self.limits, job.emit);
        }
        if let Some((line, why)) = self.outbox.take_refusal() {
            let text = format!("line {line}: {why}");
            self.findings.add(Diagnostic::error("M0316", job.span, text));
        }
    }

    /// Rapids are part of a blended path where a tolerance is stated: by G64 P, or by the machine for programs that say
    /// nothing.
    fn joins_rapids(&self) -> bool {
        let PathMode::Blend { tolerance, .. } = self.mode else { return false };
        let always = matches!(self.limits.joining.mode, PathMode::Blend { .. });
        (always || tolerance.is_some()) && self.joined_within().0 > 0.0
    }

    /// How far the joined path may be from the programmed one, and how far merged points from their line.
    fn joined_within(&self) -> (f64, f64) {
        let PathMode::Blend { tolerance, merge } = self.mode else { return (0.0, 0.0) };
        let whole = tolerance.unwrap_or(self.limits.joining.tolerance).value().max(0.0);
        let merge = merge.map_or(MERGED * whole, |q| q.value().clamp(0.0, MERGED_MOST * whole));
        (whole - merge, merge)
    }

    /// Limits along a path; `None` if there is nothing to move, or an axis is missing, which is a finding.
    fn bound(&mut self, job: &Job, path: &Path, rapid: bool, wanted: f64) -> Option<Along> {
        if path.length() < NOTHING {
            return None;
        }
        match along(path, &self.limits, rapid, wanted) {
            Ok(bound) => Some(bound),
            Err(axis) => {
                let text =
                    format!("the machine has no {} axis, and the program moves it", axis.letter());
                self.findings.add(Diagnostic::error("M0305", job.span, text));
                None
            }
        }
    }

    /// Back from the change position, before something is cut.
    fn come_down(&mut self, job: &mut Job) {
        if self.lifted.is_some() {
            let path = Path::Line { from: self.position(), to: self.programmed };
            self.lifted = None;
            self.rapid_along(job, path);
        }
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

    fn change_tool(&mut self, job: &mut Job, number: u32) {
        if number != 0 && self.tools.get(number).is_none() {
            let text = format!("T{number} is not in the tool table");
            let finding = Diagnostic::error("M0309", job.span, text);
            self.findings.add(
                finding.with_help("add it to the table, or let missing tools be stood in for"),
            );
        }
        for state in &mut self.spindles {
            state.ordered = Spin::ZERO;
        }
        if number == self.tool {
            return; // it is there already
        }
        self.tell_spindles(job);
        if let Some(z) = self.limits.tool_change.z {
            let from = self.position();
            let path = Path::Line { from, to: from.with(Axis::Z, z) };
            self.lifted = Some(z);
            if !self.is_refused(job, &path) {
                self.rapid_along(job, path);
            }
        }
        self.outbox.release(&[], &self.limits, job.emit);
        self.await_spindles(job);
        self.hand_on(job, StepKind::ChangeTool(number));
        self.tool = number;
    }

    fn end(&mut self, job: &mut Job) {
        for state in &mut self.spindles {
            state.ordered = Spin::ZERO;
        }
        self.tell_spindles(job);
        if self.spindles.iter().any(|state| state.throwing) {
            self.await_spindles(job); // the last hole's chips too
        }
        self.hand_on(job, StepKind::End);
    }

    /// Hand on a step at once, after all that waits.
    fn hand_on(&mut self, job: &mut Job, kind: StepKind) {
        self.outbox.release(&[], &self.limits, job.emit);
        let step = job.step(kind);
        self.outbox.hand_on(step, &self.limits, job.emit);
    }
}
