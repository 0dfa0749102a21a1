//! The tool leaves the work before anything stops: what a tool asks for that is tied to a spindle
//! and not screwed to the work.
//!
//! ```text
//!   alarm, abort ─► X away from the work, spindles turning on ─► spindles brake, axes hold
//!   hold in a thread ─► X away, Z going on along the thread ─► Z brakes, the spindle turns on ([`crate::threading`])
//! ```
//!
//! The way is an offset on what moves the axis otherwise: a thread goes on being one while the tool
//! is pulled off it.
use crate::axis::{AxisLoop, Target};
use crate::config::{Config, PhaseLoss};
use crate::drives::Drives;
use motion::WayOut;
use sync::Blend;
use units::Length;
use units::{Axis, Coordinate};

/// Share of what the axis can, as for any move that was not planned.
const SHARE: f64 = 0.5;

/// An axis that is further from where it was told to be has not obeyed.
const NEAR: Length = Length::mm(0.2);

/// The tool of a way out is off the work, by the encoder of its infeed axis.
pub(crate) fn is_clear(way: &WayOut, drives: &Drives) -> bool {
    let axis = drives.axes[way.infeed.index()].as_ref();
    axis.is_some_and(|axis| axis.sight.is_closed() && way.inside(base(axis)) <= NEAR)
}

/// Where an axis is by its encoder, without what is superposed on it.
fn base(axis: &AxisLoop) -> Length {
    Length::mm(axis.position() - axis.superposed.position)
}

/// The way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Retreating {
    axis: usize,
    /// Where the axis stands without it.
    from: f64,
    blend: Blend,
    at_s: f64,
}

impl Retreating {
    /// What the loss of a phase asks for, from where the axis is ordered to be; `None` if there is
    /// no such axis.
    pub(crate) fn begin(order: &PhaseLoss, drives: &Drives) -> Option<Self> {
        let (speed, accel) = order.most;
        Self::by(order.axis, order.by, (speed.value(), accel.value()), drives)
    }

    /// To where the tool is clear; `None` if it is.
    pub(crate) fn to_clear(way: &WayOut, drives: &Drives, config: &Config) -> Option<Self> {
        let index = way.infeed.index();
        let axis = drives.axes[index].as_ref()?;
        let stands = Length::mm(axis.target.position);
        let (bounds, approach) = (&config.motion.rapid, axis.control.approach);
        let share =
            |most: f64, approach: f64| if most.is_finite() { SHARE * most } else { approach };
        let most = (
            share(bounds.speed[index], approach.0.value()),
            share(bounds.accel[index], approach.1.value()),
        );
        let inside = way.inside(stands).value() > 0.0;
        inside
            .then(|| Self::by(way.infeed, Coordinate::linear(way.clear - stands), most, drives))
            .flatten()
    }

    /// To a place, gently; `None` if there is no such axis.
    pub(crate) fn gently(axis: Axis, to: Coordinate, drives: &Drives) -> Option<Self> {
        let control = drives.axes[axis.index()].as_ref()?;
        let most = (control.control.approach.0.value(), control.control.approach.1.value());
        Self::by(axis, to - Coordinate::new(control.target.position), most, drives)
    }

    fn by(axis: Axis, by: Coordinate, (speed, accel): (f64, f64), drives: &Drives) -> Option<Self> {
        let axis = axis.index();
        let from = drives.axes[axis].as_ref()?.target.position;
        Some(Self { axis, from, blend: Blend::new(0.0, by.value(), speed, accel), at_s: 0.0 })
    }

    /// The axis that leads the tool away.
    pub(crate) const fn axis(&self) -> usize {
        self.axis
    }

    /// The way is over.
    pub(crate) fn is_out(&self) -> bool {
        self.at_s >= self.blend.duration_s()
    }

    /// The axis is where it was told to be, by its encoder.
    pub(crate) fn is_there(&self, drives: &Drives) -> bool {
        drives.axes[self.axis]
            .as_ref()
            .is_some_and(|axis| (axis.position() - axis.target.position).abs() <= NEAR.value())
    }

    /// A period on. `moved`: something else has moved the axis in this period, and the way goes on
    /// top of that.
    pub(crate) fn advance(&mut self, dt: f64, moved: bool, drives: &mut Drives) {
        let Some(axis) = drives.axes[self.axis].as_mut() else { return };
        self.at_s += dt;
        let ahead_s = axis.lookahead_s();
        let (now, later) = (self.blend.at(self.at_s), self.blend.at(self.at_s + ahead_s));
        if moved {
            self.from = axis.target.position;
        } else {
            axis.target = Target { position: self.from, ..Target::default() };
        }
        axis.target.position += now.s;
        axis.target.speed += now.v;
        axis.target.accel += now.a;
        axis.target.jerk += (later.a - now.a) / ahead_s;
    }
}
