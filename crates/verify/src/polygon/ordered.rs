//! What a program ordered: where each facet stands and how far out, at any height.
//!
//! ```text
//!   gear of a few turns: normals −(k − phase − δ)/R, the same at every height
//!   one that winds, R = R₀·(1 + w): those of R₀, turned on by θ·w, θ the work's turns so far    (3600:7201 about 1:2)
//!   X of the cuts over Z: distance of the axes, at each height the least           (a taper: X and Z in one move)
//! ```
use canon::{OpKind, Position, Ratio};
use core::f64::consts::TAU;

/// More kinds of facets than this are a polygon that winds along Z.
const MOST_SIDES: usize = 64;
/// A cut reaches this far beyond its ends along Z, mm.
const BEYOND_MM: f64 = 1e-6;

/// What the program ordered.
#[derive(Clone, Debug)]
pub(crate) struct OrderedPolygon {
    pub(crate) polygon: canon::Polygon,
    at: Option<[f64; 2]>,
    /// Cuts while it is geared, machine X and Z of their ends.
    cuts: Vec<[[f64; 2]; 2]>,
}

/// Where facets stand, turns.
#[derive(Clone, Debug)]
pub(super) struct Normals {
    /// While the work stands at zero, rising from −½.
    pub(super) at_zero: Vec<f64>,
    /// By how much they turn on while the work turns once.
    pub(super) winding: f64,
}

impl Normals {
    /// Where a facet stands that is cut when the work has turned so far.
    pub(super) fn of(&self, facet: usize, work: f64) -> f64 {
        self.at_zero[facet] + self.winding * work
    }

    /// The facet that is cut when the work stands there, if one is.
    pub(super) fn nearest(&self, work: f64) -> Option<usize> {
        let off = |facet: usize| {
            let off = -work - self.of(facet, work);
            (off - off.round()).abs()
        };
        (0..self.at_zero.len()).min_by(|a, b| off(*a).total_cmp(&off(*b)))
    }
}

impl OrderedPolygon {
    pub(crate) fn new(polygon: &canon::Polygon) -> Self {
        Self { polygon: polygon.clone(), at: None, cuts: Vec::new() }
    }

    /// An operation while it is geared.
    pub(crate) fn see(&mut self, kind: &OpKind) {
        let place = |to: &Position| [to.linear[0].value(), to.linear[2].value()];
        match kind {
            OpKind::Rapid { to } => self.at = Some(place(to)),
            OpKind::Line { to, .. } | OpKind::Arc { to, .. } | OpKind::Spline { to, .. } => {
                let to = place(to);
                self.cuts.push([self.at.unwrap_or(to), to]);
                self.at = Some(to);
            }
            _ => {} // nothing else says where the tool cuts
        }
    }

    /// Least distance that X comes to; `None` before the first cut.
    pub(super) fn least_x(&self) -> Option<f64> {
        self.cuts.iter().flatten().map(|end| end[0]).min_by(f64::total_cmp)
    }

    /// X where the tool cuts at a height: by the deepest of the cuts that pass there, else the
    /// deepest of all.
    pub(super) fn x_at(&self, z: f64) -> Option<f64> {
        let passes = self.cuts.iter().filter_map(|[a, b]| {
            let (low, high) = (a[1].min(b[1]), a[1].max(b[1]));
            if z < low - BEYOND_MM || z > high + BEYOND_MM {
                return None;
            }
            let part = if high > low { (z - a[1]) / (b[1] - a[1]) } else { 1.0 };
            Some(a[0] + part.clamp(0.0, 1.0) * (b[0] - a[0]))
        });
        passes.min_by(f64::total_cmp).or_else(|| self.least_x())
    }

    /// Where the facets stand that these inserts (turns in the cutter) cut.
    pub(super) fn normals(&self, inserts: &[f64]) -> Normals {
        let ratio = self.polygon.ratio;
        let few = self.at_zero(inserts, ratio);
        if few.len() <= MOST_SIDES {
            return Normals { at_zero: few, winding: 0.0 };
        }
        let Some(settled) = ratio.settled() else {
            return Normals { at_zero: few, winding: 0.0 };
        };
        let winding = ratio.value() / settled.value() - 1.0;
        Normals { at_zero: self.at_zero(inserts, settled), winding }
    }

    fn at_zero(&self, inserts: &[f64], ratio: Ratio) -> Vec<f64> {
        let contacts = ratio.follower.unsigned_abs().min(1000);
        let phase = self.polygon.phase.value();
        let mut all: Vec<f64> = inserts
            .iter()
            .flat_map(|insert| {
                (0..contacts).map(move |k| {
                    let normal = -(f64::from(k) - phase - insert) / ratio.value();
                    normal - normal.round()
                })
            })
            .collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|b, a| (*b - *a).abs() < 1e-6);
        if all.len() > 1 && (all[all.len() - 1] - all[0] - 1.0).abs() < 1e-6 {
            all.pop();
        }
        all
    }
}

/// Whether that many facets can be told apart.
pub(super) fn can_be_judged(normals: &Normals) -> bool {
    normals.at_zero.len() <= MOST_SIDES
}

/// Radians of turns, from −π to π.
pub(super) fn rad(turns: f64) -> f64 {
    (turns - turns.round()) * TAU
}
