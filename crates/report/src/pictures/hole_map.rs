//! The map of holes: the work from above, to scale, each hole with its verdict.
//!
//! A hole is drilled and then tapped in the same place: what lies within a tenth of a millimetre is
//! one place, and the place is as good as the worst that was cut there. Good is a circle, bad a
//! crossed square, what was not judged a circle with a question mark, so that the map is read
//! without colours too.
//!
//! Where all was cut in one work offset the map is drawn in it. Where there are several it is drawn
//! in machine coordinates, as the parts lie on the table; a pointer that rests on a place shows its
//! coordinates in its own offset.
use super::figure::figure;
use crate::page::features::hole_name;
use crate::record::{Recorder, frames};
use crate::svg::{Chart, Mark, Range};
use crate::{Measure, Run, Standing};
use std::collections::BTreeMap;
use units::Length;
use verify::{Feature, FeatureKind};

/// With more places than this only the bad ones and the first are numbered.
const ALL_NUMBERED: usize = 40;
/// Numbers that are drawn at most.
const MOST_NUMBERS: usize = 60;

/// One place on the work.
struct HoleMark {
    at: (f64, f64),
    /// Its coordinates in the work offset in which it was programmed, in words.
    named: String,
    /// Largest diameter cut here, mm.
    diameter: f64,
    standing: Standing,
    /// Numbers (from 1) and names of what was cut here, and why it is bad.
    words: Vec<String>,
    number: usize,
}

/// What coordinates are counted from, and how they are written.
struct Frame {
    name: String,
    zero: [f64; 2],
    measure: Measure,
}

impl Frame {
    fn of(run: &Run, recorder: &Recorder, features: &[Feature]) -> Self {
        let measure = recorder.measure();
        let mut offsets = features
            .iter()
            .filter(|f| f.position().is_some())
            .filter_map(|f| recorder.frames.of(f.op));
        let Some(first) = offsets.next() else {
            let [x, y, _] = run.zero();
            return Self { name: run.frame().to_owned(), zero: [x, y], measure };
        };
        match frames::zero(first).filter(|_| offsets.all(|other| other == first)) {
            Some(at) => Self {
                name: frames::name(first),
                zero: [0, 1].map(|i| at.linear[i].value()),
                measure,
            },
            None => Self { name: "machine coordinates".into(), zero: [0.0; 2], measure },
        }
    }

    fn title(&self, axis: char) -> String {
        format!("{axis} in {} / {}", self.name, self.measure.symbol())
    }
}

fn named(run: &Run, recorder: &Recorder, feature: &Feature, at: [Length; 2]) -> String {
    let measure = recorder.measure();
    let (frame, [x, y]) = if let Some(frame) = recorder.frames.of(feature.op) {
        (frames::name(frame), frames::within(frame, at).map(Length::mm))
    } else {
        let zero = run.zero();
        (run.frame().to_owned(), [0, 1].map(|i| at[i] - Length::mm(zero[i])))
    };
    format!("{frame}: X{} Y{}", measure.length(x), measure.length(y))
}

fn places(run: &Run, recorder: &Recorder, features: &[Feature], frame: &Frame) -> Vec<HoleMark> {
    let mut by_cell: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    let mut places: Vec<HoleMark> = Vec::new();
    for (index, feature) in features.iter().enumerate() {
        let Some(machine) = feature.position() else { continue };
        let [x, y] = machine.map(Length::value);
        if !(x.is_finite() && y.is_finite()) {
            continue;
        }
        let cell = ((x * 10.0).round() as i64, (y * 10.0).round() as i64);
        let at = *by_cell.entry(cell).or_insert(places.len());
        if at == places.len() {
            let [x, y] =
                [0, 1].map(|i| frame.measure.number(machine[i] - Length::mm(frame.zero[i])));
            places.push(HoleMark {
                at: (x, y),
                named: named(run, recorder, feature, machine),
                diameter: 0.0,
                standing: Standing::Good,
                words: Vec::new(),
                number: index + 1,
            });
        }
        let place = &mut places[at];
        let (name, diameter) = match &feature.kind {
            FeatureKind::Hole(hole) => (hole_name(hole, frame.measure), hole.diameter),
            FeatureKind::Thread(thread) => (thread.size.clone(), thread.pitch_diameter),
            // not in the map: they have no place in it
            FeatureKind::Polygon(_)
            | FeatureKind::Cam(_)
            | FeatureKind::Turned(_)
            | FeatureKind::Milled(_)
            | FeatureKind::Gear(_) => continue,
        };
        let diameter = frame.measure.number(diameter);
        let standing = Standing::of(feature);
        if diameter.is_finite() && diameter >= place.diameter {
            place.diameter = diameter;
            place.number = index + 1;
        }
        if standing != Standing::Good {
            place.number = index + 1;
        }
        place.standing = place.standing.min(standing);
        let why = feature.verdict.reason().map_or(String::new(), |reason| format!(" – {reason}"));
        place.words.push(format!("{} {name}: {}{why}", index + 1, standing.name()));
    }
    places
}

/// The map, or nothing if nothing was cut.
pub(crate) fn hole_map(run: &Run, recorder: &Recorder, features: &[Feature]) -> String {
    let frame = Frame::of(run, recorder, features);
    let places = places(run, recorder, features, &frame);
    if places.is_empty() {
        return String::new();
    }
    let is_good = |place: &&HoleMark| place.standing == Standing::Good;
    let bad = places.iter().filter(|p| !is_good(p)).count();
    let x = Range::of(&frame.title('X'), places.iter().map(|p| p.at.0));
    let y = Range::of(&frame.title('Y'), places.iter().map(|p| p.at.1));
    let least = frame.measure.number(Length::mm(8.0));
    let margin = (0.1 * f64::max(x.to - x.from, y.to - y.from)).max(least);
    let grown = |r: Range| Range { from: r.from - margin, to: r.to + margin, ..r };
    let description =
        format!("{} places seen from above, at {bad} of them something is not good.", places.len());
    let mut chart = Chart::to_scale("Map of holes with verdicts", &description, grown(x), grown(y));
    // the bad ones last, so that nothing hides them
    let (good, not_good): (Vec<_>, Vec<_>) = places.iter().partition(is_good);
    for place in good.iter().chain(&not_good) {
        draw(&mut chart, place);
    }
    number(&mut chart, &good, &not_good, places.len() <= ALL_NUMBERED);
    for standing in Standing::ALL.into_iter().rev() {
        if places.iter().any(|place| place.standing == standing) {
            let (class, words) = sign(standing);
            chart.legend(class, words);
        }
    }
    let caption = "Seen from above, to scale; a number is the feature's in the tables below, and a pointer that rests on a \
        sign shows what was cut there. Failures that lie together point to the work or its clamping, failures \
        along the order of cutting to the tool.";
    figure("Map of holes", &chart.finish("map"), caption)
}

/// Class of a sign, and what it means.
const fn sign(standing: Standing) -> (&'static str, &'static str) {
    match standing {
        Standing::Good => ("mark pass", "circle: every cut here is within tolerance"),
        Standing::NotJudged => ("mark unjudged", "dashed circle: something here was not judged"),
        Standing::NotCut => ("mark uncut", "crossed dashed square: something here was not cut"),
        Standing::Bad => ("mark fail", "crossed square: something here is out of tolerance"),
    }
}

fn draw(chart: &mut Chart, place: &HoleMark) {
    let to_scale = place.diameter / 2.0 * chart.units_per_x();
    let (class, _) = sign(place.standing);
    let least = if place.standing == Standing::Good { 3.0 } else { 5.0 };
    let radius = if to_scale.is_finite() { to_scale.clamp(least, 30.0) } else { least };
    let title = format!("{}\n{}", place.named, place.words.join("\n"));
    let crossed = matches!(place.standing, Standing::Bad | Standing::NotCut);
    chart.mark(&Mark { at: place.at, radius, class, title: &title, crossed });
}

fn number(chart: &mut Chart, good: &[&HoleMark], bad: &[&HoleMark], all: bool) {
    let first = good.iter().take(if all { good.len() } else { 1 });
    for place in bad.iter().chain(first).take(MOST_NUMBERS) {
        let radius = (place.diameter / 2.0 * chart.units_per_x()).clamp(5.0, 30.0);
        let sign = match place.standing {
            Standing::Good => String::new(),
            other => format!("{} ", other.sign()),
        };
        chart.word(
            place.at,
            (0.0, -radius - 3.0),
            "name middle",
            &format!("{sign}{}", place.number),
        );
    }
}
