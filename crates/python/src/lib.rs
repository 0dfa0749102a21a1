//! The native part of the Python package `leadscrew`: what commands answer, a run with its result,
//! and the command itself.
//!
//! ```text
//!   leadscrew/*.py ─► words, texts ─► cli::answers ─► values as JSON; RunResult, whose trace crosses as Arrow
//! ```
//!
//! Options come as the words of the command line and are read by its reader, so that neither can
//! differ. Python's lock is released while Leadscrew works.
#![forbid(unsafe_code)]

mod interrupt;
mod refusal;
mod result;
mod trace;

use cli::answers::{self, CommandWords};
use control::Refused;
use control::job::Interruption;
use leadscrew::{Machine, MachineSource};
use pyo3::prelude::*;
use serde_json::Value;
use std::ffi::OsString;

/// A machine as Python hands it over: its name, and its text where it is not as the file has it.
type Named = (String, Option<String>);

fn source((name, text): Named) -> MachineSource {
    MachineSource { name, text }
}

/// What Python asks, with a machine and a program's text in place of files.
fn asked(
    words: Vec<String>,
    program: Option<Vec<u8>>,
    machine: Option<Named>,
    plant: Option<Named>,
) -> CommandWords {
    CommandWords {
        words,
        program,
        machine: machine.map(source),
        plant: plant.map(source),
        interruption: Interruption::by(interrupt::came_now),
    }
}

/// A value as JSON, or the exception.
fn json(py: Python<'_>, answer: Result<Value, Refused>) -> PyResult<String> {
    match answer {
        Ok(value) => Ok(value.to_string()),
        Err(refused) => Err(refusal::exception(py, &refused)),
    }
}

/// The command `leadscrew`, with these words; its exit code.
#[pyfunction]
fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| cli::main(words))
}

/// Findings of one program, as JSON.
#[pyfunction]
#[pyo3(signature = (words, program=None, machine=None))]
fn check(
    py: Python<'_>,
    words: Vec<String>,
    program: Option<Vec<u8>>,
    machine: Option<Named>,
) -> PyResult<String> {
    let asked = asked(words, program, machine, None);
    interrupt::watch(py)?;
    let answer = py.detach(|| answers::check(&asked));
    interrupt::raised()?;
    json(py, answer)
}

/// Operations of one program, as JSON.
#[pyfunction]
#[pyo3(signature = (words, program=None, machine=None))]
fn canon(
    py: Python<'_>,
    words: Vec<String>,
    program: Option<Vec<u8>>,
    machine: Option<Named>,
) -> PyResult<String> {
    let asked = asked(words, program, machine, None);
    let answer = py.detach(|| answers::canon(&asked));
    json(py, answer)
}

/// How long a program takes, as JSON.
#[pyfunction]
#[pyo3(signature = (words, program=None, machine=None))]
fn time(
    py: Python<'_>,
    words: Vec<String>,
    program: Option<Vec<u8>>,
    machine: Option<Named>,
) -> PyResult<String> {
    let asked = asked(words, program, machine, None);
    interrupt::watch(py)?;
    let answer = py.detach(|| answers::time(&asked));
    interrupt::raised()?;
    json(py, answer)
}

/// The flattest polygon, as JSON.
#[pyfunction]
#[pyo3(signature = (words, machine=None))]
fn polygon(py: Python<'_>, words: Vec<String>, machine: Option<Named>) -> PyResult<String> {
    let asked = asked(words, None, machine, None);
    let answer = py.detach(|| answers::polygon(&asked));
    json(py, answer)
}

/// The way of the grinding wheel, as JSON.
#[pyfunction]
#[pyo3(signature = (words, machine=None))]
fn cam(py: Python<'_>, words: Vec<String>, machine: Option<Named>) -> PyResult<String> {
    let asked = asked(words, None, machine, None);
    let answer = py.detach(|| answers::cam(&asked));
    json(py, answer)
}

/// Text of a machine's file, read and checked.
#[pyfunction]
fn machine_text(py: Python<'_>, machine: Named) -> PyResult<String> {
    let loaded = py.detach(|| Machine::load(source(machine)));
    loaded.map(|m| m.text().to_owned()).map_err(|refused| refusal::exception(py, &refused))
}

/// Text of a machine's file with values changed; `changes` is a JSON array of pairs of key and
/// value.
#[pyfunction]
fn machine_changed(py: Python<'_>, machine: Named, changes: &str) -> PyResult<String> {
    let changes: Vec<(String, Value)> = serde_json::from_str(changes)
        .map_err(|e| pyo3::exceptions::PyValueError::new_err(e.to_string()))?;
    let changed = py.detach(|| Machine::load(source(machine)).and_then(|m| m.with(&changes)));
    changed.map(|m| m.text().to_owned()).map_err(|refused| refusal::exception(py, &refused))
}

/// A value of a machine's file by its key, as JSON; `None`: it is stated nowhere.
#[pyfunction]
fn machine_value(text: &str, key: &str) -> Option<String> {
    store::machine::value(text, key).map(|value| value.to_string())
}

/// A machine's file with what its plant may be, and for a seed is.
#[pyfunction]
#[pyo3(signature = (machine, seed=None, part=1))]
fn machine_shown(py: Python<'_>, machine: Named, seed: Option<u64>, part: u32) -> PyResult<String> {
    let shown = py.detach(|| answers::machine(&source(machine), seed, part));
    shown.map_err(|refused| refusal::exception(py, &refused))
}

/// Unit of a quantity, by the end of its name; empty: it has none.
#[pyfunction]
fn unit_of(name: &str) -> &'static str {
    store::trace::unit_of(name)
}

#[pymodule]
fn _leadscrew(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("BUILD", answers::BUILD)?;
    module.add("MACHINES", store::machine::EMBEDDED.to_vec())?;
    module.add_class::<result::RunResult>()?;
    module.add_class::<trace::Trace>()?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(canon, module)?)?;
    module.add_function(wrap_pyfunction!(time, module)?)?;
    module.add_function(wrap_pyfunction!(polygon, module)?)?;
    module.add_function(wrap_pyfunction!(cam, module)?)?;
    module.add_function(wrap_pyfunction!(result::run, module)?)?;
    module.add_function(wrap_pyfunction!(machine_text, module)?)?;
    module.add_function(wrap_pyfunction!(machine_changed, module)?)?;
    module.add_function(wrap_pyfunction!(machine_value, module)?)?;
    module.add_function(wrap_pyfunction!(machine_shown, module)?)?;
    module.add_function(wrap_pyfunction!(unit_of, module)?)?;
    Ok(())
}
