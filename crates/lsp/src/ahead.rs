//! A line that execution has not come to yet: looked for ahead of it, and nothing of the way is kept.
//!
//! ```text
//!   kept  s₀ ── s₁ ┊                       ┊ has been executed since the edit
//!   stale          ✎ ── s₂ ── s₃ ── s₄     as it was before
//!   ahead          t₁ ═ t₂ ─ ─ t₃ ─ ─ •    ═ executed, nobody listens   ─ ─ carried over s₃   • the line
//! ```
//!
//! A pointer rests on a word while the text behind an edit is still to be executed with all that it finds. What it
//! asks for is less: how things stand before and after one block. So a stretch that was executed before is passed
//! over where what the edit has changed does not matter to it ([`Snapshot::carried`]), and executed without its
//! operations where it does.
use crate::analysis::Analysis;
use crate::document::Document;
use interp::{Contents, Interpreter, Progress, Silence, Snapshot};

/// Blocks between two places from which one that is found can be executed again, at most.
const MARK: u64 = 8192;

/// From where a block can be executed, and how many are executed up to it, itself included.
pub(crate) struct Found {
    pub(crate) from: Option<Snapshot>,
    pub(crate) block: u64,
}

/// What came of executing.
enum Way {
    Found(Found),
    /// Things stand as they do at the end of the next stale slice, or as they do without some of the edit.
    Met(Snapshot),
    Over,
}

impl Analysis {
    /// The first execution of a line (from 1) behind all that is kept.
    pub(crate) fn ahead(&mut self, document: &Document, line: u32) -> Option<Found> {
        let mut from = self.kept.last().map(|slice| slice.snapshot.clone());
        let mut contents = core::mem::take(&mut self.contents);
        let mut next = 0;
        let found = loop {
            let here = match self.execute(document, line, from, &mut next, &mut contents) {
                Way::Found(found) => break Some(found),
                Way::Over => break None,
                Way::Met(here) => here,
            };
            match self.carry(line, here, &mut next) {
                Way::Found(found) => break Some(found),
                Way::Met(here) => from = Some(here),
                Way::Over => break None,
            }
        };
        self.contents = contents;
        found
    }

    /// Executed until the line is come to, or the place where the stale slice `next` ended.
    fn execute(
        &self,
        document: &Document,
        line: u32,
        mut from: Option<Snapshot>,
        next: &mut usize,
        contents: &mut Contents,
    ) -> Way {
        let mut it = self
            .interpreter(&document.text, from.as_ref())
            .with_contents(core::mem::take(contents))
            .unheard();
        let mut meeting = self.meeting_at(next, it.executed());
        let mut mark = it.executed() + MARK;
        let way = loop {
            let before = it.executed();
            let progress = it.step(&mut Silence);
            #[cfg(test)]
            self.steps.set(self.steps.get() + 1);
            let block = it.executed();
            let place = it.place();
            if block > before && (place.file, place.line) == (0, line) {
                break Way::Found(Found { from, block });
            }
            if progress == Progress::Ended {
                break Way::Over;
            }
            if block > meeting.latest {
                meeting = self.meeting_at(next, block);
            }
            if block >= meeting.earliest && it.position() == meeting.place {
                let early = block < meeting.probably;
                let may_follow = self.may_follow(*next, &it);
                if early && !(may_follow && meeting.early > 0) {
                    continue;
                }
                if may_follow {
                    let here = it.snapshot();
                    if self.over(*next, &here).is_some() {
                        break Way::Met(here);
                    }
                    (from, mark) = (Some(here), block + MARK);
                }
                if early {
                    meeting.early -= 1;
                    continue;
                }
                *next += 1;
                meeting = self.meeting_at(next, block);
            }
            if block >= mark {
                (from, mark) = (Some(it.snapshot()), block + MARK);
            }
        };
        *contents = it.take_contents();
        way
    }

    /// Carried on from the end of the stale slice `next` over those that follow it.
    fn carry(&self, line: u32, mut here: Snapshot, next: &mut usize) -> Way {
        while let Some(carried) = self.over(*next, &here) {
            *next += 1;
            if let Some(block) = self.stale[*next].blocks_to(line) {
                let block = here.executed() + block;
                return Way::Found(Found { from: Some(here), block });
            }
            here = carried;
        }
        *next += 1;
        Way::Met(here)
    }

    /// Whether what follows the stale slice `next` may follow from where this stands.
    fn may_follow(&self, next: usize, it: &Interpreter<'_>) -> bool {
        let (slice, follower) = (self.stale.get(next), self.stale.get(next + 1));
        slice.zip(follower).is_some_and(|(slice, follower)| {
            follower.linked && it.may_be_carried(&slice.snapshot, &follower.snapshot)
        })
    }

    /// How things stand at the end of the slice behind the stale one `next`, if it need not be executed from here.
    fn over(&self, next: usize, here: &Snapshot) -> Option<Snapshot> {
        let (slice, follower) = (self.stale.get(next)?, self.stale.get(next + 1)?);
        let carried = follower.linked.then(|| here.carried(&slice.snapshot, &follower.snapshot))?;
        carried.filter(|carried| carried.executed() <= self.setup.limits.blocks)
    }
}

#[cfg(test)]
#[path = "ahead_tests.rs"]
mod tests;
