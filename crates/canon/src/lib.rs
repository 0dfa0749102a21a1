//! What to machine: the narrow waist between programs and motion.
//!
//! An interpreter, whatever its dialect, ends in [`Op`]s; planner, kernel and judge begin with
//! them. Everything the text could say in several ways is said here in one: millimetres,
//! revolutions and seconds; *machine coordinates of the axes* (work offsets, rotation, tool length
//! offset, diameter mode, G91 and inches are already applied); arcs with an absolute centre. What
//! an op knows of its text is its [`Span`], and nothing else.
//!
//! ```text
//!   Op ─┬─ motion     Rapid, Line, Arc, Tap, Threading
//!       ├─ waiting    Dwell, Pause, End
//!       ├─ coupling   Polygon, PolygonMeasure, PolygonEnd, Hob, HobEnd, Cam
//!       ├─ switching  Spindle, Coolant, SelectTool, ChangeTool, PathMode, Spline, Overrides, Output, Input, UserCode
//!       └─ meaning    Hole (what the moves that follow are for), Message
//! ```
//!
//! An axis coordinate is where the *axis* stands. The tool's tip is `axis − tool length offset`
//! along the tool axis; the judge and the simulated workpiece know the mounted tool and do that
//! subtraction.
#![no_std]
extern crate alloc;

mod cam;
mod coupling;
mod frame;
mod material;
mod op;
mod sequence;
mod series;
mod thread;
mod tool;
mod tool_life;
mod words;

pub use cam::{CamLibrary, CamOrder, CamProfile};
pub use coupling::{Actuator, GearAsked, Harmonic, Hob, Oscillating, Oscillation, Polygon};
pub use diag::Span;
pub use frame::{Counting, LengthUnit, ProgramFrame};
pub use material::Material;
pub use op::{
    Answer, Await, ChipRemoval, Feed, Hole, InputWait, Op, OpKind, Output, PathMode, Probe,
    ReturnAcceleration, Signal, SpindleOrder, Spline, Tap, Threading, UserCode,
};
pub use sequence::{
    Carousel, Handover, Magazine, Pocket, Resume, Sequence, SequenceStage, SequenceStep,
    SignalStates, ToolChange, When,
};
pub use series::standard_sizes;
pub use thread::{Family, Hand, ThreadSize, UnknownSize};
pub use tool::{
    Body, CutterMaterial, Flute, HobTool, Holder, Insert, InsertEdges, InsertOrientation,
    InsertPoint, Mill, MillForm, MillLimits, PolygonCutter, TapTool, Tool, ToolKind, ToolLibrary,
    TouchProbe,
};
pub use tool_life::{AtLimit, ToolLife, ToolLimit, ToolUse, ToolWear, UseCount};
pub use units::{Arc, Axis, Plane, Position, Ratio};
pub use words::{RapidIntoStock, WrittenPlace, number};
