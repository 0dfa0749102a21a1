//! How fast may a spindle be brought to speed in a tap? As its torque *and power* allow: a straight ramp
//! to 6000 rpm in 0.22 s would need more at the top than P/ω, and the synchronism would break there.
use examples::{Line, draw};
use plan::{AxisLimits, SpindleLimits, StrokeRequest};
use units::{
    Angle, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Inertia, Lead, Power, Speed, Spin,
    Time, Torque,
};

/// Torque that turns the spindle along a stroke, over its speed, on the way up.
fn torque(spindle: &SpindleLimits, force_ramp: Option<Time>) -> Vec<(f64, f64)> {
    let feed = AxisLimits {
        travel: None,
        rapid_speed: CoordinateSpeed::linear(Speed::mm_per_min(50_000.0)),
        feed_speed: CoordinateSpeed::linear(Speed::mm_per_min(30_000.0)),
        accel: CoordinateAccel::new(15_000.0),
        rapid_jerk: CoordinateJerk::new(8e5),
        feed_jerk: CoordinateJerk::new(8e5),
    };
    let stroke = StrokeRequest {
        revolutions: Angle::rev(30.0),
        spin: Spin::rpm(6000.0),
        lead: Lead::mm_per_rev(1.0),
        cut: Torque::ZERO,
        spindle_accel: None,
        force_ramp,
    }
    .plan(spindle, &feed);
    let instants =
        (0..600).map(|i| stroke.profile.at(stroke.profile.duration() * f64::from(i) / 600.0));
    let speeding_up = instants.take_while(|now| now.a >= 0.0);
    let inertia = spindle.inertia.value() * std::f64::consts::TAU;
    speeding_up.map(|now| (now.v * 60.0, inertia * now.a)).collect()
}

fn main() -> std::io::Result<()> {
    let spindle = SpindleLimits {
        inertia: Inertia::kg_m2(0.010),
        peak_torque: Torque::n_m(42.0),
        continuous_torque: Torque::n_m(20.0),
        thermal_time: Time::s(60.0),
        peak_power: Power::w(15_000.0),
        friction: Torque::n_m(0.3),
        viscous_n_m_s_per_rad: 0.0012,
        max_speed: Spin::rpm(10_000.0),
        tapping_max: Spin::rpm(6000.0),
        margin: 0.85,
        torque_rise: Time::s(0.006),
    };
    let curve = (1..=60).map(|i| f64::from(i) * 100.0).map(|rpm| {
        let by_power =
            spindle.peak_power.value() / (Spin::rpm(rpm).value() * std::f64::consts::TAU);
        (rpm, by_power.min(spindle.peak_torque.value()))
    });
    let lines = [
        Line { name: "planned", points: torque(&spindle, None) },
        Line { name: "forced into 0.22 s", points: torque(&spindle, Some(Time::s(0.22))) },
        Line { name: "what the drive can give", points: curve.collect() },
    ];
    let title = "An M6 at 6000 rpm: torque of the spindle while it comes to speed";
    draw("01-ramp-under-the-power-curve", title, ["spindle speed, rpm", "torque, N·m"], &lines)
}
