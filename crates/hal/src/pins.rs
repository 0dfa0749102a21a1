//! The pins: what HAL's users wire.
//!
//! ```text
//!   leadscrew.x.pos-cmd …pos-fb          axes by their letters: mm, degrees
//!   leadscrew.spindle.0.speed-cmd …revs  spindles by number: rev/min, revolutions
//!   leadscrew.estop-in …din-00           the machine as a whole
//! ```
use crate::ffi::{Direction, Hal, Pin, PinKind};
use crate::index::Unwrapped;
use crate::parameters::{LETTERS, LoadParameters};
use bus::{
    AXES, AxisFeedback, Command, Feedback, Report, SPINDLES, Signals, SpindleCommand,
    SpindleFeedback,
};
use shm::{Fieldbus, WriteTo};
use units::{Angle, Coordinate, Orientation, Time, TurnDirection};

/// Pins of an axis.
#[derive(Debug)]
struct AxisPins {
    pos_cmd: Pin<f64>,
    vel_cmd: Pin<f64>,
    enable: Pin<bool>,
    pos_fb: Pin<f64>,
    fault: Pin<bool>,
    home_sw: Pin<bool>,
    limits: [Pin<bool>; 2],
}

/// Pins of a spindle.
#[derive(Debug)]
struct SpindlePins {
    speed_cmd: Pin<f64>,
    speed_cmd_rps: Pin<f64>,
    enable: Pin<bool>,
    forward: Pin<bool>,
    reverse: Pin<bool>,
    brake: Pin<bool>,
    revs: Pin<f64>,
    index_enable: Pin<bool>,
    fault: Pin<bool>,
    pos_cmd: Pin<f64>,
    orient: Pin<bool>,
    orient_angle: Pin<f64>,
    orient_mode: Pin<i32>,
    is_oriented: Pin<bool>,
    orient_fault: Pin<i32>,
    locked: Pin<bool>,
    counted: Unwrapped,
    /// Where it is, by its encoder.
    at: Angle,
}

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
    estop: Pin<bool>,
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
            estop: input(hal, "estop-in")?,
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

impl Fieldbus for Pins {
    fn read(&mut self, time: Time) -> Feedback {
        let mut feedback = Feedback { time, ..Feedback::default() };
        for ((said, pins), enabled) in feedback.axes.iter_mut().zip(&self.axes).zip(self.enabled.0)
        {
            if let Some(pins) = pins {
                *said = pins.read(enabled);
            }
        }
        for ((said, pins), enabled) in
            feedback.spindles.iter_mut().zip(&mut self.spindles).zip(self.enabled.1)
        {
            if let Some(pins) = pins {
                let is_set = pins.index_enable.get();
                let (angle, index) = pins.counted.read(pins.revs.get(), is_set);
                pins.at = angle;
                *said = SpindleFeedback {
                    angle,
                    index,
                    ready: enabled && !pins.fault.get(),
                    saturated: false,
                    oriented: pins.is_oriented.get(),
                    orient_fault: pins.orient_fault.get(),
                    fault_code: 0,
                };
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
            emergency_stop: self.estop.get(),
            probe: self.probe.get(),
            inputs,
            ..feedback
        }
    }

    fn write(&mut self, command: &Command, report: &Report, to: &WriteTo) {
        for (index, pins) in self.axes.iter().enumerate() {
            if let Some(pins) = pins {
                let told = &command.axes[index];
                let ahead =
                    told.position.value() + told.speed.value() * to.obeys_after[index].value();
                pins.write(told.enable, ahead, told.speed.value());
                self.enabled.0[index] = told.enable;
            }
        }
        for (index, pins) in self.spindles.iter_mut().enumerate() {
            if let Some(pins) = pins {
                if pins.counted.look(to.marks[index]) != pins.index_enable.get() {
                    pins.index_enable.set(to.marks[index]);
                }
                let told = &command.spindles[index];
                pins.write(told, to.spindles_obey_after[index]);
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
            marks: [false; SPINDLES],
        };
        self.write(&Command { tool, ..Command::default() }, &Report::default(), &at_once);
        self.connected.set(false);
    }

    fn now_ns(&self) -> i64 {
        crate::ffi::now_ns()
    }
}

impl AxisPins {
    fn new(hal: &Hal, letter: char) -> Result<Self, String> {
        let name = |what: &str| format!("{letter}.{what}");
        Ok(Self {
            pos_cmd: output(hal, &name("pos-cmd"))?,
            vel_cmd: output(hal, &name("vel-cmd"))?,
            enable: output(hal, &name("enable"))?,
            pos_fb: input(hal, &name("pos-fb"))?,
            fault: input(hal, &name("fault"))?,
            home_sw: input(hal, &name("home-sw"))?,
            limits: [input(hal, &name("limit-neg"))?, input(hal, &name("limit-pos"))?],
        })
    }

    fn read(&self, enabled: bool) -> AxisFeedback {
        AxisFeedback {
            position: Coordinate::new(self.pos_fb.get()),
            ready: enabled && !self.fault.get(),
            home_switch: self.home_sw.get(),
            limit_switches: [self.limits[0].get(), self.limits[1].get()],
            ..AxisFeedback::default()
        }
    }

    fn write(&self, enable: bool, position: f64, speed: f64) {
        // one that is off is told to be where it is, so that nothing jumps when it is switched on
        self.pos_cmd.set(if enable { position } else { self.pos_fb.get() });
        self.vel_cmd.set(if enable { speed } else { 0.0 });
        self.enable.set(enable);
    }
}

impl SpindlePins {
    fn new(hal: &Hal, number: usize) -> Result<Self, String> {
        let name = |what: &str| format!("spindle.{number}.{what}");
        Ok(Self {
            speed_cmd: output(hal, &name("speed-cmd"))?,
            speed_cmd_rps: output(hal, &name("speed-cmd-rps"))?,
            enable: output(hal, &name("enable"))?,
            forward: output(hal, &name("forward"))?,
            reverse: output(hal, &name("reverse"))?,
            brake: output(hal, &name("brake"))?,
            revs: input(hal, &name("revs"))?,
            index_enable: named(hal, &name("index-enable"), Direction::Io)?,
            fault: input(hal, &name("fault"))?,
            pos_cmd: output(hal, &name("pos-cmd"))?,
            orient: output(hal, &name("orient"))?,
            orient_angle: output(hal, &name("orient-angle"))?,
            orient_mode: output(hal, &name("orient-mode"))?,
            is_oriented: input(hal, &name("is-oriented"))?,
            orient_fault: input(hal, &name("orient-fault"))?,
            locked: output(hal, &name("locked"))?,
            counted: Unwrapped::default(),
            at: Angle::ZERO,
        })
    }

    fn write(&self, told: &SpindleCommand, obeys_after: Time) {
        let enable = told.enable;
        let rps = if enable { told.spin.value() } else { 0.0 };
        // one that is off is told to be where it is, so that nothing jumps when it is switched on
        let ahead = if enable { told.angle + told.spin * obeys_after } else { self.at };
        self.pos_cmd.set(ahead.value());
        self.speed_cmd.set(rps * 60.0);
        self.speed_cmd_rps.set(rps);
        self.enable.set(enable);
        self.forward.set(rps > 0.0);
        self.reverse.set(rps < 0.0);
        self.brake.set(!enable || told.locked);
        let orient = told.orient.filter(|_| enable);
        if let Some(Orientation { angle, direction }) = orient {
            self.orient_angle.set(angle.in_deg().rem_euclid(360.0));
            // as LinuxCNC's component `orient` takes it
            self.orient_mode.set(match direction {
                TurnDirection::Shortest => 0,
                TurnDirection::Forward => 1,
                TurnDirection::Backward => 2,
            });
        }
        self.orient.set(orient.is_some() && !told.locked);
        self.locked.set(orient.is_some() && told.locked);
    }
}

fn named<T: PinKind>(hal: &Hal, name: &str, direction: Direction) -> Result<Pin<T>, String> {
    let pin = hal.pin(&format!("leadscrew.{name}"), direction)?;
    pin.set(T::default());
    Ok(pin)
}

fn input<T: PinKind>(hal: &Hal, name: &str) -> Result<Pin<T>, String> {
    named(hal, name, Direction::In)
}

fn output<T: PinKind>(hal: &Hal, name: &str) -> Result<Pin<T>, String> {
    named(hal, name, Direction::Out)
}

fn row<T: PinKind>(
    hal: &Hal,
    name: &str,
    count: usize,
    direction: Direction,
) -> Result<Vec<Pin<T>>, String> {
    (0..count).map(|number| named(hal, &format!("{name}-{number:02}"), direction)).collect()
}
