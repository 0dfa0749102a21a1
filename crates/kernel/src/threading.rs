//! Turning a thread: the axes are a function of the spindle's turns, from the start angle on.
//!
//! ```text
//!   spindle θ (its setpoint where it is led by angle, else the observer's) ─► φ = ±θ − origin ─► stretch ─► X, Y, Z
//! ```
//!
//! The origin is the next place at which the spindle stands at the start angle and the run-in still
//! fits before it. Nothing but the spindle moves the axes: overrides do not act. A hold takes the
//! tool off the thread at once, as lathes do, and the pass is turned again after it:
//!
//! ```text
//!   Cutting ── hold ──► Leaving ─────────► Braking ──► Standing ── resume ──► Back ──► the chain begins anew
//!                       infeed axis away,  Z brakes    the spindle turns on   along the thread, then in
//!                       Z on the thread
//! ```
//!
//! Where nothing says from where the tool was fed in, or the chain is too long to be kept, a hold
//! waits for its end.
use crate::config::{Config, Subject};
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::moving::stand_at;
use crate::retreating::Retreating;
use motion::AXES;
use motion::{OnThread, THREADING_AXES, ThreadStretch, WayOut};
use units::{Angle, Lead, Length, Time};
use units::{Axis, Coordinate};

/// The chain under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chain {
    /// −1 where the spindle turns counter-clockwise.
    sense: f64,
    /// `sense`·angle of the spindle where the chain's turns count from zero.
    origin: f64,
    /// Where it began.
    from: [f64; THREADING_AXES],
    course: Course,
}

/// See the module's header.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Course {
    Cutting,
    Leaving(Retreating),
    /// From these speeds: what is not led in a period rests.
    Braking([f64; THREADING_AXES]),
    Standing,
    /// This axis goes back now, then those after it, and the infeed axis last.
    Back(usize, Option<Retreating>),
}

/// Whether the thread is to be left, and how.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leave<'a> {
    /// The operator wants everything to rest.
    pub(crate) rests: bool,
    /// The way off the work, if it is known and the chain can be turned again.
    pub(crate) way: Option<&'a WayOut>,
    pub(crate) config: &'a Config,
}

/// What comes of a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// It goes on.
    Busy,
    /// The stretch is over.
    Over,
    /// The chain is to be turned again, from its first stretch.
    Again,
}

/// Begin a stretch: wait for the start angle, or go on in the chain.
pub(crate) fn begin(stretch: &ThreadStretch, drives: &mut Drives) -> Result<(), Finding> {
    let of = Subject::Spindle(stretch.spindle);
    let spindle = usize::from(stretch.spindle);
    if !drives.spindles.get(spindle).is_some_and(Option::is_some) {
        return Err((FaultKind::NotConfigured, of, 0.0, 0.0));
    }
    let Some(start) = stretch.start else {
        return match drives.chain {
            Some(_) => Ok(()),
            None => Err((FaultKind::SetpointJump, of, 0.0, 0.0)),
        };
    };
    let mut place = [0.0; AXES];
    for (index, axis) in drives.axes.iter().enumerate() {
        place[index] = match axis {
            _ if index < THREADING_AXES => stretch.from[index],
            Some(axis) => axis.target.position,
            None => 0.0,
        };
    }
    stand_at(&place, drives)?;
    drives.pace(spindle, f64::INFINITY);
    let master = drives.master(spindle);
    let sense = if master.spin.value() < 0.0 { -1.0 } else { 1.0 };
    let now = sense * master.angle.value() - stretch.begins();
    let first = sense * start.value();
    let origin = first + libm::ceil(now - first);
    let (from, course) = (stretch.from, Course::Cutting);
    drives.chain = Some(Chain { sense, origin, from, course });
    Ok(())
}

/// Go on.
pub(crate) fn advance(
    stretch: &ThreadStretch,
    period: Time,
    leave: &Leave,
    drives: &mut Drives,
) -> Pass {
    let Some(mut chain) = drives.chain else { return Pass::Over };
    let pass = match chain.course {
        Course::Cutting => {
            let (begun, over) = couple(stretch, &chain, period, drives);
            if let Some(way) = leave.way.filter(|_| leave.rests) {
                chain.course = match Retreating::to_clear(way, drives, leave.config) {
                    Some(retreat) if begun => Course::Leaving(retreat),
                    Some(_) | None => Course::Braking(speeds(drives)),
                };
                Pass::Busy
            } else if over && stretch.ends {
                end(stretch, drives);
                return Pass::Over;
            } else if over {
                Pass::Over
            } else {
                Pass::Busy
            }
        }
        Course::Leaving(mut retreat) => {
            let (_, over) = couple(stretch, &chain, period, drives);
            if over && !stretch.ends {
                return Pass::Over; // the next stretch goes on in this period, and so does the way out
            }
            retreat.advance(period.value(), true, drives);
            chain.course = if retreat.is_out() {
                Course::Braking(speeds(drives))
            } else {
                Course::Leaving(retreat)
            };
            Pass::Busy
        }
        Course::Braking(mut speeds) => {
            for (axis, speed) in drives.axes[..THREADING_AXES].iter_mut().zip(&mut speeds) {
                let Some(axis) = axis else { continue };
                axis.target.speed = *speed;
                axis.brake();
                *speed = axis.target.speed;
            }
            let stand = speeds == [0.0; THREADING_AXES];
            chain.course = if stand { Course::Standing } else { Course::Braking(speeds) };
            drives.flowing = false;
            Pass::Busy
        }
        Course::Standing => {
            if !leave.rests {
                chain.course = Course::Back(0, None);
            }
            Pass::Busy
        }
        Course::Back(at, leg) => {
            let infeed = leave.way.map_or(0, |way| way.infeed.index());
            chain.course = back(&chain, at, leg, infeed, period, drives);
            if let Course::Back(THREADING_AXES, _) = chain.course {
                Pass::Again
            } else {
                Pass::Busy
            }
        }
    };
    drives.chain = Some(chain);
    if pass == Pass::Again {
        drives.rest_axes();
        drives.chain = None;
    }
    pass
}

/// Stay on the thread while the spindle brakes for an alarm; whether the stretch is over. `None`:
/// the tool is off it.
pub(crate) fn stay(stretch: &ThreadStretch, period: Time, drives: &mut Drives) -> Option<bool> {
    let chain = drives.chain?;
    let over = match chain.course {
        Course::Cutting | Course::Leaving(_) => couple(stretch, &chain, period, drives).1,
        Course::Braking(_) | Course::Standing | Course::Back(..) => return None,
    };
    if over && stretch.ends {
        end(stretch, drives);
    }
    Some(over)
}

/// How fast the axes are told to move.
fn speeds(drives: &Drives) -> [f64; THREADING_AXES] {
    core::array::from_fn(|i| drives.axes[i].as_ref().map_or(0.0, |axis| axis.target.speed))
}

fn end(stretch: &ThreadStretch, drives: &mut Drives) {
    drives.rest_axes();
    drives.flowing = false;
    drives.chain = None;
    drives.leave(usize::from(stretch.spindle));
}

/// The axes where the spindle has them; whether the chain has begun, and the stretch is over.
fn couple(
    stretch: &ThreadStretch,
    chain: &Chain,
    period: Time,
    drives: &mut Drives,
) -> (bool, bool) {
    let spindle = usize::from(stretch.spindle);
    let master = drives.master_after_steps(spindle, period);
    let turn = chain.sense * master.angle.value() - chain.origin;
    let (n, growth) = (chain.sense * master.spin.value(), chain.sense * master.accel.value());
    let over = turn >= stretch.is_over_at();
    let begun = turn >= stretch.begins();
    let on = stretch.at(turn);
    for i in 0..THREADING_AXES {
        let Some(axis) = &mut drives.axes[i] else { continue };
        axis.target.position = on.q[i];
        axis.target.speed = on.rate[i] * n;
        axis.target.accel = on.bend[i] * n * n + on.rate[i] * growth;
        axis.target.jerk = on.third[i] * n * n * n + 3.0 * on.bend[i] * n * growth;
    }
    drives.flowing = begun && !(over && stretch.ends);
    (begun, over)
}

/// One axis after the other to where the chain began, the infeed axis last.
fn back(
    chain: &Chain,
    at: usize,
    leg: Option<Retreating>,
    infeed: usize,
    period: Time,
    drives: &mut Drives,
) -> Course {
    // 0, 1, 2 without the infeed axis, and then that
    let axis = match at {
        2 => infeed,
        at if at < infeed => at,
        at => at + 1,
    };
    let to = Coordinate::new(chain.from[axis]);
    let begun = leg.or_else(|| Retreating::gently(Axis::ALL[axis], to, drives));
    let Some(mut leg) = begun else { return Course::Back(at + 1, None) };
    leg.advance(period.value(), false, drives);
    if leg.is_out() { Course::Back(at + 1, None) } else { Course::Back(at, Some(leg)) }
}

impl Chain {
    /// A hold has brought the tool off the thread and everything to rest.
    pub(crate) fn is_standing(&self) -> bool {
        self.course == Course::Standing
    }

    /// The tool is off the thread.
    pub(crate) const fn is_off(&self) -> bool {
        match self.course {
            Course::Braking(_) | Course::Standing | Course::Back(..) => true,
            Course::Cutting | Course::Leaving(_) => false,
        }
    }

    /// The way on which a hold is taking the tool off the thread.
    pub(crate) const fn leaving(&self) -> Option<Retreating> {
        match self.course {
            Course::Leaving(retreat) => Some(retreat),
            Course::Cutting | Course::Braking(_) | Course::Standing | Course::Back(..) => None,
        }
    }

    /// What the drives shall keep together, should they be left alone: the axis that goes farthest,
    /// along the thread's tangent at this angle of the spindle.
    pub(crate) fn tangent(&self, stretch: &ThreadStretch, angle: Angle) -> Option<bus::Coupled> {
        let turn = self.sense * angle.value() - self.origin;
        let coupled = matches!(self.course, Course::Cutting | Course::Leaving(_));
        if !coupled || turn < stretch.begins() {
            return None;
        }
        let OnThread { q, rate, .. } = stretch.at(turn);
        let axis = (0..THREADING_AXES).max_by(|&i, &j| rate[i].abs().total_cmp(&rate[j].abs()))?;
        Some(bus::Coupled {
            axis: axis as u8,
            spindle: stretch.spindle,
            angle,
            place: Length::mm(q[axis]),
            lead: Lead::mm_per_rev(rate[axis] * self.sense),
        })
    }
}
