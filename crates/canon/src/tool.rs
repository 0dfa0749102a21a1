//! The tools a program calls by number.
use crate::{Hand, ToolLife, ToolWear};
use alloc::{string::String, vec::Vec};
use units::{Angle, Lead, Length, Stiffness, Torque};

/// A tool as the shop's table has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// T number.
    pub number: u32,
    /// Pocket in the magazine.
    pub pocket: u32,
    /// From the spindle's gauge line to the tip, as measured: its geometry, without wear.
    pub length: Length,
    /// Cutting diameter, without wear.
    pub diameter: Length,
    /// What use has added to its geometry.
    pub wear: ToolWear,
    /// How much it was used, and how much it may be.
    pub life: ToolLife,
    /// What it is.
    pub kind: ToolKind,
    /// For people.
    pub description: String,
    /// What stands behind its edges.
    pub body: Body,
    /// True for a tool that the table lacks and the user let us assume.
    pub stand_in: bool,
}

/// What stands behind the edges of a tool, as far as the table says: what it does not say is not
/// judged.
///
/// ```text
///        ┌──────┐ holder            drill, tap, mill: from the tip upwards
///        │      │                   boring bar: the shank lies along Z behind the insert,
///        └┬────┬┘ ─ stick_out                   as thick as `shank`
///         │    │  shank             turning tool: the shank lies across Z over the insert, from its
///         └┐  ┌┘ ─ flutes                       point towards the free end, as wide as `shank`
///          ╲╱
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// From the tip to where the flutes end; a tap states its own as [`TapTool::thread_length`].
    pub flutes: Option<Length>,
    /// Diameter of the shank, or width of a turning tool's.
    pub shank: Option<Length>,
    /// From the tip to the holder; of a turning tool, from the point to its shank.
    pub stick_out: Option<Length>,
    /// Diameter of the holder.
    pub holder: Option<Length>,
    /// Depth that a drill makes without pecks, where its maker states it.
    pub depth_without_pecks: Option<Length>,
}

/// What a tool is.
#[derive(Clone, Debug, PartialEq)]
pub enum ToolKind {
    /// Makes a round hole with a cone at its end.
    Drill {
        /// Full point angle, 118° as a rule.
        point_angle: Angle,
    },
    /// Marks a hole.
    SpotDrill {
        /// Full point angle, 90° as a rule.
        point_angle: Angle,
    },
    /// Cuts with its side, and mostly with its end.
    EndMill(Mill),
    /// Cuts an internal thread.
    Tap(TapTool),
    /// Cuts flats beside a turning workpiece.
    PolygonCutter(PolygonCutter),
    /// Turns with a single point: surfaces and threads.
    Insert(Insert),
    /// Generates the teeth of a gear that turns with it.
    Hob(HobTool),
    /// Touches the work, and cuts nothing; its diameter is that of its ball.
    Probe(TouchProbe),
    /// Anything else: what it leaves in a block is not judged; a bar takes it for a turning insert.
    Other,
}

/// An end mill of any form, as far as the table says: what it does not say is not judged.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mill {
    /// What its edges sweep in a turn; `None`: not known.
    pub form: Option<MillForm>,
    /// Its teeth about the circumference.
    pub teeth: Option<u32>,
    /// What its body is made of.
    pub body: Option<CutterMaterial>,
    /// What it is not to exceed.
    pub limits: MillLimits,
}

/// What the body of a mill is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutterMaterial {
    /// Cemented carbide of ISO class K.
    Carbide,
    /// High-speed steel.
    HighSpeedSteel,
}

impl CutterMaterial {
    /// Its Young's modulus, N/mm² (typical).
    pub const fn modulus_n_per_mm2(self) -> f64 {
        match self {
            Self::Carbide => 600_000.0,
            Self::HighSpeedSteel => 210_000.0,
        }
    }
}

/// What the edges of a mill sweep in a turn, below its diameter.
///
/// ```text
///   │      │    │      │    │      │    ╲      ╱
///   │      │    │      │    ╲      ╱     ╲    ╱
///   └──────┘    ╰──────╯     ╲____╱       ╲__╱
///    flat         bull        ball       conical
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MillForm {
    /// A cylinder whose corner is rounded; with 0 a flat end mill or a face mill.
    Cylindrical {
        /// Radius of its corner.
        corner: Length,
    },
    /// A hemisphere.
    Ball,
    /// Chamfer mills and engraving tools.
    Conical {
        /// Full angle of its cone.
        angle: Angle,
        /// Diameter of its flat tip.
        tip: Length,
    },
}

impl MillForm {
    /// A flat end mill or a face mill.
    pub const FLAT: Self = Self::Cylindrical { corner: Length::ZERO };
}

/// What a mill is not to exceed; `None`: not stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MillLimits {
    /// Thickness of the chip of a tooth.
    pub chip: Option<Length>,
    /// Axial depth of the cut.
    pub depth: Option<Length>,
    /// Deflection of its tip.
    pub deflection: Option<Length>,
}

/// A touch probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchProbe {
    /// How far its stylus gives until it switches.
    pub pretravel: Length,
    /// By how much that differs by direction.
    pub lobing: Length,
}

/// A cutter head for polygon turning: a few inserts on a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonCutter {
    /// From the tool spindle's axis to an insert's tip.
    pub radius: Length,
    /// Where each insert stands in the head, rising from zero. At zero of the tool spindle the
    /// first one points to −X, where the work is.
    pub inserts: Vec<Angle>,
    /// Radius of the inserts' noses, in the plane of the axis.
    pub nose_radius: Length,
}

/// A hob: a screw whose axial section is the rack that its gear rolls on.
///
/// ```text
///      ╲      ╱‾‾╲      ╱ ─ ─ ─ crest: `addendum` over the datum line, rounded with `tip_radius`
///   ────╲────╱────╲────╱──── datum line: tooth as wide as gap
///        ╲__╱      ╲__╱  α between flank and the line of centres
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HobTool {
    /// Module in the normal section.
    pub module: Length,
    /// Its threads.
    pub starts: u32,
    /// Hand of its threads.
    pub hand: Hand,
    /// Pressure angle in the normal section.
    pub pressure_angle: Angle,
    /// From the datum line to the crest: the dedendum of a gear without profile shift.
    pub addendum: Length,
    /// Radius that rounds the crest.
    pub tip_radius: Length,
    /// Length of its threads along its axis; `None`: not stated.
    pub length: Option<Length>,
    /// Its cutting faces look the other way: it cuts with M4.
    pub cuts_backwards: bool,
}

impl HobTool {
    /// Its threads, below zero left-handed: what L of G81 says of it, where it turns with M3.
    pub const fn signed_starts(&self) -> i64 {
        let starts = self.starts as i64;
        match self.hand {
            Hand::Right => starts,
            Hand::Left => -starts,
        }
    }
}

/// An insert of a lathe, as it stands in the plane of the work's axis, its point towards the work.
///
/// ```text
///     threading                            turning                              grooving, parting
///     crest_height ──┬─┐        ┌─          │  ╲ angle   ╱  trailing edge        │     │
///                    │  ╲ angle╱            │    ╲    ╱                          │     │
///                    │   ╲    ╱     approach╰╲     ╱    180° − approach − angle  │     │
///                    ┴    ╲__╱                 ╰─╯ nose                          └─────┘ width
///                         point: a nose radius, or a flat         ◄─ chuck
/// ```
///
/// The form belongs to the tool: it is the same whichever way the tool moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Insert {
    /// Between its flanks or edges: 60° for metric and unified threads.
    pub angle: Angle,
    /// Its point; `None`: the table does not say.
    pub point: Option<InsertPoint>,
    /// From its point to the edge that cuts the crest; `None`: partial profile, which leaves the
    /// crest as it is.
    pub crest_height: Option<Length>,
    /// Its edges beside the point.
    pub edges: InsertEdges,
    /// Where its point lies from the middle of its nose; `None`: the table does not say.
    pub orientation: Option<InsertOrientation>,
}

/// The edges of an insert beside its point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InsertEdges {
    /// Two flanks, symmetric about the point: threads.
    Profile,
    /// A corner with a leading and a trailing edge: turning and facing.
    Corner {
        /// Between the leading edge and the way along the axis in which it is fed (ISO 3002-1: κr).
        approach: Angle,
        /// Length of each edge.
        length: Length,
    },
    /// Sides at a right angle to the edge: grooving and parting.
    Square,
}

/// Where the point of an insert lies from the middle of its nose, by Fanuc's numbers: X+ is away
/// from the work's axis, Z+ away from the chuck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InsertOrientation(u8);

impl InsertOrientation {
    /// By its number, 1 to 9.
    pub const fn new(number: u8) -> Option<Self> {
        if number >= 1 && number <= 9 { Some(Self(number)) } else { None }
    }

    /// Its number, 1 to 9.
    pub const fn number(self) -> u8 {
        self.0
    }

    /// −1: towards the chuck; +1: towards the free end; 0: neither.
    pub const fn along(self) -> i8 {
        match self.0 {
            2 | 3 | 7 => -1,
            1 | 4 | 5 => 1,
            _ => 0,
        }
    }

    /// It points along the work's axis alone, as for a thread in a face.
    pub const fn is_axial(self) -> bool {
        matches!(self.0, 5 | 7)
    }

    /// Coordinates are those of the middle of its nose.
    pub const fn is_middle(self) -> bool {
        self.0 == 9
    }
}

impl Insert {
    /// Angle between the leading edge of a turning insert and its feed where it is not stated (ISO
    /// 5608: L, 95°).
    pub const APPROACH: Angle = Angle::deg(95.0);
    /// Length of a turning insert's edges where it is not stated (ISO 1832: size 12).
    pub const EDGE: Length = Length::mm(12.0);

    /// An insert that cuts threads, pointed as its flat or nose says.
    pub const fn threading(
        angle: Angle,
        point: Option<InsertPoint>,
        crest_height: Option<Length>,
    ) -> Self {
        Self { angle, point, crest_height, edges: InsertEdges::Profile, orientation: None }
    }

    /// One that turns, with this angle and nose.
    pub const fn turning(angle: Angle, nose: Length) -> Self {
        let edges = InsertEdges::Corner { approach: Self::APPROACH, length: Self::EDGE };
        let point = Some(InsertPoint::Nose(nose));
        Self { angle, point, crest_height: None, edges, orientation: None }
    }

    /// One that cuts grooves of this width.
    pub const fn grooving(width: Length) -> Self {
        let point = Some(InsertPoint::Flat(width));
        let (edges, angle) = (InsertEdges::Square, Angle::ZERO);
        Self { angle, point, crest_height: None, edges, orientation: None }
    }

    /// Twice its nose radius, which tables of lathes state as its diameter; zero for another point.
    pub fn nose_diameter(&self) -> Length {
        match self.point {
            Some(InsertPoint::Nose(radius)) => radius * 2.0,
            Some(InsertPoint::Flat(_)) | None => Length::ZERO,
        }
    }
}

/// The point of an insert.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InsertPoint {
    /// Rounded with this radius.
    Nose(Length),
    /// Flat over this width.
    Flat(Length),
}

/// A tap.
#[derive(Clone, Debug, PartialEq)]
pub struct TapTool {
    /// Thread it makes, such as "M6x1" or "1/4-20 UNC".
    pub designation: String,
    /// Lead of its helix; negative for a left-hand tap.
    pub lead: Lead,
    /// Length of its chamfer, in pitches (2–3 bottoming, 4–5 plug).
    pub chamfer_pitches: f64,
    /// Longest thread it can cut: its flutes end there.
    pub thread_length: Length,
    /// How its flutes carry chips.
    pub flute: Flute,
    /// Pitch diameter of the tap over the basic pitch diameter (tap class, ISO 2857).
    pub oversize: Length,
    /// What holds it.
    pub holder: Holder,
    /// Torque from which on it is taken out of its hole; `None`: seven tenths of what breaks it.
    pub max_torque: Option<Torque>,
}

/// Flute forms; they differ in torque.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flute {
    /// Chips come out upwards: blind holes.
    SpiralFlute,
    /// Chips go ahead: through holes.
    SpiralPoint,
    /// Chips stay.
    Straight,
}

/// Tap holders: springs between spindle and tap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Holder {
    /// Collet: 10–30 N/µm.
    Rigid {
        /// Axial stiffness.
        stiffness: Stiffness,
    },
    /// Synchro holder with a little axial play: 0.2–1 N/µm over ±0.5 mm.
    SoftSynchro {
        /// Axial stiffness.
        stiffness: Stiffness,
        /// Travel each way.
        travel: Length,
    },
    /// Tension/compression holder: 10–40 N/mm over ±8 mm.
    TensionCompression {
        /// Axial stiffness.
        stiffness: Stiffness,
        /// Travel each way.
        travel: Length,
    },
    /// Clutch (floating) holder: its splines part when the tap has pulled it out far enough, so
    /// that the tap stops at a depth which the spindle's coasting does not change; a pawl drives it
    /// back out.
    Clutch {
        /// D: pulled out so far, the splines part.
        spline_length: Length,
        /// β: from the reversal until the pawl drives.
        pawl_backlash: Angle,
        /// Of the spring that brings it home: 2–20 N/mm.
        stiffness: Stiffness,
        /// Travel towards the spindle from home, on the same spring.
        compression: Length,
    },
}

impl Holder {
    /// Axial stiffness within its travel.
    pub const fn stiffness(self) -> Stiffness {
        match self {
            Self::Rigid { stiffness }
            | Self::SoftSynchro { stiffness, .. }
            | Self::TensionCompression { stiffness, .. }
            | Self::Clutch { stiffness, .. } => stiffness,
        }
    }

    /// How far it gives each way until it is stiff; `None`: it is one spring, or parts.
    pub const fn travel(self) -> Option<Length> {
        match self {
            Self::SoftSynchro { travel, .. } | Self::TensionCompression { travel, .. } => {
                Some(travel)
            }
            Self::Rigid { .. } | Self::Clutch { .. } => None,
        }
    }
}

/// All tools, by number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolLibrary {
    tools: Vec<Tool>,
}

impl ToolLibrary {
    /// From any order; of two tools with one number the later one counts.
    pub fn new(tools: impl IntoIterator<Item = Tool>) -> Self {
        let mut library = Self::default();
        for tool in tools {
            library.insert(tool);
        }
        library
    }

    /// Add a tool, or replace the one with its number.
    pub fn insert(&mut self, tool: Tool) {
        match self.tools.binary_search_by_key(&tool.number, |t| t.number) {
            Ok(at) => self.tools[at] = tool,
            Err(at) => self.tools.insert(at, tool),
        }
    }

    /// The tool with this number.
    #[inline]
    pub fn get(&self, number: u32) -> Option<&Tool> {
        let at = self.tools.binary_search_by_key(&number, |t| t.number).ok()?;
        Some(&self.tools[at])
    }

    /// All tools, by rising number.
    pub fn iter(&self) -> impl Iterator<Item = &Tool> {
        self.tools.iter()
    }
}
