//! Least squares: a model's parameters from samples, with an interval that holds where residuals
//! are correlated.
//!
//! ```text
//!   min ‖r(p)‖²     Levenberg-Marquardt, forward differences
//!   cov = N⁻¹·(Σ gᵦ·gᵦᵀ)·N⁻¹     N = JᵀJ, gᵦ = Σ Jᵢ·rᵢ over the block β
//! ```
//!
//! What is left of a model is no white noise: a screw's error per turn, a friction that the model
//! does not have. Sums over blocks that are longer than such a memory keep it in the covariance
//! (Newey, West, Econometrica 55 (1987) 703-708; here with blocks that do not overlap). The usual
//! covariance, σ²·N⁻¹, is the least that is believed.
use std::ops::Range;

/// Steps of the solver, at most.
pub(crate) const MOST_STEPS: usize = 30;
/// Share by which the sum of squares falls in a step that is worth another one.
const WORTH: f64 = 1e-6;
/// Step of a difference, as a share of the parameter's own size.
const DIFFERENCE: f64 = 1e-5;
/// Student's quantile of 95 % where there are this many blocks or more.
const MANY_BLOCKS: usize = 60;

/// Residuals of a model, and which of them belong together.
pub(crate) struct Residuals {
    /// Measured less modelled.
    pub(crate) values: Vec<f64>,
    /// Ranges of values that are independent of one another.
    pub(crate) blocks: Vec<Range<usize>>,
}

/// Parameters that were found.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    /// Their values.
    pub(crate) values: Vec<f64>,
    /// Their covariance, row by row.
    covariance: Vec<Vec<f64>>,
    /// Root mean square of what is left.
    pub(crate) rms: f64,
    /// Student's quantile for 95 %.
    quantile: f64,
}

impl Fit {
    /// A function of the parameters, with half the width of its 95 % interval.
    pub(crate) fn of(&self, function: impl Fn(&[f64]) -> f64) -> Estimate {
        let value = function(&self.values);
        let slopes: Vec<f64> = (0..self.values.len())
            .map(|i| {
                let step = DIFFERENCE * self.values[i].abs().max(1e-12);
                let mut moved = self.values.clone();
                moved[i] += step;
                (function(&moved) - value) / step
            })
            .collect();
        let square: f64 = (0..slopes.len())
            .flat_map(|i| (0..slopes.len()).map(move |j| (i, j)))
            .map(|(i, j)| slopes[i] * slopes[j] * self.covariance[i][j])
            .sum();
        Estimate { value, half: self.quantile * square.max(0.0).sqrt() }
    }
}

/// A value with half the width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Half the width of the interval.
    pub half: f64,
}

impl Estimate {
    /// The same in another unit.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, half: self.half * factor.abs() }
    }

    /// The same with what the model itself may be off by, as a share of the value.
    pub(crate) fn widened(self, share: f64) -> Self {
        Self { half: self.half.hypot(share * self.value), ..self }
    }

    /// True where the interval holds a value.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.half
    }
}

/// Fits the parameters from where they begin; those that are not free stay. `scales`: what counts
/// as a small change of each. It ends after `most_steps` at the latest.
pub(crate) fn fit(
    begin: &[f64],
    free: &[bool],
    scales: &[f64],
    residuals: &dyn Fn(&[f64]) -> Residuals,
    most_steps: usize,
) -> Option<Fit> {
    let free: Vec<usize> = (0..begin.len()).filter(|i| free[*i]).collect();
    let mut at = begin.to_vec();
    let mut here = residuals(&at);
    let mut cost = square(&here.values);
    let mut damping = 1e-3;
    for _ in 0..most_steps {
        let jacobian = slopes(&at, &free, scales, &here, residuals);
        let (normal, right) = normal(&jacobian, &here.values);
        let before = cost;
        for _ in 0..12 {
            let mut damped = normal.clone();
            for (i, row) in damped.iter_mut().enumerate() {
                row[i] *= 1.0 + damping;
            }
            let step = solve(damped, &right)?;
            let mut moved = at.clone();
            for (k, i) in free.iter().enumerate() {
                moved[*i] += step[k];
            }
            let there = residuals(&moved);
            let less = square(&there.values);
            if less < cost {
                (at, here, cost, damping) = (moved, there, less, damping * 0.2);
                break;
            }
            damping *= 6.0;
        }
        if before - cost <= WORTH * before {
            break;
        }
    }
    let jacobian = slopes(&at, &free, scales, &here, residuals);
    let (normal, _) = normal(&jacobian, &here.values);
    let inverse = inverse(&normal)?;
    Some(finish(at, &free, &here, &jacobian, &inverse))
}

/// The covariance of what was found.
fn finish(
    values: Vec<f64>,
    free: &[usize],
    here: &Residuals,
    jacobian: &[Vec<f64>],
    inverse: &[Vec<f64>],
) -> Fit {
    let n = free.len();
    let freedom = here.values.len().saturating_sub(n).max(1) as f64;
    let variance = square(&here.values) / freedom;
    let mut meat = vec![vec![0.0; n]; n];
    for block in &here.blocks {
        let sum =
            |k: usize| -> f64 { block.clone().map(|i| jacobian[k][i] * here.values[i]).sum() };
        let g: Vec<f64> = (0..n).map(sum).collect();
        for (i, row) in meat.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate() {
                *cell += g[i] * g[j];
            }
        }
    }
    let blocks = here.blocks.len() as f64;
    let correction = blocks / (blocks - n as f64).max(1.0);
    let product = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let cell = |i: usize, j: usize| (0..n).map(|k| a[i][k] * b[k][j]).sum();
        (0..n).map(|i| (0..n).map(|j| cell(i, j)).collect()).collect()
    };
    let sandwich = product(&product(inverse, &meat), inverse);
    let mut covariance = vec![vec![0.0; values.len()]; values.len()];
    // each parameter's own variance is the larger of both; correlations are those of the sandwich
    let larger: Vec<f64> = (0..n)
        .map(|k| {
            let robust = sandwich[k][k] * correction;
            (inverse[k][k] * variance / robust.max(f64::MIN_POSITIVE)).max(1.0).sqrt()
        })
        .collect();
    for (a, i) in free.iter().enumerate() {
        for (b, j) in free.iter().enumerate() {
            covariance[*i][*j] = sandwich[a][b] * correction * larger[a] * larger[b];
        }
    }
    let rms = (square(&here.values) / here.values.len().max(1) as f64).sqrt();
    let quantile = if here.blocks.len() >= MANY_BLOCKS { 2.0 } else { 2.2 };
    Fit { values, covariance, rms, quantile }
}

fn square(values: &[f64]) -> f64 {
    values.iter().map(|r| r * r).sum()
}

/// How the model changes with each free parameter: minus the slope of the residual.
fn slopes(
    at: &[f64],
    free: &[usize],
    scales: &[f64],
    here: &Residuals,
    residuals: &dyn Fn(&[f64]) -> Residuals,
) -> Vec<Vec<f64>> {
    free.iter()
        .map(|i| {
            let step = DIFFERENCE * at[*i].abs().max(scales[*i]);
            let mut moved = at.to_vec();
            moved[*i] += step;
            let there = residuals(&moved);
            here.values.iter().zip(&there.values).map(|(a, b)| (a - b) / step).collect()
        })
        .collect()
}

fn normal(jacobian: &[Vec<f64>], r: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
    let matrix = jacobian.iter().map(|a| jacobian.iter().map(|b| dot(a, b)).collect()).collect();
    (matrix, jacobian.iter().map(|a| dot(a, r)).collect())
}

/// Solves a symmetric positive system by Cholesky's factors of the scaled matrix; `None`: it is
/// singular.
pub(crate) fn solve(matrix: Vec<Vec<f64>>, right: &[f64]) -> Option<Vec<f64>> {
    let n = right.len();
    let scale: Vec<f64> = (0..n).map(|i| matrix[i][i].sqrt()).collect();
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let mut l = matrix;
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            let rest = l[i][j] / (scale[i] * scale[j]) - known;
            if i == j {
                if rest <= 1e-14 {
                    return None;
                }
                l[i][i] = rest.sqrt();
            } else {
                l[i][j] = rest / l[j][j];
            }
        }
    }
    let mut y = vec![0.0; n];
    for i in 0..n {
        let known: f64 = (0..i).map(|k| l[i][k] * y[k]).sum();
        y[i] = (right[i] / scale[i] - known) / l[i][i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| l[k][i] * y[k]).sum();
        y[i] = (y[i] - known) / l[i][i];
    }
    Some(y.iter().zip(&scale).map(|(x, s)| x / s).collect())
}

fn inverse(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
    (0..n).map(|i| solve(matrix.to_vec(), &unit(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 3 + 2·x with noise that keeps its sign over a while.
    fn line(seed: u64, memory: f64) -> Vec<(f64, f64)> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut draw = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut noise = 0.0;
        let point = |i: u32| {
            noise = memory * noise + draw();
            let x = f64::from(i % 500) / 500.0;
            (x, 3.0 + 2.0 * x + noise)
        };
        (0..8000).map(point).collect()
    }

    fn fitted(points: &[(f64, f64)]) -> Fit {
        let residuals = |p: &[f64]| Residuals {
            values: points.iter().map(|(x, y)| y - p[0] - p[1] * x).collect(),
            blocks: (0..80).map(|b| b * 100..(b + 1) * 100).collect(),
        };
        fit(&[0.0, 1.0], &[true, true], &[1.0, 1.0], &residuals, MOST_STEPS).unwrap()
    }

    #[test]
    fn intervals_hold_where_noise_is_white_and_where_it_remembers() {
        for memory in [0.0, 0.8] {
            let holds = |seed: u64| {
                let fit = fitted(&line(seed, memory));
                [fit.of(|p| p[0]).holds(3.0), fit.of(|p| p[1]).holds(2.0)]
            };
            let all: Vec<bool> = (1..=100).flat_map(holds).collect();
            let share = all.iter().filter(|holds| **holds).count();
            assert!((180..=198).contains(&share), "{share} of 200 with memory {memory}");
        }
    }

    #[test]
    fn a_function_of_parameters_has_the_interval_of_its_slopes() {
        let fit = fitted(&line(1, 0.0));
        let (a, b) = (fit.of(|p| p[1]), fit.of(|p| 4.0 * p[1]));
        assert!((b.half - 4.0 * a.half).abs() < 1e-6 * b.half);
        assert_eq!(a.times(-4.0).half, 4.0 * a.half);
    }

    #[test]
    fn what_cannot_be_told_apart_is_no_fit() {
        let residuals = |p: &[f64]| Residuals {
            values: (0..100).map(|i| f64::from(i % 7) - p[0] - p[1]).collect(),
            blocks: std::iter::once(0..100).collect(),
        };
        assert!(fit(&[0.0, 0.0], &[true, true], &[1.0, 1.0], &residuals, 9).is_none());
    }
}
