//! The machine on the bus: one servo period is a whole number of physics steps.
//!
//! ```text
//!   command ─► drives ─► [ step × n:  tool in the work ─► Z axis, spindle 0;  all axes;  all spindles ]
//!                                                                              │
//!   feedback ◄─ encoders, changer ◄────────────────────────────────────────────┘        truth ◄─ states
//! ```
//!
//! A command takes effect at the start of the period that follows it, or `command_delay` periods later. Until
//! the first one has arrived the drives are off. Nothing here reads a clock or
//! draws a number that the seed does not determine.
use crate::axis::Axis;
use crate::changer::Changer;
use crate::rng::Rng;
use crate::spindle::Spindle;
use crate::{Config, Hole};
use bus::{Command, Feedback, Truth};
use units::{Spin, Time};

/// A machine made of equations.
#[derive(Clone, Debug)]
pub struct SimulatedMachine {
    config: Config,
    substeps: usize,
    periods: u64,
    /// Commands on their way, the oldest at `periods % len`; empty without delay.
    underway: Vec<Command>,
    rng: Rng,
    axes: Vec<Axis>,
    spindles: Vec<Spindle>,
    changer: Changer,
    feedback: Feedback,
    truth: Truth,
}

impl SimulatedMachine {
    /// At rest at its start, drives off; or everything that is wrong with the config.
    ///
    /// # Errors
    /// One sentence for each number that no machine can have.
    pub fn new(config: Config) -> Result<Self, Vec<String>> {
        let problems = config.problems();
        if !problems.is_empty() {
            return Err(problems);
        }
        let mut rng = Rng::new(config.seed);
        let h = config.period.value() / config.substeps() as f64;
        let scatter = config.scatter;
        let axes = config.axes.iter().map(|(_, m)| Axis::new(m, scatter, &mut rng, h)).collect();
        let spindles =
            config.spindles.iter().map(|m| Spindle::new(m, scatter, &mut rng, h)).collect();
        let mut machine = Self {
            substeps: config.substeps(),
            periods: 0,
            underway: vec![
                Command { tool: config.tool, ..Command::default() };
                config.command_delay
            ],
            rng,
            axes,
            spindles,
            changer: Changer::Holds(config.tool),
            feedback: Feedback::default(),
            truth: Truth::default(),
            config,
        };
        machine.observe();
        Ok(machine)
    }

    /// The holes in the work, those that were there first.
    pub fn holes(&self) -> &[Hole] {
        self.config.stock.as_ref().map_or(&[], |stock| &stock.holes)
    }

    /// Send a command on its way; the one that arrives.
    fn transport(&mut self, command: &Command) -> Command {
        if self.underway.is_empty() {
            return *command;
        }
        let oldest = (self.periods % self.underway.len() as u64) as usize;
        core::mem::replace(&mut self.underway[oldest], *command)
    }

    /// Hand the command to drives and changer.
    fn obey(&mut self, command: &Command) {
        for ((index, _), axis) in self.config.axes.iter().zip(&mut self.axes) {
            axis.obey(&command.axes[*index]);
        }
        for (spindle, order) in self.spindles.iter_mut().zip(&command.spindles) {
            spindle.obey(order);
        }
        let magazine = &self.config.magazine;
        let has = |number| number == 0 || magazine.iter().any(|tool| tool.number == number);
        let (takes, period) = (self.config.tool_change_time, self.config.period);
        self.changer = self.changer.next(command.tool, takes, period, has);
    }

    /// The physics of one period.
    fn advance(&mut self) {
        for _ in 0..self.substeps {
            for axis in &mut self.axes {
                axis.step(0.0);
            }
            for spindle in &mut self.spindles {
                spindle.step(0.0);
            }
        }
    }

    /// Read encoders, and the truth beside them.
    fn observe(&mut self) {
        self.feedback.time = self.config.period * self.periods as f64;
        self.feedback.tool = self.changer.tool();
        for ((index, _), axis) in self.config.axes.iter().zip(&self.axes) {
            self.feedback.axes[*index] = axis.feedback();
            self.truth.axes[*index] = axis.position();
            self.truth.axis_forces[*index] = axis.drive_force();
        }
        for (index, spindle) in self.spindles.iter_mut().enumerate() {
            spindle.read(&mut self.rng);
            self.feedback.spindles[index] = spindle.feedback();
            self.truth.spindles[index] = units::Angle::rev(spindle.angle_rev());
            self.truth.spins[index] = Spin::rev_per_s(spindle.omega() / core::f64::consts::TAU);
            self.truth.spindle_torques[index] = spindle.drive_torque();
        }
    }
}

impl bus::Machine for SimulatedMachine {
    fn period(&self) -> Time {
        self.config.period
    }

    fn feedback(&self) -> Feedback {
        self.feedback
    }

    fn exchange(&mut self, command: &Command) -> Feedback {
        let arrived = self.transport(command);
        self.obey(&arrived);
        self.advance();
        self.periods += 1;
        self.observe();
        self.feedback
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.truth)
    }
}
