//! Jumps, subprograms and macros: GOTO, M98, M99, G65, G66, G67.
//!
//! ```text
//!   G66 P1 …      each block that moves calls O1
//!   G66 P2 …      each block that moves calls O2, and each one that moves in O2 calls O1
//!   G67           ends O2
//! ```
//!
//! M99 in the main program goes back to its first block. That has no end, unless a variable counts:
//! where nothing has changed since the round before, the program is over here, and it is said.
//!
//! Source: Fanuc, operator's manual of series 30i, "Subprogram", "Custom macro".
pub(crate) mod arguments;
pub(crate) mod by_word;
pub(crate) mod steering;

use crate::{
    call::{Sink, out::Out},
    codes::number::near_whole,
    execute,
    fault::{Outcome, error, refuse},
    front_end::fanuc::{
        calls::arguments::arguments,
        state::{Callee, Fanuc, Level, Locals, Macro},
        tape::{Tape, TapePosition, loops::Mark},
    },
    program::Program,
    setup::MacroCall,
};
use diag::Diagnostic;
use gcode::{Block, Grammar, Label, Parser, Value};
use std::collections::HashSet;

/// Rounds of a main program that M99 repeats.
const MOST_ROUNDS: u32 = 1_000;

fn tape<'a>(fanuc: &'a mut Fanuc, it: &mut Program<'_>) -> Outcome<&'a Tape> {
    it.steered = true;
    if fanuc.tape.is_none() {
        let (tape, faults) = Tape::of(&it.sources, &it.names);
        fanuc.tape = Some(tape);
        let mut faults = faults.into_iter();
        if let Some(first) = faults.next() {
            it.contents_are_faulty = true;
            it.report_all(faults);
            it.ended = true;
            return Err(first.into());
        }
    }
    match &fanuc.tape {
        Some(tape) => Ok(tape),
        None => refuse("I1005", it.block.span, "the tape was not read"),
    }
}

pub(crate) fn loop_partner(fanuc: &mut Fanuc, it: &mut Program<'_>) -> Outcome<Mark> {
    let span = it.block.span;
    if let Some(mark) = tape(fanuc, it)?.partner(it.file, span.start) {
        Ok(mark)
    } else {
        it.ended = true;
        refuse("I1003", span, "this loop has no other end")
    }
}

/// The number of the program with this name.
pub(crate) fn named(fanuc: &mut Fanuc, it: &mut Program<'_>, name: gcode::Text) -> Outcome<u32> {
    let name = it.block.text(name).to_owned();
    if let Some(number) = tape(fanuc, it)?.named(&name) {
        return Ok(number);
    }
    Err(no_program(fanuc, it, &format!("<{name}>"))?.into())
}

fn no_program(fanuc: &mut Fanuc, it: &mut Program<'_>, which: &str) -> Outcome<Diagnostic> {
    let span = it.block.span;
    let tape = tape(fanuc, it)?;
    let known: Vec<_> = tape.programs().take(12).map(|n| tape.written(n)).collect();
    let text =
        format!("there is no program {which} on this tape, nor a file of that name beside it");
    let help = if known.is_empty() {
        format!("write {which} before its first block and M99 at its end")
    } else {
        format!("it has {}", known.join(", "))
    };
    Ok(error("I0313", span, text).with_help(help))
}

pub(crate) fn go_to(fanuc: &mut Fanuc, it: &mut Program<'_>, number: f64) -> Outcome {
    go_to_from(fanuc, it, number, it.block.span.start)
}

fn go_to_from(fanuc: &mut Fanuc, it: &mut Program<'_>, number: f64, from: u32) -> Outcome {
    let span = it.block.span;
    let whole = near_whole(number).and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0);
    let found = match whole {
        Some(whole) => tape(fanuc, it)?.block(whole, it.file, from),
        None => None,
    };
    if let Some(place) = found {
        jump(it, place);
        Ok(())
    } else {
        it.ended = true; // which blocks would follow is not known
        refuse("I1006", span, format!("there is no block N{number} in this program"))
    }
}

/// The block N of the program at hand.
pub(crate) fn block_at(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    number: u32,
) -> Option<TapePosition> {
    let (file, from) = (it.file, it.block.span.start);
    tape(fanuc, it).ok().and_then(|tape| tape.block(number, file, from))
}

/// M98, M198.
pub(crate) fn call_program(fanuc: &mut Fanuc, it: &mut Program<'_>, callee: Callee) -> Outcome {
    let Callee { program, in_file, times, start } = callee;
    let begin = match program {
        Some(number) if in_file => begin_of_file(fanuc, it, number)?,
        Some(number) => begin_of(fanuc, it, number)?,
        None => TapePosition { file: it.file, at: (it.block.span.start, 0) }, // of the program at hand
    };
    let Some(number) = start else { return enter(fanuc, it, program, begin, times, None) };
    match tape(fanuc, it)?.block(number, begin.file, begin.at.0) {
        Some(place) => enter(fanuc, it, program.or(fanuc.program), place, times, None),
        None => {
            it.ended = true;
            refuse("I1006", it.block.span, format!("there is no block N{number} in that program"))
        }
    }
}

/// G65.
pub(crate) fn call_macro(fanuc: &mut Fanuc, it: &mut Program<'_>, called: &Macro) -> Outcome {
    let begin = begin_of(fanuc, it, called.number)?;
    enter(fanuc, it, Some(called.number), begin, called.times, Some(called.locals))
}

fn begin_of(fanuc: &mut Fanuc, it: &mut Program<'_>, number: u32) -> Outcome<TapePosition> {
    if let Some(place) = tape(fanuc, it)?.program(number) {
        return Ok(place);
    }
    let which = tape(fanuc, it)?.written(number);
    Err(no_program(fanuc, it, &which)?.into())
}

/// M198: a file of the search path is what a memory card is to a control.
fn begin_of_file(fanuc: &mut Fanuc, it: &mut Program<'_>, number: u32) -> Outcome<TapePosition> {
    let span = it.block.span;
    let tape = tape(fanuc, it)?;
    if let Some(place) = tape.file(number) {
        return Ok(place);
    }
    let which = tape.written(number);
    let text = format!("there is no file {which}.nc beside this program or in its search path");
    let help = if tape.program(number).is_some() {
        format!("{which} is on this tape: M98 calls it")
    } else {
        "M198 calls programs in files of their own, M98 also those of this tape".to_owned()
    };
    Err(error("I0313", span, text).with_help(help).into())
}

fn enter(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    program: Option<u32>,
    start: TapePosition,
    times: u32,
    locals: Option<Locals>,
) -> Outcome {
    let span = it.block.span;
    if times == 0 {
        return Ok(());
    }
    if fanuc.levels.len() >= it.limits.calls {
        it.ended = true;
        let text = format!("programs call each other more than {} levels deep", it.limits.calls);
        return refuse("I0801", span, text);
    }
    let locals = locals.map(|new| Box::new(core::mem::replace(&mut fanuc.variables.local, new)));
    fanuc.levels.push(Level {
        back: TapePosition { file: it.file, at: it.parsers[it.file].position() },
        caller: span.start,
        program: core::mem::replace(&mut fanuc.program, program),
        start,
        left: times - 1,
        locals,
        by_word: false,
        modals: None,
    });
    it.executor.modes.call_level = fanuc.levels.len();
    jump(it, start);
    Ok(())
}

/// M99, and M99 P: on with this block of the caller.
pub(crate) fn return_to<S: Sink>(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    to: Option<u32>,
    out: &mut Out<'_, S>,
) -> Outcome {
    let Some(level) = fanuc.levels.last_mut() else {
        return match to {
            Some(number) => go_to(fanuc, it, f64::from(number)),
            None => next_round(fanuc, it, out),
        };
    };
    if level.left > 0 && to.is_none() {
        level.left -= 1;
        let start = level.start;
        jump(it, start);
        return Ok(());
    }
    let Some(level) = fanuc.levels.pop() else { return Ok(()) };
    fanuc.program = level.program;
    it.executor.modes.call_level = fanuc.levels.len();
    if let Some(locals) = level.locals {
        fanuc.variables.local = *locals;
    }
    if let Some(modals) = level.modals {
        fanuc.modals = modals;
    }
    match to {
        None => jump(it, level.back),
        Some(number) => {
            it.file = level.back.file;
            return go_to_from(fanuc, it, f64::from(number), level.caller);
        }
    }
    Ok(())
}

/// M99 of the main program.
fn next_round<S: Sink>(fanuc: &mut Fanuc, it: &mut Program<'_>, out: &mut Out<'_, S>) -> Outcome {
    let span = it.block.span;
    if fanuc.round_before == fanuc.variables {
        let text = "M99 repeats the main program for ever: it is read once here";
        let remark = Diagnostic::warning("I1050", span, text);
        it.report(remark.with_help("M30 ends a program"));
        execute::end_program(
            &mut it.executor.modes,
            &mut it.executor.store,
            &it.executor.settings,
            true,
            out,
        );
        it.ended = true;
        return Ok(());
    }
    fanuc.rounds += 1;
    if fanuc.rounds >= MOST_ROUNDS {
        it.ended = true;
        let text = format!("M99 has repeated the main program {MOST_ROUNDS} times: does it end?");
        return refuse("I1051", span, text);
    }
    fanuc.round_before = fanuc.variables.clone();
    let program = fanuc.program;
    let begin = tape(fanuc, it)?.main(program);
    jump(it, begin);
    Ok(())
}

/// G65, G66 or G67, if the block at hand has one.
pub(crate) fn macro_code(fanuc: &Fanuc) -> Option<u16> {
    let code = |s: &&crate::front_end::fanuc::state::Said| {
        s.letter == b'G' && matches!(s.value, 65.0 | 66.0 | 67.0)
    };
    fanuc.said.iter().find(code).map(|s| s.value as u16)
}

pub(crate) fn macro_call(fanuc: &mut Fanuc, it: &mut Program<'_>, code: u16) -> Outcome {
    if code == 67 {
        let span = it.block.span;
        fanuc.modals.pop();
        if fanuc.said.len() > 1 {
            return refuse("I1007", span, "G67 ends G66 and stands alone in its block");
        }
        return Ok(());
    }
    let called = arguments(fanuc, it, code)?;
    if code == 66 {
        if fanuc.modals.len() >= it.limits.calls {
            let text = format!("more than {} modal macros: G67 ends one", it.limits.calls);
            return refuse("I0801", it.block.span, text);
        }
        fanuc.modals.push(called);
        return Ok(());
    }
    call_macro(fanuc, it, &called)
}

/// G66: after a block that moves; a modal macro's own moves call the one before it.
pub(crate) fn modal_call(fanuc: &mut Fanuc, it: &mut Program<'_>) -> Outcome {
    let Some(called) = fanuc.modals.last().cloned() else { return Ok(()) };
    let levels = fanuc.levels.len();
    call_macro(fanuc, it, &called)?;
    if fanuc.levels.len() > levels
        && let Some(level) = fanuc.levels.last_mut()
    {
        let inner = fanuc.modals[..fanuc.modals.len() - 1].to_vec();
        level.modals = Some(core::mem::replace(&mut fanuc.modals, inner));
    }
    Ok(())
}

fn jump(it: &mut Program<'_>, to: TapePosition) {
    it.file = to.file;
    it.jump(to.at);
}

/// Programs that a tape calls by M98, G65 or G66, in their order, and those that it has: their
/// numbers, or their names.
pub(crate) fn programs(source: &[u8]) -> (Vec<String>, HashSet<String>) {
    let (mut parser, mut block) = (Parser::with_grammar(source, 0, Grammar::Fanuc), Block::new());
    let (mut called, mut there) = (Vec::new(), HashSet::new());
    let mut in_files = Vec::new();
    while parser.next(&mut block) {
        match block.o.map(|o| o.label) {
            Some(Label::Number(number)) => _ = there.insert(number.to_string()),
            Some(Label::Name(name)) => _ = there.insert(block.text(name).to_owned()),
            _ => {}
        }
        let name = match block.called {
            Some(name) => block.text(name).to_owned(),
            None => match called_number(&block) {
                Some(number) => number.to_string(),
                None => continue,
            },
        };
        if has(&block, b'M', &[198.0]) {
            in_files.push(name.clone());
        }
        if !called.contains(&name) {
            called.push(name);
        }
    }
    for name in in_files {
        there.remove(&name); // what is on the tape is not what M198 calls
    }
    (called, there)
}

/// Programs that words of the machine's own call on a tape: their numbers.
pub(crate) fn programs_by_word(source: &[u8], calls: &[MacroCall]) -> Vec<String> {
    let (mut parser, mut block) = (Parser::with_grammar(source, 0, Grammar::Fanuc), Block::new());
    let mut found = Vec::new();
    while !calls.is_empty() && parser.next(&mut block) {
        for word in &block.words {
            let is_meant = |call: &&MacroCall| {
                let number = call.number.map(f64::from);
                char::from(word.letter) == call.letter
                    && number.is_none_or(|number| plain(word) == Some(number))
            };
            let name = calls.iter().find(is_meant).map(|call| call.program.to_string());
            found.extend(name.filter(|name| !found.contains(name)));
        }
    }
    found
}

/// A word's number, if it is written as one.
const fn plain(word: &gcode::Word) -> Option<f64> {
    match word.value {
        Value::Number(number) => Some(number),
        Value::Expression(_) => None,
    }
}

/// Whether a block has one of these codes.
fn has(block: &Block, letter: u8, codes: &[f64]) -> bool {
    let mut words = block.words.iter().filter(|word| word.letter == letter);
    words.any(|word| plain(word).is_some_and(|code| codes.contains(&code)))
}

/// P of a call, if it is written as a number.
fn called_number(block: &Block) -> Option<u32> {
    let (program, macros) = (has(block, b'M', &[98.0, 198.0]), has(block, b'G', &[65.0, 66.0]));
    let number = near_whole(plain(block.word(b'P').filter(|_| program || macros)?)?)?;
    let number = u32::try_from(number).ok()?;
    // P51002: five times O1002
    let repeats = program && block.word(b'L').is_none() && number > 9999;
    Some(if repeats { number % 10_000 } else { number })
}
