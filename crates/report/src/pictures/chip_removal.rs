//! Chip removal: spindle and axes over time from hole to hole, and what the overlap saves.
use super::figure::figure;
use crate::record::{ChipRow, Hop, Recorder};
use crate::svg::{Chart, Range, Stroke, Tag, fixed};

/// How it looks, its points, its name in the legend.
type Curve<'a> = (Stroke, Vec<(f64, f64)>, Option<&'a str>);

/// What is shown before and after the manoeuvre, s.
const AROUND_S: f64 = 0.12;

/// What a number beside its line takes.
const ROOM: f64 = 14.0;

/// The picture and its table; nothing if no chips were thrown off.
pub(crate) fn chip_removal(recorder: &Recorder) -> String {
    let Some((hop, rows, cuts)) = recorder.chips.shown() else { return String::new() };
    let rows: Vec<ChipRow> = rows.iter().copied().collect();
    if rows.len() < 2 {
        return String::new();
    }
    let begin = rows[0].time;
    let events = events(&hop, begin);
    let marks: Vec<(f64, String)> = events.iter().map(|e| (e.0, e.1.to_string())).collect();
    let holes: Vec<(f64, String)> =
        cuts.iter().map(|(hole, at)| (at - begin, format!("hole {hole}"))).collect();
    let line = |of: fn(&ChipRow) -> f64| -> Vec<(f64, f64)> {
        rows.iter().map(|row| (row.time - begin, of(row))).collect()
    };
    let speed = [(Stroke::Main, line(|r| r.rpm), None)];
    let z = [(Stroke::Main, line(|r| r.at[2]), None)];
    let first = rows[0].at;
    let xy: [Curve; 2] = [
        (Stroke::Main, shifted(&rows, begin, 0, first[0]), Some("X")),
        (Stroke::Capability, shifted(&rows, begin, 1, first[1]), Some("Y")),
    ];
    let near = |(t, _): &(f64, f64)| {
        marks
            .first()
            .zip(marks.last())
            .is_some_and(|(first, last)| (first.0 - AROUND_S..=last.0 + AROUND_S).contains(t))
    };
    let close = |line: Vec<(f64, f64)>| line.into_iter().filter(near).collect::<Vec<_>>();
    let speed_near = [(Stroke::Main, close(line(|r| r.rpm)), None)];
    let z_near = [(Stroke::Main, close(line(|r| r.at[2])), None)];
    let near =
        chart(
            "Spindle near by",
            "spindle speed / rpm",
            &speed_near,
            &marks,
            &[],
            "chips-nn",
            230.0,
        ) + &chart("Tip near by", "Z of the tip / mm", &z_near, &marks, &[], "chips-nz", 190.0);
    let drawing =
        chart("Spindle speed", "spindle speed / rpm", &speed, &marks, &holes, "chips-n", 230.0)
            + &chart("Height of the tip", "Z of the tip / mm", &z, &marks, &[], "chips-z", 190.0)
            + &chart("Way of X and Y", "way / mm", &xy, &marks, &[], "chips-xy", 170.0)
            + &list(&events);
    let caption = "The spindle runs against its direction while the axes rise, travel and come down; the cut waits until it has the \
        speed and direction of the cut. Look at 5: it must not come before 4.";
    figure("Chip removal on the way", &drawing, caption)
        + &figure(
            "The manoeuvre",
            &near,
            "The same, near by, with all numbers. From 1 to 4 it lasts; as far as the way to the next hole lasts, it costs nothing.",
        )
        + &figure(
            "What the overlap saves",
            &table(&recorder.chips.hops),
            "Seconds from leaving one hole's R plane to the next cut, as they were measured; not overlapped is the hop \
        without removal and the manoeuvre after it.",
        )
}

fn shifted(rows: &[ChipRow], begin: f64, axis: usize, from: f64) -> Vec<(f64, f64)> {
    rows.iter().map(|row| (row.time - begin, row.at[axis] - from)).collect()
}

/// Time, number, what happened.
fn events(hop: &Hop, begin: f64) -> Vec<(f64, usize, String)> {
    let Some(seen) = hop.removal else { return Vec::new() };
    let named = [
        (Some(seen.told), "R plane left, told to turn back"),
        (seen.reached, "speed that throws chips off reached, told to turn forward"),
        (seen.forward, "zero passed"),
        (seen.ready, "as the next cut needs it"),
        (Some(hop.cut), "cut begins"),
    ];
    named
        .into_iter()
        .enumerate()
        .filter_map(|(at, (time, name))| time.map(|t| (t - begin, at + 1, name.to_owned())))
        .collect()
}

fn chart(
    title: &str,
    axis: &str,
    lines: &[Curve],
    marks: &[(f64, String)],
    holes: &[(f64, String)],
    id: &str,
    height: f64,
) -> String {
    let points = || lines.iter().flat_map(|line| line.1.iter());
    let x = Range::of("time / s", points().map(|p| p.0));
    let y = Range::of(axis, points().map(|p| p.1)).padded(0.14);
    let (bottom, top) = (y.from, y.to);
    let description = format!("{title} over time, around the first chip removal.");
    let mut chart = Chart::new(title, &description, x, y, height);
    chart.zero(false);
    for (at, _) in marks {
        chart.line(Stroke::Ideal, &[(*at, bottom), (*at, top)], None);
    }
    for (stroke, line, label) in lines {
        chart.line(*stroke, line, *label);
    }
    let apart = |nth: usize, other: Option<usize>| {
        let other = other.and_then(|other| marks.get(other));
        other.is_none_or(|other| (other.0 - marks[nth].0).abs() * chart.units_per_x() > ROOM)
    };
    // to the right of its line, else to the left; between lines that stand close a number is left
    // out
    let sides: Vec<_> = (0..marks.len())
        .map(|nth| match (apart(nth, Some(nth + 1)), apart(nth, nth.checked_sub(1))) {
            (true, _) => Some(("name start", 3.0)),
            (false, true) => Some(("name", -3.0)),
            (false, false) => None,
        })
        .collect();
    for ((at, name), side) in marks.iter().zip(sides) {
        if let Some((class, by)) = side {
            chart.word((*at, top), (by, 12.0), class, name);
        }
    }
    for (at, name) in holes {
        chart.word((*at, bottom), (3.0, -5.0), "name start", name);
    }
    chart.finish(id)
}

fn list(events: &[(f64, usize, String)]) -> String {
    let items: String = events
        .iter()
        .map(|(at, number, name)| {
            Tag::new("li").text(&format!("{number} {name}: {} s", fixed(*at, 3)))
        })
        .collect();
    Tag::new("ul").class("legend").around(&items)
}

/// Hops of a program without, with, and as if without overlap.
pub(crate) struct Times {
    /// Mean of a hop without removal.
    pub(crate) plain: f64,
    /// Mean of a hop with it.
    pub(crate) overlapped: f64,
    /// What it would be one after the other.
    pub(crate) apart: f64,
    /// Removals.
    pub(crate) count: usize,
}

pub(crate) fn times(hops: &[Hop]) -> Option<Times> {
    let mean = |values: Vec<f64>| {
        let n = values.len();
        (n > 0).then(|| values.iter().sum::<f64>() / n as f64)
    };
    let with = || hops.iter().filter_map(|hop| hop.removal.map(|seen| (hop, seen)));
    let overlapped = mean(with().map(|(hop, _)| hop.cut - hop.from).collect())?;
    let less_waits = mean(with().map(|(hop, _)| hop.cut - hop.from - hop.waited).collect())?;
    let without = hops.iter().filter(|hop| hop.removal.is_none());
    let plain = mean(without.map(|hop| hop.cut - hop.from).collect()).unwrap_or(less_waits);
    let manoeuvre = mean(with().filter_map(|(_, m)| m.ready.map(|at| at - m.told)).collect())?;
    Some(Times { plain, overlapped, apart: plain + manoeuvre, count: with().count() })
}

fn table(hops: &[Hop]) -> String {
    let Some(times) = times(hops) else { return String::new() };
    let heads = ["", "a hop / s", "more than no removal / s", "in all / s"];
    let head: String = heads
        .iter()
        .enumerate()
        .map(|(at, name)| Tag::new("th").class(if at == 0 { "l" } else { "" }).text(name))
        .collect();
    let row = |name: &str, hop: f64| {
        let more = hop - times.plain;
        let cells = [fixed(hop, 3), fixed(more, 3), fixed(more * times.count as f64, 3)];
        let cells: String = cells.iter().map(|cell| Tag::new("td").text(cell)).collect();
        Tag::new("tr").around(&(Tag::new("td").class("l").text(name) + &cells))
    };
    let body = row("no removal", times.plain)
        + &row("removal, overlapped", times.overlapped)
        + &row("removal, not overlapped", times.apart);
    let head = Tag::new("thead").around(&Tag::new("tr").around(&head));
    let table = Tag::new("table").around(&(head + &Tag::new("tbody").around(&body)));
    Tag::new("div").class("scroll").with("tabindex", "0").around(&table)
}
