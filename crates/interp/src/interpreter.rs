//! The program, block by block: reads, follows O-words, executes, collects what was found.
use crate::{
    call::{Call, Sink},
    comments,
    dialect::fanuc::Fanuc,
    doubts::Doubts,
    execute::{self, After},
    executor::Executor,
    fault::{Outcome, error},
    flow::Frame,
    out::Out,
    outline::Outline,
    profile::record,
    refused,
    reread::Reread,
    setup::{Limits, Parameters, Setup},
};
use diag::{Diagnostic, Span};
use gcode::{Block, Parameter, Parser};
use std::collections::HashSet;

/// Whether there is more to execute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Call [`Interpreter::step`] again.
    More,
    /// The program is over: it ended, or nothing after its last error could be executed.
    Ended,
}

/// Executes a program's blocks and says, call by call, what they order.
///
/// A block with an error is not executed, the error is kept, and the next block follows: so all
/// errors of a program come at once. Whoever moves a machine asks [`Interpreter::has_errors`] first.
#[allow(clippy::struct_excessive_bools)] // independent facts about where it is in the text
pub struct Interpreter<'s> {
    pub(crate) sources: Vec<&'s [u8]>,
    /// Names of the files; the program's own is empty.
    pub(crate) names: Vec<String>,
    pub(crate) parsers: Vec<Parser<'s>>,
    pub(crate) outlines: Vec<Option<Outline>>,
    pub(crate) contents_are_faulty: bool,
    /// O-words, or jumps and calls of Fanuc's, were executed.
    pub(crate) steered: bool,
    /// The file being read.
    pub(crate) file: usize,
    pub(crate) block: Block,
    pub(crate) executor: Executor,
    pub(crate) frames: Vec<Frame>,
    /// Counting loops of this level: the byte where they begin, rounds left.
    pub(crate) repeats: Vec<(u32, u64)>,
    /// The `elseif` ahead is to be asked.
    pub(crate) choosing: bool,
    pub(crate) ended: bool,
    pub(crate) limits: Limits,
    /// The byte up to which the block at hand has looked at those behind it; 0 if it has not.
    pub(crate) ahead: u32,
    /// The front end of Fanuc's dialect.
    pub(crate) fanuc: Option<Box<Fanuc>>,
    block_delete: bool,
    pub(crate) begun: bool,
    pub(crate) percent: bool,
    pub(crate) executed: u64,
    /// The block after which it is stopped.
    pub(crate) last: u64,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) seen: HashSet<(&'static str, Span)>,
    pub(crate) errors: usize,
    /// Errors, however often one was found.
    pub(crate) faults: u64,
    /// Numbers and values of the block's settings, before any is set.
    settings: Vec<(Option<f64>, f64)>,
    reread: Reread,
    /// More of the program follows this piece of it.
    more_follows: bool,
    /// The piece is over.
    piece_over: bool,
}

impl<'s> Interpreter<'s> {
    /// At the beginning of a program.
    pub fn new(source: &'s [u8], setup: &'s Setup) -> Self {
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
            outlines: vec![None; sources.len()],
            contents_are_faulty: false,
            steered: false,
            sources,
            names,
            parsers,
            file: 0,
            block: Block::new(),
            executor: execute::new(setup),
            frames: Vec::new(),
            repeats: Vec::new(),
            choosing: false,
            ended: false,
            limits: setup.limits,
            ahead: 0,
            fanuc: Fanuc::of(setup),
            block_delete: setup.block_delete,
            begun: false,
            percent: false,
            executed: 0,
            last: setup.limits.blocks,
            diagnostics: Vec::new(),
            seen: HashSet::new(),
            errors: 0,
            faults: 0,
            settings: Vec::new(),
            reread: Reread::default(),
            more_follows: false,
            piece_over: false,
        }
    }

    /// Execute one block.
    #[inline]
    pub fn step<S: Sink>(&mut self, sink: &mut S) -> Progress {
        let mut held = core::mem::take(&mut self.executor.held);
        let mut remarks = Vec::new();
        let place = self.executor.words.place;
        let mut out = Out { sink, held: &mut held, remarks: &mut remarks, place };
        if !self.begun {
            self.begun = true;
            execute::begin(&self.executor.modes, &mut out);
            if let Some(fanuc) = &self.fanuc {
                fanuc.begin(&mut self.executor, &mut out);
            }
        }
        if !(self.ended || self.piece_over) {
            self.execute_block(&mut out);
        }
        self.executor.held = held;
        if !(remarks.is_empty() && self.executor.remarks.is_empty()) {
            let of_words = core::mem::take(&mut self.executor.remarks);
            self.report_all(of_words.into_iter().chain(remarks));
        }
        if self.ended || self.piece_over {
            self.finish();
            return Progress::Ended;
        }
        Progress::More
    }

    #[inline]
    fn execute_block<S: Sink>(&mut self, out: &mut Out<'_, S>) {
        let before = self.executor.modes.doubts;
        match self.block(out) {
            Err(fault) => self.refuse(*fault, before, out),
            Ok(()) if self.executor.modes.doubts != Doubts::default() && !self.block.faulty => {
                refused::settle_doubts(
                    &self.executor.words,
                    &mut self.executor.modes,
                    &self.block,
                    out,
                );
            }
            Ok(()) => {}
        }
    }

    pub(crate) fn expect_more(&mut self, more_follows: bool) {
        self.more_follows = more_follows;
    }

    /// Execute to the end.
    pub fn run<S: Sink>(&mut self, sink: &mut S) {
        while self.step(sink) == Progress::More {}
    }

    /// What was found so far.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Whether the program is refused, as far as it was executed.
    pub const fn has_errors(&self) -> bool {
        self.errors > 0
    }

    /// The numbered parameters as the program has set them.
    pub const fn parameters(&self) -> &Parameters {
        &self.executor.store.numbered
    }

    /// The block executed last.
    pub const fn place(&self) -> Span {
        self.block.span
    }

    /// The byte of its file up to which the block executed last has read: its own end, or that of a block behind it
    /// for which a corner was cut.
    pub fn read_up_to(&self) -> u32 {
        self.block.span.end.max(self.ahead)
    }

    /// File and byte where the next block begins.
    #[inline]
    pub fn position(&self) -> (usize, u32) {
        (self.file, self.parsers[self.file].position().0)
    }

    fn block<S: Sink>(&mut self, out: &mut Out<'_, S>) -> Outcome {
        if !self.next_block() {
            if self.more_follows {
                self.piece_over = true;
                return Ok(());
            }
            return self.end_of_file();
        }
        self.executed += 1;
        if self.executed > self.last {
            return self.too_long();
        }
        if self.block.faulty {
            let found = self.parsers[self.file].take_diagnostics();
            self.report_all(found);
            self.faults += 1; // read again, it is not reported again
            let text = self.text_of_block();
            refused::doubt_unreadable(&mut self.executor.modes, text);
            out.sink.doubt(self.executor.modes.doubts);
            return Ok(());
        }
        if let Some(mut fanuc) = self.fanuc.take() {
            let result = fanuc.block(self, out);
            self.fanuc = Some(fanuc);
            return result;
        }
        if self.block.delete.is_some() && self.block_delete {
            return Ok(());
        }
        if self.block.o.is_some() {
            return self.o_word(out);
        }
        if self.block.percent {
            self.percent_sign(out);
            return Ok(());
        }
        let read = execute::read(
            &mut self.executor.words,
            &mut self.executor.modes,
            &self.executor.store,
            &self.block,
        );
        out.place = self.executor.words.place;
        if self.block.assignments.is_empty() {
            read?;
        } else {
            let assigned = self.assign();
            if assigned.is_err() {
                refused::doubt_parameters(&mut self.executor.modes);
            }
            read.and(assigned)?;
        }
        if self.executor.recording.is_some() {
            return record::record(&mut self.executor, out);
        }
        if !self.block.comments.is_empty() {
            let result = comments::comments(
                &self.executor.modes,
                &self.executor.store,
                &self.block,
                self.sources[self.file],
                out,
            );
            self.ended |= result.is_err();
            result?;
        }
        if self.block.words.is_empty() {
            return Ok(());
        }
        match execute::execute(&mut self.executor, out)? {
            After::Next => Ok(()),
            After::End => {
                self.ended = true;
                Ok(())
            }
            After::Call(number, times) => self.call_program(number, times),
            After::Return => self.return_from_program(out),
            After::Profile(number) => self.take_down_profile(number),
        }
    }

    fn text_of_block(&self) -> &'s [u8] {
        let span = self.block.span;
        self.sources[self.file].get(span.start as usize..span.end as usize).unwrap_or_default()
    }

    /// Keep a fault, unless it follows from one before; and go on as if the block had done what it could.
    fn refuse<S: Sink>(&mut self, fault: Diagnostic, mut before: Doubts, out: &mut Out<'_, S>) {
        if refused::names_its_motion(&self.executor.words, &self.block) {
            before.clear(Doubts::MOTION);
        }
        let explained = before.and(out.sink.missed()).may_cause(fault.code, &self.block)
            || self.executor.modes.doubts.hide_blocks(fault.code);
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
    fn next_block(&mut self) -> bool {
        let parser = &mut self.parsers[self.file];
        if !self.steered {
            return parser.next(&mut self.block);
        }
        self.reread.next(self.file, parser, &mut self.block)
    }

    /// Set the block's parameters: all values are computed before any is set.
    fn assign(&mut self) -> Outcome {
        self.settings.clear();
        for assignment in &self.block.assignments {
            let values = self.executor.values();
            let value = values.evaluate(&self.block, assignment.value, assignment.span)?;
            let number = match assignment.target {
                Parameter::Numbered(number) => {
                    Some(values.evaluate(&self.block, number, assignment.span)?)
                }
                Parameter::Named(_) => None,
            };
            self.settings.push((number, value));
        }
        for (assignment, (number, value)) in self.block.assignments.iter().zip(&self.settings) {
            let (span, value) = (assignment.span, *value);
            match (assignment.target, *number) {
                (Parameter::Numbered(_), Some(number)) => {
                    let number = crate::names::number(number, span)?;
                    crate::names::assign(&mut self.executor.store, number, value, span)?;
                }
                (Parameter::Named(name), _) => {
                    let written = self.block.text(name);
                    crate::names::assignable(&self.executor.modes, written, span)?;
                    if self.executor.store.names() >= self.limits.names {
                        self.ended = true;
                        let text = format!("more than {} named parameters", self.limits.names);
                        return Err(error("I0802", span, text).into());
                    }
                    self.executor.store.set_named(written, value);
                }
                (Parameter::Numbered(_), None) => {}
            }
        }
        Ok(())
    }

    pub(crate) fn percent_sign<S: Sink>(&mut self, out: &mut Out<'_, S>) {
        if self.percent || self.executed > 1 && self.file == 0 && self.executor.modes.line > 0 {
            out.say(&Call::Finish);
            self.ended = true;
        }
        self.percent = true;
    }

    fn end_of_file(&mut self) -> Outcome {
        self.ended = true;
        if self.diagnostics.iter().any(|finding| finding.code == "P0191") {
            return Ok(()); // no text: where it would end is nobody's question
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
        let fault =
            error("I0301", span, "the program does not end: the file is over before M2 or M30");
        Err(fault
            .with_help(
                "was it cut off? Else write M30 as its last block, or % as its first and last line",
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
