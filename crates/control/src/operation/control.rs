//! The control: one machine, what is loaded and set on it, and what it does now.
//!
//! In lock-step what paces the time calls [`Control::period`] once per servo period, and nothing
//! moves while none is called. In real time the servo thread keeps the time, and
//! [`Control::period`] looks at what it has done. A [`Request`] acts from the next period on.
use super::data::Data;
use super::ended::EndedProgram;
use super::event::{Alarm, Event, Events};
use super::features::WorkpieceLog;
use super::kept::Kept;
use super::message::MessageStatus;
use super::meters::Meters;
use super::outside::Outside;
use super::panel_keys::PanelKeys;
use super::proving::Begun;
use super::ranges;
use super::request::{Accepted, Refusal, Request};
use super::state::{Execution, ExecutionEvent, Mode, Power};
use super::under_way::{InWork, Loaded, UnderWay};
use crate::drives::{DrivesChoice, Opening};
use crate::job::{Before, Interruption, Operations, ProgramOptions, Session};
use crate::observers::Workpiece;
use crate::{Executor, RealTimeFigures, RealTimeOptions, Refused, config};
use bus::{AXES, State};
use canon::{Axis, Position};
use kernel::{Kernel, Pause, WaitFor};
use servo::StopLane;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use store::state::{LastProgram, StateChange};
use units::Coordinate;

/// What a control is switched on with.
#[derive(Clone, Debug)]
pub struct ControlOptions {
    /// Machine, tools, parameters, and how programs are read.
    pub program: ProgramOptions,
    /// Seed of what the control does not know of its machine; `None` is the machine file's.
    pub seed: Option<u64>,
    /// Folder in which offsets, tools, alarms and the last program are kept; `None`: nothing is.
    pub state: Option<PathBuf>,
    /// The machine that it leads.
    pub drives: DrivesChoice,
    /// How far from where the machine's file says the simulated stock is clamped.
    pub clamped: Position,
    /// By the clock, with kernel and machine in a servo thread; `None`: as periods are called for.
    pub real_time: Option<RealTimeOptions>,
}

impl ControlOptions {
    /// A simulated machine in the same process, in lock-step, of which nothing is kept.
    pub fn simulated(program: ProgramOptions) -> Self {
        Self {
            program,
            seed: None,
            state: None,
            drives: DrivesChoice::default(),
            clamped: Position::default(),
            real_time: None,
        }
    }
}

/// A control that stays on.
#[allow(clippy::struct_excessive_bools)] // independent facts, each asked for by itself
pub struct Control {
    pub(super) options: ControlOptions,
    /// Machine and tools as the files have them.
    pub(super) base: Session,
    pub(super) executor: Executor,
    pub(super) workpiece: Workpiece,
    /// What was cut from it, and when it begins and ends.
    pub(super) cut: WorkpieceLog,
    /// Zero of the work as it is clamped, in machine coordinates.
    pub(super) work_zero: Position,
    /// Number of the next operation that is done to the workpiece.
    pub(super) next_op: u32,
    pub(super) data: Data,
    pub(super) power: Power,
    pub(super) mode: Mode,
    pub(super) execution: Execution,
    pub(super) loaded: Option<Loaded>,
    pub(super) under_way: Option<UnderWay>,
    /// Oldest first.
    pub(super) alarms: Vec<Alarm>,
    pub(super) events: Events,
    /// Faults of the kernel that have become alarms.
    pub(super) told_faults: usize,
    /// A feed hold was asked for, and not a resume since.
    pub(super) is_hold_asked: bool,
    /// Everything comes to rest before the kernel forgets what it did.
    pub(super) is_resetting: bool,
    /// A recovery is on its way.
    pub(super) is_recovering: bool,
    /// What a recovery takes out, until it is out: another alarm may end the recovery before.
    pub(super) in_work: Option<InWork>,
    /// Axes that are homed after those that are homed now.
    pub(super) to_home: Vec<config::AxisHoming>,
    /// Where the handwheel has sent each axis.
    pub(super) handwheel: [Option<Coordinate>; AXES],
    /// The program that was loaded last, and how far it came.
    pub(super) last_program: Option<LastProgram>,
    pub(super) kept: Kept,
    /// What is in force and is not what the control wrote last, until it is acknowledged.
    pub(super) state_changes: Vec<StateChange>,
    /// A machine in another process, and what it and the sync record keep of a tool in its work.
    pub(super) outside: Option<Outside>,
    pub(super) meters: Meters,
    /// Folder in which programs are recorded.
    pub(super) runs: Option<PathBuf>,
    pub(super) ended: Option<EndedProgram>,
    /// What the program has said last.
    pub(super) message: Option<MessageStatus>,
    /// Which of the machines of this file it is: what is simulated scatters by it.
    pub(super) seed: u64,
    drives_were_ready: bool,
    /// The tool in the spindle, if it is broken.
    pub(super) broken_in_spindle: Option<u32>,
    pub(super) panel: PanelKeys,
    pub(super) told_features: usize,
    pub(super) told_changes: usize,
    /// The changer that a sequence works.
    pub(super) changer: Option<super::changer::Changer>,
}

impl Control {
    /// Switch a control on, of a machine that is simulated: drives off, nothing loaded.
    ///
    /// # Errors
    /// Machine, tools or parameters cannot be read or are wrong.
    pub fn new(options: ControlOptions) -> Result<Self, Refused> {
        let base = Session::load(&options.program, Path::new("-"), b"")?;
        let machine = &base.machine;
        let (kept, state, mut found) = Kept::open(options.state.as_deref(), machine)?;
        let seed = options.seed.unwrap_or(u64::from(machine.simulation.seed));
        let (material, mut zero) = (machine.setup.stock.material, machine.setup.g54);
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            zero = zero.with(axis, zero.along(axis) + options.clamped.along(axis));
        }
        let mut opened = (options.drives.door.open)(&Opening {
            machine,
            address: options.drives.address.as_deref(),
            keeps_record: kept.folder().is_some(),
            is_real_time: options.real_time.is_some(),
            tools: &base.tools,
            material,
            zero: &zero,
            seed,
        })?;
        let has_seat = opened.drives.seat().is_some();
        let outside = opened.welcome.map(|welcome| {
            let (outside, said) = Outside::welcomed(welcome, machine, &kept);
            found.extend(said);
            outside
        });
        let mut kernel = Kernel::new(kernel::Config {
            pause: Pause::Wait,
            ..config::control(machine, None, config::plain_drive(machine).is_some())
        });
        kernel.switch_off();
        for axis in machine.axes.iter().flatten() {
            kernel.forget_home(axis.letter);
        }
        let judge = verify::Config {
            tools: config::judged_tools(machine, &base.tools, seed, 1),
            ..base.judge(material, &zero)
        };
        let data = Data {
            parameters: base.parameters.clone(),
            tools: base.tools.clone(),
            rest: None,
            rest_number: 0,
        };
        let mut control = Self {
            options,
            executor: Executor::new(kernel, opened.drives),
            workpiece: Workpiece::new(judge),
            cut: WorkpieceLog::of(state.workpiece.clone()),
            work_zero: zero,
            next_op: 0,
            data,
            power: Power::Off,
            mode: Mode::Manual,
            execution: Execution::Ready,
            loaded: None,
            under_way: None,
            alarms: Vec::new(),
            events: Events::default(),
            told_faults: 0,
            is_hold_asked: false,
            is_resetting: false,
            is_recovering: false,
            in_work: None,
            to_home: Vec::new(),
            handwheel: [None; AXES],
            last_program: None,
            kept,
            state_changes: Vec::new(),
            outside,
            meters: Meters::new(&config::ratings(&base.machine)),
            runs: None,
            ended: None,
            message: None,
            seed,
            drives_were_ready: false,
            broken_in_spindle: None,
            panel: PanelKeys::new(base.machine.hal.as_ref().map_or(&[], |hal| &hal.mdi)),
            told_features: 0,
            told_changes: 0,
            changer: None,
            base,
        };
        control.take_kept(state);
        let state = control.options.state.as_deref();
        ranges::check_kept(&control.data.parameters, &control.base.machine, state)?;
        for finding in found {
            control.events.notice(finding);
        }
        control.forget_modes();
        control.begin_real_time(has_seat)?;
        control.find_left_at_seat();
        Ok(control)
    }

    /// The servo thread begins, where there is one.
    fn begin_real_time(&mut self, has_seat: bool) -> Result<(), Refused> {
        let keeps_time = self.options.real_time.or(has_seat.then(RealTimeOptions::default));
        if let Some(real_time) = keeps_time {
            self.executor.keep_time(real_time);
            self.executor.begin_real_time();
            if let (true, Some(why)) = (has_seat, self.executor.machine.lost()) {
                return Err(Refused::because(why));
            }
            for refused in &self.executor.refused {
                self.events.notice(refused.clone());
            }
        }
        Ok(())
    }

    /// Stops that wait in no queue, for any thread; and whether the emergency stop chain is within
    /// reach.
    pub(super) fn stops(&self) -> (Arc<StopLane>, bool) {
        (Arc::clone(&self.executor.stops), self.outside.is_none())
    }

    /// Modes are those of a control that was switched on just now.
    pub(super) fn forget_modes(&mut self) {
        let before = Before { is_typed: true, ..Before::default() };
        let setup = interp::Setup {
            parameters: self.data.parameters.clone(),
            tools: self.data.tools.clone(),
            ..self.base.interp_setup()
        };
        let operations = Operations::after(before, b"", &setup, &Interruption::default());
        self.data.leave(operations.left().rest.clone());
    }

    /// Ask for something. Whether it is done now or in the periods to come, it is answered at once:
    /// accepted or refused.
    ///
    /// # Errors
    /// What the request needs and is not so, or what is wrong with it: nothing is changed, nothing
    /// moves.
    pub fn request(&mut self, request: &Request) -> Result<Accepted, Refusal> {
        self.admits(request)?;
        match request {
            Request::Power(on) => self.switch_power(*on),
            Request::EmergencyStop(pressed) => self.press_emergency_stop(*pressed),
            Request::Home(axis) => self.home(*axis),
            Request::Jog(axis, jog) => self.jog(*axis, *jog),
            Request::JogStop => self.stop_jog(),
            Request::TurnSpindle(spindle, spin) => self.turn_spindle(*spindle, *spin),
            Request::OrientSpindle(spindle, angle) => self.orient_spindle(*spindle, *angle),
            Request::Load(_)
            | Request::LoadAs(..)
            | Request::Search(..)
            | Request::Start
            | Request::ManualDataInput(_) => match self.begin(request) {
                Begun::Answered(answer) => answer,
                Begun::Proving(proving) => self.complete(proving.planned().prove()),
            },
            Request::Sequence(order) => self.sequence(*order),
            Request::FeedHold => self.hold(),
            Request::Resume => self.resume(),
            Request::Confirm => self.confirm(),
            Request::Stop => self.give_up(),
            Request::Retract => self.retract(),
            Request::Recover => self.recover(),
            Request::ToolIsFree => self.tool_is_free(),
            Request::BeginWorkpiece(name) => self.begin_workpiece(name.as_deref()),
            Request::EndWorkpiece => self.end_workpiece(),
            Request::AcknowledgeState => self.acknowledge_state(),
            Request::Reset => self.reset(),
            Request::SingleBlock(on) => self.set(kernel::Order::SingleBlock(*on)),
            Request::OptionalStop(on) => self.set(kernel::Order::OptionalStop(*on)),
            Request::Flood(on) => self.set(kernel::Order::Flood(*on)),
            Request::Mist(on) => self.set(kernel::Order::Mist(*on)),
            Request::BlockSkip(level, on) => self.skip_blocks(*level, *on),
            Request::FeedOverride(share) => self.set(kernel::Order::FeedOverride(*share)),
            Request::RapidOverride(share) => self.set(kernel::Order::RapidOverride(*share)),
            Request::SpindleOverride(share) => self.set(kernel::Order::SpindleOverride(*share)),
            Request::TouchOff(axis, at) => self.touch_off(*axis, *at),
            Request::SetWorkOffset(system, axis, at) => self.set_work_offset(*system, *axis, *at),
            Request::EditTool(number, field, value) => self.edit_tool(*number, *field, *value),
            Request::RenewTool(number) => self.renew_tool(*number),
            Request::LimitTool(number, uses) => {
                self.change_tool(*number, |tool| tool.life.limit.uses = *uses)
            }
        }
    }

    /// An order that changes a setting, which is kept.
    fn set(&mut self, order: kernel::Order) -> Result<Accepted, Refusal> {
        let accepted = self.order(order)?;
        self.keep_settings()?;
        Ok(accepted)
    }

    pub(super) fn order(&mut self, order: kernel::Order) -> Result<Accepted, Refusal> {
        self.executor.kernel.order(order);
        let mut notes = Vec::new();
        if self.under_way.is_none() {
            // what the kernel says of it would come only with the next program
            while let Some(event) = self.executor.kernel.next_event() {
                if let kernel::EventKind::Operator(notice) = event.kind {
                    notes.push(notice.to_string());
                }
            }
        }
        Ok(Accepted { notes })
    }

    /// Periods that are over and were not looked at yet: so often [`Control::period`] answers at
    /// once. In lock-step there are none.
    pub fn periods_waiting(&self) -> usize {
        self.executor.periods_waiting()
    }

    /// How the servo thread keeps its time; `None` in lock-step.
    pub fn real_time(&self) -> Option<RealTimeFigures> {
        self.executor.real_time()
    }

    /// Where the axes are told to be.
    pub(super) fn position(&self) -> Position {
        let mut place = self.base.interp_setup().start;
        for axis in self.base.machine.axes.iter().flatten() {
            if let Some(at) = self.executor.kernel.setpoint(axis.letter) {
                place = place.with(axis.letter, at);
            }
        }
        place
    }

    /// The tool in the spindle; 0 is none.
    pub(super) fn mounted(&self) -> u32 {
        if let Some(changer) = &self.changer {
            return changer.magazine.spindle;
        }
        self.executor.machine.feedback().tool.unwrap_or(0)
    }

    pub(super) fn enter(&mut self, mode: Mode) {
        if self.mode != mode {
            self.mode = mode;
            self.events.push(Event::Mode(mode));
        }
    }

    /// What the program does changes, if the table of transitions has it.
    pub(super) fn execution_after(&mut self, event: ExecutionEvent) {
        if let Some(next) = self.execution.after(event).filter(|next| *next != self.execution) {
            self.execution = next;
            self.events.push(Event::Execution(next));
        }
    }

    /// One servo period.
    pub fn period(&mut self) {
        self.events.at(self.now());
        if let Some(under_way) = &mut self.under_way {
            let goes_on = under_way.running.period(&mut self.executor);
            let heard = under_way.running.take_events();
            self.meters.sample(under_way.running.sample());
            under_way.follow(&self.executor);
            self.hear(&heard);
            self.follow_sequence();
            self.hear_program(false);
            if goes_on.is_break() {
                self.end_program();
            } else {
                self.follow_execution();
            }
        } else {
            let Self { executor, workpiece, meters, .. } = self;
            let sample = executor.period(|_, _, sample| workpiece.sample(sample));
            meters.sample(sample);
            let mut heard = Vec::new();
            while let Some(event) = self.executor.kernel.next_event() {
                heard.push(event);
            }
            self.hear(&heard);
            self.go_on_without_program();
        }
        self.take_alarms();
        self.follow_broken_tool();
        self.say_unkept();
        self.follow_machine();
        self.follow_panel();
        let is_ready = self.executor.kernel.is_ready();
        if is_ready && !self.drives_were_ready {
            if !self.is_tool_left() {
                self.take_homed();
            }
            self.events.push(Event::DrivesReady);
        }
        self.drives_were_ready = is_ready;
    }

    /// What a program that is under way does, by what the kernel does.
    fn follow_execution(&mut self) {
        let kernel = &self.executor.kernel;
        let waits_for = kernel.waiting().map(|waiting| waiting.what);
        let event = match (kernel.report().state, waits_for) {
            (State::Held, _) if !self.is_hold_asked && kernel.operator().is_held_after_block() => {
                ExecutionEvent::BlockDone
            }
            // a hold acts before the control has heard of it
            (State::Held, _) => ExecutionEvent::Hold,
            (_, Some(WaitFor::Operator { optional: true })) => ExecutionEvent::OptionalStop,
            (_, Some(WaitFor::Operator { optional: false })) => ExecutionEvent::Stop,
            (_, Some(WaitFor::ToolByHand(_) | WaitFor::Input(_))) => ExecutionEvent::Wait,
            // a held tap that backs out is held all the same
            _ if self.is_hold_asked && self.execution == Execution::FeedHold => {
                ExecutionEvent::Hold
            }
            _ => ExecutionEvent::GoOn,
        };
        self.execution_after(event);
        self.tell_changed();
        let judged = self.under_way.as_ref().map_or(0, |u| u.running.judged_so_far().len());
        if judged > self.told_features
            && let Some(under_way) = &self.under_way
        {
            let first = under_way.first;
            let new = under_way.running.judged_so_far()[self.told_features..].to_vec();
            let cut = super::under_way::count_from(first, under_way.running.judged_so_far());
            self.told_features = judged;
            self.tell_features(new);
            self.note_progress(first, cut, false);
            self.keep_progress();
        }
    }

    /// What goes on without a program: a reset that waits for standstill, a recovery.
    fn go_on_without_program(&mut self) {
        let kernel = &mut self.executor.kernel;
        if self.is_resetting && kernel.is_standing() && kernel.clear() {
            self.is_resetting = false;
        }
        self.go_on_homing();
        if self.is_recovering && self.executor.kernel.is_over() {
            self.is_recovering = false;
            self.after_recovery();
        }
        self.settle();
    }
}
