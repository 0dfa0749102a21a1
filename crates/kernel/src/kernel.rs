//! The tick.
//!
//! ```text
//!   Feedback ─► readings ─► faults? ─► steps ─► spindles ─► loops ─► Command
//!                              │
//!                              └─ yes: outputs off, or brake and hold
//! ```
//!
//! A fault is a state, not a `Result`: the machine is stopped the way the fault asks for, and from then
//! on the kernel only holds it.
use crate::config::{Config, Subject};
use crate::drives::{Drives, Finding};
use crate::event::{Event, EventKind, Ring};
use crate::execute::{Activity, Context, Progress};
use crate::fault::{Fault, FaultKind, Reaction};
use crate::operator::{Notice, Operator, Order};
use crate::recovering::{Recovering, RecoveryPlan};
use crate::scribe::{TapRecord, Wish};
use crate::spindle::SpindleLoop;
use alloc::{collections::VecDeque, vec::Vec};
use bus::{Command, Feedback, Report, State};
use canon::Axis;
use plan::{Step, StepKind, Superpose, TableId};
use sync::{Coupling, Periodic, SyncMode};
use units::Time;

/// Steps that may wait.
pub const QUEUE: usize = 64;
/// Faults that are kept; the first ones tell why.
pub const FAULTS: usize = 16;
/// Steps that may be done within one period: what needs no time must not starve the loops.
const STEPS_PER_TICK: usize = 32;

/// The queue is full: try again after the next tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

impl core::fmt::Display for Full {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the kernel's queue of {QUEUE} steps is full")
    }
}

impl core::error::Error for Full {}

/// How the machine is run at present.
#[derive(Clone, Copy, Debug)]
enum Mode {
    /// The first tick has not been.
    New,
    /// Waiting for the drives, for so long.
    Starting(f64),
    /// Executing steps.
    Running,
    /// Stopped under control and held; what was coupled stops together and stays coupled.
    Halted,
    /// Outputs off.
    Disabled,
}

/// The control of one machine.
#[derive(Clone, Debug)]
pub struct Kernel {
    config: Config,
    drives: Drives,
    queue: VecDeque<Step>,
    activity: Activity,
    /// The step at the queue's front has begun.
    begun: bool,
    mode: Mode,
    faults: Vec<Fault>,
    events: Ring,
    report: Report,
    operator: Operator,
    /// An alarm from outside that the next tick will find.
    reported: Option<Subject>,
    /// A tool is being taken out; nothing else is done.
    recovering: Option<Recovering>,
    /// The operator has given the program up, and everything stands.
    aborted: bool,
    /// Time of the last reading.
    now: Time,
}

impl Kernel {
    /// A kernel for a machine. All memory it will ever need is taken here. What [`Config::problems`]
    /// reports should have been mended before.
    pub fn new(config: Config) -> Self {
        Self {
            drives: Drives::new(&config),
            config,
            queue: VecDeque::with_capacity(QUEUE),
            activity: Activity::Idle,
            begun: false,
            mode: Mode::New,
            faults: Vec::with_capacity(FAULTS),
            events: Ring::new(),
            report: Report::default(),
            operator: Operator::new(),
            reported: None,
            recovering: None,
            aborted: false,
            now: Time::ZERO,
        }
    }

    /// Append a step.
    ///
    /// # Errors
    /// The queue is full.
    pub fn push(&mut self, step: Step) -> Result<(), Full> {
        if self.is_full() {
            return Err(Full);
        }
        self.queue.push_back(step);
        Ok(())
    }

    /// No step can be pushed now.
    pub fn is_full(&self) -> bool {
        self.queue.len() == QUEUE
    }

    /// Nothing left to do: no step waits or runs.
    pub fn is_idle(&self) -> bool {
        self.queue.is_empty()
    }

    /// The program has ended, or a fault or the operator has ended it: nothing more will happen.
    pub fn is_over(&self) -> bool {
        let recovered = self.recovering.as_ref().is_some_and(Recovering::is_done);
        recovered || self.aborted || matches!(self.report.state, State::Ended | State::Faulted)
    }

    /// The kernel's view of the last period.
    pub const fn report(&self) -> Report {
        self.report
    }

    /// The faults that have happened, oldest first.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// The oldest event that nobody has taken yet.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// Events that were lost because nobody took them in time.
    pub const fn events_lost(&self) -> u64 {
        self.events.lost()
    }

    /// What repeated taps have learnt so far.
    pub fn lessons(&self) -> &[sync::Lesson] {
        self.drives.lessons.list()
    }

    /// Begin with what was learnt before; ignored where learning is off. Not during a tap.
    pub fn recall(&mut self, lessons: Vec<sync::Lesson>) {
        self.drives.lessons.recall(lessons);
    }

    /// Keep the table of a function that steps superpose. What it replaces comes back.
    ///
    /// # Errors
    /// All [`crate::TABLES`] places hold tables that are in use; the table comes back.
    pub fn put_table(
        &mut self,
        id: TableId,
        table: Periodic,
    ) -> Result<Option<Periodic>, Periodic> {
        self.drives.coupled.put(id, table)
    }

    /// What the step in work waits for from outside, if it does: see [`plan::StepKind::Consult`].
    pub fn consulted(&self) -> Option<u16> {
        match self.queue.front() {
            Some(Step { kind: StepKind::Consult(what), .. }) if self.begun => Some(*what),
            _ => None,
        }
    }

    /// While it is consulted: begin, exchange or end a superposition.
    ///
    /// # Errors
    /// The spindle, the axis or the table is missing.
    pub fn superpose(&mut self, order: &Superpose) -> Result<(), FaultKind> {
        self.drives.superpose(order).map_err(|(kind, ..)| kind)
    }

    /// All that was superposed has faded in or out.
    pub fn has_faded(&self) -> bool {
        self.drives.coupled.has_faded()
    }

    /// Go on after a consultation.
    pub fn answer(&mut self) {
        if matches!(self.activity, Activity::Consulting) {
            self.activity = Activity::AtOnce;
        }
    }

    /// From now on somebody writes down what taking a tap out needs, and no tap goes in before it is.
    pub const fn keep_records(&mut self) {
        self.drives.scribe.begin();
    }

    /// What shall be written down next.
    pub fn next_wish(&mut self) -> Option<Wish> {
        self.drives.scribe.take()
    }

    /// The wish of this number is on the disk.
    pub fn acknowledge(&mut self, number: u32) {
        self.drives.scribe.acknowledge(number);
    }

    /// The disk refuses: no further tap goes in.
    pub const fn not_written(&mut self) {
        self.drives.scribe.refuse();
    }

    /// Take an order of the operator; it acts from the next tick on.
    pub fn order(&mut self, order: Order) {
        let synchronised =
            matches!(&self.activity, Activity::Tapping(run) if run.coupling().is_some());
        let paused = matches!(self.activity, Activity::Pausing);
        let alarm = matches!(self.mode, Mode::Halted | Mode::Disabled);
        if alarm && matches!(order, Order::Resume | Order::FeedHold) {
            return self.note(EventKind::Operator(Notice::NothingToResume));
        }
        if order == Order::Retract && synchronised && self.operator.wants_rest() {
            self.note(EventKind::Operator(Notice::BackingOut));
        }
        if let Some(notice) = self.operator.take(order, synchronised, paused) {
            self.note(EventKind::Operator(notice));
        }
        if order == Order::Resume && paused && !self.operator.wants_rest() {
            self.activity = Activity::AtOnce;
            self.note(EventKind::Resumed);
        }
    }

    /// A drive reports an alarm with which it can still brake.
    pub const fn report_alarm(&mut self, of: Subject) {
        self.reported = Some(of);
    }

    /// Take a tool out of the work, and do nothing else: what waited is forgotten, what stopped the machine before
    /// has had its answer. The drives come up, each where it stands.
    pub fn recover(&mut self, plan: RecoveryPlan) {
        self.queue.clear();
        self.faults.clear();
        (self.activity, self.begun, self.mode) = (Activity::Idle, false, Mode::New);
        (self.operator, self.aborted, self.reported) = (Operator::new(), false, None);
        self.report.state = State::Idle;
        self.recovering = Some(Recovering::new(plan, self.now));
    }

    /// After a recovery: execute steps again, from where everything stands.
    pub fn go_on(&mut self) {
        if self.recovering.take_if(|recovering| recovering.is_done()).is_some() {
            self.operator = Operator::new();
        }
    }

    /// Nothing moves any more, by the setpoints, and nothing is about to.
    pub fn is_standing(&self) -> bool {
        let axes = self.drives.axes.iter().flatten().all(|axis| axis.target.speed == 0.0);
        let spindles = self.drives.spindles.iter().flatten();
        let still = axes && spindles.map(SpindleLoop::ordered).all(|r| r.spin.value() == 0.0);
        match self.mode {
            Mode::Disabled => true,
            Mode::New | Mode::Starting(_) => false,
            Mode::Running | Mode::Halted => still && !self.operator.wants_out(),
        }
    }

    /// What the operator's orders have left behind.
    pub const fn operator(&self) -> &Operator {
        &self.operator
    }

    /// Go on after a program's stop.
    pub fn resume(&mut self) {
        self.order(Order::Resume);
    }

    /// One servo period: from what the machine says to what it shall do.
    pub fn tick(&mut self, feedback: &Feedback) -> Command {
        self.now = feedback.time;
        if let Err(finding) = self.check(feedback) {
            self.raise(finding, feedback);
        }
        if !matches!(self.mode, Mode::Disabled) {
            self.drives.read(feedback);
        }
        let mut command = match self.mode {
            Mode::Disabled => Command { tool: self.drives.tool, ..Command::default() },
            Mode::New | Mode::Starting(_) => self.start(feedback),
            Mode::Running => self.run(feedback),
            Mode::Halted => self.halt(feedback),
        };
        command.coupled = self.kept_together();
        self.summarise();
        command
    }

    /// What is wrong before anything is done.
    fn check(&self, feedback: &Feedback) -> Result<(), Finding> {
        if feedback.emergency_stop {
            return Err((FaultKind::EmergencyStop, Subject::Machine, 0.0, 0.0));
        }
        self.drives.check_readings(feedback)?;
        match self.mode {
            Mode::New | Mode::Starting(_) | Mode::Disabled => Ok(()),
            Mode::Running => {
                if let Some(of) = self.reported {
                    return Err((FaultKind::DriveAlarm, of, 0.0, 0.0));
                }
                self.drives.check_ready(feedback)?;
                let waits = &self.config.waits;
                self.drives.check_coupled(waits.at_speed, waits.oriented)?;
                self.drives.check_following()
            }
            Mode::Halted => self.drives.check_ready(feedback),
        }
    }

    /// Wait for the drives; hold every axis where it stands.
    fn start(&mut self, feedback: &Feedback) -> Command {
        let waited = match self.mode {
            Mode::Starting(waited) => waited + self.config.period.value(),
            Mode::New | Mode::Running | Mode::Halted | Mode::Disabled => 0.0,
        };
        self.drives.adopt(feedback, &self.config);
        self.mode = Mode::Starting(waited);
        match self.drives.check_ready(feedback) {
            Ok(()) => {
                self.mode = Mode::Running;
                self.note(EventKind::DrivesReady);
            }
            Err(finding) if waited > self.config.waits.ready.value() => {
                self.raise(finding, feedback);
                return Command { tool: self.drives.tool, ..Command::default() };
            }
            Err(_) => {}
        }
        self.drives.command()
    }

    /// Execute steps, then close the loops.
    fn run(&mut self, feedback: &Feedback) -> Command {
        self.drives.rest();
        let mut left = self.config.period.value();
        for _ in 0..STEPS_PER_TICK {
            match self.step(left, feedback) {
                Ok(Progress::Done(rest)) => left = rest,
                Ok(Progress::Busy) => break,
                Err(finding) => {
                    self.raise(finding, feedback);
                    break;
                }
            }
        }
        if matches!(self.mode, Mode::Halted) {
            return self.halt(feedback);
        }
        self.hold();
        self.warn();
        self.drives.advance_spindles();
        self.drives.couple(self.config.period);
        for index in 0..bus::SPINDLES {
            if let Some(event) = self.drives.throw_chips(index) {
                self.note(event);
            }
        }
        self.drives.command()
    }

    /// Go on with the recovery, if there is one, else with the step at the queue's front.
    fn step(&mut self, dt: f64, feedback: &Feedback) -> Result<Progress, Finding> {
        if let Some(recovering) = &mut self.recovering {
            let mut context = Context {
                config: &self.config,
                feedback,
                events: &mut self.events,
                operator: &self.operator,
                halted: false,
                op: self.report.op,
                line: self.report.line,
            };
            recovering.advance(dt, &mut self.drives, &mut context)?;
            return Ok(Progress::Busy);
        }
        let Some(step) = self.queue.front() else {
            return Ok(Progress::Busy);
        };
        if !self.begun && self.holds_before(step.line) {
            return Ok(Progress::Busy);
        }
        let Some(step) = self.queue.front() else {
            return Ok(Progress::Busy);
        };
        let mut context = Context {
            config: &self.config,
            feedback,
            events: &mut self.events,
            operator: &self.operator,
            halted: false,
            op: step.op,
            line: step.line,
        };
        if !self.begun {
            (self.report.op, self.report.line) = (step.op, step.line);
            self.activity = Activity::begin(&step.kind, &mut self.drives, &mut context)?;
            self.begun = true;
        }
        let progress = self.activity.advance(&step.kind, dt, &mut self.drives, &mut context)?;
        self.foresee();
        if let Progress::Done(_) = progress {
            self.leave_hole();
            self.queue.pop_front();
            self.begun = false;
            self.activity = Activity::Idle;
        }
        Ok(progress)
    }

    /// No step begins now: the operator holds, and the axes stand. A move that flows on into the next one
    /// slows down in it.
    fn holds_before(&mut self, line: u32) -> bool {
        if self.drives.flowing {
            return false;
        }
        self.operator.holds_line(line, self.report.line) || self.operator.wants_rest()
    }

    /// The operator's hold, once everything stands: it is said, and an abort forgets the rest. A tap that
    /// stands in its thread stays there until it is told to go on, or out.
    fn hold(&mut self) {
        if !self.operator.wants_rest() || self.aborted || !self.activity.is_held(&self.operator) {
            return;
        }
        let in_thread = self.is_in_thread();
        if self.operator.wants_out() && !in_thread {
            self.operator.is_out();
            self.note(EventKind::Operator(Notice::Out));
        }
        if self.operator.wants_abort() && !in_thread {
            if matches!(self.activity, Activity::Tapping(_)) {
                self.drives.scribe.out();
            }
            self.queue.clear();
            (self.activity, self.begun, self.aborted) = (Activity::Idle, false, true);
            self.drives.flowing = false;
            self.drives.spindles.iter_mut().flatten().for_each(SpindleLoop::stop);
            (self.drives.mist, self.drives.flood) = (false, false);
            self.note(EventKind::Operator(Notice::Aborted));
        } else if let Some(notice) = self.operator.standing(in_thread) {
            self.note(EventKind::Operator(notice));
        }
    }

    /// A tap stands in its thread.
    fn is_in_thread(&self) -> bool {
        match (&self.activity, self.queue.front()) {
            (Activity::Tapping(run), Some(Step { kind: StepKind::Tap(plan), .. })) => {
                run.is_in_thread(plan, &self.drives)
            }
            _ => false,
        }
    }

    /// Brake what moves, synchronised what is coupled, and hold. A tap that was stopped in its thread comes out
    /// when it is told to.
    fn halt(&mut self, feedback: &Feedback) -> Command {
        self.drives.rest_follower();
        let tapping = match (&mut self.activity, self.queue.front()) {
            (Activity::Tapping(run), Some(step)) if run.coupling().is_some() => {
                let mut context = Context {
                    config: &self.config,
                    feedback,
                    events: &mut self.events,
                    operator: &self.operator,
                    halted: true,
                    op: step.op,
                    line: step.line,
                };
                match &step.kind {
                    StepKind::Tap(plan) => {
                        // what it failed of has been said
                        let _ = run.advance(
                            plan,
                            self.config.period.value(),
                            &mut self.drives,
                            &mut context,
                        );
                        Some(plan.axis.index())
                    }
                    _ => None,
                }
            }
            _ => None,
        };
        if self.operator.wants_out()
            && self.activity.is_held(&self.operator)
            && !self.is_in_thread()
        {
            self.operator.is_out();
            self.drives.scribe.out();
            self.note(EventKind::Operator(Notice::Out));
        }
        self.drives.advance_spindles();
        for (index, axis) in self.drives.axes.iter_mut().enumerate() {
            if let Some(axis) = axis.as_mut().filter(|_| tapping != Some(index)) {
                axis.brake();
            }
        }
        self.drives.couple(self.config.period);
        self.drives.command()
    }

    /// A fault: remember it and stop the way it asks for.
    fn raise(&mut self, (kind, subject, value, limit): Finding, feedback: &Feedback) {
        if matches!(self.mode, Mode::Disabled) {
            return;
        }
        let (op, line) = (self.report.op, self.report.line);
        let fault = Fault { kind, subject, value, limit, time: feedback.time, op, line };
        if self.faults.len() < FAULTS {
            self.faults.push(fault);
        }
        self.note(EventKind::FaultRaised(fault));
        self.mode = match kind.reaction() {
            Reaction::Disable => Mode::Disabled,
            Reaction::Halt => {
                self.operator.alarm();
                let coupled =
                    matches!(&self.activity, Activity::Tapping(run) if run.coupling().is_some());
                // a tap's master is slowed down by the tap itself
                let led = self.queue.front().and_then(|step| match &step.kind {
                    StepKind::Tap(plan) if coupled => Some(usize::from(plan.spindle)),
                    _ => None,
                });
                for (index, spindle) in self.drives.spindles.iter_mut().enumerate() {
                    if let Some(spindle) = spindle.as_mut().filter(|_| led != Some(index)) {
                        spindle.brake();
                    }
                }
                Mode::Halted
            }
        };
        (self.drives.mist, self.drives.flood) = (false, false);
    }

    /// What is coupled at present: axis, spindle, and how.
    fn coupled(&self) -> Option<(usize, usize, Coupling)> {
        let Activity::Tapping(run) = &self.activity else { return None };
        let Some(Step { kind: plan::StepKind::Tap(plan), .. }) = self.queue.front() else {
            return None;
        };
        Some((plan.axis.index(), usize::from(plan.spindle), run.coupling()?))
    }

    /// What the drives shall keep together, should they be left alone: the coupling's tangent.
    fn kept_together(&self) -> Option<bus::Coupled> {
        let (axis, spindle, coupling) = match (&self.mode, &self.recovering) {
            (Mode::Running | Mode::Halted, None) => self.coupled()?,
            (Mode::Running, Some(recovering)) => recovering.coupled()?,
            (Mode::Halted | Mode::New | Mode::Starting(_) | Mode::Disabled, _) => return None,
        };
        let angle = self.drives.spindles[spindle].as_ref()?.reading();
        Some(bus::Coupled {
            axis: axis as u8,
            spindle: spindle as u8,
            angle,
            place: coupling.position(angle),
            lead: coupling.slope(angle),
        })
    }

    /// The coupling of the tap that is in work, from where the tap is clear of the work to where it turns back, with
    /// the sense in which it goes; `None` while none is engaged. What a recovery has to know if everything stops now.
    pub fn engaged(&self) -> Option<sync::recovery::Stored> {
        match (&self.activity, self.queue.front()) {
            (Activity::Tapping(run), Some(Step { kind: StepKind::Tap(plan), .. })) => {
                run.stored(plan)
            }
            _ => None,
        }
    }

    /// While the axes are on their way to a tap and its spindle stands already: ask for its record now.
    fn foresee(&mut self) {
        let following = self.config.synchronisation != SyncMode::CommandSynchronised;
        let travels = matches!(self.activity, Activity::Moving(..) | Activity::Settling { .. });
        if !self.drives.scribe.is_on() || following || !travels {
            return;
        }
        let mut steps = self.queue.iter().skip(1);
        let next = steps.find(|step| !matches!(step.kind, plan::StepKind::Move(_)));
        let Some(Step { op, line, kind: plan::StepKind::Tap(plan) }) = next else { return };
        let spindle = self.drives.spindles.get(usize::from(plan.spindle)).and_then(Option::as_ref);
        // one that only stands will be turned to the start angle by the shorter way
        let stands =
            |s: &SpindleLoop| (s.at_rest() && plan.start_angle.is_some()).then(|| s.now().angle);
        let Some(held) = spindle.and_then(|s| s.held().or_else(|| stands(s))) else { return };
        let turns = plan.start_angle.map_or(0.0, |angle| (angle - held).value());
        let theta0 = held + units::Angle::rev(turns - libm::round(turns));
        let record = TapRecord::of(plan, *op, *line, self.drives.tool, theta0);
        self.drives.scribe.ask(&record);
    }

    /// The tap at the queue's front is done: out of its hole, unless the next stroke goes on in it.
    fn leave_hole(&mut self) {
        let Some(Step { op, kind: plan::StepKind::Tap(plan), .. }) = self.queue.front() else {
            return;
        };
        let goes_on = self
            .queue
            .get(1)
            .is_some_and(|next| next.op == *op && matches!(next.kind, plan::StepKind::Tap(_)));
        let inward = (plan.bottom - plan.surface).value();
        let is_outside = (plan.end - plan.surface).value() * inward <= 0.0;
        if is_outside && !goes_on {
            self.drives.scribe.out();
        }
    }

    /// Following errors worth an event.
    fn warn(&mut self) {
        for index in 0..bus::AXES {
            let Some(axis) = &mut self.drives.axes[index] else { continue };
            let (error, limit) = (axis.error(), axis.control.windows.following_warn.value());
            if error.abs() <= limit / 2.0 {
                axis.warned = false;
            } else if error.abs() > limit && !axis.warned {
                axis.warned = true;
                let (axis, error) = (Axis::ALL[index], units::Length::mm(error));
                self.note(EventKind::FollowingWarning { axis, error });
            }
        }
    }

    fn note(&mut self, kind: EventKind) {
        let (op, line) = (self.report.op, self.report.line);
        self.events.push(Event { time: self.now, op, line, kind });
    }

    /// The kernel's view of this period.
    fn summarise(&mut self) {
        let held = self.operator.wants_rest() && self.activity.is_held(&self.operator);
        self.report.state = match (&self.mode, &self.recovering) {
            (Mode::Halted | Mode::Disabled, _) => State::Faulted,
            (Mode::New | Mode::Starting(_), _) => State::Idle,
            (Mode::Running, Some(_)) => State::Recovering,
            (Mode::Running, None) if self.aborted => State::Idle,
            (Mode::Running, None) if held => State::Held,
            (Mode::Running, None) => self.activity.state(),
        };
        self.report.sync_error = match (&self.mode, &self.recovering, &self.activity) {
            (Mode::Running, Some(recovering), _) => recovering.sync_error(),
            (Mode::Running | Mode::Halted, None, Activity::Tapping(run)) => run.sync_error(),
            _ => None,
        };
    }
}
