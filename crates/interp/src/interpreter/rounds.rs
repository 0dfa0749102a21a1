//! Loops that never end: a program that comes back to the same place in the same state goes on as
//! before, for ever.
//!
//! ```text
//!   WHILE [#1 LT 10] DO1 … END1        jumps back   1 … 1024  1025 … 1088 … 2048  2049 …
//!      ▲                   │                            │       └──┴─ the same as then? it never ends
//!      ╰───────────────────╯                            kept               kept
//! ```
//!
//! A state is kept at each power of two, and so many jumps after it are compared with it: that
//! costs nothing beside the rounds themselves, and finds each loop whose round is not longer.
use crate::{
    front_end::FrontEnd,
    modes::Modes,
    program::{
        Program,
        idle::{COUNTING, WAITING},
        outline::At,
    },
    state::{executor::Context, tools::Tools},
    words::names::Store,
};
use diag::{Diagnostic, Span};

/// Jumps back before the first state is kept.
const FIRST: u64 = 1024;
/// Jumps after a kept state that are compared with it.
const COMPARED: u64 = 64;

/// See the module's header.
#[derive(Default)]
pub(crate) struct Rounds {
    jumps: u64,
    kept: Option<Box<Round>>,
    /// The machine has moved or waited since the state was kept.
    time_passed: bool,
}

/// What decides where a program goes.
#[derive(PartialEq)]
struct Round {
    place: (usize, At),
    modes: Modes,
    /// How often the machine had been asked something.
    asked: u32,
    store: Store,
    tools: Tools,
    contexts: Vec<Context>,
    front_end: FrontEnd,
}

/// What is known of a loop that has come back to a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Repetition {
    /// It never ends.
    Endless,
    /// It reads the machine and never moves or waits: it turns as fast as it can be read.
    Polling,
    /// It asks the machine something, and ends by an answer.
    UntilAnswered,
}

impl Repetition {
    /// What is said of the loop, at the block that leads back.
    pub(crate) fn said(self, span: Span) -> Diagnostic {
        match self {
            Self::Endless => {
                let text = "this loop never ends: nothing that it counts changes in its rounds";
                Diagnostic::error("I0803", span, text).with_help(COUNTING)
            }
            Self::Polling => {
                let text = "this loop never ends while the machine reads the same: it neither moves nor waits in its rounds";
                Diagnostic::error("I0803", span, text).with_help(WAITING)
            }
            Self::UntilAnswered => {
                let text = "when this loop ends is known when the program runs: what follows it is not looked at before";
                Diagnostic::note("I0714", span, text)
            }
        }
    }
}

impl Rounds {
    /// The machine moves or waits by the block at hand.
    pub(crate) const fn time_passes(&mut self) {
        self.time_passed = true;
    }

    /// The program has jumped back; what is known if it was here before, in the same state.
    pub(crate) fn repeats(&mut self, it: &Program<'_>, front_end: &FrontEnd) -> Option<Repetition> {
        self.jumps += 1;
        if self.jumps < FIRST {
            return None;
        }
        let place = it.place();
        if self.jumps.is_power_of_two() {
            let ex = &it.executor;
            self.time_passed = false;
            self.kept = Some(Box::new(Round {
                place,
                modes: uncounted(&ex.modes),
                asked: ex.store.asked,
                store: ex.store.clone(),
                tools: ex.tools.clone(),
                contexts: ex.contexts.clone(),
                front_end: front_end.clone(),
            }));
            return None;
        }
        let since = self.jumps - (1 << self.jumps.ilog2());
        let kept = self.kept.as_deref_mut().filter(|_| since <= COMPARED)?;
        let ex = &it.executor;
        kept.store.asked = ex.store.asked; // how often it has asked decides nothing
        let is_same = kept.place == place
            && kept.modes == uncounted(&ex.modes)
            && kept.contexts == ex.contexts
            && kept.store == ex.store
            && kept.tools == ex.tools
            && kept.front_end == *front_end;
        let repetition = match (kept.asked == ex.store.asked, self.time_passed) {
            (true, _) => Repetition::Endless,
            (false, false) => Repetition::Polling,
            (false, true) => Repetition::UntilAnswered,
        };
        is_same.then_some(repetition)
    }
}

/// Which repetition of a cycle it is, is told, and decides nothing.
fn uncounted(modes: &Modes) -> Modes {
    Modes { repetition: 0, ..modes.clone() }
}
