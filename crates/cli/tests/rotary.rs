//! Axes that turn, from the command line: they read in degrees wherever a person reads.
use crate::common::{complained, leadscrew, said};
use std::fs;

fn program(folder: &tempfile::TempDir, text: &str) -> String {
    let path = folder.path().join("turn.ngc");
    fs::write(&path, format!("G21 G90 G94 G54\nS1000 M3\n{text}\nM5\nM30\n")).unwrap();
    path.to_str().unwrap().to_owned()
}

fn checked(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let output = leadscrew(&["check", &program(&folder, text), "--machine", "mill-5-axis"]);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    complained(&output) + &said(&output)
}

#[test]
fn a_check_says_degrees_of_a_travel_that_is_exceeded() {
    let found = checked("G0 A150");
    let expected = "A would go to A150 of G54, 40° beyond its travel of -110 to 110°: \
                    A110 is the nearest that works";
    assert!(found.contains(expected), "{found}");
}

#[test]
fn a_target_that_no_machine_has_is_said_in_degrees() {
    let found = checked("G0 A1000000000000");
    assert!(found.contains("A would go to 1000000000000°: farther than any machine"), "{found}");
}

#[test]
fn an_axis_that_the_machine_lacks_is_one_finding_with_the_number_of_its_moves() {
    let found = checked("G0 B40\nG1 B20 F3000\nG1 X10 B25");
    let sentence = "the machine has no B axis, and the program moves it, the first of 3 such moves";
    assert_eq!(found.matches("M0305").count(), 1, "{found}");
    assert!(found.contains(sentence), "{found}");
}

#[test]
fn a_report_states_speeds_and_places_of_rotary_axes_in_degrees() {
    let folder = tempfile::tempdir().unwrap();
    let path = program(&folder, "G0 A40\nG1 X20 A10 F2000");
    let page = folder.path().join("turn.html");
    let report = format!("--report={}", page.to_str().unwrap());
    let output = leadscrew(&["run", &path, "--machine", "mill-5-axis", "-q", &report]);
    assert_eq!(output.status.code(), Some(0), "{}", complained(&output));
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.contains("A, B, C together / °/s"), "no curve of the rotary axes' speed");
}
