//! How near to the axis tools have come since something was cut there that turns with the work and
//! is not round, such as a polygon: its owner compares that with its own form.
use super::{SECTIONS, TurnedBar};
use crate::insert::Side;
use std::f64::consts::TAU;

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

impl TurnedBar {
    /// Notes from now on how near to the axis tools come between two Z; as the bar is there now.
    pub(crate) fn ring(&mut self, of: usize, heights: [f64; 2]) {
        let [first, last] = self.places_between(heights);
        let inner = |place: usize| {
            let all = (0..SECTIONS).map(|section| self.inner[section * self.places + place]);
            all.fold(0.0, f64::max)
        };
        let bore = (first..=last).map(inner).collect();
        self.rings.push(Ring::new(of, first, self.round[first..=last].to_vec(), bore));
    }

    /// How near tools came since, and the line that did so last, if that was not looked at.
    pub(crate) fn ring_of(&self, of: usize) -> Option<(&Ring, Option<u32>)> {
        self.rings.iter().find(|ring| ring.of == of).map(|ring| (ring, ring.line()))
    }

    /// At a place no more is left than reaches to a radius, by the angle in the work, rad.
    pub(crate) fn limit(&mut self, place: usize, radius: impl Fn(f64) -> f64) {
        for section in 0..SECTIONS {
            let angle = section as f64 / SECTIONS as f64 * TAU;
            let outer = &mut self.outer[section * self.places + place];
            *outer = outer.min(radius(angle));
        }
    }

    /// It was looked at.
    pub(crate) fn looked_at(&mut self, of: usize) {
        if let Some(ring) = self.rings.iter_mut().find(|ring| ring.of == of) {
            ring.looked_at();
        }
    }

    /// Nothing is noted of it any more.
    pub(crate) fn unring(&mut self, of: usize) {
        self.rings.retain(|ring| ring.of != of);
    }

    /// Tools came near where that is noted, and no one has looked.
    pub(crate) fn is_ring_cut(&self) -> bool {
        self.rings.iter().any(|ring| ring.line().is_some())
    }
}
