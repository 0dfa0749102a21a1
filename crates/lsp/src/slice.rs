//! A stretch of a program's execution: what it read, what it found, and how things stood at its end.
use crate::document::Edit;
use diag::Diagnostic;
use interp::{Resolver, Shift, Snapshot, Steering};

/// Stretches of the text that a slice keeps apart at most.
const MOST_STRETCHES: usize = 16;

/// Blocks that were executed on consecutive lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    /// The first one's line, from 1.
    line: u32,
    /// Blocks of the slice executed up to it, itself included.
    block: u32,
    lines: u32,
}

/// What has been noted of a slice while it is executed.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    /// The program's bytes it has read lie in these stretches, the one read last at the end.
    bytes: Vec<(u32, u32)>,
    runs: Vec<Run>,
}

impl Notes {
    /// These bytes were read, up to one behind a block's last: more there could belong to it.
    pub(crate) fn read(&mut self, from: u32, to: u32) {
        // a line's end may be two bytes
        let goes_on = |stretch: &(u32, u32)| stretch.0 <= from && from <= stretch.1 + 1;
        let Some(place) = self.bytes.iter().rposition(goes_on) else {
            self.bytes.push((from, to));
            if self.bytes.len() > MOST_STRETCHES {
                self.merge();
            }
            return;
        };
        self.bytes[place].1 = self.bytes[place].1.max(to);
        let last = self.bytes.len() - 1;
        self.bytes.swap(place, last);
    }

    /// The two stretches nearest to each other become one.
    fn merge(&mut self) {
        self.bytes.sort_unstable();
        let gap = |i: &usize| self.bytes[*i].0.saturating_sub(self.bytes[i - 1].1);
        if let Some(i) = (1..self.bytes.len()).min_by_key(gap) {
            let (_, end) = self.bytes.remove(i);
            self.bytes[i - 1].1 = self.bytes[i - 1].1.max(end);
        }
    }

    /// The slice's `block`-th block stands in this line, which it had not visited.
    pub(crate) fn visited(&mut self, line: u32, block: u32) {
        match self.runs.last_mut() {
            Some(run) if (run.line + run.lines, run.block + run.lines) == (line, block) => {
                run.lines += 1;
            }
            _ => self.runs.push(Run { line, block, lines: 1 }),
        }
    }
}

/// A stretch of execution that is over.
pub(crate) struct Slice {
    /// How things stood at its end, without what was found.
    pub(crate) snapshot: Snapshot,
    pub(crate) resolver: Resolver,
    /// Blocks executed before it.
    begin: u64,
    notes: Notes,
    /// What it found, however often it was found before.
    pub(crate) findings: Vec<Diagnostic>,
    /// Whether O-words, or jumps and calls of Fanuc's, were executed in it or before.
    pub(crate) steered: bool,
    /// It follows, in the text as it is now, from how things stand at the end of the one before.
    pub(crate) linked: bool,
}

impl Slice {
    pub(crate) fn new(
        mut snapshot: Snapshot,
        mut resolver: Resolver,
        before: Option<&Self>,
        notes: Notes,
    ) -> Self {
        let mut findings = snapshot.take_findings();
        findings.extend(resolver.take_findings());
        Self {
            begin: before.map_or(0, Self::end),
            steered: snapshot.has_o_words() || before.is_some_and(|slice| slice.steered),
            snapshot,
            resolver,
            notes,
            findings,
            linked: true,
        }
    }

    /// Blocks executed up to its end.
    pub(crate) const fn end(&self) -> u64 {
        self.snapshot.executed()
    }

    /// The block at which this line (from 1) was executed in it for the first time.
    pub(crate) fn visit(&self, line: u32) -> Option<u64> {
        let within = |run: &&Run| (run.line..run.line + run.lines).contains(&line);
        let run = self.notes.runs.iter().find(within)?;
        Some(self.begin + u64::from(run.block + (line - run.line)))
    }

    /// Blocks executed in it until this line (from 1) was for the first time, that one included.
    pub(crate) fn blocks_to(&self, line: u32) -> Option<u64> {
        self.visit(line).map(|block| block - self.begin)
    }

    /// Whether it has read, or would have read on into, what was edited.
    pub(crate) fn reads(&self, edit: &Shift) -> bool {
        let hit = |(from, to): &(u32, u32)| *from <= edit.old_end && edit.from <= *to;
        // what follows could keep a program from ending; where nothing was read, what would come next
        let (file, at) = self.snapshot.position();
        let stands = if file == 0 { at } else { 0 };
        let from = self.notes.bytes.iter().map(|(from, _)| *from).min().unwrap_or(stands);
        self.notes.bytes.iter().any(hit) || self.snapshot.has_ended() && hit(&(from, u32::MAX))
    }

    /// Whether it goes otherwise where what steers is not what it was.
    pub(crate) fn is_steered(&self, steering: &Steering) -> bool {
        match steering {
            Steering::Same => false,
            Steering::Jumps(numbers) => self.snapshot.jumps_to(numbers),
            Steering::Unknown => self.steered,
        }
    }

    /// Whether it has read something that lies behind an edit.
    pub(crate) fn goes_behind(&self, edit: &Shift) -> bool {
        self.notes.bytes.iter().any(|(_, to)| edit.from <= *to)
    }

    /// The same in the edited text; false if it cannot be said any more how things stood at its end.
    #[must_use]
    pub(crate) fn shift(&mut self, edit: &Edit, steering: &Steering) -> bool {
        let Edit { shift, first, .. } = edit;
        if self.reads(shift) || self.is_steered(steering) {
            self.linked = false;
            self.notes = Notes::default();
            self.findings.clear();
        }
        for run in self.notes.runs.iter_mut().filter(|run| run.line > first.1) {
            run.line = shift.line(run.line);
        }
        for (from, to) in &mut self.notes.bytes {
            *from = shift.byte(*from).unwrap_or(shift.from);
            *to = shift.byte(*to).unwrap_or(shift.from);
        }
        for finding in &mut self.findings {
            shift.finding(finding);
        }
        self.resolver.shift(shift);
        self.snapshot.shift(shift)
    }

    /// Follow another one than when it was executed.
    pub(crate) fn follow(&mut self, before: Option<&Self>) {
        let (begin, steered) = before.map_or((0, false), |slice| (slice.end(), slice.steered));
        self.snapshot.recount(begin.wrapping_sub(self.begin).cast_signed());
        self.steered = steered || self.snapshot.has_o_words();
        self.begin = begin;
    }

    /// As if it had been executed after this many blocks more (or fewer).
    pub(crate) fn recount(&mut self, more: i64) {
        self.begin = self.begin.saturating_add_signed(more);
        self.snapshot.recount(more);
    }

    /// This slice and the one before it as one.
    pub(crate) fn join(&mut self, before: Self) {
        let offset = (self.begin - before.begin) as u32;
        let own = core::mem::replace(&mut self.notes, before.notes);
        for (from, to) in own.bytes {
            self.notes.read(from, to);
        }
        let runs = own.runs.into_iter();
        self.notes.runs.extend(runs.map(|run| Run { block: run.block + offset, ..run }));
        self.findings.splice(..0, before.findings);
        self.snapshot.join(&before.snapshot);
        self.begin = before.begin;
        self.linked = before.linked;
    }
}
