//! The machine on the bus: one servo period is a whole number of physics steps.
//!
//! ```text
//!   command ─► drives ─► [ step × n:  tool in the work ─► Z axis, spindle 0;  all axes;  all spindles ]
//!                                                                              │
//!   feedback ◄─ encoders, changer ◄────────────────────────────────────────────┘        truth ◄─ states
//! ```
//!
//! A command takes effect at the start of the period that follows it, or `command_delay` periods
//! later. Until the first one has arrived the drives are off. Nothing here reads a clock or draws a
//! number that the seed does not determine.
mod carousel;

use crate::axis::Axis;
use crate::carousel::Carousel;
use crate::changer::Changer;
use crate::cutting::Cutting;
use crate::grinding::Grinder;
use crate::measured::{MeasuredTorques, TorqueSensors};
use crate::mishaps::Mishaps;
use crate::rng::Rng;
use crate::scatter::Draws;
use crate::signals::{Input, Inputs};
use crate::spindle::Spindle;
use crate::tapping::Load;
use crate::touch::{Boss, ToolSetter, Touch};
use crate::turning::{Turning, TurningLoad};
use crate::wear::TapWear;
use crate::{Bar, Config, Grinding, Hole, PlainDrive, PositionDrive, PowerOn};
use bus::{Command, Feedback, Truth};
use core::f64::consts::TAU;
use units::{Angle, Force, Length, Spin, Time, Torque};

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
    carousel: Option<Carousel>,
    cutting: Option<Cutting>,
    grinder: Option<Grinder>,
    inputs: Inputs,
    touch: Touch,
    /// The bar, where one turns in the first spindle.
    turning: Option<Turning>,
    /// The bar as it is clamped.
    new_bar: Option<Turning>,
    /// Where X, Y and Z are among `axes`.
    x_y_z: [Option<usize>; 3],
    torque_sensors: TorqueSensors,
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
        let (mut axes, spindles) = config.plant();
        let unknown = config.power_on == PowerOn::Unknown;
        for (index, model) in axes.iter_mut().filter(|_| unknown) {
            model.start = model.travel.draw(*index, config.seed);
        }
        let believed = config.axes.iter().map(|(_, model)| model);
        let axes = axes.iter().zip(believed);
        let axes =
            axes.map(|((_, m), b)| Axis::new(m, b, (h, config.period.value()), unknown)).collect();
        let spindles = spindles.iter().map(|m| Spindle::new(m, &mut rng, h)).collect();
        let place = |bus_index| config.axes.iter().position(|(index, _)| *index == bus_index);
        let cutting = config.stock.clone().map(|mut stock| {
            stock.cutting_n_per_mm2 *= config.strength();
            Cutting::new(stock, config.magazine.clone(), config.cut(rng.branch()))
        });
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
            carousel: config.carousel.clone().map(Carousel::new),
            cutting,
            grinder: None,
            inputs: Inputs::default(),
            touch: Touch::default(),
            turning: None,
            new_bar: None,
            x_y_z: [place(0), place(1), place(2)],
            torque_sensors: TorqueSensors::default(),
            feedback: Feedback::default(),
            truth: Truth::default(),
            config,
        };
        machine.observe();
        Ok(machine)
    }

    /// The same machine whose spindles have drives that are only told a speed, each with its own
    /// draws.
    #[must_use]
    pub fn with_plain_drive(mut self, drive: PlainDrive) -> Self {
        for spindle in &mut self.spindles {
            spindle.drive_plainly(drive, self.rng.branch());
        }
        self
    }

    /// The same machine whose drives say what they give.
    #[must_use]
    pub fn with_measured_torque(mut self, measured: &MeasuredTorques) -> Self {
        self.torque_sensors = TorqueSensors::new(measured, &self.config);
        self.torque_sensors.read(&self.truth, &mut self.feedback);
        self
    }

    /// The same machine whose axes and spindles, in their order, have drives that close their own
    /// position loops, where one is given.
    #[must_use]
    pub fn with_position_drives(
        mut self,
        axes: &[Option<PositionDrive>],
        spindles: &[Option<PositionDrive>],
    ) -> Self {
        let models = self.config.axes.iter().map(|(_, model)| model.force_lag);
        for ((axis, drive), lag) in self.axes.iter_mut().zip(axes).zip(models) {
            if let Some(drive) = drive {
                axis.drive_to_positions(*drive, lag);
            }
        }
        let period_s = self.config.period.value();
        let models = self.config.spindles.iter().map(|model| model.torque_lag);
        for ((spindle, drive), lag) in self.spindles.iter_mut().zip(spindles).zip(models) {
            if let Some(drive) = drive {
                spindle.drive_to_angles(*drive, lag, period_s);
            }
        }
        self
    }

    /// The same machine with a grinding wheel, and blanks on its work spindle; nothing is drilled
    /// or tapped on it.
    ///
    /// # Errors
    /// One sentence for each number that cannot be meant, and for an axis or spindle that is
    /// missing.
    pub fn with_grinding(mut self, grinding: Grinding) -> Result<Self, Vec<String>> {
        self.clamp(grinding)?;
        Ok(self)
    }

    /// Clamp these blanks on the work spindle, beside this grinding wheel; those that are clamped
    /// already stay as they are ground.
    ///
    /// # Errors
    /// As [`SimulatedMachine::with_grinding`]; nothing is changed.
    pub fn clamp(&mut self, grinding: Grinding) -> Result<(), Vec<String>> {
        if self.grinder.as_ref().is_some_and(|grinder| grinder.has(&grinding)) {
            return Ok(());
        }
        let mut found = Vec::new();
        grinding.problems(&mut found);
        let has = |axis: usize| self.config.axes.iter().any(|(index, _)| *index == axis);
        if !has(grinding.infeed) || !has(grinding.along) || grinding.work >= self.spindles.len() {
            found.push("grinding: the machine lacks its infeed axis, its axis along the work or its work spindle".into());
        }
        if !found.is_empty() {
            return Err(found);
        }
        let mut draws = Draws::new(self.rng.branch(), self.config.part);
        let energy = draws.factor(&self.config.scatter) * self.config.strength();
        self.grinder = Some(Grinder::new(grinding, energy));
        self.cutting = None;
        Ok(())
    }

    /// The same machine with a bar in its first spindle, that inserts turn.
    #[must_use]
    pub fn with_bar(mut self, bar: Bar) -> Self {
        /// The bar's own chance: that of the rest stays as it is without one.
        const BAR: u64 = 0x0BA5;
        let mut draws = Draws::new(Rng::new(self.config.seed ^ BAR), self.config.part);
        let scale = draws.factor(&self.config.scatter) * self.config.strength();
        self.turning = Some(Turning::new(bar, scale));
        self.new_bar = self.turning.clone();
        self
    }

    /// A new tool of this number is in its place.
    pub fn renew_tool(&mut self, number: u32) {
        if let Some(cutting) = &mut self.cutting {
            cutting.renew_tool(number);
            self.truth.tool_broken = cutting.is_broken();
            self.truth.broken_by = cutting.broken_by();
        }
    }

    /// Clamps a block or a bar of these dimensions, if another one is clamped. Holes stay where
    /// they are.
    pub fn clamp_stock(&mut self, stock: &crate::Stock, bar: Option<Bar>) {
        if let (Some(cutting), Some(own)) = (&mut self.cutting, &mut self.config.stock) {
            (own.top, own.thickness, own.sides) = (stock.top, stock.thickness, stock.sides);
            cutting.clamp(stock);
        }
        if let Some(bar) = bar.filter(|bar| self.new_bar.as_ref().is_some_and(|own| !own.is(bar))) {
            let scale = self.new_bar.as_ref().map_or(1.0, Turning::scale);
            self.turning = Some(Turning::new(bar, scale));
            self.new_bar = self.turning.clone();
        }
    }

    /// Clamp another workpiece: the same, without what was cut. Blanks beside a grinding wheel
    /// stay.
    pub fn renew_work(&mut self) {
        if let (Some(cutting), Some(stock)) = (&mut self.cutting, &self.config.stock) {
            cutting.renew(&stock.holes);
        }
        self.turning.clone_from(&self.new_bar);
    }

    /// The same machine with these inputs.
    #[must_use]
    pub fn with_inputs(mut self, inputs: Vec<Input>) -> Self {
        self.inputs = Inputs::new(inputs);
        self.feedback.inputs = self.inputs.shown();
        self
    }

    /// The same machine with more to be touched than the work's faces and holes.
    #[must_use]
    pub fn with_touched(mut self, bosses: Vec<Boss>, setter: Option<ToolSetter>) -> Self {
        self.touch = Touch::new(bosses, setter);
        self
    }

    /// The same machine with the work as another one has left it: holes, threads, the turned bar,
    /// ground blanks.
    #[must_use]
    pub fn with_work_of(mut self, other: &Self) -> Self {
        if let (Some(own), Some(cut)) = (&mut self.cutting, &other.cutting) {
            own.take_holes_of(cut);
        }
        if let (Some(own), Some(turned)) = (&mut self.turning, &other.turning) {
            own.take_surfaces_of(turned);
        }
        if let (Some(own), Some(ground)) = (&mut self.grinder, &other.grinder) {
            own.take_surfaces_of(ground);
        }
        self
    }

    /// How much of the grinding wheel's radius is worn off.
    pub fn wheel_wear(&self) -> Length {
        Length::mm(self.grinder.as_ref().map_or(0.0, Grinder::worn_mm))
    }

    /// The same machine whose taps wear.
    #[must_use]
    pub fn with_tap_wear(mut self, wear: TapWear) -> Self {
        let rng = self.rng.branch();
        if let Some(cutting) = &mut self.cutting {
            cutting.wear(wear, rng);
        }
        self
    }

    /// The same machine whose taps meet mishaps.
    #[must_use]
    pub fn with_mishaps(mut self, mishaps: Mishaps) -> Self {
        let rng = self.rng.branch();
        if let Some(cutting) = &mut self.cutting {
            cutting.meet(mishaps, rng);
        }
        self
    }

    /// The holes in the work, those that were there first.
    pub fn holes(&self) -> &[Hole] {
        self.cutting.as_ref().map_or(&[], Cutting::holes)
    }

    /// While a tap is in its thread: how far the axis holds its tip off the helix that was cut,
    /// along the axis.
    pub fn off_helix(&self) -> Option<Length> {
        let z = self.x_y_z[2]?;
        let (axis, spindle) = (&self.axes[z], self.spindles.first()?);
        self.cutting.as_ref()?.off_helix(axis.table_mm(), spindle.angle_rev())
    }

    /// Send a command on its way; the one that arrives. There must be a way.
    fn transport(&mut self, command: &Command) -> Command {
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
        let now = self.config.period * (self.periods + 1) as f64;
        self.inputs.step(&command.outputs, now, self.config.period);
        let (takes, period) = (self.config.tool_change_time, self.config.period);
        if let Some(carousel) = &mut self.carousel {
            let z = self.x_y_z[2].map_or(0.0, |z| self.axes[z].position().value());
            let spin = self.spindles.first().map_or(0.0, |spindle| spindle.omega() / TAU);
            carousel.step(&command.outputs, z, spin, period.value());
            self.changer = Changer::Holds(command.tool);
            return;
        }
        self.changer = self.changer.next(command.tool, takes, period, has);
    }

    /// The physics of one period.
    fn advance(&mut self) {
        self.cut();
        self.grind();
    }

    /// What the tool in the spindle touches without cutting it.
    fn touch(&mut self) {
        let [Some(x), Some(y), Some(z)] = self.x_y_z else { return };
        let number = self.mounted();
        let tool = self.config.magazine.iter().find(|tool| Some(tool.number) == number);
        if number.is_none() {
            self.touch.forget();
        }
        let length = tool.map_or(0.0, |tool| tool.length.value());
        let probe = tool.and_then(|tool| match &tool.kind {
            crate::ToolKind::Probe(probe) => Some(probe),
            _ => None,
        });
        let at = [x, y, z].map(|axis| self.axes[axis].position().value());
        let work = self.config.stock.as_ref().zip(self.cutting.as_ref().map(Cutting::holes));
        let touched = self.touch.step(probe, [at[0], at[1], at[2] - length], work);
        self.feedback.probe = touched.touches;
        self.feedback.probe_age = touched.since.map(|share| self.config.period * share);
        self.truth.tool_broken |= touched.broken;
    }

    /// Wheel and work, once a period: the contact changes little within one.
    fn grind(&mut self) {
        let Some(grinder) = &mut self.grinder else { return };
        let (infeed, along, work) = grinder.members();
        let place = |bus| self.config.axes.iter().position(|(index, _)| *index == bus);
        let (Some(infeed), Some(along)) = (place(infeed), place(along)) else { return };
        let spindle = &mut self.spindles[work];
        let omega = spindle.omega();
        grinder.step(
            spindle.angle_rev(),
            self.axes[infeed].table_mm(),
            self.axes[along].table_mm(),
            omega,
        );
        let contact = grinder.contact();
        self.axes[infeed].push(contact.normal);
        spindle.resist(contact.torque.copysign(omega), contact.torque);
        self.truth.tool_deflection = Length::mm(contact.deflection + grinder.worn_mm());
        self.truth.cutting_force = Force::n(contact.normal);
        self.truth.cutting_torque = Torque::n_m(contact.torque);
    }

    /// Drills and taps, and all axes and spindles.
    fn cut(&mut self) {
        let mounted = self.mounted();
        let (Some(cutting), [x, y, Some(z)], false) =
            (&mut self.cutting, self.x_y_z, self.spindles.is_empty())
        else {
            for _ in 0..self.substeps {
                step_all(&mut self.axes, &mut self.spindles);
            }
            return;
        };
        let over =
            [x, y].map(|at| at.map_or(Length::ZERO, |at| self.axes[at].position().of_linear()));
        cutting.begin_period(mounted, over);
        let turned = self.turning.as_mut().zip(cutting.insert()).map(
            |(turning, (number, insert, length))| {
                let at =
                    [over[0].value(), over[1].value(), self.axes[z].table_mm() - length.value()];
                let turns = (self.spindles[0].angle_rev(), self.spindles[0].omega());
                turning.step((number, &insert), at, turns, (cutting.top(), cutting.holes()))
            },
        );
        let turned = turned.unwrap_or_default();
        if let (Some(turning), Some((number, cutter, length)), Some(tool)) =
            (&mut self.turning, cutting.polygon_cutter(), self.spindles.get(1))
        {
            let at = [over[0].value(), over[1].value(), self.axes[z].table_mm() - length.value()];
            let turns = [self.spindles[0].angle_rev(), tool.angle_rev()];
            turning.cut_polygon((number, &cutter), at, turns);
        }
        for (axis, force) in [(x, turned.force[0]), (y, turned.force[1])] {
            if let Some(axis) = axis.filter(|_| self.turning.is_some()) {
                self.axes[axis].push(force);
            }
        }
        for _ in 0..self.substeps {
            let Load { force, torque, friction } = cutting.load();
            self.axes[z].push(force + turned.force[2]);
            self.spindles[0].resist(torque + turned.torque, friction + turned.torque.abs());
            step_all(&mut self.axes, &mut self.spindles);
            let axis_mm = self.axes[z].table_mm();
            if !cutting.is_idle(axis_mm) {
                let spindle = &self.spindles[0];
                cutting.step(axis_mm, spindle.angle_rev(), spindle.omega());
            }
        }
        let Load { force, torque, .. } = cutting.load();
        self.truth.tool_deflection = cutting.deflection();
        self.truth.tool_turn = cutting.slip();
        let TurningLoad { main, torque: by_insert, .. } = turned;
        self.truth.cutting_force = Force::n(force + main);
        self.truth.cutting_torque = Torque::n_m(-torque - by_insert);
        self.truth.tool_broken = cutting.is_broken();
        self.truth.broken_by = cutting.broken_by();
    }

    /// Read encoders, and the truth beside them.
    fn observe(&mut self) {
        self.feedback.time = self.config.period * self.periods as f64;
        self.feedback.tool = self.changer.tool();
        self.feedback.inputs = self.shown_inputs();
        for ((index, _), axis) in self.config.axes.iter().zip(&mut self.axes) {
            self.feedback.axes[*index] = axis.observe();
            self.truth.axes[*index] = axis.position();
            self.truth.axis_forces[*index] = axis.drive_force();
        }
        for (index, spindle) in self.spindles.iter_mut().enumerate() {
            spindle.read(&mut self.rng);
            self.feedback.spindles[index] = spindle.feedback();
            self.truth.spindles[index] = Angle::rev(spindle.angle_rev());
            self.truth.spins[index] = Spin::rev_per_s(spindle.omega() / TAU);
            self.truth.spindle_torques[index] = spindle.drive_torque();
        }
        self.torque_sensors.read(&self.truth, &mut self.feedback);
    }
}

/// One physics step of everything.
#[inline]
fn step_all(axes: &mut [Axis], spindles: &mut [Spindle]) {
    for axis in axes {
        axis.step();
    }
    for spindle in spindles {
        spindle.step();
    }
}

impl bus::Machine for SimulatedMachine {
    fn period(&self) -> Time {
        self.config.period
    }

    fn feedback(&self) -> &Feedback {
        &self.feedback
    }

    fn exchange(&mut self, command: &Command) -> &Feedback {
        if self.underway.is_empty() {
            self.obey(command);
        } else {
            let arrived = self.transport(command);
            self.obey(&arrived);
        }
        self.advance();
        self.touch();
        self.periods += 1;
        self.observe();
        &self.feedback
    }

    fn truth(&self) -> Option<&Truth> {
        Some(&self.truth)
    }
}
