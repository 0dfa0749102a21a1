//! An axis of a drive: from the objects that the master writes to the motor, and back.
use super::homing::{HomingState, HomingSwitches, Sight};
use super::motor::Motor;
use super::probe::{Edges, Probe};
use super::states::{DriveState, next_state, status_word};
use super::target::CyclicTarget;
use crate::coe::{Dictionary, Emergency, Handle};
use units::{Spin, Time};

/// Mode: frequency converter.
const VELOCITY: i64 = 2;
/// Mode: homing by the drive.
const HOMING: i64 = 6;
/// Mode: cyclic synchronous position.
const CSP: i64 = 8;
/// Mode: cyclic synchronous velocity.
const CSV: i64 = 9;
/// Mode: cyclic synchronous torque.
const CST: i64 = 10;
/// Error code: the following error was too large.
const FOLLOWING_ERROR: u16 = 0x8611;
/// Error code: the connection was lost.
const CONNECTION: u16 = 0x8130;
/// Bit of the control word that starts homing.
const START: u16 = 0x10;
/// Bit 12 of the status word: the target is followed, or homing is attained.
const FOLLOWS: u16 = 1 << 12;
/// Bit 13: following error, or homing error.
const ERROR: u16 = 1 << 13;
/// Bit 10: target reached.
const REACHED: u16 = 1 << 10;

/// Objects of an axis, found once.
#[derive(Clone, Debug)]
struct Handles(Vec<Handle>);

/// Indexes of [`Handles`].
macro_rules! handles {
    ($($name:ident = $index:literal : $sub:literal),+ $(,)?) => {
        #[derive(Clone, Copy)]
        enum Id { $($name),+ }
        const IDS: &[(u16, u8)] = &[$(($index, $sub)),+];
    };
}

handles! {
    ErrorCode = 0x603F:0, Control = 0x6040:0, Status = 0x6041:0, VlTarget = 0x6042:0,
    VlDemand = 0x6043:0, VlActual = 0x6044:0, VlUp = 0x6048:1, VlUpTime = 0x6048:2,
    VlDown = 0x6049:1, VlDownTime = 0x6049:2, QuickStop = 0x605A:0, Abort = 0x6007:0,
    Mode = 0x6060:0, ModeDisplay = 0x6061:0, Demand = 0x6062:0, Position = 0x6064:0,
    Window = 0x6065:0, WindowTime = 0x6066:0, Velocity = 0x606C:0, TargetTorque = 0x6071:0,
    Torque = 0x6077:0, Target = 0x607A:0, HomeOffset = 0x607C:0, MostSpeed = 0x6080:0,
    Deceleration = 0x6085:0, Method = 0x6098:0, HomingFast = 0x6099:1, HomingSlow = 0x6099:2,
    ProbeFunction = 0x60B8:0, ProbeStatus = 0x60B9:0, Probe1Rising = 0x60BA:0,
    Probe1Falling = 0x60BB:0, Probe2Rising = 0x60BC:0, Probe2Falling = 0x60BD:0,
    FollowingError = 0x60F4:0, Inputs = 0x60FD:0, TargetVelocity = 0x60FF:0,
}

/// An axis.
#[derive(Clone, Debug)]
pub(crate) struct EmulatedAxis {
    handles: Handles,
    modes: &'static [i64],
    pub(crate) state: DriveState,
    control: u16,
    mode: i64,
    pub(crate) motor: Motor,
    pub(crate) switches: HomingSwitches,
    /// Bits of 60FD where something else than the motor's angle decides them.
    pub(crate) outside_inputs: Option<u32>,
    target: CyclicTarget,
    pub(crate) probe_input: bool,
    probe_before: bool,
    homing: HomingState,
    probes: [Probe; 2],
    /// Counts of the motor at position 0.
    zero: i64,
    vl_rpm: f64,
    window_s: f64,
    fault: Option<u16>,
}

impl EmulatedAxis {
    /// Finds the objects of an axis; `None` where one is missing.
    pub(crate) fn new(
        dictionary: &Dictionary,
        offset: u16,
        motor: Motor,
        modes: &'static [i64],
    ) -> Option<Self> {
        let found = IDS.iter().map(|(index, sub)| dictionary.find(index + offset, *sub));
        Some(Self {
            handles: Handles(found.collect::<Option<_>>()?),
            modes,
            state: DriveState::NotReadyToSwitchOn,
            control: 0,
            mode: 0,
            motor,
            switches: HomingSwitches::new(),
            outside_inputs: None,
            target: CyclicTarget::default(),
            probe_input: false,
            probe_before: false,
            homing: HomingState::NotStarted,
            probes: Default::default(),
            zero: 0,
            vl_rpm: 0.0,
            window_s: 0.0,
            fault: None,
        })
    }

    fn get(&self, dictionary: &Dictionary, id: Id) -> i64 {
        dictionary.get(self.handles.0[id as usize])
    }

    fn set(&self, dictionary: &mut Dictionary, id: Id, value: i64) {
        dictionary.set(self.handles.0[id as usize], value);
    }

    fn inputs(&self) -> u32 {
        self.outside_inputs.unwrap_or_else(|| self.switches.bits(self.motor.angle))
    }

    /// Makes the drive find a fault of its own.
    pub(crate) fn fail(&mut self, code: u16) {
        self.fault = Some(code);
    }

    /// Reacts to the end of cyclic data as 6007 has it.
    pub(crate) fn lose_connection(&mut self, dictionary: &mut Dictionary) {
        if self.state != DriveState::OperationEnabled {
            return;
        }
        match self.get(dictionary, Id::Abort) {
            1 => self.fail(CONNECTION),
            2 => self.set(dictionary, Id::Control, 0),
            3 => self.set(dictionary, Id::Control, 2),
            _ => {}
        }
    }

    /// Goes on for a period; `is_told`: setpoints have come since the last one. What the drive says
    /// unasked is put into `says`.
    pub(crate) fn step(
        &mut self,
        dictionary: &mut Dictionary,
        period: Time,
        is_told: bool,
        says: &mut Option<Emergency>,
    ) {
        let target = self.get(dictionary, Id::Target) as i32;
        let follows = self.state == DriveState::OperationEnabled && self.mode == CSP;
        self.target.take(target, is_told || !follows);
        let control = self.get(dictionary, Id::Control) as u16;
        self.advance_state(dictionary, control, says);
        self.change_mode(dictionary);
        let before = self.motor.counts();
        let most_rpm = self.get(dictionary, Id::MostSpeed);
        self.motor.most_spin = Spin::rpm(most_rpm as f64);
        self.drive(dictionary, control, period);
        self.control = control;
        self.probe(dictionary, before);
        self.watch_following_error(dictionary, period);
        self.report(dictionary);
    }

    fn advance_state(
        &mut self,
        dictionary: &mut Dictionary,
        control: u16,
        says: &mut Option<Emergency>,
    ) {
        if let Some(code) = self.fault.take()
            && !matches!(self.state, DriveState::Fault | DriveState::FaultReactionActive)
        {
            self.state = DriveState::FaultReactionActive;
            self.set(dictionary, Id::ErrorCode, i64::from(code));
            dictionary.put(0x1001, 0, 0x21);
            *says = Some(Emergency { code, register: 0x21, data: [0; 5] });
            return;
        }
        let before = self.state;
        self.state = next_state(self.state, control, self.control);
        if before == DriveState::Fault && self.state != before {
            self.set(dictionary, Id::ErrorCode, 0);
            dictionary.put(0x1001, 0, 0);
            *says = Some(Emergency { code: 0, register: 0, data: [0; 5] });
        }
    }

    fn change_mode(&mut self, dictionary: &mut Dictionary) {
        let wanted = self.get(dictionary, Id::Mode);
        if wanted != self.mode && self.modes.contains(&wanted) {
            self.mode = wanted;
            self.homing = HomingState::NotStarted;
            self.vl_rpm = self.motor.spin.in_rpm();
        }
    }

    fn drive(&mut self, dictionary: &mut Dictionary, control: u16, period: Time) {
        match self.state {
            DriveState::OperationEnabled => self.follow(dictionary, control, period),
            DriveState::QuickStopActive => self.brake(dictionary, period),
            _ => self.motor.coast(period),
        }
        if self.state != DriveState::OperationEnabled {
            let here = self.motor.counts() - self.zero;
            self.set(dictionary, Id::Demand, wrap(here));
        }
    }

    fn follow(&mut self, dictionary: &mut Dictionary, control: u16, period: Time) {
        match self.mode {
            CSP => {
                let target = self.target.counts;
                self.set(dictionary, Id::Demand, i64::from(target));
                let here = self.motor.counts();
                let way = target.wrapping_sub((here - self.zero) as i32);
                self.motor.follow(self.motor.angle_of(here + i64::from(way)), period);
            }
            CSV => {
                let spin = self.motor.spin_of(self.get(dictionary, Id::TargetVelocity));
                self.motor.run(spin, period);
            }
            CST => {
                let share = self.get(dictionary, Id::TargetTorque) as f64 / 1000.0;
                self.motor.push(self.motor.rated_torque * share, period);
            }
            VELOCITY => self.ramp(dictionary, period),
            HOMING => self.home(dictionary, control, period),
            _ => self.motor.run(Spin::ZERO, period),
        }
        if self.mode != CSP {
            let here = self.motor.counts() - self.zero;
            self.set(dictionary, Id::Demand, wrap(here));
        }
    }

    fn ramp(&mut self, dictionary: &mut Dictionary, period: Time) {
        let target = self.get(dictionary, Id::VlTarget) as f64;
        let slower = target.abs() < self.vl_rpm.abs();
        let (speed, time) =
            if slower { (Id::VlDown, Id::VlDownTime) } else { (Id::VlUp, Id::VlUpTime) };
        let time = self.get(dictionary, time).max(1) as f64;
        let most = self.get(dictionary, speed) as f64 / time * period.value();
        self.vl_rpm += (target - self.vl_rpm).clamp(-most, most);
        self.motor.run(Spin::rpm(self.vl_rpm), period);
        self.set(dictionary, Id::VlDemand, self.vl_rpm.round() as i64);
    }

    fn home(&mut self, dictionary: &mut Dictionary, control: u16, period: Time) {
        let method = self.get(dictionary, Id::Method);
        if control & !self.control & START != 0 {
            self.homing = HomingState::start(method);
        } else if control & START == 0 && self.homing.is_moving() {
            self.homing = HomingState::NotStarted;
        }
        let speeds =
            [Id::HomingFast, Id::HomingSlow].map(|id| self.motor.spin_of(self.get(dictionary, id)));
        let before = self.homing;
        // the index mark of the last period: the motor stands within a period of it
        let index = self.motor.angle.value().floor()
            != (self.motor.angle - self.motor.spin * period).value().floor();
        let switches = self.inputs();
        let sight = Sight { method, switches, index, speeds };
        let (next, spin) = self.homing.next(&sight);
        self.homing = next;
        let starts_here = matches!(method, 35 | 37) && control & !self.control & START != 0;
        if next == HomingState::Attained && (before != HomingState::Attained || starts_here) {
            let mark = if matches!(method, 1 | 2 | 33 | 34) {
                self.index_counts()
            } else {
                self.motor.counts()
            };
            self.zero = mark - self.get(dictionary, Id::HomeOffset);
        }
        self.motor.run(spin, period);
    }

    /// Counts of the index mark that is next to the motor.
    fn index_counts(&self) -> i64 {
        let counts = i64::from(self.motor.counts_per_rev);
        (self.motor.angle.value().round() as i64) * counts
    }

    fn brake(&mut self, dictionary: &mut Dictionary, period: Time) {
        let most =
            self.motor.spin_of(self.get(dictionary, Id::Deceleration)).value() * period.value();
        let spin = self.motor.spin.value();
        let less = most.min(spin.abs());
        self.motor.run(Spin::rev_per_s(spin - less.copysign(spin)), period);
        let option = self.get(dictionary, Id::QuickStop);
        if option == 0 || option < 5 && self.motor.spin == Spin::ZERO {
            self.state = DriveState::SwitchOnDisabled;
        }
    }

    fn probe(&mut self, dictionary: &mut Dictionary, before: i64) {
        let here = self.motor.counts();
        let turn = i64::from(self.motor.counts_per_rev);
        // up: (before, here]; down: [here, before)
        let mark = if here > before {
            here.div_euclid(turn) * turn
        } else {
            -(-here).div_euclid(turn) * turn
        };
        let passed = if here > before { mark > before } else { mark < before };
        let rose = self.probe_input && !self.probe_before;
        let fell = !self.probe_input && self.probe_before;
        let edges = Edges {
            input: [rose.then_some(here - self.zero), fell.then_some(here - self.zero)],
            index: passed.then_some(mark - self.zero),
        };
        self.probe_before = self.probe_input;
        let function = self.get(dictionary, Id::ProbeFunction) as u16;
        let [low, high] = function.to_le_bytes();
        let status = [self.probes[0].update(low, &edges), self.probes[1].update(high, &edges)];
        self.set(dictionary, Id::ProbeStatus, i64::from(u16::from_le_bytes(status)));
        let places = [[Id::Probe1Rising, Id::Probe1Falling], [Id::Probe2Rising, Id::Probe2Falling]];
        for (probe, places) in self.probes.iter().zip(places) {
            for (position, place) in probe.positions().into_iter().zip(places) {
                dictionary.set(self.handles.0[place as usize], wrap(position));
            }
        }
    }

    fn watch_following_error(&mut self, dictionary: &mut Dictionary, period: Time) {
        let error = wrap(self.get(dictionary, Id::Demand) - (self.motor.counts() - self.zero));
        let window = self.get(dictionary, Id::Window);
        self.set(dictionary, Id::FollowingError, error);
        let follows = self.state == DriveState::OperationEnabled && self.mode == CSP;
        if !follows || window == i64::from(u32::MAX) || error.abs() <= window {
            self.window_s = 0.0;
            return;
        }
        self.window_s += period.value();
        if self.window_s * 1e3 > self.get(dictionary, Id::WindowTime) as f64 {
            self.fail(FOLLOWING_ERROR);
        }
    }

    fn report(&self, dictionary: &mut Dictionary) {
        let enabled = self.state == DriveState::OperationEnabled;
        let follows = match self.mode {
            CSP | CSV | CST if enabled => FOLLOWS,
            HOMING if self.homing == HomingState::Attained => FOLLOWS | REACHED,
            HOMING if self.homing == HomingState::Failed => ERROR,
            VELOCITY if self.get(dictionary, Id::VlTarget) == self.vl_rpm.round() as i64 => REACHED,
            _ => 0,
        };
        let error = if self.window_s > 0.0 { ERROR } else { 0 };
        let status = status_word(self.state) | follows | error;
        let counts = f64::from(self.motor.counts_per_rev);
        let velocity = (self.motor.spin.value() * counts).round() as i64;
        let torque = self.motor.torque / self.motor.rated_torque * 1000.0;
        let torque = torque.clamp(f64::from(i16::MIN), f64::from(i16::MAX)).round() as i64;
        let mut inputs = self.inputs();
        inputs |= u32::from(self.probe_input) << 16;
        self.set(dictionary, Id::Status, i64::from(status));
        self.set(dictionary, Id::ModeDisplay, self.mode);
        self.set(dictionary, Id::Position, wrap(self.motor.counts() - self.zero));
        self.set(dictionary, Id::Velocity, velocity);
        self.set(dictionary, Id::Torque, torque);
        self.set(dictionary, Id::VlActual, self.motor.spin.in_rpm().round() as i64);
        self.set(dictionary, Id::Inputs, i64::from(inputs));
    }
}

/// Returns what 32 bits hold of a position: it goes on at the other end.
fn wrap(counts: i64) -> i64 {
    i64::from(counts as i32)
}
