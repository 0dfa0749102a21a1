//! What turning, boring and parting leave of a polygon.
//!
//! ```text
//!    corner ──╮      ╭── a chamfer at an end may take corners, as high as they are
//!             │╲____╱│
//!    facet ───┼──────┼── turned below it: the facet is gone there
//!             │      │
//!    bore ────┼──────┼── wider than the facets: gone, too
//! ```
use super::{Face, Standing, corner, least_share};

/// Share of its height that a polygon may lose, at its ends and within.
const LOST_SHARE: f64 = 0.1;
/// So much of its height it may lose at least and at most, mm.
const LOST_MM: [f64; 2] = [0.3, 1.0];
/// A chamfer may be so many times as high as corners stand over facets.
const CHAMFER: f64 = 2.0;
/// A facet without corners may lose half of its width.
const LEAST_WIDTH: f64 = 0.5;
/// A wall between bore and facet that is thinner breaks through, mm.
const WALL_MM: f64 = 0.05;
/// What is turned so little below a facet leaves it, mm: the lay of the feed.
const LAY_MM: f64 = 2e-3;

/// What is left at one height.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Left {
    Whole,
    /// Corners are blunt: across them there is, and there must be at least, mm.
    Blunt([f64; 2]),
    Gone,
}

/// The round bar at one height, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub(super) z: f64,
    /// Before the polygon was cut.
    pub(super) before: f64,
    pub(super) outer: f64,
    pub(super) bore: f64,
}

impl Standing {
    /// What tools about the axis have left of it, as a clause; `None`: enough.
    pub(super) fn left_of(&self, bar: &[Round], step: f64) -> Option<String> {
        let height = self.heights[1] - self.heights[0];
        let all: Vec<Left> = bar.iter().map(|at| self.left_at(at)).collect();
        let length = |count: usize| count as f64 * step;
        let gone = length(all.iter().filter(|left| **left == Left::Gone).count());
        if gone >= height - LOST_MM[0] {
            return Some("nothing is left of its facets".to_owned());
        }
        let allowed = (height * LOST_SHARE).clamp(LOST_MM[0], LOST_MM[1]) + step;
        if gone > allowed {
            let whole = height - gone;
            return Some(format!("its facets are left over {whole:.2} of {height:.2} mm"));
        }
        let is_blunt = |left: &&Left| matches!(left, Left::Blunt(_));
        let ends = |left: &&Left| !matches!(left, Left::Whole);
        let low = all.iter().take_while(ends).count();
        let high = all.iter().rev().take_while(ends).count().min(all.len() - low);
        let [first, middle, last] =
            [&all[..low], &all[low..all.len() - high], &all[all.len() - high..]]
                .map(|part| length(part.iter().filter(is_blunt).count()));
        let chamfer = CHAMFER * self.corner_height() + step;
        if first <= chamfer && last <= chamfer && middle <= allowed {
            return None;
        }
        let worst = all.iter().filter_map(|left| match left {
            Left::Blunt(across) => Some(*across),
            Left::Whole | Left::Gone => None,
        });
        worst.min_by(|a, b| a[0].total_cmp(&b[0])).map(|[left, least]| {
            format!(
                "{left:.2} mm across corners are left, {least:.2} mm at least (ISO 4759-1), over {:.2} mm",
                first + middle + last
            )
        })
    }

    fn left_at(&self, bar: &Round) -> Left {
        let Some(faces) = self.at(bar.z) else { return Left::Whole };
        let distances = faces.iter().map(|face| face.distance);
        let [near, far] =
            distances.fold([f64::INFINITY, 0.0_f64], |[near, far], d| [near.min(d), far.max(d)]);
        if bar.bore > near - WALL_MM || bar.outer < far - LAY_MM {
            return Left::Gone;
        }
        let reach = |radius: f64| radius.min(self.reach);
        let corners = corners(&faces);
        if corners.is_empty() {
            let width = |radius: f64| (reach(radius).powi(2) - far * far).max(0.0).sqrt();
            let is_narrow = width(bar.outer) < LEAST_WIDTH * width(bar.before);
            return if is_narrow { Left::Gone } else { Left::Whole };
        }
        let share = least_share(&faces);
        let blunt = corners.iter().filter_map(|far| {
            let was = far.min(self.reach);
            let left = was.min(bar.outer);
            (left < was * share).then_some([2.0 * left, 2.0 * was * share])
        });
        blunt.min_by(|a, b| a[0].total_cmp(&b[0])).map_or(Left::Whole, Left::Blunt)
    }

    /// How far corners stand over facets, mm.
    fn corner_height(&self) -> f64 {
        let of = |(_, faces): &(f64, Vec<Face>)| {
            let near = faces.iter().map(|face| face.distance).fold(f64::INFINITY, f64::min);
            corners(faces).iter().map(|far| far.min(self.reach) - near).fold(0.0, f64::max)
        };
        self.sections.iter().map(of).fold(0.0, f64::max)
    }
}

/// How far out its corners are, mm; empty: opposite facets have none.
fn corners(faces: &[Face]) -> Vec<f64> {
    let next = |k: usize| faces[(k + 1) % faces.len()];
    let all = (0..faces.len()).filter_map(|k| corner(faces[k], next(k)));
    all.map(|[x, y]| x.hypot(y)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: f64 = 0.01;

    /// A regular polygon of 17 mm across flats, 10 mm high, from a bar of 25 mm.
    fn polygon(sides: u32) -> Standing {
        let face = |k: u32| Face {
            normal: f64::from(k) * std::f64::consts::TAU / f64::from(sides),
            distance: 8.5,
        };
        let faces: Vec<Face> = (0..sides).map(face).collect();
        Standing::cut((1, 5), "hexagon 17.000", [-10.0, 0.0], vec![(-5.0, faces)], 12.5)
    }

    /// What is left of it on a bar that is turned to a radius, and bored, by height.
    fn left(sides: u32, turned: impl Fn(f64) -> [f64; 2]) -> Option<String> {
        let at = |k: i32| {
            let z = -10.0 + (f64::from(k) + 0.5) * STEP;
            let [outer, bore] = turned(z);
            Round { z, before: 12.5, outer: outer.min(12.5), bore }
        };
        let bar: Vec<Round> = (0..1000).map(at).collect();
        polygon(sides).left_of(&bar, STEP)
    }

    #[test]
    fn a_polygon_is_what_turning_leaves_of_it() {
        let says = |what: &str, found: Option<String>| {
            let found = found.unwrap_or_default();
            assert!(found.contains(what), "{what}: \"{found}\"");
        };
        says("nothing is left", left(6, |_| [8.0, 0.0]));
        says("left over 5.0", left(6, |z| [if z > -5.0 { 8.0 } else { 12.5 }, 0.0]));
        says("left over 7.0", left(6, |z| [if z < -7.0 { 8.0 } else { 12.5 }, 0.0]));
        says("left over 7.0", left(6, |z| [if z > -6.0 && z < -3.0 { 8.0 } else { 12.5 }, 0.0]));
        says("across corners", left(6, |_| [9.0, 0.0]));
        says("across corners", left(6, |z| [if z > -6.0 && z < -3.0 { 9.0 } else { 12.5 }, 0.0]));
        says("nothing is left", left(6, |_| [12.5, 9.0]));
        says("across corners", left(4, |_| [10.0, 0.0]));
        says("nothing is left", left(2, |_| [8.6, 0.0]));
    }

    #[test]
    fn chamfers_bores_and_a_bar_that_is_finished_about_it_leave_it_good() {
        let good = |what: &str, found: Option<String>| assert_eq!(found, None, "{what}");
        good("nothing", left(6, |_| [12.5, 0.0]));
        good("turned to the corners", left(6, |_| [9.82, 0.0]));
        good("turned to 19.3 mm", left(6, |_| [9.65, 0.0]));
        good("a chamfer of 30°", left(6, |z| [8.2 - z / 0.577, 0.0]));
        good("a chamfer of 45° at both ends", left(6, |z| [8.5 + (-z).min(10.0 + z), 0.0]));
        good("a bore", left(6, |_| [12.5, 6.0]));
        good("faced by half a millimetre", left(6, |z| [if z > -0.5 { 0.0 } else { 12.5 }, 0.0]));
        good("two flats, finished about them", left(2, |_| [10.0, 0.0]));
    }
}
