//! What a program waits for comes from the machine, from a script, or from the operator; in this
//! process and over a socket.

use crate::common::{complained, said};
use crate::simulator::Simulator;
use std::{
    io::Write,
    path::Path,
    process::{Command, Output, Stdio},
};

/// `leadscrew run` of a text, with these arguments.
fn run(text: &str, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    command.args(["run", "-", "--log"]).args(arguments).env("NO_COLOR", "1");
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut process = command.spawn().unwrap();
    process.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    process.wait_with_output().unwrap()
}

/// A file with this text, in a folder that stays as long as it does.
fn file(text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("inputs.txt");
    std::fs::write(&path, text).unwrap();
    (folder, path.display().to_string())
}

/// The time at which the log has a line with these words, s.
fn when(log: &str, words: &str) -> f64 {
    let line = log.lines().find(|line| line.contains(words));
    let line = line.unwrap_or_else(|| panic!("no \"{words}\" in\n{log}"));
    line.split_whitespace().next().unwrap().parse().unwrap()
}

const WAITS: &str = "G21 G90\nM66 P3 L3 Q10\no1 if [#5399 LT 0]\n(MSG,too late)\no1 else\n(MSG,it is there)\no1 endif\nM2\n";

#[test]
fn an_input_comes_when_its_script_says_and_the_program_goes_by_it() {
    let (_folder, path) = file("digital_3 = on at 2 s  # the operator presses a button\n");
    let output = run(WAITS, &["--inputs", &path]);
    let log = said(&output);
    assert_eq!(output.status.code(), Some(0), "{log}{}", complained(&output));
    let came = when(&log, "digital input 3: what was waited for has come");
    assert!((came - 2.0).abs() < 0.002, "{came} s");
    assert!(log.contains("says: it is there"), "{log}");
    let late = said(&run(WAITS, &[]));
    assert!(late.contains("has not come within 10 s") && late.contains("says: too late"), "{late}");
}

#[test]
fn what_is_wrong_with_a_file_of_inputs_is_said_at_once_and_nothing_moves() {
    let (_folder, path) = file("digital_3 = sometimes\nvoltage = 3\n");
    let output = run(WAITS, &["--inputs", &path]);
    let why = complained(&output);
    assert_eq!(output.status.code(), Some(2));
    assert!(why.contains("line 1: expected on or off, found \"sometimes\"; what works: "), "{why}");
    assert!(why.contains("line 2: expected an input from digital_0"), "{why}");
    let output = run(WAITS, &["--inputs", "nowhere.txt"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(complained(&output).contains("nowhere.txt"), "{}", complained(&output));
}

const STOPS: &str = "G21 G90\nG0 X0 Y0\nM0\nG0 X10\nM2\n";

#[test]
fn a_stop_is_confirmed_automatically_and_that_is_said() {
    for arguments in [&[][..], &["--operator", "confirm always"]] {
        let output = run(STOPS, arguments);
        assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
        let told = "operator: confirmed automatically (M0 at line 3)";
        assert!(said(&output).contains(told), "{}", said(&output));
    }
}

#[test]
fn a_stop_waits_until_the_operator_confirms_it() {
    let output = run(STOPS, &["--operator", "confirm at 5s"]);
    let log = said(&output);
    assert_eq!(output.status.code(), Some(0), "{log}{}", complained(&output));
    assert!(when(&log, "ended") > 5.0 && !log.contains("automatically"), "{log}");
}

#[test]
fn a_stop_that_is_not_confirmed_any_more_ends_the_run() {
    let output = run(STOPS, &["--operator", "confirm at 0.1s"]);
    let why = complained(&output);
    assert_eq!(output.status.code(), Some(3), "{}{why}", said(&output));
    assert!(
        why.contains("line 3 waits for operator: M0, and no order to confirm is left"),
        "{why}"
    );
}

#[test]
fn a_tool_that_no_pocket_holds_is_changed_by_hand() {
    let (folder, _) = file("");
    let tools = folder.path().join("tools.toml");
    let text =
        "[[tool]]\nnumber = 7\npocket = 40\nkind = \"drill\"\ndiameter_mm = 5\nlength_mm = 100\n";
    std::fs::write(&tools, text).unwrap();
    let tools = ["--tools", tools.to_str().unwrap()];
    let program = "G21 G90\nT7 M6\nG0 X0\nM2\n";
    let output = run(program, &tools);
    let told = "operator: confirmed automatically (tool 7 by hand at line 2)";
    assert!(said(&output).contains(told), "{}{}", said(&output), complained(&output));
    let output = run(program, &[&tools[..], &["--operator", "confirm at 6s"]].concat());
    let log = said(&output);
    assert!(when(&log, "tool 7 in the spindle") > 6.0, "{log}");
}

const ASKS: &str = "G21 G90 G17 G54\nM64 P1\nM66 P1 L3 Q5\nT20 M6\nG43 H20\nG0 X0 Y0 Z20\nG38.2 Z-10 F300\n\
                    (PRINT,top at Z#5063 vice #5399)\nM2\n";

#[test]
fn inputs_and_the_probe_answer_over_a_socket_as_they_do_in_one_process() {
    let simulator = Simulator::start(&[]);
    let outside = simulator.run(ASKS, &["--log"]);
    let inside = run(ASKS, &[]);
    for output in [&outside, &inside] {
        assert_eq!(output.status.code(), Some(0), "{}{}", said(output), complained(output));
        let log = said(output);
        assert!(log.contains("digital input 1: what was waited for has come"), "{log}");
        assert!(log.contains("says: top at Z-0.012"), "{log}");
    }
}

#[test]
fn a_program_that_goes_on_wrongly_after_an_answer_stops_there_with_the_reason() {
    let text = "G21 G90 G17 G54\nT20 M6\nG43 H20\nG0 X0 Y0 Z20\nG38.2 Z-10 F300\n\
                o1 if [#5063 GT -5]\nG0 Z900\no1 endif\nM2\n";
    let output = run(text, &[]);
    let why = complained(&output);
    assert_eq!(output.status.code(), Some(3), "{}{why}", said(&output));
    assert!(why.contains("line 7: ") && why.contains("travel"), "{why}");
}
