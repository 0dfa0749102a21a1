//! What is cut, along which line or on which gear, and how its tool comes off it.
use serde::{Deserialize, Serialize, Serializer};
use units::{Angle, Lead, LeadGrowth, Length, Spin, Stiffness};

/// What the tool cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cut {
    /// It taps: screwed to the work, it comes out along its thread.
    Tap,
    /// A pass over a turned thread.
    Thread,
    /// A cam is ground.
    Cam,
    /// A polygon is turned.
    Polygon,
    /// A gear is hobbed.
    Gear,
    /// It taps in a holder that gives or has a clutch: the spindle is not tied to the feed, so
    /// there is no line to go back along.
    FloatingTap,
}

impl Cut {
    /// For people: what the tool is doing.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tap => "tap",
            Self::Thread => "threading pass",
            Self::Cam => "cam grinding",
            Self::Polygon => "polygon turning",
            Self::Gear => "hobbing",
            Self::FloatingTap => "tapping without synchronisation",
        }
    }

    /// An axis along a thread follows the spindle.
    pub(super) const fn has_thread(self) -> bool {
        matches!(self, Self::Tap | Self::Thread)
    }
}

/// How a tool comes off work that it is not screwed to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Retreat {
    /// Bus index of the infeed axis.
    pub axis: u8,
    /// Its coordinate where the tool is clear of the work.
    pub clear: Length,
    /// That is on its positive side.
    pub outward: bool,
}

impl Retreat {
    /// How far a place is inside of where the tool is clear; negative outside.
    pub fn inside(&self, place: Length) -> Length {
        if self.outward { self.clear - place } else { place - self.clear }
    }
}

/// The coupled motion. Coordinates are those of the axes, at the spindle's gauge line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    /// What is cut.
    pub cut: Cut,
    /// What leads the tool off the work first; a tap has none.
    pub retreat: Option<Retreat>,
    /// Bus index of the axis along the thread; where there is none, of the infeed axis.
    pub axis: u8,
    /// Which spindle leads.
    pub spindle: u8,
    /// The tool in the spindle.
    pub tool: u32,
    /// Its nominal diameter.
    pub diameter: Length,
    /// θ₀: the spindle's angle, multi-turn, …
    pub theta0: Angle,
    /// … that belongs to this place of the axis.
    pub z0: Length,
    /// H: axis travel per positive turn of the spindle; zero where no thread is cut.
    pub lead: Lead,
    /// By how much H grows with each turn from θ₀ on, of a thread whose lead is not the same
    /// everywhere.
    pub growth: LeadGrowth,
    /// PS: where the way out ends.
    pub start: Length,
    /// PE: the programmed bottom.
    pub bottom: Length,
    /// Where the material is taken to begin.
    pub surface: Length,
    /// Highest planned speed, signed as on the way in.
    pub spin: Spin,
    /// Axial stiffness of the holder.
    pub stiffness: Stiffness,
    /// How far it gives to each side; zero: it is a spring all the way.
    pub travel: Length,
    /// Of a tap: how long its thread is; zero where that is not known.
    pub thread_length: Length,
    /// The spindle that follows, where one does.
    pub geared: Option<Geared>,
}

/// A spindle that follows another one: φ = (p/q)·θ + z/H + φ₀ + Σ swing(θ).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Geared {
    /// The spindle that follows; the stroke names the one that leads.
    pub follower: u8,
    /// p: turns of the follower …
    pub turns: i32,
    /// … in so many of its master, q; above zero.
    pub master_turns: i32,
    /// φ₀: the follower's angle where the master's is zero.
    pub phase: Angle,
    /// Bus index of an axis that is a second master, and its travel for a turn.
    pub axis: Option<(u8, Lead)>,
    /// At this radius of what follows, a distance from its place is a length.
    pub radius: Length,
    /// What swings about that, rev: periods in so many turns of the master, cosine, sine; …
    #[serde(serialize_with = "cut_swing")]
    pub swing: Vec<(u32, f64, f64)>,
    /// … and those turns.
    pub swing_turns: f64,
}

impl Geared {
    /// Most terms of a swing that are written down.
    pub const MOST_TERMS: usize = 64;

    /// Numbers that some machine can have.
    pub(super) fn makes_sense(&self) -> bool {
        let (axis, lead) = self.axis.unwrap_or((0, Lead::mm_per_rev(1.0)));
        let numbers = [self.phase.value(), lead.value(), self.radius.value()];
        let swing = self.swing.iter().all(|(_, cosine, sine)| (cosine + sine).is_finite());
        usize::from(self.follower) < bus::SPINDLES
            && usize::from(axis) < bus::AXES
            && self.master_turns > 0
            && self.swing_turns.is_finite()
            && self.swing_turns > 0.0
            && numbers.iter().all(|number| number.is_finite())
            && lead != Lead::ZERO
            && self.swing.len() <= Self::MOST_TERMS
            && swing
    }

    /// Where the follower belongs.
    pub fn follow(&self, theta: Angle, place: impl Fn(u8) -> Length) -> Angle {
        let q = f64::from(self.master_turns);
        let cycles = (theta.value() / q).floor();
        let rest = theta.value() - cycles * q;
        let (turns, around) = (f64::from(self.turns), theta.value() / self.swing_turns);
        let along = self.axis.map_or(Angle::ZERO, |(axis, lead)| place(axis) / lead);
        let term = |&(period, cosine, sine): &(u32, f64, f64)| {
            let (s, c) = (std::f64::consts::TAU * f64::from(period) * around).sin_cos();
            cosine * c + sine * s
        };
        let swing: f64 = self.swing.iter().map(term).sum();
        Angle::rev(cycles * turns + rest * turns / q + swing) + along + self.phase
    }

    /// How far a follower at this angle is from there, of all its turns the nearest; where the
    /// master has lost count of its turns, of all the places that they allow.
    pub fn error(
        &self,
        theta: Angle,
        phi: Angle,
        place: impl Fn(u8) -> Length,
        lost: bool,
    ) -> Angle {
        let off = (phi - self.follow(theta, place)).value();
        let apart = if lost { 1.0 / f64::from(self.master_turns) } else { 1.0 };
        Angle::rev(off - apart * (off / apart).round())
    }
}

impl Stroke {
    /// The hand of the thread: right-hand where turning clockwise leads into the work.
    pub fn is_right_hand(&self) -> bool {
        (self.bottom < self.start) == (self.lead < Lead::ZERO)
    }

    /// θ(z), where z = z₀ + H·(θ − θ₀) + growth·(θ − θ₀)²/2, and the lead there.
    pub fn belongs(&self, z: Length) -> (Angle, Lead) {
        let (way, lead, growth) = ((z - self.z0).value(), self.lead.value(), self.growth.value());
        let squared = (lead * lead + 2.0 * growth * way).max(0.0);
        let there = squared.sqrt().copysign(lead);
        (self.theta0 + Angle::rev(2.0 * way / (lead + there)), Lead::mm_per_rev(there))
    }

    /// How far a place of the axis is inside of PS, along the way in; negative outside.
    pub fn inside(&self, z: Length) -> Length {
        if self.bottom < self.start { self.start - z } else { z - self.start }
    }
}

/// The terms that are written down.
fn cut_swing<S: Serializer>(terms: &[(u32, f64, f64)], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(&terms[..terms.len().min(Geared::MOST_TERMS)])
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A helical gear of 40 teeth, lead 734.8 mm, that follows its hob.
    pub(in crate::sync_record) fn geared() -> Geared {
        Geared {
            follower: 1,
            turns: 1,
            master_turns: 40,
            phase: Angle::rev(0.1),
            axis: Some((2, Lead::mm_per_rev(-734.8))),
            radius: Length::mm(42.567),
            swing: Vec::new(),
            swing_turns: 1.0,
        }
    }

    #[test]
    fn a_follower_belongs_where_the_gear_its_helix_and_its_swing_have_it() {
        let place = |_: u8| Length::mm(-73.48);
        // 83 turns of the hob: 2 3/40 of the work, a tenth by the helix, and the phase
        let on = geared().follow(Angle::rev(83.0), place);
        assert!((on.value() - (2.0 + 3.0 / 40.0 + 0.1 + 0.1)).abs() < 1e-12, "{on:?}");
        let tool = Geared {
            turns: 2,
            master_turns: 1,
            axis: None,
            swing: vec![(4, 0.01, 0.0), (8, 0.0, 0.002)],
            ..geared()
        };
        // an eighth of a turn: half a period of the one, a whole one of the other
        let on = tool.follow(Angle::rev(-2.875), place);
        assert!((on.value() - (-5.75 + 0.1 - 0.01)).abs() < 1e-12, "{on:?}");
    }

    #[test]
    fn the_error_of_a_follower_is_that_of_the_nearest_turn_and_of_the_nearest_tooth_where_turns_are_lost()
     {
        let place = |_: u8| Length::ZERO;
        let theta = Angle::rev(83.0);
        let on = geared().follow(theta, place);
        let off =
            |more: f64, lost| geared().error(theta, on + Angle::rev(more), place, lost).value();
        assert!((off(7.002, false) - 0.002).abs() < 1e-12 && (off(0.3, false) - 0.3).abs() < 1e-12);
        // the master may be any turn further: each is a tooth
        assert!((off(0.3 + 0.002, true) - 0.002).abs() < 1e-12, "{}", off(0.302, true));
    }

    #[test]
    fn a_place_of_a_thread_whose_lead_grows_belongs_to_an_angle() {
        let mut stroke = Stroke {
            cut: Cut::Thread,
            retreat: None,
            axis: 2,
            spindle: 0,
            tool: 31,
            diameter: Length::ZERO,
            theta0: Angle::rev(37.0),
            z0: Length::mm(-147.0),
            lead: Lead::mm_per_rev(-2.0),
            growth: LeadGrowth::mm_per_rev2(-0.1),
            start: Length::mm(-147.0),
            bottom: Length::mm(-227.0),
            surface: Length::mm(-152.0),
            spin: Spin::rpm(1000.0),
            stiffness: Stiffness::ZERO,
            travel: Length::ZERO,
            thread_length: Length::ZERO,
            geared: None,
        };
        // 2·20 + 0.1·20²/2 = 60 mm in 20 turns, up to 4 mm
        let (theta, lead) = stroke.belongs(stroke.z0 - Length::mm(60.0));
        assert!((theta.value() - 57.0).abs() < 1e-12 && (lead.value() + 4.0).abs() < 1e-12);
        stroke.growth = LeadGrowth::ZERO;
        let (theta, lead) = stroke.belongs(stroke.z0 - Length::mm(60.0));
        assert_eq!((theta, lead), (Angle::rev(67.0), stroke.lead));
    }
}
