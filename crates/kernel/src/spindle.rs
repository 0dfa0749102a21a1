//! A spindle: speed control while it only turns, position control while it is held, turned to an
//! angle or leads a tap.
//!
//! ```text
//!            ramp over                       ordered to an angle, at rest
//!    Ramp ──────────────► Slew ◄──────────────────────────────┐
//!     ▲                    │ at rest                          │
//!     └── new speed ──── Held ──────► Turn ──────► Held       Led (a tap says angle or speed)
//! ```
//!
//! The torque that the drive can give falls with speed: |M| ≤ min(M̂, P̂/2π|n|). What was not
//! planned (a stop before a tap, a speed that the plan did not foresee) runs on a share of that
//! curve.
//!
//! A spindle that leads followers may swing about its even turn: what is superposed on it is a
//! function of that turn, which stays its followers' master.
//!
//! Numbers here are in rev, s, N·m; inertia in N·m per rev/s² (J·2π).
mod observers;
mod orientation;
mod readings;
mod stuck;
mod surface;

use crate::config::{Config, SpindleControl};
use crate::encoder_check::EncoderCheck;
use crate::friction::spindle_friction;
use crate::servo::{Gains, Input, Servo};
use crate::sight::Sight;
use bus::SpindleCommand;
use core::f64::consts::TAU;
use motion::{Profile, SurfaceSpeed};
use observers::Observers;
use orientation::ByDrive;
use stuck::{Resting, Unanswered};
use sync::{Blend, Rotation, Swing};
use units::{Angle, Spin, SpinAccel, Time, Torque};

/// Share of the torque curve that unplanned changes of speed use.
const UNPLANNED: f64 = 0.75;
/// A ramp fits if it begins this near to the speed that is ordered, rev/s.
const RAMP_FITS: f64 = 1e-3;

/// What a spindle is doing.
#[derive(Clone, Copy, Debug)]
enum Task {
    /// Speed control towards a speed, rev/s, on its own ramp.
    Slew(f64),
    /// Speed control along a planned ramp, since a while, s, to a speed, rev/s.
    Ramp(f64, f64),
    /// Position control to an angle, since a while, s.
    Turn(Blend, f64),
    /// Position control where it stands.
    Held,
    /// Its drive brings it to an angle, and holds it there.
    OrientedByDrive(ByDrive),
    /// Position control, braking a tap's master.
    Brake,
    /// A tap says the angle.
    LedAngle,
    /// A tap says the speed.
    LedSpeed,
}

/// One spindle's loop and its state.
#[derive(Clone, Debug)]
pub(crate) struct SpindleLoop {
    pub(crate) control: SpindleControl,
    servo: Servo,
    observers: Observers,
    period_s: f64,
    lookahead_s: f64,
    inertia: f64,
    order: Task,
    ramp: Profile,
    /// It leads a gear: position-controlled also while it only turns, and changes its speed no
    /// faster than this, rev/s².
    pace: Option<f64>,
    /// The setpoint now, before, and as it will be when the torque acts.
    ordered: Rotation,
    before: Rotation,
    ahead: Rotation,
    /// What is superposed on the setpoint now, and when the torque acts.
    pub(crate) swing: (Swing, Swing),
    reading: f64,
    reading_before: f64,
    error: f64,
    /// The torque that was commanded last.
    torque: f64,
    unanswered: Unanswered,
    resting: Resting,
    saturated: bool,
    /// Whether its readings are used: see [`crate::encoder_plausibility`].
    pub(crate) sight: Sight,
    /// In this period its readings are usable again.
    regained: bool,
    /// What the program has ordered, rev/s, while it turns by itself; the operator's share of it.
    programmed: Option<f64>,
    /// It turns by the place of X, G96: `programmed` is that of this period.
    surface: Option<SurfaceSpeed>,
    share: f64,
    /// So long a change of the share may take yet, s.
    changing_s: f64,
    /// Whether its encoder has been checked.
    pub(crate) encoder_check: EncoderCheck,
}

impl SpindleLoop {
    pub(crate) fn new(control: SpindleControl, config: &Config) -> Self {
        let period_s = config.period.value();
        let inertia = control.inertia.value() * TAU;
        let still = Rotation::default();
        Self {
            servo: Servo::new(Gains {
                position_gain: control.position_gain,
                bandwidth_hz: control.velocity_bandwidth_hz,
                inertia,
                period_s,
                delay_s: config.command_delay.value(),
                lag_s: control.torque_lag.value(),
                count: control.encoder_count.value(),
                peak: control.peak_torque.value(),
                tracker_most_hz: f64::INFINITY,
            }),
            observers: Observers::new(&control, (config.period, config.command_delay), Angle::ZERO),
            period_s,
            lookahead_s: (config.command_delay + control.torque_lag).value() + period_s / 2.0,
            inertia,
            order: Task::Slew(0.0),
            ramp: Profile::EMPTY,
            pace: None,
            ordered: still,
            before: still,
            ahead: still,
            swing: (Swing::default(), Swing::default()),
            reading: 0.0,
            reading_before: 0.0,
            error: 0.0,
            torque: 0.0,
            unanswered: Unanswered::NONE,
            resting: Resting::NONE,
            saturated: false,
            sight: Sight::Closed,
            regained: false,
            programmed: None,
            surface: None,
            share: 1.0,
            changing_s: 0.0,
            encoder_check: EncoderCheck::new(control.encoder_check.is_some()),
            control,
        }
    }

    /// Be position-controlled while turning, or no longer.
    pub(crate) fn pace(&mut self, most: Option<f64>) {
        if most.is_some() && !self.position_controlled() {
            self.ordered.angle = self.now().angle;
            self.before = self.ordered;
        }
        self.pace = most;
    }

    /// The acceleration that a share of its torque gives at its present speed, rev/s².
    pub(crate) fn accel_at_most(&self, share: f64) -> f64 {
        share * self.limit(self.ordered.spin.value()) / self.inertia
    }

    /// The acceleration from rest of a change of speed that nothing has planned, rev/s².
    pub(crate) fn unplanned_accel(&self) -> f64 {
        UNPLANNED * self.accel_at_rest()
    }

    /// The acceleration that all of its torque gives at rest, rev/s².
    pub(crate) fn accel_at_rest(&self) -> f64 {
        self.control.peak_torque.value() / self.inertia
    }

    /// Turn at a speed that may change each period.
    pub(crate) fn slew_to(&mut self, spin: Spin) {
        self.release();
        self.order = Task::Slew(spin.value());
    }

    /// How it turns, by the observer.
    pub(crate) fn now(&self) -> Rotation {
        self.observers.now()
    }

    /// How it turns, for an axis that follows it.
    pub(crate) fn followed(&self) -> Rotation {
        self.observers.followed()
    }

    /// The last reading.
    pub(crate) const fn reading(&self) -> Angle {
        Angle::rev(self.reading)
    }

    /// The setpoint, without what is superposed: what followers follow.
    pub(crate) const fn ordered(&self) -> Rotation {
        self.ordered
    }

    /// What goes by its turn goes by this: the setpoint where it leads by angle, else how it really
    /// turns.
    pub(crate) fn master(&self) -> Rotation {
        if self.position_controlled() { self.ordered } else { self.followed() }
    }

    /// Deceleration that a stop which was not planned may ask of it: rev/s² while torque is the
    /// limit, and times speed, rev²/s³, while power is.
    pub(crate) fn braking(&self) -> (f64, f64) {
        let share = UNPLANNED / self.inertia;
        (share * self.control.peak_torque.value(), share * self.control.peak_power.value() / TAU)
    }

    /// How far ahead of the setpoint its feed-forward is taken.
    pub(crate) const fn lookahead_s(&self) -> f64 {
        self.lookahead_s
    }

    /// The drive was at its limit.
    pub(crate) const fn saturated(&self) -> bool {
        self.saturated
    }

    /// Following error under position control, rev; zero otherwise.
    pub(crate) fn error(&self) -> f64 {
        if self.position_controlled() { self.error } else { 0.0 }
    }

    /// It stands, by the observer, and is not ordered to turn.
    pub(crate) fn at_rest(&self) -> bool {
        self.ordered.spin == Spin::ZERO && self.now().spin.abs() < self.control.windows.at_rest
    }

    /// The ordered speed, once the spindle has it.
    pub(crate) fn at_speed(&self) -> Option<Spin> {
        let to = match self.order {
            Task::Slew(to) if self.ordered.spin.value() == to => to,
            Task::Ramp(..) | Task::Slew(_) => return None,
            Task::Turn(..)
            | Task::Held
            | Task::OrientedByDrive(_)
            | Task::Brake
            | Task::LedAngle
            | Task::LedSpeed => 0.0,
        };
        let windows = &self.control.windows;
        let window = (to.abs() * windows.at_speed).max(windows.at_rest.value());
        let turns = self.now().spin.value() - self.swing.0.rate;
        ((turns - to).abs() <= window).then_some(Spin::rev_per_s(to))
    }

    /// Run along a planned ramp to a speed; if it does not begin at the speed that is ordered, get
    /// there all the same.
    pub(crate) fn turn(&mut self, spin: Spin, ramp: &Profile) {
        let begins = ramp.at(0.0).v;
        self.programmed = Some(spin.value());
        self.surface = None;
        let to = self.overridden(spin.value());
        let as_planned = to == spin.value();
        let fits = as_planned && (begins - self.ordered.spin.value()).abs() <= RAMP_FITS;
        if fits && ramp.duration() > 0.0 && self.pace.is_none() {
            self.ramp = *ramp;
            self.order = Task::Ramp(0.0, to);
        } else {
            self.order = Task::Slew(to);
        }
    }

    /// No speed of the program is in force.
    const fn release(&mut self) {
        (self.programmed, self.surface) = (None, None);
    }

    /// What the operator makes of a speed, rev/s; never above what the spindle may turn.
    fn overridden(&self, spin: f64) -> f64 {
        let highest = self.control.highest.value().max(spin.abs());
        (spin * self.share).clamp(-highest, highest)
    }

    /// The operator's share of the programmed speed, from now on; `within_s`: so long it may take.
    pub(crate) fn override_by(&mut self, share: f64, within_s: f64) {
        self.changing_s -= self.period_s;
        if self.at_speed().is_some() {
            self.changing_s = 0.0;
        }
        if share == self.share {
            return;
        }
        self.share = share;
        let turns = matches!(self.order, Task::Slew(_) | Task::Ramp(..));
        if let Some(spin) = self.programmed.filter(|_| turns && self.surface.is_none()) {
            self.order = Task::Slew(self.overridden(spin));
            self.changing_s = within_s;
        }
    }

    /// It is on its way to a speed that the operator has changed.
    pub(crate) fn is_changing(&self) -> bool {
        self.changing_s > 0.0
    }

    /// The operator's share of what is programmed.
    pub(crate) const fn share(&self) -> f64 {
        self.share
    }

    /// Come to rest under speed control.
    pub(crate) fn stop(&mut self) {
        self.release();
        if !matches!(self.order, Task::Slew(0.0)) {
            self.order = Task::Slew(0.0);
        }
    }

    /// Come to rest in the kind of control that it is in: the stop of a fault.
    pub(crate) fn brake(&mut self) {
        self.release();
        self.order = if self.position_controlled() { Task::Brake } else { Task::Slew(0.0) };
    }

    /// A tap leads: the setpoint now, and when the torque acts.
    pub(crate) fn lead(&mut self, now: Rotation, ahead: Rotation, by_angle: bool) {
        self.release();
        self.order = if by_angle { Task::LedAngle } else { Task::LedSpeed };
        let angle = if by_angle { now.angle } else { self.goes_on(now.spin) };
        self.ordered = Rotation { angle, ..now };
        self.ahead = ahead;
    }

    /// Advance what the spindle does by itself by one period.
    pub(crate) fn advance(&mut self) {
        let h = self.period_s;
        match self.order {
            Task::Slew(to) if !self.position_controlled() => self.slew(to),
            Task::Slew(to) => self.slew_by_angle(to),
            Task::Brake => self.slew_by_angle(0.0),
            Task::Ramp(at, to) => {
                let at = at + h;
                if at >= self.ramp.duration() {
                    self.order = Task::Slew(to);
                    self.advance();
                } else {
                    let (now, ahead) = (self.ramp.at(at), self.ramp.at(at + self.lookahead_s));
                    let told = self.control.own_ramps.is_some();
                    self.ordered.angle = self.goes_on(Spin::rev_per_s(now.v));
                    self.set_speed(now.v, if told { 0.0 } else { now.a });
                    self.ahead = rotation(0.0, ahead.v, ahead.a);
                    self.order = Task::Ramp(at, to);
                }
            }
            Task::Turn(blend, at) => {
                let at = at + h;
                let (now, ahead) = (blend.at(at), blend.at(at + self.lookahead_s));
                self.ordered = rotation(now.s, now.v, now.a);
                self.ahead = rotation(ahead.s, ahead.v, ahead.a);
                let over = at >= blend.duration_s();
                self.order = if over { Task::Held } else { Task::Turn(blend, at) };
            }
            Task::Held => {
                self.ordered.spin = Spin::ZERO;
                self.ordered.accel = SpinAccel::ZERO;
                self.ahead = self.ordered;
            }
            Task::OrientedByDrive(_) => self.set_speed(0.0, 0.0),
            Task::LedAngle | Task::LedSpeed => {}
        }
    }

    fn slew_by_angle(&mut self, to: f64) {
        let before = self.ordered;
        self.slew(to);
        self.ordered.angle =
            before.angle + (before.spin + self.ordered.spin) * Time::s(self.period_s / 2.0);
        self.ahead = self.ordered;
    }

    /// The angle a period on, of a drive that is told an angle while the speed goes over to this
    /// one.
    fn goes_on(&self, spin: Spin) -> Angle {
        self.ordered.angle + (self.ordered.spin + spin) * Time::s(self.period_s / 2.0)
    }

    fn slew(&mut self, to: f64) {
        if self.control.own_ramps.is_some() {
            self.set_speed(to, 0.0);
            self.ahead = self.ordered;
            return;
        }
        let before = self.ordered.spin.value();
        let pace = self.pace.unwrap_or(f64::INFINITY);
        let most = pace.min(UNPLANNED * self.limit(before) / self.inertia) * self.period_s;
        let spin = before + (to - before).clamp(-most, most);
        self.set_speed(spin, (spin - before) / self.period_s);
        self.ahead = self.ordered;
    }

    fn set_speed(&mut self, spin: f64, accel: f64) {
        self.ordered.spin = Spin::rev_per_s(spin);
        self.ordered.accel = SpinAccel::rev_per_s2(accel);
    }

    /// Most torque the drive can give at a speed.
    fn limit(&self, spin: f64) -> f64 {
        let peak = self.control.peak_torque.value();
        let by_power = self.control.peak_power.value() / (TAU * spin.abs()).max(f64::MIN_POSITIVE);
        peak.min(by_power)
    }

    /// Its angle is controlled, not only its speed.
    pub(crate) const fn position_controlled(&self) -> bool {
        match self.order {
            Task::Turn(..) | Task::Held | Task::LedAngle | Task::Brake => true,
            Task::Slew(_) => self.pace.is_some() || self.control.closes_position,
            Task::Ramp(..) | Task::LedSpeed => self.control.closes_position,
            Task::OrientedByDrive(_) => false,
        }
    }

    /// The command for this period.
    pub(crate) fn command(&mut self) -> SpindleCommand {
        let shares = self.control.feed_forward;
        let by_angle = self.position_controlled();
        if !by_angle {
            self.ordered.angle = Angle::rev(self.reading);
        }
        let (ordered, ahead) = (swung(self.ordered, self.swing.0), swung(self.ahead, self.swing.1));
        let way = if by_angle {
            (ordered.angle - self.before.angle).value()
        } else {
            (self.before.spin + ordered.spin).value() * self.period_s / 2.0
        };
        let turned = self.reading - self.reading_before;
        self.error = (ordered.angle - Angle::rev(self.reading)).value();
        self.before = ordered;
        let friction = spindle_friction(&self.control.friction, ahead.spin).value();
        let feed_forward =
            shares.accel * self.inertia * ahead.accel.value() + shares.friction * friction;
        let limit = self.limit(self.now().spin.value());
        let growth = if by_angle { shares.speed * way - turned } else { way - turned };
        let limits = self.torque_limits(way, limit);
        let regained = core::mem::take(&mut self.regained);
        self.sight.advance(self.period_s);
        let torque = match self.sight {
            Sight::Closed => {
                if regained {
                    self.servo.resume();
                }
                self.servo.update(Input {
                    error: self.error,
                    growth: if regained { 0.0 } else { growth },
                    feed_forward,
                    limits,
                    position: by_angle,
                })
            }
            Sight::Carried(_) => self.servo.blind(feed_forward, limit, ordered.spin != Spin::ZERO),
            Sight::Free(_) => 0.0,
            Sight::Off => {
                self.observers.tell(Spin::ZERO);
                return SpindleCommand { angle: ordered.angle, ..SpindleCommand::default() };
            }
        };
        self.torque = torque;
        self.observers.tell(ordered.spin);
        SpindleCommand {
            enable: true,
            angle: ordered.angle,
            spin: ordered.spin,
            torque: Torque::n_m(torque),
            orient: self.told_to_orient(),
            locked: self.told_to_orient().is_some() && self.held().is_some(),
        }
    }
}

/// A setpoint with what is superposed on it.
fn swung(ordered: Rotation, swing: Swing) -> Rotation {
    Rotation {
        angle: ordered.angle + Angle::rev(swing.value),
        spin: ordered.spin + Spin::rev_per_s(swing.rate),
        accel: ordered.accel + SpinAccel::rev_per_s2(swing.accel),
    }
}

const fn rotation(angle: f64, spin: f64, accel: f64) -> Rotation {
    Rotation {
        angle: Angle::rev(angle),
        spin: Spin::rev_per_s(spin),
        accel: SpinAccel::rev_per_s2(accel),
    }
}
