//! What a file may state of compensation, and what is said of the rest.
use super::*;
use crate::machine::{MachineFile, parse};

fn read(axis: &str, text: &str) -> Result<MachineFile, Vec<String>> {
    let text = format!("extends = \"mill-5-axis\"\n[axes.{axis}.compensation]\n{text}\n");
    parse(&text, 0).map_err(|found| found.into_iter().map(|one| one.message).collect())
}

fn found(axis: &str, text: &str) -> Vec<String> {
    read(axis, text).err().unwrap_or_default()
}

fn stated(axis: canon::Axis, text: &str) -> StatedDeviations {
    let letter = axis.letter().to_ascii_lowercase().to_string();
    let file = read(&letter, text).unwrap_or_else(|why| panic!("{why:#?}"));
    file.axis(axis).unwrap().compensation.clone().unwrap()
}

#[test]
fn a_slide_that_is_12_um_too_far_at_100_mm_has_a_deviation_of_12_um() {
    let table = "table = [{ at_mm = -500, up_um = 0 }, { at_mm = -400, up_um = 12, down_um = 15 }]";
    let x = stated(canon::Axis::X, table);
    let curve = Deviation::new(&x.table);
    assert!((curve.at(-400.0, 1.0).value - 0.012).abs() < 1e-12);
    assert!((curve.at(-400.0, 0.0).value - 0.015).abs() < 1e-12);
    assert!((curve.encoder_position(-399.988, 1.0) + 400.0).abs() < 1e-9);
}

#[test]
fn a_rotary_axis_is_in_degrees_and_seconds_of_arc_and_repeats_each_turn() {
    let table = "table = [{ at_deg = 0, up_arcsec = 0 }, { at_deg = 180, up_arcsec = 36 }]\nbacklash_arcsec = 18";
    let c = stated(canon::Axis::C, table);
    let curve = Deviation::new(&c.table);
    let here = |at: f64| curve.at(at, 0.5).value;
    assert!((here(180.0) - 0.01).abs() < 1e-12 && (here(540.0) - 0.01).abs() < 1e-12);
    assert!((c.table.backlash - 0.005).abs() < 1e-15);
}

#[test]
fn everything_that_is_wrong_is_said_at_once_with_what_would_do() {
    let disordered = "table = [{ at_mm = 10, up_um = 0 }, { at_mm = -20, up_um = 1 }, { at_mm = -20, up_um = 2 }]\nbacklash = \"drive\"";
    let steep = "table = [{ at_mm = -20, up_um = 0 }, { at_mm = -19, up_um = 900 }]";
    let short = "table = [{ at_mm = -20, up_um = 0 }]";
    let high = "per_turn = [{ order = 2, um = 9 }]";
    let open = "table = [{ at_deg = 0, up_arcsec = 0 }, { at_deg = 360, up_arcsec = 3 }]";
    let all = [("x", disordered), ("x", steep), ("x", short), ("x", high), ("c", open)];
    let said = all.map(|(axis, text)| found(axis, text).join("\n"));
    insta::assert_snapshot!(said.join("\n\n"));
}

#[test]
fn what_would_do_does() {
    let most = |um: f64| format!("per_turn = [{{ order = 2, um = {um} }}]");
    let said = found("x", &most(9.0)).concat();
    let works = said.split("would do, ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    let works: f64 = works.parse().unwrap();
    assert_eq!(found("x", &most(works)), Vec::<String>::new(), "{said}");
    assert!(!found("x", &most(works * 1.02)).is_empty());
}

#[test]
fn points_waves_and_turning_back_take_five_percent_together() {
    let text = "per_turn = [{ order = 1, um = 3 }]\nbacklash_um = 20";
    let file = read("x", text).unwrap_or_else(|why| panic!("{why:#?}"));
    let axis = file.axis(canon::Axis::X).unwrap();
    let x = axis.compensation.as_ref().unwrap();
    let (speed, accel) = axis.reach();
    let (of_speed, of_accel) = x.share(axis);
    assert!(of_accel > 0.01, "{of_accel}");
    assert!((x.reversal.0 / speed + of_speed - COMPENSATION_SHARE).abs() < 1e-12);
    assert!((x.reversal.1 / accel + of_accel - COMPENSATION_SHARE).abs() < 1e-12);
}

#[test]
fn a_scale_sees_play_and_screw() {
    let text = |more: &str| {
        let text = format!(
            "extends = \"tapping-center-scale\"\n[axes.x.compensation]\ntable = [{{ at_mm = -500, up_um = 0 }}, {{ at_mm = 0, up_um = 5 }}]\n{more}\n"
        );
        parse(&text, 0).map_err(|found| found[0].message.clone())
    };
    assert!(text("").is_ok(), "a scale has errors of its own");
    assert!(text("backlash_um = 5").unwrap_err().contains("its scale sees play and screw already"));
    let waves = text("per_turn = [{ order = 1, um = 1 }]");
    assert!(waves.unwrap_err().starts_with("`per_turn` of X's"));
}

#[test]
fn an_encoder_of_a_spindle_is_in_seconds_of_arc() {
    let text = |arcsec: f64| {
        let text = format!(
            "extends = \"tapping-center\"\n[[spindles]]\n[spindles.encoder]\nper_turn = [{{ order = 1, arcsec = {arcsec}, phase_deg = 90 }}]\n"
        );
        parse(&text, 0).map_err(|found| found[0].message.clone())
    };
    let file = text(36.0).unwrap();
    let table = file.spindles[0].encoder_errors.as_ref().unwrap();
    assert!((table.waves[0].amplitude - 0.01 / 360.0).abs() < 1e-12);
    assert_eq!((table.waves[0].phase_rev, table.turn), (0.25, 1.0));
    assert!(text(20_000.0).unwrap_err().contains("times these values would do"));
}
