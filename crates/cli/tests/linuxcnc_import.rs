//! `leadscrew machine import`: LinuxCNC's configurations become machine files that load, or are
//! refused with all that is wrong.
//!
//! Where LinuxCNC is installed, all its sample configurations are imported; what an INI file says
//! is compared with LinuxCNC's own reader, `inivar`.
use crate::common::{complained, root, said};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use store::machine::{self, HomingMethod};

fn leadscrew(words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    command.args(words).env("NO_COLOR", "1").output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn the_example_becomes_a_machine_that_can_be_checked_and_cuts_the_plate() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("mill.toml");
    let ini = root().join("machines/hal/from/mill.ini");
    let output = leadscrew(&["machine", "import", text(&ini), "--out", text(&out)]);
    assert!(output.status.success(), "{}", complained(&output));
    let remarks = said(&output);
    for part in [
        "taken    axes.z.travel_from_mm: -400 from mill.ini:",
        "taken    spindles.0.encoder_counts_per_rev: 4096 from mill.hal:19 encoder.0.position-scale",
        "taken    spindles.0.drive.acceleration_rev_per_s2: 66.7 from mill.hal:17 ramp.maxv",
        "guessed  hal.silent_after_ms",
        "rewire   joint.2.motor-pos-cmd: leadscrew.z.pos-cmd on signal z-cmd, mill.hal:14",
        "rewire   spindle.0.revs: leadscrew.spindle.0.revs on signal angle, mill.hal:20",
        "rewire   iocontrol.0.emc-enable-in: leadscrew.estop-ok",
        "safety   spindle.0.inhibit: on signal door, mill.hal:24: \"leadscrew.spindle.0.inhibit\" once",
        "safety   motion.feed-inhibit: on signal door, mill.hal:24",
    ] {
        assert!(remarks.contains(part), "{part}\n{remarks}");
    }
    let checked = leadscrew(&["machine", "check", text(&out)]);
    assert!(checked.status.success());
    assert!(
        said(&checked)
            .contains("[hal.safety] spindle.0.inhibit is unanswered: on signal door, mill.hal:24")
    );
    let led = leadscrew(&["control", "--drives", "hal", "--machine", text(&out)]);
    assert!(
        complained(&led).contains("motion.feed-inhibit is unanswered: on signal door, mill.hal:24")
    );
    assert!(said(&leadscrew(&["machine", "show", text(&out)])).contains("[hal]"));
    let plate = root().join("programs/plate-12xM6.ngc");
    let checked = leadscrew(&["check", text(&plate), "--machine", text(&out)]);
    let findings = said(&checked) + &complained(&checked);
    assert!(!findings.contains("machine file"), "{findings}");

    // what was edited is not lost
    let again = leadscrew(&["machine", "import", text(&ini), "--out", text(&out)]);
    assert_eq!(again.status.code(), Some(2));
    assert!(complained(&again).contains("is there already"), "{}", complained(&again));
}

#[test]
fn without_out_the_file_goes_to_standard_output_and_the_remarks_to_standard_error() {
    let ini = root().join("machines/hal/from/mill.ini");
    let output = leadscrew(&["machine", "import", text(&ini)]);
    let file = machine::parse(&said(&output), 0).unwrap();
    assert_eq!((file.name.as_str(), file.axes.iter().flatten().count()), ("Bed mill", 3));
    assert_eq!(file.axis(canon::Axis::Z).unwrap().homing.method, HomingMethod::Absolute);
    assert!(complained(&output).contains("taken "));
}

#[test]
fn what_is_wrong_is_said_at_once_and_no_file_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let ini = folder.path().join("broken.ini");
    let whole = std::fs::read_to_string(root().join("machines/hal/from/mill.ini")).unwrap();
    let broken = whole.replace("MIN_LIMIT = -500", "MIN_LIMIT = -50,0").replace("= mm", "= foot");
    std::fs::write(&ini, broken).unwrap();
    let out = folder.path().join("broken.toml");
    let output = leadscrew(&["machine", "import", text(&ini), "--out", text(&out)]);
    assert_eq!(output.status.code(), Some(2));
    let complaint = complained(&output);
    assert!(complaint.contains("found `foot`, expected mm or inch"), "{complaint}");
    assert!(complaint.contains("mill.hal is not there"), "{complaint}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the INI file");
    let long = folder.path().join("long.ini");
    std::fs::write(&long, "# x\n".repeat(300_000)).unwrap();
    let output = leadscrew(&["machine", "import", text(&long)]);
    assert!(complained(&output).contains("larger than"), "{}", complained(&output));
    let output = leadscrew(&["machine", "import", "/nowhere.ini"]);
    assert!(complained(&output).contains("cannot read /nowhere.ini"), "{}", complained(&output));
}

/// The sample configurations of Debian's package; `None`: it is not installed.
fn samples() -> Option<PathBuf> {
    let folder = PathBuf::from("/usr/share/doc/linuxcnc/examples/sample-configs");
    folder.is_dir().then_some(folder)
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|of| of == "ini") {
            found.push(path);
        }
    }
}

/// What LinuxCNC itself reads of a file.
fn inivar(ini: &Path, section: &str, key: &str) -> Option<f64> {
    let words = ["-ini", text(ini), "-sec", section, "-var", key];
    let output = Command::new("inivar").args(words).output().ok()?;
    output.status.success().then(|| said(&output).trim().parse().unwrap())
}

#[test]
fn linuxcncs_sample_configurations_become_machines_or_are_refused_with_a_reason() {
    let Some(folder) = samples() else { return eprintln!("not run: LinuxCNC is not installed") };
    let mut all = Vec::new();
    files(&folder, &mut all);
    assert!(all.len() > 200, "{}", all.len());
    let mut refused = 0;
    for path in &all {
        let imported = store::linuxcnc::read(path, &[]).unwrap();
        let Some(text) = imported.text else {
            let wrong =
                imported.remarks.iter().any(|r| r.kind == store::linuxcnc::RemarkKind::Wrong);
            assert!(wrong, "{}", path.display());
            refused += 1;
            continue;
        };
        let parsed = machine::parse(&text, 0);
        assert!(parsed.is_ok(), "{}: {:#?}", path.display(), parsed.err());
    }
    // deltas, hexapods, SCARAs, files of the version before joints, files without limits, fragments
    assert!(refused * 5 < all.len(), "{refused} of {}", all.len());
}

/// A mill in mm, one in inches, a lathe, a gantry, real ones with an encoder on the spindle.
#[test]
fn travels_are_those_that_linuxcncs_own_reader_finds() {
    let Some(folder) = samples() else { return eprintln!("not run: LinuxCNC is not installed") };
    for (name, mm, axes, counts) in [
        ("sim/axis/axis_mm.ini", 1.0, "XYZ", None),
        ("sim/axis/axis.ini", 25.4, "XYZ", None),
        ("sim/axis/lathe.ini", 25.4, "XZ", None),
        ("sim/axis/gantry/gantry_mm.ini", 1.0, "XYZ", None),
        ("by_interface/parport/nist-lathe/inch.ini", 25.4, "XYZ", Some(1024)),
        ("by_machine/smithy/1315.ini", 25.4, "XZ", Some(4096)),
    ] {
        let path = folder.join(name);
        let imported = store::linuxcnc::read(&path, &[]).unwrap();
        let file = machine::parse(&imported.text.unwrap(), 0).unwrap();
        let letters: String = file.axes.iter().flatten().map(|axis| axis.letter.letter()).collect();
        assert_eq!(letters, axes, "{name}");
        for axis in file.axes.iter().flatten() {
            let section = format!("AXIS_{}", axis.letter.letter());
            let from = inivar(&path, &section, "MIN_LIMIT").unwrap() * mm;
            let to = inivar(&path, &section, "MAX_LIMIT").unwrap() * mm;
            assert!(axis.travel.from.value() >= from - 1e-6, "{name} {section}: {axis:?}");
            assert!(axis.travel.to.value() <= to + 1e-6, "{name} {section}: {axis:?}");
            let speed = inivar(&path, &section, "MAX_VELOCITY").map_or(f64::INFINITY, |v| v * mm);
            assert!(axis.rapid.value() <= speed + 1e-5, "{name} {section}: {axis:?}");
        }
        if let Some(counts) = counts {
            assert_eq!(file.spindles[0].encoder_counts_per_rev, counts, "{name}");
        }
    }
}
