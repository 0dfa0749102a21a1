//! The program executed as it is written: findings, and how things stood before and after each
//! block.
//!
//! ```text
//!   kept:   s₀ ──2048 blocks── s₁ ── … ── sₙ ──► advance(): the next slice
//!                     ▲ hover: resume at the nearest snapshot before, step to the block
//!
//!   edit:   s₀ ── s₁ ─ ✎ ─ s₂ ── s₃ ── s₄        s₂ … s₄ are forgotten: executed again from s₁ on
//! ```
//!
//! When many are kept, every other one is joined to the next and the slices become twice as long.
use crate::document::{Document, Edit};
use crate::slice::{Notes, Slice, key};
use diag::Diagnostic;
use interp::{Contents, Interpreter, Progress, Resolver, Setup, Silence, Standing};
use std::collections::HashSet;

/// Blocks between two snapshots, at first.
pub(crate) const SLICE: u64 = 2048;
/// Snapshots kept at most.
const MOST_KEPT: usize = 256;
/// Blocks executed of one program: an editor need not wait for a longer one.
const MOST_BLOCKS: u64 = 2_000_000;
/// Blocks executed at most before the editor is answered about a line that was not executed yet.
const MOST_WAITED: u64 = 4 * SLICE;
/// Code of the finding that the bound on blocks was reached; here that says nothing of the program.
const TOO_LONG: &str = "I0803";
/// Findings shown: more of them tell nothing new.
const MOST_FINDINGS: usize = 800;

/// How things stood around a block when it was executed for the first time.
pub(crate) struct Visit {
    pub(crate) before: Standing,
    pub(crate) after: Standing,
    /// Value that a parameter had before the block.
    pub(crate) parameter: Option<f64>,
}

/// All of a document's.
pub(crate) struct Analysis {
    pub(crate) setup: Setup,
    pub(crate) kept: Vec<Slice>,
    /// Where O-words, numbered blocks and loops of the text are, if that was needed.
    contents: Contents,
    /// For each line, the number of the slice that visited it last.
    visited: Vec<u32>,
    slices: u32,
    slice: u64,
}

impl Analysis {
    pub(crate) fn new(mut setup: Setup) -> Self {
        setup.limits.blocks = setup.limits.blocks.min(MOST_BLOCKS);
        // a program with many errors is still one that is being written
        (setup.limits.errors, setup.limits.blocks_after_error) = (usize::MAX, u64::MAX);
        // all of each slice: what is shown does not depend on where slices end
        setup.limits.findings = usize::MAX;
        Self {
            setup,
            kept: Vec::new(),
            contents: Contents::default(),
            visited: Vec::new(),
            slices: 0,
            slice: SLICE,
        }
    }

    /// Take in an edit that the document has taken in: what may depend on the edited text is
    /// forgotten.
    pub(crate) fn edited(&mut self, edit: &Edit) {
        self.contents = Contents::default();
        let holds = |slice: &&Slice| slice.holds(edit);
        self.kept.truncate(self.kept.iter().take_while(holds).count());
    }

    fn keep(&mut self, slice: Slice) {
        self.kept.push(slice);
        if self.kept.len() <= MOST_KEPT {
            return;
        }
        let mut all = std::mem::take(&mut self.kept).into_iter();
        while let Some(first) = all.next() {
            match all.next() {
                Some(mut second) => {
                    second.join(first);
                    self.kept.push(second);
                }
                None => self.kept.push(first),
            }
        }
        self.slice *= 2;
    }

    /// Whether the program was executed to its end.
    pub(crate) fn is_done(&self) -> bool {
        self.kept.last().is_some_and(|kept| kept.snapshot.has_ended())
    }

    /// Execute the next slice.
    pub(crate) fn advance(&mut self, document: &Document) {
        if self.is_done() {
            return;
        }
        self.slices += 1;
        let mut visited = std::mem::take(&mut self.visited);
        visited.resize(document.lines() + 1, 0);
        let contents = std::mem::take(&mut self.contents);
        let last = self.kept.last();
        let mut interpreter = self.interpreter(document, last).with_contents(contents);
        let mut resolver =
            last.map_or_else(|| Resolver::new(&self.setup), |slice| slice.resolver.clone());
        let mut notes = Notes::default();
        let begin = interpreter.executed();
        let mut block = 0;
        while block < self.slice {
            let progress = interpreter.step(&mut resolver);
            while resolver.pop().is_some() {}
            let place = interpreter.place();
            let executed = interpreter.executed() - begin > block;
            block = interpreter.executed() - begin;
            if place.file == 0 && executed {
                notes.read(interpreter.read_up_to().saturating_add(1));
                if let Some(visit) = visited.get_mut(place.line as usize)
                    && *visit != self.slices
                {
                    *visit = self.slices;
                    notes.visited(place.line, block as u32);
                }
            }
            if progress == Progress::Ended {
                break;
            }
        }
        let snapshot = interpreter.snapshot();
        let contents = interpreter.take_contents();
        (self.contents, self.visited) = (contents, visited);
        self.keep(Slice::new(snapshot, resolver, begin, notes));
    }

    /// An interpretation that goes on where a slice ended.
    fn interpreter<'a>(&'a self, document: &'a Document, after: Option<&Slice>) -> Interpreter<'a> {
        match after {
            Some(slice) => Interpreter::resume(&document.text, &self.setup, &slice.snapshot),
            None => Interpreter::new(&document.text, &self.setup),
        }
    }

    /// The block at which a line (from 1) is executed for the first time; `None` if it is never
    /// executed, or not soon.
    fn first_block(&mut self, document: &Document, line: u32) -> Option<u64> {
        let begin = self.kept.last().map_or(0, Slice::end);
        let mut found = self.kept.iter().find_map(|slice| slice.visit(line));
        while found.is_none() && !self.is_done() {
            if self.kept.last().map_or(0, Slice::end) >= begin + MOST_WAITED {
                return None;
            }
            self.advance(document);
            found = self.kept.last().and_then(|slice| slice.visit(line));
        }
        found
    }

    /// The last slice that was over before this block.
    fn slice_before(&self, block: u64) -> Option<&Slice> {
        let before = self.kept.partition_point(|slice| slice.end() < block);
        before.checked_sub(1).map(|i| &self.kept[i])
    }

    /// How things stood around a line (from 1), and the value of a parameter there; `None` if it is
    /// never executed, or was not executed yet.
    pub(crate) fn visit(
        &mut self,
        document: &Document,
        line: u32,
        parameter: Option<&str>,
    ) -> Option<Visit> {
        let block = self.first_block(document, line)?;
        let contents = std::mem::take(&mut self.contents);
        let mut interpreter =
            self.interpreter(document, self.slice_before(block)).with_contents(contents);
        while interpreter.executed() + 1 < block && interpreter.step(&mut Silence) == Progress::More
        {
        }
        let before = interpreter.standing();
        let parameter = parameter.and_then(|name| interpreter.parameter(name));
        interpreter.step(&mut Silence);
        let after = interpreter.standing();
        let contents = interpreter.take_contents();
        self.contents = contents;
        Some(Visit { before, after, parameter })
    }

    /// What executing found, in the order of the text; all of it if [`Analysis::is_done`].
    pub(crate) fn findings(&self) -> Vec<Diagnostic> {
        let mut seen = HashSet::new();
        let all = self.kept.iter().flat_map(|slice| &slice.findings);
        let mut all: Vec<_> =
            all.filter(|it| it.code != TOO_LONG && seen.insert(key(it))).collect();
        all.sort_by_key(|it| (it.span.file, it.span.start, it.span.end, it.code));
        all.into_iter().take(MOST_FINDINGS).cloned().collect()
    }
}

#[cfg(test)]
#[path = "analysis_tests.rs"]
mod tests;
