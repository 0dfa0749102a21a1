//! Polygon turning and hobbing: the order of gearing up and down.
//!
//! ```text
//!   G51.2   work spindle at speed ─► engage, locked ─► fade the oscillation in ─► cuts
//!   G51.4                   (turns go by, what runs the kernel looks and corrects), P times
//!   G50.2                       tool spindle at rest ◄─ release ◄─ fade it out ◄──┘
//!
//!   G81 T L Q P   hob at speed ─► engage the work, with Z as its second master ─► cuts ─► G80: release
//! ```
use super::{Job, Planner};
use crate::StepKind;
use crate::coupled::{OSCILLATION_SEEN, Table, rates, sampled};
use crate::findings::number;
use crate::limits::AxisLimits;
use crate::tap_check::whole_rpm;
use crate::way_out::along_x;
use alloc::{format, vec::Vec};
use canon::{Axis, Hob, Oscillating, Polygon};
use diag::Diagnostic;
use motion::{GearStep, Superpose, Superposed, TableId, TiedCut};
use units::{Angle, Spin};

/// Turns of the work spindle over which an oscillation fades in and out.
const FADE: Angle = Angle::rev(2.0);
/// Periods of the gear over which an oscillation is measured.
const LOOK: Angle = Angle::rev(6.0);

/// What is coupled at present.
#[derive(Clone, Debug, Default)]
pub(super) struct Coupled {
    pub(super) gear: Option<GearStep>,
    /// The gear is that of a hob.
    hobbing: bool,
    /// Turns of its master after which it passes the same facets again.
    period: f64,
    superposed: Vec<Superposed>,
    /// Axes that swing, and their speed, acceleration and jerk at one turn of the work a second.
    swings: Vec<(usize, [f64; 3])>,
    /// The fastest that the work was told to turn meanwhile.
    fastest: Spin,
    /// What the axes can do when nothing swings.
    whole: Option<[Option<AxisLimits>; 9]>,
}

/// Who follows whom, for people.
#[derive(Clone, Copy, Debug)]
enum Geared {
    /// The tool spindle the work spindle, for a polygon.
    Tool,
    /// The work the hob.
    Work,
}

impl Geared {
    const fn words(self) -> (&'static str, [&'static str; 2]) {
        match self {
            Self::Tool => ("M0404", ["the work spindle", "the tool spindle"]),
            Self::Work => ("M0433", ["the hob", "the work"]),
        }
    }
}

impl Planner {
    pub(super) fn polygon(&mut self, job: &mut Job, polygon: &Polygon) {
        if self.polygon_is_refused(job, polygon) {
            return;
        }
        if self.coupled.gear.is_some() {
            self.polygon_end(job);
        }
        self.tell_spindles(job);
        self.await_spindles(job);
        let gear = GearStep {
            follower: polygon.tool,
            master: polygon.work,
            ratio: polygon.ratio,
            axis: None,
            phase: polygon.phase,
        };
        self.hand_on(job, StepKind::Engage(gear));
        (self.coupled.gear, self.coupled.hobbing) = (Some(gear), false);
        self.coupled.period = polygon.period();
        for oscillation in &polygon.oscillations {
            let on = match oscillation.on {
                Oscillating::Axis(axis) => Superposed::Axis(axis),
                Oscillating::ToolPhase => Superposed::Spindle(polygon.tool),
            };
            let id = self.next_table();
            let nodes = sampled(&polygon.by_work(&oscillation.harmonics));
            self.tables.push(Table { id, nodes });
            let turns = polygon.period();
            let order = Superpose { on, master: polygon.work, table: Some(id), turns, over: FADE };
            self.hand_on(job, StepKind::Superpose(order));
            self.coupled.superposed.push(on);
            if let Oscillating::Axis(axis) = oscillation.on {
                let [speed, accel, jerk] = rates(&oscillation.harmonics);
                let n = turns;
                let by_turn = [speed / n, accel / (n * n), jerk / (n * n * n)];
                self.coupled.swings.push((axis.index(), by_turn));
            }
        }
        if !self.coupled.superposed.is_empty() {
            self.hand_on(job, StepKind::AwaitFades);
        }
        self.enter_geared(job, TiedCut::Polygon, polygon.work);
        let work = self.spindles.get(usize::from(polygon.work)).map_or(Spin::ZERO, |s| s.ordered);
        self.spare(work);
    }

    /// From here on the tool may be in the work. It was geared up where it stands, so there it is
    /// clear.
    fn enter_geared(&mut self, job: &mut Job, cut: TiedCut, master: u8) {
        let way_out = along_x(cut, master, self.position().linear[0]);
        self.hand_on(job, StepKind::WayOut(Some(way_out)));
    }

    /// A spindle is told a speed: what is geared to it and what swings with it goes along.
    pub(super) fn go_along(&mut self, job: &Job, spindle: usize, spin: Spin) {
        let Some(gear) = self.coupled.gear.filter(|gear| usize::from(gear.master) == spindle)
        else {
            return;
        };
        if let Some(most) =
            self.limits.spindles.get(usize::from(gear.follower)).map(|s| s.max_speed)
        {
            let who = if self.coupled.hobbing { Geared::Work } else { Geared::Tool };
            self.check_speed(job, who, gear.ratio.value().abs(), spin, most);
        }
        self.spare(spin);
    }

    /// Moves of an axis that swings get what the swing leaves of its limits, with the work at this
    /// speed or a slower one.
    fn spare(&mut self, spin: Spin) {
        self.coupled.fastest = self.coupled.fastest.max(spin.abs());
        let n = self.coupled.fastest.value();
        let whole = *self.coupled.whole.get_or_insert(self.limits.axes);
        for (index, [speed, accel, jerk]) in &self.coupled.swings {
            let swing = [speed * n, accel * n * n, jerk * n * n * n];
            self.limits.axes[*index] = whole[*index].map(|axis| axis.beside(swing));
        }
    }

    pub(super) fn polygon_end(&mut self, job: &mut Job) {
        let Some(gear) = self.coupled.gear.take() else { return };
        self.hob_ends();
        self.hand_on(job, StepKind::WayOut(None));
        let superposed = core::mem::take(&mut self.coupled.superposed);
        for on in superposed.iter().copied() {
            let order = Superpose { on, master: gear.master, table: None, turns: 1.0, over: FADE };
            self.hand_on(job, StepKind::Superpose(order));
        }
        if !superposed.is_empty() {
            self.hand_on(job, StepKind::AwaitFades);
        }
        self.hand_on(job, StepKind::Release { follower: gear.follower });
        if let Some(whole) = self.coupled.whole.take() {
            self.limits.axes = whole;
        }
        self.coupled.swings.clear();
        self.coupled.fastest = Spin::ZERO;
        self.free_geared_override(job);
    }

    /// Let it swing while it is looked at, so many times.
    pub(super) fn polygon_measure(&mut self, job: &mut Job, looks: u32) {
        let Some(gear) = self.coupled.gear else { return };
        if self.coupled.superposed.is_empty() {
            let text = "nothing swings, so there is nothing to measure: G51.4 measures what I, J, K or D of G51.2, or G51.3, let swing";
            return self.findings.add(Diagnostic::error("M0405", job.span, text));
        }
        for _ in 0..looks {
            self.hand_on(
                job,
                StepKind::Revolve { spindle: gear.master, turns: LOOK * self.coupled.period },
            );
            self.hand_on(job, StepKind::Consult(OSCILLATION_SEEN));
        }
    }

    pub(super) fn hob(&mut self, job: &mut Job, hob: &Hob) {
        if self.hob_is_refused(job, hob) {
            return;
        }
        self.polygon_end(job);
        let turning = self.spindles.get(usize::from(hob.hob)).map_or(Spin::ZERO, |s| s.ordered);
        self.hob_begins(job, hob, turning);
        self.tell_spindles(job);
        self.await_spindles(job);
        // a right-hand helix: the section at a greater Z is turned forward, so the work belongs
        // behind
        let gear = GearStep {
            follower: hob.work,
            master: hob.hob,
            ratio: hob.ratio(),
            axis: hob.lead().map(|lead| (Axis::Z, lead * -1.0)),
            phase: Angle::ZERO,
        };
        self.hand_on(job, StepKind::Engage(gear));
        (self.coupled.gear, self.coupled.hobbing) = (Some(gear), true);
        self.enter_geared(job, TiedCut::Gear, hob.hob);
    }

    fn hob_is_refused(&mut self, job: &Job, hob: &Hob) -> bool {
        let before = self.findings.len();
        let most = self.limits.spindles.get(usize::from(hob.work)).map(|s| s.max_speed);
        let turning = self.spindles.get(usize::from(hob.hob)).map(|s| s.ordered);
        let (Some(most), Some(turning)) = (most, turning) else {
            let text = format!(
                "hobbing needs a hob's spindle and a work spindle, and the machine has {} spindle(s)",
                self.limits.spindles.len()
            );
            self.findings.add(Diagnostic::error("M0431", job.span, text));
            return true;
        };
        if turning == Spin::ZERO {
            let text =
                "the hob stands, and the work shall follow it: order M3 S… before G81 T L Q P";
            self.findings.add(Diagnostic::error("M0432", job.span, text));
        }
        let ratio = hob.ratio().value().abs();
        self.check_speed(job, Geared::Work, ratio, turning, most);
        self.findings.len() > before
    }

    /// The next free table's name.
    pub(super) const fn next_table(&mut self) -> TableId {
        self.next_table = self.next_table.wrapping_add(1);
        TableId(self.next_table)
    }

    fn polygon_is_refused(&mut self, job: &Job, polygon: &Polygon) -> bool {
        let before = self.findings.len();
        let most = self.limits.spindles.get(usize::from(polygon.tool)).map(|s| s.max_speed);
        let work = self.spindles.get(usize::from(polygon.work)).map(|s| s.ordered);
        match (work, most) {
            (Some(work), Some(most)) if polygon.work != polygon.tool => {
                self.check_gear(job, polygon, work, most);
            }
            _ => {
                let count = self.limits.spindles.len();
                let text = format!(
                    "polygon turning needs a work spindle and a tool spindle, and the machine has {count} spindle(s)"
                );
                self.findings.add(Diagnostic::error("M0401", job.span, text));
            }
        }
        self.findings.len() > before
    }

    fn check_gear(&mut self, job: &Job, polygon: &Polygon, work: Spin, most: Spin) {
        if polygon.ratio.master <= 0 || polygon.ratio.follower == 0 {
            let text = format!(
                "expected a ratio of whole numbers above zero, found P{} Q{}: P1 Q2 cuts a square with two inserts",
                polygon.ratio.master, polygon.ratio.follower
            );
            self.findings.add(Diagnostic::error("M0402", job.span, text));
            return;
        }
        if work == Spin::ZERO {
            let text = "the work spindle stands, and the tool spindle shall follow it: order M3 S… before G51.2";
            self.findings.add(Diagnostic::error("M0403", job.span, text));
            return;
        }
        self.check_speed(job, Geared::Tool, polygon.ratio.value().abs(), work, most);
    }

    /// Whether the spindle that follows can turn so many times as fast.
    fn check_speed(&mut self, job: &Job, who: Geared, ratio: f64, master: Spin, most: Spin) {
        if master.abs().value() * ratio <= most.value() * (1.0 + 1e-9) {
            return;
        }
        let works = Spin::rev_per_s(most.value() / ratio);
        let (code, [leads, follows]) = who.words();
        let text = format!(
            "S{} of {leads} needs {} rpm of {follows}, whose highest is {}: S{} works",
            number(master.abs().in_rpm()),
            number(master.abs().in_rpm() * ratio),
            number(most.in_rpm()),
            number(whole_rpm(works)),
        );
        self.findings.add(Diagnostic::error(code, job.span, text));
    }
}
