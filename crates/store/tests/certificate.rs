//! The certificate's keys are a promise to other programs: this is their list.
use proptest::prelude::*;
use serde_json::{Value, json};
use store::certificate::{
    Alarm, Cam, Certificate, Clamping, Common, Contact, Count, Feature, Hand, Hole, Inputs,
    Measured, Polygon, Thread, Tolerances, Verdict, sha256,
};
use units::{Angle, Force, Lead, Length, Spin, Time, Torque};

fn common(line: u32) -> Common {
    Common {
        line,
        verdict: Verdict::Pass,
        reason: None,
        time_s: Measured::s(Time::s(1.25)),
        contact: Contact { cut: true, reach_mm: Measured::number(12.5), ..Contact::default() },
    }
}

fn thread() -> Thread {
    Thread {
        common: Common {
            verdict: Verdict::Fail,
            reason: Some("the tap broke".into()),
            ..common(12)
        },
        x_mm: Some(Measured::mm(Length::mm(10.0))),
        y_mm: Some(Measured::mm(Length::mm(20.0))),
        z_mm: None,
        size: "M6x1".into(),
        hand: Hand::Left,
        lead_mm: Measured::lead(Lead::mm_per_rev(-1.0)),
        depth_mm: Measured::mm(Length::mm(12.0)),
        depth_error_um: Measured::um(Length::um(-3.0)),
        rpm_max: Measured::rpm(Spin::rpm(6000.0)),
        sync_error_max_um: Measured::um(Length::um(4.2)),
        sync_error_rms_um: Measured::number(f64::NAN),
        lead_error_um: Measured::um(Length::um(1.0)),
        groove_widening_um: Measured::um(Length::um(5.0)),
        pitch_diameter_mm: Measured::mm(Length::mm(5.4)),
        class: "6H".into(),
        margin_um: Measured::UNKNOWN,
        torque_max_n_m: Measured::n_m(Torque::n_m(1.73)),
        torque_in_n_m: Measured::n_m(Torque::n_m(1.73)),
        torque_out_n_m: Measured::n_m(Torque::n_m(0.34)),
        torque_model_n_m: Measured::n_m(Torque::n_m(1.73)),
        torque_model_band_percent: Measured::number(25.0),
        torque_expected: Some(true),
        axial_force_max_n: Measured::n(Force::n(120.0)),
        start_angle_deg: Measured::deg(Angle::rev(0.25)),
        chip_removal: false,
        recovered: false,
        supervision: Vec::new(),
    }
}

fn certificate() -> Certificate {
    let hole = Hole {
        common: common(7),
        x_mm: Measured::number(0.1 + 0.2),
        y_mm: Measured::number(-0.0),
        depth_mm: Measured::number(15.0),
        diameter_mm: Measured::number(5.0),
        chip_removal: true,
    };
    let polygon = Polygon {
        common: common(20),
        sides: 6,
        across_flats_mm: Measured::number(17.0),
        flatness_um: Measured::number(2.0),
        tilt_deg: Measured::number(0.01),
        corner_angle_deg: Measured::number(120.0),
        z_from_mm: Measured::number(0.0),
        z_to_mm: Measured::number(-10.0),
        rpm: Measured::number(2000.0),
        across_flats_error_um: Measured::number(1.5),
        facet_difference_um: Measured::number(0.2),
        lay_um: Measured::number(1.6),
        taper_um_per_mm: Measured::number(0.1),
        taper_error_um_per_mm: Measured::number(0.1),
        twist_deg_per_mm: Measured::number(0.0),
        twist_error_deg_per_mm: Measured::number(0.0),
        broken_off: false,
    };
    let cam = Cam {
        common: common(30),
        profile: "harmonic".into(),
        rpm: Measured::number(60.0),
        phase_error_deg: Measured::number(-0.4),
        contour_error_max_um: Measured::number(3.0),
        contour_error_rms_um: Measured::number(1.0),
        revolutions: Measured::number(5.0),
        run_out_um: Measured::UNKNOWN,
        speed_error_um_per_deg: Measured::number(0.2),
        waviness_um: Measured::number(0.1),
        waves_per_rev: Measured::number(60.0),
        removal_rate_peak: Measured::number(1.7),
        removal_rate_peak_even: Measured::number(1.7),
    };
    Certificate {
        leadscrew: "0.1.0".into(),
        program: "plate.ngc".into(),
        machine: "tapping-center".into(),
        seed: 1,
        part: None,
        cycle_time_s: Measured::number(61.5),
        ended: true,
        verdict: Verdict::Fail,
        count: Count { passed: 3, failed: 1, not_judged: 0 },
        material: "C45".into(),
        tolerances: Tolerances { thread_class: "6H".into(), ..Tolerances::default() },
        frame: Some(Clamping {
            zero_mm: [-150.0, -60.0, -400.0].map(Measured::number),
            stock_mm: [[-50.0, -50.0, -30.0], [50.0, 50.0, 0.0]].map(|c| c.map(Measured::number)),
        }),
        inputs: Inputs { program_sha256: sha256(b"abc"), ..Inputs::default() },
        alarms: vec![Alarm {
            number: 301,
            text: "the drive was at its limit".into(),
            line: Some(12),
            time_s: Measured::number(3.0),
        }],
        invariants: store::certificate::Invariants::default(),
        withdrawals: Vec::new(),
        features: vec![
            Feature::Hole(hole),
            Feature::Thread(Box::new(thread())),
            Feature::Polygon(polygon),
            Feature::Cam(cam),
        ],
    }
}

fn keys(value: &Value) -> Vec<&str> {
    let mut keys =
        value.as_object().into_iter().flatten().map(|(k, _)| k.as_str()).collect::<Vec<_>>();
    keys.sort_unstable();
    keys
}

fn sorted(list: &'static str) -> Vec<&'static str> {
    let mut keys = list.split_whitespace().collect::<Vec<_>>();
    keys.sort_unstable();
    keys
}

#[test]
fn every_promised_key_is_there_and_no_other() {
    let value: Value = serde_json::from_str(&certificate().to_json()).unwrap();
    assert_eq!(
        keys(&value),
        sorted(
            "leadscrew program machine seed cycle_time_s ended verdict count material tolerances frame inputs
             alarms features invariants withdrawals"
        )
    );
    assert_eq!(keys(&value["alarms"][0]), sorted("number text line time_s"));
    let features = [
        "kind line verdict reason time_s contact x_mm y_mm depth_mm diameter_mm chip_removal",
        "kind line verdict reason time_s contact x_mm y_mm size hand lead_mm depth_mm depth_error_um rpm_max
         sync_error_max_um sync_error_rms_um lead_error_um groove_widening_um pitch_diameter_mm class
         margin_um torque_max_n_m torque_in_n_m torque_out_n_m torque_model_n_m \
         torque_model_band_percent torque_expected axial_force_max_n start_angle_deg chip_removal recovered",
        "kind line verdict reason time_s contact sides across_flats_mm flatness_um tilt_deg corner_angle_deg
         z_from_mm z_to_mm rpm across_flats_error_um facet_difference_um lay_um taper_um_per_mm taper_error_um_per_mm \
         twist_deg_per_mm twist_error_deg_per_mm broken_off",
        "kind line verdict reason time_s contact profile rpm phase_error_deg contour_error_max_um
         contour_error_rms_um revolutions run_out_um speed_error_um_per_deg waviness_um waves_per_rev \
         removal_rate_peak removal_rate_peak_even",
    ];
    for (feature, expected) in value["features"].as_array().unwrap().iter().zip(features) {
        assert_eq!(keys(feature), sorted(expected));
    }
}

#[test]
fn the_head_says_what_the_run_was_made_from_and_each_feature_whether_it_was_cut() {
    let value: Value = serde_json::from_str(&certificate().to_json()).unwrap();
    // FIPS 180-2, appendix B.1
    let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(value["inputs"]["program_sha256"], abc);
    assert_eq!(keys(&value["frame"]), sorted("zero_mm stock_mm"));
    assert_eq!(keys(&value["inputs"]), sorted("program_sha256 machine_sha256 tools_sha256"));
    assert_eq!((&value["verdict"], &value["count"]["failed"]), (&json!("fail"), &json!(1)));
    let contact = &value["features"][0]["contact"];
    assert_eq!((&contact["cut"], &contact["reach_mm"]), (&json!(true), &json!(12.5)));
    assert_eq!(serde_json::to_value(Verdict::NotJudged).unwrap(), json!("not judged"));
}

#[test]
fn values_have_the_units_of_their_keys_and_every_number_is_finite() {
    let value: Value = serde_json::from_str(&certificate().to_json()).unwrap();
    let hole = &value["features"][0];
    assert_eq!((&hole["kind"], &hole["verdict"]), (&json!("hole"), &json!("pass")));
    assert_eq!((&hole["x_mm"], &hole["y_mm"]), (&json!(0.3), &json!(0.0)));
    let thread = &value["features"][1];
    assert_eq!((&thread["verdict"], &thread["reason"]), (&json!("fail"), &json!("the tap broke")));
    assert_eq!((&thread["hand"], &thread["lead_mm"]), (&json!("left"), &json!(1.0)));
    assert_eq!((&thread["rpm_max"], &thread["start_angle_deg"]), (&json!(6000.0), &json!(90.0)));
    assert_eq!((&thread["sync_error_rms_um"], &thread["margin_um"]), (&json!(null), &json!(null)));
}

#[test]
fn a_thread_on_a_lathe_starts_at_a_z() {
    let on_lathe = Thread { x_mm: None, y_mm: None, z_mm: Some(Measured::number(2.0)), ..thread() };
    let value = serde_json::to_value(Feature::Thread(Box::new(on_lathe))).unwrap();
    assert_eq!((value.get("x_mm"), &value["z_mm"]), (None, &json!(2.0)));
}

#[test]
fn a_certificate_reads_back_as_it_was_written() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("certificate.json");
    certificate().save(&path).unwrap();
    let read = Certificate::load(&path).unwrap();
    assert_eq!(read.to_json(), certificate().to_json());
    assert_eq!(read.features[1].common().reason.as_deref(), Some("the tap broke"));
}

#[test]
fn keys_of_later_versions_are_passed_over() {
    let later = certificate().to_json().replacen('{', "{\"operator\": \"anna\",", 1);
    assert_eq!(Certificate::parse(&later).unwrap().program, "plate.ngc");
}

#[test]
fn what_is_no_certificate_is_refused_with_the_place() {
    let finding = Certificate::parse("{\n\"leadscrew\": 1\n}").unwrap_err();
    assert_eq!((finding.code, finding.span.line), ("S0701", 2));
    assert_eq!(finding.message, "not a certificate: invalid type: integer `1`, expected a string");
    for text in ["", "[", "{\"a\": \"\\u12", "nul"] {
        assert_eq!(Certificate::parse(text).unwrap_err().code, "S0701");
    }
}

proptest! {
    #[test]
    fn no_change_to_a_good_certificate_makes_the_reader_panic(
        at in 0_usize..4000, length in 0_usize..40, new in "[\\[\\]{}:\",\\\\ a-z0-9.é-]{0,8}"
    ) {
        let text = certificate().to_json();
        let end = at.saturating_add(length).min(text.len());
        if let (Some(head), Some(tail)) = (text.get(..at), text.get(end..)) {
            let changed = format!("{head}{new}{tail}");
            if let Err(finding) = Certificate::parse(&changed) {
                prop_assert!(finding.span.start <= finding.span.end);
                let place = finding.span.start as usize..finding.span.end as usize;
                prop_assert!(changed.get(place).is_some());
            }
        }
    }
}
