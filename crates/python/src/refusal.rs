//! A refusal as Python's exception `leadscrew.Refused`, which carries the findings.
use control::Refused;
use pyo3::prelude::*;
use serde_json::Value;

/// The exception; where it cannot be made, what hinders that.
pub(crate) fn exception(py: Python<'_>, refused: &Refused) -> PyErr {
    let findings = Value::Array(cli::answers::findings(refused)).to_string();
    let made = py
        .import("leadscrew._errors")
        .and_then(|module| module.getattr("Refused"))
        .and_then(|class| class.call_method1("_of", (refused.sentence(), findings)));
    made.map_or_else(|hindered| hindered, PyErr::from_value)
}
