//! Names in the code are words of the trade: types, functions and files have none of the pictures
//! that `docs/GLOSSARY.md` replaces.
use std::{collections::BTreeSet, fs, path::Path};

/// Words that are not to be used in names.
const NOT_USED: [&str; 15] = [
    "iron", "papers", "scribe", "keeper", "wish", "doubt", "lame", "patience", "gentle", "crumb",
    "wiggle", "lesson", "tempo", "glide", "bow",
];

#[test]
fn no_name_is_a_picture() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut found = BTreeSet::new();
    for folder in ["crates", "xtask"] {
        collect(&root.join(folder), &mut found);
    }
    assert!(found.is_empty(), "give these another name: {found:#?}");
}

#[test]
fn a_word_is_found_in_each_kind_of_name() {
    let words = ["IronArgs", "the_keeper", "Papers", "iron.rs"].map(is_picture);
    assert_eq!(words, [true; 4]);
    let words = ["Environment", "environ", "bowl", "elbow.rs", "Timer"].map(is_picture);
    assert_eq!(words, [false; 5]);
}

/// Names of files, types and functions below a folder.
fn collect(folder: &Path, found: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "target" {
            found.extend(is_picture(&name).then(|| format!("folder {name}")));
            collect(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.extend(is_picture(&name).then(|| format!("file {name}")));
            let text = fs::read_to_string(&path).unwrap();
            for kind in ["fn", "struct", "enum", "trait", "type", "mod"] {
                let names = text.lines().filter(|line| !line.trim_start().starts_with("//"));
                let names = names.filter_map(|line| {
                    let words: Vec<&str> = line.split_whitespace().collect();
                    let at = words.iter().position(|word| *word == kind)?;
                    let end = |c: char| !c.is_alphanumeric() && c != '_';
                    words.get(at + 1)?.split(end).next().map(str::to_owned)
                });
                let pictures = names.filter(|name| is_picture(name));
                found.extend(pictures.map(|name| format!("{kind} {name}")));
            }
        }
    }
}

/// Whether one of the words of a name is not to be used: words begin at a capital, or after `_`,
/// `-` or `.`.
fn is_picture(name: &str) -> bool {
    let mut words = vec![String::new()];
    for c in name.chars() {
        if c.is_uppercase() || !c.is_alphanumeric() {
            words.push(String::new());
        }
        if c.is_alphanumeric() {
            words.last_mut().unwrap().extend(c.to_lowercase());
        }
    }
    words.iter().any(|word| NOT_USED.contains(&word.as_str()))
}
