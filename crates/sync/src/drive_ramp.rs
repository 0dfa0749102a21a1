//! What a speed-commanded drive is about to do: it obeys after a delay, on the ramps that are set
//! in it.
//!
//! ```text
//!   told n ──► delay ──► ramp up, ramp down ──► speed, and its acceleration in the period now beginning
//! ```
//!
//! A model only: an observer that is told this acceleration has to learn no more than what the
//! drive does differently.
use units::{Spin, SpinAccel, Time};

/// Orders on their way to the drive; more than these in its delay, and the last one takes the place
/// of the one before.
const PENDING: usize = 8;

/// The model of a drive that is told speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveRamp {
    rates: (f64, f64),
    delay_s: f64,
    /// Since it was made, s.
    now_s: f64,
    told: f64,
    /// When the drive obeys, and which speed: the first `waiting` of them.
    pending: [(f64, f64); PENDING],
    waiting: usize,
    /// On its way from a speed to another one.
    ramp: Option<(f64, f64)>,
}

impl DriveRamp {
    /// A drive that was told to stand, which obeys after `delay`, with the accelerations with which
    /// it gains and loses speed.
    pub const fn new(delay: Time, gains: SpinAccel, loses: SpinAccel) -> Self {
        Self {
            rates: (gains.value(), loses.value()),
            delay_s: delay.value(),
            now_s: 0.0,
            told: 0.0,
            pending: [(0.0, 0.0); PENDING],
            waiting: 0,
            ramp: None,
        }
    }

    /// Told a speed, in this period.
    pub fn tell(&mut self, spin: Spin) {
        if spin.value() == self.told {
            return;
        }
        self.told = spin.value();
        let at = self.waiting.min(PENDING - 1);
        self.pending[at] = (self.now_s + self.delay_s, self.told);
        self.waiting = at + 1;
    }

    /// A period later: the mean acceleration in the period that begins now. `seen`: how fast it
    /// turns, from where a ramp begins.
    pub fn advance(&mut self, period: Time, seen: Spin) -> SpinAccel {
        let h = period.value();
        self.now_s += h;
        while self.waiting > 0 && self.pending[0].0 < self.now_s + h / 2.0 {
            let from = self.ramp.map_or(seen.value(), |(from, _)| from);
            self.ramp = Some((from, self.pending[0].1));
            self.pending.rotate_left(1);
            self.waiting -= 1;
        }
        let Some((from, to)) = self.ramp else { return SpinAccel::ZERO };
        let gains = from * to >= 0.0 && to.abs() > from.abs();
        let most = if gains { self.rates.0 } else { self.rates.1 } * h;
        let by = (to - from).clamp(-most, most);
        self.ramp = (from + by != to).then_some((from + by, to));
        SpinAccel::rev_per_s2(by / h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: Time = Time::s(1e-3);

    #[test]
    fn it_obeys_after_its_delay_and_on_its_ramps() {
        let mut drive = DriveRamp::new(
            Time::s(5e-3),
            SpinAccel::rev_per_s2(50.0),
            SpinAccel::rev_per_s2(100.0),
        );
        drive.tell(Spin::rev_per_s(10.0));
        let mut spin = 0.0;
        for k in 1..=400 {
            let accel = drive.advance(H, Spin::rev_per_s(spin)).value();
            // 5 ms, and 0.2 s from rest to 10 rev/s
            let expected = if (5..205).contains(&k) { 50.0 } else { 0.0 };
            assert!((accel - expected).abs() < 1e-6, "{accel} rev/s2 in period {k}");
            spin += accel * H.value();
        }
        drive.tell(Spin::rev_per_s(-10.0));
        let mut ramps = (0, 0);
        for _ in 0..400 {
            let accel = drive.advance(H, Spin::rev_per_s(spin)).value();
            spin += accel * H.value();
            ramps.0 += u32::from((accel + 100.0).abs() < 1e-6);
            ramps.1 += u32::from((accel + 50.0).abs() < 1e-6);
        }
        // 0.1 s down, 0.2 s up on the other side; the period in which it passes zero belongs to
        // either
        assert!((99..=101).contains(&ramps.0) && (197..=201).contains(&ramps.1), "{ramps:?}");
        assert!((spin + 10.0).abs() < 1e-9, "{spin} rev/s");
    }

    #[test]
    fn a_ramp_begins_at_the_speed_that_is_seen() {
        let rate = SpinAccel::rev_per_s2(100.0);
        let mut drive = DriveRamp::new(Time::ZERO, rate, rate);
        drive.tell(Spin::rev_per_s(10.0));
        let way: f64 =
            (0..200).map(|_| drive.advance(H, Spin::rev_per_s(9.0)).value() * H.value()).sum();
        assert!((way - 1.0).abs() < 1e-9, "{way} rev/s");
    }

    #[test]
    fn a_speed_that_changes_each_period_ends_at_the_last_one() {
        let rate = SpinAccel::rev_per_s2(100.0);
        let mut drive = DriveRamp::new(Time::s(0.05), rate, rate);
        let mut spin = 0.0;
        for k in 0..1000 {
            drive.tell(Spin::rev_per_s(f64::from(k.min(500)) * 0.01));
            spin += drive.advance(H, Spin::rev_per_s(spin)).value() * H.value();
        }
        assert!((spin - 5.0).abs() < 1e-6, "{spin} rev/s");
    }
}
