//! Traces: what is pushed reads back in the documented columns and units, to half a step.

use bus::{Sample, State, Truth};
use proptest::prelude::*;
use std::path::Path;
use store::trace::{Columns, GROUP_ROWS, Group, MeasuredDrives, Reader, Writer};
use test_support::size;
use units::{Angle, Coordinate, Force, Length, Spin, Time, Torque};

fn columns() -> Columns {
    Columns {
        axes: vec![(0, "x".into()), (2, "z".into())],
        spindles: vec!["spindle".into()],
        measured: MeasuredDrives { axes: vec![2], spindles: vec![0] },
    }
}

fn sample(n: u32) -> Sample {
    let n = f64::from(n);
    let mut sample = Sample::default();
    sample.feedback.time = Time::s(n * 250e-6);
    sample.feedback.axes[2].position = Coordinate::new(-0.001 * n);
    sample.feedback.axes[2].force = Some(Force::n(-812.5));
    sample.feedback.spindles[0].torque = Some(Torque::n_m(2.75));
    sample.feedback.spindles[0].angle = Angle::rev(0.025 * n);
    sample.command.axes[0].position = Coordinate::new(1.5);
    sample.command.axes[0].force = Force::n(-20.0);
    sample.command.spindles[0].angle = Angle::rev(0.025 * n + 0.001);
    sample.command.spindles[0].torque = Torque::n_m(3.25);
    sample.report.line = 17;
    sample
}

fn written(samples: &[Sample]) -> Vec<Group> {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("trace.parquet");
    let mut writer = Writer::create(&path, columns(), &[("program", "plate.ngc")]).unwrap();
    for sample in samples {
        writer.push(sample).unwrap();
    }
    writer.finish().unwrap();
    let reader = Reader::open(&path).unwrap();
    assert_eq!(reader.about("program"), Some("plate.ngc"));
    assert_eq!(reader.rows(), samples.len() as u64);
    reader.map(Result::unwrap).collect()
}

#[test]
fn the_columns_are_those_that_other_programs_rely_on() {
    let group = &written(&[sample(0)])[0];
    let names = group.numbers.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>();
    let expected = [
        "time_s",
        "x_control_setpoint_mm",
        "x_truth_mm",
        "x_encoder_mm",
        "x_drive_force_n",
        "z_control_setpoint_mm",
        "z_truth_mm",
        "z_encoder_mm",
        "z_drive_force_n",
        "spindle_control_setpoint_rev",
        "spindle_truth_rev",
        "spindle_encoder_rev",
        "spindle_rpm",
        "spindle_drive_torque_n_m",
        "z_measured_force_n",
        "spindle_measured_torque_n_m",
        "control_sync_error_um",
    ];
    assert_eq!(names, expected);
    assert_eq!(
        (group.line.as_slice(), group.state.as_slice()),
        (&[17][..], &["idle".to_owned()][..])
    );
}

#[test]
fn the_columns_of_a_machine_are_its_axes_and_spindles() {
    let text = store::machine::embedded("polygon-lathe").unwrap();
    let columns = Columns::of(&store::machine::parse(text, 0).unwrap());
    let axes = [(0, "x".to_owned()), (1, "y".to_owned()), (2, "z".to_owned())];
    assert_eq!(
        (columns.axes.as_slice(), columns.spindles),
        (&axes[..], vec!["work".into(), "tool".into()])
    );
}

#[test]
fn without_a_simulator_the_truth_is_no_number_and_drives_give_what_they_are_ordered() {
    let group = &written(&[sample(0), sample(1)])[0];
    let at = |name: &str, row: usize| group.column(name).unwrap()[row];
    assert_eq!(at("time_s", 1), 250e-6);
    assert!((at("z_encoder_mm", 1) + 0.001).abs() < 0.5e-6);
    assert!(at("z_truth_mm", 1).is_nan() && at("spindle_truth_rev", 1).is_nan());
    assert!((at("spindle_encoder_rev", 1) - 0.025).abs() < 1e-6);
    assert_eq!((at("x_control_setpoint_mm", 0), at("x_drive_force_n", 0)), (1.5, -20.0));
    assert_eq!(at("spindle_drive_torque_n_m", 0), 3.25);
    let measured = (at("z_measured_force_n", 0), at("spindle_measured_torque_n_m", 0));
    assert_eq!(measured, (-812.5, 2.75));
    // 0.025 rev in 250 µs are 100 rev/s
    assert!((at("spindle_rpm", 1) - 6000.0).abs() < 1e-3);
    assert_eq!(at("spindle_rpm", 0), 0.0);
}

#[test]
fn with_a_simulator_the_truth_is_recorded_beside_the_encoders() {
    let mut with_truth = sample(1);
    let mut truth = Truth::default();
    truth.axes[2] = Coordinate::new(-0.25);
    truth.axis_forces[2] = Force::n(1234.5);
    truth.spins[0] = Spin::rpm(6000.0);
    truth.spindle_torques[0] = Torque::n_m(-42.0);
    truth.spindles[0] = Angle::rev(0.5);
    with_truth.truth = Some(truth);
    let group = &written(&[with_truth])[0];
    let at = |name: &str| group.column(name).unwrap()[0];
    assert_eq!((at("z_truth_mm"), at("z_drive_force_n")), (-0.25, 1234.5));
    assert_eq!((at("spindle_truth_rev"), at("spindle_drive_torque_n_m")), (0.5, -42.0));
    assert!((at("spindle_rpm") - 6000.0).abs() < 1e-9);
    assert!((at("z_encoder_mm") + 0.001).abs() < 0.5e-6);
}

#[test]
fn the_sync_error_is_null_outside_the_material() {
    let mut cutting = sample(1);
    cutting.report.sync_error = Some(Length::um(-2.5));
    cutting.report.state = State::TapIn;
    let group = &written(&[sample(0), cutting, sample(2)])[0];
    let error = group.column("control_sync_error_um").unwrap();
    assert!(error[0].is_nan() && error[2].is_nan());
    assert_eq!(error[1], -2.5);
    assert_eq!(group.state, ["idle", "tap-in", "idle"]);
}

#[test]
fn rows_go_out_in_groups_so_that_memory_does_not_grow() {
    let count = u32::try_from(2 * GROUP_ROWS + 5).unwrap();
    let groups = written(&(0..count).map(sample).collect::<Vec<_>>());
    let lengths = groups.iter().map(|g| g.line.len()).collect::<Vec<_>>();
    assert_eq!(lengths, [GROUP_ROWS, GROUP_ROWS, 5]);
    let last = groups[2].column("time_s").unwrap()[4];
    assert_eq!(last, f64::from(count - 1) * 250e-6);
}

#[test]
fn an_empty_trace_is_a_trace() {
    assert_eq!(written(&[]), Vec::new());
}

#[test]
fn what_is_no_trace_is_refused_in_one_sentence() {
    let home = tempfile::tempdir().unwrap();
    let path = home.path().join("t.parquet");
    std::fs::write(&path, "G0 X0").unwrap();
    let sentence = Reader::open(&path).err().unwrap().to_string();
    assert!(sentence.starts_with("cannot read the trace "), "{sentence}");
    let sentence = Reader::open(Path::new("/nowhere.parquet")).err().unwrap().to_string();
    assert_eq!(sentence, "cannot read /nowhere.parquet: there is no such file or folder");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(64, 1280)))] // each writes and reads a file

    #[test]
    fn a_damaged_trace_is_refused_or_read_and_never_a_panic(
        at in 0_usize..10_000, byte in any::<u8>(), cut in 0_usize..2_000
    ) {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("t.parquet");
        let mut writer = Writer::create(&path, columns(), &[]).unwrap();
        (0..200).for_each(|n| writer.push(&sample(n)).unwrap());
        writer.finish().unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let at = at % bytes.len();
        bytes[at] = byte;
        if cut < 200 {
            bytes.truncate(bytes.len() - cut);
        }
        std::fs::write(&path, bytes).unwrap();
        if let Ok(reader) = Reader::open(&path) {
            let _ = reader.collect::<Vec<_>>();
        }
    }
}
