//! The workpiece as far as it is known before motion: a block of material, and what the program has
//! removed of it.
//!
//! ```text
//!      top ──────┐  ┌───┐ ╱ ┌────      bores: round, by place, diameter and depth (what drills and mills leave)
//!                │  │   │ ╲╱           milled: how deep a mill has passed, on a grid of X and Y
//!                └──┘
//! ```
//!
//! Coordinates are those of the tool's *tip* in the machine's frame, mm; depths count from the top
//! downwards. What is remembered errs on the side of too much removed: a place that a mill has
//! passed is never taken for solid.
use crate::bar::Bar;
use alloc::{collections::BTreeMap, vec, vec::Vec};
use units::Length;

/// A block of material, where it is clamped: machine coordinates of a tool's tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Corner at the negative ends of X, Y and Z.
    pub from: [Length; 3],
    /// Corner at the positive ends; its Z is the top.
    pub to: [Length; 3],
    /// Z of the workpiece's zero, where a program's zero belongs.
    pub zero: Length,
    /// It is a bar that the first spindle turns.
    pub bar: Option<Bar>,
}

impl Stock {
    /// Z of its top, mm.
    pub(crate) const fn top(&self) -> f64 {
        self.to[2].value()
    }

    /// Whether a place lies over it.
    pub(crate) fn is_below(&self, at: [f64; 2]) -> bool {
        (0..2).all(|i| (self.from[i].value()..=self.to[i].value()).contains(&at[i]))
    }

    /// Whether there is material at a place, before anything is cut: a bar is round.
    pub(crate) fn holds(&self, at: [f64; 2]) -> bool {
        self.is_below(at)
            && self.bar.is_none_or(|bar| {
                let [x, y] =
                    [0, 1].map(|i| at[i] - f64::midpoint(self.from[i].value(), self.to[i].value()));
                (bar.bore.value()..=bar.radius.value()).contains(&libm::hypot(x, y))
            })
    }

    /// The place over it that is nearest to another one.
    pub(crate) fn nearest(&self, at: [f64; 2]) -> [f64; 2] {
        if let Some(bar) = self.bar {
            let centre = [0, 1].map(|i| f64::midpoint(self.from[i].value(), self.to[i].value()));
            let [x, y] = [0, 1].map(|i| at[i] - centre[i]);
            let share = (bar.radius.value() / libm::hypot(x, y)).min(1.0);
            return [centre[0] + x * share, centre[1] + y * share];
        }
        [0, 1].map(|i| at[i].clamp(self.from[i].value(), self.to[i].value()))
    }

    /// How far a circle about a place reaches over the nearest side, mm; negative: by so much it is
    /// inside.
    pub(crate) fn over_side(&self, at: [f64; 2], radius: f64) -> f64 {
        let over = |i: usize| {
            (self.from[i].value() - at[i] + radius).max(at[i] + radius - self.to[i].value())
        };
        over(0).max(over(1))
    }

    /// The part of a line, as shares of it within `part`, that lies over the block; `None`: no part
    /// does.
    pub(crate) fn over(&self, [a, b]: [[f64; 3]; 2], part: (f64, f64)) -> Option<(f64, f64)> {
        let (mut from, mut to) = part;
        for i in 0..2 {
            let (low, high) = (self.from[i].value(), self.to[i].value());
            let way = b[i] - a[i];
            if way == 0.0 {
                if !(low..=high).contains(&a[i]) {
                    return None;
                }
                continue;
            }
            let ends = [(low - a[i]) / way, (high - a[i]) / way];
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        }
        (from < to || from == to && part.0 == part.1).then_some((from, to))
    }
}

/// Tools closer than this to a bore's centre are in that bore, mm.
const SAME_HOLE: f64 = 0.1;
/// Smallest cell of the grid on which milling is remembered, mm, and the most cells along an axis.
const CELL: f64 = 0.5;
const MOST_CELLS: f64 = 256.0;

/// A round hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bore {
    at: [f64; 2],
    pub(crate) diameter: f64,
    /// Height of the cone at its end.
    cone: f64,
    /// Depth of the deepest point.
    tip_depth: f64,
}

/// What was removed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Removed {
    bores: BTreeMap<(i64, i64), Vec<Bore>>,
    milled: Option<Milled>,
}

fn cell(x: f64) -> i64 {
    libm::floor(x / SAME_HOLE) as i64
}

impl Removed {
    /// A tool of this diameter, with a cone of this height at its end, has gone so deep.
    pub(crate) fn bore(&mut self, at: [f64; 2], diameter: f64, cone: f64, depth: f64) {
        let known = self.near_mut(at).find(|bore| bore.diameter == diameter && bore.cone == cone);
        if let Some(bore) = known {
            bore.tip_depth = bore.tip_depth.max(depth);
            return;
        }
        let bore = Bore { at, diameter, cone, tip_depth: depth };
        self.bores.entry((cell(at[0]), cell(at[1]))).or_default().push(bore);
    }

    fn near_mut(&mut self, at: [f64; 2]) -> impl Iterator<Item = &mut Bore> {
        let (i, j) = (cell(at[0]), cell(at[1]));
        // the three rows of cells around the place
        self.bores
            .range_mut((i - 1, i64::MIN)..=(i + 1, i64::MAX))
            .filter(move |((_, row), _)| (j - 1..=j + 1).contains(row))
            .flat_map(|(_, bores)| bores)
            .filter(move |bore| is_there(bore, at))
    }

    fn near(&self, at: [f64; 2]) -> impl Iterator<Item = &Bore> {
        let (i, j) = (cell(at[0]), cell(at[1]));
        let cells = (i - 1..=i + 1).flat_map(move |i| (j - 1..=j + 1).map(move |j| (i, j)));
        cells
            .filter_map(|cell| self.bores.get(&cell))
            .flatten()
            .filter(move |bore| is_there(bore, at))
    }

    /// How deep a tool of this form gets here without cutting.
    pub(crate) fn free_depth(&self, at: [f64; 2], diameter: f64, cone: f64) -> f64 {
        self.near(at)
            .map(|bore| match bore.diameter {
                d if d == diameter && bore.cone == cone => bore.tip_depth,
                d if d >= diameter => bore.tip_depth - bore.cone,
                _ => 0.0,
            })
            .fold(0.0, f64::max)
    }

    /// How deep a round body of this radius gets in one bore without cutting.
    pub(crate) fn open_round(&self, at: [f64; 2], radius: f64) -> f64 {
        let fits = |bore: &&Bore| {
            libm::hypot(bore.at[0] - at[0], bore.at[1] - at[1]) + radius
                <= bore.diameter / 2.0 + SAME_HOLE
        };
        let bores = self.bores.values().flatten().filter(fits);
        bores.map(|bore| bore.tip_depth - bore.cone).fold(0.0, f64::max)
    }

    /// Diameter that is open at a depth, of the bores narrower than this.
    pub(crate) fn open_diameter(&self, at: [f64; 2], depth: f64, below: f64) -> f64 {
        self.near(at)
            .filter(|bore| bore.diameter < below && bore.tip_depth - bore.cone >= depth)
            .map(|bore| bore.diameter)
            .fold(0.0, f64::max)
    }

    /// A mill of this radius has gone from one place to another.
    pub(crate) fn mill(&mut self, stock: &Stock, ends: [[f64; 3]; 2], radius: f64) {
        let milled = self.milled.get_or_insert_with(|| Milled::new(stock));
        milled.pass(ends, radius);
    }

    /// How deep a mill has passed over a place.
    pub(crate) fn milled_depth(&self, at: [f64; 2]) -> f64 {
        self.milled.as_ref().map_or(0.0, |milled| milled.depth(at))
    }
}

fn is_there(bore: &Bore, at: [f64; 2]) -> bool {
    libm::hypot(bore.at[0] - at[0], bore.at[1] - at[1]) <= SAME_HOLE
}

/// How deep mills have passed, by cells of X and Y.
#[derive(Clone, Debug)]
struct Milled {
    from: [f64; 2],
    top: f64,
    cell: f64,
    count: [usize; 2],
    depth: Vec<f32>,
    /// Where the disk was marked last, and how deep.
    last: Option<[f64; 3]>,
}

impl Milled {
    fn new(stock: &Stock) -> Self {
        let width = [0, 1].map(|i| (stock.to[i] - stock.from[i]).value());
        let cell = (width[0].max(width[1]) / MOST_CELLS).max(CELL);
        let count = width.map(|w| libm::ceil(w / cell).max(1.0) as usize);
        Self {
            from: [0, 1].map(|i| stock.from[i].value()),
            top: stock.top(),
            cell,
            count,
            depth: vec![0.0; count[0] * count[1]],
            last: None,
        }
    }

    fn index(&self, axis: usize, x: f64) -> Option<usize> {
        let at = libm::floor((x - self.from[axis]) / self.cell);
        let count = self.count[axis];
        // its very end belongs to the last cell
        (at >= 0.0 && at <= count as f64).then_some((at as usize).min(count - 1))
    }

    fn depth(&self, at: [f64; 2]) -> f64 {
        let place = self.index(0, at[0]).zip(self.index(1, at[1]));
        place.map_or(0.0, |(i, j)| f64::from(self.depth[j * self.count[0] + i]))
    }

    fn pass(&mut self, [a, b]: [[f64; 3]; 2], radius: f64) {
        let step = self.cell.max(radius / 4.0);
        let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
        let steps = libm::ceil(length / step).max(1.0);
        for k in 0..=steps as usize {
            let share = k as f64 / steps;
            let at = [0, 1, 2].map(|i| a[i] + (b[i] - a[i]) * share);
            let is_new = self.last.is_none_or(|last| {
                libm::hypot(at[0] - last[0], at[1] - last[1]) > step / 2.0 || at[2] < last[2]
            });
            if is_new {
                self.last = Some(at);
                self.disk(at, radius + step);
            }
        }
    }

    fn disk(&mut self, at: [f64; 3], radius: f64) {
        let depth = (self.top - at[2]) as f32;
        let ends = |axis: usize, at: f64| {
            let last = self.count[axis] as f64 - 1.0;
            let index = |x: f64| libm::floor((x - self.from[axis]) / self.cell).clamp(0.0, last);
            (index(at - radius) as usize, index(at + radius) as usize)
        };
        let (columns, rows) = (ends(0, at[0]), ends(1, at[1]));
        for j in rows.0..=rows.1 {
            let y = self.from[1] + (j as f64 + 0.5) * self.cell - at[1];
            for i in columns.0..=columns.1 {
                let x = self.from[0] + (i as f64 + 0.5) * self.cell - at[0];
                let cell = &mut self.depth[j * self.count[0] + i];
                if x * x + y * y <= radius * radius && depth > *cell {
                    *cell = depth;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plate() -> Stock {
        let corner = |x: f64, z: f64| [Length::mm(x), Length::mm(x), Length::mm(z)];
        Stock { from: corner(-50.0, -30.0), to: corner(50.0, 0.0), zero: Length::ZERO, bar: None }
    }

    #[test]
    fn a_tool_gets_as_deep_as_it_or_a_wider_one_has_bored() {
        let mut removed = Removed::default();
        removed.bore([10.0, 10.0], 5.0, 1.5, 12.0);
        removed.bore([10.02, 10.0], 8.0, 2.0, 6.0);
        assert_eq!(removed.free_depth([10.0, 10.0], 5.0, 1.5), 12.0);
        assert_eq!(removed.free_depth([10.0, 10.0], 6.0, 1.5), 4.0);
        assert_eq!(removed.free_depth([10.0, 10.0], 9.0, 1.5), 0.0);
        assert_eq!(removed.free_depth([10.5, 10.0], 5.0, 1.5), 0.0);
        assert_eq!(removed.open_diameter([10.0, 10.0], 3.0, 8.0), 5.0);
    }

    #[test]
    fn where_a_mill_has_passed_is_not_solid() {
        let (stock, mut removed) = (plate(), Removed::default());
        removed.mill(&stock, [[-10.0, 0.0, -5.0], [10.0, 0.0, -5.0]], 4.0);
        assert_eq!(removed.milled_depth([0.0, 3.5]), 5.0);
        assert_eq!(removed.milled_depth([13.0, 0.0]), 5.0);
        assert_eq!(removed.milled_depth([0.0, 12.0]), 0.0);
        assert_eq!(removed.milled_depth([1000.0, 0.0]), 0.0);
    }

    #[test]
    fn a_line_is_cut_to_its_part_over_the_block() {
        let stock = plate();
        let across = [[-100.0, 0.0, -1.0], [100.0, 0.0, -1.0]];
        assert_eq!(stock.over(across, (0.0, 1.0)), Some((0.25, 0.75)));
        assert_eq!(stock.over(across, (0.8, 1.0)), None);
        let down = [[1.0, 1.0, 5.0], [1.0, 1.0, -5.0]];
        assert_eq!(stock.over(down, (0.5, 1.0)), Some((0.5, 1.0)));
        let beside = [[60.0, 1.0, 5.0], [60.0, 1.0, -5.0]];
        assert_eq!(stock.over(beside, (0.5, 1.0)), None);
    }
}
