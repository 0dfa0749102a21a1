//! The pins: what HAL's users wire.
//!
//! ```text
//!   leadscrew.x.pos-cmd …pos-fb          axes by their letters: mm, degrees
//!   leadscrew.spindle.0.speed-cmd …revs  spindles by number: rev/min, revolutions
//!   leadscrew.estop-ok …din-00           the machine as a whole
//! ```
use crate::axis_pins::{AxisPins, ReliedOn};
use crate::driven::DrivenPin;
use crate::ffi::{Direction, Hal, Pin};
use crate::new_pin::{input, output, row};
use crate::panel_pins::PanelPins;
use crate::parameters::{LETTERS, LoadParameters};
use crate::spindle_pins::SpindlePins;
use bus::{AXES, Command, Feedback, Report, SPINDLES, Signals, WatchedInput, WatchedInputs};
use shm::{Fieldbus, Marks, WriteTo};
use units::Time;

/// A tool changer that is asked and answers.
#[derive(Debug)]
struct ToolPins {
    number: Pin<u32>,
    change: Pin<bool>,
    changed: Pin<bool>,
}

/// All pins.
#[derive(Debug)]
pub(crate) struct Pins {
    axes: [Option<AxisPins>; AXES],
    spindles: [Option<SpindlePins>; SPINDLES],
    estop_ok: DrivenPin<bool>,
    panel: PanelPins,
    /// Inputs that the machine's file relies on.
    watched: WatchedInputs,
    probe: Pin<bool>,
    din: Vec<Pin<bool>>,
    dout: Vec<Pin<bool>>,
    ain: Vec<Pin<f64>>,
    aout: Vec<Pin<f64>>,
    flood: Pin<bool>,
    mist: Pin<bool>,
    tool: ToolPins,
    /// The tool in the spindle; `None` while it is changed.
    mounted: Option<u32>,
    /// A control leads the machine.
    connected: Pin<bool>,
    state: Pin<u32>,
    sync_error: Pin<f64>,
    /// What the drives were told last: one that is off is not ready.
    enabled: ([bool; AXES], [bool; SPINDLES]),
}

impl Pins {
    /// All that these parameters ask for.
    ///
    /// # Errors
    /// HAL refuses one.
    pub(crate) fn new(hal: &Hal, of: &LoadParameters) -> Result<Self, String> {
        let mut axes = [const { None }; AXES];
        for ((slot, letter), _) in axes.iter_mut().zip(LETTERS).zip(of.axes).filter(|(_, has)| *has)
        {
            *slot = Some(AxisPins::new(hal, letter.to_ascii_lowercase())?);
        }
        let mut spindles = [const { None }; SPINDLES];
        for (number, slot) in spindles.iter_mut().enumerate().take(of.spindles) {
            *slot = Some(SpindlePins::new(hal, number)?);
        }
        Ok(Self {
            axes,
            spindles,
            estop_ok: DrivenPin::new(hal, "estop-ok")?,
            panel: PanelPins::new(hal, of)?,
            watched: WatchedInputs::default(),
            probe: input(hal, "probe-in")?,
            din: row(hal, "din", of.digital.0, Direction::In)?,
            dout: row(hal, "dout", of.digital.1, Direction::Out)?,
            ain: row(hal, "ain", of.analogue.0, Direction::In)?,
            aout: row(hal, "aout", of.analogue.1, Direction::Out)?,
            flood: output(hal, "coolant-flood")?,
            mist: output(hal, "coolant-mist")?,
            tool: ToolPins {
                number: output(hal, "tool-number")?,
                change: output(hal, "tool-change")?,
                changed: input(hal, "tool-changed")?,
            },
            mounted: Some(0),
            connected: output(hal, "connected")?,
            state: output(hal, "state")?,
            sync_error: output(hal, "sync-error")?,
            enabled: ([false; AXES], [false; SPINDLES]),
        })
    }

    /// Ask for another tool, until it is said to be there; then the request is taken back, and so
    /// must the answer be.
    fn change_tool(&mut self, wanted: u32) {
        let ToolPins { number, change, changed } = &self.tool;
        match (self.mounted, change.get(), changed.get()) {
            (Some(mounted), false, false) if mounted != wanted => {
                number.set(wanted);
                change.set(true);
                self.mounted = None;
            }
            (None, true, true) => change.set(false),
            (None, false, false) => self.mounted = Some(number.get()),
            _ => {}
        }
    }
}

/// The set with those that are true.
fn with_all(set: WatchedInputs, inputs: &[(bool, WatchedInput)]) -> WatchedInputs {
    let has = inputs.iter().filter(|(has, _)| *has);
    has.fold(set, |all, (_, input)| all.with(*input))
}

impl Fieldbus for Pins {
    fn driven(&self) -> WatchedInputs {
        let mut driven = self.panel.driven();
        if self.estop_ok.is_driven() {
            driven = driven.with(WatchedInput::EmergencyStop);
        }
        for (index, pins) in (0..).zip(&self.axes) {
            let Some(ReliedOn { ready, torque }) = pins.as_ref().map(AxisPins::driven) else {
                continue;
            };
            let inputs =
                [(ready, WatchedInput::AxisReady(index)), (torque, WatchedInput::AxisForce(index))];
            driven = with_all(driven, &inputs);
        }
        for (index, pins) in (0..).zip(&self.spindles) {
            let Some((of_drive, inhibit)) = pins.as_ref().map(SpindlePins::driven) else {
                continue;
            };
            let inputs = [
                (of_drive.ready, WatchedInput::SpindleReady(index)),
                (of_drive.torque, WatchedInput::SpindleTorque(index)),
                (inhibit, WatchedInput::SpindleInhibit(index)),
            ];
            driven = with_all(driven, &inputs);
        }
        driven
    }

    fn watch(&mut self, inputs: WatchedInputs) {
        self.watched = inputs;
    }

    fn read(&mut self, time: Time) -> Feedback {
        let mut feedback = Feedback { time, ..Feedback::default() };
        let watched = self.watched;
        feedback.panel = self.panel.read(watched);
        for (index, pins) in self.axes.iter_mut().enumerate() {
            if let Some(pins) = pins {
                let relied_on = ReliedOn {
                    ready: watched.has(WatchedInput::AxisReady(index as u8)),
                    torque: watched.has(WatchedInput::AxisForce(index as u8)),
                };
                feedback.axes[index] = pins.read(self.enabled.0[index], relied_on);
            }
        }
        for (index, pins) in self.spindles.iter_mut().enumerate() {
            if let Some(pins) = pins {
                let relied_on = ReliedOn {
                    ready: watched.has(WatchedInput::SpindleReady(index as u8)),
                    torque: watched.has(WatchedInput::SpindleTorque(index as u8)),
                };
                feedback.spindles[index] = pins.read(self.enabled.1[index], relied_on);
                let is_watched = watched.has(WatchedInput::SpindleInhibit(index as u8));
                feedback.panel.spindle_inhibit[index] = pins.is_inhibited(is_watched);
            }
        }
        let mut inputs = Signals::default();
        for (number, pin) in self.din.iter().enumerate() {
            inputs.switch(number as u8, pin.get());
        }
        for (value, pin) in inputs.analogue.iter_mut().zip(&self.ain) {
            *value = pin.get();
        }
        Feedback {
            tool: self.mounted,
            emergency_stop: watched.has(WatchedInput::EmergencyStop) && !self.estop_ok.says(),
            probe: self.probe.get(),
            inputs,
            ..feedback
        }
    }

    fn write(&mut self, command: &Command, report: &Report, to: &WriteTo) {
        for (index, pins) in self.axes.iter_mut().enumerate() {
            if let Some(pins) = pins {
                let told = &command.axes[index];
                let ahead =
                    told.position.value() + told.speed.value() * to.obeys_after[index].value();
                pins.write(told.enable, ahead, told.speed.value(), to.marks.axes[index]);
                self.enabled.0[index] = told.enable;
            }
        }
        for (index, pins) in self.spindles.iter_mut().enumerate() {
            if let Some(pins) = pins {
                let told = &command.spindles[index];
                pins.write(told, to.spindles_obey_after[index], to.marks.spindles[index]);
                self.enabled.1[index] = told.enable;
            }
        }
        for (number, pin) in self.dout.iter().enumerate() {
            pin.set(command.outputs.is_on(number as u8));
        }
        for (pin, value) in self.aout.iter().zip(command.outputs.analogue) {
            pin.set(value);
        }
        self.flood.set(command.flood);
        self.mist.set(command.mist);
        self.change_tool(command.tool);
        self.connected.set(true);
        self.state.set(report.state as u32);
        self.sync_error.set(report.sync_error.map_or(0.0, units::Length::value));
    }

    /// Drives off, outputs off, axes told to be where they are.
    fn off(&mut self) {
        let tool = self.mounted.unwrap_or(0);
        let at_once = WriteTo {
            obeys_after: [Time::ZERO; AXES],
            spindles_obey_after: [Time::ZERO; SPINDLES],
            marks: Marks::default(),
        };
        self.write(&Command { tool, ..Command::default() }, &Report::default(), &at_once);
        self.connected.set(false);
    }

    fn now_ns(&self) -> i64 {
        crate::ffi::now_ns()
    }
}
