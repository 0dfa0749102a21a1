//! One spindle: inertia, torque and power curve, friction, encoder, loops.
//!
//! ```text
//!   M │ Mpeak                   |M| ≤ min(Mpeak, Ppeak/|ω|)
//!     │──────────╮              friction: c0·tanh(ω/ω0) + c1·ω
//!     │           ╲             torque lag: τ·dM/dt = Mref − M
//!     │             ╲──────
//!     └──────────┴──────────► ω
//!              base speed Ppeak/Mpeak
//! ```
use super::axis::Loops;
use super::axis_drive::thermal_time;
use super::compensation::spindle_encoder;
use super::{
    ethercat::DriveSlot, measured_torque::MeasuredTorque, plant::SpindleErrors, setup::percent,
};
use crate::keys::Keys;
use sync::DeviationTable;
use units::{Angle, Inertia, Length, Power, Spin, SpinAccel, Time, Torque};

/// One spindle.
#[derive(Clone, Debug, PartialEq)]
pub struct Spindle {
    /// Its name, also in the trace's columns.
    pub name: String,
    /// Inertia of rotor, arbor and tool or chuck.
    pub inertia: Inertia,
    /// Peak torque.
    pub peak_torque: Torque,
    /// Torque it can hold for ever.
    pub continuous_torque: Torque,
    /// Time in which drive and winding warm: the mean of the torque's square is taken over it.
    pub thermal_time: Time,
    /// How its drive measures what it gives, if it does.
    pub measured_torque: Option<MeasuredTorque>,
    /// Peak power.
    pub peak_power: Power,
    /// Fastest speed.
    pub max: Spin,
    /// Fastest speed in a tap.
    pub tapping_max: Spin,
    /// First-order lag of the torque.
    pub torque_lag: Time,
    /// Counts of its encoder per revolution.
    pub encoder_counts_per_rev: u32,
    /// Its encoder has an index mark.
    pub encoder_index: bool,
    /// Its encoder counts turns while it is without power.
    pub encoder_keeps_turns: bool,
    /// Fraction of the torque and power curve that the planner may use up.
    pub planned_share: f64,
    /// Time in which planned torque rises from nothing to its peak.
    pub torque_rise: Time,
    /// Fastest speed while it turns to an angle.
    pub orient: Spin,
    /// Acceleration while it turns to an angle.
    pub orient_acceleration: SpinAccel,
    /// What holds it back.
    pub friction: SpindleFriction,
    /// Its drive is only told a speed and makes its own ramps; `None`: it is told a torque, or an
    /// angle.
    pub own_ramps: Option<OwnRamps>,
    /// Its drive closes its own position loop and is told an angle: `[spindles.drive]` of the kind
    /// "position".
    pub closes_position: bool,
    /// How it is controlled.
    pub loops: Loops,
    /// What it is watched for.
    pub windows: SpindleWindows,
    /// Errors per turn of its encoder that were measured and are compensated, rev; `None`: none
    /// are.
    pub encoder_errors: Option<DeviationTable>,
    /// What is wrong with it that its control is not told.
    pub errors: SpindleErrors,
    /// Its drive on an EtherCAT network; `None`: it is on none.
    pub ethercat: Option<DriveSlot>,
}

/// A drive that is only told a speed: `[spindles.drive]` of the kind "speed".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnRamps {
    /// From an order until it obeys.
    pub delay: Time,
    /// Of its ramp up.
    pub acceleration: SpinAccel,
    /// Of its ramp down.
    pub deceleration: SpinAccel,
    /// How far its stopping angle may be from what these make it.
    pub uncertainty_share: f64,
    /// How much sooner or later than a stroke has taught it may obey.
    pub repeats_delay: Time,
    /// How far its ramp may be from what a stroke has taught.
    pub repeats_share: f64,
    /// A stroke turns back straight from its speed if it repeats so well; else it creeps to its
    /// bottom.
    pub turns_within: Length,
    /// Share of a tap's speed at which strokes creep to their bottom.
    pub creep_share: f64,
    /// It brings the spindle to an angle by itself (M19).
    pub orients: bool,
}

/// What a drive is told.
enum SpindleDriveKind {
    Torque,
    Speed(OwnRamps),
    Angle,
}

/// Friction of a spindle: c0·tanh(ω/ω0) + c1·ω.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleFriction {
    /// c0.
    pub coulomb: Torque,
    /// ω0, where the friction's sign is smoothed.
    pub smoothing: Spin,
    /// c1, N·m·s/rad.
    pub viscous_n_m_s_per_rad: f64,
}

/// What a spindle is watched for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpindleWindows {
    /// At speed: within this fraction of the ordered speed.
    pub at_speed_share: f64,
    /// In a cut: within this fraction of the ordered speed, else alarm 204.
    pub in_cut_share: f64,
    /// At rest: slower than this.
    pub at_rest: Spin,
    /// Oriented: this near to the ordered angle.
    pub oriented: Angle,
    /// Following error of the angle that stops the machine.
    pub following_error_stop: Angle,
}

impl Spindle {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        let told = keys
            .optional_section("drive", SpindleDriveKind::read)
            .unwrap_or(SpindleDriveKind::Torque);
        let (own_ramps, closes_position) = match told {
            SpindleDriveKind::Torque => (None, false),
            SpindleDriveKind::Speed(own) => (Some(own), false),
            SpindleDriveKind::Angle => (None, true),
        };
        let spindle = Self {
            name: read_name(keys),
            inertia: Inertia::kg_m2(keys.number("inertia_kg_m2", 1e-6..=1e4)),
            peak_torque: Torque::n_m(keys.number("peak_torque_n_m", 1e-3..=1e6)),
            continuous_torque: Torque::n_m(keys.number("continuous_torque_n_m", 1e-3..=1e6)),
            thermal_time: thermal_time(keys),
            measured_torque: MeasuredTorque::read(keys),
            peak_power: Power::w(keys.number("peak_power_w", 1.0..=1e7)),
            max: Spin::rpm(keys.number("max_rpm", 1.0..=500_000.0)),
            tapping_max: Spin::rpm(keys.number("tapping_max_rpm", 1.0..=500_000.0)),
            torque_lag: Time::s(keys.number("torque_lag_ms", 0.0..=1000.0) * 1e-3),
            encoder_counts_per_rev: keys.whole("encoder_counts_per_rev", 16..=u32::MAX),
            encoder_index: keys.has("encoder_index") && keys.flag("encoder_index"),
            encoder_keeps_turns: keys
                .optional_choice("encoder_turns", &[("multi-turn", true), ("single-turn", false)])
                .unwrap_or(true),
            planned_share: percent(keys, "planned_percent", 1.0..=100.0),
            torque_rise: Time::s(keys.number("torque_rise_ms", 0.0..=10_000.0) * 1e-3),
            orient: Spin::rpm(keys.number("orient_rpm", 0.1..=10_000.0)),
            orient_acceleration: SpinAccel::rev_per_s2(
                keys.number("orient_rev_per_s2", 0.01..=1e6),
            ),
            friction: keys.section("friction", SpindleFriction::read),
            own_ramps,
            closes_position,
            loops: keys.section("loops", Loops::read),
            windows: keys.section("windows", SpindleWindows::read),
            encoder_errors: keys.optional_section("encoder", spindle_encoder),
            errors: keys.optional_section("errors", SpindleErrors::read).unwrap_or_default(),
            ethercat: keys.optional_section("ethercat", DriveSlot::read),
        };
        spindle.refuse_contradictions(keys);
        spindle
    }

    fn refuse_contradictions(&self, keys: &Keys<'_>) {
        if keys.has("tapping_max_rpm") && self.tapping_max > self.max {
            let most = self.max.in_rpm();
            keys.conflict(
                "tapping_max_rpm",
                format!("`tapping_max_rpm` is above `max_rpm`: expected {most} at most"),
            );
        }
        if keys.has("continuous_torque_n_m") && self.continuous_torque > self.peak_torque {
            let most = self.peak_torque.value();
            keys.conflict(
                "continuous_torque_n_m",
                format!(
                    "`continuous_torque_n_m` is above `peak_torque_n_m`: expected {most} at most"
                ),
            );
        }
    }

    /// Where the torque curve bends: Ppeak / (2π·Mpeak).
    pub fn base_speed(&self) -> Spin {
        let rad_per_s = self.peak_power.value() / self.peak_torque.value();
        Spin::rev_per_s(rad_per_s / std::f64::consts::TAU)
    }
}

/// The name becomes part of column names: small letters, digits, hyphen, underscore.
fn read_name(keys: &mut Keys<'_>) -> String {
    let name = keys.text("name");
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
    if keys.has("name") && (name.is_empty() || name.len() > 32 || !name.chars().all(plain)) {
        keys.unknown_name(
            "name",
            "`name` of a spindle: expected 1 to 32 small letters, digits, - or _",
        );
    }
    name
}

impl SpindleDriveKind {
    fn read(keys: &mut Keys<'_>) -> Self {
        let kinds = [("torque", None), ("speed", Some(false)), ("position", Some(true))];
        match keys.choice("kind", &kinds) {
            None => Self::Torque,
            Some(false) => Self::Speed(OwnRamps::read(keys)),
            Some(true) => Self::Angle,
        }
    }
}

impl OwnRamps {
    fn read(keys: &mut Keys<'_>) -> Self {
        let accel = 0.1..=1e5;
        Self {
            delay: Time::s(keys.number("delay_ms", 0.0..=1000.0) * 1e-3),
            acceleration: SpinAccel::rev_per_s2(
                keys.number("acceleration_rev_per_s2", accel.clone()),
            ),
            deceleration: SpinAccel::rev_per_s2(keys.number("deceleration_rev_per_s2", accel)),
            uncertainty_share: percent(keys, "uncertainty_percent", 0.0..=100.0),
            repeats_delay: Time::s(keys.number("repeats_ms", 0.0..=100.0) * 1e-3),
            repeats_share: percent(keys, "repeats_percent", 0.0..=100.0),
            turns_within: Length::um(keys.number("turns_within_um", 0.0..=10_000.0)),
            creep_share: percent(keys, "creep_percent", 1.0..=100.0),
            orients: keys.has("orients") && keys.flag("orients"),
        }
    }
}

impl SpindleFriction {
    fn read(keys: &mut Keys<'_>) -> Self {
        let rad_per_s = keys.number("smoothing_rad_per_s", 1e-3..=1000.0);
        Self {
            coulomb: Torque::n_m(keys.number("coulomb_n_m", 0.0..=1e5)),
            smoothing: Spin::rev_per_s(rad_per_s / std::f64::consts::TAU),
            viscous_n_m_s_per_rad: keys.number("viscous_n_m_s_per_rad", 0.0..=1e4),
        }
    }
}

impl SpindleWindows {
    fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            at_speed_share: percent(keys, "at_speed_percent", 0.01..=50.0),
            in_cut_share: keys.optional("in_cut_percent", 1.0..=100.0).unwrap_or(25.0) / 100.0,
            at_rest: Spin::rpm(keys.number("at_rest_rpm", 1e-3..=1000.0)),
            oriented: Angle::deg(keys.number("oriented_deg", 1e-4..=90.0)),
            following_error_stop: Angle::deg(
                keys.number("following_error_stop_deg", 0.01..=36_000.0),
            ),
        }
    }
}
