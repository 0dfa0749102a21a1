//! The tick.
//!
//! ```text
//!   Feedback ─► readings ─► faults? ─► steps ─► spindles ─► loops ─► Command
//!                              │
//!                              └─ yes: outputs off, or brake and hold
//! ```
//!
//! A fault is a state, not a `Result`: the machine is stopped the way the fault asks for, and from
//! then on the kernel only holds it.
mod compensation;
mod encoder;
mod exchange;
mod faults;
mod guards;
mod homing;
mod interlocks;
mod manual;
mod orders;
mod tap;
mod waiting;
mod way_out;

use crate::compensation::Compensating;
use crate::config::{Config, Subject};
use crate::drives::{Drives, Finding};
use crate::encoder_plausibility::EncoderPlausibility;
use crate::event::{Event, EventKind, Ring};
use crate::execute::{Activity, Context, StepProgress};
use crate::fault::{Fault, FaultKind};
use crate::feedback_age::FeedbackAge;
use crate::homing::Homing;
use crate::manual::Manual;
use crate::operator::{Notice, Operator};
use crate::queue::{Full, QUEUE, Queue, StepKind};
use crate::recovering::Recovering;
use crate::retreating::Retreating;
use crate::setpoint_monitor::SetpointMonitor;
use crate::signals::Answered;
use crate::spindle_monitor::SpindleMonitor;
use crate::tapping::Outcome;
use crate::withdrawing::Withdrawing;
use alloc::vec::Vec;
use bus::{Command, Feedback, Report, State};
use interlocks::Interlocks;
use motion::{Readable, Step, WayOut};
use units::{Coordinate, Time};

/// Faults that are kept; the first ones tell why.
pub const FAULTS: usize = 16;
/// Drives that are told to be off say so at the latest then, behind the command's delay, s.
const SWITCHED_OFF_S: f64 = 0.01;
/// Steps that may be done within one period: what needs no time must not starve the loops.
const STEPS_PER_TICK: usize = QUEUE;

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
    queue: Queue,
    /// Stretches at the queue's front that are done: a thread is kept from its beginning, to be
    /// turned again after a hold.
    chained: usize,
    activity: Activity,
    /// The step at the queue's front has begun.
    begun: bool,
    mode: Mode,
    faults: Vec<Fault>,
    events: Ring,
    report: Report,
    operator: Operator,
    /// An alarm from outside that the next tick will find.
    reported: Option<(FaultKind, Subject)>,
    /// Which encoders give plausible readings.
    plausibility: EncoderPlausibility,
    /// The last look at what is sent, and at what spindles and the time of the feedback do.
    setpoints: SetpointMonitor,
    spindle_monitor: SpindleMonitor,
    feedback_age: FeedbackAge,
    /// A drive or an encoder is gone: once everything stands, outputs go off; the periods for which
    /// it has stood.
    drive_lost: Option<u32>,
    /// For so long outputs have been switched off, s; `None`: they are on, or were from the start.
    off_s: Option<f64>,
    /// Axes that are moved by hand.
    manual: Manual,
    /// Where encoders count from; axes that look for that.
    homing: Homing,
    /// Errors of screws and encoders, which are taken off.
    compensation: Compensating,
    /// A tool is being taken out; nothing else is done.
    recovering: Option<Recovering>,
    /// The tool leaves the work before the spindles stop.
    retreating: Option<Retreating>,
    /// How a tool that is tied to a spindle, and not screwed to the work, comes out of it.
    way_out: Option<WayOut>,
    /// One is being taken out; nothing else is done.
    withdrawing: Option<Withdrawing>,
    /// The operator has given the program up, and everything stands.
    aborted: bool,
    /// Time of the last reading.
    now: Time,
    /// When the step at the queue's front began.
    begun_at: Time,
    /// What came of the last step that has asked the machine something.
    answer: Option<Answered>,
    /// The probe was in contact a period ago.
    probe_before: bool,
    interlocks: Interlocks,
}

impl Kernel {
    /// A kernel for a machine. All memory it will ever need is taken here. What
    /// [`Config::problems`] reports should have been mended before.
    pub fn new(config: Config) -> Self {
        let drives = Drives::new(&config);
        Self {
            setpoints: SetpointMonitor::new(&drives.axes, &config.motion),
            plausibility: EncoderPlausibility::new(&drives.axes, config.period.value()),
            drives,
            queue: Queue::new(),
            chained: 0,
            activity: Activity::Idle,
            begun: false,
            mode: Mode::New,
            faults: Vec::with_capacity(FAULTS),
            events: Ring::new(),
            report: Report::default(),
            operator: Operator::new(config.overrides),
            reported: None,
            spindle_monitor: SpindleMonitor::default(),
            feedback_age: FeedbackAge::default(),
            drive_lost: None,
            off_s: None,
            manual: Manual::default(),
            homing: Homing::default(),
            compensation: Compensating::new(&config),
            recovering: None,
            retreating: None,
            way_out: None,
            withdrawing: None,
            aborted: false,
            now: Time::ZERO,
            begun_at: Time::ZERO,
            answer: None,
            probe_before: false,
            interlocks: Interlocks::default(),
            config,
        }
    }

    /// What it was made of.
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// Append a step; its plan is copied.
    ///
    /// # Errors
    /// There is no room for it: the kernel is as it was, and after a tick there may be.
    pub fn push<S: Readable>(&mut self, step: &Step<S>) -> Result<(), Full> {
        self.queue.push(step)
    }

    /// No step can be pushed now, of whatever kind.
    pub fn is_full(&self) -> bool {
        self.queue.is_full()
    }

    /// Nothing left to do: no step waits or runs.
    pub fn is_idle(&self) -> bool {
        self.queue.is_empty()
    }

    /// Steps that wait or run.
    pub fn steps(&self) -> usize {
        self.queue.len()
    }

    /// The program has ended, or a fault or the operator has ended it: nothing more will happen.
    pub fn is_over(&self) -> bool {
        let recovered = self.recovering.as_ref().is_some_and(Recovering::is_done)
            || self.withdrawing.as_ref().is_some_and(Withdrawing::is_done);
        recovered || self.aborted || matches!(self.report.state, State::Ended | State::Faulted)
    }

    /// The tool is leaving the work, and then everything will stop.
    pub fn is_retreating(&self) -> bool {
        let backs_out = matches!(self.mode, Mode::Halted)
            && self.drive_lost.is_none()
            && self.operator.wants_out();
        backs_out || self.retreating.is_some_and(|retreating| !retreating.is_out())
    }

    /// The kernel's view of the last period.
    pub const fn report(&self) -> Report {
        self.report
    }

    /// Where the tool side of an axis is believed to be: by its scale, or by its motor and the
    /// model of its screw.
    pub fn tool_side(&self, axis: units::Axis) -> Option<Coordinate> {
        let axis = self.drives.axes.get(axis.index())?.as_ref()?;
        Some(Coordinate::new(axis.position()))
    }

    /// The faults that have happened, oldest first.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// The oldest event that has not been taken yet.
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop()
    }

    /// One servo period: from what the machine says to what it shall do.
    pub fn tick(&mut self, feedback: &Feedback) -> Command {
        self.now = feedback.time;
        let age = self.check_age(feedback);
        let mut taken = self.positions(feedback);
        self.bridge(&mut taken);
        self.read_interlocks(feedback);
        let feedback = &taken;
        if let Err(finding) = age.and_then(|()| self.check(feedback)) {
            self.raise(finding, feedback);
        }
        if !matches!(self.mode, Mode::Disabled) {
            self.drives.read(feedback);
        }
        if let Err(finding) = self.check_spindles() {
            self.raise(finding, feedback);
        }
        if matches!(self.mode, Mode::Halted) {
            self.go_on_halted(feedback);
        }
        self.stop_idle_motor();
        let mut command = match self.mode {
            Mode::Disabled => self.leave(feedback),
            Mode::New | Mode::Starting(_) => self.start(feedback),
            Mode::Running => self.run(feedback),
            Mode::Halted => self.halt(feedback),
        };
        if matches!(self.mode, Mode::Disabled) {
            self.off_s = Some(self.off_s.map_or(0.0, |off| off + self.config.period.value()));
        }
        command.coupled = self.kept_together();
        self.probe_before = feedback.probe;
        self.readings(&mut command);
        self.summarise();
        command
    }

    /// Wait for the drives; hold every axis where it stands.
    fn start(&mut self, feedback: &Feedback) -> Command {
        let waited = match self.mode {
            Mode::Starting(waited) => waited + self.config.period.value(),
            Mode::New | Mode::Running | Mode::Halted | Mode::Disabled => 0.0,
        };
        if matches!(self.mode, Mode::New) {
            self.begin_rescue();
        }
        self.drives.adopt(feedback);
        self.setpoints.reset();
        self.spindle_monitor = SpindleMonitor::default();
        self.mode = Mode::Starting(waited);
        // what drives say before they have been switched off is not about being on again
        let answers_s = self.config.command_delay.value() + SWITCHED_OFF_S;
        if let Some(off) = self.off_s.filter(|off| *off < answers_s) {
            self.off_s = Some(off + self.config.period.value());
            return self.drives.command();
        }
        self.off_s = None;
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
        self.drives.override_spindles(self.operator.spindle_share());
        if let Err(finding) = self.check_inputs(feedback) {
            self.raise(finding, feedback);
            return self.halt(feedback);
        }
        let mut left = self.config.period.value();
        for _ in 0..STEPS_PER_TICK {
            match self.step(left, feedback) {
                Ok(StepProgress::Done(rest)) => left = rest,
                Ok(StepProgress::Busy | StepProgress::Again) => break,
                Err(finding) => {
                    self.raise(finding, feedback);
                    break;
                }
            }
        }
        if matches!(self.mode, Mode::Halted) {
            return self.halt(feedback);
        }
        self.advance_manual(feedback);
        self.advance_homing(feedback);
        match self.mode {
            Mode::Halted => return self.halt(feedback),
            Mode::Disabled => return Command { tool: self.drives.tool, ..Command::default() },
            Mode::New | Mode::Starting(_) | Mode::Running => {}
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
        self.close_loops(feedback)
    }

    /// Go on with the recovery, if there is one, else with the step at the queue's front.
    fn step(&mut self, dt: f64, feedback: &Feedback) -> Result<StepProgress, Finding> {
        if let Some(recovering) = &mut self.recovering {
            let mut context = Context {
                config: &self.config,
                feedback,
                steps: (&self.queue, 0),
                events: &mut self.events,
                answer: &mut self.answer,
                operator: &self.operator,
                halted: false,
                off_thread: None,
                op: self.report.op,
                line: self.report.line,
            };
            recovering.advance(dt, &mut self.drives, &mut context)?;
            return Ok(StepProgress::Busy);
        }
        if let Some(withdrawn) = self.withdraw_on(dt) {
            return withdrawn.map(|()| StepProgress::Busy);
        }
        if self.has_run_out() {
            return Err((FaultKind::StepsRanOut, Subject::Machine, 0.0, 0.0));
        }
        let Some(line) = self.queue.line(self.chained).filter(|_| !self.is_moved_by_hand()) else {
            return Ok(StepProgress::Busy);
        };
        if !self.begun && self.holds_before(line) {
            self.break_off_encoder_check();
            return Ok(StepProgress::Busy);
        }
        if !self.begun && self.checks_encoder_first(feedback)? {
            return Ok(StepProgress::Busy);
        }
        let Some(step) = self.queue.get(self.chained) else {
            return Ok(StepProgress::Busy);
        };
        if !self.begun {
            self.check_homed(&step.kind)?;
        }
        let off_thread = self.off_thread();
        let mut context = Context {
            config: &self.config,
            feedback,
            steps: (&self.queue, self.chained),
            events: &mut self.events,
            answer: &mut self.answer,
            operator: &self.operator,
            halted: false,
            off_thread,
            op: step.op,
            line: step.line,
        };
        if !self.begun {
            (self.report.op, self.report.line, self.begun_at) = (step.op, step.line, self.now);
            self.activity = Activity::begin(&step.kind, &mut self.drives, &mut context)?;
            self.begun = true;
        }
        let progress = self.activity.advance(&step.kind, dt, &mut self.drives, &mut context)?;
        self.foresee();
        self.foresee_way_out();
        match progress {
            StepProgress::Done(_) => self.finish_step(),
            StepProgress::Again => self.turn_again(),
            StepProgress::Busy => {}
        }
        Ok(progress)
    }

    /// Brake what moves, synchronised what is coupled, and hold. A tap that was stopped in its
    /// thread comes out when it is told to.
    fn halt(&mut self, feedback: &Feedback) -> Command {
        self.drives.rest_follower();
        let mut too_deep = None;
        let tapping = match (&mut self.activity, self.queue.front()) {
            (Activity::Tapping(run), Some(step)) if run.coupling().is_some() => {
                let mut context = Context {
                    config: &self.config,
                    feedback,
                    steps: (&self.queue, 0),
                    events: &mut self.events,
                    answer: &mut self.answer,
                    operator: &self.operator,
                    halted: true,
                    off_thread: None,
                    op: step.op,
                    line: step.line,
                };
                match &step.kind {
                    StepKind::Tap(plan) => {
                        let dt = self.config.period.value();
                        let outcome = run.advance(plan, dt, &mut self.drives, &mut context);
                        // what else it failed of has been said
                        too_deep = match outcome {
                            Outcome::Failed(finding) => Some(finding)
                                .filter(|(kind, ..)| *kind == FaultKind::FollowsTooDeep),
                            Outcome::Busy | Outcome::Done => None,
                        };
                        Some(plan.axis.index())
                    }
                    _ => None,
                }
            }
            _ => None,
        };
        if let Some(finding) = too_deep {
            self.raise(finding, feedback);
        }
        let threading = self.stay_on_thread();
        if self.operator.wants_out() && self.is_held() && !self.is_in_thread() {
            self.operator.is_out();
            self.drives.record_requests.out();
            self.note(EventKind::Operator(Notice::Out));
        }
        let led = self.retreat(threading).or(tapping);
        self.drives.advance_spindles();
        for (index, axis) in self.drives.axes.iter_mut().enumerate() {
            let coupled = led == Some(index) || threading && index < motion::THREADING_AXES;
            if let Some(axis) = axis.as_mut().filter(|_| !coupled) {
                axis.brake();
            }
        }
        self.drives.couple(self.config.period);
        let command = self.close_loops(feedback);
        self.let_go();
        command
    }

    #[allow(clippy::large_types_passed_by_value)] // it moves into the ring
    fn note(&mut self, kind: EventKind) {
        let (op, line) = (self.report.op, self.report.line);
        self.events.push(Event { time: self.now, op, line, kind });
    }

    /// The kernel's view of this period.
    fn summarise(&mut self) {
        let held = self.operator.wants_rest() && self.has_something_held() && self.is_held();
        self.report.state = match (&self.mode, &self.recovering) {
            (Mode::Disabled, _) if self.faults.is_empty() => State::Idle,
            (Mode::Halted | Mode::Disabled, _) => State::Faulted,
            (Mode::New | Mode::Starting(_), _) => State::Idle,
            (Mode::Running, Some(_)) => State::Recovering,
            (Mode::Running, None) if self.withdrawing.is_some() => State::Recovering,
            (Mode::Running, None) if self.aborted => State::Idle,
            (Mode::Running, None) if self.is_moved_by_hand() => State::Manual,
            (Mode::Running, None) if held => State::Held,
            (Mode::Running, None) if self.is_off_thread() => State::Rapid,
            (Mode::Running, None) => self.activity.state(),
        };
        self.report.sync_error = match (&self.mode, &self.recovering, &self.activity) {
            (Mode::Running, Some(recovering), _) => recovering.sync_error(),
            (Mode::Running | Mode::Halted, None, Activity::Tapping(run)) => run.sync_error(),
            _ => None,
        };
    }
}
