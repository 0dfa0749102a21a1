//! The operator's spindle override: where the program lets it act (M48, M49, M51), and what needs
//! the programmed speed.
//!
//! ```text
//!   M51 P1, a cut        a thread, a gear, a tap that is not tied       the next cut
//!   it acts ───────────► locked: the programmed speed, awaited ───────► it acts
//! ```
//!
//! A synchronised tap leads its spindle itself and needs no lock. A turned thread that was begun at
//! another speed would have its run-in elsewhere, a gear's oscillation was computed for its speed,
//! and a feed that is only as fast as S says needs S. Between the passes of a thread it stays
//! locked, as on Fanuc's and Siemens' controls.
use super::{Job, Planner};
use crate::StepKind;
use crate::limits::TapMethod;
use canon::{Holder, OpKind, ToolKind};

/// Whether it acts.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_excessive_bools)] // independent reasons: any of them may hold with any other
pub(super) struct SpindleOverride {
    /// The program lets it.
    allowed: bool,
    /// A spindle is geared to another one.
    geared: bool,
    /// A cut that needs the programmed speed, or a rapid between two of them.
    cuts: bool,
    /// What the kernel has been told.
    told: bool,
}

impl Default for SpindleOverride {
    fn default() -> Self {
        Self { allowed: true, geared: false, cuts: false, told: true }
    }
}

impl Planner {
    /// An op comes: lock the override before what needs the programmed speed, and free it after.
    pub(super) fn lock_spindle_override(&mut self, job: &mut Job, kind: &OpKind) {
        let needs = self.needs_programmed_speed(kind);
        let state = &mut self.spindle_override;
        match kind {
            OpKind::Polygon(_) | OpKind::Hob(_) => state.geared = true,
            OpKind::End => state.geared = false,
            _ => {}
        }
        if needs {
            state.cuts = true;
        } else if frees(kind) {
            state.cuts = false;
        }
        self.tell_spindle_override(job);
    }

    /// The gear is released: what was locked for it is free.
    pub(super) fn free_geared_override(&mut self, job: &mut Job) {
        self.spindle_override.geared = false;
        self.tell_spindle_override(job);
    }

    /// M48, M49, M51.
    pub(super) fn allow_spindle_override(&mut self, job: &mut Job, allowed: bool) {
        self.spindle_override.allowed = allowed;
        self.tell_spindle_override(job);
    }

    fn tell_spindle_override(&mut self, job: &mut Job) {
        let SpindleOverride { allowed, geared, cuts, told } = self.spindle_override;
        let acts = allowed && !geared && !cuts;
        if acts == told {
            return;
        }
        self.spindle_override.told = acts;
        let step = StepKind::SpindleOverride(acts);
        if acts {
            let step = job.step(step);
            self.after_spindle(job, step);
        } else {
            // what needs the speed needs the spindle: it runs up beside the rapids that wait
            self.tell_spindles(job);
            self.hand_on(job, step);
        }
    }

    fn needs_programmed_speed(&self, kind: &OpKind) -> bool {
        match kind {
            OpKind::Threading(_) | OpKind::Cam(_) => true,
            OpKind::Tap(_) => {
                let clutch = self.tools.get(self.tool).is_some_and(|tool| match &tool.kind {
                    ToolKind::Tap(tap) => matches!(tap.holder, Holder::Clutch { .. }),
                    _ => false,
                });
                clutch || self.options.taps.method == TapMethod::Floating
            }
            _ => false,
        }
    }
}

/// What comes between two passes, and what moves nothing, keeps the lock.
const fn frees(kind: &OpKind) -> bool {
    !matches!(
        kind,
        OpKind::Rapid { .. }
            | OpKind::Dwell { .. }
            | OpKind::Coolant { .. }
            | OpKind::SelectTool { .. }
            | OpKind::PathMode(_)
            | OpKind::Overrides { .. }
            | OpKind::Message(_)
    )
}
