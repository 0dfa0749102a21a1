//! Drives that are left alone come to rest, together where they can.
use crate::fixtures::tapping_center;
use bus::{Command, Coupled, DriveReaction, Feedback, Machine};
use core::f64::consts::TAU;
use sim::{Bus, Fault, Faulty, LeftAlone, RunDown, SimulatedMachine};
use units::{CoordinateSpeed, Force, Lead, Spin, Time, Torque};

/// Spindle at 1000 rpm and Z at 1.25 mm per turn, driven there by hand; in the air.
fn moving() -> (SimulatedMachine, Command, Feedback) {
    let mut machine = SimulatedMachine::new(tapping_center()).expect("the fixture is a machine");
    let wanted = (Spin::rpm(1000.0), CoordinateSpeed::new(-1.25 * 1000.0 / 60.0));
    let (mut before, mut command) = (*machine.feedback(), Command::default());
    for i in 0..4000 {
        let now = *machine.feedback();
        let rate = |a: f64, b: f64| (a - b) / 250e-6;
        let v = rate(now.axes[2].position.value(), before.axes[2].position.value());
        let spin = rate(now.spindles[0].angle.value(), before.spindles[0].angle.value());
        let share = (f64::from(i) / 2000.0).min(1.0);
        command.axes[2].enable = true;
        command.axes[2].force = Force::n(400.0 * (share * wanted.1.value() - v));
        command.axes[2].speed = wanted.1;
        command.spindles[0].enable = true;
        command.spindles[0].torque = Torque::n_m(20.0 * (share * wanted.0.value() - spin));
        command.spindles[0].spin = wanted.0;
        before = now;
        machine.exchange(&command);
    }
    let now = *machine.feedback();
    command.coupled = Some(Coupled {
        axis: 2,
        spindle: 0,
        angle: now.spindles[0].angle,
        place: now.axes[2].position.of_linear(),
        lead: Lead::mm_per_rev(-1.25),
    });
    (machine, command, now)
}

/// Distance from the line at rest and at the worst, mm; turns run down; time taken.
fn run_down(reaction: DriveReaction, bus: Option<Bus>) -> (f64, f64, f64, Time) {
    let (mut machine, command, begin) = moving();
    let mut drives = RunDown::new(&tapping_center(), reaction, bus, &command, &begin);
    let mut worst = 0.0_f64;
    loop {
        let now = *machine.feedback();
        let turned = (now.spindles[0].angle - begin.spindles[0].angle).value();
        let off = (now.axes[2].position - begin.axes[2].position).value() + 1.25 * turned;
        worst = worst.max(off.abs());
        assert!(now.time - begin.time < RunDown::LONGEST, "it never stands");
        if drives.is_over() {
            return (off, worst, turned, now.time - begin.time);
        }
        let order = drives.command(&now);
        machine.exchange(&order);
    }
}

#[test]
fn coasting_takes_the_turns_that_friction_allows() {
    // J·ω·dω/dθ = −(c₀ + c₁ω), integrated from ω₀ to 0
    let (c0, c1, j, w0): (f64, f64, f64, f64) = (0.3, 0.0012, 0.010, 1000.0 / 60.0 * TAU);
    let exact = j / c1 * (w0 - c0 / c1 * (1.0 + c1 * w0 / c0).ln()) / TAU;
    let (_, _, turned, _) = run_down(DriveReaction::Off, None);
    assert!((turned - exact).abs() < 0.03 * exact, "{turned} turns, exact {exact}");
}

#[test]
fn a_quick_stop_takes_the_turns_of_the_drives_torque() {
    let exact = 0.010 * (1000.0 / 60.0 * TAU).powi(2) / 2.0 / (0.95 * 42.0) / TAU;
    let (off, _, turned, time) = run_down(DriveReaction::QuickStop, None);
    assert!((turned - exact).abs() < 0.25 * exact, "{turned} turns, exact {exact}");
    // each on its own ramp of the same length: what is left is the drives' lag and the speed loops'
    // error
    assert!(off.abs() < 0.1, "spindle and feed stop {off} mm apart");
    assert!(time < Time::s(0.3), "{time}");
}

#[test]
fn an_axis_tied_to_a_coasting_spindle_goes_with_it() {
    let (_, worst, turned, _) = run_down(DriveReaction::Coast, None);
    assert!(worst < 0.020, "{worst} mm");
    assert!(turned > 5.0, "it coasted: {turned} turns");
}

#[test]
fn a_coupled_stop_stays_on_the_line() {
    let (off, worst, turned, _) = run_down(DriveReaction::CoupledStop, None);
    assert!(worst < 0.020, "{worst} mm at the worst, {off} mm at rest");
    assert!(turned > 0.1, "it stopped at once: {turned}");
}

#[test]
fn the_braking_spindle_pays_for_a_coupled_stop_without_mains() {
    let bus = Bus { farad: 820e-6, volt: 565.0, trip_volt: 250.0 };
    let (_, worst, ..) = run_down(DriveReaction::CoupledStop, Some(bus));
    assert!(worst < 0.020, "{worst} mm");
}

#[test]
fn an_empty_bus_ends_in_coasting() {
    let bus = Bus { farad: 1e-9, volt: 565.0, trip_volt: 564.0 };
    let (_, worst, turned, _) = run_down(DriveReaction::CoupledStop, Some(bus));
    assert!(turned > 0.1 && worst > 0.0, "{turned} {worst}");
}

#[test]
fn drives_that_are_off_already_stay_off() {
    let config = tapping_center();
    let machine = SimulatedMachine::new(config.clone()).expect("the fixture is a machine");
    let nothing = Command::default();
    let mut drives =
        RunDown::new(&config, DriveReaction::QuickStop, None, &nothing, machine.feedback());
    assert_eq!(drives.command(machine.feedback()), nothing);
}

/// Drives that brake together 5 ms after their control has fallen silent.
fn coupled_stop() -> LeftAlone {
    LeftAlone {
        config: tapping_center(),
        watchdog: Time::s(5e-3),
        on_silence: DriveReaction::CoupledStop,
        on_power_loss: DriveReaction::Off,
        bus: None,
    }
}

/// A tap's axis on its line, the chain opened for some periods, and then what the control says:
/// nothing, or what it said before. How far off the line at the worst, mm; whether the opened chain
/// was heard.
fn chain_opened_for(periods: u32, says: &Command) -> (f64, bool) {
    let (machine, command, begin) = moving();
    let mut machine = Faulty::new(machine, &[], 1).left_alone(coupled_stop());
    machine.exchange(&command);
    machine.strike(Fault::EmergencyStop);
    let (mut worst, mut is_heard, mut turned_before) = (0.0_f64, false, 0.0);
    for period in 0..8000 {
        if period == periods {
            machine.repair(Fault::EmergencyStop);
        }
        is_heard |= machine.feedback().emergency_stop;
        let now = *machine.exchange(if period < periods { &command } else { says });
        let turned = (now.spindles[0].angle - begin.spindles[0].angle).value();
        let off = (now.axes[2].position - begin.axes[2].position).value() + 1.25 * turned;
        worst = worst.max(off.abs());
        if period == 7999 {
            assert!((turned - turned_before).abs() < 1e-6, "{periods}: it turns on");
        }
        turned_before = turned;
    }
    (worst, is_heard)
}

#[test]
fn drives_that_are_mended_while_they_stop_do_not_take_up_the_command_before() {
    let (machine, command, begin) = moving();
    for periods in [25, 60, 120] {
        let mut machine = Faulty::new(machine.clone(), &[], 1).left_alone(coupled_stop());
        machine.exchange(&command);
        machine.strike(Fault::Kill);
        for _ in 0..periods {
            machine.wait();
        }
        machine.mend();
        let spin = |from: &Feedback, to: &Feedback| {
            (to.spindles[0].angle - from.spindles[0].angle).value() / 250e-6
        };
        let (mut before, mut slowest) = (*machine.feedback(), f64::INFINITY);
        assert!(before.time > begin.time);
        for _ in 0..400 {
            let now = *machine.exchange(&Command::default());
            let rev_per_s = spin(&before, &now);
            assert!(rev_per_s < slowest + 0.1, "after {periods} periods it runs up: {rev_per_s}");
            (before, slowest) = (now, slowest.min(rev_per_s));
        }
    }
}

#[test]
fn a_button_that_is_pressed_again_before_its_release_is_heard_stays_pressed() {
    let (machine, command, _) = moving();
    let mut machine = Faulty::new(machine, &[], 1).left_alone(coupled_stop());
    for exchanges in 0..4 {
        machine.strike(Fault::EmergencyStop);
        for _ in 0..exchanges {
            machine.exchange(&command);
        }
        machine.repair(Fault::EmergencyStop);
        machine.strike(Fault::EmergencyStop);
        for _ in 0..3 {
            assert!(machine.exchange(&command).emergency_stop, "after {exchanges} exchanges");
        }
        machine.strike(Fault::EmergencyStop);
        machine.repair(Fault::EmergencyStop);
        assert!(!machine.exchange(&command).emergency_stop, "released after {exchanges}");
    }
}

#[test]
fn a_chain_that_is_closed_again_is_heard_and_the_stop_goes_on_together() {
    for periods in [0, 1, 2, 9, 20, 21, 60, 120, 400] {
        let (worst, is_heard) = chain_opened_for(periods, &Command::default());
        assert!(is_heard, "{periods} periods");
        assert!(worst < 0.030, "{worst} mm after {periods} periods");
    }
}
