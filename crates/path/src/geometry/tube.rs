//! The curve of a given basis that bends least within the tolerance.
//!
//! ```text
//!   minimise ½·Σ lₖ·|q″ₖ|²    so that    |Bᵢ·c − pᵢ| ≤ r·Pᵢ  at every sample i
//! ```
//!
//! By the alternating direction method of multipliers (Boyd et al., *Distributed Optimization and
//! Statistical Learning via ADMM*, 2011, ch. 3): zᵢ stands for Bᵢ·c and stays within the tolerance,
//! uᵢ gathers what keeps them apart. Each round solves
//!
//! ```text
//!   (H + Σ ρᵢ·Bᵢᵀ·Bᵢ)·c = Σ ρᵢ·Bᵢᵀ·(zᵢ − uᵢ)
//! ```
//!
//! whose matrix, a band of four, is factored once. ρᵢ goes with 1/h³ of the sample's span, as H
//! does, so that short spans beside long ones are as quick.
use super::sample::{NEAR, Sample};
use crate::banded::Banded;
use alloc::vec::Vec;
use motion::Point;

/// r of the header; samples are good up to [`NEAR`].
const RADIUS: f64 = 0.982;
/// Rounds at most, and at least.
const ROUNDS: usize = 48;
const LEAST: usize = 12;
/// How far beyond the solution a round goes, which ends the search sooner.
const RELAXED: f64 = 1.6;
/// Of ρ over 1/h³.
const STIFF: f64 = 0.3;
/// Control points at each end that are given.
const GIVEN: usize = 3;

/// Position of the axes that take part.
type Coordinates<const N: usize> = [f64; N];

/// Memory of the method, for N axes; kept from one curve to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tube<const N: usize> {
    matrix: Banded<1, 4>,
    control: Vec<Coordinates<N>>,
    /// What the given control points put on the right-hand side.
    base: Vec<Coordinates<N>>,
    held: Vec<Held<N>>,
}

/// A sample in the search.
#[derive(Clone, Copy, Debug)]
struct Held<const N: usize> {
    first: usize,
    basis: [f64; 4],
    p: Coordinates<N>,
    tolerance: f64,
    rho: f64,
    z: Coordinates<N>,
    u: Coordinates<N>,
}

impl<const N: usize> Held<N> {
    fn at(&self, control: &[Coordinates<N>]) -> Coordinates<N> {
        let mut q = [0.0; N];
        for (control, n) in control[self.first..self.first + 4].iter().zip(self.basis) {
            subtract(&mut q, -n, control);
        }
        q
    }

    /// How far off, over the tolerance: along X Y Z, U V W, or in degrees, whichever is most.
    fn off(&self, q: &Coordinates<N>) -> f64 {
        let mut most = 0.0_f64;
        for (q, p) in q.chunks(3).zip(self.p.chunks(3)) {
            most = most.max(q.iter().zip(p).map(|(q, p)| (q - p) * (q - p)).sum());
        }
        libm::sqrt(most) / self.tolerance
    }

    /// The nearest place within the tolerance.
    fn within(&self, q: &Coordinates<N>) -> Coordinates<N> {
        let share = RADIUS / self.off(q);
        if share >= 1.0 {
            return *q;
        }
        core::array::from_fn(|i| self.p[i] + (q[i] - self.p[i]) * share)
    }
}

impl<const N: usize> Tube<N> {
    /// Move the free control points to where the curve bends least. `bends`, by knot: shares of its
    /// three control points in q″, and the length it stands for.
    pub(crate) fn smooth(
        &mut self,
        control: &mut [Point],
        samples: &[Sample],
        bends: &[([f64; 3], f64)],
    ) {
        let free = GIVEN..control.len() - GIVEN;
        if free.is_empty() {
            return;
        }
        let narrow = |p: &Point| core::array::from_fn(|i| p[i]);
        self.control.clear();
        self.control.extend(control.iter().map(narrow));
        self.held.clear();
        for sample in samples.iter().filter(|sample| sample.per_square > 0.0) {
            let Sample { first, basis, tolerance, .. } = *sample;
            // a span's own bends say how long it is: 1/h³ is length times the square of a share
            let stiff = |(shares, length): &([f64; 3], f64)| {
                shares.iter().fold(0.0, |m: f64, x| m.max(x * x)) * length
            };
            let rho = STIFF * stiff(&bends[first]).max(stiff(&bends[first + 1]));
            let (z, u) = ([0.0; N], [0.0; N]);
            let mut held = Held { first, basis, p: narrow(&sample.p), tolerance, rho, z, u };
            held.z = held.within(&held.at(&self.control));
            self.held.push(held);
        }
        self.assemble(bends);
        for round in 1..=ROUNDS {
            self.solve();
            if self.keep() <= NEAR && round >= LEAST {
                break;
            }
        }
        for (wide, place) in control.iter_mut().zip(&self.control) {
            wide[..N].copy_from_slice(place);
        }
    }

    /// The matrix' factors, and what the given control points put on the right-hand side.
    fn assemble(&mut self, bends: &[([f64; 3], f64)]) {
        let count = self.control.len();
        self.matrix.clear(count);
        for (knot, (shares, length)) in bends.iter().enumerate() {
            for i in 0..3 {
                for j in 0..=i {
                    *self.matrix.entry(knot + j, i - j) += length * shares[i] * shares[j];
                }
            }
        }
        for held in &self.held {
            for i in 0..4 {
                for j in 0..=i {
                    let by = held.rho * held.basis[i] * held.basis[j];
                    *self.matrix.entry(held.first + j, i - j) += by;
                }
            }
        }
        let is_given = |i: usize| i < GIVEN || i >= count - GIVEN;
        self.base.clear();
        self.base.resize(count, [0.0; N]);
        for i in 0..count {
            for after in 1..4.min(count - i) {
                let (j, a) = (i + after, *self.matrix.entry(i, after));
                match (is_given(i), is_given(j)) {
                    (true, false) => subtract(&mut self.base[j], a, &self.control[i]),
                    (false, true) => subtract(&mut self.base[i], a, &self.control[j]),
                    _ => {}
                }
            }
        }
        for i in (0..count).filter(|i| is_given(*i)) {
            self.base[i] = self.control[i];
            self.matrix.fix(i, 0);
        }
        self.matrix.factor();
    }

    fn solve(&mut self) {
        let free = GIVEN..self.control.len() - GIVEN;
        self.control.clone_from(&self.base);
        for held in &self.held {
            let wanted: Coordinates<N> =
                core::array::from_fn(|i| held.rho * (held.z[i] - held.u[i]));
            let met = held.first..held.first + 4;
            for (i, n) in met.zip(held.basis).filter(|(i, _)| free.contains(i)) {
                subtract(&mut self.control[i], -n, &wanted);
            }
        }
        self.matrix.solve(self.control.as_chunks_mut::<1>().0);
    }

    /// z and u of the next round; how far the farthest sample is off, over its tolerance.
    fn keep(&mut self) -> f64 {
        let mut most = 0.0_f64;
        for held in &mut self.held {
            let q = held.at(&self.control);
            most = most.max(held.off(&q));
            let wanted: Coordinates<N> =
                core::array::from_fn(|i| RELAXED * q[i] + (1.0 - RELAXED) * held.z[i] + held.u[i]);
            held.z = held.within(&wanted);
            held.u = core::array::from_fn(|i| wanted[i] - held.z[i]);
        }
        most
    }
}

/// a −= f·b.
fn subtract<const N: usize>(a: &mut Coordinates<N>, f: f64, b: &Coordinates<N>) {
    for (a, b) in a.iter_mut().zip(b) {
        *a -= f * b;
    }
}
