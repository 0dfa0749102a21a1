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
mod tests {
    use super::*;
    use crate::Judge;
    use bus::Truth;
    use canon::{Op, Span, Threading, ToolLibrary};
    use std::f64::consts::TAU;
    use units::Angle;

    const PERIOD: f64 = 250e-6;
    const LEAD: f64 = 1.5;

    fn at(x: f64, z: f64) -> Position {
        let [x, z] = [x, z].map(Length::mm);
        Position { linear: [x, Length::ZERO, z], ..Position::default() }
    }

    /// Two passes from Z5 over Z0 to Z−20, as this machine has made them: distance from the helix by pass and depth.
    fn judged(error: impl Fn(usize, f64) -> f64) -> TurnedThread {
        let mut judge = Judge::new(Config::new(ToolLibrary::default()));
        let (passes, n) = ([10.0, 9.5], 10.0);
        let mut time = 0.0;
        for (index, x) in passes.into_iter().enumerate() {
            let op = index as u32 * 2;
            let span = Span { line: op + 1, ..Span::default() };
            judge.op(op, &Op { span, kind: OpKind::Rapid { to: at(x, 5.0) } });
            let order = Threading {
                to: at(x, -20.0),
                lead: Lead::mm_per_rev(LEAD),
                growth: LeadGrowth::ZERO,
                start_angle: Angle::rev(0.25),
                axis: Axis::Z,
                surface: Length::ZERO,
            };
            judge.op(op + 1, &Op { span, kind: OpKind::Threading(order) });
            // the spindle is anywhere when the pass begins, and stands at the start angle at Z5
            let whole = 7.25 + 40.0 * index as f64;
            for k in 0..(25.0 / LEAD / n / PERIOD) as usize {
                let turn = k as f64 * PERIOD * n;
                let z = 5.0 - LEAD * turn;
                let mut sample = Sample::default();
                sample.report.op = op + 1;
                sample.feedback.time = Time::s(time);
                let mut truth = Truth::default();
                truth.axes[0] = Length::mm(x);
                truth.axes[2] = Length::mm(z + error(index, -z));
                truth.spindles[0] = Angle::rev(whole + turn);
                sample.truth = Some(truth);
                judge.sample(&sample);
                time += PERIOD;
            }
        }
        let features = judge.finish();
        let [feature] = &features[..] else { panic!("{features:?}") };
        let FeatureKind::Turned(thread) = &feature.kind else { panic!("{feature:?}") };
        assert_eq!(feature.verdict.is_pass(), thread.sync_error_max < Length::um(10.0));
        (**thread).clone()
    }

    #[test]
    fn a_perfect_helix_has_no_error_and_is_right_handed() {
        let thread = judged(|_, _| 0.0);
        assert!(thread.sync_error_max.in_um() < 1e-6 && thread.hand == Hand::Right, "{thread:?}");
        assert_eq!((thread.passes, thread.passes_ordered), (2, 2));
        assert!((thread.lead.value() - LEAD).abs() < 1e-12);
        assert!((thread.spin_max.value() - 10.0).abs() < 1e-6);
    }

    #[test]
    fn a_pass_beside_the_other_is_the_passes_spread() {
        let thread = judged(|pass, _| if pass == 0 { 0.004 } else { -0.003 });
        assert!((thread.pass_spread.in_um() - 7.0).abs() < 1e-6, "{thread:?}");
        assert!((thread.sync_error_max.in_um() - 4.0).abs() < 1e-6);
    }

    #[test]
    fn a_screw_of_another_lead_leaves_its_error_over_the_length() {
        let thread = judged(|_, depth| -1e-4 * depth);
        // judged from the surface to a revolution before the end: 18.5 mm; in −Z the thread is longer
        assert!((thread.lead_error.in_um() - -1.85).abs() < 0.01, "{thread:?}");
    }

    #[test]
    fn a_wave_is_found_with_its_peak_and_its_rms_and_the_run_out_is_not_judged() {
        let wave = |_: usize, depth: f64| {
            if depth > 18.6 { -0.3 } else { 0.008 * (TAU * depth / 3.0).sin() }
        };
        let thread = judged(wave);
        assert!((thread.sync_error_max.in_um() - 8.0).abs() < 0.05, "{thread:?}");
        assert!((thread.sync_error_rms.in_um() - 8.0 / 2.0_f64.sqrt()).abs() < 0.1);
    }

    /// A pass from Z5 over Z0: 2 mm for 10 turns up to Z−15, then growing by 0.1 mm in each of 20 turns to 4 mm at Z−75, on
    /// with that for 5 turns to Z−95; X goes 1 mm out on 100 of Z. `error` by turn and depth.
    fn growing(sense: f64, error: impl Fn(f64) -> f64) -> (TurnedThread, Verdict) {
        let mut judge = Judge::new(Config::new(ToolLibrary::default()));
        let taper = |z: f64| at(9.0 + (5.0 - z) / 100.0, z);
        let slant = 0.01_f64.hypot(1.0);
        judge.op(0, &Op { span: Span::default(), kind: OpKind::Rapid { to: taper(5.0) } });
        for (op, (z, lead, growth)) in
            (1..).zip([(-15.0, 2.0, 0.0), (-75.0, 2.0, 0.1), (-95.0, 4.0, 0.0)])
        {
            let order = Threading {
                to: taper(z),
                lead: Lead::mm_per_rev(lead * slant),
                growth: LeadGrowth::mm_per_rev2(growth * slant),
                start_angle: Angle::rev(0.25),
                axis: Axis::Z,
                surface: Length::mm(if z == -15.0 { 0.0 } else { z + 60.0 }),
            };
            judge.op(op, &Op { span: Span::default(), kind: OpKind::Threading(order) });
        }
        let n = 10.0;
        for k in 0..(35.0 / n / PERIOD) as usize {
            let turn = k as f64 * PERIOD * n;
            let (op, z) = if turn < 10.0 {
                (1, 5.0 - 2.0 * turn)
            } else if turn < 30.0 {
                let grown = turn - 10.0;
                (2, -15.0 - 2.0 * grown - 0.05 * grown * grown)
            } else {
                (3, -75.0 - 4.0 * (turn - 30.0))
            };
            let mut sample = Sample::default();
            sample.report.op = op;
            sample.feedback.time = Time::s(k as f64 * PERIOD);
            let mut truth = Truth::default();
            truth.axes[0] = taper(z).linear[0];
            truth.axes[2] = Length::mm(z + error(turn));
            truth.spindles[0] = Angle::rev(0.25 + sense * (7.0 + turn));
            sample.truth = Some(truth);
            judge.sample(&sample);
        }
        let feature = judge.finish().remove(0);
        let FeatureKind::Turned(thread) = feature.kind else { panic!("{feature:?}") };
        (*thread, feature.verdict)
    }

    #[test]
    fn a_lead_that_grows_is_measured_turn_by_turn_over_the_whole_chain() {
        for (sense, hand) in [(1.0, Hand::Right), (-1.0, Hand::Left)] {
            let (thread, verdict) = growing(sense, |_| 0.0);
            assert!(verdict.is_pass() && thread.hand == hand, "{verdict:?}, {thread:?}");
            assert!(thread.sync_error_max.in_um() < 1e-6, "{thread:?}");
            assert!((thread.lead.value() - 2.0).abs() < 1e-9);
            assert!((thread.growth.value() - 0.1).abs() < 1e-9);
            assert!((thread.start_angle.in_deg() - 90.0).abs() < 1e-6, "{}", thread.start_angle);
            assert_eq!((thread.surface, thread.end), (Length::ZERO, Length::mm(-95.0)));
            // from Z0, 2.5 turns in, to a turn before the end
            assert_eq!(thread.leads.len(), 31);
            for (k, turn) in thread.leads.iter().enumerate() {
                // the mean lead of a turn that begins so long after the lead began to grow
                let grown =
                    |turn: f64| 0.05 * turn.clamp(0.0, 20.0).powi(2) + 2.0 * (turn - 20.0).max(0.0);
                let began = k as f64 - 7.5;
                let wanted = 2.0 + grown(began + 1.0) - grown(began);
                assert!((turn.cut.value() - wanted).abs() < 0.01, "turn {k}: {turn:?}, {wanted}");
                assert!((turn.cut - turn.ordered).abs().value() < 1e-9, "turn {k}: {turn:?}");
            }
            assert_eq!(thread.lead_in_words(), "lead 2 mm growing 0.1 mm a turn");
        }
    }

    #[test]
    fn a_turn_that_is_too_long_and_a_start_that_is_late_are_found() {
        // from turn 15 on 6 µm farther; 0.01 turns late in all the constant part
        let (thread, _) = growing(1.0, |turn| if turn >= 15.0 { -0.006 } else { 0.0 });
        let worst = thread.worst_turn().expect("there are turns");
        assert!(((worst.cut - worst.ordered).value() - 0.006).abs() < 1e-6, "{worst:?}");
        assert!((thread.sync_error_max.in_um() - 6.0).abs() < 1e-3);
        let at = |turn: f64| {
            let grown = (turn - 10.0).clamp(0.0, 20.0);
            5.0 - 2.0 * turn - 0.05 * grown * grown - 2.0 * (turn - 30.0).max(0.0)
        };
        let (thread, verdict) = growing(1.0, |turn| at(turn - 0.01) - at(turn));
        assert!(
            (thread.start_angle.in_deg() - 93.6).abs() < 1e-3,
            "{}",
            thread.start_angle.in_deg()
        );
        assert!(!verdict.is_pass() && thread.lead_error.in_um() > 20.0, "{}", thread.lead_error);
    }

    #[test]
    fn a_thread_of_one_lead_where_a_growing_one_is_ordered_fails() {
        let (thread, verdict) =
            growing(
                1.0,
                |turn| if turn > 10.0 { 0.05 * (turn - 10.0).min(20.0).powi(2) } else { 0.0 },
            );
        assert!(!verdict.is_pass() && thread.sync_error_max > Length::mm(0.5), "{thread:?}");
    }

    #[test]
    fn a_hold_in_the_first_pass_already_is_known_to_take_the_tool_off_the_work() {
        let mut judge = Judge::new(Config::new(ToolLibrary::default()));
        let order = Threading {
            to: at(10.0, -20.0),
            lead: Lead::mm_per_rev(LEAD),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: Axis::Z,
            surface: Length::ZERO,
        };
        let rapid = |x, z| OpKind::Rapid { to: at(x, z) };
        let ops = [rapid(30.0, 5.0), rapid(12.0, 5.0), rapid(10.0, 5.0)];
        let ops = ops.into_iter().chain([OpKind::Threading(order)]);
        for (index, kind) in (0..).zip(ops) {
            judge.op(index, &Op { span: Span::default(), kind });
        }
        let thread = |turn: f64| 5.0 - LEAD * turn;
        let mut time = 0.0;
        let mut see = |x: f64, z: f64, turn: f64| {
            let mut sample = Sample::default();
            sample.report.op = 3;
            sample.feedback.time = Time::s(time);
            let mut truth = Truth::default();
            (truth.axes[0], truth.axes[2]) = (Length::mm(x), Length::mm(z));
            truth.spindles[0] = Angle::rev(turn);
            sample.truth = Some(truth);
            judge.sample(&sample);
            time += PERIOD;
        };
        let step = PERIOD * 10.0;
        let turns = |from: f64, to: f64| {
            (0..((to - from) / step) as u32).map(move |k| from + f64::from(k) * step)
        };
        turns(0.0, 10.0).for_each(|turn| see(10.0, thread(turn), turn));
        // out within a turn, still on the thread; back in another three, and the pass again from turn 20 on
        turns(10.0, 11.0).for_each(|turn| see(10.0 + 2.0 * (turn - 10.0), thread(turn), turn));
        turns(11.0, 14.0).for_each(|turn| {
            see(12.0, thread(11.0) + (5.0 - thread(11.0)) * (turn - 11.0) / 3.0, turn);
        });
        turns(14.0, 20.0).for_each(|turn| see(10.0, 5.0, turn));
        turns(20.0, 36.0).for_each(|turn| see(10.0, thread(turn - 20.0), turn));
        let feature = judge.finish().remove(0);
        assert!(feature.verdict.is_pass(), "{:?}", feature.verdict.reason());
    }

    #[test]
    fn a_pass_that_ends_early_fails() {
        let mut judge = Judge::new(Config::new(ToolLibrary::default()));
        let order = Threading {
            to: at(9.0, -20.0),
            lead: Lead::mm_per_rev(LEAD),
            growth: LeadGrowth::ZERO,
            start_angle: Angle::ZERO,
            axis: Axis::Z,
            surface: Length::ZERO,
        };
        judge.op(0, &Op { span: Span::default(), kind: OpKind::Threading(order) });
        let feature = judge.finish().remove(0);
        let reason = feature.verdict.reason().unwrap_or_default();
        assert_eq!(reason, "0 of 1 passes were cut to their end");
    }
}
