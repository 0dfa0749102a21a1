//! Waiting for inputs, and moving until the probe changes.
//!
//! ```text
//!   M66   low ─┐ rise ┌─ high       L1 waits until it has been low, then for high; L3 for high alone (L2, L4 the other way)
//!              └──────┘             after Q seconds: no value, and the program goes on
//!
//!   G38   ──────► ● ──► ▪           ● the probe changes: its place is kept; ▪ the axes have come to rest on the path
//! ```
//!
//! The place of the contact is taken between the two readings around it, at the moment that the
//! machine states, or in their middle: at 5 mm/s and a period of 250 µs that is 0.6 µm.
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::event::EventKind;
use crate::execute::{Context, StepProgress};
use crate::fault::FaultKind;
use crate::moving::Moving;
use crate::queue::StepKind;
use crate::sequence_steps::{Awaited, Counted};
use crate::track::Track;
use bus::{AXES, Feedback};
use motion::{Await, InputWait, Move, ProbeEnd};
use units::{Axis, Coordinate, Position, Time};

/// What the program asked for, and what came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Answered {
    /// Index of the op that asked.
    pub op: u32,
    /// What came of it.
    pub answer: Answer,
}

/// What came of a wait or a probing move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Answer {
    /// What the input was when the wait ended; `None`: the wait has run out of its time.
    Input(Option<f64>),
    /// A probing move is over.
    Probe {
        /// Where the axes were when the probe changed, by their encoders; else where they have come
        /// to.
        contact: Position,
        /// Where they stand.
        stands: Position,
        /// The probe has changed.
        changed: bool,
    },
}

/// The value of an input: 1 and 0 of a digital one.
fn value_of(wait: &InputWait, feedback: &Feedback) -> f64 {
    if wait.digital {
        return f64::from(u8::from(feedback.inputs.is_on(wait.number)));
    }
    feedback.inputs.analogue.get(usize::from(wait.number)).copied().unwrap_or(0.0)
}

/// Whether what is waited for is there. `armed`: the input has been the other way, for an edge.
fn has_come(wait: &InputWait, value: f64, armed: &mut bool) -> bool {
    let on = value != 0.0;
    match wait.until {
        Await::Nothing => true,
        Await::On => on,
        Await::Off => !on,
        Await::Rise | Await::Fall => {
            let is_there = on == (wait.until == Await::Rise);
            *armed |= !is_there;
            *armed && is_there
        }
    }
}

/// One period of a wait for an input; what came of it when it has ended.
fn await_input(
    wait: &InputWait,
    dt: f64,
    (armed, waited_s): (&mut bool, &mut f64),
    feedback: &Feedback,
) -> Option<Answer> {
    let value = value_of(wait, feedback);
    if has_come(wait, value, armed) {
        return Some(Answer::Input(Some(value)));
    }
    *waited_s += dt;
    (*waited_s > wait.longest.value()).then_some(Answer::Input(None))
}

/// A probing move under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probing {
    moving: Moving,
    /// Where the axes were a period ago.
    before: [f64; AXES],
    /// Where they were when the probe changed.
    contact: Option<[f64; AXES]>,
}

impl Probing {
    /// Begin, if the axes stand there and the probe is as it must be.
    pub(crate) fn begin(
        order: &Move,
        until: ProbeEnd,
        drives: &mut Drives,
        feedback: &Feedback,
    ) -> Result<Self, Finding> {
        if feedback.probe == until.contact {
            return Err((FaultKind::ProbeNotReady, Subject::Machine, 0.0, 0.0));
        }
        let moving = Moving::begin(Track::Move(order), drives)?;
        Ok(Self { moving, before: places(drives), contact: None })
    }

    /// The operator holds it, and it stands.
    pub(crate) const fn is_held(&self) -> bool {
        self.contact.is_none() && self.moving.is_held()
    }

    /// Go on for `dt` seconds; the answer when it stands.
    pub(crate) fn advance(
        &mut self,
        until: ProbeEnd,
        dt: f64,
        drives: &mut Drives,
        context: &Context,
    ) -> Result<Option<Answer>, Finding> {
        let now = places(drives);
        if self.contact.is_none() && context.feedback.probe == until.contact {
            let period = context.config.period;
            self.contact = Some(between(&self.before, &now, context.feedback.probe_age, period));
            self.moving.come_to_rest();
        }
        self.before = now;
        let orders = (context.operator, context.config);
        let is_over = self.moving.advance(context.steps, dt, drives, orders).is_some();
        let stands = is_over || self.contact.is_some() && self.moving.is_held();
        if !stands {
            return Ok(None);
        }
        (drives.flowing, drives.owed) = (false, None);
        if self.contact.is_none() && until.required {
            return Err((FaultKind::ProbeNotReached, Subject::Machine, 0.0, 0.0));
        }
        let changed = self.contact.is_some();
        let contact = position(&self.contact.unwrap_or(now));
        Ok(Some(Answer::Probe { contact, stands: position(&targets(drives)), changed }))
    }
}

/// Go on waiting for an input.
pub(crate) fn wait_on(
    step: &StepKind,
    dt: f64,
    state: (&mut bool, &mut f64),
    context: &mut Context,
) -> StepProgress {
    let StepKind::Input(wait) = step else { return StepProgress::Done(dt) };
    let ended = await_input(wait, dt, state, context.feedback);
    let Some(answer @ Answer::Input(value)) = ended else { return StepProgress::Busy };
    context.note(EventKind::InputRead { wait: *wait, value });
    answered(answer, context, dt)
}

/// Go on probing; done when the axes are told to stand, with the answer kept for the program.
pub(crate) fn probe_on(
    probing: &mut Probing,
    step: &StepKind,
    dt: f64,
    drives: &mut Drives,
    context: &mut Context,
) -> Result<StepProgress, Finding> {
    let StepKind::Probe { until, .. } = step else { return Ok(StepProgress::Done(dt)) };
    let Some(answer) = probing.advance(*until, dt, drives, context)? else {
        return Ok(StepProgress::Busy);
    };
    if let Answer::Probe { contact, changed, .. } = answer {
        context.note(EventKind::Probed { contact, changed });
    }
    Ok(answered(answer, context, 0.0))
}

/// What a step that asks has come to: it is kept for the program, and the step is done.
fn answered(answer: Answer, context: &mut Context, left: f64) -> StepProgress {
    *context.answer = Some(Answered { op: context.op, answer });
    StepProgress::Done(left)
}

/// Between two readings, at a moment that lies so long before the later one.
fn between(
    before: &[f64; AXES],
    now: &[f64; AXES],
    age: Option<Time>,
    period: Time,
) -> [f64; AXES] {
    let share = age.map_or(0.5, |age| (age / period).clamp(0.0, 1.0));
    let mut at = *now;
    for (at, before) in at.iter_mut().zip(before) {
        *at += (before - *at) * share;
    }
    at
}

/// Where the axes are by their encoders.
fn places(drives: &Drives) -> [f64; AXES] {
    let mut at = [0.0; AXES];
    for (at, axis) in at.iter_mut().zip(&drives.axes) {
        *at = axis.as_ref().map_or(0.0, crate::axis::AxisLoop::position);
    }
    at
}

/// Where the axes are told to be.
fn targets(drives: &Drives) -> [f64; AXES] {
    let mut at = [0.0; AXES];
    for (at, axis) in at.iter_mut().zip(&drives.axes) {
        *at = axis.as_ref().map_or(0.0, |axis| axis.target.position);
    }
    at
}

fn position(at: &[f64; AXES]) -> Position {
    let mut position = Position::default();
    for (axis, at) in Axis::ALL.into_iter().zip(at) {
        position = position.with(axis, Coordinate::new(*at));
    }
    position
}

/// Goes on waiting for inputs.
pub(crate) fn await_inputs(
    step: &StepKind,
    dt: f64,
    awaited: &mut Awaited,
    feedback: &Feedback,
) -> Result<StepProgress, Finding> {
    let StepKind::Inputs(wait) = step else { return Ok(StepProgress::Done(dt)) };
    let is_over = awaited.advance(wait, dt, &feedback.inputs)?;
    Ok(if is_over { StepProgress::Done(0.0) } else { StepProgress::Busy })
}

/// Goes on counting.
pub(crate) fn count_edges(
    step: &StepKind,
    dt: f64,
    counted: &mut Counted,
    drives: &mut Drives,
    context: &mut Context,
) -> Result<StepProgress, Finding> {
    let StepKind::Count(count) = step else { return Ok(StepProgress::Done(dt)) };
    let output =
        |on| motion::Output { number: count.output, signal: motion::Signal::Digital { on } };
    if drives.motor != Some(count.output) {
        drives.start_motor(count.output);
        context.note(EventKind::OutputSet(output(true)));
    }
    if counted.advance(count, dt, &context.feedback.inputs)? {
        drives.stop_motor();
        context.note(EventKind::OutputSet(output(false)));
        return Ok(StepProgress::Done(0.0));
    }
    Ok(StepProgress::Busy)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RISE: InputWait =
        InputWait { number: 3, digital: true, until: Await::Rise, longest: Time::s(1.0) };

    /// What a wait comes to over these states of its input, a quarter of a second each, and after
    /// how many of them.
    fn waits(wait: InputWait, states: &[bool]) -> Option<(usize, Option<f64>)> {
        let (mut armed, mut waited) = (false, 0.0);
        for (index, on) in states.iter().enumerate() {
            let mut feedback = Feedback::default();
            feedback.inputs.switch(wait.number, *on);
            let ended = await_input(&wait, 0.25, (&mut armed, &mut waited), &feedback);
            if let Some(Answer::Input(value)) = ended {
                return Some((index, value));
            }
        }
        None
    }

    #[test]
    fn a_rise_needs_the_input_to_be_low_before() {
        assert_eq!(waits(RISE, &[true, true, false, true]), Some((3, Some(1.0))));
        assert_eq!(waits(RISE, &[false, true]), Some((1, Some(1.0))));
        let fall = InputWait { until: Await::Fall, ..RISE };
        assert_eq!(waits(fall, &[false, true, false]), Some((2, Some(0.0))));
    }

    #[test]
    fn a_level_that_is_there_ends_the_wait_at_once_and_a_read_always_does() {
        let high = InputWait { until: Await::On, ..RISE };
        assert_eq!(waits(high, &[true]), Some((0, Some(1.0))));
        let read = InputWait { until: Await::Nothing, ..RISE };
        assert_eq!(waits(read, &[false]), Some((0, Some(0.0))));
    }

    #[test]
    fn a_wait_that_runs_out_of_its_time_has_no_value() {
        assert_eq!(waits(RISE, &[true; 9]), Some((4, None)));
    }

    #[test]
    fn the_place_of_a_contact_lies_where_the_machine_says_that_it_was() {
        let (before, now) = ([0.0; AXES], [1.0; AXES]);
        let at = |age| between(&before, &now, age, Time::s(0.001))[0];
        assert!((at(Some(Time::s(0.000_25))) - 0.75).abs() < 1e-12);
        assert!((at(None) - 0.5).abs() < 1e-12);
    }
}
