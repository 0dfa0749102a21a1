//! Linear problems of few unknowns and many rows, of which few matter.
//!
//! ```text
//!   minimise one unknown    subject to   Σ a·x = b,  Σ a·x ≤ b          rows
//!                                        Σ a·x ≤ b                      rows that wait: solved without them, then with
//!                                                                       the worst broken of each run of neighbours, …
//! ```
//!
//! A limit that holds at every instant of a period is a row for each instant, and binds at a few of
//! them. Those that wait are brought in where the last solution broke them, until none is broken:
//! the optimum of all rows, at the price of some.
//!
//! Solver: Clarabel (interior point, convex cones; P. J. Goulart, Y. Chen, 2024).
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
    SupportedConeT::{NonnegativeConeT, ZeroConeT},
};

/// A row that waits is broken beyond this.
const BROKEN: f64 = 1e-6;
/// Of solutions that are as good the one of smaller unknowns is taken: so little counts their
/// square, and the solver is never without a direction.
const TIE: f64 = 1e-7;
/// The same of the way from a solution that is to be bettered: what is not linear holds in its
/// neighbourhood.
const NEAR: f64 = 1e-4;
/// Solutions until what is still broken is left as it is.
const EXCHANGES: usize = 12;

/// Σ a·x against b.
#[derive(Clone, Debug)]
pub(super) struct Constraint {
    /// Unknown and its weight a.
    pub(super) weights: Vec<(usize, f64)>,
    /// b.
    pub(super) bound: f64,
}

impl Constraint {
    /// By how much a solution is beyond the bound.
    fn beyond(&self, x: &[f64]) -> f64 {
        self.weights.iter().map(|(column, a)| a * x[*column]).sum::<f64>() - self.bound
    }
}

/// A linear problem.
#[derive(Clone, Debug, Default)]
pub(super) struct Lp {
    /// Unknowns are counted in these units, so that all are about one.
    pub(super) scale: Vec<f64>,
    /// A solution to stay near to; empty: none.
    pub(super) near: Vec<f64>,
    pub(super) equal: Vec<Constraint>,
    pub(super) within: Vec<Constraint>,
    /// Rows that wait, by runs of neighbours: of a period, the last one beside the first.
    pub(super) waiting: Vec<Vec<Constraint>>,
}

impl Lp {
    /// Make one unknown as small as may be under all rows; `None` if the solver fails.
    pub(super) fn minimise(&mut self, which: usize) -> Option<Vec<f64>> {
        let mut x = self.solve(which)?;
        for _ in 1..EXCHANGES {
            if !self.bring_in(&x) {
                break;
            }
            x = self.solve(which)?;
        }
        Some(x)
    }

    /// Bring in the rows that a solution breaks worst; whether there were any.
    fn bring_in(&mut self, x: &[f64]) -> bool {
        let before = self.within.len();
        for run in &mut self.waiting {
            let beyond: Vec<f64> = run.iter().map(|row| row.beyond(x)).collect();
            let count = beyond.len();
            for i in 0..count {
                let (left, right) = (beyond[(i + count - 1) % count], beyond[(i + 1) % count]);
                if beyond[i] > BROKEN && beyond[i] >= left && beyond[i] >= right {
                    self.within.push(run[i].clone());
                    run[i].bound = f64::INFINITY; // it waits no longer
                }
            }
        }
        self.within.len() > before
    }

    /// The same without the rows that wait.
    pub(super) fn solve(&self, which: usize) -> Option<Vec<f64>> {
        let columns = self.scale.len();
        let rows = self.equal.len() + self.within.len();
        let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); columns];
        let mut b = Vec::with_capacity(rows);
        for (i, row) in self.equal.iter().chain(&self.within).enumerate() {
            // each row to a largest entry of one
            let size = |(column, a): &(usize, f64)| (a * self.scale[*column]).abs();
            let norm = row.weights.iter().map(size).fold(1e-30, f64::max);
            for (column, a) in &row.weights {
                by_column[*column].push((i, a * self.scale[*column] / norm));
            }
            b.push(row.bound / norm);
        }
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in by_column {
            for (i, a) in column {
                places.push(i);
                values.push(a);
            }
            starts.push(values.len());
        }
        let a = CscMatrix::new(rows, columns, starts, places, values);
        let mut cost = vec![0.0; columns];
        let tie = if self.near.is_empty() { TIE } else { NEAR };
        for ((cost, x), scale) in cost.iter_mut().zip(&self.near).zip(&self.scale) {
            *cost = -tie * x / scale;
        }
        cost[which] += 1.0;
        let quadratic = CscMatrix::new(
            columns,
            columns,
            (0..=columns).collect(),
            (0..columns).collect(),
            vec![tie; columns],
        );
        let cones: [SupportedConeT<f64>; 2] =
            [ZeroConeT(self.equal.len()), NonnegativeConeT(self.within.len())];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-8,
            tol_gap_rel: 1e-8,
            tol_feas: 1e-9,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&quadratic, &cost, &a, &b, &cones, settings).ok()?;
        solver.solve();
        let status = solver.solution.status;
        // what comes of it is always looked at: near the optimum is better than nothing
        let near = SolverStatus::InsufficientProgress;
        (matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved) || status == near)
            .then(|| solver.solution.x.iter().zip(&self.scale).map(|(x, s)| x * s).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least t with |x − sin| ≤ t … of one unknown x: the farthest sine decides, whether its row
    /// waits or not.
    #[test]
    fn rows_that_wait_come_in_where_they_are_broken() {
        let row = |i: usize, sign: f64| {
            let sine = (core::f64::consts::TAU * i as f64 / 360.0).sin();
            Constraint { weights: vec![(0, sign), (1, -1.0)], bound: sign * sine }
        };
        let all: Vec<Vec<Constraint>> =
            [1.0, -1.0].map(|sign| (0..360).map(|i| row(i, sign)).collect()).into();
        let few = vec![row(0, 1.0), row(0, -1.0)];
        let mut lp = Lp { scale: vec![1.0; 2], within: few, waiting: all, ..Lp::default() };
        let x = lp.minimise(1).expect("it has a solution");
        assert!(x[0].abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6, "{x:?}");
        assert!(lp.within.len() < 20, "{} rows of 722", lp.within.len());
    }
}
