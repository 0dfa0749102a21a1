//! A rigid tap: the spindle's two strokes, and the line on which the axis follows it.
use crate::Profile;
use units::{Angle, Axis, Lead, Length, Position, Spin, Time, Torque};

/// A synchronised tap, planned.
///
/// ```text
///   θ │        bottom: dwell
///     │          ┌────┐              z(θ) = start + lead·sense·θ   on the coupling, in and out
///     │        ╱        ╲
///     │     ╱  inward     ╲ outward  profiles: rest to rest, speed S at most, torque within the
///     │──╱                  ╲──      spindle's curve, feed within the axis' limits
///     └──────────────────────────► t
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TapPlan {
    /// The axis that follows the spindle.
    pub axis: Axis,
    /// Which spindle leads.
    pub spindle: u8,
    /// Where the axes stand at the start.
    pub start: Position,
    /// Coordinate of `axis` at the turning point.
    pub bottom: Length,
    /// Coordinate of `axis` down to which it may follow a spindle that coasts because its drive is
    /// gone.
    pub deepest: Length,
    /// Coordinate of `axis` where it ends: the start, or inside the thread where a peck only breaks
    /// the chip and the next one goes on from there.
    pub end: Length,
    /// Coordinate of `axis` where the material begins.
    pub surface: Length,
    /// Axis travel per revolution of the spindle in its own positive sense (M3), so that
    /// `z = start + lead·(θ − θ₀)`: a right-hand tap cutting towards −Z has a *negative* lead here.
    pub lead: Lead,
    /// Signed spindle speed inwards.
    pub spin: Spin,
    /// Signed spindle speed outwards.
    pub return_spin: Spin,
    /// Revolutions (magnitude) from start to bottom over time, rest to rest.
    pub inward: Profile,
    /// Wait at the bottom.
    pub dwell: Time,
    /// Revolutions (magnitude) from bottom back to the end over time, rest to rest.
    pub outward: Profile,
    /// Spindle angle within a turn at the start; `None`: wherever it stands.
    pub start_angle: Option<Angle>,
    /// A spindle whose drive makes its own ramps may, once it is learnt, turn back straight from
    /// its speed: so well does it repeat. No matter for any other.
    pub turns_at_speed: bool,
    /// What kept it from being faster.
    pub limiting: TapLimiting,
    /// Torque of the cut as the tap makers' formula expects it; zero: not known.
    pub torque_expected: Torque,
    /// Torque of the cut from which on the tap is taken out, stated or of its own strength; `None`:
    /// not known.
    pub torque_limit: Option<Torque>,
}

/// What keeps a tap from being faster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TapLimiting {
    /// What bounds the highest speed inwards.
    pub speed: Limiting,
    /// What bounds the run-up inwards for the longest part of its time.
    pub ramp: Limiting,
}

/// A bound on a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Limiting {
    /// The programmed S is reached.
    #[default]
    ProgrammedSpeed,
    /// The spindle's highest speed for tapping.
    TappingMaximum,
    /// The spindle's peak torque.
    SpindleTorque,
    /// The spindle's peak power, above its base speed.
    SpindlePower,
    /// How fast the spindle's torque may rise.
    SpindleJerk,
    /// The feed axis' highest speed.
    FeedSpeed,
    /// The feed axis' acceleration.
    FeedAcceleration,
    /// The feed axis' jerk.
    FeedJerk,
    /// The stroke is too short to reach the programmed S.
    StrokeLength,
    /// The acceleration that was asked for.
    AskedAcceleration,
    /// A ramp that was asked for, whatever the spindle can do.
    Forced,
}

impl Limiting {
    /// For people: what bounded it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ProgrammedSpeed => "programmed speed",
            Self::TappingMaximum => "tapping maximum of the spindle",
            Self::SpindleTorque => "spindle torque",
            Self::SpindlePower => "spindle power",
            Self::SpindleJerk => "rise of the spindle torque",
            Self::FeedSpeed => "feed speed",
            Self::FeedAcceleration => "feed acceleration",
            Self::FeedJerk => "feed jerk",
            Self::StrokeLength => "length of the stroke",
            Self::AskedAcceleration => "acceleration asked for",
            Self::Forced => "forced ramp",
        }
    }
}
