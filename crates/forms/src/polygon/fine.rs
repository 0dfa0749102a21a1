//! The flattest facet where a limit binds: the oscillation as a spline, not as a few harmonics.
//!
//! At a limit the best motion has corners in its jerk, which harmonics reach slowly: with 64 of them the facet is still
//! three percent less flat than it could be. A uniform quintic B-spline over one period of the form has them almost
//! exactly, and its limits cost one row each:
//!
//! ```text
//!   x(ψ) = Σ c_i·β⁵(K·ψ − i)      x⁽ⁿ⁾ = (K·M·n)ⁿ · Σ (Δⁿc)_i·β⁵⁻ⁿ      |Δⁿc| within a limit ⇒ |x⁽ⁿ⁾| within it
//! ```
//!
//! since a spline stays within its coefficients. What comes out is handed on as harmonics: those of the spline are the
//! transform of its coefficients times sinc⁶(m/K), and beyond 2K they are too small to matter; should what is left out
//! lift a peak over its limit, everything is made so much smaller.
use super::form::Form;
use super::optimise::{Drive, Problem, Solution};
use super::profile::contact;
use super::series::{Actuator, Series, Swings, Term};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
    SupportedConeT::{NonnegativeConeT, ZeroConeT},
};
use std::f64::consts::{PI, TAU};
use units::{Angle, Length};

/// Knots of a period.
const KNOTS: usize = 160;
/// Highest harmonic that may be handed on, periods a turn.
const HIGHEST: f64 = 2000.0;
/// Places along a facet at which it shall be flat.
const CONTACTS: usize = 81;
/// Corrections of what is not linear.
const CORRECTIONS: usize = 3;
/// Flatter than this is as flat, mm.
const AS_FLAT_MM: f64 = 1e-6;
/// Places between two knots at which jerk is looked at.
const JERKS: usize = 4;
/// Left to what samples of a drive's effort do not see.
const EFFORT_SHARE: f64 = 0.995;

/// A row Σ a·x ≤ b, or = b.
type Row = (Vec<(usize, f64)>, f64);

/// The linear problem. Unknowns: each drive's coefficients, t, offset, and s, the share of the limits that is used.
struct Spline<'p> {
    problem: &'p Problem<'p>,
    knots: usize,
    equal: Vec<Row>,
    within: Vec<Row>,
    /// Unknowns are counted in these units.
    scale: Vec<f64>,
}

impl Problem<'_> {
    /// Solve it with as much detail as the limits make use of; `None` if the solver fails.
    pub fn solve_finely(&self) -> Option<Solution> {
        let knots = KNOTS.min((HIGHEST / 2.0 / self.form.base()) as usize).max(16);
        let n = knots * self.drives.len();
        let mut actual = Swings::default();
        let mut found = None;
        for round in 1..=CORRECTIONS {
            let mut lp = Spline::new(self, knots, &actual);
            let mut x = lp.minimise(n)?;
            if round == CORRECTIONS {
                let most = x[n].max(0.0) * 1.0002 + AS_FLAT_MM;
                lp.within.push((vec![(n, 1.0)], most));
                x = lp.minimise(n + 2).unwrap_or(x);
            }
            actual = self.of_spline(&x, knots, true);
            found = Some(x);
        }
        let x = found?;
        let mut command = self.of_spline(&x, knots, false);
        let used = self.used(&command).0;
        if used > 1.0 {
            let used = used * (1.0 + 1e-9);
            for series in command.0.iter_mut().chain(&mut actual.0) {
                for term in &mut series.terms {
                    (term.cosine, term.sine) = (term.cosine / used, term.sine / used);
                }
            }
        }
        let flatness = self.form.flatness(&actual);
        let (peaks, binding) = self.peaks(&command);
        let offset = Length::mm(x[n + 1]);
        Some(Solution { command, actual, flatness, offset, peaks, binding })
    }

    /// Harmonics of a solution.
    fn of_spline(&self, x: &[f64], knots: usize, actual: bool) -> Swings {
        let series = self.drives.iter().enumerate().map(|(k, drive)| {
            let coefficients = &x[k * knots..(k + 1) * knots];
            let terms = (1..2 * knots).map(|m| {
                let part = PI * m as f64 / knots as f64;
                let weight = 2.0 / knots as f64 * (part.sin() / part).powi(6);
                let (mut a, mut b) = (0.0, 0.0);
                for (i, c) in coefficients.iter().enumerate() {
                    let (sine, cosine) = (TAU * ((m * i) % knots) as f64 / knots as f64).sin_cos();
                    (a, b) = (a + c * cosine, b + c * sine);
                }
                let (a, b) = (a * weight, b * weight);
                let [re, im] = if actual { drive.at(m - 1) } else { [1.0, 0.0] };
                Term {
                    per_turn: self.form.base() * m as f64,
                    cosine: a * re + b * im,
                    sine: b * re - a * im,
                }
            });
            Series { actuator: drive.actuator, terms: terms.collect() }
        });
        Swings(series.collect())
    }
}

impl<'p> Spline<'p> {
    fn new(problem: &'p Problem<'p>, knots: usize, before: &Swings) -> Self {
        let n = knots * problem.drives.len();
        let mut scale = vec![1.0; n + 3];
        for (k, drive) in problem.drives.iter().enumerate() {
            let unit = match drive.actuator {
                Actuator::CentreLine | Actuator::Across => 0.1,
                Actuator::ToolPhase => 1e-3,
            };
            scale[k * knots..(k + 1) * knots].fill(unit);
        }
        (scale[n], scale[n + 1]) = (1e-3, 1e-2);
        let mut lp = Self { problem, knots, equal: Vec::new(), within: Vec::new(), scale };
        for k in 0..problem.drives.len() {
            // a swing about a middle: a constant would be another distance of the axes
            lp.equal.push(((0..knots).map(|i| (k * knots + i, 1.0)).collect(), 0.0));
        }
        lp.contacts(before);
        for (k, drive) in problem.drives.iter().enumerate() {
            lp.limits(k, drive);
        }
        lp.within.push((vec![(n + 2, 1.0)], 1.0));
        lp
    }

    /// |e − offset| ≤ t at every contact.
    fn contacts(&mut self, before: &Swings) {
        let form: &Form = self.problem.form;
        let n = self.knots * self.problem.drives.len();
        let cutter = form.cutter();
        let answers: Vec<Option<Vec<f64>>> =
            self.problem.drives.iter().map(|drive| answer(drive, self.knots)).collect();
        for facet in form.kinds() {
            let ends = [facet.to, facet.from].map(|s| contact(&cutter, &facet, before, s));
            for i in 0..CONTACTS {
                // denser towards the corners, where the best curve touches its limits
                let part = 0.5 - 0.5 * (PI * i as f64 / (CONTACTS - 1) as f64).cos();
                let u = Angle::rev(ends[0] + (ends[1] - ends[0]) * part);
                let work = facet.centre + u;
                let now = before.at(work);
                let mut constant = (cutter.tip_at_facet(u, now).x - cutter.flat()).value();
                let mut row = Vec::new();
                for (k, drive) in self.problem.drives.iter().enumerate() {
                    let slope = cutter.slope(u, now, drive.actuator);
                    constant -= slope * drive.actuator.of(now);
                    let at = (work.value() * form.base()).rem_euclid(1.0) * self.knots as f64;
                    row.extend(self.values(k, at, slope, answers[k].as_deref()));
                }
                for sign in [1.0, -1.0] {
                    let mut signed: Vec<_> = row.iter().map(|(c, a)| (*c, a * sign)).collect();
                    signed.extend([(n, -1.0), (n + 1, -sign)]);
                    self.within.push((signed, -constant * sign));
                }
            }
        }
    }

    /// What the coefficients of drive k give at a place counted in knots, as its loop answers.
    fn values(&self, k: usize, at: f64, slope: f64, answer: Option<&[f64]>) -> Vec<(usize, f64)> {
        let knots = self.knots;
        let whole = at.floor();
        let basis = (-2..=3).map(|i| {
            let knot = (whole as i64 + i).rem_euclid(knots.cast_signed() as i64) as usize;
            (knot, slope * quintic(at - whole - i as f64))
        });
        let Some(kernel) = answer else {
            return basis.map(|(knot, a)| (k * knots + knot, a)).collect();
        };
        let mut row = vec![0.0; knots];
        for (knot, a) in basis {
            for (j, weight) in kernel.iter().enumerate() {
                row[(knot + knots - j) % knots] += a * weight;
            }
        }
        row.into_iter().enumerate().map(|(i, a)| (k * knots + i, a)).collect()
    }

    /// Every limit of a drive, as a share s ≤ 1 of it.
    fn limits(&mut self, k: usize, drive: &Drive) {
        let share = self.knots * self.problem.drives.len() + 2;
        let knots = self.knots;
        let rate = knots as f64 * self.problem.form.base() * self.problem.spin.abs().value();
        let l = &drive.limits;
        let differences: [&[f64]; 3] = [&[1.0], &[-1.0, 1.0], &[1.0, -2.0, 1.0]];
        let orders = [l.travel, l.speed, l.acceleration];
        for ((weights, most), power) in differences.into_iter().zip(orders).zip(0..) {
            let room = most / rate.powi(power);
            if !room.is_finite() {
                continue;
            }
            for i in 0..knots {
                let row = weights.iter().enumerate();
                let row: Vec<_> = row.map(|(j, w)| (k * knots + (i + j) % knots, *w)).collect();
                self.both(&row, room.max(1e-12), share);
            }
        }
        // jerk has corners there where its coefficients would be far from it: by its values
        let room = l.jerk / rate.powi(3);
        for step in (0..JERKS * knots).filter(|_| room.is_finite()) {
            let (i, part) = (step / JERKS, (step % JERKS) as f64 / JERKS as f64);
            let row = around(k, knots, i, |at| derivative(3, at + part));
            self.both(&row, room.max(1e-12), share);
        }
        let Some(e) = l.effort else { return };
        let room = ((e.most - e.constant).max(0.0) * EFFORT_SHARE).max(1e-12);
        for step in 0..2 * knots {
            let (i, half) = (step / 2, 0.5 * (step % 2) as f64);
            let row = around(k, knots, i, |at| {
                let bend = rate * rate * derivative(2, at + half);
                e.per_acceleration * bend + e.per_speed * rate * derivative(1, at + half)
            });
            self.both(&row, room, share);
        }
    }

    /// |row| ≤ room·s.
    fn both(&mut self, row: &[(usize, f64)], room: f64, share: usize) {
        for sign in [1.0, -1.0] {
            let mut signed: Vec<_> = row.iter().map(|(c, a)| (*c, a * sign / room)).collect();
            signed.push((share, -1.0));
            self.within.push((signed, 0.0));
        }
    }

    /// Make one unknown as small as may be.
    fn minimise(&self, which: usize) -> Option<Vec<f64>> {
        let columns = self.scale.len();
        let rows = self.equal.len() + self.within.len();
        let mut by_column: Vec<Vec<(usize, f64)>> = vec![Vec::new(); columns];
        let mut b = Vec::with_capacity(rows);
        for (i, (row, bound)) in self.equal.iter().chain(&self.within).enumerate() {
            // each row to a largest entry of one
            let norm =
                row.iter().fold(1e-30_f64, |most, (c, a)| most.max((a * self.scale[*c]).abs()));
            for (column, a) in row {
                by_column[*column].push((i, a * self.scale[*column] / norm));
            }
            b.push(bound / norm);
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
        let mut q = vec![0.0; columns];
        q[which] = 1.0;
        let p = CscMatrix::zeros((columns, columns));
        let cones: [SupportedConeT<f64>; 2] =
            [ZeroConeT(self.equal.len()), NonnegativeConeT(self.within.len())];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-8,
            tol_gap_rel: 1e-8,
            tol_feas: 1e-9,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&p, &q, &a, &b, &cones, settings).ok()?;
        solver.solve();
        let status = solver.solution.status;
        matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved)
            .then(|| solver.solution.x.iter().zip(&self.scale).map(|(x, s)| x * s).collect())
    }
}

/// What a closed loop makes of coefficients, as a circular convolution; `None`: nothing.
fn answer(drive: &Drive, knots: usize) -> Option<Vec<f64>> {
    if drive.response.is_empty() {
        return None;
    }
    let at = |j: usize| {
        let mut sum = 1.0; // a constant comes as it is sent
        for m in 1..=knots / 2 {
            let [re, im] = drive.at(m - 1);
            let (sine, cosine) = (TAU * ((m * j) % knots) as f64 / knots as f64).sin_cos();
            let twice = if 2 * m == knots { 1.0 } else { 2.0 };
            sum += twice * (re * cosine - im * sine);
        }
        sum / knots as f64
    };
    Some((0..knots).map(at).collect())
}

/// A row for a place near knot i of drive k: the weight of each coefficient by how far the knot lies from its own.
fn around(k: usize, knots: usize, i: usize, weight: impl Fn(f64) -> f64) -> Vec<(usize, f64)> {
    let row = (-3..=3).map(|j: i64| {
        let knot = (i.cast_signed() as i64 + j).rem_euclid(knots.cast_signed() as i64) as usize;
        (k * knots + knot, weight(-j as f64))
    });
    row.filter(|(_, weight)| *weight != 0.0).collect()
}

/// β⁵, the uniform quintic B-spline about zero.
fn quintic(x: f64) -> f64 {
    spline(5, x)
}

/// Its derivatives, by knots: differences of splines of a lower degree.
fn derivative(order: u32, x: f64) -> f64 {
    let half = f64::from(order) / 2.0;
    let (mut sum, mut binomial) = (0.0, 1.0);
    for k in 0..=order {
        sum += binomial * spline(5 - order, x + half - f64::from(k));
        binomial *= -f64::from(order - k) / f64::from(k + 1);
    }
    sum
}

/// Of a degree, by the recursion of Cox and de Boor.
fn spline(degree: u32, x: f64) -> f64 {
    if degree == 0 {
        return if (-0.5..0.5).contains(&x) { 1.0 } else { 0.0 };
    }
    let (p, half) = (f64::from(degree), f64::from(degree + 1) / 2.0);
    if x.abs() >= half {
        return 0.0;
    }
    ((x + half) * spline(degree - 1, x + 0.5) + (half - x) * spline(degree - 1, x - 0.5)) / p
}

#[cfg(test)]
mod tests {
    use super::*;

    /// β⁵ at −2 … 2.
    const QUINTIC: [f64; 5] = [1.0 / 120.0, 26.0 / 120.0, 66.0 / 120.0, 26.0 / 120.0, 1.0 / 120.0];

    #[test]
    fn the_splines_are_the_ones_of_the_books() {
        for (k, value) in (-2..=2).zip(QUINTIC) {
            assert!((quintic(f64::from(k)) - value).abs() < 1e-15);
        }
        assert!((spline(3, 0.0) - 2.0 / 3.0).abs() < 1e-15);
        assert!((spline(4, 0.0) - 230.0 / 384.0).abs() < 1e-15);
        let h = 1e-4;
        for x in [-2.3, -0.8, 0.1, 1.7] {
            for order in 1..=3 {
                let lower = |x| derivative(order - 1, x);
                let slope = (lower(x + h) - lower(x - h)) / (2.0 * h);
                assert!((derivative(order, x) - slope).abs() < 1e-6, "{order} at {x}");
            }
        }
    }
}
