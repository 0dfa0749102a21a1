//! The harmonics of a function of one turn.
//!
//! ```text
//!    x(θ) = c₀ + 2·Re Σ c_k·exp(2πi·k·θ)          k: waves a turn
//! ```
//!
//! A lag delays each harmonic by its own angle and shrinks it by its own share, so what a machine
//! does to a profile is one complex factor a harmonic, and what must be sent to get a profile is
//! its inverse.
//!
//! The transform is the plain sum over N nodes with one table of N cosines: N·K products, a
//! millisecond for 720 nodes and 200 harmonics, once a revolution and outside the tick.
use alloc::{vec, vec::Vec};
use core::f64::consts::TAU;
use core::ops::{Add, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// One.
    pub const ONE: Self = Self { re: 1.0, im: 0.0 };

    /// Of magnitude `gain` at an angle of `turn` revolutions.
    pub fn polar(gain: f64, turn: f64) -> Self {
        let (sin, cos) = libm::sincos(TAU * turn);
        Self { re: gain * cos, im: gain * sin }
    }

    /// Magnitude.
    pub fn size(self) -> f64 {
        libm::hypot(self.re, self.im)
    }

    /// Angle in revolutions, −½ to ½.
    pub fn turn(self) -> f64 {
        libm::atan2(self.im, self.re) / TAU
    }

    /// Mirrored at the real axis.
    #[must_use]
    pub const fn conjugate(self) -> Self {
        Self { re: self.re, im: -self.im }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { re: self.re + o.re, im: self.im + o.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self { re: self.re - o.re, im: self.im - o.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }
}

impl Mul<f64> for Complex {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let size = o.re * o.re + o.im * o.im;
        self * o.conjugate() * (1.0 / size)
    }
}

/// Harmonics 0 to K of a function of one turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// From c₀ on.
    pub harmonics: Vec<Complex>,
}

/// Cosines and sines of i/N turns.
fn circle(nodes: usize) -> (Vec<f64>, Vec<f64>) {
    let angle = |i: usize| TAU * i as f64 / nodes as f64;
    (
        (0..nodes).map(|i| libm::cos(angle(i))).collect(),
        (0..nodes).map(|i| libm::sin(angle(i))).collect(),
    )
}

impl Spectrum {
    /// Of node values at θ = i/N, up to harmonic `most`; those from N/2 on do not exist and are
    /// left out.
    pub fn of(values: &[f64], most: usize) -> Self {
        let n = values.len();
        let (cosines, sines) = circle(n);
        let harmonic = |k: usize| {
            let (mut c, mut at) = (Complex::default(), 0);
            for value in values {
                c.re += value * cosines[at];
                c.im -= value * sines[at];
                at = (at + k) % n;
            }
            c * (1.0 / n as f64)
        };
        Self { harmonics: (0..=most.min(n.saturating_sub(1) / 2)).map(harmonic).collect() }
    }

    /// The values at θ = i/N.
    pub fn values(&self, nodes: usize) -> Vec<f64> {
        let (cosines, sines) = circle(nodes);
        let mut values = vec![0.0; nodes];
        for (k, c) in self.harmonics.iter().enumerate() {
            let (twice, mut at) = (if k == 0 { 1.0 } else { 2.0 }, 0);
            for value in &mut values {
                *value += twice * (c.re * cosines[at] - c.im * sines[at]);
                at = (at + k) % nodes;
            }
        }
        values
    }

    /// The same function later by an angle of `turn` revolutions: x(θ − turn).
    #[must_use]
    pub fn later(&self, turn: f64) -> Self {
        let shifted = |(k, c): (usize, &Complex)| *c * Complex::polar(1.0, -(k as f64) * turn);
        Self { harmonics: self.harmonics.iter().enumerate().map(shifted).collect() }
    }

    /// How many lobes a turn repeat: the greatest number that divides every harmonic that counts.
    /// 1: no symmetry.
    pub fn lobes(&self) -> usize {
        /// A harmonic smaller than this share of the largest is rounding of the table.
        const ROUNDING: f64 = 1e-4;
        let largest = self.harmonics.iter().skip(1).map(|c| c.size()).fold(0.0, f64::max);
        let counts = |c: &Complex| c.size() > ROUNDING * largest;
        let mut lobes = 0;
        for (k, _) in self.harmonics.iter().enumerate().skip(1).filter(|(_, c)| counts(c)) {
            lobes = common_divisor(lobes, k);
        }
        lobes.max(1)
    }
}

fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_cosine_is_one_harmonic_of_half_its_amplitude() {
        let values: Vec<f64> = (0..720)
            .map(|i| 7.0 + 3.0 * f64::cos(TAU * (5.0 * f64::from(i) / 720.0 - 0.1)))
            .collect();
        let s = Spectrum::of(&values, 20);
        assert!((s.harmonics[0].re - 7.0).abs() < 1e-12);
        assert!((s.harmonics[5].size() - 1.5).abs() < 1e-12);
        assert!((s.harmonics[5].turn() + 0.1).abs() < 1e-12);
        assert!(s.harmonics[4].size() < 1e-12);
        assert_eq!(s.lobes(), 5);
    }

    proptest! {
        #[test]
        fn all_harmonics_together_are_the_function_again(values in prop::collection::vec(-10.0..10.0f64, 9..40)) {
            // an odd number of nodes has no harmonic at N/2 that would be lost
            let values = &values[..values.len() - 1 + values.len() % 2];
            let back = Spectrum::of(values, usize::MAX).values(values.len());
            for (a, b) in values.iter().zip(&back) {
                prop_assert!((a - b).abs() < 1e-10);
            }
        }

        #[test]
        fn later_by_one_node_is_the_next_node(values in prop::collection::vec(-10.0..10.0f64, 15usize)) {
            let later = Spectrum::of(&values, 99).later(1.0 / 15.0).values(15);
            for i in 0..15 {
                prop_assert!((later[(i + 1) % 15] - values[i]).abs() < 1e-10);
            }
        }
    }
}
