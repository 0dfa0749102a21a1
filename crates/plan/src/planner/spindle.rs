//! Spindle orders: when they are told, when they are awaited.
//!
//! ```text
//!   program:  M3 S1000      rapid        cut            M3 in force
//!   kernel:   turn ───────► rapid ─────► await ► cut    told early, awaited late
//! ```
//!
//! `ordered` is what the program has in force, `told` what the kernel has been told. While the two
//! differ, rapids wait in the outbox, because only the op after them shows whether the spindle
//! shall turn (a cut) or stand still (a tap). A ramp is planned from `told`, so a change of speed
//! begins when the one before is reached. While chips are thrown off (see the `chips` module)
//! rapids wait for nothing.
use super::{Job, Planner, SpindleState};
use crate::findings::number;
use crate::tap_check::whole_rpm;
use crate::{SpindleStep, Step, StepKind};
use alloc::{format, vec::Vec};
use canon::SpindleOrder;
use diag::Diagnostic;
use units::{Spin, Torque};

impl Planner {
    /// Blocks that were typed are done when what they say of the spindles is done; the spindles
    /// turn on.
    pub(super) fn end_typed(&mut self, job: &mut Job) {
        self.tell_spindles(job);
        self.await_spindles(job);
        self.hand_on(job, StepKind::End);
    }

    /// The spindles turn already at these speeds, as something before has ordered.
    #[must_use]
    pub fn already_turning(mut self, spins: &[Spin]) -> Self {
        for (state, spin) in self.spindles.iter_mut().zip(spins) {
            (state.ordered, state.told) = (*spin, *spin);
        }
        self
    }

    pub(super) fn spindle(&mut self, job: &mut Job, index: u8, order: &SpindleOrder) {
        let Some(limits) = self.limits.spindles.get(usize::from(index)).copied() else {
            let count = self.spindles.len();
            let text = format!(
                "the machine has {count} spindle(s), found an order for spindle {index}, counted from 0"
            );
            self.findings.add(Diagnostic::error("M0313", job.span, text));
            return;
        };
        let spin = match order {
            SpindleOrder::Stop => Spin::ZERO,
            SpindleOrder::Turn(spin) => *spin,
            SpindleOrder::Orient { .. }
                if self.limits.tapping.own_ramps.is_some_and(|own| !own.orients) =>
            {
                let text = "expected M3, M4 or M5: the drive of this spindle is only told a speed, and cannot stop at an angle";
                let help = "a drive that orients the spindle by itself is told the angle: `orients = true` under [spindles.drive]";
                let found = Diagnostic::error("M0337", job.span, text).with_help(help);
                return self.findings.add(found);
            }
            SpindleOrder::Orient { to, longest } => {
                self.rest(job, usize::from(index));
                // what was in force before turns it no more
                self.spindles[usize::from(index)].order(Spin::ZERO);
                let order = SpindleStep::Orient { to: *to, longest: *longest };
                return self.hand_on(job, StepKind::Spindle { spindle: index, order });
            }
            SpindleOrder::ThrowChips(chips) => {
                return self.throw_chips(job, usize::from(index), chips);
            }
            SpindleOrder::ConstantSurfaceSpeed { speed, limit } => {
                return self.surface_speed(job, usize::from(index), *speed, *limit);
            }
        };
        let highest = limits.reachable(units::Torque::ZERO);
        let bounded = spin.abs().min(highest);
        if spin.abs().value() > highest.value() * (1.0 + 1e-9) || !spin.is_finite() {
            let text = format!(
                "S{} is above the spindle's highest speed: S{} works",
                number(spin.abs().in_rpm()),
                number(whole_rpm(highest)),
            );
            self.findings.add(Diagnostic::error("M0308", job.span, text));
        }
        self.go_along(job, usize::from(index), bounded);
        if self.is_throwing() {
            // what was in force is not told: only rapids came since
            self.outbox.release([], &self.limits, job.emit);
        } else if self.outbox.is_waiting() {
            self.tell_spindles(job);
        }
        self.warned_still = false;
        self.spindles[usize::from(index)].order(if spin < Spin::ZERO { -bounded } else { bounded });
    }

    /// Whether chips are being thrown off, and no step has waited for the end of it.
    fn is_throwing(&self) -> bool {
        self.spindles.iter().any(|state| state.throwing)
    }

    /// Remember where the drives are hottest, for what is said in the end.
    pub(super) fn feel_heat(&mut self, span: diag::Span) {
        let overloads = self.outbox.heat.overloads(&self.limits);
        for (most, torque) in self.hottest.iter_mut().zip(overloads) {
            if let Some(torque) = torque.filter(|torque| *torque > most.0) {
                *most = (torque, span);
            }
        }
    }

    /// Say which drives the program asks for more than they can give for ever.
    pub(super) fn say_heat(&mut self) {
        for (index, (torque, span)) in self.hottest.iter().enumerate() {
            let Some(limits) = self.limits.spindles.get(index).filter(|_| *torque > Torque::ZERO)
            else {
                continue;
            };
            let (has, asked) = (limits.continuous_torque.value(), torque.value());
            let longer = ((asked / has) * (asked / has) - 1.0) * 100.0;
            let text = format!(
                "the drive of spindle {index} is asked for {} N·m, the root of the mean square over {} s: {} N·m is what it can give for ever",
                number(asked),
                number(limits.thermal_time.value()),
                number(has),
            );
            let help = format!(
                "what comes before this takes {longer:.0} % longer at least on a drive that protects itself: a gentler tapping preset, a lower \
                 S or pauses of as much keep it cool"
            );
            self.findings.add(Diagnostic::warning("M0318", *span, text).with_help(help));
        }
        self.hottest = Default::default();
    }

    /// Whether an order has not reached the kernel yet.
    pub(super) fn is_open(&self) -> bool {
        self.spindles.iter().any(SpindleState::is_open)
    }

    /// A step that may go with a spindle order still open: waits behind it.
    pub(super) fn after_spindle(&mut self, job: &mut Job, step: Step) {
        self.outbox.end_run(&self.limits, job.emit);
        if self.is_open() {
            if self.outbox.is_full() {
                self.tell_spindles(job);
            }
            self.outbox.wait(step);
        } else {
            self.outbox.release([], &self.limits, job.emit);
            self.outbox.hand_on(step, &self.limits, job.emit);
        }
    }

    /// Tell the kernel the speeds that are in force, ahead of the rapids that waited.
    pub(super) fn tell_spindles(&mut self, job: &mut Job) {
        if self.is_throwing() {
            // chips fly off while the axes travel: a ramp after that is awaited where the travel
            // ends, not at R
            self.outbox.release([], &self.limits, job.emit);
        }
        let mut steps = Vec::new();
        for index in 0..self.spindles.len() {
            let SpindleState { ordered, surface, .. } = self.spindles[index];
            steps.extend(match surface {
                Some(surface) => self.turn_by_surface(job, index, surface),
                None => self.turn(job, index, ordered),
            });
        }
        if !steps.is_empty() || self.outbox.is_waiting() {
            self.outbox.release(steps, &self.limits, job.emit);
        }
    }

    /// Steps that make a spindle turn at a speed. A ramp begins where the one before has ended, so
    /// that one is awaited.
    pub(super) fn turn(&mut self, job: &Job, index: usize, spin: Spin) -> Vec<Step> {
        let SpindleState { told, told_surface, .. } = self.spindles[index];
        let differs = told != spin || told_surface.is_some();
        let ramp = differs.then(|| self.told_ramp(&self.limits.spindles[index], told, spin));
        let state = &mut self.spindles[index];
        let mut steps = Vec::new();
        if let Some(ramp) = ramp {
            let spindle = index as u8; // as many spindles as a machine file can name
            if !state.awaited {
                steps.push(job.step(StepKind::Spindle { spindle, order: SpindleStep::AwaitSpeed }));
            }
            steps.push(job.step(StepKind::Spindle {
                spindle,
                order: SpindleStep::Turn { spin, ramp: ramp.into() },
            }));
            *state = SpindleState {
                told: spin,
                awaited: false,
                throwing: false,
                told_surface: None,
                ..*state
            };
        }
        steps
    }

    pub(super) fn await_spindles(&mut self, job: &mut Job) {
        for index in 0..self.spindles.len() {
            if !self.spindles[index].awaited {
                self.spindles[index].awaited = true;
                self.spindles[index].throwing = false;
                let (spindle, order) = (index as u8, SpindleStep::AwaitSpeed);
                self.hand_on(job, StepKind::Spindle { spindle, order });
            }
        }
    }

    /// Bring a spindle to rest and wait for it; the order in force stays open.
    pub(super) fn rest(&mut self, job: &mut Job, index: usize) {
        let steps = self.turn(job, index, Spin::ZERO);
        self.outbox.release(steps, &self.limits, job.emit);
        self.await_spindles(job);
    }
}
