//! Every key of every embedded machine does something: changed, it changes what control, planner,
//! simulated plant, judge or interpreter is told. A key that is read and then forgotten changes
//! nothing.
use crate::job::options::ProgramOptions;
use crate::job::Session;
use crate::config;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;
use store::machine::{EMBEDDED, MachineFile, Preset, embedded, parse};

/// Keys that describe and do nothing.
const DESCRIPTIONS: [&str; 2] = ["name", "description"];

/// Keys that stand by: they act when another key has another value, on any machine that states it.
const STAND_BY: [(&str, &str); 4] = [
    ("prediction", "where `follows` is \"command\""),
    (
        "scale_resolution_nm",
        "where `position_from` is \"motor\", for the machine with scales that extends it",
    ),
    ("motor_counts_per_rev", "where a rotary axis is measured at its table"),
    ("chip_break_mm", "where `retract` is \"full\""),
];

/// Values of keys that are names.
const NAMES: [&str; 47] = [
    "+",
    "-",
    "switch-and-index",
    "switch",
    "hard-stop",
    "absolute",
    "given",
    "motor",
    "scale",
    "table",
    "command",
    "encoder",
    "none",
    "speed",
    "observer",
    "off",
    "coast",
    "quick-stop",
    "coupled-stop",
    "ball-screw",
    "linear-motor",
    "exact",
    "blend",
    "full",
    "chip-break",
    "linear",
    "power-curve",
    "approach",
    "standard",
    "fast",
    "max",
    "linuxcnc",
    "fanuc",
    "haas",
    "mitsubishi",
    "brother",
    "toyoda",
    "C45",
    "AlSi",
    "torque",
    "single-turn",
    "multi-turn",
    "floating",
    "synchronised",
    "initial",
    "r_plane",
    "+x",
    "y",
    "other",
];

/// A line `key = value` of a machine's file, with the value replaced.
fn with_value(text: &str, line: usize, value: &str) -> String {
    let lines = text.lines().enumerate().map(|(at, own)| {
        let Some((key, _)) = own.split_once('=').filter(|_| at == line) else {
            return own.to_owned();
        };
        format!("{key}= {value}")
    });
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

/// The values that a value may be changed to, the least change first.
fn others(value: &str) -> Vec<String> {
    if let Ok(number) = value.replace('_', "").parse::<f64>() {
        let whole = !value.contains('.');
        let near = [1.01, 0.99, 1.1, 0.9, 2.0, 0.5].map(|factor| number * factor);
        let beside = [number + 1.0, number - 1.0, number + 0.25];
        let all = near.into_iter().chain(beside).filter(|other| *other != number);
        return all
            .flat_map(|other| {
                let rounded = format!("{}", other.round() as i64);
                if whole {
                    vec![rounded, format!("{other:.6}")]
                } else {
                    vec![format!("{other:.9}")]
                }
            })
            .filter(|other| other != value)
            .collect();
    }
    match value {
        "true" => vec!["false".into()],
        "false" => vec!["true".into()],
        "\"unlimited\"" => vec!["7".into()],
        _ => NAMES.iter().map(|name| format!("\"{name}\"")).filter(|name| name != value).collect(),
    }
}

/// What control, planner and plant are told, in one number.
fn wired(machine: &MachineFile) -> u64 {
    let mut hash = DefaultHasher::new();
    let mut note = |what: String| what.hash(&mut hash);
    for preset in Preset::NAMES.map(|(_, preset)| preset) {
        let mut driven = machine.clone();
        driven.tapping.preset = preset;
        note(format!("{:?}", config::planner(&driven)));
    }
    note(format!("{:?} {:?}", config::planner(machine), config::path_limits(machine)));
    let follows = config::encoder(&machine.control, sync::Prediction::Observer);
    for mode in [None, Some(follows)] {
        note(format!("{:?}", config::control(machine, mode, true)));
    }
    let (tools, seed) = (canon::ToolLibrary::default(), u64::from(machine.simulation.seed));
    let (material, zero) = (machine.setup.stock.material, machine.setup.g54);
    let config = config::simulator(machine, &tools, material, seed, &zero);
    note(format!("{:?}", config::homing(machine)));
    note(format!("{:?}", config::left_alone(machine, &config)));
    note(format!("{:?}", config::plain_drive(machine)));
    note(format!("{:?} {:?}", config::measured_torques(machine, seed), config::ratings(machine)));
    note(format!("{:?}", config::judge(machine, &tools, material, &zero)));
    hash.finish()
}

/// What a program meets beside that; `None` where the machine is refused.
fn met(machine: &MachineFile, text: &str, file: &Path) -> Option<u64> {
    std::fs::write(file, text).ok()?;
    let programs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../programs");
    let grinds = machine.grinding.is_some();
    let program = programs.join(if grinds { "cam-grind.nc" } else { "plate-12xM6.ngc" });
    let source = std::fs::read(&program).ok()?;
    let session = Session::load(&ProgramOptions::on(file.to_str()?), &program, &source).ok()?;
    let material = machine.setup.stock.material;
    let seed = u64::from(machine.simulation.seed);
    let config = config::simulator(machine, &session.tools, material, seed, &session.work_zero());
    let mut hash = DefaultHasher::new();
    let mut note = |what: String| what.hash(&mut hash);
    note(format!("{:?}", crate::drives::simulated::build(machine, config).ok()?));
    note(format!("{:?}", session.interp_setup()));
    note(format!("{:?}", session.plan_options(material)));
    note(format!("{:?}", session.cams));
    Some(hash.finish())
}

/// Whether a change of the text reaches any component; `None` where it is refused.
fn is_told(before: &MachineFile, text: &str, file: &Path) -> Option<bool> {
    let after = parse(text, 0).ok()?;
    if wired(before) != wired(&after) {
        return Some(true);
    }
    let was = met(before, embedded(&before.name).unwrap_or_default(), file);
    Some(met(&after, text, file)? != was?)
}

/// The keys of a machine's own text that change nothing, whatever they are changed to.
fn idle_keys(name: &str, file: &Path) -> Vec<String> {
    let text = embedded(name).unwrap_or_default();
    let Ok(before) = parse(text, 0) else { panic!("{name} is in order") };
    let mut section = String::new();
    let mut idle = Vec::new();
    for (at, line) in text.lines().enumerate() {
        if line.starts_with('[') {
            section = line.split('#').next().unwrap_or_default().trim().to_owned();
        }
        let Some((key, rest)) = line.split_once('=').filter(|_| !line.starts_with(['#', '[']))
        else {
            continue;
        };
        let (key, value) = (key.trim(), rest.split('#').next().unwrap_or_default().trim());
        if key == "extends" || DESCRIPTIONS.contains(&key) {
            continue;
        }
        let mut accepted = false;
        let acts = others(value).iter().any(|other| {
            let told = is_told(&before, &with_value(text, at, other), file);
            accepted |= told.is_some();
            told == Some(true)
        });
        // a name that no other one can stand for alone is refused: that is told as well
        let stands_by = !accepted || STAND_BY.iter().any(|(stands, _)| *stands == key);
        if !acts && !stands_by {
            idle.push(format!("{name} {section} {key} = {value}"));
        }
    }
    idle
}

#[test]
fn every_key_of_every_embedded_machine_changes_what_somebody_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut idle = Vec::new();
    for name in EMBEDDED {
        idle.extend(idle_keys(name, &folder.path().join("machine.toml")));
    }
    assert!(idle.is_empty(), "these keys are read and ignored:\n{}", idle.join("\n"));
}
