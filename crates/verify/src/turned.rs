//! Turned threads: the groove that the passes of a single point have left in the bar, from recorded
//! motion.
//!
//! A thread is judged whole, by what the insert's form has left of the bar that was there before
//! (stock, turned passes, bores), in axial sections of it:
//!
//! ```text
//!   contact       the point was in the material along the ordered thread, or nothing was cut
//!   sizes         major, pitch and minor diameter, flanks, length of full thread, run-in, run-out      ([`sizes`], [`profile`])
//!   limits        of the standard thread of that pitch and bar: ISO 965-1, ASME B1.1                   ([`size`])
//! ```
//!
//! A thread whose lead is not the same everywhere (G34, chains of blocks) has no limits of size;
//! what it asks for is its program: it is judged by contact, helix and infeed, and its diameters
//! are named as not judged. A straight thread of one lead that is none of a standard, a taper, a
//! thread in a face, and one on work that is no bar are *not judged*: no standard here says what
//! they must fit.
//!
//! Each pass is judged against the helix that its own block orders: where the thread's stretch
//! starts, the spindle has turned so far from the start angle.
//!
//! ```text
//!   e = w − law(±θ − start − turns before)      w: coordinate along the thread, mm; law: what the blocks order ([`law`])
//!       the turns wrapped into ± half a one: a groove does not know which turn it is on
//!
//!   sync error    max |e|, rms e         in the material, all passes
//!   start angle   where the spindle stood at the thread's start, by the mean e of the last pass, as turns
//!   leads         of a lead that is not the same everywhere, turn by turn: the ordered one, and by how much e changes
//!   lead error    slope of e, times the thread's length, of the pass where it is largest
//!   pass spread   largest mean e of a pass less the smallest: how well the passes find the groove
//!   infeed error  largest |across − ordered| in the pass that goes deepest
//! ```
//!
//! A tool that is taken off the work, as for a hold, is judged until it is clear: until it stands
//! where it stood before it was fed in. The pass then counts once it has been cut to its end.
//!
//! Where the work is no bar, nothing says that the thread begins behind the [run-in](run_in) of its
//! axis: that is left out, and said.
//!
//! The helix is judged from the surface that the block names on. Where the chain ends the axes come
//! to rest, which takes a part of a revolution: the last revolution before it is the run-out and is
//! not judged.
mod feature;
mod figures;
mod inspection;
mod law;
mod lie;
mod ordered;
mod places;
mod profile;
mod run_in;
mod size;
mod sizes;
mod verdict;

pub use feature::{LeadOfTurn, TurnedThread};
pub(crate) use ordered::{CameFrom, OrderedThread};
pub(crate) use places::{Facets, ListChange, Places, ThreadCut};
pub use size::TurnedLimits;
pub use sizes::TurnedSizes;

use crate::Config;
use crate::bar::{Crossing, TurnedBar};
use crate::insert::Side;
use crate::judged::Judged;
use bus::Sample;
use canon::{Axis, Hand, Position};
use figures::{lead_error, leads, start_angle, thinned};
use inspection::{Contact, inspect};
use law::{Law, RUN_OUT};
use units::{Angle, Force, Lead, LeadGrowth, Length, Spin, Time, Torque};

/// Share of the way back to where a tool stood before it was fed in, from which on it is clear of
/// the work.
const CLEAR: f64 = 0.99;
use ordered::FED_IN_MM;
/// A tool so far off its ordered way across the thread is being taken off the work, mm.
const LEAVES_MM: f64 = 0.1;
/// Passes of the point through sections that are kept of one thread: 24 MB, 80,000 turns.
const MOST_CROSSINGS: usize = 1_000_000;

/// What was recorded of one pass.
#[derive(Clone, Debug, Default)]
struct Pass {
    /// Depth along the thread below the surface and distance from the helix, mm; turns since it
    /// began.
    at: Vec<[f64; 3]>,
    infeed: f64,
    /// +1 or −1: the way the spindle turned when it began.
    sense: Option<f64>,
    /// The run-out began.
    whole: bool,
    contact: Contact,
    /// How far behind the thread's beginning the work begins, as of a thread that begins in a
    /// relief groove, mm; `None`: not looked at yet.
    groove: Option<f64>,
}

/// What was recorded of a thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct TurnedTrack {
    passes: Vec<Pass>,
    began: Option<Time>,
    last: Time,
    before: Option<f64>,
    spin: f64,
    /// +1 or −1: the way the spindle turns.
    sense: f64,
    tool: Option<u32>,
    /// Where the point has passed the bar's sections; emptied where there were too many.
    crossings: Vec<Crossing>,
    too_many: bool,
    side: Option<Side>,
    force: Option<Force>,
    torque: Option<Torque>,
}

/// The bar, and the sections of it that the point has passed since the last sample.
pub(crate) type Turning<'a> = (&'a TurnedBar, Vec<Crossing>);

/// Whether a tool is off the work: an axis is back where it stood before it was fed in.
fn is_clear(axis: usize, stood: &Position, from: &Position, across: impl Fn(usize) -> f64) -> bool {
    (0..3).filter(|i| *i != axis).any(|i| {
        let way = (stood.linear[i] - from.linear[i]).value();
        way.abs() > FED_IN_MM && across(i) / way > CLEAR
    })
}

/// From outside, or from within a bore; `None` where the way does not say.
fn side_fed_in_from(stood: &Position, from: &Position, axis: [Length; 2]) -> Option<Side> {
    let radius =
        |at: &Position| (at.linear[0] - axis[0]).value().hypot((at.linear[1] - axis[1]).value());
    let way = radius(stood) - radius(from);
    match way {
        way if way > FED_IN_MM => Some(Side::External),
        way if way < -FED_IN_MM => Some(Side::Internal),
        _ => None,
    }
}

impl TurnedTrack {
    pub(crate) fn sample(
        &mut self,
        sample: &Sample,
        ordered: &OrderedThread,
        turning: Option<&Turning<'_>>,
        work_axis: [Length; 2],
    ) {
        if let Some((bar, crossings)) = turning {
            self.keep(bar, crossings);
        }
        let (angle, time) = (sample.spindle(0).value(), sample.feedback.time);
        let Some(was) = self.before.replace(angle) else { return };
        let elapsed = (time - self.last).value();
        self.last = time;
        let Some((index, law, whole)) = ordered.find(sample.report.op) else { return };
        let turned = angle - was;
        if turned == 0.0 {
            return;
        }
        let axis = law.axis().index();
        let w = sample.axis(axis).value();
        let depth = (w - law.surface().value()) * law.sign();
        let along = law.turn_at(w);
        self.passes.resize_with(self.passes.len().max(index + 1), Pass::default);
        let pass = &mut self.passes[index];
        if pass.whole || sample.report.op > law.last().op || along >= whole - RUN_OUT {
            pass.whole = true;
            return;
        }
        if depth < 0.0 {
            return;
        }
        if let Some((bar, _)) = turning.filter(|_| law.axis() == Axis::Z) {
            let side = self.side.unwrap_or_else(|| bar.side());
            let groove = *pass.groove.get_or_insert_with(|| bar.groove_before(side, law.sign()));
            if depth < groove {
                return; // it comes to its speed there
            }
        }
        // the material of a face begins at the bar's outside, which the block does not say
        let is_in_a_face = law.axis() != Axis::Z;
        if is_in_a_face && turning.is_some_and(|(bar, _)| bar.is_beside(Some(Side::External))) {
            return;
        }
        // a spindle that comes to rest in the work swings back a little: the pass goes on as it
        // began
        let sense = *pass.sense.get_or_insert(turned.signum());
        let before = law.first().before;
        let phase = sense * (angle - law.start_angle().value()) - before - along;
        let error = w - law.place(along + (phase - phase.round()));
        let [from, to] = law.ends();
        let share = law.share(w);
        let across = |i: usize| {
            let (from, to) = (from.linear[i].value(), to.linear[i].value());
            sample.axis(i).value() - (from + share * (to - from))
        };
        let stood = law.main().stood;
        if is_clear(axis, &stood, &from, across) {
            (pass.infeed, pass.sense) = (0.0, None); // it is turned again
            return;
        }
        let off = (0..3).filter(|i| *i != axis).map(|i| across(i).abs()).fold(0.0, f64::max);
        // on its way there it leaves the material long before
        let is_off_the_bar = turning.is_some_and(|(bar, _)| bar.is_beside(self.side));
        if off > LEAVES_MM && is_off_the_bar && pass.contact.touched > 0 {
            return;
        }
        self.sense = sense; // with the tool clear the spindle may turn as it likes
        if along < law.turns() - RUN_OUT {
            pass.infeed = pass.infeed.max(off); // a taper out of the thread begins with a rounded corner
        }
        if !law.is_at_step(along) {
            pass.at.push([depth, error, along]);
        }
        self.side = side_fed_in_from(&stood, &from, work_axis).or(self.side);
        if let Some((bar, crossings)) = turning {
            let side = self.side.unwrap_or_else(|| bar.side());
            let is_beyond = (w - law.span()[1].value()) * law.sign() > 0.0;
            crossings
                .iter()
                .filter(|_| !is_beyond)
                .for_each(|at| pass.contact.see(bar.depth(at, side)));
        }
        if let Some(truth) = &sample.truth {
            let (force, torque) = (truth.cutting_force.abs(), truth.cutting_torque.abs());
            self.force = Some(self.force.map_or(force, |most| most.max(force)));
            self.torque = Some(self.torque.map_or(torque, |most| most.max(torque)));
        }
        self.began.get_or_insert(time);
        self.tool = sample.feedback.tool.or(self.tool);
        if elapsed > 0.0 {
            self.spin = self.spin.max((turned / elapsed).abs());
        }
    }

    /// Keep what can have cut.
    fn keep(&mut self, bar: &TurnedBar, crossings: &[Crossing]) {
        let stock = bar.stock();
        let near =
            |at: &&Crossing| at.radius < stock.radius.value() && at.radius > stock.bore.value();
        self.crossings.extend(crossings.iter().filter(near));
        if self.crossings.len() > MOST_CROSSINGS {
            self.too_many = true;
            self.crossings = Vec::new();
        }
    }

    /// What the point met in the pass that cut most of the thread.
    fn contact(&self) -> Contact {
        let most = |a: &Contact, b: &Contact| {
            (a.share(), a.deepest)
                .partial_cmp(&(b.share(), b.deepest))
                .unwrap_or(std::cmp::Ordering::Equal)
        };
        self.passes.iter().map(|pass| pass.contact).max_by(most).unwrap_or_default()
    }

    /// What the passes have left of the bar; with what it takes to look at it again.
    fn inspect(
        &self,
        ordered: &OrderedThread,
        (law, hand): (Law<'_>, Hand),
        bar: &mut TurnedBar,
        places: &mut Places,
        config: &Config,
    ) -> ThreadCut {
        let chain = ordered.passes.last().and_then(|pass| pass.last());
        let whole = chain.map_or(0.0, |last| last.before + last.turns) - law.first().before;
        let tool = self.tool.and_then(|number| config.tools.get(number));
        let end = chain.map_or(law.span()[1], |last| last.order.to.along(law.axis()).of_linear());
        let of = inspection::Ordered { law, whole, hand, tool, end, side: self.side };
        places.look(bar, config);
        let mut contact = self.contact();
        let mut lie = of.lie(&self.crossings, bar.side(), contact.deepest);
        let block = bar.clone();
        let thread = places.before(&lie, bar);
        if let Some((_, met)) = thread.as_ref().filter(|(_, met)| met.share() > contact.share()) {
            contact = *met;
        }
        let befores = inspection::Befores { block, thread: thread.map(|(before, _)| before) };
        let inspected = inspect(&of, &self.crossings, contact, bar, &befores, config);
        let [low, high] = inspected.touched.unwrap_or(lie.span);
        let reach = lie.lead.abs();
        (lie.depth, lie.starts, lie.form) =
            (inspected.contact.deepest, inspected.starts, inspected.form);
        let span = [lie.span[0].min(low) - reach, lie.span[1].max(high) + reach];
        let at = bar.places_between(span);
        let before = befores.thread.unwrap_or(befores.block).stretch(at);
        let pass = ordered.passes.last().cloned().unwrap_or_default();
        let left = bar.stretch(at);
        ThreadCut { pass, whole, hand, tool: self.tool, end, inspected, lie, before, left }
    }

    /// Leave out of each pass what its axis needed to come to its speed; the longest of that.
    fn leave_run_in_out(&mut self, law: &Law<'_>) -> Length {
        let mut longest = 0.0_f64;
        for pass in self.passes.iter_mut().filter(|_| !law.varies()) {
            let at: Vec<_> = pass.at.iter().map(|[depth, e, _]| [*depth, e * law.sign()]).collect();
            let count = run_in::points(&at, law.main().lead().abs());
            if count > 0 {
                longest = longest.max(at[count][0] - at[0][0]);
                pass.at.drain(..count);
            }
        }
        Length::mm(longest)
    }

    /// Judges a thread; one on a bar goes among the bar's threads, and is listed at the end.
    pub(crate) fn finish(
        mut self,
        op: u32,
        line: u32,
        ordered: &OrderedThread,
        (config, bar, places): (&Config, Option<&mut TurnedBar>, &mut Places),
        now: Time,
    ) -> Option<Judged<TurnedThread>> {
        let law = ordered.passes.last().and_then(|pass| Law::of(pass));
        if bar.is_some() && ordered.goes_back && self.contact().touched == 0 {
            return None; // the way back from a pass, clear of the work
        }
        let run_in = law.filter(|_| bar.is_none()).map(|law| self.leave_run_in_out(&law));
        let slope = law.map_or(0.0, |law| law.main().lead());
        let tool = self.tool.and_then(|number| config.tools.get(number));
        let tip = |at: Length, axis: Axis| match tool {
            Some(tool) if axis == Axis::Z => at - tool.worn_length(),
            _ => at,
        };
        let errors = || self.passes.iter().flat_map(|pass| pass.at.iter().map(|[_, e, _]| *e));
        let count = errors().count().max(1) as f64;
        let most =
            |pass: &&Pass| pass.at.iter().fold(0.0, |most: f64, [_, e, _]| most.max(e.abs()));
        let worst = self.passes.iter().max_by(|a, b| most(a).total_cmp(&most(b)));
        let means: Vec<f64> = self
            .passes
            .iter()
            .filter(|pass| !pass.at.is_empty())
            .map(|pass| pass.at.iter().map(|[_, e, _]| e).sum::<f64>() / pass.at.len() as f64)
            .collect();
        let (low, high) = means
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), m| (low.min(*m), high.max(*m)));
        let lead_errors = self.passes.iter().map(|pass| lead_error(&pass.at));
        let last = self.passes.last().map_or(&[][..], |pass| &pass.at[..]);
        let none = (Axis::Z, [Length::ZERO; 2]);
        let (axis, [surface, end]) =
            law.map_or(none, |law| (law.axis(), law.span().map(|at| tip(at, law.axis()))));
        let hand = if slope * self.sense > 0.0 { Hand::Left } else { Hand::Right };
        let is_along = |law: &Law<'_>| law.axis() == Axis::Z && !self.too_many;
        let cut = law.filter(is_along).zip(bar).map(|(law, bar)| {
            bar.cut_by(line);
            let cut = self.inspect(ordered, (law, hand), bar, places, config);
            (cut, bar)
        });
        let inspected = cut.as_ref().map(|(cut, _)| &cut.inspected);
        let found = TurnedThread {
            lead: Lead::mm_per_rev(slope.abs()),
            growth: LeadGrowth::mm_per_rev2(
                law.map_or(0.0, |law| law.main().growth() * slope.signum()),
            ),
            leads: law.filter(Law::varies).map_or_else(Vec::new, |law| leads(&law, last)),
            start_angle: law.map_or(Angle::ZERO, |law| start_angle(&law, last, self.sense)),
            hand,
            axis,
            surface,
            end,
            passes: self.passes.iter().filter(|pass| pass.whole && !pass.at.is_empty()).count()
                as u32,
            passes_ordered: ordered.passes.len() as u32,
            spin_max: Spin::rev_per_s(self.spin),
            sync_error_max: Length::mm(worst.map_or(0.0, |pass| most(&pass))),
            sync_error_rms: Length::mm((errors().map(|e| e * e).sum::<f64>() / count).sqrt()),
            lead_error: Length::mm(
                lead_errors.fold(0.0, |most: f64, e| if e.abs() > most.abs() { e } else { most }),
            ),
            pass_spread: Length::mm((high - low).max(0.0)),
            pass_means: means.into_iter().map(Length::mm).collect(),
            infeed_error: Length::mm(self.passes.last().map_or(0.0, |pass| pass.infeed)),
            profile: worst.map_or_else(Vec::new, |pass| thinned(&pass.at)),
            force_max: self.force,
            torque_max: self.torque,
            run_in: run_in.unwrap_or(Length::ZERO),
            ..TurnedThread::of_bar(inspected, law.as_ref())
        };
        let judged = Judged {
            op,
            line,
            tool: self.tool,
            time: self.began.unwrap_or(now),
            duration: self.began.map_or(Time::ZERO, |began| self.last - began),
            verdict: verdict::of(&found, law.as_ref(), inspected, config),
            contact: crate::Contact {
                reach: found.groove_depth.map(|depth| depth.max(Length::ZERO)),
                torque: found.torque_max,
                force: found.force_max,
                torque_expected: None,
            },
            kind: found,
        };
        match cut {
            Some((cut, bar)) => {
                places.add(judged, cut, bar);
                None
            }
            None => Some(judged),
        }
    }
}

#[cfg(test)]
mod tests;
