//! An interpretation that stops and goes on later, perhaps in a text that was edited behind that
//! place.
//!
//! ```text
//!   text    ──────●────────●────────●─── ✎ edit ────────►     snapshots every thousand blocks;
//!                 s₁       s₂       s₃        s₄ ✗            after an edit, those before it still hold
//! ```
//!
//! A [`Snapshot`] owns what an [`Interpreter`] knows, and borrows nothing: an editor keeps the
//! snapshots while the text changes. It holds for every text that agrees with the old one in what
//! had been executed; and, if O-words had been executed ([`Snapshot::has_o_words`]), whose O-words
//! are the same and in the same order.
use crate::{
    front_end::FrontEnd,
    interpreter::{Interpreter, codes_in_force::CodesInForce, rounds::Rounds},
    program::{Program, idle::Idle, outline::At},
    setup::Setup,
    state::executor::Executor,
};
use canon::Position;
use diag::{Diagnostic, Span};
use std::collections::HashSet;

/// What an interpreter knows between two blocks.
#[allow(clippy::struct_excessive_bools)] // the interpreter's own
#[derive(Clone)]
pub struct Snapshot {
    pub(crate) executor: Executor,
    pub(crate) file: usize,
    pub(crate) positions: Vec<At>,
    pub(crate) place: Span,
    pub(crate) ended: bool,
    pub(crate) begun: bool,
    pub(crate) percent: bool,
    pub(crate) spoke: bool,
    has_o_words: bool,
    pub(crate) executed: u64,
    last: u64,
    idle: Idle,
    pub(crate) diagnostics: Vec<Diagnostic>,
    pub(crate) seen: HashSet<(&'static str, Span)>,
    errors: usize,
    faults: u64,
    pub(crate) front_end: FrontEnd,
}

impl Snapshot {
    /// Blocks executed before it.
    pub const fn executed(&self) -> u64 {
        self.executed
    }

    /// Whether O-words, or jumps and calls of Fanuc's, were executed, so that the outline of the
    /// whole text mattered.
    pub const fn has_o_words(&self) -> bool {
        self.has_o_words
    }

    /// Whether the place of a block that was not executed yet is known: where Fanuc's profile ends.
    pub fn looks_ahead(&self) -> bool {
        self.front_end.looks_ahead()
    }

    /// Whether the program was over.
    pub const fn has_ended(&self) -> bool {
        self.ended
    }

    /// The same without what was found, of which only the errors are still counted.
    pub(crate) fn without_findings(mut self) -> Self {
        self.diagnostics.clear();
        self.seen.clear();
        self
    }

    /// Nothing was found, nothing was executed.
    pub(crate) fn forget_findings(&mut self, setup: &Setup) {
        (self.errors, self.faults, self.last) = (0, 0, setup.limits.blocks);
        self.has_o_words = false;
        self.idle.end();
        self.diagnostics.clear();
        self.seen.clear();
    }

    /// File and byte where the next block begins.
    pub fn position(&self) -> (usize, u32) {
        (self.file, self.positions.get(self.file).map_or(0, |at| at.0))
    }

    /// What was found, which it forgets.
    pub fn take_findings(&mut self) -> Vec<Diagnostic> {
        self.seen.clear();
        core::mem::take(&mut self.diagnostics)
    }

    /// What was found up to here.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }
}

impl<'s> Interpreter<'s> {
    /// What it knows now.
    pub fn snapshot(&mut self) -> Snapshot {
        let it = &mut self.program;
        it.finish();
        Snapshot {
            executor: it.executor.clone(),
            front_end: self.front_end.without_index(),
            file: it.file,
            positions: it.parsers.iter().map(gcode::Parser::position).collect(),
            place: it.block.span,
            ended: it.ended,
            begun: it.begun,
            percent: it.percent,
            spoke: it.spoke,
            has_o_words: it.steered,
            executed: it.executed,
            last: it.last,
            idle: it.idle,
            diagnostics: it.diagnostics.clone(),
            seen: it.seen.clone(),
            errors: it.errors,
            faults: it.faults,
        }
    }

    /// Go on from a snapshot. The set-up must be the one with which it was made.
    pub fn resume(source: &'s [u8], setup: &'s Setup, from: &Snapshot) -> Self {
        let mut program = Program::new(source, setup);
        for (parser, at) in program.parsers.iter_mut().zip(&from.positions) {
            parser.seek(at.0, at.1);
        }
        program.executor = from.executor.clone();
        program.file = from.file;
        program.block.span = from.place;
        program.ended = from.ended;
        program.begun = from.begun;
        program.percent = from.percent;
        program.spoke = from.spoke;
        program.executed = from.executed;
        program.last = from.last;
        program.idle = from.idle;
        program.diagnostics.clone_from(&from.diagnostics);
        program.seen.clone_from(&from.seen);
        program.errors = from.errors;
        program.faults = from.faults;
        let front_end = from.front_end.clone();
        Self { program, front_end, rounds: Rounds::default() }
    }

    /// Blocks executed so far.
    pub const fn executed(&self) -> u64 {
        self.program.executed
    }

    /// Whether the program is over.
    pub const fn has_ended(&self) -> bool {
        self.program.ended
    }

    /// Value of a parameter, written `#5` or `#<name>`, if it has one.
    pub fn parameter(&self, written: &str) -> Option<f64> {
        self.front_end.parameter(&self.program.executor, written)
    }

    /// Where the program stands: what is in force, and the position.
    pub fn standing(&self) -> Standing {
        Standing::of(&self.program.executor)
    }
}

/// What is in force at a place of a program, and where the machine stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// The codes in force, one of each group, motion first: `G1`, `G17`, `G21`, ….
    pub codes: Vec<String>,
    /// Position in the program's own frame and units: X Y Z A B C U V W.
    pub program: crate::Point,
    /// Position of the axes.
    pub machine: Position,
    /// Units of the program's coordinates.
    pub units: crate::Units,
    /// F, in program units per minute or revolution, or moves per minute (G93).
    pub feed: f64,
    /// S.
    pub speed: f64,
    /// Tool in the spindle.
    pub tool: u32,
    /// Tool that the next M6 brings.
    pub selected_tool: u32,
    /// Subprograms that have not returned yet.
    pub call_level: usize,
}

impl Standing {
    pub(crate) fn of(executor: &Executor) -> Self {
        let modes = &executor.modes;
        let mut machine = modes.frame.to_machine(&modes.at);
        crate::geometry::frame::scale(&mut machine, modes.units.in_mm());
        Self {
            codes: CodesInForce::of(executor).written(),
            program: modes.at,
            machine: crate::resolve::position(&machine),
            units: modes.units,
            feed: modes.feed,
            speed: modes.spindle.speed,
            tool: modes.current_tool,
            selected_tool: modes.selected_tool,
            call_level: modes.call_level,
        }
    }
}
