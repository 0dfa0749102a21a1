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
    let main = Tag::new("h1").text(&page.title)
        + &verdict
        + &Tag::new("p").class("facts").text(&page.facts)
        + &notes
        + &section("Values", &table(&page.rows))
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
