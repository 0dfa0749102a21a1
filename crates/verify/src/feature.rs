//! What came out of the cut: one [`Feature`] for each hole and thread, in the order cut.
//!
//! ```text
//!                 y                         surface ──────┬─────────────┬──
//!                 │   ○ ← x, y of the axes                │  ▒       ▒  │ ↑       ↑
//!                 │                                       │  ▒ full  ▒  │ depth   │
//!                 └────── x                               │  ▒ form  ▒  │ ↓       │ tip_depth
//!                                                         │   ▒     ▒   │ chamfer │
//!                                                         └────\___/────┘         ↓
//! ```
//!
//! Positions are machine coordinates; depths count from the surface, positive into the material;
//! errors are signed so that positive means *deeper* or *more*. Values keep their units here;
//! the certificate's keys (`depth_error_um`, …) are made where the file is written.
use crate::{Contact, ThreadClass};
use canon::Hand;
use units::{Angle, Force, Lead, Length, Spin, Time, Torque};

/// One thing cut into the workpiece, measured and judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature {
    /// Index of the op that ordered it.
    pub op: u32,
    /// Program line of that op.
    pub line: u32,
    /// T number of the tool that cut it; `None` if the spindle was empty.
    pub tool: Option<u32>,
    /// When the tool first entered the material; when the op ended, if it never did.
    pub time: Time,
    /// From then until the tool was last in the material.
    pub duration: Time,
    /// Whether it is good.
    pub verdict: Verdict,
    /// What says that the tool was in the material.
    pub contact: Contact,
    /// What it is, with its measures.
    pub kind: FeatureKind,
}

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

/// Whether a feature is good.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within every tolerance asked.
    Pass,
    /// Out of at least one.
    Fail {
        /// One sentence with the numbers: everything that is wrong, gravest first.
        reason: String,
    },
    /// Nothing is known to be wrong, and the judge lacks what it would need to find it right.
    NotJudged {
        /// What could not be judged, and why.
        reason: String,
    },
}

impl Verdict {
    /// `Pass` if nothing was found, else all findings as one sentence.
    pub(crate) fn from_findings(findings: &[String]) -> Self {
        if findings.is_empty() { Self::Pass } else { Self::Fail { reason: findings.join("; ") } }
    }

    /// The same of a feature that could not be judged as a whole: it may be bad, but never good.
    pub(crate) fn unless(findings: &[String], not_judged: Option<String>) -> Self {
        match (Self::from_findings(findings), not_judged) {
            (Self::Pass, Some(reason)) => Self::NotJudged { reason },
            (verdict, _) => verdict,
        }
    }

    /// Good.
    pub const fn is_pass(&self) -> bool {
        matches!(self, Self::Pass)
    }

    /// `"pass"`, `"fail"` or `"not judged"`.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail { .. } => "fail",
            Self::NotJudged { .. } => "not judged",
        }
    }

    /// Why it is not good.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Pass => None,
            Self::Fail { reason } | Self::NotJudged { reason } => Some(reason),
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

/// A hole as it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Mean X of the axis while the tool was in the material.
    pub x: Length,
    /// Likewise Y.
    pub y: Length,
    /// Deepest point of the tool's tip below the surface.
    pub depth: Length,
    /// Down to here the hole has its diameter: `depth` less the drill's point.
    pub full_diameter_depth: Length,
    /// `depth` less the programmed depth.
    pub depth_error: Length,
    /// Largest distance from the programmed position while in the material.
    pub position_error: Length,
    /// The tool's diameter; for a spot drill the cone's diameter at the surface.
    pub diameter: Length,
    /// Chips were thrown off the tool after it, on the way to the next hole: seen, not only
    /// ordered.
    pub chip_removal: bool,
}

/// Which gauge leaves the least margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Gauge {
    /// The full-form plug that must screw in: the thread is nearly too tight.
    Go,
    /// The plug that must not: the thread is nearly too wide.
    NoGo,
}

impl Gauge {
    /// `"Go"` or `"No-go"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Go => "Go",
            Self::NoGo => "No-go",
        }
    }
}

/// An internal thread as it was made. `docs/judging.md` has the equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Thread {
    /// Mean X of the axis while the tap was in the material.
    pub x: Length,
    /// Likewise Y.
    pub y: Length,
    /// Largest distance from the programmed position while in the material.
    pub position_error: Length,
    /// Designation of the size, such as `"M6x1"` or `"1/4-20 UNC"`.
    pub size: String,
    /// Which way it winds.
    pub hand: Hand,
    /// Lead of the thread asked (magnitude).
    pub lead: Lead,
    /// Length of full thread: the tip's depth less the tap's chamfer.
    pub depth: Length,
    /// Deepest point of the tap's tip below the surface.
    pub tip_depth: Length,
    /// The tip's depth less the programmed one; positive is an overrun.
    pub depth_error: Length,
    /// Fastest spindle speed in the material (magnitude).
    pub spin_max: Spin,
    /// Largest distance of the axis from the ideal helix fitted to it, in the material, in and out:
    /// how well the machine kept step, before the holder gave way.
    pub sync_error_max: Length,
    /// The same, root of the mean square over the spindle's path.
    pub sync_error_rms: Length,
    /// Depth of the tip at which `sync_error_max` occurred.
    pub sync_error_depth: Length,
    /// Largest cumulative pitch error between two places within the engagement length.
    pub lead_error: Length,
    /// How much wider, axially, the widest groove place is than the tap's tooth.
    pub groove_widening: Length,
    /// Depth of that place.
    pub widest_depth: Length,
    /// Simple pitch diameter D2s = D2 of the tap + √3·widening.
    pub pitch_diameter: Length,
    /// Virtual pitch diameter D2v = D2s − √3·|ΔPn| − fα: what a full-form gauge feels.
    pub virtual_pitch_diameter: Length,
    /// Minor diameter: that of the drilled hole, or the tap drill's if the program drilled none.
    pub minor_diameter: Length,
    /// The minor diameter was measured on a hole of this program.
    pub drilled: bool,
    /// Finest class whose gauges all agree; `None` if not even the coarsest.
    pub class: Option<ThreadClass>,
    /// Class asked.
    pub class_asked: ThreadClass,
    /// The smaller of `go_margin` and `no_go_margin`; negative is out of tolerance.
    pub margin: Length,
    /// Which gauge that is.
    pub limiting_gauge: Gauge,
    /// D2v − D2: how loosely the Go gauge enters.
    pub go_margin: Length,
    /// D2 + TD2 − D2s: how surely the No-go gauge is refused.
    pub no_go_margin: Length,
    /// Distance of the minor diameter from the nearer of its limits; negative is outside.
    pub minor_margin: Length,
    /// TD2 of the class asked.
    pub pitch_diameter_tolerance: Length,
    /// Largest torque of the cut, where it can be known.
    pub torque_max: Option<Torque>,
    /// Largest torque on the way in.
    pub torque_in: Option<Torque>,
    /// Largest torque on the way out, once the chip's root is sheared: from half a turn back on.
    pub torque_out: Option<Torque>,
    /// Torque the formula of [`Material`](crate::Material) expects of a sharp tap; `None` without a
    /// material.
    pub torque_expected: Option<Torque>,
    /// Largest axial force on the tap (magnitude), where it can be known.
    pub axial_force_max: Option<Force>,
    /// Spindle angle within a turn at which the fitted helix passes the start plane; `None`: too
    /// little was cut to fit one.
    pub start_angle: Option<Angle>,
    /// Chips were thrown off the tap after it, on the way to the next hole: seen, not only ordered.
    pub chip_removal: bool,
    /// The motion was faulted in the thread and the tap was driven out of it afterwards.
    pub recovered: bool,
    /// Sync error and widening over depth, for pictures; empty if nothing was cut.
    pub profile: Vec<ProfilePoint>,
}

impl Thread {
    /// How far the tap makers' formula is believed, as a share of it: they call it a guide value,
    /// and charges of a steel differ by as much (estimate).
    pub const TORQUE_BAND: f64 = 0.25;
    /// Torque of flanks in a thread that is cut, as shares of the formula (published: 10 to 30 %).
    pub const TORQUE_OUT_SHARES: [f64; 2] = [0.1, 0.3];

    /// There is a length of full thread that a gauge could be tried on: what gauges find means
    /// something.
    pub fn is_gauged(&self) -> bool {
        self.pitch_diameter > Length::ZERO
    }

    /// What the formula expects on the way in, from and to.
    pub fn torque_in_band(&self) -> Option<[Torque; 2]> {
        let band = |t: Torque| [t * (1.0 - Self::TORQUE_BAND), t * (1.0 + Self::TORQUE_BAND)];
        self.torque_expected.map(band)
    }

    /// What it expects on the way out, with the same doubt.
    pub fn torque_out_band(&self) -> Option<[Torque; 2]> {
        let [least, most] = Self::TORQUE_OUT_SHARES;
        let band = |[low, high]: [Torque; 2]| [low * least, high * most];
        self.torque_in_band().map(band)
    }

    /// Whether both ways are within what the formula expects; `None` where that cannot be said.
    pub fn torque_is_expected(&self) -> Option<bool> {
        let within = |m: Torque, [low, high]: [Torque; 2]| low <= m && m <= high;
        let inward = within(self.torque_in?, self.torque_in_band()?);
        let outward = self.torque_out.zip(self.torque_out_band());
        Some(inward && outward.is_none_or(|(m, band)| within(m, band)))
    }

    /// Name of the class asked if the thread is within it, else of the finest that it is within,
    /// else `"none"`; `"not gauged"` where there is no full thread that a gauge could be tried on.
    pub fn class_name(&self) -> &'static str {
        if !self.is_gauged() {
            return "not gauged";
        }
        let within = self.margin >= Length::ZERO && self.minor_margin >= Length::ZERO;
        match self.class {
            Some(_) if within => self.class_asked.name(),
            Some(reached) => reached.name(),
            None => "none",
        }
    }
}

/// Sync error and cut at one depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Depth of the tap's tip.
    pub tip_depth: Length,
    /// Least and largest sync error on the way in; positive is deeper than the helix.
    pub inward: Option<[Length; 2]>,
    /// Likewise on the way out.
    pub outward: Option<[Length; 2]>,
    /// Widening of the groove at *this depth of thread*; `None` below the full form.
    pub widening: Option<Length>,
}
