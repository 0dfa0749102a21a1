//! The operations.
use crate::{Arc, Axis, CamOrder, Hob, Polygon, Position, Span};
use alloc::boxed::Box;
use alloc::vec::Vec;
use units::{Angle, Lead, LeadGrowth, Length, Orientation, Speed, Spin, SpinAccel, Time};

/// One operation and the text it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Op {
    /// The block that ordered it.
    pub span: Span,
    /// What it orders.
    pub kind: OpKind,
}

/// No text has an operation there.
const TYPED: Span = Span { file: u16::MAX, line: 0, start: 0, end: 0 };

impl Op {
    /// The end of blocks that were typed, which have no word for it: spindles turn on.
    pub const fn end_of_typed() -> Self {
        Self { span: TYPED, kind: OpKind::End }
    }

    /// It ends blocks that were typed: no block has ordered it.
    pub fn ends_typed(&self) -> bool {
        matches!(self.kind, OpKind::End) && self.span == TYPED
    }
}

/// What an operation orders.
#[derive(Clone, Debug, PartialEq)]
pub enum OpKind {
    /// Move as fast as the axes allow, not cutting.
    Rapid {
        /// Where to.
        to: Position,
    },
    /// Move in a straight line at a feed.
    Line {
        /// Where to.
        to: Position,
        /// How fast.
        feed: Feed,
    },
    /// Move along a circle or helix at a feed.
    Arc {
        /// Where to.
        to: Position,
        /// Which circle.
        arc: Arc,
        /// How fast.
        feed: Feed,
    },
    /// Move along a spline at a feed.
    Spline {
        /// Where to.
        to: Position,
        /// Which curve.
        spline: Spline,
        /// How fast.
        feed: Feed,
    },
    /// Tap a hole, synchronised with the spindle, in and out. The axes stand at the start already.
    /// Afterwards the spindle stands still; an M3 or M4 in force is restored before the next cut.
    Tap(Tap),
    /// Turn a straight stretch of a thread; stretches one after another go on into one another
    /// without a stop.
    Threading(Threading),
    /// The moves that follow, up to the next op whose span differs or to the next `Hole`, make this
    /// hole.
    Hole(Hole),
    /// Wait.
    Dwell {
        /// How long.
        time: Time,
    },
    /// Order a spindle.
    Spindle {
        /// Which, counted from 0.
        spindle: u8,
        /// What it shall do.
        order: SpindleOrder,
    },
    /// Gear the tool spindle to the work spindle (G51.2); the work spindle turns already.
    Polygon(Polygon),
    /// End of it (G50.2): what swings comes to rest, then the tool spindle stops.
    PolygonEnd,
    /// Measure what swings while nothing is cut, and compensate it (G51.4): so many looks, a
    /// correction after each.
    PolygonMeasure {
        /// How many.
        looks: u32,
    },
    /// Gear the work to a hob that turns already (G81 T L Q P).
    Hob(Hob),
    /// End of it (G80): the work stops.
    HobEnd,
    /// Grind a cam: the wheel follows the work's angle by a profile.
    Cam(CamOrder),
    /// Switch coolant.
    Coolant {
        /// M7.
        mist: bool,
        /// M8.
        flood: bool,
    },
    /// Bring a tool to the changer (T).
    SelectTool {
        /// Its number.
        number: u32,
    },
    /// Put the selected tool into the spindle (M6).
    ChangeTool {
        /// Its number; 0 empties the spindle.
        number: u32,
    },
    /// How corners are taken from here on.
    PathMode(PathMode),
    /// Which overrides the operator has from here on.
    Overrides {
        /// Feed override.
        feed: bool,
        /// Spindle override.
        spindle: bool,
    },
    /// Stop until the operator goes on (M0, M1).
    Pause {
        /// M1: only if the operator has set optional stop.
        optional: bool,
    },
    /// Tell the operator something.
    Message(Box<str>),
    /// Switch an output (M62 … M65, M67, M68).
    Output(Output),
    /// Read an input or wait for it (M66); the program learns what was read.
    Input(InputWait),
    /// Move until a probe touches, or leaves what it touches (G38.2 … G38.5); the program learns
    /// where.
    Probe(Probe),
    /// A code of the machine's own (M100 … M199): what its file says that it does.
    UserCode(Box<UserCode>),
    /// The program is over.
    End,
}

/// An output and what it is switched to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output {
    /// Which of its kind, counted from 0.
    pub number: u8,
    /// What it is to be.
    pub signal: Signal,
    /// When the next move begins, not at once. The operation then comes right before that move.
    pub with_motion: bool,
}

/// What an output is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Signal {
    /// On or off.
    Digital {
        /// On.
        on: bool,
    },
    /// A value in the machine's own unit.
    Analogue {
        /// The value.
        value: f64,
    },
}

/// A move that a probe ends. It ends at `to` if the probe does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Where to.
    pub to: Position,
    /// How fast.
    pub feed: Speed,
    /// What ends it: contact (G38.2, G38.3), or the end of contact (G38.4, G38.5).
    pub until_contact: bool,
    /// It is an alarm if the probe has not changed at its end (G38.2, G38.4).
    pub required: bool,
}

/// What the machine answers to a program that asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// What an input was when the wait ended; `None`: the wait ran out of its time.
    Input(Option<f64>),
    /// What came of a probing move.
    Probe {
        /// Where the axes were when the probe changed, or at the end.
        contact: Position,
        /// Where they stand now.
        stands: Position,
        /// The probe has changed.
        changed: bool,
    },
}

/// An input, and what is waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputWait {
    /// Which of its kind, counted from 0.
    pub number: u8,
    /// On or off; else a value.
    pub digital: bool,
    /// What ends the wait.
    pub until: Await,
    /// How long it lasts at most.
    pub longest: Time,
}

/// What a wait for an input waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Await {
    /// Nothing: the input is only read.
    Nothing,
    /// That it turns on.
    Rise,
    /// That it turns off.
    Fall,
    /// That it is on.
    On,
    /// That it is off.
    Off,
}

/// A code of the machine's own.
#[derive(Clone, Debug, PartialEq)]
pub struct UserCode {
    /// Its number after M.
    pub number: u16,
    /// What it does, by the machine's file.
    pub name: Box<str>,
    /// Its P word.
    pub p: Option<f64>,
    /// Its Q word.
    pub q: Option<f64>,
}

/// How fast a cutting move goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feed {
    /// G94.
    PerTime(Speed),
    /// G95: path length per spindle revolution.
    PerRevolution(Lead),
    /// G93, and moves of rotary axes alone: the whole move takes this long.
    Duration(Time),
}

/// A curve in X and Y, from where the axes stand; all others stay.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Bézier curves of the fifth degree, one after another: of each its four control points
    /// between its ends, and its end, in machine coordinates.
    pub pieces: Vec<[[Length; 2]; 5]>,
}

/// What a spindle is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpindleOrder {
    /// M5.
    Stop,
    /// M3 (positive) and M4 (negative).
    Turn(Spin),
    /// G96: constant surface speed.
    ConstantSurfaceSpeed {
        /// Surface speed; negative turns counter-clockwise.
        speed: Speed,
        /// Never faster than this (D word), if stated.
        limit: Option<Spin>,
    },
    /// M19.
    Orient {
        /// The angle, and how the spindle comes there.
        to: Orientation,
        /// For so long at most; `None`: as long as the machine gives it.
        longest: Option<Time>,
    },
    /// Throw the chips off the tool on the way from this hole to the next.
    ThrowChips(ChipRemoval),
}

/// Chips wound around a tool are thrown off by turning it backwards while the axes travel.
///
/// ```text
///   spindle  then ──╲                 ╱── then      the axes rise, move and come down meanwhile;
///                     ╲             ╱               the next cut waits for `then`
///              0 ───────╲─────────╱──────
///          throw          ╲_____╱   turned round as soon as it is reached
///                 ▲ `axis` passes `level` on the way out of the hole
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChipRemoval {
    /// The speed that throws them off; its sign is against the cut.
    pub throw: Spin,
    /// The speed to have before the next cut: that of the cut after drilling, zero after a tap.
    pub then: Spin,
    /// The axis that leaves the hole.
    pub axis: Axis,
    /// Machine coordinate of `axis` from which on it happens: the R plane.
    pub level: Length,
}

/// A synchronised tap. Coordinates are machine coordinates of the tapping axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tap {
    /// The axis that follows the spindle.
    pub axis: Axis,
    /// Where synchronisation starts and ends (the R plane; for G33.1 where the axis stood).
    pub start: Position,
    /// Where the spindle turns back: the programmed depth, as a coordinate of `axis`.
    pub bottom: Length,
    /// Where the material is taken to begin, as a coordinate of `axis`: the work's zero if it lies
    /// between start and bottom, else the start.
    pub surface: Length,
    /// The program's zero, as a coordinate of `axis`: with the work offset and the tool length
    /// offset in force.
    pub zero: Length,
    /// Where another work offset than the first (G55 and on) has its zero, without what G52, G92
    /// and the tool add; `None`: G54 is in force, whose place the set-up states.
    pub own_zero: Option<Length>,
    /// Advance along the tap's own direction per revolution; positive right-hand, negative
    /// left-hand.
    pub lead: Lead,
    /// Spindle speed inwards (magnitude; the hand gives the sense).
    pub spin: Spin,
    /// Spindle speed outwards (magnitude).
    pub return_spin: Spin,
    /// How hard the spindle is driven outwards.
    pub return_acceleration: ReturnAcceleration,
    /// Wait at the bottom.
    pub dwell: Time,
    /// Spindle angle at which the thread starts at `start`; `None`: wherever the spindle stands.
    pub start_angle: Option<Angle>,
    /// How deep each peck goes beyond the one before (Q); `None`: all the way at once.
    pub peck: Option<Length>,
}

/// A straight stretch of a thread turned with a single point (G33, G32, G34, G76). Coordinates are
/// machine coordinates.
///
/// The stretches of a chain are one function of the spindle's angle: where the first one starts,
/// the spindle stands at `start_angle`, and from there on the tool goes `lead` along the path with
/// each revolution; where the lead grows, `lead·n + growth·n²/2` in the n revolutions since the
/// stretch began. So passes over the same thread find the same groove, at any speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threading {
    /// Where it ends.
    pub to: Position,
    /// Length of path per revolution, where the stretch begins.
    pub lead: Lead,
    /// By how much that grows with each revolution; negative where it shrinks.
    pub growth: LeadGrowth,
    /// Spindle angle at which the chain's first stretch starts.
    pub start_angle: Angle,
    /// The axis along which the thread runs: the one that goes farthest.
    pub axis: Axis,
    /// Where the material is taken to begin, as a coordinate of `axis`: the work's zero if it lies
    /// between start and end, else the start.
    pub surface: Length,
}

/// How hard the spindle is driven on a tap's way out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ReturnAcceleration {
    /// As the machine is set.
    #[default]
    AsSet,
    /// With this share of it, above 0 and up to 1.
    Share(f64),
    /// With this acceleration, wherever torque and power leave as much.
    Limit(SpinAccel),
}

/// What a drilling cycle is about to make. Coordinates are machine coordinates of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// The axis that drills.
    pub axis: Axis,
    /// Over the hole, at the R plane.
    pub at: Position,
    /// Programmed depth, as a coordinate of `axis`.
    pub bottom: Length,
    /// Where the material is taken to begin (as for [`Tap::surface`]).
    pub surface: Length,
    /// The program's zero (as for [`Tap::zero`]).
    pub zero: Length,
    /// Zero of another work offset (as for [`Tap::own_zero`]).
    pub own_zero: Option<Length>,
}

/// How corners are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathMode {
    /// G61: the path is followed exactly; stop only where it must.
    Exact,
    /// G61.1: stop at the end of every move.
    ExactStop,
    /// G64: corners may be blended.
    Blend {
        /// P: how far from the programmed path, if stated.
        tolerance: Option<Length>,
        /// Q: how far collinear moves may be merged, if stated.
        merge: Option<Length>,
    },
}
