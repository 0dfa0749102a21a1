//! What one tick costs: three axes and a spindle, over a program of moves and rigid taps, on this
//! computer. Prints median, 99.9th percentile and worst, by what the kernel was doing, and how fast
//! kernel and simulated machine run together.
//!
//! ```text
//!   cargo bench -p kernel
//! ```
//!
//! The tick is timed by itself, without the machine; the cost of reading the clock is measured
//! first and subtracted. The worst of a computer with an ordinary operating system is the system's,
//! not the tick's.
#[path = "../tests/common/mod.rs"]
mod common;
use bus::{Machine, State};
use canon::Position;
use common::{M6, TapOrder, await_speed, control, line, machine, tapping, turn};
use kernel::{Kernel, Prediction, SyncMode};
use plan::{Step, StepKind};
use std::time::{Duration, Instant};

/// Runs of the program: enough for a 99.9th percentile.
const RUNS: usize = 20;

fn main() {
    let clock_ns = clock_cost();
    println!("clock {clock_ns} ns per reading, subtracted");
    let observer = SyncMode::EncoderFollowing { prediction: Prediction::Observer, transport: 1 };
    for (name, mode) in
        [("command-synchronised", SyncMode::CommandSynchronised), ("encoder-following", observer)]
    {
        println!("{name}");
        println!("  {:<12} {:>8} {:>9} {:>9} {:>9}", "state", "ticks", "median", "p99.9", "worst");
        let mut costs: Vec<(State, u64)> = Vec::new();
        let all: Duration = (0..RUNS).map(|_| measure(mode, clock_ns, &mut costs)).sum();
        for state in [State::Rapid, State::Feed, State::TapIn, State::TapOut, State::SpindleWait] {
            let of_state = costs.iter().filter(|(s, _)| *s == state).map(|(_, ns)| *ns).collect();
            row(state.name(), of_state);
        }
        row("all", costs.iter().map(|(_, ns)| *ns).collect());
        let per_s = costs.len() as f64 / all.as_secs_f64();
        let ratio = per_s * common::PERIOD.value();
        println!(
            "  kernel and machine: {per_s:.0} servo periods per second, {ratio:.0} × real time"
        );
    }
}

fn row(name: &str, mut costs: Vec<u64>) {
    if costs.is_empty() {
        return;
    }
    costs.sort_unstable();
    let at = |share: f64| costs[((costs.len() - 1) as f64 * share) as usize];
    let count = costs.len();
    println!("  {name:<12} {count:>8} {:>6} ns {:>6} ns {:>6} ns", at(0.5), at(0.999), at(1.0));
}

/// The program: spindle up, moves in three axes, spindle down, four taps.
fn program() -> Vec<StepKind> {
    let (zero, corner) = (Position::default(), Position::xyz(60.0, 40.0, -50.0));
    let mut steps = vec![turn(0.0, 3000.0), await_speed(), line(zero, corner, 100.0, false)];
    let StepKind::Move(mut feed) = line(corner, zero, 100.0, true) else {
        unreachable!("a line is a move")
    };
    feed.rapid = false;
    steps.extend([StepKind::Move(feed), turn(3000.0, 0.0), await_speed()]);
    for rpm in [1000.0, 3000.0, 4500.0, 6000.0] {
        steps.extend(tapping(&TapOrder { rpm, ..M6 }).into_iter().take(2));
        steps.push(line(Position::xyz(0.0, 0.0, M6.from_mm), zero, 100.0, true));
    }
    steps.push(StepKind::End);
    steps
}

#[allow(clippy::disallowed_methods)] // measuring is what this program is for
fn measure(mode: SyncMode, clock_ns: u64, costs: &mut Vec<(State, u64)>) -> Duration {
    let model = machine(1);
    let mut config = control(&model);
    config.synchronisation = mode;
    let mut kernel = Kernel::new(config);
    let mut machine = sim::SimulatedMachine::new(model).expect("the machine can be built");
    let mut feedback = *machine.feedback();
    let steps = program().into_iter().map(|kind| Step { op: 0, line: 1, kind });
    let steps: Vec<Step> = steps.collect();
    let mut waiting = steps.iter().peekable();
    let started = Instant::now();
    while !kernel.is_over() {
        while waiting.next_if(|step| kernel.push(step).is_ok()).is_some() {}
        let before = Instant::now();
        let command = kernel.tick(&feedback);
        let ns = before.elapsed().as_nanos() as u64;
        costs.push((kernel.report().state, ns.saturating_sub(clock_ns)));
        feedback = *machine.exchange(&command);
        while kernel.next_event().is_some() {}
    }
    assert!(kernel.faults().is_empty(), "{:?}", kernel.faults());
    started.elapsed()
}

#[allow(clippy::disallowed_methods)]
fn clock_cost() -> u64 {
    let mut costs: Vec<u64> = (0..10_001)
        .map(|_| {
            let before = Instant::now();
            before.elapsed().as_nanos() as u64
        })
        .collect();
    costs.sort_unstable();
    costs[costs.len() / 2]
}
