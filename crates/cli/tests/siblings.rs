//! Programs and command lines that were tried beside those that were reported:
//! docs/corpus/siblings.tsv has what was expected of each, and what came.
use crate::common::{complained, leadscrew_in, root, said};
use std::fs;

/// The file whose table is executed; `UPDATE_SPEC=1` writes its column "got" anew.
const TABLE: &str = "docs/corpus/siblings.tsv";

/// The codes of findings in a text, each once, in their order.
fn codes(text: &str) -> Vec<String> {
    let kinds = ["error[", "warning[", "note["];
    let mut all: Vec<String> = Vec::new();
    for line in text.lines() {
        let rest = kinds.iter().find_map(|kind| line.strip_prefix(kind));
        let code = rest.and_then(|rest| rest.split_once("]: ")).map(|(code, _)| code.to_owned());
        all.extend(code.filter(|code| !all.contains(code)));
    }
    all
}

#[test]
fn siblings_of_what_was_reported_are_answered_as_expected() {
    let table = fs::read_to_string(root().join(TABLE)).unwrap();
    let tools = root().join("programs/tools.toml");
    let mut anew = String::new();
    let mut wrong = Vec::new();
    for (number, row) in table.lines().enumerate() {
        let cells: Vec<&str> = row.split('\t').collect();
        let [class, written, arguments, expected, _, program] = cells[..] else {
            panic!("line {}: {row}", number + 1)
        };
        if number == 0 {
            anew += &format!("{row}\n");
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("part.ngc"), program.replace("\\n", "\n")).unwrap();
        let typed = arguments.replace("{tools}", tools.to_str().unwrap()).replace("{}", "part.ngc");
        let words: Vec<&str> = typed.split(' ').collect();
        let output = leadscrew_in(folder.path(), &words);
        let text = said(&output) + &complained(&output);
        let exit = format!("exit {}", output.status.code().unwrap_or(-1));
        for wanted in expected.split(" & ") {
            let is_met = match (wanted.strip_prefix("exit "), wanted.strip_prefix('!')) {
                (Some(_), _) => wanted == exit,
                (None, Some(unwanted)) => !text.contains(unwanted),
                (None, None) => text.contains(wanted),
            };
            if !is_met {
                wrong.push(format!("line {}: {wanted}, found {exit}:\n{text}", number + 1));
            }
        }
        let got = [vec![exit], codes(&text)].concat().join(" ");
        anew += &[class, written, arguments, expected, &got, program].join("\t");
        anew.push('\n');
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    if std::env::var_os("UPDATE_SPEC").is_some() {
        fs::write(root().join(TABLE), &anew).unwrap();
    } else {
        assert_eq!(table, anew, "UPDATE_SPEC=1 writes {TABLE} anew");
    }
}
