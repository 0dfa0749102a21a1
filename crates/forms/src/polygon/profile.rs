//! What a facet looks like when it is cut with given swings: exact kinematics, no linearisation.
use super::form::{Facet, Form};
use super::kinematics::{Cutter, Swing};
use super::series::Swings;
use units::{Angle, Length};

/// Points over a facet.
const POINTS: usize = 201;

/// A facet's surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Along the facet, and over the flat (positive: outwards).
    pub points: Vec<[Length; 2]>,
    /// Highest less lowest of them, across the ordered direction.
    pub flatness: Length,
    /// Middle between highest and lowest.
    pub offset: Length,
    /// Slope of the least-squares line, as the tilt of the normal.
    pub tilt: Angle,
}

impl Form {
    /// The surface of a facet under these swings.
    pub fn profile(&self, facet: &Facet, swings: &Swings) -> Profile {
        let cutter = self.cutter();
        let ends = [facet.to, facet.from].map(|s| contact(&cutter, facet, swings, s));
        let points: Vec<[f64; 2]> = (0..POINTS)
            .map(|i| {
                let part = i as f64 / (POINTS - 1) as f64;
                let u = ends[0] + (ends[1] - ends[0]) * part;
                let tip =
                    cutter.tip_at_facet(Angle::rev(u), swings.at(facet.centre + Angle::rev(u)));
                [tip.y.value(), (tip.x - cutter.flat()).value()]
            })
            .collect();
        let (low, high) =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p[1]), high.max(p[1]))
            });
        Profile {
            flatness: Length::mm(high - low),
            offset: Length::mm(f64::midpoint(high, low)),
            tilt: Angle::rev(-slope(&points).atan() / std::f64::consts::TAU),
            points: points.into_iter().map(|p| p.map(Length::mm)).collect(),
        }
    }

    /// Flatness of the worst facet under these swings.
    pub fn flatness(&self, swings: &Swings) -> Length {
        let of = |facet: &Facet| self.profile(facet, swings).flatness;
        self.kinds().iter().map(of).fold(Length::ZERO, Length::max)
    }
}

fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n;
    let (s, h) = (mean(0), mean(1));
    let top: f64 = points.iter().map(|p| (p[0] - s) * (p[1] - h)).sum();
    let bottom: f64 = points.iter().map(|p| (p[0] - s).powi(2)).sum();
    top / bottom
}

/// How far after the middle (rev) the tip is at this place along the facet, by bisection: y falls
/// with u.
pub(super) fn contact(cutter: &Cutter, facet: &Facet, swings: &Swings, place: Length) -> f64 {
    let y = |u: f64| {
        let swing: Swing = swings.at(facet.centre + Angle::rev(u));
        cutter.tip_at_facet(Angle::rev(u), swing).y
    };
    let quarter = 0.25 / cutter.ratio.max(1.0);
    let (mut before, mut after) = (-quarter, quarter);
    for _ in 0..50 {
        let middle = f64::midpoint(before, after);
        if y(middle) > place { before = middle } else { after = middle }
    }
    f64::midpoint(before, after)
}
