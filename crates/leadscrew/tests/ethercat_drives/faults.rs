//! Terminals, drives that fail, and a network that is gone for a while.
use crate::ethercat_drives::bench::{OnWire, ask, homed, until};
use control::operation::{Execution, Request};
use std::sync::atomic::Ordering::Relaxed;
use test_support::drives::DrivesBench;

/// Position of the drive of Z on the wire.
const Z: usize = 3;

#[test]
fn outputs_and_inputs_cross_the_wire() {
    let bench = OnWire::start();
    let mut control = homed(&bench);
    // the vice closes 0.3 s after its output is on
    ask(&mut control, &Request::ManualDataInput("M64 P1\nM66 P1 L3 Q5".into()));
    until(&mut control, "the vice is closed", |control| control.execution() != Execution::Active);
    assert!(control.stopped_by().is_none(), "{:?}", control.status().alarms);
    assert_eq!(bench.shared.outputs.load(Relaxed) & 0b10, 0b10);
}

#[test]
fn a_drive_that_fails_is_an_alarm_with_its_error_code_and_power_is_asked_for_to_reset_it() {
    let bench = OnWire::start();
    let mut control = homed(&bench);
    bench.shared.fails.store(Z, Relaxed);
    until(&mut control, "the drives are off", |control| !control.status().is_ready);
    let alarms = format!("{:?}", control.status().alarms);
    assert!(alarms.contains("102") && alarms.contains("2310"), "{alarms}");
    for _ in 0..2000 {
        control.period();
        assert!(!control.status().is_ready, "it has switched itself on again");
    }
    ask(&mut control, &Request::Reset);
    ask(&mut control, &Request::Power(true));
    until(&mut control, "drives are ready", |control| control.status().is_ready);
}

#[test]
fn a_drive_without_power_stops_the_machine_and_the_network_is_started_anew() {
    let mut bench = OnWire::start();
    let mut control = homed(&bench);
    bench.shared.without_power.store(Z, Relaxed);
    until(&mut control, "the machine has stopped", |control| !control.status().is_ready);
    let alarms = format!("{:?}", control.status().alarms);
    assert!(alarms.contains("106"), "{alarms}");
    drop(control);
    bench.wait_for("the loss is said", |bench| {
        bench.said.lock().unwrap().iter().any(|text| text.contains("the network is lost"))
    });
    bench.shared.without_power.store(0, Relaxed);
    bench.wait_for("it leads again", |bench| {
        bench.said.lock().unwrap().iter().filter(|text| *text == "leads").count() == 2
    });
    bench.without_control();
    drop(homed(&bench));
}
