//! A stretch of a program's execution: what it read, what it found, and the interpreter's state at
//! its end.
use crate::document::Edit;
use diag::{Diagnostic, Span};
use interp::{Resolver, Snapshot};
use std::collections::HashSet;

/// Blocks that were executed on consecutive lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct OpsRun {
    /// The first one's line, from 1.
    line: u32,
    /// Blocks of the slice executed up to it, itself included.
    block: u32,
    lines: u32,
}

/// What has been noted of a slice while it is executed.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    /// The program's text was read up to this byte.
    up_to: u32,
    runs: Vec<OpsRun>,
}

impl Notes {
    /// The text was read up to this byte: the one behind a block's last, for more there could
    /// belong to the block.
    pub(crate) fn read(&mut self, up_to: u32) {
        self.up_to = self.up_to.max(up_to);
    }

    /// The slice's `block`-th block stands in this line, which it had not visited.
    pub(crate) fn visited(&mut self, line: u32, block: u32) {
        match self.runs.last_mut() {
            Some(run) if (run.line + run.lines, run.block + run.lines) == (line, block) => {
                run.lines += 1;
            }
            _ => self.runs.push(OpsRun { line, block, lines: 1 }),
        }
    }
}

/// A stretch of execution that is over.
pub(crate) struct Slice {
    /// The interpreter's state at its end, without what was found.
    pub(crate) snapshot: Snapshot,
    pub(crate) resolver: Resolver,
    /// Blocks executed before it.
    pub(crate) begin: u64,
    notes: Notes,
    /// What it found, whether it was found before or not.
    pub(crate) findings: Vec<Diagnostic>,
    /// Whether O-words, or jumps and calls of Fanuc's, were executed in it.
    steered: bool,
}

impl Slice {
    pub(crate) fn new(
        mut snapshot: Snapshot,
        mut resolver: Resolver,
        begin: u64,
        mut notes: Notes,
    ) -> Self {
        let mut findings = snapshot.take_findings();
        findings.extend(resolver.take_findings());
        let labels = findings.iter().flat_map(|finding| &finding.labels).map(|label| label.span);
        let spans = findings.iter().map(|finding| finding.span).chain(labels);
        spans.filter(|span| span.file == 0).for_each(|span| notes.read(span.end));
        if let (0, next) = snapshot.position() {
            notes.read(next);
        }
        Self { begin, steered: snapshot.has_o_words(), snapshot, resolver, notes, findings }
    }

    /// Blocks executed up to its end.
    pub(crate) const fn end(&self) -> u64 {
        self.snapshot.executed()
    }

    /// The block at which this line (from 1) was executed in it for the first time.
    pub(crate) fn visit(&self, line: u32) -> Option<u64> {
        let within = |run: &&OpsRun| (run.line..run.line + run.lines).contains(&line);
        let run = self.notes.runs.iter().find(within)?;
        Some(self.begin + u64::from(run.block + (line - run.line)))
    }

    /// Whether it is executed alike after an edit. How a program ends depends on the text behind
    /// it.
    pub(crate) fn holds(&self, edit: &Edit) -> bool {
        let jumps = edit.jumps || self.snapshot.looks_ahead();
        self.notes.up_to < edit.from && !(jumps && self.steered) && !self.snapshot.has_ended()
    }

    /// This slice and the one before it as one.
    pub(crate) fn join(&mut self, before: Self) {
        let offset = (self.begin - before.begin) as u32;
        let own = core::mem::replace(&mut self.notes, before.notes);
        self.notes.read(own.up_to);
        let runs = own.runs.into_iter();
        self.notes.runs.extend(runs.map(|run| OpsRun { block: run.block + offset, ..run }));
        self.findings.splice(..0, before.findings);
        let mut seen = HashSet::new();
        self.findings.retain(|finding| seen.insert(key(finding)));
        self.begin = before.begin;
        self.steered |= before.steered;
    }
}

/// What a finding is the same by, however often it is found.
pub(crate) const fn key(finding: &Diagnostic) -> (&'static str, Span) {
    (finding.code, finding.span)
}
