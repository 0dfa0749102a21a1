//! What commissioning found of a machine: values with intervals, what they mean, and pictures.
use super::section::{document, grid, section};
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag};

/// A value that was found, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct CommissionRow {
    /// What it is.
    pub name: String,
    /// Key of the machine's file; empty: none.
    pub key: String,
    /// With its interval.
    pub value: String,
    /// Its unit.
    pub unit: &'static str,
    /// What the file said.
    pub old: String,
    /// From the file's value.
    pub difference: String,
    /// At the tool, µm.
    pub effect: String,
    /// How that is computed.
    pub effect_of: &'static str,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum CommissionPicture {
    /// Friction over speed, mm/s and N.
    Friction {
        /// Letter of the axis.
        letter: char,
        /// As measured.
        measured: Vec<(f64, f64)>,
        /// By the values found.
        fitted: Vec<(f64, f64)>,
        /// By the file.
        file: Vec<(f64, f64)>,
    },
    /// Speed of a spindle over time, s and rev/min.
    Ramp {
        /// Its name.
        name: String,
        /// As its encoder has it.
        speed: Vec<(f64, f64)>,
        /// As commanded.
        commanded: Vec<(f64, f64)>,
    },
    /// A circle, magnified.
    Circle {
        /// Its radius and feed.
        heading: String,
        /// When, and the radius less the programmed one, µm, over the angle, degrees.
        curves: Vec<(&'static str, Vec<(f64, f64)>)>,
    },
}

/// The page's content.
#[derive(Clone, Debug, PartialEq)]
pub struct CommissionPage {
    /// Heading.
    pub title: String,
    /// True where every value was found, and a sentence.
    pub verdict: (bool, String),
    /// When and on what.
    pub facts: String,
    /// Values.
    pub rows: Vec<CommissionRow>,
    /// What could not be judged.
    pub notes: Vec<String>,
    /// Circles of the proof; the first row has the headings. Empty: none.
    pub circles: Vec<Vec<String>>,
    /// Taps in air, likewise.
    pub taps: Vec<Vec<String>>,
    /// Pictures.
    pub pictures: Vec<CommissionPicture>,
}

/// The page: equal input gives an equal page.
pub fn commission_html(page: &CommissionPage) -> String {
    let (whole, says) = &page.verdict;
    let (class, sign) = if *whole { ("verdict pass", "✓") } else { ("verdict unjudged", "!") };
    let verdict = Tag::new("div").class(class).around(
        &(Tag::new("span").class("sign").text(sign) + &Tag::new("span").class("word").text(says)),
    );
    let notes: String = page.notes.iter().map(|note| Tag::new("li").text(note)).collect();
    let notes = if notes.is_empty() { notes } else { Tag::new("ul").class("list").around(&notes) };
    let pictures: String =
        page.pictures.iter().enumerate().map(|(i, one)| picture(&format!("c{i}"), one)).collect();
    let values = if page.rows.is_empty() { String::new() } else { table(&page.rows) };
    let main = Tag::new("h1").text(&page.title)
        + &verdict
        + &Tag::new("p").class("facts").text(&page.facts)
        + &notes
        + &section("Values", &values)
        + &section("Proof", &(plain(&page.circles) + &plain(&page.taps)))
        + &section("Pictures", &grid(&pictures));
    document(&page.title, &main)
}

fn table(rows: &[CommissionRow]) -> String {
    let head = |name: &str, unit: &str| {
        Tag::new("th").around(&(name.to_owned() + &Tag::new("small").text(unit)))
    };
    let heads = Tag::new("th").class("l").text("value")
        + &head("found", "± 95 %")
        + &Tag::new("th").class("l").text("unit")
        + &head("file", "")
        + &head("difference", "")
        + &head("at the tool", "µm")
        + &Tag::new("th").class("l").text("what that is");
    let rows: String = rows.iter().map(row).collect();
    let head = Tag::new("thead").around(&Tag::new("tr").around(&heads));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&rows)));
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}

fn row(row: &CommissionRow) -> String {
    let key = if row.key.is_empty() {
        String::new()
    } else {
        Tag::new("div").around(&Tag::new("code").text(&row.key))
    };
    let name = Tag::new("span").text(&row.name) + &key;
    let cells = Tag::new("td").class("l wide").around(&name)
        + &Tag::new("td").text(&row.value)
        + &Tag::new("td").class("l").text(row.unit)
        + &Tag::new("td").text(&row.old)
        + &Tag::new("td").text(&row.difference)
        + &Tag::new("td").text(&row.effect)
        + &Tag::new("td").class("l wide").text(row.effect_of);
    Tag::new("tr").around(&cells)
}

fn picture(id: &str, picture: &CommissionPicture) -> String {
    match picture {
        CommissionPicture::Friction { letter, measured, fitted, file } => {
            friction(id, *letter, [measured, fitted, file])
        }
        CommissionPicture::Ramp { name, speed, commanded } => ramp(id, name, speed, commanded),
        CommissionPicture::Circle { heading, curves } => circle(id, heading, curves),
    }
}

fn friction(id: &str, letter: char, [measured, fitted, file]: [&Vec<(f64, f64)>; 3]) -> String {
    let all = || measured.iter().chain(fitted).chain(file);
    let x = Range::of("speed / mm/s", all().map(|p| p.0)).padded(0.04);
    let y = Range::of("friction / N", all().map(|p| p.1)).padded(0.08);
    let heading = format!("{letter}: friction over speed");
    let caption = "Measured force less the force that accelerates and the weight: means over speeds, \
                   the fit through all samples, and what the file says.";
    let mut chart = Chart::new(&heading, caption, x, y, 280.0);
    chart.zero(true);
    chart.line(Stroke::Ideal, file, Some("file"));
    chart.line(Stroke::Main, fitted, Some("found"));
    chart.dots(measured, "measured");
    figure(&heading, &chart.finish(id), caption)
}

fn ramp(id: &str, name: &str, speed: &[(f64, f64)], commanded: &[(f64, f64)]) -> String {
    let all = || speed.iter().chain(commanded);
    let x = Range::of("time / s", all().map(|p| p.0)).padded(0.02);
    let y = Range::of("speed / rev/min", all().map(|p| p.1)).padded(0.06);
    let heading = format!("{name}: runs up and down");
    let caption = "Speed by the encoder, and as commanded, over the time of the step.";
    let mut chart = Chart::new(&heading, caption, x, y, 280.0);
    chart.zero(false);
    chart.line(Stroke::Ideal, commanded, Some("commanded"));
    chart.line(Stroke::Main, speed, Some("measured"));
    figure(&heading, &chart.finish(id), caption)
}

/// A table of words and figures; the first row has the headings.
fn plain(rows: &[Vec<String>]) -> String {
    let Some((heads, rows)) = rows.split_first() else { return String::new() };
    let cells = |kind: &'static str, row: &[String]| -> String {
        let cell = |(i, text): (usize, &String)| {
            let tag = Tag::new(kind);
            (if i == 0 { tag.class("l") } else { tag }).text(text)
        };
        Tag::new("tr").around(&row.iter().enumerate().map(cell).collect::<String>())
    };
    let body: String = rows.iter().map(|row| cells("td", row)).collect();
    let head = Tag::new("thead").around(&cells("th", heads));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&body)));
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}

/// Radius at which the programmed circle of a picture is drawn.
const DRAWN_RADIUS: f64 = 100.0;
/// Largest deviation in a picture, on the same scale.
const DRAWN_DEVIATION: f64 = 30.0;

fn circle(id: &str, heading: &str, curves: &[(&'static str, Vec<(f64, f64)>)]) -> String {
    let all = || curves.iter().flat_map(|curve| &curve.1);
    let most = all().map(|p| p.1.abs()).fold(0.1, f64::max);
    let times = DRAWN_DEVIATION / most;
    let at = |angle: f64, um: f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        let r = DRAWN_RADIUS + times * um;
        (r * cos, r * sin)
    };
    let ring = |um: f64| (0..=360).map(|i| at(f64::from(i), um)).collect::<Vec<_>>();
    let edge = DRAWN_RADIUS + DRAWN_DEVIATION;
    let range = || Range::of("", [-edge, edge]).padded(0.04);
    let caption = format!(
        "Where the slides really were: the deviation, {most:.1} µm at most, is drawn \
         {DRAWN_DEVIATION:.0} % of the radius high. X to the right, Y upwards."
    );
    let heading = format!("Circle {heading}");
    let mut chart = Chart::to_scale(&heading, &caption, range(), range());
    chart.line(Stroke::Ideal, &ring(0.0), Some("programmed"));
    let strokes = [Stroke::Out, Stroke::Main];
    for ((when, points), stroke) in curves.iter().zip(strokes) {
        let line: Vec<_> = points.iter().map(|p| at(p.0, p.1)).collect();
        chart.line(stroke, &line, Some(when));
    }
    figure(&heading, &chart.finish(id), &caption)
}
