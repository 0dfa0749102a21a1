//! A run that is held and that nobody resumes ends and says so, whatever it was at.
use leadscrew::{Program, RunOptions};
use test_support::size;

/// Moves, dwells, cycles, spindles that start, turn to an angle or drive a gear, threads, waits.
const PROGRAMS: [(&str, &str, f64, &str); 6] = [
    (
        "holes",
        "tapping-center",
        9.0,
        "G21 G17 G90 G54 G64 P0.02\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G83 X12 Y12 Z-24 R2 Q8 F900\nG0 X20 Y20\n\
         G4 P0.3\nM19 R90\nG0 X0 Y0\nG1 X5 Y0 F2000\nG1 X5 Y5\nG2 X9 Y9 I2 J2\nG0 Z60\nT3 M6\nG43 H3\nS2000 M3\nG0 X12 Y12 Z30\n\
         G99 G84 X12 Y12 Z-15 R5 F2000\nG80 G0 Z80\nM30\n",
    ),
    (
        "G76",
        "lathe",
        12.0,
        "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS1000 M3\nG0 X11 Y0 Z6\nG76 P1.5 Z-15 I-1 J0.4 K0.985 R1.5 Q29.5 H1 E1.5 L2\nG0 X30\nM2\n",
    ),
    (
        "gear",
        "gear-hobber",
        14.0,
        "(GEAR WIDTH 20)\nG21 G90 G94 G17\nT23 M6\nG43 H23\nG0 X110 Y0 Z5\nM3 S300\nG81 T40 L1 Q2 P20\nG0 X75.067\nG1 Z-3 F15\nG0 X110\nG80\nM5\nG0 Z100\nM30\n",
    ),
    (
        "polygon",
        "polygon-lathe",
        14.0,
        "G21 G90 G94 G17\nT21 M6\nG43 H21\nG0 X75 Y0 Z5\nM3 S500\nG51.2 P1 Q2 R0 D0\nG0 X58.5 Z2\nG1 Z-5 F50\nG0 X75\nG50.2\nM5\nG0 Z100\nM30\n",
    ),
    (
        "blocks",
        "tapping-center",
        6.0,
        "G21 G90 G54\nG61.1\nG0 X0\nX1\nX2\nX3\nM3 S1000\nX4\nM5\nG1 F500 X5\nX6\nM8\nX7\nM9\nG4 P0.1\nX8\nM30\n",
    ),
    (
        "probe",
        "tapping-center",
        6.0,
        "G21 G90 G54 G94\nG0 Z40\nG38.3 Z30 F300\nG0 Z40\nX1\nG38.3 Z30\nM30\n",
    ),
];

fn ended_by(program: &(&str, &str, f64, &str), order: &str) -> (bool, String) {
    let (name, machine, _, text) = *program;
    let options = RunOptions { operator: vec![order.to_owned()], ..RunOptions::default() };
    let job = Program::of(name, text).on(machine).unwrap();
    let outcome = job.run(&options).unwrap().outcome;
    assert!(outcome.faults.is_empty(), "{name}, {order}: {:?}", outcome.faults);
    (outcome.ended, outcome.broke_off.join("\n"))
}

#[test]
fn a_run_that_nobody_resumes_says_that_it_is_held_at_whatever_moment_it_was() {
    let count = size::of(3, 60);
    let (mut held, mut after_a_block) = (0, 0);
    for program in &PROGRAMS {
        for number in 0..count {
            // never at the same share of a period
            let at = program.2 * (f64::from(number) + 0.37) / f64::from(count);
            for order in [format!("hold at {at:.4}s"), format!("single-block on at {at:.4}s")] {
                let (is_at_end, said) = ended_by(program, &order);
                let is_said = said.contains("and nobody resumes it: --operator \"resume at ");
                assert_ne!(is_at_end, is_said, "{}, {order}: {said:?}", program.0);
                held += usize::from(is_said);
                after_a_block += usize::from(said.contains("held after a block at"));
            }
        }
    }
    assert!(held > PROGRAMS.len() && after_a_block > 1, "{held}, {after_a_block}");
}
