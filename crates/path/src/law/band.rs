//! Symmetric positive definite systems in which each unknown meets only the two before and after it.

use alloc::vec::Vec;

/// Share of a diagonal that is no more than its rounding.
const LOST: f64 = 1e-12;

/// The matrix, by rows: the diagonal, one before it, two before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Band {
    pub(crate) rows: Vec<[f64; 3]>,
}

impl Band {
    pub(crate) fn clear(&mut self, n: usize) {
        self.rows.clear();
        self.rows.resize(n, [0.0; 3]);
    }

    /// Make an unknown stand alone: its equation becomes x = right-hand side.
    pub(crate) fn pin(&mut self, i: usize) {
        self.rows[i] = [1.0, 0.0, 0.0];
        if let Some(row) = self.rows.get_mut(i + 1) {
            row[1] = 0.0;
        }
        if let Some(row) = self.rows.get_mut(i + 2) {
            row[2] = 0.0;
        }
    }

    /// Turn the matrix into its factors L·D·Lᵀ, in place; in D's place is 1/D.
    pub(crate) fn factor(&mut self) {
        // of the row before, and of the one before that: d, 1/d; and l of the row before
        let (mut d1, mut d2, mut over1, mut over2, mut l_before) = (1.0, 1.0, 1.0, 1.0, 0.0);
        for row in &mut self.rows {
            let l2 = row[2] * over2;
            let l1 = (row[1] - row[2] * l_before) * over1;
            let d = row[0] - l1 * l1 * d1 - l2 * l2 * d2;
            // where rounding leaves nothing of a stiff diagonal, the unknown stays as it is
            let (d, over) = if d > LOST * row[0] { (d, 1.0 / d) } else { (0.0, 0.0) };
            *row = [over, l1, l2];
            (d2, d1, over2, over1, l_before) = (d1, d, over1, over, l1);
        }
    }

    /// Solve in place; after [`Band::factor`].
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let (mut x1, mut x2) = (0.0, 0.0);
        for (row, x) in self.rows.iter().zip(x.iter_mut()) {
            *x -= row[1] * x1 + row[2] * x2;
            (x2, x1) = (x1, *x);
        }
        // backwards, Lᵀ·x = y/D: what the rows behind take away from the next, and from the one after it
        let (mut next, mut after) = (0.0, 0.0);
        for (row, x) in self.rows.iter().zip(x.iter_mut()).rev() {
            *x = *x * row[0] - next;
            (next, after) = (row[1] * *x + after, row[2] * *x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_system_is_solved() {
        // rows of [[4,1,1,0],[1,5,2,1],[1,2,6,1],[0,1,1,7]] times (1,2,3,4)
        let mut band =
            Band { rows: Vec::from([[4., 0., 0.], [5., 1., 0.], [6., 2., 1.], [7., 1., 1.]]) };
        let mut x = [9.0, 21.0, 27.0, 33.0];
        band.factor();
        band.solve(&mut x);
        for (x, wanted) in x.iter().zip([1.0, 2.0, 3.0, 4.0]) {
            assert!((x - wanted).abs() < 1e-12, "{x}");
        }
    }
}
