//! What motion along a spline asks of the axes, over their limits, and how it changes with shape
//! and speed.
//!
//! ```text
//!   (q″·b + ½·q′·b′)/A      √b·(q‴·b + 3/2·q″·b′ + ½·q′·b″)/J      (q′)²·b/V²,  |q′|²·b/F²        b = u̇²
//! ```
use super::spline::Rows;
use motion::{Bounds, Limits, Point};

/// Control points with a say in one place, and coefficients of b.
pub(crate) const SAY: usize = 4;
pub(crate) const SAY_B: usize = 3;

/// A place where the limits are kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LimitPoint {
    pub(crate) span: usize,
    pub(crate) rows: Rows,
    /// Length of the parameter it stands for.
    pub(crate) weight: f64,
    pub(crate) feed: f64,
    pub(crate) rapid: bool,
    /// The acceleration goes on here from a place that has it already.
    pub(crate) again: bool,
    /// In the middle of a span: here the feed is kept.
    pub(crate) middle: bool,
}

impl LimitPoint {
    /// b there.
    pub(crate) fn square(&self, beta: &[f64]) -> f64 {
        mix(&self.rows.square[0], &beta[self.span..])
    }
}

/// One over the limits of N axes.
#[derive(Clone, Copy, Debug)]
struct Over<const N: usize> {
    accel: [f64; N],
    jerk: [f64; N],
    speed: [f64; N],
}

impl<const N: usize> Over<N> {
    fn of(bounds: &Bounds) -> Self {
        let over = |limit: &Point| core::array::from_fn(|i| 1.0 / limit[i]);
        Self { accel: over(&bounds.accel), jerk: over(&bounds.jerk), speed: over(&bounds.speed) }
    }
}

/// Motion at a place: derivatives of q, then b and its derivatives.
#[derive(Clone, Copy)]
pub(crate) struct At<const N: usize> {
    pub(crate) q: [[f64; N]; 3],
    pub(crate) b: [f64; 3],
}

impl<const N: usize> At<N> {
    /// With control points and coefficients of b.
    pub(crate) fn of(place: &LimitPoint, control: &[[f64; N]], beta: &[f64]) -> Self {
        let b = |row: &[f64; SAY_B]| mix(row, &beta[place.span..]);
        Self { b: place.rows.square.each_ref().map(b), ..Self::resting(place, control, 0.0) }
    }

    /// With b the same all along.
    pub(crate) fn resting(place: &LimitPoint, control: &[[f64; N]], b: f64) -> Self {
        let mut q = [[0.0; N]; 3];
        for (k, p) in control[place.span..place.span + SAY].iter().enumerate() {
            for (q, row) in q.iter_mut().zip(&place.rows.cubic) {
                for i in 0..N {
                    q[i] += row[k] * p[i];
                }
            }
        }
        Self { q, b: [b, 0.0, 0.0] }
    }

    /// Whether the feed counts a blend's way, as where X, Y and Z alone move: see `law`.
    pub(crate) fn counts_way(&self) -> bool {
        N <= 3 || self.q[0][3..].iter().all(|slope| *slope == 0.0)
    }

    /// Square of what the feed counts, over its limit and b.
    pub(crate) fn feed(&self, place: &LimitPoint) -> f64 {
        let way = self.q[0].iter().map(|slope| slope * slope).sum();
        (if self.counts_way() { way } else { 1.0 }) / (place.feed * place.feed)
    }
}

/// Something that is to be at most 1: its value, and how much q′, q″, q‴ and b, b′, b″ count.
#[derive(Clone, Copy)]
pub(crate) struct Load {
    pub(crate) value: f64,
    of_q: [f64; 3],
    of_b: [f64; 3],
}

impl Load {
    /// By control points of its axis.
    pub(crate) fn by_control(&self, rows: &Rows) -> [f64; SAY] {
        let [a, b, c] = self.of_q;
        core::array::from_fn(|k| a * rows.cubic[0][k] + b * rows.cubic[1][k] + c * rows.cubic[2][k])
    }

    /// By coefficients of b.
    pub(crate) fn by_beta(&self, rows: &Rows) -> [f64; SAY_B] {
        let [a, b, c] = self.of_b;
        let [m, m1, m2] = &rows.square;
        core::array::from_fn(|k| a * m[k] + b * m1[k] + c * m2[k])
    }
}

/// The limits of N axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loads<const N: usize> {
    feed: Over<N>,
    rapid: Over<N>,
    pub(crate) jerky: bool,
}

impl<const N: usize> Loads<N> {
    pub(crate) fn of(limits: &Limits) -> Self {
        let jerky = limits.has_jerk();
        Self { feed: Over::of(&limits.feed), rapid: Over::of(&limits.rapid), jerky }
    }

    fn over(&self, place: &LimitPoint) -> &Over<N> {
        if place.rapid { &self.rapid } else { &self.feed }
    }

    /// One over the smallest limit of acceleration at the feed.
    pub(crate) fn slackest(&self) -> f64 {
        self.feed.accel.iter().fold(0.0, |m: f64, x| m.max(*x))
    }

    /// An axis' speed.
    pub(crate) fn speed(&self, place: &LimitPoint, at: &At<N>, i: usize) -> Load {
        let over = self.over(place).speed[i] * libm::sqrt(at.b[0]);
        let value = over * at.q[0][i];
        Load { value, of_q: [over, 0.0, 0.0], of_b: [0.5 * value / at.b[0], 0.0, 0.0] }
    }

    /// An axis' acceleration.
    pub(crate) fn accel(&self, place: &LimitPoint, at: &At<N>, i: usize) -> Load {
        let At { q: [q1, q2, _], b: [b, b1, _] } = at;
        let over = self.over(place).accel[i];
        let (of_q, of_b) =
            ([0.5 * over * b1, over * b, 0.0], [over * q2[i], 0.5 * over * q1[i], 0.0]);
        Load { value: over * (q2[i] * b + 0.5 * q1[i] * b1), of_q, of_b }
    }

    /// An axis' jerk.
    pub(crate) fn jerk(&self, place: &LimitPoint, at: &At<N>, i: usize) -> Load {
        let At { q: [q1, q2, q3], b: [b, b1, b2] } = at;
        let over = self.over(place).jerk[i] * libm::sqrt(*b);
        let value = over * (q3[i] * b + 1.5 * q2[i] * b1 + 0.5 * q1[i] * b2);
        let of_q = [0.5 * over * b2, 1.5 * over * b1, over * b];
        let of_b = [over * q3[i] + 0.5 * value / b, 1.5 * over * q2[i], 0.5 * over * q1[i]];
        Load { value, of_q, of_b }
    }

    /// All accelerations that are new there, all jerks, and speeds where the feed may be above
    /// them, with their axes.
    pub(crate) fn each(&self, place: &LimitPoint, at: &At<N>, mut give: impl FnMut(usize, &Load)) {
        if !place.again {
            for i in 0..N {
                give(i, &self.accel(place, at, i));
            }
        }
        if self.jerky {
            for i in 0..N {
                give(i, &self.jerk(place, at, i));
            }
        }
        if self.over(place).speed.iter().any(|over| place.feed * over > 1.0) {
            for i in 0..N {
                give(i, &self.speed(place, at, i));
            }
        }
    }
}

/// A sum of coefficients of b.
pub(crate) fn mix(row: &[f64; SAY_B], beta: &[f64]) -> f64 {
    row.iter().zip(beta).map(|(m, beta)| m * beta).sum()
}
