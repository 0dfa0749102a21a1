//! A turned thread as the bar has it: the passes cut out of the bar that was there before, and what
//! is measured of it.
//!
//! ```text
//!   passes of the point through sections ─► contact with the bar as it was ─► cut out of it ─► grooves ─► starts, pitch
//!   bar before, pitch ─► standard size, limits of size                                           grooves ─► diameters, lengths
//! ```
use super::law::Law;
use super::profile::{Frame, TOUCH_MM, grooves, starts, touched};
use super::size::Size;
use super::sizes::{Against, TurnedSizes, median};
use crate::Config;
use crate::bar::{Crossing, TurnedBar};
use crate::insert::{Form, Side};
use crate::tolerance::normal_engagement;
use canon::{Axis, Hand, Tool};
use units::Length;

/// Points of the picture of a section.
const PICTURE: usize = 1500;

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
    fn expected(&self) -> [f64; 2] {
        let law = &self.law;
        let length = self.tool.map_or(Length::ZERO, canon::Tool::worn_length);
        let [begins, ends] = law.span().map(|at| (at - length).value());
        let comes_to_rest = self.whole - super::RUN_OUT;
        if law.turns() <= comes_to_rest {
            return [begins, ends];
        }
        let rests = law.place(comes_to_rest) - length.value();
        [begins, if law.sign() < 0.0 { ends.max(rests) } else { ends.min(rests) }]
    }

    /// How far behind the end of the chain the point has cut, where the passes took something off
    /// between `low` and `high`.
    fn overrun(&self, [low, high]: [f64; 2]) -> Length {
        let end = (self.end - self.tool.map_or(Length::ZERO, canon::Tool::worn_length)).value();
        let behind = if self.law.sign() < 0.0 { end - low } else { high - end };
        Length::mm(behind.max(0.0))
    }
}

/// Cut the passes out of the bar, and measure.
pub(super) fn inspect(
    ordered: &Ordered<'_>,
    crossings: &[Crossing],
    contact: Contact,
    bar: &mut TurnedBar,
    config: &Config,
) -> Inspected {
    let side = ordered.side.unwrap_or_else(|| bar.side());
    let lead = ordered.law.main().lead().abs();
    let before = bar.clone();
    let cut_with = |form: &Form| {
        let mut bar = before.clone();
        for at in crossings {
            bar.cut(at, form, side);
        }
        bar
    };
    let mut form = Form::of_thread(ordered.tool, lead, side);
    *bar = cut_with(&form);
    let expected = ordered.expected();
    let rising = [expected[0].min(expected[1]), expected[0].max(expected[1])];
    let mut frame = Frame {
        side,
        range: [rising[0] - lead, rising[1] + lead],
        lead: ordered.hand.sign() * lead,
        half_tan: form.half_angle().in_rad().tan(),
    };
    let measurable =
        ordered.law.axis() == Axis::Z && ordered.law.is_straight() && !ordered.law.varies();
    let found = measurable.then(|| starts(&frame, [&before, bar])).flatten();
    let starts = found.unwrap_or(1);
    let pitch = lead / f64::from(starts);
    if starts > 1 && form != Form::of_thread(ordered.tool, pitch, side) {
        form = Form::of_thread(ordered.tool, pitch, side);
        *bar = cut_with(&form);
    }
    frame.half_tan = form.half_angle().in_rad().tan();
    let diameter = before.diameter(rising, side);
    let standard = (measurable && form.has_60_degrees())
        .then(|| Size::nearest(Length::mm(pitch), ordered.hand, diameter, side, config.class))
        .flatten();
    let sizes =
        found.and_then(|_| measured(ordered, &frame, [&before, bar], pitch, standard.as_ref()));
    let cut = (ordered.law.axis() == Axis::Z).then(|| touched(side, [&before, bar])).flatten();
    Inspected {
        side,
        form,
        starts,
        before: diameter,
        contact,
        standard,
        sizes,
        section: picture(&frame, [&before, bar]),
        expected: Length::mm(rising[1] - rising[0]),
        overrun: cut.map_or(Length::ZERO, |cut| ordered.overrun(cut)),
    }
}

fn measured(
    ordered: &Ordered<'_>,
    frame: &Frame,
    bars: [&TurnedBar; 2],
    pitch: f64,
    standard: Option<&Size>,
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
        expected: [begins.min(ends), begins.max(ends)],
        ends: match free_end {
            Some(face) => [face, low],
            None if begins > ends => [begins, low],
            None => [begins, high],
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
