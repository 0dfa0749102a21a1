//! `leadscrew control` as a user leads it: what is refused moves nothing and says why; a script
//! that fails comes to rest.
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn led(options: &[&str], script: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .arg("control")
        .args(options)
        .args(["--script", "-"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(script.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

/// What is said, with the exit code.
fn said(output: &Output) -> (String, String, i32) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr), output.status.code().unwrap())
}

/// A control that is homed.
const MORNING: &str = "power on\nwait ready within 3 s\nhome\nwait homed within 120 s\n";

#[test]
fn a_request_that_is_none_is_said_with_its_line_and_ends_the_script() {
    for (line, expected) in [
        ("jump", "help lists them"),
        ("power", "power on|off"),
        ("jog q +1", "axis such as X"),
        ("jog x 10", "jog X +10"),
        ("feed many", "a number"),
        ("wait for godot", "completed"),
        ("offset G60 x 1", "G54 to G59.3"),
        ("search hole x", "hole 5"),
    ] {
        let (_, errors, code) = said(&led(&[], &format!("power on\n{line}\npower off\n")));
        assert_eq!(code, 2, "{line}: {errors}");
        assert!(errors.starts_with("-:2: ") && errors.contains(expected), "{line}: {errors}");
    }
}

#[test]
fn a_script_with_lines_that_mean_nothing_is_told_all_of_them_and_moves_nothing() {
    let script = format!("{MORNING}jump\njog x -10\nfeed many\nwait standstill\n");
    let (out, errors, code) = said(&led(&[], &script));
    assert_eq!((out.as_str(), code), ("", 2), "{errors}");
    let lines: Vec<&str> = errors.lines().collect();
    assert_eq!(lines.len(), 2, "{errors}");
    assert!(lines[0].starts_with("-:5: ") && lines[1].starts_with("-:7: "), "{errors}");
}

#[test]
fn what_the_state_does_not_allow_is_refused_with_what_would() {
    for (script, expected) in [
        ("start\n", "load one first"),
        ("jog x -1\n", "power on"),
        ("load programs/plate-12xM6.ngc\nstart\n", "power on"),
        ("resume\n", "start one first"),
        ("retract\n", "no tap stands in a thread"),
        ("emergency stop\nwait 1 s\npower on\n", "release it"),
    ] {
        let (_, errors, code) = said(&led(&[], script));
        assert_eq!(code, 2, "{script}: {errors}");
        assert!(errors.contains(expected), "{script}: {errors}");
    }
}

#[test]
fn a_jog_that_cannot_be_names_the_number_that_works() {
    for (line, expected) in [
        ("jog b +1", "has no axis B, only XYZ"),
        ("jog x to 3", "from -500.000 mm to 0.000 mm"),
        ("jog x at -90000 for 1 s", "from -50000.000 mm to 50000.000 mm"),
        ("spindle 99999", "rev/min, found"),
    ] {
        let (_, errors, code) = said(&led(&[], &format!("{MORNING}{line}\n")));
        assert_eq!(code, 2, "{line}: {errors}");
        assert!(errors.contains(expected), "{line}: {errors}");
    }
}

#[test]
fn typed_blocks_with_an_error_are_shown_with_their_place_and_move_nothing() {
    let script = format!("{MORNING}mdi G1 X-10; G0 Z-5\nwait completed\n");
    let (out, errors, code) = said(&led(&[], &script));
    assert_eq!(code, 2, "{out}{errors}");
    assert!(errors.contains("G1 X-10") && errors.contains('^'), "{errors}");
}

#[test]
fn a_program_that_is_refused_is_not_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("part.ngc");
    std::fs::write(&part, "G0 X1\nG1 X2 F\nM2\n").unwrap();
    let script = format!("{MORNING}load {}\n", part.display());
    let (_, errors, code) = said(&led(&[], &script));
    assert!(code == 2 && errors.contains("G1 X2 F"), "{errors}");
    let (_, errors, code) = said(&led(&[], "load no/such/file.ngc\n"));
    assert!(code == 2 && errors.contains("no/such/file.ngc"), "{errors}");
}

#[test]
fn a_wait_that_is_not_met_says_how_it_is() {
    let (_, errors, code) = said(&led(&[], "wait ready within 1 s\n"));
    assert_eq!(code, 1, "{errors}");
    assert!(errors.contains("MANUAL READY"), "{errors}");
}

#[test]
fn a_script_that_ends_while_a_program_runs_gives_it_up_and_says_so() {
    let script = format!("{MORNING}load programs/plate-12xM6.ngc\nstart\nwait active\nwait 1 s\n");
    let (_, errors, code) = said(&led(&[], &script));
    assert_eq!(code, 1, "{errors}");
    assert!(errors.contains("it is given up"), "{errors}");
}

#[test]
fn a_search_shows_what_is_restored_and_never_begins_within_a_tap() {
    let script = format!(
        "{MORNING}load programs/plate-12xM6.ngc\nsearch hole 26\nsearch tool 2\nsearch line 9999\n"
    );
    let (out, errors, code) = said(&led(&[], &script));
    assert!(out.contains("T3 ") && out.contains("25 features are left out"), "{out}");
    assert!(out.contains("T2 "), "{out}");
    assert!(code == 2 && errors.contains("nothing moves at line 9999"), "{errors}");
}

#[test]
fn an_emergency_stop_is_an_alarm_until_it_is_released_and_reset() {
    let script = format!(
        "{MORNING}jog x -50\nemergency stop\nwait alarm within 1 s\nemergency release\nreset\nalarms\npower on\nwait ready\njog x -1\nwait standstill\n"
    );
    let (out, errors, code) = said(&led(&[], &script));
    assert_eq!(code, 0, "{out}{errors}");
    assert!(out.contains("alarm 101") && out.contains("(cleared)"), "{out}");
}

#[test]
fn hold_in_a_tap_retract_and_the_remaining_program_leave_good_threads() {
    // the tap is stopped at depth, backed out, and the hole is cut again from a search
    let script = format!(
        "{MORNING}load programs/plate-12xM6.ngc\nsearch tool 3\nstart\nwait activity tap-in within 60 s\nwait tool in work\nwait 60 ms\nhold\nwait held within 5 s\nfeed 50\nstatus\nretract\nwait tool out within 30 s\nstop\nwait stopped within 10 s\n"
    );
    let (out, errors, code) = said(&led(&[], &script));
    assert_eq!(code, 0, "{out}{errors}");
    assert!(out.contains("locked by a synchronised cut"), "{out}");
    assert!(out.contains("STOPPED"), "{out}");
}

#[test]
fn the_position_of_the_last_program_counts_what_this_run_has_cut_and_not_the_runs_before() {
    let home = tempfile::tempdir().unwrap();
    let part = home.path().join("part.ngc");
    std::fs::write(
        &part,
        "G21 G90 G54\nT1 M6\nG43 H1\nS1000 M3\nG81 X0 Y0 Z-1 R5 F100\nG80\nG0 Z50\nM2\n",
    )
    .unwrap();
    let state = home.path().join("state");
    let run = "start\nwait completed within 60 s\n";
    let script = format!("{MORNING}load {}\n{run}{run}", part.display());
    let (_, errors, code) = said(&led(&["--state", state.to_str().unwrap()], &script));
    assert_eq!(code, 0, "{errors}");
    let kept = std::fs::read_to_string(state.join("program.toml")).unwrap();
    let number = |name: &str| -> u32 {
        let line = kept.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
        line.unwrap().parse().unwrap()
    };
    assert_eq!(number("feature"), 1, "{kept}");
    assert!((1..20).contains(&number("operation")), "{kept}");
}

#[test]
fn what_an_alarm_has_made_impossible_is_not_waited_for() {
    for wait in
        ["completed", "active", "paused", "homed", "activity tap-in", "line 9", "tool in work"]
    {
        let script = format!(
            "power on\nwait ready within 3 s\nemergency stop\nwait {wait} within 86400 s\n"
        );
        let (out, errors, code) = said(&led(&[], &script));
        let expected =
            format!("\"wait {wait} within 86400 s\" cannot be met any more: alarm 101: ");
        assert!(errors.contains(&expected) && code == 1, "{code}: {out}{errors}");
    }
    let script = "power on\nwait ready within 3 s\nemergency stop\nwait alarm within 1 s\nemergency release\nwait ready within 86400 s\n";
    let (_, errors, code) = said(&led(&[], script));
    assert!(
        errors.contains("cannot be met any more: alarm 101: ") && code == 1,
        "{code}: {errors}"
    );
}

#[test]
fn what_comes_with_an_alarm_or_after_it_is_waited_for() {
    let script = format!(
        "{MORNING}mdi S1000 M3; G1 X-100 F100\nwait active within 5 s\nwait 2 s\nemergency stop\nwait alarm within 5 s\nwait standstill within 20 s\n"
    );
    let (out, errors, code) = said(&led(&[], &script));
    assert_eq!(code, 0, "{out}{errors}");
}
