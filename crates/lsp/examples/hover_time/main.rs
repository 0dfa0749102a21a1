//! How long a hover takes in programs of 100,000 lines, right after an edit.
//!
//! `cargo run --release -p lsp --example hover_time [PROGRAM [EDIT [REPETITIONS]]]`: the whole way, from the client's
//! request over the protocol to its answer, with the edit sent just before and nothing known of the new text. Each edit
//! is made near the beginning, in the middle and near the end, and taken back; a pointer rests at the edit, in the
//! middle, or at the end. A row says how long the worst of these places took: least, median and most of its
//! repetitions, in milliseconds, and where that was. Without arguments everything is measured, once for each place.
#![allow(clippy::unwrap_used, clippy::disallowed_methods)] // a measurement may stop, and needs a clock
mod edits;
mod programs;

use edits::{Change, Edit};
use interp::Dialect;
use lsp_server::{Connection, Message, Notification, Request, RequestId};
use programs::Program;
use serde_json::{Value, json};
use std::time::Instant;

const PROGRAM: &str = "file:///long.ngc";
const TAPE: &str = "file:///long.nc";

struct Shop;

impl lsp::Host for Shop {
    fn setup(&self, uri: &str, _: &[u8]) -> Result<interp::Setup, String> {
        let dialect = if uri == TAPE { Dialect::Fanuc } else { Dialect::LinuxCnc };
        let limits = interp::Limits::default();
        let mut setup = interp::Setup { limits, ..interp::example_setup(dialect) };
        setup.parameters.set(5241, 40.0); // X of G55
        Ok(setup)
    }

    fn subprogram(&self, _: &str, _: &str) -> Option<String> {
        None
    }

    fn preflight(&self, _: &str, _: &[u8]) -> Box<dyn lsp::Preflight> {
        Box::new(NoMachine)
    }
}

/// Hovers need no machine.
struct NoMachine;

impl lsp::Preflight for NoMachine {
    fn take(&mut self) -> Option<Result<Vec<diag::Diagnostic>, String>> {
        Some(Ok(Vec::new()))
    }
}

/// An editor with one open file.
struct Client {
    connection: Connection,
    next: i32,
    uri: &'static str,
    version: i32,
    lines: Vec<String>,
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

    fn open(&mut self, program: &Program) {
        self.uri = if program.dialect == Dialect::Fanuc { TAPE } else { PROGRAM };
        self.version += 1;
        self.lines = program.text.split_inclusive('\n').map(str::to_owned).collect();
        let (uri, version) = (self.uri, self.version);
        let item =
            json!({ "uri": uri, "languageId": "gcode", "version": version, "text": program.text });
        self.tell("textDocument/didOpen", json!({ "textDocument": item }));
        self.settle();
    }

    /// Make a change and hover at once over a line (from 0), or the nearest one before it that has something to say.
    /// How many milliseconds it took.
    fn hover_after(&mut self, change: &Change, line: usize) -> f64 {
        let (first, gone) = (change.line, change.taken.matches('\n').count());
        let new: Vec<_> = change.text.split_inclusive('\n').map(str::to_owned).collect();
        self.lines.splice(first..first + gone, new);
        self.version += 1;
        let ((line_from, from), (line_to, to), text) = change.least();
        let place = |line: u32, character: u32| json!({ "line": line, "character": character });
        let range = json!({ "start": place(line_from, from), "end": place(line_to, to) });
        let change = json!({ "range": range, "text": text });
        let item = json!({ "uri": self.uri, "version": self.version });
        let edit = json!({ "textDocument": item, "contentChanges": [change] });
        let place = place(line.min(self.lines.len() - 1) as u32, 0);
        let hover = json!({ "textDocument": { "uri": self.uri }, "position": place });
        let begun = Instant::now();
        self.tell("textDocument/didChange", edit);
        let answer = self.ask("textDocument/hover", hover);
        let took = begun.elapsed().as_secs_f64() * 1e3;
        assert!(answer.is_null() || answer["contents"]["value"].is_string());
        took
    }
}

/// Times of the same question.
struct Times(Vec<f64>);

impl Times {
    fn new(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        Self(times)
    }

    fn median(&self) -> f64 {
        self.0[self.0.len() / 2]
    }

    fn least_median_most(&self) -> [f64; 3] {
        [self.0[0], self.median(), self.0[self.0.len() - 1]]
    }
}

/// The slowest of all places to edit and to look at, and where that is.
fn worst(
    client: &mut Client,
    program: &Program,
    edit: Edit,
    repetitions: usize,
) -> (Times, String, Vec<f64>) {
    let round = program.round as usize;
    let rounds = client.lines.len() / round;
    let line_at = |rounds: usize| program.first as usize + rounds * round;
    let mut places =
        vec![("top", line_at(3)), ("middle", line_at(rounds / 2)), ("end", line_at(rounds - 20))];
    places.extend(program.called.map(|line| ("subprogram", line as usize)));
    let (mut medians, mut slowest) = (Vec::new(), None);
    for (where_edited, line) in places {
        let looked =
            [("end", line_at(rounds - 12)), ("middle", line_at(rounds / 2)), ("edit", line)];
        for (where_looked, at) in looked {
            let before = at < line && where_edited != "subprogram";
            if before || matches!(edit, Edit::First(_)) && where_edited != "top" {
                continue;
            }
            let mut times = [Vec::new(), Vec::new()];
            for repetition in 0..repetitions {
                let change = edit.at(&client.lines, line, repetition);
                for (times, change) in times.iter_mut().zip([&change, &change.undone()]) {
                    times.push(client.hover_after(change, at));
                    client.settle();
                }
            }
            for (times, way) in times.into_iter().zip(["", ", undone"]) {
                let times = Times::new(times);
                medians.push(times.median());
                let slower = |(slowest, _): &(Times, String)| slowest.median() < times.median();
                if slowest.as_ref().is_none_or(slower) {
                    let place = format!("{where_edited}{way}, hover at the {where_looked}");
                    slowest = Some((times, place));
                }
            }
        }
    }
    let (times, place) = slowest.unwrap();
    (times, place, medians)
}

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let argument = |i: usize| arguments.get(i).map_or("", |it| it.as_str());
    let repetitions = argument(2).parse().unwrap_or(1);
    let (ours, theirs) = Connection::memory();
    let server = std::thread::spawn(move || lsp::serve(&theirs, &Shop).unwrap());
    let mut client = Client { connection: ours, next: 0, uri: "", version: 0, lines: Vec::new() };
    client.ask("initialize", json!({ "capabilities": {} }));
    client.tell("initialized", json!({}));
    for program in programs::all().iter().filter(|it| it.name.starts_with(argument(0))) {
        let begun = Instant::now();
        client.open(program);
        let opened = begun.elapsed().as_secs_f64() * 1e3;
        println!("{}: open to findings {opened:.0} ms", program.name);
        let mut all = Vec::new();
        for (name, edit) in edits::of(program.dialect) {
            if !argument(1).is_empty() && *name != argument(1) {
                continue;
            }
            let (times, place, medians) = worst(&mut client, program, *edit, repetitions);
            let [least, median, most] = times.least_median_most();
            println!("  {name:<11} {least:6.1} {median:6.1} {most:6.1}  {place}");
            all.extend(medians);
        }
        let all = Times::new(all);
        println!("  of all      {:6.1} median {:6.1} worst", all.median(), all.0[all.0.len() - 1]);
        client.tell("textDocument/didClose", json!({ "textDocument": { "uri": client.uri } }));
    }
    client.ask("shutdown", Value::Null);
    client.tell("exit", Value::Null);
    server.join().unwrap();
}
