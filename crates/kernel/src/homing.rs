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
//! Where the reference is approached off the switch, its edge is where the axis that backs off lets
//! go of it, and the mark is the next one from there, back into the travel.
//!
//! Setting the reference moves the encoder's zero, and the setpoint with it by as much: the axis
//! feels nothing. Every search is bounded by a distance, so that a switch, a mark or a stop that is
//! not there is an alarm and not a wait.
//!
//! Before an axis has been homed nothing proves that its encoder counts the way its motor turns. A
//! loop that is closed the wrong way round runs away by a factor e within 1/(2π·bandwidth),
//! milliseconds: what moves against its setpoint by a few in-position windows, before it ever moved
//! with it, is switched off.
//!
//! Sources: IEC 61800-7-201 (`CiA` 402), homing methods 1 to 37; LinuxCNC, "Homing configuration".
//! Two motors that share one axis (a gantry) are not homed here. Units: mm (of A, B and C degrees)
//! and s.
mod run;

use crate::axis::{AxisLoop, Target};
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use bus::{AXES, AxisFeedback, Feedback};
use motion::{Goal, OnlineLimits, OnlineState};
use run::{HomingRun, Next, Phase};
use units::{Axis, Coordinate, Length};

/// Travel of an axis that does not know where it is.
const EVERYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
/// What moves against its setpoint by so many in-position windows, or counts, is connected the
/// wrong way round.
const AGAINST_WINDOWS: f64 = 4.0;
const AGAINST_COUNTS: f64 = 8.0;
/// What has moved with its setpoint by so many times that is connected the right way round.
const PROVEN: f64 = 4.0;

/// What tells where an axis is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct HomingOrder {
    /// What tells.
    pub method: HomingMethod,
    /// The reference is approached towards plus.
    pub positive: bool,
    /// Edge and mark are looked for off the switch, back into the travel.
    pub off_switch: bool,
    /// Largest speed while the switch is searched …
    pub fast: f64,
    /// … and while its edge, a mark or a stop is.
    pub slow: f64,
    /// Largest acceleration.
    pub accel: f64,
    /// Largest jerk; infinite where only the acceleration is limited.
    pub jerk: f64,
    /// The position that the reference has; with [`HomingMethod::Absolute`] what the encoder reads
    /// at zero is short of, with [`HomingMethod::Given`] where the axis is.
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

/// Whether an axis moves the way it is told to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EncoderSense {
    setpoint: f64,
    reading: f64,
}

/// What one period of homing has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HomingOutcome {
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
    /// What [`Self::begin`] finds homed.
    was_homed: [bool; AXES],
    /// What a reading is short of the position.
    zeros: [f64; AXES],
    shifted: bool,
    runs: [Option<HomingRun>; AXES],
    /// Axes that have not yet been seen to move the way they are told to, while they do.
    senses: [Option<EncoderSense>; AXES],
    proven: [bool; AXES],
}

impl Default for Homing {
    fn default() -> Self {
        Self {
            homed: [true; AXES],
            was_homed: [false; AXES],
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

    /// It is about to be homed: until that is done nothing goes by where it is.
    pub(crate) const fn begin_anew(&mut self, index: usize) {
        self.was_homed[index] = self.homed[index];
        self.homed[index] = false;
    }

    /// The next index mark of an axis is looked for.
    pub(crate) const fn looks_for_index(&self, index: usize) -> bool {
        match &self.runs[index] {
            Some(run) => matches!(run.phase, Phase::Index { .. }),
            None => false,
        }
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
            let zero = Coordinate::new(*zero);
            axis.position += zero;
            axis.index = axis.index.map(|at| at + zero);
        }
    }

    /// Positions as encoders would say them.
    pub(crate) fn readings(&self, command: &mut bus::Command) {
        for (axis, zero) in command.axes.iter_mut().zip(&self.zeros) {
            axis.position -= Coordinate::new(*zero);
        }
        if let Some(coupled) = &mut command.coupled {
            coupled.place -= Length::mm(self.zeros[usize::from(coupled.axis)]);
        }
    }

    /// What [`Self::readings`] made readings of, as it was.
    pub(crate) fn command_positions(&self, command: &mut bus::Command) {
        for (axis, zero) in command.axes.iter_mut().zip(&self.zeros) {
            axis.position += Coordinate::new(*zero);
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
    ) -> HomingOutcome {
        let at = axis.target.position;
        match order.method {
            HomingMethod::Absolute => {
                let zero = self.zeros[index];
                self.rename(index, axis, zero, order.reference);
                self.homed[index] = true;
                return HomingOutcome::Homed(None);
            }
            HomingMethod::Given => {
                let from = axis.position();
                self.rename(index, axis, from, order.reference);
                self.homed[index] = true;
                return HomingOutcome::Homed(None);
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
        let was_homed = core::mem::take(&mut self.was_homed[index]);
        self.homed[index] = false;
        self.runs[index] = Some(HomingRun {
            order,
            phase,
            state: OnlineState::at_rest(at),
            limits: [true; 2],
            deviation: None,
            was_homed,
        });
        HomingOutcome::UnderWay
    }

    /// One period of one axis; `rests`: it comes to rest and is not homed.
    pub(crate) fn advance(
        &mut self,
        index: usize,
        axis: &mut AxisLoop,
        said: &AxisFeedback,
        rests: bool,
        period_s: f64,
    ) -> Result<Option<HomingOutcome>, Finding> {
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
        run.state = run.state.next(goal, &limits, EVERYWHERE, period_s);
        let OnlineState { position, speed, accel, jerk } = run.state;
        axis.target = Target { position, speed, accel, jerk };
        let is_over = if rests {
            run.state.is_at_standstill()
        } else {
            matches!(run.phase, Phase::PullOff { .. }) && run.state.has_reached(goal)
        };
        if !is_over {
            self.runs[index] = Some(run);
            return Ok(Some(HomingOutcome::UnderWay));
        }
        axis.force_limit = f64::INFINITY;
        self.runs[index] = None;
        if rests {
            return Ok(Some(HomingOutcome::Stopped));
        }
        self.homed[index] = true;
        Ok(Some(HomingOutcome::Homed(run.deviation)))
    }

    /// Whether an axis that has not been homed moves the way it is told to.
    pub(crate) fn check_sense(&mut self, index: usize, axis: &AxisLoop) -> Result<(), Finding> {
        if self.proven[index] {
            return Ok(());
        }
        let (setpoint, reading) = (axis.target.position, axis.position());
        let Some(start) = self.senses[index].filter(|_| axis.target.speed != 0.0) else {
            self.senses[index] = Some(EncoderSense { setpoint, reading });
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
