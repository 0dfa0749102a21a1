//! The way out for a tool that is tied to a spindle without being screwed to the work: a pass over a thread, a cam, a
//! polygon, a gear. The infeed axis takes it off the work first, whatever the spindles' angles are.
use crate::plant::Plant;
use crate::wiring;
use canon::Axis;
use kernel::{EventKind, Kernel, WithdrawalPlan};
use store::machine::MachineFile;
use store::sync_record::{Cut, Retreat, Stroke};
use units::{Angle, Length, Time};
use wire::Welcome;

/// One axis' way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub(super) axis: Axis,
    pub(super) from: Length,
    pub(super) to: Length,
}

/// Where the tool stands, and the way it is taken off the work.
pub(super) struct Withdrawal {
    /// The infeed axis.
    pub(super) infeed: Leg,
    /// Afterwards, along a thread, back to where the pass began.
    pub(super) along: Option<Leg>,
    /// How far what follows stands off its coupling; or why that cannot be said.
    pub(super) off: Result<Off, &'static str>,
}

/// A distance from a coupling, of all the places that the turns allow the nearest one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Off {
    /// Along a thread; along the path of a cutter's tip; on the pitch circle of a gear.
    pub(super) length: Length,
    /// The same as a turn of the spindle: of the one that leads a thread, of the one that follows in a gear.
    pub(super) angle: Angle,
    /// For people: off what.
    pub(super) of: &'static str,
}

/// Of a cam.
const INFEED: &str =
    "a wheel's infeed goes on top of its profile, and how far that had come is not written down";

/// From record and encoders.
pub(super) fn find(stroke: &Stroke, retreat: Retreat, welcome: &Welcome) -> Withdrawal {
    let feedback = &welcome.observed.feedback;
    let place = |axis: u8| feedback.axes[usize::from(axis)].position;
    let leg = |axis: u8, to| Leg { axis: Axis::ALL[usize::from(axis)], from: place(axis), to };
    let is_thread = stroke.cut == Cut::Thread;
    Withdrawal {
        infeed: leg(retreat.axis, retreat.clear),
        along: is_thread.then(|| leg(stroke.axis, stroke.start)),
        off: off(stroke, welcome),
    }
}

/// How far what follows stands off its coupling.
fn off(stroke: &Stroke, welcome: &Welcome) -> Result<Off, &'static str> {
    let feedback = &welcome.observed.feedback;
    let place = |axis: u8| feedback.axes[usize::from(axis)].position;
    let reading = |spindle: u8| feedback.spindles[usize::from(spindle)].angle;
    if stroke.cut == Cut::Thread {
        let off = place(stroke.axis) - stroke.position(reading(stroke.spindle));
        let turns = (off / stroke.lead).value();
        let angle = Angle::rev(turns - turns.round());
        return Ok(Off { length: stroke.lead * angle, angle, of: "its thread" });
    }
    let Some(geared) = &stroke.geared else { return Err(INFEED) };
    let lost = welcome.turns_lost[usize::from(stroke.spindle)];
    let angle = geared.error(reading(stroke.spindle), reading(geared.follower), place, lost);
    let of = if stroke.cut == Cut::Gear { "its pitch circle" } else { "its tip's path" };
    Ok(Off { length: geared.radius * angle.in_rad(), angle, of })
}

/// Take it out; how long that took.
pub(super) fn drive(
    plant: &mut Plant,
    file: &MachineFile,
    way: &Withdrawal,
) -> Result<Time, String> {
    let legs = [Some(way.infeed), way.along];
    for leg in legs.iter().flatten() {
        if file.axis(leg.axis).is_none() {
            return Err(format!("the machine's file has no axis {}", leg.axis.letter()));
        }
    }
    let mut kernel = Kernel::new(wiring::control(file, None, false));
    kernel.withdraw(WithdrawalPlan { legs: legs.map(|leg| leg.map(|leg| (leg.axis, leg.to))) });
    let mut taken = None;
    super::obey(&mut kernel, plant, &mut |event| {
        if let EventKind::Withdrawn { duration } = event {
            taken = Some(*duration);
        }
    })?;
    taken.ok_or_else(|| format!("it is not out after {}", super::LONGEST))
}
