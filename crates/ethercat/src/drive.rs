//! An axis of a drive in the process image: status word to control word, and setpoints that never
//! jump.
use crate::cia402::{PdsState, Wanted, control_word, state};
use crate::image::ImagePlace;
use crate::network::{AxisSlot, Device, DriveMode};
use crate::pdo::Images;

/// Cycles for which the bit that resets a fault is held at most.
const MOST_RESET_CYCLES: u16 = 1_000;

/// What is wanted of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DriveCommand {
    /// State.
    pub wanted: Wanted,
    /// Setpoint in the mode's own unit: counts, counts/s, per mille of the rated torque, rpm.
    pub target: i32,
}

/// What an axis says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DriveFeedback {
    /// Status word.
    pub status: u16,
    /// Actual position, counts.
    pub position: i32,
    /// Actual speed, counts/s; `None` where it is not exchanged.
    pub velocity: Option<i32>,
    /// Actual torque, per mille of the rated one; `None` where it is not exchanged.
    pub torque: Option<i16>,
    /// Mode in force; `None` where it is not exchanged.
    pub mode: Option<i8>,
    /// Digital inputs, 60FD; `None` where they are not exchanged.
    pub inputs: Option<u32>,
    /// Error code, 603F; `None` where it is not exchanged.
    pub error: Option<u16>,
}

impl DriveFeedback {
    /// State; `None` where the status word is none of the standard's.
    pub fn state(&self) -> Option<PdsState> {
        state(self.status)
    }

    /// It follows its setpoints.
    pub fn is_enabled(&self) -> bool {
        self.state() == Some(PdsState::OperationEnabled)
    }
}

/// An axis of a drive.
#[derive(Clone, Debug)]
pub struct DriveAxis {
    pub(crate) device: usize,
    mode: DriveMode,
    most_step: u32,
    control: ImagePlace,
    target: ImagePlace,
    mode_out: Option<ImagePlace>,
    status: ImagePlace,
    position: ImagePlace,
    velocity: Option<ImagePlace>,
    torque: Option<ImagePlace>,
    mode_in: Option<ImagePlace>,
    inputs: Option<ImagePlace>,
    error: Option<ImagePlace>,
    command: DriveCommand,
    reset_cycles: u16,
    feedback: DriveFeedback,
    sent_target: i32,
    sent_control: u16,
    is_held: bool,
}

impl DriveAxis {
    /// Finds the values of a slot; `None` where one that is needed is missing.
    pub(crate) fn new(device: usize, slot: AxisSlot, images: &Images) -> Option<Self> {
        let offset = 0x800 * u16::from(slot.number);
        let out = |object: u16| images.outputs.find(object + offset, 0);
        let into = |object: u16| images.inputs.find(object + offset, 0);
        Some(Self {
            device,
            mode: slot.mode,
            most_step: slot.most_step,
            control: out(0x6040)?,
            target: out(slot.mode.target())?,
            mode_out: out(0x6060),
            status: into(0x6041)?,
            position: into(0x6064)?,
            velocity: into(0x606C),
            torque: into(0x6077),
            mode_in: into(0x6061),
            inputs: into(0x60FD),
            error: into(0x603F),
            command: DriveCommand::default(),
            reset_cycles: 0,
            feedback: DriveFeedback::default(),
            sent_target: 0,
            sent_control: 0,
            is_held: false,
        })
    }

    /// All axes of the devices of a network.
    pub(crate) fn all(devices: &[Device], images: &[Images]) -> Vec<Self> {
        let devices = devices.iter().zip(images).enumerate();
        let axes = devices.flat_map(|(at, (device, images))| {
            device.slots.iter().filter_map(move |slot| Self::new(at, *slot, images))
        });
        axes.collect()
    }

    /// What it says.
    pub fn feedback(&self) -> &DriveFeedback {
        &self.feedback
    }

    /// Target that was sent last.
    pub fn sent_target(&self) -> i32 {
        self.sent_target
    }

    /// Control word that was sent last.
    pub fn sent_control(&self) -> u16 {
        self.sent_control
    }

    /// The target that is wanted is too far from the last one: that one is sent still.
    pub fn is_held(&self) -> bool {
        self.is_held
    }

    pub(crate) fn set_command(&mut self, command: DriveCommand) {
        self.command = command;
    }

    /// Asks for the reset of a fault, if there is one: one edge.
    pub(crate) fn reset_fault(&mut self) {
        if self.feedback.state() == Some(PdsState::Fault) {
            self.reset_cycles = MOST_RESET_CYCLES;
        }
    }

    /// Takes the inputs of a complete frame.
    pub(crate) fn receive(&mut self, from: &[u8]) {
        self.feedback = DriveFeedback {
            status: self.status.read(from) as u16,
            position: self.position.read(from) as i32,
            velocity: self.velocity.map(|place| place.read(from) as i32),
            torque: self.torque.map(|place| place.read(from) as i16),
            mode: self.mode_in.map(|place| place.read(from) as i8),
            inputs: self.inputs.map(|place| place.read(from) as u32),
            error: self.error.map(|place| place.read(from) as u16),
        };
        if self.feedback.state() != Some(PdsState::Fault) {
            self.reset_cycles = 0;
        }
    }

    /// Writes the outputs of the next frame.
    pub(crate) fn send(&mut self, into: &mut [u8]) {
        let resets = self.reset_cycles > 0;
        self.reset_cycles = self.reset_cycles.saturating_sub(1);
        self.sent_control = control_word(self.feedback.status, self.command.wanted, resets);
        self.choose_target();
        self.control.write(into, i64::from(self.sent_control));
        self.target.write(into, i64::from(self.sent_target));
        if let Some(place) = self.mode_out {
            place.write(into, i64::from(self.mode as i8));
        }
    }

    fn choose_target(&mut self) {
        let rest = if self.mode == DriveMode::Csp { self.feedback.position } else { 0 };
        self.is_held = false;
        if !self.feedback.is_enabled() {
            self.sent_target = rest;
        } else if self.command.wanted == Wanted::On {
            let step = self.command.target.wrapping_sub(self.sent_target);
            if step.unsigned_abs() <= self.most_step {
                self.sent_target = self.command.target;
            } else {
                self.is_held = true;
            }
        }
        // while it is enabled and no longer wanted so, the last target stays
    }
}
