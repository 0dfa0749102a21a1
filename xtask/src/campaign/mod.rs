//! Controls killed and mains cut in everything that ties a tool to a spindle, with everything that
//! drives do by themselves, over processes; what became of the tool, and whether what `recover`
//! said of it was true.
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
//! *Torn before* is a tool that was broken when the drives had come to rest: physics, and no
//! control was there to act. *Torn after* is one that broke from then on, and *false* a statement
//! that is not so: both are defects.
mod features;
mod row;
mod trial;

use features::FEATURES;
use row::{HEAD, Row};
use std::path::Path;
use test_support::Dice;
use test_support::Stop;
use trial::{Others, repeat, trial};

/// What drives do that are left alone.
const REACTIONS: [&str; 4] = ["coupled-stop", "quick-stop", "coast", "off"];

/// Stop each feature with each reaction at `count` instants; whether nothing was torn afterwards
/// and every statement was true.
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
                let mut stops = vec![(at, *dice.one_of(&[Stop::Kill, Stop::PowerCut]))];
                row.cases += 1;
                let trial = others.as_ref().map_err(Clone::clone).and_then(|others| {
                    trial((binary, feature, others), reaction, &mut stops, &mut dice, &mut row)
                });
                row.stopped_again += u32::try_from(stops.len() - 1).unwrap_or(u32::MAX);
                if let Err(why) = trial {
                    let stops: Vec<_> =
                        stops.iter().map(|(at, stop)| format!("{stop:?} at {at:.6}")).collect();
                    row.problems.push(format!(
                        "{}; {reaction}; {}: {why}",
                        feature.name,
                        stops.join("; ")
                    ));
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

/// One case of it again, as a problem names it: `FEATURE; REACTION; STOP at S; …`.
pub(crate) fn run_again(binary: &Path, case: &str) -> Result<(), String> {
    const FORM: &str = "a case is \"FEATURE; REACTION; Kill at SECONDS; PowerCut at SECONDS; …\"";
    let mut parts = case.split("; ");
    let name = parts.next().unwrap_or_default();
    let feature = FEATURES.iter().find(|feature| feature.name == name);
    let feature = feature.ok_or_else(|| format!("{FORM}; there is no feature \"{name}\""))?;
    let reaction = parts.next().filter(|reaction| REACTIONS.contains(reaction));
    let reaction = reaction.ok_or_else(|| format!("{FORM}; reactions: {REACTIONS:?}"))?;
    let stops = parts.map(|stop| {
        let (stop, at) = stop.split_once(" at ")?;
        let stop = match stop {
            "Kill" => Stop::Kill,
            "PowerCut" => Stop::PowerCut,
            _ => return None,
        };
        Some((at.parse().ok()?, stop))
    });
    let stops: Vec<_> = stops.collect::<Option<_>>().ok_or(FORM)?;
    repeat(binary, feature, reaction, &stops)
}
