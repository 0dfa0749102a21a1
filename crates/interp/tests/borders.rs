//! What the crate's parts must not know of the dialects, read from its sources. That they make no
//! circle is held by a test of the workspace.
use std::{fs, path::Path};

/// Rust files below a folder, with their text before their tests.
fn sources(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
            let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
            found.push((name, code.to_owned()));
        }
    }
}

fn all() -> Vec<(String, String)> {
    let mut found = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut found);
    assert!(found.len() > 50, "the sources are found");
    found
}

/// The same of the machining centres that speak Fanuc's language: the front end asks for their
/// `Variant`.
#[test]
fn no_file_outside_the_dialects_folder_names_a_maker_of_machining_centres() {
    for (file, text) in all().into_iter().filter(|(file, _)| !file.starts_with("dialect/")) {
        let named = text
            .lines()
            .find(|line| line.contains("Kind::Haas") || line.contains("Kind::Mitsubishi"));
        assert!(named.is_none(), "{file}: {named:?}: ask for a field of `Variant` instead");
    }
}

/// Outside of `dialect` the crate asks for rules. The programs of `explain` are examples, each in
/// its dialect.
#[test]
fn no_file_outside_the_dialects_folder_names_a_dialect() {
    let names = interp::Dialect::ALL.map(|dialect| format!("Dialect::{dialect:?}"));
    for (file, text) in all() {
        if file.starts_with("dialect/") || file.starts_with("explain/") {
            continue;
        }
        for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
            assert!(
                !names.iter().any(|name| line.contains(name.as_str())),
                "{file}: {line}: ask for a rule of `dialect::rules` instead"
            );
        }
    }
}
