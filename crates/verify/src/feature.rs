//! What came out of the cut: one [`Feature`] for each hole and thread, in the order cut.
//!
//! Positions are machine coordinates; depths count from the surface, positive into the material;
//! errors are signed so that positive means *deeper* or *more*. Values keep their units here;
//! the certificate's keys (`depth_error_um`, …) are made where the file is written.
use crate::hole::Hole;
use crate::judged::Judged;
use crate::tapped::{KnownHole, Thread};
use units::Length;

/// One thing cut into the workpiece, measured and judged.
pub type Feature = Judged<FeatureKind>;

impl Feature {
    /// Largest distance of a thread from its coupling; `None`: it has none.
    pub const fn sync_error_max(&self) -> Option<Length> {
        match &self.kind {
            FeatureKind::Thread(thread) => Some(thread.sync_error_max),
            FeatureKind::Turned(thread) => Some(thread.sync_error_max),
            _ => None,
        }
    }

    /// Depth less the programmed one; `None`: it has none.
    pub const fn depth_error(&self) -> Option<Length> {
        match &self.kind {
            FeatureKind::Hole(hole) => Some(hole.depth_error),
            FeatureKind::Thread(thread) => Some(thread.depth_error),
            _ => None,
        }
    }

    /// `"hole"`, `"thread"`, `"polygon"`, `"cam"`, `"turned thread"`, `"gear"` or `"milling"`.
    pub const fn kind_name(&self) -> &'static str {
        match self.kind {
            FeatureKind::Hole(_) => FeatureKind::NAMES[0],
            FeatureKind::Thread(_) => FeatureKind::NAMES[1],
            FeatureKind::Polygon(_) => FeatureKind::NAMES[2],
            FeatureKind::Cam(_) => FeatureKind::NAMES[3],
            FeatureKind::Turned(_) => FeatureKind::NAMES[4],
            FeatureKind::Gear(_) => FeatureKind::NAMES[5],
            FeatureKind::Milled(_) => FeatureKind::NAMES[6],
        }
    }

    /// Whether there is something that could be measured: a hole that was there before its drill
    /// came is, and where it is not known it is taken to be.
    pub fn is_there(&self) -> bool {
        self.verdict.is_pass() || self.contact.reach.is_none() || self.contact.is_cut()
    }

    /// A thread of which nothing says that its hole was there.
    pub fn has_assumed_hole(&self) -> bool {
        matches!(&self.kind, FeatureKind::Thread(thread) if thread.hole == KnownHole::Assumed)
    }

    /// Chips were thrown off the tool after it.
    pub(crate) const fn chips_were_thrown(&mut self) {
        match &mut self.kind {
            FeatureKind::Hole(hole) => hole.chip_removal = true,
            FeatureKind::Thread(thread) => thread.chip_removal = true,
            FeatureKind::Cam(_)
            | FeatureKind::Polygon(_)
            | FeatureKind::Turned(_)
            | FeatureKind::Milled(_)
            | FeatureKind::Gear(_) => {} // no chips wind around their tools
        }
    }

    /// Where it is in the plane across the tool, as X and Y of the machine; what is turned around
    /// the work's own axis has no place.
    pub const fn position(&self) -> Option<[Length; 2]> {
        match &self.kind {
            FeatureKind::Hole(hole) => Some([hole.x, hole.y]),
            FeatureKind::Thread(thread) => Some([thread.x, thread.y]),
            FeatureKind::Polygon(_)
            | FeatureKind::Cam(_)
            | FeatureKind::Turned(_)
            | FeatureKind::Milled(_)
            | FeatureKind::Gear(_) => None,
        }
    }
}

/// What a feature is.
#[derive(Clone, Debug, PartialEq)]
pub enum FeatureKind {
    /// Drilled, spotted or plunged.
    Hole(Hole),
    /// Tapped.
    Thread(Box<Thread>),
    /// Turned with a cutter geared to the work.
    Polygon(Box<crate::Polygon>),
    /// Ground.
    Cam(Box<crate::GroundCam>),
    /// A thread turned with a single point.
    Turned(Box<crate::TurnedThread>),
    /// Hobbed teeth.
    Gear(Box<crate::Gear>),
    /// What a mill has removed while it was in the spindle.
    Milled(Box<crate::Milled>),
}

impl FeatureKind {
    /// Names of all kinds, as [`Feature::kind_name`] has them.
    pub const NAMES: [&str; 7] =
        ["hole", "thread", "polygon", "cam", "turned thread", "gear", "milling"];
    /// Of these, those that have a sync error.
    pub const SYNCHRONISED: [&str; 2] = [Self::NAMES[1], Self::NAMES[4]];
}

/// What a mill has done, as a feature.
pub(crate) fn milled(found: Judged<crate::Milled>) -> Feature {
    found.map(Box::new).map(FeatureKind::Milled)
}
