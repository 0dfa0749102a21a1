//! An open file: its text, what is known of it, and what is still being found out.
use crate::analysis::Analysis;
use crate::called::Called;
use crate::document::Document;
use crate::host::Preflight;
use diag::{Diagnostic, Severity, Span};
use interp::Lint;
use lsp_server::RequestId;
use lsp_types as lsp;
use lsp_types::Uri;

/// An open file.
pub(crate) struct Open {
    pub(crate) document: Document,
    pub(crate) analysis: Analysis,
    pub(crate) version: i32,
    pub(crate) called: Called,
    /// Why the program's surroundings could not be loaded.
    pub(crate) trouble: Option<String>,
    /// What is found by reading it as it is, as far as it has been read.
    pub(crate) lint: Option<Lint>,
    /// What is being found out with the machine: findings, then the time that it takes.
    pub(crate) preflight: Option<Box<dyn Preflight>>,
    /// What was found without it is shown, for that takes long.
    pub(crate) told_early: bool,
    /// Its findings are shown as they are.
    pub(crate) told: bool,
    /// Those that are shown, of the text as it is.
    pub(crate) shown: Vec<Diagnostic>,
    pub(crate) planned: Planned,
}

/// The time that a program takes.
pub(crate) enum Planned {
    /// It is not known yet; these wait for it.
    Asked(Vec<RequestId>),
    /// Seconds; `None`: the program is refused.
    Known(Option<f64>),
}

impl Open {
    pub(crate) fn new(
        document: Document,
        version: i32,
        (analysis, trouble): (Analysis, Option<String>),
    ) -> Self {
        Self {
            document,
            analysis,
            version,
            called: Called::default(),
            trouble,
            lint: None,
            preflight: None,
            told_early: false,
            told: false,
            shown: Vec::new(),
            planned: Planned::Asked(Vec::new()),
        }
    }

    /// What was found is to be found anew; those who waited for the time wait no longer.
    #[must_use]
    pub(crate) fn anew(&mut self) -> Vec<RequestId> {
        (self.lint, self.preflight, self.told) = (None, None, false);
        self.shown.clear();
        match std::mem::replace(&mut self.planned, Planned::Asked(Vec::new())) {
            Planned::Asked(waiting) => waiting,
            Planned::Known(_) => Vec::new(),
        }
    }

    pub(crate) fn range(&self, bytes: &std::ops::Range<usize>) -> lsp::Range {
        let (start, end) = (bytes.start as u32, bytes.end as u32);
        self.document.range(Span { start, end, ..Span::default() })
    }

    /// Everything found: by executing, by reading what is never executed, and what is legal but
    /// hurts.
    pub(crate) fn findings(&mut self) -> Vec<Diagnostic> {
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
        interp::with_dialect(interp::suspicion(&self.document.text, setup), all)
    }

    pub(crate) fn told(&self, uri: &Uri, finding: &Diagnostic) -> lsp::Diagnostic {
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
            data: self.other_dialect(finding),
            ..lsp::Diagnostic::default()
        }
    }

    /// The dialect that a finding says the program is written for: its name, and whose it is.
    fn other_dialect(&self, finding: &Diagnostic) -> Option<serde_json::Value> {
        if finding.code != "I0909" {
            return None;
        }
        let dialect = interp::looks_like(&self.document.text, self.analysis.setup.dialect)?;
        Some(serde_json::json!({ "dialect": dialect.name(), "people": dialect.people() }))
    }

    pub(crate) fn grammar(&self) -> gcode::Grammar {
        self.analysis.setup.dialect.grammar()
    }

    /// The lines that change, each as an edit: formatting keeps the number of lines.
    pub(crate) fn format(&self) -> Vec<lsp::TextEdit> {
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
