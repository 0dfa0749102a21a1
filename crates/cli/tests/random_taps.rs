//! Tapping programs at random; `cargo xtask random-taps` runs as many as one likes.
#[path = "../../../xtask/src/random_taps/mod.rs"]
mod trial;
use std::path::Path;
use test_support::size;

#[test]
fn tapping_programs_at_random_are_good_or_refused_before_motion() {
    let binary = Path::new(env!("CARGO_BIN_EXE_leadscrew"));
    let count = size::of(12, 600);
    let tally = trial::trials(binary, count, 7, |_| {});
    println!("{}", tally.text(count, 7));
    assert!(tally.violations == 0 && tally.broken.is_empty(), "{}", tally.broken.join("\n\n"));
    assert!(3 * tally.good >= 2 * count, "most are sound: {} good, {:?}", tally.good, tally.codes);
    assert!(20 * tally.refused >= count, "some are mistaken: {} refused", tally.refused);
}
