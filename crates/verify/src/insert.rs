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
use canon::{Insert, InsertEdges, InsertPoint, Tool, ToolKind};
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
        let usual = Insert::threading(HALF_ANGLE * 2.0, None, None);
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

    /// How far from the middle its flanks are apart so far behind its point: without the edge that
    /// cuts the crest.
    pub(crate) fn flanks(&self, rise: f64) -> f64 {
        let rise = self.crest.map_or(rise, |crest| rise.min(crest)).max(0.0);
        ((rise + self.below) * self.tan).max(self.nose * self.half.in_rad().cos())
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

/// A turning tool's nose where the table does not state one (estimate: the usual one for
/// finishing).
const USUAL_NOSE: Length = Length::mm(0.4);
/// Pitch for which an insert for threads is taken whose point is not stated, where it cuts none.
const NO_PITCH: f64 = 1.0;

/// What a tool has beside its programmed point, whichever way it moves.
///
/// ```text
///   Corner      leading    ╲      ╱ trailing        distance from the nose's middle along each edge's normal is the
///               (chuck)     ╲_  _╱                   nose radius: on an edge at the angle κ to the axis
///                             ╰╯                     rise = R + (d·sin κ − R)/cos κ
///   Square                  │____│
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outline {
    /// A nose and two edges.
    Corner {
        nose: f64,
        /// Angles of the leading and the trailing edge to the axis, rad.
        edges: [f64; 2],
        length: f64,
        /// Z of the nose's middle from the programmed point; its lowest place above that point.
        middle: [f64; 2],
        /// +1: the trailing edge lies towards +Z; −1: towards −Z.
        trails: f64,
    },
    /// A flat edge between two Z from the programmed point.
    Square([f64; 2]),
    /// The profile of a thread.
    Profile(Form),
}

impl Outline {
    /// Of a tool that turns; `None` of one that does not, or that points along the axis.
    pub(crate) fn of(tool: Option<&Tool>) -> Option<Self> {
        let insert = match tool.map(|tool| &tool.kind) {
            Some(ToolKind::Insert(insert)) => *insert,
            Some(ToolKind::Other) => Insert::turning(Angle::deg(80.0), USUAL_NOSE),
            _ => return None,
        };
        let along = insert.orientation.map_or(-1.0, |o| f64::from(o.along()));
        let is_axial = insert.orientation.is_some_and(canon::InsertOrientation::is_axial);
        match insert.edges {
            InsertEdges::Profile if is_axial => None,
            InsertEdges::Profile => {
                Some(Self::Profile(Form::new(&insert, NO_PITCH, Side::External)))
            }
            InsertEdges::Square => {
                let width = match insert.point {
                    Some(InsertPoint::Flat(width)) => width.value(),
                    _ => 0.0,
                };
                let from = -width * (1.0 + along) / 2.0;
                Some(Self::Square([from, from + width]))
            }
            InsertEdges::Corner { approach, length } => {
                let nose = match insert.point {
                    Some(InsertPoint::Nose(radius)) => radius.value(),
                    _ => 0.0,
                };
                let behind = Angle::deg(180.0) - approach - insert.angle;
                let is_middle = insert.orientation.is_some_and(canon::InsertOrientation::is_middle);
                let sunk = if is_middle || is_axial { -nose } else { 0.0 };
                Some(Self::Corner {
                    nose,
                    edges: [approach.in_rad(), behind.in_rad()],
                    length: length.value(),
                    middle: [-along * nose, sunk],
                    trails: if along > 0.0 { -1.0 } else { 1.0 },
                })
            }
        }
    }

    /// Z from the programmed point between which it can cut material that stands so high over it.
    pub(crate) fn reach(&self, room: f64) -> [f64; 2] {
        match self {
            Self::Corner { nose, length, middle, .. } => {
                let far = nose + length;
                [middle[0] - far, middle[0] + far]
            }
            Self::Square(ends) => *ends,
            Self::Profile(form) => {
                let reach = form.reach(room.max(0.0));
                [-reach, reach]
            }
        }
    }

    /// How far its edge lies behind its programmed point, so far along Z from it; `None`: it has
    /// none there.
    pub(crate) fn rise(&self, d: f64) -> Option<f64> {
        match *self {
            Self::Square([low, high]) => (low..=high).contains(&d).then_some(0.0),
            Self::Profile(form) => Some(form.rise(d.abs())),
            Self::Corner { nose, edges, length, middle, trails } => {
                let from_middle = (d - middle[0]) * trails;
                let edge = edges[usize::from(from_middle > 0.0)];
                let away = from_middle.abs();
                let (sin, cos) = edge.sin_cos();
                let leaves = if cos > 0.0 { nose * sin } else { nose };
                let rise = if away <= leaves {
                    nose - (nose * nose - away * away).sqrt()
                } else if cos > 0.0 && away <= nose * sin + length * cos {
                    nose + (away * sin - nose) / cos
                } else {
                    return None;
                };
                Some(rise + middle[1])
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn insert(point: Option<InsertPoint>) -> Insert {
        Insert::threading(Angle::deg(60.0), point, None)
    }

    fn outline(insert: Insert) -> Outline {
        let tool = Tool {
            number: 1,
            pocket: 1,
            length: Length::ZERO,
            diameter: Length::ZERO,
            kind: ToolKind::Insert(insert),
            description: String::new(),
            wear: canon::ToolWear::default(),
            life: canon::ToolLife::default(),
            body: canon::Body::default(),
            stand_in: false,
        };
        Outline::of(Some(&tool)).expect("it turns")
    }

    #[test]
    fn a_turning_insert_has_nothing_before_its_point_and_five_degrees_behind_it() {
        let outline = outline(Insert::turning(Angle::deg(80.0), Length::mm(0.4)));
        assert_eq!(outline.rise(-0.01), None);
        assert!(outline.rise(0.4).unwrap().abs() < 1e-12);
        let rise = |d: f64| outline.rise(d).unwrap();
        assert!(((rise(6.0) - rise(2.0)) / 4.0 - 5_f64.to_radians().tan()).abs() < 1e-9);
        assert_eq!(outline.rise(13.0), None);
        let meet = 0.4 + 0.4 * 5_f64.to_radians().sin();
        assert!((rise(meet - 1e-9) - rise(meet + 1e-9)).abs() < 1e-8, "no step");
    }

    #[test]
    fn orientation_mirrors_a_turning_insert_and_moves_a_grooving_one() {
        let turned = |number| {
            let orientation = canon::InsertOrientation::new(number);
            outline(Insert { orientation, ..Insert::turning(Angle::deg(55.0), Length::mm(0.8)) })
        };
        for d in [0.0, 0.3, 1.0, 4.0] {
            assert_eq!(turned(3).rise(d), turned(4).rise(-d), "{d}");
        }
        assert!((turned(9).rise(0.0).unwrap() + 0.8).abs() < 1e-12, "by the nose's middle");
        let groove = |number| {
            let orientation = canon::InsertOrientation::new(number);
            outline(Insert { orientation, ..Insert::grooving(Length::mm(3.0)) }).reach(1.0)
        };
        assert_eq!([groove(3), groove(8), groove(4)], [[0.0, 3.0], [-1.5, 1.5], [-3.0, 0.0]]);
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
