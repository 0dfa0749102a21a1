//! The tick takes no memory: an allocator that aborts when asked within a tick, over a whole
//! program.
#![allow(clippy::large_stack_arrays)] // a few steps
mod common;
use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use bus::Machine;
use canon::Position;
use common::{M6, TapOrder, await_speed, control, line, machine, tapping, turn};
use kernel::{
    Kernel, Learning, OverloadReaction, Prediction, SupervisionControl, SyncMode, TorqueReading,
};
use plan::{Step, StepKind};
use sim::SimulatedMachine;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Run a program with the allocator shut during every tick and push; the number of ticks.
fn ticks_without_memory(mode: SyncMode, steps: &[StepKind]) -> u32 {
    ticks_learning(mode, steps, None)
}

/// The same, with taps that may learn from one another.
fn ticks_learning(mode: SyncMode, steps: &[StepKind], learning: Option<Learning>) -> u32 {
    let machine = machine(1);
    let mut config = control(&machine);
    config.synchronisation = mode;
    config.learning = learning;
    let reading = TorqueReading { delay: units::Time::s(1e-3), noise: units::Torque::n_m(0.2) };
    config.supervision = Some(SupervisionControl {
        readings: [Some(reading); bus::SPINDLES],
        share: 0.25,
        reaction: OverloadReaction::Retract,
    });
    let mut kernel = Kernel::new(config);
    let mut measured = sim::MeasuredTorques::default();
    measured.spindles[0] = Some(sim::MeasuredTorque {
        resolution_share: 0.001,
        noise_share: 0.005,
        delay: units::Time::s(1e-3),
        constant_error: 0.02,
    });
    let machine = SimulatedMachine::new(machine).expect("the test's machine can be built");
    let mut machine = machine.with_measured_torque(&measured);
    let mut feedback = *machine.feedback();
    let steps = steps.iter().map(|kind| Step { op: 0, line: 1, kind: kind.clone() });
    let steps: Vec<Step> = steps.collect();
    let mut waiting = steps.iter().peekable();
    let mut ticks = 0;
    while !kernel.is_over() && ticks < 40_000 {
        while waiting.next_if(|step| assert_no_alloc(|| kernel.push(step)).is_ok()).is_some() {}
        // the events are not taken: the ring has to cope by itself
        let command = assert_no_alloc(|| kernel.tick(&feedback));
        feedback = *machine.exchange(&command);
        ticks += 1;
    }
    assert!(kernel.is_over() && kernel.faults().is_empty(), "{:?}", kernel.faults());
    ticks
}

#[test]
fn no_tick_of_a_surface_speed_takes_memory() {
    let (near, far) = (Position::xyz(20.0, 0.0, 0.0), Position::xyz(60.0, 0.0, 0.0));
    let surface = motion::SurfaceSpeed {
        speed: units::Speed::mm_per_min(100e3),
        limit: units::Spin::rpm(3000.0),
        axis: units::Length::ZERO,
    };
    let order = plan::SpindleStep::Surface { surface, ramp: motion::Profile::EMPTY.into() };
    let steps = [
        line(Position::default(), far, 100.0, true),
        StepKind::Spindle { spindle: 0, order },
        await_speed(),
        line(far, near, 20.0, true),
        StepKind::End,
    ];
    let ticks = ticks_without_memory(SyncMode::CommandSynchronised, &steps);
    assert!(ticks > 8000, "{ticks}");
}

#[test]
fn no_tick_of_a_whole_tapping_program_takes_memory() {
    let (zero, corner) = (Position::default(), Position::xyz(50.0, 20.0, 0.0));
    let mut steps = vec![turn(0.0, 3000.0), await_speed(), line(zero, corner, 100.0, true)];
    steps.extend([line(corner, zero, 100.0, false), turn(3000.0, 0.0), await_speed()]);
    for _ in 0..3 {
        steps.extend(tapping(&TapOrder { dwell_s: 0.1, ..M6 }).into_iter().take(2));
        steps.push(line(Position::xyz(0.0, 0.0, M6.from_mm), zero, 100.0, true));
    }
    steps.push(StepKind::End);
    let ticks = ticks_without_memory(SyncMode::CommandSynchronised, &steps);
    assert!(ticks > 10_000, "{ticks}");
}

#[test]
fn no_tick_of_an_encoder_following_tap_takes_memory() {
    let mode = SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 1 };
    assert!(ticks_without_memory(mode, &tapping(&M6)) > 4000);
}

#[test]
fn no_tick_takes_memory_while_taps_learn_even_where_a_record_makes_room_for_another() {
    let learning = Some(Learning { gain: 0.7, bandwidth_hz: 70.0 });
    let mut steps = tapping(&TapOrder { to_mm: -105.0, ..M6 })[..2].to_vec();
    // more kinds of strokes than are kept
    for kind in 0..10 {
        let to_mm = -105.0 - f64::from(kind);
        steps.push(StepKind::Tap(TapOrder { to_mm, ..M6 }.plan()));
    }
    steps.push(StepKind::End);
    assert!(ticks_learning(SyncMode::CommandSynchronised, &steps, learning) > 10_000);
    let following = SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 1 };
    assert!(ticks_learning(following, &tapping(&M6), learning) > 4000);
}

#[test]
fn a_fault_takes_no_memory_either() {
    let machine = machine(0);
    let mut kernel = Kernel::new(control(&machine));
    let mut machine = SimulatedMachine::new(machine).expect("the test's machine can be built");
    let mut feedback = *machine.feedback();
    for tick in 0..2000 {
        feedback.emergency_stop = tick > 1000;
        let command = assert_no_alloc(|| kernel.tick(&feedback));
        feedback = *machine.exchange(&command);
    }
    assert_eq!(kernel.faults().len(), 1);
}
