//! How hard drives work, as the machine says it and the status shows it: against what the machine's
//! file and mechanics make of it.
use crate::workpiece::control;
use control::Control;
use control::operation::{AxisStatus, Request};

/// Of the torque constant by which a drive measures, ±3 %, and of what else holds an axis up.
const OFF: f64 = 0.06;

fn homed(machine: &str) -> Control {
    let state = tempfile::tempdir().unwrap();
    control(machine, state.path())
}

fn pass(control: &mut Control, periods: usize) {
    for _ in 0..periods {
        control.period();
    }
}

fn axis(control: &Control, letter: char) -> AxisStatus {
    control.status().axes.into_iter().find(|axis| axis.letter == letter).unwrap()
}

#[test]
fn a_drive_that_holds_a_headstock_up_is_loaded_by_its_weight_and_warms_by_the_square() {
    let mut control = homed("tapping-center");
    pass(&mut control, 8000);
    // 150 kg on a screw of 16 mm a turn, 20 N·m for ever
    let held = 150.0 * 9.806_65 / (20.0 * std::f64::consts::TAU / 0.016);
    let z = axis(&control, 'Z');
    let load = z.load_percent.unwrap() / 100.0;
    assert!((load / held - 1.0).abs() < OFF, "{load} of {held}");
    let before = z.thermal_percent.unwrap();
    pass(&mut control, 4 * 60_000);
    let warm = axis(&control, 'Z').thermal_percent.unwrap() / 100.0;
    let closed = load * load + (before / 100.0 - load * load) * (-1.0_f64).exp();
    assert!((warm - closed).abs() < 0.02 * closed + 1e-3, "{warm}, and {closed}");
}

#[test]
fn a_spindle_that_runs_up_and_turns_is_loaded_by_what_its_drive_measures() {
    let mut control = homed("tapping-center");
    control.request(&Request::ManualDataInput("M3 S6000".into())).unwrap();
    let mut most = 0.0_f64;
    for _ in 0..8000 {
        control.period();
        most = most.max(control.status().spindles[0].torque_n_m.unwrap());
    }
    assert!(most > 15.0 && most < 42.0 * 1.1, "it runs up with {most} N·m");
    let spindle = control.status().spindles[0].clone();
    assert!((spindle.measured_rpm - 6000.0).abs() < 5.0, "{spindle:?}");
    // friction at 6000 rev/min, and noise of 0.21 N·m beside it, which the size takes for load
    let friction = 0.3 + 0.0012 * 6000.0 * std::f64::consts::TAU / 60.0;
    let torque = spindle.torque_n_m.unwrap();
    assert!((torque - friction).abs() < 0.25 * friction + 0.1, "{torque} of {friction}");
}

#[test]
fn a_drive_that_measures_nothing_has_no_load() {
    let control = homed("router");
    assert!(control.status().axes.iter().all(|axis| axis.load_percent.is_none()));
    assert!(control.status().axes.iter().all(|axis| axis.thermal_percent.is_none()));
}
