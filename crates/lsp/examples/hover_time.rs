//! How long a hover takes in a program of 100,000 lines, right after an edit.
//!
//! `cargo run --release -p lsp --example hover_time`: the whole way, from the client's request over the protocol to
//! its answer, with the edit sent just before and nothing known of the new text.
#![allow(clippy::unwrap_used, clippy::disallowed_methods)] // a measurement may stop, and needs a clock
use lsp_server::{Connection, Message, Notification, Request, RequestId};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

const LINES: u32 = 100_000;
const URI: &str = "file:///long.ngc";

struct Nowhere;

impl lsp::Host for Nowhere {
    fn setup(&self, _: &str, _: &[u8]) -> Result<interp::Setup, String> {
        Ok(interp::Setup::default())
    }

    fn subprogram(&self, _: &str, _: &str) -> Option<String> {
        None
    }
}

/// What is edited, and the line (from 0) asked about then.
struct Edit {
    line: u32,
    characters: (u32, u32),
    text: &'static str,
    hovered: u32,
}

struct Client {
    connection: Connection,
    next: i32,
    version: i32,
}

impl Client {
    fn tell(&self, method: &str, params: Value) {
        let message = Notification::new(method.to_owned(), params);
        self.connection.sender.send(Message::Notification(message)).unwrap();
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = RequestId::from(self.next);
        let request = Request::new(id.clone(), method.to_owned(), params);
        self.connection.sender.send(Message::Request(request)).unwrap();
        loop {
            if let Message::Response(response) = self.connection.receiver.recv().unwrap()
                && response.id == id
            {
                return response.result.unwrap_or_default();
            }
        }
    }

    /// Wait until the findings of the text as it is now are told.
    fn settle(&self) {
        loop {
            if let Message::Notification(told) = self.connection.receiver.recv().unwrap()
                && told.params["version"] == self.version
            {
                return;
            }
        }
    }

    /// Put a text with a digit in the place of some characters of a line, then hover over another line at once.
    fn hover_after_edit(&mut self, edit: &Edit) -> Duration {
        self.version += 1;
        let &Edit { line, characters: (from, to), text, hovered } = edit;
        let place = |character: u32| json!({ "line": line, "character": character });
        let text = text.replace('#', &(self.version % 10).to_string());
        let change = json!({ "range": { "start": place(from), "end": place(to) }, "text": text });
        let item = json!({ "uri": URI, "version": self.version });
        let begun = Instant::now();
        self.tell(
            "textDocument/didChange",
            json!({ "textDocument": item, "contentChanges": [change] }),
        );
        let answer = self.ask(
            "textDocument/hover",
            json!({
                "textDocument": { "uri": URI },
                "position": { "line": hovered, "character": 0 },
            }),
        );
        let took = begun.elapsed();
        assert!(answer["contents"]["value"].as_str().unwrap().contains("machine, mm"));
        took
    }
}

fn program() -> String {
    let mut text = "G21 G90 G94\nF1000 S1000 M3\nG1\n".to_owned();
    for i in 3..LINES - 1 {
        let (x, y) = (i % 977, i % 613);
        text += &format!("X{x}.{:03} Y{y}.5 Z-{}.25\n", i % 1000, i % 7);
    }
    text + "M2\n"
}

fn main() {
    let (ours, theirs) = Connection::memory();
    let server = std::thread::spawn(move || lsp::serve(&theirs, &Nowhere).unwrap());
    let mut client = Client { connection: ours, next: 0, version: 1 };
    client.ask("initialize", json!({ "capabilities": {} }));
    client.tell("initialized", json!({}));
    let item = json!({ "uri": URI, "languageId": "gcode", "version": 1, "text": program() });
    let begun = Instant::now();
    client.tell("textDocument/didOpen", json!({ "textDocument": item }));
    client.settle();
    println!("{LINES} lines: open to findings {:.1} ms", begun.elapsed().as_secs_f64() * 1e3);
    let end = LINES - 9;
    for (what, line, characters, text, hovered) in [
        ("a coordinate and a hover at the end", end - 1, (1, 2), "#", end),
        ("a coordinate and a hover in the middle", LINES / 2, (1, 2), "#", LINES / 2 + 1),
        ("a coordinate at the beginning, hover at the end", 5, (1, 2), "#", end),
        ("the feed at the beginning, hover at the end", 1, (4, 5), "#", end),
        ("a line more at the beginning, hover at the end", 5, (0, 0), "X# Y2\n", end),
    ] {
        let edit = Edit { line, characters, text, hovered };
        let mut times: Vec<_> = (0..9)
            .map(|_| {
                let took = client.hover_after_edit(&edit);
                client.settle();
                took
            })
            .collect();
        times.sort();
        let ms = |i: usize| times[i].as_secs_f64() * 1e3;
        println!("{what}: {:.1} ms median, {:.1} ms worst of {}", ms(4), ms(8), times.len());
    }
    client.ask("shutdown", Value::Null);
    client.tell("exit", Value::Null);
    server.join().unwrap();
}
