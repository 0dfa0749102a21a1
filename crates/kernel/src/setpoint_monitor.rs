//! The last look at what the axes are told: independent of the plan and of whatever made the
//! setpoints of it.
//!
//! ```text
//!   plan, overrides, jog, homing, couplings, compensation ─► setpoint ─► [ monitor ] ─► loops ─► bus
//!                                                                            │
//!                                no number, too fast, off the travel ────────┴──► alarm; the axis brakes from its last setpoint
//! ```
//!
//! It knows the machine's limits and the setpoints of the last three periods, nothing else:
//! differences of setpoints a period apart are what a drive has to do. A setpoint that is refused
//! is never sent.
//!
//! | what leads the axis | speed | acceleration | jerk |
//! |---|---|---|---|
//! | a path: moves, probing | 1.02·V | 1.15·A | 2·J, where limited |
//! | itself: jog, homing, stops, retreats | 1.02·V | 1.15·A | — |
//! | an angle: taps, threads, cams, G95 | 1.15·V | 1.5·max(A, peak force over mass) | — |
//!
//! V and A are the largest that anything may ask of the axis: of feeds, rapids, small moves, and
//! for A of unplanned stops. Why the shares:
//!
//! - *Path.* Differences at the period of a motion within its limits are within them (mean value
//!   theorem), but for rounding: 10⁻¹³ of a metre over h³ is below a millionth of any J. Time
//!   scaling takes up to 0.3 % of A and 2 % of J, and twice that again for each twentieth of a
//!   second in which a plan leaves it no room; a plan that turns into its next step within a period
//!   is off by what the period rounds. What is beyond twice J or 1.15·A is no rounding.
//! - *Itself.* Stops change the acceleration within a period: no limit of jerk.
//! - *An angle.* A spindle that is measured turns as its load lets it, with the noise of its
//!   encoder: the axis may be asked for as much as its drive can give. What is beyond one and a
//!   half times that it could not follow anyway.
//!
//! **Travel.** Of an axis that is homed a setpoint may be [`BESIDE_MM`] beyond the end of its
//! travel, as far as compensation and rounding need; and it may not be on the way to an end before
//! which the axis cannot come to rest any more: x + v²/2A beyond it. An axis that already is
//! outside may come back. One that follows an angle is looked at where it is.
//!
//! Setpoints say how far an axis has moved in a period, not how fast it is at its end. What they do
//! say is how fast it is *at least*, if its acceleration was within A all the time: with d the last
//! period's way and e what it was longer than the one before (0 where it was shorter),
//!
//! ```text
//!   v ≥ d/h − A·h/2 + A·τ²/h      τ = h − √(h² − e/A)
//! ```
//!
//! the motion that speeds up with A until τ into the period, and from there on brakes with A. It is
//! reached: any motion that is faster than that may still have begun to brake. A plan that begins
//! to brake within a period, with A, to rest at the very end of the travel, is never refused; one
//! that does not brake is noticed half a period later at most.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, v, h | setpoint, its speed, period | mm, mm/s, s |
//! | V, A, J | limits of speed, acceleration and jerk | mm/s, mm/s², mm/s³ |
//!
//! Lengths are in the axis' own unit: degrees of a rotary one.
use crate::axis::{AxisLoop, Target};
use crate::config::Subject;
use crate::drives::Finding;
use crate::fault::FaultKind;
use bus::AXES;
use motion::Limits;
use units::Axis;

/// How far beyond its travel a setpoint may be, mm.
const BESIDE_MM: f64 = 0.01;
/// How much further the way to rest may be, in periods of way: time scaling, and a plan that turns
/// into its next step within a period.
const WITHIN_PERIOD: f64 = 0.1;
/// Shares of the limits: see the module's header.
const SPEED_SHARE: f64 = 1.02;
const ACCEL_SHARE: f64 = 1.15;
const JERK_SHARE: f64 = 2.0;
const ANGLE_SPEED_SHARE: f64 = 1.15;
const ANGLE_ACCEL_SHARE: f64 = 1.5;
/// Periods after which nothing of another lead is left in third differences.
const FORGOTTEN: u8 = 4;

/// What leads an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Led {
    /// A planned path.
    Path,
    /// Motion of its own, or none.
    Itself,
    /// The angle of a spindle.
    Angle,
}

/// The setpoints that were sent last.
#[derive(Clone, Copy, Debug, Default)]
struct Sent {
    target: Target,
    superposed: Target,
    /// The position, without what has only given places other names; and its differences.
    told: f64,
    first: f64,
    second: f64,
    /// Setpoints that are known: three for a second difference.
    known: u8,
    /// Periods since an angle led it, and in which a path, or nothing, has led it.
    since_angle: u8,
    on_path: u8,
}

/// All axes' setpoints.
#[derive(Clone, Debug)]
pub(crate) struct SetpointMonitor {
    axes: [Sent; AXES],
    most: [MostByLead; AXES],
}

/// What an axis may be asked for, by what leads it.
#[derive(Clone, Copy, Debug, Default)]
struct MostByLead {
    path: Most,
    itself: Most,
    angle: Most,
}

/// What an axis may be asked for.
#[derive(Clone, Copy, Debug, Default)]
struct Most {
    speed: f64,
    accel: f64,
    jerk: f64,
    /// The acceleration with which it comes to rest before an end of its travel.
    stops: f64,
}

impl MostByLead {
    fn new(index: usize, axis: &AxisLoop, limits: &Limits) -> Self {
        let (approach_speed, approach_accel) = axis.control.approach;
        let speed = limits.feed.speed[index].max(limits.rapid.speed[index]);
        let stops = limits.feed.accel[index].max(limits.rapid.accel[index]);
        let jerk = limits.feed.jerk[index].max(limits.rapid.jerk[index]);
        let (speed, accel) = (speed.max(approach_speed.value()), stops.max(approach_accel.value()));
        let itself = Most {
            speed: SPEED_SHARE * speed,
            accel: ACCEL_SHARE * accel.max(axis.braking()),
            jerk: f64::INFINITY,
            stops: accel,
        };
        let path = Most { accel: ACCEL_SHARE * accel, jerk: JERK_SHARE * jerk, ..itself };
        let angle = Most {
            speed: ANGLE_SPEED_SHARE * speed,
            accel: ANGLE_ACCEL_SHARE * accel.max(2.0 * axis.braking()),
            ..itself
        };
        Self { path, itself, angle }
    }

    const fn of(&self, led: Led) -> &Most {
        match led {
            Led::Path => &self.path,
            Led::Itself => &self.itself,
            Led::Angle => &self.angle,
        }
    }
}

impl SetpointMonitor {
    /// Of a machine's axes, with their limits.
    pub(crate) fn new(axes: &[Option<AxisLoop>; AXES], limits: &Limits) -> Self {
        let most = core::array::from_fn(|index| {
            let axis = axes[index].as_ref();
            axis.map_or_else(MostByLead::default, |axis| MostByLead::new(index, axis, limits))
        });
        Self { axes: [Sent::default(); AXES], most }
    }

    /// The axes stand where their encoders say: there is no setpoint before.
    pub(crate) fn reset(&mut self) {
        self.axes = [Sent::default(); AXES];
    }

    /// An axis goes on from where it is, not from its last setpoint.
    pub(crate) fn forget(&mut self, index: usize) {
        self.axes[index] = Sent::default();
    }

    /// What was sent in the last period.
    pub(crate) const fn sent(&self, index: usize) -> Target {
        self.axes[index].target
    }

    /// Whether what an axis is about to be told can be told; it is then taken for sent.
    pub(crate) fn check(
        &mut self,
        index: usize,
        axis: &AxisLoop,
        period_s: f64,
        (led, homed, is_coupled_stop): (Led, bool, bool),
    ) -> Result<(), Finding> {
        let next = self.axes[index].next(axis, led);
        let found = |kind, value, most| Err((kind, Subject::Axis(Axis::ALL[index]), value, most));
        let now = [axis.target, axis.superposed];
        if !now.iter().all(Target::is_finite) {
            return found(FaultKind::SetpointInvalid, 0.0, 0.0);
        }
        let sent = &self.axes[index];
        // an alarm has let go of the plan: from then on the axis goes by the angle that is
        // measured, wherever that is
        let known = if is_coupled_stop { 0 } else { sent.known };
        let led = if next.since_angle < FORGOTTEN { Led::Angle } else { led };
        let most = self.most[index].of(led);
        if known > 0 {
            let speed = next.first / period_s;
            if speed.abs() > most.speed {
                return found(FaultKind::SetpointSpeed, speed, most.speed);
            }
        }
        if known > 1 {
            let accel = next.second / (period_s * period_s);
            if accel.abs() > most.accel {
                return found(FaultKind::SetpointAccel, accel, most.accel);
            }
        }
        if known > 2 && next.on_path >= FORGOTTEN {
            let jerk = (next.second - sent.second) / (period_s * period_s * period_s);
            if jerk.abs() > most.jerk {
                return found(FaultKind::SetpointJerk, jerk, most.jerk);
            }
        }
        if let Some((beyond, end)) = next.beyond(axis, most, led, period_s).filter(|_| homed) {
            return found(FaultKind::SoftLimit, beyond, end);
        }
        self.axes[index] = next;
        Ok(())
    }

    /// What is sent instead of a setpoint that was refused: on from the last one, and slower. An
    /// axis that follows an angle goes on as fast: it is in a thread.
    pub(crate) fn replace(
        &mut self,
        index: usize,
        axis: &mut AxisLoop,
        (led, period_s): (Led, f64),
    ) {
        let sent = &self.axes[index];
        (axis.target, axis.superposed) = (sent.target, sent.superposed);
        (axis.superposed.speed, axis.superposed.accel, axis.superposed.jerk) = (0.0, 0.0, 0.0);
        // as its setpoints have moved, not as was said of them
        axis.target.speed = (sent.first + sent.second / 2.0) / period_s;
        if led == Led::Angle {
            axis.target.position += period_s * axis.target.speed;
            (axis.target.accel, axis.target.jerk) = (0.0, 0.0);
        } else {
            axis.brake();
        }
        self.axes[index] = self.axes[index].next(axis, led);
    }
}

impl Sent {
    /// A setpoint on.
    fn next(&self, axis: &AxisLoop, led: Led) -> Self {
        let told = axis.target.position + axis.superposed.position - axis.renamed;
        let first = if self.known > 0 { told - self.told } else { 0.0 };
        let second = if self.known > 1 { first - self.first } else { 0.0 };
        let (angle, calm) = (led == Led::Angle, led == Led::Path || first == 0.0);
        Self {
            target: axis.target,
            superposed: axis.superposed,
            told,
            first,
            second,
            known: (self.known + 1).min(3),
            since_angle: match (angle, self.known) {
                (true, _) => 0,
                (false, 0) => FORGOTTEN,
                (false, _) => self.since_angle.saturating_add(1).min(FORGOTTEN),
            },
            on_path: if calm && !angle { self.on_path.saturating_add(1).min(FORGOTTEN) } else { 0 },
        }
    }

    /// How fast it is at the end of the period at least, the way that it has moved, if it was never
    /// accelerated by more than this: see the module's header.
    fn slowest(&self, accel: f64, period_s: f64) -> f64 {
        if !accel.is_finite() {
            return 0.0;
        }
        let longer = (self.second * self.first.signum()).clamp(0.0, accel * period_s * period_s);
        let speeds_up_s = period_s - libm::sqrt(period_s * period_s - longer / accel).max(0.0);
        let gained = accel * (speeds_up_s * speeds_up_s / period_s - period_s / 2.0);
        (self.first.abs() / period_s + gained).max(0.0)
    }

    /// How far it is, or will be, beyond an end of its travel, and that end: if it goes there.
    fn beyond(&self, axis: &AxisLoop, most: &Most, led: Led, period_s: f64) -> Option<(f64, f64)> {
        let (from, to) = axis.control.travel?;
        let at = axis.target.position + axis.superposed.position;
        let end = self.slowest(most.stops, period_s);
        let stops = if led == Led::Angle { 0.0 } else { end * end / (2.0 * most.stops) };
        let margin = BESIDE_MM + WITHIN_PERIOD * self.first.abs();
        let rests = at + stops * self.first.signum();
        let above = rests > to.value() + margin && self.first > 0.0;
        let below = rests < from.value() - margin && self.first < 0.0;
        if above {
            Some((rests, to.value()))
        } else if below {
            Some((rests, from.value()))
        } else {
            None
        }
    }
}
