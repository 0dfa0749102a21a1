//! What the kernel is told once, before the first tick: loops, limits, windows and waits.
//!
//! Plain data. The machine file fills it; [`Config::problems`] finds what cannot be meant, all at once.
use bus::{AXES, SPINDLES};
use canon::Axis;
use sync::{MAX_TRANSPORT, SyncMode, Windows};
use units::{
    Accel, Force, Inertia, Length, Mass, Power, Speed, Spin, SpinAccel, Stiffness, Time, Torque,
};

/// Everything the kernel knows of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Servo period.
    pub period: Time,
    /// From the moment encoders are read to the moment the command takes effect, without the drives'
    /// own lags. Feed-forwards are given that much earlier.
    pub command_delay: Time,
    /// By axis, X first. Rotary axes are held where they stand.
    pub axes: [Option<AxisControl>; AXES],
    /// By spindle.
    pub spindles: [Option<SpindleControl>; SPINDLES],
    /// Which master a tapping axis obeys.
    pub synchronisation: SyncMode,
    /// Limits of the sync error in the material.
    pub sync_windows: Windows,
    /// How long each wait may last.
    pub waits: Waits,
    /// What a program's stop does.
    pub pause: Pause,
}

/// Longest duration of each wait; beyond it is an alarm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waits {
    /// Drives to come up after the start.
    pub ready: Time,
    /// Spindle to reach its ordered speed, or to stand.
    pub at_speed: Time,
    /// Spindle to be held at an angle.
    pub oriented: Time,
    /// Axes to be in position.
    pub in_position: Time,
    /// The tool changer.
    pub tool_change: Time,
}

/// What a program's stop (M0, M1) does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pause {
    /// Wait for [`crate::Kernel::resume`]; optional stops too if `optional_stop` is set.
    Wait {
        /// M1 counts.
        optional_stop: bool,
    },
    /// Go on at once: nobody is there, as in a simulation.
    GoOn,
}

/// Shares of the feed-forwards, 1 for full.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedForward {
    /// Of the setpoint's speed.
    pub speed: f64,
    /// Of the setpoint's acceleration.
    pub accel: f64,
    /// Of the modelled friction.
    pub friction: f64,
}

impl FeedForward {
    /// All of it.
    pub const FULL: Self = Self { speed: 1.0, accel: 1.0, friction: 1.0 };
    /// None of it.
    pub const NONE: Self = Self { speed: 0.0, accel: 0.0, friction: 0.0 };
}

/// Friction of a guideway, as the feed-forward models it (LuGre).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFriction {
    /// Force of sliding.
    pub coulomb: Force,
    /// Force of breaking away.
    pub breakaway: Force,
    /// Speed at which the one has become the other.
    pub stribeck: Speed,
    /// Stiffness of the contact before it slides.
    pub bristle_stiffness: Stiffness,
    /// Damping of the contact before it slides, N·s/m.
    pub bristle_damping_n_s_per_m: f64,
    /// Viscous part, N·s/m.
    pub viscous_n_s_per_m: f64,
}

/// What is watched on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisWindows {
    /// The axis is in position within this.
    pub in_position: Length,
    /// And has been for this long.
    pub settle: Time,
    /// A following error worth an event.
    pub following_warn: Length,
    /// A following error that stops the machine.
    pub following_stop: Length,
}

/// Where an axis is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EncoderPlace {
    /// On the motor.
    Motor,
    /// On the tool side: a linear scale.
    Scale,
}

/// What the position of an axis is read from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisEncoder {
    /// Where it sits.
    pub place: EncoderPlace,
    /// One count, as travel of the axis.
    pub count: Length,
}

/// One linear axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisControl {
    /// Kp of the position loop, 1/s.
    pub position_gain: f64,
    /// Bandwidth of the speed loop, Hz.
    pub velocity_bandwidth_hz: f64,
    /// Feed-forwards.
    pub feed_forward: FeedForward,
    /// Motor and screw, as a mass on the table's scale.
    pub motor_mass: Mass,
    /// What moves along the guideway.
    pub table_mass: Mass,
    /// Constant force along the axis that the drive has to bear: negative if it pulls towards minus.
    pub weight: Force,
    /// Friction of the guideway.
    pub friction: AxisFriction,
    /// Axial stiffness between motor and tool side: a motor encoder sees neither the stretch of the
    /// screw …
    pub stiffness: Stiffness,
    /// … nor its play.
    pub backlash: Length,
    /// What the position is read from.
    pub encoder: AxisEncoder,
    /// Most force the drive can give.
    pub peak_force: Force,
    /// Time constant of the drive's current loop.
    pub force_lag: Time,
    /// Limits of small moves and of stops that nobody planned.
    pub gentle: (Speed, Accel),
    /// What is watched.
    pub windows: AxisWindows,
}

/// Friction of a spindle: c₀·tanh(ω/ω₀) + c₁·ω.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleFriction {
    /// Constant part c₀.
    pub coulomb: Torque,
    /// Speed ω₀ over which it changes its sign.
    pub rounding: Spin,
    /// Viscous part c₁, N·m·s/rad.
    pub viscous_n_m_s_per_rad: f64,
}

/// What is watched on a spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleWindows {
    /// At speed within this share of the ordered speed.
    pub at_speed: f64,
    /// At rest below this speed.
    pub at_rest: Spin,
    /// Oriented within this angle.
    pub oriented: units::Angle,
    /// A following error under position control that stops the machine.
    pub following_stop: units::Angle,
}

/// One spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleControl {
    /// Kp of the position loop, 1/s.
    pub position_gain: f64,
    /// Bandwidth of the speed loop, Hz.
    pub velocity_bandwidth_hz: f64,
    /// Feed-forwards.
    pub feed_forward: FeedForward,
    /// With tool and holder.
    pub inertia: Inertia,
    /// Friction of the bearings.
    pub friction: SpindleFriction,
    /// Most torque the drive can give.
    pub peak_torque: Torque,
    /// Most power the drive can give.
    pub peak_power: Power,
    /// Time constant of the drive's current loop.
    pub torque_lag: Time,
    /// One count of the encoder.
    pub encoder_count: units::Angle,
    /// Bandwidth of the observer of its motion, Hz.
    pub observer_bandwidth_hz: f64,
    /// Limits of turning to an angle.
    pub orient: (Spin, SpinAccel),
    /// What is watched.
    pub windows: SpindleWindows,
}

/// Something in a [`Config`] that cannot be meant: the field, what it is, and what it must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// Which axis or spindle, if it is one of theirs.
    pub of: Subject,
    /// The field.
    pub field: &'static str,
    /// Its value, in the base unit.
    pub value: f64,
    /// What it must be.
    pub must_be: &'static str,
}

/// What a problem or a fault is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// The machine as a whole.
    Machine,
    /// One axis.
    Axis(Axis),
    /// One spindle, counted from 0.
    Spindle(u8),
}

impl core::fmt::Display for Subject {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Machine => f.write_str("machine"),
            Self::Axis(axis) => write!(f, "axis {}", axis.letter()),
            Self::Spindle(index) => write!(f, "spindle {index}"),
        }
    }
}

impl core::fmt::Display for Problem {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}: {} is {}, expected {}", self.of, self.field, self.value, self.must_be)
    }
}

const POSITIVE: &str = "a finite number above zero";
const NOT_NEGATIVE: &str = "a finite number, zero or more";
const SLOWER_THAN_SAMPLING: &str = "above zero and below a tenth of the servo rate";
const SHARE: &str = "between 0 and 1.5";

impl Config {
    /// Report all that cannot be meant.
    pub fn problems(&self, mut report: impl FnMut(Problem)) {
        let rate_hz = 1.0 / self.period.value();
        let mut machine = |field, value: f64, good: bool, must_be| {
            if !good {
                report(Problem { of: Subject::Machine, field, value, must_be });
            }
        };
        machine("period", self.period.value(), positive(self.period.value()), POSITIVE);
        let delay = self.command_delay.value();
        machine("command_delay", delay, not_negative(delay), NOT_NEGATIVE);
        for (field, value) in [
            ("sync_windows.warn", self.sync_windows.warn.value()),
            ("sync_windows.stop", self.sync_windows.stop.value()),
            ("waits.ready", self.waits.ready.value()),
            ("waits.at_speed", self.waits.at_speed.value()),
            ("waits.oriented", self.waits.oriented.value()),
            ("waits.in_position", self.waits.in_position.value()),
            ("waits.tool_change", self.waits.tool_change.value()),
        ] {
            machine(field, value, positive(value), POSITIVE);
        }
        if let SyncMode::EncoderFollowing { transport, .. } = self.synchronisation {
            let good = transport <= MAX_TRANSPORT;
            machine("transport", f64::from(transport), good, "4 periods at most");
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let Some(axis) = axis else { continue };
            let of = Subject::Axis(Axis::ALL[index]);
            axis.fields(rate_hz, |field, value, good, must_be| {
                if !good {
                    report(Problem { of, field, value, must_be });
                }
            });
        }
        for (index, spindle) in self.spindles.iter().enumerate() {
            let Some(spindle) = spindle else { continue };
            let of = Subject::Spindle(index as u8);
            spindle.fields(rate_hz, |field, value, good, must_be| {
                if !good {
                    report(Problem { of, field, value, must_be });
                }
            });
        }
    }
}

fn positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

fn not_negative(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

fn share(value: f64) -> bool {
    (0.0..=1.5).contains(&value)
}

type Check<'a> = &'a mut dyn FnMut(&'static str, f64, bool, &'static str);

impl FeedForward {
    fn fields(&self, check: Check) {
        check("feed_forward.speed", self.speed, share(self.speed), SHARE);
        check("feed_forward.accel", self.accel, share(self.accel), SHARE);
        check("feed_forward.friction", self.friction, share(self.friction), SHARE);
    }
}

impl AxisControl {
    fn fields(&self, rate_hz: f64, mut check: impl FnMut(&'static str, f64, bool, &'static str)) {
        let band = self.velocity_bandwidth_hz;
        check(
            "velocity_bandwidth_hz",
            band,
            positive(band) && band < rate_hz / 10.0,
            SLOWER_THAN_SAMPLING,
        );
        self.feed_forward.fields(&mut check);
        for (field, value) in [
            ("position_gain", self.position_gain),
            ("table_mass", self.table_mass.value()),
            ("friction.bristle_stiffness", self.friction.bristle_stiffness.value()),
            ("friction.stribeck", self.friction.stribeck.value()),
            ("stiffness", self.stiffness.value()),
            ("encoder.count", self.encoder.count.value()),
            ("peak_force", self.peak_force.value()),
            ("gentle speed", self.gentle.0.value()),
            ("gentle acceleration", self.gentle.1.value()),
            ("windows.in_position", self.windows.in_position.value()),
            ("windows.following_warn", self.windows.following_warn.value()),
            ("windows.following_stop", self.windows.following_stop.value()),
        ] {
            check(field, value, positive(value), POSITIVE);
        }
        for (field, value) in [
            ("motor_mass", self.motor_mass.value()),
            ("friction.coulomb", self.friction.coulomb.value()),
            ("friction.breakaway", self.friction.breakaway.value()),
            ("friction.bristle_damping", self.friction.bristle_damping_n_s_per_m),
            ("friction.viscous", self.friction.viscous_n_s_per_m),
            ("backlash", self.backlash.value()),
            ("force_lag", self.force_lag.value()),
            ("windows.settle", self.windows.settle.value()),
        ] {
            check(field, value, not_negative(value), NOT_NEGATIVE);
        }
        let weight = self.weight.value();
        check("weight", weight, weight.is_finite(), "a finite number");
    }
}

impl SpindleControl {
    fn fields(&self, rate_hz: f64, mut check: impl FnMut(&'static str, f64, bool, &'static str)) {
        for (field, band) in [
            ("velocity_bandwidth_hz", self.velocity_bandwidth_hz),
            ("observer_bandwidth_hz", self.observer_bandwidth_hz),
        ] {
            check(field, band, positive(band) && band < rate_hz / 10.0, SLOWER_THAN_SAMPLING);
        }
        self.feed_forward.fields(&mut check);
        for (field, value) in [
            ("position_gain", self.position_gain),
            ("inertia", self.inertia.value()),
            ("friction.rounding", self.friction.rounding.value()),
            ("peak_torque", self.peak_torque.value()),
            ("peak_power", self.peak_power.value()),
            ("encoder_count", self.encoder_count.value()),
            ("orient speed", self.orient.0.value()),
            ("orient acceleration", self.orient.1.value()),
            ("windows.at_speed", self.windows.at_speed),
            ("windows.at_rest", self.windows.at_rest.value()),
            ("windows.oriented", self.windows.oriented.value()),
            ("windows.following_stop", self.windows.following_stop.value()),
        ] {
            check(field, value, positive(value), POSITIVE);
        }
        for (field, value) in [
            ("friction.coulomb", self.friction.coulomb.value()),
            ("friction.viscous", self.friction.viscous_n_m_s_per_rad),
            ("torque_lag", self.torque_lag.value()),
        ] {
            check(field, value, not_negative(value), NOT_NEGATIVE);
        }
    }
}
