//! A hobbed gear: where each tooth stands beside where it belongs.
use super::figure::figure;
use crate::svg::{Chart, Range, Stroke};
use verify::Gear;

/// The picture, or nothing if it could not be measured.
pub(crate) fn gear(number: usize, gear: &Gear) -> String {
    if gear.places.is_empty() {
        return String::new();
    }
    // a step for each tooth
    let half = |tooth: usize, side: f64| tooth as f64 + 1.0 + side / 2.0;
    let line: Vec<(f64, f64)> = gear
        .places
        .iter()
        .enumerate()
        .flat_map(|(k, place)| [-1.0, 1.0].map(|side| (half(k, side), place.in_um())))
        .collect();
    let x = Range::of("tooth", [0.5, gear.places.len() as f64 + 0.5]);
    let y = Range::of("place on the pitch circle / µm", line.iter().map(|p| p.1)).padded(0.15);
    let [pitch, total, helix, profile] =
        [gear.pitch_deviation, gear.pitch_total, gear.helix_deviation, gear.profile_deviation]
            .map(units::Length::in_um);
    let [single, sum, slope, form] = gear.allowed.map(units::Length::in_um);
    let lead = gear.lead.zip(gear.lead_ordered).map_or(String::new(), |(cut, asked)| {
        format!("; lead {:.3} mm, {:.3} ordered", cut.value(), asked.value())
    });
    let size = gear.size.map_or(String::new(), |size| size_of(&size));
    let grade = gear.grade.map_or("beyond every grade".to_owned(), |n| format!("grade {n}"));
    let description = format!(
        "Each tooth at the middle of the face, beside where it belongs: single pitch off by {pitch:.2} of {single:.0} µm \
         allowed, total {total:.2} of {sum:.0}, helix slope {helix:.2} of {slope:.0}, profile {profile:.2} of {form:.0}{lead}: {grade}.{size}"
    );
    let mut chart = Chart::new("Teeth", &description, x, y, 300.0);
    chart.zero(false);
    chart.line(Stroke::Main, &line, Some("as generated"));
    figure(&gear.name(), &chart.finish(&format!("gear{number}")), &description)
}

/// Size of the teeth, in a sentence.
fn size_of(size: &verify::ToothSize) -> String {
    let [least, most] = size.span_allowed;
    let balls =
        size.over_balls.zip(size.over_balls_asked).map_or(String::new(), |(found, asked)| {
            format!(
                ", over balls of {:.3} mm {:.3} mm ({:.3} asked)",
                size.ball.value(),
                found.value(),
                asked.value()
            )
        });
    let tip = size.tip_diameter.map_or(String::new(), |tip| {
        format!(", tip {:.3} mm ({:.3} asked)", tip.value(), size.tip_diameter_asked.value())
    });
    format!(
        " Span over {} teeth {:.3} mm ({:.3} to {:.3} allowed){balls}, root {:.3} mm{tip}, at a distance of the axes of {:.3} mm.",
        size.spanned,
        size.span.value(),
        least.value(),
        most.value(),
        size.root_diameter.value(),
        size.distance.value()
    )
}
