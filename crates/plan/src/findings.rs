//! What the planner has found, all of it, with an end to repetition.
//!
//! One wrong offset puts every block of a program outside the travel. The first findings of a kind are
//! kept word for word, the rest are counted, and a note says how many there were.
use alloc::{collections::BTreeMap, format, string::String, vec::Vec};
use diag::{Diagnostic, Span};

/// Findings of one code that are kept.
pub(crate) const FINDINGS_PER_CODE: usize = 40;

/// A collector of diagnostics.
#[derive(Clone, Debug, Default)]
pub(crate) struct Findings {
    kept: Vec<Diagnostic>,
    count: BTreeMap<&'static str, (usize, Span)>,
}

impl Findings {
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

/// A number for people: three decimals at most, no zeros at the end.
pub(crate) fn number(value: f64) -> String {
    if value.abs() >= 1e9 {
        return format!("{value:e}");
    }
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}
