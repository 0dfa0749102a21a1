//! One fault in a random program: nothing is found in another line because of it, whether error or
//! remark.
use interp::{Dialect, check, example_setup, lint};
use std::fmt::Write;
use test_support::size;

/// Random numbers by a seed (Numerical Recipes' constants).
struct Draw(u64);

impl Draw {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }

    fn of<'t>(&mut self, texts: &[&'t str]) -> &'t str {
        texts[self.next(texts.len() as u64) as usize]
    }
}

const DIALECTS: [Dialect; 8] = [
    Dialect::LinuxCnc,
    Dialect::Grbl,
    Dialect::Brother,
    Dialect::Fanuc,
    Dialect::Haas,
    Dialect::Mitsubishi,
    Dialect::FanucLatheA,
    Dialect::HaasLathe,
];

fn is_fanuc(dialect: Dialect) -> bool {
    dialect.grammar() == gcode::Grammar::Fanuc
}

/// A good program: a head, blocks that can stand in any order, an end.
fn program(draw: &mut Draw, dialect: Dialect) -> Vec<String> {
    let lathe = dialect.has_turret();
    let mut lines: Vec<String> = Vec::new();
    if is_fanuc(dialect) {
        lines.push("O1000".into());
    }
    let head: &[&str] = if lathe {
        &["G21 G40", "T0101", "G97 S600 M3", "G0 X40. Z5.", "G1 Z4. F0.2"]
    } else {
        &["G21 G17 G90 G94", "T1 M6", "G43 H1", "S3000 M3", "G0 X1. Y2. Z50.", "G1 Z49. F300"]
    };
    lines.extend(head.iter().map(|line| (*line).to_owned()));
    for _ in 0..6 + draw.next(14) {
        let [a, b] = [draw.next(40), draw.next(40)].map(|n| n as f64 / 2.0 + 1.0);
        let mut line = String::new();
        let kind = draw.next(9);
        let _ = match (lathe, kind) {
            (_, 0) => write!(line, "M8"),
            (_, 1) => write!(line, "M9"),
            (true, 2 | 3) => write!(line, "G0 X{:.1} Z{:.1}", 2.0 * a, b),
            (true, 4) => write!(line, "G55"),
            (true, 5) => write!(line, "G54"),
            (true, _) => write!(line, "G1 X{:.1} Z{:.1} F0.25", 2.0 * a, b),
            (false, 2 | 3) => write!(line, "G0 X{a:.1} Y{b:.1}"),
            (false, 4) => write!(line, "G1 X{a:.1} Y{b:.1} F250"),
            (false, 5) => write!(line, "G2 X{a:.1} Y{b:.1} R500."),
            (false, 6) => write!(line, "G3 X{a:.1} Y{b:.1} R400."),
            (false, 7) => write!(line, "G99 G81 X{a:.1} Y{b:.1} Z45. R49. F100"),
            (false, _) => write!(line, "G80 G0 X{a:.1}"),
        };
        // an arc of no length is none
        let twice = lines.last().is_some_and(|before| before.get(3..) == line.get(3..));
        if line.starts_with("G2") || line.starts_with("G3") {
            lines.push(format!("G0 X{:.1} Y{:.1}", a + 3.0, b + 2.0));
        }
        if !twice {
            lines.push(line);
        }
    }
    if !lathe {
        lines.push("G80 G0 Z60.".into());
    }
    lines.push("M5".into());
    lines.push("M30".into());
    lines
}

/// Blocks that are wrong wherever they stand, or in these dialects.
fn faults(dialect: Dialect) -> Vec<&'static str> {
    let mut all = vec![
        "G999",
        "G0 X1. ?",
        "G0 X",
        "G0 X1. X2.",
        "G0 X1. F-5",
        "S-100 M3",
        "M777",
        "G0 G1 X1. M3 M4",
        "N-5 G0 X1.",
        "G28.7",
        "G0 X1. Y",
        "T1.5",
        "G1 X1. F",
        "M3 M5",
        "G4",
        "G0 X1..5",
        "G0 X--1.",
        "G12345",
        "M3.7",
        "G54 G55 G56",
        "G1 X1. F1e",
        "G81.7 X1.",
        "X1. G",
        "M",
        "G41 D",
        "S",
    ];
    if is_fanuc(dialect) {
        all.extend([
            "M98 P7777",
            "G65 P7777",
            "GOTO 7777",
            "#1=[1",
            "#1=1/0",
            "IF[#1EQ1GOTO5",
            "WHILE[1EQ1DO1",
            "G10 L2 P99 X1.",
            "G54.1 P999",
            "G65",
            "M98",
            "G0 X#[0-1]",
            "#999999=1",
        ]);
    } else {
        all.extend([
            "G0 X[1/0]",
            "G92",
            "G53 G2 X1. Y1. I1.",
            "#1=[1",
            "G0 X[1",
            "G38.2",
            "G10 L2 P99 X1.",
            "G64 P-1.",
            "G2 X9. Y9. R0.001",
            "G0 X#<nothing>",
            "M98 P7777",
            "G52 G92 X1.",
            "G0 X[SQRT[0-1]]",
        ]);
    }
    if !dialect.has_turret() {
        all.extend(["G2 X7. Y9. R0.01", "G2 R5.", "G17 G18 G19"]);
    }
    all
}

/// What spoils a block that is good without it.
const SPOILS: [&str; 12] = [
    "G999", "?", "X", "M777", "F-5", "G0 G1 G2", "S-1", "T1.5", "#1=[1", "Q..5", "Y1 Y2",
    "M3 M4 M5",
];
/// It looks like a program of another dialect.
const OTHER_DIALECT: &str = "I0909";

/// Line, code and sentence of all that is found.
fn found(lines: &[String], dialect: Dialect) -> Vec<(u32, &'static str, String)> {
    let text = lines.join("\n") + "\n";
    let setup = example_setup(dialect);
    let all = check(text.as_bytes(), &setup).into_iter().chain(lint(text.as_bytes(), &setup));
    let mut all: Vec<_> = all.map(|d| (d.span.line, d.code, d.message)).collect();
    all.sort();
    all.dedup();
    all
}

#[test]
fn nothing_is_found_in_another_line_because_of_one_fault() {
    let mut wrong = Vec::new();
    for seed in 0..size::of(12_u64, 400) {
        for dialect in DIALECTS {
            let mut draw = Draw(seed * 977 + dialect.name().len() as u64);
            let lines = program(&mut draw, dialect);
            let good = found(&lines, dialect);
            assert!(
                good.iter().all(|(_, code, _)| !code.starts_with('P')),
                "{}: {good:?}\n{}",
                dialect.name(),
                lines.join("\n")
            );
            let first = usize::from(is_fanuc(dialect));
            for _ in 0..8 {
                let all = faults(dialect);
                let fault = draw.of(&all);
                let at = first + draw.next((lines.len() - 1 - first) as u64) as usize;
                let mut broken = lines.clone();
                let spoils = draw.next(2) == 0;
                let fault = if spoils {
                    let spoilt = format!("{} {}", broken[at], draw.of(&SPOILS));
                    broken[at] = spoilt.clone();
                    spoilt
                } else {
                    broken.insert(at, fault.to_owned());
                    fault.to_owned()
                };
                let here = at as u32 + 1;
                let new: Vec<_> = found(&broken, dialect)
                    .into_iter()
                    .filter(|(line, code, text)| {
                        let before = if *line > here && !spoils { line - 1 } else { *line };
                        if *code == OTHER_DIALECT && text.contains(&format!("in line {here}")) {
                            return false; // it names the fault's line
                        }
                        let is_old = |old: &(u32, &str, String)| {
                            old.1 == *code && (old.0 == before || old.2 == *text)
                        };
                        *line != here && !good.iter().any(is_old)
                    })
                    .collect();
                if !new.is_empty() {
                    wrong.push(format!("{} `{fault}` in line {here}: {new:?}", dialect.name()));
                }
            }
        }
    }
    wrong.sort();
    wrong.dedup();
    assert!(wrong.is_empty(), "{} of them:\n{}", wrong.len(), wrong.join("\n"));
}
