//! A spindle: an inertia, a drive with a torque and a power limit, bearings that rub.
//!
//! ```text
//!   Tref │▔▔▔▔▔▔▔╲ Ppeak/ω       J·dω/dt = Tm − Tf(ω) − Tload
//!        │Tpeak    ╲____          dTm/dt  = (Tref − Tm)/τ         |Tref| ≤ min(Tpeak, Ppeak/|ω|)
//!        └──────────────► ω      Tf(ω)   = c₀·tanh(ω/ω₀) + c₁·ω
//!               base speed
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | ω, θ | speed, angle | rad/s, rev |
//! | J | inertia | kg·m² |
//! | Tm, Tref, τ | torque of the motor, its reference, its lag | N·m, N·m, s |
//! | Tf, c₀, c₁, ω₀ | friction, its constant and viscous part, the speed over which it changes sign | N·m, N·m, N·m·s/rad, rad/s |
//! | h | physics step | s |
//!
//! Without a drive a spindle that hardly turns sticks: a load below the breakaway torque cannot
//! turn it.
//!
//! The lag is integrated exactly, the motion under its mean torque exactly; the limit and the
//! friction are taken at the beginning of the step (they change over milliseconds).
use crate::encoder::index_between;
use crate::friction::{between, smooth_sign};
use crate::lag::Lag;
use crate::plain_drive::{PlainDrive, Relay};
use crate::position_drive::{Moved, PositionDrive, PositionLoop};
use crate::rng::Rng;
use crate::{SpindleEncoder, SpindleScatter};
use core::f64::consts::TAU;
use units::{Angle, Inertia, Power, Spin, Time, Torque};

/// Slower than this share of ω₀ a spindle without a drive may stick.
const STICKS_BELOW: f64 = 0.5;

/// A spindle with its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleModel {
    /// Rotor, tool holder, and chuck if there is one.
    pub inertia: Inertia,
    /// Most torque, below the base speed.
    pub peak_torque: Torque,
    /// Most power, above the base speed.
    pub peak_power: Power,
    /// Time constant of the torque; zero for none.
    pub torque_lag: Time,
    /// Constant part c₀ of the friction.
    pub coulomb: Torque,
    /// Viscous part c₁ of the friction, N·m·s/rad.
    pub viscous_n_m_s_per_rad: f64,
    /// Speed ω₀ over which the constant part changes its sign.
    pub rounding: Spin,
    /// How it is measured.
    pub encoder: SpindleEncoder,
    /// Where it stands at the start.
    pub start: Angle,
    /// How far the spindle as it was built may be from all this.
    pub scatter: SpindleScatter,
}

impl SpindleModel {
    /// Speed above which power, not torque, is the limit.
    pub fn base_speed(&self) -> Spin {
        Spin::rev_per_s(self.peak_power.value() / self.peak_torque.value() / TAU)
    }
}

/// A simulated spindle: its parameters made ready for one step size, and its state.
#[derive(Clone, Debug)]
pub(crate) struct Spindle {
    h: f64,
    half_step_rev: f64,
    per_inertia: f64,
    peak_torque: f64,
    peak_power: f64,
    coulomb: f64,
    viscous: f64,
    per_rounding: f64,
    lag: Lag,
    encoder: SpindleEncoder,
    load: f64,
    load_friction: f64,
    wanted: f64,
    on: bool,
    saturated: bool,
    torque: f64,
    omega: f64,
    angle_rev: f64,
    disk_rev: f64,
    read_rev: f64,
    index: Option<f64>,
    /// A drive that makes its own ramps, instead of the torque that it is told.
    relay: Option<Relay>,
    /// A drive that closes its own position loop.
    position_loop: Option<PositionLoop>,
}

impl Spindle {
    /// At rest at its start.
    pub(crate) fn new(model: &SpindleModel, rng: &mut Rng, h: f64) -> Self {
        let angle_rev = model.start.value();
        let disk_rev = model.encoder.disk(angle_rev);
        Self {
            h,
            half_step_rev: h / 2.0 / TAU,
            per_inertia: 1.0 / model.inertia.value(),
            peak_torque: model.peak_torque.value(),
            peak_power: model.peak_power.value(),
            coulomb: model.coulomb.value(),
            viscous: model.viscous_n_m_s_per_rad,
            per_rounding: 1.0 / model.rounding.in_rad_per_s(),
            lag: Lag::new(model.torque_lag.value(), h),
            encoder: model.encoder,
            load: 0.0,
            load_friction: 0.0,
            wanted: 0.0,
            on: false,
            saturated: false,
            torque: 0.0,
            omega: 0.0,
            angle_rev,
            disk_rev,
            read_rev: model.encoder.read(disk_rev, rng),
            index: None,
            relay: None,
            position_loop: None,
        }
    }

    /// Give it a drive that is only told a speed.
    pub(crate) fn drive_plainly(&mut self, drive: PlainDrive, rng: Rng) {
        self.relay = Some(Relay::new(drive, rng));
    }

    /// Gives it a drive that closes its own position loop, told an angle each period.
    pub(crate) fn drive_to_angles(&mut self, drive: PositionDrive, lag: Time, period_s: f64) {
        let moved = Moved {
            inertia: 1.0 / self.per_inertia,
            lag_s: lag.value(),
            hold: 0.0,
            step_s: self.h,
            period_s,
        };
        self.position_loop = Some(PositionLoop::new(drive, moved));
    }

    /// What the drive shall do for the coming period.
    pub(crate) fn obey(&mut self, command: &bus::SpindleCommand) {
        self.on = command.enable;
        self.saturated = false;
        if let Some(relay) = &mut self.relay {
            relay.obey(if self.on { command.spin.in_rad_per_s() } else { 0.0 });
            relay.orient(command.orient.filter(|_| self.on));
        }
        if let Some(servo) = &mut self.position_loop {
            let told = (command.angle.value() * TAU, command.spin.in_rad_per_s());
            servo.obey(self.on, told, self.disk_rev * TAU);
        }
        // a reference that is no number is no reference
        let torque = command.torque;
        self.wanted = if self.on && torque.is_finite() { torque.value() } else { 0.0 };
    }

    /// The process loads the spindle with so many N·m from here on, positive when they would turn
    /// it backwards; its friction can hold the spindle by so many.
    #[inline]
    pub(crate) const fn resist(&mut self, load: f64, friction: f64) {
        (self.load, self.load_friction) = (load, friction);
    }

    /// One physics step.
    #[inline]
    pub(crate) fn step(&mut self) {
        if self.relay.is_some() {
            return self.step_plainly();
        }
        let at_power = self.peak_power / self.omega.abs();
        let limit = if at_power < self.peak_torque { at_power } else { self.peak_torque };
        if let Some(servo) = &mut self.position_loop {
            let seen = self.encoder.disk(self.angle_rev) * TAU;
            let most = self.peak_torque;
            self.wanted = if self.on { servo.step(seen, self.omega, most) } else { 0.0 };
        }
        self.saturated |= self.wanted.abs() > limit;
        let reference = between(self.wanted, -limit, limit);
        let drive = self.lag.step(&mut self.torque, reference);
        let rubbing =
            self.coulomb * smooth_sign(self.omega * self.per_rounding) + self.viscous * self.omega;
        let before = self.omega;
        self.omega += self.h * self.per_inertia * (drive - rubbing - self.load);
        if !self.on && self.sticks(drive) {
            self.omega = 0.0;
        }
        self.angle_rev += self.half_step_rev * (before + self.omega);
    }

    /// Without a drive, what hardly turns and is turned by less than friction can hold stands: the
    /// smooth law of friction alone would let it creep for ever.
    fn sticks(&self, drive: f64) -> bool {
        let slow = self.omega.abs() * self.per_rounding < STICKS_BELOW;
        slow && (drive - self.load).abs() < self.coulomb + self.load_friction
    }

    /// One physics step of a drive that makes its own ramps; the torque it needed is what it gave.
    fn step_plainly(&mut self) {
        let Some(relay) = &mut self.relay else { return };
        let before = self.omega;
        self.omega = relay.step(before, self.angle_rev, self.h);
        let rubbing =
            self.coulomb * smooth_sign(before * self.per_rounding) + self.viscous * before;
        self.torque = (self.omega - before) / (self.h * self.per_inertia) + rubbing + self.load;
        self.angle_rev += self.half_step_rev * (before + self.omega);
    }

    /// Read the encoder at the end of a period.
    pub(crate) fn read(&mut self, rng: &mut Rng) {
        let before = self.disk_rev;
        self.disk_rev = self.encoder.disk(self.angle_rev);
        self.read_rev = self.encoder.read(self.disk_rev, rng);
        // the mark has a track of its own: noise on the counts does not move it
        self.index = index_between(before, self.disk_rev);
    }

    /// What the machine says of it.
    pub(crate) fn feedback(&self) -> bus::SpindleFeedback {
        bus::SpindleFeedback {
            angle: Angle::rev(self.read_rev),
            index: self.index.map(Angle::rev),
            ready: self.on,
            saturated: self.saturated,
            oriented: self.relay.as_ref().is_some_and(Relay::is_oriented),
            orient_fault: 0,
            torque: None, // read beside it
            fault_code: 0,
        }
    }

    /// Angle, rev.
    #[inline]
    pub(crate) const fn angle_rev(&self) -> f64 {
        self.angle_rev
    }

    /// Speed, rad/s.
    #[inline]
    pub(crate) const fn omega(&self) -> f64 {
        self.omega
    }

    /// Torque of the drive.
    pub(crate) fn drive_torque(&self) -> Torque {
        Torque::n_m(self.torque)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::spindle;
    use crate::oracle::spindle::{RunUp, coast_down, overshoot};
    use bus::SpindleCommand;
    use units::SpinAccel;

    const H: f64 = 25e-6;

    fn turning(model: &SpindleModel) -> Spindle {
        Spindle::new(model, &mut Rng::new(0), H)
    }

    fn full_torque() -> SpindleCommand {
        SpindleCommand { enable: true, torque: Torque::n_m(1e6), ..Default::default() }
    }

    /// Time to reach a speed under full torque, s, interpolated within the last step.
    fn run_up(model: &SpindleModel, to: Spin) -> f64 {
        let mut spindle = turning(model);
        spindle.obey(&full_torque());
        let target = to.in_rad_per_s();
        for i in 0.. {
            let before = spindle.omega();
            spindle.step();
            if spindle.omega() >= target {
                let share = (target - before) / (spindle.omega() - before);
                return H * (f64::from(i) + share);
            }
        }
        unreachable!("the loop has no end but the return")
    }

    fn frictionless() -> SpindleModel {
        SpindleModel {
            coulomb: Torque::ZERO,
            viscous_n_m_s_per_rad: 0.0,
            torque_lag: Time::ZERO,
            ..spindle()
        }
    }

    #[test]
    fn running_up_to_6000_rpm_takes_the_time_of_the_power_curve() {
        let model = frictionless();
        let exact = RunUp::of(&model).time_to(Spin::rpm(6000.0)).value();
        let simulated = run_up(&model, Spin::rpm(6000.0));
        assert!((simulated - exact).abs() < 1e-4 * exact, "{simulated} s, exact {exact} s");
    }

    #[test]
    fn below_the_base_speed_run_up_is_linear_in_time() {
        let model = frictionless();
        let simulated = run_up(&model, Spin::rpm(3000.0));
        let exact = model.inertia.value() * Spin::rpm(3000.0).in_rad_per_s() / 42.0;
        assert!((simulated - exact).abs() < 1e-9, "{simulated} s, exact {exact} s");
    }

    #[test]
    fn a_lag_delays_the_run_up_by_its_time_constant() {
        let lagging = SpindleModel { torque_lag: Time::s(0.8e-3), ..frictionless() };
        let delay =
            run_up(&lagging, Spin::rpm(3000.0)) - run_up(&frictionless(), Spin::rpm(3000.0));
        assert!((delay - 0.8e-3).abs() < 1e-7, "{delay} s");
    }

    #[test]
    fn without_its_drive_the_spindle_coasts_down_with_friction() {
        let model = spindle();
        let mut spindle = turning(&model);
        let start = Spin::rpm(6000.0);
        spindle.omega = start.in_rad_per_s();
        spindle.obey(&SpindleCommand::default());
        for i in 1..=80_000 {
            spindle.step();
            // while ω ≫ ω₀ the closed form with a constant c₀ holds
            let exact = coast_down(&model, start, Time::s(f64::from(i) * H)).in_rad_per_s();
            assert!((spindle.omega() - exact).abs() < 2e-4 * exact, "{i}: {}", spindle.omega());
        }
    }

    #[test]
    fn braked_at_constant_torque_it_turns_on_by_half_the_square_of_its_speed_over_its_braking() {
        let model = frictionless();
        let mut spindle = turning(&model);
        let from = Spin::rpm(1000.0);
        spindle.omega = from.in_rad_per_s();
        let brake = Torque::n_m(-10.0);
        spindle.obey(&SpindleCommand { enable: true, torque: brake, ..Default::default() });
        let (mut before, mut omega) = (spindle.angle_rev(), spindle.omega());
        while spindle.omega() > 0.0 {
            (before, omega) = (spindle.angle_rev(), spindle.omega());
            spindle.step();
        }
        let turned = before + omega * omega / (2.0 * 10.0 / 0.010) / TAU;
        let exact = overshoot(from, SpinAccel::rev_per_s2(10.0 / 0.010 / TAU)).value();
        assert!((turned - exact).abs() < 1e-9 * exact, "{turned} rev, exact {exact} rev");
    }

    #[test]
    fn the_angle_under_constant_torque_is_a_parabola() {
        let model = frictionless();
        let mut spindle = turning(&model);
        spindle.obey(&SpindleCommand {
            enable: true,
            torque: Torque::n_m(10.0),
            ..Default::default()
        });
        for _ in 0..4000 {
            spindle.step();
        }
        let exact = 10.0 / 0.010 * 0.1 * 0.1 / 2.0 / TAU;
        assert!((spindle.angle_rev() - exact).abs() < 1e-9 * exact);
    }

    #[test]
    fn saturation_is_told_only_when_the_reference_is_beyond_the_limit() {
        let mut spindle = turning(&frictionless());
        spindle.omega = Spin::rpm(6000.0).in_rad_per_s();
        let at = |torque: f64| SpindleCommand {
            enable: true,
            torque: Torque::n_m(torque),
            ..Default::default()
        };
        let limit = 15_000.0 / spindle.omega;
        spindle.obey(&at(limit * 0.99));
        spindle.step();
        assert!(!spindle.feedback().saturated);
        spindle.obey(&at(limit * 1.01));
        spindle.step();
        assert!(spindle.feedback().saturated);
        assert!((spindle.drive_torque().value() - limit).abs() < 0.01 * limit);
    }

    #[test]
    fn without_its_drive_a_spindle_stands_under_what_friction_can_hold() {
        let model = spindle();
        let breakaway = model.coulomb.value();
        for (load, friction, stands) in [
            (0.9 * breakaway, 0.0, true),
            (1.1 * breakaway, 0.0, false),
            (-0.9 * breakaway, 0.0, true),
            // a tap in its thread, pressed by the headstock's weight: its flanks hold more than its
            // lead turns
            (1.5 * breakaway, breakaway, true),
        ] {
            let mut spindle = turning(&model);
            spindle.obey(&SpindleCommand::default());
            spindle.resist(load, friction);
            for _ in 0..40_000 {
                spindle.step();
            }
            assert_eq!(spindle.angle_rev() == model.start.value(), stands, "{load} N·m");
        }
    }

    #[test]
    fn work_in_is_kinetic_energy_and_friction() {
        let model = spindle();
        let mut spindle = turning(&model);
        let (mut work, mut heat) = (0.0, 0.0);
        for i in 0..40_000 {
            let torque = Torque::n_m(30.0 * (f64::from(i) * H * 20.0).sin());
            spindle.obey(&SpindleCommand { enable: true, torque, ..Default::default() });
            let before = spindle.clone();
            spindle.resist(0.5, 0.0);
            spindle.step();
            let mean = f64::midpoint(before.omega, spindle.omega);
            let mut lagging = before.torque;
            let limit = (before.peak_power / before.omega.abs()).min(before.peak_torque);
            let reference = torque.value().clamp(-limit, limit);
            work += before.lag.step(&mut lagging, reference) * mean * H;
            let rubbing = model.coulomb.value() * smooth_sign(before.omega * before.per_rounding)
                + model.viscous_n_m_s_per_rad * before.omega;
            heat += (rubbing + 0.5) * mean * H;
        }
        let kinetic = model.inertia.value() * spindle.omega.powi(2) / 2.0;
        assert!(
            (work - heat - kinetic).abs() < 1e-9 * work.abs().max(1.0),
            "{work} {heat} {kinetic}"
        );
    }
}
