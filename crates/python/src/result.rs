//! A run, and what came of it.
use crate::trace::{Recording, Trace};
use crate::{Named, asked, interrupt, refusal};
use cli::answers::{self, Happened};
use control::Refused;
use leadscrew::{Ending, Finished};
use pyo3::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use store::trace::Columns;
use units::Time;

/// What came of a run.
#[pyclass(frozen, module = "leadscrew._leadscrew")]
pub(crate) struct RunResult {
    finished: Mutex<Finished>,
    events: Vec<Happened>,
    trace: Option<Py<Trace>>,
}

#[pymethods]
impl RunResult {
    /// `good`, `out-of-tolerance` or `alarm`.
    #[getter]
    fn ending(&self) -> &'static str {
        match self.with(|finished| finished.ending()) {
            Ending::Good => "good",
            Ending::OutOfTolerance => "out-of-tolerance",
            Ending::Alarm => "alarm",
        }
    }

    /// The certificate, as JSON.
    fn certificate(&self) -> String {
        self.with(|finished| finished.certificate().to_json())
    }

    /// What is known of the program from before anything moved, as JSON.
    fn findings(&self) -> String {
        self.with(|finished| answers::findings_of(finished).to_string())
    }

    /// Time in s, line, kind and text of each event.
    fn events(&self) -> Vec<(f64, u32, String, String)> {
        let row = |e: &Happened| (e.time_s, e.line, e.kind.clone(), e.text.clone());
        self.events.iter().map(row).collect()
    }

    /// What stopped the run from outside and what became of that, and faults that have not come.
    fn notes(&self) -> Vec<String> {
        self.with(|finished| {
            let outcome = &finished.outcome;
            outcome.happened.iter().chain(&outcome.not_triggered).cloned().collect()
        })
    }

    /// The report, a page in one file.
    fn report(&self, py: Python<'_>) -> String {
        py.detach(|| self.with(Finished::report))
    }

    /// The trace, if it was recorded.
    #[getter]
    fn trace(&self, py: Python<'_>) -> Option<Py<Trace>> {
        self.trace.as_ref().map(|trace| trace.clone_ref(py))
    }
}

impl RunResult {
    fn with<T>(&self, look: impl FnOnce(&mut Finished) -> T) -> T {
        look(&mut self.finished.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// What a run has left, before Python sees it.
struct Ran {
    finished: Finished,
    events: Vec<Happened>,
    recorded: Option<(Columns, Vec<store::trace::Rows>)>,
}

/// Run a program on the simulated machine and judge the workpiece. `progress` is called with the
/// machine's time and the planned one, in s.
#[pyfunction]
#[pyo3(signature = (words, program=None, machine=None, plant=None, *, trace=false, progress=None))]
pub(crate) fn run(
    py: Python<'_>,
    words: Vec<String>,
    program: Option<Vec<u8>>,
    machine: Option<Named>,
    plant: Option<Named>,
    trace: bool,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<RunResult> {
    let asked = asked(words, program, machine, plant);
    let progress = progress.map(Bound::unbind);
    interrupt::watch(py)?;
    let ran = py.detach(|| execute(&asked, trace, progress.as_ref()));
    interrupt::raised()?;
    let Ran { finished, events, recorded } =
        ran.map_err(|refused| refusal::exception(py, &refused))?;
    let trace = recorded.map(|(columns, rows)| {
        let made = py.detach(|| Trace::new(&columns, rows, about(&finished)));
        let made = made.map_err(|e| pyo3::exceptions::PyRuntimeError::new_err(e.to_string()))?;
        Py::new(py, made)
    });
    Ok(RunResult { finished: Mutex::new(finished), events, trace: trace.transpose()? })
}

fn execute(
    asked: &answers::CommandWords,
    trace: bool,
    progress: Option<&Py<PyAny>>,
) -> Result<Ran, Refused> {
    let mut run = answers::run(asked)?;
    run.prove(&mut |_| ())?;
    if interrupt::came_now() {
        return Err(Refused::because("interrupted"));
    }
    let (observer, events) = answers::events(&run);
    run.observers.push(observer);
    let columns = Columns::of(&run.job.session.machine);
    let kept = trace.then(|| {
        let (recording, kept) = Recording::new(columns.clone());
        run.observers.push(Box::new(recording));
        kept
    });
    run.is_interrupted = interrupt::came;
    let planned = run.planned();
    let finished = run.execute(&mut |at: Time| tell(progress, at, planned))?;
    if !interrupt::came_now() {
        finished.keep()?;
    }
    let events = std::mem::take(&mut *events.lock().unwrap_or_else(PoisonError::into_inner));
    let recorded = kept.map(|kept| {
        (columns, std::mem::take(&mut *kept.lock().unwrap_or_else(PoisonError::into_inner)))
    });
    Ok(Ran { finished, events, recorded })
}

/// Call back; what the callback raises ends the run.
fn tell(progress: Option<&Py<PyAny>>, at: Time, planned: Time) {
    let Some(progress) = progress else { return };
    let told = Python::attach(|py| progress.call1(py, (at.value(), planned.value())).map(drop));
    if let Err(error) = told {
        interrupt::raise(error);
    }
}

/// What is to be known of the run a trace belongs to: as in a trace's file.
fn about(finished: &Finished) -> HashMap<String, String> {
    let job = &finished.job;
    [
        ("leadscrew", env!("CARGO_PKG_VERSION").to_owned()),
        ("program", job.program.name.clone()),
        ("machine", job.session.machine.name.clone()),
        ("seed", finished.seed.to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into()
}
