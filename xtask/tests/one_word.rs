//! One word, one concept: how many types have the same name. What there is too much of stands in
//! `one-word.txt` with its count, and may only shrink.
use std::{collections::BTreeMap, fs, path::Path};

/// So many types may share a name without being listed: most are private to files that do not know
/// one another.
const FEW: usize = 3;

#[test]
fn no_more_types_share_a_name_than_before() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut found = BTreeMap::new();
    for folder in fs::read_dir(root.join("crates")).unwrap() {
        count(&folder.unwrap().path().join("src"), &mut found);
    }
    let listed: BTreeMap<String, usize> = include_str!("one-word.txt")
        .lines()
        .map(|line| line.rsplit_once(' ').unwrap())
        .map(|(name, count)| (name.to_owned(), count.parse().unwrap()))
        .collect();
    let mut wrong = Vec::new();
    for (name, now) in &found {
        let most = *listed.get(name).unwrap_or(&FEW);
        if *now > most {
            wrong.push(format!(
                "{now} types are called {name}, at most {most}: give it another name"
            ));
        }
    }
    for (name, before) in &listed {
        let now = found.get(name).copied().unwrap_or(0);
        if now < *before {
            wrong.push(format!(
                "{now} types are called {name}: write that in one-word.txt, not {before}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Types that are defined below a folder, by name.
fn count(folder: &Path, found: &mut BTreeMap<String, usize>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            count(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            for name in text.lines().filter_map(defined) {
                *found.entry(name.to_owned()).or_default() += 1;
            }
        }
    }
}

/// The type that a line defines; associated types have the name that their trait gives them.
fn defined(line: &str) -> Option<&str> {
    if line.starts_with(' ') {
        return None;
    }
    let line = line.strip_prefix("pub(crate) ").unwrap_or(line);
    let line = line.strip_prefix("pub(super) ").unwrap_or(line);
    let line = line.strip_prefix("pub ").unwrap_or(line);
    let name =
        ["struct ", "enum ", "trait ", "type "].iter().find_map(|kind| line.strip_prefix(kind))?;
    name.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

#[test]
fn a_definition_is_found_whatever_stands_around_its_name() {
    assert_eq!(defined("pub(crate) struct Row<'a> {"), Some("Row"));
    assert_eq!(defined("type Place = [f64; 3];"), Some("Place"));
    assert_eq!(defined("    type Output = Length;"), None);
    assert_eq!(defined("let structure = 1;"), None);
}
