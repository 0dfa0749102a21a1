//! From which moment on motion that is under way is planned anew, while the kernel goes on with
//! what it has.
//!
//! ```text
//!   now        now + lead
//!    ▼             ▼
//!   │ step under way │ step │ step │ …      as a rule a step ends a little later: what follows it is planned anew
//!   │ step under way ┆                │ …   one that lasts long is cut there
//! ```
//!
//! Planning takes its time, and an axis that moves must have a step all the while. So the new plan
//! takes over at a moment that is far enough ahead, and the kernel is told of it when the plan is
//! there: if it has come too late for that moment, nothing has changed, and a later one is taken.
use crate::{Step, StepKind};
use motion::{Follow, Move, UnderWay};
use units::Time;

/// A step that lasts beyond so many times the lead is cut, or waited for; one that ends before is
/// left whole.
const LONG: f64 = 3.0;

/// What stays as it was planned, of the steps that a kernel has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TakeOver {
    /// So many of the first ones.
    pub stays: usize,
    /// The first, and then only, one ends at this planned time of it.
    pub at: Option<f64>,
}

/// From which moment on these steps, of which the first is under way, can be planned anew. `None`:
/// not yet, ask again later.
pub fn take_over<'a>(
    steps: impl Iterator<Item = &'a Step>,
    under_way: Option<UnderWay>,
    lead: Time,
) -> Option<TakeOver> {
    let lead_s = lead.value();
    let (mut ends_s, mut stays) = (0.0, 0);
    for step in steps {
        let at_rest = TakeOver { stays: stays.max(1), at: None };
        let Some(motion) = PlannedMotion::of(step) else { return Some(at_rest) };
        stays += 1;
        if stays == 1 {
            let Some(UnderWay { done, pace }) = under_way else {
                return motion.rests.then_some(TakeOver { stays, at: None });
            };
            ends_s = (motion.takes - done) / pace.max(1e-9);
            if ends_s > LONG * lead_s {
                return Some(TakeOver { stays, at: Some(done + lead_s * pace) });
            }
        } else {
            ends_s += motion.takes / motion.turning.max(1e-9);
        }
        if motion.rests {
            return Some(TakeOver { stays, at: None });
        }
        if ends_s >= lead_s {
            return (ends_s < LONG * lead_s).then_some(TakeOver { stays, at: None });
        }
    }
    Some(TakeOver { stays, at: None })
}

/// How long a step moves, s or revolutions, and at how many of them a second.
struct PlannedMotion {
    takes: f64,
    turning: f64,
    rests: bool,
}

impl PlannedMotion {
    fn of(step: &Step) -> Option<Self> {
        let (takes, turning, rests) = match &step.kind {
            StepKind::Follow(follow) => {
                let Follow { per_revolution, pace, exact_stop, .. } = **follow;
                let turning = if per_revolution { pace.turning } else { 1.0 };
                (follow.duration(), turning, exact_stop)
            }
            StepKind::Move(order) => {
                let Move { per_revolution, programmed, profile, .. } = &**order;
                let turning = programmed.map_or(1.0, |feed| feed.turning);
                let turning = if *per_revolution { turning } else { 1.0 };
                (profile.duration(), turning, order.rests())
            }
            _ => return None,
        };
        Some(Self { takes, turning, rests })
    }
}

/// A step that moves ends at this planned time of it, in motion; by how much shorter it is.
pub fn cut(step: &mut Step, at: f64) -> Time {
    let Some(whole) = PlannedMotion::of(step) else { return Time::ZERO };
    let is_cut = match &mut step.kind {
        StepKind::Follow(follow) => follow.cut(at),
        StepKind::Move(order) => order.cut(at),
        _ => false,
    };
    if is_cut { Time::s((whole.takes - at) / whole.turning.max(1e-9)) } else { Time::ZERO }
}
