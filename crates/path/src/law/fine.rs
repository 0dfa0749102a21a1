//! A cell of the jerk-limited plan's grid: the motion at both its ends, the phases that join them,
//! and what jerk it may have.
use super::cell::parabola::between;
use super::cell::{Cell, Demand};
use crate::{Instant, Phase};

/// Share of the limit of jerk that the plan uses; the rest is for what happens between the places
/// that are looked at.
pub(super) const JERK_SHARE: f64 = 0.99;

/// Share of the accelerations that the plan uses.
const ACCEL_SHARE: f64 = 0.995;

/// Where the speed changes by such a share within a phase, it is looked at in more places.
const UNEVEN: f64 = 0.1;

/// Slowest later than this share of a cell is at its end.
const NEARLY: f64 = 0.99;

/// w = ṡ^{3/2} grows by this times √J per length at most: (½·6^{2/3})^{3/2}.
const GROWTH: f64 = 2.121_320_343_559_643;

/// A cell of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fine {
    /// Which cell of the path, and where in it this one begins.
    pub(super) cell: usize,
    pub(super) from: f64,
    pub(super) h: f64,
    /// Motion at its beginning.
    pub(super) v: f64,
    pub(super) a: f64,
    /// At its end.
    pub(super) v1: f64,
    pub(super) a1: f64,
    /// Share of the acceleration's limit that the plan uses here.
    pub(super) accel_share: f64,
    /// Share of the jerk's limit.
    pub(super) share: f64,
}

impl Fine {
    /// At rest, until a plan is read.
    pub(super) const fn new(cell: usize, from: f64, h: f64) -> Self {
        Self {
            cell,
            from,
            h,
            v: 0.0,
            a: 0.0,
            v1: 0.0,
            a1: 0.0,
            accel_share: ACCEL_SHARE,
            share: JERK_SHARE,
        }
    }

    /// Largest acceleration and largest jerk of an axis in it, over their limits.
    pub(super) fn loads(&self, cell: &Cell) -> (f64, f64) {
        let (mut accel, mut jerk) = (0.0_f64, 0.0_f64);
        self.phases(|phase| match &cell.demand {
            Demand::Line { accel: a, jerk: j } => {
                accel = accel.max(phase.a.abs() / a);
                jerk = jerk.max(phase.j.abs() / j);
            }
            Demand::Curve(rows) => {
                let ends = phase.end();
                let uneven = (ends.v - phase.v).abs() > UNEVEN * ends.v.max(phase.v);
                let looks = if uneven { 8 } else { 4 };
                for n in 0..=looks {
                    let share = f64::from(n) / f64::from(looks);
                    let Instant { s, v, a } = phase.at(share * phase.duration);
                    for r in between(rows, (s / cell.h).clamp(0.0, 1.0)) {
                        let j = r.j1 * phase.j + 3.0 * r.j2 * v * a + r.j3 * v * v * v;
                        jerk = jerk.max(j.abs());
                        accel = accel.max((r.a1 * a + r.a2 * v * v).abs());
                    }
                }
            }
        });
        (accel, jerk)
    }

    /// Phases of constant s⃛ that join the motion at both ends, over exactly its length.
    pub(super) fn phases(&self, mut give: impl FnMut(Phase)) {
        let Self { from: s, h, v, a, v1, a1, .. } = *self;
        if v == 0.0 || v1 == 0.0 {
            // from rest, or to it: one jerk, h = v·t/3
            let t = 3.0 * h / (v + v1);
            let j = 6.0 * h / (t * t * t);
            let a = if v == 0.0 { 0.0 } else { -j * t };
            give(Phase { duration: t, s, v, a, j });
            return;
        }
        // two of equal duration: h = (v + v₁)·t − (a₁ − a)·t²/3
        let (sum, d) = (v + v1, (a1 - a) / 3.0);
        let square = sum * sum - 4.0 * d * h;
        if square < 0.0 {
            return self.crawl(&mut give);
        }
        let t = 2.0 * h / (sum + libm::sqrt(square));
        let turn = (a1 - a) / t;
        let j = (v1 - v - 2.0 * a * t) / (t * t) - turn / 2.0;
        let first = Phase { duration: t, s, v, a, j };
        let Instant { s, v, a } = first.at(t);
        give(first);
        give(Phase { duration: t, s, v, a, j: turn - j });
    }

    /// Slowing down nearly to rest and speeding up again within the cell: in parts, that meet where
    /// it is slowest, and where it is as much faster than that as it is slower than at the end. All
    /// of them lie on ṡ² = v² + 2·a·s + u·s².
    fn crawl(&self, give: &mut dyn FnMut(Phase)) {
        let Self { from, h, v, a, v1, a1, .. } = *self;
        let u = (a1 - a) / h;
        let slowest = -a / u;
        let at = if a < 0.0 && a1 > 0.0 && slowest < NEARLY * h && slowest > (1.0 - NEARLY) * h {
            slowest
        } else {
            // u·s² + 2·a·s = v·v₁ − v²
            let c = v * (v1 - v);
            let root = libm::sqrt((a * a + u * c).max(0.0));
            if a < 0.0 { c / (a - root) } else { c / (a + root) }
        };
        let square = v * v + at * (2.0 * a + u * at);
        if !(at > 1e-9 * h && at < h * (1.0 - 1e-9) && square > 0.0) {
            // rounding is all that is left
            let t = 2.0 * h / (v + v1);
            return give(Phase { duration: t, s: from, v, a: (v1 - v) / t, j: 0.0 });
        }
        let (middle, slope) = (libm::sqrt(square), a + u * at);
        Self { h: at, v1: middle, a1: slope, ..*self }.phases(&mut *give);
        let rest = Self { from: from + at, h: h - at, v: middle, a: slope, ..*self };
        rest.phases(give);
    }
}

/// Largest s⃛ at rest.
pub(super) fn jerk_along(cell: &Cell) -> f64 {
    match &cell.demand {
        Demand::Line { jerk, .. } => *jerk,
        Demand::Curve(rows) => {
            rows.all().iter().fold(f64::INFINITY, |m: f64, row| m.min(1.0 / row.j1.abs()))
        }
    }
}

/// Growth of ṡ^{3/2} by length.
pub(super) fn growth(cell: &Cell) -> f64 {
    GROWTH * libm::sqrt(jerk_along(cell))
}

/// The same as steps of τ show it: a jerk that reaches the acceleration within one of them is no
/// more to them than that.
pub(super) fn growth_in_steps(cell: &Cell, tau: f64) -> f64 {
    let jerk = jerk_along(cell);
    if jerk.is_infinite() {
        return f64::INFINITY;
    }
    let accel = match &cell.demand {
        Demand::Line { accel, .. } => *accel,
        Demand::Curve(rows) => {
            rows.all().iter().fold(f64::INFINITY, |m: f64, row| m.min(1.0 / row.a1.abs()))
        }
    };
    GROWTH * libm::sqrt(jerk.min(accel / tau))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Through 0.1 mm/s with ±100 mm/s² at the ends of 2 µm: ṡ² = v² + 2·a·s + u·s².
    #[test]
    fn slowing_down_nearly_to_rest_covers_the_cell_exactly_without_going_back() {
        for least in [0.2_f64, 0.05, 0.01, 1e-4] {
            let (h, a) = (2e-3, 100.0);
            let v = (least * least + a * h / 2.0).sqrt();
            let fine = Fine { v, a: -a, v1: v, a1: a, ..Fine::new(0, 0.5, h) };
            let mut phases = Vec::new();
            fine.phases(|phase| phases.push(phase));
            let last = phases[phases.len() - 1];
            let Instant { s, v: v1, a: a1 } = last.end();
            assert!((s - 0.5 - h).abs() < 1e-12, "ends {} off", s - 0.5 - h);
            assert!((v1 - v).abs() < 1e-9 && (a1 - a).abs() < 1e-6, "{v1} {a1}");
            for phase in &phases {
                for n in 0..=4 {
                    let Instant { v, .. } = phase.at(phase.duration * f64::from(n) / 4.0);
                    assert!(v >= -1e-9, "{v} mm/s at {least}");
                }
            }
        }
    }

    /// From 2.8 to 0.35 mm/s, where −930 mm/s² have faded to nothing, or to a rounding above it.
    #[test]
    fn slowing_down_ends_with_the_acceleration_that_was_planned() {
        for a1 in [0.0, 1e-9, -1e-9, 1e-3] {
            let (v, a, v1) = (2.769, -933.3, 0.3538);
            let h = (v1 * v1 - v * v) / (a + a1);
            let fine = Fine { v, a, v1, a1, ..Fine::new(0, 0.0, h) };
            let mut end = Instant { s: 0.0, v, a };
            fine.phases(|phase| {
                assert!((phase.a - end.a).abs() < 1e-6, "from {} to {} at once", end.a, phase.a);
                end = phase.end();
            });
            assert!((end.s - h).abs() < 1e-12 && (end.a - a1).abs() < 1e-6, "{end:?}");
        }
    }

    #[test]
    fn ends_that_lie_on_no_such_motion_still_cover_the_cell_exactly() {
        let fine = Fine { v: 0.03, a: -3.0, v1: 0.002, a1: 4.0, ..Fine::new(0, 1.0, 2e-3) };
        let (mut at, mut speed) = (1.0, 0.03);
        fine.phases(|phase| {
            assert!((phase.s - at).abs() < 1e-12 && (phase.v - speed).abs() < 1e-9);
            Instant { s: at, v: speed, .. } = phase.end();
        });
        assert!((at - 1.002).abs() < 1e-12 && (speed - 0.002).abs() < 1e-9, "{at} {speed}");
    }
}
