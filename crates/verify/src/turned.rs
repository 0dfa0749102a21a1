//! Turned threads: the groove that the passes of a single point have left, from recorded motion.
//!
//! Each pass is judged against the helix that its own block orders: where the thread's stretch starts, the spindle has
//! turned so far from the start angle.
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
//! A tool that is taken off the work, as for a hold, is judged until it is clear: until it stands where it stood before it was fed
//! in. The pass then counts once it has been cut to its end.
//!
//! The material begins at the surface that the block names. Where the chain ends the axes come to rest, which takes a part
//! of a revolution: the last revolution before it is the run-out and is not judged.
mod figures;
mod law;

use crate::Config;
use crate::feature::{Feature, FeatureKind, Verdict};
use bus::Sample;
use canon::{Axis, Hand, OpKind, Position};
use figures::{lead_error, leads, start_angle, thinned};
use law::{Law, Stretch};
use units::{Angle, Lead, LeadGrowth, Length, Spin, Time};

/// Share of the way back to where a tool stood before it was fed in, from which on it is clear of the work.
const CLEAR: f64 = 0.99;
/// Turns before the chain's end that are run-out.
const RUN_OUT: f64 = 1.0;

/// A thread that was turned with a single point, in one or more passes.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedThread {
    /// Advance along its axis for each revolution, without sign, where the longest of its blocks begins.
    pub lead: Lead,
    /// By how much that grows with each revolution of that block; negative where it shrinks.
    pub growth: LeadGrowth,
    /// Turn by turn, where the lead is not the same everywhere; of the last pass.
    pub leads: Vec<LeadOfTurn>,
    /// Where the spindle stood when the last pass was where it begins, as it was cut: in (−½, ½] turns.
    pub start_angle: Angle,
    /// Which way it winds.
    pub hand: Hand,
    /// The axis along which it runs.
    pub axis: Axis,
    /// Machine coordinate of the tip along `axis` where the material begins.
    pub surface: Length,
    /// Likewise at its end.
    pub end: Length,
    /// Passes that were cut.
    pub passes: u32,
    /// Passes that the program orders.
    pub passes_ordered: u32,
    /// Fastest that the spindle turned in the material.
    pub spin_max: Spin,
    /// Largest distance from the helix in the material, magnitude.
    pub sync_error_max: Length,
    /// Its root mean square.
    pub sync_error_rms: Length,
    /// Error of the lead over the thread's length, signed: positive is longer.
    pub lead_error: Length,
    /// Largest mean distance from the helix of a pass less the smallest.
    pub pass_spread: Length,
    /// Mean distance from the helix of each pass that was cut.
    pub pass_means: Vec<Length>,
    /// Largest distance from the ordered infeed in the deepest pass.
    pub infeed_error: Length,
    /// Of the pass with the largest error, along the thread from the surface on: depth and distance from the helix.
    pub profile: Vec<[Length; 2]>,
}

/// The lead of one turn of a thread, without sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeadOfTurn {
    /// Depth below the surface at which it begins.
    pub depth: Length,
    /// As it was ordered.
    pub ordered: Lead,
    /// As it was cut.
    pub cut: Lead,
}

impl TurnedThread {
    /// Such as "turned thread 1.500 left", "turned thread 2.000 growing 0.050 a turn".
    pub fn name(&self) -> String {
        let hand = if self.hand == Hand::Left { " left" } else { "" };
        let growth = self.growth.value();
        let changes = match growth {
            0.0 => String::new(),
            _ if growth > 0.0 => format!(" growing {growth:.3} a turn"),
            _ => format!(" shrinking {:.3} a turn", -growth),
        };
        format!("turned thread {:.3}{changes}{hand}", self.lead.value())
    }

    /// For people: "lead 2 mm growing 0.05 mm a turn".
    pub fn lead_in_words(&self) -> String {
        let (lead, growth) = (rounded(self.lead.value()), rounded(self.growth.value()));
        if growth == 0.0 {
            return format!("lead {lead} mm");
        }
        let changes = if growth > 0.0 { "growing" } else { "shrinking" };
        format!("lead {lead} mm {changes} {} mm a turn", growth.abs())
    }

    /// The turn whose lead is farthest off.
    pub fn worst_turn(&self) -> Option<&LeadOfTurn> {
        let off = |turn: &LeadOfTurn| (turn.cut - turn.ordered).abs().value();
        self.leads.iter().max_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// From where the material begins to the end.
    pub fn length(&self) -> Length {
        (self.end - self.surface).abs()
    }
}

/// To a hundredth of a micrometre.
fn rounded(mm: f64) -> f64 {
    (mm * 1e5).round() / 1e5
}

/// The passes that a program orders over one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ordered {
    passes: Vec<Vec<Stretch>>,
    chained: bool,
}

/// Where each linear axis was before the last rapid that moved it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CameFrom([Option<Length>; 3]);

impl CameFrom {
    /// A rapid of the program.
    pub(crate) fn rapid(&mut self, from: &Position, to: &Position) {
        for (came, (from, to)) in self.0.iter_mut().zip(from.linear.iter().zip(&to.linear)) {
            if from != to {
                *came = Some(*from);
            }
        }
    }

    /// Where the tool stood before it was fed in to here.
    fn before(&self, here: &Position) -> Position {
        let mut stood = *here;
        for (stood, came) in stood.linear.iter_mut().zip(self.0) {
            *stood = came.unwrap_or(*stood);
        }
        stood
    }
}

impl Ordered {
    /// An op from `from` on; whether it belongs to this thread.
    pub(crate) fn see(&mut self, op: u32, from: &Position, came: &CameFrom, kind: &OpKind) -> bool {
        let OpKind::Threading(order) = kind else {
            self.chained = false;
            return matches!(
                kind,
                OpKind::Rapid { .. }
                    | OpKind::Dwell { .. }
                    | OpKind::Spindle { .. }
                    | OpKind::Coolant { .. }
                    | OpKind::Overrides { .. }
                    | OpKind::PathMode(_)
                    | OpKind::Output(_)
                    | OpKind::Message(_)
            );
        };
        let stood = came.before(from);
        let stretch = Stretch::new(op, from, order, stood);
        match self.passes.last_mut() {
            Some(pass) if self.chained => {
                let before = pass.last().map_or(0.0, |last| last.before + last.turns);
                // a chain that feeds the tool in by itself begins where it is clear
                let first = pass.first().map_or(*from, |first| first.from);
                let across = |i: usize| i != order.axis.index();
                let feeds_in = (0..3).any(|i| across(i) && first.linear[i] != from.linear[i]);
                let stood = if feeds_in { first } else { stood };
                pass.push(Stretch { stood, before, ..stretch });
            }
            _ => {
                self.passes.push(vec![stretch]);
                self.chained = true;
            }
        }
        true
    }

    /// The pass that an op belongs to, its thread, and the turns from the thread's start to the chain's end.
    fn find(&self, op: u32) -> Option<(usize, Law<'_>, f64)> {
        let (index, pass) = self
            .passes
            .iter()
            .enumerate()
            .rfind(|(_, pass)| pass.first().is_some_and(|s| s.op <= op))?;
        let thread = Law::of(pass)?;
        let whole = pass.last().map_or(0.0, |last| last.before + last.turns);
        (op >= thread.first().op).then_some((index, thread, whole - thread.first().before))
    }
}

/// What was recorded of one pass.
#[derive(Clone, Debug, Default)]
struct Pass {
    /// Depth along the thread below the surface and distance from the helix, mm; turns since it began.
    at: Vec<[f64; 3]>,
    infeed: f64,
    /// +1 or −1: the way the spindle turned when it began.
    sense: Option<f64>,
    /// The run-out began.
    whole: bool,
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
}

impl TurnedTrack {
    pub(crate) fn sample(&mut self, sample: &Sample, ordered: &Ordered) {
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
        // a spindle that comes to rest in the work swings back a little: the pass goes on as it began
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
        let is_clear = |i: usize| {
            let way = (stood.linear[i] - from.linear[i]).value();
            way != 0.0 && across(i) / way > CLEAR
        };
        if (0..3).any(|i| i != axis && is_clear(i)) {
            (pass.infeed, pass.sense) = (0.0, None); // it is turned again
            return;
        }
        self.sense = sense; // with the tool clear the spindle may turn as it likes
        let off = (0..3).filter(|i| *i != axis).map(|i| across(i).abs()).fold(0.0, f64::max);
        if along < law.turns() - RUN_OUT {
            pass.infeed = pass.infeed.max(off); // a taper out of the thread begins with a rounded corner
        }
        if !law.is_at_step(along) {
            pass.at.push([depth, error, along]);
        }
        self.began.get_or_insert(time);
        self.tool = sample.feedback.tool.or(self.tool);
        if elapsed > 0.0 {
            self.spin = self.spin.max((turned / elapsed).abs());
        }
    }

    pub(crate) fn finish(
        self,
        op: u32,
        line: u32,
        ordered: &Ordered,
        config: &Config,
        now: Time,
    ) -> Feature {
        let law = ordered.passes.last().and_then(|pass| Law::of(pass));
        let slope = law.map_or(0.0, |law| law.main().lead());
        let tool = self.tool.and_then(|number| config.tools.get(number));
        let tip = |at: Length, axis: Axis| match tool {
            Some(tool) if axis == Axis::Z => at - tool.length,
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
        let found = TurnedThread {
            lead: Lead::mm_per_rev(slope.abs()),
            growth: LeadGrowth::mm_per_rev2(
                law.map_or(0.0, |law| law.main().growth() * slope.signum()),
            ),
            leads: law.filter(Law::varies).map_or_else(Vec::new, |law| leads(&law, last)),
            start_angle: law.map_or(Angle::ZERO, |law| start_angle(&law, last, self.sense)),
            hand: if slope * self.sense > 0.0 { Hand::Left } else { Hand::Right },
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
        };
        Feature {
            op,
            line,
            tool: self.tool,
            time: self.began.unwrap_or(now),
            duration: self.began.map_or(Time::ZERO, |began| self.last - began),
            verdict: Verdict::from_findings(&findings(&found, config)),
            kind: FeatureKind::Turned(Box::new(found)),
        }
    }
}

fn findings(found: &TurnedThread, config: &Config) -> Vec<String> {
    let mut findings = Vec::new();
    let tolerances = &config.tolerances;
    if found.passes < found.passes_ordered {
        findings.push(format!(
            "{} of {} passes were cut to their end",
            found.passes, found.passes_ordered
        ));
    }
    let mut off = |what: &str, has: Length, may: Length| {
        if has > may {
            findings.push(format!("{what} {:.1} µm, {:.1} allowed", has.in_um(), may.in_um()));
        }
    };
    off("distance from the helix", found.sync_error_max, tolerances.turned_thread);
    off("lead error over the thread's length", found.lead_error.abs(), tolerances.turned_thread);
    off("passes beside one another by", found.pass_spread, tolerances.turned_thread);
    off("infeed error", found.infeed_error, tolerances.position);
    findings
}

#[cfg(test)]
mod tests;
