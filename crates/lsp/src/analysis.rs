//! The program executed as it is written: findings, and how things stood before and after each block.
//!
//! ```text
//!   kept:   s₀ ──4096 blocks── s₁ ── … ── sₙ ──► advance(): the next slice
//!                     ▲ hover: resume at the nearest kept one before, step to the block
//!
//!   edit:   s₀ ── s₁ ─ ✎ ─ s₂ ── s₃ ── s₄        s₂ … s₄ go stale; executed anew from s₁ on
//!           s₀ ── s₁ ──── s₂' ═ s₂               where things stand as they stood at a stale one,
//!           s₀ ── s₁ ──── s₂' ── s₃ ── s₄        those that followed it follow again
//! ```
//!
//! A stale slice that has read what was edited is only a place to meet again. A hover does not wait for all of it: it
//! looks [`ahead`](crate::ahead). When many are kept, every other one is joined to the next and the slices become twice as long.
use crate::ahead::Found;
use crate::document::{Document, Edit};
use crate::slice::{Notes, Slice};
use diag::Diagnostic;
use gcode::Grammar;
use interp::{
    Contents, Interpreter, Progress, Resolver, Setup, Silence, Snapshot, Standing, Steering,
};
use std::collections::{HashSet, VecDeque};

/// Blocks between two snapshots, at first.
pub(crate) const SLICE: u64 = 2048;
/// Snapshots kept at most.
const MOST_KEPT: usize = 256;
/// Blocks executed of one program: an editor need not wait for a longer one.
const MOST_BLOCKS: u64 = 2_000_000;
/// Places where a stale slice may have ended that are looked at before the most likely one.
const MOST_EARLY: u32 = 4;
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
    /// Of texts before the edits, in the order executed.
    pub(crate) stale: VecDeque<Slice>,
    /// Where what steers is.
    pub(crate) contents: Contents,
    /// Blocks executed ahead.
    #[cfg(test)]
    pub(crate) steps: core::cell::Cell<u64>,
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
        Self {
            setup,
            kept: Vec::new(),
            stale: VecDeque::new(),
            contents: Contents::default(),
            #[cfg(test)]
            steps: core::cell::Cell::new(0),
            visited: Vec::new(),
            slices: 0,
            slice: SLICE,
        }
    }

    /// Take in an edit that the document has taken in.
    pub(crate) fn edited(&mut self, edit: &Edit, document: &Document) {
        let grammar = self.setup.dialect.grammar();
        let steering = match self.contents.edited(&document.text, &edit.shift, edit.first, grammar)
        {
            // what steers Fanuc's tapes may stand in any line
            Steering::Unknown if !edit.o_words && grammar == Grammar::Rs274 => Steering::Same,
            steering => steering,
        };
        // lines count: what they mean by #<_line> is not what it was
        let renumbered = edit.shift.lines != 0 && asks_for_lines(&document.text);
        let mut all = core::mem::take(&mut self.kept).into_iter();
        while let Some(mut slice) = all.next() {
            let holds = !(slice.reads(&edit.shift)
                || slice.is_steered(&steering)
                || renumbered && slice.goes_behind(&edit.shift));
            if holds && slice.shift(edit, &steering) {
                self.kept.push(slice);
                continue;
            }
            let lost = holds; // the place it ended at
            let rest: Vec<_> = (!lost).then_some(slice).into_iter().chain(all).collect();
            self.outdate(rest, edit, &steering, renumbered, !lost);
            break;
        }
        self.follow_on();
    }

    /// Take in an edit that these, and the stale ones behind them, have perhaps read.
    fn outdate(
        &mut self,
        slices: Vec<Slice>,
        edit: &Edit,
        steering: &Steering,
        renumbered: bool,
        mut linked: bool,
    ) {
        let stale = core::mem::take(&mut self.stale);
        let mut behind = false;
        for mut slice in slices.into_iter().chain(stale) {
            let elsewhere = slice.is_steered(steering);
            if renumbered || elsewhere && *steering == Steering::Unknown {
                break;
            }
            behind |= elsewhere || slice.reads(&edit.shift);
            if behind {
                slice.recount(i64::from(edit.shift.lines)); // about as many blocks
            }
            let stands = slice.shift(edit, steering);
            slice.linked &= linked;
            linked = stands;
            if stands {
                self.stale.push_back(slice);
            }
        }
    }

    /// What follows again from the last one kept is kept too.
    fn follow_on(&mut self) {
        while self.stale.front().is_some_and(|slice| slice.linked) {
            let Some(mut slice) = self.stale.pop_front() else { return };
            slice.follow(self.kept.last());
            self.keep(slice);
        }
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
        let mut stale = std::mem::take(&mut self.stale);
        let contents = std::mem::take(&mut self.contents);
        let last = self.kept.last();
        let mut interpreter = self
            .interpreter(&document.text, last.map(|slice| &slice.snapshot))
            .with_contents(contents);
        let mut resolver =
            last.map_or_else(|| Resolver::new(&self.setup), |slice| slice.resolver.clone());
        let mut notes = Notes::default();
        let mut meeting = self.meeting(&mut stale, &interpreter);
        let begin = interpreter.executed();
        let mut block = 0;
        while block < self.slice || interpreter.executed() >= meeting.earliest {
            let (file, from) = interpreter.position();
            let progress = interpreter.step(&mut resolver);
            while resolver.pop().is_some() {}
            let place = interpreter.place();
            let executed = interpreter.executed() - begin > block;
            block = interpreter.executed() - begin;
            if file == 0 && place.file == 0 && executed {
                notes.read(from, interpreter.read_up_to().saturating_add(1));
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
            if interpreter.executed() > meeting.latest {
                meeting = self.meeting(&mut stale, &interpreter);
            }
            if interpreter.executed() >= meeting.earliest
                && interpreter.position() == meeting.place
                && meets(stale.front(), &mut interpreter, &resolver)
            {
                stale.pop_front();
                break;
            }
        }
        let snapshot = interpreter.snapshot();
        let contents = interpreter.take_contents();
        self.contents = contents;
        self.visited = visited;
        self.stale = stale;
        self.keep(Slice::new(snapshot, resolver, self.kept.last(), notes));
        self.follow_on();
    }

    /// Where the next stale one is met, if it is met; those that are passed are forgotten.
    fn meeting(&self, stale: &mut VecDeque<Slice>, interpreter: &Interpreter<'_>) -> Meeting {
        let passed = self.passed(stale.iter(), interpreter.executed());
        stale.drain(..passed);
        if let Some(next) = stale.front_mut() {
            next.linked &= passed == 0;
        }
        Meeting::with(stale.front(), self.near())
    }

    /// The same, and those that are passed are only counted.
    pub(crate) fn meeting_at(&self, next: &mut usize, executed: u64) -> Meeting {
        let ahead = self.stale.iter().skip(*next);
        *next += self.passed(ahead, executed);
        Meeting::with(self.stale.get(*next), self.near())
    }

    /// How many slices ended before this many blocks were executed.
    fn passed<'a>(&self, slices: impl Iterator<Item = &'a Slice>, executed: u64) -> usize {
        slices.take_while(|slice| slice.end() + self.near() < executed).count()
    }

    /// How many blocks may have come or gone where a stale one is met.
    const fn near(&self) -> u64 {
        self.slice / 4
    }

    /// An interpretation that begins there.
    pub(crate) fn interpreter<'a>(
        &'a self,
        text: &'a [u8],
        from: Option<&Snapshot>,
    ) -> Interpreter<'a> {
        match from {
            Some(from) => Interpreter::resume(text, &self.setup, from),
            None => Interpreter::new(text, &self.setup),
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
        let found = match self.kept.iter().find_map(|slice| slice.visit(line)) {
            Some(block) => {
                let before = self.kept.partition_point(|slice| slice.end() < block);
                let from = before.checked_sub(1).map(|i| self.kept[i].snapshot.clone());
                Found { from, block }
            }
            None if self.is_done() => return None,
            None => self.ahead(document, line)?,
        };
        let contents = std::mem::take(&mut self.contents);
        let mut interpreter =
            self.interpreter(&document.text, found.from.as_ref()).with_contents(contents).unheard();
        while interpreter.executed() + 1 < found.block
            && interpreter.step(&mut Silence) == Progress::More
        {}
        let before = interpreter.standing();
        let parameter = parameter.and_then(|name| interpreter.parameter(name));
        interpreter.step(&mut Silence);
        let after = interpreter.standing();
        let contents = interpreter.take_contents();
        self.contents = contents;
        Some(Visit { before, after, parameter })
    }

    /// What executing found; all of it if [`Analysis::is_done`].
    pub(crate) fn findings(&self) -> Vec<Diagnostic> {
        let mut seen = HashSet::new();
        let all = self.kept.iter().flat_map(|slice| &slice.findings);
        all.filter(|finding| finding.code != TOO_LONG && seen.insert((finding.code, finding.span)))
            .take(MOST_FINDINGS)
            .cloned()
            .collect()
    }
}

/// Where a stale slice's end may be met again, and between which blocks.
pub(crate) struct Meeting {
    pub(crate) place: (usize, u32),
    pub(crate) earliest: u64,
    /// Where the place is passed more than once it is probably this time.
    pub(crate) probably: u64,
    pub(crate) latest: u64,
    /// How often it is still looked at whether it was sooner, with the blocks that an edit has taken away.
    pub(crate) early: u32,
}

impl Meeting {
    fn with(slice: Option<&Slice>, near: u64) -> Self {
        let Some(slice) = slice else {
            let never = u64::MAX;
            return Self {
                place: (0, 0),
                earliest: never,
                probably: never,
                latest: never,
                early: 0,
            };
        };
        Self {
            place: slice.snapshot.position(),
            earliest: slice.end().saturating_sub(near),
            probably: if slice.steered { slice.end() } else { 0 },
            latest: slice.end() + near,
            early: MOST_EARLY,
        }
    }
}

/// Whether things stand as at the end of the stale slice.
fn meets(stale: Option<&Slice>, interpreter: &mut Interpreter<'_>, resolver: &Resolver) -> bool {
    stale.is_some_and(|stale| {
        interpreter.is_called_as(&stale.snapshot)
            && resolver.stands_as(&stale.resolver)
            && interpreter.snapshot().stands_as(&stale.snapshot)
    })
}

/// Whether a text has the name `_line`, or one that begins so: what it reads depends on where it stands.
fn asks_for_lines(text: &[u8]) -> bool {
    memchr::memchr_iter(b'_', text).any(|at| {
        let next = text[at + 1..].iter().find(|byte| !byte.is_ascii_whitespace());
        next.is_some_and(|byte| byte.eq_ignore_ascii_case(&b'l'))
    })
}

#[cfg(test)]
#[path = "analysis_tests.rs"]
pub(crate) mod tests;
