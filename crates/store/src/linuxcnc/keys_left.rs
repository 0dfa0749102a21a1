//! A line for each key of the INI file that no line has named so far.
use super::ini::{Entry, Ini};
use super::writer::{MachineWriter, Remark, RemarkKind};

/// Keys that decide something which stands in many places of the file, and what.
const DECIDE: [(&str, &str, &str); 8] = [
    ("EMC", "MACHINE", "the machine's name"),
    ("KINS", "KINEMATICS", "which joint moves which axis"),
    ("KINS", "JOINTS", "how many joints there are"),
    ("TRAJ", "COORDINATES", "which axes there are"),
    ("TRAJ", "ANGULAR_UNITS", "degrees of a unit"),
    ("TRAJ", "SPINDLES", "how many spindles there are"),
    ("JOINT_", "HOME_SEQUENCE", "the order of homing"),
    ("HAL", "HALFILE", "its pins are told of each by itself"),
];

/// Why a key is not used: by section and key, of which either may be the beginning.
const REASONS: [(&str, &str, &str); 38] = [
    ("HAL", "POSTGUI_HALFILE", "read as the others"),
    ("HAL", "HALCMD", "read as a line of a HAL file"),
    ("HAL", "HALUI", "halui is LinuxCNC's: its pins are told of each by itself"),
    ("HAL", "", "HAL files are loaded by halrun, or by the system's start"),
    ("JOINT_", "COMP_FILE", "the first joint of an axis counts"),
    ("AXIS_", "COMP_FILE", "a joint states it"),
    ("JOINT_", "COMP_FILE_TYPE", "belongs to COMP_FILE"),
    ("JOINT_", "TYPE", "an axis is linear or rotary by its letter"),
    ("AXIS_", "TYPE", "an axis is linear or rotary by its letter"),
    ("JOINT_", "HOME_", "Leadscrew homes by switch, drive or operator: this is no part of it"),
    (
        "JOINT_",
        "VOLATILE_HOME",
        "an axis is homed anew after each start unless its drive counts on",
    ),
    ("JOINT_", "LOCKING_INDEXER", "an axis that is locked at rest is not unlocked"),
    (
        "AXIS_",
        "WRAPPED_ROTARY",
        "a rotary axis turns by the sense of its commands, and is not wound up",
    ),
    ("AXIS_", "OFFSET_AV_RATIO", "offsets from outside are not superposed on a program"),
    ("JOINT_", "", "it stays with the drive or with the HAL file"),
    ("AXIS_", "", "it stays with the drive or with the HAL file"),
    ("SPINDLE", "", "it stays with the drive or with the HAL file"),
    ("TRAJ", "NO_FORCE_HOMING", "no program runs before all axes are homed"),
    ("TRAJ", "HOME", "each axis homes by itself"),
    ("TRAJ", "", "speeds and limits are each axis' own"),
    ("KINS", "", "axes are their joints"),
    ("EMCMOT", "", "motmod is not loaded: the component has its own period"),
    (
        "EMCIO",
        "RANDOM_TOOLCHANGER",
        "tools are asked for by their numbers, wherever the changer has them",
    ),
    ("EMCIO", "TOOL_CHANGE", "a tool is changed where the machine file's [tool_change] says"),
    ("EMCIO", "", "iocontrol is not loaded"),
    (
        "RS274NGC",
        "PARAMETER_FILE",
        "its file of parameters is named beside the machine, when a program is run",
    ),
    ("RS274NGC", "RS274NGC_STARTUP_CODE", "a program begins with the words that it states itself"),
    ("RS274NGC", "SUBROUTINE_PATH", "subprograms are found beside the program"),
    ("RS274NGC", "USER_M_PATH", "M100 to M199 are those of [user_codes]"),
    ("RS274NGC", "REMAP", "codes are not remapped to Python or to subprograms"),
    ("RS274NGC", "", "the language is Leadscrew's linuxcnc dialect as it is"),
    ("DISPLAY", "", "of a display that is not used"),
    ("EMC", "", "of LinuxCNC itself"),
    ("TASK", "", "milltask is not loaded"),
    ("FILTER", "", "of a display that is not used"),
    ("HALUI", "", "halui is not loaded"),
    ("APPLICATIONS", "", "programs that LinuxCNC starts"),
    ("PYTHON", "", "Python in the interpreter is not run"),
];

/// What stands beside a key of a section that is none of LinuxCNC's.
const UNKNOWN: &str = "a section of its own";

pub(super) fn remarks(w: &mut MachineWriter, ini: &Ini) {
    let mut said: Vec<Remark> = Vec::new();
    for (at, entry) in ini.entries.iter().enumerate() {
        let cited = entry.cited();
        if w.remarks.iter().any(|remark| names(&remark.text, &cited)) {
            continue;
        }
        let same = |of: &&Entry| of.section == entry.section && of.key == entry.key;
        let first = ini.entries[..at].iter().find(same);
        let (kind, why) = fate(entry, first);
        let value: String = entry.value.chars().take(80).collect();
        said.push(Remark { kind, key: String::new(), text: format!("{cited} = {value}: {why}") });
    }
    w.remarks.append(&mut said);
    for line in &ini.unread {
        w.remarks.push(Remark { kind: RemarkKind::Unread, key: String::new(), text: line.clone() });
    }
}

/// Whether a text has the name of a key in it, and not that of a longer one.
fn names(text: &str, cited: &str) -> bool {
    text.match_indices(cited).any(|(at, _)| {
        let next = text[at + cited.len()..].chars().next();
        !next.is_some_and(|next| next.is_alphanumeric() || next == '_')
    })
}

fn fate(entry: &Entry, first: Option<&Entry>) -> (RemarkKind, String) {
    let is = |(section, key, _): &&(&str, &str, &str)| {
        let own = section.ends_with('_') || *section == "SPINDLE";
        let section =
            if own { entry.section.starts_with(section) } else { entry.section == **section };
        section && entry.key.starts_with(key)
    };
    if let Some((_, _, what)) = DECIDE.iter().find(is).filter(|(_, key, _)| *key == entry.key) {
        return (RemarkKind::Taken, (*what).to_owned());
    }
    let repeats = entry.section == "HAL"
        || ["REMAP", "PROGRAM_EXTENSION", "MDI_COMMAND"].contains(&entry.key.as_str());
    if let Some(first) = first.filter(|_| !repeats) {
        return (RemarkKind::Unread, format!("the first one counts, {}", first.place));
    }
    if entry.is_asked() {
        let why = "looked at: another line decides, or what it says is in the file already";
        return (RemarkKind::Unread, why.to_owned());
    }
    let reason = REASONS.iter().find(is).map_or(UNKNOWN, |(_, _, why)| why);
    let hal = if entry.is_in_hal() { "; the HAL file takes its value, and goes on to" } else { "" };
    (RemarkKind::Unread, format!("{reason}{hal}"))
}
