//! Machines whose files are guessed, and what commissioning finds of them. Only these tests know
//! what the machines really are.
use control::config::machine_file::MachineSource;
use leadscrew::Machine;
use leadscrew::commission::{self, Bench, Effort, StepResult};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use test_support::Dice;
use test_support::size;

/// What an axis really is.
#[derive(Clone, Copy, Debug)]
struct RealAxis {
    letter: char,
    table: f64,
    inertia: f64,
    stiffness: f64,
    play: f64,
    coulomb: f64,
    viscous: f64,
    weight: f64,
}

impl RealAxis {
    /// By a key of the machine's file, or the name of what follows from others.
    fn value(&self, key: &str, name: &str) -> Option<f64> {
        let motor = self.inertia * (TAU / 0.016_f64).powi(2);
        let what = key.rsplit('.').next().unwrap_or_default();
        Some(match what {
            "coulomb_n" => self.coulomb,
            "viscous_n_s_per_m" => self.viscous,
            "moving_mass_kg" => self.table,
            "rotating_inertia_kg_m2" => self.inertia,
            "stiffness_n_per_um" => self.stiffness,
            "backlash_um" => self.play,
            _ if name.contains("moved mass") => motor + self.table,
            _ if name.contains("antiresonance") => (self.stiffness * 1e6 / self.table).sqrt() / TAU,
            _ if name.contains(": weight") => self.table * 9.806_65 * self.weight,
            _ => return None,
        })
    }
}

/// A tapping centre that is not what its file says: scatter of the seed doubled, and values that
/// the file has guessed.
fn hidden(seed: u64) -> (MachineSource, Vec<RealAxis>) {
    let mut dice = Dice(seed ^ 0x434f_4d4d);
    let mut text = String::from("extends = \"tapping-center\"\n");
    let mut all = Vec::new();
    for (letter, table, weight) in [('x', 200.0, 0.0), ('y', 350.0, 0.0), ('z', 150.0, 1.0)] {
        let friction = dice.between(0.6, 1.4);
        let real = RealAxis {
            letter,
            table: table * dice.between(0.8, 1.2),
            inertia: 0.007 * dice.between(0.85, 1.15),
            stiffness: 80.0 * dice.between(0.7, 1.3),
            play: dice.between(0.6, 1.4),
            coulomb: 150.0 * friction,
            viscous: 600.0 * dice.between(0.6, 1.4),
            weight,
        };
        let _ = writeln!(
            text,
            "[axes.{letter}]\nmoving_mass_kg = {}\n[axes.{letter}.drive]\nrotating_inertia_kg_m2 = {}\n\
             measured_torque = {{ resolution_percent = 0.003, noise_percent = 2, delay_ms = 1 }}\n\
             [axes.{letter}.structure]\nstiffness_n_per_um = {}\nbacklash_um = {}\n\
             [axes.{letter}.friction]\ncoulomb_n = {}\nstatic_n = {}\nviscous_n_s_per_m = {}",
            real.table,
            real.inertia,
            real.stiffness,
            real.play,
            real.coulomb,
            190.0 * friction,
            real.viscous
        );
        all.push(real);
    }
    text += "[scatter]\nbacklash = { percent = 0 }\nstiffness = { percent = 0 }\nfriction = { percent = 0 }\n";
    (MachineSource { name: "hidden.toml".into(), text: Some(text) }, all)
}

fn bench(seed: u64) -> (Bench, Vec<RealAxis>) {
    let (plant, real) = hidden(seed);
    let machine = Machine::load("tapping-center").unwrap();
    (Bench { machine, plant: Some(plant), scatter: 1.0, seed }, real)
}

/// Errors as shares of the real value, and whether intervals hold it.
#[derive(Default)]
struct Tally {
    rows: Vec<(String, Vec<(f64, f64, bool)>)>,
}

impl Tally {
    fn add(&mut self, result: &StepResult, real: &[RealAxis]) {
        for finding in &result.findings {
            let letter = finding.name.chars().next().unwrap().to_ascii_lowercase();
            let axis = real.iter().find(|axis| axis.letter == letter).unwrap();
            let Some(truth) = axis.value(&finding.key, &finding.name) else { continue };
            let what = finding.name[3..].to_owned();
            let error = finding.value.value / truth - 1.0;
            let half = finding.value.half / truth;
            let entry = (error, half, finding.value.holds(truth));
            match self.rows.iter_mut().find(|row| row.0 == what) {
                Some(row) => row.1.push(entry),
                None => self.rows.push((what, vec![entry])),
            }
        }
    }

    fn print(&self) {
        for (what, all) in &self.rows {
            let count = all.len() as f64;
            let worst = all.iter().map(|e| e.0.abs()).fold(0.0, f64::max);
            let mean = all.iter().map(|e| e.0).sum::<f64>() / count;
            let rms = (all.iter().map(|e| e.0 * e.0).sum::<f64>() / count).sqrt();
            let half = all.iter().map(|e| e.1).sum::<f64>() / count;
            let holds = all.iter().filter(|e| e.2).count() as f64 / count;
            println!(
                "{what}: {count} axes, mean {:+.2} %, rms {:.2} %, largest {:.2} %, interval ± {:.2} %, holds in {:.0} of 100",
                mean * 100.0,
                rms * 100.0,
                worst * 100.0,
                half * 100.0,
                holds * 100.0
            );
        }
    }
}

/// The table of docs/commissioning.md.
#[test]
fn axes_are_found_from_their_own_drives() {
    let seeds = size::of(std::env::var("SEEDS").map_or(1, |n| n.parse().unwrap()), 100);
    let mut tally = Tally::default();
    for seed in 100..100 + seeds {
        let (bench, real) = bench(seed);
        let result = commission::axes(&bench, Effort::default()).unwrap();
        assert!(result.alarms.is_empty() && result.not_judged.is_empty(), "{result:?}");
        println!("{:?} {} s", result.moved, result.lasts_s);
        tally.add(&result, &real);
    }
    tally.print();
}
