//! How deep end mills have gone, over X and Y: where they were, a drill or a tap meets nothing.
//!
//! ```text
//!   top ──┐     ┌──   cells of 0.5 mm; each has the deepest tip of a mill whose circle held its middle
//!         └──┬──┘     floor under a tool: the least of the cells within its radius
//! ```
//!
//! Mills are flat here, and meet no force. Memory: [`MOST_CELLS`]; what is milled beyond is not
//! kept.
use std::collections::HashMap;
use units::Length;

/// Side of a cell, mm.
const CELL_MM: f64 = 0.5;
/// Cells that are kept: a block of 500 × 500 mm.
const MOST_CELLS: usize = 1_000_000;

/// What mills have left.
#[derive(Clone, Debug, Default)]
pub(super) struct Milled {
    /// Depths below the surface, mm, by place.
    depths: HashMap<(i32, i32), f32>,
    /// Where a mill was last, mm: X, Y, depth.
    last: Option<[f64; 3]>,
}

impl Milled {
    /// A mill of a diameter stands with its tip so deep below the surface.
    pub(super) fn cut(&mut self, at: [Length; 2], diameter: Length, depth: f64) {
        let now = [at[0].value(), at[1].value(), depth];
        let is_near = |last: &[f64; 3]| (0..3).all(|i| (last[i] - now[i]).abs() < CELL_MM / 4.0);
        if depth <= 0.0 || self.last.as_ref().is_some_and(is_near) {
            return;
        }
        self.last = Some(now);
        for cell in cells(at, diameter.value() / 2.0) {
            let is_known = self.depths.contains_key(&cell);
            if is_known || self.depths.len() < MOST_CELLS {
                let deepest = self.depths.entry(cell).or_insert(0.0);
                *deepest = deepest.max(depth as f32);
            }
        }
    }

    /// How deep below the surface the material begins under a tool, mm.
    pub(super) fn floor(&self, at: [Length; 2], diameter: Length) -> f64 {
        if self.depths.is_empty() {
            return 0.0;
        }
        let depth = |cell| self.depths.get(&cell).map_or(0.0, |depth| f64::from(*depth));
        let radius = (diameter.value() / 2.0 - CELL_MM).max(CELL_MM);
        cells(at, radius).map(depth).fold(f64::INFINITY, f64::min)
    }
}

/// Cells whose middle lies in a circle.
fn cells(at: [Length; 2], radius: f64) -> impl Iterator<Item = (i32, i32)> {
    let [x, y] = at.map(Length::value);
    let cell = |at: f64| (at / CELL_MM).floor() as i32;
    let middle = |cell: i32| (f64::from(cell) + 0.5) * CELL_MM;
    let columns = cell(x - radius)..=cell(x + radius);
    columns.flat_map(move |i| {
        let rows = cell(y - radius)..=cell(y + radius);
        let is_in = move |j: &i32| (middle(i) - x).hypot(middle(*j) - y) <= radius;
        rows.filter(is_in).map(move |j| (i, j))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pocket_is_as_deep_as_its_mill_went_and_its_wall_is_the_surface() {
        let at = |x: f64| [Length::mm(x), Length::ZERO];
        let mut milled = Milled::default();
        for k in 0..=100 {
            milled.cut(at(f64::from(k) * 0.2), Length::mm(12.0), 5.0);
        }
        assert!((milled.floor(at(10.0), Length::mm(6.8)) - 5.0).abs() < 1e-6);
        assert!(milled.floor(at(24.0), Length::mm(6.8)).abs() < 1e-6, "half of it is in the wall");
        assert!(milled.floor(at(40.0), Length::mm(6.8)).abs() < 1e-6);
    }
}
