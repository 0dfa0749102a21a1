//! What the kernel is told once, before the first tick: loops, limits, windows and waits.
//!
//! Plain data. The machine file fills it; [`Config::problems`] finds what cannot be meant, all at
//! once.
use bus::{AXES, SPINDLES};
use sync::{SyncMode, Windows};
use units::{Angle, Force, Inertia, Mass, Power, Spin, SpinAccel, Stiffness, Time, Torque};
use units::{Axis, Coordinate, CoordinateAccel, CoordinateSpeed};

/// Everything the kernel knows of a machine.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// Servo period.
    pub period: Time,
    /// From the moment encoders are read to the moment the command takes effect, without the
    /// drives' own lags. Feed-forwards are given that much earlier.
    pub command_delay: Time,
    /// By axis, X first.
    pub axes: [Option<AxisControl>; AXES],
    /// By spindle.
    pub spindles: [Option<SpindleControl>; SPINDLES],
    /// Which master a tapping axis obeys.
    pub synchronisation: SyncMode,
    /// Limits of the sync error in the material.
    pub sync_windows: Windows,
    /// How long each wait may last.
    pub waits: Waits,
    /// What the axes can do: overrides and holds keep it, as the plan does.
    pub motion: motion::Limits,
    /// What is done when a geared spindle loses its phase; `None`: everything stops at once.
    pub phase_loss: Option<PhaseLoss>,
    /// How far the operator may override.
    pub overrides: crate::Overrides,
    /// What a program's stop does.
    pub pause: Pause,
    /// Contact of the probe is an alarm in moves that are no probing, and in those by hand.
    pub probe_guard: bool,
    /// Repeated taps learn from one another; `None`: they do not.
    pub learning: Option<sync::Learning>,
    /// Errors of screws and encoders that are taken off.
    pub compensation: crate::DeviationTables,
    /// Taps are supervised by measured torque; `None`: they are not.
    pub supervision: Option<SupervisionControl>,
}

/// How taps are supervised.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SupervisionControl {
    /// How the drive of each spindle reads its torque; `None`: it does not.
    pub readings: [Option<TorqueReading>; SPINDLES],
    /// By this share a good hole may be off the mean of the good ones.
    pub share: f64,
    /// What an overload does.
    pub reaction: OverloadReaction,
}

/// What a torque beyond its bounds does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OverloadReaction {
    /// An alarm; the tap comes out along its thread.
    Retract,
    /// An alarm; the tap stays in its thread.
    Stop,
    /// Nothing: what is seen is said when the hole is done.
    Report,
}

/// How a drive reads its torque.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TorqueReading {
    /// From what it gives to what it says.
    pub delay: Time,
    /// Standard deviation of its noise.
    pub noise: Torque,
}

/// Longest duration of each wait; beyond it is an alarm.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// A geared spindle off its gear spoils the work with every pass: the tool leaves it first, then
/// everything stops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PhaseLoss {
    /// So far off is lost.
    pub window: Angle,
    /// The axis that takes the tool off the work.
    pub axis: Axis,
    /// How far, signed.
    pub by: Coordinate,
    /// How fast, and how fast that changes.
    pub most: (CoordinateSpeed, CoordinateAccel),
}

/// What a program's stop (M0, M1) does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Pause {
    /// Wait for [`crate::Kernel::resume`]; optional stops too if [`crate::Order::OptionalStop`] has
    /// been given.
    Wait,
    /// Go on at once: no person is there, as in a simulation.
    GoOn,
}

/// Shares of the feed-forwards, 1 for full.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisFriction {
    /// Force of sliding.
    pub coulomb: Force,
    /// Force of breaking away.
    pub breakaway: Force,
    /// Speed at which the one has become the other.
    pub stribeck: CoordinateSpeed,
    /// Stiffness of the contact before it slides.
    pub bristle_stiffness: Stiffness,
    /// Damping of the contact before it slides, N·s/m.
    pub bristle_damping_n_s_per_m: f64,
    /// Viscous part, N·s/m.
    pub viscous_n_s_per_m: f64,
}

/// What is watched on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisWindows {
    /// The axis is in position within this.
    pub in_position: Coordinate,
    /// And has been for this long.
    pub settle: Time,
    /// A following error worth an event.
    pub following_warn: Coordinate,
    /// A following error that stops the machine.
    pub following_stop: Coordinate,
}

/// Where an axis is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EncoderPlace {
    /// On the motor.
    Motor,
    /// On the tool side: a linear scale.
    Scale,
}

/// What the position of an axis is read from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisEncoder {
    /// Where it sits.
    pub place: EncoderPlace,
    /// One count, as travel of the axis.
    pub count: Coordinate,
    /// Beside a scale: one count of the encoder that the motor has itself.
    pub motor_count: Option<Coordinate>,
}

/// One axis, linear or rotary.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Constant force along the axis that the drive has to bear: negative if it pulls towards
    /// minus.
    pub weight: Force,
    /// Friction of the guideway.
    pub friction: AxisFriction,
    /// Axial stiffness between motor and tool side: a motor encoder sees neither the stretch of the
    /// screw …
    pub stiffness: Stiffness,
    /// … nor its play.
    pub backlash: Coordinate,
    /// What the position is read from.
    pub encoder: AxisEncoder,
    /// Most force the drive can give.
    pub peak_force: Force,
    /// Time constant of the drive's current loop.
    pub force_lag: Time,
    /// Limits of small moves and of stops that were not planned.
    pub approach: (CoordinateSpeed, CoordinateAccel),
    /// The ends of its travel, once it is homed; `None`: it has none.
    pub travel: Option<(Coordinate, Coordinate)>,
    /// What is watched.
    pub windows: AxisWindows,
}

/// Friction of a spindle: c₀·tanh(ω/ω₀) + c₁·ω.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SpindleWindows {
    /// At speed within this share of the ordered speed.
    pub at_speed: f64,
    /// In a cut within this share of the ordered speed: by how much a load may pull it down, or
    /// drive it.
    pub in_cut: f64,
    /// At rest below this speed.
    pub at_rest: Spin,
    /// Oriented within this angle.
    pub oriented: units::Angle,
    /// A following error under position control that stops the machine.
    pub following_stop: units::Angle,
}

/// A spindle drive that is only told a speed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OwnRamps {
    /// From an order until it obeys.
    pub delay: Time,
    /// Its acceleration and its deceleration, as far as they are known.
    pub accel: SpinAccel,
    /// See `accel`.
    pub decel: SpinAccel,
    /// Share by which its stopping angle may be longer.
    pub uncertainty: f64,
    /// How much later than learnt it may obey, and by what share its ramp may be longer than
    /// learnt.
    pub repeats: (Time, f64),
    /// Share of a tap's speed from which that does not matter.
    pub creep: f64,
}

/// What the check of a spindle's encoder looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EncoderCheckControl {
    /// It has an index mark.
    pub index: bool,
}

/// One spindle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Fastest speed.
    pub highest: Spin,
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
    /// The drive is only told a speed and makes its own ramps; `None`: it is told a torque, or an
    /// angle.
    pub own_ramps: Option<OwnRamps>,
    /// The drive closes its own position loop and is told an angle, also while the spindle only
    /// turns.
    pub closes_position: bool,
    /// A drive with ramps of its own that brings the spindle to an angle by itself.
    pub orients: bool,
    /// Its drive follows the speed that is ordered: what turns otherwise is an alarm.
    pub follows_orders: bool,
    /// Its encoder is checked by a slow turn before the spindle is used; `None`: it is not.
    pub encoder_check: Option<EncoderCheckControl>,
    /// What is watched.
    pub windows: SpindleWindows,
}

/// What a problem or a fault is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Subject {
    /// The machine as a whole.
    Machine,
    /// One axis.
    Axis(Axis),
    /// One spindle, counted from 0.
    Spindle(u8),
    /// One digital input.
    Input(u8),
}

impl core::fmt::Display for Subject {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Machine => f.write_str("machine"),
            Self::Axis(axis) => write!(f, "axis {}", axis.letter()),
            Self::Spindle(index) => write!(f, "spindle {index}"),
            Self::Input(number) => write!(f, "input {number}"),
        }
    }
}
