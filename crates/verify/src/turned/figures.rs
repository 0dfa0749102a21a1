//! Figures of a thread from what was seen of a pass: points of depth and distance from the helix,
//! mm, and turns.
use super::feature::LeadOfTurn;
use super::law::Law;
use units::{Angle, Lead, Length};

/// The lead of each whole turn that was seen.
pub(super) fn leads(law: &Law<'_>, at: &[[f64; 3]]) -> Vec<LeadOfTurn> {
    let (Some(first), Some(last)) = (at.first(), at.last()) else { return Vec::new() };
    // what was seen next to a turn, as far from it as the spindle goes in a period
    let seen = |turn: f64| {
        let k = at.partition_point(|point| point[2] < turn).clamp(1, at.len() - 1);
        let [before, after] = [at[k - 1], at[k]];
        let share =
            if after[2] > before[2] { (turn - before[2]) / (after[2] - before[2]) } else { 0.0 };
        (after[2] - before[2] < 0.5).then(|| before[1] + share * (after[1] - before[1]))
    };
    let whole = (last[2] - first[2]).floor().max(0.0) as u32;
    let turn = |k: u32| {
        let from = first[2] + f64::from(k);
        let way = law.place(from + 1.0) - law.place(from);
        let grown = (seen(from + 1.0)? - seen(from)?) * law.sign();
        Some(LeadOfTurn {
            depth: Length::mm((law.place(from) - law.surface().value()) * law.sign()),
            ordered: Lead::mm_per_rev(way.abs()),
            cut: Lead::mm_per_rev(way.abs() + grown),
        })
    };
    (0..whole).filter_map(turn).collect()
}

/// Where the spindle stood when the tool was where the chain begins, by the mean of what was seen:
/// in (−½, ½] turns.
pub(super) fn start_angle(law: &Law<'_>, at: &[[f64; 3]], sense: f64) -> Angle {
    let late =
        |[_, error, turn]: &[f64; 3]| -error / (law.place(turn + 0.5) - law.place(turn - 0.5));
    let mean = at.iter().map(late).sum::<f64>() / at.len().max(1) as f64;
    let turns = law.start_angle().value() + sense * mean;
    Angle::rev(0.5 - (0.5 - turns).rem_euclid(1.0))
}

/// Slope of the distance from the helix by least squares, times the length over which it was seen,
/// mm.
pub(super) fn lead_error(at: &[[f64; 3]]) -> f64 {
    let count = at.len() as f64;
    if at.len() < 2 {
        return 0.0;
    }
    let [depth, error] = [0, 1].map(|i| at.iter().map(|point| point[i]).sum::<f64>() / count);
    let (mut by_depth, mut squares) = (0.0, 0.0);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for [d, e, _] in at {
        by_depth += (d - depth) * (e - error);
        squares += (d - depth) * (d - depth);
        (low, high) = (low.min(*d), high.max(*d));
    }
    if squares > 0.0 { by_depth / squares * (high - low) } else { 0.0 }
}

/// Few enough points for a picture.
pub(super) fn thinned(at: &[[f64; 3]]) -> Vec<[Length; 2]> {
    const POINTS: usize = 400;
    at.iter()
        .step_by(at.len().div_ceil(POINTS).max(1))
        .map(|[d, e, _]| [*d, *e].map(Length::mm))
        .collect()
}
