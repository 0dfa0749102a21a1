//! What mills have left of a block: a height field over X and Y, and the form that cuts it.
//!
//! ```text
//!     top ──┐      ┌────┐   ┌──      depth(i, j): how deep the material is gone there, 0 … thickness
//!           └──╮╭──┘    │   │        rise(r): how far the cutter's edge stands above its tip at radius r
//!              ╰╯       └───┘        cut: depth ← max(depth, depth of the tip − rise(r))   within the cutter's radius
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | c | side of a cell | mm |
//! | D, R | diameter, radius of the cutter | mm |
//!
//! A cell is what stands at its middle: a wall may stand half a cell off, at every wall. Cells are
//! as small as D/[`CELLS_ACROSS`] of the smallest mill so far, unless the whole grid would have
//! more than [`MOST_CELLS`]. Only what is open from above is known: no undercuts.
use super::is_of_unknown_form;
use crate::Stock;
use crate::workpiece::Bore;
use canon::{MillForm, Tool, ToolKind};
use units::Length;

/// Cells across a mill.
const CELLS_ACROSS: f64 = 40.0;
/// Cells of a grid at most: 16 MB.
pub(crate) const MOST_CELLS: f64 = 4e6;
/// No cell is smaller, mm.
const SMALLEST_CELL: f64 = 0.01;
/// The grid begins so much of a cell before the block: walls at round coordinates then do not run
/// along the middles of cells, where a micrometre decides over a row of them.
const OFF_GRID: f64 = 0.381_966;

/// What a mill's edges sweep in a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cutter {
    pub(crate) radius: f64,
    form: MillForm,
}

impl Cutter {
    #[cfg(test)]
    pub(crate) const fn with(radius: f64, form: MillForm) -> Self {
        Self { radius, form }
    }

    /// Flat at its end.
    pub(crate) const fn flat(radius: f64) -> Self {
        Self { radius, form: MillForm::FLAT }
    }

    /// It makes a chamfer, not a step.
    pub(crate) const fn is_pointed(&self) -> bool {
        matches!(self.form, MillForm::Conical { .. } | MillForm::Ball)
    }

    /// Of a tool whose form is known.
    pub(crate) fn of(tool: &Tool) -> Option<Self> {
        let form = match &tool.kind {
            ToolKind::EndMill(mill) => mill.form?,
            ToolKind::Drill { point_angle } | ToolKind::SpotDrill { point_angle } => {
                MillForm::Conical { angle: *point_angle, tip: Length::ZERO }
            }
            _ => return None,
        };
        let radius = tool.diameter.value() / 2.0 + tool.wear.radius.value();
        (radius > 0.0).then_some(Self { radius, form })
    }

    /// The largest that a tool can be of which only the diameter is known.
    pub(crate) fn around(tool: &Tool) -> Option<Self> {
        let radius = tool.diameter.value() / 2.0;
        (is_of_unknown_form(tool) && radius > 0.0).then(|| Self::flat(radius))
    }

    /// How far its edge stands above its tip, mm.
    pub(crate) fn rise(&self, r: f64) -> f64 {
        let round = |corner: f64| {
            let corner = corner.min(self.radius);
            let out = r - (self.radius - corner);
            if out > 0.0 { corner - (corner * corner - out * out).max(0.0).sqrt() } else { 0.0 }
        };
        match self.form {
            MillForm::Cylindrical { corner } => round(corner.value()),
            MillForm::Ball => round(self.radius),
            MillForm::Conical { angle, tip } => {
                (r - tip.value() / 2.0).max(0.0) / (angle.in_rad() / 2.0).tan()
            }
        }
    }
}

/// What one place of the cutter has removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// From the cutter's axis to the cell's middle, mm.
    pub(crate) at: [f64; 2],
    /// Height that was removed, mm.
    pub(crate) removed: f64,
    /// How deep below the material's surface the tip stands there, mm.
    pub(crate) below: f64,
}

/// The material's heights.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    stock: Stock,
    from: [f64; 2],
    cell: f64,
    count: [usize; 2],
    thickness: f64,
    depths: Vec<f32>,
}

impl Field {
    /// The whole block, for a mill of this diameter; `None`: it has no volume.
    pub(crate) fn new(stock: Stock, diameter: f64) -> Option<Self> {
        let sides = [0, 1, 2].map(|i| (stock.to[i] - stock.from[i]).value());
        if !sides.iter().all(|side| side.is_finite() && *side > 0.0) {
            return None;
        }
        let cell = cell_of(&sides, diameter);
        let count = [sides[0], sides[1]].map(|side| (side / cell + OFF_GRID).ceil() as usize + 1);
        let from = [0, 1].map(|i| stock.from[i].value() - OFF_GRID * cell);
        let depths = vec![0.0; count[0] * count[1]];
        let mut field = Self { stock, from, cell, count, thickness: sides[2], depths };
        for j in 0..count[1] {
            for i in 0..count[0] {
                // the rim of the grid lies outside of the block
                let [x, y] = field.middle(i, j);
                let inside =
                    |i: usize, at: f64| stock.from[i].value() <= at && at <= stock.to[i].value();
                if !(inside(0, x) && inside(1, y)) {
                    field.depths[j * count[0] + i] = f32::INFINITY;
                }
            }
        }
        Some(field)
    }

    /// The same material in finer cells, if this mill needs them and there is room for them.
    pub(crate) fn refined(self, diameter: f64) -> Self {
        let sides = [0, 1, 2].map(|i| (self.stock.to[i] - self.stock.from[i]).value());
        if cell_of(&sides, diameter) > 0.75 * self.cell {
            return self;
        }
        let Some(mut fine) = Self::new(self.stock, diameter) else { return self };
        for j in 0..fine.count[1] {
            for i in 0..fine.count[0] {
                let place = j * fine.count[0] + i;
                if fine.depths[place].is_finite() {
                    fine.depths[place] = self.depth_within(fine.middle(i, j)) as f32;
                }
            }
        }
        fine
    }

    pub(crate) const fn stock(&self) -> &Stock {
        &self.stock
    }

    /// Side of a cell, mm.
    pub(crate) const fn cell(&self) -> f64 {
        self.cell
    }

    /// Bytes that its heights take.
    pub(crate) fn bytes(&self) -> usize {
        self.depths.len() * size_of::<f32>()
    }

    fn middle(&self, i: usize, j: usize) -> [f64; 2] {
        [self.from[0] + (i as f64 + 0.5) * self.cell, self.from[1] + (j as f64 + 0.5) * self.cell]
    }

    /// How deep the material is gone at a place, mm; infinite beside the block.
    pub(crate) fn depth(&self, at: [f64; 2]) -> Option<f64> {
        let index = |axis: usize| {
            let k = ((at[axis] - self.from[axis]) / self.cell).floor();
            (k >= 0.0 && k < self.count[axis] as f64).then_some(k as usize)
        };
        Some(f64::from(self.depths[index(1)? * self.count[0] + index(0)?]))
    }

    /// The same of a place over the block, or of the nearest one that is.
    fn depth_within(&self, at: [f64; 2]) -> f64 {
        let half = self.cell / 2.0;
        let inside = [0, 1].map(|i| {
            let [from, to] = [self.stock.from[i], self.stock.to[i]].map(Length::value);
            at[i].min(to - half).max(from + half)
        });
        self.depth(inside).map_or(0.0, |depth| depth.min(self.thickness))
    }

    /// Cells within a radius of the axis, as columns of a row: `(row, first, one after the last)`.
    fn rows(
        &self,
        tip: [f64; 3],
        radius: f64,
    ) -> impl Iterator<Item = (usize, usize, usize)> + use<> {
        let (from, cell, [wide, high]) = (self.from, self.cell, self.count);
        let index = move |axis: usize, at: f64| (at - from[axis]) / cell - 0.5;
        let first = index(1, tip[1] - radius).ceil().max(0.0) as usize;
        let last = (index(1, tip[1] + radius).floor() + 1.0).clamp(0.0, high as f64) as usize;
        (first..last).filter_map(move |j| {
            let dy = from[1] + (j as f64 + 0.5) * cell - tip[1];
            let half = (radius * radius - dy * dy).max(0.0).sqrt();
            let a = index(0, tip[0] - half).ceil().max(0.0) as usize;
            let b = (index(0, tip[0] + half).floor() + 1.0).clamp(0.0, wide as f64) as usize;
            (a < b).then_some((j, a, b))
        })
    }

    /// The cutter stands with its tip here: what it meets within this share of its radius is given
    /// to `each`, and, if `takes`, removed.
    pub(crate) fn meet(
        &mut self,
        cutter: &Cutter,
        tip: [f64; 3],
        (radius, takes): (f64, bool),
        mut each: impl FnMut(Cell),
    ) {
        let deep = self.stock.top().value() - tip[2];
        if deep <= 0.0 {
            return;
        }
        for (j, a, b) in self.rows(tip, radius) {
            let y = self.from[1] + (j as f64 + 0.5) * self.cell - tip[1];
            for i in a..b {
                let place = j * self.count[0] + i;
                let depth = f64::from(self.depths[place]);
                if depth >= deep || depth >= self.thickness {
                    continue;
                }
                let x = self.from[0] + (i as f64 + 0.5) * self.cell - tip[0];
                let to = (deep - cutter.rise(x.hypot(y))).min(self.thickness);
                // less is the rounding of stored heights
                if to <= depth + 1e-5 * (1.0 + depth) {
                    continue;
                }
                each(Cell { at: [x, y], removed: to - depth, below: deep - depth });
                if takes {
                    self.depths[place] = to as f32;
                }
            }
        }
    }

    /// A hole that was drilled before the grid was made.
    pub(crate) fn bore(&mut self, hole: &Bore) {
        let [x, y] = hole.at.map(Length::value);
        let (cutter, tip_mm) = (hole.cutter(), hole.tip_mm());
        self.meet(&cutter, [x, y, tip_mm], (cutter.radius, true), |_| {});
    }

    /// Depths over the block in a picture of at most this many cells a side, rows from small Y to
    /// large.
    pub(crate) fn picture(&self, most: usize) -> Vec<Vec<f64>> {
        let size = [0, 1].map(|i| (self.stock.to[i] - self.stock.from[i]).value());
        let longest = size[0].max(size[1]);
        let pixels = size.map(|side| ((side / longest * most as f64).round() as usize).max(1));
        let at = |axis: usize, k: usize| {
            self.stock.from[axis].value() + (k as f64 + 0.5) * size[axis] / pixels[axis] as f64
        };
        (0..pixels[1])
            .map(|j| (0..pixels[0]).map(|i| self.depth_within([at(0, i), at(1, j)])).collect())
            .collect()
    }
}

fn cell_of(sides: &[f64; 3], diameter: f64) -> f64 {
    let bounded = (sides[0] * sides[1] / MOST_CELLS).sqrt();
    // a long and thin block has as few cells as a square one
    let bounded = bounded.max(sides[0].max(sides[1]) / (MOST_CELLS / 4.0));
    (diameter / CELLS_ACROSS).max(bounded).max(SMALLEST_CELL)
}
