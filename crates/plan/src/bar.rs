//! The bar of a lathe as far as it is known before motion: between which radii there is material,
//! along Z.
//!
//! ```text
//!   r │ outer ────╮            ╭──────      what feeds of an insert have left
//!     │           ╰────────────╯
//!     │ ▒▒▒▒▒▒▒▒▒▒ material ▒▒▒▒▒▒▒▒▒
//!     │ inner ─────────────────┐            a bore: of the blank, or drilled
//!     └────────────────────────┴─────► z
//!                                    face
//! ```
//!
//! Coordinates are those of the insert's *tip* in the machine's frame, mm. What is remembered errs
//! on the side of too much removed: a cut takes the insert's [edges](crate::edges) and a cell to
//! each side, thin material before the tip is cut by its edge, and of a bored place nothing is
//! known once it was cut, from inside or from outside. A thread along the bar leaves its crests:
//! down to its root it is open to what goes straight out of it, and to another pass.
use crate::edges::EdgePolygon;
use crate::stock::Stock;
use alloc::{vec, vec::Vec};
use units::Length;

/// A bar about Z, in the middle of the stock's sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Its radius.
    pub radius: Length,
    /// Radius of the bore along it; zero: it is solid.
    pub bore: Length,
}

/// Length of a cell along Z at least, mm, and the most cells.
const CELL: f64 = 0.1;
const MOST_CELLS: f64 = 4096.0;
/// Material so thin before the tip is cut by the insert's edge, mm.
const EDGE: f64 = 6.0;
/// Nearer to the axis edges beside the tip are not looked at, mm.
const NEAR_AXIS: f64 = 1.0;

/// Where a line goes into the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Met {
    /// The place of the tip where the line goes in.
    pub(crate) at: [f64; 3],
    /// How deep, by the shortest way out: across the axis or through the face.
    pub(crate) depth: f64,
    /// Radius of the surface there.
    pub(crate) surface: f64,
    /// Radius that is clear of all that the line passes.
    pub(crate) clear: f64,
    /// Z of the place where an edge beside the tip is in the material; `None`: the tip is.
    pub(crate) edge: Option<f64>,
}

/// What of a tool meets the bar behind its point, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Behind {
    /// A boring bar that is thicker than the bore; by so much.
    Bore { by: f64, bar: f64, bore: f64 },
    /// The holder of a boring bar, so deep in the bar's face.
    Face { by: f64, out: f64 },
    /// A turning tool's shank, so deep in a surface of this radius.
    Shoulder { by: f64, out: f64, surface: f64 },
}

impl Behind {
    /// How deep it is in the bar.
    pub(crate) const fn by(&self) -> f64 {
        match self {
            Self::Bore { by, .. } | Self::Face { by, .. } | Self::Shoulder { by, .. } => *by,
        }
    }
}

/// What is left of a bar.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub(crate) axis: [f64; 2],
    radius: f64,
    rear: f64,
    face: f64,
    cell: f64,
    outer: Vec<f64>,
    inner: Vec<f64>,
    /// Down to where there is a thread in the outside; infinite: there is none.
    root: Vec<f64>,
}

impl Outline {
    /// The blank.
    pub(crate) fn new(stock: &Stock, bar: Bar) -> Self {
        let [rear, face] = [stock.from, stock.to].map(|corner| corner[2].value());
        let cell = ((face - rear) / MOST_CELLS).max(CELL);
        let count = libm::ceil((face - rear) / cell).max(1.0) as usize;
        Self {
            axis: [0, 1].map(|i| f64::midpoint(stock.from[i].value(), stock.to[i].value())),
            radius: bar.radius.value(),
            rear,
            face,
            cell,
            outer: vec![bar.radius.value(); count],
            inner: vec![bar.bore.value(); count],
            root: vec![f64::INFINITY; count],
        }
    }

    /// Distance from the axis.
    pub(crate) fn off_axis(&self, at: [f64; 3]) -> f64 {
        libm::hypot(at[0] - self.axis[0], at[1] - self.axis[1])
    }

    /// The cells between two places of Z; `None`: they lie beside the bar.
    fn cells(&self, low: f64, high: f64) -> Option<(usize, usize)> {
        if high < self.rear || low >= self.face {
            return None;
        }
        let index = |z: f64| libm::floor((z - self.rear) / self.cell).max(0.0) as usize;
        Some((index(low), index(high).min(self.outer.len() - 1)))
    }

    /// Z of the free end of what a round tool of this radius meets about the axis.
    pub(crate) fn front(&self, radius: f64) -> f64 {
        self.front_beside(self.axis, radius)
    }

    /// Z of the free end of what a round tool of this radius meets, whose axis is at this place.
    pub(crate) fn front_beside(&self, at: [f64; 2], radius: f64) -> f64 {
        let off = libm::hypot(at[0] - self.axis[0], at[1] - self.axis[1]);
        let meets = |i: &usize| {
            self.outer[*i] > self.inner[*i]
                && self.inner[*i] < off + radius
                && self.outer[*i] > off - radius
        };
        let last = (0..self.outer.len()).rev().find(meets);
        last.map_or(self.rear, |i| (self.rear + (i + 1) as f64 * self.cell).min(self.face))
    }

    /// What stands behind an insert's point: a boring bar where the point is nearer to the bore
    /// than to the outside, else the shank of a turning tool. `shank` is how thick it is, `out` how
    /// far the point stands over it, or out of the holder.
    pub(crate) fn behind(
        &self,
        at: [f64; 3],
        shank: Option<f64>,
        out: Option<f64>,
    ) -> Option<Behind> {
        let r = self.off_axis(at);
        let (tip, last) = self.cells(at[2], self.face)?;
        let (inner, outer) = (self.inner[tip], self.outer[tip]);
        if inner > 0.0 && r - inner < outer - r {
            let is_there = |i: &usize| self.outer[*i] > self.inner[*i];
            let bores = (tip..=last).filter(is_there).map(|i| self.inner[i]);
            let narrowest = bores.filter(|bore| *bore > 0.0).reduce(f64::min);
            let fits = shank.zip(narrowest).and_then(|(bar, bore)| {
                let by = bar - r - bore;
                (by > 0.0).then_some(Behind::Bore { by, bar, bore: 2.0 * bore })
            });
            let front = (tip..=last).rev().find(is_there);
            let front = front
                .map_or(self.face, |i| (self.rear + (i + 1) as f64 * self.cell).min(self.face));
            let in_face = out.and_then(|out| {
                let by = front - at[2] - out;
                (by > 0.0).then_some(Behind::Face { by, out })
            });
            return fits.or(in_face);
        }
        let (width, out) = (shank?, out?);
        let (first, last) = self.cells(at[2], at[2] + width)?;
        let surface = self.outer[first..=last].iter().copied().fold(0.0, f64::max);
        let by = surface - r - out;
        (by > 0.0).then_some(Behind::Shoulder { by, out, surface })
    }

    /// Places along the part of a line that lies between the bar's ends, no farther from one
    /// another than a cell.
    pub(crate) fn along(&self, [a, b]: [[f64; 3]; 2], beyond: f64, mut each: impl FnMut([f64; 3])) {
        let sides = [a[0] - self.axis[0], b[0] - self.axis[0]];
        let nearest = sides[0].abs().min(sides[1].abs());
        if sides[0] * sides[1] > 0.0 && nearest >= self.radius {
            return;
        }
        let (low, high) = (self.rear - beyond, self.face + beyond);
        let way = b[2] - a[2];
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        if way == 0.0 {
            if !(low..=high).contains(&a[2]) {
                return;
            }
        } else {
            let ends = [(low - a[2]) / way, (high - a[2]) / way];
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        }
        if from > to {
            return;
        }
        let whole = libm::sqrt((0..3).map(|i| (b[i] - a[i]) * (b[i] - a[i])).sum());
        let pieces = libm::ceil((to - from) * whole / self.cell).max(1.0);
        for k in 0..=pieces as u32 {
            let share = from + (to - from) * f64::from(k) / pieces;
            each([0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * share));
        }
    }

    /// An insert with these edges was fed along a line.
    pub(crate) fn cut(&mut self, ends: [[f64; 3]; 2], edges: &EdgePolygon) {
        let beyond = edges.ends().map(f64::abs).into_iter().fold(0.0, f64::max);
        let mut places = Vec::new();
        self.along(ends, beyond + self.cell, |at| places.push(at));
        for at in places {
            let r = self.off_axis(at);
            self.within([r, at[2]], edges, Self::cut_cell);
            let Some((tip, _)) = self.cells(at[2], at[2]) else { continue };
            let thin = (tip + (EDGE / self.cell) as usize).min(self.outer.len());
            let Some(from) = (tip..thin).find(|i| self.outer[*i] > r) else { continue };
            let free = (from..self.outer.len()).find(|i| self.outer[*i] <= r);
            if let Some(free) = free.or(Some(self.outer.len())).filter(|free| *free <= thin) {
                (from..free).for_each(|i| self.cut_cell(i, r));
            }
        }
    }

    /// The cells in which edges whose tip is at this place cut, and the radius down to which they
    /// do, a cell to each side.
    fn within(
        &mut self,
        [r, z]: [f64; 2],
        edges: &EdgePolygon,
        mut each: impl FnMut(&mut Self, usize, f64),
    ) {
        let [low, high] = edges.ends();
        let Some((first, last)) = self.cells(z + low - self.cell, z + high + self.cell) else {
            return;
        };
        let deepest = r + edges.lowest();
        for i in first..=last {
            if self.outer[i] <= deepest {
                continue;
            }
            let from = self.rear + i as f64 * self.cell - z;
            if let Some(rise) = edges.least([from - self.cell / 2.0, from + self.cell * 1.5]) {
                each(self, i, r + rise);
            }
        }
    }

    fn cut_cell(&mut self, i: usize, r: f64) {
        if self.inner[i] <= 0.0 {
            self.outer[i] = self.outer[i].min(r);
        } else if r > self.inner[i] && r < self.outer[i] {
            (self.inner[i], self.outer[i]) = (0.0, 0.0);
        }
    }

    /// Radius of the blank.
    pub(crate) const fn radius(&self) -> f64 {
        self.radius
    }

    /// Z of the blank's face.
    pub(crate) const fn face(&self) -> f64 {
        self.face
    }

    /// How far a line keeps off the material, across the axis; below zero, how deep it goes in.
    /// `None`: it stays beside the bar's ends.
    pub(crate) fn gap(&self, [a, b]: [[f64; 3]; 2]) -> Option<f64> {
        let (low, high) = (a[2].min(b[2]), a[2].max(b[2]));
        let (first, last) = self.cells(low, high)?;
        let gap = |i: usize, at: [f64; 3]| {
            let r = self.off_axis(at);
            let (inner, outer) = (self.inner[i], self.outer[i]);
            if inner > 0.0 { (r - outer).max(inner - r) } else { r - outer }
        };
        let along = (first..=last).filter(|_| b[2] != a[2]).map(|i| {
            let z = (self.rear + (i as f64 + 0.5) * self.cell).clamp(low, high);
            let share = (z - a[2]) / (b[2] - a[2]);
            gap(i, [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * share))
        });
        let ends = [a, b].into_iter().filter_map(|at| Some(gap(self.cells(at[2], at[2])?.0, at)));
        along.chain(ends).reduce(f64::min)
    }

    /// An insert with these edges has turned a thread along a line.
    pub(crate) fn threaded(&mut self, ends: [[f64; 3]; 2], edges: &EdgePolygon) {
        let [a, b] = ends;
        let is_outside = |outline: &Self, at: [f64; 3]| {
            let cells = outline.cells(at[2], at[2]);
            cells.is_none_or(|(i, _)| outline.inner[i] <= 0.0)
        };
        let is_along = (b[2] - a[2]).abs() > (self.off_axis(b) - self.off_axis(a)).abs();
        if !(is_along && is_outside(self, a) && is_outside(self, b)) {
            return self.cut(ends, edges);
        }
        let mut places = Vec::new();
        self.along(ends, 0.0, |at| places.push(at));
        for at in places {
            self.within([self.off_axis(at), at[2]], edges, |outline, i, r| {
                outline.root[i] = outline.root[i].min(r);
            });
        }
    }

    /// A drill of this radius has gone along a line; only near the axis it leaves a bore.
    pub(crate) fn bored(&mut self, ends: [[f64; 3]; 2], radius: f64) {
        let deepest = ends[0][2].min(ends[1][2]);
        let Some((first, _)) = self.cells(deepest, self.face) else { return };
        let off = self.off_axis(ends[0]).max(self.off_axis(ends[1]));
        for i in first..self.outer.len() {
            self.inner[i] = self.inner[i].max(radius + off);
        }
    }

    /// Where edges that point towards the axis go deepest into the material beside their tip, if
    /// they go deeper than `scrapes`.
    pub(crate) fn met_beside(
        &self,
        ends: [[f64; 3]; 2],
        edges: &EdgePolygon,
        scrapes: f64,
    ) -> Option<Met> {
        let [low, high] = edges.ends();
        let mut met: Option<Met> = None;
        self.along(ends, low.abs().max(high.abs()), |at| {
            let r = self.off_axis(at);
            let Some((first, last)) = self.cells(at[2] + low, at[2] + high) else { return };
            let in_bore = (first..=last).any(|i| self.inner[i] > 0.0);
            if in_bore || r < NEAR_AXIS {
                return; // a boring bar, or what is left in the middle of a face
            }
            for i in first..=last {
                let middle = self.rear + (i as f64 + 0.5) * self.cell;
                let Some(rise) = edges.least([middle - at[2]; 2]) else { continue };
                let here = r + rise;
                if self.solid(i) - here <= scrapes {
                    continue;
                }
                let is_free = |k: &usize| self.solid(*k) <= here;
                let front = (i..self.outer.len()).find(is_free).unwrap_or(self.outer.len());
                let rear = (0..i).rev().find(is_free).map_or(usize::MAX, |k| i - k);
                let way = (front - i).min(rear) as f64 * self.cell;
                let depth = (self.solid(i) - here).min(way);
                if depth > scrapes && met.is_none_or(|met| depth > met.depth) {
                    let (surface, edge) = (self.outer[i], Some(middle));
                    met = Some(Met { at, depth, surface, clear: surface, edge });
                }
            }
        });
        met
    }

    /// Radius up to which a cell and those beside it are surely solid: a thread is open down to its
    /// root.
    fn solid(&self, i: usize) -> f64 {
        let around = i.saturating_sub(1)..=(i + 1).min(self.outer.len() - 1);
        around.map(|k| self.outer[k].min(self.root[k])).fold(f64::INFINITY, f64::min)
    }

    /// Where a line goes deepest into the material, if it goes deeper than `scrapes`.
    pub(crate) fn met(&self, ends: [[f64; 3]; 2], scrapes: f64) -> Option<Met> {
        let (mut met, mut entered): (Option<Met>, Option<[f64; 3]>) = (None, None);
        let goes_out = (ends[1][2] - ends[0][2]).abs() <= self.cell
            && self.off_axis(ends[1]) >= self.off_axis(ends[0]);
        self.along(ends, 0.0, |at| {
            let r = self.off_axis(at);
            let Some((i, _)) = self.cells(at[2], at[2]) else {
                entered = None;
                return;
            };
            let (inner, outer) = (self.inner[i], self.outer[i]);
            let is_groove = goes_out && r >= self.root[i] - scrapes;
            if r >= outer - scrapes || inner > 0.0 && r <= inner + scrapes || is_groove {
                entered = None;
                return;
            }
            let place = *entered.get_or_insert(at);
            let free = (i..self.outer.len()).find(|k| self.outer[*k] <= r);
            let front = free.map_or(self.face, |k| self.rear + k as f64 * self.cell);
            let out = if inner > 0.0 { (outer - r).min(r - inner) } else { outer - r };
            let depth = out.min(front - at[2]);
            if depth > scrapes && met.is_none_or(|met| depth > met.depth) {
                met = Some(Met { at: place, depth, surface: outer, clear: 0.0, edge: None });
            }
        });
        let (low, high) = (ends[0][2].min(ends[1][2]), ends[0][2].max(ends[1][2]));
        let (first, last) = self.cells(low, high)?;
        let clear = self.outer[first..=last].iter().copied().fold(0.0, f64::max);
        met.map(|met| Met { clear, ..met })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 20 mm, from Z-100 to its face at Z0, about X5.
    fn bar(bore: f64) -> Outline {
        let corner = |x: f64, y: f64, z: f64| [x, y, z].map(Length::mm);
        let bar = Bar { radius: Length::mm(10.0), bore: Length::mm(bore) };
        let (from, to) = (corner(-5.0, -10.0, -100.0), corner(15.0, 10.0, 0.0));
        Outline::new(&Stock { from, to, zero: Length::ZERO, bar: Some(bar) }, bar)
    }

    /// A turning insert of 80° with a nose of 0.2 mm.
    fn edges() -> EdgePolygon {
        EdgePolygon::of(&canon::Insert::turning(units::Angle::deg(80.0), Length::mm(0.2)))
    }

    fn line(from: [f64; 2], to: [f64; 2]) -> [[f64; 3]; 2] {
        [from, to].map(|[r, z]| [5.0 + r, 0.0, z])
    }

    #[test]
    fn a_line_beside_or_before_the_bar_meets_nothing() {
        let bar = bar(0.0);
        assert_eq!(bar.met(line([10.0, 5.0], [10.0, -80.0]), 0.2), None);
        assert_eq!(bar.met(line([30.0, 0.0], [0.0, 0.0]), 0.2), None);
        assert_eq!(bar.met(line([30.0, 1.0], [-3.0, 1.0]), 0.2), None);
    }

    #[test]
    fn what_was_turned_is_open_down_to_where_it_was_turned() {
        let mut bar = bar(0.0);
        bar.cut(line([7.0, 2.0], [7.0, -30.0]), &edges());
        assert_eq!(bar.met(line([7.0, 2.0], [7.0, -30.0]), 0.2), None);
        let met = bar.met(line([7.0, 2.0], [7.0, -40.0]), 0.2).unwrap();
        assert!((met.depth - 3.0).abs() < 1e-9 && met.surface == 10.0 && met.clear == 10.0);
        assert!((-30.5..-30.0).contains(&met.at[2]), "{met:?}"); // where it goes in, not where it is deepest
        let met = bar.met(line([5.0, 2.0], [5.0, -20.0]), 0.2).unwrap();
        assert!((met.depth - 2.0).abs() < 1e-9, "{met:?}");
    }

    #[test]
    fn a_line_off_the_bar_keeps_a_gap_and_one_before_its_face_none() {
        let gap = |bar: &Outline, from, to| bar.gap(line(from, to));
        let near = |found: Option<f64>, mm: f64| (found.unwrap() - mm).abs() < 1e-9;
        assert!(near(gap(&bar(0.0), [10.5, 5.0], [10.5, -20.0]), 0.5));
        assert!(near(gap(&bar(0.0), [9.0, 5.0], [9.0, -20.0]), -1.0));
        assert!(near(gap(&bar(6.0), [5.5, 5.0], [5.5, -20.0]), 0.5));
        assert!(near(gap(&bar(6.0), [6.5, 5.0], [6.5, -20.0]), -0.5));
        assert_eq!(gap(&bar(0.0), [9.0, 5.0], [9.0, 1.0]), None);
        // across its face, as a scroll is turned
        assert!(near(gap(&bar(0.0), [15.0, -0.3], [3.0, -0.3]), -7.0));
        assert!(near(gap(&bar(0.0), [15.0, -0.3], [12.0, -0.3]), 2.0));
    }

    #[test]
    fn a_thread_is_left_straight_out_and_has_crests_for_all_else() {
        let mut bar = bar(0.0);
        bar.threaded(line([9.0, 2.0], [9.0, -30.0]), &edges());
        assert_eq!(bar.met(line([9.0, -30.0], [15.0, -30.0]), 0.2), None);
        let depth = |ends| bar.met(ends, 0.2).map_or(0.0, |met| met.depth);
        assert!((depth(line([9.0, 2.0], [9.0, -20.0])) - 1.0).abs() < 1e-9);
        assert!((depth(line([15.0, -10.0], [9.0, -10.0])) - 1.0).abs() < 1e-9);
        assert!((depth(line([8.0, -20.0], [15.0, -20.0])) - 2.0).abs() < 1e-9);
        assert!(depth(line([9.0, -40.0], [15.0, -40.0])) > 0.9);
        // turned off, it is gone
        bar.cut(line([8.5, 2.0], [8.5, -35.0]), &edges());
        assert_eq!(bar.met(line([9.0, 2.0], [9.0, -20.0]), 0.2), None);
    }

    #[test]
    fn facing_takes_what_is_before_the_edge() {
        let mut bar = bar(0.0);
        bar.cut(line([12.0, -1.0], [-0.5, -1.0]), &edges());
        assert_eq!(bar.met(line([0.5, -1.0], [0.5, 5.0]), 0.2), None);
        let mut faced = self::bar(0.0);
        let pointed = canon::Insert::threading(units::Angle::deg(60.0), None, None);
        faced.cut(line([12.0, -1.0], [-0.3, -1.0]), &EdgePolygon::of(&pointed));
        assert_eq!(faced.met(line([0.3, -1.0], [0.3, 5.0]), 0.2), None, "by a pointed insert");
        let met = bar.met(line([0.5, 5.0], [0.5, -3.0]), 0.2).unwrap();
        assert!((1.0..=2.0).contains(&met.depth), "{met:?}");
        // a groove leaves what is before it
        let groove = EdgePolygon::of(&canon::Insert::grooving(Length::mm(1.0)));
        bar.cut(line([12.0, -30.0], [6.0, -30.0]), &groove);
        assert!(bar.met(line([12.0, -20.0], [8.0, -20.0]), 0.2).is_some());
    }

    #[test]
    fn a_boring_bar_needs_a_bore_and_a_turning_tool_room_over_its_point() {
        let mut bar = bar(6.0);
        // a bar of 16 mm whose point cuts at 6.5 mm from the axis: its back would be at 9.5 mm, in
        // a bore of 6
        let met = bar.behind([11.5, 0.0, -20.0], Some(16.0), None).unwrap();
        assert_eq!(met, Behind::Bore { by: 3.5, bar: 16.0, bore: 12.0 });
        assert_eq!(bar.behind([11.5, 0.0, -20.0], Some(12.0), Some(30.0)), None);
        let met = bar.behind([11.5, 0.0, -20.0], Some(12.0), Some(15.0)).unwrap();
        assert!((met.by() - 5.0).abs() < 1e-9, "{met:?}");
        // a groove of 3 mm with a point that stands 2 mm over a shank 12 mm wide
        let groove = EdgePolygon::of(&canon::Insert::grooving(Length::mm(2.0)));
        bar.cut(line([7.0, -30.0], [7.0, -31.0]), &groove);
        let at = [5.0 + 7.0, 0.0, -30.5];
        let met = bar.behind(at, Some(12.0), Some(2.0)).unwrap();
        assert!((met.by() - 1.0).abs() < 1e-9, "{met:?}");
        assert_eq!(bar.behind(at, Some(12.0), Some(4.0)), None);
    }

    #[test]
    fn a_bore_is_open_and_what_was_cut_in_it_is_not_known() {
        let mut bar = bar(0.0);
        assert!(bar.met(line([3.0, 5.0], [3.0, -10.0]), 0.2).is_some());
        bar.bored(line([0.0, 5.0], [0.0, -50.0]), 4.0);
        assert_eq!(bar.met(line([3.0, 5.0], [3.0, -10.0]), 0.2), None);
        assert!(bar.met(line([6.0, 5.0], [6.0, -10.0]), 0.2).is_some());
        bar.cut(line([5.0, 5.0], [5.0, -20.0]), &edges());
        assert_eq!(bar.met(line([6.0, 5.0], [6.0, -10.0]), 0.2), None);
        assert!(bar.met(line([6.0, 5.0], [6.0, -30.0]), 0.2).is_some());
    }
}
