//! Which motion is in force, and which cycle.
use crate::{
    call::Sense,
    codes::{BORE_UPWARDS, FINE_BORE, SYNCHRO_LEFT, SYNCHRO_RIGHT},
};

/// The motion in force: what a block of axis words alone does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// G80, and the beginning.
    None,
    /// G0.
    Rapid,
    /// G1.
    Feed,
    /// G2.
    ArcClockwise,
    /// G3.
    ArcCounterclockwise,
    /// G5.
    CubicSpline,
    /// G5.1.
    QuadraticSpline,
    /// G5.2.
    Nurbs,
    /// G5.3.
    NurbsEnd,
    /// G38.2 … G38.5: the digit.
    Probe(u16),
    /// G33.
    Thread,
    /// G33.1.
    RigidTap,
    /// G76.
    ThreadCycle,
    /// G70 … G72.2: the code in tenths.
    Turning(u16),
    /// G73, G74, G81 … G89.
    Cycle(Cycle),
}

/// The drilling, tapping and boring cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cycle {
    /// G73: pecks, backs off a little, goes on.
    ChipBreak,
    /// G74.
    TapLeft,
    /// G81.
    Drill,
    /// G82: waits at the bottom.
    DrillDwell,
    /// G83: pecks, comes out, goes in again.
    Peck,
    /// G84.
    TapRight,
    /// G84.2: as G84 after M29.
    RigidRight,
    /// G84.3: as G74 after M29.
    RigidLeft,
    /// Brother's G77: right-hand, by its pitch.
    SynchroRight,
    /// Brother's G78: left-hand, by its pitch.
    SynchroLeft,
    /// G85: feeds out.
    BoreFeedOut,
    /// G86: waits, stops the spindle, comes out fast.
    BoreStopOut,
    /// G87: from below.
    BackBore,
    /// G88: waits, stops, comes out by hand.
    BoreManualOut,
    /// G89: waits, feeds out.
    BoreDwellFeedOut,
    /// Fanuc's G76: waits, stops the spindle, moves aside, comes out fast.
    FineBore,
    /// Fanuc's G87: goes down beside the bore, bores upwards.
    BoreUpwards,
}

impl Motion {
    /// From a code in tenths.
    pub(crate) const fn from_code(tenths: u16) -> Self {
        match tenths {
            0 => Self::Rapid,
            10 => Self::Feed,
            20 => Self::ArcClockwise,
            30 => Self::ArcCounterclockwise,
            50 => Self::CubicSpline,
            51 => Self::QuadraticSpline,
            52 => Self::Nurbs,
            53 => Self::NurbsEnd,
            382..=385 => Self::Probe(tenths - 380),
            330 => Self::Thread,
            331 => Self::RigidTap,
            730 => Self::Cycle(Cycle::ChipBreak),
            740 => Self::Cycle(Cycle::TapLeft),
            700..=722 => Self::Turning(tenths),
            760 => Self::ThreadCycle,
            810 => Self::Cycle(Cycle::Drill),
            820 => Self::Cycle(Cycle::DrillDwell),
            830 => Self::Cycle(Cycle::Peck),
            840 => Self::Cycle(Cycle::TapRight),
            842 => Self::Cycle(Cycle::RigidRight),
            843 => Self::Cycle(Cycle::RigidLeft),
            850 => Self::Cycle(Cycle::BoreFeedOut),
            860 => Self::Cycle(Cycle::BoreStopOut),
            870 => Self::Cycle(Cycle::BackBore),
            880 => Self::Cycle(Cycle::BoreManualOut),
            890 => Self::Cycle(Cycle::BoreDwellFeedOut),
            FINE_BORE => Self::Cycle(Cycle::FineBore),
            BORE_UPWARDS => Self::Cycle(Cycle::BoreUpwards),
            SYNCHRO_RIGHT => Self::Cycle(Cycle::SynchroRight),
            SYNCHRO_LEFT => Self::Cycle(Cycle::SynchroLeft),
            _ => Self::None, // G80
        }
    }

    /// Whether it can be made with the tool beside it.
    pub(crate) const fn can_be_beside(self) -> bool {
        matches!(
            self,
            Self::Rapid
                | Self::Feed
                | Self::ArcClockwise
                | Self::ArcCounterclockwise
                | Self::Turning(_)
        )
    }

    /// Its code in tenths, as `#<_motion_mode>` says it.
    pub(crate) const fn code(self) -> u16 {
        match self {
            Self::None => 800,
            Self::Rapid => 0,
            Self::Feed => 10,
            Self::ArcClockwise => 20,
            Self::ArcCounterclockwise => 30,
            Self::CubicSpline => 50,
            Self::QuadraticSpline => 51,
            Self::Nurbs => 52,
            Self::NurbsEnd => 53,
            Self::Probe(digit) => 380 + digit,
            Self::Thread => 330,
            Self::RigidTap => 331,
            Self::ThreadCycle => 760,
            Self::Turning(tenths) => tenths,
            Self::Cycle(cycle) => cycle.code(),
        }
    }
}

impl Cycle {
    /// Its code in tenths.
    pub(crate) const fn code(self) -> u16 {
        match self {
            Self::ChipBreak => 730,
            Self::TapLeft => 740,
            Self::Drill => 810,
            Self::DrillDwell => 820,
            Self::Peck => 830,
            Self::TapRight => 840,
            Self::RigidRight => 842,
            Self::RigidLeft => 843,
            Self::BoreFeedOut => 850,
            Self::BoreStopOut => 860,
            Self::BackBore => 870,
            Self::BoreManualOut => 880,
            Self::BoreDwellFeedOut => 890,
            Self::FineBore => FINE_BORE,
            Self::BoreUpwards => BORE_UPWARDS,
            Self::SynchroRight => SYNCHRO_RIGHT,
            Self::SynchroLeft => SYNCHRO_LEFT,
        }
    }
}

impl Cycle {
    /// Sense of rotation inwards of a tapping cycle.
    pub(crate) const fn tap_sense(self) -> Option<Sense> {
        match self {
            Self::TapRight | Self::RigidRight | Self::SynchroRight => Some(Sense::Clockwise),
            Self::TapLeft | Self::RigidLeft | Self::SynchroLeft => Some(Sense::Counterclockwise),
            _ => None,
        }
    }

    /// Whether it is one of Brother's G77 and G78.
    pub(crate) const fn is_synchro(self) -> bool {
        matches!(self, Self::SynchroRight | Self::SynchroLeft)
    }
}
