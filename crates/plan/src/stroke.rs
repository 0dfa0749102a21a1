//! A tap's stroke: the spindle from rest to speed to rest over an exact number of revolutions, with
//! the feed axis hanging on it.
//!
//! ```text
//!   n │      ____________          N = |bottom − start| / |lead|       revolutions, exactly
//!     │     ╱            ╲         n ≤ S, tapping maximum, v_max/|lead|
//!     │   ╱               ╲        α ≤ torque and power curve, a_max/|lead|
//!     │ ╱                  ╲       dα/dt ≤ torque rise, j_max/|lead|
//!     └─────────────────────────► t
//! ```
//!
//! The turning point is planned, not awaited: the spindle *brakes towards it* and rests on it, so a
//! tap does not run past its depth by the ω²/2α of a spindle that is reversed on reaching it. Lower
//! bounds for an ideal spindle with acceleration A: 2·√(N/A) if N ≤ n²/A, else N/n + n/A.
//!
//! A stroke too short for S gets the highest speed whose two ramps still fit; what rounding leaves
//! of the stroke is a short cruise.
use crate::limits::{AxisLimits, SpindleLimits};
use crate::ramp::stroke;
use crate::ramp::{Ceiling, Ramp};
use canon::Flute;
use motion::{Limiting, Profile, TapLimiting};
use units::{Angle, Lead, Length, Spin, SpinAccel, Time, Torque};

/// One way of a tap: from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrokeRequest {
    /// Revolutions, positive.
    pub revolutions: Angle,
    /// Programmed speed, positive.
    pub spin: Spin,
    /// Advance of the feed axis per revolution; only its magnitude counts.
    pub lead: Lead,
    /// Torque of the cut.
    pub cut: Torque,
    /// Highest acceleration that is asked for, below what the machine allows; `None`: all of that.
    pub spindle_accel: Option<SpinAccel>,
    /// A straight ramp from rest to `spin` in this time instead of what the machine allows.
    pub force_ramp: Option<Time>,
}

/// One way of a tap, planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Revolutions over time.
    pub profile: Profile,
    /// What kept it from being shorter.
    pub limiting: TapLimiting,
}

impl StrokeRequest {
    /// The fastest stroke that spindle and feed axis allow; empty if there is nothing to turn or
    /// the cut is heavier than the spindle.
    pub fn plan(&self, spindle: &SpindleLimits, axis: &AxisLimits) -> Stroke {
        let (top, speed_bound) = self.top_speed(spindle, axis);
        if !(top > 0.0 && self.revolutions > Angle::ZERO) {
            let limiting = TapLimiting { speed: speed_bound, ramp: Limiting::SpindleTorque };
            return Stroke { profile: Profile::EMPTY, limiting };
        }
        let ramps = match self.force_ramp {
            Some(time) => Ramps::forced(self.spin, time),
            None => Ramps::allowed(self, spindle, axis, Spin::rev_per_s(top)),
        };
        let length = self.revolutions.value();
        let peak = ramps.peak_within(length, top);
        let (up, down) = ramps.to(peak);
        let speed = if peak < top { Limiting::StrokeLength } else { speed_bound };
        let ramp = ramps.bound_of(&up);
        Stroke { profile: stroke(length, &up, &down), limiting: TapLimiting { speed, ramp } }
    }

    /// The acceleration that spindle and feed axis allow from rest, whatever gentler one is asked
    /// for.
    pub fn acceleration_from_rest(&self, spindle: &SpindleLimits, axis: &AxisLimits) -> SpinAccel {
        let torque = SpinAccel::rev_per_s2(spindle.speeding_up(self.cut).at_rest());
        torque.min(axis.accel.of_linear() / self.lead.abs())
    }

    /// Highest speed, rev/s, and what sets it.
    fn top_speed(&self, spindle: &SpindleLimits, axis: &AxisLimits) -> (f64, Limiting) {
        let candidates = [
            (self.spin.value(), Limiting::ProgrammedSpeed),
            (spindle.tapping_max.value(), Limiting::TappingMaximum),
            ((axis.feed_speed.of_linear() / self.lead.abs()).value(), Limiting::FeedSpeed),
            (spindle.reachable(self.cut).value(), Limiting::SpindlePower),
        ];
        // strictly lower: of two equal bounds the programmer's is named
        candidates.into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a }).unwrap_or(candidates[0])
    }
}

/// The two ramps of a stroke as functions of the speed between them.
struct Ramps {
    up: Ceiling,
    down: Ceiling,
    jerk: f64,
    /// Speed above which power is the limit, rev/s.
    base: f64,
    level: Limiting,
    rise: Limiting,
}

impl Ramps {
    fn forced(spin: Spin, time: Time) -> Self {
        let ceiling = Ceiling::level((spin / time).value());
        let forced = Limiting::Forced;
        let (jerk, base) = (f64::INFINITY, f64::INFINITY);
        Self { up: ceiling, down: ceiling, jerk, base, level: forced, rise: forced }
    }

    fn allowed(
        request: &StrokeRequest,
        spindle: &SpindleLimits,
        axis: &AxisLimits,
        top: Spin,
    ) -> Self {
        let lead = request.lead.abs();
        let asked = request.spindle_accel.map_or(f64::INFINITY, SpinAccel::value);
        let feed_accel = (axis.accel.of_linear() / lead).value();
        let level = feed_accel.min(asked);
        let feed_jerk = (axis.feed_jerk.of_linear() / lead).value();
        let jerk = feed_jerk.min(spindle.jerk());
        let up = spindle.speeding_up(request.cut);
        let down = spindle.slowing_down();
        Self {
            up: up.ceiling(level, jerk, top.value()),
            down: down.ceiling(level, jerk, top.value()),
            jerk,
            base: up.base(),
            level: if asked < feed_accel.min(up.at_rest()) {
                Limiting::AskedAcceleration
            } else if feed_accel < up.at_rest() {
                Limiting::FeedAcceleration
            } else {
                Limiting::SpindleTorque
            },
            rise: if feed_jerk < spindle.jerk() {
                Limiting::FeedJerk
            } else {
                Limiting::SpindleJerk
            },
        }
    }

    fn to(&self, peak: f64) -> (Ramp, Ramp) {
        (Ramp::up(&self.up, self.jerk, 0.0, peak), Ramp::up(&self.down, self.jerk, 0.0, peak))
    }

    /// Highest speed, `top` at most, whose ramps are together no longer than `length`.
    fn peak_within(&self, length: f64, top: f64) -> f64 {
        let fits = |peak: f64| {
            let (up, down) = self.to(peak);
            up.length() + down.length() <= length
        };
        if fits(top) {
            return top;
        }
        let (mut low, mut high) = (0.0, top);
        // 53 halvings exhaust the mantissa
        for _ in 0..53 {
            let middle = f64::midpoint(low, high);
            if fits(middle) { low = middle } else { high = middle }
        }
        low
    }

    /// What bounds a ramp for the longest part of its time: the jerk where it is used up, else
    /// torque or feed acceleration where the speed is low or the line level, else power.
    fn bound_of(&self, ramp: &Ramp) -> Limiting {
        let (mut rising, mut level, mut falling) = (0.0, 0.0, 0.0);
        for piece in ramp.pieces() {
            let time = if piece.j.abs() >= self.jerk {
                &mut rising
            } else if piece.j == 0.0 || piece.v < self.base {
                &mut level
            } else {
                &mut falling
            };
            *time += piece.duration;
        }
        if rising >= level && rising >= falling {
            self.rise
        } else if level >= falling {
            self.level
        } else {
            Limiting::SpindlePower
        }
    }
}

/// Torque of a tap in full cut:
/// M = tan 30°·kc·K·(D − D₀)²·(D + 2·D₀)/24000, in N·m with lengths in mm and kc in N/mm².
///
/// D is the thread's nominal diameter, D₀ that of the drilled hole; K takes the flute's form into
/// account (1.15 spiral flute, 0.95 spiral point, 1.35 straight).
pub fn tapping_torque(
    nominal: Length,
    drilled: Length,
    flute: Flute,
    cutting_pressure_n_per_mm2: f64,
) -> Torque {
    let k = match flute {
        Flute::SpiralFlute => 1.15,
        Flute::SpiralPoint => 0.95,
        Flute::Straight => 1.35,
    };
    let (d, d0) = (nominal.value(), drilled.value());
    let chip = (d - d0).max(0.0);
    let tan_30 = 0.577_350_269_189_625_8;
    Torque::n_m(tan_30 * cutting_pressure_n_per_mm2 * k * chip * chip * (d + 2.0 * d0) / 24_000.0)
}
