//! The language server over a socket: what an editor of the page is told of a program, on this
//! machine and with its tools.

use crate::common::{Served, Socket};
use serde_json::{Value, json};
use std::fmt::Write as _;
use test_support::size;
use tungstenite::Message;

/// Until a message of the language server is this one.
fn until(socket: &mut Socket, is_it: impl Fn(&Value) -> bool) -> Value {
    loop {
        if let Message::Text(text) = socket.socket.read().unwrap() {
            let message: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(message["jsonrpc"], "2.0", "{message}");
            if is_it(&message) {
                return message;
            }
        }
    }
}

fn greeted(served: &Served) -> Socket {
    let mut socket = served.socket_at("/lsp", "");
    socket.send(&json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": { "capabilities": {} } }));
    let answer = until(&mut socket, |message| message["id"] == 1);
    assert_eq!(answer["result"]["serverInfo"]["name"], "leadscrew", "{answer}");
    socket.send(&json!({ "jsonrpc": "2.0", "method": "initialized", "params": {} }));
    socket
}

fn open(socket: &mut Socket, uri: &str, text: &str) {
    let document = json!({ "uri": uri, "languageId": "gcode", "version": 1, "text": text });
    let params = json!({ "textDocument": document });
    socket.send(&json!({ "jsonrpc": "2.0", "method": "textDocument/didOpen", "params": params }));
}

/// Diagnostics that say this.
fn found(socket: &mut Socket, uri: &str, version: u64, says: &str) -> Value {
    until(socket, |message| {
        message["method"] == "textDocument/publishDiagnostics"
            && message["params"]["uri"] == uri
            && message["params"]["version"].as_u64().is_none_or(|of| of == version)
            && message["params"]["diagnostics"].to_string().contains(says)
    })
}

#[test]
fn an_editor_is_told_what_this_machine_makes_of_a_program() {
    let served = Served::at_pace(1.0);
    let mut socket = greeted(&served);
    // a travel of this machine, in a text that is not saved
    open(&mut socket, "program:/new.ngc", "G21 G90\nG53 G0 X9000\nM2\n");
    found(&mut socket, "program:/new.ngc", 1, "9000");
    // a place outside the folder is none: the text stands for itself
    open(&mut socket, "program:/../../etc/passwd", "G21 G90\nG53 G0 Y8000\nM2\n");
    found(&mut socket, "program:/../../etc/passwd", 1, "8000");
}

#[test]
fn a_long_program_is_opened_and_edited_while_the_plate_is_cut_and_the_plate_is_good() {
    let served = Served::at_pace(20.0);
    served.power_on();
    served.home();
    served.accepted(json!({ "request": "load", "program": "plate.ngc" }));
    let mut socket = greeted(&served);
    let mut text = String::from("G21 G90 G54 G94\nF600\n");
    for line in 0..size::of(20_000, 100_000) {
        writeln!(text, "G1 X{} Y{}", line % 100, line % 70).unwrap();
    }
    text.push_str("G53 G0 X9000\nM2\n");
    served.accepted(json!({ "request": "start" }));
    open(&mut socket, "program:/long.ngc", &text);
    found(&mut socket, "program:/long.ngc", 1, "9000");
    let range =
        json!({ "start": { "line": 1, "character": 0 }, "end": { "line": 1, "character": 4 } });
    let params = json!({
        "textDocument": { "uri": "program:/long.ngc", "version": 2 },
        "contentChanges": [{ "range": range, "text": "G1 G2 F600" }],
    });
    socket.send(&json!({ "jsonrpc": "2.0", "method": "textDocument/didChange", "params": params }));
    found(&mut socket, "program:/long.ngc", 2, "\"line\":1");
    let end = served.until("the end", |status| status["execution"] == "PROGRAM_COMPLETED");
    assert_eq!(end["features"], json!({ "good": 36, "failed": 0, "not_judged": 0 }));
}

/// What is told next of a text as it is.
fn codes_next(socket: &mut Socket, uri: &str) -> Vec<String> {
    let told = until(socket, |message| {
        message["method"] == "textDocument/publishDiagnostics" && message["params"]["uri"] == uri
    });
    let all = told["params"]["diagnostics"].as_array().unwrap();
    all.iter().map(|finding| finding["code"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn findings_follow_the_offsets_and_the_tools_of_the_control() {
    let served = Served::at_pace(20.0);
    served.power_on();
    served.home();
    let mut socket = greeted(&served);
    let uri = "program:/new.ngc";
    open(&mut socket, uri, "G21 G90 G54\nT1 M6\nG43 H1\nG0 Z0\nG0 X100\nM2\n");
    let is_beyond = |codes: &[String]| codes.iter().any(|code| code == "M0301");
    let codes = codes_next(&mut socket, uri);
    assert!(!is_beyond(&codes), "{codes:?}");
    let shift = |at: f64| json!({ "request": "set_work_offset", "work_offset": "G54", "axis": "X", "at_mm": at });
    served.accepted(shift(200.0)); // X100 of it is 300 mm, beyond the travel
    let codes = codes_next(&mut socket, uri);
    assert!(is_beyond(&codes), "{codes:?}");
    served.accepted(shift(-250.0));
    assert!(!is_beyond(&codes_next(&mut socket, uri)));
    let length = |value: f64| json!({ "request": "edit_tool", "tool": 1, "field": "length", "value_mm": value });
    served.accepted(length(700.0));
    let codes = codes_next(&mut socket, uri);
    assert!(is_beyond(&codes), "{codes:?}");
    served.accepted(length(100.0));
    assert!(!is_beyond(&codes_next(&mut socket, uri)));
}

#[test]
fn what_is_no_json_rpc_ends_the_conversation_and_nothing_else() {
    let served = Served::at_pace(1.0);
    let mut socket = served.socket_at("/lsp", "");
    socket.socket.send(Message::text("{\"jsonrpc\":")).unwrap();
    while socket.socket.read().is_ok() {}
    greeted(&served);
}
