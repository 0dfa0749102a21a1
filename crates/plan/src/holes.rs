//! Memory of the holes that a program has drilled, so that a tap can be measured against its hole.
//!
//! ```text
//!    surface ────┐      ┌──── ─┬─
//!                │      │      │ depth at full diameter
//!   full bottom ─│─ ─ ─ │      ▼
//!                 ╲    ╱       cone: d/2 ÷ tan(point angle/2)
//!                  ╲  ╱
//!         tip ──────╲╱         = axis coordinate − tool length
//! ```
//!
//! All depths here are those of the tool's *tip*, so that a drill and a tap of different length
//! compare.
use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use canon::{Axis, Hole, Position, Tool, ToolKind};
use diag::Span;
use units::Length;

/// Two holes nearer than this are one: wider than any rounding, narrower than any pattern.
const SAME_PLACE: f64 = 0.05;

/// A round hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drilled {
    x: f64,
    y: f64,
    /// Its diameter.
    pub(crate) diameter: Length,
    /// Where its full diameter ends, as a coordinate of the tool's tip.
    pub(crate) full_bottom: Length,
    /// Height of the cone below that.
    pub(crate) point: Length,
    /// The block that drilled it.
    pub(crate) span: Span,
}

/// All holes so far, by place. Holes along other axes than Z are not remembered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Holes {
    by_cell: BTreeMap<(i64, i64), Vec<Drilled>>,
}

fn cell(x: f64) -> i64 {
    libm::floor(x / SAME_PLACE) as i64
}

fn place(at: &Position) -> (f64, f64) {
    (at.linear[0].value(), at.linear[1].value())
}

impl Holes {
    /// Remember a hole; spot drills and taps do not make one that a tap could go into.
    pub(crate) fn drill(&mut self, hole: &Hole, tool: &Tool, span: Span) {
        let radius = tool.diameter.value() / 2.0;
        let point = match tool.kind {
            ToolKind::Drill { point_angle } => radius / libm::tan(point_angle.in_rad() / 2.0),
            ToolKind::EndMill(_) | ToolKind::Other => 0.0,
            ToolKind::SpotDrill { .. }
            | ToolKind::Tap(_)
            | ToolKind::PolygonCutter(_)
            | ToolKind::Probe(_)
            | ToolKind::Hob(_)
            | ToolKind::Insert(_) => return,
        };
        if hole.axis != Axis::Z || !point.is_finite() {
            return;
        }
        let (x, y) = place(&hole.at);
        let point = Length::mm(point);
        let drilled = Drilled {
            x,
            y,
            diameter: tool.diameter,
            full_bottom: hole.bottom - tool.worn_length() + point,
            point,
            span,
        };
        self.by_cell.entry((cell(x), cell(y))).or_default().push(drilled);
    }

    /// A hole that a tool of this diameter would meet off its centre, and how far off.
    pub(crate) fn beside(&self, at: &Position, diameter: Length) -> Option<(Drilled, Length)> {
        let (x, y) = place(at);
        let off = |d: &Drilled| libm::hypot(d.x - x, d.y - y);
        let meets = |d: &&Drilled| off(d) < (d.diameter + diameter).value() / 2.0;
        let holes = self.by_cell.values().flatten().filter(meets);
        let nearest = holes.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some((*nearest, Length::mm(off(nearest))))
    }

    /// The hole at a place that matters to a tap whose tip goes down to `tip`: the widest of those
    /// that reach that deep, else the deepest.
    pub(crate) fn at(&self, at: &Position, tip: Length) -> Option<Drilled> {
        let (x, y) = place(at);
        let near = |d: &&Drilled| libm::hypot(d.x - x, d.y - y) <= SAME_PLACE;
        let cells = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (cell(x) + i, cell(y) + j)));
        let here = || cells.clone().filter_map(|c| self.by_cell.get(&c)).flatten().filter(near);
        let wider = |a: &&Drilled, b: &&Drilled| a.diameter.value().total_cmp(&b.diameter.value());
        let deeper =
            |a: &&Drilled, b: &&Drilled| b.full_bottom.value().total_cmp(&a.full_bottom.value());
        here()
            .filter(|d| d.full_bottom <= tip)
            .max_by(wider)
            .or_else(|| here().max_by(deeper))
            .copied()
    }
}
