//! A control that stays on: what it is, what can be asked of it, and what becomes of that.
//!
//! ```text
//!   Request ──► Control::request ──► accepted, with what is to be known of it │ refused: why, and what would make it possible
//!                    │
//!   time    ──► Control::period ──► Executor::period, Running::period ──► Event: what has happened
//!                    │
//!                    └► Status: all that a panel shows
//! ```
//!
//! | file | is |
//! |---|---|
//! | `request`, `needs` | everything that can be asked for, and what it needs; whether that is met |
//! | `state` | execution, mode, power, emergency stop; the transitions |
//! | `control`, `data` | the control: which request leads where, and the period; what is set on it |
//! | `drives` | power, emergency stop, reset, what takes a tool out of the work |
//! | `manual` | jog, handwheel, spindle by hand |
//! | `panel`, `panel_keys` | a panel beside the machine |
//! | `programs` | load, search, start, blocks that are typed, the end |
//! | `offsets` | work offsets, touch off, tools |
//! | `proving`, `proof` | texts interpreted and judged apart from the control, which goes on meanwhile; what for |
//! | `timing` | the time of a long program, planned after it is known to be fit |
//! | `under_way` | a program that is loaded, and one that is under way; what ties a tool to the work |
//! | `kept`, `keeping` | the state folder; what outlives the control goes there and comes back |
//! | `event`, `questions`, `status` | what happened; what a front end asks; how things are |
//! | `outside`, `left_in_work` | a machine in another process and its sync record; a tool that a control before has left |
//! | `ended`, `recording` | a program that has ended, for report, certificate and history; the folder of its record |
//! | `workpiece`, `features` | the workpiece on the machine: its begin and end; what was cut from it |
//! | `meters`, `timeline` | measured speed and load; planned ends of operations, for the time left |
//! | `signals`, `tool_path` | what a scope shows; what a picture of the program is drawn from |
//! | `hosted` | a control in a thread of its own, paced by the clock, for any number of clients |
#![allow(clippy::unnecessary_wraps)] // every request is answered alike: accepted, or refused

mod broken_tools;
mod changer;
mod control;
mod data;
mod drives;
mod ended;
mod event;
mod features;
pub mod hosted;
mod keeping;
mod kept;
mod kernel_events;
mod left_in_work;
mod manual;
mod message;
mod meters;
mod needs;
mod offsets;
mod outside;
mod panel;
mod panel_keys;
mod programs;
mod proof;
mod proving;
mod questions;
mod ranges;
mod recording;
mod request;
mod sequence;
mod signals;
mod state;
mod status;
mod timeline;
mod timing;
mod tool_path;
mod under_way;
mod workpiece;
mod writer;

pub use control::{Control, ControlOptions};
pub use ended::EndedProgram;
pub use event::{Alarm, Event};
pub use features::{FeatureCount, MOST_SHOWN, WorkpieceStatus, said_of};
pub use kept::kept_parameters;
pub use message::MessageStatus;
pub use outside::LeftInWork;
pub use proof::ProofMark;
pub use proving::{Begun, Found, Proven, Proving};
pub use request::{Accepted, Jog, Refusal, Request, SequenceOrder, ToolField};
pub use sequence::{MagazineStatus, SequenceInput, SequenceStatus};
pub use signals::Signals;
pub use state::{EmergencyStop, Execution, ExecutionEvent, Mode, Need, Power};
pub use status::{
    AxisStatus, LoadingStatus, NeedStatus, Overrides, ProgramStatus, SpindleStatus,
    StateChangeStatus, Status, Switches, WaitingStatus,
};
pub use timing::{Timed, Timing};
pub use tool_path::{PathHole, PathKind, Segment, ToolPath};
pub use under_way::LoadedProgram;
