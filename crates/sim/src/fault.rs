//! Faults as wrappers of a machine: what happens to a real machine, seeded and to the point.
//!
//! ```text
//!             Command                       Command, or none
//!   control ─────────► Faulty ─────────────────────────────► machine
//!           ◄───────── │    ◄─────────────────────────────
//!             Feedback │ trigger: time, angle, depth, or whenever the seed wants
//!                      └ power cut, kill, drive fault · lost index, slip, dropout, stuck, jump · late, missed · torque
//! ```
//!
//! A wrapper knows the bus only, so any [`Machine`] can be spoiled. Without a controller, or
//! without mains, the drives do by themselves what [`LeftAlone`] says ([`crate::RunDown`]):
//! nothing, coast, brake each by itself, or stop coupled.
//!
//! | fault | what happens |
//! |---|---|
//! | power cut | mains and controller are gone; what the drives still do lives on the DC bus and on what turns |
//! | kill | no command arrives any more; after their watchdog's time the drives stop by themselves |
//! | emergency stop | its chain opens: the drives stop by themselves, as in a kill, then their outputs are off |
//! | drive fault | one drive is off from then on |
//! | lost index | the index mark is never seen |
//! | encoder slip | the spindle's reading is off by so much from then on |
//! | feedback jump | an axis' reading is off by so much from then on |
//! | scale error | an axis' reading is off by a share of its way from where it stood when it came |
//! | eccentricity | a spindle's reading is off by an amplitude once per revolution |
//! | dropout | the spindle's encoder gives no number for so long |
//! | stuck | the encoder of an axis or a spindle says the same from then on |
//! | late, missed | a command arrives one period late from then on; a single one is lost |
//! | torque loss | the spindle gives only a share of what is ordered |
//!
//! Drives that the control switches off while they move stop by themselves ([`switched_off`]).
mod switched_off;

use crate::rng::Rng;
use crate::{Bus, Config, RunDown};
use bus::{Command, DriveReaction, Feedback, Machine, Truth};
use switched_off::SwitchedOff;
use units::{Angle, Coordinate, Time, Torque};

/// What the drives do by themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftAlone {
    /// The machine that they drive.
    pub config: Config,
    /// After so long without a command they take the control for dead.
    pub watchdog: Time,
    /// What they do then.
    pub on_silence: DriveReaction,
    /// What they do when the mains fail.
    pub on_power_loss: DriveReaction,
    /// What they live on meanwhile; without, outputs are off at once.
    pub bus: Option<Bus>,
}

/// When something happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trigger {
    /// At a time since the machine was started.
    At(Time),
    /// When the first spindle has turned this far in all, either way.
    Turned(Angle),
    /// When an axis passes a coordinate, by its encoder: bus index, coordinate.
    Passes(usize, Coordinate),
    /// With the same chance in each period of a span of time.
    Random(Time, Time),
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The mains fail.
    PowerCut,
    /// The controller vanishes.
    Kill,
    /// The chain opens.
    EmergencyStop,
    /// The drive of an axis is off from then on.
    AxisDrive(usize),
    /// The drive of a spindle is off from then on.
    SpindleDrive(usize),
    /// No index is seen any more.
    LostIndex,
    /// The first spindle's reading is off by so much.
    Slip(Angle),
    /// The first spindle's encoder gives no number for so long.
    Dropout(Time),
    /// Nothing new is heard of the machine for so long: its frames are lost. Commands arrive.
    FeedbackLost(Time),
    /// An axis' encoder is stuck.
    Stuck(usize),
    /// A spindle's encoder is stuck.
    StuckSpindle(usize),
    /// An axis' reading jumps.
    Jump(usize, Coordinate),
    /// An axis moves so much farther than it reads, from where it stands then: length over length.
    ScaleError(usize, f64),
    /// The disk of a spindle's encoder is off its centre: amplitude of the reading's error.
    Eccentricity(usize, Angle),
    /// Commands arrive a period late.
    Late,
    /// One command is lost: the one before it stands.
    Missed,
    /// A spindle gives this share of what is ordered.
    TorqueLoss(usize, f64),
}

impl Fault {
    /// Its name, as it is typed.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::PowerCut => "power-cut",
            Self::Kill => "kill",
            Self::EmergencyStop => "emergency-stop",
            Self::AxisDrive(_) | Self::SpindleDrive(_) => "drive-fault",
            Self::LostIndex => "lost-index",
            Self::Slip(_) => "encoder-slip",
            Self::Dropout(_) => "dropout",
            Self::FeedbackLost(_) => "feedback-lost",
            Self::Stuck(_) | Self::StuckSpindle(_) => "stuck",
            Self::Jump(..) => "feedback-jump",
            Self::ScaleError(..) => "scale-error",
            Self::Eccentricity(..) => "eccentricity",
            Self::Late => "late",
            Self::Missed => "missed",
            Self::TorqueLoss(..) => "torque-loss",
        }
    }
}

/// A fault and when it comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planned {
    /// When.
    pub trigger: Trigger,
    /// What.
    pub fault: Fault,
}

/// One that waits, or has come.
#[derive(Clone, Debug)]
struct Pending {
    planned: Planned,
    came: Option<Time>,
    /// What was read when it came.
    then: Feedback,
}

/// A machine to which things happen.
#[derive(Clone, Debug)]
pub struct Faulty<M> {
    machine: M,
    alone: Option<LeftAlone>,
    /// The drives on their own; and since when they are not commanded.
    run_down: Option<RunDown>,
    silent: Time,
    /// The emergency stop chain has opened, and the stop that the drives began then goes on: also
    /// when the chain is closed meanwhile.
    is_chain_stop: bool,
    /// Who commands has had the opened chain in a feedback before it commanded.
    is_chain_heard: bool,
    /// The button is released, and the opened chain has not been heard yet.
    is_released: bool,
    switched_off: SwitchedOff,
    pending: Vec<Pending>,
    last: Command,
    said: Feedback,
    first_angle: Angle,
}

impl<M: Machine> Faulty<M> {
    /// Wrap a machine. The seed decides what is left to chance.
    pub fn new(machine: M, planned: &[Planned], seed: u64) -> Self {
        let said = *machine.feedback();
        let mut rng = Rng::new(seed);
        let pending = planned
            .iter()
            .map(|planned| {
                let trigger = match planned.trigger {
                    Trigger::Random(from, to) => Trigger::At(from + (to - from) * rng.unit()),
                    given @ (Trigger::At(_) | Trigger::Turned(_) | Trigger::Passes(..)) => given,
                };
                let planned = Planned { trigger, ..*planned };
                Pending { planned, came: None, then: said }
            })
            .collect();
        Self {
            machine,
            alone: None,
            run_down: None,
            silent: Time::ZERO,
            is_chain_stop: false,
            is_chain_heard: false,
            is_released: false,
            switched_off: SwitchedOff::default(),
            pending,
            last: Command::default(),
            said,
            first_angle: said.spindles[0].angle,
        }
    }

    /// Drives that do something by themselves; without this their outputs go off.
    #[must_use]
    pub fn left_alone(mut self, alone: LeftAlone) -> Self {
        self.alone = Some(alone);
        self
    }

    /// The machine inside, without its faults.
    pub fn into_machine(self) -> M {
        self.machine
    }

    /// The machine inside.
    pub const fn machine(&self) -> &M {
        &self.machine
    }

    /// The same, to change what is clamped on it.
    pub const fn machine_mut(&mut self) -> &mut M {
        &mut self.machine
    }

    /// Let a fault come now. A button that is pressed already is pressed once.
    pub fn strike(&mut self, fault: Fault) {
        if fault == Fault::EmergencyStop {
            self.is_released = false;
            if self.has_open_chain() {
                return;
            }
            self.is_chain_heard = false;
        }
        let now = *self.machine.feedback();
        let planned = Planned { trigger: Trigger::At(now.time), fault };
        self.pending.push(Pending { planned, came: Some(now.time), then: now });
    }

    /// The faults that have come, each with its time, in the order in which they were planned.
    pub fn came(&self) -> impl Iterator<Item = (Fault, Time)> + '_ {
        self.pending.iter().filter_map(|p| Some((p.planned.fault, p.came?)))
    }

    /// The controller is gone, by a kill or with the mains: it should not tick.
    pub fn is_abandoned(&self) -> bool {
        self.has(|fault| matches!(fault, Fault::Kill | Fault::PowerCut))
    }

    /// The drives do what they do by themselves, and have not finished.
    pub fn is_running_down(&self) -> bool {
        self.run_down.as_ref().is_some_and(|drives| !drives.is_over())
    }

    /// Mend everything: power and controller are back, encoders say what is. Faults still to come
    /// stay.
    pub fn mend(&mut self) {
        self.pending.retain(|pending| pending.came.is_none());
        self.obey_again();
        self.is_released = false;
        self.switched_off = SwitchedOff::default();
        self.said = *self.machine.feedback();
    }

    /// A fault of this kind is over: a button is released, a drive is repaired. The chain is closed
    /// when it has been heard that it was open.
    pub fn repair(&mut self, fault: Fault) {
        if fault == Fault::EmergencyStop && self.has_open_chain() && !self.is_chain_heard {
            self.is_released = true;
            return;
        }
        self.pending.retain(|pending| pending.came.is_none() || pending.planned.fault != fault);
        if fault == Fault::EmergencyStop {
            self.is_released = false;
            self.said.emergency_stop = self.machine.feedback().emergency_stop;
        }
        if !self.is_stopping_alone() {
            self.obey_again();
        }
    }

    fn has_open_chain(&self) -> bool {
        self.has(|fault| matches!(fault, Fault::EmergencyStop))
    }

    /// The drives stop by themselves, whatever the control says: it is gone, or the chain was
    /// opened and not everything stands.
    fn is_stopping_alone(&self) -> bool {
        let rests = self.run_down.as_ref().is_some_and(RunDown::is_over);
        self.is_abandoned()
            || self.has_open_chain()
            || self.is_chain_stop && self.alone.is_some() && !rests
    }

    /// The drives obey commands from now on.
    fn obey_again(&mut self) {
        if self.is_chain_stop {
            // they are off since: the command before that counts no more
            self.last = Command { tool: self.last.tool, ..Command::default() };
        }
        (self.run_down, self.silent, self.is_chain_stop) = (None, Time::ZERO, false);
    }

    /// A period without a controller.
    pub fn wait(&mut self) -> &Feedback {
        let now = *self.machine.feedback();
        let no_power = self.has(|fault| matches!(fault, Fault::PowerCut));
        let off = Command { tool: self.last.tool, ..Command::default() };
        let order = match (&mut self.run_down, &self.alone) {
            (Some(run_down), _) => run_down.command(&now),
            (None, Some(alone)) if no_power || self.silent >= alone.watchdog => {
                let reaction = match (no_power, alone.bus) {
                    (true, None) => DriveReaction::Off,
                    (true, Some(_)) => alone.on_power_loss,
                    (false, _) => alone.on_silence,
                };
                let bus = alone.bus.filter(|_| no_power);
                let mut run_down = RunDown::new(&alone.config, reaction, bus, &self.last, &now);
                let order = run_down.command(&now);
                self.run_down = Some(run_down);
                order
            }
            (None, Some(_)) => self.last,
            (None, None) => off,
        };
        self.silent += self.machine.period();
        let said = *self.machine.exchange(&order);
        self.hear(&said)
    }

    fn has(&self, what: impl Fn(&Fault) -> bool) -> bool {
        self.pending.iter().any(|p| p.came.is_some() && what(&p.planned.fault))
    }

    /// What comes now.
    fn trip(&mut self) {
        let now = *self.machine.feedback();
        let turned = (now.spindles[0].angle - self.first_angle).abs();
        for pending in &mut self.pending {
            let comes = match pending.planned.trigger {
                Trigger::At(time) | Trigger::Random(time, _) => now.time >= time,
                Trigger::Turned(angle) => turned >= angle,
                Trigger::Passes(axis, place) => {
                    let (was, is) = (pending.then.axes[axis].position, now.axes[axis].position);
                    (was - place).value() * (is - place).value() <= 0.0 && was != is
                }
            };
            if pending.came.is_none() {
                pending.then = now;
                if comes {
                    pending.came = Some(now.time);
                }
            }
        }
    }

    /// The command as it arrives.
    fn order(&mut self, command: &Command) -> Command {
        let mut order = *command;
        for pending in &self.pending {
            let Some(came) = pending.came else { continue };
            let fresh = self.said.time <= came;
            match pending.planned.fault {
                Fault::AxisDrive(axis) => order.axes[axis].enable = false,
                Fault::SpindleDrive(spindle) => order.spindles[spindle].enable = false,
                Fault::TorqueLoss(spindle, share) => {
                    let torque = &mut order.spindles[spindle].torque;
                    *torque = Torque::n_m(torque.value() * share);
                }
                Fault::Late => order = self.last,
                Fault::Missed if fresh => order = self.last,
                Fault::Missed
                | Fault::PowerCut
                | Fault::Kill
                | Fault::EmergencyStop
                | Fault::LostIndex
                | Fault::Slip(_)
                | Fault::Dropout(_)
                | Fault::FeedbackLost(_)
                | Fault::Stuck(_)
                | Fault::StuckSpindle(_)
                | Fault::Jump(..)
                | Fault::ScaleError(..)
                | Fault::Eccentricity(..) => {}
            }
        }
        self.last = *command;
        order
    }

    /// The feedback as it is heard.
    fn hear(&mut self, real: &Feedback) -> &Feedback {
        let mut said = *real;
        for pending in &self.pending {
            let Some(came) = pending.came else { continue };
            let spindle = &mut said.spindles[0];
            match pending.planned.fault {
                Fault::EmergencyStop => said.emergency_stop = true,
                Fault::LostIndex => spindle.index = None,
                Fault::Slip(by) => spindle.angle += by,
                Fault::Dropout(lasts) if real.time - came < lasts => {
                    spindle.angle = Angle::rev(f64::NAN);
                }
                Fault::FeedbackLost(lasts) if real.time - came < lasts => said = pending.then,
                Fault::Stuck(axis) => said.axes[axis].position = pending.then.axes[axis].position,
                Fault::StuckSpindle(index) => {
                    said.spindles[index].angle = pending.then.spindles[index].angle;
                }
                Fault::Jump(axis, by) => said.axes[axis].position += by,
                Fault::ScaleError(axis, by) => {
                    let way = real.axes[axis].position - pending.then.axes[axis].position;
                    said.axes[axis].position -= way * by;
                }
                Fault::Eccentricity(index, by) => {
                    let wave = |angle: Angle| angle.in_rad().sin();
                    let then = wave(pending.then.spindles[index].angle);
                    let off = by * (wave(real.spindles[index].angle) - then);
                    said.spindles[index].angle += off;
                }
                Fault::Dropout(_)
                | Fault::FeedbackLost(_)
                | Fault::PowerCut
                | Fault::Kill
                | Fault::AxisDrive(_)
                | Fault::SpindleDrive(_)
                | Fault::Late
                | Fault::Missed
                | Fault::TorqueLoss(..) => {}
            }
        }
        self.said = said;
        &self.said
    }
}

impl<M: Machine> Machine for Faulty<M> {
    fn period(&self) -> Time {
        self.machine.period()
    }

    fn feedback(&self) -> &Feedback {
        &self.said
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        let now = *self.machine.feedback();
        self.is_chain_heard = self.said.emergency_stop;
        if self.is_released && self.is_chain_heard {
            self.repair(Fault::EmergencyStop);
        }
        let own = self
            .alone
            .as_ref()
            .and_then(|alone| self.switched_off.command(alone, (&self.last, command), &now));
        if self.pending.is_empty() && own.is_none() && !self.is_chain_stop {
            // nothing can happen to it: command and feedback pass as they are
            self.last = *command;
            self.said = *self.machine.exchange(command);
            return &self.said;
        }
        self.trip();
        self.is_chain_stop |= self.has_open_chain();
        if self.is_stopping_alone() {
            return self.wait();
        }
        if self.is_chain_stop {
            self.obey_again();
        }
        let order = self.order(&own.unwrap_or(*command));
        self.last = *command;
        let real = *self.machine.exchange(&order);
        self.hear(&real);
        self.switched_off.tell(&mut self.said);
        &self.said
    }

    fn truth(&self) -> Option<&Truth> {
        self.machine.truth()
    }
}
