//! What cannot be meant in a [`Config`]: each finding names the field, its value and what would do.
//!
//! ```text
//!   axis Z: position_gain is NaN, expected a finite number above zero
//! ```
use crate::config::{AxisControl, Config, FeedForward, SpindleControl, Subject};
use sync::{DeviationPoint, MAX_TRANSPORT, SyncMode};
use units::Axis;

/// Something in a [`Config`] that cannot be meant: the field, what it is, and what it must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// Which axis or spindle, if it is one of theirs.
    pub of: Subject,
    /// The field.
    pub field: &'static str,
    /// Its value, in the base unit.
    pub value: f64,
    /// What it must be.
    pub must_be: &'static str,
}

impl core::fmt::Display for Problem {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}: {} is {}, expected {}", self.of, self.field, self.value, self.must_be)
    }
}

const POSITIVE: &str = "a finite number above zero";
const NOT_NEGATIVE: &str = "a finite number, zero or more";
const SLOWER_THAN_SAMPLING: &str = "above zero and below a tenth of the servo rate";
const SHARE: &str = "between 0 and 1.5";

impl Config {
    /// Report all that cannot be meant.
    pub fn problems(&self, mut report: impl FnMut(Problem)) {
        let rate_hz = 1.0 / self.period.value();
        let mut machine = |field, value: f64, good: bool, must_be| {
            if !good {
                report(Problem { of: Subject::Machine, field, value, must_be });
            }
        };
        machine("period", self.period.value(), positive(self.period.value()), POSITIVE);
        let delay = self.command_delay.value();
        machine("command_delay", delay, not_negative(delay), NOT_NEGATIVE);
        for (field, value) in [
            ("sync_windows.warn", self.sync_windows.warn.value()),
            ("sync_windows.stop", self.sync_windows.stop.value()),
            ("waits.ready", self.waits.ready.value()),
            ("waits.at_speed", self.waits.at_speed.value()),
            ("waits.oriented", self.waits.oriented.value()),
            ("waits.in_position", self.waits.in_position.value()),
            ("waits.tool_change", self.waits.tool_change.value()),
        ] {
            machine(field, value, positive(value), POSITIVE);
        }
        if let SyncMode::EncoderFollowing { transport, .. } = self.synchronisation {
            let good = transport <= MAX_TRANSPORT;
            machine("transport", f64::from(transport), good, "4 periods at most");
        }
        for (index, axis) in self.axes.iter().enumerate() {
            let Some(axis) = axis else { continue };
            let of = Subject::Axis(Axis::ALL[index]);
            axis.fields(rate_hz, |field, value, good, must_be| {
                if !good {
                    report(Problem { of, field, value, must_be });
                }
            });
        }
        for (index, axis) in self.compensation.axes.iter().enumerate() {
            let points = axis.as_ref().map_or(&[][..], |axis| &axis.table.points);
            let rises = |pair: &&[DeviationPoint]| pair[1].at.total_cmp(&pair[0].at).is_gt();
            let wrong = points.windows(2).find(|pair| !rises(pair));
            if let Some(pair) = wrong {
                let (of, value) = (Subject::Axis(Axis::ALL[index]), pair[1].at);
                let (field, must_be) = ("compensation.table", "positions that rise");
                report(Problem { of, field, value, must_be });
            }
        }
        for (index, spindle) in self.spindles.iter().enumerate() {
            let Some(spindle) = spindle else { continue };
            let of = Subject::Spindle(index as u8);
            spindle.fields(rate_hz, |field, value, good, must_be| {
                if !good {
                    report(Problem { of, field, value, must_be });
                }
            });
        }
    }
}

fn positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

fn not_negative(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

fn share(value: f64) -> bool {
    (0.0..=1.5).contains(&value)
}

type Check<'a> = &'a mut dyn FnMut(&'static str, f64, bool, &'static str);

impl FeedForward {
    fn fields(&self, check: Check) {
        check("feed_forward.speed", self.speed, share(self.speed), SHARE);
        check("feed_forward.accel", self.accel, share(self.accel), SHARE);
        check("feed_forward.friction", self.friction, share(self.friction), SHARE);
    }
}

impl AxisControl {
    fn fields(&self, rate_hz: f64, mut check: impl FnMut(&'static str, f64, bool, &'static str)) {
        let band = self.velocity_bandwidth_hz;
        check(
            "velocity_bandwidth_hz",
            band,
            positive(band) && band < rate_hz / 10.0,
            SLOWER_THAN_SAMPLING,
        );
        self.feed_forward.fields(&mut check);
        for (field, value) in [
            ("position_gain", self.position_gain),
            ("table_mass", self.table_mass.value()),
            ("friction.bristle_stiffness", self.friction.bristle_stiffness.value()),
            ("friction.stribeck", self.friction.stribeck.value()),
            ("stiffness", self.stiffness.value()),
            ("encoder.count", self.encoder.count.value()),
            ("encoder.motor_count", self.encoder.motor_count.map_or(1.0, units::Coordinate::value)),
            ("peak_force", self.peak_force.value()),
            ("approach speed", self.approach.0.value()),
            ("approach acceleration", self.approach.1.value()),
            ("windows.in_position", self.windows.in_position.value()),
            ("windows.following_warn", self.windows.following_warn.value()),
            ("windows.following_stop", self.windows.following_stop.value()),
        ] {
            check(field, value, positive(value), POSITIVE);
        }
        for (field, value) in [
            ("motor_mass", self.motor_mass.value()),
            ("friction.coulomb", self.friction.coulomb.value()),
            ("friction.breakaway", self.friction.breakaway.value()),
            ("friction.bristle_damping", self.friction.bristle_damping_n_s_per_m),
            ("friction.viscous", self.friction.viscous_n_s_per_m),
            ("backlash", self.backlash.value()),
            ("force_lag", self.force_lag.value()),
            ("windows.settle", self.windows.settle.value()),
        ] {
            check(field, value, not_negative(value), NOT_NEGATIVE);
        }
        let (from, to) =
            self.travel.unwrap_or((units::Coordinate::ZERO, units::Coordinate::new(1.0)));
        check("travel", from.value(), from < to, "its first end below its second one");
        let weight = self.weight.value();
        check("weight", weight, weight.is_finite(), "a finite number");
    }
}

impl SpindleControl {
    fn fields(&self, rate_hz: f64, mut check: impl FnMut(&'static str, f64, bool, &'static str)) {
        for (field, band) in [
            ("velocity_bandwidth_hz", self.velocity_bandwidth_hz),
            ("observer_bandwidth_hz", self.observer_bandwidth_hz),
        ] {
            check(field, band, positive(band) && band < rate_hz / 10.0, SLOWER_THAN_SAMPLING);
        }
        self.feed_forward.fields(&mut check);
        for (field, value) in [
            ("position_gain", self.position_gain),
            ("inertia", self.inertia.value()),
            ("friction.rounding", self.friction.rounding.value()),
            ("peak_torque", self.peak_torque.value()),
            ("peak_power", self.peak_power.value()),
            ("encoder_count", self.encoder_count.value()),
            ("orient speed", self.orient.0.value()),
            ("orient acceleration", self.orient.1.value()),
            ("windows.at_speed", self.windows.at_speed),
            ("windows.in_cut", self.windows.in_cut),
            ("windows.at_rest", self.windows.at_rest.value()),
            ("windows.oriented", self.windows.oriented.value()),
            ("windows.following_stop", self.windows.following_stop.value()),
        ] {
            check(field, value, positive(value), POSITIVE);
        }
        for (field, value) in [
            ("friction.coulomb", self.friction.coulomb.value()),
            ("friction.viscous", self.friction.viscous_n_m_s_per_rad),
            ("torque_lag", self.torque_lag.value()),
        ] {
            check(field, value, not_negative(value), NOT_NEGATIVE);
        }
        if let Some(own) = self.own_ramps {
            let (delay, decel) = (own.delay.value(), own.decel.value());
            check("own_ramps.delay", delay, not_negative(delay), NOT_NEGATIVE);
            check("own_ramps.decel", decel, positive(decel), POSITIVE);
            let accel = own.accel.value();
            check("own_ramps.accel", accel, positive(accel), POSITIVE);
            let uncertainty = own.uncertainty;
            check("own_ramps.uncertainty", uncertainty, not_negative(uncertainty), NOT_NEGATIVE);
            let (late, longer) = (own.repeats.0.value(), own.repeats.1);
            check("own_ramps.repeats.0", late, not_negative(late), NOT_NEGATIVE);
            check("own_ramps.repeats.1", longer, not_negative(longer), NOT_NEGATIVE);
            check("own_ramps.creep", own.creep, positive(own.creep), POSITIVE);
        }
    }
}
