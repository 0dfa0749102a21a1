//! `trace.parquet`: one row per servo period, for any reader of Parquet.
//!
//! | column | type | unit, meaning | stored in steps of |
//! |---|---|---|---|
//! | `time_s` | f64 | since the machine was started | — |
//! | `<axis>_control_setpoint_mm` | f64 | control's view: where the axis shall be | 2⁻²⁶ mm, 15 pm: third differences are jerk |
//! | `<axis>_truth_mm` | f64 | ground truth: where the table or ram really is; no number without a simulator | 2⁻²⁰ mm |
//! | `<axis>_encoder_mm` | f64 | control's view: position by the encoder | 2⁻²⁰ mm |
//! | `<axis>_drive_force_n` | f64 | of the drive: what it gives, without a simulator what it is ordered | 2⁻⁷ N |
//! | `<axis>_control_setpoint_deg`, `_truth_deg`, `_encoder_deg`, `_drive_torque_n_m` | f64 | the same of a rotary axis | 2⁻³⁰ °, 2⁻²⁰ °, 2⁻¹⁴ N·m |
//! | `<spindle>_control_setpoint_rev` | f64 | control's view: where it shall be, unwrapped | 2⁻²⁴ rev, 0.08″ |
//! | `<spindle>_truth_rev` | f64 | ground truth: where the nose really is; no number without a simulator | 2⁻²⁴ rev |
//! | `<spindle>_encoder_rev` | f64 | control's view: angle by the encoder | 2⁻²⁴ rev |
//! | `<spindle>_rpm` | f64 | ground truth: real speed; without a simulator from the last two angles of the encoder | 2⁻¹⁰ rpm |
//! | `<spindle>_drive_torque_n_m` | f64 | of the drive: what it gives, without a simulator what it is ordered | 2⁻¹⁴ N·m |
//! | `<axis>_measured_force_n`, of a rotary axis `_measured_torque_n_m`; `<spindle>_measured_torque_n_m` | f64 | of a drive that measures what it gives: what it says; no number where it is silent | 2⁻⁷ N, 2⁻¹⁴ N·m |
//! | `control_sync_error_um` | f64, null outside the material | control's view: the kernel's monitor, from encoders; the certificate has the judge's, from the truth | 2⁻¹⁰ µm |
//! | `line` | i32 | program line at work, 0 for none | 1 |
//! | `state` | text | what the kernel was doing | — |
//!
//! The control never sees the ground truth: where `truth` and `encoder` differ is what play,
//! springs, screws and encoders hide from it. Figures of report and certificate are the judge's,
//! from the truth; the kernel's own monitor is named as such.
//!
//! The steps are finer than any encoder here and are powers of two, so that the low bits of each
//! number are zero and compress to nothing: the byte planes of a column lie together (byte-stream
//! split), then zstd. What is read is a plain double of the stated unit, at most half a step off.
//!
//! Three axes and a spindle take about 0.3 µs and 24 bytes a row (`cargo bench -p store`): ten
//! minutes of machining are 2.4 million rows, 60 MB.
//!
//! Rows go out in groups of [`GROUP_ROWS`]; what is held in memory does not grow with the run.
mod convert;
mod protobuf;
mod read;
mod rows;
mod summary;
mod write;

pub use convert::{Format, convert};
pub use read::{Group, Reader};
pub use rows::Rows;
pub use summary::{ColumnSummary, Summary};
pub use write::Writer;

use crate::machine::MachineFile;

/// Units by the end of a column's name, the longer ones first.
const UNITS: [(&str, &str); 10] = [
    ("_n_m", "N·m"),
    ("_mm", "mm"),
    ("_um", "µm"),
    ("_deg", "°"),
    ("_rev", "rev"),
    ("_rpm", "rev/min"),
    ("_n", "N"),
    ("_s", "s"),
    ("_percent", "%"),
    ("_nm", "N·m"),
];

/// The unit of a column, by the end of its name; empty: it has none.
pub fn unit_of(column: &str) -> &'static str {
    UNITS.iter().find(|(end, _)| column.ends_with(end)).map_or("", |(_, unit)| unit)
}

/// Rows that are held and written together.
pub const GROUP_ROWS: usize = 1 << 16;

/// Which axes and spindles a trace has, and their names in its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Index in `bus` and name, such as `(0, "x")`.
    pub axes: Vec<(usize, String)>,
    /// By index in `bus`.
    pub spindles: Vec<String>,
    /// Drives that measure what they give.
    pub measured: MeasuredDrives,
}

/// Drives that measure what they give, by their index in `bus`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeasuredDrives {
    /// Of axes.
    pub axes: Vec<usize>,
    /// Of spindles.
    pub spindles: Vec<usize>,
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
            measured: MeasuredDrives::of(machine),
        }
    }

    /// Names of the columns between `time_s` and `control_sync_error_um`: four to an axis, then
    /// five to a spindle, then one to a drive that measures what it gives.
    pub fn names(&self) -> Vec<String> {
        let linear = ["control_setpoint_mm", "truth_mm", "encoder_mm", "drive_force_n"];
        let rotary = ["control_setpoint_deg", "truth_deg", "encoder_deg", "drive_torque_n_m"];
        let spindle =
            ["control_setpoint_rev", "truth_rev", "encoder_rev", "rpm", "drive_torque_n_m"];
        let of = |name: &String, what: &[&str]| -> Vec<String> {
            what.iter().map(|what| format!("{name}_{what}")).collect()
        };
        let axes = self.axes.iter().flat_map(|(index, axis)| {
            of(axis, if rows::is_rotary(*index) { &rotary } else { &linear })
        });
        let spindles = self.spindles.iter().flat_map(|name| of(name, &spindle));
        axes.chain(spindles).chain(self.measured_names()).collect()
    }

    fn measured_names(&self) -> impl Iterator<Item = String> {
        let axes = self.axes.iter().filter(|(index, _)| self.measured.axes.contains(index));
        let axes = axes.map(|(index, name)| {
            let what = if rows::is_rotary(*index) { "torque_n_m" } else { "force_n" };
            format!("{name}_measured_{what}")
        });
        let spindles = self.measured.spindles.iter().filter_map(|index| self.spindles.get(*index));
        axes.chain(spindles.map(|name| format!("{name}_measured_torque_n_m")))
    }
}

impl MeasuredDrives {
    fn of(machine: &MachineFile) -> Self {
        let axes = (0..machine.axes.len()).filter(|index| machine.measures_force(*index));
        let spindles = (0..machine.spindles.len()).filter(|index| machine.measures_torque(*index));
        Self { axes: axes.collect(), spindles: spindles.collect() }
    }
}
