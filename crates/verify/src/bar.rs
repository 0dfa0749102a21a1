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
mod part;
mod ring;

pub(crate) use part::BarPart;
pub(crate) use ring::Ring;

use crate::insert::{Form, Outline, Side};
use bus::Sample;
use canon::{Tool, ToolKind};
use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use units::Length;

/// Sections about the axis.
pub(crate) const SECTIONS: usize = 12;
/// Distance of places along the axis, mm, where the bar is short enough.
const STEP_MM: f64 = 0.01;
/// Places along the axis at most.
const MOST_PLACES: usize = 20_000;
/// Less than this is no cut, mm.
const TRACE_MM: f64 = 0.005;
/// A wall, or a pip about the axis, of this thickness breaks off, mm (estimate).
const THROUGH_MM: f64 = 0.3;
/// No thread is deeper, mm.
const MOST_THREAD_MM: f64 = 4.0;
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
    /// Least radius to which anything was turned, by place.
    round: Vec<f64>,
    last: Option<Pose>,
    side: Side,
    /// Line of the program that cuts.
    line: u32,
    watched: Vec<Watched>,
    rings: Vec<Ring>,
    /// From this place on nothing is left.
    front: usize,
}

/// Places along the axis in which it is noted who takes something off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watched {
    /// For whom.
    pub(crate) of: usize,
    pub(crate) places: [usize; 2],
    /// The line that has removed something first, and whether that was more than a trace.
    pub(crate) line: Option<(u32, bool)>,
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
            round: vec![bar.radius.value(); places],
            last: None,
            side: Side::External,
            line: 0,
            watched: Vec::new(),
            rings: Vec::new(),
            front: places,
        }
    }

    /// The same bar, before another tool comes near.
    pub(crate) fn at_rest(self) -> Self {
        Self { last: None, side: Side::External, ..self }
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

    /// The places between two machine Z, as far as the bar reaches.
    pub(crate) fn places_between(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        let place =
            |z: f64| ((z - self.bar.rear.value()) / self.step).clamp(0.0, self.places as f64 - 1.0);
        [low, high].map(|z| place(z) as usize)
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
        let nothing = match side {
            Side::External => 0.0,
            Side::Internal => -self.bar.radius.value(),
        };
        self.outer[range.clone()].iter().zip(&self.inner[range]).map(move |(outer, inner)| {
            match side {
                _ if outer <= inner => nothing,
                Side::External => *outer,
                Side::Internal => -*inner,
            }
        })
    }

    /// How deep the point of a tool is in the material, mm; negative: it is clear of it by so much.
    pub(crate) fn depth(&self, at: &Crossing, side: Side) -> f64 {
        let Some(place) = self.place(at.z) else { return f64::NEG_INFINITY };
        let index = at.section * self.places + place;
        match side {
            _ if self.outer[index] <= self.inner[index] => f64::NEG_INFINITY,
            Side::External => self.outer[index] - at.radius,
            // beyond the outside there is nothing to bore
            Side::Internal if at.radius >= self.outer[index] => self.outer[index] - at.radius,
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

    /// There is a bar at a place, and not the pip that facing leaves.
    pub(crate) fn is_solid(&self, place: usize) -> bool {
        let all = (0..SECTIONS).map(|section| section * self.places + place);
        all.map(|at| self.outer[at] - self.inner[at]).fold(f64::INFINITY, f64::min)
            > 2.0 * THROUGH_MM
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

    /// How far along Z, this way, the material lies below the tool's point, to either side of a
    /// groove of a thread that may be there; 0: it never reaches the point.
    pub(crate) fn groove_before(&self, side: Side, way: f64) -> f64 {
        let Some(at) = self.last else { return 0.0 };
        let Some(from) = self.place(at.z) else { return 0.0 };
        let level = if side == Side::External { at.radius } else { -at.radius };
        let heights: Vec<f64> = self.heights(0, side).collect();
        let along: Box<dyn Iterator<Item = usize>> =
            if way > 0.0 { Box::new(from..self.places) } else { Box::new((0..=from).rev()) };
        let first = along.into_iter().position(|place| heights[place] > level + TRACE_MM);
        first.map_or(0.0, |count| count as f64 * self.step)
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
        let Some(outline) = Outline::of(tool) else { return };
        let side = self.side;
        for at in &crossings {
            // an insert for threads so deep under the surface came in over the face, and points
            // along the axis
            if !matches!(outline, Outline::Profile(_)) || !self.is_deep(at) {
                self.turn(at, &outline, side);
            }
        }
    }

    /// The point is deeper under bar and bore than any thread, or before the face there.
    fn is_deep(&self, at: &Crossing) -> bool {
        let place = self.place(at.z).unwrap_or(self.places - 1);
        let index = at.section * self.places + place;
        let bore = self.inner[index];
        at.radius < self.outer[index] - MOST_THREAD_MM
            && (bore <= 0.0 || at.radius > bore + MOST_THREAD_MM)
    }

    /// From now on this line of the program cuts.
    pub(crate) const fn cut_by(&mut self, line: u32) {
        self.line = line;
    }

    /// The line of the program that cuts.
    pub(crate) const fn line(&self) -> u32 {
        self.line
    }

    /// Note from now on who takes something off between two places.
    pub(crate) fn watch(&mut self, of: usize, places: [usize; 2]) {
        self.unwatch(of);
        self.watched.push(Watched { of, places, line: None });
    }

    /// Note what another bar notes.
    pub(crate) fn watch_as(&mut self, other: &Self) {
        self.watched.clone_from(&other.watched);
        self.rings.clone_from(&other.rings);
    }

    /// Note it no more.
    pub(crate) fn unwatch(&mut self, of: usize) {
        self.watched.retain(|watched| watched.of != of);
    }

    /// The line that has taken something off since.
    pub(crate) fn changed_by(&self, of: usize) -> Option<u32> {
        let watched = self.watched.iter().find(|watched| watched.of == of)?;
        watched.line.map(|(line, _)| line)
    }

    fn note(&mut self, place: usize, removed: f64) {
        let (line, much) = (self.line, removed > TRACE_MM);
        for watched in &mut self.watched {
            let [low, high] = watched.places;
            if (low..=high).contains(&place) && !watched.line.is_some_and(|(_, was)| was) {
                watched.line = Some((line, much));
            }
        }
    }

    /// The tool has just cut through to the axis, or into the bore: the place where it did.
    pub(crate) fn cut_off(&self, tool: Option<&Tool>) -> Option<usize> {
        let at = self.last.filter(|at| at.radius <= self.bar.bore.value() + THROUGH_MM)?;
        let [from, to] = Outline::of(tool)?.reach(self.bar.radius.value());
        let wall = |place: usize| {
            let thick = |section| {
                let index = section * self.places + place;
                self.outer[index] - self.inner[index]
            };
            (0..SECTIONS).map(thick).fold(f64::NEG_INFINITY, f64::max)
        };
        let is_through = |place: &usize| wall(*place) <= THROUGH_MM;
        let place = self.between(at.z + from, at.z + to)?.find(is_through)?;
        (place + 1..self.front).any(|place| !is_through(&place)).then_some(place)
    }

    /// What lies before a place has come off.
    pub(crate) fn come_off(&mut self, place: usize) {
        self.front = self.front.min(place + 1);
        for section in 0..SECTIONS {
            let first = section * self.places;
            self.outer[first + place..first + self.places].fill(0.0);
        }
    }

    /// Cut what a tool has beside its point out of a section.
    fn turn(&mut self, at: &Crossing, outline: &Outline, side: Side) {
        let room = match side {
            Side::External => self.bar.radius.value() - at.radius,
            Side::Internal => at.radius - self.bar.bore.value(),
        };
        let [from, to] = outline.reach(room);
        let Some(places) = self.between(at.z + from, at.z + to) else { return };
        for place in places {
            if let Some(rise) = outline.rise(self.z(place) - at.z) {
                self.cut_to(at.section, place, [at.radius, rise], side);
            }
        }
    }

    /// The places whose middle lies between two Z.
    fn between(&self, low: f64, high: f64) -> Option<RangeInclusive<usize>> {
        if high < self.bar.rear.value() {
            return None;
        }
        let place = |z: f64| ((z - self.bar.rear.value()) / self.step - 0.5).max(0.0);
        let last = (place(high).floor() as usize).min(self.places - 1);
        Some(place(low).ceil() as usize..=last)
    }

    fn cut_to(&mut self, section: usize, place: usize, [radius, rise]: [f64; 2], side: Side) {
        let index = section * self.places + place;
        let edge = match side {
            Side::External => radius + rise,
            Side::Internal => radius - rise,
        };
        if side == Side::External {
            self.round[place] = self.round[place].min(edge.max(0.0));
        }
        let line = self.line;
        self.rings.iter_mut().for_each(|ring| ring.cut(place, edge, side, line));
        let removed = match side {
            Side::External => {
                let removed = self.outer[index] - (radius + rise).max(0.0);
                if removed > 0.0 {
                    self.outer[index] -= removed;
                }
                removed
            }
            Side::Internal => {
                let removed = radius - rise - self.inner[index];
                if removed > 0.0 {
                    self.inner[index] += removed;
                }
                removed
            }
        };
        if removed > 0.0 && !self.watched.is_empty() {
            self.note(place, removed);
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
        let Some(places) = self.between(at.z - reach, at.z + reach) else { return };
        for place in places {
            let rise = form.rise((self.z(place) - at.z).abs());
            self.cut_to(at.section, place, [at.radius, rise], side);
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
                self.cut_to(section, place, [bored, 0.0], Side::Internal);
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
        tool(ToolKind::Insert(Insert::turning(Angle::deg(80.0), Length::mm(0.4))), 0.8)
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
