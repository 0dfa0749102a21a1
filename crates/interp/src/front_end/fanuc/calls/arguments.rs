//! The arguments of a macro: which letter becomes which variable.
//!
//! | argument | variable |
//! |---|---|
//! | A B C | #1 #2 #3 |
//! | I J K, first time | #4 #5 #6 |
//! | I J K, again | #7 #8 #9, #10 #11 #12, … up to #33 |
//! | D E F H M Q R S T U V W X Y Z | #7 #8 #9 #11 #13 #17 #18 … #26 |
//!
//! Where both ways give one variable a value, the later word holds.
//!
//! Source: Fanuc, operator's manual of series 30i, "Custom macro", "Argument specification".
use crate::{
    codes::number::near_whole,
    fault::{Outcome, refuse},
    front_end::fanuc::{
        state::{Fanuc, LOCALS, Macro},
        words::read::scaled,
    },
    program::Program,
};

/// Those of G65 or G66.
pub(crate) fn arguments(fanuc: &Fanuc, it: &Program<'_>, code: u16) -> Outcome<Macro> {
    arguments_of(fanuc, it, (b'G', f64::from(code)), None)
}

/// Those of a word that calls a macro; which one, unless P says it.
pub(crate) fn arguments_of(
    fanuc: &Fanuc,
    it: &Program<'_>,
    (letter, code): (u8, f64),
    program: Option<u32>,
) -> Outcome<Macro> {
    let span = it.block.span;
    let caller = format!("{}{code}", letter as char);
    let (mut number, mut times) = (program.or(fanuc.called), 1);
    let mut locals = [None; LOCALS];
    let (mut set, mut last) = (0, None);
    let mut begun = false;
    for said in &fanuc.said {
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
            own if own == letter && said.value == code && !begun => {
                begun = true;
                continue;
            }
            _ if !begun => {
                let text = format!("expected {caller} before its arguments");
                return refuse("I1008", said.span, text);
            }
            b'P' if program.is_none() => {
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
                let text = format!("{} cannot be an argument of {caller}", other as char);
                return refuse("I1009", said.span, text);
            }
        };
        let Some(slot) = locals.get_mut(usize::from(variable) - 1) else {
            return refuse("I1009", said.span, "I, J and K can be given ten times at most");
        };
        *slot = Some(scaled(fanuc, &it.executor, said));
    }
    match number {
        Some(number) => Ok(Macro { number, times, locals }),
        None => refuse("I1010", span, format!("{caller} needs P, the number of the macro")),
    }
}
