//! A polygon before it is cut: paths of the tips, the cross-section, the facet's error, flatness
//! over speed.
use super::section::{document, section};
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag};

/// A line with a name.
pub type Named = (String, Vec<(f64, f64)>);

/// A side of the polygon as it comes out.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Where its normal points, from x towards y.
    pub normal_rad: f64,
    /// Of the flat from the work's axis, mm.
    pub distance: f64,
    /// Along it from the foot of the normal, mm, and over the flat, µm.
    pub profile: Vec<(f64, f64)>,
}

impl Side {
    /// In the work, with the error drawn so many times as large.
    fn drawn(&self, times: f64) -> Vec<(f64, f64)> {
        let (sine, cosine) = self.normal_rad.sin_cos();
        let place = |(s, e): &(f64, f64)| {
            let n = self.distance + e * 1e-3 * times;
            (n * cosine - s * sine, n * sine + s * cosine)
        };
        self.profile.iter().map(place).collect()
    }
}

/// What is drawn and told. Lengths in mm, errors in µm, speeds in rev/min.
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonPlan {
    /// Heading of the page.
    pub title: String,
    /// Sentences under it.
    pub words: Vec<String>,
    /// Heads and rows of the table of actuators.
    pub heads: Vec<String>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
    /// Path of each tip in the work's frame.
    pub tips: Vec<Vec<(f64, f64)>>,
    /// The bar.
    pub stock_radius: f64,
    /// Outline of the polygon wanted.
    pub outline: Vec<(f64, f64)>,
    /// Every side, without and with what swings.
    pub sides: Vec<(String, Vec<Side>)>,
    /// Speed, and flatness in µm.
    pub speeds: Vec<Named>,
    /// Heads of the table of what was cut on the simulated machine.
    pub proved_heads: Vec<String>,
    /// Its rows, if it was.
    pub proved: Vec<Vec<String>>,
    /// Speed, and flatness in µm that was cut.
    pub proved_speeds: Vec<Named>,
    /// Flatness that is wanted, µm.
    pub wanted: Option<f64>,
    /// The block to use.
    pub gcode: String,
}

/// As one HTML page: equal input gives an equal page.
pub fn polygon_html(plan: &PolygonPlan) -> String {
    let words: String = plan.words.iter().map(|w| Tag::new("p").text(w)).collect();
    let heading = Tag::new("h1").text(&plan.title) + &words;
    let pictures = paths(plan) + &magnified(plan) + &profiles(plan) + &speeds(plan) + &cut(plan);
    let main = heading
        + &section("Oscillating axes", &table(&plan.heads, &plan.rows))
        + &cut_table(plan)
        + &section("Pictures", &Tag::new("div").class("grid").around(&pictures))
        + &section("In the program", &Tag::new("pre").text(&plan.gcode));
    document(&plan.title, &main)
}

/// What was cut on the simulated machine, if it was, as a table.
fn cut_table(plan: &PolygonPlan) -> String {
    if plan.proved.is_empty() {
        return String::new();
    }
    section("Cut on the simulated machine", &table(&plan.proved_heads, &plan.proved))
}

/// The same as a picture.
fn cut(plan: &PolygonPlan) -> String {
    if plan.proved.is_empty() {
        return String::new();
    }
    let all = || plan.proved_speeds.iter().flat_map(|(_, p)| p);
    let x = Range::of("speed of the work / rpm", all().map(|p| p.0)).padded(0.02);
    let y = Range::of("flatness / µm", all().map(|p| p.1).chain([0.0])).padded(0.05);
    let description =
        "Flatness of the worst facet as cut on the simulated machine with all its physics.";
    let mut chart = Chart::new("Flatness as cut", description, x, y, 300.0);
    let strokes = [Stroke::Main, Stroke::Out, Stroke::Ideal];
    for (stroke, (name, line)) in strokes.into_iter().zip(&plan.proved_speeds) {
        chart.line(stroke, line, Some(name));
    }
    if let Some(wanted) = plan.wanted {
        chart.level(Stroke::Warn, wanted, "wanted");
    }
    figure("Flatness as cut", &chart.finish("cut"), description)
}

fn table(heads: &[String], rows: &[Vec<String>]) -> String {
    let cells = |tag: &'static str, row: &[String]| {
        let cell = |(i, text): (usize, &String)| {
            let cell = Tag::new(tag);
            if i == 0 { cell.class("l").text(text) } else { cell.text(text) }
        };
        Tag::new("tr").around(&row.iter().enumerate().map(cell).collect::<String>())
    };
    let body: String = rows.iter().map(|row| cells("td", row)).collect();
    let inside = Tag::new("thead").around(&cells("th", heads)) + &Tag::new("tbody").around(&body);
    let table = Tag::new("table").around(&inside);
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}

fn circle(radius: f64) -> Vec<(f64, f64)> {
    let at = |i: i32| f64::from(i) * std::f64::consts::TAU / 180.0;
    (0..=180).map(|i| (radius * at(i).cos(), radius * at(i).sin())).collect()
}

fn square(title: [&str; 2], half: f64) -> [Range; 2] {
    title.map(|title| Range::of(title, [-half, half]).padded(0.04))
}

fn paths(plan: &PolygonPlan) -> String {
    let half = plan.stock_radius * 1.25;
    let [x, y] = square(["x in the work / mm", "y / mm"], half);
    let description =
        "What each tip draws, seen from the work: only what lies inside the bar cuts.";
    let mut chart = Chart::to_scale("Paths of the tips", description, x, y);
    chart.line(Stroke::Ideal, &circle(plan.stock_radius), Some("bar"));
    let near = |p: &(f64, f64)| p.0.abs().max(p.1.abs()) < half;
    let mut tips: Vec<Vec<(f64, f64)>> = Vec::new();
    for path in &plan.tips {
        // the pieces that lie inside the picture
        let pieces = path.split(|p| !near(p)).filter(|piece| piece.len() > 1);
        tips.extend(pieces.map(<[_]>::to_vec));
    }
    chart.lines(Stroke::Main, &tips, Some("tips"));
    chart.line(Stroke::Second, &plan.outline, Some("polygon"));
    figure("Paths of the tips", &chart.finish("tips"), description)
}

/// The outline, with the error of every facet drawn many times as large.
fn magnified(plan: &PolygonPlan) -> String {
    let all = plan.sides.iter().flat_map(|(_, sides)| sides).flat_map(|side| &side.profile);
    let most = all.map(|p| p.1.abs()).fold(1e-6, f64::max);
    let size = plan.outline.iter().map(|p| p.0.hypot(p.1)).fold(0.0, f64::max);
    let times = 10_f64.powf((0.12 * size / (most * 1e-3)).log10().floor()).max(1.0);
    let [x, y] = square(["x in the work / mm", "y / mm"], size * 1.1);
    let description =
        format!("Cross-section; errors of the facets drawn {times:.0} times as large.");
    let mut chart = Chart::to_scale("Cross-section", &description, x, y);
    chart.line(Stroke::Ideal, &plan.outline, Some("flat"));
    for (stroke, (name, sides)) in [Stroke::Second, Stroke::Main].into_iter().zip(&plan.sides) {
        let lines: Vec<_> = sides.iter().map(|side| side.drawn(times)).collect();
        chart.lines(stroke, &lines, Some(name));
    }
    figure("Cross-section", &chart.finish("section"), &description)
}

/// The facets one over the other: one line where all are alike.
fn profiles(plan: &PolygonPlan) -> String {
    let all = || plan.sides.iter().flat_map(|(_, sides)| sides).flat_map(|side| &side.profile);
    let x = Range::of("along the facet / mm", all().map(|p| p.0));
    let y = Range::of("over the flat / µm", all().map(|p| p.1)).padded(0.08);
    let description = "The facets across, one over the other: what the oscillation takes away.";
    let mut chart = Chart::new("Facets", description, x, y, 300.0);
    chart.zero(false);
    for (stroke, (name, sides)) in [Stroke::Second, Stroke::Main].into_iter().zip(&plan.sides) {
        let lines: Vec<_> = sides.iter().map(|side| side.profile.clone()).collect();
        chart.lines(stroke, &lines, Some(name));
    }
    figure("Facets", &chart.finish("facet"), description)
}

fn speeds(plan: &PolygonPlan) -> String {
    let all = || plan.speeds.iter().flat_map(|(_, p)| p);
    let x = Range::of("speed of the work / rpm", all().map(|p| p.0)).padded(0.02);
    let y = Range::of("flatness / µm", all().map(|p| p.1).chain([0.0])).padded(0.05);
    let description = "The flattest that each actuator can follow within its limits.";
    let mut chart = Chart::new("Flatness over speed", description, x, y, 300.0);
    let strokes = [
        Stroke::Main,
        Stroke::Out,
        Stroke::Second,
        Stroke::Capability,
        Stroke::Share,
        Stroke::Stop,
        Stroke::Ideal,
    ];
    for (stroke, (name, line)) in strokes.into_iter().zip(&plan.speeds) {
        chart.line(stroke, line, Some(name));
    }
    if let Some(wanted) = plan.wanted {
        chart.level(Stroke::Warn, wanted, "wanted");
    }
    figure("Flatness over speed", &chart.finish("speeds"), description)
}
