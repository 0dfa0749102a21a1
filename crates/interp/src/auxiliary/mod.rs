//! The auxiliary functions of a block in their order: tools, spindle, coolant, overrides, dwell.
//!
//! ```text
//!   switch        feed and spindle modes, tools, coolant, overrides, dwell
//!   outputs       outputs, inputs, the machine's own codes
//!   context       modes kept and restored
//!   tool_change   tool, spindle and way in one block
//! ```
pub(crate) mod context;
pub(crate) mod outputs;
pub(crate) mod switch;
pub(crate) mod tool_change;

use crate::{
    call::{Call, Sink, out::Out},
    codes::MGroup,
    fault::{Outcome, refuse},
    state::executor::Executor,
};
/// T, M6, M61, M3 M4 M5 M19, coolant, overrides, G4.
pub(crate) fn tools_and_switches<S: Sink>(ex: &mut Executor, out: &mut Out<'_, S>) -> Outcome {
    if ex.words.get(b'T').is_some() {
        let number = ex.tools.word(&ex.words, b'T')?;
        ex.modes.selected_tool = number;
        if number != 0 || !ex.settings.stand_alone {
            ex.modes.selected_pocket = Some(ex.tools.pocket(number));
        }
        out.say(&Call::SelectTool(number));
    }
    outputs::outputs(&ex.words, &mut ex.store, &ex.settings, out)?;
    match ex.words.m(MGroup::Tool) {
        Some(6) => {
            out.say(&Call::StartChange);
            ex.modes.spindle.turning = None;
            out.say(&Call::SpindleStop);
            ex.modes.current_tool = ex.modes.selected_tool;
            ex.modes.current_pocket = ex.modes.selected_pocket.unwrap_or(0);
            if !ex.settings.stand_alone || ex.modes.current_tool != 0 {
                ex.modes.loaded = ex.tools.entry(ex.modes.current_tool);
            }
            out.say(&Call::ChangeTool(ex.modes.current_tool));
        }
        Some(_) => {
            if ex.words.get(b'Q').is_none() {
                return refuse("I0604", ex.words.place.span, "M61 needs Q, the number of the tool");
            }
            ex.modes.current_tool = ex.tools.word(&ex.words, b'Q')?;
            ex.modes.current_pocket = ex.tools.pocket(ex.modes.current_tool);
            if !ex.settings.stand_alone {
                ex.modes.loaded = ex.tools.entry(ex.modes.current_tool);
            }
            out.say(&Call::ToolNumber(ex.modes.current_tool));
        }
        None => {}
    }
    switch::spindle(&ex.words, &mut ex.modes, out)?;
    switch::coolant(&ex.words, &mut ex.modes, out);
    switch::overrides(&ex.words, &mut ex.modes, out);
    context::context(ex, out)?;
    outputs::user_code(ex, out)?;
    switch::dwell(&ex.words, out)
}
