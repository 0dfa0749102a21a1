//! Homing: finding out where an axis is, when its encoder does not know.
//!
//! ```text
//!                     actuated                        released                      actuated
//!   on the switch ─────────────────────────┐       ┌───────────► Approach, slow ───────────────┐
//!   at the start                           ▼       │                  ▲                        │
//!   Search, fast ───── actuated ──────► BackOff ───┘                  │               switch-  │  switch
//!      │                                                              │               and-index│  alone
//!      └── limit switch ──► Return, until actuated and released ──────┘                        │
//!                                                                                              │
//!   (index alone) ─────────────────────────────────────────────────► Index, slow ◄─────────────┤
//!                                                                     │ mark                   │
//!   (hard stop) ──► Press, slow, with little force ── held ──► the reference is set ◄──────────┘
//!                                                                     └─► PullOff ──► homed
//! ```
//!
//! Setting the reference moves the encoder's zero, and the setpoint with it by as much: the axis feels nothing. Every
//! search is bounded by a distance, so that a switch, a mark or a stop that is not there is an alarm and not a wait.
//!
//! Before an axis has been homed nothing proves that its encoder counts the way its motor turns. A loop that is closed the
//! wrong way round runs away by a factor e within 1/(2π·bandwidth), milliseconds: what moves against its setpoint by a few
//! in-position windows, before it ever moved with it, is switched off.
//!
//! Sources: IEC 61800-7-201 (CiA 402), homing methods 1 to 37; LinuxCNC, "Homing configuration". Two motors that share one
//! axis (a gantry) are not homed here. Units: mm (of A, B and C degrees) and s.
use crate::axis::{AxisLoop, Target};
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use bus::{AXES, AxisFeedback, Feedback};
use motion::{Goal, OnlineLimits, OnlineState};
use units::{Axis, Length};

/// A mark so near to the switch's edge, as a share of the distance between marks, may be taken for its neighbour next time.
pub(crate) const MARK_AT_EDGE: f64 = 0.05;
/// A mark is passed within this times the distance between marks.
const BEYOND_MARK: f64 = 1.2;
/// An axis that a hard stop holds is held for so long, s, and moves less than this share of its approach meanwhile.
const HELD_S: f64 = 0.03;
const HELD_SHARE: f64 = 0.1;
/// What moves against its setpoint by so many in-position windows, or counts, is connected the wrong way round.
const AGAINST_WINDOWS: f64 = 4.0;
const AGAINST_COUNTS: f64 = 8.0;
/// What has moved with its setpoint by so many times that is connected the right way round.
const PROVEN: f64 = 4.0;

/// What tells where an axis is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingMethod {
    /// The encoder's next index mark behind the edge of the home switch.
    SwitchAndIndex,
    /// The edge of the home switch.
    Switch,
    /// The encoder's next index mark.
    Index,
    /// A mechanical stop, with little force.
    HardStop,
    /// The encoder knows.
    Absolute,
    /// The operator says where it is.
    Given,
}

/// How one axis is homed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomingOrder {
    /// What tells.
    pub method: HomingMethod,
    /// The reference is approached towards plus.
    pub positive: bool,
    /// Largest speed while the switch is searched …
    pub fast: f64,
    /// … and while its edge, a mark or a stop is.
    pub slow: f64,
    /// Largest acceleration.
    pub accel: f64,
    /// Largest jerk; infinite where only the acceleration is limited.
    pub jerk: f64,
    /// The position that the reference has; with [`HomingMethod::Absolute`] what the encoder reads at zero is short of, with
    /// [`HomingMethod::Given`] where the axis is.
    pub reference: f64,
    /// Longest way to the switch, off it, or to the stop.
    pub search: f64,
    /// From one index mark to the next.
    pub index_spacing: f64,
    /// How far the axis goes back from the reference at the end.
    pub pull_off: f64,
    /// Share of the drive's peak force against a hard stop.
    pub force_share: f64,
}

/// What is under way.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    Search { from: f64 },
    Return { from: f64, seen: bool },
    BackOff { from: f64 },
    Approach { from: f64 },
    Index { from: f64, edge: Option<f64> },
    Press { from: f64, held_s: f64, at: f64 },
    PullOff { to: f64 },
}

impl Phase {
    const fn name(self) -> &'static str {
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

/// Whether an axis moves the way it is told to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sense {
    setpoint: f64,
    reading: f64,
}

/// One axis on its way.
#[derive(Clone, Copy, Debug)]
struct Run {
    order: HomingOrder,
    phase: Phase,
    state: OnlineState,
    /// Limit switches that were actuated when the phase began, and have been since.
    limits: [bool; 2],
    /// By how much the reference was off where it was before.
    deviation: Option<f64>,
    was_homed: bool,
}

/// What one period of homing has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Outcome {
    UnderWay,
    /// It is homed; the reference was off by so much where it was known before.
    Homed(Option<f64>),
    /// It stands, and is not homed.
    Stopped,
}

/// Where the axes' encoders count from, and which axes are being homed.
#[derive(Clone, Debug)]
pub(crate) struct Homing {
    homed: [bool; AXES],
    /// What a reading is short of the position.
    zeros: [f64; AXES],
    shifted: bool,
    runs: [Option<Run>; AXES],
    /// Axes that have not yet been seen to move the way they are told to, while they do.
    senses: [Option<Sense>; AXES],
    proven: [bool; AXES],
}

impl Default for Homing {
    fn default() -> Self {
        Self {
            homed: [true; AXES],
            zeros: [0.0; AXES],
            shifted: false,
            runs: [None; AXES],
            senses: [None; AXES],
            proven: [true; AXES],
        }
    }
}

impl Homing {
    pub(crate) const fn is_homed(&self, index: usize) -> bool {
        self.homed[index]
    }

    pub(crate) const fn zero(&self, index: usize) -> f64 {
        self.zeros[index]
    }

    /// Some reading is not a position.
    pub(crate) const fn is_shifted(&self) -> bool {
        self.shifted
    }

    pub(crate) fn is_active(&self) -> bool {
        self.runs.iter().any(Option::is_some)
    }

    pub(crate) const fn is_homing(&self, index: usize) -> bool {
        self.runs[index].is_some()
    }

    pub(crate) fn under_way(&self) -> impl Iterator<Item = (Axis, &'static str)> + '_ {
        let runs = self.runs.iter().zip(Axis::ALL);
        runs.filter_map(|(run, axis)| Some((axis, run.as_ref()?.phase.name())))
    }

    /// Nothing is known of where it is, nor of how its encoder is connected.
    pub(crate) const fn forget_home(&mut self, index: usize) {
        (self.homed[index], self.proven[index]) = (false, false);
    }

    /// All homing ends where it is.
    pub(crate) fn abandon(&mut self, axes: &mut [Option<AxisLoop>; AXES]) {
        for (run, axis) in self.runs.iter_mut().zip(axes) {
            if let (Some(_), Some(axis)) = (run.take(), axis) {
                axis.force_limit = f64::INFINITY;
            }
        }
        self.senses = [None; AXES];
    }

    /// What the encoders say, as positions.
    pub(crate) fn positions(&self, feedback: &mut Feedback) {
        for (axis, zero) in feedback.axes.iter_mut().zip(&self.zeros) {
            let zero = Length::mm(*zero);
            axis.position += zero;
            axis.index = axis.index.map(|at| at + zero);
        }
    }

    /// Positions as encoders would say them.
    pub(crate) fn readings(&self, command: &mut bus::Command) {
        for (axis, zero) in command.axes.iter_mut().zip(&self.zeros) {
            axis.position -= Length::mm(*zero);
        }
        if let Some(coupled) = &mut command.coupled {
            coupled.place -= Length::mm(self.zeros[usize::from(coupled.axis)]);
        }
    }

    /// What [`Self::readings`] made readings of, as it was.
    pub(crate) fn command_positions(&self, command: &mut bus::Command) {
        for (axis, zero) in command.axes.iter_mut().zip(&self.zeros) {
            axis.position += Length::mm(*zero);
        }
        if let Some(coupled) = &mut command.coupled {
            coupled.place += Length::mm(self.zeros[usize::from(coupled.axis)]);
        }
    }

    /// The place that is called `from` is called `to` from now on.
    fn rename(&mut self, index: usize, axis: &mut AxisLoop, from: f64, to: f64) {
        self.zeros[index] += to - from;
        self.shifted = self.zeros.iter().any(|zero| *zero != 0.0);
        axis.shift(to - from);
    }

    /// Begin; an axis whose place is told is homed at once.
    pub(crate) fn begin(
        &mut self,
        index: usize,
        axis: &mut AxisLoop,
        order: &HomingOrder,
    ) -> Outcome {
        let at = axis.target.position;
        match order.method {
            HomingMethod::Absolute => {
                let zero = self.zeros[index];
                self.rename(index, axis, zero, order.reference);
                self.homed[index] = true;
                return Outcome::Homed(None);
            }
            HomingMethod::Given => {
                let from = axis.position();
                self.rename(index, axis, from, order.reference);
                self.homed[index] = true;
                return Outcome::Homed(None);
            }
            HomingMethod::SwitchAndIndex
            | HomingMethod::Switch
            | HomingMethod::Index
            | HomingMethod::HardStop => {}
        }
        let mut order = *order;
        let phase = match order.method {
            HomingMethod::HardStop => {
                order.accel *= order.force_share;
                axis.force_limit = order.force_share * axis.control.peak_force.value();
                Phase::Press { from: at, held_s: 0.0, at: axis.position() }
            }
            HomingMethod::Index => Phase::Index { from: at, edge: None },
            _ => Phase::Search { from: at },
        };
        let was_homed = core::mem::replace(&mut self.homed[index], false);
        self.runs[index] = Some(Run {
            order,
            phase,
            state: OnlineState::at_rest(at),
            limits: [true; 2],
            deviation: None,
            was_homed,
        });
        Outcome::UnderWay
    }

    /// One period of one axis; `rests`: it comes to rest and is not homed.
    pub(crate) fn advance(
        &mut self,
        index: usize,
        axis: &mut AxisLoop,
        said: &AxisFeedback,
        rests: bool,
        period_s: f64,
    ) -> Result<Option<Outcome>, Finding> {
        let Some(mut run) = self.runs[index] else { return Ok(None) };
        let of = Subject::Axis(Axis::ALL[index]);
        if !rests {
            let next = run.next(axis, said, period_s);
            let next = next.map_err(|(kind, value, limit)| (kind, of, value, limit))?;
            if let Next::Reference(at) = next {
                let (from, to) = (at, run.order.reference);
                run.deviation = run.was_homed.then_some(from - to);
                self.rename(index, axis, from, to);
                run.state.position += to - from;
                let back = to - run.order.sense() * run.order.pull_off;
                run.phase = Phase::PullOff { to: back };
                if run.order.method == HomingMethod::HardStop {
                    run.order.fast = run.order.slow; // the force is still limited
                }
            }
        }
        let goal = if rests { Goal::Speed(0.0) } else { run.goal() };
        let speed = run.speed();
        let limits = OnlineLimits { speed, accel: run.order.accel, jerk: run.order.jerk };
        const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
        run.state = run.state.next(goal, &limits, FREE, period_s);
        let OnlineState { position, speed, accel, jerk } = run.state;
        axis.target = Target { position, speed, accel, jerk };
        let is_over = if rests {
            run.state.is_at_standstill()
        } else {
            matches!(run.phase, Phase::PullOff { .. }) && run.state.has_reached(goal)
        };
        if !is_over {
            self.runs[index] = Some(run);
            return Ok(Some(Outcome::UnderWay));
        }
        axis.force_limit = f64::INFINITY;
        self.runs[index] = None;
        if rests {
            return Ok(Some(Outcome::Stopped));
        }
        self.homed[index] = true;
        Ok(Some(Outcome::Homed(run.deviation)))
    }

    /// Whether an axis that has not been homed moves the way it is told to.
    pub(crate) fn check_sense(&mut self, index: usize, axis: &AxisLoop) -> Result<(), Finding> {
        if self.proven[index] {
            return Ok(());
        }
        let (setpoint, reading) = (axis.target.position, axis.position());
        let Some(start) = self.senses[index].filter(|_| axis.target.speed != 0.0) else {
            self.senses[index] = Some(Sense { setpoint, reading });
            return Ok(());
        };
        let told = setpoint - start.setpoint;
        let moved = (reading - start.reading) * told.signum();
        let control = &axis.control;
        let window = AGAINST_WINDOWS * control.windows.in_position.value();
        let limit = window.max(AGAINST_COUNTS * control.encoder.count.value());
        if moved < -limit {
            let of = Subject::Axis(Axis::ALL[index]);
            return Err((FaultKind::MovesAgainstOrder, of, -moved, limit));
        }
        self.proven[index] = moved > PROVEN * limit;
        Ok(())
    }
}

/// What a period of a phase leads to.
enum Next {
    Stay,
    /// The reference is here.
    Reference(f64),
}

/// An alarm, what was found, and the limit.
type Failure = (FaultKind, f64, f64);

impl HomingOrder {
    const fn sense(&self) -> f64 {
        if self.positive { 1.0 } else { -1.0 }
    }

    /// All of it are numbers that an axis can obey.
    pub(crate) fn is_sound(&self) -> bool {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        let moves = !matches!(self.method, HomingMethod::Absolute | HomingMethod::Given);
        let rates = positive(self.fast) && positive(self.slow) && self.slow <= self.fast;
        let ways = positive(self.search) && self.pull_off >= 0.0 && self.pull_off.is_finite();
        let marks = match self.method {
            HomingMethod::SwitchAndIndex | HomingMethod::Index => positive(self.index_spacing),
            HomingMethod::HardStop => self.force_share > 0.0 && self.force_share <= 1.0,
            HomingMethod::Switch | HomingMethod::Absolute | HomingMethod::Given => true,
        };
        let changes = positive(self.accel) && self.jerk > 0.0;
        self.reference.is_finite() && (!moves || rates && ways && marks && changes)
    }
}

impl Run {
    /// Where the phase wants the axis.
    fn goal(&self) -> Goal {
        let HomingOrder { fast, slow, .. } = self.order;
        let towards = self.order.sense();
        match self.phase {
            Phase::Search { .. } => Goal::Speed(towards * fast),
            Phase::Return { .. } => Goal::Speed(-towards * fast),
            Phase::BackOff { .. } => Goal::Speed(-towards * slow),
            Phase::Approach { .. } | Phase::Index { .. } | Phase::Press { .. } => {
                Goal::Speed(towards * slow)
            }
            Phase::PullOff { to } => Goal::Position(to),
        }
    }

    /// The largest speed that it may have: one that slows down from a fast phase is still fast.
    const fn speed(&self) -> f64 {
        self.order.fast
    }

    const fn turn_to(&mut self, phase: Phase, said: &AxisFeedback) -> Next {
        (self.phase, self.limits) = (phase, said.limit_switches);
        Next::Stay
    }

    /// One period of the phase.
    fn next(
        &mut self,
        axis: &AxisLoop,
        said: &AxisFeedback,
        period_s: f64,
    ) -> Result<Next, Failure> {
        let order = self.order;
        let setpoint = self.state.position;
        self.check_limits(said, setpoint)?;
        let reading = said.position.value();
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
            Phase::Search { from } => far(from, order.search, FaultKind::HomeSwitchNotFound),
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
            Phase::Return { seen: true, .. } | Phase::BackOff { .. } if !said.home_switch => {
                Ok(self.turn_to(Phase::Approach { from: setpoint }, said))
            }
            Phase::Return { from, .. } => far(from, order.search, FaultKind::HomeSwitchNotFound),
            Phase::BackOff { from } => far(from, order.search, FaultKind::HomeSwitchNotReleased),
            Phase::Approach { .. } if said.home_switch => {
                if order.method == HomingMethod::Switch {
                    return Ok(Next::Reference(reading));
                }
                Ok(self.turn_to(Phase::Index { from: setpoint, edge: Some(reading) }, said))
            }
            Phase::Approach { from } => far(from, order.search, FaultKind::HomeSwitchNotFound),
            Phase::Index { from, edge } => {
                let Some(at) = said.index.map(Length::value) else {
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
