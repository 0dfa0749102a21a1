//! One mistake in a program is told once, where it is: nothing that follows it is condemned on its
//! behalf.
use interp::{Dialect, check, example_setup};
use proptest::prelude::*;
use test_support::size;

/// Programs without an error. T1 is an end mill of 10 mm, T2 a tap M6.
const PROGRAMS: &[(Dialect, &str)] = &[
    (
        Dialect::LinuxCnc,
        "G21 G17 G90 G94\nT1 M6\nG43 H1\nS3000 M3\nG0 X-20 Y-20\nG0 Z2\nG1 Z-2 F200\nG41 D1 G1 X0 Y-10\nG1 Y40\nG2 X10 Y50 I10 J0\nG1 X60\nG2 X70 Y40 I0 J-10\nG1 Y10\nG2 X60 Y0 I-10 J0\nG1 X-15\nG40 G0 X-40 Y-20\nG0 Z20\nM5\nM2\n",
    ),
    (
        Dialect::LinuxCnc,
        "G21 G17 G90\nT2 M6\nG43\nS600 M3\nF600\nG0 X0 Y0 Z5\nG84 X10 Y10 Z-10 R2\nX20\nX30\nY20\nG80\nT1 M6\nG43\nS2000 M3\nG0 X0 Y0 Z10\nG81 X5 Y5 Z-4 R2 F100\nX15\nX25\nG80\nG0 Z20\nM2\n",
    ),
    (
        Dialect::LinuxCnc,
        "G21 G90\n#1=10\n#<depth>=3\nG0 X#1 Y0 Z5\nF100\nS500 M3\nG1 Z[-#<depth>]\nG3 X[#1+10] Y0 I5\nG1 X40\nG91\nG2 X5 Y5 I5\nG1 X10\nG3 X5 Y-5 J-5\nG90\nG0 Z5\nG0 X0\nM2\n",
    ),
    (
        Dialect::LinuxCnc,
        "o<arc> sub\nG2 X[#1+4] Y0 I2\no<arc> endsub\nG21 G90\nG0 X0 Y0 Z1\nF300 S100 M3\no<arc> call [0]\no<arc> call [4]\nG1 X20\nG54\nG3 X30 Y10 R10\nG1 Y20\nG18\nG2 X34 Z5 R4\nG17\nG0 X0\nM2\n",
    ),
    (
        Dialect::Brother,
        "G90 G54\nG100 T2 X10 Y10 G43 Z30 H2 S3000\nG77 X10 Y10 Z-15 R2 I1 S3000 L6000\nX20\nX30\nG80\nG100 T1 X0 Y0 G43 Z10 H1 S5000 M3\nG81 X0 Y0 Z-10 R2 F500\nX20\nG80\nG1 X40 F500\nG2 X50 I5\nG0 Z30\nM30\n",
    ),
    (
        Dialect::Fanuc,
        "O1000\nG21 G17 G40 G49 G80 G90 G94\nT1 M6\nG54 G0 X-20. Y-20.\nG43 Z5. H1\nS3000 M3\nG1 Z-2. F200\nG41 D1 X0. Y-10.\nY40.\nG2 X10. Y50. I10. J0.\nG1 X60.\nG3 X70. Y60. I0. J10.\nG1 Y80.\nG40 X90.\nG0 Z20.\n#1=5.\nG0 X#1\nG81 X10. Y10. Z-4. R2. F100\nX20.\nX30.\nG80\nM30\n",
    ),
    (
        Dialect::Fanuc,
        "O2000\nG21 G17 G40 G49 G80 G90 G94\nT1 M6\nG54.1 P2\nG0 X0. Y0.\nG43 Z5. H1\nS3000 M3\nG68 X0. Y0. R30.\nG0 X10. Y0.\nG1 Z-1. F200\nG2 X20. Y0. R5.\nG1 X30.\nG69\nG0 Z5.\nG51 X0. Y0. P2000\nG0 X5. Y5.\nG1 X10.\nG3 X15. Y10. J5.\nG50\nM98 P2001\nG1 X90.\nM30\nO2001\nG91 G1 X5.\nG2 X2. Y2. I2.\nG90\nM99\n",
    ),
    (
        Dialect::FanucLatheA,
        "O3000\nG21 G18 G40 G99\nG50 S2000\nT0101\nG97 S600 M3\nG0 X40. Z5.\nG1 Z-10. F0.2\nG2 X44. Z-12. R2.\nG1 X50.\nG0 X40. Z5.\nG92 X38. Z-20. F1.5\nX37.\nX36.5\nG0 X60.\nG71 U2. R1.\nG71 P10 Q20 U0.5 W0.1 F0.3\nN10 G0 X20.\nG1 Z-20.\nN20 X50.\nG70 P10 Q20\nG0 X100. Z100.\nM5\nM30\n",
    ),
    (
        Dialect::LinuxCnc,
        "G20 G17 G90\nT1 M6\nG43 H1\nS1000 M3\nG0 X0 Y0 Z1\nF10\nG92 X0 Y0\nG1 X1\nG10 L2 P1 X0.5\nG1 X1 Y0\nG2 X2 Y1 I1 J0\nG92.1\nG52 X0\nG0 X0 Y0\nG41.1 D0.25 G1 X1 Y0\nX3\nY2\nG3 X2 Y3 I-1\nG1 X0\nG40 Y5\nG95 F0.01\nG1 X1\nG94 F10\nG64 P0.001\nG5 X2 Y6 I0.2 J0.2 P-0.2 Q-0.2\nG1 X5\nG82 X6 Y6 Z-1 R0.1 P0.5\nX7\nG80\nM2\n",
    ),
];

fn errors(text: &str, dialect: Dialect) -> Vec<(u32, &'static str, String)> {
    let found = check(text.as_bytes(), &example_setup(dialect));
    found
        .into_iter()
        .filter(diag::Diagnostic::is_error)
        .map(|d| (d.span.line, d.code, d.message))
        .collect()
}

/// What becomes of a line.
#[derive(Clone, Copy, Debug)]
enum Mistake {
    UnknownCode,
    Garbage,
    NoNumber,
    TwoOfALetter,
    DivisionByZero,
    OffsetOutOfRange,
    NegativeFeed,
    UnknownTool,
    /// The n-th word is missing.
    Missing(usize),
}

impl Mistake {
    fn apply(self, line: &str) -> Option<String> {
        let words: Vec<_> = line.split(' ').collect();
        Some(match self {
            Self::UnknownCode => format!("{line} G999"),
            Self::Garbage => format!("{line} ?"),
            Self::NoNumber => format!("{line} X"),
            Self::TwoOfALetter if line.contains('X') => format!("{line} X1"),
            Self::DivisionByZero => {
                let i = words.iter().position(|w| w.starts_with(['X', 'Y', 'Z', 'F', 'S']))?;
                let computed = format!("{}[1/0]", &words[i][..1]);
                words
                    .iter()
                    .enumerate()
                    .map(|(j, w)| if i == j { &*computed } else { w })
                    .collect::<Vec<_>>()
                    .join(" ")
            }
            Self::OffsetOutOfRange if line.contains("D1") => line.replace("D1", "D99"),
            Self::NegativeFeed if line.contains('F') => line.replace('F', "F-"),
            Self::UnknownTool => ["T1", "T2"]
                .into_iter()
                .find(|t| line.contains(t))
                .map(|t| line.replace(t, "T99"))?,
            Self::Missing(n) if words.len() > 1 => {
                let n = n % words.len();
                words
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| *i != n)
                    .map(|(_, w)| *w)
                    .collect::<Vec<_>>()
                    .join(" ")
            }
            _ => return None,
        })
    }

    /// Whether the line itself is what is told.
    fn is_in_the_line(self) -> bool {
        !matches!(self, Self::Missing(_))
    }
}

fn mistake() -> impl Strategy<Value = Mistake> {
    use Mistake::*;
    prop_oneof![
        2 => Just(UnknownCode),
        1 => Just(Garbage),
        1 => Just(NoNumber),
        1 => Just(TwoOfALetter),
        2 => Just(DivisionByZero),
        2 => Just(OffsetOutOfRange),
        2 => Just(NegativeFeed),
        2 => Just(UnknownTool),
        6 => (0usize..8).prop_map(Missing),
    ]
}

#[test]
fn the_programs_have_no_error() {
    for (dialect, text) in PROGRAMS {
        assert_eq!(errors(text, *dialect), [], "{text}");
    }
}

/// Every mistake in every line of every program.
#[test]
fn one_mistake_is_one_error_at_most_and_in_its_line() {
    let mut wrong = Vec::new();
    let mut mistakes = vec![
        Mistake::UnknownCode,
        Mistake::Garbage,
        Mistake::NoNumber,
        Mistake::TwoOfALetter,
        Mistake::DivisionByZero,
        Mistake::OffsetOutOfRange,
        Mistake::NegativeFeed,
        Mistake::UnknownTool,
    ];
    mistakes.extend((0..8).map(Mistake::Missing));
    for (dialect, text) in PROGRAMS {
        let lines: Vec<_> = text.lines().collect();
        for n in 0..lines.len() {
            if lines[n].starts_with(['o', 'O']) || ["M2", "M30", "M99"].contains(&lines[n]) {
                continue; // what frames a program is told where it ends
            }
            for mistake in &mistakes {
                let Some(broken) = mistake.apply(lines[n]) else { continue };
                let mut all = lines.clone();
                all[n] = &broken;
                let found = errors(&(all.join("\n") + "\n"), *dialect);
                let elsewhere = mistake.is_in_the_line()
                    && found.iter().any(|(line, ..)| *line != n as u32 + 1);
                if found.len() > 1 || elsewhere {
                    wrong.push(format!(
                        "{} line {}: `{}` became `{broken}`: {found:?}",
                        dialect.name(),
                        n + 1,
                        lines[n]
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of them:\n{}", wrong.len(), wrong.join("\n"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(150, 1500), failure_persistence: None, ..ProptestConfig::default() })]

    /// Several mistakes: no more errors than mistakes.
    #[test]
    fn there_are_no_more_errors_than_mistakes(
        which in 0..PROGRAMS.len(),
        made in prop::collection::vec((0.0..1.0f64, mistake()), 1..5),
    ) {
        let (dialect, text) = PROGRAMS[which];
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut count = 0;
        for (place, mistake) in &made {
            let n = (place * lines.len() as f64) as usize;
            if lines[n].starts_with(['o', 'O']) || ["M2", "M30", "M99"].contains(&&*lines[n]) {
                continue;
            }
            if let Some(broken) = mistake.apply(&lines[n]) {
                lines[n] = broken;
                count += 1;
            }
        }
        let found = errors(&(lines.join("\n") + "\n"), dialect);
        prop_assert!(found.len() <= count, "{} mistakes, {:#?}\n{}", count, found, lines.join("\n"));
    }
}

/// Whatever is wrong with a lead-in, the contour behind it is followed as if compensation were off.
#[test]
fn compensation_that_is_refused_is_followed_as_if_it_were_off() {
    let contour = "Y40\nG2 X10 Y50 I10 J0\nG1 X60\nG2 X62 Y48 I0 J-2\nG3 X64 Y46 I2 J0\nG1 Y10\nG40 G0 X-40\nG2 X-30 I5\nM2\n";
    for (lead_in, code) in [
        ("G0 X0 Y-2\nG41 D1 G1 X0 Y0 F100\n", "I0545"),
        ("G0 X0 Y-20\nG41 D99 G1 X0 Y0 F100\n", "I0611"),
        ("G0 X0 Y-20\nG19\nG41 D1 G1 X0 Y0 F100\nG17\n", "I0541"),
        ("G0 X0 Y-20\nG41.1 G1 X0 Y0 F100\n", "I0542"),
        ("F100\nG0 X0 Y-1\nG41 D1\nG3 X-0.01 Y0 R50\nG1 X0 Y0.5\n", "I0547"),
    ] {
        let text = format!("G21 G90 G17\nT1 M6\nS1000 M3\n{lead_in}{contour}");
        let found = errors(&text, Dialect::LinuxCnc);
        let codes: Vec<_> = found.iter().map(|(_, code, _)| *code).collect();
        assert_eq!(codes, [code], "{lead_in}: {found:?}");
    }
}

/// Each line has its own mistake, and each is told.
#[test]
fn mistakes_that_have_nothing_to_do_with_one_another_are_all_told() {
    let text = "G21 G90\nG0 X1 Q5\nG0 X2 Q5\nG1 X3 F-1\nF100\nG1 X4 G999\nG2 X9 Y0 I1 J0\nG3 X12 Y0 I1.5\nG4 P-1\nG0 X1 X2\nT77 M6\nM2\n";
    let lines: Vec<_> = errors(text, Dialect::LinuxCnc).iter().map(|(line, ..)| *line).collect();
    assert_eq!(lines, [2, 3, 4, 6, 7, 9, 10, 11]);
}
