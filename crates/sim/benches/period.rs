//! What one servo period of simulation costs: `cargo bench -p sim`.
#![allow(missing_docs)] // criterion's macros make undocumented functions
#[path = "../tests/fixtures/mod.rs"]
mod fixtures;
use bus::{Command, Machine};
use criterion::{Criterion, criterion_group, criterion_main};
use sim::{Config, SimulatedMachine};
use std::hint::black_box;
use units::{Coordinate, Force, Time, Torque};

/// One period with every axis and the spindle under way.
fn swing(machine: &mut SimulatedMachine, phase: &mut f64) {
    *phase += 0.01;
    let mut command = Command::default();
    for axis in &mut command.axes[..3] {
        axis.enable = true;
        axis.force = Force::n(6000.0 * phase.sin());
    }
    command.spindles[0].enable = true;
    command.spindles[0].torque = Torque::n_m(20.0 * phase.cos());
    black_box(machine.exchange(&command));
}

/// A machine whose tap has entered the work and rests there.
fn in_the_work() -> (SimulatedMachine, Command) {
    let mut config = Config { tool: 2, ..fixtures::tapping_center() };
    config.axes[2].1.start = Coordinate::new(-199.999);
    let mut machine = SimulatedMachine::new(config).expect("the fixture is a machine");
    let mut command = Command { tool: 2, ..Command::default() };
    command.axes[2].enable = true;
    for force in [-300.0, 0.0] {
        command.axes[2].force = Force::n(force);
        for _ in 0..40 {
            machine.exchange(&command);
        }
    }
    let truth = machine.truth().expect("a simulated machine knows");
    assert!(!truth.tool_broken && !machine.holes().is_empty(), "{truth:?}");
    (machine, command)
}

fn period(criterion: &mut Criterion) {
    for step_us in [25.0, 12.5] {
        let config = Config { substep: Time::s(step_us * 1e-6), ..fixtures::tapping_center() };
        let mut machine = SimulatedMachine::new(config).expect("the fixture is a machine");
        let mut phase = 0.0;
        let name = format!("period of 250 µs, three axes and a spindle, {step_us} µs steps");
        criterion.bench_function(&name, |b| b.iter(|| swing(&mut machine, &mut phase)));
    }
    let (mut machine, command) = in_the_work();
    let name = "the same with a tap in the work, 25 µs steps";
    criterion.bench_function(name, |b| {
        b.iter(|| {
            black_box(machine.exchange(&command));
        });
    });
}

criterion_group!(benches, period);
criterion_main!(benches);
