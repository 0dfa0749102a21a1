//! Supervision of taps by measured torque, on a plant that does what is to be found.
use crate::common::*;
use kernel::{
    Config, EventKind, FaultKind, Kernel, OverloadReaction, Supervised, SupervisionControl,
    TorqueReading,
};
use plan::StepKind;
use sim::{Bore, Hole, MeasuredTorque, MeasuredTorques, SimulatedMachine};
use sync::supervision::diagnosis::Diagnosis;
use units::{Length, Position, Spread, Time, Torque};

/// Noise of the reading as a share of the drive's 42 N·m: 0.84 N·m, half of what an M6 takes.
const NOISE: f64 = 0.02;
const DELAY: Time = Time::s(1e-3);

/// How the holes come to be.
#[derive(Clone, Debug)]
struct Bench {
    rpm: f64,
    depth: f64,
    noise: f64,
    seed: u64,
    /// Diameters of the pre-drilled holes.
    bored: Vec<f64>,
    mishaps: Option<sim::Mishaps>,
    wear: Option<sim::TapWear>,
    limit: Option<f64>,
}

impl Bench {
    fn of(holes: usize) -> Self {
        Self {
            rpm: 1000.0,
            depth: 15.0,
            noise: NOISE,
            seed: 1,
            bored: vec![5.0; holes],
            mishaps: None,
            wear: None,
            limit: Some(6.4),
        }
    }

    fn order(&self) -> TapOrder {
        TapOrder { rpm: self.rpm, to_mm: M6.surface_mm - self.depth, ..M6 }
    }

    fn plant(&self) -> (SimulatedMachine, Config) {
        let mut machine = scattered(machine_with_work(1, &self.order(), 6.0), 0.05, self.seed);
        let bore = |bored: &f64| {
            let (diameter, tip_depth) = (Length::mm(*bored), Length::mm(self.depth + 4.0));
            Bore { diameter, tip_depth, cone: Length::ZERO }
        };
        if let Some(stock) = &mut machine.stock {
            stock.assume_predrilled = false;
            stock.holes = (0..)
                .zip(&self.bored)
                .map(|(number, bored)| Hole {
                    bores: if *bored > 0.0 { vec![bore(bored)] } else { Vec::new() },
                    ..Hole::at(Length::mm(10.0 * f64::from(number)), Length::ZERO)
                })
                .collect();
        }
        let mut control = control(&machine);
        let peak = machine.spindles[0].peak_torque;
        let reading = TorqueReading { delay: DELAY, noise: peak * self.noise };
        let readings = core::array::from_fn(|spindle| (spindle == 0).then_some(reading));
        control.supervision =
            Some(SupervisionControl { readings, share: 0.25, reaction: OverloadReaction::Retract });
        let mut measured = MeasuredTorques::default();
        measured.spindles[0] = Some(MeasuredTorque {
            resolution_share: 0.001,
            noise_share: self.noise,
            delay: DELAY,
            constant_error: 0.03,
        });
        let mut plant = SimulatedMachine::new(machine).expect("it can be built");
        plant = plant.with_measured_torque(&measured);
        if let Some(mishaps) = self.mishaps {
            plant = plant.with_mishaps(mishaps);
        }
        if let Some(wear) = self.wear {
            plant = plant.with_tap_wear(wear);
        }
        (plant, control)
    }

    fn steps(&self) -> Vec<StepKind> {
        let order = self.order();
        let at = |number: usize| Position::xyz(10.0 * number as f64, 0.0, order.from_mm);
        let mut steps = vec![line(Position::default(), at(0), 300.0, true)];
        for number in 0..self.bored.len() {
            if number > 0 {
                steps.push(line(at(number - 1), at(number), 100.0, true));
            }
            let mut plan = order.plan();
            plan.start = at(number);
            plan.torque_expected = Torque::n_m(1.73);
            plan.torque_limit = self.limit.map(Torque::n_m);
            steps.push(StepKind::Tap(plan));
        }
        steps.push(StepKind::End);
        steps
    }

    /// What supervision saw of each hole, and the run; it goes on until a retract is over.
    fn run(&self) -> (Vec<Supervised>, Run) {
        let (mut plant, control) = self.plant();
        let ticks = 16_000 * (self.bored.len() + 1);
        let run = run_kernel_on(Kernel::new(control), &mut plant, &self.steps(), ticks);
        let seen = run.events.iter().filter_map(|event| match event.kind {
            EventKind::TapSupervised(supervised) => Some(supervised),
            _ => None,
        });
        (seen.collect(), run)
    }
}

fn show(name: &str, bench: &Bench) {
    let (seen, run) = bench.run();
    let truth = run.samples.last().unwrap().truth.unwrap();
    let peak = run.samples.iter().map(|s| s.truth.unwrap().cutting_torque.value().abs());
    let z = run.samples.last().unwrap().axis(2).value();
    println!(
        "{name}: {} holes, faults {:?}, broken {}, peak {:.2}, z {z:.2}",
        seen.len(),
        run.kernel.faults(),
        truth.tool_broken,
        peak.fold(0.0, f64::max)
    );
    for s in seen.iter().skip(bench.bored.len().saturating_sub(4)) {
        println!("   {:?} {:?} level {:.3} {:.4?}", s.diagnosed, s.crossing, s.level, s.slope);
    }
}

#[test]
fn look() {
    for noise in [0.005, 0.02] {
        for rpm in [300.0, 1000.0, 3000.0, 6000.0] {
            for seed in [1, 2] {
                show(&format!("good {noise} {rpm}"), &Bench { rpm, noise, seed, ..Bench::of(10) });
            }
        }
    }
    let then = |bored: f64| [vec![5.0; 6], vec![bored]].concat();
    for rpm in [500.0, 3000.0] {
        for bored in [0.0, 4.6, 4.8, 5.2, 5.5, 6.1] {
            show(&format!("{bored} at {rpm}"), &Bench { rpm, bored: then(bored), ..Bench::of(7) });
        }
        let mishaps = sim::Mishaps {
            packing: 0.3,
            packed_from: (0.5, 1.0),
            packed_rise: 1.5,
            crack: 0.0,
            cracked_strength: 0.1,
        };
        show(&format!("packed {rpm}"), &Bench { rpm, mishaps: Some(mishaps), ..Bench::of(12) });
        let mishaps = sim::Mishaps { packing: 0.0, crack: 0.1, cracked_strength: 0.18, ..mishaps };
        show(&format!("cracked {rpm}"), &Bench { rpm, mishaps: Some(mishaps), ..Bench::of(16) });
    }
    let wear = sim::TapWear { life: Length::mm(600.0), rise: 0.8, scatter: 0.0 };
    show("wear", &Bench { rpm: 3000.0, wear: Some(wear), ..Bench::of(40) });
    panic!("look");
}
