//! Processor time of the language server in programs of 100,000 lines, after an edit.
//!
//! `cargo run --release -p lsp --example hover_time [PROGRAM [EDIT [REPETITIONS]]]`: the whole way,
//! over the protocol, with the edit sent just before and nothing known of the new text. Each edit
//! is made near the beginning, in the middle and near the end, and taken back. A row says, of one
//! place of the edit, the median and the worst of all edits for a hover at the edit, for one at the
//! end of the program, and for all findings of the new text being told; milliseconds of the
//! server's own thread (`/proc/PID/task/TID/schedstat` of Linux). Without arguments everything is
//! measured, once for each place.
#![allow(clippy::unwrap_used, clippy::disallowed_methods)] // a measurement may stop
mod edits;
mod programs;

use edits::{Change, Edit};
use interp::Dialect;
use lsp_server::{Connection, Message, Notification, Request, RequestId};
use programs::Program;
use serde_json::{Value, json};

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
    fn planned(&mut self) -> Option<Option<f64>> {
        Some(None)
    }

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
    /// Where the time of the server's thread stands.
    clock: std::path::PathBuf,
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

    /// Milliseconds for which the server's thread has run.
    fn server_ms(&self) -> f64 {
        let text = std::fs::read_to_string(&self.clock).unwrap();
        text.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-6
    }

    /// Make a change, hover at once over a line (from 0) and wait for the findings: milliseconds up
    /// to either.
    fn hover_after(&mut self, change: &Change, line: usize) -> [f64; 2] {
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
        let begun = self.server_ms();
        self.tell("textDocument/didChange", edit);
        let answer = self.ask("textDocument/hover", hover);
        let answered = self.server_ms() - begun;
        assert!(answer.is_null() || answer["contents"]["value"].is_string());
        self.settle();
        [answered, self.server_ms() - begun]
    }
}

/// Median and worst.
fn median_and_worst(times: &mut [f64]) -> String {
    times.sort_by(f64::total_cmp);
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    format!("{median:7.1} {worst:7.1}")
}

/// A row for each place of the edits.
fn rows(client: &mut Client, program: &Program, edits: &[Edit], repetitions: usize) {
    let round = program.round as usize;
    let rounds = client.lines.len() / round;
    let line_at = |rounds: usize| program.first as usize + rounds * round;
    let end = line_at(rounds - 12);
    let places =
        [("top", line_at(3)), ("middle", line_at(rounds / 2)), ("end", line_at(rounds - 20))];
    for (name, line) in places {
        let [mut here, mut last, mut told] = [Vec::new(), Vec::new(), Vec::new()];
        for (edit, repetition) in
            edits.iter().flat_map(|edit| (0..repetitions).map(move |i| (*edit, i)))
        {
            let change = edit.at(&client.lines, line, repetition);
            for (times, at) in [(&mut here, line), (&mut last, end)] {
                for change in [&change, &change.undone()] {
                    let [answered, all] = client.hover_after(change, at);
                    times.push(answered);
                    told.push(all);
                }
            }
        }
        let [here, last, told] = [&mut here, &mut last, &mut told].map(|it| median_and_worst(it));
        println!("  {name:<7} {here}   {last}   {told}");
    }
}

fn main() {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let argument = |i: usize| arguments.get(i).map_or("", |it| it.as_str());
    let repetitions = argument(2).parse().unwrap_or(1);
    let (ours, theirs) = Connection::memory();
    let (sender, clock) = std::sync::mpsc::channel();
    let server = std::thread::spawn(move || {
        let own = std::fs::read_link("/proc/thread-self").unwrap();
        sender.send(std::path::Path::new("/proc").join(own).join("schedstat")).unwrap();
        lsp::serve(&theirs, &Shop).unwrap()
    });
    let clock = clock.recv().unwrap();
    let mut client =
        Client { connection: ours, next: 0, uri: "", version: 0, lines: Vec::new(), clock };
    client.ask("initialize", json!({ "capabilities": {} }));
    client.tell("initialized", json!({}));
    println!("edit at    hover there       hover at the end  findings (median, worst; ms)");
    for program in programs::all().iter().filter(|it| it.name.starts_with(argument(0))) {
        let begun = client.server_ms();
        client.open(program);
        println!("{}: open to findings {:.0} ms", program.name, client.server_ms() - begun);
        let named = |name: &str| argument(1).is_empty() || name == argument(1);
        let edits = edits::of(program.dialect).filter(|(name, _)| named(name));
        rows(&mut client, program, &edits.map(|(_, edit)| *edit).collect::<Vec<_>>(), repetitions);
        client.tell("textDocument/didClose", json!({ "textDocument": { "uri": client.uri } }));
    }
    client.ask("shutdown", Value::Null);
    client.tell("exit", Value::Null);
    server.join().unwrap();
}
