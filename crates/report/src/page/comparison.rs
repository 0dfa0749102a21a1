//! Two ways of tapping side by side: how deep each of many holes became, and how much that
//! scatters.
use super::section::{document, section};
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag, escape, fixed};

/// One way of tapping, over many holes.
#[derive(Clone, Debug, PartialEq)]
pub struct TappingMethod {
    /// What it is called.
    pub name: String,
    /// Depth error of each hole, mm; plus is too deep.
    pub depth_errors_mm: Vec<f64>,
    /// Holes whose thread failed, of those that were cut.
    pub failed: usize,
    /// Why, of the first of them.
    pub why_failed: Option<String>,
    /// Holes that were not cut, or in which the tap broke: they are in no figure.
    pub not_cut: usize,
    /// Why, of the first of them.
    pub why_not: Option<String>,
}

/// Both ways, and what they were driven with.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Heading of the page.
    pub title: String,
    /// What scattered, in a sentence.
    pub scatter: String,
    /// The ways.
    pub ways: Vec<TappingMethod>,
}

impl TappingMethod {
    /// Mean of the depth errors, mm.
    pub fn mean_mm(&self) -> f64 {
        self.depth_errors_mm.iter().sum::<f64>() / self.depth_errors_mm.len().max(1) as f64
    }

    /// Their standard deviation, mm, with n − 1.
    pub fn sigma_mm(&self) -> f64 {
        let (mean, n) = (self.mean_mm(), self.depth_errors_mm.len());
        let squares: f64 = self.depth_errors_mm.iter().map(|e| (e - mean).powi(2)).sum();
        (squares / n.saturating_sub(1).max(1) as f64).sqrt()
    }
}

/// The comparison as one HTML page: equal input gives an equal page.
pub fn comparison_html(comparison: &Comparison) -> String {
    let heading = Tag::new("h1").text(&comparison.title) + &Tag::new("p").text(&comparison.scatter);
    let pictures: String =
        comparison.ways.iter().enumerate().map(|(i, way)| picture(i, way)).collect();
    let main = heading
        + &section("Depth scatter", &table(&comparison.ways))
        + &section("Hole by hole", &Tag::new("div").class("grid").around(&pictures));
    document(&comparison.title, &main)
}

fn table(ways: &[TappingMethod]) -> String {
    let head = "<thead><tr><th class=\"l\">cycle</th><th>holes</th><th>depth error, mean<small>mm</small></th><th>scatter, 1σ<small>µm</small></th><th>least<small>mm</small></th><th>largest<small>mm</small></th><th>not cut</th></tr></thead>";
    let rows: String = ways.iter().map(row).collect();
    let table = Tag::new("table").around(&(head.to_owned() + &Tag::new("tbody").around(&rows)));
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}

fn row(way: &TappingMethod) -> String {
    let (least, largest) = way
        .depth_errors_mm
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    let cells = [
        way.depth_errors_mm.len().to_string(),
        fixed(way.mean_mm(), 3),
        fixed(way.sigma_mm() * 1e3, 2),
        fixed(least, 3),
        fixed(largest, 3),
        way.not_cut.to_string(),
    ];
    let cells: String = cells.iter().map(|cell| Tag::new("td").text(cell)).collect();
    let whys = [&way.why_failed, &way.why_not].into_iter().flatten();
    let why: String = whys.map(|why| Tag::new("div").text(why)).collect();
    let name = escape(&way.name) + &why;
    Tag::new("tr").around(&(Tag::new("td").class("l").around(&name) + &cells))
}

/// Each hole's depth off the mean, in units that show the scatter.
fn picture(index: usize, way: &TappingMethod) -> String {
    let (mean, sigma_um) = (way.mean_mm(), way.sigma_mm() * 1e3);
    let off: Vec<_> = (1..)
        .zip(&way.depth_errors_mm)
        .map(|(hole, e)| (f64::from(hole), (e - mean) * 1e3))
        .collect();
    let x = Range::of("hole", [0.0, off.len() as f64 + 1.0]);
    let most = off.iter().map(|p| p.1.abs()).fold(1e-3, f64::max);
    let y = Range::of("depth less the mean / µm", [-most, most]).padded(0.1);
    let description = format!(
        "{}: {} holes, mean depth error {} mm, 1σ {} µm.",
        way.name,
        off.len(),
        fixed(mean, 3),
        fixed(sigma_um, 2)
    );
    let mut chart = Chart::new(&way.name, &description, x, y, 260.0);
    chart.zero(false);
    chart.limits(Stroke::Capability, sigma_um, "1σ");
    chart.dots(&off, "holes");
    figure(&way.name, &chart.finish(&format!("w{index}")), &description)
}
