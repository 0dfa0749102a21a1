//! The flattest facet where a limit binds: the oscillation as a spline, not as a few harmonics.
//!
//! At a limit the best motion has corners in its jerk, which harmonics reach slowly: with 64 of
//! them the facet is still three percent less flat than it could be. A uniform quintic B-spline
//! over one period of the form has them almost exactly, and its limits cost one row each:
//!
//! ```text
//!   x(ψ) = Σ c_i·β⁵(K·ψ − i)      x⁽ⁿ⁾ = (K·M·n)ⁿ · Σ (Δⁿc)_i·β⁵⁻ⁿ      |Δⁿc| within a limit ⇒ |x⁽ⁿ⁾| within it
//! ```
//!
//! since a spline stays within its coefficients. A limit of which a few harmonics used little is
//! looked at only if the spline exceeds it. What comes out is handed on as harmonics: those of the
//! spline are the transform of its coefficients times sinc⁶(m/K), and beyond 2K they are too small
//! to matter; should what is left out lift a peak over its limit, everything is made so much
//! smaller.
use super::drive::Drive;
use super::lp::{Constraint, Lp};
use super::optimise::{Best, Detail, Problem, Solution, flat};
use super::series::{Series, Swings, Term};
use std::f64::consts::{PI, TAU};
use units::Length;

/// Knots of a period: as it is to be cut, and to be drawn.
const KNOTS: [usize; 2] = [120, 36];
/// Highest harmonic that may be handed on, periods a turn.
const HIGHEST: f64 = 2000.0;
/// Places along a facet at which it shall be flat: as it is to be cut, and to be drawn.
const CONTACTS: [usize; 2] = [61, 25];
/// Corrections of what is not linear, beginning with what a few harmonics made of it, likewise: at
/// least, and at most.
const CORRECTIONS: [[usize; 2]; 2] = [[2, 5], [1, 1]];
/// A limit of which a few harmonics use less than this is not looked at beforehand.
const MATTERS: f64 = 0.6;
/// A limit may be exceeded by this before it is looked at: everything is made so much smaller at
/// last.
const EXCEEDED: f64 = 1.001;
/// Left to what samples of a drive's effort do not see.
const EFFORT_SHARE: f64 = 0.995;

/// Which of a drive's limits are in the problem: travel, speed, acceleration, jerk, effort.
type Looked = [bool; 5];

/// The linear problem. Unknowns: each drive's coefficients, t, x₀, s, the share of the limits that
/// is used, and e at each contact, so that a row has either many entries or both bounds, not both.
struct Spline<'p> {
    problem: &'p Problem<'p>,
    knots: usize,
    contacts: usize,
    /// Cosine and sine at each knot of a period.
    turns: Vec<[f64; 2]>,
    /// What each drive's loop makes of coefficients.
    answers: Vec<Option<Vec<f64>>>,
}

impl Problem<'_> {
    /// Solve it with as much detail as the limits make use of, from what a few harmonics made of
    /// it; `None` if the solver fails.
    pub(crate) fn solve_finely(&self, few: &Solution, detail: Detail) -> Option<Solution> {
        let spline = Spline::new(self, detail);
        let n = spline.unknowns();
        let mut looked: Vec<Looked> = self.drives.iter().zip(&few.peaks).map(matters).collect();
        let mut actual = few.actual.clone();
        let mut best = Best::default();
        let [least, most] = CORRECTIONS[detail as usize];
        for round in 1..=most {
            let (mut x, mut lp) = spline.flattest(&actual, &mut looked)?;
            if x[n + 2] < 0.999 && round >= least {
                x = lp.least_effort(n, &x);
            }
            actual = spline.swings(&x, true);
            if best.is_as_promised(self.form.flatness(&actual), &x, n) && round >= least {
                break;
            }
        }
        let x = best.0?.1;
        Some(self.solution(spline.swings(&x, false), spline.swings(&x, true)))
    }
}

fn matters((drive, peaks): (&Drive, &[f64; 5])) -> Looked {
    drive.limits.shares(peaks).map(|share| share > MATTERS)
}

impl<'p> Spline<'p> {
    fn new(problem: &'p Problem<'p>, detail: Detail) -> Self {
        let contacts = CONTACTS[detail as usize];
        let knots =
            KNOTS[detail as usize].min((HIGHEST / 2.0 / problem.form.base()) as usize).max(16);
        let turns: Vec<[f64; 2]> = (0..knots)
            .map(|i| (TAU * i as f64 / knots as f64).sin_cos())
            .map(|(sine, cosine)| [cosine, sine])
            .collect();
        let answers = problem.drives.iter().map(|drive| answer(drive, &turns)).collect();
        Self { problem, knots, contacts, turns, answers }
    }

    fn unknowns(&self) -> usize {
        self.knots * self.problem.drives.len()
    }

    /// The flattest about a swing, with every limit that it would exceed looked at.
    fn flattest(&self, before: &Swings, looked: &mut [Looked]) -> Option<(Vec<f64>, Lp)> {
        loop {
            let mut lp = self.linear(before, looked);
            let x = lp.minimise(self.unknowns())?;
            let peaks = self.problem.peaks(&self.swings(&x, false));
            let mut more = false;
            for ((drive, peaks), looked) in self.problem.drives.iter().zip(&peaks).zip(&mut *looked)
            {
                for (looked, share) in looked.iter_mut().zip(drive.limits.shares(peaks)) {
                    more |= !*looked && share > EXCEEDED;
                    *looked |= share > EXCEEDED;
                }
            }
            if !more {
                return Some((x, lp));
            }
        }
    }

    /// Harmonics of a solution, as sent or as they come.
    fn swings(&self, x: &[f64], actual: bool) -> Swings {
        let knots = self.knots;
        let series = self.problem.drives.iter().enumerate().map(|(k, drive)| {
            let coefficients = &x[k * knots..(k + 1) * knots];
            let terms = (1..2 * knots).map(|m| {
                let part = PI * m as f64 / knots as f64;
                let weight = 2.0 / knots as f64 * (part.sin() / part).powi(6);
                let (mut a, mut b) = (0.0, 0.0);
                for (i, c) in coefficients.iter().enumerate() {
                    let [cosine, sine] = self.turns[(m * i) % knots];
                    (a, b) = (a + c * cosine, b + c * sine);
                }
                let (a, b) = (a * weight, b * weight);
                let [re, im] = if actual { drive.at(m - 1) } else { [1.0, 0.0] };
                Term {
                    per_turn: self.problem.form.base() * m as f64,
                    cosine: a * re + b * im,
                    sine: b * re - a * im,
                }
            });
            Series { actuator: drive.actuator, terms: terms.collect() }
        });
        Swings(series.collect()).standing(Length::mm(x[self.unknowns() + 1]))
    }

    fn linear(&self, before: &Swings, looked: &[Looked]) -> Lp {
        let (knots, n) = (self.knots, self.unknowns());
        let base = self.problem.form.base();
        let errors = self.problem.errors(before, self.contacts, n + 1, |k, work, slope| {
            let at = (work.value() * base).rem_euclid(1.0) * knots as f64;
            self.values(k, at, slope)
        });
        let units = (0..n).map(|column| self.problem.drives[column / knots].actuator.unit());
        let scale = units.chain([1e-3, 0.1, 1.0]).chain(errors.iter().map(|_| 1e-3)).collect();
        // a swing about a middle: where X stands is an unknown of its own
        let middle = |k: usize| Constraint {
            weights: (0..knots).map(|i| (k * knots + i, 1.0)).collect(),
            bound: 0.0,
        };
        let mut equal: Vec<Constraint> = (0..self.problem.drives.len()).map(middle).collect();
        let mut within = Vec::with_capacity(2 * errors.len());
        for (e, (mut weights, constant)) in (n + 3..).zip(errors) {
            weights.push((e, -1.0));
            equal.push(Constraint { weights, bound: -constant });
            within.extend(flat(&[(e, 1.0)], 0.0, n));
        }
        let mut lp = Lp { scale, equal, within, ..Lp::default() };
        for (k, (drive, looked)) in self.problem.drives.iter().zip(looked).enumerate() {
            self.limits(k, drive, *looked, &mut lp.within);
        }
        lp.within.push(Constraint { weights: vec![(n + 2, 1.0)], bound: 1.0 });
        lp
    }

    /// What the coefficients of drive k give at a place counted in knots, as its loop answers.
    fn values(&self, k: usize, at: f64, slope: f64) -> Vec<(usize, f64)> {
        let knots = self.knots;
        let whole = at.floor();
        let basis = (-2..=3).map(|i| {
            let knot = (whole as i64 + i).rem_euclid(knots.cast_signed() as i64) as usize;
            (knot, slope * spline(5, at - whole - i as f64))
        });
        let Some(kernel) = &self.answers[k] else {
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

    /// The limits of a drive that are looked at, as a share s ≤ 1 of each.
    fn limits(&self, k: usize, drive: &Drive, looked: Looked, rows: &mut Vec<Constraint>) {
        let knots = self.knots;
        let rate = knots as f64 * self.problem.form.base() * self.problem.spin.abs().value();
        let l = &drive.limits;
        let mut both = |weights: Vec<(usize, f64)>, room: f64| {
            for sign in [1.0, -1.0] {
                let mut signed: Vec<_> =
                    weights.iter().map(|(c, a)| (*c, a * sign / room)).collect();
                signed.push((self.unknowns() + 2, -1.0));
                rows.push(Constraint { weights: signed, bound: 0.0 });
            }
        };
        let differences: [&[f64]; 4] =
            [&[1.0], &[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];
        let orders = [l.travel, l.speed, l.acceleration, l.jerk];
        let wanted = differences.into_iter().zip(orders).zip(looked).zip(0..);
        for (((weights, most), looked), power) in wanted {
            if !looked || !most.is_finite() {
                continue;
            }
            let room = (most / rate.powi(power)).max(1e-12);
            for i in 0..knots {
                let row = weights.iter().enumerate();
                both(row.map(|(j, w)| (k * knots + (i + j) % knots, *w)).collect(), room);
            }
        }
        let Some(e) = l.effort.filter(|_| looked[4]) else { return };
        let room = ((e.most - e.constant).max(0.0) * EFFORT_SHARE).max(1e-12);
        for step in 0..2 * knots {
            let (i, half) = (step / 2, 0.5 * (step % 2) as f64);
            let row = around(k, knots, i, |at| {
                let bend = rate * rate * derivative(2, at + half);
                e.per_acceleration * bend + e.per_speed * rate * derivative(1, at + half)
            });
            both(row, room);
        }
    }
}

/// What a closed loop makes of coefficients, as a circular convolution; `None`: nothing.
fn answer(drive: &Drive, turns: &[[f64; 2]]) -> Option<Vec<f64>> {
    if drive.response.is_empty() {
        return None;
    }
    let knots = turns.len();
    let at = |j: usize| {
        let mut sum = 1.0; // a constant comes as it is sent
        for m in 1..=knots / 2 {
            let [re, im] = drive.at(m - 1);
            let [cosine, sine] = turns[(m * j) % knots];
            let twice = if 2 * m == knots { 1.0 } else { 2.0 };
            sum += twice * (re * cosine - im * sine);
        }
        sum / knots as f64
    };
    Some((0..knots).map(at).collect())
}

/// A row for a place near knot i of drive k: the weight of each coefficient by how far the knot
/// lies from its own.
fn around(k: usize, knots: usize, i: usize, weight: impl Fn(f64) -> f64) -> Vec<(usize, f64)> {
    let row = (-3..=3).map(|j: i64| {
        let knot = (i.cast_signed() as i64 + j).rem_euclid(knots.cast_signed() as i64) as usize;
        (k * knots + knot, weight(-j as f64))
    });
    row.filter(|(_, weight)| *weight != 0.0).collect()
}

/// Derivatives of β⁵, the uniform quintic B-spline about zero, by knots: differences of splines of
/// a lower degree.
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
            assert!((spline(5, f64::from(k)) - value).abs() < 1e-15);
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
