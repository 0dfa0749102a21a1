//! A picture in a screenful: lines over axes, as SVG. Each example draws one into docs/pictures.
use std::{fmt::Write, fs, path::Path};

/// A line of the picture.
pub struct Line {
    /// What it is.
    pub name: &'static str,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

const WIDE: f64 = 640.0;
const HIGH: f64 = 360.0;
const EDGE: f64 = 60.0;
const COLOURS: [&str; 4] = ["#0061a8", "#d98200", "#006b4f", "#77787b"];

/// Draw lines into `docs/pictures/NAME.svg` and say where.
///
/// # Errors
/// When the file cannot be written.
pub fn draw(name: &str, title: &str, [x, y]: [&str; 2], lines: &[Line]) -> std::io::Result<()> {
    let range = |of: fn(&(f64, f64)) -> f64| {
        let all = lines.iter().flat_map(|l| &l.points).map(of);
        all.fold((f64::MAX, f64::MIN), |(least, most), v| (least.min(v), most.max(v)))
    };
    let ((x0, x1), (y0, y1)) = (range(|p| p.0), range(|p| p.1));
    let at = |(px, py): (f64, f64)| {
        let u = EDGE + (px - x0) / (x1 - x0) * (WIDE - 2.0 * EDGE);
        let v = HIGH - EDGE - (py - y0) / (y1 - y0) * (HIGH - 2.0 * EDGE);
        (u, v)
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDE} {HIGH}\" font-family=\"sans-serif\" \
         font-size=\"12\"><rect width=\"{WIDE}\" height=\"{HIGH}\" fill=\"white\"/>\
         <text x=\"{EDGE}\" y=\"22\" font-size=\"15\">{title}</text>\
         <text x=\"{:.0}\" y=\"{:.0}\" text-anchor=\"middle\">{x}</text><text x=\"{EDGE}\" y=\"48\">{y}</text>",
        WIDE / 2.0,
        HIGH - 14.0
    );
    for (value, along_x) in [(x0, true), (x1, true), (y0, false), (y1, false)] {
        let (u, v) = at(if along_x { (value, y0) } else { (x0, value) });
        let (u, v) = if along_x { (u, v + 18.0) } else { (u - 8.0, v + 4.0) };
        let anchor = if along_x { "middle" } else { "end" };
        let value = format!("{value:.2}");
        let value = value.trim_end_matches('0').trim_end_matches('.');
        let _ =
            write!(svg, "<text x=\"{u:.0}\" y=\"{v:.0}\" text-anchor=\"{anchor}\">{value}</text>");
    }
    for (index, line) in lines.iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let points: Vec<_> =
            line.points.iter().map(|p| at(*p)).map(|(u, v)| format!("{u:.1},{v:.1}")).collect();
        let (points, label) = (points.join(" "), 40.0 + 16.0 * index as f64);
        let _ = write!(
            svg,
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>\
             <text x=\"{:.0}\" y=\"{label:.0}\" fill=\"{colour}\" text-anchor=\"end\">{}</text>",
            WIDE - 8.0,
            line.name
        );
    }
    svg.push_str("</svg>\n");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures");
    let path = path.join(format!("{name}.svg"));
    fs::write(&path, svg)?;
    println!("docs/pictures/{name}.svg");
    Ok(())
}
