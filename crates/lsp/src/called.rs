//! Which programs a text calls in files of their own: where an edit calls one that was not known,
//! its file is looked for.
//!
//! Only the lines that an edit touches are read for it; all of the text where a subprogram may have
//! gone from it.
use crate::document::{Document, Edit};
use gcode::Grammar;
use interp::Setup;

/// Names that were called when files were looked for, and need not be looked for again.
#[derive(Default)]
pub(crate) struct Called(Vec<String>);

impl Called {
    /// Take in an edit that the document has taken in: whether a file is called that is not part of
    /// the set-up.
    pub(crate) fn edited(
        &mut self,
        edit: &Edit,
        document: &Document,
        setup: &Setup,
        is_there: impl Fn(&str) -> bool,
    ) -> bool {
        let grammar = setup.dialect.grammar();
        let (from, to) = (edit.from as usize, edit.end as usize);
        let text = if edit.subprograms && grammar == Grammar::Rs274 {
            &document.text
        } else if document.may_call(from, to, grammar) {
            document.lines_of(from, to)
        } else {
            return false;
        };
        let mut found = false;
        for name in interp::called_files(text, grammar) {
            if setup.subprograms.iter().any(|sub| sub.name == name) || self.0.contains(&name) {
                continue;
            }
            found |= is_there(&name);
            self.0.push(name);
        }
        found
    }
}
