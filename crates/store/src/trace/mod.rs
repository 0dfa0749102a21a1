//! `trace.parquet`: one row per servo period, for any reader of Parquet.
//!
//! | column | type | unit, meaning | stored in steps of |
//! |---|---|---|---|
//! | `time_s` | f64 | since the machine was started | — |
//! | `<axis>_command_mm` | f64 | setpoint | 2⁻²⁶ mm, 15 pm: third differences are jerk |
//! | `<axis>_actual_mm` | f64 | where the table or ram really is; without a simulator as the encoder | 2⁻²⁰ mm |
//! | `<axis>_encoder_mm` | f64 | position by the encoder | 2⁻²⁰ mm |
//! | `<axis>_force_n` | f64 | force of the drive; without a simulator its reference | 2⁻⁷ N |
//! | `<axis>_command_deg`, `_actual_deg`, `_encoder_deg`, `_torque_n_m` | f64 | the same of a rotary axis | 2⁻³⁰ °, 2⁻²⁰ °, 2⁻¹⁴ N·m |
//! | `<spindle>_command_rev` | f64 | setpoint, unwrapped | 2⁻²⁴ rev, 0.08″ |
//! | `<spindle>_actual_rev` | f64 | where the nose really is | 2⁻²⁴ rev |
//! | `<spindle>_rpm` | f64 | real speed; without a simulator from the last two angles | 2⁻¹⁰ rpm |
//! | `<spindle>_torque_n_m` | f64 | torque of the drive; without a simulator its reference | 2⁻¹⁴ N·m |
//! | `sync_error_um` | f64, null outside the material | the kernel's monitor | 2⁻¹⁰ µm |
//! | `line` | i32 | program line at work, 0 for none | 1 |
//! | `state` | text | what the kernel was doing | — |
//!
//! The steps are finer than any encoder here and are powers of two, so that the low bits of each number
//! are zero and compress to nothing: the byte planes of a column lie together (byte-stream split), then
//! zstd. What is read is a plain double of the stated unit, at most half a step off.
//!
//! Three axes and a spindle take about 0.3 µs and 24 bytes a row (`cargo bench -p store`): ten minutes of
//! machining are 2.4 million rows, 60 MB.
//!
//! Rows go out in groups of [`GROUP_ROWS`]; what is held in memory does not grow with the run.
mod read;
mod write;

pub use read::{Group, Reader};
pub use write::Writer;

use crate::machine::MachineFile;

/// Rows that are held and written together.
pub const GROUP_ROWS: usize = 1 << 16;

/// Which axes and spindles a trace has, and their names in its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Index in `bus` and name, such as `(0, "x")`.
    pub axes: Vec<(usize, String)>,
    /// By index in `bus`.
    pub spindles: Vec<String>,
}

impl Columns {
    /// Those of a machine: axes by small letter, spindles by name.
    pub fn of(machine: &MachineFile) -> Self {
        let letters = machine.axes.iter().flatten();
        Self {
            axes: letters
                .map(|a| (a.letter.index(), a.letter.letter().to_ascii_lowercase().to_string()))
                .collect(),
            spindles: machine.spindles.iter().map(|s| s.name.clone()).collect(),
        }
    }
}
