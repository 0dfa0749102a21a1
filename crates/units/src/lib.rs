//! Quantities that Leadscrew reasons in. Angle is a dimension here, so `length / angle` (a thread's
//! lead) and `length` cannot be confused, and a forgotten 2π does not compile.
//!
//! ```text
//!             ÷ Time            ÷ Time             ÷ Time
//!   Angle ───────────► Spin ───────────► SpinAccel ─────────► SpinJerk   [rev, rev/s, rev/s², rev/s³]
//!     │ × Lead           │ × Lead            │ × Lead            │ × Lead     [mm/rev]
//!     ▼       ÷ Time     ▼        ÷ Time     ▼        ÷ Time     ▼
//!   Length ──────────► Speed ────────────► Accel ────────────► Jerk       [mm, mm/s, mm/s², mm/s³]
//!     │ × Stiffness
//!     ▼
//!   Force [N]     Torque [N·m] × Spin ──► Power [W]   (the 2π is inside that product, and only there)
//! ```
//!
//! A [`Coordinate`] is where an axis is, whichever kind of axis it is: in millimetres of a linear
//! one, in degrees of a rotary one. It is neither a Length nor an Angle, and reads as one of them
//! by its axis only.
//!
//! Every arrow is one `product!` below; there are no others. Constructors name their unit
//! (`Spin::rpm(600.0)`); `value()` gives the base unit back.
#![no_std]

mod axes;
mod coordinate;
mod orientation;
mod quantity;
mod spread;

pub use axes::{Arc, Axis, Plane, Position, Ratio};
pub use coordinate::{
    AxisKind, Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Reading, SpeedReading,
};
pub use orientation::{Orientation, TurnDirection};
use quantity::{product, quantity};
pub use spread::{Distribution, FARTHEST_DEVIATIONS, Per, Spread};

quantity!(/// Time.
    Time, s, "s");
quantity!(/// Distance along an axis.
    Length, mm, "mm");
quantity!(/// Rate of [`Length`].
    Speed, mm_per_s, "mm/s");
quantity!(/// Rate of [`Speed`].
    Accel, mm_per_s2, "mm/s²");
quantity!(/// Rate of [`Accel`].
    Jerk, mm_per_s3, "mm/s³");
quantity!(/// Unwrapped rotation: 2.25 rev means two and a quarter turns, not a quarter.
    Angle, rev, "rev");
quantity!(/// Rate of [`Angle`].
    Spin, rev_per_s, "rev/s");
quantity!(/// Rate of [`Spin`].
    SpinAccel, rev_per_s2, "rev/s²");
quantity!(/// Rate of [`SpinAccel`].
    SpinJerk, rev_per_s3, "rev/s³");
quantity!(/// Axial travel per revolution. Positive: +θ drives the follower in its positive direction.
    Lead, mm_per_rev, "mm/rev");
quantity!(/// By how much a [`Lead`] grows with each revolution.
    LeadGrowth, mm_per_rev2, "mm/rev²");
quantity!(/// Force along an axis.
    Force, n, "N");
quantity!(/// Torque about a spindle.
    Torque, n_m, "N·m");
quantity!(/// Mechanical power.
    Power, w, "W");
quantity!(/// Mass.
    Mass, kg, "kg");
quantity!(/// Moment of inertia.
    Inertia, kg_m2, "kg·m²");
quantity!(/// Axial stiffness.
    Stiffness, n_per_mm, "N/mm");

product!(Speed * Time = Length);
product!(Accel * Time = Speed);
product!(Jerk * Time = Accel);
product!(Spin * Time = Angle);
product!(SpinAccel * Time = Spin);
product!(SpinJerk * Time = SpinAccel);
product!(Lead * Angle = Length);
product!(LeadGrowth * Angle = Lead);
product!(Lead * Spin = Speed);
product!(Lead * SpinAccel = Accel);
product!(Lead * SpinJerk = Jerk);
product!(Stiffness * Length = Force);

/// Millimetres in one inch, exactly (ISO 31; the international inch of 1959).
pub const MM_PER_INCH: f64 = 25.4;

impl Spin {
    /// From revolutions per minute, the programmer's unit.
    pub const fn rpm(value: f64) -> Self {
        Self::rev_per_s(value / 60.0)
    }
    /// In revolutions per minute, for people.
    pub const fn in_rpm(self) -> f64 {
        self.value() * 60.0
    }
    /// In radians per second, for equations of motion.
    pub const fn in_rad_per_s(self) -> f64 {
        self.value() * core::f64::consts::TAU
    }
}

impl Angle {
    /// From degrees.
    pub const fn deg(value: f64) -> Self {
        Self::rev(value / 360.0)
    }
    /// In degrees, for people.
    pub const fn in_deg(self) -> f64 {
        self.value() * 360.0
    }
    /// In radians, for trigonometry.
    pub const fn in_rad(self) -> f64 {
        self.value() * core::f64::consts::TAU
    }
}

impl Length {
    /// From inches.
    pub const fn inch(value: f64) -> Self {
        Self::mm(value * MM_PER_INCH)
    }
    /// From micrometres.
    pub const fn um(value: f64) -> Self {
        Self::mm(value * 1e-3)
    }
    /// In micrometres, for people.
    pub const fn in_um(self) -> f64 {
        self.value() * 1e3
    }
}

impl Speed {
    /// From millimetres per minute, the programmer's unit.
    pub const fn mm_per_min(value: f64) -> Self {
        Self::mm_per_s(value / 60.0)
    }
    /// In millimetres per minute, for people.
    pub const fn in_mm_per_min(self) -> f64 {
        self.value() * 60.0
    }
}

impl Torque {
    /// Power of this torque at a speed: P = M·2π·n.
    pub const fn power_at(self, spin: Spin) -> Power {
        Power::w(self.value() * core::f64::consts::TAU * spin.value())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_turns_at_one_and_a_half_advance_thirty_millimetres() {
        let turned: Angle = Spin::rpm(600.0) * Time::s(2.0);
        assert_eq!(Lead::mm_per_rev(1.5) * turned, Length::mm(30.0));
    }

    #[test]
    fn power_of_42_newton_metres_at_3410_rpm_is_15_kilowatts() {
        let power = Torque::n_m(42.0).power_at(Spin::rpm(3410.0));
        assert!((power.value() - 15_000.0).abs() < 10.0, "{power}");
    }
}
