//! What a machine can do, as the planner needs to know it; the machine file fills it in.
//!
//! Rotary axes (A, B, C) use the same [`AxisLimits`], in degrees, as RS-274/NGC does for the feed
//! of a rotary axis.
use alloc::{string::String, vec::Vec};
use canon::{Axis, PathMode};
use motion::{AXES, Bounds, Limits};
use units::{
    Angle, Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Inertia, Lead, Length,
    Power, Spin, SpinAccel, Time, Torque,
};

/// One axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Lowest and highest machine coordinate; `None`: endless, or not checked.
    pub travel: Option<(Coordinate, Coordinate)>,
    /// Highest speed of a rapid.
    pub rapid_speed: CoordinateSpeed,
    /// Highest speed while cutting.
    pub feed_speed: CoordinateSpeed,
    /// Highest acceleration.
    pub accel: CoordinateAccel,
    /// Highest jerk of a rapid; may be infinite.
    pub rapid_jerk: CoordinateJerk,
    /// Highest jerk while cutting; may be infinite.
    pub feed_jerk: CoordinateJerk,
}

impl AxisLimits {
    /// Least share of a limit that moves keep beside what swings: what swings is held to the rest.
    const LEAST_BESIDE: f64 = 0.05;

    /// What is left to moves while the axis swings with at most this speed, acceleration and jerk,
    /// in its own unit and s.
    pub(crate) fn beside(self, [speed, accel, jerk]: [f64; 3]) -> Self {
        let left = |most: f64, taken: f64| (most - taken).max(most * Self::LEAST_BESIDE);
        Self {
            travel: self.travel,
            rapid_speed: CoordinateSpeed::new(left(self.rapid_speed.value(), speed)),
            feed_speed: CoordinateSpeed::new(left(self.feed_speed.value(), speed)),
            accel: CoordinateAccel::new(left(self.accel.value(), accel)),
            rapid_jerk: CoordinateJerk::new(left(self.rapid_jerk.value(), jerk)),
            feed_jerk: CoordinateJerk::new(left(self.feed_jerk.value(), jerk)),
        }
    }
}

/// One spindle with its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleLimits {
    /// Everything that turns.
    pub inertia: Inertia,
    /// Largest torque of the drive.
    pub peak_torque: Torque,
    /// Torque that it can give for ever.
    pub continuous_torque: Torque,
    /// Time in which drive and winding warm.
    pub thermal_time: Time,
    /// Largest power of the drive: above `power / torque` the torque falls as power over speed.
    pub peak_power: Power,
    /// Friction that does not depend on speed.
    pub friction: Torque,
    /// Friction per speed, N·m·s/rad.
    pub viscous_n_m_s_per_rad: f64,
    /// Highest speed.
    pub max_speed: Spin,
    /// Highest speed while tapping.
    pub tapping_max: Spin,
    /// Share of the drive's torque and power that planned motion may use, 0…1; the rest is left to
    /// the control loop. 0.9 as a rule.
    pub margin: f64,
    /// Time in which planned torque may rise from zero to its peak; zero: at once.
    pub torque_rise: Time,
}

/// The tool changer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolChange {
    /// Machine coordinate of Z at which tools are changed; `None`: wherever it stands.
    pub z: Option<Length>,
    /// The same of X.
    pub x: Option<Length>,
    /// The same of Y.
    pub y: Option<Length>,
    /// Pockets of the magazine; 0: not known.
    pub pockets: u32,
    /// How long a change takes, for the estimate of the cycle time.
    pub time: Time,
}

/// How taps are planned on this machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tapping {
    /// The axis along which the spindle holds its tool.
    pub axis: Axis,
    /// What a peck does before the next one.
    pub retract: Retract,
    /// How hard the drives are driven on the way in.
    pub inward: Effort,
    /// The same on the way out.
    pub outward: Effort,
    /// The spindle's drive is only told a speed and makes its own ramps.
    pub own_ramps: Option<OwnRamps>,
    /// When its spindle is left to coast.
    pub coasts: Coasts,
}

/// When a spindle is left to coast, with the feed along with it or hanging on the tap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coasts {
    /// The control falls silent.
    pub on_link_loss: bool,
    /// The mains fail, and no DC bus pays for braking.
    pub on_power_loss: bool,
}

impl Coasts {
    /// Its drive brakes it, whatever happens.
    pub const NEVER: Self = Self { on_link_loss: false, on_power_loss: false };
}

/// A spindle drive that is only told a speed, with what is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnRamps {
    /// From an order until it obeys.
    pub delay: Time,
    /// Of its ramp up.
    pub accel: SpinAccel,
    /// Of its ramp down.
    pub decel: SpinAccel,
    /// Share by which its stopping angle may differ from what delay and deceleration make it.
    pub uncertainty: f64,
    /// How much sooner or later than learnt it may obey: it looks at its input once in a scan.
    pub repeats_delay: Time,
    /// Share by which its ramp may differ from what was learnt.
    pub repeats: f64,
    /// A stroke may turn back straight from its speed if its turning point repeats within this;
    /// else it creeps.
    pub turns_within: Length,
    /// Share of a tap's speed at which strokes creep to their bottom.
    pub creep: f64,
    /// The drive brings the spindle to an angle by itself (M19).
    pub orients: bool,
}

impl OwnRamps {
    /// From an order of another speed until it turns at that.
    pub fn change(&self, from: Spin, to: Spin) -> Time {
        // through rest where the sense changes: the part towards it with one ramp, the part away
        // from it with the other
        let (a, b) = (from.value(), to.value());
        let turns_round = a * b < 0.0;
        let down = if turns_round { a.abs() } else { (a.abs() - b.abs()).max(0.0) };
        let up = if turns_round { b.abs() } else { (b.abs() - a.abs()).max(0.0) };
        self.delay + Time::s(down / self.decel.value() + up / self.accel.value())
    }

    /// From rest over so many turns to rest, turned back straight from a speed: N/n + n/2a + n/2d.
    pub fn stroke(&self, spin: Spin, turns: Angle) -> Time {
        let n = spin.abs().min(self.fastest_within(turns)).value();
        if n <= 0.0 {
            return Time::ZERO;
        }
        let ramps = n / (2.0 * self.accel.value()) + n / (2.0 * self.decel.value());
        self.delay + Time::s(turns.abs().value() / n + ramps)
    }

    /// Turns from an order to rest: n·τ + n²/2a.
    pub fn stopping_angle(&self, spin: Spin) -> Angle {
        let n = spin.value().abs();
        spin.abs() * self.delay + Angle::rev(n * n / (2.0 * self.decel.value()))
    }

    /// By how much the turning point of a tap may be missed, on a coupling of a lead: by the stroke
    /// that creeps for want of knowledge, or by a later one, because nothing repeats exactly.
    pub fn miss(&self, spin: Spin, turns: Angle, lead: Lead) -> Length {
        let creep = spin.min(self.fastest_within(turns)) * self.creep;
        let unknown = (self.stopping_angle(creep) * self.uncertainty) * lead.abs();
        let creeping = self.scatter(creep, 1.0) * lead.abs();
        let straight = self.straight(spin, turns) * lead.abs();
        let known = if straight <= self.turns_within { straight } else { creeping };
        unknown.max(known)
    }

    /// Once it is learnt, a stroke may turn back straight from its speed.
    pub fn turns_at_speed(&self, spin: Spin, turns: Angle, lead: Lead) -> bool {
        self.straight(spin, turns) * lead.abs() <= self.turns_within
    }

    /// Scatter of a turn straight from the speed. In a stroke too short for its speed the spindle
    /// still gains some when it is told, and goes on so until it obeys: then what is late counts
    /// 1 + a/d times.
    fn straight(&self, spin: Spin, turns: Angle) -> Angle {
        let fastest = self.fastest_within(turns);
        if spin < fastest {
            return self.scatter(spin, 1.0);
        }
        self.scatter(fastest, 1.0 + self.accel / self.decel)
    }

    /// By how much a turning point differs from stroke to stroke, told at a speed: n·δ + ρ·n²/2d.
    fn scatter(&self, spin: Spin, late: f64) -> Angle {
        let n = spin.value().abs();
        let ramp = Angle::rev(n * n / (2.0 * self.decel.value()));
        spin.abs() * (self.repeats_delay * late) + ramp * self.repeats
    }

    /// The fastest that such a spindle gets in a stroke of so many turns: n²/2a + n²/2d = N.
    pub fn fastest_within(&self, turns: Angle) -> Spin {
        let (a, d) = (self.accel.value(), self.decel.value());
        Spin::rev_per_s(libm::sqrt(2.0 * turns.value().abs() * a * d / (a + d)))
    }
}

/// What a peck does before the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Retract {
    /// Comes out to the start, and enters again on the same helix: the chips come out with it.
    Full,
    /// Turns back by so much of the axis' way: the chip breaks.
    By(Length),
}

/// How hard the drives are driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Share of the spindle drive's torque and power that planned motion may use, 0…1.
    pub margin: f64,
    /// Factor on how fast torque and acceleration may rise.
    pub jerk: f64,
}

impl Tapping {
    /// Along Z, out and in again for each peck, with this share of torque and power both ways.
    pub const fn along_z(margin: f64) -> Self {
        let effort = Effort { margin, jerk: 1.0 };
        let (inward, outward) = (effort, effort);
        Self {
            axis: Axis::Z,
            retract: Retract::Full,
            inward,
            outward,
            own_ramps: None,
            coasts: Coasts::NEVER,
        }
    }
}

impl Effort {
    /// Limits of axis and spindle when driven like this.
    pub(crate) fn of(
        self,
        axis: &AxisLimits,
        spindle: &SpindleLimits,
    ) -> (AxisLimits, SpindleLimits) {
        let axis = AxisLimits { feed_jerk: axis.feed_jerk * self.jerk, ..*axis };
        let torque_rise = spindle.torque_rise / self.jerk;
        (axis, SpindleLimits { margin: self.margin, torque_rise, ..*spindle })
    }
}

/// The whole machine.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineLimits {
    /// By axis, X first; `None`: the machine has no such axis.
    pub axes: [Option<AxisLimits>; 9],
    /// By spindle.
    pub spindles: Vec<SpindleLimits>,
    /// The tool changer.
    pub tool_change: ToolChange,
    /// Time that waiting for "in position" takes as a rule, for the estimate of the cycle time.
    pub settling: Time,
    /// How taps are planned.
    pub tapping: Tapping,
    /// How moves go on into one another.
    pub joining: Joining,
    /// What signals it has; `None`: they are not checked.
    pub signals: Option<SignalNames>,
}

/// The signals of a machine, each with its name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SignalNames {
    /// Digital and analogue inputs.
    pub inputs: [Vec<(u8, String)>; 2],
    /// Digital and analogue outputs.
    pub outputs: [Vec<(u8, String)>; 2],
    /// A probe can be plugged in.
    pub probe: bool,
}

impl MachineLimits {
    /// What the axes can do, by a time of which `n` units pass in a second: revolutions, for a feed
    /// per revolution. Speed over n, acceleration over n², jerk over n³.
    pub fn motion(&self, n: f64) -> Limits {
        let none = [f64::INFINITY; AXES];
        let bounds = |of: fn(&AxisLimits) -> (f64, f64)| {
            let mut bounds = Bounds { speed: none, accel: none, jerk: none };
            for (index, axis) in self.axes.iter().enumerate() {
                let Some(axis) = axis else { continue };
                let (speed, jerk) = of(axis);
                bounds.speed[index] = speed / n;
                bounds.accel[index] = axis.accel.value() / (n * n);
                bounds.jerk[index] = jerk / (n * n * n);
            }
            bounds
        };
        Limits {
            feed: bounds(|axis| (axis.feed_speed.value(), axis.feed_jerk.value())),
            rapid: bounds(|axis| (axis.rapid_speed.value(), axis.rapid_jerk.value())),
        }
    }
}

/// How moves go on into one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joining {
    /// Servo period: where the bend of the path jumps, acceleration may change within one.
    pub period: Time,
    /// How far the path may be from the programmed one where G64 has no P.
    pub tolerance: Length,
    /// What holds before the program has said G61, G61.1 or G64.
    pub mode: PathMode,
}

impl Joining {
    /// Exactly along the path until the program says otherwise; P is 0.01 mm where it is not
    /// stated.
    pub const EXACT: Self =
        Self { period: Time::s(250e-6), tolerance: Length::mm(0.01), mode: PathMode::Exact };
}

/// What the user chooses for one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Tap with a straight ramp from rest to the programmed speed in this time, whatever the
    /// spindle can do: to show what becomes of the synchronism when the drive saturates.
    pub force_ramp: Option<Time>,
    /// Specific cutting force of the work's material, N/mm²: 3900 for C45, 1300 for `AlSi`.
    pub cutting_pressure_n_per_mm2: f64,
    /// What becomes of taps that are not tied to the spindle.
    pub taps: Unsynchronised,
}

/// How taps are driven that are not tied to the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unsynchronised {
    /// Whether the feed is tied to the spindle. A tap in a clutch holder has its own cycle either
    /// way.
    pub method: TapMethod,
    /// What becomes of a dwell with which a clutch holder does not work.
    pub dwell: DwellCheck,
    /// A spindle whose drive makes its own ramps, as measured; `None`: planned ramps.
    pub drive: Option<PlainDrive>,
}

/// Whether the feed of a tap is tied to the spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TapMethod {
    /// The feed follows the spindle.
    #[default]
    Synchronised,
    /// Both only run at their speeds, and a tension/compression holder takes the difference.
    Floating,
}

/// What becomes of a dwell outside a clutch holder's window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DwellCheck {
    /// Refused, with the dwell that would work.
    #[default]
    Refuse,
    /// Said, and done.
    Warn,
}

/// A spindle drive that is only told a speed: a relay, and a ramp of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainDrive {
    /// From an order until the drive obeys.
    pub delay: Time,
    /// Of its ramp.
    pub accel: SpinAccel,
}
