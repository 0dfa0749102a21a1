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
    let [pitch, total, helix] =
        [gear.pitch_deviation, gear.pitch_total, gear.helix_deviation].map(units::Length::in_um);
    let [single, sum, slope] = gear.allowed.map(units::Length::in_um);
    let lead = gear.lead.zip(gear.lead_ordered).map_or(String::new(), |(cut, asked)| {
        format!("; lead {:.3} mm, {:.3} ordered", cut.value(), asked.value())
    });
    let grade = gear.grade.map_or("beyond every grade".to_owned(), |n| format!("grade {n}"));
    let description = format!(
        "Each tooth at the middle of the face, beside where it belongs: single pitch off by {pitch:.2} of {single:.0} µm \
         allowed, total {total:.2} of {sum:.0}, helix slope {helix:.2} of {slope:.0}{lead}: {grade}."
    );
    let mut chart = Chart::new("Teeth", &description, x, y, 300.0);
    chart.zero(false);
    chart.line(Stroke::Main, &line, Some("as generated"));
    figure(&gear.name(), &chart.finish(&format!("gear{number}")), &description)
}
