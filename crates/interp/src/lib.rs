//! Blocks and modal state to operations.
//!
//! ```text
//!               ┌──────────── Interpreter ────────────┐            ┌─► Listing   (LinuxCNC's notation)
//!   gcode ─────►│ words → modes → motion, cycles, …   │── Call ──►─┤
//!   Block       │ O-words: branches, loops, calls     │            └─► Resolver  ──► canon::Op
//!               └──────────────┬──────────────────────┘                 offsets, inches, G91,
//!                              ▼                                        diameters end here
//!                          Diagnostics
//! ```
//!
//! The [`Interpreter`] executes a program's blocks and says what they order, [`Call`] by call, in
//! the program's own frame and units, to a listener ([`Sink`]). [`Resolver`] turns the calls
//! into [`canon::Op`]: machine coordinates of the axes in millimetres, revolutions and seconds.
//! This crate knows neither time nor machines.
//!
//! ```
//! let setup = interp::Setup::default();
//! let mut ops = interp::Ops::new(b"G20 G90\nF10\nG1 X2\nM2\n", &setup);
//! let lines: Vec<_> = ops.by_ref().filter(|op| matches!(op.kind, canon::OpKind::Line { .. })).collect();
//! let canon::OpKind::Line { to, .. } = lines[0].kind else { unreachable!() };
//! assert_eq!(to.linear[0].value(), 50.8);
//! assert!(ops.diagnostics().is_empty());
//! ```

mod auxiliary;
mod call;
mod codes;
mod compensation;
mod coordinates;
mod cycles;
mod dialect;
mod evidence;
mod execute;
mod explain;
mod fault;
mod front_end;
mod geometry;
mod interpreter;
mod listing;
mod modes;
mod motion;
mod operations;
mod profile;
mod program;
mod resolve;
mod setup;
mod state;
mod words;

pub use call::{
    Call, CamCall, ControlPoint, Corners, CycleHole, CycleTap, GrowingThread, HobOrder, Place,
    PolygonOrder, ReturnSpeed, Sense, Silence, Sink, StrokeZone, ToolEntry, Units,
};
pub use dialect::fanuc::counts::counting_words;
pub use dialect::{DepthFrom, Dialect};
pub use evidence::other_dialect::{looks_like, other_dialect, telling_words};
pub use evidence::other_machine::{
    SpecialWork, has_whole_lengths, has_word, is_for_a_sender, is_turned, special_work,
    stops_at_rest, unended,
};
pub use evidence::whole_units::counts_whole_units;
pub use explain::catalogue::{CodeInfo, codes, describe, describe_in, dialect_codes};
pub use explain::elsewhere::SENTENCES;
pub use explain::page::{explanation, explanations, found_in_example};
pub use explain::{Finding, example_setup, explain, findings};
pub use fault::unknown::Unknown;
pub use geometry::frame::{Frame, Point};
pub use interpreter::codes_in_force::CodesInForce;
pub use interpreter::contents::Contents;
pub use interpreter::snapshot::{Snapshot, Standing};
pub use interpreter::{Interpreter, Progress};
pub use listing::Listing;
pub use operations::lint::{Lint, lint};
pub use operations::live::{Live, asks};
pub use operations::ops::{
    Ops, called_files, check, defined_subprograms, files_called_by_word, suspicion, with_dialect,
};
pub use operations::pieces::{Linter, OpsRest, Rest, can_be_read_in_pieces};
pub use resolve::Resolver;
pub use setup::{
    Aside, BreakOff, Chips, CodeAction, Cycles, Increments, Leaves, Limits, MAX_PARAMETER,
    MachineCode, MacroCall, MissingTools, Parameters, Setup, Subprogram, WearOffsets,
};
