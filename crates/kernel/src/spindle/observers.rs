//! How a spindle turns, by its encoder: as quickly as its counts allow, and so smoothly that an
//! axis can follow it.
//!
//! Decisions, windows and alarms go by the quick one. A follower's setpoint has each count of it as
//! an acceleration of α·q/h² ([`sync::SmoothObserver`]): where that is much, it goes by the smooth
//! one, which is told what a speed-commanded drive is about to do.
use super::SpindleLoop;
use crate::config::SpindleControl;
use core::f64::consts::TAU;
use sync::{DriveRamp, Observer, Rotation, SmoothObserver, Tracker};
use units::{Angle, Spin, SpinAccel, Time};

/// Share of the at-rest window that quantisation may cost the observer as noise.
const REST_NOISE: f64 = 0.25;
/// Share of the spindle's own acceleration that the counts of its encoder may cost a follower.
const FOLLOWER_NOISE: f64 = 0.2;

/// The observers of one spindle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observers {
    quick: Observer,
    smooth: Option<SmoothObserver>,
    /// The drive makes its own ramps: the model of it.
    ramp: Option<DriveRamp>,
    /// Period, and delay of a command.
    times: (Time, Time),
}

impl Observers {
    /// Of a spindle at rest at `angle`; with the period, and the delay of a command.
    pub(super) fn new(control: &SpindleControl, times: (Time, Time), angle: Angle) -> Self {
        let (period, command_delay) = times;
        let count = control.encoder_count;
        // no faster than that the encoder's counts would blur what "at rest" means
        let noise = control.windows.at_rest.value() * REST_NOISE;
        let quiet = Tracker::bandwidth_for(period.value(), count.value(), noise);
        let quick = Observer::new(period, control.observer_bandwidth_hz.min(quiet), angle);
        let accel = control.own_ramps.map_or_else(
            || control.peak_torque.value() / (control.inertia.value() * TAU),
            |own| own.accel.max(own.decel).value(),
        );
        let most = SpinAccel::rev_per_s2(FOLLOWER_NOISE * accel);
        let shakes = quick.count_accel(count) > most;
        Self {
            quick,
            smooth: shakes.then(|| SmoothObserver::new(period, count, most, angle)),
            ramp: control
                .own_ramps
                .map(|own| DriveRamp::new(own.delay + command_delay, own.accel, own.decel)),
            times,
        }
    }

    /// As if made now, of a spindle at rest at `angle`.
    pub(super) fn anew(&self, control: &SpindleControl, angle: Angle) -> Self {
        Self::new(control, self.times, angle)
    }

    /// Take a reading, and the acceleration that a drive which obeys it is ordered.
    pub(super) fn read(&mut self, measured: Angle, ordered: SpinAccel) {
        self.quick.update(measured, ordered);
        let Some(smooth) = &mut self.smooth else { return };
        let (spin, period) = (smooth.now().spin, self.times.0);
        smooth.update(
            measured,
            self.ramp.as_mut().map_or(ordered, |ramp| ramp.advance(period, spin)),
        );
    }

    /// The drive is told a speed.
    pub(super) fn tell(&mut self, spin: Spin) {
        if let Some(ramp) = &mut self.ramp {
            ramp.tell(spin);
        }
    }

    /// How it turns.
    pub(super) fn now(&self) -> Rotation {
        self.quick.now()
    }

    /// How it turns, for an axis that follows it.
    pub(super) fn followed(&self) -> Rotation {
        self.smooth.map_or_else(|| self.now(), |smooth| smooth.now())
    }

    /// A spindle that stands is seen to stand by a follower as well: the smooth one has learnt what
    /// a drive with ramps of its own did differently from the model. One that obeys does what the
    /// smooth one is told.
    fn agree(&self) -> bool {
        let learns = self.smooth.filter(|_| self.ramp.is_some());
        learns.is_none_or(|smooth| smooth.stands())
    }
}

impl SpindleLoop {
    /// It stands, also as an axis that follows it has it: that axis may go to where it stands.
    pub(crate) fn stands_for_follower(&self) -> bool {
        self.at_rest() && self.observers.agree()
    }
}
