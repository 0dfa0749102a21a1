//! The face of a bar under an insert that points along its axis: threads in a face.
//!
//! ```text
//!      z │     tip at radius r              heights by column and radius, as the turns before have left them
//!   face │ ──╮  ╱╲  ╭────────               the edge lies `rise` above the tip, so far across from it
//!        │   ╰─╯  ╰─╯
//!        └──────────────────► r             the chip stands along the axis, its force pushes the tool off the face
//! ```
use super::insert::{Edges, Insert};
use super::{ACROSS, COLUMNS, Kienzle};

/// Distance of places across the face, mm.
const STEP_MM: f64 = 0.02;
/// Places across the face at most.
const MOST_PLACES: usize = 10_000;

/// Forces of an insert that cuts: along the cut, away from the axis, along it, N.
pub(super) type Forces = [f64; 3];

/// Heights of the face by column and radius.
#[derive(Clone, Debug)]
pub(super) struct Face {
    step: f64,
    places: usize,
    heights: Vec<f32>,
}

impl Face {
    /// Of a bar of this radius, by the height of its material at a column and a radius.
    pub(super) fn new(radius: f64, height: impl Fn(usize, f64) -> f64) -> Self {
        let places = ((radius / STEP_MM) as usize + 1).min(MOST_PLACES);
        let step = radius / places as f64;
        let at = |index: usize| height(index / places, ((index % places) as f64 + 0.5) * step);
        let heights = (0..COLUMNS * places).map(|index| at(index) as f32).collect();
        Self { step, places, heights }
    }

    /// The edge at each place that the insert can reach.
    fn edge(&self, radius: f64, insert: &Insert) -> impl Iterator<Item = (usize, f64, f64)> {
        let reach = insert.reach(insert.widest());
        let place = |r: f64| (r / self.step - 0.5).max(0.0);
        let first = place(radius - reach).ceil() as usize;
        let last = (place(radius + reach).floor() as usize + 1).min(self.places);
        let (step, insert) = (self.step, *insert);
        (first.min(last)..last).filter_map(move |place| {
            let d = (place as f64 + 0.5) * step - radius;
            let (rise, slope) =
                if insert.edges == Edges::V { insert.flank(d) } else { insert.edge(d) }?;
            Some((place, rise, slope))
        })
    }

    /// The tip has passed a column.
    pub(super) fn cut(&mut self, column: usize, radius: f64, z: f64, insert: &Insert) {
        let edge: Vec<_> = self.edge(radius, insert).collect();
        for (place, rise, _) in edge {
            let height = &mut self.heights[column * self.places + place];
            *height = height.min((z + rise) as f32);
        }
    }

    /// Forces of the chip that stands before the edge in a column.
    pub(super) fn forces(
        &self,
        column: usize,
        (radius, z): (f64, f64),
        insert: &Insert,
        law: &Kienzle,
    ) -> Forces {
        let (mut main, mut outward, mut along) = (0.0, 0.0, 0.0);
        for (place, rise, slope) in self.edge(radius, insert) {
            let thick = f64::from(self.heights[column * self.places + place]) - (z + rise);
            if thick <= 0.0 {
                continue;
            }
            let across = 1.0 / slope.mul_add(slope, 1.0).sqrt();
            let force = law.at(thick * across) * thick * self.step;
            main += force;
            along += ACROSS * force * across;
            outward -= ACROSS * force * across * slope;
        }
        [main, outward, along]
    }
}
