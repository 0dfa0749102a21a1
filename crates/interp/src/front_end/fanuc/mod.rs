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
//! The front end decides which block comes next, what its variables are worth, and what its words
//! mean in the shared language (millimetres or inches, seconds, the shared codes); everything that
//! moves is the [`Executor`](crate::state::executor::Executor)'s. A variable without a value makes
//! its word vanish.
//!
//! ```text
//!   tape/, calls/    programs, blocks and loops of a tape; jumps, subprograms, macros
//!   variables/       variables, expressions, system variables, DPRNT
//!   words/           a block's words with their values, in the shared language
//!   obey, act        what a block does; on_surface, corner, moves: in other ways than most
//!   cycles/          what only these controls have: lathe cycles, pockets, threads
//!   mapping/         polar coordinates, scaling, mirroring, rotation, surfaces
//!   offsets/         G10, T of a lathe, tool offsets, G45 to G48; reference, stroke beside them
//!   state            what is kept between two blocks, and of the block at hand
//! ```
//!
//! Source: Fanuc, operator's manuals of series 30i and 0i for machining centres and lathes.
#![allow(clippy::match_same_arms)] // a row of a table each
#![allow(clippy::large_types_passed_by_value)] // a macro's variables move into its call
#![allow(clippy::single_match_else)] // both outcomes are worth a line
pub(crate) mod act;
pub(crate) mod calls;
pub(crate) mod corner;
pub(crate) mod cycles;
pub(crate) mod mapping;
pub(crate) mod moves;
pub(crate) mod obey;
pub(crate) mod offsets;
pub(crate) mod on_surface;
pub(crate) mod reference;
pub(crate) mod state;
pub(crate) mod stroke;
pub(crate) mod tape;
pub(crate) mod variables;
pub(crate) mod words;

pub(crate) use calls::{programs, programs_by_word};
pub(crate) use state::Fanuc;
pub(crate) use tape::Tape;

use crate::{
    call::{Call, Sink, out::Out},
    cycles::gear_comment::gear_comment,
    execute::{After, refused},
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        act::group_one,
        calls::{
            by_word::{call_by_word, calling_word, words_beside_call},
            call_program, macro_call, macro_code, modal_call, named, return_to,
            steering::{condition_value, steer},
        },
        cycles::{
            circle::{circle, circle_code},
            turning::{end_of_shape, multiple, multiple_cycle, no_call_in_profile},
        },
        moves::{move_only, only_calls, only_moves},
        obey::obey,
        on_surface::{check_surface, on_surface},
        state::{Once, Then},
        variables::{output::output, values::assign},
        words::read::read,
    },
    program::Program,
};
use diag::Span;
use gcode::Control;

/// Execute the block that the interpreter has read.
pub(crate) fn block<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    out: &mut Out<'_, S>,
) -> Outcome {
    let result = execute(fanuc, it, out);
    if core::mem::take(&mut fanuc.once.back_to_increments) {
        it.executor.modes.incremental = true;
    }
    if fanuc.shape.is_none() {
        return result;
    }
    if let Err(fault) = result {
        it.report(*fault); // the profile is not whole, and will not be cut
    }
    end_of_shape(fanuc, it, out)
}

fn execute<S: Sink>(fanuc: &mut Fanuc, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
    if it.block.delete.is_some_and(|level| fanuc.skip_levels >> level & 1 == 1) {
        return Ok(());
    }
    it.executor.modes.line = it.block.span.line;
    it.ahead = 0;
    if let Some(word) = it.block.o {
        return program_begins(fanuc, it, word.label, word.span);
    }
    if it.block.percent {
        return percent(it, out);
    }
    if let Some(number) = it.block.number {
        fanuc.kept.word(b'N', number);
    }
    if let Some(control) = it.block.control {
        let Control::IfThen(condition) = control else { return steer(fanuc, it, control) };
        if condition_value(fanuc, it, condition)? == 0.0 {
            return Ok(());
        }
    }
    it.executor.words.begin(&it.block);
    out.place = it.executor.words.place;
    assign(fanuc, it, out).inspect_err(|_| refused::forget_parameters(&mut it.executor.modes))?;
    for comment in &it.block.comments {
        let text = it.block.text(comment.text);
        gear_comment(text, comment.span, &mut it.executor.modes, out.remarks);
    }
    if let Some(comment) = it.block.comments.last().filter(|_| it.block.assignments.is_empty()) {
        let text = it.block.text(comment.text).trim_start();
        out.say(&Call::Comment(text));
    }
    if it.block.output.is_some() {
        return output(fanuc, it, out);
    }
    fanuc.called = match it.block.called {
        Some(name) => Some(named(fanuc, it, name)?),
        None => None,
    };
    if it.block.words.is_empty() && fanuc.called.is_none() {
        return Ok(());
    }
    words(fanuc, it, out)
}

/// `%`: the end of the tape, which a subprogram's file may not reach.
fn percent<S: Sink>(it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
    if it.file == 0 {
        it.percent_sign(out);
        return Ok(());
    }
    it.ended = true;
    let fault = error("I0301", it.block.span, "this subprogram does not end: its tape is over");
    Err(fault.with_help("end it with M99").into())
}

/// A block with words.
fn words<S: Sink>(fanuc: &mut Fanuc, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
    read(fanuc, it)?;
    if it.executor.recording.is_some() {
        no_call_in_profile(fanuc, it)?;
    }
    let Some((word, call)) = calling_word(fanuc, it) else { return words_read(fanuc, it, out) };
    let levels = fanuc.levels.len();
    if call.takes_arguments {
        return call_by_word(fanuc, it, (word, call), 1, levels);
    }
    let times = words_beside_call(fanuc, word)?;
    if !fanuc.said.is_empty() {
        words_read(fanuc, it, out)?;
    }
    call_by_word(fanuc, it, (word, call), times, levels)
}

/// Those that have been read.
fn words_read<S: Sink>(fanuc: &mut Fanuc, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
    if only_moves(fanuc, &it.executor) {
        let moves = move_only(fanuc, &mut it.executor, out)?;
        return if moves { modal_call(fanuc, it) } else { Ok(()) };
    }
    if let Some(then) = only_calls(fanuc, &it.executor) {
        fanuc.once = Once::default();
        group_one(fanuc, &mut it.executor.modes.motion);
        return follow(fanuc, it, then, out);
    }
    if let Some(code) = macro_code(fanuc) {
        return macro_call(fanuc, it, code);
    }
    if let Some(clockwise) = circle_code(fanuc) {
        return circle(fanuc, it, clockwise, out);
    }
    check_surface(fanuc, &it.executor)?;
    if let Some(code) = multiple_cycle(fanuc) {
        return multiple(fanuc, it, code, out);
    }
    let (then, after) = match fanuc.surface {
        None => obey(fanuc, it, out)?,
        Some(surface) => on_surface(fanuc, it, surface, out)?,
    };
    if after == After::End {
        it.ended = true;
        return Ok(());
    }
    follow(fanuc, it, then, out)
}

fn follow<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    then: Then,
    out: &mut Out<'_, S>,
) -> Outcome {
    match then {
        Then::Call(callee) => call_program(fanuc, it, callee),
        Then::Return(to) => return_to(fanuc, it, to, out),
        Then::Moved => modal_call(fanuc, it),
        Then::Next => Ok(()),
    }
}

/// O1234: the first one names the program; another one means that it was never ended.
fn program_begins(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    label: gcode::Label,
    span: Span,
) -> Outcome {
    let number = match label {
        gcode::Label::Number(number) => number,
        gcode::Label::Name(_) => u32::MAX, // only what is called is found by its name
        gcode::Label::Computed(_) => {
            return refuse("I1001", span, "O takes the number of a program, as in O1234");
        }
    };
    let Some(before) = fanuc.program.replace(number) else { return Ok(()) };
    it.ended = true;
    let written = |number: u32| match number {
        number if number >= tape::NAMED => "this program".to_owned(),
        number => format!("O{number}"),
    };
    let text = format!("{} does not end: another program begins here", written(before));
    let help = "end a main program with M30, a subprogram or macro with M99";
    Err(error("I0301", span, text).with_help(help).into())
}
