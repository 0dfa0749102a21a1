//! An axis: from where its tool side shall be to the force of its drive.
//!
//! ```text
//!   setpoint ─┬──────────────────► + ─► servo ─► + ─► force
//!             │  stretch, play ──► ▲             ▲
//!             │                                  │ mass·a + friction − weight,
//!             └─ a moment ahead ─────────────────┘ as they will be when the force acts
//! ```
//!
//! *Ahead*: a force ordered at the reading of the encoders acts after the command's delay d and the
//! drive's own lag τ, and is held for a period h: the feed-forward is evaluated d + τ + h/2 later
//! than the setpoint it accompanies.
//!
//! *Stretch*: with the encoder on the motor the screw between encoder and tool side is a spring
//! that carries F = m·a + friction − weight, so the motor is led by F/k, and by half the play in
//! the sense of F. What the control calls the axis' position is the tool side everywhere: reading −
//! stretch. Where friction changes its sign the stretch has to change within milliseconds; the
//! motor's mass times that acceleration, m·F̈/k, is fed forward too. It halves the spike at the
//! bottom of a tapped hole.
//!
//! *A scale beside the motor's encoder.* The screw's spring must not lie inside the speed loop,
//! which would be slow for its resonance: the motor's encoder closes the speed loop, the scale
//! corrects what motor and model make of the tool side (believed = motor − stretch + what lasts of
//! scale − (motor − stretch)). By how much further than by the model the screw is stretched is the
//! cut's force, k·Δ, and fed forward: when a drill's thrust F ends, the motor stands, and the tool
//! side springs forward by F/k and its own overshoot, no more.
//!
//! Numbers here are in mm, s, N; masses in N per mm/s² (kg·10⁻³).
mod motor_side;
mod unchanged;

use crate::config::{AxisControl, Config, EncoderPlace, FeedForward};
use crate::friction::Bristles;
use crate::servo::{Gains, Input, Servo};
use crate::sight::Sight;
use bus::{AxisCommand, AxisFeedback};
use core::f64::consts::TAU;
use motor_side::MotorSide;
use unchanged::Unchanged;
use units::{Coordinate, CoordinateSpeed, Force};

/// Time in which a small jump of the setpoint is smoothed away, s.
const GAP_DECAY_S: f64 = 0.02;
/// Play changes sides over this share of the friction.
const PLAY_CROSSING: f64 = 0.25;

/// Bound of the force that stretches the screw at a reversal, over the breakaway force.
const STRETCHING_MOST: f64 = 10.0;

/// Where a tool side shall be, and how it moves there: mm and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Target {
    pub(crate) position: f64,
    pub(crate) speed: f64,
    pub(crate) accel: f64,
    pub(crate) jerk: f64,
}

impl Target {
    /// All of it are numbers.
    pub(crate) fn is_finite(&self) -> bool {
        [self.position, self.speed, self.accel, self.jerk].iter().all(|x| x.is_finite())
    }

    /// Both motions at once.
    fn with(&self, other: &Self) -> Self {
        Self {
            position: self.position + other.position,
            speed: self.speed + other.speed,
            accel: self.accel + other.accel,
            jerk: self.jerk + other.jerk,
        }
    }

    /// The same motion a moment later.
    fn ahead(&self, t: f64) -> Self {
        let Self { position, speed, accel, jerk } = *self;
        Self {
            position: position + t * (speed + t * (accel / 2.0 + t * jerk / 6.0)),
            speed: speed + t * (accel + t * jerk / 2.0),
            accel: accel + t * jerk,
            jerk,
        }
    }
}

/// The stretch between encoder and tool side, mm.
#[derive(Clone, Debug)]
struct Screw {
    per_stiffness: f64,
    half_play: f64,
    per_crossing: f64,
}

impl Screw {
    fn new(control: &AxisControl) -> Self {
        let crossing = PLAY_CROSSING * control.friction.coulomb.value().max(1.0);
        // a scale alone sees the tool side itself
        let seen = match (control.encoder.place, control.encoder.motor_count) {
            (EncoderPlace::Motor, _) | (EncoderPlace::Scale, Some(_)) => 1.0,
            (EncoderPlace::Scale, None) => 0.0,
        };
        Self {
            per_stiffness: seen / control.stiffness.value(),
            half_play: seen * control.backlash.value() / 2.0,
            per_crossing: 1.0 / crossing,
        }
    }

    fn stretch(&self, force: f64) -> f64 {
        force * self.per_stiffness + self.half_play * (force * self.per_crossing).clamp(-1.0, 1.0)
    }
}

impl AxisControl {
    /// Where the tool side stands at rest, by the encoder: the weight that hangs on a screw
    /// stretches it, and what the control calls the axis' position is the tool side everywhere.
    pub fn tool_side_at_rest(&self, reading: Coordinate) -> Coordinate {
        match self.encoder.place {
            EncoderPlace::Motor => {
                reading - Coordinate::new(Screw::new(self).stretch(-self.weight.value()))
            }
            EncoderPlace::Scale => reading,
        }
    }
}

/// Behind the screw's spring a tracker must not take the resonance for motion: at this share of it,
/// what the encoder says of the resonance is damped more than the resonance is sharp.
const BELOW_RESONANCE: f64 = 0.15;

/// The highest bandwidth of the servo's tracker, Hz: free with an encoder on the motor.
fn tracker_most_hz(control: &AxisControl) -> f64 {
    match (control.encoder.place, control.encoder.motor_count) {
        (EncoderPlace::Motor, _) | (EncoderPlace::Scale, Some(_)) => f64::INFINITY,
        (EncoderPlace::Scale, None) => {
            let per_mass = 1.0 / control.table_mass.value()
                + 1.0 / control.motor_mass.value().max(f64::MIN_POSITIVE);
            let stiffness_n_per_m = control.stiffness.value() * 1e3;
            BELOW_RESONANCE * libm::sqrt(stiffness_n_per_m * per_mass) / TAU
        }
    }
}

/// Time from a setpoint to the reading that shows it, s, where commands are on their way for more
/// than a period: they are taken after it, and reached in the period that follows.
fn late_s(config: &Config) -> f64 {
    let (delay, period) = (config.command_delay.value(), config.period.value());
    if delay > 1.5 * period { delay + period } else { 0.0 }
}

/// One axis' loop and its state.
#[derive(Clone, Debug)]
pub(crate) struct AxisLoop {
    pub(crate) control: AxisControl,
    servo: Servo,
    screw: Screw,
    motor: Option<MotorSide>,
    /// Friction on the tool side now, and as it will be when the force acts.
    friction: (Bristles, Bristles),
    positions: (f64, f64),
    /// The friction ahead of the last two periods.
    frictions: (f64, f64),
    /// Motor mass over the screw's stiffness and the period's square.
    per_friction_change: f64,
    period_s: f64,
    lookahead_s: f64,
    mass: f64,
    table: f64,
    /// The setpoint; what moves the axis writes it each period.
    pub(crate) target: Target,
    /// What couplings put on top of it.
    pub(crate) superposed: Target,
    /// By how much its places have got other names, in all, without any motion; and its readings.
    pub(crate) renamed: f64,
    pub(crate) shifted: f64,
    /// The deceleration with which it brakes, mm/s².
    pub(crate) brakes_at: f64,
    gap: f64,
    reading: f64,
    unchanged: Unchanged,
    stretch: f64,
    error: f64,
    /// Less than the drive could give, where it shall push with little force; else infinite.
    pub(crate) force_limit: f64,
    force: f64,
    /// Whether its readings are used: see [`crate::encoder_plausibility`].
    pub(crate) sight: Sight,
    /// The reading of this period is none of the encoder's: it was bridged.
    pub(crate) bridged: bool,
    /// In this period its readings are usable again.
    regained: Option<Regained>,
    pub(crate) warned: bool,
    /// Time by which its readings are late behind setpoints that cross a network, s.
    pub(crate) late_s: f64,
}

/// How an axis goes on whose readings are usable again.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Regained {
    /// On its setpoint: it was carried.
    AsOrdered,
    /// From where it is, at this speed: it was free.
    AsItMoves(f64),
}

impl AxisLoop {
    pub(crate) fn new(control: AxisControl, config: &Config) -> Self {
        let period_s = config.period.value();
        let mass = (control.motor_mass + control.table_mass).value() * 1e-3;
        let bristles = Bristles::new(&control.friction, period_s);
        Self {
            servo: Servo::new(Gains {
                position_gain: control.position_gain,
                bandwidth_hz: control.velocity_bandwidth_hz,
                inertia: mass,
                period_s,
                delay_s: config.command_delay.value(),
                lag_s: control.force_lag.value(),
                count: control.encoder.motor_count.unwrap_or(control.encoder.count).value(),
                peak: control.peak_force.value(),
                tracker_most_hz: tracker_most_hz(&control),
            }),
            screw: Screw::new(&control),
            motor: control.encoder.motor_count.map(|_| MotorSide::default()),
            friction: (bristles.clone(), bristles),
            positions: (0.0, 0.0),
            frictions: (0.0, 0.0),
            per_friction_change: control.motor_mass.value() * 1e-3
                / (control.stiffness.value() * period_s * period_s),
            period_s,
            lookahead_s: (config.command_delay + control.force_lag).value() + period_s / 2.0,
            mass,
            table: control.table_mass.value() * 1e-3,
            target: Target::default(),
            superposed: Target::default(),
            renamed: 0.0,
            shifted: 0.0,
            brakes_at: control.approach.1.value(),
            gap: 0.0,
            reading: 0.0,
            unchanged: Unchanged::new(&control, period_s),
            stretch: 0.0,
            error: 0.0,
            force_limit: f64::INFINITY,
            force: 0.0,
            sight: Sight::Closed,
            bridged: false,
            regained: None,
            warned: false,
            late_s: late_s(config),
            control,
        }
    }

    /// Deceleration that a stop without a plan may ask of it, mm/s²: half of what its drive
    /// can give.
    pub(crate) fn braking(&self) -> f64 {
        0.5 * self.control.peak_force.value() / self.mass
    }

    /// How far ahead of the setpoint its feed-forward is taken.
    pub(crate) const fn lookahead_s(&self) -> f64 {
        self.lookahead_s
    }

    /// Take the reading as the present place: the drive has just come up, or is off.
    pub(crate) fn adopt(&mut self, feedback: &AxisFeedback) {
        self.reading = feedback.position.value();
        self.stretch = self.screw.stretch(-self.control.weight.value());
        if let Some(motor) = &mut self.motor {
            let reading = feedback.motor.unwrap_or(feedback.position).value();
            let offset = self.reading + self.stretch - reading;
            *motor = MotorSide { offset, reading, ..MotorSide::default() };
        }
        let position = self.position();
        self.target = Target { position, ..Target::default() };
        self.superposed = Target::default();
        self.brakes_at = self.control.approach.1.value();
        self.positions = (position, position);
        self.gap = 0.0;
        self.error = 0.0;
        (self.sight, self.bridged) = (Sight::Closed, false);
        // what the model of friction remembers is no motion
        self.regained = Some(Regained::AsOrdered);
        self.servo.reset();
    }

    /// Take a reading.
    pub(crate) fn read(&mut self, feedback: &AxisFeedback) {
        let before = core::mem::replace(&mut self.reading, feedback.position.value());
        if let (Some(motor), Some(reading)) = (&mut self.motor, feedback.motor) {
            let bridged = motor.reading + self.reading - before;
            motor.reading = if self.bridged { bridged } else { reading.value() };
        }
        self.bridged = false;
        if let Some(Regained::AsItMoves(speed)) = self.regained {
            self.take_over(speed);
        }
    }

    /// Its readings are usable again; it moves at this speed. True if it goes on from where it is,
    /// not on its setpoint.
    pub(crate) fn regain(&mut self, speed: f64) -> bool {
        let was_free = matches!(self.sight, Sight::Free(_));
        if !self.sight.regain() {
            return false;
        }
        self.regained =
            Some(if was_free { Regained::AsItMoves(speed) } else { Regained::AsOrdered });
        was_free
    }

    /// Take it as it moves, to be braked.
    fn take_over(&mut self, speed: f64) {
        let shares = self.control.feed_forward;
        // a loop that speed is not fed to lags behind its setpoint
        let lag = (1.0 - shares.speed) * speed / self.control.position_gain;
        // what brakes it goes on by a period at once
        let total = self.position() + lag - speed * self.period_s;
        let Target { position, speed: superposed, .. } = self.superposed;
        self.target =
            Target { position: total - position, speed: speed - superposed, ..Target::default() };
        self.positions = (total, total + speed * self.lookahead_s);
        self.gap = 0.0;
        self.error = lag;
        self.servo.take_over(-(1.0 - shares.speed) * speed);
        if let Some(motor) = &mut self.motor {
            let tool_side = self.reading + self.stretch;
            motor.offset = tool_side - motor.reading;
            (motor.apart, motor.cut, motor.error) = (0.0, 0.0, lag);
        }
    }

    /// Where the tool side is: by the scale, or by the motor's encoder and the model of the screw.
    pub(crate) fn position(&self) -> f64 {
        self.reading - self.unseen()
    }

    /// The stretch that lies between tool side and encoder.
    fn unseen(&self) -> f64 {
        match self.control.encoder.place {
            EncoderPlace::Motor => self.stretch,
            EncoderPlace::Scale => 0.0,
        }
    }

    /// Following error of the last period.
    pub(crate) const fn error(&self) -> f64 {
        self.error
    }

    /// Move the setpoint a little without moving the axis: the difference is smoothed away.
    pub(crate) fn rebase(&mut self, position: f64) {
        let jump = self.target.position - position;
        self.gap += jump;
        self.renamed -= jump;
        self.target.position = position;
        self.positions = (self.positions.0 - jump, self.positions.1 - jump);
    }

    /// All places have other names from now on, by so much; nothing moves.
    pub(crate) fn shift(&mut self, by: f64) {
        self.target.position += by;
        (self.renamed, self.shifted) = (self.renamed + by, self.shifted + by);
        self.positions = (self.positions.0 + by, self.positions.1 + by);
        self.reading += by;
        if let Some(motor) = &mut self.motor {
            motor.offset += by;
        }
    }

    /// The force of its drive.
    pub(crate) const fn force(&self) -> f64 {
        self.force
    }

    /// Its drive pushes that way as hard as it may.
    pub(crate) fn is_at_force_limit(&self, sense: f64) -> bool {
        const NEARLY: f64 = 0.99;
        self.force * sense >= NEARLY * self.force_limit.min(self.control.peak_force.value())
    }

    /// What the encoder would read if nothing stretched the screw but the weight: the tool side is
    /// held, and the drive pushes.
    pub(crate) fn pressed(&self) -> f64 {
        let weight = self.control.weight.value();
        self.reading - self.screw.stretch(self.force) + self.screw.stretch(-weight)
    }

    /// Stand still from now on.
    pub(crate) const fn rest(&mut self) {
        self.target.speed = 0.0;
        self.target.accel = 0.0;
        self.target.jerk = 0.0;
    }

    /// Brake towards rest: within the approach acceleration, unless more is needed to stay in its
    /// travel.
    pub(crate) fn brake(&mut self) {
        let before = self.target.speed;
        let most = self.brakes_at.max(self.needed_in_travel()) * self.period_s;
        let speed = before - before.clamp(-most, most);
        self.target.position += self.period_s * (before + speed) / 2.0;
        self.target.accel = (speed - before) / self.period_s;
        self.target.speed = speed;
        self.target.jerk = 0.0;
    }

    /// The deceleration that brings it to rest within its travel, as far as its drive has it.
    fn needed_in_travel(&self) -> f64 {
        let (Some((from, to)), speed) = (self.control.travel, self.target.speed) else {
            return 0.0;
        };
        let end = if speed > 0.0 { to } else { from };
        let room = ((end.value() - self.target.position) * speed.signum()).max(0.0);
        // half a period's way is gone before it acts
        let room = (room - speed.abs() * self.period_s).max(f64::MIN_POSITIVE);
        (speed * speed / (2.0 * room)).min(self.braking())
    }

    /// Force that stretches the screw the other way while friction changes: the motor has to get
    /// ahead of the tool side within milliseconds at a reversal, and it is the heavier part.
    fn stretching(&mut self, friction: f64) -> f64 {
        let (last, before) = self.frictions;
        self.frictions = (friction, last);
        let most = STRETCHING_MOST * self.control.friction.breakaway.value();
        ((friction - 2.0 * last + before) * self.per_friction_change).clamp(-most, most)
    }

    /// The command for this period, with the axis' own feed-forwards or others.
    pub(crate) fn command(&mut self, others: Option<FeedForward>) -> AxisCommand {
        let shares = others.unwrap_or(self.control.feed_forward);
        let now = self.target.with(&self.superposed);
        let ahead = now.ahead(self.lookahead_s);
        let ways = (now.position - self.positions.0, ahead.position - self.positions.1);
        self.positions = (now.position, ahead.position);
        let friction_now = self.friction.0.slide(ways.0, now.speed);
        let friction_ahead = self.friction.1.slide(ways.1, ahead.speed);
        let weight = self.control.weight.value();
        self.stretch = self.screw.stretch(self.table * now.accel + friction_now - weight);
        let stretching = self.stretching(friction_ahead);
        self.gap -= self.gap * (self.period_s / GAP_DECAY_S).min(1.0);
        let setpoint = now.position + self.gap;
        let before = self.motor.as_ref().map_or(self.error, |motor| motor.error);
        self.error = setpoint - self.position();
        let (stretch, scale, period_s) = (self.stretch, self.reading, self.period_s);
        let (error, motor_error) = match &mut self.motor {
            Some(motor) => motor.errors(setpoint, stretch, scale, period_s),
            None => (self.error, self.error),
        };
        let closed = self.sight.is_closed();
        let cut = self.motor.as_ref().filter(|_| closed).map_or(0.0, |motor| motor.cut);
        let feed_forward = shares.accel * self.mass * ahead.accel
            + shares.friction * (friction_ahead + stretching)
            + cut * self.control.stiffness.value()
            - weight;
        let limit = self.control.peak_force.value().min(self.force_limit);
        let regained = self.regained.take();
        self.sight.advance(self.period_s);
        let force = match self.sight {
            Sight::Closed => {
                let way = motor_error - before - (1.0 - shares.speed) * ways.0;
                if regained.is_some() {
                    self.servo.resume();
                }
                let in_position = self.error.abs() <= self.control.windows.in_position.value();
                let rests = ways == (0.0, 0.0) && in_position && self.force_limit.is_infinite();
                let bound = self.unchanged.bound(rests, self.reading, self.force + weight);
                let limits = (
                    (-weight - bound).clamp(-limit, limit),
                    (-weight + bound).clamp(-limit, limit),
                );
                self.servo.update(Input {
                    error,
                    growth: if regained.is_some() { 0.0 } else { way },
                    feed_forward,
                    limits,
                    position: true,
                })
            }
            Sight::Carried(_) => self.servo.blind(feed_forward, limit, now.speed != 0.0),
            Sight::Free(_) => (-weight).clamp(-limit, limit),
            Sight::Off => {
                self.force = 0.0;
                return AxisCommand {
                    position: Coordinate::new(now.position),
                    ..AxisCommand::default()
                };
            }
        };
        self.force = force;
        AxisCommand {
            enable: true,
            position: Coordinate::new(now.position),
            speed: CoordinateSpeed::new(now.speed),
            force: Force::n(force),
        }
    }
}
