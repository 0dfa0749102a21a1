//! Words of the machine's own that call programs: `M31 = "…: call O9020"` in the machine's file.
//!
//! ```text
//!   M31 A1. B2.   "call O9020"         as G65 P9020 A1. B2.      parameters 6080 to 6089; G: 6050 to 6059
//!   G0 X1. M32    "subprogram O9001"   G0 X1., then M98 P9001    parameters 6071 to 6079
//!   T5            "subprogram O9000"   #149 = 5, then M98 P9000  parameter 6001#5
//! ```
//!
//! In a program that was called so, and in what it calls, all such words are the plain ones: M6 in
//! the macro of M6 changes the tool.
//!
//! Source: Fanuc, operator's manual of series 30i, "Macro call using G codes", "Macro call using an
//! M code", "Subprogram call using an M code", "Subprogram calls using a T code".
use crate::{
    codes::number::near_whole,
    fault::{Outcome, refuse},
    front_end::fanuc::{
        calls::{arguments::arguments_of, call_macro, call_program},
        state::{Callee, Fanuc, Said},
    },
    program::Program,
    setup::MacroCall,
};

/// Where T leaves its number: #149.
const TOOL: usize = 149;

/// The word of the block at hand that calls a program, and which.
#[inline]
pub(crate) fn calling_word(fanuc: &Fanuc, it: &Program<'_>) -> Option<(Said, MacroCall)> {
    let calls = &it.executor.settings.macro_calls;
    if calls.is_empty() || it.executor.recording.is_some() {
        return None;
    }
    if fanuc.levels.iter().any(|level| level.by_word) {
        return None;
    }
    fanuc.said.iter().find_map(|said| {
        let is_meant = |call: &&MacroCall| {
            let number = call.number.map(f64::from);
            char::from(said.letter) == call.letter
                && number.is_none_or(|number| number == said.value)
        };
        calls.iter().find(is_meant).map(|call| (*said, *call))
    })
}

/// What a call without arguments leaves of the block at hand, which is executed before it; how
/// often it calls.
pub(crate) fn words_beside_call(fanuc: &mut Fanuc, word: Said) -> Outcome<u32> {
    let times = repeats_of_call(fanuc)?;
    fanuc.said.retain(|said| said.span != word.span && said.letter != b'L');
    Ok(times)
}

/// Call it, so often if it takes no arguments; so deep were the calls when the block began.
pub(crate) fn call_by_word(
    fanuc: &mut Fanuc,
    it: &mut Program<'_>,
    (word, call): (Said, MacroCall),
    times: u32,
    levels: usize,
) -> Outcome {
    if call.takes_arguments {
        let called = arguments_of(fanuc, it, (word.letter, word.value), Some(call.program))?;
        call_macro(fanuc, it, &called)?;
    } else {
        if it.ended || fanuc.levels.len() != levels {
            let text = "a block calls one program: write two blocks";
            return refuse("I1067", word.span, text);
        }
        if word.letter == b'T' {
            fanuc.variables.common[TOOL - 100] = Some(word.value);
        }
        let program = Some(call.program);
        call_program(fanuc, it, Callee { program, in_file: false, times, start: None })?;
    }
    if fanuc.levels.len() > levels
        && let Some(level) = fanuc.levels.last_mut()
    {
        level.by_word = true;
    }
    Ok(())
}

/// L of the block.
fn repeats_of_call(fanuc: &Fanuc) -> Outcome<u32> {
    let Some(word) = fanuc.said.iter().find(|said| said.letter == b'L') else { return Ok(1) };
    match near_whole(word.value).and_then(|n| u32::try_from(n).ok()) {
        Some(times) => Ok(times),
        None => {
            let text = format!("expected a whole number after L, found {}", word.value);
            refuse("I0108", word.span, text)
        }
    }
}
