//! The page: one file without a single outside resource, the verdict first.
//!
//! ```text
//!   verdict · key figures · alarms and notes
//!   map of holes · tables of features
//!   hole by hole: sync error and torque · chip removal
//!   the worst and the first thread: phase plane, sync error, speed and torque, operating points
//!   tool path · the run over time · where the time went · the program, line by line
//! ```
//!
//! Whatever came from a program or a file is text here and cannot become markup: it is escaped
//! where it is written, and the page's own policy forbids everything but its one style sheet and
//! script.

mod cams;
mod commission;
mod comparison;
mod compensation;
mod doctor;
pub(crate) mod features;
mod figures;
mod listing;
mod notes;
mod polygon;
mod section;
mod sizes;
mod stops;
mod threads;
mod tools;
mod turned;
mod verdict;

pub use cams::{CamPage, cam_html};
pub use commission::{CommissionPage, CommissionPicture, CommissionRow, commission_html};
pub use comparison::{Comparison, TappingMethod, comparison_html};
pub use compensation::{
    CompensationPage, CompensationRow, WayOfCompensation, compensation_html, um_figure,
};
pub use doctor::{DoctorPage, DoctorRow, LatencyPicture, doctor_html};
pub use features::name as feature_name;
pub use polygon::{Named, PolygonPlan, Side, polygon_html};

use crate::Run;
use crate::pictures;
use crate::record::Recorder;
use crate::svg::{Tag, fixed};
use section::{STYLE, grid, section};
use verify::{Feature, FeatureKind};

const SORT: &str = include_str!("sort.js");

/// The report of a run as one HTML page: equal input gives an equal page, byte for byte.
pub fn html(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let mut main = verdict::verdict(run, features);
    let listing = listing::Listing::of(run, recorder, features);
    main += &figures::figures(run, recorder, features);
    main += &notes::notes(run, recorder, features);
    main += &stops::recoveries(&run.stops);
    let overview = pictures::hole_map(run, recorder, features)
        + &sizes::sizes(features, recorder.measure())
        + &tools::tools(run, recorder)
        + &pictures::time_shares(run, recorder);
    main += &section("Workpiece, tools, time", &grid(&overview));
    main += &section("Features", &features::tables(run, recorder, features, &listing));
    main +=
        &section("Hole by hole", &grid(&pictures::hole_by_hole(run, recorder.measure(), features)));
    main += &section("Chip removal", &grid(&pictures::chip_removal(recorder)));
    let polygons = features.iter().enumerate().filter_map(|(i, f)| match &f.kind {
        FeatureKind::Polygon(polygon) => Some(pictures::polygon(i + 1, polygon)),
        FeatureKind::Hole(_)
        | FeatureKind::Thread(_)
        | FeatureKind::Cam(_)
        | FeatureKind::Turned(_)
        | FeatureKind::Milled(_)
        | FeatureKind::Gear(_) => None,
    });
    main += &section("Polygons", &grid(&polygons.collect::<String>()));
    main += &cams::cams(features);
    let gears = features.iter().enumerate().filter_map(|(i, feature)| match &feature.kind {
        FeatureKind::Gear(gear) => Some(pictures::gear(i + 1, gear)),
        _ => None, // no other feature has teeth
    });
    main += &section("Gears", &grid(&gears.collect::<String>()));
    let milled = features.iter().enumerate().filter_map(|(i, feature)| match &feature.kind {
        FeatureKind::Milled(milled) => {
            Some(pictures::milled(i + 1, feature, milled, run, recorder))
        }
        _ => None, // nothing else takes from the block
    });
    main += &section("Milling", &grid(&milled.collect::<String>()));
    main += &section("Turned threads", &grid(&turned::pictures(features)));
    main += &section("Taps in holders that give", &grid(&pictures::floating(recorder)));
    main += &threads::threads(run, recorder, features);
    let (path, drawn) = pictures::tool_path(run, recorder, &|line| listing.shows(line));
    main += &section("Machine", &grid(&(path + &pictures::timeline(run, recorder))));
    main += &section("Speed along the path", &grid(&pictures::pace(run, recorder)));
    main += &section("Program", &listing.html(run, recorder, features, &drawn));
    main += &footer(run, recorder);
    page(run, &Tag::new("main").around(&main))
}

fn page(run: &Run, body: &str) -> String {
    let policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";
    let policy =
        Tag::new("meta").with("http-equiv", "Content-Security-Policy").with("content", policy);
    let title = Tag::new("title").text(&format!("{} on {}", run.program, run.machine));
    let width = "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>";
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>{width}{}{title}<style>{STYLE}</style></head>\n\
         <body>{body}<script>{SORT}</script></body></html>\n",
        policy.empty()
    )
}

fn footer(run: &Run, recorder: &Recorder) -> String {
    let words = format!(
        "Leadscrew {}. Program {}, machine {}, seed {}; {} servo periods recorded. The same inputs give this page again, \
         byte for byte. Threads are judged from recorded motion; the pictures of a tap show the axis and the \
         spindle where they really were.",
        run.version,
        run.program,
        run.machine,
        run.seed,
        fixed(recorder.periods() as f64, 0)
    );
    Tag::new("footer").text(&words)
}
