//! What the drives do when they are left alone: the control has fallen silent, or the power has
//! failed.
//!
//! ```text
//!   last command ─┬─ Off           outputs off: brakes clamp the axes that have one, spindles coast
//!                 ├─ Coast         spindles coast; the axis tied to one in the last command stays on that line;
//!                 │                a bus that is half empty has the spindle brake, which fills it
//!                 ├─ QuickStop     each drive brakes by itself, along a ramp that was set before; then off
//!                 └─ CoupledStop   the spindle brakes; the axis tied to it in the last command stays on
//!                                  that line; everything else brakes by itself; then off
//! ```
//!
//! In a quick stop no drive knows of the other. A drive's ramp is an object that the control may
//! write with every command (`CiA` 402, 6085h), so the axis of a tap has one that lasts as long as
//! the spindle's: lead times the spindle's ramp. Where each braked as hard as it can, the axis
//! would stand twenty times sooner than the spindle.
//!
//! The drives close their own loops here on their motors' encoders, as servo drives do in a quick
//! stop (`CiA` 402) or an extended stop. Without mains the energy is what the DC bus holds and the
//! braking spindle gives back: `C·V·dV/dt = P_back − P_drives`; below the trip voltage all outputs
//! go off and the rest is coasting.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | C, V | capacitance and voltage of the bus | F, V |
//! | η | share of the braking power that reaches the bus | 1 |
//! | M, J | moved mass, inertia | kg, kg·m² |
use crate::{AxisModel, Config, SpindleModel};
use bus::{AxisCommand, Command, Coupled, DriveReaction, Feedback, SpindleCommand};
use core::f64::consts::TAU;
use units::{Coordinate, Force, SpinAccel, Time, Torque};

/// Share of a drive's limit that it brakes with.
const BRAKING: f64 = 0.95;
/// Bandwidths of the drives' own speed loops, Hz, and gain of their position loops, 1/s.
const AXIS_HZ: f64 = 70.0;
const SPINDLE_HZ: f64 = 100.0;
const POSITION_GAIN: f64 = 80.0;
/// Time constant with which a drive smooths the speed that it takes from its encoder, in periods.
const SMOOTHING: f64 = 4.0;
/// What stands, mm/s and rad/s; for how long, s.
const STILL_MM_PER_S: f64 = 0.2;
const STILL_RAD_PER_S: f64 = 0.1;
const STILL_S: f64 = 0.05;
/// What a servo drive uses while it holds, W (estimate).
const STANDING_W: f64 = 60.0;
/// η: what inverter and motor leave of the braking power (estimate).
const RETURNED: f64 = 0.8;
/// Standard gravity, m/s² (CGPM 1901).
const GRAVITY: f64 = 9.806_65;

/// The DC bus of drives whose mains have failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bus {
    /// Capacitance, F.
    pub farad: f64,
    /// Voltage in operation, V.
    pub volt: f64,
    /// Voltage at which the drives trip, V.
    pub trip_volt: f64,
}

/// Drives left alone.
#[derive(Clone, Debug)]
pub struct RunDown {
    reaction: DriveReaction,
    coupled: Option<Coupled>,
    axes: Vec<(usize, AxisDrive)>,
    spindles: Vec<SpindleDrive>,
    tool: u32,
    period_s: f64,
    still_s: f64,
    /// Energy that the bus has above its trip, J; `None`: mains.
    energy: Option<f64>,
    /// Below this nothing coasts any more, J.
    reserve: f64,
    off: bool,
}

#[derive(Clone, Debug)]
struct AxisDrive {
    mass: f64,
    peak: f64,
    weight: f64,
    /// How much further the axis is than its motor's own encoder says, where it has one beside a
    /// scale, m: a drive closes its loops on its motor.
    beside: f64,
    /// m, m/s: measured; and the setpoint that brakes.
    x: f64,
    v: f64,
    setpoint: (f64, f64),
    force: f64,
}

#[derive(Clone, Debug)]
struct SpindleDrive {
    inertia: f64,
    peak: f64,
    power: f64,
    angle: f64,
    omega: f64,
    /// rad/s, rad/s²: the speed that brakes, and how fast it changes.
    setpoint: (f64, f64),
    torque: f64,
    /// Of a drive that makes its own ramps: what is left of its delay, s, and its ramp, rad/s².
    own: (f64, f64),
}

impl RunDown {
    /// No spindle coasts for longer.
    pub const LONGEST: Time = Time::s(600.0);

    /// Begin, after this command and this feedback. `bus`: the mains have failed.
    pub fn new(
        config: &Config,
        reaction: DriveReaction,
        bus: Option<Bus>,
        last: &Command,
        feedback: &Feedback,
    ) -> Self {
        let axes = config.axes.iter().map(|(index, model)| {
            let speed = last.axes[*index].speed.value() * 1e-3;
            let on = last.axes[*index].enable;
            let said = &feedback.axes[*index];
            let beside = said.motor.map_or(0.0, |motor| (said.position - motor).value() * 1e-3);
            let x = said.position.value() * 1e-3;
            (*index, AxisDrive::new(model, (x, beside), if on { speed } else { 0.0 }))
        });
        let spindles = config.spindles.iter().zip(&last.spindles).zip(&feedback.spindles);
        let spindles = spindles.map(|((model, order), reading)| {
            let omega = if order.enable { order.spin.in_rad_per_s() } else { 0.0 };
            SpindleDrive::new(model, reading.angle.value() * TAU, omega)
        });
        let energy = |bus: Bus| 0.5 * bus.farad * (bus.volt.powi(2) - bus.trip_volt.powi(2));
        let powered = last.axes.iter().any(|axis| axis.enable);
        Self {
            reaction,
            coupled: last.coupled,
            axes: axes.collect(),
            spindles: spindles.collect(),
            tool: last.tool,
            period_s: config.period.value(),
            still_s: 0.0,
            energy: bus.map(energy),
            reserve: bus.map_or(0.0, |bus| 0.5 * energy(bus)),
            off: reaction == DriveReaction::Off || !powered,
        }
    }

    /// The first spindle's drive makes its own ramps: it begins to brake after this delay, with
    /// this deceleration, and the axis' ramp was set to that.
    #[must_use]
    pub fn on_own_ramps(mut self, delay: Time, decel: SpinAccel) -> Self {
        if let Some(spindle) = self.spindles.first_mut() {
            spindle.own = (delay.value(), decel.value() * TAU);
        }
        self
    }

    /// Everything stands, and all outputs are off.
    pub fn is_over(&self) -> bool {
        self.off && self.still_s > STILL_S
    }

    /// The bus was empty before everything stood.
    pub fn has_tripped(&self) -> bool {
        self.energy.is_some_and(|left| left < 0.0)
    }

    /// What the drives do in the coming period.
    pub fn command(&mut self, feedback: &Feedback) -> Command {
        self.read(feedback);
        if self.off {
            return Command { tool: self.tool, ..Command::default() };
        }
        let mut command = Command { tool: self.tool, ..Command::default() };
        for (drive, order) in self.spindles.iter_mut().zip(&mut command.spindles) {
            *order = match self.reaction {
                DriveReaction::QuickStop | DriveReaction::CoupledStop => drive.brake(self.period_s),
                DriveReaction::Off | DriveReaction::Coast => drive.coast(),
            };
        }
        for (index, drive) in &mut self.axes {
            let leader = self.coupled.filter(|c| usize::from(c.axis) == *index);
            let leader = leader.and_then(|c| Some((c, self.spindles.get(usize::from(c.spindle))?)));
            command.axes[*index] = match (leader, self.reaction) {
                (Some((coupled, spindle)), DriveReaction::QuickStop) => {
                    drive.ramp(&coupled, spindle, self.period_s)
                }
                (Some((coupled, spindle)), _) => drive.follow(&coupled, spindle, self.period_s),
                (None, _) => drive.brake(self.period_s),
            };
        }
        self.draw();
        if self.reaction == DriveReaction::Coast
            && self.energy.is_some_and(|left| left < self.reserve)
        {
            self.reaction = DriveReaction::CoupledStop;
        }
        self.off = self.still_s > STILL_S || self.energy.is_some_and(|left| left < 0.0);
        command
    }

    fn read(&mut self, feedback: &Feedback) {
        let mut still = true;
        for (index, drive) in &mut self.axes {
            let said = &feedback.axes[*index];
            let x = said
                .motor
                .map_or(said.position.value() * 1e-3, |motor| motor.value() * 1e-3 + drive.beside);
            drive.read(x, self.period_s);
            still &= drive.v.abs() < STILL_MM_PER_S * 1e-3;
        }
        for (drive, reading) in self.spindles.iter_mut().zip(&feedback.spindles) {
            drive.read(reading.angle.value() * TAU, self.period_s);
            still &= drive.omega.abs() < STILL_RAD_PER_S;
        }
        self.still_s = if still { self.still_s + self.period_s } else { 0.0 };
    }

    /// Take from the bus what the drives use, and add what they give back.
    fn draw(&mut self) {
        let Some(energy) = &mut self.energy else { return };
        let axes = self.axes.iter().map(|(_, drive)| drive.force * drive.v);
        let spindles = self.spindles.iter().map(|drive| drive.torque * drive.omega);
        for power in axes.chain(spindles) {
            *energy -=
                self.period_s * if power < 0.0 { power * RETURNED } else { power / RETURNED };
        }
        *energy -= self.period_s * STANDING_W;
    }
}

impl AxisDrive {
    fn new(model: &AxisModel, (x, beside): (f64, f64), v: f64) -> Self {
        Self {
            mass: model.motor_mass().value() + model.table.value(),
            peak: model.peak_force().value(),
            weight: -model.table.value() * GRAVITY * model.weight_share,
            beside,
            x,
            v,
            setpoint: (x, v),
            force: 0.0,
        }
    }

    fn read(&mut self, x: f64, period_s: f64) {
        self.v += ((x - self.x) / period_s - self.v) / SMOOTHING;
        self.x = x;
    }

    /// Brake along a straight ramp.
    fn brake(&mut self, h: f64) -> AxisCommand {
        let most = BRAKING * (self.peak - self.weight.abs()) / self.mass;
        let (x, v) = self.setpoint;
        let slower = v.signum() * (v.abs() - most * h).max(0.0);
        self.setpoint = (x + h * f64::midpoint(v, slower), slower);
        self.control((slower - v) / h, h)
    }

    /// Brake along a ramp that lasts as long as that of the spindle, without a look at the spindle.
    fn ramp(&mut self, coupled: &Coupled, spindle: &SpindleDrive, h: f64) -> AxisCommand {
        let accel = coupled.lead.value() * 1e-3 / TAU * spindle.setpoint.1;
        let (x, v) = self.setpoint;
        let slower = if spindle.setpoint.0 == 0.0 { 0.0 } else { v + h * accel };
        self.setpoint = (x + h * f64::midpoint(v, slower), slower);
        self.control(accel, h)
    }

    /// Stay on the line of a spindle that brakes, or coasts.
    fn follow(&mut self, coupled: &Coupled, spindle: &SpindleDrive, h: f64) -> AxisCommand {
        let m_per_rad = coupled.lead.value() * 1e-3 / TAU;
        let turned = spindle.angle - coupled.angle.value() * TAU;
        let place = coupled.place.value() * 1e-3 + m_per_rad * turned;
        self.setpoint = (place, m_per_rad * spindle.omega);
        self.control(m_per_rad * spindle.setpoint.1, h)
    }

    fn control(&mut self, accel: f64, h: f64) -> AxisCommand {
        let (x, v) = self.setpoint;
        let wanted = v + POSITION_GAIN * (x - self.x);
        let force = self.mass * (accel + TAU * AXIS_HZ * (wanted - self.v)) - self.weight;
        self.force = force.clamp(-self.peak, self.peak);
        AxisCommand {
            enable: true,
            position: Coordinate::new((x + v * h) * 1e3),
            speed: units::CoordinateSpeed::new(v * 1e3),
            force: Force::n(self.force),
        }
    }
}

impl SpindleDrive {
    fn new(model: &SpindleModel, angle: f64, omega: f64) -> Self {
        Self {
            inertia: model.inertia.value(),
            peak: model.peak_torque.value(),
            power: model.peak_power.value(),
            angle,
            omega,
            setpoint: (omega, 0.0),
            torque: 0.0,
            own: (0.0, f64::INFINITY),
        }
    }

    fn read(&mut self, angle: f64, period_s: f64) {
        self.omega += ((angle - self.angle) / period_s - self.omega) / SMOOTHING;
        self.angle = angle;
    }

    /// Outputs off. What it does is measured.
    const fn coast(&mut self) -> SpindleCommand {
        (self.setpoint, self.torque) = ((self.omega, 0.0), 0.0);
        SpindleCommand {
            enable: false,
            angle: units::Angle::ZERO,
            spin: units::Spin::ZERO,
            torque: Torque::ZERO,
            orient: None,
            locked: false,
        }
    }

    fn brake(&mut self, h: f64) -> SpindleCommand {
        let limit = BRAKING * self.peak.min(self.power / self.omega.abs().max(1e-9));
        let (before, _) = self.setpoint;
        let (delay, own) = self.own;
        self.own.0 = (delay - h).max(0.0);
        let change = if delay > 0.0 { 0.0 } else { (limit / self.inertia).min(own) };
        let slower = before.signum() * (before.abs() - change * h).max(0.0);
        self.setpoint = (slower, (slower - before) / h);
        let torque = self.inertia * (self.setpoint.1 + TAU * SPINDLE_HZ * (slower - self.omega));
        self.torque = torque.clamp(-self.peak, self.peak);
        SpindleCommand {
            enable: true,
            angle: units::Angle::rev(self.angle / TAU),
            spin: units::Spin::rev_per_s(slower / TAU),
            torque: Torque::n_m(self.torque),
            orient: None,
            locked: false,
        }
    }
}
