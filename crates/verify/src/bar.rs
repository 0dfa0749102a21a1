//! The bar on a lathe as it has been turned: what the points of the tools have left of it, from
//! recorded motion.
//!
//! ```text
//!      radius                       a few axial sections, each at its angle of the work:
//!        │ ─────────╮               outer(z): the least that any pass left      radius of the bar before
//!        │          ╰──╮╱╲╱╲╱╲
//!        │ ─ ─ ─ ─ ─ ─ ─ ─ ─ ─      inner(z): the most                          bore, 0 of a solid bar
//!        └──────────────────────► z
//!         rear                face
//! ```
//!
//! The tool passes a section whenever the work has turned to it: work angle = angle of the point
//! about the axis − spindle angle. Between two samples place and angle are interpolated; in a
//! section the insert's form is cut out exactly. A drill on the axis bores.
use crate::insert::{Form, Side};
use bus::Sample;
use canon::{InsertPoint, Tool, ToolKind};
use std::f64::consts::TAU;
use units::Length;

/// Sections about the axis.
pub(crate) const SECTIONS: usize = 12;
/// Distance of places along the axis, mm, where the bar is short enough.
const STEP_MM: f64 = 0.01;
/// Places along the axis at most.
const MOST_PLACES: usize = 20_000;
/// The trailing edge of a turning tool: its slope (an insert of 80° that leads with 95°), and its
/// length, mm (ISO 1832: size 12).
const TRAILING_SLOPE: f64 = 0.087_488_663_525_924;
const TRAILING_MM: f64 = 12.0;
/// A way along Z in a period that is a feed, mm: 0.2 mm a minute.
const FEED_MM: f64 = 1e-6;
/// A turning tool's nose where the table does not state one, mm (estimate: the usual one for
/// finishing).
const USUAL_NOSE_MM: f64 = 0.4;
/// A tool nearer to the axis than this is on it, mm.
const ON_AXIS_MM: f64 = 0.05;

/// A bar about the work's axis, where it is clamped; coordinates of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Its radius.
    pub radius: Length,
    /// Radius of the bore through it; zero: it is solid.
    pub bore: Length,
    /// Machine Z of its free end.
    pub face: Length,
    /// Machine Z of its other end.
    pub rear: Length,
}

/// The point of the tool passes a section of the bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) section: usize,
    /// Distance of the point from the axis, mm.
    pub(crate) radius: f64,
    /// Machine Z of the point, mm.
    pub(crate) z: f64,
}

#[derive(Clone, Copy, Debug)]
struct Pose {
    radius: f64,
    z: f64,
    /// Turn of the work at which the point stands.
    turn: f64,
    tool: Option<u32>,
}

/// The bar and what was turned off it.
#[derive(Clone, Debug)]
pub(crate) struct TurnedBar {
    bar: Bar,
    axis: [f64; 2],
    step: f64,
    places: usize,
    outer: Vec<f64>,
    inner: Vec<f64>,
    last: Option<Pose>,
    side: Side,
    /// −1 while the tool goes towards the chuck, and until it goes the other way; +1 then.
    feed: f64,
}

/// Nose radius of a tool that turns, mm; `None` of one that does not.
fn turning_nose(tool: Option<&Tool>) -> Option<f64> {
    match tool.map(|tool| &tool.kind) {
        Some(ToolKind::Insert(insert)) => match insert.point {
            Some(InsertPoint::Nose(radius)) => Some(radius.value()),
            Some(InsertPoint::Flat(_)) => Some(0.0),
            None => Some(USUAL_NOSE_MM),
        },
        Some(ToolKind::Other) => Some(USUAL_NOSE_MM),
        _ => None,
    }
}

impl TurnedBar {
    pub(crate) fn new(bar: Bar, axis: [Length; 2]) -> Self {
        let length = (bar.face - bar.rear).value().max(STEP_MM);
        let places = ((length / STEP_MM) as usize + 1).min(MOST_PLACES);
        Self {
            bar,
            axis: axis.map(Length::value),
            step: length / places as f64,
            places,
            outer: vec![bar.radius.value(); SECTIONS * places],
            inner: vec![bar.bore.value(); SECTIONS * places],
            last: None,
            side: Side::External,
            feed: -1.0,
        }
    }

    /// The same bar, before another tool comes near.
    pub(crate) fn at_rest(self) -> Self {
        Self { last: None, side: Side::External, feed: -1.0, ..self }
    }

    pub(crate) const fn stock(&self) -> &Bar {
        &self.bar
    }

    /// Places along the axis, and how far they are from one another.
    pub(crate) const fn places(&self) -> (usize, f64) {
        (self.places, self.step)
    }

    /// Machine Z of a place.
    pub(crate) fn z(&self, place: usize) -> f64 {
        self.bar.rear.value() + (place as f64 + 0.5) * self.step
    }

    /// The place at a machine Z, if the bar reaches there.
    pub(crate) fn place(&self, z: f64) -> Option<usize> {
        let place = (z - self.bar.rear.value()) / self.step;
        (place >= 0.0 && place < self.places as f64).then_some(place as usize)
    }

    /// Height of the material at a section's places, towards the tool: the outer radius, or the
    /// inner one with its sign changed, so that more is always more material.
    pub(crate) fn heights(&self, section: usize, side: Side) -> impl Iterator<Item = f64> + '_ {
        let range = section * self.places..(section + 1) * self.places;
        let (radii, sign) = match side {
            Side::External => (&self.outer[range], 1.0),
            Side::Internal => (&self.inner[range], -1.0),
        };
        radii.iter().map(move |radius| sign * radius)
    }

    /// How deep the point of a tool is in the material, mm; negative: it is clear of it by so much.
    pub(crate) fn depth(&self, at: &Crossing, side: Side) -> f64 {
        let Some(place) = self.place(at.z) else { return f64::NEG_INFINITY };
        let index = at.section * self.places + place;
        match side {
            _ if self.outer[index] <= self.inner[index] => f64::NEG_INFINITY,
            Side::External => self.outer[index] - at.radius,
            Side::Internal => at.radius - self.inner[index],
        }
    }

    /// From which side the tool came last.
    pub(crate) const fn side(&self) -> Side {
        self.side
    }

    /// Middle one of the diameters of bar or bore between two places; of the stock, where the bar
    /// does not reach there.
    pub(crate) fn diameter(&self, [low, high]: [f64; 2], side: Side) -> Length {
        let stock = match side {
            Side::External => self.bar.radius,
            Side::Internal => self.bar.bore,
        };
        let mut radii: Vec<f64> = self
            .heights(0, side)
            .enumerate()
            .filter(|(place, _)| (low..=high).contains(&self.z(*place)) && self.is_there(*place))
            .map(|(_, height)| height.abs())
            .collect();
        radii.sort_by(f64::total_cmp);
        radii.get(radii.len() / 2).map_or(stock, |radius| Length::mm(*radius)) * 2.0
    }

    /// There is material in the first section at a place.
    fn is_there(&self, place: usize) -> bool {
        self.outer[place] > self.inner[place]
    }

    /// Machine Z of the free end of what is higher than a level.
    pub(crate) fn end(&self, side: Side, level: f64) -> Option<f64> {
        let higher = |(place, height): &(usize, f64)| *height > level && self.is_there(*place);
        let last = self.heights(0, side).enumerate().filter(higher).last();
        last.map(|(place, _)| self.z(place) + self.step / 2.0)
    }

    /// The point stands off the material: outside of the bar, or within its bore.
    pub(crate) fn is_beside(&self, side: Option<Side>) -> bool {
        self.last.is_some_and(|at| {
            let here = Crossing { section: 0, radius: at.radius, z: at.z };
            self.depth(&here, side.unwrap_or(self.side)) <= 0.0
        })
    }

    /// The sections that the tool's point has passed since the last sample.
    pub(crate) fn follow(&mut self, sample: &Sample, tool: Option<&Tool>) -> Vec<Crossing> {
        let (x, y) = (sample.axis(0).value() - self.axis[0], sample.axis(1).value() - self.axis[1]);
        let length = tool.map_or(0.0, |tool| tool.worn_length().value());
        let number = tool.map(|tool| tool.number);
        let now = Pose {
            radius: x.hypot(y),
            z: sample.axis(2).value() - length,
            turn: y.atan2(x) / TAU - sample.spindle(0).value(),
            tool: number,
        };
        let finite = now.radius.is_finite() && now.z.is_finite() && now.turn.is_finite();
        let before = std::mem::replace(&mut self.last, finite.then_some(now));
        let Some(before) = before.filter(|before| finite && before.tool == number) else {
            return Vec::new();
        };
        self.find_side(&now);
        if (now.z - before.z).abs() > FEED_MM {
            self.feed = (now.z - before.z).signum();
        }
        let (from, to) = (before.turn * SECTIONS as f64, now.turn * SECTIONS as f64);
        // a point that passes behind the axis, or a record with a gap, says nothing of the way
        // between
        if (to - from).abs() > SECTIONS as f64 / 2.0 {
            return Vec::new();
        }
        let (low, high) = (from.min(to).floor() as i64 + 1, from.max(to).floor() as i64);
        (low..=high)
            .map(|line| {
                let share = (line as f64 - from) / (to - from);
                Crossing {
                    section: line.rem_euclid(SECTIONS.cast_signed() as i64) as usize,
                    radius: before.radius + share * (now.radius - before.radius),
                    z: before.z + share * (now.z - before.z),
                }
            })
            .collect()
    }

    /// From which side a tool comes that is clear of the material, or comes in over the face.
    fn find_side(&mut self, at: &Pose) {
        let beyond = at.z >= self.bar.face.value();
        let place = if beyond { Some(self.places - 1) } else { self.place(at.z) };
        let Some(place) = place else { return };
        let (outer, inner) = (self.outer[place], self.inner[place]);
        if at.radius >= outer {
            self.side = Side::External;
        } else if at.radius <= inner {
            self.side = Side::Internal;
        } else if beyond {
            let nearer_bore = at.radius - inner < outer - at.radius;
            self.side = if nearer_bore { Side::Internal } else { Side::External };
        }
    }

    /// A sample outside of threads: what is turned and drilled.
    pub(crate) fn sample(&mut self, sample: &Sample, tool: Option<&Tool>) {
        let crossings = self.follow(sample, tool);
        if let Some(tool) = tool
            && let ToolKind::Drill { point_angle } = tool.kind
        {
            self.drill(tool.diameter.value() / 2.0, (point_angle.in_rad() / 2.0).tan());
            return;
        }
        if crossings.is_empty() || self.last.is_none_or(|at| at.radius > self.bar.radius.value()) {
            return;
        }
        let Some(nose) = turning_nose(tool) else { return };
        let side = self.side;
        for at in &crossings {
            self.turn(at, nose, side);
        }
    }

    /// Cut with a turning tool: its nose, square towards the way of the feed, and a trailing edge
    /// behind.
    fn turn(&mut self, at: &Crossing, nose: f64, side: Side) {
        let trails = -self.feed;
        let place = |z: f64| ((z - self.bar.rear.value()) / self.step - 0.5).max(0.0);
        let [a, b] = [at.z - trails * nose, at.z + trails * TRAILING_MM];
        let (low, high) = (a.min(b), a.max(b));
        if high < self.bar.rear.value() {
            return;
        }
        let last = (place(high).floor() as usize).min(self.places - 1);
        for place in place(low).ceil() as usize..=last {
            let behind = (self.z(place) - at.z) * trails;
            let round = nose - (nose * nose - behind * behind).max(0.0).sqrt();
            // on the trailing side the nose goes over into an edge that rises little
            let tangent = nose * TRAILING_SLOPE;
            let edge = if behind > tangent { (behind - tangent) * TRAILING_SLOPE } else { round };
            self.cut_to(at.section * self.places + place, at.radius, edge, side);
        }
    }

    fn cut_to(&mut self, index: usize, radius: f64, rise: f64, side: Side) {
        match side {
            Side::External => self.outer[index] = self.outer[index].min(radius + rise),
            Side::Internal => self.inner[index] = self.inner[index].max(radius - rise),
        }
    }

    /// Cut an insert's form out of a section.
    pub(crate) fn cut(&mut self, at: &Crossing, form: &Form, side: Side) {
        let room = match side {
            Side::External => self.bar.radius.value() - at.radius,
            Side::Internal => at.radius - self.bar.bore.value(),
        };
        if room <= 0.0 {
            return;
        }
        let reach = form.reach(room);
        let place = |z: f64| ((z - self.bar.rear.value()) / self.step - 0.5).max(0.0);
        let first = place(at.z - reach).ceil() as usize;
        let last = (place(at.z + reach).floor() as usize).min(self.places - 1);
        if at.z + reach < self.bar.rear.value() {
            return;
        }
        for place in first..=last {
            let rise = form.rise((self.z(place) - at.z).abs());
            let index = at.section * self.places + place;
            self.cut_to(index, at.radius, rise, side);
        }
    }

    /// A drill on the axis has bored down to its tip.
    fn drill(&mut self, radius: f64, half_tan: f64) {
        let Some(at) = self.last.filter(|at| at.radius < ON_AXIS_MM) else { return };
        let Some(tip) = self.place(at.z) else { return };
        // down to where it was before, everything is bored already
        for place in tip..self.places {
            let bored = radius.min((self.z(place) - at.z) * half_tan);
            if self.inner[place] >= bored && bored >= radius {
                break;
            }
            for section in 0..SECTIONS {
                let inner = &mut self.inner[section * self.places + place];
                *inner = inner.max(bored);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bus::Truth;
    use canon::Insert;
    use units::Angle;
    use units::Coordinate;

    fn bar() -> TurnedBar {
        let [radius, bore, face, rear] = [10.0, 0.0, 0.0, -40.0].map(Length::mm);
        TurnedBar::new(Bar { radius, bore, face, rear }, [Length::ZERO; 2])
    }

    fn tool(kind: ToolKind, diameter: f64) -> Tool {
        Tool {
            number: 1,
            pocket: 1,
            length: Length::mm(50.0),
            diameter: Length::mm(diameter),
            kind,
            description: String::new(),
            wear: canon::ToolWear::default(),
            life: canon::ToolLife::default(),
            body: canon::Body::default(),
            stand_in: false,
        }
    }

    fn turning() -> Tool {
        let point = Some(InsertPoint::Nose(Length::mm(0.4)));
        tool(ToolKind::Insert(Insert { angle: Angle::deg(80.0), point, crest_height: None }), 0.8)
    }

    /// The tip goes straight from place to place (X and Z), 0.1 mm a turn, 60 samples a turn.
    fn moves(bar: &mut TurnedBar, tool: &Tool, way: &[[f64; 2]]) {
        let mut turn = 0.0;
        for pair in way.windows(2) {
            let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            let count = (length / 0.1 * 60.0).ceil() as usize;
            for k in 0..=count {
                let share = k as f64 / count as f64;
                let at = |i: usize| pair[0][i] + share * (pair[1][i] - pair[0][i]);
                let mut truth = Truth::default();
                truth.axes[0] = Coordinate::new(at(0));
                truth.axes[2] = Coordinate::new(at(1) + 50.0);
                truth.spindles[0] = Angle::rev(turn);
                turn += 1.0 / 60.0;
                bar.sample(&Sample { truth: Some(truth), ..Sample::default() }, Some(tool));
            }
        }
    }

    fn radius(bar: &TurnedBar, z: f64, side: Side) -> [f64; 2] {
        let place = bar.place(z).unwrap();
        let all = (0..SECTIONS).map(|k| bar.heights(k, side).nth(place).unwrap().abs());
        all.fold([f64::INFINITY, 0.0], |[low, high], r| [low.min(r), high.max(r)])
    }

    #[test]
    fn a_turned_pass_leaves_its_radius_with_the_marks_of_its_feed() {
        let mut bar = bar();
        moves(&mut bar, &turning(), &[[12.0, 2.0], [9.9, 2.0], [9.9, -20.0], [12.0, -20.0]]);
        let [low, high] = radius(&bar, -10.0, Side::External);
        // marks of f²/8R = 0.1²/3.2 = 3 µm
        assert!((9.899..9.904).contains(&low) && high < 9.904, "{low} {high}");
        assert_eq!(radius(&bar, -25.0, Side::External), [10.0, 10.0]);
    }

    #[test]
    fn a_tool_beside_the_bar_leaves_it_as_it_was() {
        let mut bar = bar();
        let before = bar.outer.clone();
        moves(&mut bar, &turning(), &[[12.0, 2.0], [10.001, 2.0], [10.001, -20.0]]);
        assert_eq!(bar.outer, before);
    }

    #[test]
    fn a_drilled_hole_is_bored_out() {
        let mut bar = bar();
        let drill = tool(ToolKind::Drill { point_angle: Angle::deg(118.0) }, 8.0);
        moves(&mut bar, &drill, &[[0.0, 2.0], [0.0, -20.0], [0.0, 2.0]]);
        assert_eq!(radius(&bar, -10.0, Side::Internal), [4.0, 4.0]);
        assert_eq!(radius(&bar, -25.0, Side::Internal), [0.0, 0.0]);
        moves(&mut bar, &turning(), &[[3.5, 2.0], [4.5, 2.0], [4.5, -15.0], [3.5, -15.0]]);
        let [low, high] = radius(&bar, -10.0, Side::Internal);
        assert!((4.49..4.5001).contains(&low) && high < 4.5001, "{low} {high}");
        assert_eq!(radius(&bar, -17.0, Side::Internal), [4.0, 4.0]);
    }

    #[test]
    fn a_faced_bar_begins_where_it_was_faced() {
        let mut bar = bar();
        moves(&mut bar, &turning(), &[[12.0, -0.4], [0.0, -0.4], [0.0, 2.0]]);
        assert!(radius(&bar, -0.2, Side::External)[1] < 1.0);
        assert!(radius(&bar, -1.0, Side::External)[0] > 9.0);
    }
}
