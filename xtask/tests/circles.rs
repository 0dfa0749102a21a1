//! Files of a crate that need one another in a circle: a reader has to hold them all in the head at
//! once. How large the largest circle of each crate may be stands in `circles.txt`, and may only
//! shrink; a crate that is not listed has none.
//!
//! ```text
//!   a ──► b: file a names something of file b, by `use` or by a path      circle: a ──► b ──► … ──► a
//! ```
//!
//! The interpreter is held to more: its folders make no circle either, and what a type does stands
//! beside the type.
use crate::tree::{files, root};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Public types to which a layer above adds what it brings (snapshots, pieces of long programs),
/// and in how many files at most.
const OPEN_TO_LAYERS_ABOVE: [(&str, usize); 2] = [("Interpreter", 4), ("Ops", 2)];

#[test]
fn no_circle_of_files_is_larger_than_before() {
    let listed: BTreeMap<String, usize> = include_str!("circles.txt")
        .lines()
        .map(|line| line.rsplit_once(' ').unwrap())
        .map(|(name, most)| (name.to_owned(), most.parse().unwrap()))
        .collect();
    let mut wrong = Vec::new();
    let mut known = BTreeSet::new();
    for folder in fs::read_dir(root().join("crates")).unwrap() {
        let folder = folder.unwrap().path();
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        let files = Files::of(&folder.join("src"));
        let largest = circles(&files.needs).into_iter().max_by_key(Vec::len).unwrap_or_default();
        let (now, before) = (largest.len(), *listed.get(&name).unwrap_or(&0));
        if now > before {
            let names: Vec<&str> = largest.iter().map(|i| files.names[*i].as_str()).collect();
            wrong
                .push(format!("{name}: {now} files need one another, at most {before}: {names:?}"));
        } else if now < before {
            wrong.push(format!("{name}: write {now} in circles.txt, not {before}"));
        }
        known.insert(name);
    }
    wrong.extend(listed.keys().filter(|name| !known.contains(*name)).cloned());
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn the_interpreters_folders_make_no_circle() {
    let files = Files::of(&root().join("crates/interp/src"));
    assert!(files.names.len() > 100, "the sources are found");
    assert!(files.needs.iter().map(Vec::len).sum::<usize>() > 600, "the imports are read");
    let part = |i: usize| files.names[i].split('/').next().unwrap_or_default().to_owned();
    let parts: BTreeSet<String> = (0..files.names.len()).map(part).collect();
    let parts: Vec<String> = parts.into_iter().filter(|part| part != "lib.rs").collect();
    let at = |name: &str| parts.iter().position(|part| part == name);
    let mut needs = vec![Vec::new(); parts.len()];
    for (i, others) in files.needs.iter().enumerate() {
        for other in others {
            if let (Some(from), Some(to)) = (at(&part(i)), at(&part(*other)))
                && from != to
            {
                needs[from].push(to);
            }
        }
    }
    let circles = circles(&needs);
    let named: Vec<Vec<&String>> =
        circles.iter().map(|circle| circle.iter().map(|i| &parts[*i]).collect()).collect();
    assert!(named.is_empty(), "folders that need one another: {named:?}");
}

/// Functions take the parts that they need; a structure that has methods in many files is known to
/// all of them.
#[test]
fn a_type_of_the_interpreter_has_its_methods_in_one_file() {
    let mut homes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let files = Files::of(&root().join("crates/interp/src"));
    for (name, text) in files.names.iter().zip(&files.texts) {
        for line in text.lines().filter(|line| !line.contains(" for ")) {
            let Some(rest) = line.strip_prefix("impl") else { continue };
            let rest = match rest.strip_prefix('<').and_then(|rest| rest.split_once("> ")) {
                Some((_, rest)) => rest,
                None => rest.trim_start(),
            };
            let of: String = rest.chars().take_while(|c| c.is_alphanumeric()).collect();
            homes.entry(of).or_default().insert(name.clone());
        }
    }
    let most =
        |of: &str| OPEN_TO_LAYERS_ABOVE.iter().find(|(name, _)| *name == of).map_or(1, |(_, n)| *n);
    let spread: Vec<_> = homes.iter().filter(|(of, files)| files.len() > most(of)).collect();
    assert!(spread.is_empty(), "{spread:#?}");
}

/// The files of a crate before their tests, and which of them each one needs.
struct Files {
    names: Vec<String>,
    texts: Vec<String>,
    needs: Vec<Vec<usize>>,
}

impl Files {
    fn of(folder: &Path) -> Self {
        let mut paths = files(folder, "rs");
        paths.sort();
        let name = |path: &PathBuf| {
            path.strip_prefix(folder).unwrap().to_string_lossy().replace('\\', "/")
        };
        let names: Vec<String> = paths.iter().map(name).collect();
        let texts: Vec<String> = paths.iter().map(|path| code(path)).collect();
        let modules: Vec<String> = names.iter().map(|name| module(name)).collect();
        let mut handed_on = BTreeMap::new();
        for (own, text) in modules.iter().zip(&texts) {
            for (path, public) in taken(own, text) {
                if public && let Some((_, name)) = path.rsplit_once("::") {
                    handed_on.insert(join(own, name), path.clone());
                }
            }
        }
        let needs = |i: usize| {
            let paths = taken(&modules[i], &texts[i]);
            let needed: BTreeSet<usize> =
                paths.iter().filter_map(|(path, _)| home(path, &modules, &handed_on)).collect();
            // a crate's root hands on what all of its files have
            needed.into_iter().filter(|other| *other != i && names[*other] != "lib.rs").collect()
        };
        let needs = (0..names.len()).map(needs).collect();
        Self { names, texts, needs }
    }
}

/// The file that a path leads into.
fn home(path: &str, modules: &[String], handed_on: &BTreeMap<String, String>) -> Option<usize> {
    let mut path = path.to_owned();
    for _ in 0..32 {
        if let Some(found) = modules.iter().position(|module| *module == path) {
            return Some(found);
        }
        path = match handed_on.get(&path) {
            Some(from) if *from != path => from.clone(),
            _ => path.rsplit_once("::")?.0.to_owned(),
        };
    }
    None
}

/// A file's text before its tests, without comments.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let tests = ["#[cfg(test)]", "#[cfg(all(test"].iter().filter_map(|mark| text.find(mark)).min();
    let text = &text[..tests.unwrap_or(text.len())];
    text.lines().flat_map(|line| [line.split("//").next().unwrap_or_default(), "\n"]).collect()
}

/// The module of a file: `dialect/fanuc/mod.rs` is `dialect::fanuc`, `lib.rs` the root.
fn module(file: &str) -> String {
    let path = file.trim_end_matches(".rs").trim_end_matches("/mod").replace('/', "::");
    if path == "lib" || path == "main" { String::new() } else { path }
}

fn join(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") }
}

/// The paths that a tree of imports names: `a::{b, c::d}` names `a::b` and `a::c::d`.
fn paths_of(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((head, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let body = rest.trim_end().strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in body.chars() {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match (c, parts.last_mut()) {
            (',', _) if depth == 0 => parts.push(String::new()),
            (_, Some(part)) => part.push(c),
            (_, None) => {}
        }
    }
    let inner = parts.iter().filter(|part| !part.trim().is_empty());
    inner.flat_map(|part| paths_of(part)).map(|path| format!("{head}{path}")).collect()
}

/// The paths from the crate's root that a file names, and whether it hands them on: by `use`, and
/// by what begins with `crate::`, `super::` or `self::`.
fn taken(own: &str, text: &str) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find("use ") {
        let (before, statement) = (&rest[..at], &rest[at + 4..]);
        let line = before.rsplit('\n').next().unwrap_or_default().trim();
        let tree = statement.split(';').next().unwrap_or_default();
        rest = statement;
        if line.is_empty() || line.starts_with("pub") {
            let tree = tree.split_whitespace().collect::<Vec<_>>().join(" ");
            let public = line.starts_with("pub");
            found.extend(
                paths_of(&tree).into_iter().filter_map(|p| Some((absolute(own, &p)?, public))),
            );
        }
    }
    let in_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in text.match_indices(start) {
            let inside = text[..at].chars().next_back().is_some_and(in_path);
            if !inside {
                let path = &text[at..];
                let path = &path[..path.find(|c| !in_path(c)).unwrap_or(path.len())];
                // what ends so is the root of a tree of imports, which was read above
                let path = Some(path).filter(|path| !path.ends_with("::"));
                found.extend(path.and_then(|path| Some((absolute(own, path)?, false))));
            }
        }
    }
    found
}

/// A path from the crate's root; one that begins with a name is a child of the module, or of
/// another crate.
fn absolute(own: &str, path: &str) -> Option<String> {
    let mut here: Vec<&str> = own.split("::").filter(|part| !part.is_empty()).collect();
    let mut rest: Vec<&str> = path.split("::").map(str::trim).filter(|p| *p != "self").collect();
    while let Some(first) = rest.first() {
        match *first {
            "crate" => here.clear(),
            "super" => _ = here.pop(),
            _ => break,
        }
        rest.remove(0);
    }
    (!rest.is_empty()).then(|| here.into_iter().chain(rest).collect::<Vec<_>>().join("::"))
}

/// The sets of files (by number) each of which leads to every other one of its set.
fn circles(needs: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let reach: Vec<Vec<bool>> = (0..needs.len()).map(|from| reached(needs, from)).collect();
    let mut seen = vec![false; needs.len()];
    let mut found = Vec::new();
    for i in 0..needs.len() {
        if seen[i] || !reach[i][i] {
            continue;
        }
        let circle: Vec<usize> =
            (0..needs.len()).filter(|j| reach[i][*j] && reach[*j][i]).collect();
        for j in &circle {
            seen[*j] = true;
        }
        found.push(circle);
    }
    found
}

fn reached(needs: &[Vec<usize>], from: usize) -> Vec<bool> {
    let (mut seen, mut open) = (vec![false; needs.len()], vec![from]);
    while let Some(file) = open.pop() {
        for next in &needs[file] {
            if !std::mem::replace(&mut seen[*next], true) {
                open.push(*next);
            }
        }
    }
    seen
}

#[test]
fn a_circle_is_found() {
    let needs = [vec![1], vec![2], vec![0, 3], vec![], vec![4]];
    assert_eq!(circles(&needs), [vec![0, 1, 2], vec![4]]);
    let own = "a::b";
    let text = "use crate::c::{D, e::F};\npub(crate) use super::g;\nfn f() { crate::h::i(); }\n";
    let taken: Vec<String> = taken(own, text).into_iter().map(|(path, _)| path).collect();
    for path in ["c::D", "c::e::F", "a::g", "h::i"] {
        assert!(taken.iter().any(|found| found == path), "{path}: {taken:?}");
    }
}
