//! A turned polygon: its cross-section with the error of the facets magnified, and its facets one
//! over the other.
use super::figure::figure;
use crate::svg::{Chart, Range, Stroke};
use verify::{Facet, Polygon, Section};

/// Less than this along Z, µm or degrees a millimetre, was not ordered.
const LEVEL: f64 = 1e-6;

/// Both pictures of a polygon, or nothing if it could not be measured.
pub(crate) fn polygon(number: usize, polygon: &Polygon) -> String {
    let worst = polygon.sections.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
    worst.map_or_else(String::new, |section| {
        cross_section(number, polygon, section) + &facets(number, polygon, section)
    })
}

/// Flatness of the worst facet, µm.
fn of(section: &Section) -> f64 {
    section.facets.iter().map(|f| f.flatness.in_um()).fold(0.0, f64::max)
}

/// Along the facet, mm, and over its own middle line, µm.
fn errors(facet: &Facet) -> Vec<(f64, f64)> {
    let slope = -facet.tilt.in_rad().tan();
    let middle = facet.distance.value() / facet.tilt.in_rad().cos();
    let over =
        |[s, n]: &[units::Length; 2]| (s.value(), (n.value() - middle - slope * s.value()) * 1e3);
    facet.profile.iter().map(over).collect()
}

fn cross_section(number: usize, polygon: &Polygon, section: &Section) -> String {
    let size =
        section.outline().iter().map(|p| p[0].value().hypot(p[1].value())).fold(0.0, f64::max);
    let most = section.facets.iter().flat_map(errors).map(|p| p.1.abs()).fold(1e-6, f64::max);
    let times = 10_f64.powf((0.12 * size / (most * 1e-3)).log10().floor()).max(1.0);
    let drawn = |facet: &Facet, times: f64| {
        let (sine, cosine) = facet.normal.in_rad().sin_cos();
        let d = facet.distance.value();
        let turned = move |(s, e): (f64, f64)| {
            let n = d + e * 1e-3 * times;
            (n * cosine - s * sine, n * sine + s * cosine)
        };
        errors(facet).into_iter().map(turned).collect::<Vec<_>>()
    };
    let [x, y] =
        ["x in the work / mm", "y / mm"].map(|title| Range::of(title, [-size, size]).padded(0.08));
    let description = format!(
        "Cross-section {:.1} mm from the end; errors of the facets drawn {times:.0} times as large.",
        (section.z - polygon.z_from).value()
    );
    let title = polygon.name();
    let mut chart = Chart::to_scale(&title, &description, x, y);
    let flat: Vec<_> = section.facets.iter().map(|f| drawn(f, 0.0)).collect();
    let real: Vec<_> = section.facets.iter().map(|f| drawn(f, times)).collect();
    chart.lines(Stroke::Ideal, &flat, Some("flat"));
    chart.lines(Stroke::Main, &real, Some("as cut"));
    figure(&title, &chart.finish(&format!("polygon{number}")), &description)
}

/// Taper and twist, where one was ordered.
fn along(polygon: &Polygon) -> String {
    let (cut, asked) = (polygon.along, polygon.along_ordered);
    let taper = (asked.across_flats.in_um().abs() > LEVEL).then(|| {
        let [cut, asked] = [cut, asked].map(|a| a.across_flats.in_um());
        format!("; {cut:.3} µm wider across flats with each millimetre of Z, {asked:.3} ordered")
    });
    let twist = (asked.turn.in_deg().abs() > LEVEL).then(|| {
        let [cut, asked] = [cut, asked].map(|a| a.turn.in_deg());
        format!("; turned by {cut:.4}° with each millimetre of Z, {asked:.4}° ordered")
    });
    taper.unwrap_or_default() + &twist.unwrap_or_default()
}

fn facets(number: usize, polygon: &Polygon, section: &Section) -> String {
    let lines: Vec<_> = section.facets.iter().map(errors).collect();
    let all = || lines.iter().flatten();
    let x = Range::of("along the facet / mm", all().map(|p| p.0));
    let y = Range::of("off the middle line / µm", all().map(|p| p.1)).padded(0.1);
    let description = format!(
        "All {} facets, one over the other: flat to {:.2} µm, tilted by {:.3}° at most, {:.2} µm between the nearest and the \
         farthest; the feed leaves marks of {:.2} µm along Z{}.",
        polygon.sides,
        polygon.flatness.in_um(),
        polygon.tilt.in_deg().abs(),
        polygon.facet_difference.in_um(),
        polygon.lay.in_um(),
        along(polygon)
    );
    let mut chart = Chart::new("Facets", &description, x, y, 300.0);
    chart.zero(false);
    chart.lines(Stroke::Main, &lines, Some("facets"));
    figure("Facets", &chart.finish(&format!("facets{number}")), &description)
}
