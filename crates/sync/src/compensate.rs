//! Sending a profile so that its follower comes out where it should: by shift, and by the answer of
//! each harmonic.
//!
//! ```text
//!   command at master angle t:   D(t + Δθ)            Δθ positive (late): send what comes later
//!
//!   (1) by addresses   Δθ rounded to whole steps of the table: the source's, leaves up to half a step
//!   (2) by fraction    Δθ as it is
//!   (3) by harmonics   U_k = D_k / H_k                H_k: what the machine made of harmonic k
//! ```
//!
//! A lag delays and shrinks each harmonic by its own amount, and no shift mends that: (3) does. H
//! belongs to the frequency k·n, not to the profile, so what is known at one speed serves another
//! one as far as its frequencies reach. Where H is not known, or so small that the command would
//! grow beyond [`MOST_BOOST`], the harmonic is sent as it is.
//!
//! The wrong sign doubles the error instead of removing it.
use crate::spectrum::{Complex, Spectrum};
use alloc::vec::Vec;
use core::f64::consts::TAU;
use units::{Angle, Spin};

/// No harmonic is sent more than so many times as large as it shall come out.
pub const MOST_BOOST: f64 = 6.0;

/// Δθ in whole addresses of a table of `nodes`, as the source compensates; the fraction is lost.
pub fn whole_addresses(shift: Angle, nodes: usize) -> Angle {
    let step = 1.0 / nodes as f64;
    Angle::rev(libm::round(shift.value() / step) * step)
}

/// The node values to send for a follower that is late by `shift`.
pub fn advanced(ideal: &[f64], shift: Angle) -> Vec<f64> {
    Spectrum::of(ideal, usize::MAX).later(-shift.value()).values(ideal.len())
}

/// Phase errors of one profile at several speeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShiftOverSpeed {
    /// By rising speed.
    points: Vec<(Spin, Angle)>,
}

/// A speed that was not measured, nor lies between two that were.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotMeasured {
    /// At no speed at all.
    Nowhere,
    /// Beyond what was measured.
    Beyond {
        /// The slowest speed measured.
        slowest: Spin,
        /// The fastest.
        fastest: Spin,
    },
}

impl core::fmt::Display for NotMeasured {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Nowhere => f.write_str("the phase error has not been measured at any speed"),
            Self::Beyond { slowest, fastest } => write!(
                f,
                "the phase error has been measured from {:.1} to {:.1} rpm only",
                slowest.in_rpm(),
                fastest.in_rpm()
            ),
        }
    }
}

impl core::error::Error for NotMeasured {}

impl ShiftOverSpeed {
    /// From measurements in any order; of two at one speed the later one counts.
    pub fn new(measured: impl IntoIterator<Item = (Spin, Angle)>) -> Self {
        let mut points: Vec<(Spin, Angle)> = Vec::new();
        for (spin, shift) in measured {
            match points.binary_search_by(|p| p.0.value().total_cmp(&spin.value())) {
                Ok(same) => points[same].1 = shift,
                Err(place) => points.insert(place, (spin, shift)),
            }
        }
        Self { points }
    }

    /// Δθ at a speed, between two measured ones by a straight line.
    ///
    /// # Errors
    /// The speed lies outside of what was measured by more than a thousandth.
    pub fn at(&self, spin: Spin) -> Result<Angle, NotMeasured> {
        const SAME: f64 = 1e-3;
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else {
            return Err(NotMeasured::Nowhere);
        };
        let slack = spin.abs() * SAME;
        if spin < first.0 - slack || spin > last.0 + slack || !spin.is_finite() {
            return Err(NotMeasured::Beyond { slowest: first.0, fastest: last.0 });
        }
        let upper = self.points.partition_point(|p| p.0 < spin).min(self.points.len() - 1);
        let lower = upper.saturating_sub(1);
        let ((n0, a0), (n1, a1)) = (self.points[lower], self.points[upper]);
        if n1 == n0 {
            return Ok(a1);
        }
        let share = ((spin - n0) / (n1 - n0)).clamp(0.0, 1.0);
        Ok(a0 + (a1 - a0) * share)
    }
}

/// A drive's loops, as its machine's file has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLoops {
    /// K, 1/s.
    pub position_gain: f64,
    /// ω/2π of the speed loop, Hz.
    pub bandwidth_hz: f64,
    /// φ, share of the speed that is fed forward.
    pub speed_share: f64,
    /// α, share of the acceleration that is fed forward.
    pub accel_share: f64,
}

/// What a machine makes of a sine, by frequency.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Frequency in Hz and answer, by rising frequency.
    points: Vec<(f64, Complex)>,
}

impl Response {
    /// From what was sent and what came at a speed; harmonics of the command below `smallest` are
    /// not believed.
    pub fn of(command: &Spectrum, answer: &Spectrum, spin: Spin, smallest: f64) -> Self {
        let pairs = command.harmonics.iter().zip(&answer.harmonics).enumerate().skip(1);
        let heard = pairs.filter(|(_, (sent, _))| sent.size() > smallest);
        let points = heard.map(|(k, (sent, came))| (k as f64 * spin.abs().value(), *came / *sent));
        Self { points: points.filter(|(_, h)| h.size() > 1.0 / MOST_BOOST).collect() }
    }

    /// Points as frequency in Hz, gain, and delay in turns of the wave.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.points.iter().map(|(hz, h)| (*hz, h.size(), -h.turn()))
    }

    /// From such points, in rising order of frequency; others are left out.
    pub fn from_points(points: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        let mut kept: Vec<(f64, Complex)> = Vec::new();
        for (hz, gain, delay) in points {
            let sound = hz > 0.0 && gain > 0.0 && (hz + gain + delay).is_finite();
            if sound && kept.last().is_none_or(|last| last.0 < hz) {
                kept.push((hz, Complex::polar(gain, -delay)));
            }
        }
        Self { points: kept }
    }

    /// As it follows from a drive's loops, up to a frequency, where nothing was measured: s²x =
    /// C·(K(u − x) + φs·u − s·x) + αs²·u with C = ω + ω²/4s.
    pub fn of_loops(loops: &DriveLoops, highest_hz: f64) -> Self {
        /// Points of it.
        const POINTS: u32 = 200;
        let at = |i: u32| {
            let hz = highest_hz * f64::from(i) / f64::from(POINTS);
            let s = Complex { re: 0.0, im: TAU * hz };
            let w = Complex { re: TAU * loops.bandwidth_hz, im: 0.0 };
            let gain = Complex { re: loops.position_gain, im: 0.0 };
            let control = w + w * w / (s * 4.0);
            let sent = control * (gain + s * loops.speed_share) + s * s * loops.accel_share;
            (hz, sent / (s * s + control * (s + gain)))
        };
        Self { points: (1..=POINTS).map(at).collect() }
    }

    /// At a frequency, between known ones; below the lowest it goes to one, and beyond the highest
    /// nothing is known.
    pub fn at(&self, hz: f64) -> Option<Complex> {
        let upper = self.points.partition_point(|p| p.0 < hz * (1.0 - 1e-9));
        let (high, h1) = *self.points.get(upper)?;
        let (low, h0) = match upper.checked_sub(1) {
            Some(lower) => self.points[lower],
            None => (0.0, Complex::ONE),
        };
        let share = (hz - low) / (high - low);
        // gain and angle each along a line; neighbours differ by less than half a turn
        let turned = (h1 / h0).turn();
        Some(Complex::polar(
            h0.size() + (h1.size() - h0.size()) * share,
            h0.turn() + turned * share,
        ))
    }

    /// What to send so that `ideal` comes out at a speed.
    pub fn precompensated(&self, ideal: &Spectrum, spin: Spin) -> Spectrum {
        let sent = |(k, d): (usize, &Complex)| match self.at(k as f64 * spin.abs().value()) {
            Some(h) if k > 0 && h.size() > 1.0 / MOST_BOOST => *d / h,
            _ => *d,
        };
        Spectrum { harmonics: ideal.harmonics.iter().enumerate().map(sent).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;
    use proptest::prelude::*;

    fn wave(phase: f64) -> Vec<f64> {
        (0..720).map(|i| f64::cos(TAU * (f64::from(i) / 720.0 * 3.0 - phase))).collect()
    }

    fn rms(a: &[f64], b: &[f64]) -> f64 {
        (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
    }

    #[test]
    fn what_is_late_is_sent_early_and_the_wrong_sign_doubles_the_error() {
        let late = Angle::deg(2.0);
        let machine = |sent: &[f64]| advanced(sent, -late);
        let ideal = wave(0.0);
        let before = rms(&machine(&ideal), &ideal);
        let after = rms(&machine(&advanced(&ideal, late)), &ideal);
        let wrong = rms(&machine(&advanced(&ideal, -late)), &ideal);
        assert!(after < 1e-9, "{after}");
        assert!((wrong / before - 2.0).abs() < 0.02, "{wrong} {before}");
    }

    #[test]
    fn loops_without_feed_forward_lag_by_the_speed_over_the_gain_and_with_all_of_it_not_at_all() {
        let bare = DriveLoops {
            position_gain: 120.0,
            bandwidth_hz: 100.0,
            speed_share: 0.0,
            accel_share: 0.0,
        };
        let slow = Response::of_loops(&bare, 100.0).at(0.5).unwrap();
        // late by 1/K s: at half a hertz 0.5/120 turns of the wave
        assert!(
            (slow.turn() + 0.5 / 120.0).abs() < 1e-5 && (slow.size() - 1.0).abs() < 1e-3,
            "{slow:?}"
        );
        let led = DriveLoops { speed_share: 1.0, accel_share: 1.0, ..bare };
        for hz in [1.0, 30.0, 99.0] {
            let h = Response::of_loops(&led, 100.0).at(hz).unwrap();
            assert!((h - Complex::ONE).size() < 1e-9);
        }
    }

    #[test]
    fn whole_addresses_leave_at_most_half_of_one() {
        for tenth in -100..100 {
            let shift = Angle::deg(f64::from(tenth) / 10.0 + 0.01);
            let left = whole_addresses(shift, 720) - shift;
            assert!(left.abs().in_deg() <= 0.25 + 1e-9);
        }
        assert_eq!(whole_addresses(Angle::deg(1.3), 720).in_deg(), 1.5);
    }

    #[test]
    fn between_two_speeds_a_line_and_beyond_them_a_refusal() {
        let table = ShiftOverSpeed::new([
            (Spin::rpm(60.0), Angle::deg(3.0)),
            (Spin::rpm(10.0), Angle::deg(0.5)),
            (Spin::rpm(60.0), Angle::deg(3.1)),
        ]);
        assert_eq!(table.at(Spin::rpm(10.0)), Ok(Angle::deg(0.5)));
        assert!((table.at(Spin::rpm(35.0)).unwrap().in_deg() - 1.8).abs() < 1e-9);
        let refused = table.at(Spin::rpm(61.0)).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "the phase error has been measured from 10.0 to 60.0 rpm only"
        );
        assert_eq!(ShiftOverSpeed::default().at(Spin::rpm(1.0)), Err(NotMeasured::Nowhere));
    }

    /// A lag of first order, 1/(1 + i·f/f₀).
    fn lag(hz: f64) -> Complex {
        Complex::ONE / Complex { re: 1.0, im: hz / 19.1 }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(test_support::size::of(40, 800)))]
        #[test]
        fn an_answer_measured_at_one_speed_serves_every_slower_one(rpm in 5.0..60.0f64) {
            let through = |s: &Spectrum, n: Spin| Spectrum {
                harmonics: s.harmonics.iter().enumerate().map(|(k, c)| *c * lag(k as f64 * n.value())).collect(),
            };
            let tooth: Vec<f64> = (0..720).map(|i| f64::from((i - 360i32).abs()).min(90.0) / 90.0).collect();
            let ideal = Spectrum::of(&tooth, 40);
            let known = Response::of(&ideal, &through(&ideal, Spin::rpm(60.0)), Spin::rpm(60.0), 1e-4);
            let spin = Spin::rpm(rpm);
            let error = |sent: &Spectrum| rms(&through(sent, spin).values(720), &ideal.values(720));
            let (before, after) = (error(&ideal), error(&known.precompensated(&ideal, spin)));
            prop_assert!(after < 0.1 * before, "{before} {after}");
        }
    }
}
