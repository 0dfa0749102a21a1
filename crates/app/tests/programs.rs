//! Whole runs of the shipped programs: what is judged, and that it is good.
#![allow(clippy::unwrap_used)] // a test may panic
mod common;
use common::{complained, leadscrew, said};
use serde_json::Value;

/// Every feature of a run in a line of figures that a person can check: rounded so that a change of tuning below the
/// resolution of the question does not show, and no worse than the largest errors promised.
fn verdicts(program: &str) -> String {
    let output = leadscrew(&["run", program, "--format", "json", "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    let certificate: Value = serde_json::from_str(&said(&output)).unwrap();
    assert_eq!(certificate["ended"], true);
    assert_eq!(certificate["alarms"], Value::Array(Vec::new()));
    let mut lines = String::new();
    for feature in certificate["features"].as_array().unwrap() {
        let number = |key: &str| feature[key].as_f64().unwrap_or(f64::NAN);
        let at = format!("line {:3}", feature["line"]);
        let verdict = feature["verdict"].as_str().unwrap();
        let depth = number("depth_mm");
        lines += &match feature["kind"].as_str().unwrap() {
            "hole" => {
                format!("{at} hole Ø{:.2} depth {depth:.1} {verdict}\n", number("diameter_mm"))
            }
            "thread" => {
                assert!(number("sync_error_max_um") <= 10.0, "{feature}");
                assert!(number("depth_error_um").abs() <= 10.0, "{feature}");
                format!(
                    "{at} {} {} depth {depth:.2} class {} {verdict}\n",
                    feature["size"].as_str().unwrap(),
                    feature["hand"].as_str().unwrap(),
                    feature["class"].as_str().unwrap(),
                )
            }
            other => panic!("unexpected feature {other}"),
        };
    }
    lines
}

#[test]
fn the_plate_has_twelve_good_threads() {
    insta::assert_snapshot!(verdicts("programs/plate-12xM6.ngc"));
}

#[test]
fn the_bracket_has_small_and_large_threads() {
    insta::assert_snapshot!(verdicts("programs/m3-and-m10.ngc"));
}

#[test]
fn the_cover_is_tapped_in_inches() {
    insta::assert_snapshot!(verdicts("programs/inch-unc.ngc"));
}

#[test]
fn the_flange_has_left_hand_threads_beside_right_hand_ones() {
    insta::assert_snapshot!(verdicts("programs/left-hand.ngc"));
}

/// A turned thread, on its machine: the helix is the judge's, from the program's words.
#[test]
fn the_bolt_gets_its_thread_in_sixteen_passes() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let program = "programs/thread-m20x1.5.ngc";
    let args = ["run", program, "--machine", "lathe", "-q", "--out", out.to_str().unwrap()];
    let output = leadscrew(&args);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    let text = std::fs::read_to_string(out.join("certificate.json")).unwrap();
    let certificate: serde_json::Value = serde_json::from_str(&text).unwrap();
    let thread = &certificate["features"][0];
    let number = |key: &str| thread[key].as_f64().unwrap();
    assert_eq!(thread["kind"], "turned-thread");
    // 0.25·n^½ ≥ 0.92 at n = 14, and two spring passes
    assert_eq!((number("passes"), number("passes_ordered")), (16.0, 16.0));
    assert_eq!((number("from_mm"), number("to_mm")), (0.0, -23.5));
    assert!(number("sync_error_max_um") < 10.0 && number("pass_spread_um") < 5.0, "{thread}");
}

/// The certificate of a program for the lathe, in a Fanuc lathe's words.
fn turned(program: &str) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let out_name = out.to_str().unwrap();
    let dialect = ["--dialect", "fanuc-lathe-a", "--machine", "lathe"];
    let output = leadscrew(&[&["run", program, "-q", "--out", out_name][..], &dialect].concat());
    assert_eq!(output.status.code(), Some(0), "{}{}", said(&output), complained(&output));
    serde_json::from_str(&std::fs::read_to_string(out.join("certificate.json")).unwrap()).unwrap()
}

#[test]
fn the_pockets_of_the_feed_screw_move_apart_turn_by_turn() {
    let certificate = turned("programs/feed-screw.nc");
    let screw = &certificate["features"][0];
    let number = |key: &str| screw[key].as_f64().unwrap();
    assert!(number("sync_error_max_um") < 5.0 && number("pass_spread_um") < 1.0, "{screw}");
    // 3 mm, then from Z-3 on 3·n + 0.2·n²/2 for 15 turns, then 6 mm
    let n_at = |depth: f64| match depth - 3.0 {
        before if before < 0.0 => before / 3.0,
        grown if grown < 67.5 => ((9.0 + 0.4 * grown).sqrt() - 3.0) / 0.2,
        after => 15.0 + (after - 67.5) / 6.0,
    };
    let depth_at = |n: f64| {
        let grown = n.clamp(0.0, 15.0);
        3.0 + 3.0 * n + 0.1 * grown * grown + 3.0 * (n - 15.0).max(0.0)
    };
    let mut text = format!(
        "{} lead {} growing {} passes {} of {}, Z{} to Z{}, {}\n",
        screw["kind"].as_str().unwrap(),
        number("lead_mm"),
        number("lead_growth_mm"),
        number("passes"),
        number("passes_ordered"),
        number("from_mm"),
        number("to_mm"),
        screw["verdict"].as_str().unwrap(),
    );
    for turn in screw["leads_mm"].as_array().unwrap() {
        let [depth, ordered, cut] = [0, 1, 2].map(|i| turn[i].as_f64().unwrap());
        let n = n_at(depth);
        let wanted = depth_at(n + 1.0) - depth_at(n);
        assert!((ordered - wanted).abs() < 2e-6, "{turn}: {wanted}");
        assert!((cut - wanted).abs() < 2e-3, "{turn}: {wanted}");
        text += &format!("from {depth:.0} mm on: {ordered:.2} ordered, {cut:.2} cut\n");
    }
    insta::assert_snapshot!(text);
}

#[test]
fn the_bolt_circles_come_out_of_one_subroutine() {
    insta::assert_snapshot!(verdicts("programs/bolt-circle.ngc"));
}

#[test]
fn two_runs_are_the_same_to_the_last_bit_and_another_seed_is_not() {
    let run = |seed: &str| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let out_name = out.to_str().unwrap();
        let program = "programs/inch-unc.ngc";
        let output = leadscrew(&["run", program, "-q", "--seed", seed, "--out", out_name]);
        assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
        let read = |name: &str| std::fs::read(out.join(name)).unwrap();
        (read("certificate.json"), read("report.html"), read("trace.parquet"))
    };
    let first = run("7");
    assert!(first == run("7"), "two runs of the same inputs differ");
    assert!(first.2 != run("8").2, "the seed changes nothing");
}

#[test]
fn both_tool_tables_describe_the_same_tools() {
    let run = |table: &str| {
        let output = leadscrew(&["canon", "programs/plate-12xM6.ngc", "--tools", table]);
        assert!(output.status.success(), "{}", complained(&output));
        said(&output)
    };
    assert_eq!(run("programs/tools.toml"), run("programs/tools.tbl"));
}

#[test]
fn a_ramp_steeper_than_the_power_curve_saturates_the_drive_and_the_error_grows() {
    let error = |arguments: &[&str]| {
        let mut all = vec!["run", "programs/plate-12xM6.ngc", "--format", "json", "-q"];
        all.extend(arguments);
        let certificate: Value = serde_json::from_str(&said(&leadscrew(&all))).unwrap();
        let features = certificate["features"].as_array().unwrap();
        let errors = features.iter().filter_map(|f| f["sync_error_max_um"].as_f64());
        errors.fold(0.0, f64::max)
    };
    let planned = error(&[]);
    let forced = error(&["--force-ramp", "0.22"]);
    assert!(forced > 5.0 * planned, "planned {planned} µm, forced {forced} µm");
}

/// A drill that slides sideways over the work, a few hundredths deep, breaks: no hole is out of tolerance, and yet the run
/// is no good one. (Deeper it is refused before.)
#[test]
fn a_run_that_breaks_its_tool_is_not_called_good() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("sideways.ngc");
    let text = "G21 G90 G54\nT1 M6\nS3000 M3\nG43 H1\nG0 X0 Y0 Z2\nG1 Z-0.045 F300\nX5\nG0 Z20\nM30\n";
    std::fs::write(&program, text).unwrap();
    let output = leadscrew(&["run", program.to_str().unwrap()]);
    assert!(said(&output).contains("INVARIANT BROKEN: ") && said(&output).contains("FAIL: "));
    let why = "the tool is broken: T1 spot drill 10 mm, moved 2.50 mm sideways in the work of 2.50 mm it withstands, at X2.5 Y0 Z-0.0";
    assert!(said(&output).contains(why), "{}", said(&output));
    assert!(complained(&output).contains("warning[M0361]"), "{}", complained(&output));
    assert_eq!(output.status.code(), Some(1), "{}{}", said(&output), complained(&output));
}
