//! A loaded program and all that it meets: text, machine, tools, parameters, cams; what is known
//! before anything moves.
//!
//! ```text
//!   options ─► session ─► operations ─► preflight ─► time, run
//!                │            ▲
//!       subprograms, cams   restart
//! ```
pub mod cams;
pub mod choice;
mod clamped;
pub(crate) use clamped::ClampedStock;
mod described;
pub mod dialect;
pub mod drawn;
mod drill_size;
mod interruption;
mod live;
pub mod mill_stock;
mod operations;
pub mod options;
pub mod preflight;
pub mod program_files;
pub mod restart;
mod session;
mod session_files;
mod side_by_side;
mod stock_comments;
pub mod subprograms;
pub mod table_notes;
mod texts;
mod wear_comments;

pub use interruption::{Interruption, ReadProgress};
pub use live::Live;
pub use operations::{Before, Cursor, Left, Operations, Reading, Source};
pub use options::ProgramOptions;
pub use session::{Session, read_program, tools};
pub use texts::Texts;

/// The embedded machine that is taken where none is named.
pub const DEFAULT_MACHINE: &str = "tapping-center";
