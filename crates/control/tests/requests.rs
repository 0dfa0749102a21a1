//! Random sequences of requests: no forbidden transition, every limit kept, no jog beyond its
//! lease, no broken tap. `cargo xtask requests` runs ten thousand of them.
use test_support::requests::{PROGRAM, Tally, sequence};
use test_support::size;

/// Seeds that have broken a rule once: single block and more feed in a drilled hole while a joined
/// path waits (390, 453, 600, 1114, 1271, 1330), homing after an emergency stop in a cut (987). And
/// sequences that the rules themselves were wrong about: an axis without power that stands 2 µm
/// beyond its end (2698), a drill at four times its feed per turn (3262), an axis that was held
/// fast, after a reset (6466), a tap where the operator has left the hole half drilled (6865).
const FOUND: [u64; 11] = [390, 453, 600, 987, 1114, 1271, 1330, 2698, 3262, 6466, 6865];

#[test]
fn whatever_is_asked_for_in_whatever_order_the_machine_keeps_its_limits_and_the_tap_stays_whole() {
    let folder = tempfile::tempdir().expect("a folder for the program");
    let program = folder.path().join("part.ngc");
    std::fs::write(&program, PROGRAM).expect("the program can be written");
    let mut tally = Tally::default();
    for seed in (0..size::of(10, 1000)).chain(FOUND) {
        if let Err(why) = sequence(seed, &program, &mut tally) {
            panic!("{why}");
        }
    }
    // the sequences have met something
    assert!(
        tally.accepted > 8 * tally.sequences && tally.refused > 3 * tally.sequences,
        "{tally:?}"
    );
    assert!(tally.alarms > 0 && tally.features > 0, "{tally:?}");
}
