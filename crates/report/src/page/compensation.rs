//! Ways of compensating a cam's phase error side by side: contour errors over cams and speeds.
use super::section::{document, section};
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag, fixed};

/// What one way leaves of the contour error.
#[derive(Clone, Debug, PartialEq)]
pub struct WayOfCompensation {
    /// Largest contour error, µm.
    pub contour_um: f64,
    /// Its root mean square, µm.
    pub rms_um: f64,
    /// The error at equal steps of the profile's angle, µm.
    pub errors_um: Vec<f64>,
}

/// A cam at a speed.
#[derive(Clone, Debug, PartialEq)]
pub struct CompensationRow {
    /// Number of the profile.
    pub profile: u32,
    /// Its name.
    pub name: String,
    /// Speed of the work, rev/min.
    pub rpm: f64,
    /// The phase error by least squares, by the flanks, by the maximum, degrees.
    pub shifts_deg: [f64; 3],
    /// Greatest removal rate over its mean.
    pub removal_peak: f64,
    /// One for each way.
    pub ways: Vec<WayOfCompensation>,
}

/// The comparison.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompensationPage {
    /// Heading.
    pub title: String,
    /// Names of the ways.
    pub ways: Vec<String>,
    /// Cams and speeds.
    pub rows: Vec<CompensationRow>,
    /// What a reader must know.
    pub notes: Vec<String>,
}

/// Micrometres with as many decimals as they are worth.
pub fn um_figure(um: f64) -> String {
    let decimals = match um {
        x if x >= 100.0 => 0,
        x if x >= 10.0 => 1,
        x if x >= 1.0 => 2,
        _ => 3,
    };
    fixed(um, decimals)
}

/// The page: equal input gives an equal page.
pub fn compensation_html(page: &CompensationPage) -> String {
    let notes: String = page.notes.iter().map(|note| Tag::new("p").text(note)).collect();
    let mut names: Vec<&str> = Vec::new();
    for row in &page.rows {
        if !names.contains(&row.name.as_str()) {
            names.push(&row.name);
        }
    }
    let pictures: String = names
        .iter()
        .enumerate()
        .map(|(i, name)| over_speed(i, name, page) + &left(i, name, page))
        .collect();
    let main = Tag::new("h1").text(&page.title)
        + &section("Contour error by method", &(table(page) + &notes))
        + &section("Cam by cam", &Tag::new("div").class("grid").around(&pictures));
    document(&page.title, &main)
}

fn table(page: &CompensationPage) -> String {
    let head = |name: &str, unit: &str| {
        Tag::new("th").around(&(name.to_owned() + &Tag::new("small").text(unit)))
    };
    let mut heads = Tag::new("th").class("l").text("cam") + &head("speed", "rpm");
    for name in ["phase error, least squares", "by the flanks", "by the maximum"] {
        heads += &head(name, "°");
    }
    for way in &page.ways {
        heads += &head(way, "µm");
    }
    let rows: String = page
        .rows
        .iter()
        .map(|row| {
            let shifts = row.shifts_deg.iter().map(|deg| fixed(*deg, 4));
            let errors = row.ways.iter().map(|way| um_figure(way.contour_um));
            let cells = std::iter::once(fixed(row.rpm, 0)).chain(shifts).chain(errors);
            let cells: String = cells.map(|cell| Tag::new("td").text(&cell)).collect();
            Tag::new("tr").around(&(Tag::new("td").class("l").text(&row.name) + &cells))
        })
        .collect();
    let head = Tag::new("thead").around(&Tag::new("tr").around(&heads));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&rows)));
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}

/// Strokes of the ways that are drawn: uncompensated, shift, harmonics, after learning.
const DRAWN: [(usize, Stroke); 4] =
    [(0, Stroke::Stop), (3, Stroke::Out), (4, Stroke::Second), (5, Stroke::Main)];

fn over_speed(index: usize, name: &str, page: &CompensationPage) -> String {
    let of = |way: usize| -> Vec<(f64, f64)> {
        let rows = page.rows.iter().filter(|row| row.name == name);
        rows.filter_map(|row| Some((row.rpm, row.ways.get(way)?.contour_um.log10()))).collect()
    };
    let all: Vec<_> = DRAWN.iter().flat_map(|(way, _)| of(*way)).collect();
    let x =
        Range::of("speed of the work / rev/min", all.iter().map(|p| p.0).chain([0.0])).padded(0.03);
    let y = Range::of("error / µm", all.iter().map(|p| p.1)).padded(0.08).powers_of_ten();
    let heading = format!("{name}: what each way leaves");
    let caption =
        "The largest contour error over the speed of the work; the scale of errors is logarithmic.";
    let mut chart = Chart::new(&heading, caption, x, y, 260.0);
    for (way, stroke) in DRAWN {
        chart.line(stroke, &of(way), page.ways.get(way).map(String::as_str));
    }
    figure(&heading, &chart.finish(&format!("cs{index}")), caption)
}

/// What the better ways leave, over the angle, at the highest speed.
fn left(index: usize, name: &str, page: &CompensationPage) -> String {
    let Some(row) = page.rows.iter().rfind(|row| row.name == name) else { return String::new() };
    let points = |way: usize| -> Vec<(f64, f64)> {
        let errors = row.ways.get(way).map_or(&[][..], |way| &way.errors_um);
        let step = 360.0 / errors.len().max(1) as f64;
        (0..).zip(errors).map(|(i, e)| (f64::from(i) * step, *e)).collect()
    };
    let shown = &DRAWN[2..];
    let most =
        shown.iter().flat_map(|(way, _)| points(*way)).map(|p| p.1.abs()).fold(0.01, f64::max);
    let x =
        Range { title: "angle / °".into(), from: 0.0, to: 360.0, powers: false, counted: false };
    let y = Range::of("contour error / µm", [-most, most]).padded(0.08);
    let heading = format!("{name} at {} rpm, unrolled", fixed(row.rpm, 0));
    let caption = "What harmonics and learning leave, over the angle of the profile.";
    let mut chart = Chart::new(&heading, caption, x, y, 260.0);
    chart.zero(false);
    for (way, stroke) in shown {
        chart.line(*stroke, &points(*way), page.ways.get(*way).map(String::as_str));
    }
    figure(&heading, &chart.finish(&format!("cl{index}")), caption)
}
