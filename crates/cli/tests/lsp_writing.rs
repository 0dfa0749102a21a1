//! What an editor offers while a program is written: completion, quick fixes, the time that it
//! takes.
use crate::editor::Editor;
use serde_json::{Value, json};

const URI: &str = "file:///tmp/part.ngc";

fn open(text: &str) -> Editor {
    let mut editor = Editor::start(&["--machine", "tapping-center"]);
    editor.open(URI, text);
    editor
}

/// Labels and details of what is offered.
fn offered(editor: &mut Editor, line: u32, character: u32) -> Vec<(String, String)> {
    let place = json!({ "line": line, "character": character });
    let params = json!({ "textDocument": { "uri": URI }, "position": place });
    let items = editor.ask("textDocument/completion", params);
    let text = |item: &Value, key: &str| item[key].as_str().unwrap().to_owned();
    items.as_array().unwrap().iter().map(|i| (text(i, "label"), text(i, "detail"))).collect()
}

fn fixes(editor: &mut Editor) -> Vec<Value> {
    let range =
        json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 999, "character": 0 } });
    let params =
        json!({ "textDocument": { "uri": URI }, "range": range, "context": { "diagnostics": [] } });
    editor.ask("textDocument/codeAction", params).as_array().unwrap().clone()
}

/// Finds something with this code, offers this, and finds nothing of the code once it is taken.
fn mended(text: &str, code: &str, title: &str) {
    let mut editor = open(text);
    let has = |findings: &[Value]| findings.iter().any(|finding| finding["code"] == code);
    let findings = editor.findings();
    assert!(has(&findings), "{findings:?}");
    let all = fixes(&mut editor);
    let of_code = |fix: &&Value| fix["diagnostics"][0]["code"] == code;
    let fix = all.iter().find(of_code).unwrap_or_else(|| panic!("{all:?} in {findings:?}"));
    assert_eq!(fix["title"], title);
    let mut edits = fix["edit"]["changes"][URI].as_array().unwrap().clone();
    edits.sort_by_key(|edit| edit["range"]["start"]["character"].as_u64());
    let item = json!({ "uri": URI, "version": 2 });
    // from behind, so that places before it stay
    let changes: Vec<_> = edits
        .iter()
        .rev()
        .map(|edit| json!({ "range": edit["range"], "text": edit["newText"] }))
        .collect();
    let params = json!({ "textDocument": item, "contentChanges": changes });
    editor.tell("textDocument/didChange", params);
    let findings = editor.findings();
    assert!(!has(&findings), "{findings:?}");
    editor.leave();
}

#[test]
fn a_code_is_completed_with_what_it_does() {
    let mut editor = open("G21 G90\nG8\nM\n(G8)\n");
    let all = offered(&mut editor, 1, 2);
    assert!(all.contains(&("G84".into(), "right-hand tapping".into())), "{all:?}");
    assert!(all.iter().all(|(label, _)| label.starts_with('G')));
    let all = offered(&mut editor, 2, 1);
    assert!(all.iter().any(|(label, _)| label == "M6") && !all.iter().any(|(l, _)| l == "G0"));
    assert!(offered(&mut editor, 3, 3).is_empty(), "of a comment nothing is completed");
    editor.leave();
}

#[test]
fn a_code_brings_the_words_that_it_takes() {
    let mut editor = open("G21 G90\nG84 Z-10 \nG4 \n");
    let all = offered(&mut editor, 1, 9);
    let role = |letter: &str| all.iter().find(|(l, _)| l == letter).map(|(_, role)| role.as_str());
    assert_eq!(role("R"), Some("level to which the tool goes fast, and from which it feeds"));
    assert_eq!(role("Z"), None, "it stands there already");
    let all = offered(&mut editor, 2, 3);
    assert!(all.contains(&("P".into(), "seconds to wait".into())), "{all:?}");
    editor.leave();
}

#[test]
fn a_fix_writes_the_feed_that_the_axes_can() {
    let text = "G21 G90 G94\nS500 M3\nG0 X0 Y0 Z5\nG1 X20 F60000\nM2\n";
    mended(text, "M0304", "Write F30000");
    // F stands in a block before: it is written into this one
    mended("G21 G90 G94 F60000\nS500 M3\nG0 Z5\nG1 X20\nM2\n", "M0304", "Write F30000");
}

#[test]
fn a_fix_writes_the_coordinate_that_the_axis_can_reach() {
    mended("G21 G90\nG0 X900\nM2\n", "M0301", "Write X250");
    mended("G20 G90\nG54\nG0 X900\nM2\n", "M0301", "Write X9.8425");
    // machine coordinates, whatever the work offset in force
    mended("G21 G90 G54\nG53 G0 X-600\nM2\n", "M0301", "Write X-500");
    mended("G20 G90 G54\nG53 G0 X-30\nM2\n", "M0301", "Write X-19.685");
}

#[test]
fn a_fix_is_none_where_the_program_does_not_say_the_number_itself() {
    let mut editor = open("G21 G90\n#1 = 9000\nG53 G0 X#1\nM2\n");
    assert_eq!(editor.findings()[0]["code"], "M0301");
    assert!(fixes(&mut editor).is_empty());
    editor.leave();
}

#[test]
fn a_fix_writes_the_speed_and_the_feed_of_a_tap_together() {
    let drill =
        "G21 G90 G94 G54\nT2 M6\nG43 H2\nS3000 M3\nG0 X12 Y12 Z5\nG81 X12 Y12 Z-26 R5 F300\nG80\n";
    let tap = "T3 M6\nG43 H3\nS9000 M3\nG0 X12 Y12 Z5\nG84 X12 Y12 Z-20 R5 F9000\nM2\n";
    mended(&format!("{drill}{tap}"), "M0321", "Write S6000 F6000");
    let tap = tap.replace("9000", "3000").replace("F3000", "F2500");
    mended(&format!("{drill}{tap}"), "M0326", "Write F3000");
}

#[test]
fn the_time_that_a_program_takes_is_told_once_it_is_known() {
    let mut editor = open("G21 G90\nG4 P7\nM2\n");
    let params = json!({ "textDocument": { "uri": URI } });
    let answer = editor.ask("leadscrew/plannedTime", params.clone());
    assert!((answer["planned_s"].as_f64().unwrap() - 7.0).abs() < 0.1, "{answer}");
    editor.change(URI, json!({ "text": "G21 G90\nG53 G0 X9000\nM2\n" }));
    let answer = editor.ask("leadscrew/plannedTime", params);
    assert_eq!(answer, json!({ "planned_s": null }), "what is refused takes no time");
    editor.leave();
}
