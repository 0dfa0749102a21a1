//! Places of the workpiece: bores and tapped threads, each with the line that has made it.
use super::cut::{ToolCut, apart};
use crate::hole::SAME_HOLE;
use crate::milling::Cutter;
use units::Length;

/// Less than this is the noise of axes and the rounding of programs, mm.
pub(super) const NOISE_MM: f64 = 0.01;

/// A hole that a drill or an end mill has made, or a spot drill's cone.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
pub(crate) struct Bore {
    /// Across the tool.
    pub(crate) at: [Length; 2],
    /// Diameter of the tool that made it.
    pub(crate) diameter: Length,
    /// Coordinate of the *tip* to which the diameter is full.
    pub(crate) bottom_mm: f64,
    pub(super) cut: ToolCut,
    pub(super) is_spot: bool,
    /// Where its cylinder begins, coordinate.
    pub(super) top_mm: f64,
    /// First op of its feature; `None`: it is none.
    pub(super) op: Option<u32>,
    /// A cycle has made it.
    pub(super) is_ordered: bool,
    pub(super) line: u32,
    pub(super) rotary: [f64; 3],
    pub(super) is_broken_into: bool,
    /// It was there before, as deep: its drill met nothing.
    pub(super) is_found_made: bool,
}

impl Bore {
    /// Another hole is part of this one: in the same place, as wide, and no deeper.
    pub(super) fn stands_for(&self, other: &Self) -> bool {
        const SAME: Length = Length::um(1.0);
        let is_near = |a: Length, b: Length| (a - b).abs() <= SAME;
        is_near(self.at[0], other.at[0])
            && is_near(self.at[1], other.at[1])
            && is_near(self.diameter, other.diameter)
            && self.bottom_mm <= other.bottom_mm + SAME.value()
            && self.is_spot == other.is_spot
            && same_side(self.rotary, other.rotary)
    }

    /// The form that has made it.
    pub(crate) const fn cutter(&self) -> Cutter {
        self.cut.cutter
    }

    /// Coordinate of its deepest point.
    pub(crate) const fn tip_mm(&self) -> f64 {
        self.cut.tip_mm
    }

    pub(super) const fn radius(&self) -> f64 {
        self.cut.cutter.radius
    }

    /// It has the same axis as this place.
    pub(super) fn is_about(&self, at: [f64; 2]) -> bool {
        apart(self.cut.at, at) <= SAME_HOLE.value()
    }

    /// Length over which its cylinder lies beside that of another radius, if the two break into one
    /// another: neither has the other's axis, and neither lies within the other.
    pub(super) fn breaks_into(
        &self,
        at: [f64; 2],
        radius: f64,
        [top, bottom]: [f64; 2],
    ) -> Option<f64> {
        let (apart, own) = (apart(self.cut.at, at), self.radius());
        let meet = apart < own + radius - NOISE_MM;
        let is_within = apart + own.min(radius) <= own.max(radius) + NOISE_MM;
        let beside = self.top_mm.min(top) - self.bottom_mm.max(bottom);
        let is_one = self.is_spot || is_within || self.is_about(at);
        (meet && !is_one && beside > NOISE_MM).then_some(beside)
    }
}

/// A tapped thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct TappedPlace {
    pub(crate) at: [f64; 2],
    /// Radii between which its flanks are: the largest bore allowed, and nominal.
    pub(crate) ring: [f64; 2],
    pub(crate) pitch_mm: f64,
    /// Its pitch, negative for a left-hand thread.
    pub(crate) advance_mm: f64,
    /// Coordinates between which it has its full form.
    pub(crate) top_mm: f64,
    pub(crate) bottom_mm: f64,
    /// Zero of the work that its program means: what stands above it is to be faced off.
    pub(crate) zero_mm: f64,
    /// Coordinate of the tip at the spindle's angle zero; `None`: too little was cut to know.
    pub(crate) phase_mm: Option<f64>,
    /// How far another tap of its size may stand off its groove before the No-go gauge enters.
    pub(crate) play_mm: f64,
    /// First ops of the features that are this thread.
    pub(crate) ops: Vec<u32>,
    pub(crate) line: u32,
    pub(crate) rotary: [f64; 3],
    /// Where mills have cut into it: first line, lowest coordinate, and whether the form of all of
    /// them is known.
    pub(crate) hit: Option<(u32, f64, bool)>,
    pub(crate) is_destroyed: bool,
}

impl TappedPlace {
    /// Coordinate down to which a cut takes nothing of what was ordered.
    pub(super) fn ordered_top_mm(&self) -> f64 {
        let is_within = self.zero_mm > self.bottom_mm && self.zero_mm < self.top_mm;
        if is_within { self.zero_mm } else { self.top_mm }
    }

    pub(super) fn full_mm(&self) -> f64 {
        (self.top_mm - self.bottom_mm).max(0.0)
    }

    /// What is left of it if it is cut away down to this coordinate.
    pub(super) fn left_of(&self, level_mm: f64) -> String {
        let lost = (self.top_mm - level_mm).clamp(0.0, self.full_mm());
        let full = self.full_mm();
        if lost >= full {
            return format!("nothing is left of its {full:.2} mm of full thread");
        }
        format!(
            "{lost:.2} mm of its {full:.2} mm of full thread are gone, {:.2} mm are left",
            full - lost
        )
    }

    /// How far the flanks of another thread of the same form stand off these, along the axis;
    /// `None`: of another form, or not known.
    pub(super) fn off_groove(&self, other: &Self) -> Option<f64> {
        let is_same = (self.advance_mm - other.advance_mm).abs() < 1e-6
            && (self.ring[1] - other.ring[1]).abs() < 1e-6;
        let off = (self.phase_mm? - other.phase_mm?) / self.pitch_mm;
        is_same.then(|| (off - off.round()).abs() * self.pitch_mm)
    }
}

/// Both were cut with the rotary axes at the same place.
pub(super) fn same_side(a: [f64; 3], b: [f64; 3]) -> bool {
    const TURNED_DEG: f64 = 0.01;
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TURNED_DEG)
}
