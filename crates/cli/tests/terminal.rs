//! What a command says where: widths, silence, JSON, faults that did not come.
use crate::common::{complained, leadscrew, said};
use serde_json::Value;

const PLATE: &str = "programs/plate-12xM6.ngc";

fn widest(text: &str) -> usize {
    text.lines()
        .filter(|line| line.contains('─'))
        .map(|line| line.chars().count())
        .max()
        .unwrap_or(0)
}

#[test]
fn the_tables_of_a_run_fit_a_terminal_of_80_columns() {
    let runs: [&[&str]; 5] = [
        &[PLATE],
        &["programs/inch-unc.ngc"],
        &["programs/thread-m20x1.5.ngc", "--machine", "lathe"],
        &["programs/hexagon-af17.nc", "--machine", "polygon-lathe"],
        &["programs/cam-shaft.nc", "--machine", "cam-grinder"],
    ];
    for run in runs {
        let output = leadscrew(&[&["run"], run].concat());
        let text = said(&output);
        assert!((1..=80).contains(&widest(&text)), "{text}");
    }
}

#[test]
fn where_there_is_no_terminal_a_table_is_as_wide_as_a_page() {
    let compare = ["compare", "--size", "M6", "--samples", "4"];
    for command in [&["machine", "list"][..], &["codes"], &compare] {
        let text = said(&leadscrew(command));
        let end = text.rfind('─').unwrap_or_default();
        assert!(text[..end].lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}

#[test]
fn quiet_says_nothing_of_a_good_run_and_only_what_is_wrong_of_a_bad_one() {
    let output = leadscrew(&["run", PLATE, "-q"]);
    assert_eq!((said(&output).as_str(), complained(&output).as_str()), ("", ""));
    assert_eq!(output.status.code(), Some(0));
    let output = leadscrew(&["run", PLATE, "-q", "--force-ramp", "0.05"]);
    let text = said(&output);
    assert_ne!(output.status.code(), Some(0));
    assert!(text.starts_with("✗ line") && !text.contains("report:"), "{text}");
    for command in [&["check", PLATE, "-q"][..], &["time", PLATE, "-q"]] {
        assert_eq!(said(&leadscrew(command)), "");
    }
}

#[test]
fn a_refusal_is_json_where_json_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.ngc");
    std::fs::write(&bad, "G21\nG1 X10 Q5\nM2\n").unwrap();
    let bad = bad.to_str().unwrap();
    let none = "/nowhere/none.ngc";
    let commands: [&[&str]; 11] = [
        &["doctor", "--machine", "nothing-like-it"],
        &["doctor", "--seconds", "4000"],
        &["run", bad],
        &["run", none],
        &["run", PLATE, "--machine", "nothing-like-it"],
        &["check", none],
        &["time", bad],
        &["recover", "--simulator", "/nowhere/iron"],
        &["cam", "/nowhere/lift.csv", "--base", "18"],
        &["polygon", "--across-flats", "-1"],
        &["compensation", none],
    ];
    for command in commands {
        let output = leadscrew(&[command, &["--format", "json"]].concat());
        assert_eq!(output.status.code(), Some(2), "{command:?}");
        let found: Value = serde_json::from_str(&said(&output)).unwrap();
        let first = &found.as_array().unwrap()[0];
        assert_eq!(first["severity"], "error", "{command:?}: {found}");
        assert!(first["message"].as_str().is_some_and(|m| !m.is_empty()), "{command:?}: {found}");
    }
    // a command line that cannot be read is a refusal as well
    let output = leadscrew(&["time", PLATE, "--no-such-option", "--format", "json"]);
    let found: Value = serde_json::from_str(&said(&output)).unwrap();
    assert!(found[0]["message"].as_str().unwrap().contains("--no-such-option"), "{found}");
}

#[test]
fn a_fault_that_was_not_triggered_fails_the_run() {
    let output = leadscrew(&["run", PLATE, "--fault", "power-cut at depth 80mm", "-q"]);
    assert_eq!(output.status.code(), Some(1));
    let text = complained(&output);
    assert!(text.contains("fault not triggered: power-cut at depth 80mm"), "{text}");
}

#[test]
fn progress_is_said_in_plain_lines_where_that_is_asked_for() {
    let output = leadscrew(&["time", PLATE, "--progress", "lines"]);
    let text = complained(&output);
    assert!(text.contains("planning: "), "{text}");
    assert_eq!(complained(&leadscrew(&["time", PLATE])), "");
}

#[test]
fn no_control_character_of_a_program_or_a_name_reaches_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let hostile = "\u{1b}]0;title\u{7}\u{1b}[31m\u{9b}2J\u{8}";
    let path = |name: &str| folder.path().join(name).display().to_string();
    let good = path(&format!("{hostile}good.ngc"));
    let bad = path(&format!("{hostile}bad.ngc"));
    let missing = path(&format!("{hostile}missing.ngc"));
    std::fs::write(&good, format!("G21\n(MSG,{hostile})\n(PRINT,{hostile})\nM2\n")).unwrap();
    std::fs::write(&bad, format!("G21 ({hostile})\nG0 X{hostile} {hostile}\nG1 X1 ({hostile})\n"))
        .unwrap();
    let commands: [&[&str]; 14] = [
        &[hostile],
        &["run", &good, hostile, "--seed", hostile],
        &["run", &good, "--log"],
        &["run", &bad],
        &["run", &missing],
        &["run", &good, "--machine", &missing],
        &["run", &good, "--tools", &bad],
        &["run", &good, "--out", &path(&format!("{hostile}/{hostile}"))],
        &["check", &good, &bad, &missing],
        &["time", &bad],
        &["fmt", "--check", &good, &bad],
        &["canon", &bad, "--format", "json"],
        &["recover", "--simulator", &missing],
        &["simulator", "--listen", &bad],
    ];
    for command in commands {
        let output = leadscrew(command);
        for text in [said(&output), complained(&output)] {
            let obeyed = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
            assert!(!text.contains(obeyed), "{command:?}: {text:?}");
        }
    }
}

#[test]
fn the_doctor_answers_by_its_exit_code_whether_a_machine_can_be_led() {
    let output = leadscrew(&["doctor", "--seconds", "0.05", "--format", "json"]);
    let found: Value = serde_json::from_str(&said(&output)).unwrap();
    let wrong = |found: &Value| found["health"] == "wrong";
    let is_wrong = found["findings"].as_array().unwrap().iter().any(wrong);
    assert_eq!(output.status.code(), Some(i32::from(is_wrong)), "{found}");
    assert_eq!(found["can_lead"], !is_wrong);
    // 50 ms of the machine's period of 250 µs
    assert_eq!(found["latency"]["periods"], 200, "{found}");
}

#[test]
fn options_of_programs_are_refused_where_a_machine_alone_is_led() {
    for command in ["drives", "simulator"] {
        let output = leadscrew(&[command, "--dialect", "fanuc"]);
        assert_eq!(output.status.code(), Some(2), "{command}");
        assert!(complained(&output).contains("--dialect"), "{}", complained(&output));
    }
}
