//! Drives that the control has switched off while they move.
//!
//! ```text
//!   enable │‾‾‾‾‾‾‾|____________        a drive whose enable goes brakes by itself and is off when it stands
//!   speed  │‾‾‾‾‾‾‾‾\___                (CiA 402, 605Ch: slow down on a ramp, then disable)
//! ```
//!
//! What a drive can do then is what it does when the control falls silent
//! ([`LeftAlone::on_silence`]): where that is nothing, or coasting, it is that here. All drives
//! that go off at once stop as they do without a control, coupled ones together; one that goes off
//! alone stops alone.
use super::LeftAlone;
use crate::RunDown;
use bus::{AXES, Command, DriveReaction, Feedback, SPINDLES};

/// A drive that moves by less in a period stands, and is off at once: mm or degrees, rev.
const STILL: (f64, f64) = (1e-4, 1e-5);

/// The drives that stop by themselves.
#[derive(Clone, Debug, Default)]
pub(super) struct SwitchedOff {
    stop: Option<RunDown>,
    axes: [bool; AXES],
    spindles: [bool; SPINDLES],
    before: Option<Feedback>,
}

impl SwitchedOff {
    /// The command with what the drives do that it switches off; `last` is the one before it.
    /// `None`: it switches off nothing that moves.
    pub(super) fn command(
        &mut self,
        alone: &LeftAlone,
        (last, command): (&Command, &Command),
        now: &Feedback,
    ) -> Option<Command> {
        let before = self.before.replace(*now).unwrap_or(*now);
        let mut newly = false;
        for (index, off) in self.axes.iter_mut().enumerate() {
            let way = now.axes[index].position - before.axes[index].position;
            let moves = way.value().abs() > STILL.0;
            let goes = last.axes[index].enable && !command.axes[index].enable && moves;
            newly |= goes;
            *off = !command.axes[index].enable && (*off || goes);
        }
        for (index, off) in self.spindles.iter_mut().enumerate() {
            let way = now.spindles[index].angle - before.spindles[index].angle;
            let moves = way.value().abs() > STILL.1;
            let goes = last.spindles[index].enable && !command.spindles[index].enable && moves;
            newly |= goes;
            *off = !command.spindles[index].enable && (*off || goes);
        }
        if newly {
            let all = !command.axes.iter().any(|axis| axis.enable)
                && !command.spindles.iter().any(|spindle| spindle.enable);
            let reaction = match alone.on_silence {
                DriveReaction::CoupledStop if !all => DriveReaction::QuickStop,
                stated => stated,
            };
            self.stop = Some(RunDown::new(&alone.config, reaction, None, last, now));
        }
        if !self.is_any() {
            self.stop = None;
        }
        let stop = self.stop.as_mut()?;
        let own = stop.command(now);
        let mut order = *command;
        for (index, _) in self.axes.iter().enumerate().filter(|(_, off)| **off) {
            order.axes[index] = own.axes[index];
        }
        for (index, _) in self.spindles.iter().enumerate().filter(|(_, off)| **off) {
            order.spindles[index] = own.spindles[index];
        }
        if stop.is_over() {
            (self.stop, self.axes, self.spindles) = (None, [false; AXES], [false; SPINDLES]);
        }
        Some(order)
    }

    /// What they say of themselves: they are not ready.
    pub(super) fn tell(&self, said: &mut Feedback) {
        for (axis, off) in said.axes.iter_mut().zip(self.axes) {
            axis.ready &= !off;
        }
        for (spindle, off) in said.spindles.iter_mut().zip(self.spindles) {
            spindle.ready &= !off;
        }
    }

    fn is_any(&self) -> bool {
        self.axes.contains(&true) || self.spindles.contains(&true)
    }
}
