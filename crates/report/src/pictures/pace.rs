//! How fast, where, and why not faster.
//!
//! ```text
//!   the path from above, coloured by speed      speed, acceleration and jerk over time      seconds by what limited
//! ```
use super::figure;
use super::tool_path::{above, axes};
use crate::Run;
use crate::record::{CLASSES, Limiter, Point, Recorder, class_bounds};
use crate::svg::{Chart, Range, Stroke, Tag, fixed};

/// How it is drawn, its points, its name.
type Curve<'a> = (Stroke, &'a [(f64, f64)], &'a str);

/// Colours of the classes of speed, slow to fast; the last ones are for all that are faster.
const COLOURS: [&str; 6] =
    ["line pace0", "line pace1", "line pace2", "line pace3", "line pace4", "line pace5"];

/// What limited, and what would make it faster.
const LIMITERS: [(Limiter, &str, &str); 5] = [
    (Limiter::Feed, "programmed feed", "a higher F"),
    (Limiter::Speed, "highest speed of an axis", "a faster axis"),
    (Limiter::Acceleration, "acceleration of an axis", "a larger P of G64"),
    (Limiter::Jerk, "jerk of an axis", "a larger P, more jerk"),
    (Limiter::Nothing, "none of these", "—"),
];

/// The pictures; nothing if nothing moved along a path for a while.
pub(crate) fn pace(run: &Run, recorder: &Recorder) -> String {
    let points: Vec<Point> = recorder.pace.track.points().collect();
    let all: f64 = recorder.pace.limited.iter().sum();
    if points.len() < 2 || all <= 0.0 {
        return String::new();
    }
    coloured(run, &points) + &over_time(recorder) + &limiters(recorder, all)
}

fn coloured(run: &Run, points: &[Point]) -> String {
    let zero = run.zero();
    let view = |p: &Point| above(std::array::from_fn(|i| p.at[i] - zero[i]));
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
    let seen = || lines.iter().flatten().flatten();
    if seen().next().is_none() {
        return String::new();
    }
    let x = Range::of("across the view / mm", seen().map(|p| p.0)).padded(0.06);
    let y = Range::of("up the view / mm", seen().map(|p| p.1)).padded(0.06);
    let mut chart = Chart::to_scale(
        "Tool path by speed",
        "Path of the tool's tip while cutting, coloured by its speed.",
        x,
        y,
    );
    // the fastest have a colour each, all that are slower share one
    let fastest = (0..CLASSES).rev().find(|class| !lines[usize::from(*class)].is_empty());
    let slow = fastest.unwrap_or(0).saturating_sub(COLOURS.len() as u8 - 1);
    let below: Vec<_> = lines[..=usize::from(slow)].concat();
    let round = |v: f64| fixed(v, usize::from(v < 10.0));
    chart.coloured(COLOURS[0], &below, &format!("up to {} mm/s", round(class_bounds(slow).1)));
    for (class, colour) in (slow + 1..CLASSES).zip(&COLOURS[1..]) {
        let label = format!("to {}", round(class_bounds(class).1));
        chart.coloured(colour, &lines[usize::from(class)], &label);
    }
    axes(&mut chart, above);
    let caption = "Cutting moves by the speed of their setpoints, from above. Slow stretches are corners, tight bends and short moves; \
        the table beside says what kept them slow.";
    figure("Tool path by speed", &chart.finish("pace-path"), caption)
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
    let speeds = chart(
        "pace-speed",
        "Speed along the path",
        "speed / mm/s",
        &[(Stroke::Main, speed.as_slice(), "speed along the path")],
    );
    let mut curves = vec![(Stroke::Second, accel.as_slice(), "acceleration")];
    if jerk.iter().any(|p| p.1 > 0.0) {
        curves.insert(0, (Stroke::Share, jerk.as_slice(), "jerk"));
    }
    let shares =
        chart("pace-shares", "Share of the axes' limits", "share of an axis' limit / %", &curves);
    figure("Speed over time", &speeds, "Of the setpoints of X, Y and Z, in feeds and rapids.")
        + &figure(
            "Acceleration and jerk over time",
            &shares,
            "The largest share that X, Y or Z has of what it can, by differences of the setpoints.",
        )
}

fn limiters(recorder: &Recorder, all: f64) -> String {
    let head = "<thead><tr><th class=\"l\">limited by</th><th>s</th><th>%</th><th class=\"l\">faster with</th></tr></thead>";
    let rows: String = LIMITERS
        .iter()
        .map(|(limiter, name, remedy)| (recorder.pace.limited[*limiter as usize], name, remedy))
        .filter(|(seconds, ..)| *seconds > 0.0)
        .map(|(seconds, name, remedy)| {
            let cell = |class: &str, text: &str| Tag::new("td").with("class", class).text(text);
            Tag::new("tr").around(
                &(cell("l", name)
                    + &cell("", &fixed(seconds, 2))
                    + &cell("", &fixed(100.0 * seconds / all, 1))
                    + &cell("l", remedy)),
            )
        })
        .collect();
    let table = Tag::new("table").around(&(head.to_owned() + &Tag::new("tbody").around(&rows)));
    figure(
        "What limited the motion",
        &table,
        "Seconds of feeds and rapids, by what the setpoints had reached.",
    )
}
