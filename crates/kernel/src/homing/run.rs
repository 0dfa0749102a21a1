//! One axis that is being homed: its phases, what ends each, and what is wrong when nothing does.
//! The drawing stands in [`super`].
use super::{HomingMethod, HomingOrder};
use crate::axis::AxisLoop;
use crate::fault::FaultKind;
use bus::AxisFeedback;
use motion::{Goal, OnlineState};
use units::Coordinate;

/// A mark so near to the switch's edge, as a share of the distance between marks, may be taken for
/// its neighbour next time.
const MARK_AT_EDGE: f64 = 0.05;
/// A mark is passed within this times the distance between marks.
const BEYOND_MARK: f64 = 1.2;
/// An axis that a hard stop holds is held for so long, s, and moves less than this share of its
/// approach meanwhile.
const HELD_S: f64 = 0.03;
const HELD_SHARE: f64 = 0.1;
/// What is under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Phase {
    Search { from: f64 },
    Return { from: f64, seen: bool },
    BackOff { from: f64 },
    Approach { from: f64 },
    Index { from: f64, edge: Option<f64> },
    Press { from: f64, held_s: f64, at: f64 },
    PullOff { to: f64 },
}

impl Phase {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Search { .. } => "searching the home switch",
            Self::Return { .. } => "returning from the limit switch",
            Self::BackOff { .. } => "backing off the home switch",
            Self::Approach { .. } => "approaching the home switch",
            Self::Index { .. } => "searching the index mark",
            Self::Press { .. } => "moving to the hard stop",
            Self::PullOff { .. } => "pulling off",
        }
    }
}

/// One axis on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct HomingRun {
    pub(super) order: HomingOrder,
    pub(super) phase: Phase,
    pub(super) state: OnlineState,
    /// Limit switches that were actuated when the phase began, and have been since.
    pub(super) limits: [bool; 2],
    /// By how much the reference was off where it was before.
    pub(super) deviation: Option<f64>,
    pub(super) was_homed: bool,
}

/// What a period of a phase leads to.
pub(super) enum Next {
    Stay,
    /// The reference is here.
    Reference(f64),
}

/// An alarm, what was found, and the limit.
pub(super) type Failure = (FaultKind, f64, f64);

impl HomingRun {
    /// Where the phase wants the axis.
    pub(super) fn goal(&self) -> Goal {
        let HomingOrder { fast, slow, .. } = self.order;
        let towards = self.order.sense();
        match self.phase {
            Phase::Search { .. } => Goal::Speed(towards * fast),
            Phase::Return { .. } => Goal::Speed(-towards * fast),
            Phase::BackOff { .. } => Goal::Speed(-towards * slow),
            Phase::Index { edge: Some(_), .. } if self.order.off_switch => {
                Goal::Speed(-towards * slow)
            }
            Phase::Approach { .. } | Phase::Index { .. } | Phase::Press { .. } => {
                Goal::Speed(towards * slow)
            }
            Phase::PullOff { to } => Goal::Position(to),
        }
    }

    /// The largest speed that it may have: one that slows down from a fast phase is still fast.
    pub(super) const fn speed(&self) -> f64 {
        self.order.fast
    }

    const fn turn_to(&mut self, phase: Phase, said: &AxisFeedback) -> Next {
        (self.phase, self.limits) = (phase, said.limit_switches);
        Next::Stay
    }

    /// The switch has changed in the sense in which its edge counts: it is the reference, or the
    /// mark behind it is.
    const fn at_edge(&mut self, setpoint: f64, said: &AxisFeedback) -> Next {
        let reading = said.position.value();
        if matches!(self.order.method, HomingMethod::Switch) {
            return Next::Reference(reading);
        }
        self.turn_to(Phase::Index { from: setpoint, edge: Some(reading) }, said)
    }

    /// One period of the phase.
    pub(super) fn next(
        &mut self,
        axis: &AxisLoop,
        said: &AxisFeedback,
        period_s: f64,
    ) -> Result<Next, Failure> {
        let order = self.order;
        let setpoint = self.state.position;
        self.check_limits(said, setpoint)?;
        let far = |from: f64, most: f64, kind| {
            let way = (setpoint - from).abs();
            if way > most { Err((kind, way, most)) } else { Ok(Next::Stay) }
        };
        match self.phase {
            Phase::Search { .. } if said.home_switch => {
                Ok(self.turn_to(Phase::BackOff { from: setpoint }, said))
            }
            Phase::Search { .. } if said.limit_switches[usize::from(order.positive)] => {
                Ok(self.turn_to(Phase::Return { from: setpoint, seen: false }, said))
            }
            Phase::Return { from, seen } if said.home_switch => {
                self.phase = Phase::Return { from, seen: true };
                far(
                    from,
                    order.search,
                    if seen {
                        FaultKind::HomeSwitchNotReleased
                    } else {
                        FaultKind::HomeSwitchNotFound
                    },
                )
            }
            Phase::BackOff { .. } if !said.home_switch && order.off_switch => {
                Ok(self.at_edge(setpoint, said))
            }
            Phase::Return { seen: true, .. } | Phase::BackOff { .. } if !said.home_switch => {
                Ok(self.turn_to(Phase::Approach { from: setpoint }, said))
            }
            Phase::BackOff { from } => far(from, order.search, FaultKind::HomeSwitchNotReleased),
            Phase::Approach { .. } if said.home_switch && order.off_switch => {
                Ok(self.turn_to(Phase::BackOff { from: setpoint }, said))
            }
            Phase::Approach { .. } if said.home_switch => Ok(self.at_edge(setpoint, said)),
            Phase::Search { from } | Phase::Return { from, .. } | Phase::Approach { from } => {
                far(from, order.search, FaultKind::HomeSwitchNotFound)
            }
            Phase::Index { from, edge } => {
                let Some(at) = said.index.map(Coordinate::value) else {
                    return far(from, BEYOND_MARK * order.index_spacing, FaultKind::IndexNotFound);
                };
                let nearest = MARK_AT_EDGE * order.index_spacing;
                let apart = edge.map_or(nearest, |edge| (at - edge).abs());
                let apart = apart.min(order.index_spacing - apart);
                if edge.is_some() && apart < nearest {
                    return Err((FaultKind::IndexAtSwitch, apart, nearest));
                }
                Ok(Next::Reference(at))
            }
            Phase::Press { from, held_s, at } => {
                let moved = (axis.position() - at).abs();
                let is_held = axis.is_at_force_limit(order.sense())
                    && moved < HELD_SHARE * order.slow * HELD_S;
                if is_held && held_s >= HELD_S {
                    return Ok(Next::Reference(axis.pressed()));
                }
                self.phase = if is_held {
                    Phase::Press { from, held_s: held_s + period_s, at }
                } else {
                    Phase::Press { from, held_s: 0.0, at: axis.position() }
                };
                far(from, order.search, FaultKind::HardStopNotFound)
            }
            Phase::PullOff { .. } => Ok(Next::Stay),
        }
    }

    /// The limit switches ahead and behind, by the sense of homing, have come in this phase.
    const fn on_limits(&self, said: &AxisFeedback) -> (bool, bool) {
        let [low, high] = said.limit_switches;
        let [was_low, was_high] = self.limits;
        let (low, high) = (low && !was_low, high && !was_high);
        if self.order.positive { (high, low) } else { (low, high) }
    }

    /// A limit switch that comes where it cannot.
    fn check_limits(&mut self, said: &AxisFeedback, setpoint: f64) -> Result<(), Failure> {
        for (was, is) in self.limits.iter_mut().zip(said.limit_switches) {
            *was &= is;
        }
        let (ahead, behind) = self.on_limits(said);
        match self.phase {
            // there is no switch on the whole way to the other end
            Phase::Return { from, .. } if behind => {
                Err((FaultKind::HomeSwitchNotFound, (setpoint - from).abs(), self.order.search))
            }
            Phase::BackOff { from } if behind => {
                Err((FaultKind::HomeSwitchNotReleased, (setpoint - from).abs(), self.order.search))
            }
            Phase::Search { .. }
            | Phase::Approach { .. }
            | Phase::Index { .. }
            | Phase::Press { .. }
                if behind && self.state.speed * self.order.sense() > 0.0 =>
            {
                Err((FaultKind::WrongLimitSwitch, setpoint, setpoint))
            }
            Phase::Approach { from } if ahead => {
                Err((FaultKind::HomeSwitchNotFound, (setpoint - from).abs(), self.order.search))
            }
            Phase::Index { from, .. } if ahead => {
                let most = BEYOND_MARK * self.order.index_spacing;
                Err((FaultKind::IndexNotFound, (setpoint - from).abs(), most))
            }
            _ => Ok(()),
        }
    }
}
