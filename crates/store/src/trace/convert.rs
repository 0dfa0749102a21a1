//! A recording in another format, whole or not at all: [`Format`].
//!
//! ```text
//!   trace.parquet, what the page's scope has saved ─► Reader ─► group after group ─► MCAP, CSV, plain Parquet
//! ```
//!
//! Each format says the unit of each column and what the recording says of itself (program,
//! machine, …).
use super::protobuf::{self, PeriodMessage};
use super::{Group, Reader, unit_of};
use crate::Error;
use crate::output::NewFile;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type};
use parquet::errors::Result as ParquetResult;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;

/// What a recording is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MCAP: a message for each period, in Protocol Buffers, with its descriptor.
    Mcap,
    /// Text: `#` lines about it, the names of the columns, then a line for each period.
    Csv,
    /// Parquet with encodings that all readers have.
    Parquet,
}

/// Convert a recording; how many rows were written.
///
/// # Errors
/// It cannot be read to its end, or the new file cannot be written: then there is none.
pub fn convert(from: &Path, to: &Path, format: Format) -> Result<u64, Error> {
    let reader = Reader::open(from)?;
    let about = About::of(&reader);
    let file = NewFile::begin(to)?;
    let written = |cause: io::Error| Error::file("write", to, cause);
    let out = BufWriter::with_capacity(1 << 20, file.as_file().try_clone().map_err(written)?);
    let mut sink: Box<dyn Sink> = match format {
        Format::Mcap => Box::new(Mcap::begin(out, &about).map_err(written)?),
        Format::Csv => Box::new(Csv::begin(out, &about).map_err(written)?),
        Format::Parquet => Box::new(Plain::begin(out, &about).map_err(written)?),
    };
    let mut rows = 0;
    for group in reader {
        let group = group?;
        sink.group(&group).map_err(written)?;
        rows += group.rows() as u64;
    }
    sink.end().map_err(written)?;
    file.finish()?;
    Ok(rows)
}

/// What a recording says of itself, and its columns.
struct About {
    facts: Vec<(String, String)>,
    numbers: Vec<String>,
    has_line: bool,
    has_state: bool,
}

impl About {
    fn of(reader: &Reader) -> Self {
        let columns = reader.columns();
        let is_number = |name: &&String| !matches!(name.as_str(), "line" | "state");
        Self {
            facts: reader.facts(),
            numbers: columns.iter().filter(is_number).cloned().collect(),
            has_line: columns.iter().any(|name| name == "line"),
            has_state: columns.iter().any(|name| name == "state"),
        }
    }

    /// Facts, and the unit of each column that has one.
    fn with_units(&self) -> BTreeMap<String, String> {
        let units = self.numbers.iter().map(|name| (format!("unit:{name}"), unit_of(name).into()));
        self.facts.iter().cloned().chain(units).collect()
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        let line = self.has_line.then_some("line");
        let state = self.has_state.then_some("state");
        self.numbers.iter().map(String::as_str).chain(line).chain(state)
    }
}

/// Takes groups of rows.
trait Sink {
    fn group(&mut self, group: &Group) -> io::Result<()>;
    fn end(self: Box<Self>) -> io::Result<()>;
}

/// The values of a row, as far as the recording has them.
fn row(group: &Group, index: usize) -> (impl Iterator<Item = f64> + '_, Option<u32>, Option<&str>) {
    let numbers = group.numbers.iter().map(move |(_, values)| values[index]);
    (numbers, group.line.get(index).copied(), group.state.get(index).map(String::as_str))
}

struct Csv<W: Write>(W);

impl<W: Write> Csv<W> {
    fn begin(mut out: W, about: &About) -> io::Result<Self> {
        for (name, value) in about.with_units() {
            // a fact is a line, whatever stands in it
            let value = value.replace(['\n', '\r'], " ");
            writeln!(out, "# {name}: {value}")?;
        }
        writeln!(out, "{}", about.names().collect::<Vec<_>>().join(","))?;
        Ok(Self(out))
    }
}

impl<W: Write> Sink for Csv<W> {
    fn group(&mut self, group: &Group) -> io::Result<()> {
        let mut text = String::new();
        for index in 0..group.rows() {
            text.clear();
            let (numbers, line, state) = row(group, index);
            for number in numbers {
                if !number.is_nan() {
                    text += &number.to_string();
                }
                text.push(',');
            }
            if let Some(line) = line {
                text += &format!("{line},");
            }
            if let Some(state) = state {
                text += &format!("{state},");
            }
            text.pop(); // the last comma
            writeln!(self.0, "{text}")?;
        }
        Ok(())
    }

    fn end(mut self: Box<Self>) -> io::Result<()> {
        self.0.flush()
    }
}

/// Topic and name of the message.
const TOPIC: &str = "trace";
const MESSAGE: &str = "leadscrew.Period";

struct Mcap<W: Write + io::Seek> {
    writer: mcap::Writer<W>,
    channel: u16,
    sequence: u32,
    row: PeriodMessage,
}

impl<W: Write + io::Seek> Mcap<W> {
    fn begin(out: W, about: &About) -> io::Result<Self> {
        let options = mcap::WriteOptions::new()
            .compression(None)
            .library(concat!("leadscrew ", env!("CARGO_PKG_VERSION")));
        let mut writer = options.create(out).map_err(io::Error::other)?;
        let row = PeriodMessage::new(&about.numbers, about.has_line, about.has_state);
        let descriptor = protobuf::descriptor(MESSAGE, &row);
        let schema = writer.add_schema(MESSAGE, "protobuf", &descriptor);
        let about = about.with_units();
        let channel = schema
            .and_then(|schema| writer.add_channel(schema, TOPIC, "protobuf", &about))
            .map_err(io::Error::other)?;
        let metadata = mcap::records::Metadata { name: TOPIC.into(), metadata: about };
        writer.write_metadata(&metadata).map_err(io::Error::other)?;
        Ok(Self { writer, channel, sequence: 0, row })
    }
}

impl<W: Write + io::Seek> Sink for Mcap<W> {
    fn group(&mut self, group: &Group) -> io::Result<()> {
        let times = group.column("time_s").unwrap_or_default();
        for index in 0..group.rows() {
            let (numbers, line, state) = row(group, index);
            let message = self.row.write(numbers, line, state);
            let time = times.get(index).map_or(0, |time_s| (time_s * 1e9).round() as u64);
            let header = mcap::records::MessageHeader {
                channel_id: self.channel,
                sequence: self.sequence,
                log_time: time,
                publish_time: time,
            };
            self.writer.write_to_known_channel(&header, message).map_err(io::Error::other)?;
            self.sequence = self.sequence.wrapping_add(1);
        }
        Ok(())
    }

    fn end(mut self: Box<Self>) -> io::Result<()> {
        self.writer.finish().map(drop).map_err(io::Error::other)?;
        self.writer.into_inner().flush()
    }
}

struct Plain<W: Write + Send>(SerializedFileWriter<W>);

impl<W: Write + Send> Plain<W> {
    fn begin(out: W, about: &About) -> io::Result<Self> {
        let facts = about.with_units().into_iter().map(|(name, value)| KeyValue::new(name, value));
        let properties = WriterProperties::builder()
            .set_created_by(concat!("leadscrew ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(facts.collect()))
            .set_compression(Compression::LZ4_RAW)
            .set_dictionary_enabled(false)
            .set_column_dictionary_enabled("state".into(), true);
        let schema = schema(about)?;
        let writer =
            SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build()))?;
        Ok(Self(writer))
    }

    fn write(&mut self, group: &Group) -> ParquetResult<()> {
        let mut rows = self.0.next_row_group()?;
        for (_, values) in &group.numbers {
            let known: Vec<i16> = values.iter().map(|value| i16::from(!value.is_nan())).collect();
            let values: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
            let Some(mut column) = rows.next_column()? else { break };
            column.typed::<DoubleType>().write_batch(&values, Some(&known), None)?;
            column.close()?;
        }
        if !group.line.is_empty()
            && let Some(mut column) = rows.next_column()?
        {
            let most = |line: &u32| i32::try_from(*line).unwrap_or(i32::MAX);
            let lines: Vec<i32> = group.line.iter().map(most).collect();
            column.typed::<Int32Type>().write_batch(&lines, None, None)?;
            column.close()?;
        }
        if !group.state.is_empty()
            && let Some(mut column) = rows.next_column()?
        {
            let states: Vec<ByteArray> = group.state.iter().map(|s| s.as_str().into()).collect();
            column.typed::<ByteArrayType>().write_batch(&states, None, None)?;
            column.close()?;
        }
        rows.close().map(drop)
    }
}

impl<W: Write + Send> Sink for Plain<W> {
    fn group(&mut self, group: &Group) -> io::Result<()> {
        if group.rows() == 0 { Ok(()) } else { Ok(self.write(group)?) }
    }

    fn end(self: Box<Self>) -> io::Result<()> {
        self.0.into_inner()?.flush()
    }
}

fn schema(about: &About) -> ParquetResult<Type> {
    let mut fields = Vec::new();
    for name in &about.numbers {
        let number = Type::primitive_type_builder(name, Physical::DOUBLE);
        fields.push(Arc::new(number.with_repetition(Repetition::OPTIONAL).build()?));
    }
    if about.has_line {
        let line = Type::primitive_type_builder("line", Physical::INT32);
        fields.push(Arc::new(line.with_repetition(Repetition::REQUIRED).build()?));
    }
    if about.has_state {
        let state = Type::primitive_type_builder("state", Physical::BYTE_ARRAY)
            .with_logical_type(Some(LogicalType::String))
            .with_repetition(Repetition::REQUIRED);
        fields.push(Arc::new(state.build()?));
    }
    Type::group_type_builder("trace").with_fields(fields).build()
}
