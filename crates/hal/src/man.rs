//! The manual page leadscrew(9), held against what the component asks HAL for.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::fake;
use crate::ffi::Hal;
use crate::parameters::{LoadParameters, defaults};
use crate::pins::Pins;

/// The page without roff's commands: lines of text.
fn page() -> String {
    let text = include_str!("../leadscrew.9");
    let plain =
        ["\\fB", "\\fI", "\\fR"].iter().fold(text.to_owned(), |text, font| text.replace(font, ""));
    plain.replace("\\-", "-")
}

/// `leadscrew.L.pos-cmd float out`, of every pin that the page has.
fn documented() -> Vec<String> {
    let is_pin = |line: &&str| [" in", " out", " io"].iter().any(|end| line.ends_with(end));
    let page = page();
    let lines = page.lines().filter_map(|line| line.strip_prefix(".B leadscrew.")).filter(is_pin);
    let mut pins: Vec<String> = lines.map(|line| format!("leadscrew.{line}")).collect();
    pins.sort();
    pins
}

/// The same of the component, loaded with an axis, a spindle, and an input and output of each kind.
fn exported() -> Vec<String> {
    let mut axes = [false; bus::AXES];
    axes[3] = true;
    let of = LoadParameters {
        axes,
        spindles: 1,
        digital: (1, 1),
        analogue: (1, 1),
        mdi: 1,
        name: "default".into(),
    };
    let hal = Hal::begin("leadscrew").unwrap();
    let _pins = Pins::new(&hal, &of).unwrap();
    let mut pins = fake::with(|hal| hal.described());
    for pin in &mut pins {
        *pin =
            pin.replace(".a.", ".L.").replace(".spindle.0.", ".spindle.M.").replace("-00 ", "-NN ");
    }
    pins.sort();
    pins
}

#[test]
fn the_manual_page_has_every_pin_of_the_component_with_type_and_direction_and_no_other() {
    let _one = fake::one_at_a_time();
    assert_eq!(documented(), exported());
}

#[test]
fn the_manual_page_has_the_load_parameters_with_their_defaults() {
    let page = page();
    let stated: Vec<String> = page
        .lines()
        .filter_map(|line| line.strip_prefix(".BI "))
        .map(|line| line.replace("= ", "="))
        .collect();
    assert_eq!(stated, defaults());
}
