//! A feed axis: motor and screw, a spring with play, a table with friction.
//!
//! ```text
//!          Fm                  k, c, play b                     process, weight
//!        ──────►┌──────────┐                 ┌──────────┐ ◄────────────
//!               │ mm       ├──╱╲╱╲╱──┤ ├─────┤ mt       │
//!               └──────────┘                 └──────────┘ ◄─ Ff (LuGre)
//!                xm, vm       Fk              xt, vt
//!
//!   mm = (J)(2π/lead)²           mm·dvm/dt = Fm − Fk          Fk = k·deadzone(xm − xt, b) + c·(vm − vt)
//!   c  = 2ζ·√(k·mr)              mt·dvt/dt = Fk − Ff + F      mr = mm·mt/(mm + mt)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | xm, vm, mm | motor and screw, as a mass on the table's scale | m, m/s, kg |
//! | xt, vt, mt | table | m, m/s, kg |
//! | k, ζ, b | stiffness, damping ratio of the free mode, whole play | N/m, 1, m |
//! | Fm, Fk, Ff, F | motor, spring, friction, process and weight | N |
//! | h | physics step | s |
//!
//! Beside its play and its spring the screw has errors of its lead, and the encoders of their own
//! ([`crate::plant`]).
//!
//! Each step drifts half a step, kicks once, drifts half a step (position Verlet): exact under
//! constant force, second order and free of numerical damping on the spring, one evaluation of the
//! forces.
//!
//! A drive that is off gives no force. Where there is a brake it then clamps the motor at once if
//! it hardly moved, else when it has stood for [`BRAKE_STANDS_S`], not where it merely turns about:
//! a holding brake is no working brake. One that falls, or has run down for [`BRAKE_LATEST_S`], is
//! clamped all the same. Elsewhere the guideway's own friction holds the axis.
//!
//! Source: the two-mass model is that of any text on feed drives, e.g. Altintas, *Manufacturing
//! Automation*, 2nd ed. 2012, ch. 5; friction as in [`crate::Lugre`].
use crate::encoder::quantise;
use crate::friction::{Guideway, between};
use crate::lag::Lag;
use crate::plant::Transmission;
use crate::position_drive::{Moved, PositionDrive, PositionLoop};
use crate::travel::{Surroundings, Travel};
use crate::{AxisEncoder, AxisErrors, AxisScatter, Lugre, ScrewGrowth};
use core::f64::consts::TAU;
use units::{Coordinate, Force, Inertia, Mass, Stiffness, Time, Torque};

/// Standard gravity, m/s² (CGPM 1901).
pub(crate) const GRAVITY: f64 = 9.806_65;

/// Slower than this for so long a motor stands, for its brake, m/s and s (estimate: a drive's
/// standstill monitor).
const BRAKE_STANDS: f64 = 0.5e-3;
const BRAKE_STANDS_S: f64 = 0.01;
/// What runs no faster when it is switched off is caught at once, m/s (estimate: what does a
/// holding brake no harm).
const BRAKE_CATCHES: f64 = 5e-3;
/// A motor that runs downwards faster by this than when it was switched off falls, m/s (estimate:
/// 20 ms in which a brake closes).
const BRAKE_FALLS: f64 = 0.02;
/// A brake closes after this time at the latest, s (estimate: supervision of the drive).
const BRAKE_LATEST_S: f64 = 3.0;

/// A ball-screw axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisModel {
    /// What moves along the guideway.
    pub table: Mass,
    /// Motor, coupling and screw.
    pub inertia: Inertia,
    /// Travel per turn of the motor.
    pub screw_lead: Coordinate,
    /// Most the motor can give.
    pub peak_torque: Torque,
    /// Time constant of the current loop; zero for none.
    pub force_lag: Time,
    /// Axial stiffness between motor and table.
    pub stiffness: Stiffness,
    /// Damping ratio of the mode in which motor and table swing against each other.
    pub damping_ratio: f64,
    /// Whole play between motor and table.
    pub backlash: Coordinate,
    /// Friction of the guideway.
    pub friction: Lugre,
    /// Share of the table's weight that pulls it towards minus: 0 for a level or a counterbalanced
    /// axis, 1 for a bare vertical one.
    pub weight_share: f64,
    /// A brake clamps the motor while the drive is off.
    pub brake: bool,
    /// Where the axis is measured.
    pub encoder: AxisEncoder,
    /// Where it stands at the start, by its encoder.
    pub start: Coordinate,
    /// What stands along it.
    pub travel: Travel,
    /// How far the axis as it was built may be from all this.
    pub scatter: AxisScatter,
    /// What is wrong with its screw and its encoders, as far as it is stated.
    pub errors: AxisErrors,
    /// How its screw grows while it gets warm, if it does.
    pub growth: Option<ScrewGrowth>,
}

impl AxisModel {
    /// What motor and screw weigh on the table's scale: J(2π/lead)².
    pub fn motor_mass(&self) -> Mass {
        let per_m = TAU / (self.screw_lead.value() * 1e-3);
        Mass::kg(self.inertia.value() * per_m * per_m)
    }

    /// Most force the motor can give.
    pub fn peak_force(&self) -> Force {
        Force::n(self.peak_torque.value() * TAU / (self.screw_lead.value() * 1e-3))
    }
}

/// A simulated axis: its parameters made ready for one step size, and its state. SI units.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    half_step: f64,
    motor_rate: f64,
    table_rate: f64,
    stiffness: f64,
    damping: f64,
    half_play: f64,
    weight: f64,
    peak_force: f64,
    brake: bool,
    screw: Transmission,
    surroundings: Surroundings,
    lag: Lag,
    guideway: Guideway,
    process: f64,
    reference: f64,
    on: bool,
    clamped: bool,
    /// Since the drive went off, s, and how fast it ran then, m/s.
    off: (f64, f64),
    /// For so long the motor has stood since, s.
    stood: f64,
    force: f64,
    motor: Body,
    table: Body,
    bristles: f64,
    /// A drive that closes its own position loop, instead of the force that it is told.
    position_loop: Option<PositionLoop>,
    period_s: f64,
}

/// Position, m, and speed, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Body {
    x: f64,
    v: f64,
}

impl Axis {
    /// At rest, its table at the start, its screw stretched by the weight that hangs on it.
    /// `model` is the axis as it was built, `believed` as its maker states it.
    /// `unknown`: an encoder that is not absolute counts from where it is switched on.
    pub(crate) fn new(
        model: &AxisModel,
        believed: &AxisModel,
        (h, period): (f64, f64),
        unknown: bool,
    ) -> Self {
        let (motor_mass, table_mass) = (model.motor_mass().value(), model.table.value());
        let reduced = motor_mass * table_mass / (motor_mass + table_mass);
        let stiffness = model.stiffness.value() * 1e3;
        let screw = Transmission::new(model, believed, period);
        // a table that hangs on its screw stretches it; one that does not stands amid the play
        let (motor, table) = screw.at(model.start.value() * 1e-3, model.hang_mm() * 1e-3);
        let (seen, count) = screw.seen(motor, table);
        let surroundings = Surroundings::new(&model.travel, table_mass, seen, count, unknown);
        let mut axis = Self {
            half_step: h / 2.0,
            motor_rate: h / motor_mass,
            table_rate: h / table_mass,
            stiffness,
            damping: 2.0 * model.damping_ratio * (stiffness * reduced).sqrt(),
            half_play: model.backlash.value() * 1e-3 / 2.0,
            weight: model.weight().value(),
            peak_force: model.peak_force().value(),
            brake: model.brake,
            screw,
            surroundings,
            lag: Lag::new(model.force_lag.value(), h),
            guideway: Guideway::new(&model.friction, h),
            process: 0.0,
            reference: 0.0,
            on: false,
            clamped: model.brake,
            off: (0.0, 0.0),
            stood: 0.0,
            force: 0.0,
            motor: Body { x: motor, v: 0.0 },
            table: Body { x: table, v: 0.0 },
            bristles: 0.0,
            position_loop: None,
            period_s: period,
        };
        let _ = axis.observe();
        axis
    }

    /// Gives it a drive that closes its own position loop.
    pub(crate) fn drive_to_positions(&mut self, drive: PositionDrive, lag: Time) {
        let moved = Moved {
            inertia: 2.0 * self.half_step * (1.0 / self.motor_rate + 1.0 / self.table_rate),
            lag_s: lag.value(),
            hold: -self.weight,
            step_s: 2.0 * self.half_step,
            period_s: self.period_s,
        };
        self.position_loop = Some(PositionLoop::new(drive, moved));
    }

    /// Where it is by its encoder between counts, m.
    fn seen_m(&self) -> f64 {
        let (seen, _) = self.screw.seen(self.motor.x, self.table.x);
        self.surroundings.reading(Coordinate::new(seen)).value() * 1e-3
    }

    /// What the drive shall do for the coming period.
    pub(crate) fn obey(&mut self, command: &bus::AxisCommand) {
        if self.on && !command.enable {
            (self.off, self.stood) = ((0.0, self.motor.v), 0.0);
        }
        self.screw.begin_period(self.motor.x);
        self.on = command.enable;
        self.clamped &= !self.on;
        if self.position_loop.is_some() {
            let here = self.seen_m();
            let told = (command.position.value() * 1e-3, command.speed.value() * 1e-3);
            if let Some(servo) = &mut self.position_loop {
                servo.obey(self.on, told, here);
            }
        }
        // a reference that is no number is no reference
        let wanted = if command.force.is_finite() { command.force.value() } else { 0.0 };
        self.reference =
            if self.on { wanted.max(-self.peak_force).min(self.peak_force) } else { 0.0 };
    }

    /// The process pushes the table with so many newtons from here on.
    #[inline]
    pub(crate) const fn push(&mut self, process: f64) {
        self.process = process;
    }

    /// Force reference of a physics step.
    #[inline]
    fn reference(&mut self) -> f64 {
        if self.position_loop.is_none() {
            return self.reference;
        }
        if !self.on {
            return 0.0;
        }
        let (seen, speed, most) = (self.seen_m(), self.motor.v, self.peak_force);
        self.position_loop.as_mut().map_or(0.0, |servo| servo.step(seen, speed, most))
    }

    /// One physics step.
    #[inline]
    pub(crate) fn step(&mut self) {
        let reference = self.reference();
        let drive = self.lag.step(&mut self.force, reference);
        self.motor.x += self.half_step * self.motor.v;
        self.table.x += self.half_step * self.table.v;
        let ratio = self.screw.ratio;
        let stretch = ratio * self.motor.x + self.screw.offset - self.table.x;
        let beyond_play = stretch - between(stretch, -self.half_play, self.half_play);
        let opening = ratio * self.motor.v - self.table.v;
        let spring = self.stiffness * beyond_play + self.damping * opening;
        let friction = self.guideway.step(&mut self.bristles, self.table.v);
        self.motor.v += self.motor_rate * (drive - ratio * spring);
        // friction comes last: it takes longest to compute
        let mut pushed = spring + self.process + self.weight;
        if self.surroundings.is_beyond(self.table.x) {
            pushed += self.surroundings.push(self.table.x, self.table.v);
        }
        self.table.v += self.table_rate * pushed;
        self.table.v -= self.table_rate * friction;
        if self.brake && !self.on {
            self.clamp();
        }
        self.motor.x += self.half_step * self.motor.v;
        self.table.x += self.half_step * self.table.v;
    }

    /// The brake, once it is closed, holds more than the motor: it does not slip.
    fn clamp(&mut self) {
        let (since, then) = self.off;
        self.off.0 = since + 2.0 * self.half_step;
        let v = self.motor.v.abs();
        let down = self.weight.signum();
        let falls =
            self.weight != 0.0 && self.motor.v * down > (then * down).max(0.0) + BRAKE_FALLS;
        self.stood = if v < BRAKE_STANDS { self.stood + 2.0 * self.half_step } else { 0.0 };
        let stands = then.abs() < BRAKE_CATCHES || self.stood > BRAKE_STANDS_S;
        self.clamped |= stands || falls || since > BRAKE_LATEST_S;
        if self.clamped {
            self.motor.v = 0.0;
        }
    }

    /// A period is over: what encoders, switches and index marks say.
    pub(crate) fn observe(&mut self) -> bus::AxisFeedback {
        let (seen, count) = self.screw.seen(self.motor.x, self.table.x);
        self.surroundings.observe(self.table_mm(), seen, count);
        let position = self.surroundings.reading(Coordinate::new(quantise(seen, count)));
        let motor = self.screw.beside(self.motor.x);
        let mut said = bus::AxisFeedback { position, motor, ready: self.on, ..Default::default() };
        self.surroundings.fill(self.table_mm(), &mut said);
        said
    }

    /// Where the table really is.
    pub(crate) fn position(&self) -> Coordinate {
        Coordinate::new(self.table.x * 1e3)
    }

    /// Table position, mm.
    #[inline]
    pub(crate) const fn table_mm(&self) -> f64 {
        self.table.x * 1e3
    }

    /// Force of the drive.
    pub(crate) fn drive_force(&self) -> Force {
        Force::n(self.force)
    }
}

#[cfg(test)]
mod tests;
