//! The tap in work, as others have to know it: what is coupled, what is written down of it, and the
//! way out of the work after everything has stopped.
use super::{Kernel, Mode};
use crate::encoder_plausibility::EncoderPlausibility;
use crate::execute::Activity;
use crate::operator::Operator;
use crate::queue::{Step, StepKind};
use crate::record_requests::WorkRecord;
use crate::recovering::{Recovering, RecoveryPlan};
use crate::spindle::SpindleLoop;
use bus::State;
use sync::{Coupling, SyncMode};

/// A stroke that ends at the surface, as near as its coordinates were computed, ends outside, mm.
const AT_SURFACE_MM: f64 = 1e-3;

impl Kernel {
    /// Take a tool out of the work, and do nothing else: what waited is forgotten, what stopped the
    /// machine before has had its answer. The drives come up, each where it stands.
    pub fn recover(&mut self, plan: RecoveryPlan) {
        self.begin_anew();
        self.recovering = Some(Recovering::new(plan, self.now));
    }

    /// A tool is being taken out of the work by [`Self::recover`].
    pub const fn is_recovering(&self) -> bool {
        self.recovering.is_some()
    }

    /// Forget what there was.
    pub(super) fn begin_anew(&mut self) {
        self.queue.clear();
        self.manual.forget();
        self.homing.abandon(&mut self.drives.axes);
        self.faults.clear();
        self.drives.supervision.forget_retract(); // an alarm that is cleared orders nothing more
        (self.answer, self.drives.outputs) = (None, bus::Signals::default());
        self.drives.guard = crate::sequence_steps::Guard::default();
        (self.activity, self.begun, self.mode) = (Activity::Idle, false, Mode::New);
        (self.operator, self.aborted, self.reported) =
            (Operator::new(self.config.overrides), false, None);
        (self.plausibility, self.drive_lost) =
            (EncoderPlausibility::new(&self.drives.axes, self.config.period.value()), None);
        (self.chained, self.way_out, self.retreating) = (0, None, None);
        (self.recovering, self.withdrawing) = (None, None);
        self.report.state = State::Idle;
    }

    /// After a recovery: execute steps again, from where everything stands.
    pub fn go_on(&mut self) {
        if self.recovering.take_if(|recovering| recovering.is_done()).is_some() {
            self.operator = Operator::new(self.config.overrides);
        }
    }

    /// The coupling of the tap that is in work, from where the tap is clear of the work to where it
    /// turns back, with the sense in which it goes; `None` while none is engaged. What a recovery
    /// has to know if everything stops now.
    pub fn engaged(&self) -> Option<sync::recovery::Stored> {
        match (&self.activity, self.queue.front()) {
            (Activity::Tapping(run), Some(Step { kind: StepKind::Tap(plan), .. })) => {
                run.stored(plan)
            }
            _ => None,
        }
    }

    /// Where the tap that is in work touches the work, as a coordinate of its axis.
    pub fn surface(&self) -> Option<units::Length> {
        let taps = matches!(self.activity, Activity::Tapping(_));
        self.queue.tap(0).filter(|_| taps).map(|plan| plan.surface)
    }

    /// What is coupled at present: axis, spindle, and how.
    pub(super) fn coupled(&self) -> Option<(usize, usize, Coupling)> {
        let Activity::Tapping(run) = &self.activity else { return None };
        let plan = self.queue.tap(0)?;
        Some((plan.axis.index(), usize::from(plan.spindle), run.coupling()?))
    }

    /// What the drives shall keep together, should they be left alone: the coupling's tangent.
    pub(super) fn kept_together(&self) -> Option<bus::Coupled> {
        if let Some(on_thread) = self.on_thread() {
            return Some(on_thread);
        }
        let (axis, spindle, coupling) = match (&self.mode, &self.recovering) {
            (Mode::Running | Mode::Halted, None) => self.coupled()?,
            (Mode::Running, Some(recovering)) => recovering.coupled()?,
            (Mode::Halted | Mode::New | Mode::Starting(_) | Mode::Disabled, _) => return None,
        };
        let angle = self.drives.spindles[spindle].as_ref()?.reading();
        Some(bus::Coupled {
            axis: axis as u8,
            spindle: spindle as u8,
            angle,
            place: coupling.position(angle),
            lead: coupling.slope(angle),
        })
    }

    /// While the axes are on their way to a tap and its spindle stands already: ask for its record
    /// now.
    pub(super) fn foresee(&mut self) {
        let following = self.config.synchronisation != SyncMode::CommandSynchronised;
        let travels = matches!(self.activity, Activity::Moving(..) | Activity::Settling { .. });
        if !self.drives.record_requests.is_on() || following || !travels {
            return;
        }
        let mut steps = self.queue.iter().skip(1);
        let next = steps.find(|step| !matches!(step.kind, StepKind::Move(_)));
        let Some(Step { op, line, kind: StepKind::Tap(plan) }) = next else { return };
        let spindle = self.drives.spindles.get(usize::from(plan.spindle)).and_then(Option::as_ref);
        // one that only stands will be turned to the start angle by the shorter way
        let stands =
            |s: &SpindleLoop| (s.at_rest() && plan.start_angle.is_some()).then(|| s.now().angle);
        let Some(held) = spindle.and_then(|s| s.held().or_else(|| stands(s))) else { return };
        let turns = plan.start_angle.map_or(0.0, |angle| (angle - held).value());
        let theta0 = held + units::Angle::rev(turns - libm::round(turns));
        let record = WorkRecord::of(plan, op, line, self.drives.tool, theta0);
        self.drives.record_requests.ask(&record);
    }

    /// The tap at the queue's front is done: out of its hole, unless the next stroke goes on in it.
    pub(super) fn leave_hole(&mut self) {
        let Some(Step { op, kind: StepKind::Tap(plan), .. }) = self.queue.front() else {
            return;
        };
        let goes_on = self
            .queue
            .get(1)
            .is_some_and(|next| next.op == op && matches!(next.kind, StepKind::Tap(_)));
        let inward = (plan.bottom - plan.surface).value();
        let inside = (plan.end - plan.surface).value() * libm::copysign(1.0, inward);
        let is_outside = inside <= AT_SURFACE_MM;
        if is_outside && !goes_on {
            self.drives.record_requests.out();
        }
    }
}
