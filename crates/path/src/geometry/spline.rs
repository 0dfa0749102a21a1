//! Basis of a spline, by its knots (de Boor, *A Practical Guide to Splines*, 1978).
//!
//! ```text
//!   q(u) = Σ Nⱼ(u)·Pⱼ        on the span from knot i to the next one four functions are not zero: Pᵢ … Pᵢ₊₃
//!   q′ = Σ N²ⱼ·Qⱼ            Qⱼ = 3·(Pⱼ₊₁ − Pⱼ)/(tⱼ₊₄ − tⱼ₊₁)        three of one degree less, and so on
//! ```
use alloc::vec::Vec;

/// Knots of a cubic spline, without the repetition at the ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knots<'a>(pub(crate) &'a [f64]);

/// The functions of a span at one place: of a cubic spline's first three derivatives, and of a
/// quadratic one with the same knots and its first two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows {
    pub(crate) cubic: [[f64; 4]; 3],
    pub(crate) square: [[f64; 3]; 3],
}

/// Knots with more of them between, and by new span which old one it is of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Halved {
    pub(crate) knots: Vec<f64>,
    of: Vec<usize>,
}

impl Knots<'_> {
    /// Knot with the repetition at the ends.
    pub(crate) fn t(&self, index: usize) -> f64 {
        self.0[index.saturating_sub(3).min(self.0.len() - 1)]
    }

    pub(crate) fn spans(&self) -> usize {
        self.0.len() - 1
    }

    /// The functions of a degree that are not zero in a span, one more than the degree (de Boor,
    /// Cox).
    pub(crate) fn basis(&self, span: usize, u: f64, degree: usize) -> [f64; 4] {
        let i = span + 3;
        let mut n = [1.0, 0.0, 0.0, 0.0];
        for degree in 1..=degree {
            let mut saved = 0.0;
            for (r, value) in n.iter_mut().enumerate().take(degree) {
                let (right, left) = (self.t(i + r + 1), self.t(i + 1 + r - degree));
                let share = *value / (right - left);
                *value = saved + (right - u) * share;
                saved = (u - left) * share;
            }
            n[degree] = saved;
        }
        n
    }

    /// See [`Rows`].
    pub(crate) fn rows(&self, span: usize, u: f64) -> Rows {
        let i = span + 3;
        let t = |k: usize| self.t(k);
        let (squares, lines) = (self.basis(span, u, 2), self.basis(span, u, 1));
        // by how much a control point counts in those of the derivative with so many of them
        let slope = |p: [f64; 4], count: usize| -> [f64; 4] {
            let degree = count as f64;
            let mut q = [0.0; 4];
            for (j, q) in q.iter_mut().enumerate().take(count) {
                *q = degree * (p[j + 1] - p[j]) / (t(i + 1 + j) - t(i + 1 + j - count));
            }
            q
        };
        let one = |k: usize| core::array::from_fn(|j| f64::from(u8::from(j == k)));
        let mix = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut rows = Rows { cubic: [[0.0; 4]; 3], square: [[0.0; 3]; 3] };
        for k in 0..4 {
            let first = slope(one(k), 3);
            let second = slope(first, 2);
            let values = [mix(&squares, &first), mix(&lines, &second), slope(second, 1)[0]];
            for (row, value) in rows.cubic.iter_mut().zip(values) {
                row[k] = value;
            }
        }
        for k in 0..3 {
            let first = slope(one(k), 2);
            let values = [squares[k], mix(&lines, &first), slope(first, 1)[0]];
            for (row, value) in rows.square.iter_mut().zip(values) {
                row[k] = value;
            }
        }
        rows
    }

    /// The same knots, and one midway between the two of each span that is not so `near`; and which
    /// span each one of the new spans is of.
    pub(crate) fn halved(&self, near: impl Fn(usize) -> bool) -> Halved {
        let (mut knots, mut of) = (Vec::new(), Vec::new());
        for (span, ends) in self.0.windows(2).enumerate() {
            knots.push(ends[0]);
            of.push(span);
            if !near(span) {
                knots.push(f64::midpoint(ends[0], ends[1]));
                of.push(span);
            }
        }
        knots.extend(self.0.last());
        Halved { knots, of }
    }
}

impl Halved {
    /// Control points of the same curve, with the polynomials of the old spans: their polar forms
    /// at the knots around (Ramshaw, *Blossoming*, 1987), of which the curve has the degree less
    /// one.
    pub(crate) fn control<const DEGREE: usize, P>(
        &self,
        polar: impl Fn(usize, [f64; DEGREE]) -> P,
    ) -> impl Iterator<Item = P> {
        let knots = Knots(&self.knots);
        (0..knots.spans() + DEGREE).map(move |j| {
            let span = self.of[j.clamp(1, knots.spans()) - 1];
            polar(span, core::array::from_fn(|k| knots.t(j + k + 4 - DEGREE)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOTS: Knots = Knots(&[0.0, 0.4, 1.0, 1.3, 2.5]);

    /// q = u³ has Pⱼ = tⱼ₊₁·tⱼ₊₂·tⱼ₊₃, b = u² has βⱼ = tⱼ₊₂·tⱼ₊₃ (Marsden's identity).
    #[test]
    fn derivatives_of_powers_are_exact() {
        let t = |k: usize| KNOTS.t(k);
        for span in 0..KNOTS.spans() {
            for share in [0.0, 0.3, 1.0] {
                let u = KNOTS.0[span] + share * (KNOTS.0[span + 1] - KNOTS.0[span]);
                let rows = KNOTS.rows(span, u);
                let cubic = rows.cubic.map(|row| -> f64 {
                    let of =
                        |k: usize| row[k] * t(span + k + 1) * t(span + k + 2) * t(span + k + 3);
                    (0..4).map(of).sum()
                });
                let square = rows.square.map(|row| -> f64 {
                    (0..3).map(|k| row[k] * t(span + k + 2) * t(span + k + 3)).sum()
                });
                let expected = [3.0 * u * u, 6.0 * u, 6.0, u * u, 2.0 * u, 2.0];
                for (found, expected) in cubic.iter().chain(&square).zip(expected) {
                    assert!((found - expected).abs() < 1e-9, "{found} {expected} at {u}");
                }
            }
        }
    }

    /// With the polar form x·y·z of u³ the control points are those of u³ on the new knots, too.
    #[test]
    fn knots_come_between_those_that_are_far_apart_and_the_curve_stays() {
        let halved = KNOTS.halved(|span| KNOTS.0[span + 1] - KNOTS.0[span] < 0.5);
        assert_eq!(halved.knots, [0.0, 0.4, 0.7, 1.0, 1.3, 1.9, 2.5]);
        assert_eq!(halved.of, [0, 1, 1, 2, 3, 3]);
        let control: Vec<f64> = halved.control(|_, [x, y, z]: [f64; 3]| x * y * z).collect();
        let knots = Knots(&halved.knots);
        for (span, u) in [(0, 0.1), (2, 0.9), (5, 2.0)] {
            let basis = knots.basis(span, u, 3);
            let cube: f64 = basis.iter().zip(&control[span..]).map(|(n, p)| n * p).sum();
            assert!((cube - u * u * u).abs() < 1e-12, "{cube} at {u}");
        }
    }
}
