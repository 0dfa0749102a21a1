//! A feed that follows a measured spindle is late: by v/Kp + v·Ts with its position loop alone, by v·Ts with speed
//! feed-forward, hardly at all with a prediction. In the material that is the width of the thread's groove.
use examples::{Line, draw};
use sync::Prediction;
use units::{Lead, Spin, Time};

fn main() -> std::io::Result<()> {
    let (lead, gain_per_s, age) = (Lead::mm_per_rev(1.0), 80.0, Time::s(250e-6));
    let over_speed = |prediction: Prediction| {
        let lag = |rpm: f64| prediction.lag(lead * Spin::rpm(rpm), gain_per_s, age).in_um();
        (0..=60)
            .map(|i| f64::from(i) * 100.0)
            .map(|rpm| (rpm, lag(rpm).max(1e-3).log10()))
            .skip(1)
            .collect()
    };
    let lines = [
        Line { name: "position loop alone", points: over_speed(Prediction::None) },
        Line { name: "with speed feed-forward", points: over_speed(Prediction::Speed) },
    ];
    let title = "An M6 behind its spindle: lag, µm, as a power of ten";
    draw(
        "03-what-a-lag-does-to-a-tap",
        title,
        ["spindle speed, rpm", "log10 of the lag in µm"],
        &lines,
    )
}
