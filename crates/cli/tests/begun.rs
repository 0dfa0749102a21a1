//! Programs begun in their middle (`run --from`): what the part before has left in the work is
//! known to the simulated machine and to the judge, and what was left out is not judged.
//!
//! ```text
//!   run part             features  1 … n
//!   run part --from …    features      k … n     the same verdicts, the same sizes
//! ```
use crate::common::{complained, leadscrew, root, said};
use serde_json::Value;

/// Exit code, and each feature: its line and whether it is good.
fn run(program: &str, tools: Option<&str>, options: &[&str]) -> (Option<i32>, Vec<Value>, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part.nc");
    let table = folder.path().join("tools.toml");
    let shop = std::fs::read_to_string(root().join("programs/tools.toml")).unwrap();
    std::fs::write(&path, program).unwrap();
    std::fs::write(&table, tools.unwrap_or(&shop)).unwrap();
    let fixed = ["run", path.to_str().unwrap(), "--format", "json"];
    let output = leadscrew(&[&fixed[..], options].concat());
    let told = format!("{}{}", said(&output), complained(&output));
    let certificate: Value = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    let features = certificate["features"].as_array().cloned().unwrap_or_default();
    (output.status.code(), features, told)
}

fn lines(features: &[Value]) -> Vec<u64> {
    features.iter().map(|feature| feature["line"].as_u64().unwrap()).collect()
}

const PLATE: &str = "G21 G90 G54 G17\nT2 M6\nS3000 M3\nG0 X0 Y0\nG43 H2 Z20\nG99 G81 X10 Y10 Z-18 R3 F300\nX30\nX50\nG80\n\
T3 M6\nS1000 M3\nG0 X10 Y10\nG43 H3 Z20\nG99 G84 X10 Y10 Z-12 R4 F1000\nX30\nX50\nG80\nG0 Z50\nM2\n";

/// Holes of 5.4 mm for M6, whose minor diameter is 5.236 mm at most (ISO 965-1, 6H): each thread is
/// bad, begun where it may be.
#[test]
fn a_tap_finds_the_holes_that_were_drilled_before_the_beginning() {
    let shop = std::fs::read_to_string(root().join("programs/tools.toml")).unwrap();
    let wide = shop.replacen("diameter_mm = 5.0", "diameter_mm = 5.4", 1);
    assert_ne!(shop, wide);
    let (code, whole, told) = run(PLATE, Some(&wide), &[]);
    assert_eq!((code, whole.len()), (Some(1), 6), "{told}");
    for hole in [4, 5] {
        let from = format!("hole {hole}");
        let (code, begun, told) = run(PLATE, Some(&wide), &["--from", &from]);
        assert_eq!(code, Some(1), "{told}");
        assert_eq!(lines(&begun), lines(&whole[hole - 1..]), "{told}");
        assert!(begun.iter().all(|feature| feature["verdict"] == whole[5]["verdict"]), "{told}");
    }
    let (code, begun, told) = run(PLATE, None, &["--from", "hole 5"]);
    assert_eq!((code, lines(&begun)), (Some(0), vec![15, 16]), "{told}");
}

/// A program that asks for an input is interpreted while it runs, from its beginning; what is left
/// out asks nothing.
#[test]
fn a_program_that_asks_the_machine_is_begun_before_and_behind_its_question() {
    let asks = PLATE.replace("G80\nT3 M6", "G80\nM66 P0 L3 Q2\nT3 M6");
    assert_ne!(asks, PLATE);
    let folder = tempfile::tempdir().unwrap();
    let inputs = folder.path().join("inputs.txt");
    std::fs::write(&inputs, "digital_0 = on at 0.5 s\n").unwrap();
    let inputs = ["--inputs", inputs.to_str().unwrap()];
    let (code, whole, told) = run(&asks, None, &inputs);
    assert_eq!((code, whole.len()), (Some(0), 6), "{told}");
    for (from, first) in [("hole 2", 1), ("tool 3", 3), ("hole 5", 4)] {
        let (code, begun, told) = run(&asks, None, &[&inputs[..], &["--from", from]].concat());
        assert_eq!((code, lines(&begun)), (Some(0), lines(&whole[first..])), "{from}: {told}");
    }
}

/// The bar of 20 mm is turned to 16 mm; a thread M16x1.5 is cut on it, and one on the bar that is
/// left behind the groove.
const TURNED: &str = "%\nO1\nG21 G18 G97 G99\nT3333\nS1000 M3\nG0 X24. Z5.\nX18.\nG1 Z-30. F0.3\nG0 X24. Z5.\nX16.\nG1 Z-30. F0.3\nG0 X60. Z60.\n\
T3232\nS800 M3\nG0 X20. Z6.\nG92 X15.4 Z-20. F1.5\nX15.\nX14.6\nX14.3\nX14.1\nX14.03\nX14.03\nG0 X60. Z60.\nM30\n%\n";
const LATHE: [&str; 4] = ["--machine", "lathe", "--dialect", "fanuc-lathe-a"];

#[test]
fn a_thread_is_cut_on_the_bar_that_was_turned_before_the_beginning() {
    let (code, whole, told) = run(TURNED, None, &LATHE);
    assert_eq!(whole.len(), 1, "{told}");
    for line in ["16", "20"] {
        let (begun_code, begun, told_begun) =
            run(TURNED, None, &[&LATHE[..], &["--from", line]].concat());
        assert_eq!(begun_code, code, "{told}\n{told_begun}");
        assert_eq!(begun[0]["verdict"], whole[0]["verdict"], "{told}\n{told_begun}");
    }
    // without the turning the bar is too thick for any thread of this root
    let whole_bar: String = TURNED
        .lines()
        .filter(|line| !line.starts_with("X18.") && !line.starts_with("X16."))
        .fold(String::new(), |all, line| all + line + "\n");
    let (code, _, told) = run(&whole_bar, None, &LATHE);
    assert_ne!(code, Some(0), "{told}");
}

/// What the part before would have done to the machine is said, and ends nothing.
#[test]
fn a_machine_that_waits_before_the_beginning_does_not_wait_in_the_simulation_of_it() {
    let held = PLATE.replace("G80\nT3 M6", "G80\nM0\nG4 P600\nT3 M6");
    let (code, begun, told) = run(&held, None, &["--from", "hole 4"]);
    assert_eq!((code, begun.len()), (Some(0), 3), "{told}");
}
