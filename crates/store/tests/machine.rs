//! Machine files: the embedded ones hold what their comments say, and a bad one is refused with
//! everything that is wrong with it.

use proptest::prelude::*;
use store::machine::{self, Motor, PositionFrom, Ramp};
use units::{Coordinate, CoordinateAccel, Force, Spin, Time};

fn tapping_center() -> machine::MachineFile {
    machine::parse(machine::embedded("tapping-center").unwrap(), 0).unwrap()
}

/// The tapping centre's file with one line changed; every finding as `line code sentence`.
fn refused(from: &str, to: &str) -> String {
    let text = machine::embedded("tapping-center").unwrap();
    assert!(text.contains(from), "{from}");
    findings(&text.replacen(from, to, 1))
}

fn findings(text: &str) -> String {
    let found = machine::parse(text, 0).unwrap_err();
    let line = |d: &diag::Diagnostic| {
        let place = text.get(d.span.start as usize..d.span.end as usize).unwrap();
        format!("{} {} {} [{place}]", d.span.line, d.code, d.message)
    };
    found.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_embedded_machine_is_valid() {
    for name in machine::EMBEDDED {
        let file = machine::parse(machine::embedded(name).unwrap(), 0).unwrap();
        assert_eq!(file.name, name);
    }
    assert_eq!(machine::embedded("milling-robot"), None);
}

#[test]
fn the_tapping_centers_z_axis_weighs_a_ton_at_the_screw_and_has_the_force_for_15_m_per_s2() {
    let file = tapping_center();
    let z = file.axis(canon::Axis::Z).unwrap();
    // (2π / 0.016 m)² × 0.0070 kg·m²; 60 N·m × 2π / 0.016 m
    assert!((z.drive.motor_mass().value() - 1079.5).abs() < 0.1, "{}", z.drive.motor_mass());
    assert!((z.drive.peak_force().value() - 23_562.0).abs() < 1.0, "{}", z.drive.peak_force());
    assert_eq!(z.acceleration, CoordinateAccel::new(15_000.0));
    assert_eq!(z.friction.static_force, Force::n(190.0));
    assert!(matches!(z.drive.motor, Motor::BallScrew { .. }));
    let PositionFrom::Motor { resolution, counts_per_rev: 1_048_576 } = z.position_from else {
        panic!("a motor encoder")
    };
    assert!((resolution.of_linear().in_um() - 16_000.0 / 1_048_576.0).abs() < 1e-12);
}

#[test]
fn the_tapping_centers_spindle_bends_its_torque_curve_at_3410_rpm() {
    let file = tapping_center();
    let spindle = &file.spindles[0];
    assert!((spindle.base_speed().in_rpm() - 3410.0).abs() < 1.0);
    assert!((spindle.tapping_max.in_rpm() - 6000.0).abs() < 1e-9);
    assert!((spindle.max - Spin::rpm(10_000.0)).abs() < Spin::rpm(1e-9));
    assert_eq!(file.control.period, Time::s(250.0 * 1e-6));
    assert_eq!(file.tapping.ramp, Ramp::PowerCurve);
}

#[test]
fn a_tool_of_150_mm_fits_between_the_work_and_the_top_of_the_travel() {
    let file = tapping_center();
    let z = file.axis(canon::Axis::Z).unwrap();
    let tip_at_work = file.setup.g54.along(canon::Axis::Z) + Coordinate::new(150.0);
    assert!(tip_at_work + Coordinate::new(100.0) <= z.travel.to);
    assert!(file.setup.g54.along(canon::Axis::Z) - Coordinate::new(50.0) >= z.travel.from);
}

#[test]
fn a_misspelt_key_is_named_with_its_neighbour_and_missed_under_its_right_name() {
    insta::assert_snapshot!(refused("inertia_kg_m2 = 0.010", "inertai_kg_m2 = 0.010"));
}

#[test]
fn all_mistakes_are_told_at_once_in_the_order_of_the_text() {
    let text = machine::embedded("tapping-center")
        .unwrap()
        .replace("period_us = 250 ", "period_us = nan ")
        .replace("peak_power_w = 15_000", "peak_power_w = inf")
        .replace("damping_ratio = 0.04", "damping_ratio = \"low\"")
        .replace("prediction = \"observer\"", "prediction = true")
        .replace("brake = true", "brake = 1")
        .replace("dialect = \"linuxcnc\"", "dialect = \"linux\"")
        .replace("seed = 1", "seed = -1")
        .replace("tapping_max_rpm = 6000", "tapping_max_rpm = 12_000");
    insta::assert_snapshot!(findings(&text));
}

#[test]
fn a_missing_section_is_one_finding() {
    let text = machine::embedded("tapping-center").unwrap().replace("[axes.z.friction]", "[other]");
    insta::assert_snapshot!(findings(&text));
}

#[test]
fn values_that_contradict_each_other_are_refused() {
    let both = [
        refused("travel_from_mm = -400", "travel_from_mm = 400"),
        refused("substep_us = 25 ", "substep_us = 300"),
        refused("following_error_stop_um = 2000", "following_error_stop_um = 20"),
        refused("motor_counts_per_rev = 1_048_576 ", "# "),
        refused("ramp = \"power-curve\"", "ramp = \"linear\""),
        refused("sync_stop_um = 300", "sync_stop_um = 3"),
        refused("z_mm = -300", "z_mm = -500"),
        refused("static_n = 190", "static_n = 90"),
        refused("z_from_mm = -40", "z_from_mm = 40"),
        refused("name = \"spindle\"", "name = \"S 1\""),
    ];
    insta::assert_snapshot!(both.join("\n"));
}

#[test]
fn a_file_that_is_not_toml_is_refused_with_the_place() {
    insta::assert_snapshot!(findings("name = \n[control\nperiod_us 250\n"));
}

#[test]
fn an_empty_file_lacks_every_section() {
    insta::assert_snapshot!(findings(""));
}

#[test]
fn a_machine_is_found_by_name_or_by_file() {
    assert_eq!(machine::find("tapping-center").unwrap(), tapping_center());
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    std::fs::write(&path, machine::embedded("cam-grinder").unwrap()).unwrap();
    assert_eq!(machine::find(path.to_str().unwrap()).unwrap().name, "cam-grinder");
    let sentence = |name| machine::find(name).unwrap_err().to_string();
    assert_eq!(
        sentence("tapping-centre"),
        "there is no machine `tapping-centre` and no file of that name: did you mean `tapping-center`?"
    );
    assert_eq!(
        sentence("robot"),
        "there is no machine `robot` and no file of that name: \
         expected a file or one of tapping-center, polygon-lathe, lathe, cam-grinder, cam-grinder-coarse, \
         tapping-center-scale, tapping-center-shop, vfd-mill, gear-hobber, bench-xyz, bench-xyz-jerk20, mill-5-axis, \
         machining-center, router, turning-center, portal-mill, lathe-chuck-zero, umbrella-mill"
    );
    assert_eq!(sentence("no.toml"), "cannot read no.toml: there is no such file or folder");
}

#[test]
fn materials_are_known_by_name() {
    let kc = |name| machine::StockMaterial::named(name).map(|m| m.cutting_force_n_per_mm2);
    assert_eq!([kc("C45"), kc("alsi"), kc("cheese")], [Some(3900.0), Some(1300.0), None]);
}

#[test]
fn loading_a_bad_file_names_it_and_the_first_finding() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("mine.toml");
    std::fs::write(&path, "name = 1\ncolour = 2\n").unwrap();
    let sentence = machine::load(&path).unwrap_err().to_string();
    let sentence = sentence.replace(&*dir.path().to_string_lossy(), "…");
    insta::assert_snapshot!(sentence);
}

proptest! {
    #[test]
    fn no_bytes_make_the_reader_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let text = String::from_utf8_lossy(&bytes);
        for finding in machine::parse(&text, 0).err().into_iter().flatten() {
            let place = finding.span.start as usize..finding.span.end as usize;
            prop_assert!(text.get(place).is_some(), "{:?}", finding);
        }
    }

    #[test]
    fn no_change_to_a_good_file_makes_the_reader_panic(
        at in 0_usize..9000,
        length in 0_usize..80,
        new in "[\\[\\]{}=\"',.#\n a-z0-9_-]{0,12}",
    ) {
        let text = machine::embedded("tapping-center").unwrap();
        let end = at.saturating_add(length).min(text.len());
        if let (Some(head), Some(tail)) = (text.get(..at), text.get(end..)) {
            let _ = machine::parse(&format!("{head}{new}{tail}"), 0);
        }
    }
}

/// Each built-in machine, those too that extend another one, can be extended by a file that states
/// nothing but its name.
#[test]
fn a_file_that_extends_a_machine_and_states_a_name_alone_is_that_machine() {
    for name in machine::EMBEDDED {
        let text = format!("extends = \"{name}\"\nname = \"mine\"\n");
        let mine = machine::parse(&text, 0).unwrap_or_else(|found| panic!("{name}: {found:?}"));
        let base = machine::find(name).unwrap();
        assert_eq!(mine.name, "mine");
        let named = machine::MachineFile { name: base.name.clone(), ..mine };
        assert_eq!(named, base, "{name}");
    }
}

/// The bench has no limit of jerk; a file that extends it and says nothing of jerk has none either.
#[test]
fn what_is_unlimited_stays_so_in_a_file_that_extends_it() {
    let base = machine::parse(machine::embedded("bench-xyz").unwrap(), 0).unwrap();
    let text = "extends = \"bench-xyz\"\nname = \"quicker\"\n[axes.x]\nacceleration_m_per_s2 = 2\n";
    let file = machine::parse(text, 0).unwrap();
    let (x, before) = (file.axis(canon::Axis::X).unwrap(), base.axis(canon::Axis::X).unwrap());
    assert_eq!(x.acceleration, before.acceleration * 2.0);
    assert_eq!((x.jerk_feed, x.jerk_rapid), (before.jerk_feed, before.jerk_rapid));
    assert!(x.jerk_feed.value().is_infinite());
}
