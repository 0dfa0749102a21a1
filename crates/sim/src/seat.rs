//! A tap between its holder and its thread: one axial equilibrium.
//!
//! ```text
//!     spindle z ──╱╲╱╲╱── tap zt ──┤ c ├─╱╲╱╲╱── thread g(θ)          e = z − g(θ)   offset
//!                 kh (ks beyond s)       kf                            δ = zt − z     deflection
//!
//!     holder pulls the tap with −Fh(δ)     flanks with −Ff(δ + e)      Fh(δ) + Ff(δ + e) = 0
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | kh, s, ks | holder's stiffness, its travel to each side, its stop's stiffness | N/mm, mm, N/mm |
//! | kf, c | flanks' stiffness, whole play | N/mm, mm |
//! | x = \|e\| − c/2 | how far the springs are pressed together | mm |
//!
//! The tap has no mass worth speaking of (0.1 kg on 20 N/µm swings at 2 kHz), so the balance holds
//! at every instant. Both laws are odd, rising and made of straight pieces, so the answer is
//! closed:
//!
//! ```text
//!     x ≤ 0           δ = 0                               the tap floats
//!     within travel   |δ| = kf·x/(kf + kh)
//!     at the stop     |δ| = (kf·x + (ks − kh)·s)/(kf + ks)       δ is against e
//! ```
//!
//! Rigid (10–30 N/µm), soft-synchro (0.2–1 N/µm over ±0.5 mm) and tension/compression holders
//! (10–40 N/mm over ±8 mm) differ in numbers only. A clutch holder has another travel outwards (δ <
//! 0: its splines and a little more) than inwards. Source: springs in a row.
use crate::{CLUTCH_RUN_OUT, HOLDER_STOP, Tap};

/// Holder and flanks, N/mm and mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seat {
    holder: f64,
    /// How far the tap can be pulled out, and pushed in.
    out: f64,
    inward: f64,
    stop: f64,
    flank: f64,
    half_play: f64,
}

impl Seat {
    /// Of this tap.
    pub(crate) fn new(tap: &Tap) -> Self {
        let holder = tap.holder.stiffness.value();
        let travel = tap.holder.travel.map_or(f64::INFINITY, units::Length::value);
        let (out, inward) = tap.clutch.map_or((travel, travel), |clutch| {
            ((clutch.spline_length + CLUTCH_RUN_OUT).value(), clutch.compression.value())
        });
        Self {
            holder,
            out,
            inward,
            stop: holder.max(HOLDER_STOP.value()),
            flank: tap.flank_stiffness.value(),
            half_play: tap.flank_play.value() / 2.0,
        }
    }

    /// Deflection δ at an offset e, while `share` of the flanks is engaged.
    #[inline]
    pub(crate) fn deflection(&self, offset: f64, share: f64) -> f64 {
        let flank = self.flank * share;
        let push = flank * (offset.abs() - self.half_play).max(0.0);
        let within = push / (flank + self.holder);
        // a spindle above the helix pulls the tap out
        let travel = if offset > 0.0 { self.out } else { self.inward };
        let size = if within <= travel {
            within
        } else {
            (push + (self.stop - self.holder) * travel) / (flank + self.stop)
        };
        -size.copysign(offset)
    }

    /// How much of an offset that presses the flanks goes into the holder, while it is within its
    /// travel.
    #[inline]
    pub(crate) fn holder_share(&self, share: f64) -> f64 {
        let flank = self.flank * share;
        flank / (flank + self.holder)
    }

    /// Force of flanks pressed together by so much, all of them engaged.
    #[inline]
    pub(crate) fn flank_force(&self, pressed: f64) -> f64 {
        self.flank * pressed.max(0.0)
    }

    /// Force that a tap deflected by δ hands to the spindle, along +Z.
    #[inline]
    pub(crate) fn force(&self, deflection: f64) -> f64 {
        let size = deflection.abs();
        let travel = if deflection < 0.0 { self.out } else { self.inward };
        let beyond = (size - travel).max(0.0);
        (self.holder * (size - beyond) + self.stop * beyond).copysign(deflection)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Holder;
    use crate::fixtures::m6;
    use crate::oracle::thread::force_at_offset;
    use proptest::{prop_assert, proptest};
    use units::{Length, Stiffness};

    fn held(stiffness_n_per_mm: f64, travel_mm: f64) -> Tap {
        let stiffness = Stiffness::n_per_mm(stiffness_n_per_mm);
        Tap { holder: Holder { stiffness, travel: Some(Length::mm(travel_mm)) }, ..m6() }
    }

    #[test]
    fn within_the_play_the_tap_floats() {
        let seat = Seat::new(&m6());
        assert_eq!(seat.deflection(0.005, 1.0), 0.0);
        assert_eq!(seat.deflection(-0.0049, 1.0), 0.0);
    }

    #[test]
    fn the_three_holders_press_as_two_springs_in_a_row() {
        for tap in [m6(), held(500.0, 0.5), held(20.0, 8.0)] {
            let seat = Seat::new(&tap);
            for offset in [0.02, -0.05, 0.3, -0.4] {
                let (held_by, flank) = (tap.holder.stiffness, tap.flank_stiffness);
                let exact =
                    force_at_offset(Length::mm(offset), held_by, flank, tap.flank_play).value();
                // a tap that stands too high is pulled down by the thread
                let force = seat.force(seat.deflection(offset, 1.0));
                assert!(
                    (force + exact.copysign(offset)).abs() < 1e-9 * exact,
                    "{force} N, {exact} N"
                );
            }
        }
    }

    #[test]
    fn at_the_end_of_its_travel_a_soft_holder_turns_hard() {
        let seat = Seat::new(&held(500.0, 0.5));
        let (soft, hard) = (seat.deflection(0.4, 1.0), seat.deflection(0.6, 1.0));
        assert!(soft > -0.5 && hard < -0.5 && hard > -0.6);
        // 0.6 mm less half the play is 0.595 mm: 0.5 mm of it soft, the rest shared by stop and
        // flanks
        let flank = 100_000.0;
        let exact = (flank * 0.595 + (20_000.0 - 500.0) * 0.5) / (flank + 20_000.0);
        assert!((hard + exact).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn holder_and_flanks_always_balance(
            offset in -3.0..3.0_f64, share in 0.0..1.0_f64, k in 10.0..30_000.0_f64, travel in 0.0..8.0_f64,
        ) {
            let tap = held(k, travel);
            let seat = Seat::new(&tap);
            let deflection = seat.deflection(offset, share);
            let at = deflection + offset;
            let flank = tap.flank_stiffness.value() * share * (at - at.clamp(-0.005, 0.005));
            prop_assert!((seat.force(deflection) + flank).abs() < 1e-6 * (1.0 + flank.abs()));
        }
    }
}
