//! Symmetric positive definite systems in which each unknown meets only the two before and after it.

/// The matrix, by rows: the diagonal, one before it, two before it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Band {
    pub(crate) rows: alloc::vec::Vec<[f64; 3]>,
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

    /// Turn the matrix into its factors L·D·Lᵀ, in place.
    pub(crate) fn factor(&mut self) {
        let (mut d1, mut d2, mut l_before) = (1.0, 1.0, 0.0); // of the row before, and of the one before that
        for row in &mut self.rows {
            let l2 = row[2] / d2;
            let l1 = (row[1] - row[2] * l_before) / d1;
            let d = row[0] - l1 * l1 * d1 - l2 * l2 * d2;
            // rounding may leave nothing of a stiff diagonal; what is tiny is not to become a large step
            let d = d.max(1e-14 * row[0]);
            *row = [d, l1, l2];
            (d2, d1, l_before) = (d1, d, l1);
        }
    }

    /// Solve in place; after [`Band::factor`].
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let rows = &self.rows;
        let (mut x1, mut x2) = (0.0, 0.0);
        for (row, x) in rows.iter().zip(x.iter_mut()) {
            *x -= row[1] * x1 + row[2] * x2;
            (x2, x1) = (x1, *x);
        }
        // backwards: D·Lᵀ·x = y
        for i in (0..rows.len()).rev() {
            let mut value = x[i] / rows[i][0];
            if let Some(row) = rows.get(i + 1) {
                value -= row[1] * x[i + 1];
            }
            if let Some(row) = rows.get(i + 2) {
                value -= row[2] * x[i + 2];
            }
            x[i] = value;
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
            Band { rows: alloc::vec![[4., 0., 0.], [5., 1., 0.], [6., 2., 1.], [7., 1., 1.]] };
        let mut x = [9.0, 21.0, 27.0, 33.0];
        band.factor();
        band.solve(&mut x);
        for (x, wanted) in x.iter().zip([1.0, 2.0, 3.0, 4.0]) {
            assert!((x - wanted).abs() < 1e-12, "{x}");
        }
    }
}
