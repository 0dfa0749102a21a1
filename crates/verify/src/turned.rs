//! Turned threads: the groove that the passes of a single point have left, from recorded motion.
//!
//! Each pass is judged against the helix that its own block orders: where the thread's stretch starts, the spindle has
//! turned so far from the start angle.
//!
//! ```text
//!   e = w − (w₀ + slope·(±θ − start − turns before))      w: coordinate along the thread, mm
//!       wrapped into ± half a lead: a groove does not know which turn it is on
//!
//!   sync error    max |e|, rms e         in the material, all passes
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
use crate::Config;
use crate::feature::{Feature, FeatureKind, Verdict};
use bus::Sample;
use canon::{Axis, Hand, OpKind, Position, Threading};
use units::{Lead, Length, Spin, Time};

/// Share of the way back to where a tool stood before it was fed in, from which on it is clear of the work.
const CLEAR: f64 = 0.99;
/// Turns before the chain's end that are run-out.
const RUN_OUT: f64 = 1.0;

/// A thread that was turned with a single point, in one or more passes.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedThread {
    /// Advance along its axis for each revolution, without sign.
    pub lead: Lead,
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

impl TurnedThread {
    /// Such as "turned thread 1.500 left".
    pub fn name(&self) -> String {
        let hand = if self.hand == Hand::Left { " left" } else { "" };
        format!("turned thread {:.3}{hand}", self.lead.value())
    }

    /// From where the material begins to the end.
    pub fn length(&self) -> Length {
        (self.end - self.surface).abs()
    }
}

/// One stretch of a pass as ordered.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    op: u32,
    from: Position,
    order: Threading,
    /// Where the tool stood before it was fed in.
    stood: Position,
    /// Turns since the start angle where it begins, and how many it takes.
    before: f64,
    turns: f64,
}

impl Stretch {
    /// Along the thread for each revolution, mm.
    fn slope(&self) -> f64 {
        self.way() / self.turns
    }

    /// Along the thread, mm.
    fn way(&self) -> f64 {
        let axis = self.order.axis;
        (self.order.to.along(axis) - self.from.along(axis)).value()
    }
}

/// The passes that a program orders over one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ordered {
    passes: Vec<Vec<Stretch>>,
    chained: bool,
    /// Where the last rapid began.
    rapid_from: Option<Position>,
}

impl Ordered {
    /// An op from `from` on; whether it belongs to this thread.
    pub(crate) fn see(&mut self, op: u32, from: &Position, kind: &OpKind) -> bool {
        let OpKind::Threading(order) = kind else {
            self.chained = false;
            if let OpKind::Rapid { .. } = kind {
                self.rapid_from = Some(*from);
            }
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
        let [dx, dy, dz] = [0, 1, 2].map(|i| (order.to.linear[i] - from.linear[i]).value());
        let turns = dx.hypot(dy).hypot(dz) / order.lead.value();
        let stood = self.rapid_from.unwrap_or(*from);
        let stretch = Stretch { op, from: *from, order: *order, stood, before: 0.0, turns };
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

    /// The stretch of a pass that is the thread: the longest.
    fn thread(pass: &[Stretch]) -> Option<&Stretch> {
        pass.iter().max_by(|a, b| a.way().abs().total_cmp(&b.way().abs()))
    }

    /// The pass that an op belongs to, its thread, and the turns from the thread's start to the chain's end.
    fn find(&self, op: u32) -> Option<(usize, &Stretch, f64)> {
        let (index, pass) = self
            .passes
            .iter()
            .enumerate()
            .rfind(|(_, pass)| pass.first().is_some_and(|s| s.op <= op))?;
        let thread = Self::thread(pass)?;
        let whole = pass.last().map_or(0.0, |last| last.before + last.turns);
        (op >= thread.op).then_some((index, thread, whole - thread.before))
    }
}

/// What was recorded of one pass.
#[derive(Clone, Debug, Default)]
struct Pass {
    /// Depth along the thread below the surface and distance from the helix, mm.
    at: Vec<[f64; 2]>,
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
        let Some((index, stretch, whole)) = ordered.find(sample.report.op) else { return };
        let turned = angle - was;
        if turned == 0.0 {
            return;
        }
        let (order, slope) = (&stretch.order, stretch.slope());
        let axis = order.axis.index();
        let w = sample.axis(axis).value();
        let depth = (w - order.surface.value()) * slope.signum();
        let run_in = (order.surface - stretch.from.along(order.axis)).value() / slope;
        let along = (w - stretch.from.along(order.axis).value()) / slope;
        self.passes.resize_with(self.passes.len().max(index + 1), Pass::default);
        let pass = &mut self.passes[index];
        if pass.whole || sample.report.op > stretch.op || along >= whole - RUN_OUT {
            pass.whole = true;
            return;
        }
        if along < run_in {
            return;
        }
        // a spindle that comes to rest in the work swings back a little: the pass goes on as it began
        let sense = *pass.sense.get_or_insert(turned.signum());
        let phase = sense * (angle - order.start_angle.value()) - stretch.before - along;
        let error = -(phase - phase.round()) * slope;
        let across = |i: usize| {
            let share = along / stretch.turns;
            let (from, to) = (stretch.from.linear[i].value(), order.to.linear[i].value());
            sample.axis(i).value() - (from + share * (to - from))
        };
        let is_clear = |i: usize| {
            let way = (stretch.stood.linear[i] - stretch.from.linear[i]).value();
            way != 0.0 && across(i) / way > CLEAR
        };
        if (0..3).any(|i| i != axis && is_clear(i)) {
            (pass.infeed, pass.sense) = (0.0, None); // it is turned again
            return;
        }
        self.sense = sense; // with the tool clear the spindle may turn as it likes
        let off = (0..3).filter(|i| *i != axis).map(|i| across(i).abs()).fold(0.0, f64::max);
        if along < stretch.turns - RUN_OUT {
            pass.infeed = pass.infeed.max(off); // a taper out of the thread begins with a rounded corner
        }
        pass.at.push([depth, error]);
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
        let thread = ordered.passes.last().and_then(|pass| Ordered::thread(pass)).copied();
        let tool = self.tool.and_then(|number| config.tools.get(number));
        let tip = |at: Length, axis: Axis| match tool {
            Some(tool) if axis == Axis::Z => at - tool.length,
            _ => at,
        };
        let errors = || self.passes.iter().flat_map(|pass| pass.at.iter().map(|[_, e]| *e));
        let count = errors().count().max(1) as f64;
        let most = |pass: &&Pass| pass.at.iter().fold(0.0, |most: f64, [_, e]| most.max(e.abs()));
        let worst = self.passes.iter().max_by(|a, b| most(a).total_cmp(&most(b)));
        let means: Vec<f64> = self
            .passes
            .iter()
            .filter(|pass| !pass.at.is_empty())
            .map(|pass| pass.at.iter().map(|[_, e]| e).sum::<f64>() / pass.at.len() as f64)
            .collect();
        let (low, high) = means
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), m| (low.min(*m), high.max(*m)));
        let lead_errors = self.passes.iter().map(|pass| lead_error(&pass.at));
        let found = TurnedThread {
            lead: Lead::mm_per_rev(thread.map_or(0.0, |t| t.slope().abs())),
            hand: if thread.map_or(0.0, |t| t.slope()) * self.sense > 0.0 {
                Hand::Left
            } else {
                Hand::Right
            },
            axis: thread.map_or(Axis::Z, |t| t.order.axis),
            surface: thread.map_or(Length::ZERO, |t| tip(t.order.surface, t.order.axis)),
            end: thread.map_or(Length::ZERO, |t| tip(t.order.to.along(t.order.axis), t.order.axis)),
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

/// Slope of the distance from the helix by least squares, times the length over which it was seen, mm.
fn lead_error(at: &[[f64; 2]]) -> f64 {
    let count = at.len() as f64;
    if at.len() < 2 {
        return 0.0;
    }
    let [depth, error] = [0, 1].map(|i| at.iter().map(|point| point[i]).sum::<f64>() / count);
    let (mut by_depth, mut squares) = (0.0, 0.0);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for [d, e] in at {
        by_depth += (d - depth) * (e - error);
        squares += (d - depth) * (d - depth);
        (low, high) = (low.min(*d), high.max(*d));
    }
    if squares > 0.0 { by_depth / squares * (high - low) } else { 0.0 }
}

/// Few enough points for a picture.
fn thinned(at: &[[f64; 2]]) -> Vec<[Length; 2]> {
    const POINTS: usize = 400;
    at.iter().step_by(at.len().div_ceil(POINTS).max(1)).map(|p| p.map(Length::mm)).collect()
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
    use canon::{Op, Span, ToolLibrary};
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

    #[test]
    fn a_pass_that_ends_early_fails() {
        let mut judge = Judge::new(Config::new(ToolLibrary::default()));
        let order = Threading {
            to: at(9.0, -20.0),
            lead: Lead::mm_per_rev(LEAD),
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
