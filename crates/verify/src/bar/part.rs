//! A part of a bar as it was at some time, to be compared with what is there later.
use super::{SECTIONS, TRACE_MM, TurnedBar};
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

impl TurnedBar {
    /// What is there between two places.
    pub(crate) fn stretch(&self, places: [usize; 2]) -> BarPart {
        let [low, high] = places;
        let of = |radii: &[f64]| {
            let part = |section: usize| {
                let first = section * self.places;
                radii[first + low..=first + high].iter().copied()
            };
            (0..SECTIONS).flat_map(part).collect()
        };
        BarPart { places, outer: of(&self.outer), inner: of(&self.inner) }
    }

    /// The same bar, as a stretch of it was before: where it still is as `left` has it.
    pub(crate) fn with(&self, before: &BarPart, left: &BarPart) -> Self {
        let mut bar = Self { watched: Vec::new(), rings: Vec::new(), ..self.clone() };
        let [low, high] = before.places;
        let length = high - low + 1;
        for section in 0..SECTIONS {
            for k in 0..length {
                let (at, of) = (section * self.places + low + k, section * length + k);
                if (bar.outer[at] - left.outer[of]).abs() < TRACE_MM {
                    bar.outer[at] = before.outer[of];
                }
                if (bar.inner[at] - left.inner[of]).abs() < TRACE_MM {
                    bar.inner[at] = before.inner[of];
                }
            }
        }
        bar
    }

    /// Where later cuts have taken something off what was left, in any section: by place.
    pub(crate) fn is_changed(&self, left: &BarPart) -> Vec<bool> {
        let [low, high] = left.places;
        let length = high - low + 1;
        let changed = |k: usize| {
            (0..SECTIONS).any(|section| {
                let (at, of) = (section * self.places + low + k, section * length + k);
                left.outer[of] - self.outer[at] > TRACE_MM
                    || self.inner[at] - left.inner[of] > TRACE_MM
            })
        };
        (0..length).map(changed).collect()
    }
}
