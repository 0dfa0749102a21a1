//! Conditions, jumps and loops: IF, GOTO, WHILE, DO and END.
use crate::{
    fault::Outcome,
    front_end::fanuc::{
        calls::{go_to, loop_partner},
        state::Fanuc,
        variables::values::values,
    },
    program::Program,
};
use gcode::Control;

pub(crate) fn condition_value(
    fanuc: &Fanuc,
    it: &mut Program<'_>,
    value: gcode::Value,
) -> Outcome<f64> {
    let result = values(fanuc, &it.executor).value(&it.block, value, it.block.span);
    it.ended |= result.is_err(); // there is no way to go on
    Ok(result?.unwrap_or(0.0))
}

pub(crate) fn steer(fanuc: &mut Fanuc, it: &mut Program<'_>, control: Control) -> Outcome {
    match control {
        Control::GoTo(to) => {
            let number = condition_value(fanuc, it, to)?;
            go_to(fanuc, it, number)
        }
        Control::IfGoTo { condition, to } => {
            if condition_value(fanuc, it, condition)? == 0.0 {
                return Ok(());
            }
            let number = condition_value(fanuc, it, to)?;
            go_to(fanuc, it, number)
        }
        Control::While { condition, .. } => {
            let holds = match condition {
                Some(condition) => condition_value(fanuc, it, condition)? != 0.0,
                None => true,
            };
            let end = loop_partner(fanuc, it)?;
            if !holds {
                it.jump(end.after);
            }
            Ok(())
        }
        Control::End(_) => {
            let begin = loop_partner(fanuc, it)?;
            it.jump(begin.at);
            Ok(())
        }
        Control::IfThen(_) => Ok(()),
    }
}
