//! `check` and `run` say the same of a mill: of a rapid into the stock, and of a spindle without a
//! tool.
use std::{
    fs,
    process::{Command, Output},
};

/// The tool table beside the program.
const TOOLS: &str = r#"
[[tool]]
number = 8
pocket = 8
kind = "end-mill"
description = "end mill 10 mm"
diameter_mm = 10.0
length_mm = 100.0
form = "flat"
teeth = 2
"#;

/// What a command says of a program, and its exit code.
fn of(command: &str, program: &str, words: &[&str]) -> (String, Option<i32>) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.ngc"), program).unwrap();
    fs::write(folder.path().join("tools.toml"), TOOLS).unwrap();
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .args([command, "part.ngc"])
        .args(words)
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&stdout).into_owned() + &String::from_utf8_lossy(&stderr);
    (text, status.code())
}

/// A slot without M6; `call` is how the tool is called.
fn slot(call: &str, unit: &str) -> String {
    format!(
        "(STOCK X0 Y0 Z-20 X100 Y60 Z0)\n{call}\n{unit} G90 G54 S3000 M3\nG0 X10 Y10\nZ5\nG1 Z1 F200\nX40\nG0 Z50\nM2\n"
    )
}

#[test]
fn a_selected_tool_that_m6_has_not_brought_is_missed_by_check_and_not_judged_by_run() {
    let fanuc = ["--dialect", "fanuc", "--decimal-point", "calculator"];
    for (program, words) in [(slot("T8", "G21"), &[][..]), (slot("T8", "G21"), &fanuc)] {
        let program = if words.is_empty() { program } else { format!("O1\n{program}") };
        let line = 2 + u32::from(!words.is_empty());
        let missing = format!("line {line} selects T8, and no M6 brings it into the spindle");
        let (text, code) = of("check", &program, words);
        assert!(text.contains("M0373") && text.contains(&missing), "{text}");
        assert!(!text.contains("I0907"), "one finding for one mistake: {text}");
        assert_eq!(code, Some(0), "{text}");
        let (text, code) = of("run", &program, words);
        assert!(text.contains("NOT JUDGED: of 1 feature, 1 not judged"), "{text}");
        assert!(text.contains(&format!("nothing was cut: {missing}")), "{text}");
        assert_eq!(code, Some(1), "{text}");
    }
}

#[test]
fn a_tool_that_is_brought_or_not_called_or_clamped_by_hand_is_not_missing() {
    let honest = [
        (slot("T8 M6\nG43", "G21"), &[][..]),
        (slot("", "G21"), &[]),
        (slot("T8", "G21"), &["--dialect", "grbl"]),
    ];
    for (program, words) in honest {
        let (text, _) = of("check", &program, words);
        assert!(!text.contains("M0373"), "{program}{text}");
        let (text, _) = of("run", &program, words);
        assert!(!text.contains("no M6 brings"), "{program}{text}");
    }
}

/// Depth, unit, X, Y, Z and work offset of the first rapid into the stock that a text names.
fn rapid<'a>(text: &'a str, head: &str) -> ([f64; 4], [&'a str; 2]) {
    let head = format!("{head} takes T8 (an end mill) ");
    let (_, said) = text.split_once(&head).unwrap_or_else(|| panic!("no \"{head}\" in {text}"));
    let words: Vec<&str> = said.split_whitespace().take(10).collect();
    let [depth, unit, "into", "the", "stock", "at", x, y, z, "of"] = words[..] else {
        panic!("{words:?}")
    };
    let number = |word: &str| word.trim_start_matches(['X', 'Y', 'Z']).parse().unwrap();
    let (_, offset) = said.split_once(" of ").unwrap();
    ([depth, x, y, z].map(number), [unit, &offset[..3]])
}

#[test]
fn a_rapid_into_the_stock_is_said_in_the_same_words_in_the_programs_unit() {
    for (unit, place, within) in [("G21", "X40 Y20 Z-5", 0.02), ("G20", "X1.5 Y1 Z-0.2", 0.001)] {
        let [x, y, z] = place.split(' ').collect::<Vec<_>>()[..] else { panic!("{place}") };
        let program =
            format!("{unit} G90 G54\nT8 M6\nG43 H8\nS3000 M3\nG0 {x} {y}\nG0 {z}\nG0 Z2\nM2\n");
        let (checked, _) = of("check", &program, &[]);
        let (run, _) = of("run", &program, &[]);
        let (before, words) = rapid(&checked, "the rapid");
        let (after, said) = rapid(&run, "the rapid in line 6");
        assert_eq!(words, said, "{checked}{run}");
        // the axes really stand some micrometres off
        let near = before.iter().zip(after).all(|(a, b)| (a - b).abs() < within);
        assert!(near, "{checked}{run}");
    }
}
