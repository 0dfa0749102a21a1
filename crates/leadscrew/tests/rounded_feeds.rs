//! Leads of taps as posts write them: what a check lets pass comes out good.
use leadscrew::{Ending, Program, RunOptions};
use test_support::{Dice, size};

/// Taps of the shipped table: their number, their drill's, their lead and the depth of a thread.
const TAPS: [(u32, u32, f64, f64); 5] = [
    (3, 2, 1.0, 12.0),
    (7, 5, 1.5, 18.0),
    (9, 8, 1.27, 15.0),
    (11, 10, 1.25, 16.0),
    (14, 2, 1.0, 12.0),
];
/// A clutch holder gives: its tap may be fed by up to 1 % more or less.
const CLUTCH: (u32, u32, f64, f64) = (13, 2, 1.0, 12.0);

/// How a program says a lead.
#[derive(Clone, Copy, Debug)]
enum Word {
    PerMinute,
    PerTurn,
    Lead,
}

/// A program of one hole, drilled and tapped, with this word as it is written.
fn program(
    inch: bool,
    (tap, drill, depth): (u32, u32, f64),
    rpm: f64,
    (word, value): (Word, &str),
) -> String {
    let unit = if inch { 25.4 } else { 1.0 };
    let at = |mm: f64| format!("{:.4}", mm / unit);
    let (clear, high, bottom) = (at(5.0), at(40.0), at(-depth));
    let place = format!("G0 X{} Y{} Z{high}\n", at(12.0), at(12.0));
    let tapped = match word {
        Word::PerMinute => format!("G99 G84 Z{bottom} R{clear} F{value}\nG80\n"),
        Word::PerTurn => format!("G95 G99 G84 Z{bottom} R{clear} F{value}\nG80\n"),
        Word::Lead => format!("G0 Z{clear}\nG33.1 Z{bottom} K{value}\n"),
    };
    format!(
        "{} G90 G54 G94\nT{drill} M6\nG43 H{drill}\nS3000 M3\n{place}G99 G83 Z{} R{} Q{} F{}\nG80\nT{tap} M6\nG43 H{tap}\n\
         S{rpm} M3\n{place}{tapped}G0 Z{high}\nM2\n",
        if inch { "G20" } else { "G21" },
        at(-depth - 8.0),
        at(2.0),
        at(5.0),
        at(300.0)
    )
}

#[test]
fn what_a_check_lets_pass_comes_out_good_however_its_lead_is_rounded() {
    let mut dice = Dice(55);
    let (mut good, mut refused) = (0, 0);
    for _ in 0..size::of(24, 600) {
        let (tap, drill, lead, depth) = if dice.chance(0.1) { CLUTCH } else { *dice.one_of(&TAPS) };
        let depth = depth * dice.one_of(&[1.0, 0.7, 0.4]);
        let rpm = if dice.chance(0.5) {
            *dice.one_of(&[200.0, 350.0, 500.0, 640.0, 900.0, 1000.0])
        } else {
            dice.between(100.0, 1500.0).round()
        };
        let inch = dice.chance(0.5);
        let words = [Word::PerMinute, Word::PerMinute, Word::PerTurn, Word::Lead];
        let word = if tap == CLUTCH.0 { Word::PerMinute } else { *dice.one_of(&words) };
        let exact = match word {
            Word::PerMinute => lead * rpm,
            Word::PerTurn | Word::Lead => lead,
        } / if inch { 25.4 } else { 1.0 };
        let slip = *dice.one_of(&[0.0, 0.0, 0.0005, 0.003, 0.012]);
        let digits = *dice.one_of(&[0, 1, 2, 3, 4]);
        let value = format!("{:.digits$}", exact * (1.0 + dice.between(-slip, slip)));
        if value.parse::<f64>().unwrap() == 0.0 {
            continue;
        }
        let text = program(inch, (tap, drill, depth), rpm, (word, &value));
        let mut job = Program::of("rounded", text.clone()).on("tapping-center").unwrap();
        let errors = job.check().iter().any(diag::Diagnostic::is_error);
        if let Ok(finished) = job.run(&RunOptions::default()) {
            let is_good = !errors && finished.ending() == Ending::Good;
            assert!(is_good, "{exact}:\n{text}{:#?}", finished.features());
            good += 1;
        } else {
            assert!(errors, "{exact}:\n{text}");
            refused += 1;
        }
    }
    println!("{good} good, {refused} refused");
    assert!(good > 5 && refused > 2, "{good} good, {refused} refused");
}
