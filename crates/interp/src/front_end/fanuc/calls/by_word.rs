//! Words of the machine's own that call programs: `M31 = "…: call O9020"` in the machine's file.
//!
//! ```text
//!   M31 A1. B2.   "call O9020"         as G65 P9020 A1. B2.      parameters 6080 to 6089; G: 6050 to 6059
//!   G0 X1. M32    "subprogram O9001"   G0 X1., then M98 P9001    parameters 6071 to 6079
//!   T5            "subprogram O9000"   #149 = 5, then M98 P9000  parameter 6001#5
//! ```
//!
//! In a program that was called so, and in what it calls, all such words are the plain ones: M6 in the macro of M6
//! changes the tool.
//!
//! Source: Fanuc, operator's manual of series 30i, "Macro call using G codes", "Macro call using an M code", "Subprogram
//! call using an M code", "Subprogram calls using a T code".
use crate::{
    call::{Sink, out::Out},
    codes::number::near_whole,
    fault::{Outcome, refuse},
    front_end::fanuc::state::{Callee, Fanuc, Said},
    program::Program,
    setup::MacroCall,
};

/// Where T leaves its number: #149.
const TOOL: usize = 149;

impl Fanuc {
    /// The word of the block at hand that calls a program, and which.
    pub(crate) fn calling_word(&self, it: &Program<'_>) -> Option<(Said, MacroCall)> {
        let calls = &it.executor.settings.macro_calls;
        if calls.is_empty() || it.executor.recording.is_some() {
            return None;
        }
        if self.levels.iter().any(|level| level.by_word) {
            return None;
        }
        self.said.iter().find_map(|said| {
            let is_meant = |call: &&MacroCall| {
                let number = call.number.map(f64::from);
                char::from(said.letter) == call.letter
                    && number.is_none_or(|number| number == said.value)
            };
            calls.iter().find(is_meant).map(|call| (*said, *call))
        })
    }

    /// Call it.
    pub(crate) fn call_by_word<S: Sink>(
        &mut self,
        it: &mut Program<'_>,
        word: Said,
        call: MacroCall,
        out: &mut Out<'_, S>,
    ) -> Outcome {
        let levels = self.levels.len();
        if call.takes_arguments {
            let called = self.arguments_of(it, (word.letter, word.value), Some(call.program))?;
            self.call_macro(it, &called)?;
        } else {
            let times = self.repeats_of_call()?;
            self.said.retain(|said| said.span != word.span && said.letter != b'L');
            if !self.said.is_empty() {
                self.words_read(it, out)?;
            }
            if it.ended || self.levels.len() != levels {
                let text = "a block calls one program: write two blocks";
                return refuse("I1067", word.span, text);
            }
            if word.letter == b'T' {
                self.variables.common[TOOL - 100] = Some(word.value);
            }
            let program = Some(call.program);
            self.call_program(it, Callee { program, in_file: false, times, start: None })?;
        }
        if self.levels.len() > levels
            && let Some(level) = self.levels.last_mut()
        {
            level.by_word = true;
        }
        Ok(())
    }

    /// L of the block.
    fn repeats_of_call(&self) -> Outcome<u32> {
        let Some(word) = self.said.iter().find(|said| said.letter == b'L') else { return Ok(1) };
        match near_whole(word.value).and_then(|n| u32::try_from(n).ok()) {
            Some(times) => Ok(times),
            None => {
                let text = format!("expected a whole number after L, found {}", word.value);
                refuse("I0108", word.span, text)
            }
        }
    }
}
