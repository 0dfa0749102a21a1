//! Symmetric systems of equations whose matrix is a band.
//!
//! ```text
//!   Uᵀ·D·U·x = r       a row holds D and, behind it, the row of U up to the band's end
//! ```
//!
//! (Golub and Van Loan, *Matrix Computations*, 2013, ch. 4.3.)
use alloc::vec::Vec;

/// The matrix; then its factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Banded {
    /// Length of a row: the diagonal, and what is beside it on one side.
    width: usize,
    rows: Vec<f64>,
}

impl Banded {
    /// All zero.
    pub(crate) fn clear(&mut self, count: usize, width: usize) {
        self.width = width;
        self.rows.clear();
        self.rows.resize(count * width, 0.0);
    }

    /// Add to an element, and to the one across the diagonal; `i` ≤ `j`.
    pub(crate) fn add(&mut self, i: usize, j: usize, x: f64) {
        self.rows[i * self.width + j - i] += x;
    }

    /// A row, from the diagonal on.
    pub(crate) fn row(&mut self, i: usize) -> &mut [f64] {
        &mut self.rows[i * self.width..(i + 1) * self.width]
    }

    /// Add f·b·bᵀ, where b has these elements, in order.
    pub(crate) fn rank_one(&mut self, indices: &[usize], b: &[f64], f: f64) {
        for (k, (i, x)) in indices.iter().zip(b).enumerate() {
            let row = &mut self.rows[i * self.width..(i + 1) * self.width];
            for (j, y) in indices.iter().zip(b).skip(k) {
                row[j - i] += f * x * y;
            }
        }
    }

    /// The same where b's elements follow each other.
    pub(crate) fn rank_one_of_all(&mut self, first: usize, b: &[f64], f: f64) {
        for (k, x) in b.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            let row = &mut self.rows[(first + k) * self.width..];
            for (to, y) in row.iter_mut().zip(&b[k..]) {
                *to += f * x * y;
            }
        }
    }

    /// An unknown that is given: zero.
    pub(crate) fn fix(&mut self, i: usize) {
        let row = &mut self.rows[i * self.width..(i + 1) * self.width];
        row.fill(0.0);
        row[0] = 1.0;
        for back in 1..self.width.min(i + 1) {
            self.rows[(i - back) * self.width + back] = 0.0;
        }
    }

    /// Solve for the right-hand side that `x` is; the matrix is spent. `regular`: by how much, as a share, its diagonal is
    /// made larger against rounding.
    pub(crate) fn solve(&mut self, x: &mut [f64], regular: f64) {
        let (width, count) = (self.width, x.len());
        for i in 0..count {
            let (row, below) = self.rows[i * width..].split_at_mut(width);
            let pivot = (row[0] * (1.0 + regular)).max(f64::MIN_POSITIVE);
            row[0] = pivot;
            for k in 1..width.min(count - i) {
                let share = row[k] / pivot;
                if share != 0.0 {
                    let other = &mut below[(k - 1) * width..k * width - k];
                    for (a, b) in other.iter_mut().zip(&row[k..]) {
                        *a -= share * b;
                    }
                    x[i + k] -= share * x[i];
                }
            }
        }
        for i in (0..count).rev() {
            let row = &self.rows[i * width..(i + 1) * width];
            let known: f64 = row[1..].iter().zip(&x[i + 1..]).map(|(a, x)| a * x).sum();
            x[i] = (x[i] - known) / row[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_solved_for_is_found_again_and_what_is_given_stays_zero() {
        let (count, width) = (9, 4);
        let element = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 10.0 + i as f64,
            d if d < width => 1.0 / (1.0 + (i.min(j) * d) as f64),
            _ => 0.0,
        };
        let mut matrix = Banded::default();
        matrix.clear(count, width);
        for i in 0..count {
            for j in i..count.min(i + width) {
                matrix.add(i, j, element(i, j));
            }
        }
        let given = 5;
        matrix.fix(given);
        let mut wanted: Vec<f64> = (0..count).map(|i| 1.0 - i as f64).collect();
        wanted[given] = 0.0;
        let mut x: Vec<f64> = (0..count)
            .map(|i| (0..count).map(|j| element(i, j) * wanted[j]).sum::<f64>())
            .collect();
        x[given] = 0.0;
        matrix.solve(&mut x, 0.0);
        for (found, wanted) in x.iter().zip(&wanted) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }
}
