//! The drive of an axis: its motor, what makes thrust of it, and what it can hold.
use super::measured_torque::MeasuredTorque;
use crate::keys::Keys;
use units::{Force, Inertia, Lead, Mass, Time, Torque};

/// The motor, and what makes thrust of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Kind of motor.
    pub motor: Motor,
    /// First-order lag of the force; zero where it is neglected.
    pub force_lag: Time,
    /// A brake clamps the motor while the drive is off.
    pub brake: bool,
    /// Force that it can hold for ever, where the file states it.
    pub continuous_force: Option<Force>,
    /// Time in which drive and winding warm.
    pub thermal_time: Time,
    /// How it measures what it gives, if it does.
    pub measured_torque: Option<MeasuredTorque>,
}

/// Kinds of motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motor {
    /// A motor on a ball screw.
    BallScrew {
        /// Travel per revolution.
        lead: Lead,
        /// Inertia of motor, coupling and screw.
        rotating_inertia: Inertia,
        /// Peak torque.
        peak_torque: Torque,
    },
    /// A linear motor.
    Linear {
        /// Mass of its coil part.
        motor_mass: Mass,
        /// Peak force.
        peak_force: Force,
    },
}

impl Drive {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        #[derive(Clone, Copy)]
        enum Kind {
            BallScrew,
            Linear,
        }
        let kinds = [("ball-screw", Kind::BallScrew), ("linear-motor", Kind::Linear)];
        let motor = match keys.choice("kind", &kinds) {
            Kind::BallScrew => Motor::BallScrew {
                lead: Lead::mm_per_rev(keys.number("lead_mm_per_rev", 0.1..=1000.0)),
                rotating_inertia: Inertia::kg_m2(
                    keys.number("rotating_inertia_kg_m2", 1e-9..=100.0),
                ),
                peak_torque: Torque::n_m(keys.number("peak_torque_n_m", 1e-4..=1e5)),
            },
            Kind::Linear => Motor::Linear {
                motor_mass: Mass::kg(keys.number("motor_mass_kg", 1e-3..=1e5)),
                peak_force: Force::n(keys.number("peak_force_n", 0.1..=1e7)),
            },
        };
        Self {
            motor,
            force_lag: Time::s(keys.number("force_lag_ms", 0.0..=100.0) * 1e-3),
            brake: keys.flag("brake"),
            continuous_force: motor.continuous_force(keys),
            thermal_time: thermal_time(keys),
            measured_torque: MeasuredTorque::read(keys),
        }
    }

    /// Largest force on the axis: F = M·2π/lead.
    pub fn peak_force(&self) -> Force {
        match self.motor {
            Motor::BallScrew { lead, peak_torque, .. } => Force::n(
                peak_torque.value() * std::f64::consts::TAU / (lead.value() * 1e-3), // mm/rev to m/rev
            ),
            Motor::Linear { peak_force, .. } => peak_force,
        }
    }

    /// Mass on the motor's side: m = J·(2π/lead)².
    pub fn motor_mass(&self) -> Mass {
        match self.motor {
            Motor::BallScrew { lead, rotating_inertia, .. } => {
                let rad_per_m = std::f64::consts::TAU / (lead.value() * 1e-3);
                Mass::kg(rotating_inertia.value() * rad_per_m * rad_per_m)
            }
            Motor::Linear { motor_mass, .. } => motor_mass,
        }
    }
}

impl Motor {
    /// Reads what it can hold for ever, as a force along the axis.
    pub(super) fn continuous_force(&self, keys: &mut Keys<'_>) -> Option<Force> {
        let (key, most, newtons) = match self {
            Self::BallScrew { lead, peak_torque, .. } => {
                let per_m = std::f64::consts::TAU / (lead.value() * 1e-3);
                ("continuous_torque_n_m", peak_torque.value(), per_m)
            }
            Self::Linear { peak_force, .. } => ("continuous_force_n", peak_force.value(), 1.0),
        };
        let stated = keys.optional(key, 1e-4..=1e7)?;
        if stated > most {
            keys.conflict(key, format!("`{key}` is above the peak: expected {most} at most"));
        }
        Some(Force::n(stated * newtons))
    }
}

/// Reads the time in which a drive and its winding warm; a minute where it is not stated.
pub(super) fn thermal_time(keys: &mut Keys<'_>) -> Time {
    Time::s(keys.optional("thermal_time_s", 0.1..=36_000.0).unwrap_or(60.0))
}
