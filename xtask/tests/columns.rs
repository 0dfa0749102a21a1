//! Text is no wider than a page: documents and comments wrap at 100 columns. Tables, drawings and
//! code are as wide as they are, and pages that a test writes have the lines of what they are made
//! from.
use crate::tree::{self, files, root};
use std::fs;
use std::path::PathBuf;

/// Columns of a line of text.
const COLUMNS: usize = 100;
/// Written by a test: its lines are those of the list that it shows.
const WRITTEN: [&str; 1] = ["spec/codes.md"];

#[test]
fn documents_wrap() {
    let mut files = files(&root().join("docs"), "md");
    files.extend(tree::files(&root().join("spec"), "md"));
    files.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|name| root().join(name)));
    files.retain(|file| WRITTEN.iter().all(|page| !file.ends_with(page)));
    assert_none_is_wide(&files, |text| wide(text.lines()));
}

#[test]
fn comments_wrap() {
    let folders = ["crates", "xtask", "fuzz/fuzz_targets"];
    let files: Vec<_> =
        folders.iter().flat_map(|folder| files(&root().join(folder), "rs")).collect();
    assert_none_is_wide(&files, |text| {
        wide(text.lines().map(|line| if line.trim_start().starts_with("//") { line } else { "" }))
    });
}

fn assert_none_is_wide(files: &[PathBuf], wide: impl Fn(&str) -> Vec<usize>) {
    let mut found = Vec::new();
    for file in files {
        let lines = wide(&fs::read_to_string(file).unwrap());
        found.extend(lines.into_iter().map(|line| format!("{}:{line}", file.display())));
    }
    assert!(files.len() > 10 && found.is_empty(), "wider than {COLUMNS} columns: {found:#?}");
}

/// Numbers of the lines that are too wide, beginning at 1.
fn wide<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<usize> {
    let mut is_code = false;
    let mut found = Vec::new();
    for (at, line) in lines.enumerate() {
        let text = line.trim_start().trim_start_matches(['/', '!']).trim_start();
        if text.starts_with("```") {
            is_code = !is_code;
        }
        // a table, a quotation of what the program says, an address
        let is_whole = text.starts_with(['|', '>']) || text.contains("](https://");
        if !is_code && !is_whole && line.chars().count() > COLUMNS {
            found.push(at + 1);
        }
    }
    found
}

#[test]
fn a_wide_line_is_found_and_a_drawing_is_not() {
    let long = format!("/// {}", "word ".repeat(30));
    let text = format!("{long}\n/// ```text\n{long}\n/// ```\n/// | {long} |\n{long}");
    assert_eq!(wide(text.lines()), [1, 6]);
}
