//! A single point in a bar that turns: what it leaves of it, and what that costs.
//!
//! ```text
//!      radius                          A   chip: what stands between the surface and the edge, as the work comes round
//!        │ ───────╮   edge    ╭──────  h   its thickness across the edge, t/√(1 + s²), s the edge's slope
//!        │         ╲░░ t ░░░╱          kc  = kc1.1·h^(−m)                       Kienzle and Victor 1957
//!        │          ╲░░░░░╱            Fc  = ∫ kc·t dz                          along the speed of the cut, times the radius: torque
//!        │           ╲___╱             Fn  = 0.5·Fc                             across each part of the edge (estimate: 0.4 to 0.6)
//!        └──────────────────► z        Fr  = ∫ dFn/√(1 + s²)   Fz = −∫ dFn·s/√(1 + s²)
//! ```
//!
//! The surface is kept in columns about the axis, as in any model of turning that knows the turn
//! before (regenerative effect). The point passes a column when the work has turned to it: work
//! angle = angle of the point about the axis − spindle angle. The force of a period is that against
//! the column that comes next, as the turn before and the passes before have left it. Both sides
//! are known: a shaft from outside, a bore from within.
//!
//! Not simulated: bending of the bar, an insert that breaks, chips that wind.
mod face;
mod insert;

mod polygon;

pub use insert::{Edges, Insert};
pub use polygon::PolygonCutter;

use polygon::CutterPose;

use crate::work::Hole;
use core::f64::consts::TAU;
use face::{Face, Forces};
use units::Length;

/// Columns about the axis.
const COLUMNS: usize = 120;
/// Distance of places along the axis, mm, where the bar is short enough.
const STEP_MM: f64 = 0.02;
/// Places along the axis at most.
const MOST_PLACES: usize = 20_000;
/// Force across the edge by force along the cut, of a rake of about 0° (estimate: 0.4 to 0.6).
const ACROSS: f64 = 0.5;
/// A thinner chip is no dearer, mm: Kienzle's law holds from about here on.
const THINNEST_MM: f64 = 0.01;
/// Slower than this, rad/s, the force falls to zero with the speed: it is friction then, and turns
/// nothing.
const SLOW: f64 = 1.0;
/// Deeper than this under the outside, or under the face, no thread is, mm.
const MOST_THREAD_MM: f64 = 4.0;
/// So far before the face an insert shows where it points, mm.
const FACE_MM: f64 = 12.0;
/// A tool nearer to a hole's middle than this is in it, mm.
const ON_AXIS_MM: f64 = 0.1;

/// Specific cutting force by the chip's thickness: kc = kc1.1·h^(−m), h in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kienzle {
    /// At a thickness of 1 mm, N/mm².
    pub at_1_mm_n_per_mm2: f64,
    /// By how much a thinner chip is dearer, m.
    pub exponent: f64,
}

/// Materials' values, of turning with carbide (Kienzle and Victor; König and Essel, *Spezifische
/// Schnittkraftwerte*, 1973).
pub const KIENZLE: [(&str, Kienzle); 6] = [
    ("C45", Kienzle { at_1_mm_n_per_mm2: 2220.0, exponent: 0.14 }),
    ("42CrMo4", Kienzle { at_1_mm_n_per_mm2: 2500.0, exponent: 0.26 }),
    ("stainless", Kienzle { at_1_mm_n_per_mm2: 2350.0, exponent: 0.21 }),
    ("GG25", Kienzle { at_1_mm_n_per_mm2: 1160.0, exponent: 0.26 }),
    ("AlSi", Kienzle { at_1_mm_n_per_mm2: 830.0, exponent: 0.23 }),
    ("brass", Kienzle { at_1_mm_n_per_mm2: 780.0, exponent: 0.18 }),
];

impl Kienzle {
    /// Of a material by name, in any case; C45 of one that is not known.
    pub fn named(name: &str) -> Self {
        let known = KIENZLE.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        known.unwrap_or(&KIENZLE[0]).1
    }

    fn at(&self, thickness_mm: f64) -> f64 {
        self.at_1_mm_n_per_mm2 * thickness_mm.max(THINNEST_MM).powf(-self.exponent)
    }
}

/// A bar about Z in a spindle's chuck, in machine coordinates of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Machine X and Y of its axis.
    pub axis: [Length; 2],
    /// Its radius.
    pub radius: Length,
    /// Radius of the bore through it; zero: it is solid.
    pub bore: Length,
    /// Machine Z of its free end.
    pub face: Length,
    /// Machine Z of its other end.
    pub rear: Length,
    /// What it costs to cut.
    pub force: Kienzle,
}

/// What the work does to the machine: forces on the tool along X, Y and Z, N; torque against
/// positive rotation, N·m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TurningLoad {
    pub(crate) force: [f64; 3],
    pub(crate) torque: f64,
    /// Along the cut, N.
    pub(crate) main: f64,
}

/// Where the point is: distance and angle (rev) about the axis, mm, Z of the tip, and the work
/// angle in columns.
#[derive(Clone, Copy, Debug)]
struct Pose {
    radius: f64,
    about: f64,
    z: f64,
    column: f64,
}

/// The column of a line about the axis, turn after turn.
const fn column(line: i64) -> usize {
    line.rem_euclid(COLUMNS.cast_signed() as i64) as usize
}

/// The bar and its surface.
#[derive(Clone, Debug)]
pub(crate) struct Turning {
    bar: Bar,
    scale: f64,
    places: usize,
    step: f64,
    /// Outer and inner radii by column and place; made when a tool first comes near.
    outer: Vec<f32>,
    inner: Vec<f32>,
    from_within: bool,
    /// The face, once an insert has pointed into it.
    face: Option<Face>,
    /// The insert points along the axis: as the table states it, or as it went into the material.
    is_axial: Option<bool>,
    tool: Option<u32>,
    last: Option<Pose>,
    /// The polygon cutter that came last, and where it was.
    cutter: Option<(u32, CutterPose)>,
}

impl Turning {
    /// Whole, and with a cutting force of so many times the material's.
    pub(crate) fn new(bar: Bar, scale: f64) -> Self {
        let length = (bar.face - bar.rear).value().max(STEP_MM);
        let places = ((length / STEP_MM) as usize + 1).min(MOST_PLACES);
        Self {
            bar,
            scale,
            places,
            step: length / places as f64,
            outer: Vec::new(),
            inner: Vec::new(),
            from_within: false,
            face: None,
            is_axial: None,
            tool: None,
            last: None,
            cutter: None,
        }
    }

    /// It is a bar of these dimensions.
    pub(crate) fn is(&self, bar: &Bar) -> bool {
        self.bar == *bar
    }

    /// Its cutting force, in those of the material.
    pub(crate) const fn scale(&self) -> f64 {
        self.scale
    }

    /// The bar as it was turned elsewhere.
    pub(crate) fn take_surfaces_of(&mut self, other: &Self) {
        if (self.places, self.bar) == (other.places, other.bar) {
            self.outer.clone_from(&other.outer);
            self.inner.clone_from(&other.inner);
            self.face.clone_from(&other.face);
        }
    }

    /// A tool comes to the bar.
    fn come_with(&mut self, tool: u32) {
        if self.tool != Some(tool) {
            (self.tool, self.last, self.is_axial) = (Some(tool), None, None);
        }
        if self.outer.is_empty() {
            let all = COLUMNS * self.places;
            self.outer = vec![self.bar.radius.value() as f32; all];
            self.inner = vec![self.bar.bore.value() as f32; all];
        }
    }

    /// Another tool: what others have bored on the axis is there for it.
    fn mount(&mut self, tool: u32, top: Length, holes: &[Hole]) {
        self.come_with(tool);
        let [x, y] = self.bar.axis;
        for hole in holes {
            if (hole.x - x).value().hypot((hole.y - y).value()) > ON_AXIS_MM {
                continue;
            }
            for bore in &hole.bores {
                let bottom = (top - bore.full_depth()).value();
                let radius = (bore.diameter.value() / 2.0) as f32;
                for at in 0..COLUMNS * self.places {
                    if self.z(at % self.places) > bottom {
                        self.inner[at] = self.inner[at].max(radius);
                    }
                }
            }
        }
    }

    fn z(&self, place: usize) -> f64 {
        self.bar.rear.value() + (place as f64 + 0.5) * self.step
    }

    /// One period with the point at machine X, Y and tip Z, mm, at the end of it; the spindle's
    /// angle, rev, and speed, rad/s.
    pub(crate) fn step(
        &mut self,
        (number, insert): (u32, &Insert),
        at: [f64; 3],
        (angle, omega): (f64, f64),
        (top, holes): (Length, &[Hole]),
    ) -> TurningLoad {
        let [x, y] = [at[0] - self.bar.axis[0].value(), at[1] - self.bar.axis[1].value()];
        let radius = x.hypot(y);
        let about = y.atan2(x) / TAU;
        let now = Pose { radius, about, z: at[2], column: (about - angle) * COLUMNS as f64 };
        if self.tool != Some(number) {
            self.mount(number, top, holes);
        }
        self.come(&now);
        let before = self.last.replace(now);
        if radius > self.bar.radius.value() + STEP_MM
            || at[2] > self.bar.face.value() + insert.widest()
        {
            return TurningLoad::default();
        }
        let Some(before) = before.filter(|p| (p.column - now.column).abs() < COLUMNS as f64 / 2.0)
        else {
            return TurningLoad::default();
        };
        let is_axial = self.points_along(insert, &before, &now);
        let (low, high) = (before.column.min(now.column), before.column.max(now.column));
        for line in low.floor() as i64 + 1..=high.floor() as i64 {
            let share = (line as f64 - before.column) / (now.column - before.column);
            let radius = before.radius + share * (now.radius - before.radius);
            let z = before.z + share * (now.z - before.z);
            match &mut self.face {
                Some(face) if is_axial => face.cut(column(line), radius, z, insert),
                _ => self.cut(column(line), radius, z, insert),
            }
        }
        let ahead = if now.column >= before.column {
            now.column.floor() as i64 + 1
        } else {
            now.column.ceil() as i64 - 1
        };
        // by then the point has gone on along the axis
        let turned = now.column - before.column;
        let slope = if turned == 0.0 { 0.0 } else { (now.z - before.z) / turned };
        let there = Pose { z: now.z + slope * (ahead as f64 - now.column), ..now };
        let forces = match &self.face {
            Some(face) if is_axial => {
                let slope = (now.radius - before.radius) / if turned == 0.0 { 1.0 } else { turned };
                let radius = now.radius + slope * (ahead as f64 - now.column);
                face.forces(column(ahead), (radius, now.z), insert, &self.bar.force)
            }
            _ => self.forces(column(ahead), &there, insert),
        };
        self.load(forces, &there, omega)
    }

    /// The insert points along the axis, into the face: as the table states it. A V of which it
    /// states nothing points the way in which it goes into the material: before the face and deeper
    /// under the outside than a thread's depth, or across it just under the face, that is along the
    /// axis.
    fn points_along(&mut self, insert: &Insert, before: &Pose, now: &Pose) -> bool {
        let is_axial = if insert.edges != Edges::V {
            false
        } else if let Some(stated) = insert.is_axial {
            stated
        } else {
            let Some(depths) = self.depths(now) else {
                self.is_axial = None;
                return false;
            };
            let [outside, inside, face] = depths;
            let across = (now.radius - before.radius).abs() > (now.z - before.z).abs();
            let deep = outside.min(inside) > MOST_THREAD_MM;
            if face < 0.0 && !deep {
                self.is_axial = None;
                return false;
            }
            *self.is_axial.get_or_insert(face < MOST_THREAD_MM && (across || deep))
        };
        if is_axial && self.face.is_none() {
            let top = |column: usize, radius: f64| {
                let at = column * self.places..(column + 1) * self.places;
                let pairs = self.outer[at.clone()].iter().zip(&self.inner[at]);
                let is_there = |(outer, inner): (&f32, &f32)| {
                    (f64::from(*inner)..f64::from(*outer)).contains(&radius)
                };
                let last = pairs.map(is_there).rposition(|is| is);
                last.map_or(self.bar.rear.value(), |place| self.z(place) + self.step / 2.0)
            };
            self.face = Some(Face::new(self.bar.radius.value(), top));
        }
        is_axial
    }

    /// How deep a point is below outside, bore and face; `None`: it is neither in the material nor
    /// just before its face.
    fn depths(&self, at: &Pose) -> Option<[f64; 3]> {
        let place = (at.z - self.bar.rear.value()) / self.step;
        let face = self.bar.face.value() - at.z;
        if place < 0.0 || face < -FACE_MM {
            return None;
        }
        let place = (place as usize).min(self.places - 1);
        let index = column(at.column.floor() as i64) * self.places + place;
        let (outer, inner) = (f64::from(self.outer[index]), f64::from(self.inner[index]));
        let solid = if inner > 0.0 { at.radius - inner } else { f64::INFINITY };
        (at.radius < outer && at.radius > inner).then_some([outer - at.radius, solid, face])
    }

    /// From which side a point that is clear comes.
    fn come(&mut self, at: &Pose) {
        let place = (at.z - self.bar.rear.value()) / self.step;
        if place < 0.0 {
            return;
        }
        let beyond = place >= self.places as f64;
        let place = (place as usize).min(self.places - 1);
        let (outer, inner) = (f64::from(self.outer[place]), f64::from(self.inner[place]));
        if at.radius >= outer {
            self.from_within = false;
        } else if at.radius <= inner {
            self.from_within = true;
        } else if beyond {
            self.from_within = at.radius - inner < outer - at.radius;
        }
    }

    /// The places that the insert can reach.
    fn places_near(&self, radius: f64, z: f64, insert: &Insert) -> core::ops::Range<usize> {
        let room = if self.from_within {
            radius - self.bar.bore.value()
        } else {
            self.bar.radius.value() - radius
        };
        if room <= 0.0 {
            return 0..0;
        }
        let reach = insert.reach(room);
        let place = |z: f64| ((z - self.bar.rear.value()) / self.step - 0.5).max(0.0);
        let first = place(z - reach).ceil() as usize;
        let last = (place(z + reach).floor() as usize + 1).min(self.places);
        first.min(last)..last
    }

    fn cut(&mut self, column: usize, radius: f64, z: f64, insert: &Insert) {
        for place in self.places_near(radius, z, insert) {
            let Some((rise, _)) = insert.edge(self.z(place) - z) else { continue };
            let index = column * self.places + place;
            if self.from_within {
                self.inner[index] = self.inner[index].max((radius - rise) as f32);
            } else {
                self.outer[index] = self.outer[index].min((radius + rise) as f32);
            }
        }
    }

    /// The chip between the edge and a column's surface, and its forces: along the cut, away from
    /// the material across the axis, along it.
    fn forces(&self, column: usize, at: &Pose, insert: &Insert) -> Forces {
        let (mut main, mut radial, mut axial) = (0.0, 0.0, 0.0);
        for place in self.places_near(at.radius, at.z, insert) {
            let Some((rise, slope)) = insert.edge(self.z(place) - at.z) else { continue };
            let index = column * self.places + place;
            let (outer, inner) = (f64::from(self.outer[index]), f64::from(self.inner[index]));
            let thick = if self.from_within {
                (at.radius - rise).min(outer) - inner
            } else {
                outer - (at.radius + rise).max(inner)
            };
            if thick <= 0.0 {
                continue;
            }
            let across = 1.0 / slope.mul_add(slope, 1.0).sqrt();
            let force = self.bar.force.at(thick * across) * thick * self.step;
            main += force;
            radial += ACROSS * force * across;
            axial -= ACROSS * force * across * slope;
        }
        [main, if self.from_within { -radial } else { radial }, axial]
    }

    /// What these forces do to the machine.
    fn load(&self, forces: Forces, at: &Pose, omega: f64) -> TurningLoad {
        let moving = self.scale * (omega.abs() / SLOW).min(1.0);
        let [main, outward, axial] = forces.map(|force| force * moving);
        let along = main * omega.signum(); // the work drags the point along with it
        let (sin, cos) = (at.about * TAU).sin_cos();
        TurningLoad {
            force: [outward * cos - along * sin, outward * sin + along * cos, axial],
            torque: along * at.radius * 1e-3,
            main,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::Angle;

    fn bar(bore: f64) -> Bar {
        Bar {
            axis: [Length::ZERO; 2],
            radius: Length::mm(10.0),
            bore: Length::mm(bore),
            face: Length::ZERO,
            rear: Length::mm(-40.0),
            force: Kienzle::named("C45"),
        }
    }

    fn v(nose: f64) -> Insert {
        Insert {
            half_angle: Angle::deg(30.0),
            nose: Length::mm(nose),
            flat: Length::ZERO,
            crest_height: None,
            edges: Edges::V,
            along: None,
            is_middle: false,
            is_axial: None,
        }
    }

    /// A pass along the helix at that radius, 20 turns at 1000 rpm; the load in its middle.
    fn pass(turning: &mut Turning, insert: &Insert, radius: f64, lead: f64) -> TurningLoad {
        let step = 1000.0 / 60.0 * 250e-6;
        let omega = 1000.0 / 60.0 * TAU;
        let mut middle = TurningLoad::default();
        turning.last = None;
        for k in 0..(20.0 / step) as u32 {
            let turn = f64::from(k) * step;
            let at = [radius, 0.0, 3.0 * lead - lead * turn];
            let load = turning.step((1, insert), at, (turn, omega), (Length::ZERO, &[]));
            if (turn - 10.0).abs() < step {
                middle = load;
            }
        }
        middle
    }

    fn fresh(bore: f64) -> Turning {
        Turning::new(bar(bore), 1.0)
    }

    #[test]
    fn the_first_pass_costs_its_area_times_kienzles_pressure() {
        // a sharp V 0.3 mm deep: area d²·tan 30° = 0.0520 mm²; across each flank the chip is
        // d(z)·sin 30° thick, kc = 2220·h^-0.14, so Fc = 2·∫ 2220·(t·sin 30°)^-0.14·t dz with t
        // from 0 to 0.3, dz = dt·tan 30°
        let load = pass(&mut fresh(0.0), &v(0.0), 9.7, 1.5);
        let closed =
            2.0 * 30_f64.to_radians().tan() * 2220.0 * 0.5_f64.powf(-0.14) * 0.3_f64.powf(1.86)
                / 1.86;
        assert!((load.main / closed - 1.0).abs() < 0.02, "{} for {closed} N", load.main);
        assert!((150.0..200.0).contains(&load.main), "{load:?}");
        // torque at the point's radius; both flanks alike push outwards only: half of it, times sin
        // 30°
        assert!((load.torque - load.main * 9.7e-3).abs() < 1e-9);
        assert!((load.force[0] / (0.25 * load.main) - 1.0).abs() < 0.02, "{load:?}");
        assert!(load.force[2].abs() < 0.02 * load.main, "{load:?}");
        assert!((load.force[1] - load.main).abs() < 1e-9, "the work turns towards +Y");
    }

    #[test]
    fn a_pass_in_the_groove_of_the_one_before_costs_nothing() {
        let mut turning = fresh(0.0);
        pass(&mut turning, &v(0.2), 9.7, 1.5);
        assert!(pass(&mut turning, &v(0.2), 9.7, 1.5).main < 1.0, "a spring pass");
        let deeper = pass(&mut turning, &v(0.2), 9.5, 1.5).main;
        assert!((200.0..700.0).contains(&deeper), "{deeper} N");
    }

    #[test]
    fn a_pass_along_one_flank_pushes_the_other_way() {
        let mut turning = fresh(0.0);
        pass(&mut turning, &v(0.1), 9.6, 1.5);
        // 0.2 mm deeper and 0.2·tan 30° towards −Z: the flank on that side cuts, the other one only
        // touches
        let step = 1000.0 / 60.0 * 250e-6;
        let omega = 1000.0 / 60.0 * TAU;
        turning.last = None;
        let mut middle = TurningLoad::default();
        for k in 0..(20.0 / step) as u32 {
            let turn = f64::from(k) * step;
            let at = [9.4, 0.0, 4.5 - 0.2 * 30_f64.to_radians().tan() - 1.5 * turn];
            let load = turning.step((1, &v(0.1)), at, (turn, omega), (Length::ZERO, &[]));
            if (turn - 10.0).abs() < step {
                middle = load;
            }
        }
        assert!(middle.force[2] > 0.2 * middle.main, "towards +Z: {middle:?}");
    }

    #[test]
    fn a_bore_is_cut_from_within_and_a_tool_in_the_air_costs_nothing() {
        let mut turning = fresh(6.0);
        let load = pass(&mut turning, &v(0.1), 6.3, 1.5);
        assert!(load.main > 100.0 && load.force[0] < 0.0, "pushed towards the axis: {load:?}");
        assert_eq!(pass(&mut fresh(0.0), &v(0.1), 10.5, 1.5), TurningLoad::default());
        assert_eq!(pass(&mut fresh(6.0), &v(0.1), 5.5, 1.5), TurningLoad::default());
    }

    #[test]
    fn turning_costs_feed_times_depth() {
        let insert = Insert { nose: Length::mm(0.4), edges: Edges::corner(80.0), ..v(0.0) };
        let load = pass(&mut fresh(0.0), &insert, 9.0, 0.2);
        // A = 0.2·1 mm² (less the corner's), h about 0.2 mm: 2220·0.2^-0.14 = 2781 N/mm²
        assert!((load.main / 556.0 - 1.0).abs() < 0.2, "{load:?}");
        assert!(load.force[2] > 0.0, "against the feed: {load:?}");
    }

    #[test]
    fn a_thread_in_the_face_from_its_middle_outwards_costs_as_much() {
        let mut turning = fresh(0.0);
        let (step, omega) = (500.0 / 60.0 * 250e-6, 500.0 / 60.0 * TAU);
        let mut turn = 0.0;
        for k in 0..2000 {
            turn += step;
            let at = [2.0, 0.0, 2.0 - 2.3 * f64::from(k) / 2000.0];
            turning.step((1, &v(0.0)), at, (turn, omega), (Length::ZERO, &[]));
        }
        let mut most = 0.0_f64;
        for k in 0..(6.0 / 1.5 / step) as u32 {
            turn += step;
            let at = [2.0 + 1.5 * step * f64::from(k), 0.0, -0.3];
            let load = turning.step((1, &v(0.0)), at, (turn, omega), (Length::ZERO, &[]));
            most = most.max(load.main);
        }
        assert!((100.0..250.0).contains(&most), "{most} N");
    }

    /// A spiral in the face from `from` to `to`, 0.3 mm deep, 1.5 mm a turn; the largest force.
    fn spiral(turning: &mut Turning, insert: &Insert, from: f64, to: f64) -> TurningLoad {
        let step = 500.0 / 60.0 * 250e-6;
        let omega = 500.0 / 60.0 * TAU;
        let mut most = TurningLoad::default();
        let turns = (from - to).abs() / 1.5;
        for k in 0..(turns / step) as u32 {
            let turn = f64::from(k) * step;
            let at = [from + (to - from) * turn / turns, 0.0, -0.3];
            let load = turning.step((1, insert), at, (turn, omega), (Length::ZERO, &[]));
            if load.main > most.main {
                most = load;
            }
        }
        most
    }

    #[test]
    fn a_thread_in_the_face_costs_its_depth_below_the_face_and_pushes_the_tool_off_it() {
        let along = pass(&mut fresh(0.0), &v(0.0), 9.7, 1.5);
        for is_axial in [None, Some(true)] {
            let insert = Insert { is_axial, ..v(0.0) };
            let load = spiral(&mut fresh(0.0), &insert, 11.0, 3.0);
            assert!((load.main / along.main - 1.0).abs() < 0.1, "{load:?} {along:?}");
            assert!(load.force[2] > 0.2 * load.main && load.force[0].abs() < 0.1 * load.main);
        }
        // the same chip along a thread that is stated to point to the axis: 15 kN
        let insert = Insert { is_axial: Some(false), ..v(0.0) };
        assert!(spiral(&mut fresh(0.0), &insert, 11.0, 3.0).main > 5_000.0);
    }

    #[test]
    fn a_spring_pass_in_the_face_costs_nothing() {
        let mut turning = fresh(0.0);
        spiral(&mut turning, &v(0.1), 11.0, 3.0);
        turning.last = None;
        assert!(spiral(&mut turning, &v(0.1), 11.0, 4.5).main < 1.0);
    }

    #[test]
    fn a_tool_that_leaves_a_shoulder_or_a_chamfer_costs_nothing() {
        let insert = Insert { nose: Length::mm(0.4), edges: Edges::corner(80.0), ..v(0.0) };
        let (turns, omega) = (1000.0 / 60.0 * 250e-6, 1000.0 / 60.0 * TAU);
        // straight out, along a slant, back along the bar: the way of a rapid in a period
        for out in [[0.02, 0.0], [0.02, 0.02], [0.0, 0.02]] {
            let mut turning = fresh(0.0);
            let (mut at, mut turn) = ([9.0, 0.0, 2.0], 0.0);
            let mut go = |at: &mut [f64; 3], by: [f64; 2], count: u32| {
                let mut most = 0.0_f64;
                for _ in 0..count {
                    (at[0], at[2], turn) = (at[0] + by[0], at[2] + by[1], turn + turns);
                    let load = turning.step((1, &insert), *at, (turn, omega), (Length::ZERO, &[]));
                    most = most.max(load.main);
                }
                most
            };
            let cut = go(&mut at, [0.0, -0.1 * turns], (7.0 / 0.1 / turns) as u32);
            go(&mut at, [0.1 * turns, -0.1 * turns], (0.5 / 0.1 / turns) as u32);
            let left = go(&mut at, out, 200);
            assert!(cut > 100.0 && left < 0.5 * cut, "{left} N after {cut} N, by {out:?}");
        }
    }
}
