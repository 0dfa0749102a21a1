//! Symmetric systems of equations whose matrix is a band of blocks: B unknowns belong together, and meet those of the next
//! three blocks.
//!
//! ```text
//!   ┌ D A₁ A₂ A₃         ┐      a row of blocks is eliminated from the three below it that it meets:
//!   │   D  A₁ A₂ A₃      │
//!   │      D  A₁ A₂ A₃   │      Aₗ of row k  −=  Aₖᵀ·D⁻¹·Aₖ₊ₗ of this row
//!   └         ⋱          ┘
//! ```
//!
//! (Golub and Van Loan, *Matrix Computations*, 2013, ch. 4.3.)
use super::load::SAY;
use alloc::vec::Vec;

type Block<const B: usize> = [[f64; B]; B];

/// The matrix, by rows of blocks: the one on the diagonal, of which only what is on it and above counts, and those behind it.
/// Then its factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Banded<const B: usize> {
    pub(crate) rows: Vec<[Block<B>; SAY]>,
}

impl<const B: usize> Banded<B> {
    /// All zero.
    pub(crate) fn clear(&mut self, count: usize) {
        self.rows.clear();
        self.rows.resize(count, [[[0.0; B]; B]; SAY]);
    }

    /// An unknown that is given: zero.
    pub(crate) fn fix(&mut self, block: usize, unknown: usize) {
        for row in 0..B {
            self.rows[block][0][row][unknown] = 0.0;
        }
        self.rows[block].iter_mut().for_each(|block| block[unknown] = [0.0; B]);
        self.rows[block][0][unknown][unknown] = 1.0;
        for away in 1..SAY.min(block + 1) {
            self.rows[block - away][away].iter_mut().for_each(|row| row[unknown] = 0.0);
        }
    }

    /// Solve for the right-hand side that `x` is; the matrix is spent. `damping`: by how much, as a share, its diagonal is
    /// made larger.
    pub(crate) fn solve(&mut self, x: &mut [[f64; B]], damping: f64) {
        for row in &mut self.rows {
            (0..B).for_each(|i| row[0][i][i] *= 1.0 + damping);
        }
        for at in 0..x.len() {
            let (above, below) = self.rows.split_at_mut(at + 1);
            let row = &mut above[at];
            within(row, &mut x[at]);
            let behind = SAY.min(x.len() - at);
            for k in 1..behind {
                let mut shares = row[k];
                for (i, shares) in shares.iter_mut().enumerate() {
                    *shares = shares.map(|share| share / row[0][i][i]);
                }
                for l in k..behind {
                    subtract(&mut below[k - 1][l - k], &shares, &row[l]);
                }
                let known = x[at];
                for (known, shares) in known.iter().zip(&shares) {
                    for (x, share) in x[at + k].iter_mut().zip(shares) {
                        *x -= share * known;
                    }
                }
            }
        }
        for at in (0..x.len()).rev() {
            let row = &self.rows[at];
            let mut known = x[at];
            for k in 1..SAY.min(x.len() - at) {
                for (known, row) in known.iter_mut().zip(&row[k]) {
                    *known -= row.iter().zip(&x[at + k]).map(|(a, x)| a * x).sum::<f64>();
                }
            }
            for i in (0..B).rev() {
                let later: f64 = (i + 1..B).map(|k| row[0][i][k] * known[k]).sum();
                known[i] = (known[i] - later) / row[0][i][i];
            }
            x[at] = known;
        }
    }
}

/// Elimination within a row of blocks.
fn within<const B: usize>(row: &mut [Block<B>; SAY], x: &mut [f64; B]) {
    for i in 0..B {
        let pivot = row[0][i][i].max(f64::MIN_POSITIVE);
        row[0][i][i] = pivot;
        for k in i + 1..B {
            let share = row[0][i][k] / pivot;
            if share != 0.0 {
                for block in row.iter_mut() {
                    let eliminated = block[i];
                    let to = block[k].iter_mut().zip(eliminated);
                    to.for_each(|(a, b)| *a -= share * b);
                }
                x[k] -= share * x[i];
            }
        }
    }
}

/// a −= bᵀ·c
fn subtract<const B: usize>(a: &mut Block<B>, b: &Block<B>, c: &Block<B>) {
    for (i, a) in a.iter_mut().enumerate() {
        let mut sum = *a;
        for (b, c) in b.iter().zip(c) {
            sum.iter_mut().zip(c).for_each(|(sum, c)| *sum -= b[i] * c);
        }
        *a = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_solved_for_is_found_again_and_what_is_given_stays_zero() {
        const B: usize = 2;
        let count = 6;
        let element = |i: usize, j: usize| match (i / B).abs_diff(j / B) {
            _ if i == j => 10.0 + i as f64,
            d if d < SAY => 1.0 / (1.0 + (i.min(j) * i.abs_diff(j)) as f64),
            _ => 0.0,
        };
        let mut matrix = Banded::<B>::default();
        matrix.clear(count);
        for i in 0..count * B {
            for j in i..(count * B).min((i / B + SAY) * B) {
                matrix.rows[i / B][j / B - i / B][i % B][j % B] = element(i, j);
            }
        }
        let given = 5;
        matrix.fix(given / B, given % B);
        let mut wanted: Vec<f64> = (0..count * B).map(|i| 1.0 - i as f64).collect();
        wanted[given] = 0.0;
        let right = |i: usize| (0..count * B).map(|j| element(i, j) * wanted[j]).sum::<f64>();
        let right = |i: usize| if i == given { 0.0 } else { right(i) };
        let mut x: Vec<[f64; B]> =
            (0..count).map(|at| [right(at * B), right(at * B + 1)]).collect();
        matrix.solve(&mut x, 0.0);
        for (found, wanted) in x.as_flattened().iter().zip(&wanted) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }
}
