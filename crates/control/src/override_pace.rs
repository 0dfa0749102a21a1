//! More feed than programmed, and stops at each line, at any moment: what has not been done is planned anew.
use crate::KernelHandle;
use plan::Step;
use plan::{OperatorSettings, Planner};
use std::collections::VecDeque;

/// What the moves that wait were planned for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace(OperatorSettings);

impl Pace {
    /// Look what the operator wants. `queue`: steps on their way to the kernel; `sent`: steps that it has. So many of these have come
    /// back to be planned anew.
    pub(crate) fn keep(
        &mut self,
        kernel: &mut KernelHandle,
        planner: &mut Planner,
        queue: &mut VecDeque<Step>,
        sent: &mut VecDeque<Step>,
    ) -> usize {
        let operator = kernel.operator();
        let settings = OperatorSettings {
            share: operator.share(false).max(1.0),
            stops: operator.single_block(),
        };
        if settings == self.0 || kernel.is_over() {
            return 0;
        }
        let more = settings.share > self.0.share || (settings.stops && !self.0.stops);
        if !more {
            // slower is the kernel's affair, and a stop that is planned does no harm
            self.0 = settings;
            planner.set_operator(settings);
            return 0;
        }
        let Some(back) = kernel.hand_back() else { return 0 };
        self.0 = settings;
        let mut steps = Vec::from(sent.split_off(sent.len().saturating_sub(back.steps)));
        steps.extend(queue.drain(..));
        planner.repace(settings, steps, back.done, &mut |step| queue.push_back(step));
        back.steps
    }
}
