//! What is left of the bar: every insert, every turn, exact kinematics.
//!
//! ```text
//!          ray from the work's axis          on each ray the innermost crossing of all paths is what is left;
//!        ╲ │ ╱   ╱ path of one insert        a facet are the rays between the corners on either side of its normal
//!         ╲│╱___╱
//!          ●  ╲___ of another one            flatness: least width of two parallel lines that hold it between them
//! ```
//!
//! It asks nothing of how the oscillation was found: no contact that is looked for, no straight
//! lines about it. What is claimed of a block is what comes of the block's own numbers here. A tip
//! that cuts into another one's facet is seen.
use super::form::{Facet, Form};
use super::series::Swings;
use std::f64::consts::TAU;
use units::{Angle, Length};

/// Rays over a facet.
const RAYS: usize = 121;
/// Places of a path in one turn of the tool, between which it crosses a ray once.
const PLACES: f64 = 720.0;
/// Steps towards a crossing.
const CROSSING_STEPS: usize = 60;
/// Steps towards the inclination at which two lines are nearest.
const INCLINATION_STEPS: usize = 80;
/// Farther than this beyond the bar nothing is cut.
const NEAR_THE_BAR: f64 = 1.1;

/// A cross-section that is left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Of the worst facet, minimum zone.
    pub flatness: Length,
    /// Twice the mean distance of the facets from the work's axis.
    pub across_flats: Length,
    /// Of the worst facet against its ordered normal, signed.
    pub tilt: Angle,
}

/// One insert's path in the work's frame: the work's angle (rev), x and y (mm).
struct Path<'f> {
    form: &'f Form,
    swings: &'f Swings,
    insert: Angle,
    places: Vec<[f64; 3]>,
}

impl Path<'_> {
    fn at(&self, work: f64) -> [f64; 2] {
        let work = Angle::rev(work);
        let tip = self.form.cutter().tip(work, self.insert, self.swings.at(work));
        [tip.x.value(), tip.y.value()]
    }

    /// How far out it crosses a ray, at the least.
    fn innermost(&self, ray: [f64; 2], reach: f64) -> f64 {
        let along = |p: [f64; 2]| p[0] * ray[0] + p[1] * ray[1];
        let across = |p: [f64; 2]| p[1] * ray[0] - p[0] * ray[1];
        let mut least = f64::INFINITY;
        for pair in self.places.windows(2) {
            let ([from, x0, y0], [to, x1, y1]) = (pair[0], pair[1]);
            let (a, b) = ([x0, y0], [x1, y1]);
            let apart = across(a) * across(b) > 0.0 || along(a).min(along(b)) > reach;
            if apart || along(a).max(along(b)) < 0.0 {
                continue;
            }
            let (mut before, mut after) = (from, to);
            let (mut low, mut high) = (across(a), across(b));
            let mut out = along(a);
            for _ in 0..CROSSING_STEPS {
                // by secants, each end's weight halved while it stays
                let work = if low == high {
                    before
                } else {
                    before + (after - before) * low / (low - high)
                };
                let now = self.at(work);
                let off = across(now);
                out = along(now);
                if off.abs() < 1e-10 {
                    break;
                }
                if off * low > 0.0 {
                    (before, low, high) = (work, off, high / 2.0);
                } else {
                    (after, high, low) = (work, off, low / 2.0);
                }
            }
            if out > 0.0 {
                least = least.min(out);
            }
        }
        least
    }
}

impl Form {
    /// What is left under these swings about this form's distance of the axes; `None`: a facet is
    /// not cut from corner to corner.
    pub fn cut(&self, swings: &Swings) -> Option<Cut> {
        let paths: Vec<Path<'_>> =
            self.inserts.iter().map(|insert| self.path(*insert, swings)).collect();
        let facets = self.kinds();
        let all: Option<Vec<[f64; 3]>> =
            facets.iter().map(|facet| self.facet_cut(facet, &paths)).collect();
        let all = all?;
        let mean = all.iter().map(|[_, middle, _]| middle).sum::<f64>() / all.len() as f64;
        let worst = |of: fn(&[f64; 3]) -> f64| {
            all.iter().map(of).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0)
        };
        Some(Cut {
            flatness: Length::mm(worst(|one| one[0])),
            across_flats: Length::mm(2.0 * mean),
            tilt: Angle::rev(worst(|one| one[2])),
        })
    }

    fn path<'f>(&'f self, insert: Angle, swings: &'f Swings) -> Path<'f> {
        let mut path = Path { form: self, swings, insert, places: Vec::new() };
        let turns = f64::from(self.turns[1].max(1));
        let count = (PLACES * f64::from(self.turns[0].unsigned_abs().max(1))).ceil() as usize;
        let place = |i: usize| {
            let work = turns * (i as f64 + 0.5) / count as f64;
            let [x, y] = path.at(work);
            [work, x, y]
        };
        path.places = (0..=count).map(place).collect();
        path
    }

    /// Width of the zone, its middle's distance from the axis (mm) and its tilt (rev).
    fn facet_cut(&self, facet: &Facet, paths: &[Path<'_>]) -> Option<[f64; 3]> {
        let d = self.across_flats.value() / 2.0;
        let reach = self.stock_radius.value().max(d.hypot(facet.to.value())) * NEAR_THE_BAR;
        let normal = -facet.centre.in_rad();
        let ends = [facet.from, facet.to].map(|s| s.value().atan2(d));
        let point = |i: usize| {
            let off = ends[0] + (ends[1] - ends[0]) * i as f64 / (RAYS - 1) as f64;
            let (sine, cosine) = (normal + off).sin_cos();
            let out = paths.iter().map(|path| path.innermost([cosine, sine], reach));
            let out = out.fold(f64::INFINITY, f64::min);
            let (s, n) = off.sin_cos();
            out.is_finite().then_some([out * s, out * n])
        };
        let points: Option<Vec<[f64; 2]>> = (0..RAYS).map(point).collect();
        Some(zone(&points?))
    }
}

/// Two parallel lines that hold points between them, as near to each other as may be: their
/// distance, how far out their middle is, and how far its normal is turned (rev). The distance is
/// convex in the inclination.
fn zone(points: &[[f64; 2]]) -> [f64; 3] {
    let ends = |slope: f64| {
        let above = points.iter().map(|p| p[1] - slope * p[0]);
        above.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), n| (a.min(n), b.max(n)))
    };
    let width = |slope: f64| ends(slope).1 - ends(slope).0;
    let (mut least, mut most) = (-0.1, 0.1);
    for _ in 0..INCLINATION_STEPS {
        let (a, b) = (least + (most - least) / 3.0, most - (most - least) / 3.0);
        if width(a) < width(b) { most = b } else { least = a }
    }
    let slope = f64::midpoint(least, most);
    let (low, high) = ends(slope);
    let cosine = slope.atan().cos();
    [(high - low) * cosine, f64::midpoint(low, high) * cosine, -slope.atan() / TAU]
}
