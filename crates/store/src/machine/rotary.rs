//! A rotary axis of a machine file, A, B or C: a table or a head that a motor turns through a gear.
//!
//! Its coordinates and their rates are in degrees, of a type that says no unit without its axis.
//! Its drive and what it moves are computed as those of a linear axis on which 1000° are a metre.
//! By the work that is done, with r = 1000·π/180 rad a "metre":
//!
//! ```text
//!   F = r·M      m = r²·J      k = r²·kt      c = r²·ct        degrees of the table a turn of the motor: its lead
//! ```
//!
//! | symbol | meaning | unit in the file |
//! |---|---|---|
//! | M, J | torque, inertia about the axis | N·m, kg·m² |
//! | kt, ct | torsional stiffness, damping | N·m/rad, N·m·s/rad |
use super::axis::{
    Approach, Axis, AxisWindows, Friction, Loops, PositionFrom, Structure, Travel, at_least,
};
use super::axis_drive::{Drive, Motor, thermal_time};
use super::ethercat::DriveSlot;
use super::homing::{Ends, Homing};
use super::measured_torque::MeasuredTorque;
use super::plant::AxisErrors;
use crate::keys::Keys;
use units::{
    Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Force, Inertia, Lead, Mass,
    Stiffness, Time, Torque,
};

/// Farthest from zero that a rotary axis may turn, °: a thousand turns.
const FARTHEST_DEG: f64 = 360_000.0;
/// Radians of 1000°, which stand for a metre.
pub const RAD_PER_M: f64 = 1000.0 * std::f64::consts::PI / 180.0;
/// Seconds of arc in a degree.
const ARCSEC: f64 = 3600.0;

/// Read `[axes.a]`, `[axes.b]` or `[axes.c]`.
pub(super) fn read(letter: canon::Axis, keys: &mut Keys<'_>) -> Axis {
    let drive = keys.section("drive", drive);
    let inertia = keys.number("moving_inertia_kg_m2", 1e-6..=1e6);
    let travel = travel(keys);
    let axis = Axis {
        letter,
        travel,
        rapid: CoordinateSpeed::per_min(keys.number("rapid_deg_per_min", 1.0..=1e7)),
        feed_most: CoordinateSpeed::per_min(keys.number("feed_most_deg_per_min", 1.0..=1e7)),
        acceleration: CoordinateAccel::new(keys.limit("acceleration_deg_per_s2", 0.1..=1e7)),
        jerk_feed: CoordinateJerk::new(keys.limit("jerk_feed_deg_per_s3", 1.0..=1e10)),
        jerk_rapid: CoordinateJerk::new(keys.limit("jerk_rapid_deg_per_s3", 1.0..=1e10)),
        approach: Approach {
            speed: CoordinateSpeed::per_min(keys.renamed(
                "approach_deg_per_min",
                "gentle_deg_per_min",
                1.0..=1e7,
            )),
            acceleration: CoordinateAccel::new(keys.renamed(
                "approach_deg_per_s2",
                "gentle_deg_per_s2",
                0.1..=1e7,
            )),
        },
        moving_mass: Mass::kg(inertia * RAD_PER_M * RAD_PER_M),
        weight_share: 0.0,
        structure: keys.section("structure", structure),
        friction: keys.section("friction", friction),
        position_from: keys.section("encoder", |k| position_from(&drive.motor, k)),
        drive,
        loops: keys.section("loops", Loops::read),
        windows: keys.section("windows", windows),
        homing: Homing::UNREAD,
        ends: Ends::read(letter, &travel, keys),
        compensation: None,
        errors: keys.optional_section("errors", AxisErrors::read).unwrap_or_default(),
        ethercat: keys.optional_section("ethercat", DriveSlot::read),
    };
    axis.with_homing(keys)
}

/// It stands at zero when the machine is switched on, so zero lies within.
fn travel(keys: &mut Keys<'_>) -> Travel {
    let from = Coordinate::new(keys.number("travel_from_deg", -FARTHEST_DEG..=0.0));
    let to = Coordinate::new(keys.number("travel_to_deg", 0.0..=FARTHEST_DEG));
    if keys.has("travel_from_deg") && from >= to {
        let (low, high) = (from.value(), to.value());
        let text = format!("`travel_from_deg` {low} is not below `travel_to_deg` {high}");
        keys.conflict("travel_from_deg", text);
    }
    Travel { from, to }
}

fn drive(keys: &mut Keys<'_>) -> Drive {
    let motor = Motor::BallScrew {
        lead: Lead::mm_per_rev(keys.number("gear_deg_per_rev", 0.01..=360.0)),
        rotating_inertia: Inertia::kg_m2(keys.number("rotating_inertia_kg_m2", 1e-9..=100.0)),
        peak_torque: Torque::n_m(keys.number("peak_torque_n_m", 1e-4..=1e5)),
    };
    Drive {
        motor,
        continuous_force: motor.continuous_force(keys),
        thermal_time: thermal_time(keys),
        measured_torque: MeasuredTorque::read(keys),
        force_lag: Time::s(keys.number("torque_lag_ms", 0.0..=100.0) * 1e-3),
        brake: keys.flag("brake"),
    }
}

/// N·m/rad as what stands for N/mm.
fn stiffness(value: f64) -> Stiffness {
    Stiffness::n_per_mm(value * RAD_PER_M * RAD_PER_M * 1e-3)
}

fn structure(keys: &mut Keys<'_>) -> Structure {
    Structure {
        stiffness: stiffness(keys.number("stiffness_n_m_per_rad", 1.0..=1e9)),
        damping_ratio: keys.number("damping_ratio", 0.0..=2.0),
        backlash: Coordinate::new(keys.number("backlash_arcsec", 0.0..=36_000.0) / ARCSEC),
    }
}

fn friction(keys: &mut Keys<'_>) -> Friction {
    let damping = RAD_PER_M * RAD_PER_M;
    let torque = |value: f64| Force::n(value * RAD_PER_M);
    let friction = Friction {
        bristle_stiffness: stiffness(keys.number("bristle_stiffness_n_m_per_rad", 1.0..=1e9)),
        bristle_damping_n_s_per_m: keys.number("bristle_damping_n_m_s_per_rad", 0.0..=1e6)
            * damping,
        viscous_n_s_per_m: keys.number("viscous_n_m_s_per_rad", 0.0..=1e5) * damping,
        coulomb: torque(keys.number("coulomb_n_m", 0.0..=1e5)),
        static_force: torque(keys.number("static_n_m", 0.0..=1e5)),
        stribeck_speed: CoordinateSpeed::new(
            keys.number("stribeck_speed_deg_per_s", 1e-3..=1000.0),
        ),
    };
    let least = friction.coulomb.value() / RAD_PER_M;
    let below = friction.static_force < friction.coulomb;
    at_least(keys, "static_n_m", "`coulomb_n_m`", below, least);
    friction
}

fn position_from(motor: &Motor, keys: &mut Keys<'_>) -> PositionFrom {
    let table = keys.choice("position_from", &[("motor", false), ("table", true)]);
    let key = if table { "table_counts_per_rev" } else { "motor_counts_per_rev" };
    let turn = match motor {
        Motor::BallScrew { lead, .. } if !table => lead.value(),
        Motor::BallScrew { .. } | Motor::Linear { .. } => 360.0,
    };
    // the other encoder may be stated as well
    let motor_counts = keys.optional_whole("motor_counts_per_rev", 16..=u32::MAX);
    let table_counts = keys.optional_whole("table_counts_per_rev", 16..=u32::MAX);
    let Some(counts_per_rev) = (if table { table_counts } else { motor_counts }) else {
        keys.conflict("position_from", format!("position from there needs `{key}`"));
        return PositionFrom::Motor { counts_per_rev: 1, resolution: Coordinate::ZERO };
    };
    let resolution = Coordinate::new(turn / f64::from(counts_per_rev));
    if table {
        PositionFrom::Scale { resolution, motor: None }
    } else {
        PositionFrom::Motor { counts_per_rev, resolution }
    }
}

fn windows(keys: &mut Keys<'_>) -> AxisWindows {
    let mut arcsec = |key| Coordinate::new(keys.number(key, 0.01..=3.6e6) / ARCSEC);
    let (in_position, following_error_warn, following_error_stop) = (
        arcsec("in_position_arcsec"),
        arcsec("following_error_warn_arcsec"),
        arcsec("following_error_stop_arcsec"),
    );
    let settle = Time::s(keys.number("settle_ms", 0.0..=10_000.0) * 1e-3);
    let below = following_error_stop < following_error_warn;
    let least = following_error_warn.value() * ARCSEC;
    at_least(keys, "following_error_stop_arcsec", "the warning", below, least);
    AxisWindows { in_position, settle, following_error_warn, following_error_stop }
}
