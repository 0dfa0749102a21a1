//! What the help of `leadscrew serve` shows, in the order in which it shows it, and the attacks
//! that its examples once were open to.

use crate::common::{leadscrew, said};
use std::io::{BufRead as _, BufReader, Read as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// The address that a server says, or its refusal; it ends at once.
fn served(folder: &Path, arguments: &[&str]) -> Result<String, String> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leadscrew"))
        .arg("serve")
        .args(arguments)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let is_served = line.starts_with("http");
    if is_served {
        child.kill().unwrap();
    }
    let mut complaint = String::new();
    child.stderr.take().unwrap().read_to_string(&mut complaint).unwrap();
    child.wait().unwrap();
    let is_refused = complaint.starts_with("error");
    if is_refused { Err(complaint) } else { Ok(line) }
}

/// A shop with a folder of programs, and one for what the control keeps.
fn shop() -> tempfile::TempDir {
    let shop = tempfile::tempdir().unwrap();
    for folder in ["programs", "out"] {
        std::fs::create_dir(shop.path().join(folder)).unwrap();
    }
    shop
}

#[test]
fn each_example_of_its_help_is_served_and_keeps_what_is_secret_apart() {
    let help = said(&leadscrew(&["serve", "--help"]));
    let (_, examples) = help.split_once("Examples:").unwrap();
    let examples: Vec<Vec<&str>> = examples
        .lines()
        .filter_map(|line| line.trim().strip_prefix("leadscrew serve "))
        .map(|line| line.split("  ").next().unwrap().split_whitespace().collect())
        .collect();
    assert!(examples.len() >= 5, "{help}");
    let shop = shop();
    let secret = shop.path().join("out/tokens.toml");
    for words in examples {
        let told = words.join(" ");
        // the one that is taken out was all that there was
        let is_made = secret.exists() || !words.contains(&"--token-file");
        assert!(is_made, "{told}: no example has made the file");
        if words.contains(&"--token-file") {
            let file = ["--new-token", "out/tokens.toml", "--token-name", "desk"];
            served(shop.path(), &file).unwrap();
        }
        let mut words = words;
        if !told.contains("-token out/") && !words.contains(&"--port") {
            words.extend(["--port", "0"]);
        }
        let line = served(shop.path(), &words).unwrap_or_else(|why| panic!("{told}: {why}"));
        assert!(!line.contains("error"), "{told}: {line}");
    }
    assert_eq!(secret.metadata().unwrap().permissions().mode() & 0o777, 0o600);
}

#[test]
fn what_cannot_be_told_apart_from_the_programs_is_refused_with_both_names() {
    let shop = shop();
    served(shop.path(), &["--new-token", "tokens.toml"]).unwrap();
    std::fs::copy(shop.path().join("tokens.toml"), shop.path().join("out/open.toml")).unwrap();
    let open = std::fs::Permissions::from_mode(0o644);
    std::fs::set_permissions(shop.path().join("out/open.toml"), open).unwrap();
    std::os::unix::fs::symlink(".", shop.path().join("link")).unwrap();
    for (arguments, names) in [
        (&["--token-file", "tokens.toml"][..], ["tokens.toml", "programs ."]),
        (&["--programs", "link", "--token-file", "tokens.toml"], ["tokens.toml", "programs link"]),
        (&["--state", "."], ["programs .", "state folder ."]),
        (&["--programs", "out/runs", "--state", "out"], ["out/runs", "state folder out"]),
        (&["--programs", "programs", "--token-file", "out/open.toml"], ["out/open.toml", "chmod"]),
    ] {
        std::fs::create_dir_all(shop.path().join("out/runs")).unwrap();
        let arguments = [arguments, &["--port", "0"]].concat();
        let why = served(shop.path(), &arguments).expect_err("it is refused");
        let told = format!("{arguments:?}: {why}");
        assert!(names.iter().all(|name| why.contains(name)), "{told}");
        assert_eq!(why.trim().lines().count(), 1, "{told}");
    }
}
