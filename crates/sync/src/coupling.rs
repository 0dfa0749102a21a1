//! The coupling: a follower axis as a function of a master angle.
//!
//! ```text
//!    z │
//!      │ anchor
//!   z₀ ┼──●                 z(θ) = z₀ + H·(θ − θ₀)
//!      │    ╲
//!      │      ╲  slope H: negative when +θ drives −z
//!      └──┼───────────► θ
//!         θ₀
//! ```
//!
//! The line has no direction of travel, so it holds while the spindle slows, stops and turns back.
//! A measured point (θ, z) is judged by two figures of the same fact: the *error* e = z − g(θ)
//! along the axis, and the *phase difference* e/H, the angle by which the follower is ahead.
//!
//! Followed at speed, the chain rule gives the feed-forwards: ż = g′·ω and z̈ = g′·α + g″·ω².
use units::{Accel, Angle, Lead, Length, Speed, Spin, SpinAccel, Time};

/// How a master turns at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rotation {
    /// Unwrapped angle.
    pub angle: Angle,
    /// Its rate.
    pub spin: Spin,
    /// The rate of that.
    pub accel: SpinAccel,
}

impl Rotation {
    /// How it will turn a while later, if its acceleration stays as it is.
    #[must_use]
    pub fn after(self, time: Time) -> Self {
        let turned: Angle = (self.spin + self.accel * time / 2.0) * time;
        Self { angle: self.angle + turned, spin: self.spin + self.accel * time, accel: self.accel }
    }
}

/// How its follower shall move at the same instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Follower {
    /// Position.
    pub position: Length,
    /// Speed.
    pub speed: Speed,
    /// Acceleration.
    pub accel: Accel,
}

/// A straight line through an anchor: taps and threads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Line {
    lead: Lead,
    theta0: Angle,
    z0: Length,
}

/// Which function the follower obeys.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Coupling {
    /// A thread's helix.
    Line(Line),
}

impl Coupling {
    /// Engage a line, so that the axis belongs at `z` while the master is at `theta`. `lead` is the
    /// axis' travel per revolution of the master in its positive sense.
    pub const fn line(lead: Lead, theta: Angle, z: Length) -> Self {
        Self::Line(Line { lead, theta0: theta, z0: z })
    }

    /// Where the follower belongs.
    pub fn position(&self, theta: Angle) -> Length {
        match self {
            Self::Line(line) => line.z0 + line.lead * (theta - line.theta0),
        }
    }

    /// Travel per revolution at this angle, g′.
    pub const fn slope(&self, _theta: Angle) -> Lead {
        match self {
            Self::Line(line) => line.lead,
        }
    }

    /// Where the follower belongs, and how fast it moves there.
    pub fn follow(&self, master: Rotation) -> Follower {
        let slope = self.slope(master.angle);
        Follower {
            position: self.position(master.angle),
            speed: slope * master.spin,
            accel: slope * master.accel,
        }
    }

    /// Distance of a measured point from the coupling along the axis, e = z − g(θ).
    pub fn error(&self, theta: Angle, z: Length) -> Length {
        z - self.position(theta)
    }

    /// The same as an angle: by how much the follower is ahead of the master, e/g′. Zero where the
    /// coupling is level, since no angle would mend the error there.
    pub fn phase_difference(&self, theta: Angle, z: Length) -> Angle {
        let slope = self.slope(theta);
        if slope == Lead::ZERO { Angle::ZERO } else { self.error(theta, z) / slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_right_hand_tap_goes_down_as_the_spindle_turns_clockwise() {
        let m8 = Coupling::line(Lead::mm_per_rev(-1.25), Angle::rev(3.0), Length::mm(2.0));
        assert_eq!(m8.position(Angle::rev(3.0)), Length::mm(2.0));
        assert_eq!(m8.position(Angle::rev(20.6)), Length::mm(2.0 - 1.25 * 17.6));
    }

    #[test]
    fn a_left_hand_tap_goes_down_as_the_spindle_turns_counter_clockwise() {
        let left = Coupling::line(Lead::mm_per_rev(1.0), Angle::ZERO, Length::ZERO);
        assert_eq!(left.position(Angle::rev(-5.0)), Length::mm(-5.0));
        let follower = left.follow(Rotation { spin: Spin::rpm(-6000.0), ..Rotation::default() });
        assert_eq!(follower.speed, Speed::mm_per_s(-100.0));
    }

    #[test]
    fn an_axis_half_a_lead_too_deep_is_half_a_turn_ahead() {
        let m6 = Coupling::line(Lead::mm_per_rev(-1.0), Angle::ZERO, Length::ZERO);
        let (theta, z) = (Angle::rev(4.0), Length::mm(-4.5));
        assert_eq!(m6.error(theta, z), Length::mm(-0.5));
        assert_eq!(m6.phase_difference(theta, z), Angle::rev(0.5));
    }

    #[test]
    fn a_level_coupling_has_no_phase() {
        let level = Coupling::line(Lead::ZERO, Angle::ZERO, Length::ZERO);
        assert_eq!(level.phase_difference(Angle::rev(1.0), Length::mm(1.0)), Angle::ZERO);
    }

    proptest! {
        #[test]
        fn points_on_the_graph_have_no_error(
            lead in -10.0..10.0f64, theta0 in -1e4..1e4f64, z0 in -500.0..500.0f64, turned in -200.0..200.0f64,
        ) {
            let g = Coupling::line(Lead::mm_per_rev(lead), Angle::rev(theta0), Length::mm(z0));
            let theta = Angle::rev(theta0 + turned);
            prop_assert_eq!(g.error(theta, g.position(theta)), Length::ZERO);
        }

        #[test]
        fn the_speed_is_the_derivative_of_the_position(
            lead in -10.0..10.0f64, spin in -170.0..170.0f64, theta in -50.0..50.0f64,
        ) {
            let g = Coupling::line(Lead::mm_per_rev(lead), Angle::ZERO, Length::mm(7.0));
            let dt = 1e-4;
            let step = g.position(Angle::rev(theta + spin * dt)) - g.position(Angle::rev(theta - spin * dt));
            let follower = g.follow(Rotation { angle: Angle::rev(theta), spin: Spin::rev_per_s(spin), ..Rotation::default() });
            prop_assert!((step.value() / (2.0 * dt) - follower.speed.value()).abs() < 1e-6);
        }

        #[test]
        fn the_other_hand_mirrors_the_motion(lead in 0.1..10.0f64, theta in -50.0..50.0f64) {
            let right = Coupling::line(Lead::mm_per_rev(-lead), Angle::ZERO, Length::ZERO);
            let left = Coupling::line(Lead::mm_per_rev(lead), Angle::ZERO, Length::ZERO);
            prop_assert_eq!(right.position(Angle::rev(theta)), left.position(Angle::rev(-theta)));
        }
    }
}
