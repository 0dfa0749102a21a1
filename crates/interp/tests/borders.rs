//! What the crate's parts must not know of one another, read from its sources.
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

/// Outside of `dialect` the crate asks for rules. The programs of `explain` are examples, each in its dialect.
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

/// The module of a file: `dialect/fanuc/mod.rs` is `dialect::fanuc`.
fn module(file: &str) -> String {
    file.trim_end_matches(".rs").trim_end_matches("/mod").replace('/', "::")
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

/// What a file takes from which others: by `use`, and by paths that begin with `crate::` or `super::`.
fn taken(own: &str, text: &str) -> Vec<String> {
    let code: String = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .flat_map(|line| [line, "\n"])
        .collect();
    let mut paths = Vec::new();
    for start in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(start) {
            let rest = &code[at..];
            let end = if code[..at].trim_end().ends_with("use") {
                rest.find(';').unwrap_or(rest.len())
            } else {
                let in_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
                rest.find(|c| !in_path(c)).unwrap_or(rest.len())
            };
            paths.extend(paths_of(&rest[..end]));
        }
    }
    for line in code.lines() {
        let used = line.trim_start_matches("pub ").trim_start_matches("pub(crate) ");
        if let Some(child) = used.strip_prefix("use ") {
            paths.extend(
                paths_of(child.trim_end_matches(';')).into_iter().map(|p| format!("self::{p}")),
            );
        }
    }
    paths.into_iter().filter_map(|path| absolute(own, &path)).collect()
}

/// A path from the crate's root.
fn absolute(own: &str, path: &str) -> Option<String> {
    let mut here: Vec<&str> = own.split("::").collect();
    let mut rest: Vec<&str> = path.split("::").map(str::trim).collect();
    match *rest.first()? {
        "crate" => here.clear(),
        "self" => {}
        "super" => _ = here.pop(),
        _ => return None,
    }
    rest.remove(0);
    Some(here.into_iter().chain(rest).collect::<Vec<_>>().join("::"))
}

/// A reader may take the files one after the other: none needs one that needs it.
#[test]
fn no_files_import_one_another_in_a_circle() {
    let files = all();
    let modules: Vec<String> = files.iter().map(|(file, _)| module(file)).collect();
    let exported: Vec<(String, usize)> = exports(&files, &modules);
    let nearest = |path: &str| -> Option<usize> {
        let mut path = path;
        loop {
            if let Some(found) = modules.iter().position(|module| module == path) {
                return Some(found);
            }
            if let Some((_, at)) = exported.iter().find(|(name, _)| name == path) {
                return Some(*at);
            }
            path = path.rsplit_once("::")?.0;
        }
    };
    let needs: Vec<Vec<usize>> = files
        .iter()
        .enumerate()
        .map(|(i, (_, text))| {
            let paths = taken(&modules[i], text);
            paths.iter().filter_map(|path| nearest(path)).filter(|other| *other != i).collect()
        })
        .collect();
    assert!(needs.iter().map(Vec::len).sum::<usize>() > 300, "the imports are read");
    let reach = |from: usize| -> Vec<bool> {
        let (mut seen, mut open) = (vec![false; needs.len()], vec![from]);
        while let Some(file) = open.pop() {
            for next in &needs[file] {
                if !std::mem::replace(&mut seen[*next], true) {
                    open.push(*next);
                }
            }
        }
        seen
    };
    let circle: Vec<&str> =
        (0..files.len()).filter(|i| reach(*i)[*i]).map(|i| files[i].0.as_str()).collect();
    assert!(circle.is_empty(), "{circle:?} import one another in a circle");
}

/// Names that the crate's root hands on, and the file that they come from.
fn exports(files: &[(String, String)], modules: &[String]) -> Vec<(String, usize)> {
    let root = files.iter().find(|(file, _)| file == "lib.rs").map_or("", |(_, text)| text);
    let mut found = Vec::new();
    for (at, _) in root.match_indices("pub use ") {
        let tree = root[at + 8..].split(';').next().unwrap_or_default();
        for path in paths_of(&tree.split_whitespace().collect::<Vec<_>>().join(" ")) {
            let Some((module, name)) = path.rsplit_once("::") else { continue };
            let from = modules.iter().position(|other| other == module.trim());
            found.extend(from.map(|from| (name.trim().to_owned(), from)));
        }
    }
    found
}

/// What executes blocks is functions of parts; the structure that holds the parts together has no methods elsewhere.
#[test]
fn the_executor_has_methods_in_its_own_file_alone() {
    for (file, text) in all() {
        let methods = text.lines().any(|line| line.starts_with("impl Executor"));
        assert!(
            !methods || file == "executor.rs",
            "{file}: write a function of the parts it needs"
        );
    }
}
