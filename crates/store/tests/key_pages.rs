//! The pages of keys: `docs/machine-files.md`, `docs/tool-tables.md`, `docs/cam-libraries.md`, made
//! from what the readers ask for; their examples are read.
//!
//! `UPDATE_SPEC=1 cargo test -p store --test all key_pages::` writes them anew.
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use store::AskedKey;

/// What stands between the head of a page and its tables.
const BEGIN: &str = "<!-- keys: written by a test of store -->\n";

fn page(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name)
}

/// Holds a page's tables against these, or writes them.
fn hold(name: &str, tables: &str) {
    let text = fs::read_to_string(page(name)).unwrap();
    let (head, written) = text.split_once(BEGIN).unwrap_or_else(|| panic!("{name} has no {BEGIN}"));
    if std::env::var_os("UPDATE_SPEC").is_some_and(|value| value == "1") {
        fs::write(page(name), format!("{head}{BEGIN}{tables}")).unwrap();
    } else {
        assert!(written == tables, "UPDATE_SPEC=1 cargo test -p store --test all key_pages::");
    }
}

/// The examples of a page: its blocks in TOML.
fn examples(name: &str) -> Vec<String> {
    let text = fs::read_to_string(page(name)).unwrap();
    let blocks = text.split("```toml\n").skip(1);
    blocks.map(|block| block.split("```").next().unwrap().to_owned()).collect()
}

fn row(key: &AskedKey) -> String {
    let must = if key.must { "yes" } else { "" };
    format!("| `{}` | {} | {must} |\n", key.key, key.value.replace('|', "\\|"))
}

const HEAD: &str = "\n| key | value | must |\n|---|---|---|\n";

/// One table a section, in the order in which the reader asks.
fn by_section<'k>(keys: impl IntoIterator<Item = &'k AskedKey>) -> String {
    let mut sections: Vec<(String, String)> = Vec::new();
    for key in keys {
        let title =
            if key.table.is_empty() { "at the top".into() } else { format!("`{}`", key.table) };
        match sections.iter_mut().find(|(name, _)| *name == title) {
            Some((_, rows)) => *rows += &row(key),
            None => sections.push((title, row(key))),
        }
    }
    let sections = sections.iter().map(|(title, rows)| format!("\n## {title}\n{HEAD}{rows}"));
    sections.collect::<Vec<_>>().concat()
}

#[test]
fn the_page_of_machine_files_has_each_key_that_is_asked_for() {
    // of axes that are alike, one linear and one that turns
    let keys = store::machine::asked_keys();
    let other = ["y", "z", "a", "b", "u", "v", "w"];
    let is_shown = |key: &&AskedKey| {
        !other.iter().any(|axis| {
            let table = key.table.trim_start_matches('[');
            table.starts_with(&format!("axes.{axis}]"))
                || table.starts_with(&format!("axes.{axis}."))
        })
    };
    let shown: Vec<_> = keys.iter().filter(is_shown).collect();
    assert!(shown.len() > 200, "{}", shown.len());
    hold("machine-files.md", &by_section(shown));
    for example in examples("machine-files.md") {
        let machine = store::machine::parse(&example, 0);
        let machine = machine.unwrap_or_else(|found| panic!("{example}: {found:?}"));
        assert!(machine.setup.chuck.is_some() && machine.setup.tailstock.is_some());
    }
}

#[test]
fn the_page_of_tool_tables_has_each_key_of_each_kind() {
    let kinds = store::tools::asked_keys();
    let of_all = |key: &AskedKey| {
        kinds.iter().all(|(_, keys)| {
            keys.iter()
                .any(|one| one.key == key.key && one.table == key.table && one.must == key.must)
        })
    };
    let common = kinds[0].1.iter().filter(|key| of_all(key));
    let mut tables = by_section(common);
    for (kind, keys) in &kinds {
        let own: String = keys.iter().filter(|key| !of_all(key)).map(row).collect();
        if !own.is_empty() {
            let _ = write!(tables, "\n## kind = \"{kind}\"\n{HEAD}{own}");
        }
    }
    hold("tool-tables.md", &tables);
    for example in examples("tool-tables.md") {
        store::tools::parse_toml(&example, 0)
            .unwrap_or_else(|found| panic!("{example}: {found:?}"));
    }
}

#[test]
fn the_page_of_cam_libraries_has_each_key_of_each_kind() {
    let kinds = store::cams::asked_keys();
    let of_all = |key: &AskedKey| kinds.iter().all(|(_, keys)| keys.contains(key));
    let mut tables = by_section(kinds[0].1.iter().filter(|key| of_all(key)));
    for (kind, keys) in &kinds {
        let own: String = keys.iter().filter(|key| !of_all(key)).map(row).collect();
        let _ = write!(tables, "\n## kind = \"{kind}\"\n{HEAD}{own}");
    }
    hold("cam-libraries.md", &tables);
    for example in examples("cam-libraries.md") {
        store::cams::parse(&example).unwrap_or_else(|found| panic!("{example}: {found:?}"));
    }
}

/// Each wrong key of a file is said, not the first one alone.
#[test]
fn all_wrong_keys_of_a_file_are_said_at_once() {
    let machine = "extends = \"lathe\"\nnam = \"x\"\n[setup]\nspindle_nose = 80\n[setup.chuk]\nz_mm = 1\n[axes.x]\ntravel_form_mm = 1\n";
    let found = store::machine::parse(machine, 0).unwrap_err();
    for key in ["nam", "spindle_nose", "chuk", "travel_form_mm"] {
        assert!(found.iter().any(|f| f.message.contains(&format!("`{key}`"))), "{key}: {found:?}");
    }
    let tools = "[[tool]]\nnumber = 1\nkind = \"drill\"\nlength_mm = 100\ndiametre_mm = 5\npoint_angel_deg = 118\n";
    let found = store::tools::parse_toml(tools, 0).unwrap_err();
    for key in ["diametre_mm", "point_angel_deg"] {
        assert!(found.iter().any(|f| f.message.contains(&format!("`{key}`"))), "{key}: {found:?}");
    }
}
