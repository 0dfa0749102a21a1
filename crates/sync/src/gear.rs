//! An electronic gear: a spindle that follows another one, in a ratio of whole numbers, at a phase.
//!
//! ```text
//!   follower θf = (p/q)·θm + x/H + φ        p turns of the follower in q turns of the master;
//!                                           x/H: one more turn a lead that an axis travels (hobbing a helix)
//!
//!   Spinning ── same speed (coarse) ──► Phasing ── gap gone (fine) ──► Locked
//! ```
//!
//! The master's angle is split into whole cycles of q turns, each of which is exactly p turns of
//! the follower, and a rest below q. Only the rest is multiplied by p/q, so no rounding adds up,
//! however long the gear runs.
//!
//! Engaging at speed: while *spinning* the follower is only told the speed it will have. Once it
//! has it, the gap to its place on the gear, less than half a turn, is closed by a smooth move on
//! top of the gear (*phasing*).
//!
//! Source: `G51.2 P Q R` of lathes with two spindles; JP7525593B2 for what it is used for.
use crate::{Blend, Rotation};
use units::{Accel, Angle, Lead, Length, Speed, Spin, SpinAccel, Time};

/// The gear's law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    follower_turns: f64,
    master_turns: f64,
    phase: Angle,
    lead: Option<Lead>,
}

/// How an axis that is a second master moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Travel {
    /// Where it is.
    pub position: Length,
    /// Its rate.
    pub speed: Speed,
    /// The rate of that.
    pub accel: Accel,
}

impl Gear {
    /// A gear of `follower` turns in `master` turns (above zero), the follower standing at `phase`
    /// when the masters are at zero; with a lead, an axis is a second master.
    pub fn new(follower: i32, master: i32, phase: Angle, lead: Option<Lead>) -> Self {
        Self {
            follower_turns: f64::from(follower),
            master_turns: f64::from(master.max(1)),
            phase,
            lead: lead.filter(|lead| *lead != Lead::ZERO),
        }
    }

    /// Turns of the follower per turn of the master.
    pub fn ratio(&self) -> f64 {
        self.follower_turns / self.master_turns
    }

    /// Where the follower belongs, and how it turns there.
    pub fn follow(&self, master: Rotation, axis: Travel) -> Rotation {
        let (ratio, theta) = (self.ratio(), master.angle.value());
        let cycles = libm::floor(theta / self.master_turns);
        let rest = theta - cycles * self.master_turns;
        let angle = cycles * self.follower_turns + rest * ratio;
        let (mut spin, mut accel) = (master.spin * ratio, master.accel * ratio);
        let mut more = Angle::ZERO;
        if let Some(lead) = self.lead {
            more = axis.position / lead;
            let per_mm = 1.0 / lead.value();
            spin += Spin::rev_per_s(axis.speed.value() * per_mm);
            accel += SpinAccel::rev_per_s2(axis.accel.value() * per_mm);
        }
        Rotation { angle: Angle::rev(angle) + more + self.phase, spin, accel }
    }
}

/// How fast a gap in the phase may be closed, and when it counts as closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engaging {
    /// Fastest relative turn.
    pub spin: Spin,
    /// Its fastest change.
    pub accel: SpinAccel,
    /// The follower's angle is within this of the gear.
    pub fine: Angle,
    /// And has been for this long.
    pub settle: Time,
}

/// How far the follower has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Engagement {
    /// Told the gear's speed only.
    Spinning,
    /// Led by angle; the gap is being closed, since a while.
    Phasing {
        /// From the gap to nothing.
        gap: Blend,
        /// For so long.
        since: Time,
        /// Within the fine window for so long.
        inside: Time,
    },
    /// On the gear.
    Locked,
}

impl Engagement {
    /// The follower has the gear's speed: begin to close what its phase lacks. `place` is where it
    /// is, `belongs` where the gear has it. The follower's angle counts turns; whole ones do not
    /// matter.
    #[must_use]
    pub fn phasing(place: Angle, belongs: Angle, limits: &Engaging) -> Self {
        let gap = (place - belongs).value();
        let within = gap - libm::round(gap);
        let gap = Blend::new(within, 0.0, limits.spin.value(), limits.accel.value());
        Self::Phasing { gap, since: Time::ZERO, inside: Time::ZERO }
    }

    /// A period later; `error` is the follower's distance from its setpoint.
    #[must_use]
    pub fn next(self, period: Time, error: Angle, limits: &Engaging) -> Self {
        match self {
            Self::Phasing { gap, since, inside } => {
                let since = since + period;
                let closed = since.value() >= gap.duration_s() && error.abs() <= limits.fine;
                let inside = if closed { inside + period } else { Time::ZERO };
                if inside > limits.settle {
                    Self::Locked
                } else {
                    Self::Phasing { gap, since, inside }
                }
            }
            Self::Spinning | Self::Locked => self,
        }
    }

    /// What is added to the gear's setpoint while the gap is being closed.
    pub fn offset(&self, later: Time) -> Rotation {
        match self {
            Self::Phasing { gap, since, .. } => {
                let at = gap.at((*since + later).value());
                Rotation {
                    angle: Angle::rev(at.s),
                    spin: Spin::rev_per_s(at.v),
                    accel: SpinAccel::rev_per_s2(at.a),
                }
            }
            Self::Spinning | Self::Locked => Rotation::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Of an encoder.
    const COUNTS: i64 = 1 << 20;

    fn at(turns: f64) -> Rotation {
        Rotation { angle: Angle::rev(turns), ..Rotation::default() }
    }

    #[test]
    fn a_tool_at_two_to_one_turns_twice_from_its_phase() {
        let gear = Gear::new(2, 1, Angle::deg(30.0), None);
        let angle = gear.follow(at(10.25), Travel::default()).angle;
        assert!((angle.value() - (20.5 + 30.0 / 360.0)).abs() < 1e-12);
    }

    #[test]
    fn a_helix_adds_a_turn_for_each_lead_of_travel() {
        let gear = Gear::new(1, 40, Angle::ZERO, Some(Lead::mm_per_rev(200.0)));
        let travel = Travel {
            position: Length::mm(50.0),
            speed: Speed::mm_per_s(20.0),
            ..Travel::default()
        };
        let follower = gear.follow(at(0.0), travel);
        assert!((follower.angle.value() - 0.25).abs() < 1e-12);
        assert!((follower.spin.value() - 0.1).abs() < 1e-12);
    }

    proptest! {
        /// Against the rational numbers themselves: follower = p·(turns + count/2²⁰)/q, whole turns
        /// left out.
        #[test]
        fn a_thousand_million_turns_leave_no_drift(
            p in 1..10_000_i64, q in 1..10_000_i64, backwards: bool,
            turns in 990_000_000..1_010_000_000_i64, count in 0..COUNTS,
        ) {
            let p = if backwards { -p } else { p };
            prop_assume!(p.abs() <= 10 * q);
            let gear = Gear::new(p as i32, q as i32, Angle::ZERO, None);
            let theta = turns as f64 + count as f64 / COUNTS as f64;
            let found = gear.follow(at(theta), Travel::default()).angle.value();
            let counted = i128::from(p) * i128::from(turns * COUNTS + count);
            let exact = counted.rem_euclid(i128::from(q * COUNTS)) as f64 / (q * COUNTS) as f64;
            let off = found - exact;
            // the last bits of a number as large as the angle: after as many turns again no more of
            // them are lost
            let bits = 4.0 * f64::EPSILON * found.abs();
            prop_assert!((off - off.round()).abs() <= bits, "{p}:{q} at {theta}: {off}, {bits}");
        }

        #[test]
        fn the_gap_is_never_more_than_half_a_turn_and_ends_at_nothing(
            place in -1e4..1e4f64, belongs in -1e4..1e4f64,
        ) {
            let limits = Engaging {
                spin: Spin::rev_per_s(2.0),
                accel: SpinAccel::rev_per_s2(20.0),
                fine: Angle::deg(0.1),
                settle: Time::s(0.001),
            };
            let mut state = Engagement::phasing(Angle::rev(place), Angle::rev(belongs), &limits);
            prop_assert!(state.offset(Time::ZERO).angle.abs() <= Angle::rev(0.5 + 1e-9));
            let mut periods = 0;
            while state != Engagement::Locked {
                state = state.next(Time::s(250e-6), Angle::ZERO, &limits);
                periods += 1;
                prop_assert!(periods < 10_000);
            }
            prop_assert_eq!(state.offset(Time::ZERO).angle, Angle::ZERO);
        }

        #[test]
        fn the_speed_is_the_derivative_of_the_angle_across_cycles(
            follower in -9..9i32, master in 1..9i32, theta in -100.0..100.0f64,
        ) {
            let gear = Gear::new(follower, master, Angle::rev(0.1), None);
            let of = |turns| gear.follow(at(turns), Travel::default()).angle.value();
            let slope = (of(theta + 1e-4) - of(theta - 1e-4)) / 2e-4;
            prop_assert!((slope - gear.ratio()).abs() < 1e-6);
        }
    }
}
