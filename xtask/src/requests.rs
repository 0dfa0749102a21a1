//! `cargo xtask requests`: random sequences of requests to a control on its simulated machine.
use test_support::requests::{PROGRAM, Tally, sequence};

/// Run sequences with seeds from `first` on; what they met, or the first that broke a rule.
///
/// # Errors
/// The seeds of the sequences that broke a rule, each with the rule.
pub(crate) fn run(count: u64, first: u64) -> Result<bool, String> {
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let program = folder.path().join("part.ngc");
    std::fs::write(&program, PROGRAM).map_err(|e| e.to_string())?;
    let mut tally = Tally::default();
    let mut broken = Vec::new();
    for seed in first..first + count {
        if let Err(why) = sequence(seed, &program, &mut tally) {
            println!("{why}");
            broken.push(why);
        }
        if (seed - first) % 500 == 499 {
            println!("{} sequences, {} broke a rule", seed - first + 1, broken.len());
        }
    }
    println!(
        "{} sequences: {} requests accepted, {} refused, {:.0} s of machine time, {} alarms, {} features",
        count, tally.accepted, tally.refused, tally.machine_s, tally.alarms, tally.features
    );
    Ok(broken.is_empty())
}
