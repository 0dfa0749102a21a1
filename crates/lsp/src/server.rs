//! The conversation: what the editor says, what is answered, and what is done while it says
//! nothing.
use crate::analysis::Analysis;
use crate::document::Document;
use crate::host::Host;
use crate::open::{Open, Planned};
use diag::Diagnostic;
use interp::Lint;
use lsp_server::{
    Connection, ErrorCode, Message, Notification, ProtocolError, RequestId, Response,
};
use lsp_types as lsp;
use lsp_types::notification::{
    DidChangeConfiguration, DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument,
    Notification as _, PublishDiagnostics,
};
use lsp_types::{InitializeParams, PositionEncodingKind, Uri};
use serde_json::{Value, json};
use std::{collections::HashMap, time::Duration};

/// Blocks read at once for what is found by reading alone: an editor that asks meanwhile waits that
/// long.
const READ_AT_ONCE: usize = 8192;
/// A message is waited for so long before a preflight is looked at again.
const LOOK_AGAIN: Duration = Duration::from_millis(2);
/// Of programs longer than this, what the machine has to do with is not waited for.
const LONG: usize = 1 << 18;
/// Findings shown: more of them tell nothing new.
const MOST_FINDINGS: usize = 1000;

/// A notification: a program is read as one for another dialect.
const READ_AS: &str = "leadscrew/readAs";

/// Serve one editor until it says goodbye. True if it took leave in order.
///
/// # Errors
/// When the editor breaks the protocol or vanishes before the greeting is over.
pub fn serve(connection: &Connection, host: &dyn Host) -> Result<bool, ProtocolError> {
    let (id, greeting) = connection.initialize_start()?;
    let encoding = encoding(&greeting);
    let capabilities = json!({
        "positionEncoding": encoding,
        "textDocumentSync": { "openClose": true, "change": lsp::TextDocumentSyncKind::INCREMENTAL },
        "hoverProvider": true,
        "documentSymbolProvider": true,
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        // a code is completed while its number is typed
        "completionProvider": { "triggerCharacters": ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "."] },
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "documentFormattingProvider": true,
        "documentRangeFormattingProvider": true,
    });
    let answer = json!({
        "capabilities": capabilities,
        "serverInfo": { "name": "leadscrew", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, answer)?;
    let mut server = Server { connection, host, encoding, open: HashMap::new() };
    server.converse()
}

/// Bytes, if the editor counts in them too; else UTF-16 units.
fn encoding(greeting: &Value) -> PositionEncodingKind {
    let params: Option<InitializeParams> = serde_json::from_value(greeting.clone()).ok();
    let offered = params.and_then(|p| p.capabilities.general?.position_encodings);
    if offered.is_some_and(|all| all.contains(&PositionEncodingKind::UTF8)) {
        PositionEncodingKind::UTF8
    } else {
        PositionEncodingKind::UTF16
    }
}

/// What a preflight has found out.
enum Found {
    Findings(Result<Vec<Diagnostic>, String>),
    Time(Option<f64>),
}

/// One editor's.
pub(crate) struct Server<'a> {
    connection: &'a Connection,
    pub(crate) host: &'a dyn Host,
    encoding: PositionEncodingKind,
    pub(crate) open: HashMap<Uri, Open>,
}

impl Server<'_> {
    fn converse(&mut self) -> Result<bool, ProtocolError> {
        loop {
            let busy = self.open.values().any(|open| !open.told && open.preflight.is_none());
            let waits = self.open.values().any(|open| open.preflight.is_some());
            let message = if waits && !busy {
                match self.connection.receiver.recv_timeout(LOOK_AGAIN) {
                    Ok(message) => Some(message),
                    Err(e) if e.is_disconnected() => return Ok(false),
                    Err(_) => None,
                }
            } else if busy {
                match self.connection.receiver.try_recv() {
                    Ok(message) => Some(message),
                    Err(e) if e.is_disconnected() => return Ok(false),
                    Err(_) => None,
                }
            } else {
                match self.connection.receiver.recv() {
                    Ok(message) => Some(message),
                    Err(_) => return Ok(false),
                }
            };
            match message {
                None => self.work(),
                Some(Message::Request(request)) => {
                    if self.connection.handle_shutdown(&request)? {
                        return Ok(true);
                    }
                    self.answer(request);
                }
                Some(Message::Notification(told)) => self.hear(told),
                Some(Message::Response(_)) => {}
            }
        }
    }

    /// A slice of what is still to be found out.
    fn work(&mut self) {
        self.look();
        let wanted = |(_, open): &(&Uri, &mut Open)| !open.told && open.preflight.is_none();
        let Some((uri, open)) = self.open.iter_mut().find(wanted) else { return };
        if !open.analysis.is_done() {
            open.analysis.advance(&open.document);
            return;
        }
        let lint = open.lint.get_or_insert_with(|| Lint::new(&open.analysis.setup));
        if lint.advance(&open.document.text, READ_AT_ONCE) {
            return;
        }
        open.preflight = Some(self.host.preflight(uri.as_str(), &open.document.text));
        if open.document.text.len() > LONG && !open.told_early {
            open.told_early = true;
            let findings = open.findings();
            let uri = uri.clone();
            self.publish(&uri, &findings);
        }
    }

    /// Whether a preflight has found out something: that is shown, and nothing else.
    fn look(&mut self) {
        let over = self.open.iter_mut().find_map(|(uri, open)| {
            let preflight = open.preflight.as_mut()?;
            let answer = if open.told {
                Found::Time(preflight.planned()?)
            } else {
                Found::Findings(preflight.take()?)
            };
            Some((uri.clone(), answer))
        });
        let Some((uri, answer)) = over else { return };
        let Some(open) = self.open.get_mut(&uri) else { return };
        let findings = match answer {
            Found::Time(planned) => return self.timed(&uri, planned),
            Found::Findings(Ok(mut findings)) => {
                findings.retain(|finding| finding.span.file == 0);
                findings.truncate(MOST_FINDINGS);
                findings
            }
            Found::Findings(Err(trouble)) => {
                open.trouble.get_or_insert(trouble);
                open.findings()
            }
        };
        open.told = true;
        open.shown.clone_from(&findings);
        self.publish(&uri, &findings);
    }

    /// The time is known that a program takes.
    fn timed(&mut self, uri: &Uri, planned: Option<f64>) {
        let Some(open) = self.open.get_mut(uri) else { return };
        open.preflight = None;
        if let Planned::Asked(waiting) =
            std::mem::replace(&mut open.planned, Planned::Known(planned))
        {
            for id in waiting {
                self.send(Response::new_ok(id, json!({ "planned_s": planned })));
            }
        }
    }

    fn publish(&self, uri: &Uri, findings: &[Diagnostic]) {
        let Some(open) = self.open.get(uri) else { return };
        let params = lsp::PublishDiagnosticsParams {
            diagnostics: findings.iter().map(|finding| open.told(uri, finding)).collect(),
            uri: uri.clone(),
            version: Some(open.version),
        };
        self.tell(PublishDiagnostics::METHOD, params);
    }

    fn tell(&self, method: &str, params: impl serde::Serialize) {
        let message = Notification::new(method.to_owned(), params);
        // A vanished editor is noticed at the next reading.
        _ = self.connection.sender.send(Message::Notification(message));
    }

    fn hear(&mut self, told: Notification) {
        match &*told.method {
            DidOpenTextDocument::METHOD => {
                if let Ok(params) =
                    serde_json::from_value::<lsp::DidOpenTextDocumentParams>(told.params)
                {
                    let item = params.text_document;
                    let document = Document::new(item.text, &self.encoding);
                    let begun = self.begin(&item.uri, &document);
                    let open = Open::new(document, item.version, begun);
                    let before = self.open.insert(item.uri, open);
                    self.give_up(before.map(|mut open| open.anew()));
                }
            }
            DidChangeTextDocument::METHOD => {
                if let Ok(params) =
                    serde_json::from_value::<lsp::DidChangeTextDocumentParams>(told.params)
                {
                    self.change(params);
                }
            }
            DidCloseTextDocument::METHOD => {
                if let Ok(params) =
                    serde_json::from_value::<lsp::DidCloseTextDocumentParams>(told.params)
                {
                    let uri = params.text_document.uri;
                    let before = self.open.remove(&uri);
                    self.give_up(before.map(|mut open| open.anew()));
                    let none = lsp::PublishDiagnosticsParams::new(uri, Vec::new(), None);
                    self.tell(PublishDiagnostics::METHOD, none);
                }
            }
            DidChangeConfiguration::METHOD => self.set_up_anew(),
            READ_AS => {
                let uri = told.params["textDocument"]["uri"].as_str().unwrap_or_default();
                let dialect = told.params["dialect"].as_str().and_then(interp::Dialect::named);
                self.host.read_as(uri, dialect);
                self.set_up_anew();
            }
            _ => {}
        }
    }

    fn begin(&self, uri: &Uri, document: &Document) -> (Analysis, Option<String>) {
        match self.host.setup(uri.as_str(), &document.text) {
            Ok(setup) => (Analysis::new(setup), None),
            Err(trouble) => (Analysis::new(interp::Setup::default()), Some(trouble)),
        }
    }

    fn change(&mut self, params: lsp::DidChangeTextDocumentParams) {
        let uri = params.text_document.uri;
        let Some(open) = self.open.get_mut(&uri) else { return };
        let mut calls = false; // other files may be called now: they belong to the set-up
        for change in params.content_changes {
            let grammar = open.grammar();
            let edit = open.document.apply(change, grammar);
            open.analysis.edited(&edit);
            let is_there = |name: &str| self.host.subprogram(uri.as_str(), name).is_some();
            let Open { called, document, analysis, .. } = &mut *open;
            calls |= called.edited(&edit, document, &analysis.setup, is_there);
        }
        open.version = params.text_document.version;
        open.told_early = false;
        let waiting = open.anew();
        if calls {
            let Some(mut open) = self.open.remove(&uri) else { return };
            (open.analysis, open.trouble) = self.begin(&uri, &open.document);
            self.open.insert(uri, open);
        }
        self.give_up(Some(waiting));
    }

    /// What programs meet has changed: tools, offsets, the machine.
    fn set_up_anew(&mut self) {
        let all: Vec<_> = self.open.drain().collect();
        for (uri, mut open) in all {
            (open.analysis, open.trouble) = self.begin(&uri, &open.document);
            let waiting = open.anew();
            self.open.insert(uri, open);
            self.give_up(Some(waiting));
        }
    }

    /// What these have asked for is not found out any more.
    fn give_up(&self, waiting: Option<Vec<RequestId>>) {
        for id in waiting.into_iter().flatten() {
            let text = "the program has changed meanwhile".to_owned();
            self.send(Response::new_err(id, ErrorCode::ContentModified as i32, text));
        }
    }

    pub(crate) fn send(&self, response: Response) {
        // A vanished editor is noticed at the next reading.
        _ = self.connection.sender.send(Message::Response(response));
    }
}
