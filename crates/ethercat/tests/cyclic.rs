//! Cyclic data: setpoints are followed, clocks run together, inputs and outputs cross.
use crate::support::{
    Wire, enable, six_drives, six_drives_expected, two_drives, two_drives_expected,
};
use esc::{DriveState, Quirks};
use ethercat::cia402::{PdsState, Wanted};
use ethercat::{DriveCommand, DriveMode, Master, PdoEntry, Reply, Storage};

/// There and back within two seconds: a turn of the first drive, six of the last.
fn target(cycle: i32, axis: usize) -> i32 {
    let angle = f64::from(cycle) / 1000.0 * std::f64::consts::TAU * 0.5;
    ((1.0 - angle.cos()) * 131_072.0 * (axis as f64 + 1.0) / 2.0).round() as i32
}

#[test]
fn six_enabled_drives_follow_a_target_count_by_count() {
    let mut wire = Wire::new(six_drives(&Quirks::default()));
    let network = six_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    enable(&mut bus, &mut wire);
    for cycle in 0..2_000 {
        for axis in 0..6 {
            bus.command(axis, DriveCommand { wanted: Wanted::On, target: target(cycle, axis) });
        }
        bus.cycle(&mut wire);
        for axis in 0..6 {
            let drive = &bus.drives()[axis];
            assert!(!drive.is_held(), "axis {axis}, cycle {cycle}");
            // sent in cycle n, taken at the SYNC0 after it, sent back in cycle n + 1
            let expected = if cycle == 0 { 0 } else { target(cycle - 1, axis) };
            assert_eq!(drive.feedback().position, expected, "axis {axis}, cycle {cycle}");
        }
    }
    bus.cycle(&mut wire);
    for at in 1..7 {
        let device = wire.segment.device(at).unwrap();
        assert_eq!(device.drive_state(0), Some(DriveState::OperationEnabled));
        let turned = device.motor(0).unwrap().counts();
        assert_eq!(turned, i64::from(target(1_999, at - 1)));
    }
}

#[test]
fn clocks_that_differ_by_90_ppm_run_together_and_the_frame_keeps_its_phase() {
    let mut wire = Wire::new(six_drives(&Quirks::default()));
    let network = six_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let (mut worst_phase, mut worst_clock) = (0, 0);
    for cycle in 0..4_000 {
        let Reply::Complete { phase_ns, .. } = bus.cycle(&mut wire).reply else { panic!() };
        if cycle < 2_000 {
            continue;
        }
        worst_phase = worst_phase.max(phase_ns.abs());
        let now = wire.now_ns;
        let time = |at: usize| wire.segment.device(at).unwrap().system_time(now);
        let reference = time(0);
        worst_clock = (1..7).map(|at| time(at).abs_diff(reference)).fold(worst_clock, u64::max);
    }
    assert!(worst_phase < 1_000, "{worst_phase} ns");
    // a cycle at the remaining difference of rate, and the hop of a frame
    assert!(worst_clock < 1_000, "{worst_clock} ns");
}

#[test]
fn digital_inputs_and_outputs_cross() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    assert_eq!(bus.set_outputs(3, &[0xA5]), 1);
    wire.segment.device_mut(3).unwrap().set_digital_inputs(0x3C);
    for _ in 0..4 {
        bus.cycle(&mut wire);
    }
    let mut inputs = [0];
    assert_eq!((bus.inputs(3, &mut inputs), inputs), (1, [0x3C]));
    assert_eq!(wire.segment.device(3).unwrap().digital_outputs(), 0xA5);
}

#[test]
fn a_network_is_started_anew_from_op_and_drives_that_were_enabled_have_a_fault() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    for start in 0..3 {
        let mut bus = master.start(&mut wire).unwrap_or_else(|error| panic!("{error}"));
        bus.cycle(&mut wire);
        for axis in 0..2 {
            // 6007 is 1: the loss of the connection is a fault
            let is_faulty = bus.drives()[axis].feedback().state() == Some(PdsState::Fault);
            assert_eq!(is_faulty, start > 0, "start {start}");
            bus.reset_fault(axis);
        }
        bus.cycle(&mut wire);
        enable(&mut bus, &mut wire);
        for _ in 0..50 {
            assert!(matches!(bus.cycle(&mut wire).reply, Reply::Complete { .. }));
        }
    }
}

#[test]
fn a_fault_is_reported_and_reset_by_an_order_alone() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let network = two_drives_expected();
    let storage = Storage::new();
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    enable(&mut bus, &mut wire);
    wire.segment.device_mut(1).unwrap().fail(0, 0x2310);
    for _ in 0..500 {
        let outcome = bus.cycle(&mut wire);
        assert!(matches!(outcome.reply, Reply::Complete { .. }));
        bus.poll_mail(&mut wire);
    }
    let expected = ethercat::Emergency { station: 0x1001, code: 0x2310, register: 0x21 };
    assert_eq!(bus.emergencies(), (&[expected][..], 1));
    assert_eq!(bus.drives()[0].feedback().state(), Some(PdsState::Fault));
    assert!(bus.drives()[1].feedback().is_enabled());
    bus.reset_fault(0);
    bus.cycle(&mut wire);
    assert_eq!(bus.drives()[0].sent_control(), 0x0080);
    enable(&mut bus, &mut wire);
}

/// Mode, object of the target, its bits, target, and speed of the motor after a second, turns/s.
#[test]
fn speeds_and_torques_are_followed_too() {
    let torque = 0.127 / (std::f64::consts::TAU * 2e-4);
    let cases = [
        (DriveMode::Csv, 0x60FF, 32, -131_072, -1.0),
        (DriveMode::Velocity, 0x6042, 16, 600, 10.0),
        // 10 % of 1.27 N·m on 2e-4 kg·m², up to 3,000 rpm
        (DriveMode::Cst, 0x6071, 16, 100, torque.min(50.0)),
    ];
    for (mode, object, bits, target, expected) in cases {
        let mut wire = Wire::new(two_drives(&Quirks::default()));
        let mut network = two_drives_expected();
        for device in &mut network.devices[1..3] {
            device.pdos[0].entries[1] = PdoEntry::of(object, bits);
            device.slots[0].mode = mode;
            device.slots[0].most_step = 200_000;
        }
        let storage = Storage::new();
        let mut master = Master::new(&storage, &network).unwrap();
        let mut bus = master.start(&mut wire).unwrap_or_else(|error| panic!("{error}"));
        enable(&mut bus, &mut wire);
        for _ in 0..1_000 {
            for axis in 0..2 {
                bus.command(axis, DriveCommand { wanted: Wanted::On, target });
            }
            bus.cycle(&mut wire);
        }
        assert_eq!(bus.drives()[0].feedback().mode, Some(mode as i8));
        let spin = wire.segment.device(1).unwrap().motor(0).unwrap().spin.value();
        assert!((spin - expected).abs() < 0.01, "{}: {spin}, expected {expected}", mode.name());
        let velocity = bus.drives()[1].feedback().velocity.unwrap();
        assert!((f64::from(velocity) / 131_072.0 - expected).abs() < 0.02, "{velocity}");
    }
}
