//! Waits, each with what ends it and how long it may last: spindles, axes in position, tools,
//! records, the operator.
use crate::config::{Pause, Subject};
use crate::drives::{Drives, Finding};
use crate::event::EventKind;
use crate::execute::{Activity, Context, StepProgress};
use crate::fault::FaultKind;
use crate::queue::StepKind;
use crate::record_requests::{Permission, RECORD_WAIT, WorkRecord};
use crate::spindle::SpindleLoop;
use crate::waiting::WaitFor;
use units::{Angle, Orientation, Time};

/// How long what runs the kernel may take to answer a question.
pub(crate) const CONSULT_WAIT: Time = Time::s(60.0);

/// A tool goes into the work only when its way out is written down, where that is done.
pub(crate) fn record(
    step: &StepKind,
    dt: f64,
    waited_s: f64,
    drives: &mut Drives,
    context: &Context,
) -> Result<StepProgress, Finding> {
    let StepKind::WayOut(Some(way_out)) = step else { return Ok(StepProgress::Done(dt)) };
    let record = WorkRecord::of_way_out(way_out, context.op, context.line, drives.tool);
    match drives.record_requests.ask(&record) {
        Permission::Granted => Ok(StepProgress::Done(dt)),
        Permission::Waiting if waited_s <= RECORD_WAIT.value() => Ok(StepProgress::Busy),
        Permission::Waiting | Permission::Refused => {
            Err((FaultKind::RecordNotWritten, Subject::Machine, 0.0, 0.0))
        }
    }
}

pub(crate) fn begin_pause(optional: bool, context: &mut Context) -> Activity {
    match context.config.pause {
        _ if optional && !context.operator.optional_stop() => Activity::AtOnce,
        Pause::GoOn => {
            context.note(EventKind::ConfirmedAutomatically(WaitFor::Operator { optional }));
            Activity::AtOnce
        }
        Pause::Wait => {
            context.note(EventKind::Paused);
            Activity::Pausing
        }
    }
}

/// A tool is called: the changer brings it, or it is put in by hand.
pub(crate) fn begin_change(
    tool: u32,
    by_hand: bool,
    drives: &mut Drives,
    context: &mut Context,
) -> Activity {
    if by_hand && context.config.pause == Pause::Wait {
        context.note(EventKind::Paused);
        return Activity::ChangingByHand { tool };
    }
    if by_hand {
        context.note(EventKind::ConfirmedAutomatically(WaitFor::ToolByHand(tool)));
    }
    drives.tool = tool;
    Activity::Changing { tool, waited_s: 0.0 }
}

pub(crate) fn settle(
    dt: f64,
    waited_s: &mut f64,
    inside_s: &mut f64,
    drives: &Drives,
    limit: Time,
) -> Result<StepProgress, Finding> {
    *waited_s += dt;
    let outside = drives.in_position();
    *inside_s = if outside.is_ok() { *inside_s + dt } else { 0.0 };
    if *inside_s > drives.settle_s() {
        return Ok(StepProgress::Done(0.0));
    }
    match outside {
        Err(finding) if *waited_s > limit.value() => Err(finding),
        _ => Ok(StepProgress::Busy),
    }
}

/// A superposition begins when the one before has faded; all are awaited where a step says so.
pub(crate) fn fade(
    step: &StepKind,
    dt: f64,
    drives: &mut Drives,
    still: (&mut f64, Time),
) -> Result<StepProgress, Finding> {
    if let StepKind::Superpose(order) = step {
        if drives.coupled.is_fading(order.on) {
            return turns_on(drives, None, dt, still);
        }
        drives.superpose(order)?;
        return Ok(StepProgress::Done(dt));
    }
    if drives.coupled.has_faded() {
        return Ok(StepProgress::Done(dt));
    }
    turns_on(drives, None, dt, still)
}

/// What counts turns goes on while a spindle turns: this one, or any.
fn turns_on(
    drives: &Drives,
    spindle: Option<u8>,
    dt: f64,
    (still_s, limit): (&mut f64, Time),
) -> Result<StepProgress, Finding> {
    /// What turns slower stands, rev/s.
    const STANDS: f64 = 1e-3;
    let of = |index: usize| spindle.is_none_or(|spindle| usize::from(spindle) == index);
    let loops = drives.spindles.iter().enumerate().filter(|(index, _)| of(*index));
    let spins = loops.filter_map(|(_, spindle)| spindle.as_ref());
    let turns = spins.map(|spindle| spindle.now().spin.value().abs()).fold(0.0, f64::max);
    *still_s = if turns < STANDS { *still_s + dt } else { 0.0 };
    let of = spindle.map_or(Subject::Machine, Subject::Spindle);
    within(*still_s, limit, FaultKind::TurnsNotMade, of)
}

/// A spindle locks onto its gear.
pub(crate) fn engage(follower: u8, drives: &Drives, context: &mut Context) -> StepProgress {
    if !drives.coupled.is_locked(follower) {
        return StepProgress::Busy;
    }
    context.note(EventKind::SpindlesCoupled { follower });
    StepProgress::Done(0.0)
}

/// What runs the kernel answers a question in time.
pub(crate) fn consult(waited_s: f64) -> Result<StepProgress, Finding> {
    within(waited_s, CONSULT_WAIT, FaultKind::NotAnswered, Subject::Machine)
}

pub(crate) fn await_speed(
    spindle: u8,
    waited_s: f64,
    drives: &Drives,
    context: &mut Context,
) -> Result<StepProgress, Finding> {
    let Some(control) = &drives.spindles[usize::from(spindle)] else {
        return Ok(StepProgress::Done(0.0));
    };
    let throwing = drives.removals[usize::from(spindle)].is_some();
    if let Some(spin) = control.at_speed().filter(|_| !throwing) {
        context.note(EventKind::SpindleAtSpeed { spindle, spin });
        return Ok(StepProgress::Done(0.0));
    }
    let (has, wanted) = (control.now().spin.value(), control.ordered().spin.value());
    if waited_s > context.config.waits.at_speed.value() {
        return Err((FaultKind::NotAtSpeed, Subject::Spindle(spindle), has, wanted));
    }
    Ok(StepProgress::Busy)
}

pub(crate) fn await_angle(
    spindle: u8,
    (to, longest): (Orientation, Option<Time>),
    waited_s: f64,
    drives: &mut Drives,
    context: &mut Context,
) -> Result<StepProgress, Finding> {
    let Some(control) = &mut drives.spindles[usize::from(spindle)] else {
        return Ok(StepProgress::Done(0.0));
    };
    control.hold(Some(to));
    if control.held().is_some() {
        context.note(EventKind::SpindleOriented { spindle });
        return Ok(StepProgress::Done(0.0));
    }
    let limit = longest.unwrap_or(context.config.waits.oriented);
    is_not_oriented(spindle, control, waited_s, limit)?;
    Ok(StepProgress::Busy)
}

/// A spindle that is on its way to an angle is given so long, unless its drive says that it cannot.
pub(crate) fn is_not_oriented(
    spindle: u8,
    control: &SpindleLoop,
    waited_s: f64,
    limit: Time,
) -> Result<(), Finding> {
    let of = Subject::Spindle(spindle);
    if let Some(code) = control.orient_fault() {
        return Err((FaultKind::OrientationFault, of, f64::from(code), 0.0));
    }
    if waited_s > limit.value() {
        return Err((FaultKind::NotOriented, of, waited_s, limit.value()));
    }
    Ok(())
}

fn within(
    waited_s: f64,
    limit: Time,
    kind: FaultKind,
    of: Subject,
) -> Result<StepProgress, Finding> {
    if waited_s > limit.value() {
        Err((kind, of, waited_s, limit.value()))
    } else {
        Ok(StepProgress::Busy)
    }
}

/// The changer puts a tool in.
pub(crate) fn await_tool(
    tool: u32,
    waited_s: f64,
    context: &mut Context,
) -> Result<StepProgress, Finding> {
    if context.feedback.tool == Some(tool) {
        context.note(EventKind::ToolChanged { tool });
        return Ok(StepProgress::Done(0.0));
    }
    let limit = context.config.waits.tool_change;
    within(waited_s, limit, FaultKind::ToolNotChanged, Subject::Machine)
}

/// A spindle turns so often from where it was.
pub(crate) fn revolve(
    step: &StepKind,
    from: Angle,
    dt: f64,
    drives: &Drives,
    still: (&mut f64, Time),
) -> Result<StepProgress, Finding> {
    let StepKind::Revolve { spindle, turns } = step else { return Ok(StepProgress::Done(dt)) };
    let now = drives.spindles[usize::from(*spindle)].as_ref().map(SpindleLoop::now);
    let turned = now.map_or(*turns, |now| now.angle - from);
    if turned.abs() < turns.abs() {
        return turns_on(drives, Some(*spindle), dt, still);
    }
    Ok(StepProgress::Done(0.0))
}
