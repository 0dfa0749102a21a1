//! Stored stroke check: a box that no axis may enter, or leave, from G22 to G23.
//!
//! ```text
//!          ┌───────────┐ X Y Z      inside forbidden: no point of a move lies within
//!   ──────►│  the box  │            outside forbidden: all points of a move lie within
//!          └───────────┘
//!    I J K
//! ```
//!
//! A move is a line or a helix: each coordinate is p + q·t, or c + r·cos(φ + w·t), over t from 0
//! to 1. It crosses a face of the box where the coordinate equals the face's; between two crossings
//! it is on one side of all of them, so its middles there are all that must be looked at.
//!
//! Source: Fanuc, operator's manual of series 30i, "Stored stroke check" (machine coordinates;
//! forbidden inside or outside by parameter).
use crate::{call::StrokeZone, geometry::frame::Point};
use core::f64::consts::{FRAC_PI_2, TAU};
use diag::{Diagnostic, Span};

/// Nearer than this to a face is on it, mm.
const ON_FACE_MM: f64 = 1e-6;

/// One coordinate over t from 0 to 1.
#[derive(Clone, Copy)]
pub(crate) enum Coordinate {
    /// From, and how far.
    Straight(f64, f64),
    /// Centre, radius, first angle and sweep in radians.
    Round(f64, f64, f64, f64),
}

impl Coordinate {
    fn at(self, t: f64) -> f64 {
        match self {
            Self::Straight(from, way) => from + way * t,
            Self::Round(centre, radius, first, sweep) => {
                centre + radius * (first + sweep * t).cos()
            }
        }
    }

    /// Every t at which it is `face`.
    fn crossings(self, face: f64, all: &mut Vec<f64>) {
        match self {
            Self::Straight(from, way) if way != 0.0 => all.push((face - from) / way),
            Self::Round(centre, radius, first, sweep) if radius > 0.0 && sweep != 0.0 => {
                let cos = (face - centre) / radius;
                if cos.abs() > 1.0 {
                    return;
                }
                let (low, high) = (first.min(first + sweep), first.max(first + sweep));
                for angle in [cos.acos(), -cos.acos()] {
                    let mut angle = angle + ((low - angle) / TAU).ceil() * TAU;
                    while angle <= high {
                        all.push((angle - first) / sweep);
                        angle += TAU;
                    }
                }
            }
            _ => {}
        }
    }
}

impl StrokeZone {
    /// Where a move first is where it may not be.
    fn violated(&self, way: &[Coordinate; 3]) -> Option<[f64; 3]> {
        let mut all = vec![0.0, 1.0];
        for (axis, coordinate) in way.iter().enumerate() {
            for face in [self.from[axis], self.to[axis]].into_iter().filter(|f| f.is_finite()) {
                coordinate.crossings(face, &mut all);
            }
        }
        all.retain(|t| (0.0..=1.0).contains(t));
        all.sort_by(f64::total_cmp);
        let at = |t: f64| way.map(|coordinate| coordinate.at(t));
        let part = all.windows(2).find(|part| self.forbids(at(f64::midpoint(part[0], part[1]))));
        let ends = [0.0, 1.0].into_iter().find(|t| self.forbids(at(*t)));
        match (part.map(|part| part[0]), ends) {
            (Some(t), Some(end)) => Some(at(t.min(end))),
            (one, other) => one.or(other).map(at),
        }
    }

    fn forbids(&self, at: [f64; 3]) -> bool {
        let by = if self.outside { -ON_FACE_MM } else { ON_FACE_MM };
        let within = (0..3).all(|i| self.from[i] + by < at[i] && at[i] < self.to[i] - by);
        within != self.outside
    }

    /// Its sides, as people write them.
    fn sides(&self) -> String {
        let side = |i: usize| {
            let [from, to] = [self.from[i], self.to[i]].map(crate::codes::spelling::short);
            from.is_finite().then(|| format!("{} {from} to {to}", ['X', 'Y', 'Z'][i]))
        };
        (0..3).filter_map(side).collect::<Vec<_>>().join(", ")
    }
}

/// The way of a straight move.
pub(crate) fn straight(from: &Point, to: &Point) -> [Coordinate; 3] {
    core::array::from_fn(|i| Coordinate::Straight(from[i], to[i] - from[i]))
}

/// The way of an arc in the plane of these axes.
pub(crate) fn round(
    [a, b]: [usize; 2],
    (from, to): (&Point, &Point),
    centre: [f64; 2],
    sweep: f64,
) -> [Coordinate; 3] {
    let (x, y) = (from[a] - centre[0], from[b] - centre[1]);
    let (radius, first) = (x.hypot(y), y.atan2(x));
    let mut way = straight(from, to);
    way[a] = Coordinate::Round(centre[0], radius, first, sweep);
    way[b] = Coordinate::Round(centre[1], radius, first - FRAC_PI_2, sweep); // sin a = cos(a − 90°)
    way
}

/// What is wrong with a move, if it goes where the box forbids it.
pub(crate) fn refusal(zone: &StrokeZone, way: &[Coordinate; 3], span: Span) -> Option<Diagnostic> {
    let at = zone.violated(way)?;
    let [x, y, z] = at.map(|value| crate::codes::spelling::short((value * 1e3).round() / 1e3));
    let (does, which) = if zone.outside { ("leaves", "allows") } else { ("enters", "forbids") };
    let text = format!(
        "this move {does} the box that G22 {which} ({} of the machine): it may go as far as X{x} Y{y} Z{z} of the machine",
        zone.sides()
    );
    let fault = Diagnostic::error("I1057", span, text);
    Some(fault.with_help("G23 ends the check, G22 with other words sets another box"))
}

#[cfg(test)]
mod tests {
    use super::{Coordinate::*, *};

    const BOX: StrokeZone =
        StrokeZone { from: [0.0, 0.0, -10.0], to: [10.0, 10.0, 0.0], outside: false };

    fn line(from: [f64; 3], to: [f64; 3]) -> [Coordinate; 3] {
        core::array::from_fn(|i| Straight(from[i], to[i] - from[i]))
    }

    #[test]
    fn a_line_is_stopped_where_it_enters() {
        let through = line([-10.0, 5.0, -5.0], [30.0, 5.0, -5.0]);
        assert_eq!(BOX.violated(&through), Some([0.0, 5.0, -5.0]));
        assert_eq!(BOX.violated(&line([-10.0, 5.0, 0.0], [30.0, 5.0, 0.0])), None); // along a face
        assert_eq!(BOX.violated(&line([-10.0, 5.0, 5.0], [30.0, 5.0, 5.0])), None);
        // from above, over the edge and down
        assert_eq!(BOX.violated(&line([5.0, 5.0, 5.0], [5.0, 5.0, -1.0])), Some([5.0, 5.0, 0.0]));
    }

    #[test]
    fn a_line_is_stopped_where_it_leaves() {
        let zone = StrokeZone { outside: true, ..BOX };
        let out = line([5.0, 5.0, -5.0], [5.0, 25.0, -5.0]);
        assert_eq!(zone.violated(&out), Some([5.0, 10.0, -5.0]));
        assert_eq!(zone.violated(&line([0.0, 0.0, -10.0], [10.0, 10.0, 0.0])), None);
    }

    #[test]
    fn an_arc_bulges_into_the_box_between_its_ends() {
        // about X-8, radius 10, from 45° clockwise to -45°: its ends are outside, at 0° it is 2 mm
        // inside
        let quarter = core::f64::consts::FRAC_PI_4;
        let arc = |y: f64| {
            [
                Round(-8.0, 10.0, quarter, -2.0 * quarter),
                Round(y, 10.0, -quarter, -2.0 * quarter),
                Straight(-5.0, 0.0),
            ]
        };
        // sin(a) = cos(a − 90°); past X0 at 37° it is still at Y11, and comes in over Y10 at 30°
        let entered = BOX.violated(&arc(5.0)).map(|at| (at[0], at[1]));
        let x = 10.0 * (3.0_f64.sqrt() / 2.0) - 8.0;
        assert!(entered.is_some_and(|at| (at.0 - x).hypot(at.1 - 10.0) < 1e-9), "{entered:?}");
        let mut beside = arc(5.0);
        beside[0] = Round(-12.0, 10.0, quarter, -2.0 * quarter);
        assert_eq!(BOX.violated(&beside), None);
    }
}
