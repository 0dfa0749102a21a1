//! What is asked along one span, gathered before it goes into the equations: all of it meets in the
//! same few unknowns.
//!
//! ```text
//!                        P₀ … P₃ of the axis     of the next one     β₀ … β₂
//!   P₀ … P₃ of an axis         own                   across           mixed
//!   β₀ … β₂                                                           speed
//! ```
use super::load::{At, LimitPoint, Load, SAY, SAY_B};
use super::spline::Rows;
use crate::banded::Banded;

/// Pairs of control points, each once.
const PAIRS: [(usize, usize); 10] =
    [(0, 0), (0, 1), (0, 2), (0, 3), (1, 1), (1, 2), (1, 3), (2, 2), (2, 3), (3, 3)];

/// Gradient and matrix of one span, of N axes.
#[derive(Clone, Debug)]
pub(crate) struct Gathered<const N: usize> {
    /// By axis: control points of the same one, and of the next one whose distance counts together
    /// with it.
    own: [[f64; PAIRS.len()]; N],
    across: [[f64; PAIRS.len()]; N],
    mixed: [[[f64; SAY_B]; SAY]; N],
    speed: [[f64; SAY_B]; SAY_B],
    by_control: [[f64; SAY]; N],
    by_beta: [f64; SAY_B],
}

/// The next axis of X Y Z, of U V W, or of A B C.
const fn next(axis: usize) -> usize {
    if axis % 3 == 2 { axis - 2 } else { axis + 1 }
}

/// Derivatives of a barrier: by what it is of, and by that once more.
type Slopes = (f64, f64);

impl<const N: usize> Gathered<N> {
    pub(crate) fn new() -> Self {
        Self {
            own: [[0.0; PAIRS.len()]; N],
            across: [[0.0; PAIRS.len()]; N],
            mixed: [[[0.0; SAY_B]; SAY]; N],
            speed: [[0.0; SAY_B]; SAY_B],
            by_control: [[0.0; SAY]; N],
            by_beta: [0.0; SAY_B],
        }
    }

    /// A goal's slope by b, and its bend.
    pub(crate) fn speed(&mut self, share: &[f64; SAY_B], (slope, bend): Slopes) {
        add(&mut self.by_beta, slope, share);
        add_outer(&mut self.speed, bend, share, share);
    }

    /// A load's part.
    pub(crate) fn load(&mut self, axis: usize, load: &Load, rows: &Rows, (slope, bend): Slopes) {
        let (p, b) = (load.by_control(rows), load.by_beta(rows));
        for (own, (j, k)) in self.own[axis].iter_mut().zip(PAIRS) {
            *own += bend * p[j] * p[k];
        }
        add(&mut self.by_control[axis], slope, &p);
        add_outer(&mut self.mixed[axis], bend, &p, &b);
        self.speed(&b, (slope, bend));
    }

    /// The feed's part: b·`slow` is bounded, with |q′|² in `slow`.
    pub(crate) fn pace(
        &mut self,
        place: &LimitPoint,
        at: &At<N>,
        slow: f64,
        (slope, bend): Slopes,
    ) {
        let (slopes, shares) = (&place.rows.cubic[0], &place.rows.square[0]);
        let shares = shares.map(|share| slow * share);
        self.speed(&shares, (slope, bend));
        if !at.counts_way() {
            return;
        }
        let way = 2.0 * at.b[0] / (place.feed * place.feed);
        let d: [f64; 3] = core::array::from_fn(|i| way * at.q[0][i]);
        for (i, d) in d.iter().enumerate() {
            add(&mut self.by_control[i], slope * d, slopes);
            add_outer(&mut self.mixed[i], bend * d, slopes, &shares);
        }
        self.outer(0, slopes, &d, (slope * way, bend));
    }

    /// A distance's part: of its group, how far off; half the square of that is bounded.
    pub(crate) fn near(
        &mut self,
        group: usize,
        basis: &[f64; SAY],
        d: &[f64; 3],
        (slope, bend): Slopes,
    ) {
        for (i, d) in d.iter().enumerate() {
            add(&mut self.by_control[3 * group + i], slope * d, basis);
        }
        self.outer(group, basis, d, (slope, bend));
    }

    /// Σ shareⱼ·shareₖ·(once·1 + twice·d·dᵀ)
    fn outer(&mut self, group: usize, share: &[f64; SAY], d: &[f64; 3], (once, twice): Slopes) {
        let mut shares = [0.0; PAIRS.len()];
        for (shares, (j, k)) in shares.iter_mut().zip(PAIRS) {
            *shares = share[j] * share[k];
        }
        for i in 0..3 {
            add(&mut self.own[3 * group + i], once + twice * d[i] * d[i], &shares);
            add(&mut self.across[3 * group + i], twice * d[i] * d[next(i)], &shares);
        }
    }

    /// Add it to gradient and matrix, where the span's first control point is, and begin anew. B =
    /// N + 1.
    pub(crate) fn put<const B: usize>(
        &mut self,
        first: usize,
        matrix: &mut Banded<B, SAY>,
        gradient: &mut [[f64; B]],
    ) {
        let (rows, gradient) = (&mut matrix.rows[first..][..SAY], &mut gradient[first..][..SAY]);
        for (i, by) in self.by_control.iter().enumerate() {
            for (gradient, by) in gradient.iter_mut().zip(by) {
                gradient[i] += by;
            }
        }
        for (gradient, by) in gradient.iter_mut().zip(&self.by_beta) {
            gradient[N] += by;
        }
        for (pair, (j, k)) in PAIRS.into_iter().enumerate() {
            let block = &mut rows[j][k - j];
            for i in 0..N {
                block[i][i] += self.own[i][pair];
                block[i][next(i)] += self.across[i][pair];
                block[next(i)][i] += self.across[i][pair];
            }
        }
        for (i, mixed) in self.mixed.iter().enumerate() {
            for (j, mixed) in mixed.iter().enumerate() {
                for (k, mixed) in mixed.iter().enumerate() {
                    if j <= k {
                        rows[j][k - j][i][N] += mixed;
                    } else {
                        rows[k][j - k][N][i] += mixed;
                    }
                }
            }
        }
        for j in 0..SAY_B {
            for k in j..SAY_B {
                rows[j][k - j][N][N] += self.speed[j][k];
            }
        }
        *self = Self::new();
    }
}

/// a += f·x
fn add<const M: usize>(a: &mut [f64; M], f: f64, x: &[f64; M]) {
    for (a, x) in a.iter_mut().zip(x) {
        *a += f * x;
    }
}

/// a += f·x·yᵀ
fn add_outer<const M: usize, const K: usize>(
    a: &mut [[f64; K]; M],
    f: f64,
    x: &[f64; M],
    y: &[f64; K],
) {
    for (a, x) in a.iter_mut().zip(x) {
        add(a, f * x, y);
    }
}
