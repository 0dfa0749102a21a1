//! How a spindle comes to rest whose drive is only told a speed and makes its own ramps.
//!
//! ```text
//!   n │─────╮ told to stand (or to turn back)
//!     │  τ   ╲  a                       N(n) = n·τ + n²/2a      turns from the order to rest
//!     │       ╲
//!     └────────╲──► t                   told when the turns left are N(n), it comes to rest on the spot
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | n | speed when it is told | rev/s |
//! | τ | from the order until the drive obeys | s |
//! | a | the drive's deceleration | rev/s² |
//! | N | stopping angle | rev |
//!
//! The machine's file knows τ and a as they were measured or set; the machine itself may
//! differ. A stroke that only slows down to a creep shows the real a on the way, since from n₀ to n
//! the spindle turns (n₀² − n²)/2a.
use units::{Angle, Spin, SpinAccel, Time};

/// A ramp shorter than this share of what its file says is an error of measuring.
const LEAST_RAMP: f64 = 0.1;

/// Angle a master turns until it stands, at a constant deceleration: ω²/2a.
pub fn stopping_angle(spin: Spin, deceleration: SpinAccel) -> Angle {
    Angle::rev(spin.value() * spin.value() / (2.0 * deceleration.value().abs()))
}

/// Delay and deceleration of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopping {
    /// τ.
    pub delay: Time,
    /// a, magnitude.
    pub decel: SpinAccel,
}

impl Stopping {
    /// N(n): turns from the order to rest.
    pub fn angle(&self, spin: Spin) -> Angle {
        spin.abs() * self.delay + stopping_angle(spin, self.decel)
    }

    /// The same while it still gains speed, which it goes on doing until the drive obeys:
    /// nτ + aτ²/2 + (n + aτ)²/2d.
    pub fn angle_while(&self, spin: Spin, accel: SpinAccel) -> Angle {
        let n = spin.abs();
        let gained: Spin = accel * self.delay;
        (n + gained / 2.0) * self.delay + stopping_angle(n + gained, self.decel)
    }

    /// The same drive with the deceleration that it showed: it was at `from`, and at `to` after
    /// `turned`. `None` if it had not slowed down enough by then to tell.
    pub fn shown(&self, from: Spin, to: Spin, turned: Angle) -> Option<Self> {
        let braked = turned.value();
        let squares = from.value() * from.value() - to.value() * to.value();
        let decel = SpinAccel::rev_per_s2(squares / (2.0 * braked));
        (braked > 0.0 && squares > 0.0).then_some(Self { decel, ..*self })
    }

    /// The same drive, if from a speed it needs so many turns more than by delay and deceleration.
    /// What would leave no turns to brake is not believed.
    #[must_use]
    pub(crate) fn later_by(&self, early: Angle, from: Spin) -> Self {
        let ramp = stopping_angle(from, self.decel);
        let longer = ramp + early;
        let share = if longer > ramp * LEAST_RAMP { ramp / longer } else { 1.0 };
        Self { decel: self.decel * share, ..*self }
    }

    /// The same drive, if its deceleration is less by so much of itself.
    #[must_use]
    pub(crate) fn slower_by(&self, share: f64) -> Self {
        Self { decel: self.decel / (1.0 + share), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRIVE: Stopping = Stopping { delay: Time::s(0.01), decel: SpinAccel::rev_per_s2(100.0) };

    #[test]
    fn a_spindle_at_6000_rpm_braked_at_400_rev_per_s2_turns_twelve_and_a_half_times() {
        let angle = stopping_angle(Spin::rpm(6000.0), SpinAccel::rev_per_s2(-400.0));
        assert_eq!(angle, Angle::rev(12.5));
    }

    #[test]
    fn the_delay_adds_the_turns_of_its_time() {
        // 50 rev/s for 10 ms, then 50²/200
        assert!((DRIVE.angle(Spin::rpm(-3000.0)).value() - 13.0).abs() < 1e-12);
    }

    #[test]
    fn a_spindle_that_gains_speed_goes_on_doing_so_until_the_drive_obeys() {
        // 40 rev/s, 100 rev/s² for 10 ms: 0.405 rev and 41 rev/s, then 41²/200
        let angle = DRIVE.angle_while(Spin::rev_per_s(40.0), SpinAccel::rev_per_s2(100.0));
        assert!((angle.value() - 0.405 - 8.405).abs() < 1e-12, "{angle:?}");
    }

    #[test]
    fn what_a_drive_shows_on_its_way_to_a_creep_is_its_deceleration() {
        // really 80 rev/s²: from 50 to 5 rev/s it turns (2500 − 25)/160
        let turned = Angle::rev(2475.0 / 160.0);
        let shown = DRIVE.shown(Spin::rev_per_s(50.0), Spin::rev_per_s(5.0), turned);
        assert!((shown.expect("it braked").decel.value() - 80.0).abs() < 1e-9);
        assert_eq!(DRIVE.shown(Spin::rev_per_s(5.0), Spin::rev_per_s(5.0), Angle::rev(0.01)), None);
    }
}
