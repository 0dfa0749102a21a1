//! A stop while a tool is in work that it is not screwed to: a thread that is turned, a cam, a
//! polygon, a gear.
//!
//! With the drives alive the kernel itself takes the tool off the work; else, when drives and
//! control are back, its infeed axis does.
use super::{Ears, RUN_DOWN, one_period, run_down};
use crate::Drives;
use crate::recovery;
use kernel::{EventKind, Kernel, WithdrawalPlan};
use motion::{TiedCut, WayOut};
use units::{Accel, Length, Speed};

/// Periods after everything stands in which the kernel switches off what it holds no longer.
const SWITCHED_OFF: u32 = 20;

/// A tool that was taken off the work.
#[derive(Clone, Debug)]
pub struct Withdrawn {
    /// The program line that cut.
    pub line: u32,
    /// What it cut.
    pub cut: &'static str,
    /// The axis that took it off first, …
    pub axis: char,
    /// … and how far.
    pub by: Length,
}

/// What is being cut, for people.
const fn name(cut: TiedCut) -> &'static str {
    match cut {
        TiedCut::Thread => "a thread",
        TiedCut::Cam => "a cam",
        TiedCut::Polygon => "a polygon",
        TiedCut::Gear => "a gear",
        TiedCut::FloatingTap => "its hole",
    }
}

/// What is said where it is left.
pub(super) fn left_in(line: u32, way_out: &WayOut, by: &str) -> String {
    let (cut, axis) = (name(way_out.cut), way_out.infeed.letter());
    if !way_out.is_straight() {
        return format!(
            "line {line}: the tap was left in {cut}, and nothing ties it to an axis: turn the spindle backwards by hand until it is out"
        );
    }
    format!("line {line}: the tool was left in {cut}; {by} takes it off the work along {axis}")
}

/// Let everything come to rest, and take the tool off the work if that is asked for. What has come
/// of it; or, as an error, what is said where it is left. `recovers`: speed and acceleration of an
/// axis that goes back onto a thread.
pub(super) fn deal_with(
    kernel: &mut Kernel,
    plant: &mut dyn Drives,
    recovers: Option<(Speed, Accel)>,
    hear: Ears<'_>,
) -> Result<Option<Result<Withdrawn, String>>, String> {
    let Some(way_out) = kernel.way_out().copied() else {
        // an alarm is over when everything stands
        if kernel.is_retreating() || !kernel.faults().is_empty() {
            run_down(kernel, plant, hear);
            for _ in 0..SWITCHED_OFF {
                hear(&one_period(kernel, plant));
            }
        }
        return Ok(None);
    };
    let (line, cut) = (kernel.report().line, name(way_out.cut));
    let axis = way_out.infeed.letter();
    let place =
        |plant: &dyn Drives| plant.feedback().axes[way_out.infeed.index()].position.of_linear();
    let before = place(plant);
    run_down(kernel, plant, hear);
    // with the drives alive the kernel has seen to it
    if kernel.way_out().is_some() {
        let Some(feed) = recovers.filter(|_| way_out.is_straight()) else {
            return Ok(Some(Err(left_in(line, &way_out, "--recover"))));
        };
        plant.mend();
        withdraw(kernel, plant, &way_out, feed, hear)?;
    }
    Ok(Some(Ok(Withdrawn { line, cut, axis, by: place(plant) - before })))
}

/// The infeed axis takes the tool off; then, of a thread, spindle and axis go back along it.
fn withdraw(
    kernel: &mut Kernel,
    plant: &mut dyn Drives,
    way_out: &WayOut,
    feed: (Speed, Accel),
    hear: Ears<'_>,
) -> Result<(), String> {
    kernel.withdraw(WithdrawalPlan { legs: [Some((way_out.infeed, way_out.clear)), None] });
    until_over(kernel, plant, hear)?;
    let Some(pass) = way_out.pass else { return Ok(()) };
    match recovery::along_pass(&pass, way_out.spindle, plant.feedback(), feed) {
        Some(plan) => kernel.recover(plan),
        None => kernel.withdraw(WithdrawalPlan { legs: [Some((pass.axis, pass.from)), None] }),
    }
    until_over(kernel, plant, hear)
}

fn until_over(kernel: &mut Kernel, plant: &mut dyn Drives, hear: Ears<'_>) -> Result<(), String> {
    while kernel.next_event().is_some() {} // what was said before is no news
    let end = plant.feedback().time + recovery::LONGEST.max(RUN_DOWN);
    loop {
        if plant.feedback().time > end {
            return Err("the tool is not off the work after five minutes".into());
        }
        let sample = one_period(kernel, plant);
        hear(&sample);
        while let Some(event) = kernel.next_event() {
            match event.kind {
                EventKind::Withdrawn { .. } | EventKind::RecoveryEnded(_) => return Ok(()),
                EventKind::FaultRaised(fault) => return Err(fault.to_string()),
                _ => {}
            }
        }
    }
}
