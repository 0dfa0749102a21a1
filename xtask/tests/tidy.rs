//! What the documents promise about the tree is true.
use crate::tree::{files, root};
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

/// Files are opened by [`store::open`], which waits for no pipe, and read to a limit.
#[test]
fn every_file_is_read_by_the_one_reader_that_has_a_limit() {
    // the system's own files, and those of a folder that is locked
    let own = [
        "crates/store/src/regular.rs",
        "crates/store/src/text.rs",
        "crates/store/src/output.rs",
        "crates/store/src/state/plain.rs",
        "crates/store/src/state/lock.rs",
        "crates/server/src/metrics/process.rs",
        "crates/server/src/monitoring.rs",
    ];
    let readers =
        ["File::open(", "fs::read(", "fs::read_to_string(", "pem_file", ".read(true).open("];
    let mut others = Vec::new();
    for file in sources() {
        let name = shown(&file);
        let is_product = name.starts_with("crates/") && name.contains("/src/");
        let is_test = ["tests.rs", "documented.rs", "machine_keys.rs", "/tests/"]
            .iter()
            .any(|part| name.contains(part));
        if !is_product || is_test || own.contains(&name.as_str()) {
            continue;
        }
        let text = read(&file);
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let found = readers.iter().filter(|reader| code.contains(**reader));
        others.extend(found.map(|reader| format!("{name}: {reader}")));
    }
    assert!(others.is_empty(), "not read by store::open or store::read_bytes: {others:#?}");
}

/// Files are created, emptied and appended to by [`store::regular`], which waits for no pipe and
/// opens no device; or made under a name of their own and renamed.
#[test]
fn every_file_is_written_by_the_one_way_that_takes_regular_files_alone() {
    let own = [
        "crates/store/src/regular.rs",
        // options without links, for files whose kind is looked at
        "crates/store/src/state/plain.rs",
    ];
    let writers = [
        "File::create",
        "File::options",
        "OpenOptions",
        "fs::write(",
        "fs::copy(",
        ".write(true)",
        ".append(true)",
    ];
    let checked = "must_be_regular(";
    let mut others = Vec::new();
    for file in sources() {
        let name = shown(&file);
        let is_product = name.starts_with("crates/") && name.contains("/src/");
        let is_test = ["tests.rs", "documented.rs", "machine_keys.rs", "/tests/"]
            .iter()
            .any(|part| name.contains(part));
        if !is_product || is_test || own.contains(&name.as_str()) {
            continue;
        }
        let text = read(&file);
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let code = code.split("#[cfg(all(test").next().unwrap_or_default();
        let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        let code = code.collect::<Vec<_>>().join("\n");
        if code.contains(checked) || code.contains("is_plain(&file)") {
            continue; // the locked file, and the alarms beside it
        }
        let found = writers.iter().filter(|writer| code.contains(**writer));
        others.extend(found.map(|writer| format!("{name}: {writer}")));
    }
    assert!(others.is_empty(), "not written by store::regular: {others:#?}");
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
    for page in pages() {
        let text = read(&page);
        let base = page.parent().unwrap();
        for target in links(&text) {
            let place = base.join(&target);
            assert!(place.exists(), "{} links to {target}, which does not exist", shown(&page));
        }
    }
}

/// Items of the code that ARCHITECTURE.md and GLOSSARY.md name stand in the file that their link
/// leads to: `Type::function()`, `function()`, or `Type`.
#[test]
fn what_the_architecture_and_the_glossary_name_is_in_the_file_that_it_links_to() {
    let doc = read(&root().join("docs/ARCHITECTURE.md"));
    let glossary = read(&root().join("docs/GLOSSARY.md"));
    let named = [named_items(&doc), named_items(&glossary)].concat();
    let wrong: Vec<_> = named
        .iter()
        .filter(|(item, file)| {
            let file = root().join("docs").join(file);
            !file.is_file() || !has(&read(&file), item)
        })
        .collect();
    assert!(wrong.is_empty(), "not in the linked file: {wrong:#?}");
    let life = doc.split("## The life of a G84").nth(1).and_then(|s| s.split("\n## ").next());
    let steps = split_steps(life.unwrap());
    assert_eq!(steps.len(), 9, "the life of a G84 has nine steps");
    for step in steps {
        let calls = named_items(&step).iter().any(|(item, _)| item.ends_with("()"));
        assert!(calls, "a step without a function: {step}");
    }
}

#[test]
fn an_item_that_is_not_in_its_file_is_found() {
    let text = "pub struct Kernel {}\nimpl Kernel {\n    pub fn tick(&mut self) {}\n}\n";
    assert!(has(text, "Kernel::tick()") && has(text, "tick()") && has(text, "Kernel"));
    assert!(!has(text, "Kernel::tock()") && !has(text, "Servo::tick()") && !has(text, "Servo"));
}

#[test]
fn the_files_that_documents_name_are_there() {
    let all: Vec<String> = sources().iter().map(|file| shown(file)).collect();
    let mut named = 0;
    let mut gone = Vec::new();
    for page in pages() {
        let text = read(&page);
        for name in text
            .split('`')
            .filter(|name| name.split('.').next_back() == Some("rs") && !name.contains([' ', '*']))
        {
            let name = name.trim_start_matches("../");
            named += 1;
            // with or without the crate's `src`
            let is_there = |file: &String| {
                let ends = |path: &str| path == name || path.ends_with(&format!("/{name}"));
                ends(file) || ends(&file.replace("/src/", "/"))
            };
            if !all.iter().any(is_there) {
                gone.push(format!("{}: {name}", shown(&page)));
            }
        }
    }
    assert!(named > 40 && gone.is_empty(), "of {named} files these are not there: {gone:#?}");
}

/// The numbered steps of a list, each with its further lines.
fn split_steps(text: &str) -> Vec<String> {
    let mut steps: Vec<String> = Vec::new();
    for line in text.lines() {
        let starts = line.split_once(". **").is_some_and(|(n, _)| n.parse::<u32>().is_ok());
        match steps.last_mut() {
            _ if starts => steps.push(line.to_owned()),
            Some(step) => *step += &format!("\n{line}"),
            None => {}
        }
    }
    steps
}

/// `[`item`](file.rs)`: items and files.
fn named_items(text: &str) -> Vec<(String, String)> {
    let links = text
        .split("[`")
        .skip(1)
        .filter_map(|rest| rest.split_once("`]("))
        .filter_map(|(item, rest)| Some((item.to_owned(), rest.split(')').next()?.to_owned())));
    let is_item = |item: &str| item.ends_with("()") || item.starts_with(char::is_uppercase);
    let is_source = |file: &str| Path::new(file).extension().is_some_and(|e| e == "rs");
    links.filter(|(item, file)| is_source(file) && is_item(item)).collect()
}

/// Whether a source has the item: the function, and the type before it.
fn has(source: &str, item: &str) -> bool {
    let words = |kind: &str, name: &str| {
        let words = format!("{kind} {name}");
        source.match_indices(&words).any(|(at, whole)| {
            let after = source[at + whole.len()..].chars().next();
            !after.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })
    };
    let is_type = |name: &str| {
        let kinds = ["struct", "enum", "trait", "type", "const", "static", "impl", "for"];
        kinds.iter().any(|kind| words(kind, name))
    };
    match item.strip_suffix("()") {
        None => is_type(item),
        Some(path) => match path.rsplit_once("::") {
            None => words("fn", path),
            Some((ty, function)) => words("fn", function) && is_type(ty),
        },
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
/// The documents.
fn pages() -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> =
        ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(|page| root().join(page)).into();
    for folder in ["docs", "spec"] {
        let entries = fs::read_dir(root().join(folder)).unwrap();
        found.extend(entries.map(|entry| entry.unwrap().path()));
    }
    found.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    assert!(found.len() > 40, "the documents were not found");
    found
}

fn sources() -> Vec<PathBuf> {
    let folders = ["crates", "xtask", "fuzz", "examples", "benches"];
    let there = folders.iter().map(|folder| root().join(folder)).filter(|folder| folder.is_dir());
    let found: Vec<PathBuf> = there.flat_map(|folder| files(&folder, "rs")).collect();
    assert!(found.len() > 10, "the tree was not found");
    found
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}
