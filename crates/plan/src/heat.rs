//! How hot a spindle's drive becomes: the root of the mean square of its torque, over the time in
//! which it warms.
//!
//! ```text
//!   τ·dΘ/dt = M² − Θ        overloaded: √Θ > M of continuous duty
//!
//!   M │▗▖  ▗▖  ▗▖         a peak is nothing to it; many of them are
//!   Θ │      ▁▁▂▂▃▃▄▄
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | M | torque of the drive, as planned: inertia, friction, the tap's cut | N·m |
//! | Θ, τ | its mean square, and the time over which; one figure for drive and winding | N²·m², s |
//!
//! What milling and drilling take is not known before the cut, and is left out; so is what a
//! spindle swings. Time goes as the moves alone take, without what joining them costs: it is the
//! same for a program that is checked and for one that runs.
//!
//! Source: IEC 60034-1, duty types S1 and S3; a winding warms by the square of its current.
use crate::limits::{MachineLimits, SpindleLimits};
use crate::{SpindleStep, StepKind};
use core::f64::consts::TAU;
use motion::Profile;
use units::{Spin, Torque};

/// Slices of a profile over which its torque is averaged.
const SLICES: u32 = 24;
/// The longest time that is taken in one step of the mean, over τ.
const COARSE: f64 = 0.25;

/// The mean squares of the spindles' torques.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Heat {
    spindles: [Warm; SPINDLES],
    /// Torque of the next tap's cut.
    cut: f64,
    /// Time that has passed with nothing but friction, s.
    waiting: f64,
    /// Something has warmed since anybody asked.
    fresh: bool,
}

/// As many spindles as a machine file can name.
pub(crate) const SPINDLES: usize = 2;

#[derive(Clone, Copy, Debug, Default)]
struct Warm {
    /// Speed that it was told, rev/s.
    spin: f64,
    /// N²·m²: now, and at most so far.
    mean: f64,
    most: f64,
}

impl Heat {
    /// The next tap cuts with this torque.
    pub(crate) const fn cuts_with(&mut self, torque: Torque) {
        self.cut = torque.value();
    }

    /// The machine moves for so long, its spindles turn.
    pub(crate) fn passes(&mut self, time: f64) {
        if time > 0.0 && time.is_finite() {
            self.waiting += time;
        }
    }

    /// What has passed has warmed the drives by their friction alone.
    fn settle(&mut self, limits: &MachineLimits) {
        let time = core::mem::take(&mut self.waiting);
        for (state, spindle) in self.spindles.iter_mut().zip(&limits.spindles) {
            let torque = friction(spindle, state.spin);
            state.takes(torque * torque * time, time, spindle);
        }
    }

    /// A step that has been planned; along joined paths [`Heat::passes`] counts.
    pub(crate) fn count(&mut self, step: &StepKind, limits: &MachineLimits) {
        let spin = self.spindles[0].spin.abs();
        match step {
            StepKind::Move(order) => {
                let over = order.profile.duration();
                let time = if !order.per_revolution {
                    over
                } else if spin > 0.0 {
                    over / spin
                } else {
                    0.0
                };
                self.passes(time);
            }
            StepKind::Probe { order, .. } => self.passes(order.profile.duration()),
            StepKind::Dwell(time) => self.passes(time.value()),
            StepKind::Inputs(wait) => self.passes(wait.usual.value()),
            StepKind::Count(count) => self.passes(count.usual.value()),
            StepKind::ChangeTool { .. } => self.passes(limits.tool_change.time.value()),
            StepKind::Thread(stretch) if spin > 0.0 => {
                self.passes((stretch.is_over_at() - stretch.begins()) / spin);
            }
            StepKind::Revolve { turns, .. } if spin > 0.0 => {
                self.passes(turns.abs().value() / spin);
            }
            StepKind::Spindle { spindle, order } => {
                self.settle(limits);
                self.fresh = true;
                let index = usize::from(*spindle);
                let (Some(state), Some(drive)) =
                    (self.spindles.get_mut(index), limits.spindles.get(index))
                else {
                    return;
                };
                match order {
                    SpindleStep::Turn { spin, ramp } => {
                        // it runs beside what comes next
                        let heat = ramp_heat(drive, ramp, 0.0);
                        state.takes(heat, 0.0, drive);
                        state.spin = spin.value();
                    }
                    SpindleStep::Surface { surface: _, ramp } => {
                        let heat = ramp_heat(drive, ramp, 0.0);
                        state.takes(heat, 0.0, drive);
                        state.spin = ramp.end().v;
                    }
                    SpindleStep::Throw(throw) => {
                        let heat = ramp_heat(drive, &throw.against, 0.0)
                            + ramp_heat(drive, &throw.back, 0.0);
                        state.takes(heat, 0.0, drive);
                        state.spin = throw.then.value();
                    }
                    SpindleStep::AwaitSpeed | SpindleStep::Orient { .. } => {}
                }
            }
            StepKind::Tap(tap) => {
                self.settle(limits);
                self.fresh = true;
                let index = usize::from(tap.spindle);
                let (Some(state), Some(drive)) =
                    (self.spindles.get_mut(index), limits.spindles.get(index))
                else {
                    return;
                };
                let cut = self.cut;
                let inward = ramp_heat(drive, &tap.inward, cut);
                let outward = ramp_heat(drive, &tap.outward, 0.0);
                state.spin = 0.0;
                let lasts = tap.inward.duration() + tap.outward.duration();
                state.takes(inward + outward, lasts, drive);
                self.passes(tap.dwell.value() + limits.settling.value());
            }
            _ => {}
        }
    }

    /// The drives that are overloaded, if anything has warmed since the last call.
    pub(crate) fn overloads(&mut self, limits: &MachineLimits) -> [Option<Torque>; SPINDLES] {
        if !core::mem::take(&mut self.fresh) {
            return [None; SPINDLES];
        }
        core::array::from_fn(|index| {
            let drive = limits.spindles.get(index)?;
            let torque = Torque::n_m(libm::sqrt(self.spindles[index].most));
            (torque > drive.continuous_torque).then_some(torque)
        })
    }
}

impl Warm {
    /// So much of M²·t in so much time.
    fn takes(&mut self, heat: f64, time: f64, drive: &SpindleLimits) {
        let constant = drive.thermal_time.value();
        if constant <= 0.0 || !(constant + heat + time).is_finite() {
            return;
        }
        let steps = libm::ceil(time / (COARSE * constant)).clamp(1.0, 64.0);
        let (heat, time) = (heat / steps / constant, time / steps / constant);
        for _ in 0..steps as u32 {
            // exact for a torque that does not change within the step
            let fades = libm::exp(-time);
            let share = if time > 0.0 { (1.0 - fades) / time } else { 1.0 };
            self.mean = self.mean * fades + heat * share;
        }
        self.most = self.most.max(self.mean);
    }
}

fn friction(drive: &SpindleLimits, spin: f64) -> f64 {
    if spin == 0.0 {
        return 0.0;
    }
    drive.friction.value() + drive.viscous_n_m_s_per_rad * spin.abs() * TAU
}

/// ∫M²·dt along a profile of the speed; `cut` resists it all the way.
fn ramp_heat(drive: &SpindleLimits, profile: &Profile, cut: f64) -> f64 {
    let lasts = profile.duration();
    if lasts <= 0.0 || !lasts.is_finite() {
        return 0.0;
    }
    let slice = lasts / f64::from(SLICES);
    let inertia = drive.inertia.value() * TAU;
    let most = |spin: Spin| {
        let by_power = drive.peak_power.value() / spin.abs().in_rad_per_s().max(f64::MIN_POSITIVE);
        drive.peak_torque.value().min(by_power)
    };
    let mut heat = 0.0;
    for k in 0..SLICES {
        let at = profile.at((f64::from(k) + 0.5) * slice);
        let speed = at.v;
        let rubs = friction(drive, speed) * speed.signum();
        let limit = most(Spin::rev_per_s(speed));
        let torque = (inertia * at.a + rubs + cut).clamp(-limit, limit);
        heat += torque * torque * slice;
    }
    heat
}
