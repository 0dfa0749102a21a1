//! The planned time of steps: how long they will take, one after another, with the spindle ramps that run beside them.
use crate::limits::MachineLimits;
use crate::{ChipThrow, SpindleStep, Step, StepKind};
use units::Time;

/// Adds up the planned time of steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    /// Planned time of all that was counted, s.
    elapsed: f64,
    /// When the ordered spindle ramp is over, s.
    ready_at: f64,
    /// Speed of spindle 0 that was ordered last, rev/s, without sign.
    speed: f64,
    /// Chips that are to be thrown off once a move passes their level.
    throw: Option<ChipThrow>,
}

impl Clock {
    /// Planned time of all that was counted.
    pub const fn elapsed(&self) -> Time {
        Time::s(self.elapsed)
    }

    /// Count a step.
    pub fn count(&mut self, step: &Step, limits: &MachineLimits) {
        match &step.kind {
            StepKind::Move(m) => {
                if let Some((throw, at)) = self.throw.and_then(|t| Some((t, t.passed_by(m)?))) {
                    self.ready_at = self.ready_at.max(self.elapsed + at + throw.duration());
                    self.throw = None;
                }
                self.motion(m.profile.duration(), m.per_revolution, m.exact_stop, limits);
            }
            StepKind::Follow(follow) => {
                self.motion(follow.duration(), follow.per_revolution, follow.exact_stop, limits);
            }
            StepKind::Dwell(time) => self.elapsed += time.value(),
            StepKind::Spindle { spindle, order } => match order {
                SpindleStep::Turn { spin, ramp } => {
                    self.ready_at = self.ready_at.max(self.elapsed + ramp.duration());
                    if *spindle == 0 {
                        self.speed = spin.abs().value();
                    }
                }
                SpindleStep::AwaitSpeed => self.elapsed = self.elapsed.max(self.ready_at),
                SpindleStep::Orient(_) => {}
                SpindleStep::Throw(throw) => {
                    self.throw = Some(*throw);
                    self.ready_at = self.ready_at.max(self.elapsed + throw.duration());
                    if *spindle == 0 {
                        self.speed = throw.then.abs().value();
                    }
                }
            },
            StepKind::Tap(tap) => {
                let stroke = tap.inward.duration() + tap.outward.duration() + tap.dwell.value();
                self.elapsed += stroke + limits.settling.value();
            }
            // the spindle comes round to the start angle after half a turn, on average
            StepKind::Thread(stretch) if self.speed > 0.0 => {
                let wait = if stretch.start.is_some() { 0.5 } else { 0.0 };
                let turns = stretch.is_over_at() - stretch.begins() + wait;
                self.elapsed += turns / self.speed;
            }
            StepKind::Revolve { spindle: _, turns } if self.speed > 0.0 => {
                self.elapsed += turns.abs().value() / self.speed;
            }
            StepKind::Superpose(order) if self.speed > 0.0 => {
                self.ready_at =
                    self.ready_at.max(self.elapsed + order.over.abs().value() / self.speed);
            }
            StepKind::AwaitFades => self.elapsed = self.elapsed.max(self.ready_at),
            StepKind::ChangeTool(_) => self.elapsed += limits.tool_change.time.value(),
            StepKind::Engage(_)
            | StepKind::WayOut(_)
            | StepKind::Release { .. }
            | StepKind::Superpose(_)
            | StepKind::Thread(_)
            | StepKind::Revolve { .. }
            | StepKind::Consult(_)
            | StepKind::Coolant { .. }
            | StepKind::FeedOverride(_)
            | StepKind::Output(_)
            | StepKind::Input(_)
            | StepKind::UserCode(_)
            | StepKind::Pause { .. }
            | StepKind::End => {}
        }
    }

    fn motion(&mut self, over: f64, per_revolution: bool, stops: bool, limits: &MachineLimits) {
        self.elapsed += over / if per_revolution { self.speed } else { 1.0 };
        if stops {
            self.elapsed += limits.settling.value();
        }
    }
}
