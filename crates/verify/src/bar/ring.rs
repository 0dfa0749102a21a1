//! How near to the axis tools have come since something was cut there that turns with the work and
//! is not round, such as a polygon: its owner compares that with its own form.
use crate::insert::Side;

/// Differences below this are none, mm.
const SAME_MM: f64 = 1e-6;

/// The places of one owner.
#[derive(Clone, Debug)]
pub(crate) struct Ring {
    pub(super) of: usize,
    pub(super) first: usize,
    /// Radius of what is left of the round bar, by place.
    outer: Vec<f64>,
    /// Radius of the bore.
    inner: Vec<f64>,
    /// The line that has changed it since its owner has looked.
    line: Option<u32>,
}

impl Ring {
    /// Of the bar as it is, between places from the first one on.
    pub(super) fn new(of: usize, first: usize, outer: Vec<f64>, inner: Vec<f64>) -> Self {
        Self { of, first, outer, inner, line: None }
    }

    /// A tool's edge was at a radius.
    pub(super) fn cut(&mut self, place: usize, radius: f64, side: Side, line: u32) {
        let Some(k) = place.checked_sub(self.first).filter(|k| *k < self.outer.len()) else {
            return;
        };
        let is_cut = match side {
            Side::External => radius < self.outer[k] - SAME_MM,
            Side::Internal => radius > self.inner[k] + SAME_MM,
        };
        if is_cut {
            match side {
                Side::External => self.outer[k] = radius.max(0.0),
                Side::Internal => self.inner[k] = radius,
            }
            self.line = Some(line);
        }
    }

    /// Outer radius and bore at each place, from the first one on.
    pub(crate) fn radii(&self) -> impl Iterator<Item = (usize, [f64; 2])> + '_ {
        let radii = self.outer.iter().zip(&self.inner);
        radii.enumerate().map(|(k, (outer, inner))| (self.first + k, [*outer, *inner]))
    }

    pub(super) const fn line(&self) -> Option<u32> {
        self.line
    }

    pub(super) const fn looked_at(&mut self) -> Option<u32> {
        self.line.take()
    }
}
