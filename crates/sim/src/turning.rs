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
use crate::work::Hole;
use core::f64::consts::TAU;
use units::{Angle, Length};

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
/// A tool nearer to a hole's middle than this is in it, mm.
const ON_AXIS_MM: f64 = 0.1;
/// Trailing edge of a turning tool: slope (an insert of 80° that leads with 95°) and length, mm.
const TRAILING: (f64, f64) = (0.087_488_663_525_924, 12.0);
/// The crest's edge of a full profile reaches so much farther than the flanks there.
const OVER_THE_CREST: f64 = 1.3;

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

/// An insert, in the plane of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Insert {
    /// Half of the angle between its flanks.
    pub half_angle: Angle,
    /// Nose radius.
    pub nose: Length,
    /// Width of a flat point.
    pub flat: Length,
    /// From its point to the edge that cuts a thread's crest.
    pub crest_height: Option<Length>,
    /// It turns: square towards the chuck, with a trailing edge behind. Otherwise a V, as for
    /// threads.
    pub turns: bool,
}

impl Insert {
    /// How far the edge lies behind the point, and its slope, so far along the axis from it.
    fn edge(&self, d: f64) -> Option<(f64, f64)> {
        let nose = self.nose.value();
        let round = |d: f64| {
            let down = (nose * nose - d * d).max(0.0).sqrt();
            (nose - down, d / down.max(1e-9))
        };
        if self.turns {
            let (slope, length) = TRAILING;
            return match d {
                d if d < -nose || d > length => None,
                d if d <= nose * slope => Some(round(d)),
                d => Some(((d - nose * slope) * slope, slope)),
            };
        }
        let (sin, cos) = (self.half_angle.in_rad().sin(), self.half_angle.in_rad().cos());
        let tan = sin / cos;
        let away = d.abs();
        let below = nose * (1.0 / sin - 1.0) + self.flat.value() / 2.0 / tan;
        let (rise, slope) = if away <= nose * cos {
            round(away)
        } else {
            let flank = away / tan - below;
            if flank > 0.0 { (flank, 1.0 / tan) } else { (0.0, 0.0) }
        };
        match self.crest_height.map(Length::value) {
            Some(crest) if away > OVER_THE_CREST * (crest + below) * tan => None,
            Some(crest) if rise >= crest => Some((crest, 0.0)),
            _ => Some((rise, slope * d.signum())),
        }
    }

    /// How far along the axis the edge reaches, to each side, at most so far behind its point.
    fn reach(&self, rise: f64) -> f64 {
        if self.turns {
            return TRAILING.1;
        }
        let (sin, tan) = (self.half_angle.in_rad().sin(), self.half_angle.in_rad().tan());
        let below = self.nose.value() * (1.0 / sin - 1.0) + self.flat.value() / 2.0 / tan;
        let least = self.nose.value();
        match self.crest_height.map(Length::value) {
            Some(crest) if rise >= crest => OVER_THE_CREST * (crest + below) * tan,
            _ => ((rise + below) * tan).max(least),
        }
    }
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
    tool: Option<u32>,
    last: Option<Pose>,
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
            tool: None,
            last: None,
        }
    }

    /// The bar as it was turned elsewhere.
    pub(crate) fn take_surfaces_of(&mut self, other: &Self) {
        if (self.places, self.bar) == (other.places, other.bar) {
            self.outer.clone_from(&other.outer);
            self.inner.clone_from(&other.inner);
        }
    }

    /// Another tool: what others have bored on the axis is there for it.
    fn mount(&mut self, tool: u32, top: Length, holes: &[Hole]) {
        (self.tool, self.last) = (Some(tool), None);
        if self.outer.is_empty() {
            let all = COLUMNS * self.places;
            self.outer = vec![self.bar.radius.value() as f32; all];
            self.inner = vec![self.bar.bore.value() as f32; all];
        }
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
        if radius > self.bar.radius.value() + STEP_MM || at[2] > self.bar.face.value() + TRAILING.1
        {
            return TurningLoad::default();
        }
        let Some(before) = before.filter(|p| (p.column - now.column).abs() < COLUMNS as f64 / 2.0)
        else {
            return TurningLoad::default();
        };
        let (low, high) = (before.column.min(now.column), before.column.max(now.column));
        for line in low.floor() as i64 + 1..=high.floor() as i64 {
            let share = (line as f64 - before.column) / (now.column - before.column);
            let radius = before.radius + share * (now.radius - before.radius);
            let z = before.z + share * (now.z - before.z);
            self.cut(column(line), radius, z, insert);
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
        self.load(column(ahead), &there, insert, omega)
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

    /// The chip between the edge and a column's surface, and its force.
    fn load(&self, column: usize, at: &Pose, insert: &Insert, omega: f64) -> TurningLoad {
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
        let moving = self.scale * (omega.abs() / SLOW).min(1.0);
        let [main, radial, axial] = [main, radial, axial].map(|force| force * moving);
        let outward = if self.from_within { -radial } else { radial };
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

    const fn v(nose: f64) -> Insert {
        Insert {
            half_angle: Angle::deg(30.0),
            nose: Length::mm(nose),
            flat: Length::ZERO,
            crest_height: None,
            turns: false,
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
        let insert = Insert { nose: Length::mm(0.4), turns: true, ..v(0.0) };
        let load = pass(&mut fresh(0.0), &insert, 9.0, 0.2);
        // A = 0.2·1 mm² (less the corner's), h about 0.2 mm: 2220·0.2^-0.14 = 2781 N/mm²
        assert!((load.main / 556.0 - 1.0).abs() < 0.2, "{load:?}");
        assert!(load.force[2] > 0.0, "against the feed: {load:?}");
    }
}
