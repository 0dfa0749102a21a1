//! Machines whose files are guessed, and what commissioning finds of them. Only these tests know
//! what the machines really are.
use control::config::machine_file::MachineSource;
use leadscrew::Machine;
use leadscrew::commission::{self, Bench, MOST_TORQUE_SHARE, StepResult, StrokeCounts};
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

/// Error and half interval as shares of the real value, and whether the interval holds it.
type Held = (f64, f64, bool);

/// What is found, by its name.
#[derive(Default)]
struct Tally {
    rows: Vec<(String, Vec<Held>)>,
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

/// Largest error that is allowed, as a share, of what has one.
fn allowed(what: &str) -> Option<f64> {
    Some(match what {
        "moved mass with motor and screw" | "antiresonance" => 0.02,
        "stiffness of the screw" => 0.05,
        _ => return None,
    })
}

/// The table of docs/commissioning.md.
#[test]
fn axes_are_found_from_their_own_drives() {
    let seeds = size::of(1, 100);
    let quick = StrokeCounts { slow_pairs: 3, fast_pairs: 4 };
    let effort = if size::is_full() { StrokeCounts::default() } else { quick };
    let mut tally = Tally::default();
    for seed in 100..100 + seeds {
        let (bench, real) = bench(seed);
        let result = commission::axes(&bench, effort).unwrap();
        assert!(result.is_whole(), "{:?} {:?}", result.alarms, result.not_judged);
        for moved in &result.moved {
            let window = moved.window;
            assert!(moved.force_share <= MOST_TORQUE_SHARE + 1e-9, "{moved:?}");
            assert!(moved.from_mm > window.from && moved.to_mm < window.to + 0.1, "{moved:?}");
        }
        assert!(result.lasts_s < 900.0, "{} s", result.lasts_s);
        tally.add(&result, &real);
    }
    tally.print();
    for (what, all) in &tally.rows {
        let worst = all.iter().map(|entry| entry.0.abs()).fold(0.0, f64::max);
        assert!(allowed(what).is_none_or(|most| worst < most), "{what}: {worst}");
    }
}

/// A mill whose converter does not do what its file says.
fn hidden_mill(seed: u64) -> (MachineSource, [f64; 3]) {
    let mut dice = Dice(seed ^ 0x5646_4400);
    let (delay, up, down) =
        (dice.between(6.0, 20.0), dice.between(45.0, 90.0), dice.between(40.0, 80.0));
    let text = format!(
        "extends = \"vfd-mill\"\n[[spindles]]\n[spindles.drive]\nkind = \"speed\"\ndelay_ms = {delay}\n\
         acceleration_rev_per_s2 = {up}\ndeceleration_rev_per_s2 = {down}\n\
         [simulation.spindle_drive]\ndeceleration_percent = 100\n"
    );
    (MachineSource { name: "mill.toml".into(), text: Some(text) }, [delay, up, down])
}

#[test]
fn ramps_of_a_converter_are_found_by_the_encoder() {
    let seeds = size::of(3, 100);
    let (mut holds, mut all, mut worst) = ([0; 3], 0, [0.0_f64; 3]);
    for seed in 100..100 + seeds {
        let (plant, real) = hidden_mill(seed);
        let machine = Machine::load("vfd-mill").unwrap();
        let bench = Bench { machine, plant: Some(plant), scatter: 1.0, seed };
        let result = commission::spindle(&bench).unwrap();
        all += 1;
        let keys = ["delay_ms", "acceleration_rev_per_s2", "deceleration_rev_per_s2"];
        for (i, key) in keys.iter().enumerate() {
            let found = result.findings.iter().find(|one| one.key.ends_with(key)).unwrap().value;
            let error = (found.value / real[i] - 1.0).abs();
            assert!(error < 0.03, "seed {seed}, {key}: {found:?}, really {}", real[i]);
            worst[i] = worst[i].max(error);
            holds[i] += usize::from(found.holds(real[i]));
        }
    }
    println!("largest errors {worst:?}, intervals hold in {holds:?} of {all}");
}

#[test]
fn the_inertia_of_a_spindle_is_found_though_its_drive_reads_its_torque_wrong() {
    for seed in 100..100 + size::of(2, 100) {
        let mut dice = Dice(seed);
        let inertia = 0.01 * dice.between(0.7, 1.4);
        let text = format!(
            "extends = \"tapping-center\"\n[[spindles]]\ninertia_kg_m2 = {inertia}\n\
             measured_torque = {{ resolution_percent = 0.003, noise_percent = 2, delay_ms = 1 }}\n\
             [scatter]\ntorque_constant = {{ percent = 6 }}\n"
        );
        let plant = MachineSource { name: "heavy.toml".into(), text: Some(text) };
        let machine = Machine::load("tapping-center").unwrap();
        let bench = Bench { machine, plant: Some(plant), scatter: 1.0, seed };
        let result = commission::spindle(&bench).unwrap();
        let found = result.findings.iter().find(|one| one.key.ends_with("inertia_kg_m2")).unwrap();
        let error = found.value.value / inertia - 1.0;
        assert!(error.abs() < 0.02, "seed {seed}: {:?}, really {inertia}", found.value);
    }
}

#[test]
fn the_file_that_is_written_extends_the_old_one_and_says_where_each_value_is_from() {
    let machine = Machine::load("vfd-mill").unwrap();
    let bench = Bench { machine, plant: None, scatter: 1.0, seed: 3 };
    let result = commission::spindle(&bench).unwrap();
    let text =
        commission::commissioned(&bench.machine, "mill", &result.findings, "2026-11-30").unwrap();
    assert!(text.contains("extends = \"vfd-mill\""), "{text}");
    let line = text.lines().find(|line| line.starts_with("deceleration_rev_per_s2")).unwrap();
    assert!(line.contains("# measured 2026-11-30, by ramps: ± "), "{line}");
    assert!(line.ends_with("rev/s²; was 67"), "{line}");
    let written =
        Machine::load(MachineSource { name: "new.toml".into(), text: Some(text) }).unwrap();
    let real = 67.0 * 0.85; // what the simulated converter does
    let found = written.file().spindles[0].own_ramps.unwrap().deceleration.value();
    assert!((found / real - 1.0).abs() < 0.01, "{found}");
    assert_eq!(written.file().axes[0], bench.machine.file().axes[0], "what was not measured stays");
}

#[test]
fn taps_in_air_and_circles_show_what_a_file_is_worth() {
    let machine = Machine::load("tapping-center").unwrap();
    let bench = Bench { machine, plant: None, scatter: 2.0, seed: 4 };
    let proof = bench.prove(&bench.machine).unwrap();
    assert!(proof.alarms.is_empty(), "{:?}", proof.alarms);
    let taps = proof.taps.unwrap();
    assert_eq!(taps.count, 20);
    assert!(taps.sync_error_um > 0.1 && taps.sync_error_um < 20.0, "{taps:?}");
    for circle in &proof.circles {
        // a circle is off by the errors of the screws, some micrometres, not by its radius
        let um = circle.circularity_um;
        assert!(um > 1.0 && um < 60.0, "{}: {um}", circle.radius_mm);
        assert_eq!(um, circle.radial_um[0] - circle.radial_um[1]);
    }
    assert_eq!(proof.circles.len(), 6, "R20 and R50 have room");
}
