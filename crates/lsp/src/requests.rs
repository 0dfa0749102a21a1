//! What an editor asks for, and the answers.
use crate::server::Server;
use crate::{
    completion, fixes, hover,
    jumps::{self, Target},
    names,
    open::Planned,
    outline,
};
use lsp_server::{ErrorCode, Request, Response};
use lsp_types as lsp;
use lsp_types::request::{
    CodeActionRequest, Completion, DocumentSymbolRequest, Formatting, GotoDefinition, HoverRequest,
    PrepareRenameRequest, RangeFormatting, References, Rename, Request as _,
};
use serde_json::{Value, json};

/// A request of ours: `{"textDocument":{"uri"}}` is answered `{"planned_s"}` once the time is known
/// that the program takes.
const PLANNED_TIME: &str = "leadscrew/plannedTime";

/// Answer to a request: a value, or why there is none.
type Answer = Result<Value, String>;

impl Server<'_> {
    pub(crate) fn answer(&mut self, request: Request) {
        let Request { id, method, params } = request;
        let answer = match &*method {
            HoverRequest::METHOD => self.hover(params),
            Completion::METHOD => self.complete(params),
            CodeActionRequest::METHOD => self.fix(params),
            DocumentSymbolRequest::METHOD => self.symbols(params),
            GotoDefinition::METHOD => self.definition(params),
            References::METHOD => self.references(params),
            PrepareRenameRequest::METHOD => self.prepare_rename(params),
            Rename::METHOD => self.rename(params),
            Formatting::METHOD => self.format(params),
            RangeFormatting::METHOD => self.format_range(params),
            PLANNED_TIME => return self.planned_time(id, params),
            _ => {
                let text = format!("{method} is not served");
                self.send(Response::new_err(id, ErrorCode::MethodNotFound as i32, text));
                return;
            }
        };
        self.reply(id, answer);
    }

    fn reply(&self, id: lsp_server::RequestId, answer: Answer) {
        self.send(match answer {
            Ok(value) => Response::new_ok(id, value),
            Err(text) => Response::new_err(id, ErrorCode::InvalidParams as i32, text),
        });
    }

    /// Answered at once where it is known, else later.
    fn planned_time(&mut self, id: lsp_server::RequestId, params: Value) {
        let params: lsp::DocumentSymbolParams = match parsed(params) {
            Ok(params) => params,
            Err(text) => return self.reply(id, Err(text)),
        };
        let known = match self.open.get_mut(&params.text_document.uri) {
            None => Ok(Value::Null),
            Some(open) => match &mut open.planned {
                Planned::Asked(waiting) => return waiting.push(id),
                Planned::Known(planned) => Ok(json!({ "planned_s": planned })),
            },
        };
        self.reply(id, known);
    }

    fn complete(&mut self, params: Value) -> Answer {
        let params: lsp::CompletionParams = parsed(params)?;
        let place = params.text_document_position;
        let Some(open) = self.open.get(&place.text_document.uri) else { return Ok(Value::Null) };
        let Some((line, byte)) = open.document.at(place.position) else { return Ok(Value::Null) };
        Ok(json!(completion::at(&open.document, open.analysis.setup.dialect, line, byte)))
    }

    fn fix(&mut self, params: Value) -> Answer {
        let params: lsp::CodeActionParams = parsed(params)?;
        let uri = params.text_document.uri;
        let Some(open) = self.open.get_mut(&uri) else { return Ok(Value::Null) };
        Ok(json!(fixes::within(open, &uri, params.range)))
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

pub(crate) fn parsed<T: serde::de::DeserializeOwned>(params: Value) -> Result<T, String> {
    serde_json::from_value(params).map_err(|e| e.to_string())
}
