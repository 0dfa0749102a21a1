//! The form of an insert of a lathe, in the plane of the work's axis.
//!
//! ```text
//!      rise
//!       │      ╲        │         ╱        d       distance along the axis from the middle of the point
//!       │       ╲       │        ╱         rise(d) = d/tan a − R·(1/sin a − 1)    on the flank, half angle a, nose R
//!       │        ╲___   │    ___╱                  = R − √(R² − d²)               on the nose, d ≤ R·cos a
//!       └────────────╲──┴──╱──────► d              = (d − f/2)/tan a              beside a flat f
//! ```
//!
//! A full profile ends at the edge that cuts the crest, which reaches a little over the crest's
//! middle. Where the tool table does not state the point it is taken from the design profiles of
//! ISO 68-1: outside a root rounded with H/6 = 0.1443·P, inside with H/12 = 0.0722·P.
use canon::{Insert, InsertPoint, Tool, ToolKind};
use units::{Angle, Length};

/// Height of the fundamental triangle, in pitches.
pub(crate) const TRIANGLE: f64 = 0.866_025_403_784_438_6;
/// Half angle of metric and unified threads.
const HALF_ANGLE: Angle = Angle::deg(30.0);
/// How far the edge that cuts the crest reaches beyond the flanks, as a share of the width there.
const OVER_THE_CREST: f64 = 0.3;
/// Whether material outside or inside the tool's point is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// A shaft: the insert points towards the axis.
    External,
    /// A bore: it points away from it.
    Internal,
}

/// What an insert leaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Form {
    half: Angle,
    tan: f64,
    nose: f64,
    /// Half of the flat.
    flat: f64,
    /// How far the straight flanks' lines lie below the point at its middle.
    below: f64,
    crest: Option<f64>,
    /// The table does not state the point.
    assumed: bool,
}

impl Form {
    /// Of an insert; where its point is not stated, of a thread of this pitch.
    pub(crate) fn new(insert: &Insert, pitch: f64, side: Side) -> Self {
        let by_standard = match side {
            Side::External => TRIANGLE / 6.0,
            Side::Internal => TRIANGLE / 12.0,
        };
        let point = insert.point.unwrap_or(InsertPoint::Nose(Length::mm(by_standard * pitch)));
        let half = insert.angle * 0.5;
        let (sin, tan) = (half.in_rad().sin(), half.in_rad().tan());
        let (nose, flat) = match point {
            InsertPoint::Nose(radius) => (radius.value(), 0.0),
            InsertPoint::Flat(width) => (0.0, width.value() / 2.0),
        };
        Self {
            half,
            tan,
            nose,
            flat,
            below: nose * (1.0 / sin - 1.0) + flat / tan,
            crest: insert.crest_height.map(Length::value),
            assumed: insert.point.is_none(),
        }
    }

    /// Of the tool in a threading pass. A tool that the table does not describe is taken for an
    /// insert of 60°.
    pub(crate) fn of_thread(tool: Option<&Tool>, pitch: f64, side: Side) -> Self {
        let usual = Insert { angle: HALF_ANGLE * 2.0, point: None, crest_height: None };
        match tool.map(|tool| &tool.kind) {
            Some(ToolKind::Insert(insert)) => Self::new(insert, pitch, side),
            _ => Self::new(&usual, pitch, side),
        }
    }

    /// How far its edge lies behind its point, so far from the middle.
    pub(crate) fn rise(&self, d: f64) -> f64 {
        let flank = d / self.tan - self.below;
        let edge = if d <= self.nose * self.half.in_rad().cos() {
            self.nose - (self.nose * self.nose - d * d).sqrt()
        } else {
            flank.max(0.0)
        };
        self.crest.map_or(edge, |crest| edge.min(crest))
    }

    /// How far from the middle its edge is at most so far behind its point.
    pub(crate) fn reach(&self, rise: f64) -> f64 {
        let flank = |rise: f64| (rise + self.below) * self.tan;
        match self.crest {
            Some(crest) if rise >= crest => flank(crest) * (1.0 + OVER_THE_CREST),
            _ => flank(rise).max(self.nose * self.half.in_rad().cos()),
        }
    }

    /// Half of the angle between its flanks.
    pub(crate) const fn half_angle(&self) -> Angle {
        self.half
    }

    /// It has the flanks of a metric or unified thread.
    pub(crate) fn has_60_degrees(&self) -> bool {
        (self.half - HALF_ANGLE).in_deg().abs() < 0.26 // half a degree of the whole angle (ISO 965-1 tolerates none: gauges)
    }

    /// For people: "60°, nose 0.217 mm by ISO 68-1 (not stated)".
    pub(crate) fn in_words(&self) -> String {
        let angle = self.half.in_deg() * 2.0;
        let point = if self.flat > 0.0 {
            format!("flat {:.3} mm", self.flat * 2.0)
        } else {
            format!("nose {:.3} mm", self.nose)
        };
        let by = if self.assumed { " by ISO 68-1, the tool table states none" } else { "" };
        let crest = self
            .crest
            .map_or_else(String::new, |crest| format!(", full profile {crest:.3} mm high"));
        format!("{angle:.0}°, {point}{by}{crest}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn insert(point: Option<InsertPoint>) -> Insert {
        Insert { angle: Angle::deg(60.0), point, crest_height: None }
    }

    #[test]
    fn nose_and_flank_meet_without_a_step_and_the_flank_has_its_slope() {
        let form =
            Form::new(&insert(Some(InsertPoint::Nose(Length::mm(0.2)))), 1.5, Side::External);
        let meet = 0.2 * 30_f64.to_radians().cos();
        assert!((form.rise(meet - 1e-9) - form.rise(meet + 1e-9)).abs() < 1e-8);
        assert!((form.rise(meet) - 0.1).abs() < 1e-9, "R·(1 − sin a)");
        assert!(((form.rise(0.6) - form.rise(0.5)) / 0.1 - 3.0_f64.sqrt()).abs() < 1e-9);
        for rise in [0.12, 0.5, 0.9] {
            assert!((form.rise(form.reach(rise)) - rise).abs() < 1e-12);
        }
    }

    #[test]
    fn a_point_that_is_not_stated_is_the_root_of_iso_68_1() {
        // its V is P/4 wide where the basic minor diameter is, H/4 above the sharp vertex
        let form = Form::new(&insert(None), 1.5, Side::External);
        let h = TRIANGLE * 1.5;
        assert!((2.0 * form.reach(h / 12.0) - 1.5 / 4.0).abs() < 1e-9);
        assert!(form.in_words().contains("nose 0.217 mm by ISO 68-1"), "{}", form.in_words());
    }
}
