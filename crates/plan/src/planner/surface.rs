//! Constant surface speed (G96): what the kernel is told, and what cannot be done while it is in
//! force.
//!
//! ```text
//!   G96 ──► speed, limit, place of the work's axis ──► kernel: n by X, in every period
//!           tool or work offset changes: the place again
//! ```
//!
//! The axis of the work is where the program has its X zero, with the tool's offset, as on every
//! lathe. The spindle follows X in rapids too, and the first cut after one awaits its speed.
//!
//! A pass of a thread along Z turns at one speed, that of the X where it begins: the axes follow
//! the spindle's angle by what they know of its speed, and a speed that changes with X would leave
//! them behind by another way at each turn.
use super::{Job, Planner, SpindleState};
use crate::findings::number;
use crate::tap_check::whole_rpm;
use crate::{SpindleStep, Step, StepKind};
use alloc::{format, vec, vec::Vec};
use canon::{Axis, OpKind};
use diag::Diagnostic;
use motion::SurfaceSpeed;
use units::{Angle, Length, Speed, Spin, Torque};

/// The spindle whose speed goes by X.
const SPINDLE: usize = 0;
/// The axis of the work is known to so much, mm.
const SAME_AXIS: f64 = 1e-9;

impl Planner {
    /// G96.
    pub(super) fn surface_speed(
        &mut self,
        job: &mut Job,
        index: usize,
        speed: Speed,
        limit: Option<Spin>,
    ) {
        if !self.turns_work || index != SPINDLE {
            let text = "constant surface speed (G96) is for a spindle that turns the work, and this one turns the tool: give rpm with G97 S";
            let help = "on a lathe, lathe = true in the machine's file says that its first spindle turns the work";
            self.findings.add(Diagnostic::error("M0310", job.span, text).with_help(help));
            // what follows is judged as though it turned
            if let Some(state) = self.spindles.get_mut(index) {
                let highest = self.limits.spindles[index].reachable(Torque::ZERO);
                let spin = limit.map_or(highest, |limit| limit.abs().min(highest));
                state.order(if speed < Speed::ZERO { -spin } else { spin });
            }
            return;
        }
        if self.frame.rotation != Angle::ZERO {
            let text = "constant surface speed (G96) needs X across the work's axis, and the program's X is turned away from it";
            return self.findings.add(Diagnostic::error("M0310", job.span, text));
        }
        if !speed.is_finite()
            || limit.is_some_and(|limit| limit <= Spin::ZERO || !limit.is_finite())
        {
            let text = "G96 needs a surface speed and a limit above zero";
            return self.findings.add(Diagnostic::error("M0310", job.span, text));
        }
        if speed.value() == 0.0 {
            return self.spindle(job, index as u8, &canon::SpindleOrder::Stop);
        }
        let highest = self.limits.spindles[index].reachable(Torque::ZERO);
        if limit.is_none() {
            let text = format!(
                "G96 without a limit: near the work's axis the spindle turns at its highest speed, {} rpm",
                number(whole_rpm(highest)),
            );
            let help = "state what chuck and work bear: D in the block of G96, on a Fanuc lathe G50 S before it";
            self.findings.add_once(Diagnostic::warning("M0319", job.span, text).with_help(help));
        }
        let limit = limit.map_or(highest, |limit| limit.min(highest));
        if self.coupled.gear.is_some() {
            return self.refuse_surface(job, "what is geared to the spindle");
        }
        let surface = SurfaceSpeed { speed, limit, axis: self.work_axis() };
        if self.outbox.is_waiting() {
            self.tell_spindles(job);
        }
        self.warned_still = false;
        let x = self.position().linear[0];
        let state = &mut self.spindles[index];
        (state.surface, state.ordered) = (Some(surface), surface.at(x));
    }

    /// Where X has the tip on the axis of the work.
    fn work_axis(&self) -> Length {
        self.frame.origin.linear[0] + self.frame.tool.linear[0] + self.frame.added.linear[0]
    }

    /// Before an op: the axis of the work may lie elsewhere now, and some ops need revolutions per
    /// minute.
    pub(super) fn aim_surface(&mut self, job: &Job, kind: &OpKind) {
        let (axis, x, begins) =
            (self.work_axis(), self.position().linear[0], self.chain.is_empty());
        let Some(state) = self.spindles.get_mut(SPINDLE) else { return };
        for surface in [&mut state.surface, &mut state.held_surface].into_iter().flatten() {
            if (surface.axis - axis).abs().value() > SAME_AXIS {
                surface.axis = axis;
            }
        }
        let holds = match kind {
            OpKind::Threading(order) => order.axis != Axis::X,
            kind => matches!(kind, OpKind::Rapid { .. }),
        };
        match state.held_surface {
            Some(held) if !holds => {
                (state.held_surface, state.surface) = (None, Some(held));
                state.ordered = held.at(x);
            }
            Some(held) if begins && matches!(kind, OpKind::Threading(_)) => {
                state.ordered = held.at(x);
            }
            _ => {}
        }
        if state.surface.is_none() {
            return;
        }
        let what = match kind {
            OpKind::Threading(order) if order.axis != Axis::X => return self.hold_surface(job),
            OpKind::Threading(_) => "a thread on a face",
            OpKind::Tap(_) => "a tap",
            OpKind::Polygon(_) => "a polygon",
            OpKind::Hob(_) => "a gear",
            OpKind::Cam(_) => "a cam",
            _ => return,
        };
        self.refuse_surface(job, what);
    }

    /// The first pass of a thread: the speed that there is holds.
    fn hold_surface(&mut self, job: &Job) {
        let Some(state) = self.spindles.get_mut(SPINDLE) else { return };
        state.held_surface = state.surface.take();
        let rpm = number(whole_rpm(state.ordered.abs()));
        let text = format!(
            "a thread under constant surface speed (G96): this pass turns at S{rpm}, by the X where it begins, and a pass at another X at another speed"
        );
        let help = format!("G97 S{rpm} before it gives all passes one speed");
        self.findings.add_once(Diagnostic::warning("M0356", job.span, text).with_help(help));
    }

    fn refuse_surface(&mut self, job: &Job, what: &str) {
        let spindle = self.spindles.get(SPINDLE);
        let here = spindle.filter(|state| state.surface.is_some()).map(|state| state.ordered);
        let works = match here.map(|spin| whole_rpm(spin.abs())).filter(|rpm| *rpm > 0.0) {
            Some(rpm) => format!("G97 S{} before it, which is its speed at this X", number(rpm)),
            None => "G97 S… before it".into(),
        };
        let text = format!(
            "{what} needs a speed in revolutions per minute, but constant surface speed (G96) is in force: write {works}"
        );
        self.findings.add(Diagnostic::error("M0355", job.span, text));
        // what follows is judged as at the speed that there is
        if let Some(state) = self.spindles.get_mut(SPINDLE) {
            state.order(state.ordered);
        }
    }

    /// After an op: the speed that is in force where X is now. A rapid changes it, and the next cut
    /// waits for it.
    pub(super) fn follow_surface(&mut self, kind: &OpKind) {
        let x = self.position().linear[0];
        let Some(state) = self.spindles.get_mut(SPINDLE) else { return };
        if let Some(surface) = state.surface {
            state.ordered = surface.at(x);
        }
        if let Some(surface) = state.told_surface {
            let spin = surface.at(x);
            if matches!(kind, OpKind::Rapid { .. }) && spin != state.told {
                state.awaited = false;
            }
            state.told = spin;
        }
    }

    /// Steps that make a spindle turn by the place of X.
    pub(super) fn turn_by_surface(
        &mut self,
        job: &Job,
        index: usize,
        surface: SurfaceSpeed,
    ) -> Vec<Step> {
        let SpindleState { told, told_surface, ordered, .. } = self.spindles[index];
        if told_surface == Some(surface) {
            return Vec::new();
        }
        let ramp = self.told_ramp(&self.limits.spindles[index], told, ordered);
        let state = &mut self.spindles[index];
        (state.told, state.told_surface) = (ordered, Some(surface));
        (state.awaited, state.throwing) = (false, false);
        let order = SpindleStep::Surface { surface, ramp: ramp.into() };
        vec![job.step(StepKind::Spindle { spindle: index as u8, order })]
    }
}
