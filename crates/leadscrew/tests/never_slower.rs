//! A path that may round its corners takes no longer than one that stops at each, nor than one that
//! may round them less.
use leadscrew::Program;
use test_support::size;

/// A curve in Y and Z as a CAM system writes it, in moves of very different lengths.
fn profile(seed: u64, moves: usize, mode: &str) -> String {
    let mut random = seed;
    let mut text = format!("G21 G90 G17 G94\n{mode}\nG0 X0 Y0 Z0\nF22500\n");
    let mut y = 0.0_f64;
    for _ in 0..moves {
        // Knuth's linear congruence
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        y += [0.02, 0.1, 0.25, 0.5, 1.0, 2.0][(random >> 33) as usize % 6];
        let z = 3.0 * (y / 4.0).sin() + 0.5 * (1.3 * y).sin();
        text += &format!("G1 Y{y:.3} Z{z:.3}\n");
    }
    text + "M2\n"
}

fn motion(text: &str, machine: &str) -> f64 {
    let mut job = Program::of("profile", text).on(machine).unwrap();
    job.time().unwrap().shares().motion().value()
}

#[test]
fn rounding_more_is_never_slower_than_rounding_less_or_stopping() {
    for machine in ["bench-xyz-jerk20", "bench-xyz"] {
        for seed in 1..=size::of(3, 60) {
            let time = |mode: &str| motion(&profile(seed, 90, mode), machine);
            let modes = ["G61", "G64 P0.0001", "G64 P0.001", "G64 P0.01", "G64 P0.1"];
            let times = modes.map(time);
            for (mode, pair) in modes.iter().skip(1).zip(times.windows(2)) {
                assert!(pair[1] <= pair[0] * 1.001, "{machine}, seed {seed}, {mode}: {times:?}");
            }
        }
    }
}
