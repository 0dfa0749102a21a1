//! Writing a trace while the machine runs.
//!
//! ```text
//!   push(&Sample) ─► Rows: one Vec per column ─(GROUP_ROWS full)─► encoded, compressed, on the disk
//! ```
use super::{Columns, GROUP_ROWS, Rows};
use crate::{Error, regular};
use bus::{Sample, State};
use parquet::{
    basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical},
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

/// Writes a trace. It may move between threads; the thread that has it may push.
pub struct Writer {
    path: PathBuf,
    file: SerializedFileWriter<File>,
    rows: Rows,
}

impl Writer {
    /// Begin a trace in a new file. `about` is kept as the file's metadata, such as the program's
    /// name.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub fn create(path: &Path, columns: Columns, about: &[(&str, &str)]) -> Result<Self, Error> {
        let file = regular::create(path).map_err(|cause| Error::file("create", path, cause))?;
        let properties = properties(about);
        let schema = Arc::new(schema(&columns).map_err(|e| failed(path, &e))?);
        let file = SerializedFileWriter::new(file, schema, Arc::new(properties))
            .map_err(|e| failed(path, &e))?;
        Ok(Self { path: path.to_owned(), file, rows: Rows::new(columns) })
    }

    /// Append the row of one servo period.
    ///
    /// # Errors
    /// When a full group cannot be written.
    pub fn push(&mut self, sample: &Sample) -> Result<(), Error> {
        self.rows.push(sample);
        if self.rows.is_full() { self.write_group() } else { Ok(()) }
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
        let written = self.file.next_row_group().and_then(|group| write(&self.rows, group));
        self.rows.clear();
        written.map_err(|e| failed(&self.path, &e))
    }
}

/// In the order of the schema.
fn write(rows: &Rows, mut group: SerializedRowGroupWriter<'_, File>) -> ParquetResult<()> {
    for column in std::iter::once(&rows.time_s).chain(&rows.numbers) {
        write_column::<DoubleType>(&mut group, column, None)?;
    }
    let known = Some(rows.sync_error_known.as_slice());
    write_column::<DoubleType>(&mut group, &rows.sync_error_um, known)?;
    write_column::<Int32Type>(&mut group, &rows.line, None)?;
    // rows of the same state share the bytes of its name
    let mut last = (State::Idle, ByteArray::from(State::Idle.name()));
    let names = rows.state.iter().map(|state| {
        if last.0 != *state {
            last = (*state, ByteArray::from(state.name()));
        }
        last.1.clone()
    });
    let names: Vec<_> = names.collect();
    write_column::<ByteArrayType>(&mut group, &names, None)?;
    group.close().map(drop)
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

fn failed(path: &Path, cause: &parquet::errors::ParquetError) -> Error {
    Error::Trace { action: "write", path: path.to_owned(), cause: cause.to_string() }
}

fn schema(columns: &Columns) -> ParquetResult<Type> {
    let number = |name: String, repetition| {
        Type::primitive_type_builder(&name, Physical::DOUBLE).with_repetition(repetition).build()
    };
    let mut fields = vec![number("time_s".into(), Repetition::REQUIRED)?];
    for name in columns.names() {
        fields.push(number(name, Repetition::REQUIRED)?);
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
        .set_compression(Compression::LZ4_RAW)
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
    fn the_writer_may_move_to_its_own_thread() {
        const fn movable<T: Send>() {}
        movable::<Writer>();
    }
}
