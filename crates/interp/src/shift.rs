//! A snapshot after its text was edited elsewhere, and whether two of them have the same future.
//!
//! ```text
//!   before   ──────────[ abc ]──────────●──────        ● a place, a snapshot: byte 40, line 7
//!   after    ──────────[ abcdef\n ]─────────●──────    the same one: byte 44, line 8
//! ```
//!
//! What has already been executed leaves its mark in the state alone. So where an interpretation of the new text
//! comes to the place of a snapshot of the old one, and [stands as](Snapshot::stands_as) that one stood there,
//! everything that followed then will follow again, as long as it reads nothing that was edited.
use crate::{
    Interpreter, Resolver, Snapshot, execute::Executor, flow::Frame, outline::At, rigid::Rigid,
    state::State,
};
use diag::{Diagnostic, Span};

/// An edit of the program's text: bytes `from..old_end` have become `from..new_end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shift {
    /// First byte that is not as it was.
    pub from: u32,
    /// One past the last byte replaced.
    pub old_end: u32,
    /// One past the last byte that replaced them.
    pub new_end: u32,
    /// Lines more than before; fewer, if negative.
    pub lines: i32,
    /// Whole lines have come in the place of whole lines: what follows is only moved.
    pub whole_lines: bool,
}

impl Shift {
    /// Where a byte of the text is now; `None` if it was replaced.
    pub const fn byte(&self, byte: u32) -> Option<u32> {
        if byte <= self.from {
            Some(byte)
        } else if byte >= self.old_end {
            Some(byte - self.old_end + self.new_end)
        } else {
            None
        }
    }

    /// Where a place, byte and line, of the text is now.
    pub(crate) fn at(&self, (byte, line): At) -> Option<At> {
        let moved = self.byte(byte)?;
        Some((moved, if byte <= self.from { line } else { self.line(line) }))
    }

    /// The number now of a line behind the edit.
    pub const fn line(&self, line: u32) -> u32 {
        line.saturating_add_signed(self.lines)
    }

    /// Where a stretch of the text is now; of what was replaced, the edit's begin.
    pub fn span(&self, span: &mut Span) {
        if span.file != 0 {
            return;
        }
        if span.start >= self.old_end && span.start > self.from {
            span.line = self.line(span.line);
        }
        span.start = self.byte(span.start).unwrap_or(self.from);
        span.end = self.byte(span.end).unwrap_or(self.from).max(span.start);
    }

    /// A finding of the old text as one of the new.
    pub fn finding(&self, finding: &mut Diagnostic) {
        self.span(&mut finding.span);
        for label in &mut finding.labels {
            self.span(&mut label.span);
        }
    }
}

/// Where loops begin, in the edited text.
fn shift_loops(loops: &mut [(u32, u64)], shift: &Shift) -> Option<()> {
    loops.iter_mut().try_for_each(|(begin, _)| shift.byte(*begin).map(|moved| *begin = moved))
}

impl Frame {
    /// Where it goes back to, in the edited text.
    fn shift(&mut self, shift: &Shift) -> Option<()> {
        if self.file == 0 {
            shift_loops(&mut self.repeats, shift)?;
            self.back = shift.at(self.back)?;
            if let Some((begin, _)) = &mut self.again {
                *begin = shift.at(*begin)?; // M98 calls within a file
            }
        }
        Some(())
    }
}

impl Snapshot {
    /// File and byte where the next block begins.
    pub fn position(&self) -> (usize, u32) {
        (self.file, self.positions.get(self.file).map_or(0, |at| at.0))
    }

    /// Its findings, which it forgets.
    pub fn take_findings(&mut self) -> Vec<Diagnostic> {
        self.seen.clear();
        core::mem::take(&mut self.diagnostics)
    }

    /// The same snapshot in the edited text; false if the place it stands at is no more.
    #[must_use]
    pub fn shift(&mut self, shift: &Shift) -> bool {
        shift.span(&mut self.place);
        let Some(at) = self.positions.first_mut() else { return false };
        let Some(moved) = shift.at(*at) else { return false };
        *at = moved;
        if self.file == 0 && shift_loops(&mut self.repeats, shift).is_none() {
            return false;
        }
        self.executor.shift(shift);
        let fanuc = self.fanuc.as_mut().is_none_or(|fanuc| fanuc.shift(shift).is_some());
        fanuc && self.frames.iter_mut().all(|frame| frame.shift(shift).is_some())
    }

    /// As if `more` blocks more (or fewer) had been executed before it.
    pub fn recount(&mut self, more: i64) {
        self.executed = self.executed.saturating_add_signed(more);
    }

    /// Whether what follows in the same text is the same. False where that is not known: while moves are held back
    /// or a profile is taken down.
    pub fn stands_as(&self, other: &Self) -> bool {
        self.positions == other.positions
            && (self.file, self.choosing, self.ended) == (other.file, other.choosing, other.ended)
            && (self.begun, self.percent) == (other.begun, other.percent)
            && self.frames == other.frames
            && self.repeats == other.repeats
            && self.fanuc == other.fanuc
            && self.fanuc.as_ref().is_none_or(|fanuc| fanuc.is_between_profiles())
            && self.executor.stands_as(&other.executor)
    }
}

impl Interpreter<'_> {
    /// Whether it stands in the same calls and rounds as that one did.
    pub fn is_called_as(&self, then: &Snapshot) -> bool {
        let levels = match (&self.fanuc, &then.fanuc) {
            (Some(own), Some(then)) => own.is_called_as(then),
            (own, then) => own.is_none() && then.is_none(),
        };
        levels && self.frames == then.frames && self.repeats == then.repeats
    }
}

impl Executor {
    /// Places of blocks that are still to have their effect.
    fn shift(&mut self, shift: &Shift) {
        if let Rigid::Ordered(span) = &mut self.state.rigid {
            shift.span(span);
        }
        for (place, _) in self.held.get_mut() {
            shift.span(&mut place.span);
        }
        if let Some(recording) = &mut self.recording {
            shift.span(&mut recording.place.span);
        }
    }

    fn stands_as(&self, other: &Self) -> bool {
        // the line is that of the block executed last, which no block reads
        let line_of = |state: &State| State { line: other.state.line, ..state.clone() };
        self.is_between_moves()
            && other.is_between_moves()
            && line_of(&self.state) == other.state
            && self.compensating == other.compensating
            && self.contexts == other.contexts
            && self.tools == other.tools
            && self.tool_table == other.tool_table
            && self.store == other.store
    }

    fn is_between_moves(&self) -> bool {
        self.recording.is_none()
            && self.remarks.is_empty()
            && self.held.borrow().is_empty()
            && !matches!(self.state.rigid, Rigid::Ordered(_))
    }
}

impl Resolver {
    /// Its findings, which it forgets.
    pub fn take_findings(&mut self) -> Vec<Diagnostic> {
        core::mem::take(&mut self.diagnostics)
    }

    /// The same in the edited text.
    pub fn shift(&mut self, shift: &Shift) {
        for (span, _) in &mut self.with_motion {
            shift.span(span);
        }
    }

    /// Whether the same calls would become the same operations.
    pub fn stands_as(&self, other: &Self) -> bool {
        let modes = |it: &Self| (it.tool, it.units, it.path, it.path_said, it.pitch_said, it.zone);
        self.ops.is_empty()
            && other.ops.is_empty()
            && self.with_motion.is_empty()
            && other.with_motion.is_empty()
            && modes(self) == modes(other)
            && (self.at, self.frame) == (other.at, other.frame)
            && (self.feed, self.spindle) == (other.feed, other.spindle)
            && (self.threading, self.thread_angle) == (other.threading, other.thread_angle)
            && (self.overrides, self.coolant) == (other.overrides, other.coolant)
            && self.tools == other.tools
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDIT: Shift = Shift { from: 10, old_end: 13, new_end: 17, lines: 1, whole_lines: false };

    #[test]
    fn what_lies_behind_an_edit_moves_and_what_lies_before_stays() {
        assert_eq!(EDIT.at((10, 3)), Some((10, 3)));
        assert_eq!(EDIT.at((13, 3)), Some((17, 4)));
        assert_eq!(EDIT.at((12, 3)), None);
        let mut span = Span { file: 0, line: 3, start: 13, end: 15 };
        EDIT.span(&mut span);
        assert_eq!(span, Span { file: 0, line: 4, start: 17, end: 19 });
        let mut elsewhere = Span { file: 1, line: 3, start: 13, end: 15 };
        EDIT.span(&mut elsewhere);
        assert_eq!(elsewhere.start, 13);
    }
}
