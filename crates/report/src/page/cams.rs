//! Cams: what a profile asks of its machine, and the ground cam as an inspector draws it.
//!
//! ```text
//!   unrolled   e │ ~~~╮╭~~~      polar      ╭ ‑ ‑ ╮      the contour, with its error magnified
//!                └──────── θ                 ╰ ‑ ‑ ╯
//! ```
use super::section::{document, section};
use crate::pictures::figure;
use crate::svg::{Chart, Range, Stroke, Tag, fixed};
use std::f64::consts::TAU;
use verify::{Feature, FeatureKind, GroundCam};

/// Radius at which the base circle of a polar picture is drawn, mm.
const POLAR_BASE: f64 = 20.0;
/// Height of the largest error in a polar picture, mm, at most.
const POLAR_ERROR: f64 = 6.0;
/// Height at which a polar picture has its ring of scale, mm.
const POLAR_RING: f64 = 2.0;

/// What is drawn of a cam before it is ground. All curves over degrees.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CamPage {
    /// Heading.
    pub title: String,
    /// Rows of figures: what, and how much.
    pub figures: Vec<(String, String)>,
    /// The contour, mm.
    pub contour: Vec<(f64, f64)>,
    /// Lift of the follower, mm.
    pub lift: Vec<(f64, f64)>,
    /// Speed of X at the speed asked, mm/s.
    pub speed: Vec<(f64, f64)>,
    /// Acceleration of X, m/s².
    pub accel: Vec<(f64, f64)>,
    /// Curvature of the contour, 1/mm; negative in a hollow.
    pub curvature: Vec<(f64, f64)>,
    /// Work speed for an even removal rate, rev/min.
    pub work_speed: Vec<(f64, f64)>,
}

/// The page of a cam: equal input gives an equal page.
pub fn cam_html(page: &CamPage) -> String {
    let rows: String = page
        .figures
        .iter()
        .map(|(what, value)| {
            let cells = Tag::new("td").class("l").text(what) + &Tag::new("td").text(value);
            Tag::new("tr").around(&cells)
        })
        .collect();
    let table = Tag::new("table").around(&Tag::new("tbody").around(&rows));
    let curve = |id, heading: &str, title: &str, points: &[(f64, f64)], caption: &str| {
        let y = Range::of(title, points.iter().map(|p| p.1).chain([0.0])).padded(0.06);
        let mut chart = Chart::new(heading, caption, degrees(), y, 230.0);
        chart.zero(false);
        chart.line(Stroke::Main, points, None);
        figure(heading, &chart.finish(id), caption)
    };
    let outline = {
        let all = || page.contour.iter();
        let x = Range::of("mm", all().map(|p| p.0)).padded(0.05);
        let y = Range::of("mm", all().map(|p| p.1)).padded(0.05);
        let mut chart = Chart::to_scale("Contour", "The contour of the cam, to scale.", x, y);
        chart.zero(true);
        chart.line(Stroke::Main, &page.contour, None);
        figure("Contour", &chart.finish("contour"), "To scale; the follower stands at 0° along +x.")
    };
    let mut pictures = outline;
    pictures +=
        &curve("lift", "Lift", "lift / mm", &page.lift, "Of the follower above the base circle.");
    pictures += &curve(
        "speed",
        "Speed of X",
        "speed / mm/s",
        &page.speed,
        "Of the wheelhead while the work turns at the speed asked.",
    );
    pictures += &curve(
        "accel",
        "Acceleration of X",
        "acceleration / m/s²",
        &page.accel,
        "Of the wheel's slide at the speed of the work, as the speed above it.",
    );
    pictures += &curve(
        "curvature",
        "Curvature",
        "curvature / 1/mm",
        &page.curvature,
        "Of the contour over the follower's angle; below zero it is hollow, and the wheel must be smaller than the hollow.",
    );
    if !page.work_speed.is_empty() {
        pictures += &curve(
            "work",
            "Work speed for an even removal rate",
            "work speed / rev/min",
            &page.work_speed,
            "Slow where the contact runs fast along the contour, within the limits of both axes.",
        );
    }
    let main = Tag::new("h1").text(&page.title)
        + &section("Figures", &Tag::new("div").class("scroll").around(&table))
        + &section("Pictures", &Tag::new("div").class("grid").around(&pictures));
    document(&page.title, &main)
}

fn degrees() -> Range {
    Range { title: "angle / °".into(), from: 0.0, to: 360.0, powers: false, counted: false }
}

/// Ground cams, each unrolled and polar; nothing if there are none.
pub(super) fn cams(features: &[Feature]) -> String {
    let ground = features.iter().enumerate().filter_map(|(index, f)| match &f.kind {
        FeatureKind::Cam(cam) if !cam.errors.is_empty() => Some((index, cam.as_ref())),
        FeatureKind::Cam(_)
        | FeatureKind::Hole(_)
        | FeatureKind::Thread(_)
        | FeatureKind::Polygon(_)
        | FeatureKind::Turned(_)
        | FeatureKind::Milled(_)
        | FeatureKind::Gear(_) => None,
    });
    let pictures: String =
        ground.take(12).map(|(i, cam)| unrolled(i, cam) + &polar(i, cam)).collect();
    if pictures.is_empty() {
        return pictures;
    }
    section("Cams", &Tag::new("div").class("grid").around(&pictures))
}

fn unrolled(index: usize, cam: &GroundCam) -> String {
    let step = 360.0 / cam.errors.len() as f64;
    let points: Vec<_> =
        (0..).zip(&cam.errors).map(|(i, e)| (f64::from(i) * step, e.in_um())).collect();
    let most = points.iter().map(|p| p.1.abs()).fold(0.1, f64::max);
    let y = Range::of("contour error / µm", [-most, most]).padded(0.08);
    let number = index + 1;
    let heading =
        format!("{number}: {} at {} rpm, unrolled", cam.name, fixed(cam.spin.in_rpm(), 0));
    let late = fixed(cam.phase_error.in_deg().abs(), 4);
    let sense = if cam.phase_error.in_deg() < 0.0 { "early" } else { "late" };
    let caption = format!(
        "The wheel's edge less the profile over the last turn: {} µm at most, {} µm rms; all of it {sense} by {late}°. Largest wave from 30 to 180 a turn: {} µm, {} a turn. Removal rate: its peak is {} of its mean ({} if the work turned evenly).",
        fixed(cam.contour_error_max.in_um(), 2),
        fixed(cam.contour_error_rms.in_um(), 2),
        fixed(cam.waviness.0.in_um(), 3),
        cam.waviness.1,
        fixed(cam.removal_peak, 2),
        fixed(cam.removal_peak_even, 2)
    );
    let mut chart = Chart::new(&heading, &caption, degrees(), y, 260.0);
    chart.zero(false);
    chart.line(Stroke::Main, &points, None);
    figure(&heading, &chart.finish(&format!("cu{index}")), &caption)
}

fn polar(index: usize, cam: &GroundCam) -> String {
    let count = cam.errors.len() as f64;
    let most = cam.errors.iter().map(|e| e.value().abs()).fold(1e-6, f64::max);
    let times = round_below(POLAR_ERROR / most);
    let ring = |with_error: f64, beyond: f64| -> Vec<(f64, f64)> {
        let point = |i: usize| {
            let k = i % cam.errors.len();
            let error = with_error * cam.errors[k].value() * times;
            let r = POLAR_BASE + cam.lift[k].value() + error + beyond;
            let (sin, cos) = (TAU * k as f64 / count).sin_cos();
            (r * cos, r * sin)
        };
        (0..=cam.errors.len()).map(point).collect()
    };
    let (ideal, real) = (ring(0.0, 0.0), ring(1.0, 0.0));
    let (more, less) = (ring(0.0, POLAR_RING), ring(0.0, -POLAR_RING));
    let all = || ideal.iter().chain(&real).chain(&more);
    let x = Range::of("mm", all().map(|p| p.0)).padded(0.05);
    let y = Range::of("mm", all().map(|p| p.1)).padded(0.05);
    let heading = format!("{}: {}, polar", index + 1, cam.name);
    let caption = format!(
        "Stroke of the wheel about a circle, and the same with its error {} times as large; outside of the ideal line material is left.",
        fixed(times, 0)
    );
    let mut chart = Chart::to_scale(&heading, &caption, x, y);
    let scale = format!("profile ± {} µm", fixed(POLAR_RING / times * 1e3, 2));
    chart.lines(Stroke::Share, &[more, less], Some(&scale));
    chart.line(Stroke::Ideal, &ideal, Some("profile"));
    chart.line(Stroke::Main, &real, Some("as ground, error magnified"));
    figure(&heading, &chart.finish(&format!("cp{index}")), &caption)
}

/// The largest of 1, 2, 5 times a power of ten that is not above a value.
fn round_below(value: f64) -> f64 {
    let power = 10f64.powf(value.max(1.0).log10().floor());
    [5.0, 2.0].into_iter().map(|digit| digit * power).find(|x| *x <= value).unwrap_or(power)
}
