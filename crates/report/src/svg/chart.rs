//! A chart: two axes with titles and ticks, and lines, limits and marks between them.
//!
//! ```text
//!        y title │          ┄┄┄┄┄┄┄┄┄┄ limit (dashed)
//!                │     ╱╲      ●  mark
//!                │ ╲╱╲╱  ╲╱╲   line
//!                └──┴──┴──┴──┴─ x title
//! ```
//!
//! Legends are HTML, below the drawing: there their words wrap on a phone.
use super::{Range, Stroke, Tag, escape, path_data};
use std::fmt::Write as _;

/// Room for tick labels and titles around the plot, picture units.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 12.0;
const BOTTOM: f64 = 44.0;

/// A sign at a point.
pub(crate) struct Mark<'a> {
    /// Where, in data.
    pub(crate) at: (f64, f64),
    /// Radius in picture units.
    pub(crate) radius: f64,
    /// Class in the style sheet.
    pub(crate) class: &'a str,
    /// What a pointer that rests on it reads.
    pub(crate) title: &'a str,
    /// Drawn as a cross in a square instead of a circle.
    pub(crate) crossed: bool,
}

/// Where a line is found, and where it leads.
pub(crate) struct Linked {
    /// Unique on the page.
    pub(crate) id: String,
    /// Such as "#L12".
    pub(crate) to: String,
    /// What a pointer that rests on it reads.
    pub(crate) title: String,
}

/// A chart being drawn.
pub(crate) struct Chart {
    title: String,
    description: String,
    x: Range,
    y: Range,
    width: f64,
    height: f64,
    body: String,
    front: String,
    legend: Vec<(&'static str, String)>,
    /// Heights at which names stand already, picture units.
    named: Vec<f64>,
}

impl Chart {
    /// Width of every chart, picture units; the type is 13 of them high.
    const WIDTH: f64 = 480.0;

    /// A chart of this height. Title and description are read by those who do not see it.
    pub(crate) fn new(title: &str, description: &str, x: Range, y: Range, height: f64) -> Self {
        Self {
            title: title.into(),
            description: description.into(),
            x,
            y,
            width: Self::WIDTH,
            height,
            body: String::new(),
            front: String::new(),
            legend: Vec::new(),
            named: Vec::new(),
        }
    }

    /// A chart in which a millimetre is as long along y as along x; as high as that asks for,
    /// within reason.
    pub(crate) fn to_scale(title: &str, description: &str, mut x: Range, mut y: Range) -> Self {
        let width = Self::WIDTH - LEFT - RIGHT;
        let height = (width * y.span() / x.span()).clamp(130.0, 360.0);
        let per_unit = f64::max(x.span() / width, y.span() / height);
        for (range, room) in [(&mut x, width), (&mut y, height)] {
            let more = (per_unit * room - range.span()) / 2.0;
            range.from -= more;
            range.to += more;
        }
        Self::new(title, description, x, y, height + TOP + BOTTOM)
    }

    /// Picture coordinates of a point.
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let across = (x - self.x.from) / self.x.span();
        let up = (y - self.y.from) / self.y.span();
        (
            LEFT + across * (self.width - LEFT - RIGHT),
            self.height - BOTTOM - up * (self.height - TOP - BOTTOM),
        )
    }

    /// A line through points, clipped to the plot; `label` goes into the legend.
    pub(crate) fn line(&mut self, stroke: Stroke, points: &[(f64, f64)], label: Option<&str>) {
        let data = path_data(points.iter().map(|&p| self.place(p)));
        if data.matches(' ').count() == 1 {
            // a line of one point is a dot: else the legend names a line that is not visible
            let class = format!("{} dot", stroke.class());
            self.body += &Tag::new("path").class(&class).with("d", &(data + "h0")).empty();
            self.legend.extend(label.map(|label| (stroke.class(), label.into())));
            return;
        }
        self.path(stroke.class(), &data, label);
    }

    /// Thin lines along which y, and if asked also x, is zero.
    pub(crate) fn zero(&mut self, also_x: bool) {
        let (from, to) = ((self.x.from, 0.0), (self.x.to, 0.0));
        self.line(Stroke::Zero, &[from, to], None);
        if also_x {
            let (from, to) = ((0.0, self.y.from), (0.0, self.y.to));
            self.line(Stroke::Zero, &[from, to], None);
        }
    }

    /// A cloud of dots.
    pub(crate) fn dots(&mut self, points: &[(f64, f64)], label: &str) {
        let dots = points.iter().map(|&p| path_data([self.place(p)]));
        let data: String = dots.filter(|d| !d.is_empty()).map(|d| d + "h0").collect();
        self.path("dots", &data, Some(label));
    }

    /// The area between two curves over the same x.
    pub(crate) fn area(
        &mut self,
        class: &'static str,
        bounds: &[(f64, [f64; 2])],
        label: Option<&str>,
    ) {
        for stretch in
            bounds.split(|(x, b)| !(x.is_finite() && b[0].is_finite() && b[1].is_finite()))
        {
            let there = stretch.iter().map(|&(x, [low, _])| self.place((x, low)));
            let back = stretch.iter().rev().map(|&(x, [_, high])| self.place((x, high)));
            let data = path_data(there.chain(back));
            if !data.is_empty() {
                self.body += &Tag::new("path").class(class).with("d", &(data + "Z")).empty();
            }
        }
        if let Some(label) = label
            && !bounds.is_empty()
        {
            self.legend.push((class, label.into()));
        }
    }

    /// Many lines of one kind, thinned to what can be seen.
    pub(crate) fn lines(&mut self, stroke: Stroke, lines: &[Vec<(f64, f64)>], label: Option<&str>) {
        self.path(stroke.class(), &self.data(lines), label);
    }

    fn data(&self, lines: &[Vec<(f64, f64)>]) -> String {
        let mut data = String::new();
        for line in lines {
            let placed: Vec<_> = line.iter().map(|&p| self.place(p)).collect();
            data += &path_data(super::thinned(&placed, 0.25));
        }
        data
    }

    /// Several lines of a class of their own, with one entry in the legend.
    pub(crate) fn coloured(&mut self, class: &'static str, lines: &[Vec<(f64, f64)>], label: &str) {
        self.path(class, &self.data(lines), Some(label));
    }

    /// Lines that are each a link of their own, so that they can be found from elsewhere on the
    /// page.
    pub(crate) fn linked(&mut self, stroke: Stroke, line: &Linked, lines: &[Vec<(f64, f64)>]) {
        let data = self.data(lines);
        if data.is_empty() {
            return;
        }
        let title = Tag::new("title").text(&line.title);
        let path = Tag::new("path").class(stroke.class()).with("id", &line.id).with("d", &data);
        self.body += &Tag::new("a").with("href", &line.to).around(&path.around(&title));
    }

    /// Filled rectangles of a class of their own, from corner to corner, with one entry in the
    /// legend.
    pub(crate) fn cells(&mut self, class: &'static str, cells: &[[f64; 4]], label: &str) {
        let mut data = String::new();
        for [left, low, right, high] in cells {
            let ((a, b), (c, d)) = (self.place((*left, *high)), self.place((*right, *low)));
            let _ = write!(data, "M{a:.1} {b:.1}H{c:.1}V{d:.1}H{a:.1}Z");
        }
        self.path(class, &data, Some(label));
    }

    fn path(&mut self, class: &'static str, data: &str, label: Option<&str>) {
        if data.is_empty() {
            return;
        }
        self.body += &Tag::new("path").class(class).with("d", data).empty();
        if let Some(label) = label {
            self.legend.push((class, label.into()));
        }
    }

    /// Limits at plus and minus a value, where the plot shows them; the legend names them.
    pub(crate) fn limits(&mut self, stroke: Stroke, value: f64, name: &str) {
        if !(self.y.from..=self.y.to).contains(&value) {
            return;
        }
        self.line(stroke, &[(self.x.from, value), (self.x.to, value)], Some(name));
        self.line(stroke, &[(self.x.from, -value), (self.x.to, -value)], None);
    }

    /// A horizontal line across the plot, named at its end.
    pub(crate) fn level(&mut self, stroke: Stroke, value: f64, name: &str) {
        self.line(stroke, &[(self.x.from, value), (self.x.to, value)], None);
        self.name_at(value, name);
    }

    fn name_at(&mut self, value: f64, name: &str) {
        let (x, y) = self.place((self.x.to, value));
        if self.named.iter().all(|other| (other - y).abs() > 14.0) {
            self.named.push(y);
            self.front +=
                &Tag::new("text").class("name").at("x", x - 4.0).at("y", y - 3.0).text(name);
        }
    }

    /// A stretch of x filled from bottom to top.
    pub(crate) fn band(&mut self, class: &'static str, from: f64, to: f64) {
        let (left, top) = self.place((from.max(self.x.from), self.y.to));
        let (right, bottom) = self.place((to.min(self.x.to), self.y.from));
        let band = Tag::new("rect").class(class).at("x", left).at("y", top);
        let (width, height) = (f64::max(right - left, 0.5), bottom - top);
        self.body.insert_str(0, &band.at("width", width).at("height", height).empty());
    }

    /// A sign at a point.
    pub(crate) fn mark(&mut self, mark: &Mark) {
        let (x, y) = self.place(mark.at);
        let r = mark.radius;
        let mut shape = if mark.crossed {
            let square = Tag::new("rect").at("x", x - r).at("y", y - r);
            square.at("width", 2.0 * r).at("height", 2.0 * r).empty()
        } else {
            Tag::new("circle").at("cx", x).at("cy", y).at("r", r).empty()
        };
        if mark.crossed {
            let a = r * 0.6;
            let cross =
                [(x - a, y - a), (x + a, y + a), (f64::NAN, 0.0), (x - a, y + a), (x + a, y - a)];
            shape += &Tag::new("path").with("d", &path_data(cross)).empty();
        }
        if !mark.title.is_empty() {
            shape.insert_str(0, &Tag::new("title").text(mark.title));
        }
        self.front += &Tag::new("g").class(mark.class).around(&shape);
    }

    /// A word beside a point, moved by picture units.
    pub(crate) fn word(&mut self, at: (f64, f64), by: (f64, f64), class: &str, word: &str) {
        let (x, y) = self.place(at);
        self.front += &Tag::new("text").class(class).at("x", x + by.0).at("y", y + by.1).text(word);
    }

    /// An entry of the legend for what is not a line.
    pub(crate) fn legend(&mut self, class: &'static str, label: &str) {
        self.legend.push((class, label.into()));
    }

    /// The point of the plot at these shares of its width and height, in data.
    pub(crate) fn inside(&self, across: f64, up: f64) -> (f64, f64) {
        (self.x.from + across * self.x.span(), self.y.from + up * self.y.span())
    }

    /// Picture units that one data unit takes along x.
    pub(crate) fn units_per_x(&self) -> f64 {
        (self.width - LEFT - RIGHT) / self.x.span()
    }

    fn grid(&self) -> String {
        let mut lines = Vec::new();
        let mut labels = String::new();
        let floor = self.height - BOTTOM;
        let most_x = ((self.width - LEFT - RIGHT) / 62.0) as usize;
        let most_y = (((self.height - TOP - BOTTOM) / 30.0) as usize).max(5);
        for (value, text) in self.x.labels(most_x) {
            let at = self.place((value, 0.0)).0;
            lines.extend([(at, TOP), (at, floor + 4.0), (f64::NAN, 0.0)]);
            let label = Tag::new("text").class("tick x").at("x", at).at("y", floor + 17.0);
            labels += &label.text(&text);
        }
        for (value, text) in self.y.labels(most_y) {
            let at = self.place((0.0, value)).1;
            lines.extend([(LEFT - 4.0, at), (self.width - RIGHT, at), (f64::NAN, 0.0)]);
            let label = Tag::new("text").class("tick y").at("x", LEFT - 7.0).at("y", at + 4.0);
            labels += &label.text(&text);
        }
        Tag::new("path").class("mesh").with("d", &path_data(lines)).empty() + &labels
    }

    fn titles(&self) -> String {
        let middle = f64::midpoint(LEFT, self.width - RIGHT);
        let x = Tag::new("text").class("axis").at("x", middle).at("y", self.height - 6.0);
        let up = f64::midpoint(TOP, self.height - BOTTOM);
        let y = Tag::new("text").class("axis").at("x", 0.0).at("y", 0.0);
        let turned = format!("translate(13 {up:.1}) rotate(-90)");
        x.text(&self.x.title) + &y.with("transform", &turned).text(&self.y.title)
    }

    /// The drawing and its legend. `id` must be unique on the page.
    pub(crate) fn finish(self, id: &str) -> String {
        let (right, floor) = (self.width - RIGHT, self.height - BOTTOM);
        let frame = Tag::new("rect").class("frame").at("x", LEFT).at("y", TOP);
        let frame = frame.at("width", right - LEFT).at("height", floor - TOP).empty();
        // an inner svg clips what it holds, without an identifier that would have to be unique
        let clip = Tag::new("svg").at("x", LEFT).at("y", TOP).at("width", right - LEFT);
        let view = format!("{LEFT} {TOP} {:.1} {:.1}", right - LEFT, floor - TOP);
        let clip = clip.at("height", floor - TOP).with("viewBox", &view).around(&self.body);
        let head = Tag::new("title").with("id", &format!("{id}-t")).text(&self.title)
            + &Tag::new("desc").with("id", &format!("{id}-d")).text(&self.description);
        let inside = head + &self.grid() + &clip + &frame + &self.front + &self.titles();
        let svg = Tag::new("svg")
            .class("chart")
            .with("role", "img")
            .with("aria-labelledby", &format!("{id}-t {id}-d"))
            .with("viewBox", &format!("0 0 {:.0} {:.0}", self.width, self.height));
        svg.around(&inside) + &self.legend_list()
    }

    fn legend_list(&self) -> String {
        if self.legend.is_empty() {
            return String::new();
        }
        let mut list = String::from("<ul class=\"legend\">");
        for (class, label) in &self.legend {
            let sign = match *class {
                "dots" => "M5 6h0M13 6h0M21 6h0",
                line if line.starts_with("line") => "M0 6H26",
                // the crossed square and the circles of a map
                "mark fail" => "M8 1H18V11H8ZM10 3L16 9M10 9L16 3",
                mark if mark.starts_with("mark") => "M8 6a5 5 0 1 0 10 0a5 5 0 1 0 -10 0Z",
                _ => "M8 1H18V11H8Z",
            };
            let _ = write!(
                list,
                "<li><svg viewBox=\"0 0 26 12\" aria-hidden=\"true\"><path class=\"{class}\" d=\"{sign}\"/></svg>{}</li>",
                escape(label)
            );
        }
        list + "</ul>"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_is_a_grid_a_clipped_line_and_titles() {
        let x =
            Range { title: "time / s".into(), from: 0.0, to: 2.0, powers: false, counted: false };
        let y = Range {
            title: "a < b / µm".into(),
            from: -1.0,
            to: 1.0,
            powers: false,
            counted: false,
        };
        let mut chart = Chart::new("Error", "It is small.", x, y, 120.0);
        chart.line(Stroke::In, &[(0.0, 0.0), (1.0, f64::NAN), (1.0, 0.5), (9.0, 0.5)], Some("in"));
        chart.limits(Stroke::Warn, 0.5, "warn");
        chart.limits(Stroke::Stop, 3.0, "stop, out of sight");
        insta::assert_snapshot!(chart.finish("e").replace("><", ">\n<"));
    }

    #[test]
    fn a_chart_to_scale_has_millimetres_of_one_length_both_ways() {
        for (width, height) in [(100.0, 1.0), (1.0, 100.0), (30.0, 20.0)] {
            let x = Range {
                title: String::new(),
                from: 5.0,
                to: 5.0 + width,
                powers: false,
                counted: false,
            };
            let y = Range {
                title: String::new(),
                from: -height,
                to: 0.0,
                powers: false,
                counted: false,
            };
            let chart = Chart::to_scale("", "", x, y);
            let (a, b) = (chart.place((5.0, 0.0)), chart.place((6.0, -1.0)));
            assert!((b.0 - a.0 - (b.1 - a.1)).abs() < 1e-9, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_line_of_a_single_point_is_a_dot() {
        let range = || Range::of("", [0.0, 1.0]);
        let mut chart = Chart::new("", "", range(), range(), 120.0);
        chart.line(Stroke::Main, &[(0.5, 0.5)], Some("one"));
        assert!(chart.finish("e").contains("h0\""), "it is to be seen");
    }
}
