//! What a run says of taps that are supervised by torque.
use crate::common::{leadscrew, leadscrew_in, root, said};
use std::fs;
use store::certificate::{Certificate, Feature, Verdict};

const PLATE: &str = "programs/plate-12xM6.ngc";

/// A machine whose taps meet what these keys say.
fn machine(packing: u32, crack: u32) -> String {
    format!(
        "extends = \"tapping-center\"\n\n[tapping.supervision]\non_overload = \"retract\"\n\n[simulation.tap_mishaps]\npacking_percent = {packing}\n\
         packed_from_diameters = 1\npacked_to_diameters = 2\npacked_rise_percent = 150\n\
         crack_percent = {crack}\ncracked_strength_percent = 20\n"
    )
}

#[test]
fn a_sound_plate_is_within_the_band_and_the_next_one_from_its_first_hole_on() {
    let folder = tempfile::tempdir().unwrap();
    let learnt = folder.path().join("learnt.toml");
    let out = folder.path().join("out");
    let learnt = learnt.to_str().unwrap();
    let run =
        |more: &[&str]| said(&leadscrew(&[&["run", PLATE, "--learning", learnt], more].concat()));
    let first = run(&[]);
    assert!(first.contains("of 12 holes 7 within the band, 5 before there was one"), "{first}");
    let second = run(&["--out", out.to_str().unwrap()]);
    assert!(second.contains("of 12 holes 12 within the band"), "{second}");
    let certificate = Certificate::load(&out.join("certificate.json")).unwrap();
    let threads = certificate.features.iter().filter_map(|feature| match feature {
        Feature::Thread(thread) => Some(thread),
        _ => None,
    });
    let mut count = 0;
    for thread in threads {
        let [stroke] = &thread.supervision[..] else { panic!("{thread:?}") };
        assert_eq!((stroke.says.as_str(), stroke.torque_in_n_m.len()), ("within the band", 24));
        // 1.73 N·m by the formula, and what friction adds over the depth
        let middle = stroke.torque_in_n_m[12].value().unwrap();
        assert!((middle - 1.9).abs() < 0.35, "{middle}");
        count += 1;
    }
    assert_eq!(count, 12);
    assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("12 within the band"));
}

#[test]
fn packed_chips_and_a_break_stop_the_run_and_the_tap_is_out() {
    let folder = tempfile::tempdir().unwrap();
    let program = root().join(PLATE);
    let run = |packing, crack| {
        fs::write(folder.path().join("mill.toml"), machine(packing, crack)).unwrap();
        let tools = root().join("programs/tools.toml");
        let arguments = ["run", program.to_str().unwrap(), "--machine", "mill.toml"];
        let tools = ["--tools", tools.to_str().unwrap(), "--out", "out"];
        let text = said(&leadscrew_in(folder.path(), &[&arguments[..], &tools].concat()));
        (text, Certificate::load(&folder.path().join("out/certificate.json")).unwrap())
    };
    let (packed, certificate) = run(30, 0);
    assert!(packed.contains("chips packed in the flutes"), "{packed}");
    assert!(packed.contains("alarm 215") && packed.contains("has come out along its thread"));
    assert_eq!(certificate.verdict, Verdict::Fail);
    let stopped = certificate.features.iter().any(|feature| {
        let Feature::Thread(thread) = feature else { return false };
        thread.supervision.iter().any(|stroke| stroke.stopped.is_some())
    });
    assert!(stopped);
    let (broken, _) = run(0, 10);
    assert!(broken.contains("tap broken") && broken.contains("alarm 216"), "{broken}");
}

#[test]
fn a_drive_that_does_not_measure_its_torque_is_said_once() {
    let folder = tempfile::tempdir().unwrap();
    let silent = "extends = \"tapping-center\"\n\n[[spindles]]\nname = \"spindle\"\nmeasured_torque = { from = \"none\" }\n";
    fs::write(folder.path().join("mill.toml"), silent).unwrap();
    let machine = folder.path().join("mill.toml");
    let text = said(&leadscrew(&["run", PLATE, "--machine", machine.to_str().unwrap()]));
    let says = "supervision: not supervised: the drive of spindle does not measure its torque\n";
    assert_eq!(text.matches("supervis").count(), 2, "{text}");
    assert!(text.contains(says) && text.contains("PASS"), "{text}");
}
