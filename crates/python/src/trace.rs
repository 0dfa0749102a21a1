//! The trace of a run in memory, handed to Python through the Arrow C stream interface: the columns
//! are not copied.
//!
//! Chunks have the rows of a group of the trace's file ([`store::trace::GROUP_ROWS`]); what is in
//! them is the same to the bit.
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::Int8Type;
use arrow_array::{
    ArrayRef, DictionaryArray, Float64Array, Int8Array, Int32Array, RecordBatch,
    RecordBatchIterator, StringArray,
};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use bus::Sample;
use control::observers::Observer;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use store::trace::{Columns, Rows, unit_of};

/// Where rows are kept, for the caller and the run.
pub(crate) type KeptRows = Arc<Mutex<Vec<Rows>>>;

/// Keeps every servo period.
pub(crate) struct Recording {
    kept: KeptRows,
    rows: Option<Rows>,
    columns: Columns,
}

impl Recording {
    /// Of these columns; where its rows come when it is dropped.
    pub(crate) fn new(columns: Columns) -> (Self, KeptRows) {
        let kept = KeptRows::default();
        let rows = Some(Rows::new(columns.clone()));
        (Self { kept: Arc::clone(&kept), rows, columns }, kept)
    }

    fn keep(&mut self) {
        if let Some(rows) = self.rows.take().filter(|rows| !rows.is_empty()) {
            self.kept.lock().unwrap_or_else(PoisonError::into_inner).push(rows);
        }
    }
}

impl Observer for Recording {
    fn sample(&mut self, sample: &Sample) {
        let Some(rows) = &mut self.rows else { return };
        rows.push(sample);
        if rows.is_full() {
            let next = rows.next();
            self.keep();
            self.rows = Some(next);
        }
    }

    fn event(&mut self, _event: &kernel::Event) {}
}

impl Drop for Recording {
    fn drop(&mut self) {
        self.keep();
        debug_assert!(self.rows.is_none(), "{:?}", self.columns);
    }
}

/// The trace of a run: anything that takes Arrow streams takes it (`pyarrow.table`,
/// `polars.DataFrame`, `duckdb`).
#[pyclass(frozen, module = "leadscrew._leadscrew")]
pub(crate) struct Trace {
    schema: Arc<Schema>,
    batches: Vec<RecordBatch>,
}

impl Trace {
    /// Of what was recorded, with what is to be known of the run.
    pub(crate) fn new(
        columns: &Columns,
        rows: Vec<Rows>,
        about: HashMap<String, String>,
    ) -> Result<Self, ArrowError> {
        let schema = Arc::new(schema(columns).with_metadata(about));
        let batches =
            rows.into_iter().map(|rows| batch(&schema, rows)).collect::<Result<_, _>>()?;
        Ok(Self { schema, batches })
    }
}

#[pymethods]
impl Trace {
    /// The Arrow C stream interface.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema; // the interface allows a producer to keep to its own
        let batches = self.batches.clone().into_iter().map(Ok);
        let reader = RecordBatchIterator::new(batches, Arc::clone(&self.schema));
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// Rows.
    fn __len__(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }
}

fn schema(columns: &Columns) -> Schema {
    let number = |name: String, nullable| {
        let unit = HashMap::from([("unit".to_owned(), unit_of(&name).to_owned())]);
        Field::new(name, DataType::Float64, nullable).with_metadata(unit)
    };
    let state = DataType::Dictionary(Box::new(DataType::Int8), Box::new(DataType::Utf8));
    let mut fields = vec![number("time_s".into(), false)];
    fields.extend(columns.names().into_iter().map(|name| number(name, false)));
    fields.push(number("control_sync_error_um".into(), true));
    fields.push(Field::new("line", DataType::Int32, false));
    fields.push(Field::new("state", state, false));
    Schema::new(fields)
}

fn batch(schema: &Arc<Schema>, rows: Rows) -> Result<RecordBatch, ArrowError> {
    let Rows { time_s, numbers, sync_error_um, sync_error_known, line, state, .. } = rows;
    let mut known = sync_error_um.into_iter();
    let errors: Float64Array =
        sync_error_known.iter().map(|is| if *is == 0 { None } else { known.next() }).collect();
    let mut names: Vec<&'static str> = Vec::new();
    let keys: Int8Array = state
        .iter()
        .map(|state| {
            let name = state.name();
            let at = names.iter().position(|known| *known == name);
            let at = at.unwrap_or_else(|| {
                names.push(name);
                names.len() - 1
            });
            i8::try_from(at).ok()
        })
        .collect();
    let states = DictionaryArray::<Int8Type>::try_new(keys, Arc::new(StringArray::from(names)))?;
    let numbers = std::iter::once(time_s).chain(numbers);
    let mut arrays: Vec<ArrayRef> =
        numbers.map(|column| Arc::new(Float64Array::from(column)) as ArrayRef).collect();
    arrays.push(Arc::new(errors));
    arrays.push(Arc::new(Int32Array::from(line)));
    arrays.push(Arc::new(states));
    RecordBatch::try_new(Arc::clone(schema), arrays)
}
