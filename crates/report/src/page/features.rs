//! The tables of features, one for each kind with what matters for it, worst first; a click on a
//! column's head sorts by it.
use super::listing::Listing;
use crate::record::Recorder;
use crate::record::frames;
use crate::svg::{Tag, escape, fixed};
use crate::{Measure, Run, Standing};
use units::{Length, Torque};
use verify::{
    Criterion, Feature, FeatureKind, Gear, GroundCam, Headroom, Hole, Largest, Milled, Polygon,
    Thread, TurnedThread,
};

/// The order of badness: what failed first, then by the share of the nearest tolerance that is
/// left.
pub(super) fn by_badness(run: &Run, features: &[Feature]) -> Vec<(usize, Headroom)> {
    let mut order: Vec<_> =
        features.iter().map(|f| f.headroom(&run.tolerances)).enumerate().collect();
    let standing = |&(index, _): &(usize, Headroom)| Standing::of(&features[index]);
    order.sort_by(|a, b| standing(a).cmp(&standing(b)).then(a.1.share().total_cmp(&b.1.share())));
    order
}

/// A column: its name, its unit, and whether it holds words.
type Column = (&'static str, &'static str, bool);

/// A cell: what is shown, and the same in millimetres where inches are shown.
struct Cell {
    text: String,
    metric: Option<String>,
}

impl Cell {
    fn plain(text: impl Into<String>) -> Self {
        Self { text: text.into(), metric: None }
    }

    const fn empty() -> Self {
        Self { text: String::new(), metric: None }
    }
}

/// Writes cells in the unit of the page.
#[derive(Clone, Copy)]
struct Writer(Measure);

impl Writer {
    fn with_metric(self, of: impl Fn(Measure) -> String, unit: &str) -> Cell {
        let metric = (self.0 != Measure::METRIC).then(|| of(Measure::METRIC) + " " + unit);
        Cell { text: of(self.0), metric }
    }

    fn length(self, length: Length) -> Cell {
        self.with_metric(|measure| measure.length(length), "mm")
    }

    fn small(self, error: Length, decimals: usize) -> Cell {
        self.with_metric(|measure| measure.small(error, decimals), "µm")
    }
}

/// Kinds in the order of their tables.
const KINDS: usize = 7;

const fn kind(feature: &Feature) -> usize {
    match feature.kind {
        FeatureKind::Thread(_) => 0,
        FeatureKind::Hole(_) => 1,
        FeatureKind::Turned(_) => 2,
        FeatureKind::Polygon(_) => 3,
        FeatureKind::Cam(_) => 4,
        FeatureKind::Gear(_) => 5,
        FeatureKind::Milled(_) => 6,
    }
}

const NAMES: [&str; KINDS] =
    ["Threads", "Holes", "Turned threads", "Polygons", "Cams", "Gears", "Milling"];

/// The tables, or a sentence if there is nothing to put into them.
pub(super) fn tables(
    run: &Run,
    recorder: &Recorder,
    features: &[Feature],
    listing: &Listing,
) -> String {
    if features.is_empty() {
        return Tag::new("p").class("soft").text("The program cut nothing that could be judged.");
    }
    let order = by_badness(run, features);
    let page = Page { run, recorder, listing, writer: Writer(recorder.measure()) };
    let tables = (0..KINDS).map(|wanted| {
        let of_kind: Vec<_> =
            order.iter().filter(|(index, _)| kind(&features[*index]) == wanted).collect();
        page.table(wanted, &of_kind, features)
    });
    let words = "Worst first: what is out of tolerance, then by the share of the tolerance that is left. Tolerance left: of the \
                 tolerance nearest to its limit. A click on a head sorts; a line number leads to the program.";
    Tag::new("p").class("soft").text(words) + &tables.collect::<String>()
}

struct Page<'a> {
    run: &'a Run,
    recorder: &'a Recorder,
    listing: &'a Listing,
    writer: Writer,
}

impl Page<'_> {
    fn table(&self, kind: usize, order: &[&(usize, Headroom)], features: &[Feature]) -> String {
        if order.is_empty() {
            return String::new();
        }
        let columns = columns(kind);
        let rows: Vec<Vec<Cell>> =
            order.iter().map(|(index, left)| self.cells(*index, &features[*index], left)).collect();
        // a column in which nothing stands says nothing
        let used: Vec<usize> = (0..columns.len())
            .filter(|at| rows.iter().any(|row| row.get(*at).is_some_and(|c| !c.text.is_empty())))
            .collect();
        let heads: String = used.iter().map(|at| self.head(columns[*at])).collect();
        let body: String = order
            .iter()
            .zip(&rows)
            .map(|((index, _), row)| self.row(*index, &features[*index], row, &used, &columns))
            .collect();
        let head = Tag::new("thead").around(&Tag::new("tr").around(&heads));
        let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&body)));
        let scroll = Tag::new("div").class("scroll").with("tabindex", "0");
        let scroll = scroll.with("role", "region").with("aria-label", NAMES[kind]).around(&table);
        Tag::new("h3").class("kind").text(NAMES[kind])
            + &scroll
            + &Tag::new("p").class("soft small").text(explained(kind))
    }

    fn head(&self, (name, unit, words): Column) -> String {
        let unit = match unit {
            "" => String::new(),
            "mm" => Tag::new("small").text(self.writer.0.symbol()),
            "µm" => Tag::new("small").text(self.writer.0.small_symbol()),
            unit => Tag::new("small").text(unit),
        };
        let button = Tag::new("button").with("type", "button").around(&(escape(name) + &unit));
        let head = Tag::new("th").with("scope", "col");
        if words { head.class("l").around(&button) } else { head.around(&button) }
    }

    fn row(
        &self,
        index: usize,
        feature: &Feature,
        cells: &[Cell],
        used: &[usize],
        columns: &[Column],
    ) -> String {
        let standing = Standing::of(feature);
        let cell = |at: &usize| {
            let Cell { text, metric } = &cells[*at];
            let cell = match metric {
                Some(metric) => Tag::new("td").with("title", metric),
                None => Tag::new("td"),
            };
            match columns[*at].0 {
                "verdict" => cell.class("l verdict-cell").text(text),
                "feature" => match feature.verdict.reason() {
                    Some(why) => {
                        let why = Tag::new("div").text(why);
                        cell.class("l wide").around(&(escape(text) + &why))
                    }
                    None => cell.class("l").text(text),
                },
                "line" => cell.around(&self.listing.link(self.recorder, feature)),
                _ if columns[*at].2 => cell.class("l").text(text),
                _ => cell.text(text),
            }
        };
        let cells: String = used.iter().map(cell).collect();
        let id = format!("F{}", index + 1);
        Tag::new("tr").class(standing.class()).with("id", &id).around(&cells)
    }

    /// No., verdict, feature, line, then what its kind has, then what is left.
    fn cells(&self, index: usize, feature: &Feature, left: &Headroom) -> Vec<Cell> {
        let standing = Standing::of(feature);
        let mut cells = vec![
            Cell::plain((index + 1).to_string()),
            Cell::plain(standing.shown()),
            Cell::plain(name(feature, self.writer.0)),
            Cell::plain(feature.line.to_string()),
        ];
        if feature.position().is_some() {
            cells.extend(self.place(feature));
        }
        let measures = self.measures(feature);
        // what was not cut has no measures
        let uncut = standing == Standing::NotCut;
        cells.extend(measures.into_iter().map(|cell| if uncut { Cell::empty() } else { cell }));
        cells.push(Cell::plain(share_left(left, standing)));
        cells
    }

    /// Work offset, X and Y in it.
    fn place(&self, feature: &Feature) -> [Cell; 3] {
        let Some(at) = feature.position() else { return [const { Cell::empty() }; 3] };
        let (frame, [x, y]) = if let Some(frame) = self.recorder.frames.of(feature.op) {
            (frames::name(frame), frames::within(frame, at).map(Length::mm))
        } else {
            let zero = self.run.zero();
            (self.run.frame().to_owned(), [0, 1].map(|i| at[i] - Length::mm(zero[i])))
        };
        [Cell::plain(frame), self.writer.length(x), self.writer.length(y)]
    }

    fn measures(&self, feature: &Feature) -> Vec<Cell> {
        let write = self.writer;
        match &feature.kind {
            FeatureKind::Hole(hole) => of_hole(write, hole),
            FeatureKind::Thread(thread) => of_thread(write, thread),
            FeatureKind::Turned(thread) => of_turned(write, thread),
            FeatureKind::Polygon(polygon) => of_polygon(write, polygon),
            FeatureKind::Cam(cam) => of_cam(write, cam),
            FeatureKind::Gear(gear) => of_gear(write, gear),
            FeatureKind::Milled(milled) => of_milled(write, milled),
        }
    }
}

/// A feature's name in tables: its kind and size.
pub fn name(feature: &Feature, measure: Measure) -> String {
    match &feature.kind {
        FeatureKind::Hole(hole) => hole_name(hole, measure),
        FeatureKind::Thread(thread) => {
            let said = thread.size.ends_with("LH");
            let hand = if thread.hand.sign() < 0.0 && !said { " left" } else { "" };
            format!("{}{hand}", thread.size)
        }
        FeatureKind::Turned(thread) => thread.name(),
        FeatureKind::Polygon(polygon) => polygon.name(),
        FeatureKind::Cam(cam) => format!("cam {}", cam.name),
        FeatureKind::Gear(gear) => gear.name(),
        FeatureKind::Milled(_) if feature.tool.is_none() => "no tool".into(),
        FeatureKind::Milled(milled) => {
            let number = feature.tool.map_or(String::new(), |number| format!("T{number} "));
            let decimals = if measure == Measure::METRIC { 2 } else { 4 };
            let diameter = fixed(measure.number(milled.diameter), decimals);
            format!("{number}{} ⌀{diameter}", milled.form_name())
        }
    }
}

/// Such as "hole ⌀5.00".
pub(crate) fn hole_name(hole: &Hole, measure: Measure) -> String {
    let decimals = if measure == Measure::METRIC { 2 } else { 4 };
    format!("hole ⌀{}", fixed(measure.number(hole.diameter), decimals))
}

fn columns(kind: usize) -> Vec<Column> {
    let mut columns: Vec<Column> =
        vec![("No.", "", false), ("verdict", "", true), ("feature", "", true), ("line", "", false)];
    let place = [("work offset", "", true), ("X", "mm", false), ("Y", "mm", false)];
    let own: &[Column] = match kind {
        0 => &[
            ("depth", "mm", false),
            ("depth error", "µm", false),
            ("sync error, max", "µm", false),
            ("pitch ⌀", "mm", false),
            ("class", "", true),
            ("gauge margin", "µm", false),
            ("torque of the cut", "N·m", false),
            ("speed", "rpm", false),
        ],
        1 => {
            &[("depth", "mm", false), ("depth error", "µm", false), ("off its place", "µm", false)]
        }
        2 => &[
            ("length", "mm", false),
            ("passes", "", false),
            ("infeed error", "µm", false),
            ("sync error, max", "µm", false),
            ("passes apart", "µm", false),
            ("lead error", "µm", false),
            ("pitch ⌀", "mm", false),
            ("class", "", true),
            ("gauge margin", "µm", false),
            ("torque of the cut", "N·m", false),
            ("speed", "rpm", false),
        ],
        3 => &[
            ("length", "mm", false),
            ("across flats", "mm", false),
            ("size error", "µm", false),
            ("flatness", "µm", false),
            ("facets differ", "µm", false),
            ("speed", "rpm", false),
        ],
        4 => &[
            ("lift", "mm", false),
            ("contour error, max", "µm", false),
            ("contour error, rms", "µm", false),
            ("phase error", "°", false),
            ("waviness", "µm", false),
            ("speed", "rpm", false),
        ],
        6 => &[
            ("axial depth", "mm", false),
            ("radial width", "mm", false),
            ("engagement", "°", false),
            ("feed per tooth", "µm", false),
            ("chip", "µm", false),
            ("removal", "cm³/min", false),
            ("force, estimated", "N", false),
            ("deflection", "µm", false),
            ("rapids through stock", "", false),
            ("speed", "rpm", false),
        ],
        _ => &[
            ("width", "mm", false),
            ("span", "mm", false),
            ("span error", "µm", false),
            ("single pitch", "µm", false),
            ("total pitch", "µm", false),
            ("helix slope", "µm", false),
            ("profile", "µm", false),
            ("grade", "", true),
            ("speed", "rpm", false),
        ],
    };
    if kind < 2 {
        columns.extend(place);
    }
    columns.extend(own);
    columns.push(("tolerance left", "%", false));
    columns
}

/// What the columns of a kind mean.
const fn explained(kind: usize) -> &'static str {
    match kind {
        0 => {
            "Depth: length of full thread, from the surface; plus is deeper. Sync error: distance of the axis from the ideal \
             helix, in the material."
        }
        1 => "Depth of the tip, from the surface; plus is deeper.",
        2 => {
            "Sync error: distance of the tool from the ideal helix in the worst pass. Passes apart: how well each finds the \
             groove of the others."
        }
        3 => {
            "Size error: across flats, less what was ordered. Facets differ: the farthest less the nearest."
        }
        4 => {
            "Contour error: distance of the wheel's edge from the profile along X, in the last turns."
        }
        6 => {
            "The largest of each while the mill was in the spindle. Chip: a tooth's largest thickness, thinner than its feed \
             below 90° of engagement. Force: tangential, at most. Below the table: the stock afterwards."
        }
        _ => "Deviations at the middle of the face, by ISO 1328-1. Speed of the work.",
    }
}

fn rpm(spin: units::Spin) -> Cell {
    Cell::plain(fixed(spin.in_rpm(), 0))
}

fn of_hole(write: Writer, hole: &Hole) -> Vec<Cell> {
    vec![
        write.length(hole.depth),
        write.small(hole.depth_error, 1),
        write.small(hole.position_error, 1),
    ]
}

fn of_thread(write: Writer, thread: &Thread) -> Vec<Cell> {
    let gauged = |cell| if thread.is_gauged() { cell } else { Cell::empty() };
    let torque = thread.torque_max.map_or(String::new(), |torque: Torque| fixed(torque.value(), 2));
    vec![
        write.length(thread.depth),
        write.small(thread.depth_error, 1),
        write.small(thread.sync_error_max, 1),
        gauged(write.length(thread.pitch_diameter)),
        Cell::plain(thread.class_name()),
        gauged(write.small(thread.margin, 0)),
        Cell::plain(torque),
        rpm(thread.spin_max),
    ]
}

fn of_turned(write: Writer, thread: &TurnedThread) -> Vec<Cell> {
    vec![
        write.length(thread.length()),
        Cell::plain(thread.passes.to_string()),
        write.small(thread.infeed_error, 1),
        write.small(thread.sync_error_max, 2),
        write.small(thread.pass_spread, 2),
        write.small(thread.lead_error, 2),
        thread.sizes.as_ref().map_or_else(Cell::empty, |sizes| write.length(sizes.pitch[0])),
        Cell::plain(thread.class_and_size()),
        thread.pitch_margin().map_or_else(Cell::empty, |margin| write.small(margin, 0)),
        Cell::plain(thread.torque_max.map_or_else(String::new, |m| fixed(m.value(), 2))),
        rpm(thread.spin_max),
    ]
}

fn of_polygon(write: Writer, polygon: &Polygon) -> Vec<Cell> {
    vec![
        write.length((polygon.z_to - polygon.z_from).abs()),
        write.length(polygon.across_flats),
        write.small(polygon.across_flats - polygon.across_flats_ordered, 1),
        write.small(polygon.flatness, 2),
        write.small(polygon.facet_difference, 2),
        rpm(polygon.spin),
    ]
}

fn of_cam(write: Writer, cam: &GroundCam) -> Vec<Cell> {
    vec![
        write.length(cam.lift.iter().copied().fold(Length::ZERO, Length::max)),
        write.small(cam.contour_error_max, 2),
        write.small(cam.contour_error_rms, 2),
        Cell::plain(fixed(cam.phase_error.in_deg(), 4)),
        write.small(cam.waviness.0, 3),
        rpm(cam.spin),
    ]
}

fn of_gear(write: Writer, gear: &Gear) -> Vec<Cell> {
    vec![
        write.length((gear.z_to - gear.z_from).abs()),
        gear.size.map_or_else(Cell::empty, |size| write.length(size.span)),
        gear.size.map_or_else(Cell::empty, |size| write.small(size.span - size.span_asked, 1)),
        write.small(gear.pitch_deviation, 2),
        write.small(gear.pitch_total, 2),
        write.small(gear.helix_deviation, 2),
        write.small(gear.profile_deviation, 2),
        Cell::plain(gear.grade.map_or("none".into(), |grade| grade.to_string())),
        Cell::plain(fixed(gear.spin.in_rpm(), 1)),
    ]
}

fn of_milled(write: Writer, milled: &Milled) -> Vec<Cell> {
    let small = |of: Option<Largest<Length>>, decimals| {
        of.map_or_else(Cell::empty, |most| write.small(most.value, decimals))
    };
    let length =
        |of: Option<Largest<Length>>| of.map_or_else(Cell::empty, |most| write.length(most.value));
    let plain =
        |of: Option<f64>, decimals| Cell::plain(of.map_or(String::new(), |v| fixed(v, decimals)));
    let rapids = milled.rapid_count;
    vec![
        length(milled.depth),
        length(milled.width),
        plain(milled.angle.map(|most| most.value.in_deg()), 0),
        small(milled.feed_per_tooth, 0),
        small(milled.chip, 0),
        plain(milled.removal_mm3_per_s.map(|most| most.value * 0.06), 1),
        plain(milled.force.map(|most| most.value.value()), 0),
        small(milled.deflection, 0),
        Cell::plain(if rapids == 0 { String::new() } else { rapids.to_string() }),
        rpm(milled.spin_max),
    ]
}

/// In percent; what has no measure has no share.
fn share_left(left: &Headroom, standing: Standing) -> String {
    match (standing, left.of) {
        (Standing::NotCut | Standing::NotJudged, _) | (_, Criterion::Whole) => "–".into(),
        (_, of) => format!("{} {}", fixed(left.share() * 100.0, 0), of.name()),
    }
}
