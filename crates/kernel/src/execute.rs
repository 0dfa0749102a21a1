//! Executing steps, one after the other.
//!
//! ```text
//!            ┌──────────────── next step ◄───────────────────────────────┐
//!            ▼                                                            │
//!   Idle ─► begin ─┬─► Moving ──► Settling (exact stop) ──────────────────┤
//!                  ├─► Dwelling, AwaitingSpeed, AwaitingAngle, Changing ──┤
//!                  ├─► AwaitingInput, Probing ──► Settling ───────────────┤
//!                  ├─► AwaitingInputs, Counting ──────────────────────────┤
//!                  ├─► ChangingByHand ─ confirm ─► Changing ──────────────┤
//!                  ├─► Tapping, Threading ────────────────────────────────┤
//!                  ├─► Recording, Engaging, Fading, Revolving, Consulting ┤
//!                  ├─► Pausing ─ resume ──────────────────────────────────┤
//!                  ├─► (coolant, spindle order: at once) ─────────────────┘
//!                  └─► Ended
//! ```
//!
//! What a step leaves over of a period goes to the next one, so that motion has no gaps.
use crate::chips::Removal;
use crate::config::{Config, Subject};
use crate::drives::{Drives, Finding};
use crate::event::{Event, EventKind, Ring};
use crate::fault::FaultKind;
use crate::moving::Moving;
use crate::operator::Operator;
use crate::queue::{Queue, SpindleStep, StepKind};
use crate::sequence_steps::{Awaited, Counted, Guard};
use crate::signals::{self, Answered, Probing, await_inputs};
use crate::spindle::SpindleLoop;
use crate::tapping::{Outcome, TapRun};
use crate::threading::{self, Chain, Leave, Pass};
use crate::track::Track;
use crate::waits::{
    await_angle, await_speed, await_tool, begin_change, begin_pause, consult, engage, fade, record,
    revolve, settle,
};
use bus::{Feedback, State};
use motion::WayOut;
use sync::Phase;
use units::{Orientation, Spin, Time};

/// What an activity may look at and write to.
pub(crate) struct Context<'a> {
    pub(crate) config: &'a Config,
    pub(crate) feedback: &'a Feedback,
    /// What waits, and the place in it of what is executed.
    pub(crate) steps: (&'a Queue, usize),
    pub(crate) events: &'a mut Ring,
    /// Where a step that asks the machine something leaves the answer.
    pub(crate) answer: &'a mut Option<Answered>,
    /// What the operator has ordered.
    pub(crate) operator: &'a Operator,
    /// An alarm has stopped the machine: what is coupled stops together, and stays.
    pub(crate) halted: bool,
    /// How a hold takes the tool off a thread.
    pub(crate) off_thread: Option<WayOut>,
    pub(crate) op: u32,
    pub(crate) line: u32,
}

impl Context<'_> {
    #[allow(clippy::large_types_passed_by_value)] // it moves into the ring
    pub(crate) fn note(&mut self, kind: EventKind) {
        self.events.push(Event { time: self.feedback.time, op: self.op, line: self.line, kind });
    }
}

/// What the kernel is doing.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant)] // one exists, and a box would be freed in the servo thread
pub(crate) enum Activity {
    /// Nothing.
    Idle,
    /// Along a path.
    Moving(Moving, State),
    /// Waiting until all axes are in position; for so long, and within the windows for so long.
    Settling { waited_s: f64, inside_s: f64 },
    /// A programmed wait; so much is left.
    Dwelling { left_s: f64 },
    /// Waiting for a spindle's speed.
    AwaitingSpeed { spindle: u8, waited_s: f64 },
    /// Waiting for a spindle's angle.
    AwaitingAngle { spindle: u8, to: Orientation, longest: Option<Time>, waited_s: f64 },
    /// Waiting until a tool is put in by hand and confirmed.
    ChangingByHand { tool: u32 },
    /// Waiting for an input; whether it has been the other way, for how long.
    AwaitingInput { armed: bool, waited_s: f64 },
    /// Waiting for several inputs.
    AwaitingInputs(Awaited),
    /// Counting edges of an input while an output is on.
    Counting(Counted),
    /// Along a path until the probe changes.
    Probing(Probing),
    /// Waiting for the tool.
    Changing { tool: u32, waited_s: f64 },
    /// Tapping.
    Tapping(TapRun),
    /// Turning a thread.
    Threading,
    /// Waiting until the way out is written down; for so long.
    Recording { waited_s: f64 },
    /// Waiting until a spindle is on its gear.
    Engaging(u8),
    /// Waiting until one superposition can begin, or all have faded; for so long no spindle has
    /// turned.
    Fading { still_s: f64 },
    /// Waiting for a spindle's turns: where it began, and for how long it has not turned.
    Revolving { from: units::Angle, still_s: f64 },
    /// Waiting for what runs the kernel; for so long.
    Consulting { waited_s: f64 },
    /// Waiting for the operator.
    Pausing,
    /// Done within the period in which it began.
    AtOnce,
    /// The program is over.
    Ended,
}

/// Whether a step is done.
pub(crate) enum StepProgress {
    /// Not yet.
    Busy,
    /// Done, with so many seconds of the period left.
    Done(f64),
    /// The thread that it belongs to is to be turned again.
    Again,
}

impl Activity {
    /// Begin a step.
    pub(crate) fn begin(
        step: &StepKind,
        drives: &mut Drives,
        context: &mut Context,
    ) -> Result<Self, Finding> {
        Ok(match step {
            StepKind::Move(order) => {
                let state = if order.rapid { State::Rapid } else { State::Feed };
                Self::Moving(Moving::begin(Track::Move(order), drives)?, state)
            }
            StepKind::Follow(order) => {
                let state = if order.piece.rapid { State::Rapid } else { State::Feed };
                Self::Moving(Moving::begin(Track::Follow(order), drives)?, state)
            }
            StepKind::Dwell(time) => Self::Dwelling { left_s: time.value() },
            StepKind::Spindle { spindle, order } => begin_spindle(*spindle, order, drives)?,
            StepKind::Tap(plan) => Self::Tapping(TapRun::begin(plan, drives, context.config)?),
            StepKind::Thread(stretch) => {
                threading::begin(stretch, drives)?;
                Self::Threading
            }
            StepKind::WayOut(Some(_)) => Self::Recording { waited_s: 0.0 },
            StepKind::WayOut(None) => Self::AtOnce,
            StepKind::Engage(gear) => {
                drives.engage(gear)?;
                Self::Engaging(gear.follower)
            }
            StepKind::Release { follower } => {
                drives.release(*follower);
                Self::AtOnce
            }
            StepKind::Superpose(_) | StepKind::AwaitFades => Self::Fading { still_s: 0.0 },
            StepKind::Revolve { spindle, .. } => match drives.spindles.get(usize::from(*spindle)) {
                Some(Some(control)) => Self::Revolving { from: control.now().angle, still_s: 0.0 },
                _ => {
                    return Err((FaultKind::NotConfigured, Subject::Spindle(*spindle), 0.0, 0.0));
                }
            },
            StepKind::Consult(_) => Self::Consulting { waited_s: 0.0 },
            StepKind::ChangeTool { tool, by_hand } => {
                begin_change(*tool, *by_hand, drives, context)
            }
            StepKind::Coolant { mist, flood } => {
                (drives.mist, drives.flood) = (*mist, *flood);
                Self::AtOnce
            }
            StepKind::FeedOverride(acts) => {
                drives.overridden = *acts;
                Self::AtOnce
            }
            StepKind::SpindleOverride(acts) => {
                let locks = drives.spindle_overridden && !acts;
                drives.spindle_overridden = *acts;
                drives.override_spindles(context.operator.spindle_share());
                let changing = |spindle: &Option<SpindleLoop>| {
                    spindle.as_ref().is_some_and(SpindleLoop::is_changing)
                };
                // what needs the programmed speed waits for it
                match drives.spindles.iter().position(changing).filter(|_| locks) {
                    Some(index) => Self::AwaitingSpeed { spindle: index as u8, waited_s: 0.0 },
                    None => Self::AtOnce,
                }
            }
            StepKind::Output(output) => {
                drives.switch(output);
                context.note(EventKind::OutputSet(*output));
                Self::AtOnce
            }
            StepKind::Input(_) => Self::AwaitingInput { armed: false, waited_s: 0.0 },
            StepKind::Inputs(_) => Self::AwaitingInputs(Awaited::default()),
            StepKind::Count(_) => Self::Counting(Counted::default()),
            StepKind::Guard { on, off } => {
                drives.guard = Guard::new(*on, *off);
                Self::AtOnce
            }
            StepKind::Probe { order, until } => {
                Self::Probing(Probing::begin(order, *until, drives, context.feedback)?)
            }
            StepKind::UserCode(number) => {
                context.note(EventKind::UserCode { number: *number });
                Self::AtOnce
            }
            StepKind::Pause { optional } => begin_pause(*optional, context),
            StepKind::End => {
                context.note(EventKind::ProgramEnded);
                Self::Ended
            }
        })
    }

    /// Go on for `dt` seconds.
    pub(crate) fn advance(
        &mut self,
        step: &StepKind,
        dt: f64,
        drives: &mut Drives,
        context: &mut Context,
    ) -> Result<StepProgress, Finding> {
        let waits = context.config.waits;
        match self {
            Self::Idle | Self::Pausing | Self::ChangingByHand { .. } | Self::Ended => {
                Ok(StepProgress::Busy)
            }
            Self::Consulting { waited_s } => {
                *waited_s += dt;
                consult(*waited_s)
            }
            Self::Engaging(follower) => Ok(engage(*follower, drives, context)),
            Self::Fading { still_s } => fade(step, dt, drives, (still_s, waits.at_speed)),
            Self::Revolving { from, still_s } => {
                revolve(step, *from, dt, drives, (still_s, waits.at_speed))
            }
            Self::AtOnce => Ok(StepProgress::Done(dt)),
            Self::Moving(moving, _) => {
                let (track, exact_stop) = match step {
                    StepKind::Move(order) => (Track::Move(order), order.exact_stop),
                    StepKind::Follow(order) => (Track::Follow(order), order.exact_stop),
                    _ => return Ok(StepProgress::Done(dt)),
                };
                if Moving::checks_cut(track) {
                    drives.check_cut()?;
                }
                let orders = (context.operator, context.config);
                match moving.advance(context.steps, dt, drives, orders) {
                    None => Ok(StepProgress::Busy),
                    Some(over) if !exact_stop => Ok(StepProgress::Done(over)),
                    Some(_) => {
                        *self = Self::Settling { waited_s: 0.0, inside_s: 0.0 };
                        Ok(StepProgress::Busy)
                    }
                }
            }
            Self::Threading => {
                let StepKind::Thread(stretch) = step else { return Ok(StepProgress::Done(dt)) };
                drives.check_cut()?;
                let (period, rests) = (context.config.period, context.operator.wants_rest());
                let leave =
                    Leave { rests, way: context.off_thread.as_ref(), config: context.config };
                Ok(match threading::advance(stretch, period, &leave, drives) {
                    Pass::Busy => StepProgress::Busy,
                    Pass::Again => StepProgress::Again,
                    Pass::Over if stretch.ends => {
                        *self = Self::Settling { waited_s: 0.0, inside_s: 0.0 };
                        StepProgress::Busy
                    }
                    Pass::Over => StepProgress::Done(0.0),
                })
            }
            Self::Recording { waited_s } => {
                *waited_s += dt;
                record(step, dt, *waited_s, drives, context)
            }
            Self::Settling { waited_s, inside_s } => {
                settle(dt, waited_s, inside_s, drives, waits.in_position)
            }
            Self::AwaitingInput { .. } | Self::AwaitingInputs(_) | Self::Dwelling { .. }
                if context.operator.wants_rest() =>
            {
                Ok(StepProgress::Busy)
            }
            Self::AwaitingInputs(awaited) => await_inputs(step, dt, awaited, context.feedback),
            Self::Counting(counted) => signals::count_edges(step, dt, counted, drives, context),
            Self::AwaitingInput { armed, waited_s } => {
                Ok(signals::wait_on(step, dt, (armed, waited_s), context))
            }
            Self::Probing(probing) => {
                let progress = signals::probe_on(probing, step, dt, drives, context)?;
                if let StepProgress::Done(_) = progress {
                    *self = Self::Settling { waited_s: 0.0, inside_s: 0.0 };
                }
                Ok(StepProgress::Busy)
            }
            Self::Dwelling { left_s } => {
                *left_s -= dt;
                Ok(if *left_s > 0.0 { StepProgress::Busy } else { StepProgress::Done(-*left_s) })
            }
            Self::AwaitingSpeed { spindle, waited_s } => {
                *waited_s += dt;
                await_speed(*spindle, *waited_s, drives, context)
            }
            Self::AwaitingAngle { spindle, to, longest, waited_s } => {
                *waited_s += dt;
                await_angle(*spindle, (*to, *longest), *waited_s, drives, context)
            }
            Self::Changing { tool, waited_s } => {
                *waited_s += dt;
                await_tool(*tool, *waited_s, context)
            }
            Self::Tapping(run) => {
                let StepKind::Tap(plan) = step else { return Ok(StepProgress::Done(dt)) };
                match run.advance(plan, dt, drives, context) {
                    Outcome::Busy => Ok(StepProgress::Busy),
                    Outcome::Done => Ok(StepProgress::Done(0.0)),
                    Outcome::Failed(finding) => Err(finding),
                }
            }
        }
    }

    /// The operator's hold has come into force in the middle of it: it stands, and goes on from
    /// there.
    pub(crate) fn is_held(&self, operator: &Operator, chain: Option<&Chain>) -> bool {
        match self {
            Self::Threading => operator.wants_rest() && chain.is_some_and(Chain::is_standing),
            Self::Idle
            | Self::Pausing
            | Self::ChangingByHand { .. }
            | Self::AwaitingInput { .. }
            | Self::AwaitingInputs(_)
            | Self::Dwelling { .. } => operator.wants_rest(),
            Self::Probing(probing) => operator.wants_rest() && probing.is_held(),
            Self::Moving(moving, _) => moving.is_held(),
            Self::Tapping(run) => operator.wants_rest() && run.is_standing(),
            Self::Settling { .. }
            | Self::AwaitingSpeed { .. }
            | Self::AwaitingAngle { .. }
            | Self::Changing { .. }
            | Self::Counting(_)
            | Self::Recording { .. }
            | Self::Engaging(_)
            | Self::Fading { .. }
            | Self::Revolving { .. }
            | Self::Consulting { .. }
            | Self::AtOnce
            | Self::Ended => false,
        }
    }

    /// What it is, for reports.
    pub(crate) const fn state(&self) -> State {
        match self {
            Self::Idle | Self::AtOnce => State::Idle,
            Self::Moving(_, state) => *state,
            Self::Threading | Self::Probing(_) => State::Feed,
            Self::Settling { .. } => State::Settle,
            Self::Dwelling { .. } | Self::AwaitingInput { .. } | Self::Revolving { .. } => {
                State::Dwell
            }
            Self::Engaging(_) | Self::Fading { .. } => State::Couple,
            Self::Consulting { .. } => State::Measure,
            Self::AwaitingSpeed { .. } | Self::AwaitingAngle { .. } | Self::Recording { .. } => {
                State::SpindleWait
            }
            Self::Changing { .. }
            | Self::ChangingByHand { .. }
            | Self::AwaitingInputs(_)
            | Self::Counting(_) => State::ToolChange,
            Self::Tapping(run) => match run.phase() {
                Phase::Prepare => State::SpindleWait,
                Phase::In => State::TapIn,
                Phase::Bottom => State::TapBottom,
                Phase::Out | Phase::Done => State::TapOut,
            },
            Self::Pausing => State::Paused,
            Self::Ended => State::Ended,
        }
    }
}

fn begin_spindle(
    spindle: u8,
    order: &SpindleStep,
    drives: &mut Drives,
) -> Result<Activity, Finding> {
    let index = usize::from(spindle);
    let Some(control) = drives.spindles.get_mut(index).and_then(Option::as_mut) else {
        return Err((FaultKind::NotConfigured, Subject::Spindle(spindle), 0.0, 0.0));
    };
    Ok(match order {
        SpindleStep::Turn { spin, ramp } => {
            control.turn(*spin, ramp);
            drives.in_force[index] = *spin;
            drives.removals[index] = None;
            Activity::AtOnce
        }
        SpindleStep::Throw(order) => {
            drives.in_force[index] = order.then;
            drives.removals[index] = Some(Removal::new(order));
            Activity::AtOnce
        }
        SpindleStep::Surface { surface, ramp: _ } => {
            control.turn_by_surface(*surface);
            drives.in_force[index] = Spin::ZERO; // by the place of X
            drives.removals[index] = None;
            drives.follow_surface();
            Activity::AtOnce
        }
        SpindleStep::AwaitSpeed => Activity::AwaitingSpeed { spindle, waited_s: 0.0 },
        SpindleStep::Orient { to, longest } => {
            drives.in_force[index] = Spin::ZERO;
            drives.removals[index] = None;
            Activity::AwaitingAngle { spindle, to: *to, longest: *longest, waited_s: 0.0 }
        }
    })
}
