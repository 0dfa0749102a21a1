//! Reading a trace, a group of rows at a time.
use super::GROUP_ROWS;
use crate::Error;
use parquet::{
    basic::{Repetition, Type as Physical},
    column::reader::get_typed_column_reader,
    data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type},
    errors::ParquetError,
    file::reader::{FileReader, RowGroupReader, SerializedFileReader},
};
use std::{
    fs::File,
    panic::{self, AssertUnwindSafe},
    path::{Path, PathBuf},
};

/// Largest group that is read: files of others may have longer ones than ours.
const MOST_ROWS: usize = 64 * GROUP_ROWS;

/// Reads a trace group by group.
pub struct Reader {
    path: PathBuf,
    file: SerializedFileReader<File>,
    next: usize,
}

/// Rows of a trace, column by column, in the units of the columns' names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Names and values of the columns that hold numbers; NaN where a value is null.
    pub numbers: Vec<(String, Vec<f64>)>,
    /// Program lines.
    pub line: Vec<u32>,
    /// States by name.
    pub state: Vec<String>,
}

impl Group {
    /// Rows.
    pub fn rows(&self) -> usize {
        self.numbers.first().map_or(self.line.len(), |(_, values)| values.len())
    }

    /// A column of numbers by name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.numbers.iter().find(|(n, _)| n == name).map(|(_, values)| values.as_slice())
    }
}

impl Reader {
    /// Open a trace.
    ///
    /// # Errors
    /// When the file cannot be opened or is no trace.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let file = crate::open(path).map_err(|cause| Error::file("read", path, cause))?;
        let opened = guarded(|| SerializedFileReader::new(file).map_err(|e| e.to_string()));
        let file = opened.map_err(|cause| failed(path, &cause))?;
        Ok(Self { path: path.to_owned(), file, next: 0 })
    }

    /// What the file says of itself under a key.
    pub fn about(&self, key: &str) -> Option<&str> {
        let known = self.file.metadata().file_metadata().key_value_metadata()?;
        known.iter().find(|pair| pair.key == key)?.value.as_deref()
    }

    /// All that the file says of itself, but for what readers of tables keep there.
    pub fn facts(&self) -> Vec<(String, String)> {
        let known = self.file.metadata().file_metadata().key_value_metadata();
        let facts = known.into_iter().flatten();
        let facts = facts.filter(|pair| !pair.key.contains(':'));
        facts.filter_map(|pair| Some((pair.key.clone(), pair.value.clone()?))).collect()
    }

    /// Names of the columns, in their order.
    pub fn columns(&self) -> Vec<String> {
        let schema = self.file.metadata().file_metadata().schema_descr();
        schema.columns().iter().map(|column| column.name().to_owned()).collect()
    }

    /// Rows altogether.
    pub fn rows(&self) -> u64 {
        u64::try_from(self.file.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    fn group(&self, index: usize) -> Result<Group, String> {
        let group = self.file.get_row_group(index).map_err(|e| e.to_string())?;
        let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(usize::MAX);
        if rows > MOST_ROWS {
            return Err(format!("a group has {rows} rows: expected {MOST_ROWS} at most"));
        }
        read_group(group.as_ref(), rows)
    }
}

impl Iterator for Reader {
    type Item = Result<Group, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next >= self.file.num_row_groups() {
            return None;
        }
        let group = guarded(|| self.group(self.next)).map_err(|cause| failed(&self.path, &cause));
        self.next = if group.is_ok() { self.next + 1 } else { usize::MAX };
        Some(group)
    }
}

fn read_group(group: &dyn RowGroupReader, rows: usize) -> Result<Group, String> {
    let mut read = Group::default();
    for index in 0..group.num_columns() {
        let column = group.metadata().column(index).column_descr_ptr();
        let name = column.name().to_owned();
        let required = column.self_type().get_basic_info().repetition() == Repetition::REQUIRED;
        match (column.physical_type(), name.as_str()) {
            (Physical::DOUBLE, _) => {
                let (values, known) = values::<DoubleType>(group, index, rows)?;
                let values = if required { values } else { with_gaps(&values, &known) };
                read.numbers.push((name, values));
            }
            // what the page's scope has saved
            (Physical::FLOAT, _) => {
                let (values, known) = values::<FloatType>(group, index, rows)?;
                let values: Vec<f64> = values.into_iter().map(f64::from).collect();
                let values = if required { values } else { with_gaps(&values, &known) };
                read.numbers.push((name, values));
            }
            (Physical::INT32, "line") if required => {
                let (values, _) = values::<Int32Type>(group, index, rows)?;
                read.line = values.into_iter().map(|n| u32::try_from(n).unwrap_or(0)).collect();
            }
            (Physical::BYTE_ARRAY, "state") if required => {
                let (values, _) = values::<ByteArrayType>(group, index, rows)?;
                let text = |v: &ByteArray| String::from_utf8_lossy(v.data()).into_owned();
                read.state = values.iter().map(text).collect();
            }
            (kind, _) => {
                return Err(format!("column `{name}` of type {kind} is not one of a trace"));
            }
        }
    }
    Ok(read)
}

/// Values of a column that are there, and for each row whether it has one.
fn values<T: DataType>(
    group: &dyn RowGroupReader,
    index: usize,
    rows: usize,
) -> Result<(Vec<T::T>, Vec<i16>), String> {
    let words = |e: ParquetError| e.to_string();
    let mut reader = get_typed_column_reader::<T>(group.get_column_reader(index).map_err(words)?);
    let (mut values, mut known) = (Vec::new(), Vec::new());
    let (read, ..) =
        reader.read_records(rows, Some(&mut known), None, &mut values).map_err(words)?;
    if read == rows {
        Ok((values, known))
    } else {
        Err(format!("expected {rows} rows, found {read}"))
    }
}

fn with_gaps(values: &[f64], known: &[i16]) -> Vec<f64> {
    let mut values = values.iter();
    known
        .iter()
        .map(|k| if *k > 0 { values.next().copied().unwrap_or(f64::NAN) } else { f64::NAN })
        .collect()
}

/// The format's library asserts what a whole file always fulfils (a column's place is not negative,
/// a page's size fits); in a damaged one that is an answer like any other.
fn guarded<T>(read: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    // nothing outlives the closure half-changed: what it made is dropped
    panic::catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err("the file is damaged".into()))
}

fn failed(path: &Path, cause: &str) -> Error {
    Error::Trace { action: "read", path: path.to_owned(), cause: cause.to_owned() }
}
