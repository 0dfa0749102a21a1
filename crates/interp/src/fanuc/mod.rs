//! Fanuc's dialect: a front end that ends in the words, motions and cycles that all dialects share.
//!
//! ```text
//!   block ──► skip /n ──► O, %, GOTO, IF, WHILE, G65 … ──► variables ──► words ──► Executor
//!                          (tape, calls)                   (values)      (words)
//!
//!   X10       10 of the least input increment, 0.001 mm; X10. is 10 mm       G4 P500    half a second
//!   G84 K3    three repetitions: L of the shared cycles                      G99, G98   lathe A: feed modes
//! ```
//!
//! The front end decides which block comes next, what its variables are worth, and what its words mean
//! in the shared language (millimetres or inches, seconds, the shared codes); everything that moves is
//! the [`Executor`](crate::execute::Executor)'s. A variable without a value makes its word vanish.
//!
//! Source: Fanuc, operator's manuals of series 30i and 0i for machining centres and lathes.
#![allow(clippy::unused_self)] // steps of the front end, called alike
#![allow(clippy::match_same_arms)] // a row of a table each
#![allow(clippy::large_types_passed_by_value)] // a macro's variables move into its call
#![allow(clippy::single_match_else)] // both outcomes are worth a line
mod calls;
mod codes;
mod figure;
mod grooving;
mod lathe;
mod mapping;
mod offsets;
mod tape;
mod threading;
mod turning;
mod values;
mod words;

use crate::{
    call::{Call, Sink},
    execute::After,
    fault::{Outcome, error, refuse},
    interpreter::Interpreter,
    setup::{Dialect, Setup},
    state::Motion,
};
use calls::Level;
pub(crate) use codes::{has_m, stays, told};
use diag::Span;
use gcode::Control;
use tape::Tape;
use values::Variables;
pub(crate) use values::binary_coded;
use words::Said;

/// Whose G codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Machining centres.
    Mill,
    /// Lathes, system A: G90, G92, G94 are cycles, U and W are increments.
    LatheA,
    /// Lathes, system B: G77, G78, G79 are those cycles, G91 makes increments.
    LatheB,
}

/// The front end's own state.
#[derive(Clone, PartialEq)]
pub(crate) struct Fanuc {
    kind: Kind,
    calculator: bool,
    skip_levels: u16,
    tape: Option<Tape>,
    variables: Variables,
    levels: Vec<Level>,
    /// G66: the macro called after each block that moves.
    modal: Option<calls::Macro>,
    /// O of the program whose blocks are executed; none before the first.
    program: Option<u32>,
    /// G92 S, G50 S: no faster with G96.
    top_speed: Option<f64>,
    lathe_cycle: Option<u16>,
    /// Where the cycle's last pass led, and its taper.
    corner: Option<(crate::Point, f64)>,
    /// The motion that G80 goes back to.
    before_cycle: Motion,
    /// F of a thread.
    lead: Option<f64>,
    /// Q of the thread of the block at hand.
    thread_angle: Option<f64>,
    warned_of_point: bool,
    said: Vec<Said>,
    /// G16, G51, G51.1, G68.
    mapping: figure::Mapping,
    /// G71 to G76: what their first lines have set.
    first_lines: turning::FirstLines,
    /// G70 to G73: the profile being taken down.
    shape: Option<turning::Shape>,
}

/// What follows a block.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Then {
    Next,
    /// M98.
    Call {
        number: u32,
        times: u32,
    },
    /// M99, M99 P.
    Return(Option<u32>),
}

impl Fanuc {
    /// The front end that a set-up asks for.
    pub(crate) fn of(setup: &Setup) -> Option<Box<Self>> {
        let kind = match setup.dialect {
            Dialect::Fanuc => Kind::Mill,
            Dialect::FanucLatheA => Kind::LatheA,
            Dialect::FanucLatheB => Kind::LatheB,
            Dialect::LinuxCnc | Dialect::Brother | Dialect::Toyoda => return None,
        };
        Some(Box::new(Self {
            kind,
            calculator: setup.whole_units_without_point,
            skip_levels: setup.block_delete_levels | u16::from(setup.block_delete) << 1,
            tape: None,
            variables: Variables::default(),
            levels: Vec::new(),
            modal: None,
            program: None,
            top_speed: None,
            lathe_cycle: None,
            corner: None,
            before_cycle: Motion::Rapid,
            lead: None,
            thread_angle: None,
            warned_of_point: false,
            said: Vec::new(),
            mapping: figure::Mapping::default(),
            first_lines: turning::FirstLines::default(),
            shape: None,
        }))
    }

    /// Whether the order of the tape's blocks has mattered.
    pub(crate) const fn has_jumped(&self) -> bool {
        self.tape.is_some()
    }

    /// The same, which will read its tape again when it is needed.
    pub(crate) fn without_tape(&mut self) -> Self {
        let tape = self.tape.take();
        let mut copy = self.clone();
        copy.said.clear(); // the last block's
        self.tape = tape;
        copy
    }

    /// Whether no profile is being taken down.
    pub(crate) const fn is_between_profiles(&self) -> bool {
        self.shape.is_none()
    }

    const fn is_lathe(&self) -> bool {
        !matches!(self.kind, Kind::Mill)
    }

    /// Execute the block that the interpreter has read.
    pub(crate) fn block<S: Sink>(&mut self, it: &mut Interpreter<'_>, sink: &mut S) -> Outcome {
        let result = self.execute(it, sink);
        if self.shape.is_none() {
            return result;
        }
        if let Err(fault) = result {
            it.report(*fault); // the profile is not whole, and will not be cut
        }
        self.end_of_shape(it, sink)
    }

    fn execute<S: Sink>(&mut self, it: &mut Interpreter<'_>, sink: &mut S) -> Outcome {
        if it.block.delete.is_some_and(|level| self.skip_levels >> level & 1 == 1) {
            return Ok(());
        }
        it.executor.state.line = it.block.span.line;
        if let Some(word) = it.block.o {
            return self.program_begins(it, word.label, word.span);
        }
        if it.block.percent {
            it.percent_sign(sink);
            return Ok(());
        }
        if let Some(control) = it.block.control {
            let Control::IfThen(condition) = control else { return self.control(it, control) };
            if self.condition(it, condition)? == 0.0 {
                return Ok(());
            }
        }
        self.assign(it, sink)?;
        it.executor.words.begin(&it.block);
        if let Some(comment) = it.block.comments.last().filter(|_| it.block.assignments.is_empty())
        {
            let text = it.block.text(comment.text).trim_start();
            it.executor.say(sink, &Call::Comment(text));
        }
        if it.block.words.is_empty() {
            return Ok(());
        }
        self.words(it, sink)
    }

    /// A block with words.
    fn words<S: Sink>(&mut self, it: &mut Interpreter<'_>, sink: &mut S) -> Outcome {
        self.read(it)?;
        if let Some(code) = self.macro_code() {
            return self.macro_call(it, code);
        }
        if let Some(code) = self.multiple_cycle() {
            return self.multiple(it, code, sink);
        }
        let then = self.translate(&mut it.executor)?;
        if it.executor.recording.is_some() {
            return it.executor.record();
        }
        let moves = it.executor.words.any(crate::codes::AXES);
        let cycle = self.lathe_cycle.filter(|_| moves);
        if moves {
            threading::angle(&it.executor, self.thread_angle.take(), sink);
        }
        let after = match cycle {
            Some(code) => self.lathe_move(&mut it.executor, code, sink)?,
            None => it.executor.execute(sink)?,
        };
        self.group_one(&mut it.executor.state.motion);
        if after == After::End {
            it.ended = true;
            return Ok(());
        }
        match then {
            Then::Call { number, times } => self.call_program(it, number, times),
            Then::Return(to) => self.return_to(it, to),
            Then::Next if moves => self.modal_call(it),
            Then::Next => Ok(()),
        }
    }

    /// G80 ends a cycle, and the motion that was in force before it is in force again.
    fn group_one(&mut self, motion: &mut Motion) {
        match *motion {
            Motion::None if self.lathe_cycle.is_none() => *motion = self.before_cycle,
            Motion::None | Motion::Cycle(_) => {}
            other => self.before_cycle = other,
        }
    }

    /// O1234: the first one names the program; another one means that it was never ended.
    fn program_begins(
        &mut self,
        it: &mut Interpreter<'_>,
        label: gcode::Label,
        span: Span,
    ) -> Outcome {
        let gcode::Label::Number(number) = label else {
            return refuse("I1001", span, "O takes the number of a program, as in O1234");
        };
        let Some(before) = self.program.replace(number) else { return Ok(()) };
        it.ended = true;
        let text = format!("O{before} does not end: O{number} begins here");
        let help = "end a main program with M30, a subprogram or macro with M99";
        Err(error("I0301", span, text).with_help(help).into())
    }

    fn condition(&self, it: &mut Interpreter<'_>, value: gcode::Value) -> Outcome<f64> {
        let result = self.values(&it.executor).value(&it.block, value, it.block.span);
        it.ended |= result.is_err(); // there is no way to go on
        Ok(result?.unwrap_or(0.0))
    }

    fn control(&mut self, it: &mut Interpreter<'_>, control: Control) -> Outcome {
        match control {
            Control::GoTo(to) => {
                let number = self.condition(it, to)?;
                self.go_to(it, number)
            }
            Control::IfGoTo { condition, to } => {
                if self.condition(it, condition)? == 0.0 {
                    return Ok(());
                }
                let number = self.condition(it, to)?;
                self.go_to(it, number)
            }
            Control::While { condition, .. } => {
                let holds = match condition {
                    Some(condition) => self.condition(it, condition)? != 0.0,
                    None => true,
                };
                let end = self.loop_partner(it)?;
                if !holds {
                    it.jump(end.after);
                }
                Ok(())
            }
            Control::End(_) => {
                let begin = self.loop_partner(it)?;
                it.jump(begin.at);
                Ok(())
            }
            Control::IfThen(_) => Ok(()),
        }
    }
}
