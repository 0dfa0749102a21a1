//! The picture of a cycle's steps, from what the page's own log says: height and spindle over time.
//!
//! ```text
//!   Z ──1─╲        ╱──      numbers: steps in their order, named below
//!          2╲__3_4╱
//!   n ____╱▔▔▔╲____        mean speed within each step, from the revolutions of the log
//! ```
use std::fmt::Write as _;

/// One line of the log.
struct Row {
    time: f64,
    state: String,
    z: f64,
    rev: f64,
}

/// One step: a row and the one after it.
struct Step<'a> {
    from: &'a Row,
    to: &'a Row,
}

const WIDTH: f64 = 720.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 12.0;
const Z_BAND: [f64; 2] = [18.0, 208.0];
const N_BAND: [f64; 2] = [236.0, 322.0];
/// Shorter than this, s, a step gets no number; nor does the settling of the axes.
const SHORTEST_S: f64 = 0.012;
/// Steps that are shown at most: those of the last cycle before the end.
const MOST: usize = 24;

/// The drawing of a log block; nothing if it has no steps.
pub(crate) fn picture(title: &str, log: &str) -> Option<String> {
    let rows: Vec<Row> = log.lines().filter_map(row).collect();
    let begin = rows.iter().rposition(|row| row.state == "tool-change").map_or(0, |at| at + 1);
    let end = rows.iter().position(|row| row.state == "ended").unwrap_or(rows.len() - 1);
    let rows = rows.get(begin..=end)?;
    // the way to the first hole is no step of the cycle
    let cut = |row: &Row| ["feed", "tap-in"].contains(&row.state.as_str());
    let first = rows.iter().position(cut)?.saturating_sub(3);
    let rows = &rows[first..rows.len().min(first + MOST + 1)];
    let steps: Vec<Step> = rows.windows(2).map(|w| Step { from: &w[0], to: &w[1] }).collect();
    (steps.len() > 1).then(|| draw(title, &steps))
}

fn row(line: &str) -> Option<Row> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let [time, _line, state, _x, _y, z, rev, _rpm] = words[..] else { return None };
    Some(Row {
        time: time.parse().ok()?,
        state: state.to_owned(),
        z: z.parse().ok()?,
        rev: rev.parse().ok()?,
    })
}

impl Step<'_> {
    fn seconds(&self) -> f64 {
        (self.to.time - self.from.time).max(1e-3)
    }
    fn rpm(&self) -> f64 {
        (self.to.rev - self.from.rev) / self.seconds() * 60.0
    }
    /// Its class in the drawing.
    fn class(&self) -> &'static str {
        match self.from.state.as_str() {
            "rapid" => "r",
            "feed" | "tap-in" => "i",
            "tap-out" => "o",
            _ => "w",
        }
    }
    fn name(&self) -> String {
        let what = match self.from.state.as_str() {
            "tap-in" => "tap in",
            "tap-out" => "tap out",
            "tap-bottom" => "stand at the bottom",
            "spindle-wait" => "wait for the spindle",
            other => other,
        };
        format!("{what} {:.3} s", self.seconds())
    }
}

fn draw(title: &str, steps: &[Step]) -> String {
    let (t0, t1) = (steps[0].from.time, steps[steps.len() - 1].to.time);
    let x = |t: f64| LEFT + (t - t0) / (t1 - t0) * (WIDTH - LEFT - RIGHT);
    let zs = || steps.iter().flat_map(|s| [s.from.z, s.to.z]);
    let z = band(zs(), Z_BAND);
    let n = band(steps.iter().map(Step::rpm).chain([0.0]), N_BAND);
    let mut out = String::new();
    grid(&mut out, zs(), &z, "Z of the tip / mm", Z_BAND);
    grid(&mut out, steps.iter().map(Step::rpm).chain([0.0]), &n, "mean / rpm", N_BAND);
    let mut speed = String::new();
    let mut names = Vec::new();
    let mut last = f64::NEG_INFINITY;
    let mut down = 0.0;
    for step in steps {
        let (a, b) = (x(step.from.time), x(step.to.time));
        let (from, to) = (z(step.from.z), z(step.to.z));
        let _ = writeln!(
            out,
            "<path class=\"{}\" d=\"M{a:.1} {from:.1}L{b:.1} {to:.1}\"/>",
            step.class()
        );
        let _ = write!(speed, "M{a:.1} {0:.1}H{b:.1}", n(step.rpm()));
        if step.seconds() >= SHORTEST_S && step.from.state != "settle" {
            names.push(step.name());
            let middle = f64::midpoint(a, b);
            down = if middle - last < 15.0 { 12.0 - down } else { 0.0 };
            last = middle;
            let number = names.len();
            let y = N_BAND[1] + 16.0 + down;
            let _ =
                writeln!(out, "<text class=\"n\" x=\"{middle:.1}\" y=\"{y:.1}\">{number}</text>");
            let _ = writeln!(out, "<path class=\"g\" d=\"M{a:.1} {}V{}\"/>", Z_BAND[0], N_BAND[1]);
        }
    }
    let _ = writeln!(out, "<path class=\"s\" d=\"{speed}\"/>");
    let height = legend(&mut out, &names, t1 - t0);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\">\n<title>{title}: its steps</title>\n<style>{STYLE}</style>\n\
         <rect class=\"b\" width=\"{WIDTH}\" height=\"{height:.0}\"/>\n{out}</svg>\n"
    )
}

const STYLE: &str = "text{font:12px sans-serif;fill:#222}.n{text-anchor:middle;font-weight:600}.y{text-anchor:end;fill:#555;font-size:11px}\
    .a{text-anchor:middle;fill:#555}.b{fill:#fff}.g{stroke:#e4e4e4;fill:none}.z{stroke:#bbb;fill:none}path{fill:none;stroke-width:2}\
    .g,.z{stroke-width:1}.r{stroke:#888;stroke-dasharray:5 4}.i{stroke:#0b5fa5}.o{stroke:#b3541e}.w{stroke:#7a3fa0;stroke-width:3}.s{stroke:#222;stroke-width:1.6}";

/// From values to heights in a band.
fn band(values: impl Iterator<Item = f64>, [top, bottom]: [f64; 2]) -> impl Fn(f64) -> f64 {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let span = (high - low).max(1e-9);
    move |v| bottom - (v - low) / span * (bottom - top)
}

/// Lowest and highest value and zero, and the axis' title.
fn grid(
    out: &mut String,
    values: impl Iterator<Item = f64>,
    place: &impl Fn(f64) -> f64,
    title: &str,
    [top, bottom]: [f64; 2],
) {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let mut marks = vec![low, high];
    if low < 0.0 && high > 0.0 && (place(0.0) - top).min(bottom - place(0.0)) > 13.0 {
        marks.push(0.0);
    }
    for value in marks {
        let y = place(value);
        let _ = writeln!(out, "<path class=\"z\" d=\"M{LEFT} {y:.1}H{}\"/>", WIDTH - RIGHT);
        let x = LEFT - 5.0;
        let shown =
            if value.abs() >= 1000.0 { format!("{value:.0}") } else { format!("{value:.1}") };
        let _ = writeln!(out, "<text class=\"y\" x=\"{x}\" y=\"{:.1}\">{shown}</text>", y + 4.0);
    }
    let middle = f64::midpoint(top, bottom);
    let _ = writeln!(
        out,
        "<text class=\"a\" transform=\"translate(12 {middle:.1}) rotate(-90)\">{title}</text>"
    );
}

/// Names of the steps in two columns, and the legend of the lines; the height of all.
fn legend(out: &mut String, names: &[String], seconds: f64) -> f64 {
    let top = N_BAND[1] + 54.0;
    let rows = names.len().div_ceil(3).max(1);
    for (at, name) in names.iter().enumerate() {
        let (column, row) = (at / rows, at % rows);
        let (x, y) = (LEFT + 215.0 * column as f64, top + 17.0 * row as f64);
        let _ = writeln!(out, "<text x=\"{x:.0}\" y=\"{y:.0}\">{} {name}</text>", at + 1);
    }
    let y = top + 17.0 * rows as f64 + 8.0;
    let kinds =
        [("r", "rapid"), ("i", "in the material, in"), ("o", "out"), ("w", "waiting, dwell")];
    for (at, (class, name)) in kinds.iter().enumerate() {
        let x = LEFT + 150.0 * at as f64;
        let _ = writeln!(out, "<path class=\"{class}\" d=\"M{x:.0} {0:.0}h26\"/>", y - 4.0);
        let _ = writeln!(out, "<text x=\"{:.0}\" y=\"{y:.0}\">{name}</text>", x + 32.0);
    }
    let _ = writeln!(
        out,
        "<text class=\"y\" x=\"{}\" y=\"{y:.0}\">{seconds:.2} s</text>",
        WIDTH - RIGHT
    );
    y + 12.0
}
