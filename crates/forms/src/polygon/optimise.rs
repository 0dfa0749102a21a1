//! The flattest facet that the axes can follow: a convex problem.
//!
//! The tip's distance from the flat is linear in the harmonics of dx and dy, and nearly so in those of the tool's
//! phase (two corrections make it exact):
//!
//! ```text
//!   minimise t      subject to   |e(u) − offset| ≤ t                      wherever a tip touches a facet
//!                                |x|, |ẋ|, |ẍ|, |x⃛|, |m·ẍ + c·ẋ| ≤ limit   over a whole period, each actuator
//!   e(u) = l·cos u − r·cos(qu) − (l−r)  +  dx·cos u + dy·sin u + r·sin(qu)·ε        q = R − 1
//!   dx = Σ G(m)·(a·cos mφ + b·sin mφ)       G: answer of the closed loop; 1 where it is compensated
//! ```
//!
//! A first solution finds the least t; a second one, of all that are as flat, the one that asks least of the drives.
//! Limits between two samples: a trigonometric polynomial of degree H sampled n times exceeds its samples by no more
//! than 1/cos(πH/n), which is taken off the limits beforehand, so the result never exceeds one.
//!
//! Solver: Clarabel (interior point, convex cones; P. J. Goulart, Y. Chen, 2024).
use super::form::{Facet, Form};
use super::profile::contact;
use super::series::{Actuator, Series, Swings, Term};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus,
    SupportedConeT::{self, NonnegativeConeT},
};
use std::f64::consts::{PI, TAU};
use units::{Angle, Length, Spin};

/// Places along a facet at which it shall be flat.
const CONTACTS: usize = 61;
/// Samples of a period for each harmonic.
const SAMPLES: usize = 40;
/// Corrections of what is not linear.
const CORRECTIONS: usize = 3;
/// Flatter than this is as flat, mm: a thousandth of a micrometre.
const AS_FLAT_MM: f64 = 1e-6;

/// What one actuator can do: mm and s, or rev and s; N, or N·m.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Farthest from the middle.
    pub travel: f64,
    /// Speed.
    pub speed: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Jerk.
    pub jerk: f64,
    /// What its drive needs and has, if that is known.
    pub effort: Option<Effort>,
}

/// Force or torque = `per_acceleration`·ẍ + `per_speed`·ẋ + `constant`, within ±most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Mass or inertia, in the units of the amplitude.
    pub per_acceleration: f64,
    /// Viscous friction.
    pub per_speed: f64,
    /// Coulomb friction and what turning takes.
    pub constant: f64,
    /// What the drive gives.
    pub most: f64,
}

/// An actuator that may swing.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Which.
    pub actuator: Actuator,
    /// What it can do.
    pub limits: Limits,
    /// What its closed loop makes of each harmonic, real and imaginary part; empty: 1, it is compensated.
    pub response: Vec<[f64; 2]>,
}

/// A problem.
#[derive(Clone, Debug)]
pub struct Problem<'f> {
    /// What is wanted.
    pub form: &'f Form,
    /// Speed of the work.
    pub spin: Spin,
    /// Who may swing.
    pub drives: Vec<Drive>,
    /// Harmonics of the form's base.
    pub harmonics: usize,
}

/// An answer.
#[derive(Clone, Debug)]
pub struct Solution {
    /// What to command.
    pub command: Swings,
    /// What the loops make of it.
    pub actual: Swings,
    /// Flatness of the worst facet that comes of it.
    pub flatness: Length,
    /// The facets lie so much farther out: take it off the distance of the axes.
    pub offset: Length,
    /// Largest travel, speed, acceleration, jerk, effort of each drive.
    pub peaks: Vec<[f64; 5]>,
    /// The limit that is used up, if one is: "acceleration of X".
    pub binding: Option<String>,
}

impl Problem<'_> {
    /// Solve it. `None` if the solver fails, which a feasible problem (nothing swings) does not make it do.
    pub fn solve(&self) -> Option<Solution> {
        let mut actual = Swings::default();
        let mut answer = None;
        for round in 1..=CORRECTIONS {
            let mut x = Lp::new(self, &actual, None).solve()?;
            if round == CORRECTIONS {
                let least = x[self.unknowns()].max(0.0);
                x = Lp::new(self, &actual, Some(least)).solve().unwrap_or(x);
            }
            actual = self.swings(&x, true);
            answer = Some((self.swings(&x, false), x[self.unknowns() + 1]));
        }
        let (command, offset) = answer?;
        let flatness = self.form.flatness(&actual);
        let (peaks, binding) = self.peaks(&command);
        Some(Solution { command, actual, flatness, offset: Length::mm(offset), peaks, binding })
    }

    /// Coefficients: cosine and sine of each harmonic of each drive.
    fn unknowns(&self) -> usize {
        2 * self.harmonics * self.drives.len()
    }

    fn swings(&self, x: &[f64], actual: bool) -> Swings {
        let series = self.drives.iter().enumerate().map(|(k, drive)| {
            let terms = (0..self.harmonics).map(|h| {
                let i = 2 * (k * self.harmonics + h);
                let (a, b) = (x[i], x[i + 1]);
                let [re, im] = if actual { drive.at(h) } else { [1.0, 0.0] };
                // Re[(a − jb)·G·e^{jmφ}]
                Term {
                    per_turn: self.form.base() * (h + 1) as f64,
                    cosine: a * re + b * im,
                    sine: b * re - a * im,
                }
            });
            Series { actuator: drive.actuator, terms: terms.collect() }
        });
        Swings(series.collect())
    }

    /// Solve it with a few harmonics; where a limit binds, as finely as it takes.
    pub fn solve_well(&self) -> Option<Solution> {
        Some(self.refined(self.solve()?))
    }

    /// A solution with a few harmonics, or a finer one where a limit binds and it is flatter.
    pub fn refined(&self, few: Solution) -> Solution {
        if few.binding.is_none() || self.spin == Spin::ZERO {
            return few;
        }
        self.solve_finely().filter(|fine| fine.flatness < few.flatness).unwrap_or(few)
    }

    /// Largest of everything, finely sampled, and the limit that is used to 95 % or more.
    pub fn peaks(&self, command: &Swings) -> (Vec<[f64; 5]>, Option<String>) {
        let omega = self.spin.in_rad_per_s();
        let largest = |(drive, series): (&Drive, &Series)| {
            let mut peak = [0.0_f64; 5];
            let highest = series.terms.iter().map(|t| t.per_turn).fold(0.0, f64::max);
            // the highest harmonics of a spline are too small to need as many as a few large ones
            let harmonics = highest / self.form.base();
            let count = (200.0 * harmonics).min(12_800.0).max(40.0 * harmonics).ceil() as usize;
            for d in series.over_a_period(self.form.base(), count) {
                let by_time: Vec<f64> =
                    d.iter().zip(0..4).map(|(d, n)| d * omega.powi(n)).collect();
                for n in 0..4 {
                    peak[n] = peak[n].max(by_time[n].abs());
                }
                if let Some(e) = drive.limits.effort {
                    let effort = e.per_acceleration * by_time[2] + e.per_speed * by_time[1];
                    peak[4] = peak[4].max(effort.abs() + e.constant);
                }
            }
            peak
        };
        let all: Vec<[f64; 5]> = self.drives.iter().zip(&command.0).map(largest).collect();
        let binding = self.binding(&all).filter(|(used, _)| *used > 0.95);
        (all, binding.map(|(_, name)| name))
    }

    /// The largest share of a limit that a command uses, and its name.
    pub(super) fn used(&self, command: &Swings) -> (f64, String) {
        self.binding(&self.peaks(command).0).unwrap_or_default()
    }

    fn binding(&self, peaks: &[[f64; 5]]) -> Option<(f64, String)> {
        const NAMES: [&str; 5] = ["travel", "speed", "acceleration", "jerk", "torque"];
        let shares = self.drives.iter().zip(peaks).flat_map(|(drive, peak)| {
            let l = &drive.limits;
            let effort = l.effort.map_or(f64::INFINITY, |e| e.most);
            let most = [l.travel, l.speed, l.acceleration, l.jerk, effort];
            let share = move |n: usize| {
                (peak[n] / most[n], format!("{} of {}", NAMES[n], drive.actuator.name()))
            };
            (0..5).map(share)
        });
        shares.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

impl Drive {
    pub(super) fn at(&self, harmonic: usize) -> [f64; 2] {
        self.response.get(harmonic).copied().unwrap_or([1.0, 0.0])
    }
}

/// Rows a·x ≤ b. Unknowns: coefficients, t, offset, and s, the share of the limits that is used.
struct Lp {
    columns: usize,
    rows: Vec<(Vec<f64>, f64)>,
    cost: Vec<f64>,
    /// Unknowns are counted in these units, so that all are about one.
    scale: Vec<f64>,
    /// Unknowns that are zero by symmetry.
    zero: Vec<bool>,
    /// Share of a period that has to be sampled.
    share: f64,
}

impl Lp {
    fn new(problem: &Problem<'_>, before: &Swings, least: Option<f64>) -> Self {
        let n = problem.unknowns();
        let mut lp = Self {
            columns: n + 3,
            rows: Vec::new(),
            cost: vec![0.0; n + 3],
            scale: vec![1.0; n + 3],
            zero: vec![false; n + 3],
            share: 1.0,
        };
        let symmetric =
            problem.form.is_regular() && problem.drives.iter().all(|d| d.response.is_empty());
        if symmetric {
            lp.share = 0.5; // what is even or odd repeats itself in the other half
        }
        for (k, drive) in problem.drives.iter().enumerate() {
            let unit = match drive.actuator {
                Actuator::CentreLine | Actuator::Across => 0.1,
                Actuator::ToolPhase => 1e-3,
            };
            for h in 0..problem.harmonics {
                let i = 2 * (k * problem.harmonics + h);
                lp.scale[i] = unit / (h + 1) as f64;
                lp.scale[i + 1] = lp.scale[i];
                if symmetric {
                    // X swings evenly about the middle of a facet, Y and the phase oddly
                    let even = drive.actuator == Actuator::CentreLine;
                    lp.zero[if even { i + 1 } else { i }] = true;
                }
            }
        }
        (lp.scale[n], lp.scale[n + 1]) = (1e-3, 1e-2);
        lp.contacts(problem, before);
        lp.limits(problem);
        match least {
            None => lp.cost[n] = 1.0,
            Some(least) => {
                let mut row = vec![0.0; n + 3];
                row[n] = 1.0;
                lp.rows.push((row, least * 1.0002 + AS_FLAT_MM));
                lp.cost[n + 2] = 1.0;
            }
        }
        lp
    }

    /// |e − offset| ≤ t at every contact.
    fn contacts(&mut self, problem: &Problem<'_>, before: &Swings) {
        let form = problem.form;
        let cutter = form.cutter();
        let n = problem.unknowns();
        for facet in form.kinds() {
            let ends: Vec<f64> = [facet.to, facet.from]
                .iter()
                .map(|s| contact(&cutter, &facet, before, *s))
                .collect();
            for i in 0..CONTACTS {
                // denser towards the corners, where the best curve touches its limits
                let part = 0.5 - 0.5 * (PI * i as f64 / (CONTACTS - 1) as f64).cos();
                let u = Angle::rev(ends[0] + (ends[1] - ends[0]) * part);
                let now = before.at(facet.centre + u);
                let base = (cutter.tip_at_facet(u, now).x - cutter.flat()).value();
                let mut row = vec![0.0; self.columns];
                let mut constant = base;
                for (k, drive) in problem.drives.iter().enumerate() {
                    let slope = cutter.slope(u, now, drive.actuator);
                    constant -= slope * drive.actuator.of(now);
                    Self::fill(problem, k, drive, &facet, u, slope, &mut row);
                }
                for sign in [1.0, -1.0] {
                    let mut signed: Vec<f64> = row.iter().map(|a| a * sign).collect();
                    signed[n] = -1.0;
                    signed[n + 1] = -sign;
                    self.rows.push((signed, -constant * sign));
                }
            }
        }
    }

    fn fill(
        problem: &Problem<'_>,
        k: usize,
        drive: &Drive,
        facet: &Facet,
        u: Angle,
        slope: f64,
        row: &mut [f64],
    ) {
        for h in 0..problem.harmonics {
            let i = 2 * (k * problem.harmonics + h);
            let m = problem.form.base() * (h + 1) as f64;
            let (sine, cosine) = (TAU * (m * (facet.centre + u).value()).fract()).sin_cos();
            let [re, im] = drive.at(h);
            row[i] = slope * (re * cosine - im * sine);
            row[i + 1] = slope * (im * cosine + re * sine);
        }
    }

    /// Every limit of every drive, as a share s ≤ 1 of it.
    fn limits(&mut self, problem: &Problem<'_>) {
        let n = problem.unknowns();
        let count = SAMPLES * problem.harmonics;
        let between = (PI / SAMPLES as f64).cos();
        let omega = problem.spin.in_rad_per_s();
        for (k, drive) in problem.drives.iter().enumerate() {
            let l = &drive.limits;
            let mut wanted: Vec<([f64; 4], f64)> = Vec::new();
            let orders = [l.travel, l.speed, l.acceleration, l.jerk];
            for ((order, most), power) in orders.into_iter().enumerate().zip(0..) {
                let mut weights = [0.0; 4];
                weights[order] = omega.powi(power);
                wanted.push((weights, most));
            }
            if let Some(e) = l.effort {
                let weights = [0.0, e.per_speed * omega, e.per_acceleration * omega * omega, 0.0];
                wanted.push((weights, (e.most - e.constant).max(0.0)));
            }
            for (weights, most) in wanted.into_iter().filter(|(_, most)| most.is_finite()) {
                let room = (most * between).max(1e-12);
                for i in 0..=(count as f64 * self.share) as usize {
                    let phase = TAU * i as f64 / count as f64;
                    let mut row = vec![0.0; self.columns];
                    for h in 0..problem.harmonics {
                        let j = 2 * (k * problem.harmonics + h);
                        let m = problem.form.base() * (h + 1) as f64;
                        let (s, c) = (phase * (h + 1) as f64).sin_cos();
                        let [w0, w1, w2, w3] = weights;
                        row[j] = (w0 * c - w1 * m * s - w2 * m * m * c + w3 * m.powi(3) * s) / room;
                        row[j + 1] =
                            (w0 * s + w1 * m * c - w2 * m * m * s - w3 * m.powi(3) * c) / room;
                    }
                    for sign in [1.0, -1.0] {
                        let mut signed: Vec<f64> = row.iter().map(|a| a * sign).collect();
                        signed[n + 2] = -1.0;
                        self.rows.push((signed, 0.0));
                    }
                }
            }
        }
        let mut share = vec![0.0; self.columns];
        share[n + 2] = 1.0;
        self.rows.push((share, 1.0));
    }

    fn solve(&self) -> Option<Vec<f64>> {
        let used: Vec<usize> = (0..self.columns).filter(|c| !self.zero[*c]).collect();
        let (rows, columns) = (self.rows.len(), used.len());
        let scaled: Vec<Vec<f64>> = self
            .rows
            .iter()
            .map(|(row, _)| row.iter().zip(&self.scale).map(|(a, s)| a * s).collect())
            .collect();
        // each row to a largest entry of one
        let norm = |row: &Vec<f64>| row.iter().fold(1e-30_f64, |most, a| most.max(a.abs()));
        let norms: Vec<f64> = scaled.iter().map(norm).collect();
        let (mut starts, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in used.iter().copied() {
            for (i, row) in scaled.iter().enumerate() {
                if row[column] != 0.0 {
                    places.push(i);
                    values.push(row[column] / norms[i]);
                }
            }
            starts.push(values.len());
        }
        let a = CscMatrix::new(rows, columns, starts, places, values);
        let b: Vec<f64> = self.rows.iter().zip(&norms).map(|((_, b), norm)| b / norm).collect();
        let q: Vec<f64> = used.iter().map(|c| self.cost[*c] * self.scale[*c]).collect();
        let most = q.iter().fold(1e-30_f64, |most, c| most.max(c.abs()));
        let q: Vec<f64> = q.iter().map(|c| c / most).collect();
        let p = CscMatrix::zeros((columns, columns));
        let cones: [SupportedConeT<f64>; 1] = [NonnegativeConeT(rows)];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-9,
            tol_gap_rel: 1e-9,
            tol_feas: 1e-10,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings).ok()?;
        solver.solve();
        let solved =
            matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        solved.then(|| {
            let mut x = vec![0.0; self.columns];
            for (column, value) in used.iter().zip(&solver.solution.x) {
                x[*column] = value * self.scale[*column];
            }
            x
        })
    }
}
