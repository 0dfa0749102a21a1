//! The simulated machine behind emulated drives: what a master finds on the wire is a machine.
//!
//! ```text
//!   frame ─► NetworkSegment ─► setpoints, at SYNC0 ─► SimulatedMachine, a period ─► actual values, switches
//! ```
//!
//! A drive takes its setpoint at SYNC0 and reports where its motor is then; the machine's period
//! from that SYNC0 to the next is simulated at once. The drives of the simulated machine close
//! their loops in its physics ([`sim::PositionDrive`]).
use bus::{Command, Feedback, Machine, Truth};
use control::Refused;
use esc::{
    AlState, Device, DriveModel, Motor, MotorOrder, NetworkSegment, Passed, coupler, digital_io,
    drive,
};
use sim::SimulatedMachine;
use store::machine::{DeviceProfile, DriveSlot, MachineFile, Motor as AxisMotor};
use units::{Angle, Coordinate, Force, Spin, Torque};

/// A tool changer's word for an empty spindle.
const EMPTY: u8 = 0xFF;
/// A motor can turn so much faster than the fastest motion of its axis.
const FASTER: f64 = 1.5;
/// Nanoseconds by which the clocks of neighbours part in a second.
const DRIFT_PPB: i64 = 5_000;

/// A motor of a device, and what it moves.
#[derive(Clone, Copy, Debug)]
struct Moved {
    device: usize,
    /// Axis of the device.
    slot: usize,
    /// Index of the axis or the spindle.
    index: usize,
    is_spindle: bool,
    /// Turns of the motor per mm, ° or revolution.
    turns_per_unit: f64,
    /// Bits of 60FD: home switch, limit switches.
    bits: [Option<u8>; 3],
    /// Place that the drive wants.
    setpoint: f64,
}

/// A terminal.
#[derive(Clone, Copy, Debug)]
enum Terminal {
    Digital { device: usize, inputs_from: Option<u8>, outputs_from: Option<u8> },
    ToolChanger { device: usize },
}

/// See the module's header.
pub struct EmulatedMachine {
    segment: NetworkSegment,
    machine: SimulatedMachine,
    moved: Vec<Moved>,
    terminals: Vec<Terminal>,
    /// Pulses of SYNC0 of the first drive that were simulated, and when time was let pass last.
    synced: u64,
    advanced_ns: u64,
    period_ns: u64,
    command: Command,
}

impl EmulatedMachine {
    /// A machine of this file, switched off, behind the devices that its file expects.
    ///
    /// # Errors
    /// Its file has no network.
    pub fn new(file: &MachineFile, machine: SimulatedMachine) -> Result<Self, Refused> {
        let Some(network) = &file.ethercat else {
            return Err(Refused::because(format!(
                "the machine {} has no [ethercat] section: its drives cannot be emulated",
                file.name
            )));
        };
        let mut moved = Vec::new();
        let drifts = (0..).map(|at| DRIFT_PPB * at);
        let (mut devices, mut terminals): (Vec<Device>, Vec<Terminal>) = (Vec::new(), Vec::new());
        for ((at, of), drift_ppb) in network.devices.iter().enumerate().zip(drifts) {
            let [inputs_from, outputs_from] = of.signals_from;
            devices.push(match of.profile {
                DeviceProfile::Plain => coupler(drift_ppb),
                DeviceProfile::Cia402 => {
                    let slots = motors_of(file, &of.name);
                    let model = DriveModel {
                        motors: slots.iter().map(|(.., motor)| motor.clone()).collect(),
                        drift_ppb,
                        ..DriveModel::new(at as u32)
                    };
                    let led = slots.into_iter().filter_map(|(moves, _)| moves);
                    moved.extend(led.map(|moves| Moved { device: at, ..moves }));
                    drive(&model)
                }
                DeviceProfile::DigitalIo => {
                    terminals.push(Terminal::Digital { device: at, inputs_from, outputs_from });
                    digital_io()
                }
                DeviceProfile::ToolChanger => {
                    terminals.push(Terminal::ToolChanger { device: at });
                    digital_io()
                }
            });
        }
        let mut emulated = Self {
            segment: NetworkSegment::new(devices),
            period_ns: (machine.period().value() * 1e9).round() as u64,
            machine,
            moved,
            terminals,
            synced: 0,
            advanced_ns: 0,
            command: Command::default(),
        };
        emulated.show();
        Ok(emulated)
    }

    /// The devices.
    pub const fn segment_mut(&mut self) -> &mut NetworkSegment {
        &mut self.segment
    }

    /// The devices.
    pub const fn segment(&self) -> &NetworkSegment {
        &self.segment
    }

    /// The machine behind them.
    pub const fn machine(&self) -> &SimulatedMachine {
        &self.machine
    }

    /// Where the machine really is.
    pub fn truth(&self) -> Truth {
        self.machine.truth().copied().unwrap_or_default()
    }

    /// Setpoint of the last period.
    pub const fn command(&self) -> &Command {
        &self.command
    }

    /// Lets time pass up to a time that never goes back.
    pub fn advance(&mut self, now_ns: u64) {
        // no two pulses of SYNC0 within a step
        let step_ns = self.period_ns / 4;
        while self.advanced_ns + step_ns < now_ns {
            // a long pause is not lived through period by period
            let behind = now_ns - self.advanced_ns;
            self.advanced_ns +=
                if behind > 1000 * step_ns { behind - 1000 * step_ns } else { step_ns };
            self.segment.advance(self.advanced_ns);
            self.simulate();
        }
    }

    /// Sends a frame through the devices.
    pub fn pass(&mut self, frame: &mut [u8], now_ns: u64) -> Passed {
        self.advance(now_ns);
        let passed = self.segment.pass(frame, now_ns);
        self.simulate();
        passed
    }

    /// Simulates a period for each SYNC0 that has come since the last call.
    fn simulate(&mut self) {
        let first = self.moved.first().and_then(|moved| self.segment.device(moved.device));
        let syncs = first.map_or(0, Device::syncs);
        // a device that was turned off and on counts anew
        let due = syncs.checked_sub(self.synced).unwrap_or(syncs);
        self.synced = syncs;
        for _ in 0..due.min(2) {
            self.obey();
            self.machine.exchange(&self.command);
            self.show();
        }
    }

    /// What the drives want of their motors becomes a command to the machine.
    fn obey(&mut self) {
        let Self { segment, machine, moved, terminals, command, .. } = self;
        let period = machine.period();
        let feedback = machine.feedback();
        for one in moved {
            let device = segment.device(one.device).filter(|_| segment.is_on(one.device));
            let motor = device.and_then(|device| device.motor(one.slot));
            let order = motor.and_then(|motor| motor.outside).unwrap_or_default();
            let mut spin = Spin::ZERO;
            let enable = match order {
                MotorOrder::Angle(angle) => {
                    one.setpoint = angle.value() / one.turns_per_unit;
                    true
                }
                MotorOrder::Spin(turns) => {
                    spin = turns / one.turns_per_unit;
                    one.setpoint += (spin * period).value();
                    true
                }
                // the loops of the simulated drives take no torque
                MotorOrder::Free | MotorOrder::Torque(_) => {
                    one.setpoint = if one.is_spindle {
                        feedback.spindles[one.index].angle.value()
                    } else {
                        feedback.axes[one.index].position.value()
                    };
                    false
                }
            };
            if one.is_spindle {
                let told = &mut command.spindles[one.index];
                (told.enable, told.angle, told.spin) = (enable, Angle::rev(one.setpoint), spin);
            } else {
                let told = &mut command.axes[one.index];
                (told.enable, told.position) = (enable, Coordinate::new(one.setpoint));
            }
        }
        command.tool = feedback.tool.unwrap_or(command.tool);
        for terminal in terminals {
            let (Terminal::Digital { device, .. } | Terminal::ToolChanger { device }) = *terminal;
            let of = segment.device(device).filter(|_| segment.is_on(device));
            let Some(of) = of.filter(|of| of.state() == AlState::Op) else { continue };
            let bits = of.digital_outputs();
            match *terminal {
                Terminal::Digital { outputs_from: Some(from), .. } => {
                    for bit in 0..8 {
                        command.outputs.switch(from.saturating_add(bit), bits >> bit & 1 == 1);
                    }
                }
                Terminal::Digital { .. } => {}
                Terminal::ToolChanger { .. } => match bits {
                    0 => {}
                    EMPTY => command.tool = 0,
                    number => command.tool = u32::from(number),
                },
            }
        }
    }

    /// What the machine says becomes the drives' actual values and the terminals' inputs.
    fn show(&mut self) {
        let Self { segment, machine, moved, terminals, .. } = self;
        let feedback = machine.feedback();
        let truth = machine.truth();
        for one in moved {
            let Some(device) = segment.device_mut(one.device) else { continue };
            let (place, bits) = if one.is_spindle {
                (feedback.spindles[one.index].angle.value(), [false; 3])
            } else {
                let axis = &feedback.axes[one.index];
                let [low, high] = axis.limit_switches;
                (axis.position.value(), [axis.home_switch, low, high])
            };
            if let Some(motor) = device.motor_mut(one.slot) {
                let angle = Angle::rev(place * one.turns_per_unit);
                let period = machine.period();
                motor.spin = (angle - motor.angle) / period;
                motor.angle = angle;
                motor.torque = one.motor_torque(feedback, truth);
            }
            let inputs = one.bits.into_iter().zip(bits);
            let inputs = inputs.filter_map(|(bit, on)| bit.filter(|_| on));
            device.set_axis_inputs(one.slot, inputs.fold(0, |all, bit| all | 1 << bit));
        }
        for terminal in terminals {
            let (device, bits) = match *terminal {
                Terminal::Digital { device, inputs_from: Some(from), .. } => {
                    let shown =
                        (0..8).filter(|bit| feedback.inputs.is_on(from.saturating_add(*bit)));
                    (device, shown.fold(0, |all, bit| all | 1 << bit))
                }
                Terminal::Digital { .. } => continue,
                Terminal::ToolChanger { device } => {
                    let number = match feedback.tool {
                        None => 0,
                        Some(0) => EMPTY,
                        Some(number) => u8::try_from(number).unwrap_or(0),
                    };
                    (device, number)
                }
            };
            if let Some(device) = segment.device_mut(device) {
                device.set_digital_inputs(bits);
            }
        }
    }
}

impl Moved {
    /// Torque of the motor, by what the machine's drives measure, else by what they give.
    fn motor_torque(&self, feedback: &Feedback, truth: Option<&Truth>) -> Torque {
        if self.is_spindle {
            let given = truth.map(|truth| truth.spindle_torques[self.index]);
            let torque = feedback.spindles[self.index].torque.or(given).unwrap_or(Torque::ZERO);
            return torque / self.turns_per_unit;
        }
        let given = truth.map(|truth| truth.axis_forces[self.index]);
        let force = feedback.axes[self.index].force.or(given).unwrap_or(Force::ZERO);
        // the work of a turn: N over as many mm
        Torque::n_m(force.value() * 1e-3 / (std::f64::consts::TAU * self.turns_per_unit))
    }
}

/// Motors of a device by its slots, and what each of them moves.
fn motors_of(file: &MachineFile, name: &str) -> Vec<(Option<Moved>, Motor)> {
    let mut slots: Vec<(Option<Moved>, Motor)> = Vec::new();
    let mut put = |slot: &DriveSlot, index, is_spindle, (per_rev, fastest): (f64, f64)| {
        if slot.device != name {
            return;
        }
        let at = usize::from(slot.slot);
        while slots.len() <= at {
            slots.push((None, Motor::new()));
        }
        let sign = if slot.is_reversed { -1.0 } else { 1.0 };
        let turns_per_unit = sign * f64::from(slot.gear.0) / f64::from(slot.gear.1) / per_rev;
        let [low, high] = slot.inputs.limits;
        let moved = Moved {
            device: 0,
            slot: at,
            index,
            is_spindle,
            turns_per_unit,
            bits: [slot.inputs.home, low, high],
            setpoint: 0.0,
        };
        let motor = Motor {
            counts_per_rev: slot.counts_per_rev,
            most_spin: Spin::rev_per_s(fastest * turns_per_unit.abs() * FASTER),
            outside: Some(MotorOrder::Free),
            rated_torque: slot.torque_rated.unwrap_or(Motor::new().rated_torque),
            ..Motor::new()
        };
        slots[at] = (Some(moved), motor);
    };
    for (index, axis) in file.axes.iter().enumerate() {
        let Some((axis, slot)) = axis.as_ref().and_then(|a| Some((a, a.ethercat.as_ref()?))) else {
            continue;
        };
        let per_rev = match axis.drive.motor {
            AxisMotor::BallScrew { lead, .. } => lead.value(),
            AxisMotor::Linear { .. } => 1.0,
        };
        put(slot, index, false, (per_rev, axis.rapid.value()));
    }
    for (index, spindle) in file.spindles.iter().enumerate() {
        if let Some(slot) = &spindle.ethercat {
            put(slot, index, true, (1.0, spindle.max.value()));
        }
    }
    slots
}
