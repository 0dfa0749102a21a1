//! Every finding is explained, and every explanation is true: `docs/diagnostics.md`.
//!
//! `UPDATE_SPEC=1 cargo test -p interp --test all diagnostics::` writes the page anew.
use crate::elsewhere;
use diag::{Diagnostic, Severity};
use interp::{Finding, Setup, example_setup, findings};
use std::{
    collections::BTreeSet,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

/// Everything that is found in a program of the list.
fn found(finding: &Finding, program: &str) -> Vec<Diagnostic> {
    let setup = Setup { has_example_tools: true, ..example_setup(finding.dialect) };
    let text = whole(program);
    let mut all = interp::check(text.as_bytes(), &setup);
    all.extend(interp::lint(text.as_bytes(), &setup));
    all
}

/// A program that does not end by itself ends with M2.
fn whole(program: &str) -> String {
    let is_end = |word: &str| matches!(word, "M2" | "M30" | "M99" | "%" | "(no");
    let ends = program.split_whitespace().any(is_end);
    if ends { format!("{program}\n") } else { format!("{program}\nM2\n") }
}

#[test]
fn every_wrong_program_gives_its_code_and_every_right_one_does_not() {
    let mut untrue = Vec::new();
    for finding in findings().filter(|finding| !finding.wrong.is_empty()) {
        let codes = |program: &str| -> Vec<_> {
            found(finding, program).iter().map(|found| found.code).collect()
        };
        let (wrong, right) = (codes(finding.wrong), codes(finding.right));
        if !wrong.contains(&finding.code) {
            untrue.push(format!("{}: {:?} gives {wrong:?}", finding.code, finding.wrong));
        }
        let errors: Vec<_> = found(finding, finding.right)
            .iter()
            .filter(|found| found.is_error())
            .map(|found| format!("{} {}", found.code, found.message))
            .collect();
        if right.contains(&finding.code) || !errors.is_empty() {
            untrue
                .push(format!("{}: {:?} gives {right:?} {errors:?}", finding.code, finding.right));
        }
    }
    assert!(untrue.is_empty(), "{}", untrue.join("\n"));
}

#[test]
fn every_code_is_in_the_list_once_and_in_order() {
    let listed: Vec<_> = findings().map(|finding| finding.code).collect();
    assert!(listed.is_sorted_by(|a, b| a[1..] < b[1..] || a[..1] > b[..1]), "{listed:?}");
    let used = codes_in(&["interp", "gcode"]);
    let missing: Vec<_> = used.iter().filter(|code| !listed.contains(&code.as_str())).collect();
    assert!(missing.is_empty(), "not explained: {missing:?}");
    let unused: Vec<_> = listed.iter().filter(|code| !used.contains(**code)).collect();
    assert!(unused.is_empty(), "explained and never used: {unused:?}");
}

#[test]
fn every_code_of_planner_files_and_editor_has_its_sentence() {
    let listed: Vec<_> = elsewhere::SENTENCES.iter().map(|(code, _)| *code).collect();
    assert!(listed.is_sorted_by(|a, b| a < b), "{listed:?}");
    let used = codes_in(&["plan", "store", "control", "leadscrew", "cli", "lsp"]);
    let missing: Vec<_> = used
        .iter()
        .filter(|code| b"MSA".contains(&code.as_bytes()[0]) && !listed.contains(&code.as_str()))
        .collect();
    assert!(missing.is_empty(), "write their sentences into tests/elsewhere: {missing:?}");
}

#[test]
fn findings_that_no_short_program_shows_are_few() {
    let without: Vec<_> =
        findings().filter(|finding| finding.wrong.is_empty()).map(|finding| finding.code).collect();
    assert!(without.len() <= 18, "{without:?}");
}

#[test]
fn the_page_is_made_from_the_list() {
    let path = root().join("docs/diagnostics.md");
    let page = page();
    if std::env::var_os("UPDATE_SPEC").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap_or_default();
    assert!(written == page, "UPDATE_SPEC=1 cargo test -p interp --test all diagnostics::");
}

fn page() -> String {
    let mut page = String::from(
        "# What can be wrong with a program\n\n\
         Made from the list by which the tests run every program of this page (`crates/interp/src/explain`): the wrong one gives \
         the code, the right one does not. `leadscrew check FILE` or `leadscrew check FOLDER` says all findings of a program at \
         once; `--format json` and `--format sarif` say them to other programs. A program that does not end by itself is meant \
         with `M2` behind it. T1 is an end mill of 10 mm, T2 a tap M6.\n\n\
         *error*: the program is refused. *warning*: legal, and likely to hurt. *note*: worth knowing.\n",
    );
    for finding in findings() {
        let _ = write!(page, "\n### {}\n\n{}", finding.code, finding.sentence);
        let dialect = match finding.dialect {
            interp::Dialect::LinuxCnc => "gcode".to_owned(),
            other => format!("gcode --dialect {}", other.name()),
        };
        if finding.wrong.is_empty() {
            page += "\n";
            continue;
        }
        let said = found(finding, finding.wrong);
        let said = said.iter().find(|found| found.code == finding.code).unwrap();
        let severity = match said.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        let help = said.help.as_ref().map(|help| format!(" — {help}")).unwrap_or_default();
        let _ = write!(
            page,
            "\n\n```{dialect}\n{}\n```\n\n> {severity}, line {}: {}{help}\n\nRight:\n\n```{dialect}\n{}\n```\n",
            shown(finding.wrong),
            said.span.line,
            said.message,
            shown(finding.right),
        );
    }
    page += "\n## Before motion, in files and on the command line\n\n\
        What the planner finds (M), what is wrong with machine files, tool tables and parameter files (S), and what command line \
        and editor say (A). Each says its own numbers.\n\n| code | what it means |\n|---|---|\n";
    for (code, sentence) in elsewhere::SENTENCES {
        let _ = writeln!(page, "| {code} | {sentence} |");
    }
    page
}

/// Control characters made visible.
fn shown(program: &str) -> String {
    program.replace('\0', "␀").replace('\r', "␍")
}

fn codes_in(crates: &[&str]) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    for name in crates {
        for path in sources(&root().join("crates").join(name).join("src")) {
            if path.components().any(|part| part.as_os_str() == "explain") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            all.extend(codes_of(&text).map(|(_, code)| code));
        }
    }
    all
}

/// Codes such as `"I0101"` and where they stand.
fn codes_of(text: &str) -> impl Iterator<Item = (usize, String)> + '_ {
    text.match_indices('"').filter_map(|(at, _)| {
        let code = text.get(at + 1..at + 6)?;
        let closed = text.as_bytes().get(at + 6) == Some(&b'"');
        let letter = code.as_bytes()[0].is_ascii_uppercase();
        let digits = code.bytes().skip(1).all(|byte| byte.is_ascii_digit());
        (closed && letter && digits).then(|| (at, code.to_owned()))
    })
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
