//! The program executed as it is written: findings, and how things stood before and after each block.
//!
//! ```text
//!   kept:   s₀ ──4096 blocks── s₁ ── … ── sₙ ──► advance(): the next slice
//!                     ▲ hover: resume at the nearest kept one before, step to the block
//! ```
//!
//! An edit at byte e keeps every snapshot before whose making no byte from e on had been executed. When
//! many are kept, every other one is given up and the slices become twice as long.
use crate::document::{Document, Edit};
use diag::Diagnostic;
use interp::{Interpreter, Progress, Resolver, Setup, Snapshot, Standing};

/// Blocks between two snapshots, at first.
const SLICE: u64 = 4096;
/// Snapshots kept at most.
const MOST_KEPT: usize = 256;
/// Blocks executed of one program: an editor need not wait for a longer one.
const MOST_BLOCKS: u64 = 2_000_000;
/// Code of the finding that the bound on blocks was reached; here that says nothing of the program.
const TOO_LONG: &str = "I0803";

/// How things stood around a block when it was executed for the first time.
pub(crate) struct Visit {
    pub(crate) before: Standing,
    pub(crate) after: Standing,
    /// Value that a parameter had before the block.
    pub(crate) parameter: Option<f64>,
}

struct Kept {
    snapshot: Snapshot,
    resolver: Resolver,
    /// One past the last byte that matters to it.
    furthest: u32,
}

/// All of a document's.
pub(crate) struct Analysis {
    pub(crate) setup: Setup,
    kept: Vec<Kept>,
    /// For each line, the number of the block that was executed there first; 0 for none.
    visits: Vec<u64>,
    slice: u64,
}

impl Analysis {
    pub(crate) fn new(mut setup: Setup) -> Self {
        setup.limits.blocks = setup.limits.blocks.min(MOST_BLOCKS);
        Self { setup, kept: Vec::new(), visits: Vec::new(), slice: SLICE }
    }

    /// Forget what an edit made void.
    pub(crate) fn edited(&mut self, edit: Edit) {
        // what steers Fanuc's tapes may stand in any line
        let steers = edit.o_words || self.setup.dialect.grammar() == gcode::Grammar::Fanuc;
        self.kept
            .retain(|kept| kept.furthest <= edit.from && !(steers && kept.snapshot.has_o_words()));
        let executed = self.kept.last().map_or(0, |kept| kept.snapshot.executed());
        for visit in &mut self.visits {
            if *visit > executed {
                *visit = 0;
            }
        }
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
        let mut visits = std::mem::take(&mut self.visits);
        visits.resize(document.lines() + 1, 0);
        let (mut interpreter, mut resolver, mut furthest) = self.resume(&document.text, u64::MAX);
        let mut progress = Progress::More;
        for _ in 0..self.slice {
            progress = interpreter.step(&mut resolver);
            while resolver.pop().is_some() {}
            let place = interpreter.place();
            if place.file == 0 {
                furthest = furthest.max(place.end.saturating_add(1));
                if let Some(visit @ 0) = visits.get_mut(place.line as usize) {
                    *visit = interpreter.executed();
                }
            }
            if progress == Progress::Ended {
                break;
            }
        }
        if progress == Progress::Ended {
            furthest = u32::MAX; // what follows could keep it from ending
        }
        let snapshot = interpreter.snapshot();
        self.visits = visits;
        self.kept.push(Kept { snapshot, resolver, furthest });
        if self.kept.len() > MOST_KEPT {
            let mut odd = false;
            self.kept.retain(|kept| {
                odd = !odd;
                odd || kept.snapshot.has_ended()
            });
            self.slice *= 2;
        }
    }

    /// An interpretation that has executed fewer blocks than `before`, as many as possible.
    fn resume<'a>(&'a self, text: &'a [u8], before: u64) -> (Interpreter<'a>, Resolver, u32) {
        let at = self.kept.partition_point(|kept| kept.snapshot.executed() < before);
        match at.checked_sub(1).and_then(|i| self.kept.get(i)) {
            Some(kept) => (
                Interpreter::resume(text, &self.setup, &kept.snapshot),
                kept.resolver.clone(),
                kept.furthest,
            ),
            None => (Interpreter::new(text, &self.setup), Resolver::new(&self.setup), 0),
        }
    }

    /// How things stood around a line (from 1), and the value of a parameter there; `None` if it is
    /// never executed.
    pub(crate) fn visit(
        &mut self,
        document: &Document,
        line: u32,
        parameter: Option<&str>,
    ) -> Option<Visit> {
        let visited = |all: &[u64]| all.get(line as usize).copied().filter(|block| *block > 0);
        while visited(&self.visits).is_none() && !self.is_done() {
            self.advance(document);
        }
        let block = visited(&self.visits)?;
        let (mut interpreter, mut resolver, _) = self.resume(&document.text, block);
        let mut step = |interpreter: &mut Interpreter<'_>| {
            let progress = interpreter.step(&mut resolver);
            while resolver.pop().is_some() {}
            progress == Progress::More
        };
        while interpreter.executed() + 1 < block && step(&mut interpreter) {}
        let before = interpreter.standing();
        let parameter = parameter.and_then(|name| interpreter.parameter(name));
        step(&mut interpreter);
        Some(Visit { before, after: interpreter.standing(), parameter })
    }

    /// What executing found; all of it if [`Analysis::is_done`].
    pub(crate) fn findings(&self) -> Vec<Diagnostic> {
        let Some(last) = self.kept.last() else { return Vec::new() };
        let both = last.snapshot.diagnostics().iter().chain(last.resolver.diagnostics());
        both.filter(|finding| finding.code != TOO_LONG).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lsp_types::{PositionEncodingKind, TextDocumentContentChangeEvent};

    fn open(text: String) -> (Document, Analysis) {
        let document = Document::new(text, &PositionEncodingKind::UTF16);
        (document, Analysis::new(Setup::default()))
    }

    fn finish(document: &Document, analysis: &mut Analysis) {
        while !analysis.is_done() {
            analysis.advance(document);
        }
    }

    fn x_after(document: &Document, analysis: &mut Analysis, line: u32) -> Option<f64> {
        analysis.visit(document, line, None).map(|visit| visit.after.program[0])
    }

    /// G91 steps of 1: X after line n is n − 2.
    fn staircase(steps: usize) -> String {
        format!("G21 G91\nF100 G1\n{}M2\n", "X1\n".repeat(steps))
    }

    fn replace(line: u32, text: &str) -> TextDocumentContentChangeEvent {
        use lsp_types::{Position, Range};
        let range = Range { start: Position::new(line, 0), end: Position::new(line, 2) };
        TextDocumentContentChangeEvent { range: Some(range), range_length: None, text: text.into() }
    }

    #[test]
    fn each_block_is_known_before_and_after() {
        let (document, mut analysis) = open(staircase(5000));
        let visit = analysis.visit(&document, 4002, None);
        let both = visit.map(|v| (v.before.program[0], v.after.program[0]));
        assert_eq!(both, Some((3999.0, 4000.0)));
    }

    #[test]
    fn an_edit_keeps_what_lies_before_it_and_changes_what_follows() {
        let (mut document, mut analysis) = open(staircase(20_000));
        finish(&document, &mut analysis);
        let edit = document.apply(replace(16_000, "X5"));
        analysis.edited(edit);
        assert!(analysis.kept.len() >= 3, "snapshots before the edit were thrown away");
        assert_eq!(x_after(&document, &mut analysis, 3000), Some(2998.0));
        assert_eq!(x_after(&document, &mut analysis, 16_001), Some(15_999.0 + 4.0));
        finish(&document, &mut analysis);
        assert_eq!(x_after(&document, &mut analysis, 20_002), Some(20_004.0));
    }

    #[test]
    fn an_edit_in_a_subprogram_that_was_executed_starts_anew() {
        let text = "o1 sub\nG0 X1\no1 endsub\nG21 G90\no1 call\nM2\n";
        let (mut document, mut analysis) = open(text.to_owned());
        finish(&document, &mut analysis);
        let edit = document.apply(TextDocumentContentChangeEvent {
            range: Some(lsp_types::Range {
                start: lsp_types::Position::new(1, 4),
                end: lsp_types::Position::new(1, 5),
            }),
            range_length: None,
            text: "9".into(),
        });
        analysis.edited(edit);
        assert_eq!(x_after(&document, &mut analysis, 2), Some(9.0));
    }

    #[test]
    fn a_line_never_executed_has_no_visit() {
        let (document, mut analysis) = open("G21\nM2\nG0 X1\n".to_owned());
        assert!(analysis.visit(&document, 3, None).is_none());
    }

    #[test]
    fn an_endless_loop_does_not_hold_the_editor() {
        let (document, mut analysis) = open("o1 while [1]\no1 endwhile\nM2\n".to_owned());
        analysis.setup.limits.blocks = 600_000;
        finish(&document, &mut analysis);
        assert!(analysis.kept.len() <= MOST_KEPT + 1);
        assert!(analysis.findings().is_empty());
    }
}
