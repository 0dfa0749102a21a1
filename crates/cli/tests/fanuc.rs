//! Fanuc's programs from the command line: files of the search path, kept variables, the machine's
//! own counting.
use crate::common;

use crate::common::{complained, said};
use std::fs;

fn leadscrew(arguments: &[&str]) -> (Option<i32>, String) {
    let output = common::leadscrew(arguments);
    (output.status.code(), format!("{}{}", said(&output), complained(&output)))
}

#[test]
fn subprograms_lie_beside_the_program_and_in_other_folders() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name).display().to_string();
    fs::create_dir(path("macros")).unwrap();
    fs::write(path("main.nc"), "O1\nM98P12\nG65P9000A5.\nM98<POCKET>\nM30\n").unwrap();
    fs::write(path("O0012.nc"), "%\nO0012\nG0X1.\nM99\n%\n").unwrap();
    fs::write(path("macros/9000.NC"), "G0Y#1\nM99\n").unwrap();
    fs::write(path("macros/POCKET"), "<POCKET>\nG0Z-1.\nM99\n").unwrap();
    let main = path("main.nc");
    let canon = ["canon", &main, "--dialect", "fanuc"];
    let (code, text) = leadscrew(&canon);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("no program O9000"), "{text}");
    let macros = path("macros");
    let (code, text) = leadscrew(&[&canon[..], &["--subprograms", &macros]].concat());
    assert_eq!(code, Some(0), "{text}");
    assert_eq!(text.matches("rapid").count(), 3, "{text}");
}

#[test]
fn a_machines_file_says_how_numbers_count_and_variables_are_kept() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name).display().to_string();
    let machine = "extends = \"tapping-center\"\nname = \"fine\"\n[control]\ndialect = \"fanuc\"\n\
        [control.fanuc]\nincrements = \"IS-C\"\n";
    fs::write(path("fine.toml"), machine).unwrap();
    fs::write(path("count.nc"), "O1\n#500=#500+1\nG4P10000\nG53G0Z-#500\nM30\n").unwrap();
    let (program, machine, kept) = (path("count.nc"), path("fine.toml"), path("kept.var"));
    fs::write(&kept, "").unwrap();
    for round in 1..=2 {
        let (code, text) = leadscrew(&[
            "canon",
            &program,
            "--machine",
            &machine,
            "--parameters",
            &kept,
            "--write-parameters",
            &kept,
        ]);
        assert_eq!(code, Some(0), "{text}");
        assert!(text.contains("time_s=1\n"), "10000 of 0.1 ms: {text}");
        assert!(text.contains(&format!("Z-{round}\n")), "{text}");
    }
    let (_, text) = leadscrew(&["machine", "check", &machine]);
    assert!(!text.contains("error"), "{text}");
}
