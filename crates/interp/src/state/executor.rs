//! Everything that executing blocks changes, part by part.
//!
//! ```text
//!   words ──► read anew for each block            settings ──► the machine's and the dialect's, never change
//!   modes ──► what is in force, and where         store, tools ──► parameters; tool library and table
//! ```
//!
//! Functions of this crate take the parts that they need; only those that need most of them take it
//! whole.
use crate::{
    call::out::Held,
    codes::Letters,
    dialect::rules::Rules,
    modes::Modes,
    profile::recording::Recording,
    setup::{Cycles, Leaves, MachineCode, MacroCall},
    state::tools::Tools,
    words::{Words, eval::Values, names::Store},
};
use diag::Diagnostic;
use std::collections::BTreeSet;

/// The interpreter without its text.
#[derive(Clone)]
pub(crate) struct Executor {
    /// What is in force.
    pub(crate) modes: Modes,
    /// The parameters.
    pub(crate) store: Store,
    /// The words at hand.
    pub(crate) words: Words,
    /// The tools.
    pub(crate) tools: Tools,
    /// What the machine has set.
    pub(crate) settings: Settings,
    /// Modes kept by M70 and M73, innermost subprogram last.
    pub(crate) contexts: Vec<Context>,
    /// What is held back behind moves whose end is not settled.
    pub(crate) held: Held,
    /// A profile being taken down.
    pub(crate) recording: Option<Box<Recording>>,
    /// Letters without effect that were remarked upon.
    pub(crate) idle_told: Letters,
    /// Codes that the controls of the dialect lack, of which it was said: a bit each.
    pub(crate) lack_told: u32,
    /// M codes without effect that were remarked upon.
    pub(crate) codes_told: BTreeSet<u16>,
    /// Warnings and notes of the block at hand.
    pub(crate) remarks: Vec<Diagnostic>,
}

impl Executor {
    /// What an expression may read.
    pub(crate) fn values(&self) -> Values<'_> {
        Values { store: &self.store, modes: &self.modes }
    }
}

/// What does not change while a program is executed.
#[derive(Clone)]
pub(crate) struct Settings {
    /// What the dialect has of its own.
    pub(crate) rules: &'static Rules,
    /// No machine is asked, as by LinuxCNC's stand-alone interpreter.
    pub(crate) stand_alone: bool,
    /// What the machine's own M codes do.
    pub(crate) user_codes: Vec<MachineCode>,
    /// Words that call programs, where the dialect can.
    pub(crate) macro_calls: Vec<MacroCall>,
    /// What a program may leave out.
    pub(crate) leaves: Leaves,
    /// The machine's settings for cycles.
    pub(crate) cycles: Cycles,
    /// What the spindle turns at most, rev/min; infinite: it is not known.
    pub(crate) fastest_rpm: f64,
}

impl Settings {
    /// Whether a program may lack M2 and M30.
    pub(crate) const fn may_end_with_text(&self) -> bool {
        self.rules.ends_with_text || self.leaves.end
    }
}

/// The modes kept at one level.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Context {
    pub(crate) kept: Option<Box<Modes>>,
    /// M73.
    pub(crate) automatic: bool,
}
