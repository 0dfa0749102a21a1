//! What holds from block to block: the modal state.
pub(crate) mod compensation;
pub(crate) mod motion;
pub(crate) mod nurbs;
pub(crate) mod tapping;

use crate::{
    call::{Corners, Sense, ToolEntry, Units},
    fault::unknown::Unknown,
    geometry::frame::{Frame, Point},
    modes::{
        compensation::Compensation,
        nurbs::Nurbs,
        tapping::{Rigid, Shift, TapWords},
    },
    setup::Chips,
};
use canon::Plane;
pub(crate) use motion::{Cycle, Motion};

/// What F means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FeedMode {
    /// G93: moves per minute.
    InverseTime,
    /// G94.
    PerMinute,
    /// G95.
    PerRevolution,
}

/// The spindle as the program has ordered it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spindle {
    /// S.
    pub(crate) speed: f64,
    /// M3, M4; none after M5.
    pub(crate) turning: Option<Sense>,
    /// G96.
    pub(crate) constant_surface_speed: bool,
    /// D of G96, rev/min.
    pub(crate) limit: f64,
    /// S of the last G96, once another mode is in force; 0: there was none.
    pub(crate) surface_speed: f64,
}

/// What a cycle keeps for the blocks that repeat it: the words as written, and how they were meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sticky {
    pub(crate) r: f64,
    pub(crate) bottom: f64,
    /// R and Z are ways, as under G91.
    pub(crate) by_way: [bool; 2],
    pub(crate) dwell: Option<f64>,
    pub(crate) peck: Option<f64>,
    pub(crate) tap: TapWords,
    /// I, J, K of G87.
    pub(crate) shift: Option<Shift>,
    /// U and E, or the machine's setting.
    pub(crate) chips: Option<Chips>,
    /// The plane they were given in.
    pub(crate) plane: Plane,
}

/// All of it.
#[allow(clippy::struct_excessive_bools)] // each is a mode with two values and a code of its own
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Modes {
    pub(crate) motion: Motion,
    pub(crate) plane: Plane,
    pub(crate) units: Units,
    /// G91.
    pub(crate) incremental: bool,
    /// G90.1.
    pub(crate) absolute_centres: bool,
    pub(crate) feed_mode: FeedMode,
    pub(crate) feed: f64,
    /// G98.
    pub(crate) retract_to_initial: bool,
    pub(crate) corners: Corners,
    /// Q of G64 in force.
    pub(crate) merge: f64,
    /// G7.
    pub(crate) diameter: bool,
    pub(crate) spindle: Spindle,
    /// M29, G84.2, G84.3.
    pub(crate) rigid: Rigid,
    pub(crate) sticky: Option<Sticky>,
    /// P of the last cycle that had one: a tap without P waits as long.
    pub(crate) last_dwell: Option<f64>,
    /// Holes made since the block that named the cycle.
    pub(crate) repetition: u32,
    /// Level to which G98 returns: where the axis stood before the first hole of the series.
    pub(crate) initial: Option<f64>,
    /// Work offset in force, 1 is G54.
    pub(crate) system: u8,
    /// Offsets, in program units.
    pub(crate) frame: Frame,
    /// Where the program stands, in its frame and units.
    pub(crate) at: Point,
    /// Control points since G5.2.
    pub(crate) nurbs: Option<Nurbs>,
    /// Direction in which the last G5 left, as I and J of the next one.
    pub(crate) spline_leaves: Option<[f64; 2]>,
    /// G41, G42.
    pub(crate) compensation: Option<Compensation>,
    /// G40 was the last, and the tool still stands beside the programmed point: here, in machine
    /// coordinates of program units.
    pub(crate) left_beside: Option<Point>,
    /// What the table says about the tool in the spindle.
    pub(crate) loaded: ToolEntry,
    pub(crate) selected_tool: u32,
    pub(crate) current_tool: u32,
    /// Pocket of the tool that T has called last; none before the first.
    pub(crate) selected_pocket: Option<u32>,
    pub(crate) current_pocket: u32,
    pub(crate) mist: bool,
    pub(crate) flood: bool,
    pub(crate) feed_override: bool,
    pub(crate) speed_override: bool,
    pub(crate) adaptive_feed: bool,
    pub(crate) feed_hold: bool,
    /// Block being executed, for `#<_line>`.
    pub(crate) line: u32,
    pub(crate) call_level: usize,
    /// `#<_value>` and `#<_value_returned>`.
    pub(crate) returned: Option<f64>,
    pub(crate) value: f64,
    /// Harmonics of G51.3 that wait for G51.2.
    pub(crate) swings: Vec<canon::Oscillation>,
    /// Between G51.2 and G50.2.
    pub(crate) polygon: bool,
    /// G81 T L Q P is in force.
    pub(crate) hobbing: bool,
    /// What the last (GEAR …) asks.
    pub(crate) gear: canon::GearAsked,
    /// G151: a cam's profile is in force.
    pub(crate) cam: bool,
    /// S of the last grinding block.
    pub(crate) cam_rpm: f64,
    /// What is not known since a block was refused.
    pub(crate) unknown: Unknown,
}

impl Modes {
    pub(crate) fn new() -> Self {
        Self {
            motion: Motion::None,
            plane: Plane::XY,
            units: Units::Millimetre,
            incremental: false,
            absolute_centres: false,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            retract_to_initial: false,
            corners: Corners::Continuous(0.0),
            merge: 0.0,
            diameter: false,
            spindle: Spindle {
                speed: 0.0,
                turning: None,
                constant_surface_speed: false,
                limit: 0.0,
                surface_speed: 0.0,
            },
            rigid: Rigid::Off,
            sticky: None,
            last_dwell: None,
            repetition: 0,
            initial: None,
            system: 1,
            frame: Frame::default(),
            at: [0.0; 9],
            nurbs: None,
            spline_leaves: None,
            compensation: None,
            left_beside: None,
            loaded: ToolEntry::default(),
            selected_tool: 0,
            current_tool: 0,
            selected_pocket: None,
            current_pocket: 0,
            mist: false,
            flood: false,
            feed_override: true,
            speed_override: true,
            adaptive_feed: false,
            feed_hold: true,
            line: 0,
            call_level: 0,
            returned: None,
            value: 0.0,
            swings: Vec::new(),
            polygon: false,
            hobbing: false,
            gear: canon::GearAsked::default(),
            cam: false,
            cam_rpm: 0.0,
            unknown: Unknown::default(),
        }
    }

    /// Where the tool is, as the program calls the place: beside `at` while it is compensated.
    pub(crate) fn place(&self) -> Point {
        if let Some(machine) = &self.left_beside {
            return self.frame.to_program(machine);
        }
        let mut at = self.at;
        if let Some(beside) = self.compensation.as_ref().and_then(Compensation::place) {
            let [a, b, _] = self.plane_axes();
            (at[a], at[b]) = (beside[0], beside[1]);
        }
        at
    }

    /// Whether moves go beside the programmed ones.
    #[inline]
    pub(crate) const fn compensating(&self) -> bool {
        self.compensation.is_some()
    }

    /// Indices of the plane's first axis, second axis and normal.
    #[inline]
    pub(crate) const fn plane_axes(&self) -> [usize; 3] {
        let [a, b, c] = self.plane.axes();
        [a.index(), b.index(), c.index()]
    }

    /// Change offsets while the axes stand still: the program's coordinates of that place change.
    pub(crate) fn reframe(&mut self, change: impl FnOnce(&mut Frame)) {
        let machine = self.frame.to_machine(&self.at);
        change(&mut self.frame);
        self.at = self.frame.to_program(&machine);
    }
}
