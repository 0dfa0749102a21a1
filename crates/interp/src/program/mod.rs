//! A program while it is executed: its text and the place in it, what its blocks change, and what
//! was found.
//!
//! The front end of a dialect decides which block is next and what it says; it works on this.
//!
//! ```text
//!   idle      what was executed since the machine has moved or waited
//!   outline   where the O-words of a file are
//!   reread    blocks of loops and subprograms, kept as they were read
//! ```
pub(crate) mod idle;
pub(crate) mod outline;
pub(crate) mod reread;

use crate::{
    call::{Call, Sink, out::Out},
    execute::{begin, refused},
    fault::{Outcome, error, unknown::Unknown},
    program::{idle::Idle, outline::At, reread::Reread},
    setup::{BreakOff, Limits, Setup},
    state::executor::Executor,
};
use diag::{Diagnostic, Span};
use gcode::{Block, Parser};
use std::collections::HashSet;

/// A program and its files.
#[allow(clippy::struct_excessive_bools)] // independent facts about where it is in the text
pub(crate) struct Program<'s> {
    pub(crate) sources: Vec<&'s [u8]>,
    /// Names of the files; the program's own is empty.
    pub(crate) names: Vec<String>,
    pub(crate) parsers: Vec<Parser<'s>>,
    pub(crate) contents_are_faulty: bool,
    /// O-words, or jumps and calls of a tape, were executed.
    pub(crate) steered: bool,
    /// The file being read.
    pub(crate) file: usize,
    pub(crate) block: Block,
    pub(crate) executor: Executor,
    pub(crate) ended: bool,
    pub(crate) limits: Limits,
    /// The byte up to which the block at hand has looked at those behind it; 0 if it has not.
    pub(crate) ahead: u32,
    pub(crate) begun: bool,
    pub(crate) percent: bool,
    /// A block of it said something.
    pub(crate) spoke: bool,
    pub(crate) executed: u64,
    /// The block after which it is stopped.
    pub(crate) last: u64,
    /// What executing has cost, in blocks.
    work: u64,
    pub(crate) idle: Idle,
    /// Who is asked whether the program is still wanted, and at what cost next.
    break_off: BreakOff,
    asks_at: u64,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) seen: HashSet<(&'static str, Span)>,
    pub(crate) errors: usize,
    /// Errors, however often one was found.
    pub(crate) faults: u64,
    reread: Reread,
    /// More of the program follows this piece of it.
    pub(crate) more_follows: bool,
    /// The piece is over.
    pub(crate) piece_over: bool,
    /// The block at hand has led back in its file.
    pub(crate) jumped_back: bool,
}

/// Bytes of a block that cost as much to execute as a block does.
const BYTES: u64 = 64;

/// What may be executed, in blocks, before it is asked whether the program is still wanted.
const ASKS: u64 = 1 << 16;

impl<'s> Program<'s> {
    /// At its beginning.
    pub(crate) fn new(source: &'s [u8], setup: &'s Setup) -> Self {
        let mut sources = vec![source];
        let mut names = vec![String::new()];
        for subprogram in setup.subprograms.iter().take(usize::from(u16::MAX)) {
            sources.push(&subprogram.source);
            names.push(subprogram.name.clone());
        }
        let grammar = setup.dialect.grammar();
        let parser = |(i, s): (usize, &&'s [u8])| Parser::with_grammar(s, i as u16, grammar);
        let parsers = sources.iter().enumerate().map(parser).collect();
        Self {
            contents_are_faulty: false,
            steered: false,
            sources,
            names,
            parsers,
            file: 0,
            block: Block::new(),
            executor: begin::new(setup),
            ended: false,
            limits: setup.limits,
            ahead: 0,
            begun: false,
            percent: false,
            spoke: false,
            executed: 0,
            last: setup.limits.blocks,
            work: 0,
            idle: Idle::default(),
            break_off: setup.break_off.clone(),
            asks_at: ASKS,
            diagnostics: Vec::new(),
            seen: HashSet::new(),
            errors: 0,
            faults: 0,
            reread: Reread::default(),
            more_follows: false,
            piece_over: false,
            jumped_back: false,
        }
    }

    /// Read the next block. Whether there is one to execute: it can be read, and nothing forbids to
    /// go on.
    #[inline]
    pub(crate) fn read_block<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome<bool> {
        if !self.next_block() {
            if self.more_follows {
                self.piece_over = true;
                return Ok(false);
            }
            return self.end_of_file(out).map(|()| false);
        }
        self.executed += 1;
        let cost = 1 + self.text_of_block().len() as u64 / BYTES;
        self.work += cost;
        self.idle.executed(cost);
        if self.work >= self.asks_at {
            self.asks_at = self.work + ASKS;
            if self.break_off.came() {
                self.ended = true;
                return Ok(false);
            }
        }
        self.spoke |= self.block.faulty || !(self.block.is_blank() || self.block.percent);
        if self.executed > self.last {
            return self.too_long().map(|()| false);
        }
        if self.block.faulty {
            let found = self.parsers[self.file].take_diagnostics();
            self.report_all(found);
            self.faults += 1; // read again, it is not reported again
            let text = self.text_of_block();
            refused::forget_unreadable(&mut self.executor.modes, text);
            out.sink.suppress(self.executor.modes.unknown);
            return Ok(false);
        }
        Ok(true)
    }

    /// Where it goes on.
    pub(crate) fn place(&self) -> (usize, At) {
        (self.file, self.parsers[self.file].position())
    }

    pub(crate) fn jump(&mut self, at: At) {
        self.jumped_back |= at.0 <= self.parsers[self.file].position().0;
        self.parsers[self.file].seek(at.0, at.1);
    }

    fn text_of_block(&self) -> &'s [u8] {
        let span = self.block.span;
        self.sources[self.file].get(span.start as usize..span.end as usize).unwrap_or_default()
    }

    /// Keep a fault, unless it follows from one before; and go on as if the block had done what it
    /// could.
    pub(crate) fn refuse<S: Sink>(
        &mut self,
        fault: Diagnostic,
        mut before: Unknown,
        out: &mut Out<'_, S>,
    ) {
        if refused::names_its_motion(&self.executor.words, &self.block) {
            before.clear(Unknown::MOTION);
        }
        let explained = before.and(out.sink.missed()).may_cause(fault.code, &self.block)
            || self.executor.modes.unknown.hide_blocks(fault.code);
        if fault.is_error() {
            let text = self.text_of_block();
            refused::after_refusal(&mut self.executor, fault.code, &self.block, text, out);
        }
        if explained {
            self.faults += 1;
        } else {
            self.report(fault);
        }
    }

    /// Read on; what has O-words is perhaps not read again.
    #[inline]
    fn next_block(&mut self) -> bool {
        let parser = &mut self.parsers[self.file];
        if !self.steered {
            return parser.next(&mut self.block);
        }
        self.reread.next(self.file, parser, &mut self.block)
    }

    /// The first `%` begins the program, whatever blank lines and comments stand before it; the
    /// next one ends it.
    pub(crate) fn percent_sign<S: Sink>(&mut self, out: &mut Out<'_, S>) {
        if self.percent || self.spoke && self.file == 0 {
            out.say(&Call::Finish);
            self.ended = true;
        }
        self.percent = true;
    }

    fn end_of_file<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        self.ended = true;
        if self.diagnostics.iter().any(|finding| finding.code == "P0191") {
            return Ok(()); // no text: where it would end is not asked
        }
        let span = Span { start: self.block.span.start, ..self.block.span };
        let source = self.sources[self.file];
        let end = source.len().try_into().unwrap_or(u32::MAX);
        let line = self.parsers[self.file].position().1.saturating_sub(1).max(1);
        let span = Span {
            file: self.file as u16,
            line,
            start: end.min(span.start.max(end.saturating_sub(1))),
            end,
        };
        if self.executor.settings.may_end_with_text() && self.file == 0 {
            let text = "the program ends where its text does: M2 or M30 is missing";
            self.report(Diagnostic::note("I0323", span, text));
            out.say(&Call::Finish);
            return Ok(());
        }
        let fault =
            error("I0301", span, "the program does not end: the file is over before M2 or M30");
        Err(fault
            .with_help(
                "was it cut off? Else write M30 as its last block, or % as its first and last line; --accept no-end lets it end with its text",
            )
            .into())
    }

    #[cold]
    fn too_long(&mut self) -> Outcome {
        self.ended = true;
        if self.last < self.limits.blocks {
            return Ok(()); // refused already: a loop whose counting failed
        }
        let text = format!("stopped after {} blocks: does this loop end?", self.limits.blocks);
        Err(error("I0803", self.block.span, text).into())
    }

    /// The block at hand leads back: refused where nothing has moved or waited for too long.
    pub(crate) fn idles(&self) -> Option<Diagnostic> {
        self.idle.refusal(&self.limits, self.block.span)
    }

    pub(crate) fn report_all(&mut self, found: impl IntoIterator<Item = Diagnostic>) {
        for diagnostic in found {
            self.report(diagnostic);
        }
    }

    /// Keep a finding; the same one at the same place once.
    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        self.faults += u64::from(diagnostic.is_error());
        if !self.seen.insert((diagnostic.code, diagnostic.span)) {
            return;
        }
        if diagnostic.is_error() {
            self.last = self.last.min(self.executed.saturating_add(self.limits.blocks_after_error));
            self.errors += 1;
        }
        let enough = diagnostic.is_error() && self.errors == self.limits.errors;
        let span = diagnostic.span;
        if self.diagnostics.len() < self.limits.findings {
            self.diagnostics.push(diagnostic);
        }
        if enough {
            self.ended = true;
            let text = format!("stopped after {} errors: there may be more", self.errors);
            self.diagnostics.push(Diagnostic::note("I0320", span, text));
        }
    }

    /// What the parsers still keep: notes on lines that were read without an error.
    pub(crate) fn finish(&mut self) {
        for file in 0..self.parsers.len() {
            let found = self.parsers[file].take_diagnostics();
            self.report_all(found);
        }
    }
}
