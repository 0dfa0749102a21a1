//! The map of holes: the work from above, to scale, each hole with its verdict.
//!
//! A hole is drilled and then tapped in the same place: what lies within a tenth of a millimetre is
//! one place, and the place is as good as the worst that was cut there. Good is a circle, bad a
//! crossed square, so that the map is read without colours too.
use super::figure;
use crate::Run;
use crate::svg::{Chart, Mark, Range, fixed};
use std::collections::BTreeMap;
use verify::{Feature, FeatureKind};

/// With more places than this only the bad ones and the first are numbered.
const ALL_NUMBERED: usize = 40;
/// Numbers that are drawn at most.
const MOST_NUMBERS: usize = 60;

/// One place on the work.
struct Place {
    at: (f64, f64),
    /// Largest diameter cut here, mm.
    diameter: f64,
    good: bool,
    /// Numbers (from 1) and names of what was cut here, and why it is bad.
    words: Vec<String>,
    number: usize,
}

fn places(run: &Run, features: &[Feature]) -> Vec<Place> {
    let [x0, y0, _] = run.zero();
    let mut by_cell: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let mut places: Vec<Place> = Vec::new();
    for (index, feature) in features.iter().enumerate() {
        let Some([x, y]) = feature.position().map(|at| at.map(units::Length::value)) else {
            continue;
        };
        if !(x.is_finite() && y.is_finite()) {
            continue;
        }
        let cell = ((x * 10.0).round() as i64, (y * 10.0).round() as i64);
        let at = *by_cell.entry(cell).or_insert(places.len());
        if at == places.len() {
            let at = (x - x0, y - y0);
            places.push(Place {
                at,
                diameter: 0.0,
                good: true,
                words: Vec::new(),
                number: index + 1,
            });
        }
        let place = &mut places[at];
        let (name, diameter) = match &feature.kind {
            FeatureKind::Hole(hole) => {
                (format!("hole ⌀{}", fixed(hole.diameter.value(), 2)), hole.diameter.value())
            }
            FeatureKind::Thread(thread) => (thread.size.clone(), thread.pitch_diameter.value()),
            FeatureKind::Polygon(polygon) => (polygon.name(), polygon.across_flats.value()),
            // not in the map: they have no place in it
            FeatureKind::Cam(cam) => (cam.name.clone(), 0.0),
            FeatureKind::Turned(thread) => (thread.name(), 0.0),
            FeatureKind::Gear(gear) => (gear.name(), 0.0),
        };
        place.good &= feature.verdict.is_pass();
        if diameter.is_finite() && diameter >= place.diameter {
            place.diameter = diameter;
            place.number = index + 1;
        }
        if !feature.verdict.is_pass() {
            place.number = index + 1;
        }
        let why = feature.verdict.reason().map_or(String::new(), |reason| format!(" – {reason}"));
        place.words.push(format!("{} {name}: {}{why}", index + 1, feature.verdict.name()));
    }
    places
}

/// The map, or nothing if nothing was cut.
pub(crate) fn hole_map(run: &Run, features: &[Feature]) -> String {
    let places = places(run, features);
    if places.is_empty() {
        return String::new();
    }
    let bad = places.iter().filter(|p| !p.good).count();
    let x = Range::of(&format!("X in {} / mm", run.frame()), places.iter().map(|p| p.at.0));
    let y = Range::of(&format!("Y in {} / mm", run.frame()), places.iter().map(|p| p.at.1));
    let margin = (0.1 * f64::max(x.to - x.from, y.to - y.from)).max(8.0);
    let grown = |r: Range| Range { from: r.from - margin, to: r.to + margin, ..r };
    let description = format!(
        "{} places seen from above, {bad} of them with something out of tolerance.",
        places.len()
    );
    let mut chart = Chart::to_scale("Map of holes with verdicts", &description, grown(x), grown(y));
    // the bad ones last, so that nothing hides them
    let (good, not_good): (Vec<_>, Vec<_>) = places.iter().partition(|p| p.good);
    for place in good.iter().chain(&not_good) {
        draw(&mut chart, place);
    }
    number(&mut chart, &good, &not_good, places.len() <= ALL_NUMBERED);
    chart.legend("mark pass", "circle: every cut here is within tolerance");
    chart.legend("mark fail", "crossed square: something is not");
    let caption = "Seen from above, to scale; a number is the feature's in the table below, and a pointer that rests on a \
        sign shows what was cut there. Failures that lie together point to the work or its clamping, failures \
        along the order of cutting to the tool.";
    figure("Map of holes", &chart.finish("map"), caption)
}

fn draw(chart: &mut Chart, place: &Place) {
    let to_scale = place.diameter / 2.0 * chart.units_per_x();
    let (class, least) = if place.good { ("mark pass", 3.0) } else { ("mark fail", 5.0) };
    let radius = if to_scale.is_finite() { to_scale.clamp(least, 30.0) } else { least };
    let title =
        format!("X{} Y{}\n{}", fixed(place.at.0, 3), fixed(place.at.1, 3), place.words.join("\n"));
    chart.mark(&Mark { at: place.at, radius, class, title: &title, crossed: !place.good });
}

fn number(chart: &mut Chart, good: &[&Place], bad: &[&Place], all: bool) {
    let first = good.iter().take(if all { good.len() } else { 1 });
    for place in bad.iter().chain(first).take(MOST_NUMBERS) {
        let radius = (place.diameter / 2.0 * chart.units_per_x()).clamp(5.0, 30.0);
        let sign = if place.good { "" } else { "✗ " };
        chart.word(
            place.at,
            (0.0, -radius - 3.0),
            "name middle",
            &format!("{sign}{}", place.number),
        );
    }
}
