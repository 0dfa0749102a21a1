//! A tool in the work that only recovery may take out: what control and machine know of it. The
//! machine keeps it when the control ends.
use units::{Length, Spin};

/// Speed below which a spindle stands: its sense is that of before.
pub const STANDSTILL: Spin = Spin::rpm(3.0);

/// A tool in the work that only recovery may take out: a tap in its thread, or one that is coupled
/// to a spindle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EngagedTool {
    /// Number of the engagement, which the machine counts from 1.
    pub number: u64,
    /// The tool.
    pub tool: u32,
    /// It is certainly in the workpiece now; before its first touch and between two pecks it is
    /// not.
    pub touches: bool,
    /// Largest distance of the axis from its coupling in the material, by the encoders.
    pub sync_error: Length,
    /// A recovery that has begun to move it knows that it may be broken; where it stands later does
    /// not show that any more.
    pub may_be_broken: bool,
}

/// Sense in which a spindle turned while an axis was coupled to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SpindleSense {
    /// It has not turned since the tool went in.
    #[default]
    Unknown,
    /// With growing angle.
    Positive,
    /// With falling angle.
    Negative,
}

impl SpindleSense {
    /// Sense of a spindle that turns this fast; `None`: it stands.
    pub fn of(spin: Spin) -> Option<Self> {
        (spin.abs() > STANDSTILL).then_some(if spin > Spin::ZERO {
            Self::Positive
        } else {
            Self::Negative
        })
    }
}

/// How drives came to rest without a control; the one after which it is least certain how far a
/// tool is from its coupling is the greatest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RunDownKind {
    /// They have been led all the time.
    #[default]
    None,
    /// Coupled drives braked together.
    Coupled,
    /// Each drive braked by itself.
    QuickStop,
    /// Axes clamped, spindles coasted.
    Coasted,
}

/// What a machine keeps of a tool in its work when its control ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EngagementEvidence {
    /// Number of the last engagement; 0: there has been none.
    pub last: u64,
    /// The tool that is in the work now; `None`: the control that led it there has taken it out.
    pub in_work: Option<EngagedTool>,
    /// How the spindle of the last engagement turned last while an axis was coupled to it.
    pub sense: SpindleSense,
}
