//! Soft limits: does a path stay within each axis' travel?
//!
//! A line's extremes are its ends; a spline is looked at all along. An arc bulges beyond them
//! wherever it passes one of the four points where an axis turns back:
//!
//! ```text
//!         ╭──┴──╮ ¼ turn: highest Y
//!        ┤   ┼   ├ 0 turn: highest X            extremes at whole quarter turns within the sweep
//!         ╰──┬──╯
//! ```
use crate::limits::MachineLimits;
use alloc::vec;
use canon::{Arc, Axis, Position};
use core::f64::consts::TAU;
use motion::{Bezier, Path, coordinate, radius};

/// An axis that would leave its travel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Beyond {
    pub(crate) axis: Axis,
    /// Where the path would take it, mm or degrees.
    pub(crate) reaches: f64,
    /// Its travel.
    pub(crate) travel: (f64, f64),
}

impl Beyond {
    /// The coordinate nearest to the wanted one that works.
    pub(crate) fn nearest(&self) -> f64 {
        self.reaches.clamp(self.travel.0, self.travel.1)
    }
}

/// Rounding of a program's numbers, mm: that far beyond the travel is not beyond it.
const ROUNDING: f64 = 1e-6;

/// To so much the extremes of a part of a spline are found, mm: less than that.
const FINE: f64 = 1e-7;

/// All axes that leave their travel along paths.
pub(crate) fn beyond<'a>(
    paths: &'a [Path],
    limits: &'a MachineLimits,
) -> impl Iterator<Item = Beyond> + 'a {
    Axis::ALL.into_iter().filter_map(move |axis| {
        let (low, high) = limits.axes[axis.index()]?.travel?;
        let travel = (low.value(), high.value());
        let out = |x: f64| x < travel.0 - ROUNDING || x > travel.1 + ROUNDING;
        let all = paths.iter().map(|path| extremes(path, axis));
        let (lowest, highest) = all.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        let far = |x: f64| (x - travel.0).abs().max((x - travel.1).abs());
        let [near, reaches] =
            if far(lowest) > far(highest) { [highest, lowest] } else { [lowest, highest] };
        let reaches = [reaches, near].into_iter().find(|x| out(*x))?;
        Some(Beyond { axis, reaches, travel })
    })
}

/// Lowest and highest coordinate of an axis on the way and at the end. (The start is the end of the
/// move before, which has been judged.)
fn extremes(path: &Path, axis: Axis) -> (f64, f64) {
    let end = coordinate(path.to(), axis);
    let (from, arc) = match path {
        Path::Line { .. } => return (end, end),
        Path::Spline { curve, .. } => return of_spline(curve, axis.index()),
        Path::Arc { from, arc, .. } => (from, arc),
    };
    let [first, second, _] = arc.plane.axes();
    // angle, in turns, at which this axis is highest
    let (index, top) = match axis {
        a if a == first => (0, 0.0),
        a if a == second => (1, 0.25),
        _ => return (end, end),
    };
    let (r, centre) = (radius(from, arc), arc.centre[index].value());
    let mut range = (end, end);
    if passes(from, arc, top) {
        range.1 = range.1.max(centre + r);
    }
    if passes(from, arc, top + 0.5) {
        range.0 = range.0.min(centre - r);
    }
    range
}

/// Lowest and highest coordinate of an axis on a part of a spline, to within [`FINE`]: halved where
/// its control points lie beyond what was found.
fn of_spline(curve: &Bezier, axis: usize) -> (f64, f64) {
    let whole = curve.control.map(|point| point[axis]);
    let [from, .., to] = whole;
    let mut range = (from.min(to), from.max(to));
    let mut waiting = vec![whole];
    while let Some(part) = waiting.pop() {
        let beyond = |x: &f64| *x < range.0 - FINE || *x > range.1 + FINE;
        if !part.iter().any(beyond) {
            continue;
        }
        let (left, right) = halves(part);
        range = (range.0.min(right[0]), range.1.max(right[0]));
        waiting.extend([left, right]);
    }
    range
}

/// Control points of both halves of a curve, by de Casteljau's rule.
fn halves(mut row: [f64; 6]) -> ([f64; 6], [f64; 6]) {
    let (mut left, mut right) = (row, row);
    for level in 0..6 {
        left[level] = row[0];
        right[5 - level] = row[5 - level];
        for j in 0..5 - level {
            row[j] = f64::midpoint(row[j], row[j + 1]);
        }
    }
    (left, right)
}

/// Whether an arc passes an angle, in turns.
fn passes(from: &Position, arc: &Arc, angle: f64) -> bool {
    let [first, second, _] = arc.plane.axes();
    let d = [first, second].map(|a| from.along(a).value());
    let start = libm::atan2(d[1] - arc.centre[1].value(), d[0] - arc.centre[0].value()) / TAU;
    let sweep = arc.sweep.value();
    let ahead = if sweep >= 0.0 { angle - start } else { start - angle };
    ahead - libm::floor(ahead) < sweep.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    proptest! {
        /// Bernstein's form of the curve, at a thousand places, finds nothing beyond them, and
        /// something near each.
        #[test]
        fn the_extremes_of_a_spline_are_those_of_its_points(
            control in prop::array::uniform6(-100.0..100.0_f64),
        ) {
            let at = |t: f64| -> f64 {
                let u = 1.0 - t;
                let shares = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
                (0..6_u8).map(|k| {
                    let n = i32::from(k);
                    shares[usize::from(k)] * u.powi(5 - n) * t.powi(n) * control[usize::from(k)]
                }).sum()
            };
            let points: Vec<f64> = (0..=1000).map(|n| at(f64::from(n) / 1000.0)).collect();
            let point = |x: f64| core::array::from_fn(|axis| if axis == 1 { x } else { 0.0 });
            let (low, high) = of_spline(&Bezier::new(control.map(point)), 1);
            let (least, most) = (points.iter().copied().fold(f64::INFINITY, f64::min),
                points.iter().copied().fold(f64::NEG_INFINITY, f64::max));
            prop_assert!(low <= least + 2e-7 && high >= most - 2e-7);
            prop_assert!(low > least - 2e-3 && high < most + 2e-3);
        }
    }
}
