//! A tool that broke is broken until a person says that a new one is in its place: over programs,
//! over restarts, and for a tool that is in the spindle already.
use crate::workpiece::{control, until};
use control::Control;
use control::operation::{Execution, Request};
use std::path::Path;

/// A drill that slides sideways over the work, a few hundredths deep, breaks.
const BREAKS: &str =
    "G21 G90 G54 G17 G94\nT1 M6\nG43 H1\nS3000 M3\nG0 X0 Y0 Z2\nG1 Z-0.045 F300\nX5\nG0 Z20\nM2\n";
/// A second program for the broken tool.
const AGAIN: &str = "G21 G90 G54 G17 G94\nT1 M6\nG43 H1\nS1000 M3\nG0 X30 Y0 Z5\nG81 Z-2 R2 F300\nG80\nG0 Z50\nM2\n";
/// A program for whatever tool is in the spindle.
const IN_THE_SPINDLE: &str = "G21 G90 G54 G17 G94\nS1000 M3\nG0 X30 Y0 Z100\nG1 Z99 F300\nM2\n";
/// A program for another tool.
const OTHER: &str = "G21 G90 G54 G17 G94\nT2 M6\nG43 H2\nS1000 M3\nG0 X30 Y0 Z5\nG81 Z-2 R2 F300\nG80\nG0 Z50\nM2\n";

/// Loads a program and starts it, until it has ended or an alarm has stopped it.
fn run(control: &mut Control, home: &Path, text: &str) -> Result<(), String> {
    let path = home.join("part.ngc");
    std::fs::write(&path, text).unwrap();
    control.request(&Request::Load(path)).map_err(|why| format!("{why:?}"))?;
    control.request(&Request::Start).map_err(|why| format!("{why:?}"))?;
    until(control, |control| {
        control.execution() == Execution::ProgramCompleted || control.has_alarm()
    });
    Ok(())
}

fn is_broken(control: &Control) -> bool {
    control.tools().any(|tool| tool.number == 1 && tool.life.is_broken)
}

#[test]
fn a_tool_that_broke_is_refused_until_a_new_one_is_in_its_place() {
    let home = tempfile::tempdir().unwrap();
    let state = home.path().join("state");
    let mut first = control("tapping-center", &state);
    run(&mut first, home.path(), BREAKS).unwrap();
    assert!(is_broken(&first), "{:?}", first.broken_tool());
    for text in [AGAIN, IN_THE_SPINDLE] {
        let why = run(&mut first, home.path(), text).unwrap_err();
        assert!(
            why.contains("T1 is broken: it is not used before a new one is in its place"),
            "{why}"
        );
    }
    run(&mut first, home.path(), OTHER).unwrap();
    drop(first);
    // a control that is started again knows it
    let mut second = control("tapping-center", &state);
    assert!(is_broken(&second));
    let why = run(&mut second, home.path(), AGAIN).unwrap_err();
    assert!(why.contains("T1 is broken") && why.contains("tool 1 renew"), "{why}");
    second.request(&Request::RenewTool(1)).map_err(|why| why.to_string()).unwrap();
    assert!(!is_broken(&second));
    run(&mut second, home.path(), AGAIN).unwrap();
    assert!(
        second.features().iter().all(|feature| feature.verdict.is_pass()),
        "{:?}",
        second.features()
    );
}

#[test]
fn a_new_tool_in_the_place_of_a_broken_one_cuts_at_once() {
    let home = tempfile::tempdir().unwrap();
    let mut control = control("tapping-center", &home.path().join("state"));
    run(&mut control, home.path(), BREAKS).unwrap();
    control.request(&Request::RenewTool(1)).map_err(|why| why.to_string()).unwrap();
    run(&mut control, home.path(), AGAIN).unwrap();
    assert!(!is_broken(&control) && control.broken_tool().is_none());
}

#[test]
fn a_tool_that_broke_in_a_run_with_this_state_folder_is_broken_here() {
    let home = tempfile::tempdir().unwrap();
    let state = home.path().join("state");
    store::state::broken_tools::keep(&state, &[1].into()).unwrap();
    let mut control = control("tapping-center", &state);
    assert!(run(&mut control, home.path(), AGAIN).unwrap_err().contains("T1 is broken"));
    control.request(&Request::RenewTool(1)).map_err(|why| why.to_string()).unwrap();
    run(&mut control, home.path(), AGAIN).unwrap();
    assert!(store::state::broken_tools::of_all(&state).is_empty());
}
