//! What a program leaves behind, written to LinuxCNC's files and read back from them.
use crate::common::{complained, leadscrew, said};
use std::fs;
use std::path::Path;

const SETS: &str = "G21 G90\n#100=3.25\n#<_mine>=1\n#7=9\nG10 L2 P2 X-5.5 Y6 R30\nG0 X150\nG28.1\nG10 L1 P3 Z99.5\nM2\n";

fn written(command: &str, folder: &Path) -> (String, String) {
    let path = |name: &str| folder.join(name).display().to_string();
    fs::write(folder.join("sets.ngc"), SETS).unwrap();
    let output = leadscrew(&[
        command,
        &path("sets.ngc"),
        "--write-parameters",
        &path("left.var"),
        "--write-tools",
        &path("left.tbl"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    (read("left.var"), read("left.tbl"))
}

#[test]
fn parameters_and_tools_are_left_as_the_program_has_set_them() {
    for command in ["canon", "run"] {
        let folder = tempfile::tempdir().unwrap();
        let (parameters, tools) = written(command, folder.path());
        for line in ["100\t3.250000", "5241\t-5.500000", "5242\t6.000000", "5250\t30.000000"] {
            assert!(parameters.lines().any(|l| l == line), "{line} is not in\n{parameters}");
        }
        // machine coordinates of the place where the program stood: G54 is at X-250
        assert!(parameters.contains("5161\t-100.000000\n"), "{parameters}");
        assert!(!parameters.lines().any(|l| l.starts_with("7\t")), "{parameters}");
        let numbers: Vec<u32> =
            parameters.lines().map(|l| l.split('\t').next().unwrap().parse().unwrap()).collect();
        assert!(numbers.is_sorted());
        assert!(tools.lines().any(|l| l.starts_with("T3 P3 Z99.5 D6 ;")), "{tools}");
    }
}

#[test]
fn what_was_left_is_there_for_the_next_program() {
    let folder = tempfile::tempdir().unwrap();
    written("canon", folder.path());
    let path = |name: &str| folder.path().join(name).display().to_string();
    let asks = "G21 G90\nT3 M6\nG43\nG55\n(PRINT, #100 #5403 #5241)\nM2\n";
    fs::write(folder.path().join("asks.ngc"), asks).unwrap();
    let output = leadscrew(&[
        "canon",
        &path("asks.ngc"),
        "--parameters",
        &path("left.var"),
        "--tools",
        &path("left.tbl"),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    let told = said(&output);
    assert!(told.contains("3.250000 99.500000 -5.500000"), "{told}");
}

#[test]
fn a_refused_program_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::write(folder.path().join("bad.ngc"), "#100=1\nG12\nM2\n").unwrap();
    let output = leadscrew(&["canon", &path("bad.ngc"), "--write-parameters", &path("left.var")]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!folder.path().join("left.var").exists());
}
