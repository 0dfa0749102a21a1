//! Symmetric positive definite systems of equations whose matrix is a band of blocks: B unknowns
//! belong together, and meet those of their own block and of the next W − 1 ones.
//!
//! ```text
//!   ┌ D A₁ A₂       ┐      L·D·Lᵀ, from above: each row of blocks loses what the W − 1 rows before it take,
//!   │   D  A₁ A₂    │
//!   │      D  A₁ …  │      Aₗ of row k  −=  Aᵢᵀ·D⁻¹·Aᵢ₊ₗ of row k − i
//!   └         ⋱     ┘
//! ```
//!
//! (Golub and Van Loan, *Matrix Computations*, 2013, ch. 4.3.)
use alloc::vec::Vec;

/// Share of a diagonal that is no more than its rounding.
const LOST: f64 = 1e-12;

type Block<const B: usize> = [[f64; B]; B];

/// The matrix, by rows of blocks: the one on the diagonal, of which only what is on it and above
/// counts, and those behind it. After [`Banded::factor`] Lᵀ, with 1/D on the diagonal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Banded<const B: usize, const W: usize> {
    pub(crate) rows: Vec<[Block<B>; W]>,
}

impl<const W: usize> Banded<1, W> {
    /// What ties an unknown to the one that comes so many after it.
    pub(crate) fn entry(&mut self, unknown: usize, after: usize) -> &mut f64 {
        &mut self.rows[unknown][after][0][0]
    }
}

impl<const B: usize, const W: usize> Banded<B, W> {
    /// All zero.
    pub(crate) fn clear(&mut self, count: usize) {
        self.rows.clear();
        self.rows.resize(count, [[[0.0; B]; B]; W]);
    }

    /// An unknown that is given: its equation becomes x = right-hand side, which nothing else
    /// meets.
    pub(crate) fn fix(&mut self, block: usize, unknown: usize) {
        for row in 0..B {
            self.rows[block][0][row][unknown] = 0.0;
        }
        self.rows[block].iter_mut().for_each(|block| block[unknown] = [0.0; B]);
        self.rows[block][0][unknown][unknown] = 1.0;
        for away in 1..W.min(block + 1) {
            self.rows[block - away][away].iter_mut().for_each(|row| row[unknown] = 0.0);
        }
    }

    /// Make the diagonal larger by this share of it.
    pub(crate) fn damp(&mut self, share: f64) {
        for row in &mut self.rows {
            (0..B).for_each(|i| row[0][i][i] *= 1.0 + share);
        }
    }

    /// Turn the matrix into its factors, in place. Where rounding leaves nothing of a stiff
    /// diagonal, 1/D is zero, and the unknown comes out as zero.
    pub(crate) fn factor(&mut self) {
        for at in 0..self.rows.len() {
            let (above, rest) = self.rows.split_at_mut(at);
            let row = &mut rest[0];
            let stiff: [f64; B] = core::array::from_fn(|i| row[0][i][i]);
            for (back, before) in (1..W).zip(above.iter().rev()) {
                let over: [f64; B] = core::array::from_fn(|i| before[0][i][i]);
                let mut shares = before[back];
                for (shares, over) in shares.iter_mut().zip(over) {
                    *shares = shares.map(|share| share * over);
                }
                for (block, before) in row.iter_mut().zip(&before[back..]) {
                    subtract(block, &shares, before);
                }
            }
            within(row, &stiff);
        }
        // D·Lᵀ becomes Lᵀ
        for row in &mut self.rows {
            for i in 0..B {
                let over = row[0][i][i];
                row[0][i][i + 1..].iter_mut().for_each(|entry| *entry *= over);
                row[1..].iter_mut().for_each(|block| block[i] = block[i].map(|entry| entry * over));
            }
        }
    }

    /// Solve in place for N right-hand sides at once; after [`Banded::factor`].
    pub(crate) fn solve<const N: usize>(&self, x: &mut [[[f64; N]; B]]) {
        for (at, row) in self.rows.iter().enumerate() {
            let (known, behind) = x[at..].split_at_mut(1);
            let known = &mut known[0];
            for i in 0..B {
                let (done, later) = known.split_at_mut(i + 1);
                for (x, share) in later.iter_mut().zip(&row[0][i][i + 1..]) {
                    less(x, *share, &done[i]);
                }
            }
            for (x, block) in behind.iter_mut().zip(&row[1..]) {
                for (known, shares) in known.iter().zip(block) {
                    x.iter_mut().zip(shares).for_each(|(x, share)| less(x, *share, known));
                }
            }
        }
        for (at, row) in self.rows.iter().enumerate().rev() {
            let (x, behind) = x[at..].split_at_mut(1);
            let x = &mut x[0];
            for i in (0..B).rev() {
                let mut own = x[i].map(|x| x * row[0][i][i]);
                for (block, known) in row[1..].iter().zip(behind.iter()) {
                    block[i].iter().zip(known).for_each(|(share, x)| less(&mut own, *share, x));
                }
                let later = row[0][i][i + 1..].iter().zip(&x[i + 1..]);
                later.for_each(|(share, x)| less(&mut own, *share, x));
                x[i] = own;
            }
        }
    }

    /// [`Banded::solve`] for one right-hand side.
    pub(crate) fn solve_one(&self, x: &mut [[f64; B]]) {
        self.solve(x.as_flattened_mut().as_chunks_mut::<1>().0.as_chunks_mut::<B>().0);
    }
}

/// Elimination within a row of blocks, whose diagonal was `stiff` before; 1/D comes into its place.
fn within<const B: usize, const W: usize>(row: &mut [Block<B>; W], stiff: &[f64; B]) {
    for (i, stiff) in stiff.iter().enumerate() {
        let pivot = row[0][i][i];
        let over = if pivot > LOST * stiff { 1.0 / pivot } else { 0.0 };
        row[0][i][i] = over;
        for k in i + 1..B {
            let share = row[0][i][k] * over;
            for block in row.iter_mut() {
                let eliminated = block[i];
                block[k].iter_mut().zip(eliminated).for_each(|(a, b)| *a -= share * b);
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

/// a −= f·b
fn less<const N: usize>(a: &mut [f64; N], f: f64, b: &[f64; N]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a -= f * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_solved_for_is_found_again_and_what_is_given_stays_zero() {
        const B: usize = 2;
        const W: usize = 4;
        let count = 6;
        let element = |i: usize, j: usize| match (i / B).abs_diff(j / B) {
            _ if i == j => 10.0 + i as f64,
            d if d < W => 1.0 / (1.0 + (i.min(j) * i.abs_diff(j)) as f64),
            _ => 0.0,
        };
        let mut matrix = Banded::<B, W>::default();
        matrix.clear(count);
        for i in 0..count * B {
            for j in i..(count * B).min((i / B + W) * B) {
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
        matrix.factor();
        matrix.solve_one(&mut x);
        for (found, wanted) in x.as_flattened().iter().zip(&wanted) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }

    #[test]
    fn single_unknowns_are_solved_for_several_right_hand_sides_at_once() {
        // [[4,1,1,0],[1,5,2,1],[1,2,6,1],[0,1,1,7]] times (1,2,3,4), and times (0,1,0,−1)
        let mut band = Banded::<1, 3>::default();
        band.clear(4);
        for (i, row) in [[4.0, 1.0, 1.0], [5.0, 2.0, 1.0], [6.0, 1.0, 0.0], [7.0, 0.0, 0.0]]
            .into_iter()
            .enumerate()
        {
            (0..3).for_each(|after| *band.entry(i, after) = row[after]);
        }
        let mut x = [[[9.0, 1.0]], [[21.0, 4.0]], [[27.0, 1.0]], [[33.0, -6.0]]];
        band.factor();
        band.solve(&mut x);
        for (x, wanted) in x.iter().zip([[1.0, 0.0], [2.0, 1.0], [3.0, 0.0], [4.0, -1.0]]) {
            let off = |i: usize| (x[0][i] - wanted[i]).abs();
            assert!(off(0) < 1e-12 && off(1) < 1e-12, "{x:?}");
        }
    }

    #[test]
    fn an_unknown_whose_diagonal_is_lost_to_rounding_comes_out_as_zero() {
        let mut band = Banded::<1, 3>::default();
        band.clear(2);
        for (i, after) in [(0, 0), (0, 1), (1, 0)] {
            *band.entry(i, after) = 1.0;
        }
        let mut x = [[2.0], [2.0]];
        band.factor();
        band.solve_one(&mut x);
        assert_eq!(x, [[2.0], [0.0]]);
    }
}
