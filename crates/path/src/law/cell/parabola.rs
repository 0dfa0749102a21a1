//! What is demanded between the three places of a cell: a parabola through them.
//!
//! Where blends bend sharply in a small part of them (q‴ falls to a tenth within some percent of
//! the length), a parabola leads past what is demanded there, and the law past its limits: such a
//! cell is cut in two.
use super::{LimitRow, Rows, moving};
use crate::{AXES, Bounds, Derivatives};

/// How far what is demanded may lie beside its parabola, as a share of the limit.
const OFF: f64 = 0.02;

/// The demands at a share of a cell.
pub(in crate::law) fn between(rows: &Rows, x: f64) -> impl Iterator<Item = LimitRow> {
    let [p, q, r] = [(2.0 * x - 1.0) * (x - 1.0), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)];
    let three = rows.at(0).iter().zip(rows.at(1)).zip(rows.at(2));
    three.map(move |((a, b), c)| {
        let mix = |of: fn(&LimitRow) -> f64| p * of(a) + q * of(b) + r * of(c);
        LimitRow {
            a1: mix(|row| row.a1),
            a2: mix(|row| row.a2),
            j1: mix(|row| row.j1),
            j2: mix(|row| row.j2),
            j3: mix(|row| row.j3),
        }
    })
}

/// Whether the parabolas through three places lead near what is demanded at the two quarters, as
/// far as that matters with ṡ² up to a `cap`.
pub(super) fn fits(
    rows: &Rows,
    (three, quarters): (&[Derivatives; 3], &[Derivatives; 2]),
    bounds: &Bounds,
    cap: f64,
) -> bool {
    let least = |of: fn(&LimitRow) -> f64| {
        rows.all().iter().fold(f64::MAX, |m: f64, row| m.min(1.0 / of(row).abs()))
    };
    // what one term alone leaves of the limits: ṡ², s̈, s⃛, ṡ·s̈ and ṡ³
    let b = cap.min(least(|row| row.a2));
    let (v, a, u) = (libm::sqrt(b), least(|row| row.a1), least(|row| row.j1));
    let (va, v3) = ((v * a).min(least(|row| 3.0 * row.j2)), (v * b).min(least(|row| row.j3)));
    let axes = moving(three);
    [0.25, 0.75].into_iter().zip(quarters).all(|(x, d)| {
        let real = (0..AXES).filter(|k| axes[*k]).map(|k| LimitRow::of(d, k, bounds));
        between(rows, x).zip(real).all(|(row, real)| {
            let off = |of: fn(&LimitRow) -> f64| (of(&row) - of(&real)).abs();
            let accel = off(|row| row.a1) * a + off(|row| row.a2) * b;
            let jerk =
                off(|row| row.j1) * u + 3.0 * off(|row| row.j2) * va + off(|row| row.j3) * v3;
            accel <= OFF && jerk <= OFF
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::{Cell, Demand, Sampler};
    use super::*;
    use crate::geometry::{Joiner, Segment};
    use alloc::vec::Vec;
    use motion::{Curve, Limits, Line, Piece, Shape};
    use proptest::prelude::*;

    fn decades(range: core::ops::Range<f64>) -> impl Strategy<Value = f64> {
        range.prop_map(|exponent| 10.0_f64.powf(exponent))
    }

    /// The blends of a corner of two lines.
    fn blends(ends: [[f64; 3]; 2], tolerance: f64, limits: &Limits) -> Vec<Piece> {
        let wide = |of: [f64; 3]| core::array::from_fn(|k| of.get(k).copied().unwrap_or(0.0));
        let middle = [0.0; AXES];
        let (mut joiner, mut pieces) = (Joiner::new(limits), Vec::new());
        for [from, to] in [[wide(ends[0]), middle], [middle, wide(ends[1])]] {
            let length = motion::measure(&core::array::from_fn(|k| to[k] - from[k]));
            let curve = Curve::Line(Line { from, to, length });
            let (feed, rapid, merge) = (100.0, false, 0.0);
            let segment = Segment { curve, feed, rapid, tolerance, merge, op: 0, line: 0 };
            joiner.push(segment, &mut |piece| pieces.push(piece));
        }
        joiner.finish(&mut |piece| pieces.push(piece));
        pieces.retain(|piece| matches!(piece.curve, Curve::Polynomial(_)));
        pieces
    }

    fn limits() -> impl Strategy<Value = Limits> {
        let axis = (decades(0.5..3.3), decades(1.0..5.0), decades(1.0..7.0));
        prop::array::uniform3(axis).prop_map(|axes| {
            let of = |value: fn(&(f64, f64, f64)) -> f64| {
                core::array::from_fn(|k| axes.get(k).map_or(1000.0, value))
            };
            let feed = Bounds { speed: of(|a| a.0), accel: of(|a| a.1), jerk: of(|a| a.2) };
            Limits { feed, rapid: feed }
        })
    }

    /// All terms over their limits at a place, as fast as the cell and each term alone allow.
    fn terms(rows: &[LimitRow], cell: &Cell, all: &[LimitRow]) -> Vec<[f64; 5]> {
        let least = |of: fn(&LimitRow) -> f64| {
            all.iter().fold(f64::MAX, |m: f64, row| m.min(1.0 / of(row).abs()))
        };
        let b = cell.cap.min(least(|row| row.a2));
        let v = b.sqrt();
        let a = least(|row| row.a1);
        let va = (v * a).min(least(|row| 3.0 * row.j2));
        let v3 = (v * b).min(least(|row| row.j3));
        let u = least(|row| row.j1);
        rows.iter().map(|r| [r.a1 * a, r.a2 * b, r.j1 * u, 3.0 * r.j2 * va, r.j3 * v3]).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(test_support::size::of(64, 4000)))]

        /// At fifteen places of each cell of a blend, whatever the limits.
        #[test]
        fn along_a_cell_each_demand_is_near_its_parabola(
            ends in prop::array::uniform2(prop::array::uniform3(-20.0..20.0_f64)),
            tolerance in decades(-4.0..-1.0),
            limits in limits(),
        ) {
            for piece in blends(ends, tolerance, &limits) {
                look_at_cells(&piece, &limits)?;
            }
        }
    }

    fn look_at_cells(piece: &Piece, limits: &Limits) -> Result<(), TestCaseError> {
        let mut sampler = Sampler::new(piece, 0, 0.0, None, limits, 1e-3);
        let mut at = 0.0;
        while let Some(cell) = sampler.next(limits) {
            prop_assert!((cell.from - at).abs() < 1e-12, "begins at {} after {at}", cell.from);
            at = cell.from + cell.h;
            let Demand::Curve(rows) = &cell.demand else { panic!("{cell:?}") };
            for n in 1..16 {
                let x = f64::from(n) / 16.0;
                let d = piece.at(cell.from + x * cell.h);
                let real: Vec<LimitRow> =
                    (0..3).map(|k| LimitRow::of(&d, k, &limits.feed)).collect();
                let near: Vec<LimitRow> = between(rows, x).collect();
                let both = [near, real].map(|of| terms(&of, &cell, rows.all()));
                for (near, real) in both[0].iter().zip(&both[1]) {
                    for (near, real) in near.iter().zip(real) {
                        prop_assert!(
                            (near - real).abs() < 1.5 * OFF,
                            "{near} of {real} at {x} of {cell:?}"
                        );
                    }
                }
            }
        }
        prop_assert!((at - piece.length).abs() < 1e-12, "ends at {at} of {}", piece.length);
        Ok(())
    }
}
