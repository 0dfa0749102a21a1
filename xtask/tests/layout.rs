//! What there is one of stays one: the command line's library in one crate, one call of the servo
//! loop.
use crate::tree::{files, root};
use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn only_the_command_line_knows_the_library_that_reads_command_lines() {
    let with_clap: Vec<String> = crates()
        .filter(|folder| {
            let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
            manifest.lines().any(|line| line.starts_with("clap"))
        })
        .map(|folder| name(&folder))
        .collect();
    assert_eq!(with_clap, ["cli"]);
}

#[test]
fn one_place_calls_the_kernels_tick() {
    let mut callers = Vec::new();
    for folder in crates().filter(|folder| name(folder) != "kernel") {
        let files = files(&folder.join("src"), "rs");
        let calls = |file: &PathBuf| production(file).contains("kernel.tick(");
        callers.extend(files.into_iter().filter(calls));
    }
    let mut callers: Vec<_> =
        callers.iter().map(|file| file.strip_prefix(root()).unwrap()).collect();
    callers.sort();
    assert_eq!(callers, ["crates/servo/src/period.rs"].map(Path::new));
}

/// The proof of each file that calls the operating system or HAL stands in the documents.
#[test]
fn the_files_with_unsafe_code_are_those_of_the_security_page() {
    let page = fs::read_to_string(root().join("docs/security.md")).unwrap();
    let table = page.split("## Unsafe code").nth(1).unwrap().split("\n## ").next().unwrap();
    let listed = table.lines().filter_map(|row| row.strip_prefix("| `")?.split_once('`'));
    let mut listed: Vec<_> = listed.map(|(file, _)| PathBuf::from(file)).collect();
    listed.sort();
    let allows = |file: &PathBuf| {
        let text = fs::read_to_string(file).unwrap();
        let mut lines = text.lines().map(str::trim_start).filter(|line| !line.starts_with("//"));
        lines.any(|line| {
            ["unsafe {", "unsafe fn", "unsafe impl", "unsafe extern", "#[unsafe("]
                .iter()
                .any(|word| line.contains(word))
        })
    };
    let all = crates().flat_map(|folder| files(&folder.join("src"), "rs"));
    let mut found: Vec<_> =
        all.filter(allows).map(|file| file.strip_prefix(root()).unwrap().to_owned()).collect();
    found.sort();
    assert_eq!(found, listed);
}

/// The text before its tests.
fn production(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    text.split("#[cfg(test)]").next().unwrap_or_default().to_owned()
}

fn crates() -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(root().join("crates")).unwrap();
    entries.map(|entry| entry.unwrap().path()).filter(|path| path.join("Cargo.toml").exists())
}

fn name(folder: &Path) -> String {
    folder.file_name().unwrap().to_string_lossy().into_owned()
}

/// A crate whose tests are linked into one program names them in its manifest and in
/// `tests/all.rs`: what is named in neither would never run.
#[test]
fn every_file_of_tests_is_run() {
    let mut forgotten = Vec::new();
    for folder in crates() {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        if !manifest.contains("autotests = false") {
            continue;
        }
        let all = fs::read_to_string(folder.join("tests/all.rs")).unwrap();
        for entry in fs::read_dir(folder.join("tests")).unwrap() {
            let file = entry.unwrap().path();
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            let is_run = manifest.contains(&format!("[[test]]\nname = \"{name}\""))
                || all.contains(&format!("\nmod {name};"));
            if file.extension().is_some_and(|ending| ending == "rs") && !is_run {
                forgotten.push(file);
            }
        }
    }
    assert!(forgotten.is_empty(), "in neither Cargo.toml nor tests/all.rs: {forgotten:?}");
}
