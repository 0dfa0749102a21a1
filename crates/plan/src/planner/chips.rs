//! Chip removal on the way to the next hole: two ramps, and where they begin.
//!
//! ```text
//!   n │ told ╲                   ╱ then        t_chip = 2(S+U)/A after drilling, 2U/A after a tap,
//!     │        ╲               ╱               with a constant acceleration A
//!   0 ├──────────╲───────────╱───── t
//!     │            ╲_______╱
//!     │           −U reached: turned round at once
//! ```
//!
//! Both ramps use the torque and power curve. The order goes ahead of the rapid out of the hole,
//! and the kernel obeys it when the axis passes the R plane; the next cut or tap awaits the spindle
//! as after any other order.
use super::{Job, Planner, SpindleState};
use crate::findings::number;
use crate::tap_check::whole_rpm;
use crate::{SpindleStep, StepKind};
use alloc::boxed::Box;
use alloc::format;
use canon::ChipRemoval;
use diag::Diagnostic;
use motion::{ChipThrow, coordinate};
use units::{Spin, Torque};

impl Planner {
    pub(super) fn throw_chips(&mut self, job: &mut Job, index: usize, chips: &ChipRemoval) {
        let (limits, state) = (self.limits.spindles[index], self.spindles[index]);
        let highest = limits.reachable(Torque::ZERO);
        let sound = chips.throw.is_finite() && chips.then.is_finite() && chips.level.is_finite();
        let fastest = chips.throw.abs().max(chips.then.abs());
        if !sound || fastest.value() > highest.value() * (1.0 + 1e-9) {
            let text = format!(
                "chips would be thrown off at S{}, which the spindle does not reach: S{} works",
                number(fastest.in_rpm()),
                number(whole_rpm(highest)),
            );
            return self.findings.add(Diagnostic::error("M0350", job.span, text));
        }
        if chips.throw.value() * state.told.value() > 0.0 || chips.throw == Spin::ZERO {
            let text = format!(
                "chips are thrown off against the cut: S{} is not against S{}",
                number(chips.throw.in_rpm()),
                number(state.told.in_rpm()),
            );
            return self.findings.add(Diagnostic::error("M0351", job.span, text));
        }
        let here = coordinate(&self.position(), chips.axis);
        let order = SpindleStep::Throw(Box::new(ChipThrow {
            throw: chips.throw,
            against: limits.ramp(state.told, chips.throw),
            then: chips.then,
            back: limits.ramp(chips.throw, chips.then),
            axis: chips.axis,
            level: chips.level,
            upwards: chips.level.value() >= here,
        }));
        self.outbox.release([], &self.limits, job.emit);
        self.await_spindles(job); // a ramp begins where the one before has ended
        self.hand_on(job, StepKind::Spindle { spindle: index as u8, order });
        self.spindles[index] =
            SpindleState { told: chips.then, awaited: false, throwing: true, ..state };
    }
}
