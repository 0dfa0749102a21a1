//! The program: each line with the time that it took and what it cut, and links there and back.
//!
//! ```text
//!   line 12  ──► path of the line in the picture (#P12)       feature 3 ──► its line (#L12)
//!            └─► row of the feature in its table (#F3)        path ───────► its line (#L12)
//! ```
//!
//! A long program is shown where it cut: the lines of its features with their neighbours, and how
//! many are left out between.
use crate::record::Recorder;
use crate::svg::{Tag, escape, fixed};
use crate::{Run, Standing};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use verify::Feature;

/// A program of so many lines is shown whole.
const WHOLE: u32 = 600;
/// Of a longer one: its first lines, and so many that cut.
const FIRST: u32 = 20;
const CUTTING: usize = 400;
/// Lines shown before and behind one that cut.
const AROUND: u32 = 2;
/// Characters shown of a line.
const WIDEST: usize = 160;
/// Features named beside one line.
const NAMED: usize = 12;

/// Which lines are shown.
pub(super) struct Listing {
    shown: BTreeSet<u32>,
    /// Numbers of the features, from 1, by the line that ordered them.
    cut: BTreeMap<u32, Vec<usize>>,
    lines: u32,
}

impl Listing {
    /// Of a run; nothing is shown of a program whose text is not known.
    pub(super) fn of(run: &Run, recorder: &Recorder, features: &[Feature]) -> Self {
        let text = &run.listing[..];
        let text = text.strip_suffix(b"\n").unwrap_or(text);
        let lines = if text.is_empty() { 0 } else { text.split(|byte| *byte == b'\n').count() };
        let lines = u32::try_from(lines).unwrap_or(u32::MAX);
        let mut cut: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (index, feature) in features.iter().enumerate() {
            if !recorder.lines.is_elsewhere(feature.op) {
                cut.entry(feature.line).or_default().push(index + 1);
            }
        }
        let shown = if lines <= WHOLE {
            (1..=lines).collect()
        } else {
            let near = cut.keys().take(CUTTING).flat_map(|line| {
                line.saturating_sub(AROUND).max(1)..=line.saturating_add(AROUND).min(lines)
            });
            near.chain(1..=FIRST).collect()
        };
        Self { shown, cut, lines }
    }

    /// Whether a line is shown, so that a link leads somewhere.
    pub(super) fn shows(&self, line: u32) -> bool {
        self.shown.contains(&line)
    }

    /// A feature's line, with a link to it if it is shown.
    pub(super) fn link(&self, recorder: &Recorder, feature: &Feature) -> String {
        let text = feature.line.to_string();
        if self.shows(feature.line) && !recorder.lines.is_elsewhere(feature.op) {
            Tag::new("a").with("href", &format!("#L{}", feature.line)).text(&text)
        } else {
            text
        }
    }

    /// The listing; nothing without a text. `drawn`: lines whose path is in a picture.
    pub(super) fn html(
        &self,
        run: &Run,
        recorder: &Recorder,
        features: &[Feature],
        drawn: &BTreeSet<u32>,
    ) -> String {
        if self.shown.is_empty() {
            return String::new();
        }
        let text = String::from_utf8_lossy(&run.listing);
        let mut rows = String::new();
        let mut before = 0;
        for (line, code) in (1..).zip(text.split('\n')).filter(|(line, _)| self.shows(*line)) {
            rows += &left_out(line - before - 1);
            before = line;
            rows += &self.row(line, code, recorder, features, drawn);
        }
        rows += &left_out(self.lines - before.min(self.lines));
        let heads = "<thead><tr><th>line</th><th>time<small>s</small></th><th class=\"l\">program</th><th class=\"l\">cut</th></tr></thead>";
        let table = Tag::new("table").class("listing");
        let table = table.around(&(heads.to_owned() + &Tag::new("tbody").around(&rows)));
        let scroll = Tag::new("div").class("scroll").with("tabindex", "0").around(&table);
        let words = "Each line with the time that it took and what it cut. A number of a line leads to its path in the picture, a \
                     feature to its row; both lead back.";
        Tag::new("p").class("soft").text(words) + &scroll
    }

    fn row(
        &self,
        line: u32,
        code: &str,
        recorder: &Recorder,
        features: &[Feature],
        drawn: &BTreeSet<u32>,
    ) -> String {
        let number = if drawn.contains(&line) {
            Tag::new("a").with("href", &format!("#P{line}")).text(&line.to_string())
        } else {
            line.to_string()
        };
        let time = recorder.lines.seconds(line).map_or(String::new(), |s| fixed(s, 2));
        let code = code.trim_end_matches('\r');
        let mut short: String = code.chars().take(WIDEST).collect();
        if short.len() < code.len() {
            short.push('…');
        }
        let mut cut = String::new();
        let numbers = self.cut.get(&line).map_or(&[][..], Vec::as_slice);
        for &number in numbers.iter().take(NAMED) {
            let Some(feature) = features.get(number - 1) else { continue };
            let standing = Standing::of(feature);
            let text = format!("{} {number}", standing.sign());
            let link = Tag::new("a").with("href", &format!("#F{number}"));
            cut += &link.class(standing.class()).with("title", feature.kind_name()).text(&text);
            cut.push(' ');
        }
        if numbers.len() > NAMED {
            let _ = write!(cut, "and {} more", numbers.len() - NAMED);
        }
        let cells = Tag::new("td").around(&number)
            + &Tag::new("td").text(&time)
            + &Tag::new("td").class("l code").around(&Tag::new("code").around(&escape(&short)))
            + &Tag::new("td").class("l").around(&cut);
        Tag::new("tr").with("id", &format!("L{line}")).around(&cells)
    }
}

/// A row that says how many lines are not shown.
fn left_out(lines: u32) -> String {
    if lines == 0 {
        return String::new();
    }
    let noun = if lines == 1 { "line" } else { "lines" };
    let cell = Tag::new("td").class("l soft").with("colspan", "4");
    Tag::new("tr").around(&cell.text(&format!("… {lines} {noun} …")))
}
