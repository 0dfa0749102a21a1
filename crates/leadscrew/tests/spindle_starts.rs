//! Spindles that start late, scatter or are stopped and turned to an angle are answered: no encoder
//! of a healthy machine is taken for one that is stuck.
use kernel::FaultKind;
use leadscrew::{Program, RunOptions};
use test_support::size;

/// Starts both ways, slow and fast, standstill, and what ties an axis to the spindle.
const STARTS: [(&str, &[&str], &str); 3] = [
    (
        "M3, M4, M19",
        &[
            "tapping-center",
            "tapping-center-scale",
            "tapping-center-shop",
            "machining-center",
            "mill-5-axis",
            "portal-mill",
            "vfd-mill",
            "bench-xyz",
            "bench-xyz-jerk20",
            "lathe",
            "lathe-chuck-zero",
            "polygon-lathe",
            "gear-hobber",
        ],
        "G21 G90 G94\nM3 S20\nG4 P0.3\nM4 S300\nG4 P0.3\nM5\nG4 P1.5\nM19 R47.3\nG4 P1\nM19 R200\nM3 S900\nG4 P0.2\nM4 S200\nM5\nM2\n",
    ),
    (
        "G84",
        &[
            "tapping-center",
            "tapping-center-scale",
            "tapping-center-shop",
            "vfd-mill",
            "portal-mill",
        ],
        "G21 G90 G94 G54\nT3 M6\nG43 H3\nS600 M3\nG0 X12 Y12 Z30\nG99 G84 Z-12 R5 P0.2 F600\nX20\nG80\nG0 Z50\nM30\n",
    ),
    (
        "G33",
        &["lathe", "lathe-chuck-zero"],
        "G21 G18 G90 G94 G8\nT32 M6\nG43 H32\nS300 M3\nG0 X11 Y0 Z6\nX9.8\nG33 Z-15 K1.5\nG0 X11\nZ6\nX9.5\nG33 Z-15 K1.5\nG0 X30\nM2\n",
    ),
];

#[test]
fn no_spindle_that_starts_turns_or_stands_is_taken_for_one_whose_encoder_is_stuck() {
    let seeds = size::of(1, 40);
    let (mut runs, mut wrong) = (0, Vec::new());
    for (name, machines, text) in STARTS {
        let mut ran = 0;
        for (number, machine) in machines.iter().enumerate() {
            for seed in 1..=seeds {
                let seed = seed + if size::is_full() { 0 } else { number as u64 };
                let job = match Program::of(name, text).on(*machine) {
                    Ok(job) => job,
                    Err(why) => {
                        println!("{name} on {machine}: {why}");
                        continue;
                    }
                };
                let options = RunOptions { seed: Some(seed), ..RunOptions::default() };
                let Ok(finished) = job.run(&options) else {
                    println!("{name} on {machine} is refused");
                    continue;
                };
                ran += 1;
                for fault in &finished.outcome.faults {
                    println!("{name} on {machine}, seed {seed}: {fault}");
                    if fault.kind == FaultKind::ReadingImplausible {
                        wrong.push(format!("{name} on {machine}, seed {seed}: {fault}"));
                    }
                }
            }
        }
        assert!(ran > 0, "{name} ran nowhere");
        runs += ran;
    }
    println!("{runs} runs");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
