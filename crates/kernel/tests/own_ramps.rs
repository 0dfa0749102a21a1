//! A spindle on a frequency converter that is only told a speed, and brakes slower than its control
//! was told.
use crate::common::*;
use bus::State;
use kernel::{Config, Learning, OwnRamps, Prediction, SyncMode};
use plan::StepKind;
use units::{Angle, SpinAccel, Time};

const STATED: SpinAccel = SpinAccel::rev_per_s2(67.0);

/// The drive, its control, and a drive that is exact but for its deceleration.
fn mill(share: f64) -> (sim::Config, Config, sim::PlainDrive) {
    let mut machine = machine(1);
    machine.spindles[0].encoder.counts_per_rev = 4096;
    let mut control = control(&machine);
    control.synchronisation =
        SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 1 };
    control.learning = Some(Learning { gain: 0.7, bandwidth_hz: 70.0 });
    let spindle = control.spindles[0].as_mut().expect("one");
    spindle.encoder_count = Angle::rev(1.0 / 4096.0);
    let delay = Time::s(0.01);
    spindle.own_ramps = Some(OwnRamps {
        delay,
        accel: STATED,
        decel: STATED,
        uncertainty: 0.25,
        repeats: (Time::s(0.7e-3), 0.002),
        creep: 0.1,
    });
    let drive = sim::PlainDrive {
        delay,
        delay_scatter: Time::ZERO,
        accel: STATED,
        decel: STATED * share,
        ramp_scatter: 0.0,
        speed_scatter: 0.0,
        orients: None,
    };
    (machine, control, drive)
}

/// Depths beyond the programmed bottom, µm, of so many M8 holes, one after the other.
fn overruns(rpm: f64, share: f64, holes: usize) -> Vec<f64> {
    let (machine, control, drive) = mill(share);
    let order = TapOrder { lead_mm: 1.25, rpm, to_mm: -125.0, ..M6 };
    let mut steps = tapping(&order);
    for _ in 1..holes {
        steps.insert(2, StepKind::Tap(order.plan()));
    }
    let machine = sim::SimulatedMachine::new(machine).expect("it can be built");
    let seen = run_on(&mut machine.with_plain_drive(drive), &control, &steps, 200_000);
    assert_eq!(seen.kernel.faults(), []);
    assert!(seen.kernel.is_over(), "the program did not come to its end");
    let deepest = |op: u32| {
        let of = seen.samples.iter().filter(|s| s.report.op == op);
        let inside = of.filter(|s| matches!(s.report.state, State::TapIn | State::TapOut));
        inside.map(|s| s.axis(2).value()).fold(f64::MAX, f64::min)
    };
    let first = seen.samples.iter().find(|s| s.report.state == State::TapIn).expect("one");
    let first = first.report.op;
    (0..holes as u32).map(|hole| (order.to_mm - deepest(first + hole)) * 1e3).collect()
}

#[test]
fn every_hole_meets_its_depth_from_the_first_one_on_although_the_drive_brakes_15_percent_slower() {
    for rpm in [500.0, 1000.0, 2000.0, 3000.0] {
        let seen = overruns(rpm, 0.85, 3);
        assert!(seen.iter().all(|um| um.abs() <= 50.0), "{rpm} rpm: {seen:.1?} µm");
    }
}

#[test]
fn a_drive_that_brakes_faster_than_stated_is_learnt_too() {
    let seen = overruns(2000.0, 1.2, 3);
    assert!(seen.iter().all(|um| um.abs() <= 50.0), "{seen:.1?} µm");
}

#[test]
fn what_the_feed_follows_is_the_spindle_on_whatever_ramp() {
    let (machine, control, drive) = mill(0.85);
    let order = TapOrder { lead_mm: 1.25, rpm: 2000.0, to_mm: -125.0, ..M6 };
    let machine = sim::SimulatedMachine::new(machine).expect("it can be built");
    let machine = &mut machine.with_plain_drive(drive);
    let seen = run_on(machine, &control, &tapping(&order), 200_000);
    let first = seen.samples.iter().find(|s| s.report.state == State::TapIn).expect("one");
    let theta0 = first.spindle(0).value();
    for s in seen.synchronised().filter(|s| s.axis(2).value() <= order.surface_mm) {
        let off = s.axis(2).value() - order.from_mm + 1.25 * (s.spindle(0).value() - theta0);
        assert!(off.abs() < 10e-3, "{off} mm at {}", s.feedback.time);
    }
}
