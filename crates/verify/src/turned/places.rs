//! Threads as places on the bar: what several blocks have cut of one thread is one thread, and each
//! is looked at again when something was taken off it.
//!
//! ```text
//!   block cut ─► the groove of a thread that is there?  same hand, lead and phase ─► one thread, measured from the bar before the first
//!                                                        between its grooves        ─► another start of it
//!                                                        across them                ─► both are spoilt
//!   anything else cut ─► the bar notes line and places ─► at the end each place is measured as it stands
//!   cut through       ─► what lies in front has come off, as a piece of its own: its threads stay as they were
//! ```
//!
//! A cut within a pitch and a half of a thread's ends, as a chamfer or a relief groove, shortens it
//! and is judged by what is left; a cut that leaves its diameters within their limits, such as a
//! crest that is turned down, is none that spoils it.
use super::feature::TurnedThread;
use super::inspection::{self, Contact, Inspected, Ordered};
use super::law::{Law, Stretch};
use super::lie::{Lie, Relation};
use super::verdict::{self, UNCUT_PITCHES};
use crate::Config;
use crate::bar::{BarPart, TurnedBar};
use crate::insert::Side;
use crate::judged::Judged;
use crate::verdict::Verdict;
use canon::Hand;
use units::Length;

/// Threads that are remembered at most: the oldest are not looked at again.
const MOST: usize = 64;

/// What a thread's blocks have cut, and what it takes to look at it again.
#[derive(Clone, Debug)]
pub(crate) struct ThreadCut {
    pub(super) pass: Vec<Stretch>,
    pub(super) whole: f64,
    pub(super) hand: Hand,
    pub(super) tool: Option<u32>,
    pub(super) end: Length,
    pub(super) inspected: Inspected,
    pub(super) lie: Lie,
    /// The bar before and after, as far as the thread reaches.
    pub(super) before: BarPart,
    pub(super) left: BarPart,
}

/// Whether the features have a thread, and under which operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Listed {
    No,
    As(u32),
    /// By a program before this one.
    Before,
}

#[derive(Clone, Debug)]
struct ThreadPlace {
    id: usize,
    /// As its last block has left it.
    when_cut: Judged<TurnedThread>,
    cut: ThreadCut,
    listed: Listed,
    /// Line that has first taken something off it.
    changed: Option<u32>,
    /// Another thread crosses it: its line.
    crossed: Option<u32>,
    /// Facets have taken its crests.
    faceted: Option<Faceted>,
    /// It has come off with a part: nothing happens to it any more.
    is_off: bool,
    /// Nothing is left of it.
    is_gone: bool,
    /// It was looked at as it stands.
    is_settled: bool,
    /// As it stands.
    now: Judged<TurnedThread>,
}

/// A thread that the features lack, or have otherwise than it stands.
#[derive(Clone, Debug)]
pub(crate) enum ListChange {
    New(Judged<TurnedThread>),
    /// In place of the feature of this operation.
    Instead(u32, Judged<TurnedThread>),
}

/// The facets of a polygon on a bar.
pub(crate) struct Facets<'a> {
    pub(crate) line: u32,
    pub(crate) name: &'a str,
    /// Least distance from the axis at a machine Z; `None`: there are none.
    pub(crate) at: Box<dyn Fn(f64) -> Option<f64> + 'a>,
}

/// What facets have done to a thread.
#[derive(Clone, Debug)]
struct Faceted {
    line: u32,
    how: String,
    /// They were cut after the thread.
    is_later: bool,
}

/// Facets below the crests of a thread by less take nothing that counts, mm.
const FACET_MM: f64 = 0.1;

/// The threads on a bar.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    all: Vec<ThreadPlace>,
    next: usize,
}

impl Places {
    /// As the next program finds them.
    pub(crate) fn at_rest(mut self) -> Self {
        self.taken();
        self
    }

    /// The features were taken: they have none of these threads any more.
    pub(crate) fn taken(&mut self) {
        for place in self.all.iter_mut().filter(|place| place.listed != Listed::No) {
            place.listed = Listed::Before;
        }
    }

    /// True where the features have every thread as it stands.
    pub(crate) fn is_settled(&self, bar: Option<&TurnedBar>) -> bool {
        self.all.iter().all(|place| {
            place.is_settled
                && (place.is_off || bar.is_none_or(|b| b.changed_by(place.id).is_none()))
        })
    }

    /// The bar before a groove that lies where threads were cut before: without these, as far as
    /// nothing else has changed them since; and what the insert met in them.
    pub(super) fn before(&self, new: &Lie, bar: &TurnedBar) -> Option<(TurnedBar, Contact)> {
        let mut whole: Option<(TurnedBar, Contact)> = None;
        for place in self.all.iter().rev().filter(|place| new.touches() && !place.is_done()) {
            if matches!(place.cut.lie.relation(new), Relation::Same | Relation::AnotherStart) {
                let contact = place.cut.inspected.contact;
                let (from, met) = whole.as_ref().map_or((bar, contact), |(bar, met)| (bar, *met));
                let with = from.with(&place.cut.before, &place.cut.left);
                whole = Some((with, if met.share() > contact.share() { met } else { contact }));
            }
        }
        whole
    }

    /// Look at all as they stand.
    pub(super) fn look(&mut self, bar: &mut TurnedBar, config: &Config) {
        self.all.iter_mut().for_each(|place| place.look(bar, config));
    }

    /// A block was cut, and what its thread is now.
    pub(crate) fn add(
        &mut self,
        mut found: Judged<TurnedThread>,
        cut: ThreadCut,
        bar: &mut TurnedBar,
    ) {
        let mut listed = Listed::No;
        let line = found.line;
        let mut crossed = None;
        for index in (0..self.all.len()).rev() {
            let place = &mut self.all[index];
            if place.is_done() || !cut.lie.touches() {
                continue;
            }
            match place.cut.lie.relation(&cut.lie) {
                Relation::Apart => {}
                Relation::Same | Relation::AnotherStart if cut.lie.covers(&place.cut.lie) => {
                    let place = self.all.remove(index);
                    bar.unwatch(place.id);
                    found.kind.passes += place.when_cut.kind.passes;
                    found.kind.passes_ordered += place.when_cut.kind.passes;
                    if place.listed != Listed::Before {
                        listed = place.listed;
                    }
                }
                Relation::Same | Relation::AnotherStart => place.is_settled = false,
                Relation::Across(_) if bar.changed_by(place.id).is_none() => {}
                Relation::Across(off) => {
                    place.crossed = Some(line);
                    place.is_settled = false;
                    let by = off
                        .map_or_else(String::new, |off| format!(", {off:.3} mm beside its groove"));
                    let of_line = place.when_cut.line;
                    crossed = Some((
                        format!("cut across the thread of line {of_line}{by}"),
                        place.when_cut.kind.size.is_some(),
                    ));
                }
            }
        }
        if let Some((how, has_limits)) = crossed {
            found.verdict = match &found.verdict {
                Verdict::Fail { reason } => Verdict::Fail { reason: format!("{how}; {reason}") },
                // of crossing grooves no limits are known
                Verdict::NotJudged { reason } if !has_limits => {
                    Verdict::NotJudged { reason: format!("{reason}; {how}") }
                }
                Verdict::Pass | Verdict::NotJudged { .. } => Verdict::Fail { reason: how },
            };
        }
        let id = self.next;
        self.next += 1;
        bar.watch(id, cut.left.places());
        let now = found.clone();
        self.all.push(ThreadPlace {
            id,
            when_cut: found,
            cut,
            listed,
            changed: None,
            crossed: None,
            faceted: None,
            is_off: false,
            is_gone: false,
            is_settled: false,
            now,
        });
        if self.all.len() > MOST
            && let Some(oldest) = self.all.iter().position(|place| place.listed != Listed::No)
        {
            bar.unwatch(self.all.remove(oldest).id);
        }
    }

    /// Facets were cut where threads are.
    pub(crate) fn are_faceted(&mut self, by: &Facets<'_>, bar: &TurnedBar) {
        self.all.iter_mut().for_each(|place| place.is_faceted(by, bar, true));
    }

    /// The last thread was cut where facets are.
    pub(crate) fn is_on_facets<'a>(
        &mut self,
        facets: impl Iterator<Item = Facets<'a>>,
        bar: &TurnedBar,
    ) {
        if let Some(place) = self.all.last_mut() {
            facets.for_each(|by| place.is_faceted(&by, bar, false));
        }
    }

    /// The bar is cut through at a place: what is in front comes off.
    pub(crate) fn come_off(&mut self, through: usize, bar: &mut TurnedBar, config: &Config) {
        for place in self.all.iter_mut().filter(|place| !place.is_off) {
            let [low, high] = place.cut.left.places();
            if high <= through {
                continue;
            }
            place.look(bar, config);
            let is_cut_in_two =
                bar.z(low) < bar.z(through) && place.cut.lie.span[0] < bar.z(through);
            let is_in_front = place.cut.lie.span[0] >= bar.z(through);
            if is_in_front || is_cut_in_two {
                place.is_off = true;
                bar.unwatch(place.id);
            }
        }
    }

    /// Look at each as it stands, and tell what is new.
    pub(crate) fn settle(
        &mut self,
        bar: Option<&mut TurnedBar>,
        config: &Config,
    ) -> Vec<ListChange> {
        let mut new = Vec::new();
        let Some(bar) = bar else { return new };
        for place in &mut self.all {
            let before = place.now.verdict.clone();
            if !place.is_off {
                place.look(bar, config);
            }
            place.lose_to_facets();
            let is_new = !std::mem::replace(&mut place.is_settled, true);
            let changes = before != place.now.verdict;
            let now = place.now.clone();
            match place.listed {
                Listed::No => {
                    place.listed = Listed::As(now.op);
                    new.push(ListChange::New(now));
                }
                Listed::As(op) if is_new || changes => {
                    place.listed = Listed::As(now.op);
                    new.push(ListChange::Instead(op, now));
                }
                Listed::Before if changes => {
                    let line = place.changed.or(place.crossed).unwrap_or(now.line);
                    new.push(ListChange::New(Judged { line, ..now }));
                }
                Listed::As(_) | Listed::Before => {}
            }
        }
        new
    }
}

impl ThreadPlace {
    /// Nothing happens to it any more.
    const fn is_done(&self) -> bool {
        self.is_off || self.is_gone
    }

    /// Facets lie below its crests, over more of it than the bar's end and the run-out may spoil.
    fn is_faceted(&mut self, by: &Facets<'_>, bar: &TurnedBar, is_later: bool) {
        let (side, [low, high]) = (self.cut.lie.side, self.cut.lie.span);
        if self.is_done() || self.faceted.is_some() || side == Side::Internal {
            return;
        }
        let [first, _] = self.cut.left.places();
        let heights = self.cut.left.heights(side);
        let at = |k: usize| bar.z(first + k);
        let within = |k: &usize| (low..=high).contains(&at(*k));
        let crest = (0..heights.len()).filter(within).map(|k| heights[k]).fold(0.0, f64::max);
        let below = |k: usize| (by.at)(at(k)).map(|facet| crest - facet);
        let taken = (0..heights.len()).filter(within).filter_map(below);
        let (count, most) = taken.fold((0_usize, 0.0_f64), |(count, most), off| {
            (count + usize::from(off > FACET_MM), most.max(off))
        });
        let length = count as f64 * bar.places().1;
        if length <= UNCUT_PITCHES * self.cut.lie.lead.abs() {
            return;
        }
        let how = format!(
            "the facets of the {} lie {most:.2} mm below its crests, over {length:.2} mm",
            by.name
        );
        self.faceted = Some(Faceted { line: by.line, how, is_later });
        self.is_settled = false;
    }

    /// What facets have taken is in the verdict.
    fn lose_to_facets(&mut self) {
        let Some(Faceted { line, how, is_later }) = &self.faceted else { return };
        if self.now.verdict.reason().is_some_and(|reason| reason.contains(how.as_str())) {
            return;
        }
        if *is_later {
            self.changed.get_or_insert(*line);
            self.now.destroyed(*line, how);
        } else {
            self.now.fails(format!("cut over line {line}: {how}"));
        }
    }

    /// Measure it as it stands, if something was taken off it.
    fn look(&mut self, bar: &mut TurnedBar, config: &Config) {
        if self.is_done() {
            return;
        }
        let Some(line) = bar.changed_by(self.id) else { return };
        self.changed.get_or_insert(line);
        bar.watch(self.id, self.cut.left.places());
        let Some(law) = Law::of(&self.cut.pass) else {
            return;
        };
        let was = &self.when_cut;
        let of = Ordered {
            law,
            whole: self.cut.whole,
            hand: self.cut.hand,
            tool: self.cut.tool.and_then(|number| config.tools.get(number)),
            end: self.cut.end,
            side: Some(self.cut.lie.side),
        };
        let before = bar.with(&self.cut.before, &self.cut.left);
        let changed = bar.is_changed(&self.cut.left);
        let [first, _] = self.cut.left.places();
        let places: Vec<f64> =
            (0..).zip(&changed).filter(|(_, is)| **is).map(|(k, _)| bar.z(first + k)).collect();
        if places.is_empty() {
            return;
        }
        let inspected = inspection::again(&of, &self.cut.inspected, [&before, bar], &places);
        let mut kind = was.kind.clone();
        kind.sizes.clone_from(&inspected.sizes);
        kind.section.clone_from(&inspected.section);
        let lost = self.lost(&before, bar);
        let verdict = match (&was.kind.sizes, &inspected.sizes) {
            (Some(_), None) => Verdict::Fail { reason: "nothing is left of it".into() },
            (None, _) if lost > 0.0 => {
                Verdict::Fail { reason: format!("{:.0} % of its crests are gone", 100.0 * lost) }
            }
            (None, _) => was.verdict.clone(),
            (Some(_), Some(_)) => verdict::of(&kind, Some(&law), Some(&inspected), config),
        };
        self.now = Judged { kind, ..was.clone() };
        self.is_gone = matches!((&was.kind.sizes, &inspected.sizes), (Some(_), None)) || lost > 0.0;
        let by = self.crossed.or(self.changed).unwrap_or(line);
        let was_bad = matches!(was.verdict, Verdict::Fail { .. });
        match (verdict, self.crossed) {
            // of crossing grooves no limits are known
            (_, Some(by)) if was.kind.size.is_none() => {
                let reason = format!(
                    "crossed by the thread of line {by}: what is left of it is not measured"
                );
                if !was_bad {
                    self.now.verdict = Verdict::NotJudged { reason };
                }
            }
            (Verdict::Fail { reason }, None) if was_bad && !self.is_gone => {
                self.now.verdict = Verdict::Fail { reason };
            }
            (Verdict::Fail { reason }, _) => {
                self.now.destroyed(by, &left(&reason, self.cut.lie.span, &places));
            }
            (_, Some(by)) => self.now.destroyed(by, "another thread was cut across it"),
            (verdict, None) => self.now.verdict = verdict,
        }
    }

    /// Share of the crests that fell below half of their height over the root.
    fn lost(&self, before: &TurnedBar, now: &TurnedBar) -> f64 {
        let side = self.cut.lie.side;
        let depth = self.cut.inspected.contact.deepest;
        if !(depth.is_finite() && depth > 0.0) {
            return 0.0;
        }
        let [low, high] = self.cut.left.places();
        let within = |place: &usize| {
            (self.cut.lie.span[0]..=self.cut.lie.span[1]).contains(&now.z(*place))
                && (low..=high).contains(place)
        };
        let heights = |bar: &TurnedBar| bar.heights(0, side).collect::<Vec<_>>();
        let (was, is) = (heights(before), heights(now));
        let left = self.cut.left.heights(side);
        let places: Vec<usize> = (low..=high).filter(within).collect();
        let half = |place: usize| was[place] - depth / 2.0;
        let crests: Vec<usize> =
            places.into_iter().filter(|place| left[place - low] > half(*place)).collect();
        let lost = crests.iter().filter(|place| is[**place] < half(**place)).count();
        let share = lost as f64 / crests.len().max(1) as f64;
        let allowed =
            UNCUT_PITCHES * self.cut.lie.lead.abs() / (self.cut.lie.span[1] - self.cut.lie.span[0]);
        if share > allowed { share } else { 0.0 }
    }
}

/// What is wrong, and how much is left. A groove or an edge that is gone has no pitch diameter.
fn left(reason: &str, [low, high]: [f64; 2], changed: &[f64]) -> String {
    let said: Vec<&str> =
        reason.split("; ").filter(|part| !part.starts_with("pitch diameter")).collect();
    let ends = [low].into_iter().chain(changed.iter().copied()).chain([high]);
    let ends: Vec<f64> = ends.filter(|z| (low..=high).contains(z)).collect();
    let whole = ends.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    let whole = format!("it is whole over {whole:.2} of {:.2} mm", high - low);
    if said.is_empty() { whole } else { format!("{whole}; {}", said.join("; ")) }
}
