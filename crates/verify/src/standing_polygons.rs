//! Polygons over one another on one bar: each is judged by what all of them have left.
//!
//! ```text
//!    ╲ ╱  corner of the one       every facet is a half-plane; a corner is left as far out as all half-planes
//!   ──┴── facet of the other      of both reach in its direction
//! ```
//!
//! A polygon that a later, whole one is cut from was roughing: it is as good as the later one. A
//! corner may be as blunt as on a bolt of product grade A: across corners at least 1.13
//! times the least width of a hexagon, 1.3 times that of a square (ISO 4759-1), the width by h13
//! (ISO 286-1).
//!
//! What [turning](turned) about the axis leaves of them is noted by the bar, and judged when a line
//! has cut it.
mod turned;

use crate::bar::TurnedBar;
use crate::feature::Feature;
use crate::judged::Judged;
use crate::polygon::{Facet, Polygon, Section};
use crate::turned::Facets;
use crate::undone::{Undone, of_before};
use crate::verdict::Verdict;
use turned::Round;
use units::Length;

/// Normals within this are of the same facet, rad.
const SAME_NORMAL: f64 = 0.005;
/// Facets within this are at the same distance, mm.
const SAME_DISTANCE: f64 = 2e-3;
/// What is left at the end of a polygon by one that is as long, mm: a lay of the feed.
const LAST_LAY: f64 = 0.3;
/// Polygons that are remembered on one workpiece.
const MOST: usize = 64;
/// Share of a corner's distance that is left at least where no standard says it.
const LEAST_CORNER: f64 = 0.97;

/// A facet at one height: where its normal points, rad, and how far out it is, mm.
#[derive(Clone, Copy, Debug)]
struct Face {
    normal: f64,
    distance: f64,
}

/// A polygon that was cut, as it stands on the bar.
#[derive(Clone, Debug)]
struct Standing {
    /// By which the bar knows it.
    id: usize,
    op: Option<u32>,
    line: u32,
    name: String,
    /// Z of its lower and its upper end, mm.
    heights: [f64; 2],
    /// From the lowest up, with their heights; one at least.
    sections: Vec<(f64, Vec<Face>)>,
    /// Radius of the stock.
    reach: f64,
    /// Radius of the bar at each place, from its lower end up, before it was cut.
    before: Vec<f64>,
    /// The line that has spoilt it first, and whether that was said.
    spoilt: Option<(u32, bool)>,
    /// It has come off with a part: nothing happens to it any more.
    is_off: bool,
}

impl Standing {
    fn cut(
        (op, line): (u32, u32),
        name: &str,
        heights: [f64; 2],
        sections: Vec<(f64, Vec<Face>)>,
        reach: f64,
    ) -> Self {
        let (op, name, before) = (Some(op), name.to_owned(), Vec::new());
        let (id, spoilt, is_off) = (0, None, false);
        Self { id, op, line, name, heights, sections, reach, before, spoilt, is_off }
    }

    /// What there is of a polygon; `None`: it was not cut.
    fn of(judged: &Judged<Polygon>, reach: f64) -> Option<Self> {
        let faces = |section: &Section| {
            let face = |facet: &Facet| Face {
                normal: (facet.normal + facet.tilt).in_rad(),
                distance: facet.distance.value(),
            };
            (section.z.value(), section.facets.iter().map(face).collect())
        };
        let mut sections: Vec<(f64, Vec<Face>)> = judged.kind.sections.iter().map(faces).collect();
        sections.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Judged { op, line, .. } = *judged;
        let polygon = &judged.kind;
        let heights = [polygon.z_from, polygon.z_to].map(Length::value);
        (!sections.is_empty())
            .then(|| Self::cut((op, line), &polygon.name(), heights, sections, reach))
    }

    /// The bar as it is notes from now on what happens to it, and what was turned before is said.
    fn stands_on(&mut self, bar: &mut TurnedBar) -> Option<String> {
        // where the end was faced off before, the cutter went through the air
        let is_there = |place: &usize| bar.is_solid(*place);
        let [first, last] = bar.places_between(self.heights);
        let Some(top) = (first..=last).rev().find(is_there) else {
            return Some("not cut: no bar is left there".to_owned());
        };
        if top < last {
            self.heights[1] = bar.z(top);
        }
        bar.ring(self.id, self.heights);
        let (ring, _) = bar.ring_of(self.id)?;
        self.before = ring.radii().map(|(_, [outer, _])| outer).collect();
        let left = self.left_of(&self.bar(bar), bar.places().1);
        for place in first..=top {
            let Some(faces) = self.at(bar.z(place)) else { continue };
            bar.limit(place, |angle| reach_of(&faces, angle));
        }
        left.map(|left| format!("the bar was turned or bored below its facets before: {left}"))
    }

    /// The bar where it stands.
    fn bar(&self, bar: &TurnedBar) -> Vec<Round> {
        let Some((ring, _)) = bar.ring_of(self.id) else { return Vec::new() };
        let at = |((place, [outer, bore]), before): ((usize, [f64; 2]), &f64)| Round {
            z: bar.z(place),
            before: *before,
            outer,
            bore,
        };
        ring.radii().zip(&self.before).map(at).filter(|at| self.is_at(at.z)).collect()
    }

    fn is_at(&self, z: f64) -> bool {
        (self.heights[0]..=self.heights[1]).contains(&z)
    }

    /// Least distance of its facets from the axis at a height.
    fn facets(&self, z: f64) -> Option<f64> {
        self.at(z).map(|faces| faces.iter().map(|f| f.distance).fold(f64::INFINITY, f64::min))
    }

    /// A later line has spoilt it.
    fn undone(&self, line: u32, how: &str) -> Option<Undone> {
        self.op.map(|op| Undone { op, line, how: how.to_owned(), is_known: true })
    }

    /// The facets at a height, between two sections or beyond the last ones; `None` above and below
    /// it.
    fn at(&self, z: f64) -> Option<Vec<Face>> {
        if !(self.heights[0]..=self.heights[1]).contains(&z) {
            return None;
        }
        let above = self.sections.partition_point(|(height, _)| *height < z);
        let last = self.sections.len() - 1;
        let below = above.saturating_sub(1).min(last.saturating_sub(1));
        let ((from, lower), (to, upper)) =
            (&self.sections[below], &self.sections[last.min(below + 1)]);
        let part = if to > from { (z - from) / (to - from) } else { 0.0 };
        let between = |(a, b): (&Face, &Face)| Face {
            normal: a.normal + part * turned(a.normal, b.normal),
            distance: a.distance + part * (b.distance - a.distance),
        };
        Some(lower.iter().zip(upper).map(between).collect())
    }

    /// The heights of this one at which the other stands too, with the facets of both.
    fn with<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (&'a [Face], Vec<Face>)> {
        let both = |(z, own): &'a (f64, Vec<Face>)| Some((own.as_slice(), other.at(*z)?));
        self.sections.iter().filter_map(both)
    }

    /// What another one leaves of its corners, as a clause; `None`: enough.
    fn left_by(&self, other: &Self, reach: f64) -> Option<String> {
        self.with(other).find_map(|(own, other)| blunt(own, &other, reach))
    }

    /// It is there wherever the other is, and no larger.
    fn covers(&self, other: &Self) -> bool {
        let [[from, to], [low, high]] = [self.heights, other.heights];
        let near = LAST_LAY.min((high - low) / 2.0);
        let width = |faces: &[Face]| faces.iter().map(|face| face.distance).sum::<f64>();
        from <= low + near
            && to >= high - near
            && self.with(other).all(|(own, other)| {
                width(own) / own.len() as f64 <= width(&other) / other.len() as f64 + SAME_DISTANCE
            })
    }
}

/// The polygons on a bar, in the order cut.
#[derive(Clone, Debug, Default)]
pub(crate) struct StandingPolygons {
    all: Vec<Standing>,
    next: usize,
}

impl StandingPolygons {
    /// As a program finds them that is another one.
    pub(crate) fn at_rest(mut self) -> Self {
        self.all.iter_mut().for_each(|polygon| polygon.op = polygon.op.map(of_before));
        self
    }

    /// Adds one that is judged now: what stands there changes its verdict, and it changes those of
    /// the features before it; gives what it does to those that are no longer among them.
    pub(crate) fn add(
        &mut self,
        found: &mut Judged<Polygon>,
        features: &mut [Feature],
        (stock_radius, mut bar): (Option<Length>, Option<&mut TurnedBar>),
    ) -> Vec<Undone> {
        let mut undone = Vec::new();
        let reach = stock_radius.map_or(f64::INFINITY, Length::value);
        let Some(mut later) = Standing::of(found, reach) else { return undone };
        later.id = self.next;
        self.next += 1;
        if let Some(before) = bar.as_deref_mut().and_then(|bar| later.stands_on(bar)) {
            found.fails(before);
        }
        self.all.retain(|earlier| {
            if earlier.is_off {
                return true;
            }
            let first = features.iter_mut().rfind(|feature| Some(feature.op) == earlier.op);
            if let Some(deeper) = deeper(earlier, &later) {
                found.fails(format!(
                    "line {} has cut its facets {:.0} µm deeper before it",
                    earlier.line,
                    deeper * 1e3
                ));
                return true;
            }
            let Some(left) = later.left_by(earlier, reach) else {
                // whole as it is: what it was cut from was roughing, where it covers that
                let covers = later.covers(earlier);
                match (first, &found.verdict) {
                    _ if !covers => {}
                    (Some(first), _) => first.verdict = found.verdict.clone(),
                    (None, Verdict::Pass) => {}
                    (None, verdict) => {
                        let how = verdict.reason().unwrap_or_default();
                        undone.extend(earlier.undone(later.line, &format!("cut again: {how}")));
                    }
                }
                if let Some(bar) = bar.as_deref_mut().filter(|_| covers) {
                    bar.unring(earlier.id);
                }
                return !covers;
            };
            found.fails(format!("line {} has cut its corners: {left}", earlier.line));
            if let Some(left) = earlier.left_by(&later, reach) {
                let how = format!("{} was cut over it: {left}", later.name);
                match first {
                    Some(first) => first.destroyed(later.line, &how),
                    None => undone.extend(earlier.undone(later.line, &how)),
                }
            }
            true
        });
        if self.all.len() == MOST {
            let oldest = self.all.remove(0);
            if let Some(bar) = bar {
                bar.unring(oldest.id);
            }
        }
        self.all.push(later);
        undone
    }

    /// Looks at those that tools have come near to since.
    pub(crate) fn look(&mut self, bar: &mut TurnedBar) {
        if !bar.is_ring_cut() {
            return;
        }
        let step = bar.places().1;
        for polygon in self.all.iter_mut().filter(|polygon| !polygon.is_off) {
            let Some(line) = bar.ring_of(polygon.id).and_then(|(_, line)| line) else { continue };
            bar.looked_at(polygon.id);
            if polygon.spoilt.is_none() && polygon.left_of(&polygon.bar(bar), step).is_some() {
                polygon.spoilt = Some((line, false));
            }
        }
    }

    /// Nothing is left to say of them.
    pub(crate) fn is_settled(&self, bar: Option<&TurnedBar>) -> bool {
        bar.is_none_or(|bar| !bar.is_ring_cut())
            && self.all.iter().all(|polygon| polygon.spoilt.is_none_or(|(_, said)| said))
    }

    /// What tools about the axis have done to them since, as they stand now.
    pub(crate) fn settle(&mut self, bar: &mut TurnedBar) -> Vec<Undone> {
        self.look(bar);
        let step = bar.places().1;
        let mut undone = Vec::new();
        for polygon in &mut self.all {
            let Some((line, false)) = polygon.spoilt else { continue };
            polygon.spoilt = Some((line, true));
            if let Some(left) = polygon.left_of(&polygon.bar(bar), step) {
                undone.extend(polygon.undone(line, &left));
            }
        }
        undone
    }

    /// The bar is cut through at a place: what is in front comes off.
    pub(crate) fn come_off(&mut self, through: usize, bar: &mut TurnedBar) -> Vec<Undone> {
        let undone = self.settle(bar);
        let z = bar.z(through);
        for polygon in self.all.iter_mut().filter(|polygon| polygon.heights[1] > z) {
            polygon.is_off = true;
            bar.unring(polygon.id);
        }
        undone
    }

    /// The facets on the bar: line, name, and how far from the axis they are by height.
    pub(crate) fn facets(&self) -> impl Iterator<Item = Facets<'_>> {
        self.all.iter().filter(|polygon| !polygon.is_off).map(|polygon| Facets {
            line: polygon.line,
            name: &polygon.name,
            at: Box::new(|z| polygon.facets(z)),
        })
    }
}

/// By how much the facets of a later polygon are not there, since an earlier one took them away.
fn deeper(earlier: &Standing, later: &Standing) -> Option<f64> {
    let off = |(own, other): (&[Face], Vec<Face>)| {
        let all = own.iter().filter_map(|face| Some(face.distance - facing(face, &other)?));
        all.fold(0.0, f64::max)
    };
    let most = later.with(earlier).map(off).fold(0.0, f64::max);
    (most > SAME_DISTANCE * 10.0).then_some(most)
}

/// How far out the facet is that faces the same way.
fn facing(face: &Face, others: &[Face]) -> Option<f64> {
    let same = |other: &&Face| turned(face.normal, other.normal).abs() < SAME_NORMAL;
    others.iter().find(same).map(|other| other.distance)
}

/// What other facets leave of corners, as a clause; `None`: enough.
fn blunt(own: &[Face], others: &[Face], reach: f64) -> Option<String> {
    let share = least_share(own);
    let corners = (0..own.len()).filter_map(|k| corner(own[k], own[(k + 1) % own.len()]));
    let mut worst: Option<[f64; 2]> = None;
    for [x, y] in corners {
        let far = x.hypot(y).min(reach);
        let left = reach_of(others, y.atan2(x)).min(far);
        if left < far * share && worst.is_none_or(|[least, _]| left < least) {
            worst = Some([left, far * share]);
        }
    }
    worst.map(|[left, least]| {
        format!(
            "{:.2} mm across corners are left, {:.2} mm at least (ISO 4759-1)",
            2.0 * left,
            2.0 * least
        )
    })
}

/// Share of its sharp corners that a polygon must have at least.
fn least_share(own: &[Face]) -> f64 {
    let width = 2.0 * own.iter().map(|face| face.distance).sum::<f64>() / own.len() as f64;
    let [least, sharp] = match own.len() {
        4 => [1.3, std::f64::consts::SQRT_2],
        6 => [1.13, 2.0 / 3.0_f64.sqrt()],
        _ => return LEAST_CORNER,
    };
    // IT13 = 250·i
    let tolerance = 0.25 * (0.45 * width.cbrt() + 0.001 * width);
    least * (width - tolerance) / (sharp * width)
}

/// How far out the material is in a direction.
fn reach_of(faces: &[Face], direction: f64) -> f64 {
    let ends = faces.iter().filter_map(|face| {
        let cosine = turned(direction, face.normal).cos();
        (cosine > 0.0).then(|| face.distance / cosine)
    });
    ends.fold(f64::INFINITY, f64::min)
}

/// Where two neighbouring facets meet; `None` of opposite ones.
fn corner(a: Face, b: Face) -> Option<[f64; 2]> {
    let turn = turned(a.normal, b.normal);
    if turn.sin().abs() < 1e-3 {
        return None;
    }
    let s = (b.distance - a.distance * turn.cos()) / turn.sin();
    let (sine, cosine) = a.normal.sin_cos();
    Some([a.distance * cosine - s * sine, a.distance * sine + s * cosine])
}

/// From one direction to another, −π to π.
fn turned(from: f64, to: f64) -> f64 {
    let turns = (to - from) / std::f64::consts::TAU;
    (turns - turns.round()) * std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hexagon(width: f64, turned_deg: f64) -> Vec<Face> {
        let face = |k: i32| Face {
            normal: (f64::from(k) * 60.0 + turned_deg).to_radians(),
            distance: width / 2.0,
        };
        (0..6).map(face).collect()
    }

    #[test]
    fn a_corner_of_a_hexagon_may_be_as_blunt_as_that_of_a_bolt() {
        // ISO 4014, s = 17: e at least 18.90
        assert!(
            (2.0 * 17.0 / 3.0_f64.sqrt() * least_share(&hexagon(17.0, 0.0)) - 18.9).abs() < 0.05
        );
        // a facet across the corner, 19.0 and 18.8 mm wide
        assert_eq!(blunt(&hexagon(17.0, 0.0), &hexagon(19.0, 30.0), 12.0), None);
        assert!(blunt(&hexagon(17.0, 0.0), &hexagon(18.8, 30.0), 12.0).is_some());
        // the same faces again, and larger ones, take nothing
        assert_eq!(blunt(&hexagon(17.0, 0.0), &hexagon(17.0, 60.0), 12.0), None);
        assert_eq!(blunt(&hexagon(17.0, 0.0), &hexagon(21.0, 17.0), 12.0), None);
        // a bar that has no sharp corner to lose
        assert_eq!(blunt(&hexagon(17.0, 0.0), &hexagon(18.8, 30.0), 9.3), None);
    }
}
