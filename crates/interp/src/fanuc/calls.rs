//! Jumps, subprograms and macros: GOTO, M98, M99, G65, G66, G67.
//!
//! | argument | variable |
//! |---|---|
//! | A B C | #1 #2 #3 |
//! | I J K, first time | #4 #5 #6 |
//! | I J K, again | #7 #8 #9, #10 #11 #12, … up to #33 |
//! | D E F H M Q R S T U V W X Y Z | #7 #8 #9 #11 #13 #17 #18 … #26 |
//!
//! Where both ways give one variable a value, the later word holds.
use super::{
    Fanuc,
    tape::{Mark, Tape},
    values::{LOCALS, Locals},
};
use crate::{
    fault::{Outcome, error, refuse},
    interpreter::Interpreter,
    outline::At,
    words::near_whole,
};

/// A call that has not returned yet.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    back: At,
    /// The calling block: where GOTO of the caller searches from.
    caller: u32,
    program: Option<u32>,
    start: At,
    /// Executions still to come after this one.
    left: u32,
    /// The caller's #1 to #33, if the callee has its own.
    locals: Option<Box<Locals>>,
}

/// A macro with its arguments.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Macro {
    number: u32,
    times: u32,
    locals: Locals,
}

impl Fanuc {
    fn tape<'a>(&'a mut self, it: &mut Interpreter<'_>) -> Outcome<&'a Tape> {
        if self.tape.is_none() {
            let (tape, faults) = Tape::of(it.sources[0]);
            self.tape = Some(tape);
            let mut faults = faults.into_iter();
            if let Some(first) = faults.next() {
                it.report_all(faults);
                it.ended = true;
                return Err(first.into());
            }
        }
        match &self.tape {
            Some(tape) => Ok(tape),
            None => refuse("I1005", it.block.span, "the tape was not read"),
        }
    }

    pub(super) fn loop_partner(&mut self, it: &mut Interpreter<'_>) -> Outcome<Mark> {
        let span = it.block.span;
        if let Some(mark) = self.tape(it)?.partner(span.start) {
            Ok(mark)
        } else {
            it.ended = true;
            refuse("I1003", span, "this loop has no other end")
        }
    }

    pub(super) fn go_to(&mut self, it: &mut Interpreter<'_>, number: f64) -> Outcome {
        self.go_to_from(it, number, it.block.span.start)
    }

    fn go_to_from(&mut self, it: &mut Interpreter<'_>, number: f64, from: u32) -> Outcome {
        let span = it.block.span;
        let whole = near_whole(number).and_then(|n| u32::try_from(n).ok()).filter(|n| *n > 0);
        let found = match whole {
            Some(whole) => self.tape(it)?.block(whole, from),
            None => None,
        };
        if let Some(at) = found {
            it.jump(at);
            Ok(())
        } else {
            it.ended = true; // which blocks would follow is not known
            refuse("I1006", span, format!("there is no block N{number} in this program"))
        }
    }

    /// The block N of the program at hand.
    pub(super) fn block_at(&mut self, it: &mut Interpreter<'_>, number: u32) -> Option<At> {
        let from = it.block.span.start;
        self.tape(it).ok().and_then(|tape| tape.block(number, from))
    }

    /// M98.
    pub(super) fn call_program(
        &mut self,
        it: &mut Interpreter<'_>,
        number: u32,
        times: u32,
    ) -> Outcome {
        self.enter(it, number, times, None)
    }

    fn enter(
        &mut self,
        it: &mut Interpreter<'_>,
        number: u32,
        times: u32,
        locals: Option<Locals>,
    ) -> Outcome {
        let span = it.block.span;
        let Some(start) = self.tape(it)?.program(number) else {
            let known: Vec<_> =
                self.tape(it)?.programs().take(12).map(|n| format!("O{n}")).collect();
            let fault = error("I0313", span, format!("there is no program O{number} on this tape"));
            let help = if known.is_empty() {
                format!("write O{number} before its first block and M99 at its end")
            } else {
                format!("it has {}", known.join(", "))
            };
            return Err(fault.with_help(help).into());
        };
        if times == 0 {
            return Ok(());
        }
        if self.levels.len() >= it.limits.calls {
            it.ended = true;
            let text =
                format!("programs call each other more than {} levels deep", it.limits.calls);
            return refuse("I0801", span, text);
        }
        let locals = locals.map(|new| Box::new(core::mem::replace(&mut self.variables.local, new)));
        self.levels.push(Level {
            back: it.parsers[0].position(),
            caller: span.start,
            program: self.program.replace(number),
            start,
            left: times - 1,
            locals,
        });
        it.executor.state.call_level = self.levels.len();
        it.jump(start);
        Ok(())
    }

    /// M99, and M99 P: on with this block of the caller.
    pub(super) fn return_to(&mut self, it: &mut Interpreter<'_>, to: Option<u32>) -> Outcome {
        let Some(level) = self.levels.last_mut() else {
            if let Some(number) = to {
                return self.go_to(it, f64::from(number));
            }
            it.ended = true;
            let text = "M99 in the main program would repeat it for ever";
            return Err(error("I0314", it.block.span, text).with_help("end it with M30").into());
        };
        if level.left > 0 && to.is_none() {
            level.left -= 1;
            let start = level.start;
            it.jump(start);
            return Ok(());
        }
        let Some(level) = self.levels.pop() else { return Ok(()) };
        self.program = level.program;
        it.executor.state.call_level = self.levels.len();
        if let Some(locals) = level.locals {
            self.variables.local = *locals;
        }
        match to {
            None => it.jump(level.back),
            Some(number) => return self.go_to_from(it, f64::from(number), level.caller),
        }
        Ok(())
    }

    /// G65, G66 or G67, if the block at hand has one.
    pub(super) fn macro_code(&self) -> Option<u16> {
        let code =
            |s: &&super::words::Said| s.letter == b'G' && matches!(s.value, 65.0 | 66.0 | 67.0);
        self.said.iter().find(code).map(|s| s.value as u16)
    }

    pub(super) fn macro_call(&mut self, it: &mut Interpreter<'_>, code: u16) -> Outcome {
        if code == 67 {
            let span = it.block.span;
            self.modal = None;
            if self.said.len() > 1 {
                return refuse("I1007", span, "G67 ends G66 and stands alone in its block");
            }
            return Ok(());
        }
        let called = self.arguments(it, code)?;
        if code == 66 {
            self.modal = Some(called);
            return Ok(());
        }
        self.enter(it, called.number, called.times, Some(called.locals))
    }

    /// G66: after a block that moves, but not inside the macro itself.
    pub(super) fn modal_call(&mut self, it: &mut Interpreter<'_>) -> Outcome {
        match self.modal.clone() {
            Some(called) if self.levels.is_empty() => {
                self.enter(it, called.number, called.times, Some(called.locals))
            }
            _ => Ok(()),
        }
    }

    fn arguments(&self, it: &Interpreter<'_>, code: u16) -> Outcome<Macro> {
        let span = it.block.span;
        let (mut number, mut times) = (None, 1);
        let mut locals = [None; LOCALS];
        let (mut set, mut last) = (0, None);
        let mut begun = false;
        for said in &self.said {
            let whole = || match near_whole(said.value).and_then(|n| u32::try_from(n).ok()) {
                Some(n) => Ok(n),
                None => refuse(
                    "I0108",
                    said.span,
                    format!(
                        "expected a whole number after {}, found {}",
                        said.letter as char, said.value
                    ),
                ),
            };
            let variable = match said.letter {
                b'G' if said.value == f64::from(code) => {
                    begun = true;
                    continue;
                }
                _ if !begun => {
                    let text = format!("expected G{code} before its arguments");
                    return refuse("I1008", said.span, text);
                }
                b'P' => {
                    number = Some(whole()?);
                    continue;
                }
                b'L' => {
                    times = whole()?;
                    continue;
                }
                b'A'..=b'C' => said.letter - b'A' + 1,
                b'D' | b'E' | b'F' => said.letter - b'D' + 7,
                b'H' => 11,
                b'M' => 13,
                b'Q'..=b'Z' => said.letter - b'Q' + 17,
                rank @ b'I'..=b'K' => {
                    if last.is_some_and(|last| rank <= last) {
                        set += 1;
                    }
                    last = Some(rank);
                    4 + 3 * set + (rank - b'I')
                }
                other => {
                    let text = format!("{} cannot be an argument of G{code}", other as char);
                    return refuse("I1009", said.span, text);
                }
            };
            let Some(slot) = locals.get_mut(usize::from(variable) - 1) else {
                return refuse("I1009", said.span, "I, J and K can be given ten times at most");
            };
            *slot = Some(self.scaled(&it.executor, said));
        }
        match number {
            Some(number) => Ok(Macro { number, times, locals }),
            None => refuse("I1010", span, format!("G{code} needs P, the number of the macro")),
        }
    }
}
