//! Loops that never end: a program that comes back to the same place in the same state goes on as before, for ever.
//!
//! ```text
//!   WHILE [#1 LT 10] DO1 … END1        jumps back   1 … 1024  1025 … 1088 … 2048  2049 …
//!      ▲                   │                            │       └──┴─ the same as then? it never ends
//!      ╰───────────────────╯                            kept               kept
//! ```
//!
//! A state is kept at each power of two, and so many jumps after it are compared with it: that costs nothing beside the
//! rounds themselves, and finds each loop whose round is not longer.
use crate::{
    executor::Context, front_end::FrontEnd, modes::Modes, names::Store, outline::At,
    program::Program, tools::Tools,
};

/// Jumps back before the first state is kept.
const FIRST: u64 = 1024;
/// Jumps after a kept state that are compared with it.
const COMPARED: u64 = 64;

/// See the module's header.
#[derive(Default)]
pub(crate) struct Rounds {
    jumps: u64,
    kept: Option<Box<Round>>,
}

/// What decides where a program goes.
#[derive(PartialEq)]
struct Round {
    place: (usize, At),
    modes: Modes,
    store: Store,
    tools: Tools,
    contexts: Vec<Context>,
    front_end: FrontEnd,
}

impl Rounds {
    /// The program has jumped back; whether it was here before, in the same state.
    pub(crate) fn repeats(&mut self, it: &Program<'_>, front_end: &FrontEnd) -> bool {
        self.jumps += 1;
        if self.jumps < FIRST {
            return false;
        }
        let place = it.place();
        if self.jumps.is_power_of_two() {
            let ex = &it.executor;
            self.kept = Some(Box::new(Round {
                place,
                modes: uncounted(&ex.modes),
                store: ex.store.clone(),
                tools: ex.tools.clone(),
                contexts: ex.contexts.clone(),
                front_end: front_end.clone(),
            }));
            return false;
        }
        let since = self.jumps - (1 << self.jumps.ilog2());
        let Some(kept) = self.kept.as_deref().filter(|_| since <= COMPARED) else { return false };
        let ex = &it.executor;
        kept.place == place
            && kept.modes == uncounted(&ex.modes)
            && kept.contexts == ex.contexts
            && kept.store == ex.store
            && kept.tools == ex.tools
            && kept.front_end == *front_end
    }
}

/// Which repetition of a cycle it is, is told, and decides nothing.
fn uncounted(modes: &Modes) -> Modes {
    Modes { repetition: 0, ..modes.clone() }
}
