//! How far planning is ahead of what is executed: the time of the steps that the kernel has and has
//! not done.
use motion::Follow;
use plan::{Step, StepKind};
use std::collections::VecDeque;
use units::Time;

/// What waits, by its planned time.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionAhead {
    waiting: VecDeque<StepTime>,
    total_s: f64,
    least: Option<Time>,
}

#[derive(Clone, Copy, Debug)]
struct StepTime {
    takes_s: f64,
    /// The next one must be there when it ends.
    flows_on: bool,
}

impl MotionAhead {
    /// A step goes to the kernel.
    pub(crate) fn push(&mut self, step: &Step) {
        let waiting = match &step.kind {
            StepKind::Follow(follow) => {
                StepTime { takes_s: takes_s(follow), flows_on: !follow.exact_stop }
            }
            StepKind::Move(order) if !order.per_revolution => {
                StepTime { takes_s: order.profile.duration(), flows_on: false }
            }
            StepKind::Dwell(time) => StepTime { takes_s: time.value(), flows_on: false },
            // how long others take shows when they are executed
            _ => StepTime { takes_s: 0.0, flows_on: false },
        };
        self.total_s += waiting.takes_s;
        self.waiting.push_back(waiting);
    }

    /// The last ones were handed back.
    pub(crate) fn forget_last(&mut self, steps: usize) {
        for _ in 0..steps {
            self.total_s -= self.waiting.pop_back().map_or(0.0, |waiting| waiting.takes_s);
        }
    }

    /// The last one is shorter than it was.
    pub(crate) fn shorten_last(&mut self, by: Time) {
        if let Some(last) = self.waiting.back_mut() {
            let by_s = by.value().min(last.takes_s);
            last.takes_s -= by_s;
            self.total_s -= by_s;
        }
    }

    /// The kernel has so many steps that are not done; `is_all`: none follow them.
    pub(crate) fn keep(&mut self, steps: usize, is_all: bool) {
        while self.waiting.len() > steps {
            self.total_s -= self.waiting.pop_front().map_or(0.0, |waiting| waiting.takes_s);
        }
        if let Some(under_way) = self.waiting.front().filter(|step| step.flows_on && !is_all) {
            let ahead = Time::s((self.total_s - under_way.takes_s).max(0.0));
            self.least = Some(self.least.map_or(ahead, |least| least.min(ahead)));
        }
    }

    /// What waits takes so long.
    pub(crate) fn time(&self) -> Time {
        Time::s(self.total_s.max(0.0))
    }

    /// The least that waited behind a stretch that flows on, while more was to come.
    pub(crate) const fn least(&self) -> Option<Time> {
        self.least
    }
}

fn takes_s(follow: &Follow) -> f64 {
    let turning = if follow.per_revolution { follow.pace.turning } else { 1.0 };
    follow.duration() / turning.max(1e-9)
}
