//! Conditions, jumps and loops: IF, GOTO, WHILE, DO and END.
use crate::{fault::Outcome, front_end::fanuc::state::Fanuc, program::Program};
use gcode::Control;

impl Fanuc {
    pub(crate) fn condition(&self, it: &mut Program<'_>, value: gcode::Value) -> Outcome<f64> {
        let result = self.values(&it.executor).value(&it.block, value, it.block.span);
        it.ended |= result.is_err(); // there is no way to go on
        Ok(result?.unwrap_or(0.0))
    }

    pub(crate) fn control(&mut self, it: &mut Program<'_>, control: Control) -> Outcome {
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
