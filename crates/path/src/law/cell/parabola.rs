//! What is demanded between the places of a cell: a polynomial through them.
//!
//! Where blends bend sharply in a small part of them (q‴ falls to a tenth within some percent of
//! the length), a parabola through three places leads past what is demanded there, and the law past
//! its limits: such a cell is cut in two. Where one axis may hardly change its acceleration and
//! others may, what is demanded is a small difference of large terms: with a limit of jerk, five
//! places of a blend are known.
use super::{LimitRow, Rows};
use crate::{AXES, Bounds, Derivatives};

/// How far what is demanded may lie beside its parabola, as a share of the limit.
const OFF: f64 = 0.02;

/// The demands at a share of a cell: by the parabola through its three places, or the polynomial of
/// the fourth degree through all five.
pub(crate) fn between(rows: &Rows, x: f64) -> impl Iterator<Item = LimitRow> {
    let three = rows.at(0).iter().zip(rows.at(1)).zip(rows.at(2));
    let quarters = rows.quarters();
    let (at_three, at_quarters) =
        if quarters.is_some() { quartic(x) } else { (parabola(x), [0.0; 2]) };
    three.enumerate().map(move |(axis, ((a, b), c))| {
        let [p, q, r] = at_three;
        let mut mixed = mix([(p, a), (q, b), (r, c)]);
        if let Some([first, second]) = quarters {
            let [f, s] = at_quarters;
            mixed = mix([(1.0, &mixed), (f, &first[axis]), (s, &second[axis])]);
        }
        mixed
    })
}

/// Shares of the three places.
fn parabola(x: f64) -> [f64; 3] {
    [(2.0 * x - 1.0) * (x - 1.0), 4.0 * x * (1.0 - x), x * (2.0 * x - 1.0)]
}

/// Shares of the three places and of both quarters: Lagrange's.
fn quartic(x: f64) -> ([f64; 3], [f64; 2]) {
    let [a, b, c, d, e] = [4.0 * x, 4.0 * x - 1.0, 4.0 * x - 2.0, 4.0 * x - 3.0, 4.0 * x - 4.0];
    (
        [b * c * d * e / 24.0, a * b * d * e / 4.0, a * b * c * d / 24.0],
        [-a * c * d * e / 6.0, -a * b * c * e / 6.0],
    )
}

fn mix(of: [(f64, &LimitRow); 3]) -> LimitRow {
    let sum = |term: fn(&LimitRow) -> f64| of.iter().map(|(share, row)| share * term(row)).sum();
    LimitRow {
        a1: sum(|row| row.a1),
        a2: sum(|row| row.a2),
        j1: sum(|row| row.j1),
        j2: sum(|row| row.j2),
        j3: sum(|row| row.j3),
    }
}

/// How far an axis' acceleration q′·s̈ + q″·ṡ² may be above its limit between places of a cell, as
/// a share of it, where s̈ is constant.
const ABOVE: f64 = 0.01;

/// Whether each axis' acceleration stays near the straight lines between three places where s̈ is
/// constant: as for the whole of a piece (`cells_for_sag`), in a part of it.
pub(super) fn keeps_between(three: &[Derivatives; 3], bounds: &Bounds) -> bool {
    let [start, middle, end] = three;
    let slope = |k: usize| three.iter().fold(0.0, |m: f64, d| m.max(d.q1[k].abs()));
    let fastest = (0..AXES).map(|k| 2.0 * bounds.accel[k] / slope(k)).fold(f64::MAX, f64::min);
    (0..AXES).all(|k| {
        let second = (start.q1[k] - 2.0 * middle.q1[k] + end.q1[k]).abs();
        second == 0.0 || 5.0 / 8.0 * second * fastest <= ABOVE * bounds.accel[k]
    })
}

/// Whether the parabolas through the three places lead near what is demanded at both quarters, as
/// far as that matters with ṡ² up to a `cap`.
pub(super) fn fits(rows: &Rows, cap: f64) -> bool {
    let least = |of: fn(&LimitRow) -> f64| {
        rows.all().iter().fold(f64::MAX, |m: f64, row| m.min(1.0 / of(row).abs()))
    };
    // what one term alone leaves of the limits: ṡ², s̈, s⃛, ṡ·s̈ and ṡ³
    let b = cap.min(least(|row| row.a2));
    let (v, a, u) = (libm::sqrt(b), least(|row| row.a1), least(|row| row.j1));
    let (va, v3) = ((v * a).min(least(|row| 3.0 * row.j2)), (v * b).min(least(|row| row.j3)));
    let near = |(x, real): (f64, &[LimitRow])| {
        let [p, q, r] = parabola(x);
        let three = rows.at(0).iter().zip(rows.at(1)).zip(rows.at(2));
        three.zip(real).all(|(((first, second), third), real)| {
            let row = mix([(p, first), (q, second), (r, third)]);
            let off = |of: fn(&LimitRow) -> f64| (of(&row) - of(real)).abs();
            let accel = off(|row| row.a1) * a + off(|row| row.a2) * b;
            let jerk =
                off(|row| row.j1) * u + 3.0 * off(|row| row.j2) * va + off(|row| row.j3) * v3;
            accel <= OFF && jerk <= OFF
        })
    };
    rows.quarters().is_none_or(|[first, second]| near((0.25, first)) && near((0.75, second)))
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
