//! What the planner has found, all of it, with an end to repetition.
//!
//! One wrong offset puts every block of a program outside the travel: findings of one cause are one
//! finding, with the worst place and their number. Of those that have causes of their own the first
//! of a kind are kept word for word, the rest are counted, and a note says how many there were.
use alloc::{
    collections::{BTreeMap, BTreeSet},
    format,
    string::String,
    vec::Vec,
};
use canon::Axis;
pub(crate) use canon::number;
use diag::{Diagnostic, Span};

/// Findings of one code that are kept.
pub(crate) const FINDINGS_PER_CODE: usize = 40;

/// Why something is wrong: findings of one cause are one finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Cause {
    /// Code of the finding.
    pub(crate) code: &'static str,
    /// Which of its kind: an axis and its end, a tool, a work offset.
    pub(crate) which: [u32; 3],
}

/// Moves that are wrong for one cause.
#[derive(Clone, Debug)]
struct Merged {
    /// Where its finding is kept.
    at: usize,
    /// Blocks that have such moves, and the last of them: an arc that is looked at in pieces, or a
    /// cycle's moves, are one.
    moves: usize,
    block: u32,
    /// How wrong the worst of them is, and where it stands.
    worst: f64,
    line: u32,
    /// What is said of the worst: what is wrong, and what works.
    said: [String; 2],
}

/// A collector of diagnostics.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    kept: Vec<Diagnostic>,
    count: BTreeMap<&'static str, (usize, Span)>,
    merged: BTreeMap<Cause, Merged>,
    /// Causes that were said already.
    said: BTreeSet<Cause>,
    /// Number of the block at hand, and its place.
    block: u32,
    span: Option<Span>,
}

impl Findings {
    /// What is found from here on belongs to the block at this place.
    pub(crate) fn begin(&mut self, span: Span) {
        if self.span.replace(span) != Some(span) {
            self.block = self.block.wrapping_add(1);
        }
    }

    /// Add it, unless the same has been said: a cycle passes a place more than once.
    pub(crate) fn add(&mut self, finding: Diagnostic) {
        if self.kept.contains(&finding) {
            return;
        }
        let count = self.count.entry(finding.code).or_insert((0, finding.span));
        *count = (count.0 + 1, finding.span);
        if count.0 <= FINDINGS_PER_CODE {
            self.kept.push(finding);
        }
    }

    /// A move of an axis that the machine lacks.
    pub(crate) fn add_missing_axis(&mut self, span: Span, axis: Axis) {
        let cause = Cause { code: "M0305", which: [axis.index() as u32, 0, 0] };
        let text = format!("the machine has no {} axis, and the program moves it", axis.letter());
        let error =
            || (Diagnostic::error(cause.code, span, text.as_str()), [text.clone(), String::new()]);
        self.merge(cause, 0.0, error);
    }

    /// Add a move that is wrong by so much for this cause: the worst is said, and how many there
    /// are. `finding` makes what is said of it: severity, place and help; then what is wrong, and
    /// what works.
    pub(crate) fn merge(
        &mut self,
        cause: Cause,
        wrong_by: f64,
        finding: impl FnOnce() -> (Diagnostic, [String; 2]),
    ) {
        if self.said.contains(&cause) {
            return;
        }
        if let Some(merged) = self.merged.get_mut(&cause) {
            if merged.block != self.block {
                (merged.moves, merged.block) = (merged.moves + 1, self.block);
            }
            if wrong_by > merged.worst {
                let (worse, said) = finding();
                let first = &mut self.kept[merged.at];
                first.severity = first.severity.max(worse.severity);
                first.remedy = worse.remedy;
                (merged.worst, merged.line, merged.said) = (wrong_by, worse.span.line, said);
            }
            return;
        }
        let (first, said) = finding();
        let (at, line) = (self.kept.len(), first.span.line);
        self.kept.push(first);
        let block = self.block;
        self.merged.insert(cause, Merged { at, moves: 1, block, worst: wrong_by, line, said });
    }

    /// How many are kept so far.
    pub(crate) const fn len(&self) -> usize {
        self.kept.len()
    }

    /// Add it unless one of its code is there already.
    pub(crate) fn add_once(&mut self, finding: Diagnostic) {
        if !self.count.contains_key(finding.code) {
            self.add(finding);
        }
    }

    /// All so far, and no longer here.
    pub(crate) fn take(&mut self) -> Vec<Diagnostic> {
        for (cause, merged) in core::mem::take(&mut self.merged) {
            let [wrong, works] = merged.said;
            let many = match merged.moves {
                1 => String::new(),
                n if merged.worst == 0.0 => format!(", the first of {n} such moves"),
                n => format!(", in line {}, the worst of {n} such moves", merged.line),
            };
            self.kept[merged.at].message = format!("{wrong}{many}{works}");
            self.said.insert(cause);
        }
        for (code, (count, last)) in &self.count {
            if *count > FINDINGS_PER_CODE {
                let more = count - FINDINGS_PER_CODE;
                let text = format!("{more} more findings of the kind {code}, the last one here");
                self.kept.push(Diagnostic::note(code, *last, text));
            }
        }
        self.count.clear();
        core::mem::take(&mut self.kept)
    }
}

/// A drilling cycle with an empty spindle.
pub(crate) fn no_drill(span: Span) -> Diagnostic {
    let text = "a hole is drilled with no tool in the spindle";
    Diagnostic::error("M0315", span, text)
        .with_help("call one with T and M6, or allow stand-ins for missing tools")
}
