//! What README and docs tell a reader to type does what they say: every shipped program is accepted by its machine in its
//! dialect, and every command of the docs that runs one of them ends well.
#![allow(clippy::unwrap_used)] // a test may panic
#[allow(dead_code)] // commands are typed in a folder of their own here
mod common;
use common::{complained, root, said};
use std::{fs, os::unix::fs::symlink, path::Path, process::Command};

/// What each shipped program has to be run with.
const PROGRAMS: [(&str, &[&str]); 18] = [
    ("plate-12xM6.ngc", &[]),
    ("mill-8xM8.ngc", &[]),
    ("learning-12xM6.ngc", &[]),
    ("bolt-circle.ngc", &[]),
    ("inch-unc.ngc", &[]),
    ("left-hand.ngc", &[]),
    ("m3-and-m10.ngc", &[]),
    ("plate-macro.nc", &["--dialect", "fanuc"]),
    ("chip-removal.nc", &["--dialect", "brother"]),
    ("scroll.ngc", &["--machine", "mill-5-axis"]),
    ("thread-m20x1.5.ngc", &["--machine", "lathe"]),
    ("feed-screw.nc", &["--machine", "lathe", "--dialect", "fanuc-lathe-a"]),
    ("hexagon-af17.nc", &["--machine", "polygon-lathe"]),
    ("square-af30.nc", &["--machine", "polygon-lathe"]),
    ("cam-measure.nc", CAM),
    ("cam-grind.nc", CAM),
    ("cam-shaft.nc", &["--machine", "cam-grinder"]),
    ("gear-m2-z40.nc", &["--machine", "gear-hobber"]),
];
const CAM: &[&str] =
    &["--machine", "cam-grinder", "--dialect", "toyoda", "--phase-table", "phases.toml"];

/// A folder that has the shipped files, and takes what is written.
fn shop() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in ["programs", "machines"] {
        symlink(root().join(name).canonicalize().unwrap(), folder.path().join(name)).unwrap();
    }
    folder
}

fn typed(folder: &Path, words: &[&str]) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_leadscrew"));
    command.args(words).current_dir(folder).env("NO_COLOR", "1").output().unwrap()
}

#[test]
fn every_shipped_program_is_in_order_on_its_machine_in_its_dialect() {
    let folder = shop();
    let mut shipped: Vec<String> = fs::read_dir(root().join("programs"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| matches!(name.rsplit_once('.'), Some((_, "ngc" | "nc"))))
        .collect();
    shipped.sort();
    for (name, options) in PROGRAMS {
        let path = format!("programs/{name}");
        // a cam is ground with the phase error that the program before it has measured
        let verb = if options == CAM { "run" } else { "check" };
        let output = typed(folder.path(), &[&[verb, &path, "-q"], options].concat());
        let text = said(&output) + &complained(&output);
        assert_eq!(output.status.code(), Some(0), "{name}: {text}");
        shipped.retain(|s| s != name);
    }
    assert!(shipped.is_empty(), "nobody says how these are run: {shipped:?}");
}

/// Commands in the text whose program is a shipped one; what is left out with `…` is not run.
fn runnable(text: &str) -> Vec<String> {
    let blocks = text.lines().filter_map(|line| line.trim_start().strip_prefix("leadscrew "));
    let spans = text.lines().flat_map(|line| line.split('`').skip(1).step_by(2));
    let spans = spans.filter_map(|span| span.strip_prefix("leadscrew "));
    let commands = blocks.chain(spans).map(|c| c.split(" #").next().unwrap_or(c).trim().to_owned());
    let concrete = |c: &String| {
        let words: Vec<&str> = c.split_whitespace().collect();
        // ten speeds of a polygon, each cut twice; every cam at every speed: they are read as commands only
        let long = c.contains("--simulate") || words[0] == "compensation";
        !long
            && !c.contains('…')
            && (words.iter().any(|word| word.starts_with("programs/"))
                || matches!(words[0], "polygon" | "cam" | "compare") && words.len() > 1)
    };
    commands.filter(concrete).collect()
}

#[test]
fn every_command_of_readme_and_docs_on_a_shipped_program_does_its_work() {
    let folder = shop();
    let mut pages: Vec<_> = fs::read_dir(root().join("docs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.sort();
    pages.push(root().join("README.md"));
    let mut ran = 0;
    for page in pages {
        for command in runnable(&fs::read_to_string(&page).unwrap()) {
            let words: Vec<String> = command
                .split(['\'', '"'])
                .enumerate()
                .flat_map(|(at, part)| match at % 2 {
                    1 => vec![part.to_owned()],
                    _ => part.split_whitespace().map(str::to_owned).collect(),
                })
                .collect();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let output = typed(folder.path(), &words);
            let text = said(&output) + &complained(&output);
            // a stop that is shown is an alarm
            let stopped = words.iter().any(|word| *word == "--fault" || *word == "--operator");
            let good = output.status.success() || stopped && output.status.code() == Some(3);
            assert!(good, "{}: leadscrew {command}: {text}", page.display());
            ran += 1;
        }
    }
    assert!(ran >= 3, "the commands were not found: {ran}");
}
