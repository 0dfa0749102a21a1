//! Polygons from the command line: whole runs with all the machine's physics, and what becomes of
//! one that fails.
use crate::common::{complained, leadscrew, said};
use serde_json::Value;

/// More cutters: T91 one insert, T92 two at a right angle.
const TOOLS: &str = r#"
[[tool]]
number = 21
kind = "polygon-cutter"
tip_radius_mm = 50.0
inserts = 3
nose_radius_mm = 0.8
length_mm = 60.0

[[tool]]
number = 22
kind = "polygon-cutter"
tip_radius_mm = 50.0
inserts = 2
nose_radius_mm = 0.8
length_mm = 60.0

[[tool]]
number = 91
kind = "polygon-cutter"
tip_radius_mm = 50.0
inserts = 1
nose_radius_mm = 0.8
length_mm = 60.0

[[tool]]
number = 92
kind = "polygon-cutter"
tip_radius_mm = 50.0
insert_angles_deg = [0.0, 90.0]
nose_radius_mm = 0.8
length_mm = 60.0
"#;

/// Cut 3 mm with a tool at a distance of the axes; the exit code, and the certificate if there is
/// one.
fn cut(tool: u32, gear: &str, x: f64, more: &[&str]) -> (i32, Value, String) {
    cut_in(&tempfile::tempdir().unwrap(), tool, gear, x, more)
}

/// The same in a folder that stays.
fn cut_in(
    folder: &tempfile::TempDir,
    tool: u32,
    gear: &str,
    x: f64,
    more: &[&str],
) -> (i32, Value, String) {
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let text = format!(
        "G21 G90 G94 G17\nT{tool} M6\nG43 H{tool}\nG0 X85 Y0 Z5\nM3 S500\nG51.2 {gear}\n\
         G0 X{x} Z2\nG1 Z-3 F50\nG0 X85\nG50.2\nM5\nM2\n"
    );
    std::fs::write(at("part.nc"), text).unwrap();
    std::fs::write(at("tools.toml"), TOOLS).unwrap();
    let (part, tools, out) = (at("part.nc"), at("tools.toml"), at("out"));
    let mut all = vec!["run", &part, "--machine", "polygon-lathe", "-q", "--out", &out];
    all.extend(["--tools", &tools]);
    all.extend(more);
    let output = leadscrew(&all);
    let found = std::fs::read_to_string(folder.path().join("out/certificate.json"));
    let certificate = found.map_or(Value::Null, |text| serde_json::from_str(&text).unwrap());
    (output.status.code().unwrap(), certificate, complained(&output))
}

/// Flatness, tilt and across flats of a part that passes.
#[track_caller]
fn good(tool: u32, gear: &str, x: f64, flatness_um: f64) -> Value {
    let (code, certificate, complaints) = cut(tool, gear, x, &[]);
    assert_eq!(code, 0, "{complaints}{certificate}");
    let part = certificate["features"][0].clone();
    let number = |key: &str| part[key].as_f64().unwrap();
    assert!(number("flatness_um") <= flatness_um, "{part}");
    assert!(number("tilt_deg").abs() <= 0.05, "{part}");
    // the screw of X errs by 3 µm at most once per revolution, here and where it was touched off,
    // and twice in a diameter
    assert!(number("across_flats_error_um").abs() <= 5.0 + 4.0 * 3.0, "{part}");
    part
}

#[test]
fn a_hexagon_of_17_mm_is_flat_to_two_micrometres_and_bulges_by_nine_without_a_swing() {
    good(21, "P1 Q2 D0", 58.5, 2.0);
    let (_, plain, _) = cut(21, "P1 Q2", 58.5, &[]);
    let flatness = plain["features"][0]["flatness_um"].as_f64().unwrap();
    assert!((flatness - 8.7).abs() < 0.2, "{flatness}");
}

#[test]
fn a_square_of_30_mm_is_flat_to_three_micrometres() {
    good(22, "P1 Q2 D0", 65.0, 3.0);
}

#[test]
fn a_pentagon_at_five_to_two_is_cut_by_one_insert_in_two_turns() {
    let part = good(91, "P2 Q5 D0", 58.5, 2.0);
    assert_eq!(part["sides"], 5);
    assert!((part["corner_angle_deg"].as_f64().unwrap() - 108.0).abs() < 0.01, "{part}");
}

#[test]
fn the_solid_reaches_from_the_face_to_the_end_of_the_cut() {
    let folder = tempfile::tempdir().unwrap();
    let (_, certificate, _) = cut_in(&folder, 21, "P1 Q2 D0", 58.5, &[]);
    let stl = std::fs::read(folder.path().join("out/polygon-1.stl")).unwrap();
    // 84 bytes of head, then 50 a triangle: the normal, three corners, two bytes
    let corners = stl[84..].chunks_exact(50).flat_map(|t| t[12..48].chunks_exact(12));
    let heights = corners.map(|c| f32::from_le_bytes(c[8..12].try_into().unwrap()));
    let (low, high) =
        heights.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
    let end = certificate["features"][0]["z_from_mm"].as_f64().unwrap();
    assert!((f64::from(low) - end).abs() < 1e-5 && high.abs() < 1e-5, "{low} {high}");
    assert!((end + 3.0).abs() < 0.01, "{end}");
}

#[test]
fn a_rhombus_swings_by_a_series_of_its_own() {
    let part = good(92, "P1 Q2 D0", 58.5, 4.0);
    assert_eq!(part["sides"], 4);
    assert!((part["corner_angle_deg"].as_f64().unwrap() - 45.0).abs() < 0.1, "{part}");
}

#[test]
fn a_phase_that_is_lost_in_the_cut_takes_the_tool_away_along_x_and_the_certificate_says_so() {
    // the tool spindle's drive gives a hundredth of what is ordered: it cannot swing, and falls
    // behind
    let fault = ["--fault", "torque-loss 99% spindle 1 at 6s"];
    let (code, certificate, complaints) = cut(21, "P1 Q2 D0", 58.5, &fault);
    assert_eq!(code, 3, "{complaints}{certificate}");
    assert_eq!(certificate["alarms"][0]["number"], 205, "{certificate}");
    let part = &certificate["features"][0];
    assert_eq!(
        (part["verdict"].as_str(), part["broken_off"].as_bool()),
        (Some("fail"), Some(true))
    );
    let reason = part["reason"].as_str().unwrap();
    assert!(reason.contains("off its gear") && reason.contains("left the work by"), "{reason}");
}

#[test]
fn the_helper_prints_a_table_and_the_block() {
    let output = leadscrew(&["polygon", "--across-flats", "17", "--actuator", "phase"]);
    let text = said(&output);
    assert!(text.contains("▸ tool phase") && text.contains("G51.3 L6 A0.02"), "{text}");
    // the closed loop lets the tool fall 1.3° behind at 50 Hz: it is sent that much earlier
    assert!(text.contains(" B0.97") && text.contains("T21 M6"), "{text}");
    assert!(text.contains("flat to 0.00") && text.contains("servo error up to"), "{text}");
}

#[test]
fn the_helper_calls_the_cutter_of_the_table_that_the_form_needs_or_says_what_to_enter() {
    let block = |words: &[&str]| {
        said(&leadscrew(&[&["polygon", "--actuator", "phase", "--speed", "100"], words].concat()))
    };
    // T21 of the embedded table has three inserts, T22 two
    assert!(block(&["--across-flats", "17"]).contains("T21 M6"));
    assert!(block(&["--across-flats", "30", "--sides", "4"]).contains("T22 M6"));
    let rhombus = block(&["--across-flats", "17", "--insert-angles", "0,90"]);
    assert!(rhombus.contains("not in the tool table"), "{rhombus}");
    assert!(!rhombus.contains("T21 M6") && !rhombus.contains("T22 M6"), "{rhombus}");
    // the embedded table's T21 has another cutter
    let wrong = leadscrew(&["polygon", "--across-flats", "30", "--sides", "4", "--tool", "21"]);
    assert!(said(&wrong).contains("T21 of the embedded table is another tool"), "{}", said(&wrong));
}
