//! What a mill has left of the stock, from above: the deeper, the darker; where a rapid went
//! through it, a cross.
use super::figure::figure;
use crate::record::Recorder;
use crate::svg::{Chart, Mark, Range, fixed};
use crate::{Measure, Run, feature_name};
use std::fmt::Write;
use verify::{Feature, HeightMap, Largest, Milled, MillingPlace};

/// Classes of the style sheet, from the top to the bottom.
const CLASSES: [&str; 6] = ["deep0", "deep1", "deep2", "deep3", "deep4", "deep5"];
/// Less is as it was, mm.
const UNTOUCHED: f64 = 1e-3;
/// Rapids that are marked.
const MARKED: usize = 50;

/// The picture with its figures; nothing where no stock is known.
pub(crate) fn milled(
    number: usize,
    feature: &Feature,
    milled: &Milled,
    run: &Run,
    recorder: &Recorder,
) -> String {
    let Some(map) = &milled.map else { return String::new() };
    let measure = recorder.measure();
    let (name, caption) = (feature_name(feature, measure), caption(milled, measure));
    let unit = measure.symbol();
    let ends = |i: usize| {
        [map.block.from[i], map.block.to[i]].map(|at| measure.number(at - map.block.zero[i]))
    };
    let frame = run.frame();
    let ranges = [("X", 0), ("Y", 1)]
        .map(|(axis, i)| Range::of(&format!("{axis} in {frame} / {unit}"), ends(i)).padded(0.06));
    let [x, y] = ranges;
    let mut chart = Chart::to_scale(&name, &caption, x, y);
    let deepest = map.depths.iter().flatten().copied().fold(0.0, f64::max);
    for (class, cells) in bands(map, deepest, [ends(0), ends(1)]).iter().enumerate() {
        let to = |share: f64| fixed(deepest * share / measure.unit.in_mm(), measure.decimals() - 1);
        let label = if class == 0 {
            "as it was".to_owned()
        } else {
            let part = (CLASSES.len() - 1) as f64;
            let k = class as f64;
            format!("{} to {} {unit} deep", to((k - 1.0) / part), to(k / part))
        };
        if !cells.is_empty() {
            chart.cells(CLASSES[class], cells, &label);
        }
    }
    for rapid in milled.rapids.iter().take(MARKED) {
        let MillingPlace { line, at, .. } = rapid.place;
        let title = format!("line {line}: {} {unit} deep", measure.length(rapid.depth));
        let at = (measure.number(at[0]), measure.number(at[1]));
        chart.mark(&Mark { at, radius: 6.0, class: "mark fail", title: &title, crossed: true });
    }
    if !milled.rapids.is_empty() {
        chart.legend("mark fail", "a rapid goes through the stock");
    }
    figure(
        &format!("{name}: the stock afterwards"),
        &chart.finish(&format!("milled{number}")),
        &caption,
    )
}

/// Rectangles of each class, runs of cells in a row joined.
fn bands(map: &HeightMap, deepest: f64, [x, y]: [[f64; 2]; 2]) -> Vec<Vec<[f64; 4]>> {
    let mut bands = vec![Vec::new(); CLASSES.len()];
    let rows = map.depths.len() as f64;
    let class = |depth: f64| match depth {
        d if d < UNTOUCHED => 0,
        d => 1 + ((d / deepest * 5.0).ceil() as usize).clamp(1, 5) - 1,
    };
    for (j, row) in map.depths.iter().enumerate() {
        let up = |j: f64| y[0] + (y[1] - y[0]) * j / rows;
        let right = |i: usize| x[0] + (x[1] - x[0]) * i as f64 / row.len() as f64;
        let mut begun = 0;
        for i in 0..row.len() {
            let here = class(row[i]);
            if row.get(i + 1).is_none_or(|next| class(*next) != here) {
                let cell = [right(begun), up(j as f64), right(i + 1), up(j as f64 + 1.0)];
                bands[here].push(cell);
                begun = i + 1;
            }
        }
    }
    bands
}

/// The largest of each, with its place.
fn caption(milled: &Milled, measure: Measure) -> String {
    let unit = measure.symbol();
    let at = |place: &MillingPlace| {
        let [x, y, z] = place.at.map(|at| measure.coarse(at));
        format!("line {}, X{x} Y{y} Z{z}", place.line)
    };
    let mut said = String::from("Seen from above.");
    let mut length = |name: &str, of: &Option<Largest<units::Length>>| {
        if let Some(most) = of {
            let value = measure.length(most.value);
            let _ = write!(said, " {name} {value} {unit} at most ({}).", at(&most.place));
        }
    };
    length("Axial depth", &milled.depth);
    length("Radial width", &milled.width);
    length("Chip of a tooth", &milled.chip);
    if let Some(angle) = &milled.angle {
        let degrees = fixed(angle.value.in_deg(), 0);
        let _ = write!(said, " Engaged over {degrees}° at most ({}).", at(&angle.place));
    }
    match &milled.force {
        Some(force) => {
            let value = fixed(force.value.value(), 0);
            let _ = write!(
                said,
                " Tangential force {value} N at most, estimated ({}).",
                at(&force.place)
            );
        }
        None => said.push_str(" Force is not judged: teeth or material are not known."),
    }
    if let Some(cell) = milled.cell {
        let _ = write!(
            said,
            " Cells of {} {unit}, {} kB: walls may stand half a cell off.",
            measure.length(cell),
            milled.grid_bytes / 1000
        );
    }
    said
}
