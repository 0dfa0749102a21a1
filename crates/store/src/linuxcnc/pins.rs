//! What becomes of each pin of LinuxCNC's motion controller, its I/O controller and its user
//! interface in HAL.
//!
//! A pin that stops something, or keeps it from starting, is a *guard*: the machine does not start
//! until a person has answered for it in the machine file ([`super::guards`]).
use Fate::{Guard, Nothing, Pin, Unguarded};

/// What becomes of a pin of LinuxCNC's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// This pin of Leadscrew's takes its place.
    Pin(&'static str),
    /// This pin of Leadscrew's takes its place, and without it something would not be stopped.
    Guard(&'static str),
    /// It stops something, and no pin of Leadscrew's does: what to do instead.
    Unguarded(&'static str),
    /// It is not used, and why.
    Nothing(&'static str),
}

const CHAIN: &str = "put it into the chain of leadscrew.estop-ok, which stops the machine";
const BY_ITSELF: &str = "Leadscrew sees it from revs";
const HOMES: &str = "Leadscrew homes with the switch, or where the drive counts from";
const PAGE: &str = "this is on Leadscrew's page and in its API, no pin shows or asks for it";
const SHOWN: &str = "nothing is moved by it: the page and the API show it";
const WHEEL: &str =
    "a count is always a way: the wheel has no speed, and jogs as fast as the axis may";
const NO_OFFSET: &str = "offsets from outside are not superposed on a program";
const POCKET: &str = "Leadscrew asks for a tool by tool-change and tool-number alone";
const CHANGER: &str = "a changer that does not answer within tool_change_s is an alarm";

/// LinuxCNC's name, and what becomes of it; the first that fits counts. `N` is a number, of a joint
/// the axis' letter `L`; `*` is any end.
#[rustfmt::skip]
const PINS: &[(&str, Fate)] = &[
    ("joint.N.motor-pos-cmd", Pin("leadscrew.L.pos-cmd")),
    ("joint.N.pos-cmd", Pin("leadscrew.L.pos-cmd")),
    ("joint.N.vel-cmd", Pin("leadscrew.L.vel-cmd")),
    ("joint.N.motor-pos-fb", Pin("leadscrew.L.pos-fb")),
    ("joint.N.amp-enable-out", Pin("leadscrew.L.enable")),
    ("joint.N.amp-fault-in", Pin("leadscrew.L.fault")),
    ("joint.N.home-sw-in", Pin("leadscrew.L.home-sw")),
    ("joint.N.neg-lim-sw-in", Pin("leadscrew.L.limit-neg")),
    ("joint.N.pos-lim-sw-in", Pin("leadscrew.L.limit-pos")),
    ("joint.N.index-enable", Pin("leadscrew.L.index-enable")),
    ("joint.N.is-unlocked", Unguarded("an axis that is locked at rest is moved without waiting for its lock: keep its lock open, or leave the axis out")),
    ("joint.N.unlock", Unguarded("an axis that is locked at rest is moved without opening its lock: keep its lock open, or leave the axis out")),
    ("joint.N.jog-counts", Pin("leadscrew.L.jog-counts")),
    ("joint.N.jog-scale", Pin("leadscrew.L.jog-scale")),
    ("joint.N.jog-enable", Pin("leadscrew.L.jog-enable")),
    ("joint.N.jog-*", Nothing(WHEEL)),
    ("joint.N.pos-fb", Pin("leadscrew.L.pos-fb")),
    ("joint.N.homing", Nothing(HOMES)),
    ("joint.N.homed", Nothing(SHOWN)),
    ("joint.N.posthome-cmd", Nothing("an extra joint is no axis: it stays with what moves it")),
    ("joint.N.motor-offset", Nothing(SHOWN)),
    ("axis.L.jog-counts", Pin("leadscrew.L.jog-counts")),
    ("axis.L.jog-scale", Pin("leadscrew.L.jog-scale")),
    ("axis.L.jog-enable", Pin("leadscrew.L.jog-enable")),
    ("axis.L.jog-*", Nothing(WHEEL)),
    ("axis.L.eoffset*", Nothing(NO_OFFSET)),
    ("axis.L.pos-cmd", Nothing("Leadscrew's axes are its joints: leadscrew.L.pos-cmd")),
    ("spindle.N.inhibit", Guard("leadscrew.spindle.N.inhibit")),
    ("spindle.N.amp-fault-in", Pin("leadscrew.spindle.N.fault")),
    ("spindle.N.speed-out", Pin("leadscrew.spindle.N.speed-cmd")),
    ("spindle.N.speed-out-rps", Pin("leadscrew.spindle.N.speed-cmd-rps")),
    ("spindle.N.speed-out-abs", Pin("leadscrew.spindle.N.speed-cmd, through LinuxCNC's component abs")),
    ("spindle.N.speed-out-rps-abs", Pin("leadscrew.spindle.N.speed-cmd-rps, through LinuxCNC's component abs")),
    ("spindle.N.on", Pin("leadscrew.spindle.N.enable")),
    ("spindle.N.forward", Pin("leadscrew.spindle.N.forward")),
    ("spindle.N.reverse", Pin("leadscrew.spindle.N.reverse")),
    ("spindle.N.brake", Pin("leadscrew.spindle.N.brake")),
    ("spindle.N.revs", Pin("leadscrew.spindle.N.revs")),
    ("spindle.N.index-enable", Pin("leadscrew.spindle.N.index-enable")),
    ("spindle.N.orient", Pin("leadscrew.spindle.N.orient")),
    ("spindle.N.orient-angle", Pin("leadscrew.spindle.N.orient-angle")),
    ("spindle.N.orient-mode", Pin("leadscrew.spindle.N.orient-mode")),
    ("spindle.N.orient-fault", Pin("leadscrew.spindle.N.orient-fault")),
    ("spindle.N.is-oriented", Pin("leadscrew.spindle.N.is-oriented")),
    ("spindle.N.locked", Pin("leadscrew.spindle.N.locked")),
    ("spindle.N.at-speed", Nothing(BY_ITSELF)),
    ("spindle.N.speed-in", Nothing(BY_ITSELF)),
    ("motion.spindle-inhibit", Guard("leadscrew.spindle.0.inhibit")),
    ("motion.spindle-speed-out", Pin("leadscrew.spindle.0.speed-cmd")),
    ("motion.spindle-speed-out-rps", Pin("leadscrew.spindle.0.speed-cmd-rps")),
    ("motion.spindle-on", Pin("leadscrew.spindle.0.enable")),
    ("motion.spindle-forward", Pin("leadscrew.spindle.0.forward")),
    ("motion.spindle-reverse", Pin("leadscrew.spindle.0.reverse")),
    ("motion.spindle-brake", Pin("leadscrew.spindle.0.brake")),
    ("motion.spindle-revs", Pin("leadscrew.spindle.0.revs")),
    ("motion.spindle-index-enable", Pin("leadscrew.spindle.0.index-enable")),
    ("motion.spindle-orient", Pin("leadscrew.spindle.0.orient")),
    ("motion.spindle-orient-angle", Pin("leadscrew.spindle.0.orient-angle")),
    ("motion.spindle-orient-mode", Pin("leadscrew.spindle.0.orient-mode")),
    ("motion.spindle-orient-fault", Pin("leadscrew.spindle.0.orient-fault")),
    ("motion.spindle-is-oriented", Pin("leadscrew.spindle.0.is-oriented")),
    ("motion.spindle-locked", Pin("leadscrew.spindle.0.locked")),
    ("motion.spindle-at-speed", Nothing(BY_ITSELF)),
    ("motion.spindle-speed-in", Nothing(BY_ITSELF)),
    ("motion.feed-inhibit", Guard("leadscrew.feed-inhibit")),
    ("motion.feed-hold", Guard("leadscrew.feed-inhibit, whatever M53 says")),
    ("motion.enable", Unguarded(CHAIN)),
    ("motion.jog-inhibit", Unguarded("nothing keeps axes from being jogged: leadscrew.feed-inhibit holds programs alone")),
    ("motion.jog-stop*", Unguarded("no pin stops a jog, which ends 0.2 s after the page's key is released: put it into the chain of leadscrew.estop-ok if that is too late")),
    ("motion.homing-inhibit", Unguarded("nothing keeps axes from being homed")),
    ("motion.probe-input", Pin("leadscrew.probe-in")),
    ("motion.digital-in-N", Pin("leadscrew.din-N")),
    ("motion.digital-out-N", Pin("leadscrew.dout-N")),
    ("motion.analog-in-N", Pin("leadscrew.ain-N")),
    ("motion.analog-out-N", Pin("leadscrew.aout-N")),
    ("motion.adaptive-feed", Nothing("a feed that HAL scales is not read: the override on the page does it")),
    ("motion.motion-enabled", Pin("leadscrew.connected: a control leads the machine; each drive has its enable")),
    ("iocontrol.N.emc-enable-in", Pin("leadscrew.estop-ok: TRUE, the chain is closed; wire what ends in it")),
    ("iocontrol.N.user-enable-out", Unguarded("the page has no pin for its emergency stop: close the chain behind leadscrew.estop-ok without it")),
    ("iocontrol.N.user-request-enable", Unguarded("the page has no pin that resets a latch: reset the chain behind leadscrew.estop-ok by a button")),
    ("iocontrol.N.tool-change", Pin("leadscrew.tool-change")),
    ("iocontrol.N.tool-changed", Pin("leadscrew.tool-changed")),
    ("iocontrol.N.tool-prep-number", Pin("leadscrew.tool-number")),
    ("iocontrol.N.tool-number", Pin("leadscrew.tool-number")),
    ("iocontrol.N.tool-prepare", Nothing("Leadscrew does not prepare a tool before it asks for the change: wire what prepares to leadscrew.tool-change")),
    ("iocontrol.N.tool-prepared", Nothing("Leadscrew waits for no preparation: tool-changed answers for both")),
    ("iocontrol.N.tool-prep-*", Nothing(POCKET)),
    ("iocontrol.N.tool-from-pocket", Nothing(POCKET)),
    ("iocontrol.N.toolchanger-*", Nothing(CHANGER)),
    ("iocontrol.N.start-change*", Nothing(CHANGER)),
    ("iocontrol.N.coolant-flood", Pin("leadscrew.coolant-flood")),
    ("iocontrol.N.coolant-mist", Pin("leadscrew.coolant-mist")),
    ("iocontrol.N.lube", Nothing("lubrication has no pin: leadscrew.connected tells that a control leads the machine")),
    ("iocontrol.N.lube_level", Nothing("a low level stops nothing, as in LinuxCNC: it is not shown either")),
    ("iocontrol.N.emc-abort*", Nothing(SHOWN)),
    ("iocontrol.N.emc-reason", Nothing(SHOWN)),
    ("halui.program.pause", Guard("leadscrew.hold")),
    ("halui.program.stop", Guard("leadscrew.stop")),
    ("halui.abort", Guard("leadscrew.stop")),
    ("halui.program.run", Pin("leadscrew.cycle-start")),
    ("halui.program.resume", Pin("leadscrew.cycle-start")),
    ("halui.estop.activate", Unguarded(CHAIN)),
    ("halui.machine.off", Unguarded(CHAIN)),
    ("halui.spindle.N.stop", Unguarded("no pin stops a spindle alone: leadscrew.stop ends the program, leadscrew.spindle.N.inhibit stops the spindle while it is set")),
    ("halui.spindle-stop", Unguarded("no pin stops a spindle alone: leadscrew.stop ends the program, leadscrew.spindle.0.inhibit stops the spindle while it is set")),
    ("halui.machine.on", Pin("leadscrew.power-on")),
    ("halui.home-all", Pin("leadscrew.home-all")),
    ("halui.flood.on", Pin("leadscrew.flood-on")),
    ("halui.flood.off", Pin("leadscrew.flood-off")),
    ("halui.mist.on", Pin("leadscrew.mist-on")),
    ("halui.mist.off", Pin("leadscrew.mist-off")),
    ("halui.mdi-command-N", Pin("leadscrew.mdi-N")),
    ("halui.program.optional-stop.on", Pin("leadscrew.optional-stop: as long as it is TRUE")),
    ("halui.program.block-delete.on", Pin("leadscrew.block-skip: as long as it is TRUE")),
    ("halui.feed-override.counts", Pin("leadscrew.feed-override.counts")),
    ("halui.feed-override.scale", Pin("leadscrew.feed-override.scale")),
    ("halui.feed-override.count-enable", Pin("leadscrew.feed-override.count-enable")),
    ("halui.feed-override.direct-value", Pin("leadscrew.feed-override.direct-value")),
    ("halui.rapid-override.counts", Pin("leadscrew.rapid-override.counts")),
    ("halui.rapid-override.scale", Pin("leadscrew.rapid-override.scale")),
    ("halui.rapid-override.count-enable", Pin("leadscrew.rapid-override.count-enable")),
    ("halui.rapid-override.direct-value", Pin("leadscrew.rapid-override.direct-value")),
    ("halui.spindle.0.override.counts", Pin("leadscrew.spindle-override.counts")),
    ("halui.spindle.0.override.scale", Pin("leadscrew.spindle-override.scale")),
    ("halui.spindle.0.override.count-enable", Pin("leadscrew.spindle-override.count-enable")),
    ("halui.spindle.0.override.direct-value", Pin("leadscrew.spindle-override.direct-value")),
    ("halui.spindle-override.counts", Pin("leadscrew.spindle-override.counts")),
    ("halui.spindle-override.scale", Pin("leadscrew.spindle-override.scale")),
    ("halui.spindle-override.count-enable", Pin("leadscrew.spindle-override.count-enable")),
    ("halui.spindle-override.direct-value", Pin("leadscrew.spindle-override.direct-value")),
    ("halui.axis.jog-speed", Pin("leadscrew.jog-speed")),
    ("halui.axis.L.plus", Pin("leadscrew.L.jog-plus: with leadscrew.jog-enable TRUE")),
    ("halui.axis.L.minus", Pin("leadscrew.L.jog-minus: with leadscrew.jog-enable TRUE")),
    ("halui.joint.N.plus", Pin("leadscrew.L.jog-plus: with leadscrew.jog-enable TRUE")),
    ("halui.joint.N.minus", Pin("leadscrew.L.jog-minus: with leadscrew.jog-enable TRUE")),
    ("halui.joint.N.has-fault", Nothing(SHOWN)),
    ("halui.*.is-*", Nothing(SHOWN)),
    ("halui.estop.reset", Nothing("a closed chain is enough: leadscrew.reset clears the alarm")),
    ("halui.*", Nothing(PAGE)),
    ("ini.*", Nothing("limits are those of the machine file while the control runs")),
];

/// Components of LinuxCNC's whose pins are gone with it.
const COMPONENTS: [&str; 7] = ["motion", "joint", "axis", "spindle", "iocontrol", "halui", "ini"];

/// Words by which a pin that no line knows may stop something.
const STOPS: [&str; 9] =
    ["inhibit", "hold", "enable", "estop", "stop", "abort", "fault", "lock", "brake"];

/// What becomes of a pin, with Leadscrew's name in full; `None`: it is none of LinuxCNC's own
/// components. `letter` is that of a joint by its number.
pub fn fate(pin: &str, letter: impl Fn(usize) -> Option<char>) -> Option<(Fate, String)> {
    let component = pin.split('.').next().unwrap_or_default();
    if !COMPONENTS.contains(&component) {
        return None;
    }
    for (theirs, fate) in PINS {
        let Some(number) = fits(pin, theirs) else { continue };
        return Some(match fate {
            Pin(ours) | Guard(ours) if ours.contains(".L.") => {
                let by_letter = number.chars().next().filter(char::is_ascii_alphabetic);
                let Some(of) = by_letter.or_else(|| number.parse().ok().and_then(&letter)) else {
                    let none = "its joint moves no axis of this machine";
                    return Some((Nothing(none), none.into()));
                };
                (*fate, ours.replace(".L.", &format!(".{}.", of.to_ascii_lowercase())))
            }
            Pin(ours) | Guard(ours) | Unguarded(ours) => {
                let input = ours.replacen("-N", &format!("-{number}"), 1);
                (*fate, input.replace(".N.", &format!(".{number}.")))
            }
            Nothing(why) => (*fate, (*why).to_owned()),
        });
    }
    let unknown = "no pin of Leadscrew's is like it";
    let stops = STOPS.iter().any(|word| pin.contains(word));
    Some((if stops { Unguarded(unknown) } else { Nothing(unknown) }, unknown.into()))
}

/// The number, or the letter, in a pin that is of this pattern; empty where the pattern has none.
fn fits<'a>(pin: &'a str, pattern: &str) -> Option<&'a str> {
    let (head, end) = match pattern.split_once('*') {
        Some((head, end)) => (head, Some(end)),
        None => (pattern, None),
    };
    let (before, after) = match head.split_once(".N").or_else(|| head.split_once("-N")) {
        Some((before, after)) => (before.len() + 1, after),
        None => match head.split_once(".L") {
            Some((before, after)) => (before.len() + 1, after),
            None => return rest(pin.strip_prefix(head)?, end).then_some(""),
        },
    };
    let (name, number) = (pin.get(..before)?, pin.get(before..)?);
    if !head.starts_with(name) {
        return None;
    }
    let digits = number.find(['.', '-']).unwrap_or(number.len());
    let (number, left) = number.split_at(digits);
    let is_number = number.bytes().all(|b| b.is_ascii_digit()) || number.len() == 1;
    let left = left.strip_prefix(after).filter(|_| is_number && !number.is_empty())?;
    rest(left, end).then_some(number)
}

/// Whether what is left of a pin is what a pattern allows behind its `*`.
fn rest(left: &str, end: Option<&str>) -> bool {
    match end {
        None => left.is_empty(),
        Some(end) => end.split('*').all(|part| left.contains(part)),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn of(pin: &str) -> Option<(Fate, String)> {
        fate(pin, |joint| (joint == 2).then_some('Z'))
    }

    #[test]
    fn each_pin_has_its_name_and_a_joint_its_letter() {
        let name = |pin| of(pin).unwrap().1;
        assert_eq!(name("joint.2.motor-pos-cmd"), "leadscrew.z.pos-cmd");
        assert!(matches!(of("joint.3.motor-pos-cmd"), Some((Nothing(_), _))));
        assert_eq!(name("spindle.1.revs"), "leadscrew.spindle.1.revs");
        assert_eq!(name("motion.digital-in-03"), "leadscrew.din-03");
        assert_eq!(name("motion.probe-input"), "leadscrew.probe-in");
        assert_eq!(name("halui.mdi-command-04"), "leadscrew.mdi-04");
        assert_eq!(name("axis.y.jog-counts"), "leadscrew.y.jog-counts");
        assert_eq!(name("joint.2.jog-enable"), "leadscrew.z.jog-enable");
        assert_eq!(name("halui.spindle.0.override.counts"), "leadscrew.spindle-override.counts");
        assert_eq!(of("encoder.0.position"), None);
        for (_, fate) in PINS {
            if let Pin(ours) | Guard(ours) = fate {
                assert!(ours.starts_with("leadscrew."), "{ours}");
            }
        }
    }

    #[test]
    fn what_stops_something_is_a_guard_also_where_no_line_knows_it() {
        for pin in ["spindle.0.inhibit", "motion.feed-inhibit", "motion.feed-hold", "halui.abort"] {
            assert!(matches!(of(pin), Some((Guard(_), _))), "{pin}");
        }
        for pin in [
            "motion.enable",
            "iocontrol.0.user-enable-out",
            "halui.estop.activate",
            "motion.tp-inhibit",
        ] {
            assert!(matches!(of(pin), Some((Unguarded(_), _))), "{pin}");
        }
        for pin in [
            "axis.x.jog-vel-mode",
            "axis.x.eoffset-enable",
            "joint.0.jog-counts",
            "halui.machine.is-on",
            "motion.current-vel",
        ] {
            assert!(matches!(of(pin), Some((Nothing(_), _))), "{pin}");
        }
    }
}
