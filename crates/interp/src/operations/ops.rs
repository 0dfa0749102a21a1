//! A program as a stream of operations, and a program's diagnostics alone.
use crate::{
    codes::GGroup,
    dialect::DepthFrom,
    interpreter::{Interpreter, Progress},
    resolve::Resolver,
    setup::{MacroCall, Parameters, Setup},
};
use canon::{Counting, Op, ProgramFrame, ToolLibrary};
use diag::{Diagnostic, Span};
use gcode::{Block, Grammar, Keyword, Label, Parser};
use std::collections::HashSet;

/// The operations of a program, one after the other.
///
/// After an error in a block the stream goes on with the next block, so that all errors come;
/// what moves a machine refuses the program if [`Ops::has_errors`].
pub struct Ops<'s> {
    interpreter: Interpreter<'s>,
    resolver: Resolver,
    ended: bool,
    /// The program looks like one for another dialect.
    other_dialect: Option<Diagnostic>,
}

impl<'s> Ops<'s> {
    /// At the beginning of a program.
    pub fn new(source: &'s [u8], setup: &'s Setup) -> Self {
        Self::with(Interpreter::new(source, setup), Resolver::new(setup)).suspecting(source, setup)
    }

    /// With what the beginning of the program looks like.
    pub(crate) fn suspecting(self, source: &[u8], setup: &Setup) -> Self {
        if let Some(printer) = crate::evidence::other_machine::printer(source) {
            return Self { ended: true, other_dialect: Some(printer), ..self };
        }
        Self { other_dialect: suspicion(source, setup), ..self }
    }

    pub(crate) const fn with(interpreter: Interpreter<'s>, resolver: Resolver) -> Self {
        Self { interpreter, resolver, ended: false, other_dialect: None }
    }

    pub(crate) fn parts(self) -> (Interpreter<'s>, Resolver) {
        (self.interpreter, self.resolver)
    }

    /// What was found so far, in the order of the text; first of all that it looks like a program
    /// for another dialect.
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let both = self.interpreter.diagnostics().iter().chain(self.resolver.diagnostics());
        with_dialect(self.other_dialect.clone(), in_order(both.cloned()))
    }

    /// Whether the program is refused, as far as it was read.
    pub fn has_errors(&self) -> bool {
        self.interpreter.has_errors()
            || self.resolver.diagnostics().iter().any(Diagnostic::is_error)
            || self.other_dialect.as_ref().is_some_and(Diagnostic::is_error)
    }

    /// The tools, with the stand-ins for those that the program has called so far and the library
    /// lacks.
    pub const fn tools(&self) -> &ToolLibrary {
        &self.interpreter.program.executor.tools.library
    }

    /// What the control believes about a tool, as the program has left it.
    pub fn tool_entry(&self, number: u32) -> crate::ToolEntry {
        self.interpreter.program.executor.tools.entry(number)
    }

    /// Frame and units in which the operation that came last was written. What one block orders is
    /// written in one frame.
    pub fn frame(&self) -> ProgramFrame {
        let executor = &self.interpreter.program.executor;
        let modes = &executor.modes;
        let from_the_level = modes.sticky.is_some()
            && executor.settings.cycles.depth_from == DepthFrom::InitialLevel;
        let counting = match () {
            () if executor.words.by_increments => Counting::IncrementalLetters,
            // a cycle's depth counts from another place than its other words there
            () if modes.incremental && !from_the_level => Counting::Incremental,
            () => Counting::Absolute,
        };
        let frame = self.resolver.program_frame(modes.system, modes.diameter);
        if executor.words.g(GGroup::NonModal) == Some(530) {
            return frame.of_machine();
        }
        ProgramFrame { counting, ..frame }
    }

    /// The codes in force after the block that the operation that came last stands in, one of each
    /// group.
    pub fn codes(&self) -> crate::CodesInForce {
        crate::CodesInForce::of(&self.interpreter.program.executor)
    }

    /// The numbered parameters as the program has set them.
    pub const fn parameters(&self) -> &Parameters {
        self.interpreter.parameters()
    }
}

impl Iterator for Ops<'_> {
    type Item = Op;

    fn next(&mut self) -> Option<Op> {
        loop {
            if let Some(op) = self.resolver.pop() {
                return Some(op);
            }
            if self.ended {
                return None;
            }
            self.ended = self.interpreter.step(&mut self.resolver) == Progress::Ended;
        }
    }
}

/// Everything that is wrong with a program, also in lines that are never executed.
pub fn check(source: &[u8], setup: &Setup) -> Vec<Diagnostic> {
    let mut found = syntax(source, setup);
    let mut ops = Ops::new(source, setup);
    for _ in ops.by_ref() {}
    let other_dialect = ops.other_dialect.take();
    found.extend(ops.diagnostics());
    with_dialect(other_dialect, in_order(found))
}

/// What is found in a program, after the suspicion that it is one for another dialect. That is an
/// error where there are others, which may be due to it alone, and so it comes before them in
/// whatever order they are told.
pub fn with_dialect(suspicion: Option<Diagnostic>, found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let Some(mut suspicion) = suspicion else { return found };
    if suspicion.is_error() {
        return vec![suspicion]; // nothing else was read
    }
    if found.iter().any(Diagnostic::is_error) {
        suspicion.severity = diag::Severity::Error;
    }
    core::iter::once(suspicion).chain(found).collect()
}

/// What the beginning of a program looks like, if that is not how it is read: one for another
/// dialect, or one whose numbers without a point are meant otherwise.
pub fn suspicion(source: &[u8], setup: &Setup) -> Option<Diagnostic> {
    let other_dialect = crate::other_dialect(source, setup);
    other_dialect.or_else(|| crate::evidence::whole_units::meant_otherwise(source, setup))
}

/// What the parser finds wrong, in all lines.
fn syntax(source: &[u8], setup: &Setup) -> Vec<Diagnostic> {
    let mut parser = Parser::with_grammar(source, 0, setup.dialect.grammar());
    let mut block = Block::new();
    while parser.next(&mut block) {}
    parser.take_diagnostics()
}

/// Each finding once, by its place.
fn in_order(found: impl IntoIterator<Item = Diagnostic>) -> Vec<Diagnostic> {
    let mut seen: HashSet<(&str, Span)> = HashSet::new();
    let mut all: Vec<_> = found.into_iter().filter(|d| seen.insert((d.code, d.span))).collect();
    all.sort_by_key(|d| (d.span.file, d.span.start));
    // The interpreter warns of a crooked tap, the resolver refuses it: once is enough.
    let crooked: HashSet<u32> =
        all.iter().filter(|d| d.code == "I0705").map(|d| d.span.line).collect();
    all.retain(|d| d.code != "I0422" || !crooked.contains(&d.span.line));
    all
}

/// Names of subprograms that a text calls and does not define: files to look for. Of Fanuc's
/// programs it is their number without zeros before it, or their name.
pub fn called_files(source: &[u8], grammar: Grammar) -> Vec<String> {
    let (mut called, defined) = match grammar {
        Grammar::Rs274 | Grammar::Grbl => subprograms(source),
        Grammar::Fanuc => crate::front_end::fanuc::programs(source),
    };
    called.retain(|name| !defined.contains(name));
    called
}

/// Numbers of programs that a text calls by words of the machine's own.
pub fn files_called_by_word(source: &[u8], calls: &[MacroCall], grammar: Grammar) -> Vec<String> {
    match grammar {
        Grammar::Rs274 | Grammar::Grbl => Vec::new(),
        Grammar::Fanuc => crate::front_end::fanuc::programs_by_word(source, calls),
    }
}

/// Names of subprograms that a text of RS-274 defines.
pub fn defined_subprograms(source: &[u8]) -> HashSet<String> {
    subprograms(source).1
}

/// Those that are called, in their order, and those that are defined.
fn subprograms(source: &[u8]) -> (Vec<String>, HashSet<String>) {
    let (mut parser, mut block) = (Parser::new(source, 0), Block::new());
    let (mut called, mut defined) = (Vec::new(), HashSet::new());
    while parser.next_o_word(&mut block) {
        let Some(word) = block.o else { continue };
        let name = match word.label {
            Label::Name(name) => block.text(name).to_owned(),
            Label::Number(number) => number.to_string(),
            Label::Computed(_) => continue,
        };
        match word.keyword {
            Keyword::Call if !called.contains(&name) => called.push(name),
            Keyword::Sub => _ = defined.insert(name),
            _ => {}
        }
    }
    (called, defined)
}
