//! A rehearsed recovery as a picture: where the tap stands off its thread, and the way back.
//!
//! ```text
//!   z │ PS                          z − g(θ) │        ○ Pb
//!     │  ╲                                   │        ┆
//!     │   ╲                                  │        ┆ back onto the thread
//!     │    ╲○ Pb                             │        ▼
//!     │   PE╲                              0 │ ───────●── the thread: out together
//!     └────────── turns                      └──────────── degrees
//! ```
//!
//! On the left the whole stroke; on the right the distance from the thread in micrometres, which on
//! the left is too small to be seen.
use crate::svg::{escape, fixed, ticks};
use std::fmt::Write as _;

/// Points are [turns of the spindle from the start, z over the surface in mm].
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// What it is about.
    pub title: String,
    /// PS.
    pub start: [f64; 2],
    /// PE.
    pub end: [f64; 2],
    /// Where spindle and feed stand.
    pub stop: [f64; 2],
    /// The way that is taken: unloaded, and on the coupling.
    pub chosen: [[f64; 2]; 2],
    /// Where the document's rule would join the coupling.
    pub direct: [f64; 2],
}

const WIDTH: f64 = 435.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 66.0;
const TOP: f64 = 64.0;
const FONT: &str = "font-family='system-ui,sans-serif' font-size='13' fill='#333'";

/// One panel: data ranges and where it stands.
struct Panel {
    x: [f64; 2],
    y: [f64; 2],
    left: f64,
}

impl Panel {
    fn around(points: &[[f64; 2]], left: f64) -> Self {
        let range = |i: usize| {
            let values = points.iter().map(|p| p[i]);
            let (from, to) =
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            let more = ((to - from) * 0.12).max(1e-3);
            [from - more, to + more]
        };
        Self { x: range(0), y: range(1), left }
    }

    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.left + LEFT + (x - self.x[0]) / (self.x[1] - self.x[0]) * (WIDTH - LEFT - 14.0),
            TOP + (self.y[1] - y) / (self.y[1] - self.y[0]) * HEIGHT,
        ]
    }

    fn line(&self, out: &mut String, points: &[[f64; 2]], style: &str) {
        let points = points.iter().map(|p| {
            let [x, y] = self.place(*p);
            format!("{},{}", fixed(x, 1), fixed(y, 1))
        });
        let points = points.collect::<Vec<_>>().join(" ");
        let _ = write!(out, "<polyline points='{points}' fill='none' {style}/>");
    }

    fn dot(&self, out: &mut String, at: [f64; 2], fill: &str) {
        let [x, y] = self.place(at);
        let (x, y) = (fixed(x, 1), fixed(y, 1));
        let _ = write!(out, "<circle cx='{x}' cy='{y}' r='5' fill='{fill}' stroke='#111'/>");
    }

    /// Frame, ticks, titles: of the panel, across and up.
    fn axes(&self, out: &mut String, [heading, across, up]: [&str; 3]) {
        let (left, right) = (self.left + LEFT, self.left + WIDTH - 14.0);
        let bottom = TOP + HEIGHT;
        let _ = write!(
            out,
            "<text x='{left}' y='{}' {FONT} font-weight='600'>{heading}</text><path d='M{left} {TOP}V{bottom}H{right}' fill='none' stroke='#999'/>",
            TOP - 12.0
        );
        for (vertical, range) in [(false, self.x), (true, self.y)] {
            let ticks = ticks(range[0], range[1], 5);
            for value in ticks.values {
                let [x, y] =
                    self.place(if vertical { [self.x[0], value] } else { [value, self.y[0]] });
                let label = fixed(value, ticks.decimals);
                let _ = if vertical {
                    write!(
                        out,
                        "<text x='{}' y='{}' {FONT} text-anchor='end'>{label}</text>",
                        fixed(x - 6.0, 1),
                        fixed(y + 4.0, 1)
                    )
                } else {
                    write!(
                        out,
                        "<text x='{}' y='{}' {FONT} text-anchor='middle'>{label}</text>",
                        fixed(x, 1),
                        fixed(y + 18.0, 1)
                    )
                };
            }
        }
        let middle = f64::midpoint(left, right);
        let _ = write!(
            out,
            "<text x='{middle}' y='{}' {FONT} text-anchor='middle'>{across}</text><text transform='translate({},{}) rotate(-90)' {FONT} text-anchor='middle'>{up}</text>",
            bottom + 40.0,
            self.left + 16.0,
            TOP + HEIGHT / 2.0
        );
    }
}

/// The picture, as an SVG of its own.
pub fn recovery_svg(r: &Recovery) -> String {
    const THREAD: &str = "stroke='#8a8a8a' stroke-width='1.5'";
    const FIRST: &str = "stroke='#c2410c' stroke-width='4'";
    const OUT: &str = "stroke='#15803d' stroke-width='3'";
    const OTHER: &str = "stroke='#1d4ed8' stroke-width='2' stroke-dasharray='5 4'";
    const STANDS: &str = "#f97316";
    /// Least part of a turn that is shown on each side.
    const LEAST_DEG: f64 = 5.0;
    let on = r.chosen[1];
    let mut out = String::new();
    let (width, height) = (2.0 * WIDTH + 10.0, TOP + HEIGHT + 116.0);
    let _ = write!(
        out,
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}'><rect width='100%' height='100%' fill='#fff'/><text x='{LEFT}' y='26' font-family='system-ui,sans-serif' font-size='16' fill='#333' font-weight='600'>{}</text>",
        escape(&r.title)
    );
    let whole = Panel::around(&[r.start, r.end, r.stop], 0.0);
    whole.axes(
        &mut out,
        ["the whole stroke", "spindle angle from the start / turns", "z over the surface / mm"],
    );
    whole.line(&mut out, &[r.start, r.end], THREAD);
    whole.line(&mut out, &[on, r.start], OUT);
    whole.dot(&mut out, r.stop, STANDS);
    // the neighbourhood: degrees from where it stands, micrometres from the thread
    let slope = (r.end[1] - r.start[1]) / (r.end[0] - r.start[0]);
    let off = |p: [f64; 2]| {
        let thread = r.start[1] + slope * (p[0] - r.start[0]);
        [(p[0] - r.stop[0]) * 360.0, (p[1] - thread) * 1e3]
    };
    let (stop, direct, chosen) = (off(r.stop), off(r.direct), r.chosen.map(off));
    let inner = [stop, direct, chosen[0], chosen[1]];
    let reach = inner.iter().fold(LEAST_DEG, |most: f64, p| most.max(p[0].abs())) * 1.4;
    let out_to = if r.start[0] < r.stop[0] { -reach } else { reach };
    let thread = [[-reach, 0.0], [reach, 0.0]];
    let close = Panel::around(&[&inner[..], &thread].concat(), WIDTH + 10.0);
    close.axes(
        &mut out,
        [
            "where it stands, enlarged",
            "spindle angle from where it stands / °",
            "distance from the thread / µm",
        ],
    );
    close.line(&mut out, &thread, THREAD);
    close.line(&mut out, &[chosen[1], [out_to, 0.0]], OUT);
    close.line(&mut out, &[stop, chosen[0], chosen[1]], FIRST);
    close.line(&mut out, &[stop, direct], OTHER); // dashes over the other one, where they are the same
    close.dot(&mut out, stop, STANDS);
    close.dot(&mut out, chosen[1], "#22c55e");
    let legend = [
        (THREAD, "the thread"),
        (FIRST, "back onto the thread"),
        (OUT, "out, spindle and feed together"),
        (OTHER, "the axis that overran, not unloaded first"),
    ];
    for (at, (style, words)) in legend.iter().enumerate() {
        let x = LEFT + (WIDTH + 10.0) * (at % 2) as f64;
        let y = TOP + HEIGHT + 70.0 + 22.0 * (at / 2) as f64;
        let _ = write!(
            out,
            "<path d='M{x} {}h34' fill='none' {style}/><text x='{}' y='{y}' {FONT}>{words}</text>",
            y - 4.0,
            x + 44.0
        );
    }
    out + "</svg>\n"
}
