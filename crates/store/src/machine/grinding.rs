//! What a cam grinder grinds with: the wheel, what it costs to cut with it, and how stiffly it is
//! held.
use super::axis::n_per_um;
use crate::keys::Keys;
use units::{Length, Speed, Stiffness};

/// `[grinding]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grinding {
    /// Wheel, work and centres together.
    pub stiffness: Stiffness,
    /// Least step of the tables of the infeed axis that are sent; zero: as fine as they are
    /// computed.
    pub table_pulse: Length,
    /// The wheel that is mounted.
    pub wheel: Wheel,
}

/// `[grinding.wheel]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wheel {
    /// When it was new.
    pub diameter: Length,
    /// What its radius has lost since, by wear and dressing.
    pub worn: Length,
    /// In contact with a cam.
    pub width: Length,
    /// Speed of its rim.
    pub rim: Speed,
    /// Specific energy, J/mm³.
    pub energy_j_per_mm3: f64,
    /// Tangential over normal force.
    pub force_ratio: f64,
    /// Volume of work ground for a volume of wheel lost.
    pub grinding_ratio: f64,
}

impl Wheel {
    /// As it is now.
    pub fn radius(&self) -> Length {
        self.diameter / 2.0 - self.worn
    }
}

impl Grinding {
    pub(super) fn read(keys: &mut Keys<'_>) -> Self {
        Self {
            stiffness: n_per_um(keys.number("stiffness_n_per_um", 0.1..=1e4)),
            table_pulse: Length::um(keys.optional("table_pulse_um", 0.0..=1000.0).unwrap_or(0.0)),
            wheel: keys.section("wheel", Wheel::read),
        }
    }
}

impl Wheel {
    fn read(keys: &mut Keys<'_>) -> Self {
        let wheel = Self {
            diameter: Length::mm(keys.number("diameter_mm", 1.0..=2000.0)),
            worn: Length::mm(keys.number("worn_mm", 0.0..=1000.0)),
            width: Length::mm(keys.number("width_mm", 0.1..=1000.0)),
            rim: Speed::mm_per_s(keys.number("rim_m_per_s", 1.0..=300.0) * 1e3),
            energy_j_per_mm3: keys.number("specific_energy_j_per_mm3", 0.1..=1000.0),
            force_ratio: keys.number("force_ratio", 0.05..=1.0),
            grinding_ratio: keys.number("grinding_ratio", 0.1..=1e6),
        };
        if keys.has("worn_mm") && wheel.worn >= wheel.diameter / 2.0 {
            let most = wheel.diameter.value() / 2.0;
            keys.conflict(
                "worn_mm",
                format!("the wheel's radius when new was {most} mm: nothing would be left of it"),
            );
        }
        wheel
    }
}
