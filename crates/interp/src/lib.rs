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
//! The [`Interpreter`] executes a program's blocks and says what they order, [`Call`] by call, in the
//! program's own frame and units, to whoever listens ([`Sink`]). [`Resolver`] turns the calls into
//! [`canon::Op`]: machine coordinates of the axes in millimetres, revolutions and seconds. This crate
//! knows neither time nor machines.
//!
//! ```
//! let setup = interp::Setup::default();
//! let mut ops = interp::Ops::new(b"G20 G90\nF10\nG1 X2\nM2\n", &setup);
//! let lines: Vec<_> = ops.by_ref().filter(|op| matches!(op.kind, canon::OpKind::Line { .. })).collect();
//! let canon::OpKind::Line { to, .. } = lines[0].kind else { unreachable!() };
//! assert_eq!(to.linear[0].value(), 50.8);
//! assert!(ops.diagnostics().is_empty());
//! ```

mod arcs;
mod auxiliary;
mod boring;
mod call;
mod cam;
mod catalogue;
mod chips;
mod codes;
mod comments;
mod compensation;
mod contents;
mod context;
mod cycles;
mod decimal;
mod dialect;
mod distances;
mod eval;
mod execute;
mod executor;
mod explain;
mod fault;
mod flow;
mod frame;
mod front_end;
mod hobbing;
mod holes;
mod interpreter;
mod lint;
mod listing;
mod live;
mod modes;
mod motion;
mod names;
mod next_text;
mod non_modal;
mod number;
mod offset_curve;
mod offsets;
mod ops;
mod orders;
mod other_dialect;
mod other_machine;
mod out;
mod outline;
mod outputs;
mod pieces;
mod polygon;
mod probe;
mod profile;
mod program;
mod refused;
mod reread;
mod resolve;
mod rigid;
mod rounds;
mod rs274;
mod setup;
mod snapshot;
mod spelling;
mod splines;
mod stroke;
mod switch;
mod synchro;
mod taps;
mod target;
mod thread_cycle;
mod threads;
mod tool_change;
mod tool_table;
mod tools;
mod unknown;
mod whole_units;
mod words;

pub use call::{
    Call, CamCall, ControlPoint, Corners, CycleHole, CycleTap, GrowingThread, HobOrder, Place,
    PolygonOrder, ReturnSpeed, Sense, Silence, Sink, StrokeZone, ToolEntry, Units,
};
pub use catalogue::{CodeInfo, codes, describe, describe_in, dialect_codes};
pub use contents::Contents;
pub use dialect::{DepthFrom, Dialect};
pub use explain::{Finding, example_setup, explain, findings};
pub use frame::{Frame, Point};
pub use interpreter::{Interpreter, Progress};
pub use lint::{Lint, lint};
pub use listing::Listing;
pub use live::{Live, asks};
pub use ops::{
    Ops, called_files, check, defined_subprograms, files_called_by_word, suspicion, with_dialect,
};
pub use other_dialect::{looks_like, other_dialect, telling_words};
pub use other_machine::{is_turned, unended};
pub use pieces::{Linter, OpsRest, Rest, can_be_read_in_pieces};
pub use resolve::Resolver;
pub use setup::{
    Aside, Chips, Cycles, Increments, Leaves, Limits, MAX_PARAMETER, MacroCall, MissingTools,
    Parameters, Setup, Subprogram, UserAction, UserCode,
};
pub use snapshot::{Snapshot, Standing};
pub use unknown::Unknown;
pub use whole_units::counts_whole_units;
