//! An insert in the plane of the bar's axis: where its edge is, and how steep.
//!
//! ```text
//!   V            d/tan a − below, the nose about its point          a   half of the angle between the flanks
//!   corner       ╲       ╱                                          κ   approach, on the leading side
//!                 ╲κ   κ'╱     R + d·tan κ − R/cos κ                κ'  180° − κ − ε, behind it
//!                  ╰───╯       the nose R between; an edge of 90° and more leaves the nose alone
//!   square       │_____│
//! ```
use units::{Angle, Length};

/// The crest's edge of a full profile reaches so much farther than the flanks there.
const OVER_THE_CREST: f64 = 1.3;

/// An insert, in the plane of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Insert {
    /// Half of the angle between its flanks.
    pub half_angle: Angle,
    /// Radius that rounds the point.
    pub nose: Length,
    /// Width of a flat point.
    pub flat: Length,
    /// From its point to the edge that cuts a thread's crest.
    pub crest_height: Option<Length>,
    /// Its edges beside the point.
    pub edges: Edges,
    /// Side of the nose on which the programmed point lies along the axis: −1 towards the chuck,
    /// +1 away from it, 0 in the middle; `None`: not stated.
    pub along: Option<i8>,
    /// The programmed point is the middle of the nose across the axis, too.
    pub is_middle: bool,
    /// It points along the axis, into the face; `None`: not stated.
    pub is_axial: Option<bool>,
}

/// Edges beside the point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edges {
    /// Two flanks of the same slope.
    V,
    /// A leading and a trailing edge.
    Corner {
        /// Between the leading edge and its feed along the axis.
        approach: Angle,
        /// Between the trailing edge and the axis.
        trailing: Angle,
        /// Of each edge.
        length: Length,
    },
    /// Sides at a right angle to the edge.
    Square,
}

impl Edges {
    /// A corner of this angle that leads with 95°, with edges of 12 mm.
    pub fn corner(degrees: f64) -> Self {
        let [approach, trailing] = [95.0, 85.0 - degrees].map(Angle::deg);
        Self::Corner { approach, trailing, length: Length::mm(12.0) }
    }
}

impl Insert {
    /// How far the edge lies behind the point, and its slope, so far along the axis from it.
    pub(super) fn edge(&self, d: f64) -> Option<(f64, f64)> {
        match self.edges {
            Edges::V => self.flank(d),
            Edges::Square => {
                let [low, high] = self.flat_ends();
                (low..=high).contains(&d).then_some((0.0, 0.0))
            }
            Edges::Corner { approach, trailing, length } => {
                let nose = self.nose.value();
                let along = f64::from(self.along.unwrap_or(-1));
                let way = if along > 0.0 { -1.0 } else { 1.0 };
                // behind the middle of the nose
                let behind = (d + along * nose) * way;
                let angle = if behind < 0.0 { approach } else { trailing };
                let (rise, slope) = beside(behind.abs(), angle, nose, length.value())?;
                let sunk = if self.is_middle { nose } else { 0.0 };
                Some((rise - sunk, slope * behind.signum() * way))
            }
        }
    }

    /// Along the axis from the point, the ends of a square edge.
    fn flat_ends(&self) -> [f64; 2] {
        let width = self.flat.value();
        match self.along {
            Some(0) => [-width / 2.0, width / 2.0],
            Some(1) => [-width, 0.0],
            _ => [0.0, width],
        }
    }

    /// The edge of a V.
    pub(super) fn flank(&self, d: f64) -> Option<(f64, f64)> {
        let nose = self.nose.value();
        let (sin, cos) = (self.half_angle.in_rad().sin(), self.half_angle.in_rad().cos());
        let tan = sin / cos;
        let away = d.abs();
        let below = nose * (1.0 / sin - 1.0) + self.flat.value() / 2.0 / tan;
        let (rise, slope) = if away <= nose * cos {
            round(away, nose)
        } else {
            let flank = away / tan - below;
            if flank > 0.0 { (flank, 1.0 / tan) } else { (0.0, 0.0) }
        };
        match self.crest_height.map(Length::value) {
            Some(crest) if away > OVER_THE_CREST * (crest + below) * tan => None,
            Some(crest) if rise >= crest => Some((crest, 0.0)),
            _ => Some((rise, slope * d.signum())),
        }
    }

    /// How far along the axis the edge reaches, to each side, at most so far behind its point.
    pub(super) fn reach(&self, rise: f64) -> f64 {
        if self.edges != Edges::V {
            return self.widest();
        }
        let (sin, tan) = (self.half_angle.in_rad().sin(), self.half_angle.in_rad().tan());
        let below = self.nose.value() * (1.0 / sin - 1.0) + self.flat.value() / 2.0 / tan;
        let least = self.nose.value();
        match self.crest_height.map(Length::value) {
            Some(crest) if rise >= crest => OVER_THE_CREST * (crest + below) * tan,
            _ => ((rise + below) * tan).max(least),
        }
    }

    /// How far from its point it can touch the bar's face, mm.
    pub(super) fn widest(&self) -> f64 {
        match self.edges {
            Edges::V => 12.0,
            Edges::Square => self.flat.value(),
            Edges::Corner { length, .. } => length.value() + 2.0 * self.nose.value(),
        }
    }
}

/// A nose, so far from its middle: how far it lies behind its lowest place, and its slope.
fn round(away: f64, nose: f64) -> (f64, f64) {
    let down = (nose * nose - away * away).max(0.0).sqrt();
    (nose - down, away / down.max(1e-9))
}

/// A nose that goes over into an edge at this angle to the axis.
fn beside(away: f64, angle: Angle, nose: f64, length: f64) -> Option<(f64, f64)> {
    let (sin, cos) = (angle.in_rad().sin(), angle.in_rad().cos());
    if cos <= 1e-9 {
        return (away <= nose).then(|| round(away, nose));
    }
    if away <= nose * sin {
        return Some(round(away, nose));
    }
    let slope = sin / cos;
    (away <= nose * sin + length * cos).then(|| (nose + away * slope - nose / cos, slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(edges: Edges, along: Option<i8>) -> Insert {
        Insert {
            half_angle: Angle::deg(40.0),
            nose: Length::mm(0.4),
            flat: Length::ZERO,
            crest_height: None,
            edges,
            along,
            is_middle: false,
            is_axial: None,
        }
    }

    #[test]
    fn a_corner_stands_at_its_point_towards_the_chuck_and_rises_away_from_it() {
        let insert = turning(Edges::corner(80.0), None);
        assert!(insert.edge(-0.01).is_none(), "nothing lies before its point");
        assert!(insert.edge(0.4).unwrap().0.abs() < 1e-12, "the lowest place of the nose");
        // 5° behind it
        let (near, far) = (insert.edge(2.0).unwrap(), insert.edge(5.0).unwrap());
        assert!(((far.0 - near.0) / 3.0 - 5_f64.to_radians().tan()).abs() < 1e-9);
        assert!(insert.edge(13.0).is_none());
    }

    #[test]
    fn a_corner_that_points_to_the_free_end_is_its_mirror_image() {
        let [near, far] = [Some(-1), Some(1)].map(|along| turning(Edges::corner(55.0), along));
        for d in [0.0, 0.2, 0.4, 0.9, 3.0] {
            let ((a, up), (b, down)) = (near.edge(d).unwrap(), far.edge(-d).unwrap());
            assert!((a - b).abs() < 1e-12 && (up + down).abs() < 1e-9, "{d}");
        }
    }

    #[test]
    fn nose_and_edges_meet_without_a_step() {
        let edges = Edges::Corner {
            approach: Angle::deg(45.0),
            trailing: Angle::deg(45.0),
            length: Length::mm(9.0),
        };
        let insert = turning(edges, Some(0));
        let meet = 0.4 * 45_f64.to_radians().sin();
        for side in [-1.0, 1.0] {
            let at = |d: f64| insert.edge(side * d).unwrap().0;
            assert!((at(meet - 1e-9) - at(meet + 1e-9)).abs() < 1e-8);
            assert!((at(2.0) - at(1.0) - 1.0).abs() < 1e-9, "45°");
        }
    }

    #[test]
    fn a_square_edge_lies_on_the_side_that_its_orientation_says() {
        let width = Length::mm(3.0);
        for (along, inside, outside) in
            [(None, 2.9, -0.1), (Some(0), -1.4, 1.6), (Some(1), -2.9, 0.1)]
        {
            let insert = Insert { flat: width, ..turning(Edges::Square, along) };
            assert!(insert.edge(inside).is_some() && insert.edge(outside).is_none(), "{along:?}");
        }
    }
}
