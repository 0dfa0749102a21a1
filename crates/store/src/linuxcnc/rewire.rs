//! Pins of LinuxCNC's motion controller, and those of Leadscrew's component in their place.
use super::axes::AxisOf;
use super::hal::Hal;
use super::writer::{MachineWriter, RemarkKind};

/// LinuxCNC's name, Leadscrew's. `N` is a number; of a joint it becomes the axis' letter `L`.
pub const PINS: [(&str, &str); 51] = [
    ("joint.N.motor-pos-cmd", "leadscrew.L.pos-cmd"),
    ("joint.N.pos-cmd", "leadscrew.L.pos-cmd"),
    ("joint.N.vel-cmd", "leadscrew.L.vel-cmd"),
    ("joint.N.motor-pos-fb", "leadscrew.L.pos-fb"),
    ("joint.N.amp-enable-out", "leadscrew.L.enable"),
    ("joint.N.amp-fault-in", "leadscrew.L.fault"),
    ("joint.N.home-sw-in", "leadscrew.L.home-sw"),
    ("joint.N.neg-lim-sw-in", "leadscrew.L.limit-neg"),
    ("joint.N.pos-lim-sw-in", "leadscrew.L.limit-pos"),
    ("spindle.N.speed-out", "leadscrew.spindle.N.speed-cmd"),
    ("spindle.N.speed-out-rps", "leadscrew.spindle.N.speed-cmd-rps"),
    ("spindle.N.on", "leadscrew.spindle.N.enable"),
    ("spindle.N.forward", "leadscrew.spindle.N.forward"),
    ("spindle.N.reverse", "leadscrew.spindle.N.reverse"),
    ("spindle.N.brake", "leadscrew.spindle.N.brake"),
    ("spindle.N.revs", "leadscrew.spindle.N.revs"),
    ("spindle.N.index-enable", "leadscrew.spindle.N.index-enable"),
    ("spindle.N.amp-fault-in", "leadscrew.spindle.N.fault"),
    ("spindle.N.orient", "leadscrew.spindle.N.orient"),
    ("spindle.N.orient-angle", "leadscrew.spindle.N.orient-angle"),
    ("spindle.N.is-oriented", "leadscrew.spindle.N.is-oriented"),
    ("spindle.N.orient-fault", "leadscrew.spindle.N.orient-fault"),
    ("spindle.N.locked", "leadscrew.spindle.N.locked"),
    ("spindle.N.orient-mode", "leadscrew.spindle.N.orient-mode"),
    ("motion.spindle-speed-out", "leadscrew.spindle.0.speed-cmd"),
    ("motion.spindle-speed-out-rps", "leadscrew.spindle.0.speed-cmd-rps"),
    ("motion.spindle-on", "leadscrew.spindle.0.enable"),
    ("motion.spindle-forward", "leadscrew.spindle.0.forward"),
    ("motion.spindle-reverse", "leadscrew.spindle.0.reverse"),
    ("motion.spindle-brake", "leadscrew.spindle.0.brake"),
    ("motion.spindle-revs", "leadscrew.spindle.0.revs"),
    ("motion.spindle-orient", "leadscrew.spindle.0.orient"),
    ("motion.spindle-orient-angle", "leadscrew.spindle.0.orient-angle"),
    ("motion.spindle-is-oriented", "leadscrew.spindle.0.is-oriented"),
    ("motion.spindle-orient-fault", "leadscrew.spindle.0.orient-fault"),
    ("motion.spindle-locked", "leadscrew.spindle.0.locked"),
    ("motion.spindle-orient-mode", "leadscrew.spindle.0.orient-mode"),
    ("motion.probe-input", "leadscrew.probe-in"),
    ("motion.digital-in-N", "leadscrew.din-N"),
    ("motion.digital-out-N", "leadscrew.dout-N"),
    ("motion.analog-in-N", "leadscrew.ain-N"),
    ("motion.analog-out-N", "leadscrew.aout-N"),
    ("iocontrol.N.tool-change", "leadscrew.tool-change"),
    ("iocontrol.N.tool-changed", "leadscrew.tool-changed"),
    ("iocontrol.N.tool-prep-number", "leadscrew.tool-number"),
    ("iocontrol.N.coolant-flood", "leadscrew.coolant-flood"),
    ("iocontrol.N.coolant-mist", "leadscrew.coolant-mist"),
    ("iocontrol.N.emc-enable-in", "leadscrew.estop-in, inverted"),
    ("motion-command-handler", "leadscrew.update"),
    ("motion-controller", "leadscrew.update"),
    ("spindle.N.at-speed", "nothing: Leadscrew sees it from revs"),
];

/// What a pin of LinuxCNC's becomes; `letter` is that of a joint by its number.
pub fn renamed(pin: &str, letter: impl Fn(usize) -> Option<char>) -> Option<String> {
    PINS.iter().find_map(|(theirs, ours)| {
        let Some((before, after)) = theirs.split_once('N') else {
            return (*theirs == pin).then(|| (*ours).to_owned());
        };
        let number = pin.strip_prefix(before)?.strip_suffix(after)?;
        let count = number.parse::<usize>().ok()?;
        let letter = letter(count).map(|letter| letter.to_ascii_lowercase());
        if ours.contains(".L.") {
            letter.map(|letter| ours.replace(".L.", &format!(".{letter}.")))
        } else {
            Some(ours.replacen('N', number, usize::from(!ours.starts_with("nothing"))))
        }
    })
}

/// A remark for each pin that a HAL file wires.
pub(super) fn remarks(w: &mut MachineWriter, hal: &Hal, axes: &[AxisOf]) {
    w.section("", "");
    let letter = |joint: usize| {
        axes.iter().find(|axis| axis.joints.contains(&joint)).map(|axis| axis.letter)
    };
    let mut said = Vec::new();
    for (signal, pin, place) in &hal.pins {
        if said.contains(&pin) {
            continue;
        }
        if let Some(ours) = renamed(pin, letter) {
            said.push(pin);
            w.say(RemarkKind::Rewire, pin, &format!("{ours} on signal {signal}, {place}"));
        }
    }
}
