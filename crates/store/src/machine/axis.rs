//! One axis: where it may go, what drives it, what it is made of, how it is controlled.
//!
//! ```text
//!            lead               stiffness k, damping ζ, backlash
//!   motor ─ screw ─── mm ───────/\/\/\──┤├─────── mt ── table, ram
//!   torque, inertia                               friction (LuGre), weight, process
//!
//!   mm = (Jm + Jscrew)·(2π/lead)²        largest force = torque·2π/lead        [kg] [N]
//! ```
//!
//! LuGre friction: dz/dt = v − σ0·|v|·z/g(v), F = σ0·z + σ1·ż + σ2·v, g = Fc + (Fs −
//! Fc)·exp(−(v/vs)²); Canudas de Wit, Olsson, Åström, Lischinsky, IEEE Trans. Automatic Control 40
//! (1995) 419–425.
use super::axis_drive::{Drive, Motor};
use super::deviations::StatedDeviations;
use super::ethercat::DriveSlot;
use super::homing::{Ends, Homing, Of};
use super::plant::AxisErrors;
use super::setup::percent;
use crate::keys::Keys;
use units::{
    Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Force, Lead, Length, Mass,
    Stiffness, Time,
};

/// Standard gravity (CGPM 1901).
const GRAVITY_M_PER_S2: f64 = 9.806_65;
/// Farthest from zero that any coordinate may be, mm.
pub(super) const FARTHEST_MM: f64 = 100_000.0;

/// One axis, linear or rotary; its drive and what it moves are those of a linear one, as in
/// `machine/rotary.rs`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Which.
    pub letter: canon::Axis,
    /// Where it may go.
    pub travel: Travel,
    /// Speed of rapid moves.
    pub rapid: CoordinateSpeed,
    /// Fastest feed.
    pub feed_most: CoordinateSpeed,
    /// Largest acceleration; infinite: what the drive gives.
    pub acceleration: CoordinateAccel,
    /// Largest jerk on feeds; may be infinite.
    pub jerk_feed: CoordinateJerk,
    /// Largest jerk on rapids; may be infinite.
    pub jerk_rapid: CoordinateJerk,
    /// Limits of motion that is not planned.
    pub approach: Approach,
    /// What it moves: table, column or ram.
    pub moving_mass: Mass,
    /// Share of its weight that the drive must hold: 0 for a horizontal or fully balanced axis.
    pub weight_share: f64,
    /// What drives it.
    pub drive: Drive,
    /// What lies between motor and mass.
    pub structure: Structure,
    /// What holds it back.
    pub friction: Friction,
    /// What tells its position.
    pub position_from: PositionFrom,
    /// How it is controlled.
    pub loops: Loops,
    /// What it is watched for.
    pub windows: AxisWindows,
    /// How it finds out where it is.
    pub homing: Homing,
    /// What stands at the ends of its travel.
    pub ends: Option<Ends>,
    /// Errors of screw and encoder that were measured and are compensated; `None`: none are.
    pub compensation: Option<StatedDeviations>,
    /// What is wrong with it that its control is not told.
    pub errors: AxisErrors,
    /// Its drive on an EtherCAT network; `None`: it is on none.
    pub ethercat: Option<DriveSlot>,
}

/// Limits of small moves and of stops that are not planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Speed.
    pub speed: CoordinateSpeed,
    /// Acceleration.
    pub acceleration: CoordinateAccel,
}

/// Where an axis may go, in machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// Negative end.
    pub from: Coordinate,
    /// Positive end.
    pub to: Coordinate,
}

/// What lies between motor and mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Structure {
    /// Axial stiffness of screw, nut and bearings.
    pub stiffness: Stiffness,
    /// Damping ratio of the axial mode.
    pub damping_ratio: f64,
    /// Lost motion.
    pub backlash: Coordinate,
}

/// LuGre friction of the guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// σ0, stiffness of the bristles.
    pub bristle_stiffness: Stiffness,
    /// σ1, damping of the bristles.
    pub bristle_damping_n_s_per_m: f64,
    /// σ2, viscous friction.
    pub viscous_n_s_per_m: f64,
    /// Fc.
    pub coulomb: Force,
    /// Fs, break-away force.
    pub static_force: Force,
    /// vs, where friction has fallen from Fs most of the way to Fc.
    pub stribeck_speed: CoordinateSpeed,
}

/// What tells an axis' position, and in what steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionFrom {
    /// The motor's encoder; the structure's deflection is not seen.
    Motor {
        /// Counts per revolution of the motor.
        counts_per_rev: u32,
        /// One count, at the table.
        resolution: Coordinate,
    },
    /// A linear scale at the table.
    Scale {
        /// One count.
        resolution: Coordinate,
        /// The motor's own encoder beside it: counts per revolution, and one count at the table.
        motor: Option<(u32, Coordinate)>,
    },
}

/// Cascade of position and velocity loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loops {
    /// Position gain Kp, 1/s.
    pub position_gain_per_s: f64,
    /// Bandwidth of the velocity loop.
    pub velocity_bandwidth_hz: f64,
    /// Velocity feed-forward; 1 is full.
    pub velocity_feed_forward_share: f64,
    /// Acceleration feed-forward; 1 is full.
    pub acceleration_feed_forward_share: f64,
    /// Friction feed-forward; 1 is full.
    pub friction_feed_forward_share: f64,
}

/// What an axis is watched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisWindows {
    /// In position: this near to the command …
    pub in_position: Coordinate,
    /// … for this long.
    pub settle: Time,
    /// Following error that is reported.
    pub following_error_warn: Coordinate,
    /// Following error that stops the machine.
    pub following_error_stop: Coordinate,
}

impl Travel {
    /// Whether a coordinate lies within.
    pub fn contains(&self, at: Coordinate) -> bool {
        (self.from..=self.to).contains(&at)
    }

    fn read(keys: &mut Keys<'_>) -> Self {
        let mut end = |key| Coordinate::new(keys.number(key, -FARTHEST_MM..=FARTHEST_MM));
        let travel = Self { from: end("travel_from_mm"), to: end("travel_to_mm") };
        if keys.has("travel_from_mm") && travel.from >= travel.to {
            keys.conflict(
                "travel_from_mm",
                format!(
                    "`travel_from_mm` {} is not below `travel_to_mm` {}",
                    travel.from.value(),
                    travel.to.value()
                ),
            );
        }
        travel
    }
}

impl Axis {
    pub(super) fn read(letter: canon::Axis, keys: &mut Keys<'_>) -> Self {
        const MM_PER_M: f64 = 1e3;
        let drive = keys.section("drive", Drive::read);
        let travel = Travel::read(keys);
        let approach = Approach {
            speed: CoordinateSpeed::per_min(keys.renamed(
                "approach_mm_per_min",
                "gentle_mm_per_min",
                1.0..=1e6,
            )),
            acceleration: CoordinateAccel::new(
                keys.renamed("approach_m_per_s2", "gentle_m_per_s2", 1e-3..=500.0) * MM_PER_M,
            ),
        };
        let axis = Self {
            letter,
            travel,
            rapid: CoordinateSpeed::per_min(keys.number("rapid_mm_per_min", 1.0..=1e6)),
            feed_most: CoordinateSpeed::per_min(keys.number("feed_most_mm_per_min", 1.0..=1e6)),
            acceleration: CoordinateAccel::new(
                keys.limit("acceleration_m_per_s2", 1e-3..=500.0) * MM_PER_M,
            ),
            jerk_feed: CoordinateJerk::new(keys.limit("jerk_feed_m_per_s3", 0.01..=1e6) * MM_PER_M),
            jerk_rapid: CoordinateJerk::new(
                keys.limit("jerk_rapid_m_per_s3", 0.01..=1e6) * MM_PER_M,
            ),
            approach,
            moving_mass: Mass::kg(keys.number("moving_mass_kg", 0.01..=100_000.0)),
            weight_share: percent(keys, "weight_percent", 0.0..=100.0),
            structure: keys.section("structure", Structure::read),
            friction: keys.section("friction", Friction::read),
            position_from: keys.section("encoder", |k| PositionFrom::read(&drive.motor, k)),
            drive,
            loops: keys.section("loops", Loops::read),
            windows: keys.section("windows", AxisWindows::read),
            homing: Homing::UNREAD,
            ends: Ends::read(letter, &travel, keys),
            compensation: None,
            errors: keys.optional_section("errors", AxisErrors::read).unwrap_or_default(),
            ethercat: keys.optional_section("ethercat", DriveSlot::read),
        };
        axis.with_homing(keys)
    }

    /// The axis with what its file says of homing, which has to do with all the rest of it.
    pub(super) fn with_homing(self, keys: &mut Keys<'_>) -> Self {
        let lead = match self.drive.motor {
            Motor::BallScrew { lead, .. } => Some(Coordinate::new(lead.value())),
            Motor::Linear { .. } => None,
        };
        let weight = self.weight_share * self.moving_mass.value() * GRAVITY_M_PER_S2;
        let of = Of {
            letter: self.letter,
            travel: &self.travel,
            approach: &self.approach,
            position_from: &self.position_from,
            lead,
            ends: self.ends.as_ref(),
            peak: self.drive.peak_force(),
            weight: Force::n(weight),
            friction: &self.friction,
        };
        let homing = Homing::read(&of, keys);
        Self { homing, ..self }
    }
}

impl Structure {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            stiffness: n_per_um(keys.number("stiffness_n_per_um", 1e-3..=1e5)),
            damping_ratio: keys.number("damping_ratio", 0.0..=2.0),
            backlash: Coordinate::linear(Length::um(keys.number("backlash_um", 0.0..=10_000.0))),
        }
    }
}

/// Stiffness as guides and holders state it.
pub(crate) fn n_per_um(value: f64) -> Stiffness {
    Stiffness::n_per_mm(value * 1e3)
}

impl Friction {
    fn read(keys: &mut Keys<'_>) -> Self {
        let friction = Self {
            bristle_stiffness: n_per_um(keys.number("bristle_stiffness_n_per_um", 1e-3..=1e5)),
            bristle_damping_n_s_per_m: keys.number("bristle_damping_n_s_per_m", 0.0..=1e8),
            viscous_n_s_per_m: keys.number("viscous_n_s_per_m", 0.0..=1e7),
            coulomb: Force::n(keys.number("coulomb_n", 0.0..=1e6)),
            static_force: Force::n(keys.number("static_n", 0.0..=1e6)),
            stribeck_speed: CoordinateSpeed::new(
                keys.number("stribeck_speed_mm_per_s", 1e-3..=1000.0),
            ),
        };
        let below = friction.static_force < friction.coulomb;
        at_least(keys, "static_n", "`coulomb_n`", below, friction.coulomb.value());
        friction
    }
}

/// One value is not to be below another.
pub(super) fn at_least(keys: &Keys<'_>, key: &'static str, of: &str, below: bool, least: f64) {
    if below && keys.has(key) {
        keys.conflict(key, format!("`{key}` is below {of}: expected {least} at least"));
    }
}

/// What a count of a motor's encoder is at the table.
fn count(lead: Lead, counts_per_rev: u32) -> Coordinate {
    Coordinate::new(lead.value() / f64::from(counts_per_rev))
}

impl PositionFrom {
    fn read(motor: &Motor, keys: &mut Keys<'_>) -> Self {
        let scale = keys.choice("position_from", &[("motor", false), ("scale", true)]);
        let counts = keys.optional_whole("motor_counts_per_rev", 16..=u32::MAX);
        let scale_step = keys.optional("scale_resolution_nm", 0.01..=1e6);
        let expected = |key, why: &str| {
            keys.conflict("position_from", format!("position from the {why} needs `{key}`"));
            Coordinate::ZERO
        };
        if scale {
            let resolution = scale_step.map_or_else(
                || expected("scale_resolution_nm", "scale"),
                |nm| Coordinate::new(nm * 1e-6),
            );
            let motor = match motor {
                Motor::BallScrew { lead, .. } => {
                    counts.map(|counts| (counts, count(*lead, counts)))
                }
                Motor::Linear { .. } => None,
            };
            return Self::Scale { resolution, motor };
        }
        let Motor::BallScrew { lead, .. } = motor else {
            keys.conflict(
                "position_from",
                "a linear motor has no encoder of its own: expected \"scale\"",
            );
            return Self::Scale { resolution: Coordinate::ZERO, motor: None };
        };
        let Some(counts_per_rev) = counts else {
            let resolution = expected("motor_counts_per_rev", "motor");
            return Self::Motor { counts_per_rev: 1, resolution };
        };
        Self::Motor { counts_per_rev, resolution: count(*lead, counts_per_rev) }
    }

    /// One count.
    pub const fn resolution(&self) -> Coordinate {
        match *self {
            Self::Motor { resolution, .. } | Self::Scale { resolution, .. } => resolution,
        }
    }
}

impl Loops {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let feed_forward = 0.0..=150.0; // beyond, no loop is better for it
        Self {
            position_gain_per_s: keys.number("position_gain_per_s", 0.1..=10_000.0),
            velocity_bandwidth_hz: keys.number("velocity_bandwidth_hz", 0.1..=5000.0),
            velocity_feed_forward_share: percent(
                keys,
                "velocity_feed_forward_percent",
                feed_forward.clone(),
            ),
            acceleration_feed_forward_share: percent(
                keys,
                "acceleration_feed_forward_percent",
                feed_forward.clone(),
            ),
            friction_feed_forward_share: percent(
                keys,
                "friction_feed_forward_percent",
                feed_forward,
            ),
        }
    }
}

impl AxisWindows {
    fn read(keys: &mut Keys<'_>) -> Self {
        let windows = Self {
            in_position: Coordinate::linear(Length::um(
                keys.number("in_position_um", 0.01..=10_000.0),
            )),
            settle: Time::s(keys.number("settle_ms", 0.0..=10_000.0) * 1e-3),
            following_error_warn: Coordinate::linear(Length::um(
                keys.number("following_error_warn_um", 0.1..=1e6),
            )),
            following_error_stop: Coordinate::linear(Length::um(
                keys.number("following_error_stop_um", 0.1..=1e6),
            )),
        };
        let below = windows.following_error_stop < windows.following_error_warn;
        let least = windows.following_error_warn.of_linear().in_um();
        at_least(keys, "following_error_stop_um", "the warning", below, least);
        windows
    }
}
