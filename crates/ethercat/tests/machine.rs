//! A machine on the network: places, speeds, switches, terminals and power, in its own units.
use crate::support::{Wire, two_drives};
use bus::{Command, Feedback};
use esc::{DriveState, Quirks};
use ethercat::{
    Ahead, AxisInputs, AxisSlot, Bus, CountScale, Device, DriveMode, LedDrive, MachineDrives,
    Master, Network, Storage, Terminal,
};
use units::{Coordinate, CoordinateSpeed, Force, Spin, Time, Torque};

/// Positions of the drives and of the terminal on the wire.
const AXIS: usize = 1;
const SPINDLE: usize = 2;
const TERMINAL: usize = 3;
const AT_ONCE: Ahead = Ahead { axes: [Time::ZERO; 9], spindles: [Time::ZERO; 2] };

/// An axis Y on a screw of 10 mm behind a gear, mounted the other way round.
const SCREW: CountScale =
    CountScale { counts_per_rev: 131_072, gear: (3, 2), is_reversed: true, per_rev: 10.0 };
const SHAFT: CountScale =
    CountScale { counts_per_rev: 131_072, gear: (1, 1), is_reversed: false, per_rev: 1.0 };

fn expected(spindle: DriveMode) -> Network {
    let slot = |mode, most_step| AxisSlot { number: 0, mode, most_step, says_torque: true };
    let mut network = Network::new(vec![
        Device::plain("coupler"),
        Device::drive("Y", &[slot(DriveMode::Csp, 6_000)]),
        Device::drive("S", &[slot(spindle, u32::MAX)]),
        Device::plain("I/O"),
    ]);
    network.clock_frames = 200;
    network
}

fn axis_y() -> LedDrive {
    LedDrive {
        index: 1,
        drive: 0,
        mode: DriveMode::Csp,
        scale: SCREW,
        inputs: AxisInputs { home: Some(2), limits: [Some(0), Some(1)] },
        torque_rated: Some(Torque::n_m(1.27)),
    }
}

fn machine(spindle: DriveMode, terminal: Terminal) -> MachineDrives {
    let inputs = AxisInputs::default();
    let turning = LedDrive { index: 0, drive: 1, mode: spindle, scale: SHAFT, inputs, ..axis_y() };
    MachineDrives::new(&[axis_y()], &[turning], &[terminal])
}

const SIGNALS: Terminal =
    Terminal::Digital { device: TERMINAL, inputs_from: Some(4), outputs_from: Some(8) };

/// Runs a machine for cycles, each with a command made from its number and the last feedback;
/// returns the last feedback.
fn run<F: FnMut(u64) -> crate::support::Fate>(
    (drives, bus, wire): (&mut MachineDrives, &mut Bus<'_, '_>, &mut Wire<F>),
    cycles: u32,
    mut command: impl FnMut(u32, &Feedback) -> Command,
) -> Feedback {
    let mut feedback = Feedback::default();
    for number in 0..cycles {
        let cycle = bus.cycle(wire);
        feedback = drives.read(bus, &cycle);
        drives.write(bus, &command(number, &feedback), &AT_ONCE);
    }
    feedback
}

fn held(feedback: &Feedback) -> Command {
    let mut command = Command::default();
    command.axes[1].enable = true;
    command.axes[1].position = feedback.axes[1].position;
    command.spindles[0].enable = true;
    command
}

#[test]
fn an_axis_goes_where_it_is_told_through_gear_and_direction_and_a_spindle_turns() {
    for (mode, rpm) in [(DriveMode::Csv, 600.0), (DriveMode::Velocity, -900.0)] {
        let mut wire = Wire::new(two_drives(&Quirks::default()));
        let (network, storage) = (expected(mode), Storage::new());
        let mut master = Master::new(&storage, &network).unwrap();
        let mut bus = master.start(&mut wire).unwrap_or_else(|error| panic!("{error}"));
        let mut drives = machine(mode, SIGNALS);
        let enabled = run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
        assert!(enabled.axes[1].ready && enabled.spindles[0].ready);
        let said = run((&mut drives, &mut bus, &mut wire), 1_500, |number, said| {
            let mut command = held(said);
            command.axes[1].position = Coordinate::new(-0.1 * f64::from(number.min(500)));
            command.spindles[0].spin = Spin::rpm(rpm);
            command
        });
        assert_eq!(SCREW.counts(said.axes[1].position.value()), SCREW.counts(-50.0));
        // five turns of the screw are seven and a half of the motor, the other way round
        let motor = |at: usize| wire.segment.device(at).unwrap().motor(0).unwrap();
        assert!((motor(AXIS).angle.value() - 7.5).abs() < 1e-5, "{}", motor(AXIS).angle);
        assert!((motor(SPINDLE).spin.in_rpm() - rpm).abs() < 1.0, "{}", motor(SPINDLE).spin);
        let turned = said.spindles[0].angle.value();
        assert!((turned - motor(SPINDLE).angle.value()).abs() < 0.05, "{turned}");
    }
}

#[test]
fn what_drives_measure_is_the_force_of_the_axis_whatever_gear_and_direction() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let (network, storage) = (expected(DriveMode::Csv), Storage::new());
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut drives = machine(DriveMode::Csv, SIGNALS);
    run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
    // 4 m/s² are 600 rev/s² of a motor of 2·10⁻⁴ kg·m²
    let said = run((&mut drives, &mut bus, &mut wire), 40, |number, said| {
        let mut command = held(said);
        let t = f64::from(number) * 1e-3;
        command.axes[1].position = Coordinate::new(2000.0 * t * t);
        command
    });
    let work_of_a_turn = std::f64::consts::TAU * 2e-4 * 600.0 * std::f64::consts::TAU;
    let expected = work_of_a_turn * 150.0; // turns of the motor by metre
    let force = said.axes[1].force.unwrap();
    assert!((force.value() - expected).abs() < 0.04 * expected, "{force} of {expected} N");
    assert!(said.spindles[0].torque.unwrap().abs() < Torque::n_m(0.02));
    let mut silent =
        MachineDrives::new(&[LedDrive { torque_rated: None, ..axis_y() }], &[], &[SIGNALS]);
    let said = run((&mut silent, &mut bus, &mut wire), 2, |_, said| held(said));
    assert_eq!(said.axes[1].force, None::<Force>);
}

#[test]
fn a_setpoint_is_sent_for_the_place_where_the_axis_is_when_its_drive_obeys() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let (network, storage) = (expected(DriveMode::Csv), Storage::new());
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut drives = machine(DriveMode::Csv, SIGNALS);
    let mut command = Command::default();
    command.axes[1].position = Coordinate::new(1.0);
    command.axes[1].speed = CoordinateSpeed::new(50.0);
    command.axes[1].enable = true;
    run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
    let ahead = Ahead { axes: [Time::s(3e-3); 9], ..AT_ONCE };
    for step in 0..100 {
        command.axes[1].position = Coordinate::new(0.05 * f64::from(step));
        let cycle = bus.cycle(&mut wire);
        drives.read(&bus, &cycle);
        drives.write(&mut bus, &command, &ahead);
    }
    bus.cycle(&mut wire);
    let sent = SCREW.value(i64::from(bus.drives()[0].sent_target()));
    assert!((sent - (0.05 * 99.0 + 50.0 * 3e-3)).abs() < 1e-4, "{sent} mm");
}

#[test]
fn switches_signals_and_a_tool_changer_are_bits_of_their_devices() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let (network, storage) = (expected(DriveMode::Csv), Storage::new());
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    wire.segment.device_mut(AXIS).unwrap().set_axis_inputs(0, 0b101);
    wire.segment.device_mut(TERMINAL).unwrap().set_digital_inputs(0b11);
    let mut drives = machine(DriveMode::Csv, SIGNALS);
    let mut command = Command { tool: 7, ..Command::default() };
    command.outputs.switch(9, true);
    let said = run((&mut drives, &mut bus, &mut wire), 5, |_, _| command);
    assert!(said.axes[1].home_switch && said.axes[1].limit_switches == [true, false]);
    assert_eq!((said.inputs.digital, said.tool), (0b11_0000, Some(0)));
    assert_eq!(wire.segment.device(TERMINAL).unwrap().digital_outputs(), 0b10);

    // the same terminal as a tool changer
    let mut drives = machine(DriveMode::Csv, Terminal::ToolChanger { device: TERMINAL });
    for (asked, output) in [(7, 7), (0, 255), (300, 0)] {
        command.tool = asked;
        run((&mut drives, &mut bus, &mut wire), 5, |_, _| command);
        assert_eq!(wire.segment.device(TERMINAL).unwrap().digital_outputs(), output, "{asked}");
    }
    for (input, tool) in [(0, None), (255, Some(0)), (12, Some(12))] {
        wire.segment.device_mut(TERMINAL).unwrap().set_digital_inputs(input);
        let said = run((&mut drives, &mut bus, &mut wire), 5, |_, _| command);
        assert_eq!(said.tool, tool, "{input}");
    }
}

#[test]
fn a_drive_that_fails_is_off_until_power_is_asked_for_anew() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let (network, storage) = (expected(DriveMode::Csv), Storage::new());
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut drives = machine(DriveMode::Csv, SIGNALS);
    run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
    wire.segment.device_mut(AXIS).unwrap().fail(0, 0x2310);
    let said = run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
    assert!(!said.axes[1].ready);
    assert_eq!(said.axes[1].fault_code, 0x2310);
    assert_eq!(drives.take_fault().map(|fault| (fault.drive, fault.code)), Some((0, 0x2310)));
    // it stays so, whatever its control wants meanwhile
    run((&mut drives, &mut bus, &mut wire), 200, |_, said| held(said));
    let state = |wire: &Wire<_>| wire.segment.device(AXIS).unwrap().drive_state(0);
    assert_eq!(state(&wire), Some(DriveState::Fault));
    run((&mut drives, &mut bus, &mut wire), 5, |_, _| Command::default());
    let said = run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
    assert!(said.axes[1].ready && said.axes[1].fault_code == 0);
}

#[test]
fn what_is_no_number_is_not_sent() {
    let mut wire = Wire::new(two_drives(&Quirks::default()));
    let (network, storage) = (expected(DriveMode::Csv), Storage::new());
    let mut master = Master::new(&storage, &network).unwrap();
    let mut bus = master.start(&mut wire).unwrap();
    let mut drives = machine(DriveMode::Csv, SIGNALS);
    run((&mut drives, &mut bus, &mut wire), 20, |_, said| held(said));
    let before = bus.drives()[0].sent_target();
    run((&mut drives, &mut bus, &mut wire), 20, |_, said| {
        let mut command = held(said);
        command.axes[1].position = Coordinate::new(f64::NAN);
        command.spindles[0].spin = Spin::rev_per_s(f64::INFINITY);
        command
    });
    assert_eq!((bus.drives()[0].sent_target(), bus.drives()[1].sent_target()), (before, 0));
}
