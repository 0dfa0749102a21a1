//! The same problem without harmonics: jerk is free in each of many steps of a period, speed and
//! place follow from it exactly. A fine convex optimum that shares nothing with the series; the
//! kinematics are written out for R = 2:
//!
//! ```text
//!   e(u) = (l + dx)·cos u + dy·sin u − r·cos(u + ε) − (l − r)          ε by corrections: e ≈ e₀ + r·sin(u + ε₀)·(ε − ε₀)
//! ```
//!
//! By the angle ψ = M·u all derivatives are about as large.
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SupportedConeT,
    SupportedConeT::{NonnegativeConeT, ZeroConeT},
};
use core::f64::consts::{PI, TAU};
use forms::polygon::{Actuator, Drive, Form};

/// Steps of a period.
const N: usize = 360;
const STEP: f64 = TAU / N as f64;
/// Corrections of what is not linear.
const CORRECTIONS: usize = 4;

/// Unknowns and their weights, and the bound.
type Constraint = (Vec<(usize, f64)>, f64);

struct Fine<'a> {
    form: &'a Form,
    drives: &'a [Drive],
    /// The last solution.
    x: Vec<f64>,
}

/// Flatness of the flattest facet of a regular form at 1:2, µm; the drives answer as they are told.
pub(crate) fn optimum_um(form: &Form, rpm: f64, drives: &[Drive]) -> f64 {
    let mut fine = Fine { form, drives, x: vec![0.0; 4 * N * drives.len() + 2] };
    let t = 4 * N * drives.len();
    let has_phase = drives.iter().any(|drive| drive.actuator == Actuator::ToolPhase);
    for _ in 0..if has_phase { CORRECTIONS } else { 1 } {
        let (rows, equalities) = fine.rows(rpm);
        fine.x = solve(&rows, equalities, fine.x.len(), t);
    }
    2.0 * fine.x[t] * 1e3
}

impl Fine<'_> {
    /// Place and three derivatives by ψ of a drive in each step.
    fn at(drive: usize, order: usize, i: usize) -> usize {
        4 * (N * drive + i % N) + order
    }

    /// mm or rev for an unknown of one.
    fn unit(&self, drive: usize) -> f64 {
        if self.drives[drive].actuator == Actuator::ToolPhase { 1e-3 } else { 1.0 }
    }

    /// Place of a drive at ψ as unknowns and weights.
    fn place(&self, drive: usize, psi: f64) -> Vec<(usize, f64)> {
        let from_start = (psi + PI).rem_euclid(TAU);
        let i = (from_start / STEP) as usize;
        let part = from_start - i as f64 * STEP;
        let mut weight = self.unit(drive);
        let mut row = Vec::new();
        for order in 0..4 {
            row.push((Self::at(drive, order, i), weight));
            weight *= part / (order + 1) as f64;
        }
        row
    }

    /// dx, dy mm and ε rad of the last solution.
    fn swing(&self, psi: f64) -> [f64; 3] {
        let mut swing = [0.0; 3];
        for (k, drive) in self.drives.iter().enumerate() {
            let value: f64 = self.place(k, psi).iter().map(|(column, a)| a * self.x[*column]).sum();
            match drive.actuator {
                Actuator::CentreLine => swing[0] += value,
                Actuator::Across => swing[1] += value,
                Actuator::ToolPhase => swing[2] += value * TAU,
            }
        }
        swing
    }

    fn rows(&self, rpm: f64) -> (Vec<Constraint>, usize) {
        let mut rows = Vec::new();
        for k in 0..self.drives.len() {
            motion(k, &mut rows);
        }
        let equalities = rows.len();
        let (l, r, m) =
            (self.form.centres().value(), self.form.tip_radius.value(), self.form.base());
        let half = self.form.across_flats.value() / 2.0 * (PI / m).tan();
        let ends = [1.0, -1.0].map(|side| {
            // y falls with u
            let (mut before, mut after) = (-0.5, 0.5);
            for _ in 0..60 {
                let u = f64::midpoint(before, after);
                let [dx, dy, phase] = self.swing(u * m);
                let y = -(l + dx) * u.sin() + dy * u.cos() - r * (u + phase).sin();
                if y > side * half { before = u } else { after = u }
            }
            before * m
        });
        let inner = (0..N).map(|i| (i as f64 - (N / 2) as f64) * STEP);
        let inner = inner.filter(|psi| (ends[0]..=ends[1]).contains(psi));
        for psi in inner.chain(ends) {
            let u = psi / m;
            let [_, _, about] = self.swing(psi);
            let slope = r * (u + about).sin();
            let constant = l * u.cos() - r * (u + about).cos() - (l - r) - slope * about;
            let mut e = Vec::new();
            for (k, drive) in self.drives.iter().enumerate() {
                let by = match drive.actuator {
                    Actuator::CentreLine => u.cos(),
                    Actuator::Across => u.sin(),
                    Actuator::ToolPhase => slope * TAU,
                };
                e.extend(self.place(k, psi).into_iter().map(|(column, a)| (column, a * by)));
            }
            let t = 4 * N * self.drives.len();
            for sign in [1.0, -1.0] {
                let mut row: Vec<_> = e.iter().map(|(column, a)| (*column, a * sign)).collect();
                // the axes stand nearer by an unknown, which moves the facet by its cosine
                row.extend([(t, -1.0), (t + 1, sign * u.cos())]);
                rows.push((row, -sign * constant));
            }
        }
        let omega = m * rpm / 60.0 * TAU;
        for k in 0..self.drives.len() {
            self.limits(k, omega, &mut rows);
        }
        (rows, equalities)
    }

    /// Speed, acceleration, jerk and effort of a drive.
    fn limits(&self, k: usize, omega: f64, rows: &mut Vec<Constraint>) {
        let (l, unit) = (&self.drives[k].limits, self.unit(k));
        for (i, sign) in (0..N).flat_map(|i| [(i, 1.0), (i, -1.0)]) {
            for ((order, power), most) in (1..4).zip(1..).zip([l.speed, l.acceleration, l.jerk]) {
                if most.is_finite() {
                    let room = most / omega.powi(power) / unit;
                    rows.push((vec![(Self::at(k, order, i), sign)], room));
                }
            }
            if let Some(e) = l.effort {
                let by_speed = e.per_speed * omega * unit * sign;
                let by_acceleration = e.per_acceleration * omega * omega * unit * sign;
                let row = vec![(Self::at(k, 1, i), by_speed), (Self::at(k, 2, i), by_acceleration)];
                rows.push((row, e.most - e.constant));
            }
        }
    }
}

/// A drive's place and derivatives from step to step, about a middle: where the axes stand is an
/// unknown of its own.
fn motion(k: usize, rows: &mut Vec<Constraint>) {
    for i in 0..N {
        for order in 0..3 {
            let mut row = vec![(Fine::at(k, order, i + 1), -1.0)];
            let mut weight = 1.0;
            for higher in order..4 {
                row.push((Fine::at(k, higher, i), weight));
                weight *= STEP / (higher - order + 1) as f64;
            }
            rows.push((row, 0.0));
        }
    }
    rows.push(((0..N).map(|i| (Fine::at(k, 0, i), 1.0)).collect(), 0.0));
}

fn solve(rows: &[Constraint], equalities: usize, columns: usize, least: usize) -> Vec<f64> {
    let mut entries: Vec<(usize, usize, f64)> = rows
        .iter()
        .enumerate()
        .flat_map(|(i, (row, _))| row.iter().map(move |(c, a)| (*c, i, *a)))
        .collect();
    entries.sort_by_key(|e| (e.0, e.1));
    let mut starts = vec![0; columns + 1];
    for entry in &entries {
        starts[entry.0 + 1] += 1;
    }
    for column in 0..columns {
        starts[column + 1] += starts[column];
    }
    let a = CscMatrix::new(
        rows.len(),
        columns,
        starts,
        entries.iter().map(|e| e.1).collect(),
        entries.iter().map(|e| e.2).collect(),
    );
    let b: Vec<f64> = rows.iter().map(|r| r.1).collect();
    let mut q = vec![0.0; columns];
    q[least] = 1.0;
    let cones: [SupportedConeT<f64>; 2] =
        [ZeroConeT(equalities), NonnegativeConeT(rows.len() - equalities)];
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let p = CscMatrix::zeros((columns, columns));
    let mut solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings).unwrap();
    solver.solve();
    solver.solution.x
}
