//! The tool leaves the work before anything stops: what a geared spindle that has lost its phase asks for.
//!
//! ```text
//!   phase lost ─► X away from the work, spindles turning on ─► spindles brake, axes hold
//! ```
use crate::axis::Target;
use crate::config::PhaseLoss;
use crate::drives::Drives;
use sync::Blend;

/// The way out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Retreating {
    axis: usize,
    blend: Blend,
    at_s: f64,
}

impl Retreating {
    /// Begin where the axis is ordered to be; `None` if there is no such axis.
    pub(crate) fn begin(order: &PhaseLoss, drives: &Drives) -> Option<Self> {
        let axis = order.axis.index();
        let from = drives.axes[axis].as_ref()?.target.position;
        let (speed, accel) = order.most;
        let blend = Blend::new(from, from + order.by.value(), speed.value(), accel.value());
        Some(Self { axis, blend, at_s: 0.0 })
    }

    /// The axis that leads the tool away.
    pub(crate) const fn axis(&self) -> usize {
        self.axis
    }

    /// A period on; whether it is over.
    pub(crate) fn advance(&mut self, dt: f64, drives: &mut Drives) -> bool {
        let Some(axis) = drives.axes[self.axis].as_mut() else { return true };
        self.at_s += dt;
        let ahead_s = axis.lookahead_s();
        let (now, later) = (self.blend.at(self.at_s), self.blend.at(self.at_s + ahead_s));
        axis.target = Target {
            position: now.s,
            speed: now.v,
            accel: now.a,
            jerk: (later.a - now.a) / ahead_s,
        };
        self.at_s >= self.blend.duration_s()
    }
}
