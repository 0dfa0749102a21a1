//! Single block and more feed at any moment of a program with cycles, stops and joined paths: what
//! is planned anew is the same program.
use leadscrew::{Program, RunOptions};

/// A hole is drilled, and behind a stop a path that is rounded at its corners waits, then a tap.
const PROGRAM: &str = "G21 G17 G90 G54 G64 P0.02\nT2 M6\nG43 H2\nS6000 M3\nG0 X12 Y12 Z30\nG99 G81 X12 Y12 Z-24 R2 F900\n\
    G0 X20 Y20\nM1\nG0 Z50\nG0 X0 Y0\nG1 X5 Y0 F2000\nG1 X5 Y5\nG0 Z60\nT3 M6\nG43 H3\nS2000 M3\nG0 X12 Y12 Z30\n\
    G99 G84 X12 Y12 Z-15 R5 F2000\nG80 G0 Z80\nM30\n";

#[test]
fn a_program_that_is_held_after_each_line_and_hurried_on_is_cut_as_it_is_written() {
    for moment in [1.0, 1.45, 2.0, 2.5, 2.9, 3.3, 3.7, 4.4] {
        let operator = [
            "override 14 at 0.3s".to_owned(),
            format!("single-block on at {moment}s"),
            format!("override 197 at {}s", moment + 0.3),
            format!("single-block off at {}s", moment + 9.0),
            format!("resume at {}s", moment + 9.1),
        ];
        let options = RunOptions { operator: operator.to_vec(), ..RunOptions::default() };
        let job = Program::of("part", PROGRAM).on("tapping-center").unwrap();
        let finished = job.run(&options).unwrap();
        let outcome = &finished.outcome;
        assert!(outcome.ended, "{moment}: {:?} {:?}", outcome.faults, outcome.broke_off);
        let wrong: Vec<_> = outcome.features.iter().filter(|f| !f.verdict.is_pass()).collect();
        assert!(wrong.is_empty() && outcome.features.len() == 2, "{moment}: {wrong:?}");
    }
}

/// Rows over a wave, as a CAM system writes a surface.
fn rows() -> String {
    let mut text = "G21 G90 G17 G94 G64 P0.01\nG0 X0 Y0 Z0\nF4718\n".to_owned();
    for row in 0..4 {
        for k in 0..64 {
            let k = if row % 2 == 0 { k } else { 63 - k };
            let (x, y) = (0.4708 * f64::from(k), 0.5 * f64::from(row));
            let z = (x / 3.0).sin() + 0.3 * (2.1 * x + f64::from(row)).sin();
            text += &format!("G1 X{x:.4} Y{y:.4} Z{z:.4}\n");
        }
    }
    text + "M2\n"
}

#[test]
fn a_surface_that_is_held_twice_at_its_lines_and_hurried_on_is_followed_to_its_end() {
    for (second, hurry) in [(7.12, 11.0), (7.12, 12.25), (5.3, 9.0), (3.0, 14.0)] {
        let operator = [
            "single-block on at 2.0747s".to_owned(),
            "single-block off at 2.2747s".to_owned(),
            "resume at 2.2847s".to_owned(),
            format!("single-block on at {second}s"),
            format!("single-block off at {}s", second + 0.2),
            format!("resume at {}s", second + 1.0),
            format!("override 120 at {hurry}s"),
        ];
        let options = RunOptions { operator: operator.to_vec(), ..RunOptions::default() };
        let job = Program::of("rows", rows()).on("bench-xyz-jerk20").unwrap();
        let outcome = job.run(&options).unwrap().outcome;
        assert!(outcome.ended, "{second}, {hurry}: {:?} {:?}", outcome.faults, outcome.broke_off);
    }
}
