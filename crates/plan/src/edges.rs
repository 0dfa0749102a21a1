//! The edges of an insert in the plane of the bar's axis, as far as `check` needs them: a polygon.
//!
//! ```text
//!    rise │   ╲             ╱         corners of the polygon, by rising Z: the ends of both edges, the nose in steps
//!         │    ╲           ╱
//!         │     •..     .•            d: along Z from the programmed point
//!         └────────•─•─•──────► d
//! ```
//!
//! Where the tool table states no point it is taken to be sharp: such an insert cuts least, and
//! meets least.
use alloc::vec::Vec;
use canon::{Insert, InsertEdges, InsertPoint};
use units::Length;

/// Steps of a nose's arc.
const STEPS: u32 = 8;
/// An insert for threads is looked at so high over its point, mm.
const FLANK: f64 = 4.0;

/// Corners of an insert's edges: along Z from the programmed point, and how far behind it, mm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EdgePolygon(Vec<[f64; 2]>);

impl EdgePolygon {
    /// As it stands in the tool table.
    pub(crate) fn of(insert: &Insert) -> Self {
        let (nose, flat) = match insert.point {
            Some(InsertPoint::Nose(radius)) => (radius.value(), 0.0),
            Some(InsertPoint::Flat(width)) => (0.0, width.value()),
            None => (0.0, 0.0),
        };
        let towards = insert.orientation.map_or(-1.0, |o| f64::from(o.along()));
        match insert.edges {
            InsertEdges::Square => {
                let from = -flat * (1.0 + towards) / 2.0;
                Self([from, from + flat].map(|d| [d, 0.0]).to_vec())
            }
            InsertEdges::Profile => {
                let steep = core::f64::consts::FRAC_PI_2 - insert.angle.in_rad() / 2.0;
                let high = insert.crest_height.map_or(FLANK, Length::value);
                let side = side_of(nose, steep, high / libm::sin(steep));
                Self::joined(&side, &side, [flat / 2.0, flat / 2.0], [0.0, 0.0])
            }
            InsertEdges::Corner { approach, length } => {
                let leads = approach.in_rad();
                let trails = core::f64::consts::PI - leads - insert.angle.in_rad();
                let [leading, trailing] =
                    [leads, trails].map(|angle| side_of(nose, angle, length.value()));
                let is_middle = insert.orientation.is_some_and(|o| o.is_middle() || o.is_axial());
                let moved = [-towards * nose, if is_middle { -nose } else { 0.0 }];
                if towards > 0.0 {
                    Self::joined(&trailing, &leading, [0.0; 2], moved)
                } else {
                    Self::joined(&leading, &trailing, [0.0; 2], moved)
                }
            }
        }
    }

    /// The side towards the chuck and that towards the free end, each so far from the middle.
    fn joined(
        chuck: &[[f64; 2]],
        free: &[[f64; 2]],
        apart: [f64; 2],
        [along, up]: [f64; 2],
    ) -> Self {
        let left = chuck.iter().rev().map(|[d, rise]| [-d - apart[0], *rise]);
        let right = free.iter().map(|[d, rise]| [d + apart[1], *rise]);
        Self(left.chain(right).map(|[d, rise]| [d + along, rise + up]).collect())
    }

    /// Along Z from the programmed point, where they begin and end.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.0.first(), self.0.last()].map(|corner| corner.map_or(0.0, |corner| corner[0]))
    }

    /// Least distance behind the programmed point; below zero where that is the nose's middle.
    pub(crate) fn lowest(&self) -> f64 {
        self.0.iter().map(|[_, rise]| *rise).fold(f64::INFINITY, f64::min)
    }

    /// Least distance behind the programmed point between two places along Z; `None`: there is no
    /// edge.
    pub(crate) fn least(&self, [from, to]: [f64; 2]) -> Option<f64> {
        let [first, last] = self.ends();
        if to < first || from > last {
            return None;
        }
        let ends = [self.at(from.max(first)), self.at(to.min(last))];
        let between = self.0.iter().filter(|[d, _]| (from..=to).contains(d)).map(|[_, rise]| *rise);
        ends.into_iter().chain(between).reduce(f64::min)
    }

    /// How far behind the programmed point it is at a place between its ends.
    fn at(&self, d: f64) -> f64 {
        let on = self.0.windows(2).find(|pair| (pair[0][0]..=pair[1][0]).contains(&d));
        on.map_or(0.0, |pair| {
            let [[a, low], [b, high]] = [pair[0], pair[1]];
            if b > a { low + (high - low) * (d - a) / (b - a) } else { low.min(high) }
        })
    }
}

/// From the lowest place of a nose outwards: its arc, and the edge that leaves it at this angle to
/// the axis.
fn side_of(nose: f64, angle: f64, length: f64) -> Vec<[f64; 2]> {
    let last = angle.clamp(0.0, core::f64::consts::FRAC_PI_2);
    let arc = (0..=STEPS).map(|k| {
        let at = last * f64::from(k) / f64::from(STEPS);
        [nose * libm::sin(at), nose * (1.0 - libm::cos(at))]
    });
    let mut side: Vec<[f64; 2]> = arc.collect();
    if angle < core::f64::consts::FRAC_PI_2
        && let Some([d, rise]) = side.last().copied()
    {
        side.push([d + length * libm::cos(angle), rise + length * libm::sin(angle)]);
    }
    side
}

#[cfg(test)]
mod tests {
    use super::*;
    use canon::InsertOrientation;
    use units::Angle;

    fn edges(insert: Insert, number: Option<u8>) -> EdgePolygon {
        let orientation = number.and_then(InsertOrientation::new);
        EdgePolygon::of(&Insert { orientation, ..insert })
    }

    #[test]
    fn a_turning_insert_cuts_nothing_on_the_side_of_the_chuck() {
        let edges = edges(Insert::turning(Angle::deg(80.0), Length::mm(0.8)), None);
        assert!(edges.ends()[0].abs() < 1e-9, "{:?}", edges.ends());
        assert!(edges.least([0.8, 0.8]).unwrap().abs() < 1e-9);
        let behind = edges.least([6.8, 6.8]).unwrap() - edges.least([4.8, 4.8]).unwrap();
        assert!((behind / 2.0 - 5_f64.to_radians().tan()).abs() < 1e-9, "5 degrees behind it");
        assert_eq!(edges.least([-1.0, -0.2]), None);
    }

    #[test]
    fn orientation_turns_a_turning_insert_over_and_moves_a_grooving_one() {
        let of = |number| edges(Insert::turning(Angle::deg(55.0), Length::mm(0.4)), Some(number));
        for d in [0.1, 0.4, 2.0, 5.0] {
            let (near, far) = (of(3).least([d, d]).unwrap(), of(4).least([-d, -d]).unwrap());
            assert!((near - far).abs() < 1e-12, "{d}");
        }
        let groove = |number| edges(Insert::grooving(Length::mm(3.0)), number).ends();
        assert_eq!(
            [groove(None), groove(Some(8)), groove(Some(4))],
            [[0.0, 3.0], [-1.5, 1.5], [-3.0, 0.0]]
        );
    }

    #[test]
    fn a_thread_insert_is_as_wide_as_its_flanks_are_apart() {
        let insert = Insert::threading(Angle::deg(60.0), None, None);
        let edges = edges(insert, None);
        let [low, high] = edges.ends();
        assert!((high - 4.0 * 30_f64.to_radians().tan()).abs() < 1e-9 && (low + high).abs() < 1e-9);
        assert!((edges.least([-1.0, -1.0]).unwrap() - 3_f64.sqrt()).abs() < 1e-9);
    }
}
