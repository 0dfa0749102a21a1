//! A cell of the jerk-limited plan's grid: the motion at both its ends, the phases that join them, and what jerk it may have.
use super::cell::{Cell, Demand, Row, Rows};
use super::phase::Phase;

/// Share of the limit of jerk that the plan uses; the rest is for what happens between the places that are looked at.
pub(super) const JERK_SHARE: f64 = 0.99;

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
    /// Share of the jerk's limit that the plan uses here.
    pub(super) share: f64,
}

impl Fine {
    /// At rest, until a plan is read.
    pub(super) const fn new(cell: usize, from: f64, h: f64) -> Self {
        Self { cell, from, h, v: 0.0, a: 0.0, v1: 0.0, a1: 0.0, share: JERK_SHARE }
    }

    /// Largest jerk of an axis in it, over its limit.
    pub(super) fn jerk(&self, cell: &Cell) -> f64 {
        let mut most = 0.0_f64;
        self.phases(|phase| {
            let most = &mut most;
            match &cell.demand {
                Demand::Line { jerk, .. } => *most = most.max(phase.j.abs() / jerk),
                Demand::Curve(rows) => {
                    let (s, v, a) = phase.at(phase.duration);
                    for (s, v, a) in [(phase.s, phase.v, phase.a), (s, v, a)] {
                        each(rows, (s / cell.h).clamp(0.0, 1.0), |r| {
                            let j = r.j1 * phase.j + 3.0 * r.j2 * v * a + r.j3 * v * v * v;
                            *most = most.max(j.abs());
                        });
                    }
                }
            }
        });
        most
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
        let root = libm::sqrt((sum * sum - 4.0 * d * h).max(0.0));
        let t = 2.0 * h / (sum + root);
        let turn = (a1 - a) / t;
        let j = (v1 - v - 2.0 * a * t) / (t * t) - turn / 2.0;
        let first = Phase { duration: t, s, v, a, j };
        let (s, v, a) = first.at(t);
        give(first);
        give(Phase { duration: t, s, v, a, j: turn - j });
    }
}

/// Largest s⃛ at rest.
pub(super) fn jerk_along(cell: &Cell) -> f64 {
    match &cell.demand {
        Demand::Line { jerk, .. } => *jerk,
        Demand::Curve(rows) => {
            let of = |r: &Rows| {
                r.all().iter().fold(f64::INFINITY, |m: f64, row| m.min(1.0 / row.j1.abs()))
            };
            of(&rows[0]).min(of(&rows[1])).min(of(&rows[2]))
        }
    }
}

/// Growth of ṡ^{3/2} by length.
pub(super) fn growth(cell: &Cell) -> f64 {
    GROWTH * libm::sqrt(jerk_along(cell))
}

/// The demands at a share of a cell.
pub(super) fn each(rows: &[Rows; 3], x: f64, mut give: impl FnMut(Row)) {
    let (p, q, f) =
        if x < 0.5 { (&rows[0], &rows[1], 2.0 * x) } else { (&rows[1], &rows[2], 2.0 * x - 1.0) };
    let mix = |a: f64, b: f64| a + (b - a) * f;
    for (p, q) in p.all().iter().zip(q.all()) {
        give(Row {
            a1: mix(p.a1, q.a1),
            a2: mix(p.a2, q.a2),
            j1: mix(p.j1, q.j1),
            j2: mix(p.j2, q.j2),
            j3: mix(p.j3, q.j3),
        });
    }
}
