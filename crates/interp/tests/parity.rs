//! The listing against what LinuxCNC 2.9 printed for the same programs (`parity/README.md`).
use interp::{Interpreter, Listing, Progress, Setup};
use std::{fs, path::PathBuf};

/// Calls without count and N word; −0.0000 is 0.0000.
fn calls(listing: &str) -> Vec<String> {
    let bare = |line: &str| {
        let text = line.trim_start().split_once(" N").map_or(line, |(_, rest)| rest);
        text.trim_start_matches(['.', ' '])
            .trim_start_matches(|c: char| c.is_ascii_digit())
            .trim_start()
            .to_owned()
    };
    listing.lines().map(|line| positive_zeros(&bare(line))).collect()
}

fn positive_zeros(line: &str) -> String {
    line.replace("-0.0000,", "0.0000,")
        .replace("-0.0000)", "0.0000)")
        .replace("-0.0000 ", "0.0000 ")
}

/// The listing up to the first error, and whether there was one.
fn list(source: &[u8]) -> (Vec<String>, bool) {
    let setup = Setup { stand_alone: true, ..Setup::default() };
    let mut interpreter = Interpreter::new(source, &setup);
    let mut listing = Listing::new(Vec::new());
    while interpreter.step(&mut listing) == Progress::More && !interpreter.has_errors() {}
    let text = String::from_utf8(listing.finish().unwrap()).unwrap();
    (calls(&text), interpreter.has_errors())
}

fn programs(kind: &str) -> Vec<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/parity").join(kind);
    let mut all: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    all.retain(|path| path.extension().is_some_and(|e| e == "ngc"));
    all.sort();
    assert!(all.len() > 50, "the programs are there");
    all
}

#[test]
fn what_linuxcnc_accepts_is_listed_as_it_lists_it() {
    for path in programs("good") {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let wanted: Vec<String> = fs::read_to_string(path.with_extension("canon"))
            .unwrap()
            .lines()
            .map(str::to_owned)
            .collect();
        let (found, refused) = list(&fs::read(&path).unwrap());
        // `gen_acc_*` are what it accepts against its own manual: those may be refused.
        if refused {
            assert!(name.starts_with("gen_acc_"), "{name} is refused");
        } else if let Some(at) = found.iter().zip(&wanted).position(|(a, b)| a != b) {
            panic!("{name}, call {at}: {} is not {}", found[at], wanted[at]);
        } else {
            assert_eq!(found.len(), wanted.len(), "{name}");
        }
    }
}

#[test]
fn what_linuxcnc_refuses_is_refused() {
    for path in programs("bad") {
        let (_, refused) = list(&fs::read(&path).unwrap());
        assert!(refused, "{} is accepted", path.display());
    }
}
