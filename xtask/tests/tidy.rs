//! What the documents promise about the tree is true.
#![allow(clippy::unwrap_used)] // a test may panic
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// Longest source file, in lines, before its tests begin. Beyond it a file has two ideas.
const LONGEST_FILE: usize = 500;

#[test]
fn the_architecture_table_is_the_manifests() {
    let doc = read(&root().join("docs/ARCHITECTURE.md"));
    let promised = layers(&doc);
    let mut actual = BTreeMap::new();
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        let dir = entry.unwrap().path();
        let name = dir.file_name().unwrap().to_string_lossy().into_owned();
        actual.insert(name, local_dependencies(&read(&dir.join("Cargo.toml"))));
    }
    assert_eq!(promised, actual, "docs/ARCHITECTURE.md (left) and the manifests (right) disagree");
}

#[test]
fn every_module_opens_by_saying_what_it_is() {
    let mute: Vec<_> = sources()
        .into_iter()
        .filter(|file| !read(file).trim_start().starts_with("//!"))
        .map(|file| shown(&file))
        .collect();
    assert!(mute.is_empty(), "these files do not begin with `//!`: {mute:#?}");
}

#[test]
fn no_file_is_longer_than_one_idea() {
    let long: Vec<_> = sources()
        .into_iter()
        .filter(|file| !shown(file).contains("/tests/"))
        .filter_map(|file| {
            let text = read(&file);
            let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
            let lines = code.lines().count();
            (lines > LONGEST_FILE).then(|| format!("{} ({lines} lines)", shown(&file)))
        })
        .collect();
    assert!(long.is_empty(), "longer than {LONGEST_FILE} lines before their tests: {long:#?}");
}

#[test]
fn nothing_is_left_open_in_the_code() {
    let marks = [concat!("to", "do!("), concat!("unimple", "mented!("), concat!("FIX", "ME")];
    let open: Vec<_> = sources()
        .into_iter()
        .filter(|file| marks.iter().any(|mark| read(file).contains(mark)))
        .map(|file| shown(&file))
        .collect();
    assert!(open.is_empty(), "left open: {open:#?}");
}

#[test]
fn the_manuals_pages_and_the_programs_they_name_exist() {
    for page in ["README.md", "docs/ARCHITECTURE.md", "docs/DESIGN.md"] {
        let text = read(&root().join(page));
        let base = root().join(page);
        let base = base.parent().unwrap();
        for target in links(&text) {
            assert!(base.join(&target).exists(), "{page} links to {target}, which does not exist");
        }
    }
}

/// Relative targets of Markdown links.
fn links(text: &str) -> Vec<String> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
        .filter(|target| !target.contains("://") && !target.starts_with('#'))
        .map(|target| target.split('#').next().unwrap_or_default().to_owned())
        .collect()
}

/// Rows of the table between `<!-- layers` and `<!-- /layers -->`: crate, and what it may use.
fn layers(doc: &str) -> BTreeMap<String, Vec<String>> {
    let table = doc.split("<!-- layers").nth(1).and_then(|s| s.split("<!-- /layers").next());
    table
        .expect("docs/ARCHITECTURE.md has a layers table")
        .lines()
        .filter(|row| row.starts_with('|'))
        .skip(2)
        .map(|row| {
            let cell = |n| row.split('|').nth(n).unwrap_or_default().trim().replace('`', "");
            let mut uses: Vec<_> =
                cell(3).split(", ").filter(|s| *s != "—").map(str::to_owned).collect();
            uses.sort();
            (cell(1), uses)
        })
        .collect()
}

/// Our own crates under `[dependencies]`; `[dev-dependencies]` are free.
fn local_dependencies(manifest: &str) -> Vec<String> {
    let ours: Vec<_> = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    let section = manifest.split("[dependencies]").nth(1).unwrap_or_default();
    let section = section.split("\n[").next().unwrap_or_default();
    let mut found: Vec<_> = section
        .lines()
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .filter(|name| ours.iter().any(|o| o == name))
        .map(str::to_owned)
        .collect();
    found.sort();
    found
}

/// Every Rust file of the workspace.
fn sources() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in ["crates", "xtask", "fuzz", "examples", "benches"] {
        collect(&root().join(folder), &mut found);
    }
    assert!(found.len() > 10, "the tree was not found");
    found
}

fn collect(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|n| n != "target") {
            collect(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}
