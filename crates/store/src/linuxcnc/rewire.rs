//! What is said of each pin of LinuxCNC's own components that a configuration wires or sets, and
//! the guards that a person answers for.
//!
//! ```text
//!   net door  spindle.0.inhibit <= door.out        ─► rewire, safety, not read: one line a pin
//!                                                  └► [hal.safety]
//!                                                     "spindle.0.inhibit" = "unanswered: mill.hal:31, …"
//! ```
use super::axes::AxisOf;
use super::hal::Hal;
use super::pins::{Fate, fate};
use super::writer::{MachineWriter, RemarkKind, quoted};
use crate::machine::UNANSWERED;

/// A line for each pin, and the section of those that guard something.
pub(super) fn remarks(w: &mut MachineWriter, hal: &Hal, axes: &[AxisOf]) {
    w.section("", "");
    let letter = |joint: usize| {
        axes.iter().find(|axis| axis.joints.contains(&joint)).map(|axis| axis.letter)
    };
    let mut guards = String::new();
    let mut said: Vec<&str> = Vec::new();
    let wired =
        hal.pins.iter().map(|(signal, pin, place)| (pin, format!("on signal {signal}, {place}")));
    let set =
        hal.values.iter().map(|(pin, value, place)| (pin, format!("set to {value}, {place}")));
    for (pin, how) in wired.chain(set) {
        if said.contains(&pin.as_str()) {
            continue;
        }
        let Some((fate, text)) = fate(pin, letter) else { continue };
        said.push(pin);
        match fate {
            Fate::Pin(_) => w.say(RemarkKind::Rewire, pin, &format!("{text} {how}")),
            Fate::Nothing(_) => w.say(RemarkKind::Unread, pin, &format!("{how}: {text}")),
            Fate::Guard(_) => {
                let (ours, more) = text.split_once([',', ':']).unwrap_or((&text, ""));
                let why = format!("\"{ours}\" once that pin is wired in its place{more}");
                guards += &guard(w, pin, &how, &why);
            }
            Fate::Unguarded(_) => guards += &guard(w, pin, &how, &text),
        }
    }
    for (what, why) in &hal.unseen {
        guards += &guard(w, what, why, "it may wire what stops the machine: look at it");
    }
    if !guards.is_empty() {
        w.text += "\n# What LinuxCNC was stopped by. HAL's drives are led when each has its answer: the pin that does it now, or \"not needed\".\n";
        w.text += "[hal.safety]\n";
        w.text += &guards;
    }
}

/// The line of a guard in the machine file.
fn guard(w: &mut MachineWriter, pin: &str, how: &str, why: &str) -> String {
    let text = format!("{how}: {why}; answer for it in [hal.safety] of the machine file");
    w.say(RemarkKind::Safety, pin, &text);
    let (key, value) = (quoted(pin), quoted(&format!("{UNANSWERED}: {how}")));
    format!("{key} = {value} # MISSING: {why}\n")
}
