//! What supervision finds, and how often it is wrong, over many holes on machines that scatter: the
//! table of `docs/supervision.md`.
//!
//! ```sh
//! LEADSCREW_TESTS=full cargo test --release -p kernel --test all supervision_campaign -- --nocapture
//! ```
use crate::common::run_kernel_on;
use crate::supervision::{Bench, PACKED};
use kernel::{EventKind, Kernel, Supervised};
use sync::supervision::band::StrokeBand;
use sync::supervision::diagnosis::Diagnosis;
use test_support::size;
use units::Time;

/// Good holes of each machine, beside those that make its band.
const GOOD: usize = 10;

/// What a hole really is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Case {
    Good,
    Bored(f64),
    Packed,
    Cracked,
}

impl Case {
    const ALL: [Self; 7] = [
        Self::Good,
        Self::Bored(4.6),
        Self::Bored(4.8),
        Self::Bored(5.2),
        Self::Bored(6.1),
        Self::Packed,
        Self::Cracked,
    ];

    fn name(self) -> String {
        match self {
            Self::Good => "good, bored 5.0 mm".to_owned(),
            Self::Bored(bored) if bored > 6.0 => format!("no material: bored {bored:.1} mm"),
            Self::Bored(bored) => format!("bored {bored:.1} mm"),
            Self::Packed => "chips packed".to_owned(),
            Self::Cracked => "core cracked: the tap breaks".to_owned(),
        }
    }

    fn bench(self, machine: &Bench) -> Bench {
        let sure = |mishaps: sim::Mishaps| Bench { mishaps: Some(mishaps), ..machine.clone() };
        match self {
            Self::Good => Bench { bored: vec![5.0; GOOD], ..machine.clone() },
            Self::Bored(bored) => Bench { bored: vec![bored], ..machine.clone() },
            Self::Packed => sure(sim::Mishaps { packing: 1.0, ..PACKED }),
            Self::Cracked => {
                sure(sim::Mishaps { packing: 0.0, crack: 1.0, cracked_strength: 0.15, ..PACKED })
            }
        }
    }

    fn is_named_by(self, what: Diagnosis) -> bool {
        match self {
            Self::Good => matches!(what, Diagnosis::WithinBand),
            Self::Bored(bored) if bored > 6.0 => what == Diagnosis::CutsNothing,
            Self::Bored(bored) if bored > 5.0 => matches!(what, Diagnosis::HoleTooLarge(_)),
            Self::Bored(_) => matches!(what, Diagnosis::HoleTooSmall(_)),
            Self::Packed => matches!(what, Diagnosis::ChipsPacked(_)),
            Self::Cracked => matches!(what, Diagnosis::Broken(_)),
        }
    }
}

/// What came of all holes of a case.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    holes: usize,
    /// Not within the band.
    found: usize,
    /// With the right name.
    named: usize,
    /// With another name that is said to be sure.
    wrongly_sure: usize,
    stopped: usize,
    longest: Time,
    broken: usize,
}

impl Tally {
    fn add(&mut self, case: Case, seen: &[Supervised], broken: bool) {
        self.holes += seen.len();
        self.broken += usize::from(broken);
        for supervised in seen {
            let what = supervised.diagnosed.what;
            let named = case.is_named_by(what);
            self.found += usize::from(what != Diagnosis::WithinBand);
            self.named += usize::from(named);
            self.wrongly_sure += usize::from(!named && supervised.diagnosed.is_sure);
            if let Some(crossing) = supervised.crossing {
                self.stopped += 1;
                self.longest = self.longest.max(crossing.took);
            }
        }
    }
}

/// A run with what was known before.
fn run(bench: &Bench, bands: Vec<StrokeBand>) -> (Vec<Supervised>, Vec<StrokeBand>, bool) {
    let (mut plant, control) = bench.plant();
    let mut kernel = Kernel::new(control);
    kernel.recall_bands(bands);
    let ticks = 16_000 * (bench.bored.len() + 1);
    let run = run_kernel_on(kernel, &mut plant, &bench.steps(), ticks);
    let seen = run.events.iter().filter_map(|event| match event.kind {
        EventKind::TapSupervised(supervised) => Some(supervised),
        _ => None,
    });
    let broken = run.samples.last().and_then(|sample| sample.truth).is_some_and(|t| t.tool_broken);
    (seen.collect(), run.kernel.bands().to_vec(), broken)
}

#[test]
fn of_many_holes_on_scattered_machines_faults_are_found_and_good_ones_are_left_alone() {
    let mut tallies = [Tally::default(); Case::ALL.len()];
    for seed in 0..size::of(2, 63) as u64 {
        let machine = Bench {
            rpm: [1000.0, 3000.0, 6000.0][seed as usize % 3],
            seed: seed + 1,
            // the torque constant within 3 %
            constant: 0.03 * ((seed * 7 % 13) as f64 / 6.0 - 1.0),
            ..Bench::of(1)
        };
        let learning = Bench { bored: vec![5.0; 6], ..machine.clone() };
        let (_, bands, _) = run(&learning, Vec::new());
        for (case, tally) in Case::ALL.into_iter().zip(&mut tallies) {
            // other holes than those that made the band
            let bench = Bench { seed: machine.seed + 1000, ..case.bench(&machine) };
            let (seen, _, broken) = run(&bench, bands.clone());
            tally.add(case, &seen, broken);
        }
    }
    println!(
        "| hole | holes | not within the band | right name | wrong name, said to be sure | stopped | longest to the alarm | broken |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (case, t) in Case::ALL.into_iter().zip(&tallies) {
        let ms = t.longest.value() * 1e3;
        println!(
            "| {} | {} | {} | {} | {} | {} | {ms:.1} ms | {} |",
            case.name(),
            t.holes,
            t.found,
            t.named,
            t.wrongly_sure,
            t.stopped,
            t.broken
        );
    }
    for (case, t) in Case::ALL.into_iter().zip(&tallies) {
        let share = t.found as f64 / t.holes as f64;
        if case == Case::Good {
            assert!(share <= 0.005, "{} of {} good holes", t.found, t.holes);
        } else {
            assert!(share >= 0.95, "{}: {} of {} found", case.name(), t.found, t.holes);
        }
    }
}
