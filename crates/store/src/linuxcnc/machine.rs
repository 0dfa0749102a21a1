//! The machine as a whole: units, axes, control, tool change, what is clamped.
use super::axes::{AxisOf, LETTERS, Written};
use super::hal::Hal;
use super::ini::{Entry, Ini};
use super::writer::{MachineWriter, Remark, RemarkKind, plain, quoted};
use super::{homing, keys_left, rewire, spindles};

/// The text of a machine file, `None` where something is wrong, and the remarks.
pub fn import(ini: &Ini, hal: &Hal) -> (Option<String>, Vec<Remark>) {
    let mut w = MachineWriter::default();
    let name = ini.get("EMC", "MACHINE").map_or("imported", |entry| &entry.value);
    w.text += "# From a LinuxCNC configuration. Behind each value stands where it comes from; a guess and what is MISSING are to be looked at.\n\n";
    w.text += &format!("name = {}\n", quoted(name));
    w.text += "description = \"From a LinuxCNC configuration\"\n";
    let lathe = ini.get("DISPLAY", "LATHE").filter(|entry| entry.is_yes());
    if let Some(lathe) = lathe {
        w.taken("lathe", "true", &lathe.cited());
    }
    let axes = axes(&mut w, ini);
    if let Some(axes) = &axes {
        machine(&mut w, ini, hal, axes, lathe.is_some());
    }
    rewire::remarks(&mut w, hal, axes.as_deref().unwrap_or_default());
    keys_left::remarks(&mut w, ini);
    finished(w)
}

/// Control, axes, spindles and the rest.
fn machine(w: &mut MachineWriter, ini: &Ini, hal: &Hal, axes: &[AxisOf], is_lathe: bool) {
    let period_us = control(w, ini);
    let orders = orders(w, ini, axes);
    let mut all = Vec::new();
    for (axis, order) in axes.iter().zip(orders) {
        if let Some(written) = axis.write(w, ini, period_us) {
            homing::write(w, ini, axis, &written, order);
            all.push((axis.letter, written));
        }
        if axis.joints.len() > 1 {
            let joints: Vec<String> = axis.joints.iter().map(usize::to_string).collect();
            let text = format!(
                "joints {} move it together: both take {}.pos-cmd, and neither is squared by a switch of its own",
                joints.join(" and "),
                axis.letter.to_ascii_lowercase()
            );
            w.section("", &axis.key());
            w.say(RemarkKind::Missing, "", &text);
        }
    }
    let has_encoder = spindles::write(w, ini, hal, period_us);
    if !has_encoder {
        w.section("", "");
        w.say(RemarkKind::Missing, "leadscrew.spindle.0.revs", "a spindle without an encoder stands to Leadscrew, which waits for its speed in vain: wire one, or leave S out");
    }
    the_rest(w, ini, &all, is_lathe);
}

fn finished(w: MachineWriter) -> (Option<String>, Vec<Remark>) {
    let MachineWriter { text, mut remarks, .. } = w;
    remarks.sort_by_key(|remark| remark.kind);
    let wrong = remarks.iter().any(|remark| remark.kind == RemarkKind::Wrong);
    ((!wrong).then_some(text), remarks)
}

/// mm of a unit of length, degrees of one of angle.
fn units(w: &mut MachineWriter, ini: &Ini) -> Option<(f64, f64)> {
    let linear = ini.get("TRAJ", "LINEAR_UNITS");
    let word = linear.map_or("mm", |entry| &entry.value).to_ascii_lowercase();
    let mm = match word.as_str() {
        "mm" | "metric" | "millimeter" | "millimeters" => Some(1.0),
        "inch" | "in" | "imperial" | "inches" => Some(25.4),
        _ => word.parse::<f64>().ok().filter(|per_mm| *per_mm > 0.0).map(|per_mm| 1.0 / per_mm),
    };
    let angular = ini.get("TRAJ", "ANGULAR_UNITS");
    let word = angular.map_or("degree", |entry| &entry.value).to_ascii_lowercase();
    let deg = match word.as_str() {
        "deg" | "degree" | "degrees" => Some(1.0),
        "grad" | "gon" => Some(0.9),
        "rad" | "radian" | "radians" => Some(180.0 / std::f64::consts::PI),
        _ => word.parse::<f64>().ok().filter(|per_deg| *per_deg > 0.0).map(|per_deg| 1.0 / per_deg),
    };
    let expected = [(linear, mm, "mm or inch"), (angular, deg, "degree, radian or grad")];
    for (entry, _, would) in expected.into_iter().filter(|(_, found, _)| found.is_none()) {
        if let Some(entry) = entry {
            w.wrong(format!("{}: found `{}`, expected {would}", entry.cited(), entry.value));
        }
    }
    match linear {
        Some(entry) => {
            let text = format!("1 unit is {} mm, from {}", plain(mm?), entry.cited());
            w.say(RemarkKind::Taken, "units of length", &text);
        }
        None => w.say(RemarkKind::Guessed, "units of length", "mm: no [TRAJ]LINEAR_UNITS"),
    }
    Some((mm?, deg?))
}

/// Which axes there are, and which joints move them.
fn axes(w: &mut MachineWriter, ini: &Ini) -> Option<Vec<AxisOf>> {
    if !ini.has("JOINT_0") && ini.has("AXIS_0") {
        w.wrong("[AXIS_0] and no [JOINT_0]: a configuration of LinuxCNC 2.7 or older: its update_ini makes one with joints of it".into());
        return None;
    }
    let units = units(w, ini);
    let kinematics = ini.get("KINS", "KINEMATICS");
    let words = kinematics.map_or("trivkins", |entry| &entry.value);
    if words.split_whitespace().next() != Some("trivkins") {
        let cited = kinematics.map(Entry::cited).unwrap_or_default();
        w.wrong(format!(
            "{cited}: found `{words}`, expected trivkins: each axis has its own motors"
        ));
        return None;
    }
    let told = words.split_whitespace().find_map(|word| word.strip_prefix("coordinates="));
    let told = told.map(str::to_ascii_uppercase);
    let used = ini.get("TRAJ", "COORDINATES").map(|entry| entry.value.to_ascii_uppercase());
    let Some(used) = used.or_else(|| told.clone()) else {
        w.wrong("no [TRAJ]COORDINATES: expected the axes' letters, such as X Y Z".into());
        return None;
    };
    let (mm, deg) = units?;
    let by_joint: Vec<char> =
        told.as_deref().unwrap_or(LETTERS).chars().filter(|c| LETTERS.contains(*c)).collect();
    let most = w.number(ini, "KINS", "JOINTS").map_or(9.0, |found| found.value) as usize;
    let mut axes = Vec::new();
    for letter in LETTERS.chars().filter(|letter| used.contains(*letter)) {
        let joints = by_joint.iter().take(most).enumerate();
        let joints: Vec<usize> = joints.filter(|(_, of)| **of == letter).map(|(n, _)| n).collect();
        let scale = if "ABC".contains(letter) { deg } else { mm };
        if joints.is_empty() {
            w.wrong(format!(
                "[TRAJ]COORDINATES has {letter}, and no joint of [KINS]KINEMATICS moves it"
            ));
        }
        axes.push(AxisOf { letter, joints, scale });
    }
    if axes.is_empty() {
        w.wrong(format!("[TRAJ]COORDINATES = {used}: expected letters of {LETTERS}"));
        return None;
    }
    for axis in &axes {
        let joints: Vec<String> = axis.joints.iter().map(usize::to_string).collect();
        let (letter, small) = (axis.letter, axis.letter.to_ascii_lowercase());
        let text = format!("joint {}, leadscrew.{small} in HAL", joints.join(" and "));
        w.say(RemarkKind::Taken, &format!("axis {letter}"), &text);
        if (axis.scale - 1.0).abs() > 1e-12 {
            let (unit, by) = (if axis.is_rotary() { "degrees" } else { "mm" }, plain(axis.scale));
            let text = format!(
                "counts in {unit}: a scale of a HAL file that is per unit of this configuration is divided by {by}, a speed or acceleration multiplied"
            );
            w.say(RemarkKind::Missing, &format!("leadscrew.{small}"), &text);
        }
    }
    let letters: String = axes.iter().map(|axis| axis.letter).collect();
    w.text += &format!("# loadrt leadscrew axes={letters}\n");
    Some(axes)
}

/// Numbers from 1 of `HOME_SEQUENCE`: equal ones together, and only their order counts.
fn orders(w: &mut MachineWriter, ini: &Ini, axes: &[AxisOf]) -> Vec<Option<u32>> {
    let mut sequence = |axis: &AxisOf| {
        axis.of_joint(w, ini, "HOME_SEQUENCE").map(|found| found.value.abs() as u32)
    };
    let numbers: Vec<Option<u32>> = axes.iter().map(&mut sequence).collect();
    let mut all: Vec<u32> = numbers.iter().copied().flatten().collect();
    all.sort_unstable();
    all.dedup();
    let place = |number: u32| all.iter().position(|of| *of == number).map(|at| at as u32 + 1);
    numbers.into_iter().map(|number| place(number?)).collect()
}

/// `[control]` and `[hal]`; the servo period, µs.
fn control(w: &mut MachineWriter, ini: &Ini) -> f64 {
    const NS_PER_US: f64 = 1e3;
    w.section("[control]", "control");
    let period =
        w.number(ini, "EMCMOT", "SERVO_PERIOD").map(|found| found.map(|ns| ns / NS_PER_US));
    let period = period.filter(|found| (50.0..=10_000.0).contains(&found.value));
    let period_us = period.as_ref().map_or(1000.0, |found| found.value);
    match period {
        Some(found) => w.taken("period_us", &plain(period_us), &found.from),
        None => w.guessed("period_us", "1000", "no [EMCMOT]SERVO_PERIOD"),
    }
    w.line("command_delay_periods", "1", "guess: drives obey in the period after");
    w.line("dialect", "\"linuxcnc\"", "as the programs were written for");
    w.section("[control.synchronisation]", "control.synchronisation");
    w.line(
        "follows",
        "\"encoder\"",
        "the spindle is told a speed, and the feed follows its encoder",
    );
    w.line("prediction", "\"observer\"", "guess");
    w.line("encoder_age_periods", "0", "guess: revs is read in the period in which it is used");
    let bandwidth = plain((60_000.0 / period_us).clamp(1.0, 2000.0));
    w.line("observer_bandwidth_hz", &bandwidth, "a sixteenth of the servo rate");
    w.section("[control.waits]", "control.waits");
    w.text += WAITS;
    w.section("[control.overrides]", "control.overrides");
    let overrides = [
        ("feed_most_percent", "MAX_FEED_OVERRIDE", 100.0, 400.0, "120"),
        ("spindle_least_percent", "MIN_SPINDLE_OVERRIDE", 1.0, 100.0, "50"),
        ("spindle_most_percent", "MAX_SPINDLE_OVERRIDE", 100.0, 400.0, "120"),
    ];
    for (ours, theirs, least, most, usual) in overrides {
        match w.number(ini, "DISPLAY", theirs) {
            Some(found) if (least..=most).contains(&(found.value * 100.0)) => {
                w.taken(ours, &plain(found.value * 100.0), &found.from);
            }
            Some(found) => {
                let why =
                    format!("{} says {}: expected {least} to {most} %", found.from, found.value);
                w.guessed(ours, &plain((found.value * 100.0).clamp(least, most)), &why);
            }
            None => w.guessed(ours, usual, &format!("no [DISPLAY]{theirs}")),
        }
    }
    w.section("[hal]", "hal");
    w.line("component", "\"default\"", "loadrt leadscrew name=default");
    w.guessed(
        "silent_after_ms",
        "500",
        "on a computer that has other work; shorter with a real-time kernel",
    );
    w.guessed("obeys_after_periods", "1", "of servo drives that follow within a period; what halscope shows from pos-cmd to pos-fb at speed");
    mdi(w, ini);
    period_us
}

/// Blocks of halui's MDI commands.
fn mdi(w: &mut MachineWriter, ini: &Ini) {
    let stated: Vec<&Entry> = ini.all("HALUI", "MDI_COMMAND").collect();
    if stated.is_empty() {
        return;
    }
    let list = stated.iter().map(|entry| quoted(&entry.value)).collect::<Vec<_>>().join(", ");
    let why = format!("loadrt leadscrew mdi={}: leadscrew.mdi-00 and on", stated.len());
    w.line("mdi", &format!("[{list}]"), &why);
    for (key, entry) in stated.iter().enumerate() {
        let text = format!("{} from {}, by leadscrew.mdi-{key:02}", entry.value, entry.cited());
        w.say(RemarkKind::Taken, "mdi", &text);
    }
}

/// `X Y Z` of a tool change, in units of `mm`; of axes that the machine has, which `at` knows.
fn change_position(
    w: &mut MachineWriter,
    entry: &Entry,
    mm: f64,
    at: impl Fn(char) -> Option<(f64, f64)>,
) {
    let words = entry.value.split_whitespace();
    let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
    let keys = [('X', "x_mm"), ('Y', "y_mm"), ('Z', "z_mm")];
    for ((letter, key), number) in keys.into_iter().zip(&numbers) {
        if at(letter).is_some() || letter == 'Z' {
            w.taken(key, &plain(number * mm), &entry.cited());
        }
    }
    if numbers.len() < 3 {
        w.wrong(format!("{}: found `{}`, expected X Y Z", entry.cited(), entry.value));
    }
}

/// Tool change, tapping, setup, simulation.
fn the_rest(w: &mut MachineWriter, ini: &Ini, axes: &[(char, Written)], lathe: bool) {
    w.section("[tool_change]", "tool_change");
    w.line("time_s", "6", "guess: only times are reckoned with it");
    let at = |letter: char| axes.iter().find(|(of, _)| *of == letter).map(|(_, a)| a.travel);
    let mm = units(&mut MachineWriter::default(), ini).map_or(1.0, |(mm, _)| mm);
    if let Some(entry) = ini.get("EMCIO", "TOOL_CHANGE_POSITION") {
        change_position(w, entry, mm, at);
    } else {
        let top = plain(at('Z').map_or(0.0, |(_, to)| to));
        w.guessed("z_mm", &top, "no [EMCIO]TOOL_CHANGE_POSITION: the top of Z's travel");
    }
    w.line("pockets", "0", "guess: tools are changed by hand, or as HAL's tool-change answers");
    w.section("", "");
    match ini.get("EMCIO", "TOOL_TABLE") {
        Some(entry) => {
            let text =
                format!("{} from {}: leadscrew reads it as it is", entry.value, entry.cited());
            w.say(RemarkKind::Taken, "--tools", &text);
        }
        None => w.say(RemarkKind::Missing, "--tools", "no [EMCIO]TOOL_TABLE"),
    }
    w.section("[tapping]", "tapping");
    w.text += TAPPING;
    w.section("[setup.g54]", "setup.g54");
    for (letter, key) in [('X', "x_mm"), ('Y', "y_mm"), ('Z', "z_mm")] {
        let zero = at(letter).map_or(0.0, |(from, to)| 0.0_f64.clamp(from, to));
        w.line(key, &plain(zero), "guess: until it is touched off");
    }
    w.say(RemarkKind::Guessed, "", "machine zero: until the work is touched off");
    w.section("[setup.stock]", "setup.stock");
    w.text += if lathe { BAR } else { BLOCK };
    w.say(RemarkKind::Guessed, "", "what is clamped: only the judged workpiece is made of it");
    w.section("[simulation]", "simulation");
    w.text += SIMULATION;
}

const WAITS: &str = "\
ready_s = 5                           # guess: drives come up
at_speed_s = 20                       # guess
oriented_s = 10                       # guess
in_position_s = 5                     # guess
tool_change_s = 600                   # guess: by hand
";
const TAPPING: &str = "\
sync_warn_um = 40                     # guess
sync_stop_um = 500                    # guess
ramp = \"power-curve\"
preset = \"standard\"
";
const BLOCK: &str = "\
material = \"C45\"
x_from_mm = -50
x_to_mm = 50
y_from_mm = -50
y_to_mm = 50
z_from_mm = -30
z_to_mm = 0
";
const BAR: &str = "\
material = \"C45\"
x_from_mm = -10
x_to_mm = 10
y_from_mm = -10
y_to_mm = 10
z_from_mm = -60
z_to_mm = 0
";
const SIMULATION: &str = "\
substep_us = 50
seed = 1

[simulation.tap_seat]
flank_clearance_um = 0.5
flank_stiffness_n_per_um = 100
";
