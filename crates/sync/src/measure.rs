//! Measuring a periodic coupling: what the follower did over the master's angle, and by which angle
//! it is late.
//!
//! ```text
//!    x │   ideal ╭──╮ ╭──╮ measured         Δθ = θ_measured − θ_ideal     late: positive
//!      │        ╱    ╳    ╲                 (a) maximum     where each has its top
//!      │   ────╱─a─►╱ ╲─b─►╲──── level      (b) flank mean  (a + b)/2 at a given lift
//!      │      ╱    ╱   ╲    ╲               (c) least squares  Δ that makes Σ(M(θ) − D(θ − Δ))² least
//!      └──────────────────────► θ
//! ```
//!
//! Samples of both encoders are taken at a fixed period. When the master passed each node of the
//! profile is found by interpolation of its angle over time, and the follower's place at that time
//! by a cubic through the four samples around it. Angles are smoothed by a straight line over a few
//! periods, since a master turns evenly and its counts are coarse.
//!
//! (a) and (b) are the source's; (c) weights every node by its slope, which is what a shift can
//! mend, and alone makes the contour error least. Its standard deviation is σ/√(Σ D′²), with σ the
//! noise of one node. A profile with m equal lobes says Δθ only modulo 1/m turn: the value next to
//! zero is taken.
//!
//! Source: JPH0622778B2, figures 5, 6, 11 and 12.
#![allow(clippy::cast_possible_wrap)] // nodes are far below 2⁶³
use crate::spectrum::{Complex, Spectrum};
use alloc::{vec, vec::Vec};
use core::f64::consts::TAU;
use units::{Angle, Length};

/// Where both stood at one sampling time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pair {
    /// The master's angle, unwrapped.
    pub angle: Angle,
    /// The follower's position.
    pub position: Length,
}

/// Samples on each side over which the angle is smoothed.
const SMOOTHED: usize = 6;
/// Harmonics that are looked at.
pub const HARMONICS: usize = 240;

/// Why samples give no profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasureError {
    /// They do not cover a whole turn.
    TooShort {
        /// What they cover.
        turned: Angle,
    },
    /// The master stood or turned back.
    NotTurning {
        /// At which sample, counted from 0.
        sample: usize,
    },
    /// A sample is not a finite number.
    NotFinite {
        /// Which, counted from 0.
        sample: usize,
    },
    /// Ideal and measured profile have different numbers of nodes, or too few.
    Nodes,
    /// The profile is round: it has no phase.
    Round,
}

impl core::fmt::Display for MeasureError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooShort { turned } => {
                write!(f, "expected samples of a whole turn, found {:.3} turns", turned.value())
            }
            Self::NotTurning { sample } => {
                write!(f, "the master does not turn on at sample {sample}")
            }
            Self::NotFinite { sample } => write!(f, "sample {sample} is not a finite number"),
            Self::Nodes => {
                f.write_str("ideal and measured profile differ in their number of nodes")
            }
            Self::Round => f.write_str("the profile is round and has no phase"),
        }
    }
}

impl core::error::Error for MeasureError {}

/// The follower's place at each of N angles of the master; the mean of all turns that the samples
/// cover.
///
/// # Errors
/// See [`MeasureError`].
pub fn fold(samples: &[Pair], nodes: usize) -> Result<Vec<f64>, MeasureError> {
    let bad = |p: &Pair| !(p.angle.is_finite() && p.position.is_finite());
    if let Some(sample) = samples.iter().position(bad) {
        return Err(MeasureError::NotFinite { sample });
    }
    let turned = match (samples.first(), samples.last()) {
        (Some(first), Some(last)) => last.angle - first.angle,
        _ => Angle::ZERO,
    };
    if turned.abs().value() < 1.0 || samples.len() < 4 {
        return Err(MeasureError::TooShort { turned });
    }
    let sense = turned.value().signum();
    let places = smoothed(samples, sense * nodes as f64);
    let (mut sums, mut counts) = (vec![0.0; nodes], vec![0u32; nodes]);
    for i in 0..places.len() - 1 {
        let (here, next) = (places[i], places[i + 1]);
        if next <= here {
            return Err(MeasureError::NotTurning { sample: i + 1 });
        }
        let mut node = libm::ceil(here);
        while node < next {
            let x = cubic(samples, i, (node - here) / (next - here));
            let index = libm::round(sense * node) as i64;
            let index = index.rem_euclid(nodes as i64) as usize;
            sums[index] += x;
            counts[index] += 1;
            node += 1.0;
        }
    }
    if counts.contains(&0) {
        return Err(MeasureError::TooShort { turned });
    }
    Ok(sums.iter().zip(&counts).map(|(sum, count)| sum / f64::from(*count)).collect())
}

/// Angles in nodes, in the sense of turning, each the value of a line through its neighbours.
fn smoothed(samples: &[Pair], nodes: f64) -> Vec<f64> {
    let n = samples.len();
    let origin = samples[0].angle;
    let raw: Vec<f64> = samples.iter().map(|p| (p.angle - origin).value()).collect();
    let value = |i: usize| {
        // a window that is symmetric about i: the mean of a line is its value in the middle
        let half = SMOOTHED.min(i).min(n - 1 - i);
        let window = &raw[i - half..=i + half];
        (window.iter().sum::<f64>() / window.len() as f64 + origin.value()) * nodes
    };
    (0..n).map(value).collect()
}

/// The position between samples i and i + 1.
fn cubic(samples: &[Pair], i: usize, f: f64) -> f64 {
    let x = |k: usize| samples[k].position.value();
    if i == 0 || i + 2 >= samples.len() {
        return x(i) + f * (x(i + 1) - x(i));
    }
    let (a, b, c, d) = (x(i - 1), x(i), x(i + 1), x(i + 2));
    // Lagrange through −1, 0, 1, 2
    -f * (f - 1.0) * (f - 2.0) / 6.0 * a + (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0 * b
        - (f + 1.0) * f * (f - 2.0) / 2.0 * c
        + (f + 1.0) * f * (f - 1.0) / 6.0 * d
}

/// A phase error and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Δθ: positive, the follower is late.
    pub shift: Angle,
    /// One standard deviation from the noise of the samples.
    pub sigma: Angle,
}

/// What a measurement says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseError {
    /// (a), by the places of the maxima.
    pub maximum: Estimate,
    /// (b), by the mean shift of the flanks.
    pub flanks: Estimate,
    /// (c), by least squares over all nodes.
    pub least_squares: Estimate,
    /// Noise of one node, mm.
    pub noise: Length,
    /// Equal lobes a turn: Δθ is known modulo one turn over this.
    pub lobes: usize,
}

/// Compare a measured profile with the ideal one; `level` is the share of the lift at which the
/// flanks are read.
///
/// # Errors
/// See [`MeasureError`].
pub fn phase_error(
    ideal: &[f64],
    measured: &[f64],
    level: f64,
) -> Result<PhaseError, MeasureError> {
    let n = ideal.len();
    if n != measured.len() || n < crate::FEWEST_NODES {
        return Err(MeasureError::Nodes);
    }
    let (d, m) = (Spectrum::of(ideal, HARMONICS), Spectrum::of(measured, HARMONICS));
    // Σ D′² over the nodes, by Parseval
    let square = |x: f64| x * x;
    let power = |k: usize, c: &Complex| 2.0 * square(TAU * k as f64 * c.size());
    let slope2: f64 =
        n as f64 * d.harmonics.iter().enumerate().map(|(k, c)| power(k, c)).sum::<f64>();
    let lift = spread(ideal);
    if lift.1 - lift.0 < 1e-9 {
        return Err(MeasureError::Round);
    }
    let lobes = d.lobes();
    let shift = best_shift(&d, &m, n, lobes);
    let shape = d.later(shift).values(n);
    let residual: Vec<f64> = measured.iter().zip(&shape).map(|(a, b)| a - b).collect();
    let noise = noise_of(&residual);
    let least_squares =
        Estimate { shift: Angle::rev(shift), sigma: Angle::rev(noise / libm::sqrt(slope2)) };
    let window = 0.5 / lobes as f64;
    Ok(PhaseError {
        maximum: by_maximum(ideal, measured, window, noise),
        flanks: by_flanks(ideal, measured, level, window, noise).unwrap_or(least_squares),
        least_squares,
        noise: Length::mm(noise),
        lobes,
    })
}

/// Smallest and largest.
fn spread(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)))
}

/// Standard deviation of what changes from node to node without pattern: by fourth differences.
pub(crate) fn noise_of(values: &[f64]) -> f64 {
    let n = values.len();
    let at = |i: usize| values[i % n];
    let fourth = |i: usize| at(i) - 4.0 * at(i + 1) + 6.0 * at(i + 2) - 4.0 * at(i + 3) + at(i + 4);
    let sum: f64 = (0..n).map(|i| fourth(i) * fourth(i)).sum();
    libm::sqrt(sum / (70.0 * n as f64)) // 1 + 16 + 36 + 16 + 1
}

/// The shift that maximises the correlation of D(θ − Δ) with M(θ), the real part of Σ
/// `M_k·conj(D_k)·exp(2πi·k·Δ)`.
fn best_shift(d: &Spectrum, m: &Spectrum, nodes: usize, lobes: usize) -> f64 {
    let product: Vec<Complex> =
        d.harmonics.iter().zip(&m.harmonics).map(|(d, m)| *m * d.conjugate()).collect();
    let terms = || product.iter().enumerate().skip(1);
    let table: Vec<Complex> =
        (0..nodes).map(|i| Complex::polar(1.0, i as f64 / nodes as f64)).collect();
    let reach = (nodes / (2 * lobes)).max(1) as i64;
    let coarse = (-reach..=reach).map(|j| {
        let at = |k: usize| table[(k as i64 * j).rem_euclid(nodes as i64) as usize];
        (terms().map(|(k, p)| (*p * at(k)).re).sum::<f64>(), j)
    });
    let top = coarse.fold((f64::NEG_INFINITY, 0_i64), |best, new| {
        let nearer = new.0 >= best.0 * (1.0 - 1e-9) && new.1.abs() < best.1.abs();
        if new.0 > best.0 * (1.0 + 1e-9) || nearer { new } else { best }
    });
    let mut shift = top.1 as f64 / nodes as f64;
    for _ in 0..8 {
        let (mut first, mut second) = (0.0, 0.0);
        for (k, p) in terms() {
            let w = TAU * k as f64;
            let c = *p * Complex::polar(1.0, k as f64 * shift);
            first -= w * c.im;
            second -= w * w * c.re;
        }
        if second >= 0.0 {
            break; // no maximum here: the coarse one stands
        }
        let step = (-first / second).clamp(-0.5 / nodes as f64, 0.5 / nodes as f64);
        shift += step;
    }
    shift
}

/// The vertex of the parabola through the top of a profile near node `from`, in nodes, and its
/// curvature.
fn vertex(values: &[f64], from: i64, reach: i64) -> (f64, f64) {
    let n = values.len() as i64;
    let at = |i: i64| values[i.rem_euclid(n) as usize];
    let top =
        (from - reach..=from + reach).fold(from, |best, i| if at(i) > at(best) { i } else { best });
    // the top is taken as far as it is within two percent of the lift
    let (low, high) = spread(values);
    let floor = at(top) - 0.02 * (high - low);
    let edge =
        |sign: i64| (1..=reach.max(2)).take_while(|i| at(top + sign * i) >= floor).count() as i64;
    let half = edge(1).min(edge(-1)).max(1);
    let (mut s2, mut s4, mut y, mut xy, mut x2y) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let count = (2 * half + 1) as f64;
    for i in -half..=half {
        let (x, v) = (i as f64, at(top + i) - at(top));
        s2 += x * x;
        s4 += x * x * x * x;
        y += v;
        xy += x * v;
        x2y += x * x * v;
    }
    let curve = (count * x2y - s2 * y) / (count * s4 - s2 * s2);
    let slope = xy / s2;
    let place =
        if curve < 0.0 { (-slope / (2.0 * curve)).clamp(-(half as f64), half as f64) } else { 0.0 };
    (top as f64 + place, libm::sqrt(s2) * curve.abs() * 2.0)
}

fn by_maximum(ideal: &[f64], measured: &[f64], window: f64, noise: f64) -> Estimate {
    let n = ideal.len();
    let (_, high) = spread(ideal);
    let top = ideal.iter().position(|v| *v >= high).unwrap_or(0) as i64;
    let reach = ((window * n as f64) as i64 - 1).max(1);
    let (is, _) = vertex(ideal, top, 2);
    let (was, weight) = vertex(measured, top, reach);
    Estimate {
        shift: Angle::rev((was - is) / n as f64),
        sigma: Angle::rev(noise / weight.max(1e-12) / n as f64),
    }
}

/// Angles in nodes at which a profile passes a height, and in which sense.
fn crossings(values: &[f64], height: f64) -> Vec<(f64, bool)> {
    let n = values.len();
    let pairs = (0..n).map(|i| (i, values[i] - height, values[(i + 1) % n] - height));
    let passes = pairs.filter(|(_, a, b)| (*a < 0.0) != (*b < 0.0));
    passes.map(|(i, a, b)| (i as f64 + a / (a - b), b > a)).collect()
}

fn by_flanks(
    ideal: &[f64],
    measured: &[f64],
    level: f64,
    window: f64,
    noise: f64,
) -> Option<Estimate> {
    let n = ideal.len() as f64;
    let (low, high) = spread(ideal);
    let (low_m, high_m) = spread(measured);
    let is = crossings(ideal, low + level * (high - low));
    let was = crossings(measured, low_m + level * (high_m - low_m));
    let (mut sums, mut counts, mut slopes) = ([0.0; 2], [0.0; 2], 0.0);
    for (place, rising) in &is {
        let nearest = was
            .iter()
            .filter(|(_, r)| r == rising)
            .map(|(other, _)| {
                let gap = (other - place) / n;
                gap - libm::round(gap)
            })
            .filter(|gap| gap.abs() <= window)
            .min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        sums[usize::from(*rising)] += nearest;
        counts[usize::from(*rising)] += 1.0;
        let i = *place as usize;
        slopes += (ideal[(i + 1) % ideal.len()] - ideal[i]).abs() * n;
    }
    if counts.contains(&0.0) {
        return None;
    }
    let shift = f64::midpoint(sums[0] / counts[0], sums[1] / counts[1]);
    let count = counts[0] + counts[1];
    let sigma = noise / (slopes / count) / libm::sqrt(count);
    Some(Estimate { shift: Angle::rev(shift), sigma: Angle::rev(sigma) })
}

#[cfg(test)]
#[path = "measure_tests.rs"]
mod tests;
