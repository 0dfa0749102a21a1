//! All loops of the machine, and what is switched.
//!
//! ```text
//!   steps ──► targets, orders ──► [ axis loops | spindle loops | tool, coolant ] ──► Command
//! ```
use crate::axis::AxisLoop;
use crate::chips::Removal;
use crate::config::{Config, FeedForward, Subject};
use crate::coupled::Coupled;
use crate::fault::FaultKind;
use crate::learning_records::LearningRecords;
use crate::moving::Turned;
use crate::record_requests::RecordRequests;
use crate::sight::Without;
use crate::spindle::SpindleLoop;
use crate::supervision::Supervision;
use crate::threading::Chain;
use crate::time_scaling::TimeScaling;
use bus::{AXES, Command, Feedback, SPINDLES, Signals};
use motion::{Output, Signal};
use sync::SyncMode;
use units::Axis;
use units::{Length, Spin};

/// Indices of the axes that moves move: all, each in its own unit.
pub(crate) const MOVING: core::ops::Range<usize> = 0..AXES;

/// The machine's loops.
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools)] // two outputs and two facts, each on its own
pub(crate) struct Drives {
    pub(crate) axes: [Option<AxisLoop>; AXES],
    pub(crate) spindles: [Option<SpindleLoop>; SPINDLES],
    /// The axis that follows a master at present, and its feed-forwards if they are not its own.
    pub(crate) follower: Option<(usize, Option<FeedForward>)>,
    /// What is coupled in the background of the steps.
    pub(crate) coupled: Coupled,
    /// The turned thread under way.
    pub(crate) chain: Option<Chain>,
    /// Masters are led by angle, where the machine's spindles can.
    pub(crate) paces: bool,
    /// What taps have learnt.
    pub(crate) learning_records: LearningRecords,
    /// What good holes have been like, and the torque of the tap under way.
    pub(crate) supervision: Supervision,
    /// What is written down of taps.
    pub(crate) record_requests: RecordRequests,
    /// Chip removals under way.
    pub(crate) removals: [Option<Removal>; SPINDLES],
    /// The speeds that a cut needs, as the steps have ordered them; zero: none was ordered.
    pub(crate) in_force: [Spin; SPINDLES],
    /// How fast planned time passes.
    pub(crate) time_scaling: TimeScaling,
    /// Planned time of this period that the steps have not done yet: it goes on into the next one.
    pub(crate) owed: Option<f64>,
    /// What feeds per revolution go by.
    pub(crate) turned: Turned,
    /// The program lets the operator's feed override act.
    pub(crate) overridden: bool,
    /// The program lets the operator's spindle override act.
    pub(crate) spindle_overridden: bool,
    /// Spindles that stand, or slow down, for an interlock.
    pub(crate) stopped: [bool; SPINDLES],
    /// So long a spindle may take to a speed that the operator has changed, s.
    at_speed_s: f64,
    /// A move is under way: the axes need not stand where the next step begins.
    pub(crate) flowing: bool,
    pub(crate) tool: u32,
    pub(crate) mist: bool,
    pub(crate) flood: bool,
    /// Outputs as the program has switched them.
    pub(crate) outputs: Signals,
    /// Inputs that must stay as they are wherever something moves.
    pub(crate) guard: crate::sequence_steps::Guard,
    /// Output that is on only while a step counts edges.
    pub(crate) motor: Option<u8>,
    lookahead_s: f64,
}

/// What is wrong with a reading or a loop: kind, on what, value, limit.
pub(crate) type Finding = (FaultKind, Subject, f64, f64);

impl Drives {
    /// From now on the axes that move brake as hard as a move may, all of them to the same instant:
    /// straight on, and where a move is braking for its end not beyond that.
    pub(crate) fn brake_together(&mut self, limits: &motion::Limits) {
        let most = |index: usize, axis: &AxisLoop| {
            let planned = limits.feed.accel[index].max(limits.rapid.accel[index]);
            let approach = axis.control.approach.1.value();
            if planned.is_finite() { planned.max(approach) } else { approach }
        };
        let axes = self.axes.iter().enumerate();
        let axes = axes.filter_map(|(index, axis)| Some((index, axis.as_ref()?)));
        let duration =
            axes.map(|(i, axis)| axis.target.speed.abs() / most(i, axis)).fold(0.0, f64::max);
        for axis in self.axes.iter_mut().flatten() {
            let speed = axis.target.speed.abs();
            if speed > 0.0 {
                axis.brakes_at = speed / duration;
            }
        }
    }

    pub(crate) fn new(config: &Config) -> Self {
        let axes = config.axes.map(|axis| axis.map(|control| AxisLoop::new(control, config)));
        let spindles = config.spindles.map(|s| s.map(|control| SpindleLoop::new(control, config)));
        let lookahead_s =
            axes.iter().flatten().map(AxisLoop::lookahead_s).fold(config.period.value(), f64::max);
        let learning_records = LearningRecords::new(config.learning);
        let (removals, in_force) = ([None; SPINDLES], [Spin::ZERO; SPINDLES]);
        Self {
            axes,
            spindles,
            follower: None,
            coupled: Coupled::new(),
            chain: None,
            paces: matches!(config.synchronisation, SyncMode::CommandSynchronised),
            learning_records,
            supervision: Supervision::new(config.supervision),
            record_requests: RecordRequests::new(),
            removals,
            in_force,
            time_scaling: TimeScaling::FULL,
            owed: None,
            turned: Turned::default(),
            overridden: true,
            spindle_overridden: true,
            stopped: [false; SPINDLES],
            at_speed_s: config.waits.at_speed.value(),
            flowing: false,
            tool: 0,
            mist: false,
            flood: false,
            outputs: Signals::default(),
            guard: crate::sequence_steps::Guard::default(),
            motor: None,
            lookahead_s,
        }
    }

    /// How far ahead of their setpoint the axes' feed-forwards are taken at most.
    pub(crate) const fn lookahead_s(&self) -> f64 {
        self.lookahead_s
    }

    /// Take the readings as the present place.
    pub(crate) fn adopt(&mut self, feedback: &Feedback) {
        self.coupled.reset();
        self.chain = None;
        (self.flowing, self.owed) = (false, None); // a path on which everything was switched off is not gone on along
        for (axis, reading) in self.axes.iter_mut().zip(&feedback.axes) {
            if let Some(axis) = axis {
                axis.adopt(reading);
            }
        }
        for (spindle, reading) in self.spindles.iter_mut().zip(&feedback.spindles) {
            if let Some(spindle) = spindle {
                spindle.adopt(reading);
            }
        }
        self.tool = feedback.tool.unwrap_or(self.tool);
    }

    /// Take the readings.
    pub(crate) fn read(&mut self, feedback: &Feedback) {
        for (axis, reading) in self.axes.iter_mut().zip(&feedback.axes) {
            // one that gives no number has said so; what is coupled stops first
            if let Some(axis) = axis.as_mut().filter(|_| reading.position.is_finite()) {
                axis.read(reading);
            }
        }
        for (spindle, reading) in self.spindles.iter_mut().zip(&feedback.spindles) {
            if let Some(spindle) = spindle.as_mut().filter(|_| reading.angle.is_finite()) {
                spindle.read(reading);
            }
        }
    }

    /// All axes stand unless something moves them.
    pub(crate) fn rest(&mut self) {
        self.follower = None;
        self.owed = None;
        self.rest_axes();
    }

    /// No axis follows a master unless that is told.
    pub(crate) const fn rest_follower(&mut self) {
        self.follower = None;
    }

    /// No reading comes any more: what is tied goes on by its model, everything else gets no force.
    pub(crate) fn go_blind(&mut self, (axis, spindle): (usize, usize)) {
        let without = |is_tied: bool| if is_tied { Without::Model } else { Without::Nothing };
        for (index, it) in self.axes.iter_mut().enumerate() {
            let Some(it) = it else { continue };
            it.sight.lose(without(index == axis));
        }
        for (index, it) in self.spindles.iter_mut().enumerate() {
            let Some(it) = it else { continue };
            it.sight.lose(without(index == spindle));
        }
    }

    /// All axes stand.
    pub(crate) fn rest_axes(&mut self) {
        for axis in self.axes.iter_mut().flatten() {
            axis.rest();
        }
    }

    /// All axes within their in-position window; else the one that is not.
    pub(crate) fn in_position(&self) -> Result<(), Finding> {
        for (index, axis) in self.axes.iter().enumerate() {
            let Some(axis) = axis else { continue };
            let window = axis.control.windows.in_position.value();
            if axis.error().abs() > window {
                let of = Subject::Axis(Axis::ALL[index]);
                return Err((FaultKind::NotInPosition, of, axis.error(), window));
            }
        }
        Ok(())
    }

    /// How long the axes have to be in position.
    pub(crate) fn settle_s(&self) -> f64 {
        let settle = |axis: &AxisLoop| axis.control.windows.settle.value();
        self.axes.iter().flatten().map(settle).fold(0.0, f64::max)
    }

    /// A motor turns while edges are counted.
    pub(crate) fn start_motor(&mut self, output: u8) {
        self.stop_motor();
        self.outputs.switch(output, true);
        self.motor = Some(output);
    }

    /// It turns no more.
    pub(crate) fn stop_motor(&mut self) {
        if let Some(output) = self.motor.take() {
            self.outputs.switch(output, false);
        }
    }

    /// Switch an output.
    pub(crate) fn switch(&mut self, output: &Output) {
        match output.signal {
            Signal::Digital { on } => self.outputs.switch(output.number, on),
            Signal::Analogue { value } => {
                if let Some(out) = self.outputs.analogue.get_mut(usize::from(output.number)) {
                    *out = value;
                }
            }
        }
    }

    /// Close all loops.
    pub(crate) fn command(&mut self) -> Command {
        let mut command = Command {
            tool: self.tool,
            flood: self.flood,
            mist: self.mist,
            outputs: self.outputs,
            ..Command::default()
        };
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let Some(axis) = axis else { continue };
            let others = self.follower.and_then(|(i, others)| others.filter(|_| i == index));
            command.axes[index] = axis.command(others);
        }
        for (index, spindle) in self.spindles.iter_mut().enumerate() {
            let Some(spindle) = spindle else { continue };
            command.spindles[index] = spindle.command();
        }
        command
    }

    /// Spindles turn at the operator's share of what is programmed, where the program lets it act.
    pub(crate) fn override_spindles(&mut self, share: f64) {
        let share = if self.spindle_overridden { share } else { 1.0 };
        for (spindle, stopped) in self.spindles.iter_mut().zip(self.stopped) {
            let Some(spindle) = spindle else { continue };
            spindle.override_by(if stopped { 0.0 } else { share }, self.at_speed_s);
        }
    }

    /// Advance what spindles do by themselves.
    pub(crate) fn advance_spindles(&mut self) {
        self.follow_surface();
        for spindle in self.spindles.iter_mut().flatten() {
            spindle.advance();
        }
    }

    /// Spindles whose speed goes by the place of X take it from where X is ordered to be.
    pub(crate) fn follow_surface(&mut self) {
        let Some(x) = &self.axes[Axis::X.index()] else { return };
        let x = Length::mm(x.target.position);
        for spindle in self.spindles.iter_mut().flatten() {
            spindle.follow_surface(x);
        }
    }

    /// Whether all readings are numbers.
    pub(crate) fn check_readings(&self, feedback: &Feedback) -> Result<(), Finding> {
        let invalid = |of| Err((FaultKind::FeedbackInvalid, of, 0.0, 0.0));
        if !feedback.time.is_finite() {
            return invalid(Subject::Machine);
        }
        for index in self.configured_axes() {
            if !feedback.axes[index].position.is_finite() {
                return invalid(Subject::Axis(Axis::ALL[index]));
            }
        }
        for index in self.configured_spindles() {
            if !feedback.spindles[index].angle.is_finite() {
                return invalid(Subject::Spindle(index as u8));
            }
        }
        Ok(())
    }

    /// Whether all drives are ready; else the first that is not.
    pub(crate) fn check_ready(&self, feedback: &Feedback) -> Result<(), Finding> {
        let missing = |of, code| Err((FaultKind::DriveNotReady, of, f64::from(code), 0.0));
        for index in self.configured_axes() {
            let said = &feedback.axes[index];
            if !said.ready {
                return missing(Subject::Axis(Axis::ALL[index]), said.fault_code);
            }
        }
        for index in self.configured_spindles() {
            let said = &feedback.spindles[index];
            if !said.ready {
                return missing(Subject::Spindle(index as u8), said.fault_code);
            }
        }
        Ok(())
    }

    /// Whether all loops follow; else the first that does not.
    pub(crate) fn check_following(&self) -> Result<(), Finding> {
        (0..AXES).try_for_each(|axis| self.check_axis_follows(axis))?;
        for (index, spindle) in self.spindles.iter().enumerate() {
            // what its encoder counts is not known while that is checked
            let Some(spindle) = spindle.as_ref().filter(|it| !it.encoder_check.is_under_way())
            else {
                continue;
            };
            let limit = spindle.control.windows.following_stop.value();
            if spindle.error().abs() > limit {
                let of = Subject::Spindle(index as u8);
                return Err((FaultKind::SpindleFollowingError, of, spindle.error(), limit));
            }
        }
        Ok(())
    }

    /// Whether one axis follows.
    pub(crate) fn check_axis_follows(&self, index: usize) -> Result<(), Finding> {
        let Some(axis) = &self.axes[index] else { return Ok(()) };
        let limit = axis.control.windows.following_stop.value();
        if axis.error().abs() > limit {
            let of = Subject::Axis(Axis::ALL[index]);
            return Err((FaultKind::FollowingError, of, axis.error(), limit));
        }
        Ok(())
    }

    fn configured_axes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..AXES).filter(|&i| self.axes[i].is_some())
    }

    fn configured_spindles(&self) -> impl Iterator<Item = usize> + '_ {
        (0..SPINDLES).filter(|&i| self.spindles[i].is_some())
    }
}
