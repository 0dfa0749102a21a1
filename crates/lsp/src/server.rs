//! The conversation: what the editor says, what is answered, and what is done while it says nothing.
use crate::analysis::Analysis;
use crate::called::Called;
use crate::document::Document;
use crate::host::{Host, Preflight};
use crate::{
    hover,
    jumps::{self, Target},
    names, outline,
};
use diag::{Diagnostic, Severity, Span};
use interp::Lint;
use lsp_server::{Connection, ErrorCode, Message, Notification, ProtocolError, Request, Response};
use lsp_types as lsp;
use lsp_types::notification::{
    DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument, Notification as _,
    PublishDiagnostics,
};
use lsp_types::request::{
    DocumentSymbolRequest, Formatting, GotoDefinition, HoverRequest, PrepareRenameRequest,
    RangeFormatting, References, Rename, Request as _,
};
use lsp_types::{InitializeParams, PositionEncodingKind, Uri};
use serde_json::{Value, json};
use std::{collections::HashMap, time::Duration};

/// Blocks read at once for what is found by reading alone: an editor that asks meanwhile waits that long.
const READ_AT_ONCE: usize = 8192;
/// A message is waited for so long before a preflight is looked at again.
const LOOK_AGAIN: Duration = Duration::from_millis(2);
/// Of programs longer than this, what the machine has to do with is not waited for.
const LONG: usize = 1 << 18;
/// Findings shown: more of them tell nothing new.
const MOST_FINDINGS: usize = 1000;

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

/// An open file.
struct Open {
    document: Document,
    analysis: Analysis,
    version: i32,
    called: Called,
    /// Why the program's surroundings could not be loaded.
    trouble: Option<String>,
    /// What is found by reading it as it is, as far as it has been read.
    lint: Option<Lint>,
    /// What is being found out with the machine.
    preflight: Option<Box<dyn Preflight>>,
    /// What was found without it is shown, for that takes long.
    told_early: bool,
    /// Its findings are shown as they are.
    told: bool,
}

struct Server<'a> {
    connection: &'a Connection,
    host: &'a dyn Host,
    encoding: PositionEncodingKind,
    open: HashMap<Uri, Open>,
}

/// Answer to a request: a value, or why there is none.
type Answer = Result<Value, String>;

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

    /// Whether a preflight is over: what it found is shown, and nothing else.
    fn look(&mut self) {
        let over = self.open.iter_mut().find_map(|(uri, open)| {
            let answer = open.preflight.as_mut()?.take()?;
            Some((uri.clone(), answer))
        });
        let Some((uri, answer)) = over else { return };
        let Some(open) = self.open.get_mut(&uri) else { return };
        (open.preflight, open.told) = (None, true);
        let findings = match answer {
            Ok(mut findings) => {
                findings.retain(|finding| finding.span.file == 0);
                findings.truncate(MOST_FINDINGS);
                findings
            }
            Err(trouble) => {
                open.trouble.get_or_insert(trouble);
                open.findings()
            }
        };
        self.publish(&uri, &findings);
    }

    fn publish(&self, uri: &Uri, findings: &[Diagnostic]) {
        let Some(open) = self.open.get(uri) else { return };
        let params = lsp::PublishDiagnosticsParams {
            diagnostics: findings.iter().map(|finding| open.shown(uri, finding)).collect(),
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
                    let (analysis, trouble) = self.begin(&item.uri, &document);
                    let version = item.version;
                    let open = Open {
                        document,
                        analysis,
                        version,
                        called: Called::default(),
                        trouble,
                        lint: None,
                        preflight: None,
                        told_early: false,
                        told: false,
                    };
                    self.open.insert(item.uri, open);
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
                    self.open.remove(&uri);
                    let none = lsp::PublishDiagnosticsParams::new(uri, Vec::new(), None);
                    self.tell(PublishDiagnostics::METHOD, none);
                }
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
        (open.lint, open.preflight) = (None, None);
        (open.told_early, open.told) = (false, false);
        if calls {
            let Some(mut open) = self.open.remove(&uri) else { return };
            (open.analysis, open.trouble) = self.begin(&uri, &open.document);
            self.open.insert(uri, open);
        }
    }

    fn answer(&mut self, request: Request) {
        let Request { id, method, params } = request;
        let answer = match &*method {
            HoverRequest::METHOD => self.hover(params),
            DocumentSymbolRequest::METHOD => self.symbols(params),
            GotoDefinition::METHOD => self.definition(params),
            References::METHOD => self.references(params),
            PrepareRenameRequest::METHOD => self.prepare_rename(params),
            Rename::METHOD => self.rename(params),
            Formatting::METHOD => self.format(params),
            RangeFormatting::METHOD => self.format_range(params),
            _ => {
                let text = format!("{method} is not served");
                self.send(Response::new_err(id, ErrorCode::MethodNotFound as i32, text));
                return;
            }
        };
        self.send(match answer {
            Ok(value) => Response::new_ok(id, value),
            Err(text) => Response::new_err(id, ErrorCode::InvalidParams as i32, text),
        });
    }

    fn send(&self, response: Response) {
        // A vanished editor is noticed at the next reading.
        _ = self.connection.sender.send(Message::Response(response));
    }

    fn hover(&mut self, params: Value) -> Answer {
        let params: lsp::HoverParams = parsed(params)?;
        let place = params.text_document_position_params;
        let Some(open) = self.open.get_mut(&place.text_document.uri) else {
            return Ok(Value::Null);
        };
        let Some((line, byte)) = open.document.at(place.position) else { return Ok(Value::Null) };
        let Some(hover) = hover::at(&open.document, &mut open.analysis, line, byte) else {
            return Ok(Value::Null);
        };
        let start = open.document.place(hover.from);
        let end = open.document.place(hover.to);
        Ok(json!({
            "contents": { "kind": "markdown", "value": hover.markdown },
            "range": { "start": start, "end": end },
        }))
    }

    fn symbols(&self, params: Value) -> Answer {
        let params: lsp::DocumentSymbolParams = parsed(params)?;
        let Some(open) = self.open.get(&params.text_document.uri) else { return Ok(Value::Null) };
        Ok(json!(outline::symbols(&open.document, &open.analysis.setup)))
    }

    fn definition(&self, params: Value) -> Answer {
        let params: lsp::GotoDefinitionParams = parsed(params)?;
        let place = params.text_document_position_params;
        let uri = place.text_document.uri;
        let Some(open) = self.open.get(&uri) else { return Ok(Value::Null) };
        let Some((line, byte)) = open.document.at(place.position) else { return Ok(Value::Null) };
        if let Some(name) = names::definition(&open.document, line, byte, open.grammar()) {
            return Ok(json!({ "uri": uri, "range": open.range(&name.inner) }));
        }
        if open.grammar() == gcode::Grammar::Fanuc
            && let Some(Target::Block(to)) = jumps::target(&open.document, line, byte)
        {
            return Ok(json!({ "uri": uri, "range": open.document.range(to) }));
        }
        let all = names::in_line(&open.document, line, open.grammar());
        let is_call = |name: &&names::Name| matches!(name.kind, names::Kind::O(_));
        let here = all.iter().find(|name| name.holds(byte)).or_else(|| all.iter().find(is_call));
        let file = here
            .filter(|name| matches!(name.kind, names::Kind::O(_)))
            .and_then(|name| self.host.subprogram(uri.as_str(), &name.text));
        let top = lsp::Range::default();
        Ok(file.map_or(Value::Null, |file| json!({ "uri": file, "range": top })))
    }

    fn references(&self, params: Value) -> Answer {
        let params: lsp::ReferenceParams = parsed(params)?;
        let place = params.text_document_position;
        let uri = place.text_document.uri;
        let Some(open) = self.open.get(&uri) else { return Ok(Value::Null) };
        let Some((line, byte)) = open.document.at(place.position) else { return Ok(Value::Null) };
        let all = names::same(&open.document, line, byte, open.grammar());
        let location = |name: &names::Name| json!({ "uri": uri, "range": open.range(&name.inner) });
        Ok(all.iter().map(location).collect())
    }

    fn prepare_rename(&self, params: Value) -> Answer {
        let place: lsp::TextDocumentPositionParams = parsed(params)?;
        let Some(open) = self.open.get(&place.text_document.uri) else { return Ok(Value::Null) };
        let Some((line, byte)) = open.document.at(place.position) else { return Ok(Value::Null) };
        let here = names::in_line(&open.document, line, open.grammar())
            .into_iter()
            .find(|name| name.holds(byte));
        Ok(here.map_or(
            Value::Null,
            |name| json!({ "range": open.range(&name.inner), "placeholder": name.text }),
        ))
    }

    fn rename(&self, params: Value) -> Answer {
        let params: lsp::RenameParams = parsed(params)?;
        let place = params.text_document_position;
        let uri = place.text_document.uri;
        let Some(open) = self.open.get(&uri) else { return Ok(Value::Null) };
        let all = open.document.at(place.position).map_or_else(Vec::new, |(line, byte)| {
            names::same(&open.document, line, byte, open.grammar())
        });
        let Some(first) = all.first() else {
            return Err("there is no parameter or O-word here".to_owned());
        };
        let new = names::acceptable(first, &params.new_name)?;
        if names::taken(&open.document, first, &new, open.grammar()) {
            return Err(format!("{new} is there already: both would become one"));
        }
        let is_number = new.bytes().all(|b| b.is_ascii_digit());
        // the number in `P0041002` keeps its four digits
        let padded = |name: &names::Name| match name.kind {
            names::Kind::O(_) if name.inner.len() == 4 && is_number => format!("{new:0>4}"),
            _ => new.clone(),
        };
        let edit = |name: &names::Name| json!({ "range": open.range(&name.inner), "newText": padded(name) });
        let edits: Vec<_> = all.iter().map(edit).collect();
        Ok(json!({ "changes": { uri.as_str(): edits } }))
    }

    fn format(&self, params: Value) -> Answer {
        let params: lsp::DocumentFormattingParams = parsed(params)?;
        let Some(open) = self.open.get(&params.text_document.uri) else { return Ok(Value::Null) };
        Ok(json!(open.format()))
    }

    /// Only these lines; how they are indented depends on all before them.
    fn format_range(&self, params: Value) -> Answer {
        let params: lsp::DocumentRangeFormattingParams = parsed(params)?;
        let Some(open) = self.open.get(&params.text_document.uri) else { return Ok(Value::Null) };
        let lsp::Range { start, end } = params.range;
        // what ends before a line's first letter has nothing of it
        let last = if end.character == 0 { end.line.saturating_sub(1) } else { end.line };
        let lines = start.line..=last.max(start.line);
        let mut edits = open.format();
        edits.retain(|edit| lines.contains(&edit.range.start.line));
        Ok(json!(edits))
    }
}

impl Open {
    fn range(&self, bytes: &std::ops::Range<usize>) -> lsp::Range {
        let (start, end) = (bytes.start as u32, bytes.end as u32);
        self.document.range(Span { start, end, ..Span::default() })
    }

    /// Everything found: by executing, by reading what is never executed, and what is legal but hurts.
    fn findings(&mut self) -> Vec<Diagnostic> {
        let mut all = self.analysis.findings();
        all.retain(|finding| finding.span.file == 0);
        let setup = &self.analysis.setup;
        let read = self.lint.take().map(|lint| lint.finish(setup));
        for finding in read.into_iter().flatten() {
            if all.iter().all(|f| (f.code, f.span) != (finding.code, finding.span)) {
                all.push(finding);
            }
        }
        if let Some(trouble) = &self.trouble {
            all.push(Diagnostic::error("A0102", Span::default(), trouble.clone()));
        }
        all.sort_by_key(|finding| finding.span.start);
        interp::with_dialect(interp::other_dialect(&self.document.text, setup), all)
    }

    fn shown(&self, uri: &Uri, finding: &Diagnostic) -> lsp::Diagnostic {
        let severity = match finding.severity {
            Severity::Error => lsp::DiagnosticSeverity::ERROR,
            Severity::Warning => lsp::DiagnosticSeverity::WARNING,
            Severity::Note => lsp::DiagnosticSeverity::INFORMATION,
        };
        let here = finding.labels.iter().filter(|label| label.span.file == 0);
        let related = here.map(|label| lsp::DiagnosticRelatedInformation {
            location: lsp::Location::new(uri.clone(), self.document.range(label.span)),
            message: label.text.clone(),
        });
        let message = match &finding.help {
            Some(help) => format!("{}\n{help}", finding.message),
            None => finding.message.clone(),
        };
        lsp::Diagnostic {
            range: self.document.range(finding.span),
            severity: Some(severity),
            code: Some(lsp::NumberOrString::String(finding.code.to_owned())),
            source: Some("leadscrew".to_owned()),
            message,
            related_information: Some(related.collect()),
            ..lsp::Diagnostic::default()
        }
    }

    fn grammar(&self) -> gcode::Grammar {
        self.analysis.setup.dialect.grammar()
    }

    /// The lines that change, each as an edit: formatting keeps the number of lines.
    fn format(&self) -> Vec<lsp::TextEdit> {
        let anew = gcode::format(&self.document.text, self.grammar());
        let lines = anew.split(|b| *b == b'\n').enumerate();
        let mut edits = Vec::new();
        for (i, line) in lines.take(self.document.lines()) {
            let line = line.strip_suffix(b"\r").unwrap_or(line);
            let (from, to) = self.document.line(i);
            if &self.document.text[from..to] != line {
                let range = self.range(&(from..to));
                edits.push(lsp::TextEdit::new(range, String::from_utf8_lossy(line).into_owned()));
            }
        }
        edits
    }
}

fn parsed<T: serde::de::DeserializeOwned>(params: Value) -> Result<T, String> {
    serde_json::from_value(params).map_err(|e| e.to_string())
}
