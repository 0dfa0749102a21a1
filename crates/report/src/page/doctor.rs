//! What a computer is like for leading a machine: findings topic by topic, and how late periods
//! began.
use super::section::{document, grid, section};
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag, fixed};

/// A finding, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DoctorRow {
    /// What it is about.
    pub topic: String,
    /// `good`, `note`, `improve`, `wrong` or `unknown`.
    pub health: &'static str,
    /// What was found.
    pub says: String,
    /// What to change; empty: nothing.
    pub remedy: String,
}

/// How late periods began.
#[derive(Clone, Debug, PartialEq)]
pub struct LatencyPicture {
    /// Servo period, µs.
    pub period_us: f64,
    /// Periods that began late by 0 to 1 µs, 1 to 2 µs, …
    pub histogram: Vec<u64>,
    /// Largest lateness, µs.
    pub worst_us: f64,
    /// In a sentence.
    pub caption: String,
}

/// The page's content.
#[derive(Clone, Debug, PartialEq)]
pub struct DoctorPage {
    /// Heading.
    pub title: String,
    /// The verdict: whether a machine can be led, and a sentence.
    pub verdict: (bool, String),
    /// Topic by topic.
    pub rows: Vec<DoctorRow>,
    /// `None`: not measured.
    pub latency: Option<LatencyPicture>,
}

/// The page: equal input gives an equal page.
pub fn doctor_html(page: &DoctorPage) -> String {
    let (can_lead, says) = &page.verdict;
    let (class, sign) = if *can_lead { ("verdict pass", "✓") } else { ("verdict fail", "✗") };
    let verdict = Tag::new("div").class(class).around(
        &(Tag::new("span").class("sign").text(sign) + &Tag::new("span").class("word").text(says)),
    );
    let latency = grid(&page.latency.as_ref().map(picture).unwrap_or_default());
    let main = Tag::new("h1").text(&page.title)
        + &verdict
        + &section("What was found", &table(&page.rows))
        + &section("How late periods begin", &latency);
    document(&page.title, &main)
}

/// Colour and word of a finding's state.
fn state(health: &str) -> (&'static str, &'static str) {
    match health {
        "good" => ("l pass", "good"),
        "improve" => ("l unjudged", "improve"),
        "wrong" => ("l fail", "wrong"),
        "note" => ("l none", "note"),
        _ => ("l none", "not known"),
    }
}

fn table(rows: &[DoctorRow]) -> String {
    let heads = ["", "state", "found, and what to change"];
    let heads: String = heads.iter().map(|head| Tag::new("th").class("l").text(head)).collect();
    let rows: String = rows
        .iter()
        .map(|row| {
            let (class, word) = state(row.health);
            let remedy = if row.remedy.is_empty() {
                String::new()
            } else {
                Tag::new("div").text(&format!("to change: {}", row.remedy))
            };
            let says = Tag::new("span").text(&row.says) + &remedy;
            let cells = Tag::new("td").class("l").text(&row.topic)
                + &Tag::new("td").class(class).text(word)
                + &Tag::new("td").class("l wide").around(&says);
            Tag::new("tr").around(&cells)
        })
        .collect();
    let head = Tag::new("thead").around(&Tag::new("tr").around(&heads));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&rows)));
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}

/// Periods over their lateness, both by powers of ten: what is rare is what matters.
fn picture(latency: &LatencyPicture) -> String {
    // a bin's upper end, so that the first one has a logarithm
    let filled = (1_u32..).zip(&latency.histogram).filter(|(_, count)| **count > 0);
    let bars: Vec<_> = filled.map(|(us, count)| (f64::from(us), *count as f64)).collect();
    let farthest = latency.worst_us.max(latency.period_us).max(10.0);
    let most = bars.iter().map(|bar| bar.1).fold(10.0, f64::max);
    let x = Range::of("late by / µs", [0.0, farthest.log10()]).padded(0.02).powers_of_ten();
    let y = Range::of("periods", [-0.3, most.log10()]).padded(0.02).powers_of_ten();
    let bottom = y.from;
    let heading = "Lateness";
    let mut chart = Chart::new(heading, &latency.caption, x, y, 300.0);
    let cells: Vec<_> = bars
        .iter()
        .map(|(us, count)| {
            [(us - 0.45).max(0.55).log10(), bottom, (us + 0.45).log10(), count.log10()]
        })
        .collect();
    chart.cells("deep4", &cells, "periods");
    let at = latency.period_us.log10();
    let period = format!("a period, {} µs", fixed(latency.period_us, 0));
    chart.line(Stroke::Stop, &[(at, bottom), (at, most.log10())], Some(&period));
    figure(heading, &chart.finish("late"), &latency.caption)
}
