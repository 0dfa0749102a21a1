//! The way out for a tool that is tied to a spindle without being screwed to the work: a pass over
//! a thread, a cam, a polygon, a gear. The infeed axis takes it off the work first, whatever the
//! spindles' angles are; then, of a thread, spindle and axis go back along its line, so that the
//! space that the tool passes is that of the pass.
use crate::Drives;
use crate::config;
use bus::Feedback;
use canon::Axis;
use kernel::{EventKind, Kernel, RecoveryFigures, RecoveryPlan, WithdrawalPlan};
use motion::Pass;
use store::machine::MachineFile;
use store::sync_record::{Cut, Retreat, Stroke};
use sync::Coupling;
use sync::recovery::{Direction, Point, Stored, Way};
use units::{Accel, Angle, LeadGrowth, Length, Speed, Time};
use wire::Welcome;

/// One axis' way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Which axis.
    pub axis: Axis,
    /// From here …
    pub from: Length,
    /// … to there, machine coordinates.
    pub to: Length,
}

/// Where the tool stands, and the way it is taken off the work.
pub struct Withdrawal {
    /// The infeed axis.
    pub infeed: Leg,
    /// Afterwards back to where a thread's pass began …
    pub along: Option<Leg>,
    /// … along the thread, together with the spindle; else by itself, as its lead grows.
    pub together: bool,
    /// How far what follows stands off its coupling; or why that cannot be said.
    pub off: Result<Off, &'static str>,
}

/// A distance from a coupling, of all the places that the turns allow the nearest one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Off {
    /// Along a thread; along the path of a cutter's tip; on the pitch circle of a gear.
    pub length: Length,
    /// The same as a turn of the spindle: of the one that leads a thread, of the one that follows
    /// in a gear.
    pub angle: Angle,
    /// For people: off what.
    pub of: &'static str,
}

/// Of a cam.
const INFEED: &str =
    "a wheel's infeed goes on top of its profile, and how far that had come is not written down";

/// From record and encoders.
pub(super) fn find(
    stroke: &Stroke,
    retreat: Retreat,
    welcome: &Welcome,
    file: &MachineFile,
) -> Withdrawal {
    let feedback = &welcome.observed.feedback;
    let place = |axis: u8| feedback.axes[usize::from(axis)].position.of_linear();
    let leg = |axis: u8, to| Leg { axis: Axis::ALL[usize::from(axis)], from: place(axis), to };
    let is_thread = stroke.cut == Cut::Thread;
    Withdrawal {
        infeed: leg(retreat.axis, retreat.clear),
        along: is_thread.then(|| leg(stroke.axis, stroke.start)),
        together: is_thread && stroke.growth == LeadGrowth::ZERO,
        off: off(stroke, welcome, file),
    }
}

/// How far what follows stands off its coupling.
fn off(stroke: &Stroke, welcome: &Welcome, file: &MachineFile) -> Result<Off, &'static str> {
    let feedback = &welcome.observed.feedback;
    let place = |axis: u8| super::stands(file, feedback, axis);
    let reading = |spindle: u8| feedback.spindles[usize::from(spindle)].angle;
    if stroke.cut == Cut::Thread {
        let (theta, lead) = stroke.belongs(place(stroke.axis));
        let turns = (theta - reading(stroke.spindle)).value();
        let angle = Angle::rev(turns - turns.round());
        return Ok(Off { length: lead * angle, angle, of: "its thread" });
    }
    let Some(geared) = &stroke.geared else { return Err(INFEED) };
    let lost = welcome.turns_lost[usize::from(stroke.spindle)];
    let angle = geared.error(reading(stroke.spindle), reading(geared.follower), place, lost);
    let of = if stroke.cut == Cut::Gear { "its pitch circle" } else { "its tip's path" };
    Ok(Off { length: geared.radius * angle.in_rad(), angle, of })
}

/// How it was taken out.
#[derive(Debug)]
pub(super) struct Drawn {
    /// How long that took.
    pub(super) duration: Time,
    /// Of a thread: how it went back along it.
    pub(super) figures: Option<RecoveryFigures>,
    /// Why it did not.
    pub(super) note: Option<String>,
}

/// Take it out. A thread's axis goes back along the thread with the spindle; where that cannot be,
/// by itself: the tool is off the work.
pub(super) fn drive(
    plant: &mut dyn Drives,
    file: &MachineFile,
    stroke: &Stroke,
    way: &Withdrawal,
) -> Result<Drawn, String> {
    let legs = [Some(way.infeed), way.along];
    for leg in legs.iter().flatten() {
        if file.axis(leg.axis).is_none() {
            return Err(format!("the machine's file has no axis {}", leg.axis.letter()));
        }
    }
    let duration = straight(plant, file, way.infeed)?;
    let mut drawn = Drawn { duration, figures: None, note: None };
    let Some(leg) = way.along else { return Ok(drawn) };
    if !way.together {
        drawn.duration += straight(plant, file, leg)?;
        return Ok(drawn);
    }
    match back_along(plant, file, stroke) {
        Ok(figures) => {
            drawn.duration += figures.duration;
            drawn.figures = Some(figures);
        }
        Err(why) => {
            let letter = leg.axis.letter();
            drawn.note =
                Some(format!("not along the thread ({why}): {letter} went back by itself"));
            drawn.duration += straight(plant, file, leg)?;
        }
    }
    Ok(drawn)
}

/// One axis by itself; how long that took.
fn straight(plant: &mut dyn Drives, file: &MachineFile, leg: Leg) -> Result<Time, String> {
    let mut kernel = Kernel::new(config::unreferenced(file));
    kernel.withdraw(WithdrawalPlan { legs: [Some((leg.axis, leg.to)), None] });
    let mut taken = None;
    super::obey(&mut kernel, plant, &mut |event| {
        if let EventKind::Withdrawn { duration } = event {
            taken = Some(*duration);
        }
    })?;
    taken.ok_or_else(|| format!("it is not out after {}", super::LONGEST))
}

/// Back onto the thread's line by who overran, then along it to where the pass began: the tool is
/// off the work.
fn back_along(
    plant: &mut dyn Drives,
    file: &MachineFile,
    stroke: &Stroke,
) -> Result<RecoveryFigures, String> {
    let Some(pass) = pass(stroke) else { return Err("it is no thread".into()) };
    let approach = file.axis(pass.axis).map(|axis| axis.approach);
    let approach = approach.ok_or_else(|| format!("there is no axis {}", pass.axis.letter()))?;
    let mut kernel = Kernel::new(config::unreferenced(file));
    let feed = (approach.speed.of_linear() / 10.0, approach.acceleration.of_linear());
    let plan = along_pass(&pass, stroke.spindle, plant.feedback(), feed);
    kernel.recover(plan.ok_or("its lead grows")?);
    let mut figures = None;
    super::obey(&mut kernel, plant, &mut |event| {
        if let EventKind::RecoveryEnded(ended) = event {
            figures = Some(*ended);
        }
    })?;
    figures.ok_or_else(|| format!("it is not there after {}", super::LONGEST))
}

/// The pass of a thread that is turned.
pub fn pass(stroke: &Stroke) -> Option<Pass> {
    (stroke.cut == Cut::Thread).then(|| Pass {
        axis: Axis::ALL[usize::from(stroke.axis)],
        start: stroke.z0,
        angle: stroke.theta0,
        end: stroke.bottom,
        from: stroke.start,
        surface: stroke.surface,
        lead: stroke.lead,
        growth: stroke.growth,
        spin: stroke.spin,
    })
}

/// The way back onto the line of a pass and along it, for a tool that is off the work; none where
/// its lead grows, which is no line: its axis goes back by itself.
pub fn along_pass(
    pass: &Pass,
    spindle: u8,
    feedback: &Feedback,
    feed: (Speed, Accel),
) -> Option<RecoveryPlan> {
    if pass.growth != LeadGrowth::ZERO {
        return None;
    }
    let at = Point {
        angle: feedback.spindles[usize::from(spindle)].angle,
        place: feedback.axes[pass.axis.index()].position.of_linear(),
    };
    let coupling = Coupling::line(pass.lead, pass.angle, pass.start);
    let angle = |z: Length| pass.angle + (z - pass.start) / pass.lead;
    let stored = Stored::on(coupling, angle(pass.from), angle(pass.end), Direction::Inward);
    // every turn is as good: a pass is begun at an angle within one
    let turn = Angle::rev((stored.error(at) / pass.lead).value().round());
    let (way, spin) = (Way::Direct, super::OUT);
    Some(RecoveryPlan { axis: pass.axis, spindle, stored, turn, way, spin, feed })
}
