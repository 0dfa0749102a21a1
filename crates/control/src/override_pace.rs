//! More feed than programmed, and stops at each line, at any moment: what has not been done is
//! planned anew.
//!
//! In lock-step what is under way is planned anew from where it is; by the clock, from a moment
//! ahead ([`plan::take_over`]).
use crate::KernelHandle;
use plan::{OperatorSettings, Planner, Step, TakeOver};
use std::collections::VecDeque;
use units::Time;

/// How long after now a new plan takes over, at first and at most; it has to be planned until then.
const LEAD: Time = Time::s(0.25);
const MOST_LEAD: Time = Time::s(4.0);
/// After a plan that could not take over, so many periods pass.
const PAUSE: u32 = 40;

/// What the moves that wait were planned for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    settings: OperatorSettings,
    /// How long after now a new plan takes over.
    lead: Time,
    /// Periods until it is tried again.
    pause: u32,
}

impl Default for Pace {
    fn default() -> Self {
        Self { settings: OperatorSettings::default(), lead: LEAD, pause: 0 }
    }
}

/// Steps that have come back to be planned anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CameBack {
    /// How many.
    pub(crate) steps: usize,
    /// By so much the one before them is shorter now.
    pub(crate) shorter: Time,
}

impl Pace {
    /// Look what the operator wants. `queue`: steps on their way to the kernel; `sent`: steps that
    /// it has.
    pub(crate) fn keep(
        &mut self,
        kernel: &mut KernelHandle,
        planner: &mut Planner,
        queue: &mut VecDeque<Step>,
        sent: &mut VecDeque<Step>,
    ) -> CameBack {
        let operator = kernel.operator();
        let settings = OperatorSettings {
            share: operator.share(false).max(1.0),
            stops: operator.single_block(),
        };
        if settings == self.settings || kernel.is_over() {
            return CameBack::default();
        }
        let now = self.settings;
        let more = settings.share > now.share || (settings.stops && !now.stops);
        if !more {
            // slower is the kernel's affair, and a stop that is planned does no harm
            self.settings = settings;
            planner.set_operator(settings);
            return CameBack::default();
        }
        if kernel.moves_elsewhere() {
            return self.take_over(settings, kernel, planner, (queue, sent));
        }
        let Some(back) = kernel.hand_back() else { return CameBack::default() };
        self.settings = settings;
        let mut steps = Vec::from(sent.split_off(sent.len().saturating_sub(back.steps)));
        steps.extend(queue.drain(..));
        planner.repace(settings, steps, back.done, &mut |step| queue.push_back(step));
        CameBack { steps: back.steps, shorter: Time::ZERO }
    }

    /// Plan anew from a moment ahead, while the kernel goes on.
    fn take_over(
        &mut self,
        settings: OperatorSettings,
        kernel: &mut KernelHandle,
        planner: &mut Planner,
        (queue, sent): (&mut VecDeque<Step>, &mut VecDeque<Step>),
    ) -> CameBack {
        self.pause = self.pause.saturating_sub(1);
        if self.pause > 0 || kernel.is_giving_up() {
            return CameBack::default();
        }
        self.pause = PAUSE;
        let (under_way, steps) = kernel.under_way();
        let first = sent.len().saturating_sub(steps);
        let Some(TakeOver { stays, at }) =
            plan::take_over(sent.iter().skip(first), under_way, self.lead)
        else {
            return CameBack::default();
        };
        let given_up = steps.saturating_sub(stays);
        let anew = if at.is_some() { first } else { first + stays };
        let mut planned = (planner.clone(), VecDeque::new());
        let again = sent.iter().skip(anew).chain(queue.iter()).cloned().collect();
        planned.0.repace(settings, again, at, &mut |step| planned.1.push_back(step));
        if !kernel.give_up(given_up, at) {
            self.lead = Time::s((2.0 * self.lead.value()).min(MOST_LEAD.value()));
            return CameBack::default();
        }
        (self.settings, self.lead, self.pause) = (settings, LEAD, 0);
        (*planner, *queue) = planned;
        sent.truncate(first + stays);
        // as the kernel has cut its own
        let shorter = at.zip(sent.back_mut()).map_or(Time::ZERO, |(at, last)| plan::cut(last, at));
        CameBack { steps: given_up, shorter }
    }
}
