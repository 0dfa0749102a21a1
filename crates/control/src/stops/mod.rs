//! What stops a run in the middle, and the way out of a thread after it.
//!
//! ```text
//!   --fault, --operator ─► Script ─┬─► the machine fails, the operator orders
//!                                  ▼
//!   a tap in its thread ── runs down ── mended ─► kernel: back onto the coupling, out ─► end, or the remaining holes
//!                              │
//!                              └─ a copy of the machine takes the other way, for the report
//! ```
mod off;
mod settings;

pub use off::Withdrawn;
pub use settings::RecoverySettings;

use crate::executor::period;
use crate::job::Session;
use crate::recovery;
use crate::script::{Script, Told};
use crate::{Drives, KernelHandle, MachineHandle};
use bus::Sample;
use kernel::{EventKind, FaultKind, Kernel, Notice, Order, RecoveryFigures, RecoveryPlan};
use report::{PlanePoint, ThreadStop, WayBack};
use sim::Fault;
use std::ops::ControlFlow;
use sync::recovery::{Mover, Point, Stored, Way};
use units::{Angle, Coordinate, Length, Spin, Time};
use verify::{FeatureKind, Judge};

/// Whatever was switched off stands by then: the operator switches it on again.
const RUN_DOWN: Time = Time::s(10.0);

/// What comes after a tool has been taken out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AfterStop {
    /// The end.
    Out,
    /// The remaining holes.
    Continue,
}

/// What is to come, and what has come.
pub struct Stops {
    faults: Script<Fault>,
    orders: Script<Order>,
    recover: Option<AfterStop>,
    lengths: Vec<(u32, Length)>,
    zero: Length,
    settings: RecoverySettings,
    /// What has come, for people.
    pub happened: Vec<String>,
    /// Stops in a thread.
    pub threads: Vec<ThreadStop>,
    /// Tools taken off work that they were not screwed to.
    pub withdrawn: Vec<Withdrawn>,
    /// Of the last fault: its name and when.
    last: Option<(String, Time)>,
}

/// What the machine does while a stop is dealt with.
pub type Ears<'a> = &'a mut dyn FnMut(&Sample);

impl Stops {
    /// As the arguments have it.
    pub fn new(
        recover: Option<AfterStop>,
        told: Told,
        session: &Session,
        seed: u64,
        planned: Time,
    ) -> Self {
        Self {
            faults: Script::new(told.faults, seed, planned),
            orders: Script::new(told.orders, seed ^ 1, planned),
            recover,
            lengths: session.tools.iter().map(|tool| (tool.number, tool.worn_length())).collect(),
            zero: session.work_zero().linear[2],
            settings: RecoverySettings::new(session),
            happened: Vec::new(),
            threads: Vec::new(),
            withdrawn: Vec::new(),
            last: None,
        }
    }

    /// Nothing comes.
    pub fn none() -> Self {
        Self {
            faults: Script::new(Vec::new(), 0, Time::ZERO),
            orders: Script::new(Vec::new(), 0, Time::ZERO),
            recover: None,
            lengths: Vec::new(),
            zero: Length::ZERO,
            settings: RecoverySettings::none(),
            happened: Vec::new(),
            threads: Vec::new(),
            withdrawn: Vec::new(),
            last: None,
        }
    }

    /// Nothing was told to come.
    pub fn is_quiet(&self) -> bool {
        self.faults.is_empty() && self.orders.is_empty()
    }

    /// The operator has nothing more to say.
    pub fn no_orders_left(&self) -> bool {
        self.orders.is_empty()
    }

    /// Let come what comes in this period.
    pub fn act(&mut self, sample: &Sample, kernel: &mut KernelHandle, plant: &mut MachineHandle) {
        if self.is_quiet() {
            return;
        }
        let tool = sample.feedback.tool.unwrap_or(0);
        let length = self.lengths.iter().find(|(number, _)| *number == tool);
        let length = length.map_or(Length::ZERO, |(_, length)| *length);
        let below = self.zero - (sample.axis(2).of_linear() - length);
        let now = sample.feedback.time;
        for order in self.orders.due(sample, below) {
            self.happened.push(format!("operator at {:.3} s: {}", now.value(), name(order)));
            kernel.order(order);
        }
        for fault in self.faults.due(sample, below) {
            self.happened.push(format!("fault at {:.3} s: {}", now.value(), fault.name()));
            self.last = Some((fault.name().to_owned(), now));
            plant.strike(fault);
        }
    }

    /// Returns the faults that were to happen in a program that has come to its end after so long,
    /// and have not. An operator's orders that were never given are only said, for what they are
    /// for may be over before; so are faults after what ended the run before its program.
    pub fn not_triggered(&mut self, after: Time, is_at_end: bool) -> Vec<String> {
        let seconds = after.value();
        let sentence = |what: &str, text: &str| {
            if is_at_end {
                format!(
                    "{what} not triggered: {text}: the run was over after {seconds:.3} s without that moment"
                )
            } else {
                format!("{what} not reached: {text}: the run ended before it, at {seconds:.3} s")
            }
        };
        let orders: Vec<_> = self.orders.left().map(|text| sentence("order", text)).collect();
        let faults: Vec<_> = self.faults.left().map(|text| sentence("fault", text)).collect();
        self.happened.extend(orders);
        if is_at_end {
            return faults;
        }
        self.happened.extend(faults);
        Vec::new()
    }

    /// A run that has stopped: run down, and out of the thread if that is asked for. Whether the
    /// program goes on.
    ///
    /// # Errors
    /// A connection to the machine that is gone.
    pub fn deal_with(
        &mut self,
        kernel: &mut Kernel,
        plant: &mut dyn Drives,
        judge: &mut Judge,
        hear: Ears<'_>,
    ) -> Result<bool, String> {
        if plant.outlives_control() {
            // its drives and a recovery see to that
            self.happened.extend(left_to_recovery(kernel, plant));
            return Ok(false);
        }
        let Some(stored) = kernel.engaged() else {
            let recovers = self.recover.map(|_| self.settings.feed);
            let said = off::deal_with(kernel, plant, recovers, &mut |sample| {
                judge.sample(sample);
                hear(sample);
            })?;
            match said {
                Some(Ok(withdrawn)) => self.withdrawn.push(withdrawn),
                Some(Err(left)) => self.happened.push(left),
                None => {}
            }
            return Ok(false);
        };
        let line = kernel.report().line;
        let alarm = kernel.faults().first().map(|f| (f.kind.sentence().to_owned(), f.time));
        let (cause, time) =
            self.last.take().or(alarm).unwrap_or_else(|| ("a stop".into(), plant.feedback().time));
        let mut stop = Vec::new();
        let surface = kernel.surface().unwrap_or(stored.start().place);
        let work = TapInWork { stored, surface };
        let (mut stop_error, mut broken) = (Length::ZERO, None);
        run_down(kernel, plant, &mut |sample| {
            stop.push(point(sample));
            stop_error = stop_error.max(work.error(sample).unwrap_or_default());
            broken = broken.or_else(|| breaks(sample));
            judge.sample(sample);
            hear(sample);
        });
        let Some(after) = self.recover else {
            let left = left_in(line, plant, surface, "--recover");
            let is_out = || retracted(line, kernel);
            self.happened.extend(left.or_else(is_out));
            return Ok(false);
        };
        plant.mend();
        let plan = self.settings.plan(stored, surface, plant.feedback())?;
        let preferred = plan.way;
        let mut ways = Vec::new();
        if let Some(mut copy) = plant.copy() {
            let (mut kernel, mut judge) = (kernel.clone(), judge.clone());
            let other = if preferred == Way::Straight { preferred } else { Way::Direct };
            let plan = RecoveryPlan { way: other, ..plan };
            let track = drive_out(&mut kernel, &mut *copy, plan, surface, &mut |sample| {
                judge.sample(sample);
            });
            ways.extend(track.map(|track| way_back("the direct way", false, &track, &judge)));
        }
        let track = drive_out(kernel, plant, plan, surface, &mut |sample| {
            broken = broken.or_else(|| breaks(sample));
            judge.sample(sample);
            hear(sample);
        })?;
        ways.insert(0, way_back("unloaded first", true, &track, judge));
        let start = stored.start();
        self.threads.push(ThreadStop {
            line,
            cause,
            time,
            coupling: ((start.angle, start.place), stored.lead() * Angle::rev(1.0)),
            stop,
            stop_error,
            broken,
            ways,
        });
        Ok(after == AfterStop::Continue && broken.is_none())
    }
}

/// What is said of a tap that is not taken out.
fn left_in(line: u32, plant: &dyn Drives, surface: Length, by: &str) -> Option<String> {
    let depth = (surface - plant.feedback().axes[2].position.of_linear()).value();
    (depth > 0.0).then(|| {
        format!("line {line}: the tap was left {depth:.2} mm deep in its thread; {by} takes it out along it")
    })
}

/// What is said of a tap that supervision by torque has taken out.
fn retracted(line: u32, kernel: &Kernel) -> Option<String> {
    let by_torque = |fault: &kernel::Fault| {
        matches!(fault.kind, FaultKind::TapOverload | FaultKind::TapCutsNothing)
    };
    let is_out = kernel.faults().iter().any(by_torque) && !kernel.is_in_thread();
    is_out.then(|| format!("line {line}: the tap has come out along its thread"))
}

/// What is said of a tool that is left in the work of a machine simulator.
fn left_to_recovery(kernel: &Kernel, plant: &dyn Drives) -> Option<String> {
    let (line, by) = (kernel.report().line, "leadscrew recover");
    match (kernel.surface(), kernel.way_out()) {
        (Some(surface), _) => left_in(line, plant, surface, by),
        (None, Some(way_out)) => Some(off::left_in(line, way_out, by)),
        (None, None) => None,
    }
}

fn name(order: Order) -> String {
    match order {
        Order::FeedHold => "hold".into(),
        Order::Resume => "resume".into(),
        Order::Confirm => "confirm".into(),
        Order::Abort => "abort".into(),
        Order::Retract => "retract".into(),
        Order::FeedOverride(share) => format!("override {:.0} %", share * 100.0),
        Order::SpindleOverride(share) => format!("spindle override {:.0} %", share * 100.0),
        Order::RapidOverride(share) => format!("rapid override {:.0} %", share * 100.0),
        Order::SingleBlock(on) => format!("single block {}", if on { "on" } else { "off" }),
        Order::OptionalStop(on) => format!("optional stop {}", if on { "on" } else { "off" }),
        Order::Flood(on) => format!("flood {}", if on { "on" } else { "off" }),
        Order::Mist(on) => format!("mist {}", if on { "on" } else { "off" }),
    }
}

fn point(sample: &Sample) -> PlanePoint {
    (sample.spindle(0), sample.axis(2).of_linear())
}

/// A tap on its coupling, and where the work begins.
#[derive(Clone, Copy)]
struct TapInWork {
    stored: Stored,
    surface: Length,
}

impl TapInWork {
    /// Distance from the coupling, while the tip is in the work.
    fn error(&self, sample: &Sample) -> Option<Length> {
        let (angle, place) = point(sample);
        let inward = (self.stored.end().place - self.stored.start().place).value();
        let inside = (place - self.surface).value() * inward > 0.0;
        inside.then(|| self.stored.error(Point { angle, place }).abs())
    }
}

/// When the tool broke, if it is broken.
fn breaks(sample: &Sample) -> Option<Time> {
    sample.truth.as_ref().is_some_and(|truth| truth.tool_broken).then_some(sample.feedback.time)
}

/// One period without orders: the drives alone, or a control that has stopped.
fn one_period(kernel: &mut Kernel, plant: &mut dyn Drives) -> Sample {
    let mut seen = Sample::default();
    // what only looks breaks nothing off
    let _ = period(kernel, plant, |_, _, sample| {
        seen = *sample;
        ControlFlow::<()>::Continue(())
    });
    seen
}

/// Until nothing turns or moves.
fn run_down(kernel: &mut Kernel, plant: &mut dyn Drives, hear: Ears<'_>) {
    /// What stands, and for how many periods.
    const STANDS: (Spin, Coordinate, u32) = (Spin::rpm(1.0), Coordinate::new(2.5e-5), 200);
    let end = plant.feedback().time + RUN_DOWN;
    let (mut still, mut before) = (0, None);
    while plant.feedback().time < end && (still < STANDS.2 || kernel.is_retreating()) {
        let sample = one_period(kernel, plant);
        let (angle, places): (_, [Coordinate; bus::AXES]) =
            (sample.spindle(0), core::array::from_fn(|axis| sample.axis(axis)));
        let stands = before.replace((angle, places)).is_some_and(|(a, was)| {
            let moved = places.iter().zip(was).any(|(place, was)| (*place - was).abs() >= STANDS.1);
            ((angle - a) / plant.period()).abs() < STANDS.0 && !moved
        });
        still = if stands { still + 1 } else { 0 };
        hear(&sample);
    }
}

/// What a way out came to.
struct Track {
    points: Vec<PlanePoint>,
    mover: Option<Mover>,
    helix: Length,
    force_n: f64,
}

/// Take the tap out along its thread: by the control that stopped coupled and still has its drives,
/// or by a recovery.
fn drive_out(
    kernel: &mut Kernel,
    plant: &mut dyn Drives,
    plan: RecoveryPlan,
    surface: Length,
    hear: Ears<'_>,
) -> Result<Track, String> {
    let alive = kernel.can_back_out() && plant.feedback().axes[2].ready;
    while kernel.next_event().is_some() {} // what was said while everything ran down is no news
    let work = TapInWork { stored: plan.stored, surface };
    if alive {
        kernel.order(Order::Retract);
    } else {
        kernel.recover(plan);
    }
    let end = plant.feedback().time + recovery::LONGEST;
    let mut track = Track { points: Vec::new(), mover: None, helix: Length::ZERO, force_n: 0.0 };
    let (mut on, mut out) = (alive, None);
    while out.is_none() {
        if plant.feedback().time > end {
            return Err("the tap is not out after five minutes".into());
        }
        let sample = one_period(kernel, plant);
        let (angle, place) = point(&sample);
        track.points.push((angle, place));
        if let Some(truth) = &sample.truth {
            track.force_n = track.force_n.max(truth.cutting_force.value().abs());
        }
        if on {
            track.helix = track.helix.max(work.error(&sample).unwrap_or_default());
        }
        while let Some(event) = kernel.next_event() {
            match event.kind {
                EventKind::RecoveryBegun { mover, .. } => track.mover = mover,
                EventKind::OnCoupling => on = true,
                EventKind::RecoveryEnded(RecoveryFigures { .. })
                | EventKind::Operator(Notice::Out) => out = Some(()),
                EventKind::FaultRaised(fault) => return Err(fault.to_string()),
                _ => {}
            }
        }
        hear(&sample);
    }
    Ok(track)
}

fn way_back(name: &str, taken: bool, track: &Track, judge: &Judge) -> WayBack {
    let features = judge.clone().finish();
    let class = features.iter().rev().find_map(|f| match &f.kind {
        FeatureKind::Thread(thread) if thread.recovered => Some(match f.verdict.reason() {
            Some(reason) => format!("{}: {reason}", thread.class_name()),
            None => thread.class_name().to_owned(),
        }),
        _ => None,
    });
    WayBack {
        name: name.to_owned(),
        taken,
        track: track.points.clone(),
        mover: match track.mover {
            Some(Mover::Feed) => "the feed".into(),
            Some(Mover::Spindle) => "the spindle".into(),
            None => "neither".into(),
        },
        helix_error: track.helix,
        force_n: track.force_n,
        class: class.unwrap_or_else(|| "none".into()),
    }
}

/// For people: what happened, and what came of it.
pub fn text(stops: &[ThreadStop], happened: &[String], withdrawn: &[Withdrawn]) -> String {
    let mut said = String::new();
    for line in happened {
        said += line;
        said.push('\n');
    }
    for Withdrawn { line, cut, axis, by } in withdrawn {
        let by = by.value();
        said +=
            &format!("line {line}: {axis} took the tool {by:+.3} mm off the work, out of {cut}\n");
    }
    for stop in stops {
        let Some(way) = stop.ways.first() else { continue };
        let (line, cause, at) = (stop.line, &stop.cause, stop.time.value());
        let (rest, most) = (stop.rest_um().abs(), stop.stop_error.in_um());
        if let Some(broken) = stop.broken {
            said += &format!(
                "line {line}: {cause} at {at:.3} s: the tap broke at {:.3} s, up to {most:.1} µm off its helix; its shank was driven out, \
                 what is left of it is in the hole\n",
                broken.value()
            );
            continue;
        }
        said += &format!(
            "line {line}: {cause} at {at:.3} s left the tap {rest:.1} µm off its helix, {most:.1} µm at most in the stop; \
             recovered: {} went back, then out with at most {:.1} µm, damage index {:.2} µm·rev\n",
            way.mover,
            way.helix_error.in_um(),
            stop.damage_um_rev(way),
        );
    }
    said
}
