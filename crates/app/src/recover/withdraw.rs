//! The way out for a tool that is tied to a spindle without being screwed to the work: a pass over a thread, a cam, a
//! polygon, a gear. The infeed axis takes it off the work first, whatever the spindles' angles are.
use crate::plant::Plant;
use crate::wiring;
use bus::Feedback;
use canon::Axis;
use kernel::{EventKind, Kernel, WithdrawalPlan};
use store::machine::MachineFile;
use store::sync_record::{Cut, Retreat, Stroke};
use units::{Length, Time};

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
    /// How far the tool stands off the thread's line along it, of all the turns the nearest one.
    pub(super) error: Option<Length>,
}

/// From record and encoders.
pub(super) fn find(stroke: &Stroke, retreat: Retreat, feedback: &Feedback) -> Withdrawal {
    let place = |axis: u8| feedback.axes[usize::from(axis)].position;
    let leg = |axis: u8, to| Leg { axis: Axis::ALL[usize::from(axis)], from: place(axis), to };
    let is_thread = stroke.cut == Cut::Thread;
    let error = is_thread.then(|| {
        let reading = feedback.spindles[usize::from(stroke.spindle)].angle;
        let off = place(stroke.axis) - stroke.position(reading);
        let turns = (off / stroke.lead).value();
        stroke.lead * units::Angle::rev(turns - turns.round())
    });
    Withdrawal {
        infeed: leg(retreat.axis, retreat.clear),
        along: is_thread.then(|| leg(stroke.axis, stroke.start)),
        error,
    }
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
