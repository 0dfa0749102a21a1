//! Tapping programs at random; `cargo xtask random-taps` runs as many as one likes.
#[path = "../../../xtask/src/random_taps/mod.rs"]
mod trial;
use std::path::Path;

#[test]
fn sixty_tapping_programs_at_random_are_good_or_refused_before_motion() {
    let binary = Path::new(env!("CARGO_BIN_EXE_leadscrew"));
    let tally = trial::trials(binary, 60, 7, |_| {});
    println!("{}", tally.text(60, 7));
    assert!(tally.violations == 0 && tally.broken.is_empty(), "{}", tally.broken.join("\n\n"));
    assert!(tally.good >= 40, "most are sound: {} good, {:?}", tally.good, tally.codes);
    assert!(tally.refused >= 3, "some are mistaken: {} refused", tally.refused);
}
