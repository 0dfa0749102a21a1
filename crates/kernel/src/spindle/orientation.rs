//! A spindle is held, where it stands or at an angle: by the position loop, or by a drive that
//! orients it by itself.
//!
//! ```text
//!   hold(angle) ─► at rest? ─┬─ no ─► stop, and the call is repeated
//!                            ├─ position loop ──────► Held ─► Turn ─► Held: within its window
//!                            └─ the drive orients ──► told the angle ─► it says that it is there, or that it cannot
//! ```
//!
//! What such a drive says counts from when it obeys: before that it is about the angle at which it
//! stood.
use super::{SpindleLoop, Task};
use bus::SpindleFeedback;
use sync::{Blend, Rotation};
use units::{Angle, Orientation};

/// A drive that orients the spindle by itself, at work.
#[derive(Clone, Copy, Debug)]
pub(super) struct ByDrive {
    /// What it is told.
    pub(super) to: Orientation,
    /// For so long, s.
    told_s: f64,
    /// It has said that it is there.
    is_there: bool,
    /// It has said that it cannot.
    fault: Option<i32>,
}

impl SpindleLoop {
    /// The angle at which it is held, once it is.
    pub(crate) fn held(&self) -> Option<Angle> {
        if let Task::OrientedByDrive(drive) = self.order {
            return drive.is_there.then_some(drive.to.angle);
        }
        let within = self.error.abs() <= self.control.windows.oriented.value();
        (matches!(self.order, Task::Held) && within && self.at_rest()).then_some(self.ordered.angle)
    }

    /// The angle within a turn that its drive shall bring it to by itself.
    pub(super) const fn told_to_orient(&self) -> Option<Orientation> {
        match self.order {
            Task::OrientedByDrive(drive) => Some(drive.to),
            _ => None,
        }
    }

    /// The fault code of a drive that cannot orient the spindle.
    pub(crate) const fn orient_fault(&self) -> Option<i32> {
        match self.order {
            Task::OrientedByDrive(drive) => drive.fault,
            _ => None,
        }
    }

    /// Hold it, at an angle within a turn or where it stands. It should stand; if it does not, it
    /// is stopped first and the call repeated.
    pub(crate) fn hold(&mut self, to: Option<Orientation>) {
        match self.order {
            Task::Turn(..) => return,
            Task::Held => {}
            Task::LedAngle => self.order = Task::Held,
            Task::OrientedByDrive(drive) if to == Some(drive.to) => return,
            // a drive takes an angle when it is asked anew: it is let go for a period
            Task::OrientedByDrive(_) => return self.stop(),
            Task::Slew(_) | Task::Ramp(..) | Task::LedSpeed | Task::Brake => {
                if !self.at_rest() {
                    return self.stop();
                }
                self.release();
                if let (true, Some(to)) = (self.control.orients, to) {
                    let drive = ByDrive { to, told_s: 0.0, is_there: false, fault: None };
                    self.order = Task::OrientedByDrive(drive);
                    return;
                }
                // one whose drive goes by its angle is held at what it was told last
                let at = if self.control.closes_position { self.ordered } else { self.now() };
                self.ordered = Rotation { angle: at.angle, ..Rotation::default() };
                self.before = self.ordered;
                self.order = Task::Held;
            }
        }
        let Some(to) = to else { return };
        let from = self.ordered.angle;
        let to = to.from(from, self.control.windows.oriented);
        if (to - from).abs() > Angle::rev(1e-9) {
            let (spin, accel) = self.control.orient;
            let turn = Blend::new(from.value(), to.value(), spin.value(), accel.value());
            self.order = Task::Turn(turn, 0.0);
        }
    }

    /// What a drive that orients the spindle says of it.
    pub(super) fn hear_drive(&mut self, feedback: &SpindleFeedback) {
        let obeys_after_s = self.control.own_ramps.map_or(0.0, |own| own.delay.value());
        let Task::OrientedByDrive(drive) = &mut self.order else { return };
        drive.told_s += self.period_s;
        if drive.told_s <= obeys_after_s + self.period_s || drive.is_there {
            return;
        }
        drive.fault = drive.fault.or(Some(feedback.orient_fault).filter(|code| *code != 0));
        drive.is_there = feedback.oriented && drive.fault.is_none();
    }
}
