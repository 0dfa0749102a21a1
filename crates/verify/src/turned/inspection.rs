//! A turned thread as the bar has it: the passes cut out of the bar that was there before, and what
//! is measured of it.
//!
//! ```text
//!   passes of the point through sections ─► contact with the bar as it was ─► cut out of it ─► grooves ─► starts, pitch
//!   bar before, pitch ─► standard size, limits of size                                           grooves ─► diameters, lengths
//! ```
use super::law::{Law, RUN_OUT};
use super::lie::{Lie, lead_of, overlap, phase};
use super::profile::{Frame, TOUCH_MM, grooves, starts, touched};
use super::size::Size;
use super::sizes::{Against, TurnedSizes, median};
use super::verdict::UNCUT_PITCHES;
use crate::Config;
use crate::bar::{Crossing, TurnedBar};
use crate::insert::{Form, Side};
use crate::tolerance::normal_engagement;
use canon::{Axis, Hand, Tool};
use units::Length;

/// Points of the picture of a section.
const PICTURE: usize = 1500;

/// A relief groove before a thread's end is at most so long, in pitches (DIN 76-1: 3.5, and 1.5 of
/// run-out).
const MOST_RELIEF: f64 = 5.0;
/// A relief lies below the root but for this, mm.
const RELIEF_MM: f64 = 0.02;

/// What the tool's point met in a pass, where the thread is ordered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Sections passed, and those in which it was in the material.
    pub(super) passed: u32,
    pub(super) touched: u32,
    /// Deepest, mm; negative: it came no nearer.
    pub(super) deepest: f64,
}

impl Default for Contact {
    fn default() -> Self {
        Self { passed: 0, touched: 0, deepest: f64::NEG_INFINITY }
    }
}

impl Contact {
    pub(super) fn see(&mut self, depth: f64) {
        self.passed += 1;
        self.deepest = self.deepest.max(depth);
        if depth > TOUCH_MM {
            self.touched += 1;
        }
    }

    /// Share of the ordered length in which it cut.
    pub(super) fn share(&self) -> f64 {
        if self.passed == 0 { 0.0 } else { f64::from(self.touched) / f64::from(self.passed) }
    }
}

/// What was found of the bar.
#[derive(Clone, Debug)]
pub(super) struct Inspected {
    pub(super) side: Side,
    pub(super) form: Form,
    pub(super) starts: u32,
    /// Diameter of bar or bore before.
    pub(super) before: Length,
    /// Deepest that the point was below it, and the share of the ordered length in which it cut.
    pub(super) contact: Contact,
    pub(super) standard: Option<Size>,
    pub(super) sizes: Option<TurnedSizes>,
    /// Radius over machine Z in a section, for a picture: before and after.
    pub(super) section: Vec<[Length; 3]>,
    /// Length in which the full thread is expected.
    pub(super) expected: Length,
    /// How far behind the end of the last block the insert has taken something off.
    pub(super) overrun: Length,
    /// Lengths at the ends, by rising Z, in which the bar was below the root before, mm.
    pub(super) relief: [f64; 2],
    /// Machine Z between which this block has taken something off.
    pub(super) touched: Option<[f64; 2]>,
    /// Height below which its grooves lie.
    pub(super) middle: Option<f64>,
    /// Its starts cut across one another.
    pub(super) overlap: Option<String>,
}

/// What is known of the thread beside the bar.
pub(super) struct Ordered<'a> {
    pub(super) law: Law<'a>,
    /// Turns of the whole chain.
    pub(super) whole: f64,
    pub(super) hand: Hand,
    pub(super) tool: Option<&'a Tool>,
    /// Machine coordinate along the axis where the whole chain ends.
    pub(super) end: Length,
    /// By the way in which the tool was fed in.
    pub(super) side: Option<Side>,
}

impl Ordered<'_> {
    /// Machine Z of the tip where the thread begins, and to where it is to be whole.
    pub(super) fn expected(&self) -> [f64; 2] {
        let law = &self.law;
        let length = self.tool.map_or(Length::ZERO, canon::Tool::worn_length);
        let [begins, ends] = law.span().map(|at| (at - length).value());
        let comes_to_rest = self.whole - RUN_OUT;
        if law.turns() <= comes_to_rest {
            return [begins, ends];
        }
        let rests = law.place(comes_to_rest) - length.value();
        [begins, if law.sign() < 0.0 { ends.max(rests) } else { ends.min(rests) }]
    }

    /// Where its groove lies, by where the point has passed; on the side from which it came, if
    /// the order does not say.
    pub(super) fn lie(&self, crossings: &[Crossing], came: Side, depth: f64) -> Lie {
        let side = self.side.unwrap_or(came);
        let lead = lead_of(&self.law, self.hand);
        let [a, b] = self.expected();
        let span = match self.law.axis() {
            Axis::Z => [a.min(b), a.max(b)],
            _ => [f64::INFINITY, f64::NEG_INFINITY],
        };
        let slope = if lead == 0.0 { 0.0 } else { self.law.slope() };
        let phase =
            if lead == 0.0 || slope > 0.0 { 0.0 } else { phase(crossings, side, lead, span) };
        let form = Form::of_thread(self.tool, self.law.main().lead().abs(), side);
        Lie { side, lead, slope, starts: 1, phase, span, form, depth }
    }

    /// What is looked for between two Z.
    fn frame(&self, form: &Form, side: Side, [low, high]: [f64; 2]) -> Frame {
        let lead = self.law.main().lead().abs();
        Frame {
            side,
            range: [low - lead, high + lead],
            lead: self.hand.sign() * lead,
            half_tan: form.half_angle().in_rad().tan(),
            middle: None,
        }
    }

    /// How far behind the end of the chain the point has cut, where the passes took something off
    /// between `low` and `high`.
    fn overrun(&self, [low, high]: [f64; 2]) -> Length {
        let end = (self.end - self.tool.map_or(Length::ZERO, canon::Tool::worn_length)).value();
        let behind = if self.law.sign() < 0.0 { end - low } else { high - end };
        Length::mm(behind.max(0.0))
    }
}

/// The bar before a thread, and without earlier blocks that have cut the same one.
#[derive(Clone, Debug)]
pub(super) struct Befores {
    pub(super) block: TurnedBar,
    pub(super) thread: Option<TurnedBar>,
}

/// Cut the passes out of the bar, with the form of the insert for a thread of this pitch.
pub(super) fn cut_out(
    ordered: &Ordered<'_>,
    crossings: &[Crossing],
    bar: &mut TurnedBar,
    pitch: f64,
) -> Form {
    let side = ordered.side.unwrap_or_else(|| bar.side());
    let form = Form::of_thread(ordered.tool, pitch, side);
    if ordered.law.axis() == Axis::Z {
        for at in crossings {
            bar.cut(at, &form, side);
        }
    }
    form
}

/// Cut the passes out of the bar, and measure.
pub(super) fn inspect(
    ordered: &Ordered<'_>,
    crossings: &[Crossing],
    contact: Contact,
    bar: &mut TurnedBar,
    befores: &Befores,
    config: &Config,
) -> Inspected {
    let side = ordered.side.unwrap_or_else(|| bar.side());
    let lead = ordered.law.main().lead().abs();
    let before = befores.thread.as_ref().unwrap_or(&befores.block);
    let mut form = cut_out(ordered, crossings, bar, lead);
    let expected = ordered.expected();
    let rising = [expected[0].min(expected[1]), expected[0].max(expected[1])];
    let mut frame = ordered.frame(&form, side, rising);
    let measurable =
        ordered.law.axis() == Axis::Z && ordered.law.is_straight() && !ordered.law.varies();
    let found = measurable.then(|| starts(&frame, [before, bar])).flatten();
    let starts = found.unwrap_or(1);
    let pitch = lead / f64::from(starts);
    if starts > 1 && form != Form::of_thread(ordered.tool, pitch, side) {
        let watched = bar.clone();
        *bar = befores.block.clone();
        bar.watch_as(&watched);
        form = cut_out(ordered, crossings, bar, pitch);
    }
    frame.half_tan = form.half_angle().in_rad().tan();
    let diameter = before.diameter(rising, side);
    let standard = (measurable && form.has_60_degrees())
        .then(|| Size::nearest(Length::mm(pitch), ordered.hand, diameter, side, config.class))
        .flatten();
    let deepest = crossings
        .iter()
        .filter(|at| (rising[0]..=rising[1]).contains(&at.z))
        .map(|at| before.depth(at, side))
        .fold(f64::NEG_INFINITY, f64::max);
    let contact = Contact { deepest: contact.deepest.max(deepest), ..contact };
    let relief = relief(ordered, before, side, contact.deepest, pitch);
    let range = [rising[0] + relief[0], rising[1] - relief[1]];
    let sizes = found
        .and_then(|_| measured(ordered, &frame, [before, bar], pitch, standard.as_ref(), range));
    let is_along = ordered.law.axis() == Axis::Z;
    let cut = is_along.then(|| touched(side, [&befores.block, bar])).flatten();
    Inspected {
        side,
        form,
        starts,
        before: diameter,
        contact,
        standard,
        sizes,
        section: picture(&frame, [before, bar]),
        expected: Length::mm(range[1] - range[0]),
        overrun: cut.map_or(Length::ZERO, |cut| ordered.overrun(cut)),
        relief,
        touched: cut,
        middle: middle(&frame, [before, bar]),
        overlap: overlap(&form, contact.deepest, pitch, starts),
    }
}

/// Height halfway between the bar before and the grooves' roots.
fn middle(frame: &Frame, bars: [&TurnedBar; 2]) -> Option<f64> {
    let grooves = grooves(frame, bars, frame.lead.abs(), None);
    let root = median(grooves.iter().map(|groove| groove.root).collect());
    let crest = median(grooves.iter().map(|groove| groove.crests[0]).collect());
    (!grooves.is_empty()).then(|| f64::midpoint(root, crest))
}

/// Lengths at the ends of a thread, by rising Z, in which the bar lies below the thread's root
/// already: relief grooves, at most [`MOST_RELIEF`] pitches of each. A thread that begins at the
/// end of the work has none there.
fn relief(ordered: &Ordered<'_>, bar: &TurnedBar, side: Side, depth: f64, pitch: f64) -> [f64; 2] {
    if ordered.law.axis() != Axis::Z || !(depth.is_finite() && depth > 0.0) {
        return [0.0; 2];
    }
    let [begins, ends] = ordered.expected();
    let span = [begins.min(ends), begins.max(ends)];
    let surface = bar.diameter(span, side).value() / 2.0;
    let root = if side == Side::External { surface } else { -surface } - depth;
    let heights: Vec<f64> = bar.heights(0, side).collect();
    let is_below = |z: f64| bar.place(z).is_some_and(|at| heights[at] <= root + RELIEF_MM);
    let (_, step) = bar.places();
    let most = ((MOST_RELIEF * pitch).min((span[1] - span[0]) / 2.0) / step) as u32;
    let free = if ordered.law.runs_out() { ends } else { begins };
    let from = |end: f64, way: f64| {
        let is_open = (end - free).abs() < step && ordered.law.is_open();
        let below = |k: &u32| !is_open && is_below(end + way * step * f64::from(*k));
        (0..most).take_while(below).count() as f64 * step
    };
    [from(span[0], 1.0), from(span[1], -1.0)]
}

/// The same thread as it stands now, where something was taken off it since at these places of Z.
pub(super) fn again(
    ordered: &Ordered<'_>,
    was: &Inspected,
    bars: [&TurnedBar; 2],
    changed: &[f64],
) -> Inspected {
    let lead = ordered.law.main().lead().abs();
    let pitch = lead / f64::from(was.starts);
    let expected = ordered.expected();
    let low = expected[0].min(expected[1]) + was.relief[0];
    let high = expected[0].max(expected[1]) - was.relief[1];
    let mut frame = ordered.frame(&was.form, was.side, [low, high]);
    frame.middle = was.middle;
    // what was taken off at the ends shortens it
    let spoilt = UNCUT_PITCHES * pitch;
    let inwards = |end: f64, way: f64| {
        let places = changed.iter().map(|z| (z - end) * way).filter(|off| *off <= spoilt);
        end + way * places.fold(0.0, f64::max)
    };
    let range = [inwards(low, 1.0), inwards(high, -1.0)];
    let sizes = was
        .sizes
        .as_ref()
        .and_then(|_| measured(ordered, &frame, bars, pitch, was.standard.as_ref(), range));
    Inspected { sizes, section: picture(&frame, bars), ..was.clone() }
}

fn measured(
    ordered: &Ordered<'_>,
    frame: &Frame,
    bars: [&TurnedBar; 2],
    pitch: f64,
    standard: Option<&Size>,
    range: [f64; 2],
) -> Option<TurnedSizes> {
    let [begins, ends] = ordered.expected();
    let height = |diameter: Length| match frame.side {
        Side::External => diameter.value() / 2.0,
        Side::Internal => -diameter.value() / 2.0,
    };
    // the Go gauge's crest: outside its minor diameter, inside its major one
    let go = standard.map(|standard| match frame.side {
        Side::External => height(standard.limits.minor[1]),
        Side::Internal => height(standard.limits.major[0]),
    });
    let mate = standard.map(|standard| match frame.side {
        Side::External => height(standard.thread.minor_diameter()),
        Side::Internal => height(standard.thread.nominal),
    });
    let grooves = grooves(frame, bars, pitch, go);
    let level = median(grooves.iter().map(|groove| groove.root).collect());
    let open = ordered.law.is_open();
    let free_end = bars[0].end(frame.side, level).filter(|_| open);
    let [low, high] = touched(frame.side, bars).unwrap_or([begins, ends]);
    let against = Against {
        side: frame.side,
        pitch,
        expected: range,
        ends: match free_end {
            Some(face) => [face, low],
            None if begins > ends => [range[1], low],
            None => [range[0], high],
        },
        full_root: go,
        mate,
        engagement: standard.map_or(f64::INFINITY, |s| normal_engagement(&s.thread).value()),
    };
    against.sizes(&grooves)
}

fn picture(frame: &Frame, bars: [&TurnedBar; 2]) -> Vec<[Length; 3]> {
    let [before, after] = bars.map(|bar| bar.heights(0, frame.side).collect::<Vec<_>>());
    let [low, high] = frame.range;
    let places: Vec<_> =
        (0..after.len()).filter(|at| (low..=high).contains(&bars[1].z(*at))).collect();
    places
        .iter()
        .step_by(places.len().div_ceil(PICTURE).max(1))
        .map(|at| [bars[1].z(*at), before[*at].abs(), after[*at].abs()].map(Length::mm))
        .collect()
}
