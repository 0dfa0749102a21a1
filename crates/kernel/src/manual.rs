//! Axes and spindles that are moved by hand: jog, handwheel, homing.
//!
//! ```text
//!   ManualOrder: goal, limits, ends of travel, lease ─► OnlineState::next, every period ─► the axis' target
//!                                                            ▲
//!                 lease over, hold, alarm ── goal: rest ─────┘
//! ```
//!
//! A continuous jog is a lease: who wants the axis to go on says so again before it ends. A
//! client that is lost, or a control that hangs, leaves no axis moving. A limit switch ends what
//! leads further onto it, whether or not the axis knows where it is.
mod switch_stops;

use crate::axis::Target;
use crate::drives::{Drives, Finding};
use crate::waits::is_not_oriented;
use bus::{AXES, Feedback, SPINDLES};
use motion::{Goal, OnlineLimits, OnlineState};
use switch_stops::SwitchStops;
use units::{Angle, Axis, Orientation, Spin, Time};

/// How one axis is moved by hand, in its own unit and s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ManualOrder {
    /// Where it shall go.
    pub goal: Goal,
    /// What it keeps.
    pub limits: OnlineLimits,
    /// Ends of travel, from and to; infinite while the axis is not homed.
    pub ends: (f64, f64),
    /// The moment from which on it comes to rest by itself; `None`: at its goal.
    pub lease: Option<Time>,
}

/// Why an axis cannot be moved by hand now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ManualRefusal {
    /// The machine has no such axis or spindle.
    NoAxis,
    /// The drives are off, or an alarm has stopped the machine.
    NotReady,
    /// Steps of a program wait or are executed.
    Busy,
    /// A speed, a place or a limit is no number that an axis could obey.
    NotANumber,
    /// A door or another interlock is open.
    Inhibited,
}

/// The axes that are moved by hand at present.
#[derive(Clone, Debug, Default)]
pub(crate) struct Manual {
    moving: [Option<(ManualOrder, OnlineState)>; AXES],
    turning: [Option<SpindleByHand>; SPINDLES],
    stops: SwitchStops,
}

/// How a spindle is turned by hand.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SpindleByHand {
    /// Until its lease is over.
    Until(Time),
    /// To an angle within its turn, once it stands; for so long, s.
    To(Angle, f64),
}

impl Manual {
    /// An axis is moving, or about to.
    pub(crate) fn is_active(&self) -> bool {
        self.moving.iter().any(Option::is_some) || self.turning.iter().any(Option::is_some)
    }

    /// An axis is moving as long as its lease lasts.
    pub(crate) fn is_leased(&self) -> bool {
        self.moving.iter().flatten().any(|(order, _)| order.lease.is_some())
    }

    /// How a spindle is turned; `None`: it is not.
    pub(crate) const fn turn(&mut self, index: usize, turning: Option<SpindleByHand>) {
        self.turning[index] = turning;
    }

    pub(crate) fn take(&mut self, index: usize, order: ManualOrder, position: f64) {
        let state = match self.moving[index] {
            Some((_, state)) => state,
            None => OnlineState::at_rest(position),
        };
        self.moving[index] = Some((order, state));
    }

    /// All shall come to rest.
    pub(crate) fn rest(&mut self) {
        for (order, _) in self.moving.iter_mut().flatten() {
            (order.goal, order.lease) = (Goal::Speed(0.0), None);
        }
        for turning in &mut self.turning {
            *turning = turning.map(|_| SpindleByHand::Until(Time::ZERO));
        }
    }

    pub(crate) fn forget(&mut self) {
        self.moving = [None; AXES];
        self.turning = [None; SPINDLES];
    }

    /// The next axis that a limit switch has stopped, once while it is sent onto it again and
    /// again.
    pub(crate) fn take_stopped(&mut self) -> Option<Axis> {
        self.stops.take()
    }

    /// One period; axes and spindles that shall come to rest do.
    ///
    /// # Errors
    /// A spindle does not come to its angle within `oriented`.
    pub(crate) fn advance(
        &mut self,
        (now, oriented): (Time, Time),
        (rests, spindles_rest): (bool, bool),
        (period_s, feedback): (f64, &Feedback),
        drives: &mut Drives,
    ) -> Result<(), Finding> {
        let mut found = Ok(());
        self.stops.advance(period_s);
        for (index, (turning, spindle)) in
            self.turning.iter_mut().zip(&mut drives.spindles).enumerate()
        {
            let Some(spindle) = spindle.as_mut() else { continue };
            match turning {
                Some(SpindleByHand::To(angle, waited_s)) if !spindles_rest => {
                    *waited_s += period_s;
                    spindle.hold(Some(Orientation::shortest(*angle)));
                    if spindle.held().is_some() {
                        *turning = None;
                    } else {
                        let late = is_not_oriented(index as u8, spindle, *waited_s, oriented);
                        found = found.and(late);
                    }
                }
                Some(SpindleByHand::Until(end)) if !spindles_rest && now < *end => {}
                Some(_) => {
                    spindle.slew_to(Spin::ZERO);
                    *turning = None;
                }
                None => {}
            }
        }
        for (index, (moving, axis)) in self.moving.iter_mut().zip(&mut drives.axes).enumerate() {
            let (Some((order, state)), Some(axis)) = (moving.as_mut(), axis.as_mut()) else {
                continue;
            };
            if let Some(is_upper) =
                leads_onto(order.goal, state.position, feedback.axes[index].limit_switches)
            {
                (order.goal, order.lease) = (Goal::Speed(0.0), None);
                self.stops.ended(index, is_upper);
            }
            let is_over = order.lease.is_some_and(|end| now >= end);
            let goal = if rests || is_over { Goal::Speed(0.0) } else { order.goal };
            *state = state.next(goal, &order.limits, order.ends, period_s);
            axis.target = Target {
                position: state.position,
                speed: state.speed,
                accel: state.accel,
                jerk: state.jerk,
            };
            // at the end of its travel it stands as long as its goal lies beyond
            let waits = order.lease.is_some() && !is_over && !rests;
            if state.is_at_standstill() && (state.has_reached(goal) || !waits) {
                axis.target = Target { position: state.position, ..Target::default() };
                *moving = None;
            }
        }
        found
    }
}

/// Whether the limit switch, actuated, beyond which a goal lies is that of the upper end.
const fn leads_onto(goal: Goal, position: f64, [negative, positive]: [bool; 2]) -> Option<bool> {
    let by = match goal {
        Goal::Speed(speed) => speed,
        Goal::Position(place) => place - position,
    };
    match (negative && by < 0.0, positive && by > 0.0) {
        (_, true) => Some(true),
        (true, false) => Some(false),
        (false, false) => None,
    }
}

impl ManualOrder {
    /// All of it are numbers that an axis can obey.
    pub(crate) fn is_sound(&self) -> bool {
        let OnlineLimits { speed, accel, jerk } = self.limits;
        let goal = match self.goal {
            Goal::Speed(value) | Goal::Position(value) => value,
        };
        let positive = |value: f64| value > 0.0; // not a number is not
        goal.is_finite()
            && positive(speed)
            && speed.is_finite()
            && positive(accel)
            && accel.is_finite()
            && positive(jerk)
            && self.ends.0 <= self.ends.1
    }
}
