//! What the interpreter says, call by call, in the program's own frame and units.
//!
//! These are the canonical machining functions of RS-274 (NISTIR 6556, section 4), as far as a
//! program can cause them. Two listeners are here: [`Listing`](crate::Listing) prints them as
//! LinuxCNC's stand-alone interpreter does, [`Resolver`](crate::Resolver) turns them into
//! [`canon::Op`]. What the two need differently is kept whole in one call: a tapping cycle is one
//! [`Call::Tap`], which the listing expands into LinuxCNC's moves and the resolver does not.
pub(crate) mod orders;
pub(crate) mod out;

use crate::geometry::frame::Point;
pub use orders::{CamCall, ControlPoint, HobOrder, PolygonOrder, StrokeZone, ToolEntry};

use canon::{InputWait, Output, Plane};
use diag::Span;
use units::TurnDirection;

/// Where a call comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The block.
    pub span: Span,
    /// Its N word.
    pub number: Option<u32>,
}

/// Who listens to an interpreter.
pub trait Sink {
    /// One call. Calls come in the order in which a machine would obey them.
    fn call(&mut self, place: &Place, call: &Call<'_>);

    /// From here on this much is unknown, because a block before was refused.
    fn suppress(&mut self, _: crate::Unknown) {}

    /// Returns true if the machine moves or waits by a call since this was asked last.
    fn take_time_passed(&mut self) -> bool {
        false
    }

    /// What an operation has missed, and was told of.
    fn missed(&self) -> crate::Unknown {
        crate::Unknown::default()
    }
}

/// What is called is not told.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silence;

impl Sink for Silence {
    #[inline]
    fn call(&mut self, _: &Place, _: &Call<'_>) {}
}

/// Units of length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// G20.
    Inch,
    /// G21.
    #[default]
    Millimetre,
}

impl Units {
    /// Millimetres in one unit.
    pub const fn in_mm(self) -> f64 {
        match self {
            Self::Inch => units::MM_PER_INCH,
            Self::Millimetre => 1.0,
        }
    }

    /// The unit's symbol.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Inch => "in",
            Self::Millimetre => "mm",
        }
    }
}

/// Sense of rotation, seen from behind the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// M3.
    Clockwise,
    /// M4.
    Counterclockwise,
}

impl Sense {
    /// The other one.
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Clockwise => Self::Counterclockwise,
            Self::Counterclockwise => Self::Clockwise,
        }
    }
}

/// How corners are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corners {
    /// G61.
    ExactPath,
    /// G61.1.
    ExactStop,
    /// G64, with P in program units (0: not stated).
    Continuous(f64),
}

/// A drilling, boring or tapping cycle at one hole, in the program's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleHole {
    /// The plane; the cycle goes along its normal.
    pub plane: Plane,
    /// Over the hole at the R plane.
    pub at: Point,
    /// Z (or Y, X): how deep.
    pub bottom: f64,
    /// Where the cycle ends: R (G99) or the initial level (G98).
    pub clear: f64,
    /// Chips are thrown off on the way out, from R on, by turning against the cut at this speed.
    pub throw_rpm: Option<f64>,
}

/// A straight stretch of a thread whose lead grows: `lead·n + growth·n²/2` of the path after n
/// turns, program units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowingThread {
    /// From here, in the program's frame …
    pub from: Point,
    /// … to here.
    pub to: Point,
    /// Path per revolution where it begins.
    pub lead: f64,
    /// By how much that grows with each revolution.
    pub growth: f64,
}

/// A tapping cycle at one hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleTap {
    /// Where.
    pub hole: CycleHole,
    /// Sense of rotation inwards.
    pub sense: Sense,
    /// Wait at the bottom, seconds.
    pub dwell_s: f64,
    /// A: where in its turn the spindle stands when the thread begins, degrees.
    pub start_angle_deg: f64,
    /// J: how fast it comes out.
    pub return_speed: ReturnSpeed,
    /// I: how hard the spindle is driven on the way out.
    pub return_acceleration: canon::ReturnAcceleration,
    /// Q: depth of each peck.
    pub peck: Option<f64>,
    /// Overrides of feed and spindle that are on, and are off while tapping.
    pub overrides: (bool, bool),
    /// F stands in the tap's own block; in a clutch holder an older one is no order to the tap.
    pub feed_stated: bool,
    /// The lead in mm where the block states it, whatever F is: Brother's I and J.
    pub lead_mm: Option<f64>,
}

/// How fast a tap comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReturnSpeed {
    /// So many times as fast as it goes in.
    Times(f64),
    /// At so many revolutions per minute.
    Rpm(f64),
}

/// One canonical machining function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Call<'a> {
    /// The interpreter begins or is reset.
    Reset,
    /// The machine's feed reference: the path of X, Y, Z.
    FeedReference,
    /// G20, G21.
    UseUnits(Units),
    /// G54 … G59.3 or a change of the one in force: number (1 is G54) and offset.
    WorkOffset(u8, Point),
    /// G92, G52.
    AddedOffset(Point),
    /// Rotation of the work offset, degrees.
    Rotation(f64),
    /// G43, G43.1, G43.2, G49.
    ToolOffset(Point),
    /// G17, G18, G19.
    SelectPlane(Plane),
    /// G93, G94 (false), G95 (true).
    FeedMode {
        /// F is a length per revolution.
        per_revolution: bool,
    },
    /// Feed per minute or per revolution. With G93 also how long the next move takes, seconds.
    FeedRate {
        /// Feed.
        rate: f64,
        /// How long the move that follows takes.
        duration_s: Option<f64>,
    },
    /// G61, G61.1, G64.
    PathControl {
        /// How corners are taken.
        corners: Corners,
        /// Q of G64, where it is said anew.
        merge: Option<f64>,
    },
    /// G0.
    Rapid(Point),
    /// G1.
    Line(Point),
    /// G2, G3.
    Arc {
        /// The plane.
        plane: Plane,
        /// Where to.
        to: Point,
        /// Centre, along the plane's first and second axis.
        centre: [f64; 2],
        /// Turns begun: 1 or more counter-clockwise, −1 or less clockwise.
        turns: i32,
    },
    /// G5, G5.1, G5.2 … G5.3: a NURBS from where it stands, in X and Y.
    Spline {
        /// Order, the degree plus one.
        order: usize,
        /// Control points; the first is where it stands.
        points: &'a [ControlPoint],
    },
    /// G38.2 … G38.5: to here, or to where the probe touches.
    Probe {
        /// Where to.
        to: Point,
        /// Contact ends it; else the end of contact.
        until_contact: bool,
        /// It is an alarm if the probe has not changed at its end.
        required: bool,
    },
    /// A cycle is about to make a hole; its moves follow, up to the end of the cycle's block or the
    /// next hole.
    Hole(CycleHole),
    /// Chip removal: from R on, on the rapid out of this hole that follows. For a tap its hole says
    /// it.
    ThrowChips(CycleHole),
    /// G84, G74: the tap stands at R. In and out again, up to the hole's clear level.
    Tap(CycleTap),
    /// G33.1.
    RigidTap {
        /// To here and back.
        to: Point,
        /// K.
        lead: f64,
        /// I: speed of the way out over that of the way in.
        return_factor: f64,
        /// Sense of rotation inwards.
        sense: Sense,
    },
    /// Q of Fanuc's threads: where in its turn the spindle stands when the thread that follows
    /// begins, degrees.
    ThreadAngle(f64),
    /// G34.
    GrowingThread(GrowingThread),
    /// G33, G76: what follows is synchronised with the spindle at this lead.
    SyncStart(f64),
    /// The end of that.
    SyncStop,
    /// G150 … G155.
    Cam(CamCall),
    /// G22: from here on no axis may enter this box, or leave it; G23: none.
    StrokeCheck(Option<StrokeZone>),
    /// G4, seconds.
    Dwell(f64),
    /// G51.2: the tool spindle is geared to the work spindle.
    Polygon(&'a PolygonOrder),
    /// G51.4, and how many looks.
    PolygonMeasure(u32),
    /// G50.2.
    PolygonEnd,
    /// G81 T L Q P: the work is geared to the hob.
    Hob(&'a HobOrder),
    /// The end of that.
    HobEnd,
    /// S.
    SpindleSpeed(f64),
    /// G96 (D; infinite if not stated), G97 (0): highest speed of constant surface speed.
    SpindleMode(f64),
    /// M3, M4.
    SpindleTurn(Sense),
    /// M5.
    SpindleStop,
    /// M19 R, P, Q.
    SpindleOrient {
        /// Degrees.
        angle: f64,
        /// How it comes there.
        direction: TurnDirection,
        /// The number that LinuxCNC's call has for that: 0, 1 and 2 of M19, 2 and 3 of a cycle that
        /// turns on clockwise and counter-clockwise.
        mode: u8,
        /// Longest wait for it, seconds.
        longest: Option<f64>,
    },
    /// T.
    SelectTool(u32),
    /// M6 begins.
    StartChange,
    /// M6.
    ChangeTool(u32),
    /// M61: the spindle has had this tool all along.
    ToolNumber(u32),
    /// G10 L0.
    ReloadTools,
    /// G10 L1, L10, L11: what the control believes about a tool from here on.
    ToolTableEntry {
        /// Its place in the table, from 1; 0 is the spindle.
        rank: u32,
        /// What is written.
        entry: ToolEntry,
    },
    /// M62 … M65, M67, M68.
    Output(Output),
    /// M66.
    Input(InputWait),
    /// M100 … M199.
    User {
        /// The number after M.
        number: u16,
        /// What it does, by the machine's file.
        name: &'a str,
        /// P.
        p: Option<f64>,
        /// Q.
        q: Option<f64>,
    },
    /// M7, M9.
    Mist(bool),
    /// M8, M9.
    Flood(bool),
    /// M48, M49, M50.
    FeedOverride(bool),
    /// M48, M49, M51.
    SpeedOverride(bool),
    /// M52.
    AdaptiveFeed(bool),
    /// M53.
    FeedHold(bool),
    /// M0, M60.
    Stop,
    /// M1.
    OptionalStop,
    /// G88: after the stop for the operator, out to here, wherever he left the axis.
    OutByHand(Point),
    /// M60, M30.
    PalletShuttle,
    /// M2, M30.
    End,
    /// The second `%`.
    Finish,
    /// A comment.
    Comment(&'a str),
    /// What the interpreter notes about itself; LinuxCNC prints it as a comment.
    Note(&'a str),
    /// (MSG,…), (DEBUG,…).
    Message(&'a str),
    /// (PRINT,…).
    Print(&'a str),
    /// (LOGOPEN,…), (LOGAPPEND,…).
    LogOpen(&'a str),
    /// (LOG,…).
    Log(&'a str),
    /// (LOGCLOSE).
    LogClose,
}
