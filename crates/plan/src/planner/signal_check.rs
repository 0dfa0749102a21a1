//! Whether the machine has the inputs, outputs and the probe that a program asks for.
use super::{Job, Planner};
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use canon::{InputWait, Output, Signal};
use diag::Diagnostic;

impl Planner {
    pub(super) fn check_input(&mut self, job: &Job, wait: &InputWait) {
        let Some(signals) = &self.limits.signals else { return };
        let names = &signals.inputs[usize::from(!wait.digital)];
        if names.iter().any(|(number, _)| *number == wait.number) {
            return;
        }
        let finding = missing("M0370", job, "input", (wait.digital, wait.number), names);
        self.findings.add(finding);
    }

    pub(super) fn check_output(&mut self, job: &Job, output: &Output) {
        let Some(signals) = &self.limits.signals else { return };
        let digital = matches!(output.signal, Signal::Digital { .. });
        let names = &signals.outputs[usize::from(!digital)];
        if names.iter().any(|(number, _)| *number == output.number) {
            return;
        }
        let finding = missing("M0371", job, "output", (digital, output.number), names);
        self.findings.add(finding);
    }

    pub(super) fn check_probe(&mut self, job: &Job) {
        if self.limits.signals.as_ref().is_none_or(|signals| signals.probe) {
            return;
        }
        let text = "the machine has no probe, so nothing would end this move";
        let help = "write [probe] in the machine's file if it has one; G1 moves without probing";
        self.findings.add(Diagnostic::error("M0372", job.span, text).with_help(help));
    }
}

/// The machine does not have it, and this it has.
fn missing(
    code: &'static str,
    job: &Job,
    what: &str,
    (digital, number): (bool, u8),
    names: &[(u8, String)],
) -> Diagnostic {
    let kind = if digital { "digital" } else { "analogue" };
    let text = format!("the machine has no {kind} {what} {number}");
    let known: Vec<_> = names.iter().map(|(number, name)| format!("{number} ({name})")).collect();
    let help = match known.as_slice() {
        [] => "it has none".to_string(),
        some => format!("it has {}", some.join(", ")),
    };
    let help = format!(
        "{help}; what it has is named in the machine's file, under [{what}s], as in {kind}_{number} = \"what it is\""
    );
    Diagnostic::error(code, job.span, text).with_help(help)
}
