//! The part that is wanted, and where each of its facets is cut.
//!
//! ```text
//!        ν   normal of a facet in the work, −(k − δ)/R turns        corner between two facets at the same
//!        │   for each insert δ and each of its R passes a turn      distance d: half-way between their normals,
//!    ____│____                                                      s = d·tan(Δν/2)
//!   ╱    d    ╲
//! ```
use super::kinematics::Cutter;
use std::f64::consts::PI;
use std::fmt;
use units::{Angle, Length};

/// Facets that can be told apart.
const MOST_FACETS: usize = 64;
/// Turns of the work after which a gear that is proposed begins anew.
const FEW_TURNS: i32 = 8;

/// What is wanted, and the cutter that is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// Where the inserts stand in the cutter, rising from zero.
    pub inserts: Vec<Angle>,
    /// Turns of the tool, and of the work meanwhile.
    pub turns: [i32; 2],
    /// Distance of opposite flats; twice the facets' distance from the axis.
    pub across_flats: Length,
    /// From the tool spindle's axis to a tip.
    pub tip_radius: Length,
    /// Radius of the bar.
    pub stock_radius: Length,
}

/// Why a form cannot be cut; each says what would work.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal(pub String);

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}

/// A facet: when it is cut, and from where to where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// The work's angle when the tip is in the middle.
    pub centre: Angle,
    /// From the foot of its normal to the corner behind, negative.
    pub from: Length,
    /// To the corner ahead.
    pub to: Length,
}

impl Form {
    /// R.
    pub fn ratio(&self) -> f64 {
        f64::from(self.turns[0]) / f64::from(self.turns[1])
    }

    /// Distance of the axes.
    pub fn centres(&self) -> Length {
        self.across_flats / 2.0 + self.tip_radius
    }

    /// The cutter in its place.
    pub fn cutter(&self) -> Cutter {
        Cutter { centres: self.centres(), radius: self.tip_radius, ratio: self.ratio() }
    }

    /// Whether the inserts are equally spaced.
    pub fn is_regular(&self) -> bool {
        let n = self.inserts.len() as f64;
        let even = |(k, a): (usize, &Angle)| (a.value() - k as f64 / n).abs() < 1e-9;
        self.inserts.iter().enumerate().all(even)
    }

    /// Periods of an oscillation in one turn of the work: one for each pass of an insert, or of the
    /// whole cutter where its inserts are not equally spaced.
    pub fn base(&self) -> f64 {
        if self.is_regular() { self.ratio() * self.inserts.len() as f64 } else { self.ratio() }
    }

    /// The facets, by their normals' angle in the work; two of them where two are ordered.
    pub fn facets(&self) -> Vec<Facet> {
        let ratio = self.ratio();
        let passes = self.turns[0].unsigned_abs();
        let mut all: Vec<(f64, f64)> = self
            .inserts
            .iter()
            .flat_map(|insert| {
                (0..passes).map(move |k| {
                    let work = (f64::from(k) - insert.value()) / ratio;
                    (-work - (-work).floor(), work)
                })
            })
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.dedup_by(|b, a| (b.0 - a.0).abs() < 1e-9);
        let d = self.across_flats.value() / 2.0;
        let stock = self.stock_radius.value();
        let most = (stock * stock - d * d).max(0.0).sqrt();
        let corner =
            |turn: f64| if turn < 0.499 { (d * (PI * turn).tan()).min(most) } else { most };
        let count = all.len();
        (0..count)
            .map(|i| {
                let ahead = (all[(i + 1) % count].0 - all[i].0).rem_euclid(1.0);
                let behind = (all[i].0 - all[(i + count - 1) % count].0).rem_euclid(1.0);
                let whole = |turn: f64| if count == 1 { 1.0 } else { turn };
                Facet {
                    centre: Angle::rev(all[i].1),
                    from: Length::mm(-corner(whole(behind))),
                    to: Length::mm(corner(whole(ahead))),
                }
            })
            .collect()
    }

    /// One facet of each kind: all that an oscillation of this base has to serve.
    pub fn kinds(&self) -> Vec<Facet> {
        let base = self.base();
        let mut kinds: Vec<(f64, Facet)> = Vec::new();
        for facet in self.facets() {
            let at = (facet.centre.value() * base).rem_euclid(1.0);
            let known = |(other, _): &(f64, Facet)| {
                let off = (at - other).abs();
                off.min(1.0 - off) < 1e-6
            };
            if !kinds.iter().any(known) {
                kinds.push((at, facet));
            }
        }
        kinds.into_iter().map(|(_, facet)| facet).collect()
    }

    /// Everything that forbids this form.
    ///
    /// # Errors
    /// Sentences, each with the number that would work.
    pub fn check(&self) -> Result<(), Vec<Refusal>> {
        let mut found = Vec::new();
        if self.makes_sense(&mut found) {
            self.check_passes(&mut found);
            self.check_corners(&mut found);
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }

    /// Everything that forbids it even as a first cut, whose corners may lie beyond the bar.
    ///
    /// # Errors
    /// Sentences, each with the number that would work.
    pub fn check_roughing(&self) -> Result<(), Vec<Refusal>> {
        let mut found = Vec::new();
        if self.makes_sense(&mut found) {
            self.check_passes(&mut found);
        }
        if found.is_empty() { Ok(()) } else { Err(found) }
    }

    /// Whether there are tips that pass the work at all.
    fn makes_sense(&self, found: &mut Vec<Refusal>) -> bool {
        let mut refuse = |text: String| found.push(Refusal(text));
        let [tool, work] = self.turns;
        let (flat, r) = (self.across_flats.value(), self.tip_radius.value());
        if work <= 0 || tool == 0 {
            refuse(format!("a ratio needs turns above zero, found {work}:{tool}: 1:2 works"));
        } else if tool < 0 {
            refuse(format!(
                "turning against each other, {work}:{tool}, the tips draw loops that cut into the flats: the same sense, {work}:{}, works",
                -tool
            ));
        } else if tool <= work {
            refuse(format!(
                "at {work}:{tool} the tip does not run across a flat but around the work: the tool must turn faster, {work}:{} works",
                2 * work
            ));
        }
        if !(flat > 0.0 && flat.is_finite()) {
            refuse(format!("expected a size across flats above zero, found {flat}"));
        }
        if !(r > 0.0 && r.is_finite()) {
            refuse(format!("expected a tip radius above zero, found {r}"));
        }
        if self.inserts.is_empty() {
            refuse("the cutter has no insert: 3 at 1:2 cut a hexagon".to_owned());
        }
        found.is_empty()
    }

    /// Whether the bar holds the polygon.
    fn check_corners(&self, found: &mut Vec<Refusal>) {
        let d = self.across_flats.value() / 2.0;
        let stock = self.stock_radius.value();
        let across = 2.0 * self.corner_radius().value();
        if stock <= d {
            found.push(Refusal(format!(
                "a bar of Ø{:.3} has no flats of {:.3} mm: Ø{:.3} works",
                2.0 * stock,
                2.0 * d,
                across + 0.5
            )));
        } else if across > 2.0 * (stock + 1e-9) && self.facets().len() > 2 {
            found.push(Refusal(format!(
                "the corners lie beyond the stock: {across:.3} mm across corners from a bar of Ø{:.3}: Ø{across:.3} works, or {:.3} mm across flats",
                2.0 * stock,
                2.0 * d * 2.0 * stock / across
            )));
        }
    }

    /// Whether the facets are a few, and cut by tips that come from outside the bar.
    fn check_passes(&self, found: &mut Vec<Refusal>) {
        let facets = self.facets();
        let tool = self.ratio() * self.inserts.len() as f64;
        if self.turns[1] > 1 && facets.len() > MOST_FACETS {
            let [tools, works] = self.nearest_gear();
            found.push(Refusal(format!(
                "{} inserts at {}:{} cut {} different facets, {tool:.3} a turn, which must be whole over a few turns: {works}:{tools} works",
                self.inserts.len(), self.turns[1], self.turns[0], facets.len()
            )));
        }
        let (d, r) = (self.across_flats.value() / 2.0, self.tip_radius.value());
        let stock = self.stock_radius.value();
        // the farthest that a tip gets from the work's axis
        let reach = d + 2.0 * r;
        if reach <= stock {
            found.push(Refusal(format!(
                "the tips stay within {reach:.3} mm of the work's axis, in a bar of Ø{:.3}, and never leave it: a tip radius above {:.3} mm works, or a bar below Ø{:.3}",
                2.0 * stock,
                up((stock - d) / 2.0),
                2.0 * reach
            )));
        }
    }

    /// The gear next to this one that begins anew after few turns and cuts few facets; of equals
    /// the one of fewest turns.
    fn nearest_gear(&self) -> [i32; 2] {
        let ratio = self.ratio();
        let most = (MOST_FACETS / self.inserts.len().max(1)).max(2) as f64;
        let gear = |work: i32| {
            let tool = (ratio * f64::from(work)).round().min(most).max(f64::from(work) + 1.0);
            [tool as i32, work]
        };
        let off = |[tool, work]: &[i32; 2]| (f64::from(*tool) / f64::from(*work) - ratio).abs();
        let nearest = (1..=FEW_TURNS).map(gear).min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.unwrap_or([2, 1])
    }

    /// Radius of the corners; of two flats, of the bar.
    pub fn corner_radius(&self) -> Length {
        let d = self.across_flats.value() / 2.0;
        let facets = self.facets();
        let ends = facets.iter().flat_map(|f| [f.from.value().abs(), f.to.value()]);
        let unlimited = Self { stock_radius: Length::mm(1e6), ..self.clone() };
        if facets.len() > 2 {
            let widest = unlimited
                .facets()
                .iter()
                .flat_map(|f| [f.from.value().abs(), f.to.value()])
                .filter(|s| *s < 1e5)
                .fold(0.0, f64::max);
            return Length::mm(d.hypot(widest));
        }
        Length::mm(d.hypot(ends.fold(0.0, f64::max)))
    }
}

/// To the next thousandth above.
fn up(mm: f64) -> f64 {
    ((mm * 1000.0).floor() + 1.0) / 1000.0
}
