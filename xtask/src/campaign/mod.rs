//! Controls killed and mains cut in everything that ties a tool to a spindle, with everything that drives do by themselves, over
//! processes; what became of the tool, and whether what `recover` said of it was true.
//!
//! ```text
//!   leadscrew simulator … --on-link-loss REACTION ◄── relay, which stops it at t ◄── leadscrew run: pecks, threads, gears, …
//!            │ SIGKILL, or the mains
//!            ▼
//!   drives alone ─► looked at: dry run, a refused run; no record, an old one, a foreign one ─► nothing may have changed
//!            ▼
//!   leadscrew recover, stopped itself at t₁, t₂, … ─► what it says  ◄── compared ──► what the simulated machine knows
//! ```
//!
//! *Torn before* is a tool that was broken when the drives had come to rest: physics, and no control was there to act. *Torn after*
//! is one that broke from then on, and *false* a statement that is not so: both are defects.
mod features;
mod row;
mod trial;

use features::FEATURES;
use row::{HEAD, Row};
use std::path::Path;
use test_support::Dice;
use test_support::Stop;
use trial::{Others, trial};

/// What drives do that are left alone.
const REACTIONS: [&str; 4] = ["coupled-stop", "quick-stop", "coast", "off"];

/// Stop each feature with each reaction at `count` instants; whether nothing was torn afterwards and every statement was true.
pub(crate) fn run(binary: &Path, count: u32, seed: u64) -> bool {
    println!("{HEAD}");
    let mut all = Row::default();
    let mut dice = Dice(seed);
    for feature in &FEATURES {
        let others = Others::of(binary, feature);
        for reaction in REACTIONS {
            let mut row = Row::of(reaction);
            for case in 0..count {
                let (from, to) = feature.window;
                let share = (f64::from(case) + dice.between(0.0, 1.0)) / f64::from(count);
                let at = from + (to - from) * share;
                let stop = *dice.one_of(&[Stop::Kill, Stop::PowerCut]);
                row.cases += 1;
                let trial = others.as_ref().map_err(Clone::clone).and_then(|others| {
                    trial((binary, feature, others), reaction, (at, stop), &mut dice, &mut row)
                });
                if let Err(why) = trial {
                    let what = format!("{}, {reaction}, {stop:?} at {at:.6} s", feature.name);
                    row.problems.push(format!("{what}: {why}"));
                }
            }
            println!("{}", row.text(&format!("{}, {reaction}", feature.name)));
            for problem in &row.problems {
                println!("  {problem}");
            }
            all.add(&row);
            all.problems.append(&mut row.problems);
        }
    }
    println!("{}", all.text("all"));
    all.is_good()
}
