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
//! Beside its play and its spring the screw has errors of its lead, and the encoders of their own ([`crate::plant`]).
//!
//! Each step drifts half a step, kicks once, drifts half a step (position Verlet): exact under constant
//! force, second order and free of numerical damping on the spring, one evaluation of the forces.
//!
//! A drive that is off gives no force. Where there is a brake it then clamps the motor at once if it hardly moved, else when
//! it has stood for [`BRAKE_STANDS_S`], not where it merely turns about: a holding brake is no working brake. One that falls, or has run down for [`BRAKE_LATEST_S`], is clamped all the same.
//! Elsewhere the guideway's own friction holds the axis.
//!
//! Source: the two-mass model is that of any text on feed drives, e.g. Altintas, *Manufacturing
//! Automation*, 2nd ed. 2012, ch. 5; friction as in [`crate::Lugre`].
use crate::friction::{Guideway, between};
use crate::lag::Lag;
use crate::plant::Transmission;
use crate::travel::{Surroundings, Travel};
use crate::{AxisEncoder, AxisErrors, AxisScatter, Lugre, ScrewGrowth};
use core::f64::consts::TAU;
use units::{Coordinate, Force, Inertia, Mass, Stiffness, Time, Torque};

/// Standard gravity, m/s² (CGPM 1901).
pub(crate) const GRAVITY: f64 = 9.806_65;

/// Slower than this for so long a motor stands, for its brake, m/s and s (estimate: a drive's standstill monitor).
const BRAKE_STANDS: f64 = 0.5e-3;
const BRAKE_STANDS_S: f64 = 0.01;
/// What runs no faster when it is switched off is caught at once, m/s (estimate: what does a holding brake no harm).
const BRAKE_CATCHES: f64 = 5e-3;
/// A motor that runs downwards faster by this than when it was switched off falls, m/s (estimate: 20 ms in which a brake closes).
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
    /// Share of the table's weight that pulls it towards minus: 0 for a level or a counterbalanced axis, 1
    /// for a bare vertical one.
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
        };
        axis.observe();
        axis
    }

    /// What the drive shall do for the coming period.
    pub(crate) fn obey(&mut self, command: &bus::AxisCommand) {
        if self.on && !command.enable {
            (self.off, self.stood) = ((0.0, self.motor.v), 0.0);
        }
        self.screw.begin_period(self.motor.x);
        self.on = command.enable;
        self.clamped &= !self.on;
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

    /// One physics step.
    #[inline]
    pub(crate) fn step(&mut self) {
        let drive = self.lag.step(&mut self.force, self.reference);
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

    /// What the machine says of it.
    pub(crate) fn feedback(&self) -> bus::AxisFeedback {
        let (position, motor) = self.screw.read(self.motor.x, self.table.x);
        let position = self.surroundings.reading(position);
        let mut said = bus::AxisFeedback { position, motor, ready: self.on, ..Default::default() };
        self.surroundings.fill(self.table_mm(), &mut said);
        said
    }

    /// A period is over: switches and index marks.
    pub(crate) fn observe(&mut self) {
        let (seen, count) = self.screw.seen(self.motor.x, self.table.x);
        self.surroundings.observe(self.table.x * 1e3, seen, count);
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
mod tests {
    use super::*;
    use crate::fixtures::z_axis;
    use crate::oracle::{free_mode, ramp_up};
    use bus::AxisCommand;

    const H: f64 = 25e-6;

    fn axis(model: &AxisModel) -> Axis {
        Axis::new(model, model, (H, 10.0 * H), false)
    }

    fn on(force: f64) -> AxisCommand {
        AxisCommand { enable: true, force: Force::n(force), ..Default::default() }
    }

    fn without_friction(mut model: AxisModel) -> AxisModel {
        model.friction.coulomb = Force::n(1e-9);
        model.friction.breakaway = Force::n(1e-9);
        model.friction.viscous_n_s_per_m = 0.0;
        model.friction.bristle_damping_n_s_per_m = 0.0;
        model
    }

    #[test]
    fn the_z_axis_rings_at_its_natural_frequency_of_124_hz() {
        let model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
        let mode = free_mode(&model);
        let mut axis = axis(&model);
        axis.obey(&on(0.0));
        axis.table.x += 10e-6;
        // zero crossings of the stretch, each found by interpolation, over one second less decay
        let (mut crossings, mut last) = (Vec::new(), axis.motor.x - axis.table.x);
        for i in 1..2_000 {
            axis.step();
            let now = axis.motor.x - axis.table.x;
            if last * now < 0.0 {
                crossings.push(H * (f64::from(i) - now / (now - last)));
            }
            last = now;
        }
        let half_periods = (crossings.len() - 1) as f64;
        let hz = half_periods / 2.0 / (crossings[crossings.len() - 1] - crossings[0]);
        assert!((mode.natural_hz - 124.0).abs() < 0.5, "{} Hz", mode.natural_hz);
        assert!((hz - mode.damped_hz).abs() < 1e-3 * mode.damped_hz, "{hz} Hz, {mode:?}");
    }

    #[test]
    fn the_ringing_decays_at_its_damping_ratio() {
        let model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
        let mode = free_mode(&model);
        let mut axis = axis(&model);
        axis.obey(&on(0.0));
        axis.table.x += 10e-6;
        let (mut peaks, mut last, mut rising) = (Vec::new(), 0.0, false);
        for _ in 0..4_000 {
            axis.step();
            let now = axis.motor.x - axis.table.x;
            if rising && now < last {
                peaks.push(last);
            }
            rising = now > last;
            last = now;
        }
        let decrement = (peaks[0] / peaks[3]).ln() / 3.0;
        let ratio = decrement / f64::hypot(decrement, TAU);
        assert!((ratio - mode.damping_ratio).abs() < 0.005 * mode.damping_ratio + 2e-4, "{ratio}");
    }

    #[test]
    fn constant_force_gives_the_parabola_of_the_whole_mass() {
        let model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
        let mut axis = axis(&model);
        axis.obey(&on(10_000.0));
        for _ in 0..4000 {
            axis.step();
        }
        let (mm, mt) = (model.motor_mass().value(), model.table.value());
        let centre = (mm * axis.motor.x + mt * axis.table.x) / (mm + mt);
        let exact = ramp_up(10_000.0 / (mm + mt), 0.1);
        assert!((centre - exact).abs() < 1e-9 * exact, "{centre} m, exact {exact} m");
    }

    #[test]
    fn a_hard_stop_holds_an_axis_that_is_driven_into_it_with_all_its_force() {
        let mut model = AxisModel { backlash: Coordinate::ZERO, ..without_friction(z_axis()) };
        let stop = Stiffness::n_per_mm(80_000.0);
        model.travel.stops = Some((Coordinate::new(-400.0), Coordinate::new(10.0), stop));
        let mut axis = axis(&model);
        let force = model.peak_force().value();
        let (mut fastest, mut farthest) = (0.0_f64, 0.0_f64);
        for _ in 0..40_000 {
            axis.obey(&on(force));
            axis.step();
            fastest = fastest.max(axis.motor.v);
            farthest = farthest.max(axis.table_mm());
        }
        // undamped, the whole mass m at speed v and under force F goes F/k + √((F/k)² + m·v²/k) deep into a spring k; the screw
        // is another spring behind it, so that half the mass's way is its own
        let (mass, k) = (model.table.value() + model.motor_mass().value(), 8e7);
        let static_mm = force / k * 1e3;
        let deepest = static_mm + (force / k).hypot(fastest * (mass / k).sqrt()) * 1e3;
        assert!(farthest - 10.0 < deepest, "{farthest} mm, stop at 10, {deepest} mm at most");
        let rests = axis.table_mm() - 10.0;
        assert!((rests - static_mm).abs() < 0.01 * static_mm, "{rests} mm, exact {static_mm} mm");
    }

    #[test]
    fn on_reversal_the_table_stays_behind_by_the_play() {
        let model = AxisModel { backlash: Coordinate::new(3e-3), ..z_axis() };
        let mut axis = axis(&model);
        axis.obey(&on(0.0));
        // the motor is led by hand, slowly; the table follows with friction only
        let lead_to = |axis: &mut Axis, target: f64| {
            while (axis.motor.x - target).abs() > 1e-9 {
                axis.motor.v = 0.5e-3 * (target - axis.motor.x).signum();
                axis.motor_rate = 0.0;
                axis.step();
            }
            for _ in 0..20_000 {
                axis.motor.v = 0.0;
                axis.step();
            }
            axis.motor.x - axis.table.x
        };
        let forth = lead_to(&mut axis, 100e-6);
        let back = lead_to(&mut axis, 0.0);
        // the play, plus twice the screw's stretch under friction that stays in the bristles at rest
        let stretch = 2.0 * 190.0 / 80e6;
        let lost = forth - back;
        assert!(lost > 3e-6 && lost < 3e-6 + stretch, "{lost} m");
    }

    #[test]
    fn the_table_breaks_away_at_the_breakaway_force() {
        let model = z_axis();
        let mut axis = axis(&model);
        axis.obey(&on(0.0));
        axis.motor_rate = 0.0; // the screw held fast is out of the way: push the table freely
        axis.stiffness = 0.0;
        axis.damping = 0.0;
        let mut push = 0.0;
        while axis.table.v < 1e-3 {
            push += 50.0 * H; // 50 N/s
            axis.push(push);
            axis.step();
            assert!(push < 1000.0, "never broke away");
        }
        let exact = model.friction.breakaway.value();
        assert!((push - exact).abs() < 0.03 * exact, "{push} N, exact {exact} N");
    }

    #[test]
    fn a_bare_vertical_axis_without_its_drive_falls_and_a_brake_holds_it() {
        let bare = AxisModel { weight_share: 1.0, brake: false, ..z_axis() };
        let mut falling = axis(&bare);
        let mut held = axis(&AxisModel { brake: true, ..bare });
        for _ in 0..8000 {
            falling.step();
            held.step();
        }
        assert!(falling.table.x < -5e-3, "{}", falling.table.x);
        assert!(held.table.x.abs() < 1e-9, "{}", held.table.x); // the screw carries it from the start
    }

    #[test]
    fn a_brake_does_not_clamp_an_axis_that_turns_about_and_catches_one_that_falls() {
        let model = AxisModel { weight_share: 1.0, brake: true, ..z_axis() };
        let mut up = axis(&model);
        up.obey(&AxisCommand { enable: true, ..AxisCommand::default() });
        (up.motor.v, up.table.v) = (0.02, 0.02);
        up.obey(&AxisCommand::default());
        let (mut highest, mut caught) = (0.0_f64, None);
        for i in 0..20_000 {
            up.step();
            highest = highest.max(up.table_mm());
            caught = caught.or(up.clamped.then_some((i, up.table_mm())));
        }
        let (when, place) = caught.expect("it falls, and is caught");
        assert!(f64::from(when) * H > 0.02, "not while it rises: {when}");
        // 20 mm/s downwards at 1.1 m/s² of weight less friction on all that moves: about 0.2 mm below its highest
        assert!((0.05..0.5).contains(&(highest - place)), "{highest} mm, caught at {place} mm");
    }

    #[test]
    fn work_in_is_energy_stored_and_heat() {
        let model = z_axis();
        let mut axis = axis(&model);
        let h = H;
        let (mm, mt) = (model.motor_mass().value(), model.table.value());
        let (mut work, mut damped, mut rubbed) = (0.0, 0.0, 0.0);
        for i in 0..8000 {
            axis.obey(&on(8000.0 * (f64::from(i) * h * 60.0).sin()));
            let (before, bent) = (axis.clone(), axis.bristles);
            axis.step();
            let vm = f64::midpoint(before.motor.v, axis.motor.v);
            let vt = f64::midpoint(before.table.v, axis.table.v);
            work += axis.reference * vm * h;
            damped += axis.damping * (before.motor.v - before.table.v) * (vm - vt) * h;
            let mut z = bent;
            rubbed += before.guideway.step(&mut z, before.table.v) * vt * h;
        }
        let stretch = axis.motor.x - axis.table.x;
        let beyond = stretch - stretch.clamp(-axis.half_play, axis.half_play);
        let kinetic = 0.5 * (mm * axis.motor.v.powi(2) + mt * axis.table.v.powi(2));
        let stored = kinetic + axis.stiffness * beyond.powi(2) / 2.0;
        let balance = work - damped - rubbed - stored;
        assert!(rubbed > 1.0 && damped > 0.0, "{rubbed} J, {damped} J");
        assert!(
            balance.abs() < 1e-3 * (work.abs() + stored),
            "{balance} J of {work} J, {stored} J"
        );
    }

    #[test]
    fn the_drive_gives_no_more_than_its_peak() {
        let mut axis = axis(&z_axis());
        axis.obey(&on(1e9));
        axis.step();
        let peak = 60.0 * TAU / 0.016;
        assert!((axis.drive_force().value() - peak).abs() < 1e-6, "{}", axis.drive_force());
        axis.obey(&on(f64::NAN));
        axis.step();
        assert_eq!(axis.drive_force(), Force::ZERO);
    }
}
