//! The licences of everything that is linked into the `leadscrew` program: who passes a binary on
//! passes them on with it.
//!
//! ```text
//!   cargo metadata ─► what `cli` needs, proc macros apart ─► LICENSE, COPYING, NOTICE of each ─► one text
//! ```
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// What the names of licence files begin with.
const NAMES: [&str; 6] = ["LICENSE", "LICENCE", "COPYING", "COPYRIGHT", "NOTICE", "UNLICENSE"];

/// The text; each library once, by name and version.
///
/// # Errors
/// cargo does not answer, or a library that is linked in has no licence file.
pub(crate) fn text(target: &str) -> Result<String, String> {
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", target];
    let output = Command::new(env!("CARGO")).args(arguments).output();
    let output = output.map_err(|e| format!("cargo: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let graph: Value = serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())?;
    let linked = linked(&graph)?;
    let mut text = format!(
        "The leadscrew program contains these {} libraries, the Rust standard library (MIT or Apache-2.0) and\n\
         the GNU C library (LGPL-2.1-or-later, linked statically: leadscrew's source and its build script link it anew).\n",
        linked.len()
    );
    for package in linked.values() {
        let word = |key: &str| package[key].as_str().unwrap_or_default();
        let (name, version) = (word("name"), word("version"));
        let folder =
            Path::new(word("manifest_path")).parent().ok_or("a manifest without folder")?;
        let _ = write!(text, "\n==== {name} {version}: {}\n", word("license")); // a String takes everything
        let files = licences(folder)?;
        let files = if files.is_empty() {
            let text = by_its_manifest(package).ok_or_else(|| {
                format!("{name} {version} has no licence file in {}", folder.display())
            })?;
            vec![text]
        } else {
            files
        };
        for file in files {
            let _ = write!(text, "\n{}\n", file.trim());
        }
    }
    Ok(text)
}

/// The packages from registries that `cli` is linked with.
fn linked(graph: &Value) -> Result<BTreeMap<String, &Value>, String> {
    let by_id = |list: &'static str| -> BTreeMap<&str, &Value> {
        let list = if list == "nodes" { &graph["resolve"]["nodes"] } else { &graph[list] };
        list.as_array()
            .into_iter()
            .flatten()
            .filter_map(|one| Some((one["id"].as_str()?, one)))
            .collect()
    };
    let (packages, nodes) = (by_id("packages"), by_id("nodes"));
    let is_macro = |package: &Value| {
        let targets = package["targets"].as_array().into_iter().flatten();
        targets
            .flat_map(|target| target["kind"].as_array().into_iter().flatten())
            .any(|kind| kind == "proc-macro")
    };
    let cli = packages.iter().find(|(_, package)| package["name"] == "cli");
    let mut open = vec![*cli.ok_or("the workspace has no package cli")?.0];
    let (mut seen, mut linked) = (std::collections::BTreeSet::new(), BTreeMap::new());
    while let Some(id) = open.pop() {
        let package =
            packages.get(id).ok_or_else(|| format!("cargo metadata names no package {id}"))?;
        if is_macro(package) || !seen.insert(id) {
            continue;
        }
        if !package["source"].is_null() {
            linked.insert(format!("{} {}", package["name"], package["version"]), *package);
        }
        let needs = nodes.get(id).and_then(|node| node["deps"].as_array()).into_iter().flatten();
        let normal = needs.filter(|dep| {
            dep["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"].is_null())
        });
        open.extend(normal.filter_map(|dep| dep["pkg"].as_str()));
    }
    Ok(linked)
}

/// The licence (MIT, else Apache 2.0) of a library that may be had under it, names its authors or
/// where they are found, and brings no file.
fn by_its_manifest(package: &Value) -> Option<String> {
    let licences = package["license"].as_str()?;
    let named = package["authors"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let mut holders = named.collect::<Vec<_>>().join(", ");
    if let (true, Some(name), Some(repository)) =
        (holders.is_empty(), package["name"].as_str(), package["repository"].as_str())
    {
        holders = format!("the authors of {name}, {repository}");
    }
    if holders.is_empty() || licences.contains(" AND ") {
        return None;
    }
    let (_, permission) = MIT.split_once(PERMISSION)?;
    let may_be = |name: &str| licences.split([' ', '/', '(', ')']).any(|licence| licence == name);
    if may_be("MIT") {
        Some(format!("Copyright (c) {holders}\n\n{PERMISSION}{permission}"))
    } else if may_be("Apache-2.0") {
        Some(format!("Copyright (c) {holders}\n\n{APACHE}"))
    } else {
        None
    }
}

/// Leadscrew's own, whose words behind the line of copyright are everybody's.
const MIT: &str = include_str!("../../LICENSE-MIT");
/// The same for each library.
const APACHE: &str = include_str!("../../LICENSE-APACHE");
/// What these words begin with.
const PERMISSION: &str = "Permission is hereby granted";

/// The licence files of a folder, by name.
fn licences(folder: &Path) -> Result<Vec<String>, String> {
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().to_ascii_uppercase();
        if NAMES.iter().any(|begin| name.starts_with(begin)) && entry.path().is_file() {
            let bytes = std::fs::read(entry.path()).map_err(failed)?;
            files.insert(name, String::from_utf8_lossy(&bytes).into_owned());
        }
    }
    Ok(files.into_values().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_is_linked_in_has_a_licence() {
        let text = text("x86_64-unknown-linux-gnu").unwrap();
        assert!(text.contains("\n==== serde "));
        assert!(text.matches("\n==== ").count() > 50);
    }

    #[test]
    fn a_library_without_a_file_has_the_licence_of_its_manifest() {
        let library = |license: &str, authors: &[&str]| serde_json::json!({"license": license, "authors": authors});
        let text =
            by_its_manifest(&library("Apache-2.0 OR MIT", &["A. Author", "B. Builder"])).unwrap();
        assert!(
            text.starts_with("Copyright (c) A. Author, B. Builder\n\nPermission is hereby granted")
        );
        assert!(text.contains("WITHOUT WARRANTY OF ANY KIND"));
        let unnamed =
            serde_json::json!({"license": "MIT", "name": "far", "repository": "https://far"});
        let text = by_its_manifest(&unnamed).unwrap();
        assert!(text.starts_with("Copyright (c) the authors of far, https://far\n"));
        let text = by_its_manifest(&library("Apache-2.0", &["A. Author"])).unwrap();
        assert!(text.contains("Apache License"));
        for (license, authors) in
            [("MIT", &[][..]), ("BSD-3-Clause", &["A. Author"]), ("MIT AND Zlib", &["A. Author"])]
        {
            assert_eq!(by_its_manifest(&library(license, authors)), None, "{license}");
        }
    }

    #[test]
    fn what_is_linked_in_is_named_and_what_only_builds_or_tests_is_not() {
        let package = |name: &str, source: Option<&str>, kind: &str| serde_json::json!({"id": name, "name": name, "version": "1", "source": source, "targets": [{"kind": [kind]}]});
        let needs = |name: &str, kind: Option<&str>| serde_json::json!({"pkg": name, "dep_kinds": [{"kind": kind}]});
        let graph = serde_json::json!({
            "packages": [
                package("cli", None, "bin"), package("own", None, "lib"), package("far", Some("r"), "lib"),
                package("derive", Some("r"), "proc-macro"), package("tester", Some("r"), "lib"),
                package("syntax", Some("r"), "lib"),
            ],
            "resolve": {"nodes": [
                {"id": "cli", "deps": [needs("own", None), needs("tester", Some("dev"))]},
                {"id": "own", "deps": [needs("far", None), needs("derive", None)]},
                {"id": "derive", "deps": [needs("syntax", None)]},
            ]},
        });
        let linked = linked(&graph).unwrap();
        assert_eq!(linked.values().map(|one| &one["name"]).collect::<Vec<_>>(), ["far"]);
    }
}
