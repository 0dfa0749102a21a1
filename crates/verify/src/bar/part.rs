//! A part of a bar as it was at some time, to be compared with what is there later.
use crate::insert::Side;

/// Material about the axis between two places, in all sections.
#[derive(Clone, Debug)]
pub(crate) struct BarPart {
    pub(super) places: [usize; 2],
    pub(super) outer: Vec<f64>,
    pub(super) inner: Vec<f64>,
}

impl BarPart {
    /// First and last place.
    pub(crate) const fn places(&self) -> [usize; 2] {
        self.places
    }

    /// Heights in the first section, by place.
    pub(crate) fn heights(&self, side: Side) -> Vec<f64> {
        let length = self.places[1] - self.places[0] + 1;
        match side {
            Side::External => self.outer[..length].to_vec(),
            Side::Internal => self.inner[..length].iter().map(|radius| -radius).collect(),
        }
    }
}
