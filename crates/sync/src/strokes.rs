//! The planned strokes of a tap: revolutions over time, in, at the bottom, and out.
//!
//! ```text
//!    turned │      ___________
//!           │    ╱             ╲
//!           │  ╱                 ╲
//!           └──────┬──────────┬──────► time
//!              In    Bottom     Out
//! ```
use units::{Angle, Spin, SpinAccel, Time};

use crate::halting::sense;
use crate::{Coupling, Rotation, Tap};

/// State of a stroke at one time; magnitudes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrokePoint {
    /// Revolutions done.
    pub turned: Angle,
    /// Speed.
    pub spin: Spin,
    /// Acceleration along the stroke.
    pub accel: SpinAccel,
}

/// Revolutions over time, rest to rest.
pub trait Stroke {
    /// State at a time from the stroke's start; at rest before and after.
    fn at(&self, time: Time) -> StrokePoint;
    /// How long it lasts.
    fn duration(&self) -> Time;
    /// Revolutions in all.
    fn length(&self) -> Angle;
    /// When it begins to slow down for good.
    fn brake(&self) -> Time;
}

/// The parts of the planned motion.
#[derive(Clone, Copy)]
pub(crate) enum Leg {
    /// In.
    In,
    /// Standing at the bottom.
    Bottom,
    /// Out.
    Out,
}

/// The planned master, `time` after the beginning of a leg and possibly in a later one.
pub(crate) fn planned<S: Stroke>(
    tap: &Tap<S>,
    coupling: &Coupling,
    leg: Leg,
    time: Time,
) -> Rotation {
    let sense = sense(tap);
    let theta0 = coupling.phase_difference(Angle::ZERO, tap.start);
    let (turned, direction, point) = match leg {
        Leg::In if time >= tap.inward.duration() => {
            return planned(tap, coupling, Leg::Bottom, time - tap.inward.duration());
        }
        Leg::Bottom if time >= tap.dwell => {
            return planned(tap, coupling, Leg::Out, time - tap.dwell);
        }
        Leg::In => {
            let point = tap.inward.at(time);
            (point.turned, sense, point)
        }
        Leg::Bottom => (tap.inward.length(), sense, StrokePoint::default()),
        Leg::Out => {
            let point = tap.outward.at(time);
            (tap.inward.length() - point.turned, -sense, point)
        }
    };
    Rotation {
        angle: theta0 + turned * sense,
        spin: point.spin * direction,
        accel: point.accel * direction,
    }
}
