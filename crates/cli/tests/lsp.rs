//! The language server, spoken to as an editor speaks: JSON-RPC over the program's standard input
//! and output.
use crate::editor::Editor;
use serde_json::{Value, json};

const URI: &str = "file:///tmp/part.ngc";

/// An editor in which this program is open.
fn open(text: &str) -> Editor {
    open_with(&[], text)
}

fn open_with(arguments: &[&str], text: &str) -> Editor {
    let mut editor = Editor::start(arguments);
    editor.open(URI, text);
    editor
}

impl Editor {
    fn at(&mut self, what: &str, line: u32, character: u32) -> Value {
        let place = json!({ "line": line, "character": character });
        let params = json!({ "textDocument": { "uri": URI }, "position": place });
        self.ask(&format!("textDocument/{what}"), params)
    }

    fn hover(&mut self, line: u32, character: u32) -> String {
        self.at("hover", line, character)["contents"]["value"].as_str().unwrap().to_owned()
    }

    fn replace(&mut self, line: u32, from: u32, to: u32, text: &str) {
        let range = json!({
            "start": { "line": line, "character": from },
            "end": { "line": line, "character": to },
        });
        self.change(URI, json!({ "range": range, "text": text }));
    }
}

const PART: &str = "\
G21 G17 G40 G49 G80 G90 G94 G54
o<hole> sub (drill one)
  #<depth> = #1
  G0 X#2 Y#3
  G1 Z-#<depth> F300
  G0 Z5
o<hole> endsub
T2 M6
G43 H2
S3000 M3
G0 X0 Y0 Z5
o<hole> call [4] [10] [20]
G0 X1 Y2
T3 M6
G43 H3
M2
";

#[test]
fn findings_come_with_their_place_code_and_remedy() {
    let mut editor = open("G21 G90\nG0 X1\nG331 Z-5 K1\nG4 P500\nM2\n");
    let findings = editor.findings();
    let codes: Vec<_> = findings.iter().map(|f| f["code"].as_str().unwrap()).collect();
    assert_eq!(codes, ["I0102", "I0904"]);
    assert_eq!(findings[0]["range"]["start"], json!({ "line": 2, "character": 0 }));
    assert_eq!(findings[0]["range"]["end"], json!({ "line": 2, "character": 4 }));
    assert!(findings[0]["message"].as_str().unwrap().contains("did you mean G33.1"));
    assert_eq!(findings[1]["severity"], 2);
    editor.leave();
}

#[test]
fn a_correction_makes_the_finding_go() {
    let mut editor = open("G21 G90 S500 M3\nG1 X1\nM2\n");
    assert_eq!(editor.findings()[0]["code"], "I0408");
    editor.replace(1, 5, 5, " F100");
    assert!(editor.findings().is_empty());
    editor.leave();
}

#[test]
fn a_hover_says_what_the_word_does_and_where_the_machine_stands() {
    let mut editor = open(PART);
    let text = editor.hover(12, 1);
    assert!(text.contains("**G0** rapid move"), "{text}");
    assert!(text.contains("| X | 10 | 1 |"), "{text}");
    assert!(text.contains("| Y | 20 | 2 |"), "{text}");
    assert!(text.contains("G21 G90 G94 G54 G43"), "{text}");
    assert!(text.contains("S3000 T2"), "{text}");
    let text = editor.hover(4, 16);
    assert!(text.contains("**F**") && text.contains("feed"), "{text}");
    let text = editor.hover(4, 8);
    assert!(text.contains("`#<depth>` = 4 before this block"), "{text}");
    assert!(text.contains("| Z | 5 | -4 |"), "{text}");
    editor.leave();
}

#[test]
fn a_hover_over_an_unknown_code_says_so() {
    let mut editor = open("G21 G90\nG123 X1\nM2\n");
    let text = editor.hover(1, 1);
    assert!(text.contains("**G123** is no known code"), "{text}");
    editor.leave();
}

#[test]
fn the_outline_shows_tools_and_subprograms() {
    let mut editor = open(PART);
    let symbols =
        editor.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": URI } }));
    let names: Vec<_> =
        symbols.as_array().unwrap().iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["o<hole>", "T2", "T3"]);
    assert_eq!(symbols[0]["detail"], "drill one");
    assert_eq!(symbols[0]["range"]["end"]["line"], 6);
    assert_eq!(symbols[1]["range"]["start"]["line"], 7);
    editor.leave();
}

#[test]
fn a_call_leads_to_its_subprogram() {
    let mut editor = open(PART);
    let place = editor.at("definition", 11, 3);
    assert_eq!(place["range"]["start"], json!({ "line": 1, "character": 2 }));
    editor.leave();
}

#[test]
fn renaming_a_parameter_changes_it_wherever_it_is_the_same_one() {
    let mut editor = open(PART);
    let place = json!({ "line": 4, "character": 9 });
    let params = json!({ "textDocument": { "uri": URI }, "position": place, "newName": "bottom" });
    let edits = editor.ask("textDocument/rename", params.clone());
    let edits = edits["changes"][URI].as_array().unwrap().clone();
    let lines: Vec<_> = edits.iter().map(|e| e["range"]["start"]["line"].as_u64()).collect();
    assert_eq!(lines, [Some(2), Some(4)]);
    assert!(edits.iter().all(|e| e["newText"] == "bottom"));
    let mut params = params;
    params["newName"] = json!("not-a-name");
    let refused = editor.ask("textDocument/rename", params);
    assert!(refused["message"].as_str().unwrap().contains("letters, digits and _"));
    editor.leave();
}

#[test]
fn formatting_touches_only_the_lines_that_change() {
    let mut editor = open("G21 G90\ng0x1 y2 (there)\nM2\n");
    let params = json!({
        "textDocument": { "uri": URI },
        "options": { "tabSize": 2, "insertSpaces": true },
    });
    let edits = editor.ask("textDocument/formatting", params);
    assert_eq!(edits.as_array().unwrap().len(), 1);
    assert_eq!(edits[0]["newText"], "G0 X1 Y2 (there)");
    assert_eq!(edits[0]["range"]["start"]["line"], 1);
    editor.leave();
}

#[test]
fn a_range_is_formatted_alone_as_it_would_be_in_the_whole() {
    let text = "o1 sub\ng0x1\nif [1 gt 0]\ng0x2\no1 endif\no1 endsub\ng0x3\nM2\n";
    let text = text.replace("\nif", "\no1 if");
    let mut editor = open(&text);
    let mut ask = |method: &str, range: Value| {
        let params = json!({
            "textDocument": { "uri": URI },
            "range": range,
            "options": { "tabSize": 2, "insertSpaces": true },
        });
        editor.ask(&format!("textDocument/{method}"), params).as_array().unwrap().clone()
    };
    let whole = ask("formatting", Value::Null);
    let at = |line: u32, character: u32| json!({ "line": line, "character": character });
    let part = ask("rangeFormatting", json!({ "start": at(3, 0), "end": at(6, 0) }));
    let wanted: Vec<_> = whole
        .iter()
        .filter(|edit| (3..6).contains(&edit["range"]["start"]["line"].as_u64().unwrap()))
        .cloned()
        .collect();
    assert!(!wanted.is_empty() && wanted.len() < whole.len());
    assert_eq!(part, wanted);
    editor.leave();
}

#[test]
fn a_goto_leads_to_its_block_and_a_do_to_its_end() {
    let text = "O1\n#1=0\nWHILE [#1 LT 2] DO1\n#1=#1+1\nEND1\nIF [#1 GT 5] GOTO 90\nG0 X1.\nGOTO 77\nN90 M30\n";
    let mut editor = open_with(&["--dialect", "fanuc"], text);
    let mut line = |from: u32, character: u32| {
        editor.at("definition", from, character)["range"]["start"]["line"].as_u64()
    };
    assert_eq!(line(5, 17), Some(8)); // GOTO
    assert_eq!((line(2, 18), line(4, 1)), (Some(4), Some(2))); // DO1, END1
    assert_eq!(line(2, 8), Some(1)); // #1: where it is set first
    assert_eq!(line(7, 1), None); // there is no N77
    let hover = editor.hover(5, 17);
    assert!(hover.contains("It leads to line 9: `N90 M30`"), "{hover}");
    let hover = editor.hover(7, 1);
    assert!(hover.contains("There is no block N77"), "{hover}");
    let hover = editor.hover(2, 18);
    assert!(hover.contains("It leads to line 5: `END1`"), "{hover}");
    editor.leave();
}

#[test]
fn what_is_not_served_is_refused_in_words() {
    let mut editor = Editor::start(&[]);
    let answer = editor.ask("textDocument/inlayHint", json!({}));
    assert!(answer["message"].as_str().unwrap().contains("not served"));
    assert!(editor.at("hover", 0, 0).is_null());
    editor.leave();
}

#[test]
fn places_behind_the_text_are_answered() {
    let mut editor = open(PART);
    for what in ["hover", "definition", "prepareRename"] {
        for (line, character) in [(9999, 0), (u32::MAX, u32::MAX)] {
            assert_eq!(editor.at(what, line, character), Value::Null, "{what}");
        }
    }
    let place = json!({ "line": u32::MAX, "character": 0 });
    let params = json!({ "textDocument": { "uri": URI }, "position": place, "newName": "deeper" });
    let told = editor.ask("textDocument/rename", params);
    assert!(told["message"].as_str().unwrap().contains("no parameter"), "{told}");
    assert!(editor.hover(12, u32::MAX).contains("| X | 10 | 1 |"));
    let told = editor.ask("textDocument/unheardOf", json!({}));
    assert_eq!(told["code"], -32601, "{told}");
    editor.leave();
}

/// What the page of a machine does where a program's words are another dialect's.
#[test]
fn a_program_is_read_as_one_for_another_dialect_when_the_editor_says_so() {
    let text = "O1000\nG21 G90\nG43 H1 Z50.\nG0 X1. ,R2.\nG65 P9100 A1.\nM30\n";
    let mut editor = open_with(&["--machine", "tapping-center"], text);
    let dialect = |found: &[Value]| {
        let other = found.iter().find(|finding| finding["code"] == "I0909");
        other.map(|finding| finding["data"].clone())
    };
    let other = json!({ "dialect": "fanuc", "people": "Fanuc's machining centres" });
    assert_eq!(dialect(&editor.findings()), Some(other.clone()));
    let mut read_as = |dialect: Value| {
        let uri = json!({ "uri": URI });
        editor.tell("leadscrew/readAs", json!({ "textDocument": uri, "dialect": dialect }));
        editor.findings()
    };
    assert_eq!(dialect(&read_as("fanuc".into())), None);
    assert_eq!(dialect(&read_as(Value::Null)), Some(other), "as the machine does");
    editor.leave();
}
