//! A wrong dialect is suspected and named, with its evidence; and never of a program that is read
//! as it was written.

use diag::Diagnostic;
use interp::{Dialect, Setup, other_dialect};
use std::{fs, path::Path};

const ALL: [Dialect; 9] = [
    Dialect::LinuxCnc,
    Dialect::Brother,
    Dialect::Fanuc,
    Dialect::Haas,
    Dialect::Mitsubishi,
    Dialect::FanucLatheA,
    Dialect::FanucLatheB,
    Dialect::FanucLatheC,
    Dialect::Toyoda,
];

fn suspected(text: &str, dialect: Dialect) -> Option<Diagnostic> {
    other_dialect(text.as_bytes(), &Setup { dialect, ..Setup::default() })
}

/// The dialect that the finding says to read it with.
fn named(text: &str, read_as: Dialect) -> Option<String> {
    let help = suspected(text, read_as)?.help.unwrap();
    let name = help.split("--dialect ").nth(1).unwrap();
    Some(name.split([',', ' ']).next().unwrap().to_owned())
}

/// Programs that a shop would run, and the dialect of each.
const PROGRAMS: [(Dialect, &str); 15] = [
    (Dialect::Fanuc, "%\nO1000\nT1 M6\nG43 H1 Z1.\nG83 Z-20. R2. P500. Q2. F20\nM30\n%\n"),
    (Dialect::Haas, "%\nO1000\nT1 M6\nG43 H1 Z1.\nG81 Z-0.5 R0.1 P0.5 F10.\nM30\n%\n"),
    (Dialect::Haas, "%\nO1000\nG154 P3\nG0 X0 Y0\nG13 I8. D1 F100.\nM97 P100\nM30\nN100 M99\n%\n"),
    (Dialect::Haas, "%\nO1000 (MADE FOR A HAAS VF-2)\nG90 G54 G0 X0 Y0\nM30\n%\n"),
    (Dialect::Mitsubishi, "O80\n#900001=5.\nM98 P2 H20\nM30\n"),
    (Dialect::Fanuc, "%\nO1000(COVER)\nG21G17G40G49G80G90\nT1M6\nG65P9100A1.B2.\nM30\n%\n"),
    (Dialect::Fanuc, "%\nO0012\nG90G54G0X0Y0\nG51X0Y0P2000\nG1X10.F100\nG50\nM30\n%\n"),
    (Dialect::Fanuc, "O1\n#1=0\nN10 #1=#1+1\nIF[#1LT5]GOTO10\nM30\n"),
    (Dialect::Fanuc, ":1001\nG0X1.\nM30\n"),
    (Dialect::Fanuc, "G0 X0 Y0\nG1 X10. ,R2. F100.\nY10.\nM30\n"),
    (
        Dialect::FanucLatheA,
        "O2\nG50 S2000\nT0101\nG96 S180 M3\nG0 X40. Z2.\nG71 U2. R1.\nG71 P10 Q20 U.4 W.1 F.3\nM30\n",
    ),
    (
        Dialect::Brother,
        "G90 G54\nG100 T2 X10. Y10. G43 Z50. H2\nG77 X10. Y10. Z-15. R2. I1. S3000\nG80\nM30\n",
    ),
    (
        Dialect::Brother,
        "T2 M6\nM3 S6000\nG43 H2 Z30\nG91 G81 X10 Z-54 R-28 F900 U2000 K2 E1\nM30\n",
    ),
    (Dialect::LinuxCnc, "o<hole> sub\nG1 Z#1 F100\no<hole> endsub\no<hole> call [-5]\nM2\n"),
    (
        Dialect::Toyoda,
        "G51 P1234\nG53 G04 S60 P4\nG55\nG50\nG01 X-0.1 F0.02 S60\nG04 S60 P2\nG51 P0\nM30\n",
    ),
];

#[test]
fn a_program_that_is_read_in_the_wrong_dialect_is_named_whichever_it_is() {
    for (written_for, text) in PROGRAMS {
        assert_eq!(
            named(text, written_for),
            None,
            "{} in its own dialect: {text}",
            written_for.name()
        );
        let cores = [Dialect::LinuxCnc, Dialect::Fanuc];
        for read_as in cores.into_iter().filter(|dialect| *dialect != written_for) {
            let name = named(text, read_as);
            assert_eq!(name.as_deref(), Some(written_for.name()), "as {}: {text}", read_as.name());
        }
    }
}

#[test]
fn the_finding_comes_first_with_its_evidence_and_says_what_follows_from_it() {
    let text =
        "%\nO1000\nG90 G54 G0 X0 Y0\nG1 Z-1. F100\nIF[#1 GT 5]GOTO20\nG65 P9100 A1. B2.\nM30\n%\n";
    let found = interp::check(text.as_bytes(), &Setup::default());
    let first = &found[0];
    assert_eq!(first.code, "I0909");
    assert!(first.is_error() && found.len() > 2, "{found:?}");
    for evidence in ["O1000 in line 2", "IF in line 5", "G65 in line 6"] {
        assert!(first.message.contains(evidence), "{}", first.message);
    }
    assert_eq!(first.labels.len(), 3);
    let places: Vec<_> = first
        .labels
        .iter()
        .map(|label| text.get(label.span.start as usize..label.span.end as usize).unwrap())
        .collect();
    assert_eq!(places, ["O1000", "IF[#1 GT 5]GOTO20", "G65"]);
}

#[test]
fn a_program_with_no_errors_of_its_own_is_warned_of_and_not_refused() {
    let found = interp::check(b"O1000\nG0 X1. (,R)\n:1001\nM30\n", &Setup::default());
    assert!(found.iter().any(|finding| finding.code == "I0909"));
    let found = interp::check(
        b"%\nG64 P0.01\n(MSG,hello)\n; a comment\nG0 X1.\nM30\n%\n",
        &Setup { dialect: Dialect::Fanuc, ..Setup::default() },
    );
    assert_eq!(found[0].code, "I0909");
}

/// G154 is a work offset to Haas, and turns on in the cam mode of the shared language.
#[test]
fn the_cam_words_of_the_shared_language_are_not_haas() {
    let cam = "G21 G90 G54\nT1 M6\nG43 H1\nG151 P7\nG154 S60 P2\nG154 P3\nG151 P0\nM30\n";
    assert_eq!(named(cam, Dialect::LinuxCnc), None);
    let mill = "O1\nT1 M6\nG154 P3\nG43 H1 Z5.\nM30\n";
    assert_eq!(named(mill, Dialect::LinuxCnc).as_deref(), Some("haas"));
}

/// Bare `%` lines, numbered programs and all else that LinuxCNC reads as well.
#[test]
fn no_program_that_is_compared_with_linuxcnc_is_suspected() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut looked_at = 0;
    for folder in ["tests/parity/good", "tests/parity/bad"] {
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "ngc") {
                continue;
            }
            let text = String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
            let found = suspected(&text, Dialect::LinuxCnc).map(|finding| finding.message);
            assert_eq!(found, None, "{}", path.display());
            looked_at += 1;
        }
    }
    assert!(looked_at > 200, "{looked_at} programs");
}

/// Of the programs on the pages and of the explained findings, each in the dialect that it names.
#[test]
fn no_program_of_the_pages_is_suspected_in_its_own_dialect() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut pages = vec![("explanations".to_owned(), interp::explanations())];
    for entry in fs::read_dir(root.join("spec")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "md") {
            pages.push((path.display().to_string(), fs::read_to_string(&path).unwrap()));
        }
    }
    let mut looked_at = 0;
    for (page, text) in pages {
        for part in text.split("```gcode").skip(1) {
            let (options, rest) = part.split_once('\n').unwrap();
            let program = rest.split("```").next().unwrap();
            let named =
                options.split("--dialect ").nth(1).and_then(|rest| rest.split_whitespace().next());
            let is_lathe_page = options.contains("--machine");
            let dialect = Dialect::ALL.into_iter().find(|dialect| Some(dialect.name()) == named);
            let dialect = dialect.unwrap_or(Dialect::LinuxCnc);
            if is_lathe_page && named.is_none() || program.contains("G65 P9100 A#1") {
                continue; // the machine's file has the dialect; the program that explains the finding
            }
            let found = suspected(program, dialect).map(|finding| finding.message);
            assert_eq!(found, None, "{page}: {program}");
            looked_at += 1;
        }
    }
    assert!(looked_at > 300, "{looked_at} programs");
    for entry in fs::read_dir(root.join("programs")).unwrap() {
        let path = entry.unwrap().path();
        let text = String::from_utf8_lossy(&fs::read(&path).unwrap_or_default()).into_owned();
        let seen = ALL.into_iter().filter(|dialect| suspected(&text, *dialect).is_none()).count();
        assert!(seen > 0, "{} is suspected in every dialect", path.display());
    }
}

#[test]
fn numbers_beside_the_percent_sign_and_simulators_lines_are_fanucs() {
    let guess = |text: &str| interp::looks_like(text.as_bytes(), Dialect::LinuxCnc);
    assert_eq!(guess("%O0003( FIXTURE)\nG0 X1.\nM30\n%\n"), Some(Dialect::Fanuc));
    assert_eq!(
        guess("[BILLET X50 Z80\nO3\nT0101\nG0 X50. Z2.\nG28 U0 W0\nM30\n"),
        Some(Dialect::FanucLatheA)
    );
    // Denford's simulators state a blank of their lathes without Y, one of their mills with it
    let lathe = "[BILLET X47.63  Z80\nO3\nG54\nG28\nT0707 M06\nG0 X50 Z-1\nM30\n";
    assert_eq!(guess(lathe), Some(Dialect::FanucLatheA));
    let mill = "[BILLET X100 Y60 Z20\nO3\nG54\nT1 M6\nG0 X50 Z-1\nM30\n";
    assert_eq!(guess(mill), Some(Dialect::Fanuc));
    assert_eq!(guess("O3\nG120.1 P1 Q1\nG0 X1.\nM30\n"), Some(Dialect::Mitsubishi));
}

#[test]
fn a_line_without_an_end_tells_nothing_more_than_its_beginning() {
    let text = "X1 ".repeat(1 << 22) + "G65 P9000 A1.";
    assert_eq!(interp::looks_like(text.as_bytes(), Dialect::LinuxCnc), None);
    assert_eq!(interp::looks_like(b"G65 P9000 A1.\n", Dialect::LinuxCnc), Some(Dialect::Fanuc));
}
