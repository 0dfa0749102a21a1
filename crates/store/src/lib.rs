//! Files that outlive a run: read with every mistake named at once, written whole or not at all.
//!
//! ```text
//!   machine.toml ──► machine     tools.toml, tool.tbl ──► tools     parameters.var ◄─► parameters
//!                                        run
//!   parameters, tools, homing, program, alarms, settings ◄─► state::StateFolder   (a control that stays on)
//!   bus::Sample  ──► trace ──┐
//!   features     ──► certificate ──┴─► output::Folder ══ rename ══► out/   (complete, or not there)
//! ```
//!
//! Units end at this edge: a key or column carries its unit in its name, a field its quantity.
mod bases;
pub mod begun_run;
pub mod cams;
pub mod certificate;
mod kept_file;
pub mod learning;
pub mod linuxcnc;
pub mod machine;
mod nearest;
pub mod output;
pub mod parameters;
pub mod phases;
pub mod regular;
pub mod solid;
pub mod state;
pub mod sync_record;
pub mod tools;
pub mod trace;

mod asked_key;
mod error;
mod keys;
mod text;

pub use asked_key::AskedKey;
pub use error::{Error, Refusal};
pub use text::{
    MOST_FINDINGS, PROGRAM_LIMIT, SMALL_FILE_LIMIT, open, read_bytes, read_stream, read_text,
};
