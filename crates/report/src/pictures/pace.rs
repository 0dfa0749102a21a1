//! How fast, where, and why not faster.
//!
//! ```text
//!   the path seen obliquely, coloured by speed, and by what limited it      speed, acceleration and jerk over time
//!   seconds by what limited, and what the limits of jerk cost
//! ```
use super::figure::figure;
use super::tool_path::{Looking, axes, looking};
use crate::record::{CLASSES, Limiter, Point, Recorder, Series, class_bounds};
use crate::svg::{Chart, Range, Stroke, Tag, fixed};
use crate::{Motion, Run};
use units::Time;

/// How it is drawn, its points, its name.
type Curve<'a> = (Stroke, &'a [(f64, f64)], &'a str);

/// Colours of the classes of speed, slow to fast; the last ones are for all that are faster.
const COLOURS: [&str; 6] =
    ["line pace0", "line pace1", "line pace2", "line pace3", "line pace4", "line pace5"];

/// What limited, in words, what would make it faster, and its colour.
const fn words(limiter: Limiter) -> [&'static str; 3] {
    match limiter {
        Limiter::Feed => ["programmed feed", "a higher F", "line lim0"],
        Limiter::Speed => ["highest speed of an axis", "a faster axis", "line lim1"],
        Limiter::Acceleration => ["acceleration of an axis", "a larger P of G64", "line lim2"],
        Limiter::Jerk => ["jerk of an axis", "a larger P of G64, more jerk", "line lim3"],
        Limiter::Spindle => ["turns of the spindle", "a higher S", "line lim5"],
        Limiter::Nothing => ["none of these", "—", "line lim4"],
    }
}

/// What would make a rapid faster: no word of the program rounds it or gives it a feed.
const fn of_rapids(limiter: Limiter) -> &'static str {
    match limiter {
        Limiter::Speed => "a shorter way",
        Limiter::Acceleration | Limiter::Jerk => "fewer stops: lower retracts, nearer holes",
        Limiter::Feed | Limiter::Spindle | Limiter::Nothing => "—",
    }
}

/// The pictures; nothing if nothing moved along a path for a while.
pub(crate) fn pace(run: &Run, recorder: &Recorder) -> String {
    let points: Vec<Point> = recorder.pace.track.points().collect();
    let all: f64 = recorder.pace.limited.iter().flatten().sum();
    if points.len() < 2 || all <= 0.0 {
        return String::new();
    }
    let limiting: Vec<Point> = recorder.pace.limiting.points().collect();
    let looking = looking(run, recorder);
    by_speed(run, &looking, &points, recorder.pace.turning.is_some())
        + &by_limit(run, &looking, &limiting)
        + &over_time(recorder)
        + &limiters(run, recorder, all)
}

/// Cuts as lines, by their class; empty if nothing was cut.
fn by_class(run: &Run, looking: &Looking, points: &[Point]) -> Vec<Vec<Vec<(f64, f64)>>> {
    let zero = run.zero();
    let millimetres = looking.measure.unit.in_mm();
    let seen = |p: &Point| std::array::from_fn(|i| (p.at[i] - zero[i]) / millimetres);
    let view = |p: &Point| (looking.view)(seen(p));
    let cuts = points.windows(2).filter(|pair| !pair[1].rapid && !pair[1].lifted);
    let mut lines: Vec<Vec<Vec<(f64, f64)>>> = vec![Vec::new(); usize::from(CLASSES)];
    for pair in cuts {
        let (a, b) = (view(&pair[0]), view(&pair[1]));
        let class = &mut lines[usize::from(pair[1].class)];
        match class.last_mut() {
            Some(line) if line.last() == Some(&a) => line.push(b),
            _ => class.push(vec![a, b]),
        }
    }
    lines
}

/// The view with room for these lines; `None` without any.
fn view_of(
    looking: &Looking,
    lines: &[Vec<Vec<(f64, f64)>>],
    title: &str,
    description: &str,
) -> Option<Chart> {
    let seen = || lines.iter().flatten().flatten();
    seen().next()?;
    let [across, up] = &looking.titles;
    let x = Range::of(across, seen().map(|p| p.0));
    let y = Range::of(up, seen().map(|p| p.1));
    Some(looking.chart(title, description, x, y))
}

fn by_speed(run: &Run, looking: &Looking, points: &[Point], turns_too: bool) -> String {
    let lines = by_class(run, looking, points);
    let description = "Path of the tool's tip while cutting, coloured by its speed.";
    let Some(mut chart) = view_of(looking, &lines, "Tool path by speed", description) else {
        return String::new();
    };
    // the fastest have a colour each, all that are slower share one
    let fastest = (0..CLASSES).rev().find(|class| !lines[usize::from(*class)].is_empty());
    let slow = fastest.unwrap_or(0).saturating_sub(COLOURS.len() as u8 - 1);
    let below: Vec<_> = lines[..=usize::from(slow)].concat();
    let round = |v: f64| fixed(v, usize::from(v < 10.0));
    chart.coloured(COLOURS[0], &below, &format!("up to {} mm/s", round(class_bounds(slow).1)));
    for (class, colour) in (slow + 1..CLASSES).zip(&COLOURS[1..]) {
        let label = format!("to {} mm/s", round(class_bounds(class).1));
        chart.coloured(colour, &lines[usize::from(class)], &label);
    }
    axes(&mut chart, looking);
    let turns = if turns_too { " The rotary axes that turn meanwhile are not in it." } else { "" };
    let caption = "Cutting moves by the speed of their setpoints along X, Y and Z. Slow stretches are corners, small \
        radii and short moves; the next picture says what kept them slow.";
    figure("Tool path by speed", &chart.finish("pace-path"), &(caption.to_owned() + turns))
}

fn by_limit(run: &Run, looking: &Looking, points: &[Point]) -> String {
    let lines = by_class(run, looking, points);
    let description =
        "Path of the tool's tip while cutting, coloured by what kept it from being faster.";
    let Some(mut chart) = view_of(looking, &lines, "Tool path by what limited it", description)
    else {
        return String::new();
    };
    for limiter in Limiter::ALL {
        let [name, _, colour] = words(limiter);
        chart.coloured(colour, &lines[limiter as usize], name);
    }
    axes(&mut chart, looking);
    let caption = "The same moves by what had reached its limit there: the programmed feed, or some axis' speed, acceleration or jerk.";
    figure("Tool path by what limited it", &chart.finish("pace-limits"), caption)
}

fn over_time(recorder: &Recorder) -> String {
    let pace = &recorder.pace;
    let (speed, accel, jerk) = (pace.speed.points(), pace.accel.points(), pace.jerk.points());
    let times = || speed.iter().map(|p| p.0);
    let chart = |id: &str, title: &str, y: &str, curves: &[Curve]| {
        let values = curves.iter().flat_map(|(_, curve, _)| curve.iter().map(|p| p.1));
        let y = Range::of(y, values.chain([0.0])).padded(0.04);
        let mut chart = Chart::new(title, title, Range::of("time / s", times()), y, 220.0);
        for (stroke, curve, label) in curves {
            chart.line(*stroke, curve, Some(label));
        }
        chart.finish(id)
    };
    let turning = pace.turning.as_ref().map(Series::points).unwrap_or_default();
    let mut speeds = vec![(Stroke::Main, speed.as_slice(), "X, Y, Z along the path / mm/s")];
    let unit = if turning.is_empty() { "speed / mm/s" } else { "speed / mm/s, °/s" };
    if !turning.is_empty() {
        speeds.push((Stroke::Second, turning.as_slice(), "A, B, C together / °/s"));
    }
    let speeds = chart("pace-speed", "Speed along the path", unit, &speeds);
    let mut curves = vec![(Stroke::Second, accel.as_slice(), "acceleration")];
    if jerk.iter().any(|p| p.1 > 0.0) {
        curves.insert(0, (Stroke::Share, jerk.as_slice(), "jerk"));
    }
    let shares =
        chart("pace-shares", "Share of the axes' limits", "share of the limit / %", &curves);
    figure(
        "Speed over time",
        &speeds,
        "Of the axes' setpoints, in feeds and rapids; zero is shown between them.",
    ) + &figure(
        "Acceleration and jerk over time",
        &shares,
        "The largest share that any axis has of what it can, by differences of the setpoints.",
    )
}

fn limiters(run: &Run, recorder: &Recorder, all: f64) -> String {
    let head = "<thead><tr><th class=\"l\">motion</th><th class=\"l\">limited by</th><th>s</th><th>%</th><th class=\"l\">faster with</th></tr></thead>";
    let of = |(what, seconds): (&'static str, [f64; 6])| {
        let each =
            Limiter::ALL.iter().map(move |limiter| (what, *limiter, seconds[*limiter as usize]));
        each.filter(move |(.., seconds)| *seconds > 5e-4 * all)
    };
    let kinds = ["cut", "rapid"].into_iter().zip(recorder.pace.limited);
    let rows: String = kinds
        .flat_map(of)
        .map(|(what, limiter, seconds)| {
            let [name, remedy, _] = words(limiter);
            let remedy = if what == "rapid" { of_rapids(limiter) } else { remedy };
            let cell = |class: &str, text: &str| Tag::new("td").with("class", class).text(text);
            Tag::new("tr").around(
                &(cell("l", what)
                    + &cell("l words", name)
                    + &cell("", &fixed(seconds, 2))
                    + &cell("", &fixed(100.0 * seconds / all, 1))
                    + &cell("l words", remedy)),
            )
        })
        .collect();
    let table = Tag::new("table").around(&(head.to_owned() + &Tag::new("tbody").around(&rows)));
    let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
    let caption = "Seconds of feeds and rapids, by what the setpoints had reached; none of these: overrides, holds, and changes from one \
        to the other.";
    figure("What limited the motion", &scroll, &(caption.to_owned() + &jerk_costs(run)))
}

/// What the limits of jerk cost, if the axes have any.
fn jerk_costs(run: &Run) -> String {
    let Some(Motion { planned, without_jerk }) = run.motion else { return String::new() };
    let (planned, Some(free)) = (planned.value(), without_jerk.map(Time::value)) else {
        return " No axis has a limit of jerk.".into();
    };
    if free <= 0.0 {
        return String::new();
    }
    let more = fixed(100.0 * (planned / free - 1.0).max(0.0), 1);
    format!(
        " Planned are {} s in motion; without limits of jerk it would be {} s: they cost {more} %.",
        fixed(planned, 2),
        fixed(free, 2)
    )
}
