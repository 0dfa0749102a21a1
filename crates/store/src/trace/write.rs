//! Writing a trace while the machine runs.
//!
//! ```text
//!   push(&Sample) ─► one Vec per column ─(GROUP_ROWS full)─► encoded, compressed, on the disk
//! ```
use super::{Columns, GROUP_ROWS};
use crate::Error;
use crate::machine::rotary::RAD_PER_M;
use bus::{Sample, State};
use parquet::{
    basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel},
    data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type},
    errors::Result as ParquetResult,
    file::{
        metadata::KeyValue,
        properties::{EnabledStatistics, WriterProperties},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::{ColumnPath, Type},
};
use std::{
    fs::File,
    path::{Path, PathBuf},
    sync::Arc,
};
use units::{Angle, AxisKind, Time};

/// Writes a trace. It may move between threads; the thread that has it may push.
pub struct Writer {
    path: PathBuf,
    file: SerializedFileWriter<File>,
    columns: Columns,
    rows: Rows,
    /// Time and spindle angles of the sample before, for speeds that the sample itself does not hold.
    before: Option<(Time, [Angle; bus::SPINDLES])>,
}

/// The rows of the group in the making, column by column.
struct Rows {
    time_s: Vec<f64>,
    /// Four to an axis, then five to a spindle, as the table of the module has them.
    numbers: Vec<Vec<f64>>,
    sync_error_um: Vec<f64>,
    sync_error_known: Vec<i16>,
    line: Vec<i32>,
    state: Vec<ByteArray>,
    /// The last state and its name: rows share the bytes.
    last: (State, ByteArray),
}

const PER_AXIS: usize = 4;
const PER_SPINDLE: usize = 5;

impl Writer {
    /// Begin a trace in a new file. `about` is kept as the file's metadata, such as the program's name.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub fn create(path: &Path, columns: Columns, about: &[(&str, &str)]) -> Result<Self, Error> {
        let file = File::create(path).map_err(|cause| Error::file("create", path, cause))?;
        let properties = properties(about);
        let schema = Arc::new(schema(&columns).map_err(|e| failed(path, &e))?);
        let file = SerializedFileWriter::new(file, schema, Arc::new(properties))
            .map_err(|e| failed(path, &e))?;
        let numbers = columns.axes.len() * PER_AXIS + columns.spindles.len() * PER_SPINDLE;
        let rows = Rows::with_capacity(numbers);
        Ok(Self { path: path.to_owned(), file, columns, rows, before: None })
    }

    /// Append the row of one servo period.
    ///
    /// # Errors
    /// When a full group cannot be written.
    pub fn push(&mut self, sample: &Sample) -> Result<(), Error> {
        let mut numbers = self.rows.numbers.iter_mut();
        let mut put = |value: f64| {
            if let Some(column) = numbers.next() {
                column.push(value);
            }
        };
        for (index, _) in &self.columns.axes {
            let (index, command) = (*index, &sample.command.axes[*index]);
            let force = sample.truth.map_or(command.force, |t| t.axis_forces[index]);
            let setpoint = if is_rotary(index) { ROTARY_SETPOINT } else { SETPOINT };
            let real = sample.truth.map_or(f64::NAN, |t| t.axes[index].value());
            put(setpoint.snap(command.position.value()));
            put(NM.snap(real));
            put(NM.snap(sample.feedback.axes[index].position.value()));
            if is_rotary(index) {
                put(TORQUE.snap(force.value() / RAD_PER_M));
            } else {
                put(FORCE.snap(force.value()));
            }
        }
        for index in 0..self.columns.spindles.len() {
            let command = &sample.command.spindles[index];
            let torque = sample.truth.map_or(command.torque, |t| t.spindle_torques[index]);
            let real = sample.truth.map_or(f64::NAN, |t| t.spindles[index].value());
            put(ANGLE.snap(command.angle.value()));
            put(ANGLE.snap(real));
            put(ANGLE.snap(sample.feedback.spindles[index].angle.value()));
            put(SPEED.snap(rpm(sample, index, self.before.as_ref())));
            put(TORQUE.snap(torque.value()));
        }
        self.before = Some((sample.feedback.time, sample.feedback.spindles.map(|s| s.angle)));
        self.rows.push_report(sample);
        if self.rows.time_s.len() == GROUP_ROWS { self.write_group() } else { Ok(()) }
    }

    /// Write what is left and close the file.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn finish(mut self) -> Result<(), Error> {
        self.write_group()?;
        self.file.close().map(drop).map_err(|e| failed(&self.path, &e))
    }

    fn write_group(&mut self) -> Result<(), Error> {
        if self.rows.time_s.is_empty() {
            return Ok(());
        }
        let written = self.file.next_row_group().and_then(|group| self.rows.write(group));
        self.rows.clear();
        written.map_err(|e| failed(&self.path, &e))
    }
}

impl Rows {
    fn with_capacity(numbers: usize) -> Self {
        let column = || Vec::with_capacity(GROUP_ROWS);
        Self {
            time_s: column(),
            numbers: (0..numbers).map(|_| column()).collect(),
            sync_error_um: Vec::new(),
            sync_error_known: Vec::with_capacity(GROUP_ROWS),
            line: Vec::with_capacity(GROUP_ROWS),
            state: Vec::with_capacity(GROUP_ROWS),
            last: (State::Idle, ByteArray::from(State::Idle.name())),
        }
    }

    fn push_report(&mut self, sample: &Sample) {
        let report = &sample.report;
        self.time_s.push(sample.feedback.time.value());
        self.sync_error_known.push(i16::from(report.sync_error.is_some()));
        self.sync_error_um.extend(report.sync_error.map(|e| ERROR.snap(e.in_um())));
        self.line.push(i32::try_from(report.line).unwrap_or(i32::MAX));
        if self.last.0 != report.state {
            self.last = (report.state, ByteArray::from(report.state.name()));
        }
        self.state.push(self.last.1.clone());
    }

    /// In the order of the schema.
    fn write(&self, mut group: SerializedRowGroupWriter<'_, File>) -> ParquetResult<()> {
        for column in std::iter::once(&self.time_s).chain(&self.numbers) {
            write_column::<DoubleType>(&mut group, column, None)?;
        }
        write_column::<DoubleType>(&mut group, &self.sync_error_um, Some(&self.sync_error_known))?;
        write_column::<Int32Type>(&mut group, &self.line, None)?;
        write_column::<ByteArrayType>(&mut group, &self.state, None)?;
        group.close().map(drop)
    }

    fn clear(&mut self) {
        self.time_s.clear();
        self.numbers.iter_mut().for_each(Vec::clear);
        self.sync_error_um.clear();
        self.sync_error_known.clear();
        self.line.clear();
        self.state.clear();
    }
}

fn write_column<T: parquet::data_type::DataType>(
    group: &mut SerializedRowGroupWriter<'_, File>,
    values: &[T::T],
    known: Option<&[i16]>,
) -> ParquetResult<()> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<T>().write_batch(values, known, None)?;
    column.close()
}

/// Rounds to a multiple of a power of two.
///
/// The sum x + 1.5·2⁵²·step has no bits left below `step`, so the addition itself rounds; the
/// subtraction is exact. Good for |x| < 2⁵¹·step; larger numbers pass through.
struct Steps {
    big: f64,
}

impl Steps {
    const fn new(per_unit: f64) -> Self {
        const ONE_AND_A_HALF_TIMES_2_TO_THE_52: f64 = 6_755_399_441_055_744.0;
        Self { big: ONE_AND_A_HALF_TIMES_2_TO_THE_52 / per_unit }
    }

    fn snap(&self, x: f64) -> f64 {
        // a third of big is 2⁵¹·step
        if x.abs() < self.big / 3.0 { (x + self.big) - self.big } else { x }
    }
}

/// An axis of the bus that turns.
fn is_rotary(index: usize) -> bool {
    canon::Axis::ALL[index].kind() == AxisKind::Rotary
}

/// Jerk by third differences of setpoints at 125 µs is off by 4 steps / T³: 31 m/s³.
const SETPOINT: Steps = Steps::new((1 << 26) as f64);
/// Of a rotary axis, whose limit of jerk may be tens of thousands of °/s³.
const ROTARY_SETPOINT: Steps = Steps::new((1 << 30) as f64);
const NM: Steps = Steps::new((1 << 20) as f64);
const FORCE: Steps = Steps::new((1 << 7) as f64);
const ANGLE: Steps = Steps::new((1 << 24) as f64);
const SPEED: Steps = Steps::new((1 << 10) as f64);
const TORQUE: Steps = Steps::new((1 << 14) as f64);
const ERROR: Steps = Steps::new((1 << 10) as f64);

/// Real speed of a spindle, or what two angles say of it.
fn rpm(sample: &Sample, index: usize, before: Option<&(Time, [Angle; bus::SPINDLES])>) -> f64 {
    if let Some(truth) = &sample.truth {
        return truth.spins[index].in_rpm();
    }
    let Some((time, angles)) = before else { return 0.0 };
    let elapsed = sample.feedback.time - *time;
    if elapsed <= Time::ZERO {
        return 0.0;
    }
    ((sample.feedback.spindles[index].angle - angles[index]) / elapsed).in_rpm()
}

fn failed(path: &Path, cause: &parquet::errors::ParquetError) -> Error {
    Error::Trace { action: "write", path: path.to_owned(), cause: cause.to_string() }
}

fn schema(columns: &Columns) -> ParquetResult<Type> {
    let number = |name: String, repetition| {
        Type::primitive_type_builder(&name, Physical::DOUBLE).with_repetition(repetition).build()
    };
    let mut fields = vec![number("time_s".into(), Repetition::REQUIRED)?];
    for (index, axis) in &columns.axes {
        let linear = ["control_setpoint_mm", "truth_mm", "encoder_mm", "drive_force_n"];
        let rotary = ["control_setpoint_deg", "truth_deg", "encoder_deg", "drive_torque_n_m"];
        for what in if is_rotary(*index) { rotary } else { linear } {
            fields.push(number(format!("{axis}_{what}"), Repetition::REQUIRED)?);
        }
    }
    for spindle in &columns.spindles {
        let columns =
            ["control_setpoint_rev", "truth_rev", "encoder_rev", "rpm", "drive_torque_n_m"];
        for what in columns {
            fields.push(number(format!("{spindle}_{what}"), Repetition::REQUIRED)?);
        }
    }
    fields.push(number("control_sync_error_um".into(), Repetition::OPTIONAL)?);
    let line = Type::primitive_type_builder("line", Physical::INT32);
    fields.push(line.with_repetition(Repetition::REQUIRED).build()?);
    let state = Type::primitive_type_builder("state", Physical::BYTE_ARRAY)
        .with_logical_type(Some(LogicalType::String))
        .with_repetition(Repetition::REQUIRED);
    fields.push(state.build()?);
    Type::group_type_builder("trace")
        .with_fields(fields.into_iter().map(Arc::new).collect())
        .build()
}

fn properties(about: &[(&str, &str)]) -> WriterProperties {
    let column = |name: &str| ColumnPath::from(name);
    let about = about.iter().map(|(k, v)| KeyValue::new((*k).to_owned(), (*v).to_owned()));
    WriterProperties::builder()
        .set_created_by(concat!("leadscrew ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(about.collect()))
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_column_encoding(column("line"), Encoding::DELTA_BINARY_PACKED)
        .set_column_encoding(column("state"), Encoding::PLAIN)
        .set_column_dictionary_enabled(column("state"), true)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_max_row_group_row_count(Some(GROUP_ROWS))
        .build()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_stored_at_most_half_a_step_off() {
        for x in [0.0, 1e-9, -0.123_456_789, 499.999_999_9, -1e4, 8.5e5] {
            let off = (NM.snap(x) - x).abs();
            assert!(off <= 0.5 / f64::from(1 << 20), "{x} {off}");
        }
    }

    #[test]
    fn a_multiple_of_the_step_is_stored_exactly() {
        assert_eq!(NM.snap(-299.5), -299.5);
        assert_eq!(NM.snap(3.0 / f64::from(1 << 20)), 3.0 / f64::from(1 << 20));
    }

    #[test]
    fn what_is_too_large_or_no_number_passes_through() {
        assert_eq!(ANGLE.snap(1e12), 1e12);
        assert!(ANGLE.snap(f64::NAN).is_nan());
        assert_eq!(ANGLE.snap(f64::INFINITY), f64::INFINITY);
    }

    #[test]
    fn the_writer_may_move_to_its_own_thread() {
        const fn movable<T: Send>() {}
        movable::<Writer>();
    }
}
