//! What a person is told to type where a tool is, or may be, in the work.
use crate::typed;
use control::Refused;
use std::path::Path;
use store::sync_record::{Cut, Place, SyncRecord, Untrusted};

/// Where the tool of a record is.
pub(crate) fn whereabouts(record: &SyncRecord) -> String {
    let Place { program, line, hole, .. } = &record.place;
    match record.stroke.cut {
        Cut::Tap => format!("hole {hole} of {program} (line {line})"),
        cut => format!("the work, {} of {program} (line {line})", cut.name()),
    }
}

/// The option that names a record's machine as it was named then, where it is not the usual one.
pub(crate) fn option_machine(record: &SyncRecord) -> String {
    let machine = &record.identity.machine;
    match typed::value(&record.place.command, "--machine") {
        Some(named) => format!(" --machine {}", typed::quoted(named)),
        None if machine == control::job::DEFAULT_MACHINE => String::new(),
        None => format!(" --machine {}", typed::quoted(machine)),
    }
}

/// What is said where a tap is in the work and something else is to be moved.
pub(crate) fn interlock(record: &SyncRecord, simulator: &Path, state: Option<&Path>) -> Refused {
    let state = state.map_or_else(String::new, |path| format!(" --state {}", path.display()));
    let machine = option_machine(record);
    Refused::because(format!(
        "tool {} is in {}: nothing but recovery may move\n  take it out with: leadscrew recover --simulator {}{machine}{state}",
        record.stroke.tool,
        whereabouts(record),
        simulator.display(),
    ))
}

/// What is said where it cannot be told.
pub(crate) fn unsure(why: &Untrusted, simulator: &Path, state: Option<&Path>) -> Refused {
    if let Untrusted::OtherMachine { .. } = why {
        return Refused::because(format!("{why}\n  name this machine's own folder with --state"));
    }
    unknown(&why.to_string(), simulator, state)
}

/// What is said where the machine still keeps a tool that the encoders show outside of the work.
pub(crate) fn settle(simulator: &Path, state: Option<&Path>) -> Refused {
    let typed = typed::of_this_run();
    let machine = typed::value(&typed, "--machine");
    Refused::because(format!(
        "the machine keeps a tool in its work that the encoders show outside of it\n  have that settled with: {}",
        recovery(simulator, machine, state)
    ))
}

/// The command that recovers.
fn recovery(simulator: &Path, machine: Option<&str>, state: Option<&Path>) -> String {
    let quoted = |path: &Path| typed::quoted(&path.display().to_string());
    let machine =
        machine.map_or_else(String::new, |name| format!(" --machine {}", typed::quoted(name)));
    let state = state.map_or_else(String::new, |path| format!(" --state {}", quoted(path)));
    format!("leadscrew recover --simulator {}{machine}{state}", quoted(simulator))
}

/// What is said where it cannot be known whether a tool is in the work.
pub(crate) fn unknown(why: &str, simulator: &Path, state: Option<&Path>) -> Refused {
    let typed = typed::of_this_run();
    let free = free_by_hand(simulator, typed::value(&typed, "--machine"), state);
    Refused::because(format!(
        "{why}\n  nothing may move: name the folder of the control that led the tool there with --state, and recover. Where that folder is \
         lost, see for yourself; once no tool is in the work: {free}"
    ))
}

/// What is typed by a person who has seen that no tool is in the work.
pub(crate) fn free_by_hand(
    simulator: &Path,
    machine: Option<&str>,
    state: Option<&Path>,
) -> String {
    recovery(simulator, machine, state) + " --tool-is-free"
}
