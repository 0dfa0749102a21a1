//! Every finding is explained, and every explanation is true.
use interp::{SENTENCES, findings, found_in_example};
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

#[test]
fn every_wrong_program_gives_its_code_and_every_right_one_does_not() {
    let mut untrue = Vec::new();
    for finding in findings().filter(|finding| !finding.wrong.is_empty()) {
        let codes = |program: &str| -> Vec<_> {
            found_in_example(finding, program).iter().map(|found| found.code).collect()
        };
        let (wrong, right) = (codes(finding.wrong), codes(finding.right));
        if !wrong.contains(&finding.code) {
            untrue.push(format!("{}: {:?} gives {wrong:?}", finding.code, finding.wrong));
        }
        let errors: Vec<_> = found_in_example(finding, finding.right)
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
    let listed: Vec<_> = SENTENCES.iter().map(|(code, _)| *code).collect();
    assert!(listed.is_sorted_by(|a, b| a < b), "{listed:?}");
    let used = codes_in(&["plan", "store", "control", "leadscrew", "cli", "lsp"]);
    let missing: Vec<_> = used
        .iter()
        .filter(|code| b"MSA".contains(&code.as_bytes()[0]) && !listed.contains(&code.as_str()))
        .collect();
    assert!(missing.is_empty(), "write their sentences into src/explain/elsewhere.rs: {missing:?}");
}

#[test]
fn findings_that_no_short_program_shows_are_few() {
    let without: Vec<_> =
        findings().filter(|finding| finding.wrong.is_empty()).map(|finding| finding.code).collect();
    assert!(without.len() <= 18, "{without:?}");
}

#[test]
fn a_code_is_explained_alone_and_on_the_page_of_all() {
    let page = interp::explanations();
    let codes =
        findings().map(|finding| finding.code).chain(SENTENCES.iter().map(|(code, _)| *code));
    for code in codes {
        let alone = interp::explanation(code).unwrap();
        let sentence = alone.lines().nth(2).unwrap();
        assert!(alone.starts_with(&format!("### {code}\n")) && page.contains(sentence), "{alone}");
    }
    assert_eq!(interp::explanation("I9999"), None);
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
