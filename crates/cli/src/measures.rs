//! The short tables of what was cut: one for each kind of feature, a row for each size, with what
//! matters for that kind.
//!
//! Lengths are in the unit in which the program is written.
use crate::tables;
use control::Outcome;
use report::Measure;
use units::{Length, Spin};
use verify::{
    Feature, FeatureKind, Gear, GroundCam, Largest, Milled, Polygon, Thread, TurnedThread,
};

/// Heads of a table and what stands in it.
struct MeasureTable {
    heads: &'static [&'static str],
    rows: Vec<Vec<String>>,
}

/// Every table; nothing if nothing was cut.
pub(crate) fn tables(outcome: &Outcome) -> String {
    let measure = outcome.recorder.measure();
    let mut kinds: Vec<MeasureTable> = Vec::new();
    let mut limits = String::new();
    for group in groups(&outcome.features, measure) {
        let heads = heads(&group[0].kind);
        let row = row(&group, measure);
        limits += &limited(&group, measure, outcome);
        match kinds.iter_mut().find(|kind| kind.heads == heads) {
            Some(kind) => kind.rows.push(row),
            None => kinds.push(MeasureTable { heads, rows: vec![row] }),
        }
    }
    let tables = kinds.iter().map(|kind| {
        let heads: Vec<String> = kind.heads.iter().map(|head| in_unit(head, measure)).collect();
        let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
        format!("{}\n", tables::figures(&heads, &kind.rows))
    });
    tables.collect::<String>() + &limits
}

fn in_unit(head: &str, measure: Measure) -> String {
    head.replace("MM", measure.symbol()).replace("UM", measure.small_symbol())
}

/// What kept taps from being faster.
fn limited(group: &[&Feature], measure: Measure, outcome: &Outcome) -> String {
    match outcome.limiting.get(&group[0].op) {
        Some(limit) if matches!(group[0].kind, FeatureKind::Thread(_)) => {
            format!("{} limited by: {limit}\n", report::feature_name(group[0], measure))
        }
        _ => String::new(),
    }
}

/// `MM` and `UM` stand for the units of lengths and of errors.
const fn heads(kind: &FeatureKind) -> &'static [&'static str] {
    match kind {
        FeatureKind::Hole(_) | FeatureKind::Thread(_) => &[
            "feature",
            "good",
            "depth\nMM",
            "error\nUM",
            "sync\nerror UM",
            "class",
            "margin\nUM",
            "rpm",
        ],
        FeatureKind::Turned(_) => {
            &["feature", "good", "length\nMM", "sync\nUM", "class", "margin\nUM", "rpm"]
        }
        FeatureKind::Polygon(_) => &[
            "feature",
            "good",
            "length\nMM",
            "across\nflats MM",
            "error\nUM",
            "flatness\nUM",
            "rpm",
        ],
        FeatureKind::Cam(_) => {
            &["feature", "good", "lift\nMM", "contour\nerror UM", "rms\nUM", "rpm"]
        }
        FeatureKind::Gear(_) => &[
            "feature",
            "good",
            "width\nMM",
            "span\nMM",
            "error\nUM",
            "pitch\nUM",
            "total\nUM",
            "helix\nUM",
            "profile\nUM",
            "grade",
            "rpm",
        ],
        FeatureKind::Milled(_) => &[
            "feature",
            "good",
            "depth\nMM",
            "width\nMM",
            "chip\nUM",
            "force\nN",
            "rapids in\nstock",
            "rpm",
        ],
    }
}

/// Features of one kind and size, in the order in which the first of each was cut.
fn groups(features: &[Feature], measure: Measure) -> Vec<Vec<&Feature>> {
    let mut groups: Vec<(String, Vec<&Feature>)> = Vec::new();
    for feature in features {
        let name = report::feature_name(feature, measure);
        match groups.iter_mut().find(|(n, _)| *n == name) {
            Some((_, group)) => group.push(feature),
            None => groups.push((name, vec![feature])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

fn row(group: &[&Feature], measure: Measure) -> Vec<String> {
    let good = group.iter().filter(|f| f.verdict.is_pass()).count();
    let mut cells =
        vec![report::feature_name(group[0], measure), format!("{good}/{}", group.len())];
    // what was not cut has no measures
    let cut: Vec<&Feature> = group
        .iter()
        .copied()
        .filter(|f| report::Standing::of(f) != report::Standing::NotCut)
        .collect();
    let Some(first) = cut.first() else { return cells };
    let lengths = |of: &dyn Fn(&Feature) -> Option<Length>| -> Vec<Length> {
        cut.iter().filter_map(|feature| of(feature)).collect()
    };
    let figures = Figures { lengths: &lengths, measure };
    cells.extend(match &first.kind {
        FeatureKind::Hole(_) => figures.holes(),
        FeatureKind::Thread(thread) => figures.threads(thread),
        FeatureKind::Turned(thread) => figures.turned(thread),
        FeatureKind::Polygon(polygon) => figures.polygons(polygon),
        FeatureKind::Cam(cam) => figures.cams(cam),
        FeatureKind::Gear(gear) => figures.gears(gear),
        FeatureKind::Milled(milled) => figures.milled(milled),
    });
    if let Some(spin) = fastest(&cut) {
        cells.push(format!("{:.0}", spin.in_rpm()));
    }
    cells
}

/// The fastest of them, where a speed is recorded.
fn fastest(cut: &[&Feature]) -> Option<Spin> {
    let spin = |feature: &&Feature| match &feature.kind {
        FeatureKind::Hole(_) => None,
        FeatureKind::Thread(thread) => Some(thread.spin_max),
        FeatureKind::Turned(thread) => Some(thread.spin_max),
        FeatureKind::Polygon(polygon) => Some(polygon.spin),
        FeatureKind::Cam(cam) => Some(cam.spin),
        FeatureKind::Gear(gear) => Some(gear.spin),
        FeatureKind::Milled(milled) => Some(milled.spin_max),
    };
    cut.iter().filter_map(spin).reduce(Spin::max)
}

/// Picks a measure out of each feature that has it.
type Pick<'f> = &'f dyn Fn(&Feature) -> Option<Length>;

/// The figures of features of one kind, worst over all of them.
struct Figures<'f> {
    lengths: &'f dyn Fn(Pick<'_>) -> Vec<Length>,
    measure: Measure,
}

macro_rules! of_kind {
    ($kind:ident, $it:ident => $figure:expr) => {
        &|feature: &Feature| match &feature.kind {
            FeatureKind::$kind($it) => Some($figure),
            _ => None, // the group is of one kind
        }
    };
}

impl Figures<'_> {
    /// The one farthest from zero.
    fn worst(&self, of: Pick<'_>) -> Option<Length> {
        (self.lengths)(of).into_iter().reduce(|a, b| if b.abs() > a.abs() { b } else { a })
    }

    fn length(&self, of: Pick<'_>) -> String {
        self.worst(of).map_or_else(String::new, |length| self.measure.length(length))
    }

    fn error(&self, of: Pick<'_>, decimals: usize) -> String {
        self.worst(of).map_or_else(String::new, |error| self.measure.small(error, decimals))
    }

    fn signed(&self, of: Pick<'_>, decimals: usize) -> String {
        self.worst(of).map_or_else(String::new, |error| self.measure.signed(error, decimals))
    }

    fn least(&self, of: Pick<'_>) -> Option<Length> {
        (self.lengths)(of).into_iter().reduce(Length::min)
    }

    fn holes(&self) -> Vec<String> {
        vec![
            self.length(of_kind!(Hole, hole => hole.depth)),
            self.signed(of_kind!(Hole, hole => hole.depth_error), 1),
        ]
    }

    fn threads(&self, first: &Thread) -> Vec<String> {
        let measure = self.measure;
        let shallowest = self.least(of_kind!(Thread, thread => thread.depth));
        let margins = (self.lengths)(&|feature: &Feature| match &feature.kind {
            FeatureKind::Thread(thread) => thread.is_gauged().then_some(thread.margin),
            _ => None, // the group is of one kind
        });
        let margin = margins.into_iter().reduce(Length::min);
        vec![
            shallowest.map_or_else(String::new, |depth| measure.length(depth)),
            self.signed(of_kind!(Thread, thread => thread.depth_error), 1),
            self.error(of_kind!(Thread, thread => thread.sync_error_max), 1),
            first.class_name().to_owned(),
            margin.map_or_else(String::new, |margin| measure.small(margin, 0)),
        ]
    }

    fn turned(&self, first: &TurnedThread) -> Vec<String> {
        let margins = (self.lengths)(&|feature: &Feature| match &feature.kind {
            FeatureKind::Turned(thread) => thread.pitch_margin(),
            _ => None, // the group is of one kind
        });
        let margin = margins.into_iter().reduce(Length::min);
        vec![
            self.length(of_kind!(Turned, thread => thread.length())),
            self.error(of_kind!(Turned, thread => thread.sync_error_max), 2),
            first.class_and_size(),
            margin.map_or_else(String::new, |margin| self.measure.small(margin, 0)),
        ]
    }

    fn polygons(&self, first: &Polygon) -> Vec<String> {
        vec![
            self.measure.length((first.z_to - first.z_from).abs()),
            self.length(of_kind!(Polygon, it => it.across_flats)),
            self.signed(of_kind!(Polygon, it => it.across_flats - it.across_flats_ordered), 1),
            self.error(of_kind!(Polygon, it => it.flatness), 2),
        ]
    }

    fn cams(&self, first: &GroundCam) -> Vec<String> {
        let lift = first.lift.iter().copied().fold(Length::ZERO, Length::max);
        vec![
            self.measure.length(lift),
            self.error(of_kind!(Cam, cam => cam.contour_error_max), 2),
            self.error(of_kind!(Cam, cam => cam.contour_error_rms), 2),
        ]
    }

    fn milled(&self, first: &Milled) -> Vec<String> {
        let largest = |of: Option<Largest<Length>>| {
            of.map_or_else(String::new, |most| self.measure.length(most.value))
        };
        vec![
            largest(first.depth),
            largest(first.width),
            first.chip.map_or_else(String::new, |most| self.measure.small(most.value, 0)),
            first.force.map_or_else(String::new, |most| format!("{:.0}", most.value.value())),
            first.rapid_count.to_string(),
        ]
    }

    fn gears(&self, first: &Gear) -> Vec<String> {
        vec![
            self.measure.length((first.z_to - first.z_from).abs()),
            first.size.map_or_else(String::new, |size| self.measure.length(size.span)),
            first.size.map_or_else(String::new, |size| {
                self.measure.small(size.span - size.span_asked, 1)
            }),
            self.error(of_kind!(Gear, gear => gear.pitch_deviation), 2),
            self.error(of_kind!(Gear, gear => gear.pitch_total), 2),
            self.error(of_kind!(Gear, gear => gear.helix_deviation), 2),
            self.error(of_kind!(Gear, gear => gear.profile_deviation), 2),
            first.grade.map_or("none".to_owned(), |grade| grade.to_string()),
        ]
    }
}
