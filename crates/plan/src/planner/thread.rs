//! Turned threads: stretches are gathered until the chain is over, then their corners are rounded
//! and all is judged.
//!
//! ```text
//!   Threading, Threading, … ─► chain ─┐ anything else comes
//!                                     ▼
//!             judge: spindle turns · axes fast enough · stretches long enough for their corners at this speed
//!                                     ▼
//!             spindle at speed ─► ThreadStretch, ThreadStretch, …
//! ```
use super::{Job, Planner};
use crate::findings::number;
use crate::limits::AxisLimits;
use crate::tap_check::whole_rpm;
use crate::thread::Change;
use crate::words::{bare_length, feed, length, length_at_least};
use crate::{Step, StepKind};
use alloc::{format, vec::Vec};
use canon::{Axis, Position, Threading};
use diag::{Diagnostic, Span};
use motion::{Corner, Pass, Path, THREADING_AXES, ThreadStretch, TiedCut, Vector, WayOut};
use units::{Angle, Lead, LeadGrowth, Length, Spin};

/// The spindle that threads follow.
const SPINDLE: usize = 0;
/// What a spindle at speed may turn too fast.
const FASTER: f64 = 1.05;

/// A stretch that waits for the chain's end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    index: u32,
    span: Span,
    from: Position,
    order: Threading,
}

/// A stretch with its turns.
struct Straight {
    from: Vector,
    to: Vector,
    from_turn: f64,
    to_turn: f64,
    /// Slope where it begins and where it ends, mm/rev.
    first: Vector,
    last: Vector,
    /// mm/rev².
    bend: Vector,
}

const fn linear(position: &Position) -> Vector {
    let [x, y, z] = position.linear;
    [x.value(), y.value(), z.value()]
}

impl Planner {
    /// One more stretch.
    pub(super) fn threading(&mut self, job: &mut Job, order: &Threading) {
        if self.chain.is_empty() {
            self.come_down(job);
            self.tell_spindles(job);
            self.await_spindles(job);
        }
        let from = self.programmed;
        self.programmed = order.to;
        let path = Path::Line { from, to: order.to };
        if !self.is_refused(job, &[path]) && !self.threading_is_refused(job, &from, order) {
            let feed = canon::Feed::PerRevolution(order.lead);
            self.judge_tool_is_there(job);
            self.sweep(job, &path, super::contact::Sweep::Thread(feed));
            self.chain.push(Waiting { index: job.index, span: job.span, from, order: *order });
        }
    }

    fn threading_is_refused(&mut self, job: &Job, from: &Position, order: &Threading) -> bool {
        let before = self.findings.len();
        if order.to.rotary != from.rotary || order.to.parallel != from.parallel {
            let text = "a thread is turned with X, Y and Z, found another axis that moves with it";
            self.findings.add(Diagnostic::error("M0425", job.span, text));
        }
        let turning = self.spindles.get(SPINDLE).is_some_and(|s| s.ordered != Spin::ZERO);
        if !turning {
            let text =
                "a thread needs a turning spindle: order M3 or M4 with an S above zero before it";
            self.findings.add(Diagnostic::error("M0421", job.span, text));
        }
        if !(order.lead.value() > 0.0 && order.lead.is_finite()) {
            let text = format!(
                "expected a lead above zero, found {}",
                length(&self.frame, order.lead.value())
            );
            self.findings.add(Diagnostic::error("M0424", job.span, text));
        } else if last_lead(order, far(&linear(from), &linear(&order.to))).is_none() {
            let text = format!(
                "a lead of {} that grows by {} in each turn is used up before the thread ends",
                length(&self.frame, order.lead.value()),
                length(&self.frame, order.growth.value()),
            );
            self.findings.add(Diagnostic::error("M0424", job.span, text));
        }
        self.findings.len() > before
    }

    /// No more stretches come.
    pub(super) fn end_thread(&mut self, emit: &mut dyn FnMut(Step)) {
        let chain = core::mem::take(&mut self.chain);
        let (Some(first), Some(last)) = (chain.first(), chain.last()) else { return };
        self.turned_pass(first.span, last.order.to.linear[2].value());
        let straight = straighten(&chain);
        let spin = self.spindles.get(SPINDLE).map_or(Spin::ZERO, |s| s.ordered.abs());
        let Some(corners) = self.corners(&chain, &straight, spin) else { return };
        self.judge_run_in(first, &straight[0], corners[0], spin);
        self.judge_hand(first, &straight);
        let last = chain.len() - 1;
        self.outbox.release([], &self.limits, emit);
        if let Some(way_out) = self.way_out(first, &straight) {
            let (op, line) = (first.index, first.span.line);
            let step = Step { op, line, kind: StepKind::WayOut(Some(way_out)) };
            self.outbox.hand_on(step, &self.limits, emit);
        }
        for (k, (waiting, at)) in chain.iter().zip(&straight).enumerate() {
            let before = k.checked_sub(1).and_then(|k| straight.get(k));
            let (entry, exit) = (corners[k], corners[k + 1]);
            let stretch = ThreadStretch {
                spindle: SPINDLE as u8,
                start: (k == 0).then_some(waiting.order.start_angle),
                ends: k == last,
                from: at.from,
                to: at.to,
                from_turn: at.from_turn,
                to_turn: at.to_turn,
                bend: at.bend,
                entry: before.map_or(Corner { half: entry, ..Corner::default() }, |before| {
                    Corner { beyond: before.last, bend: before.bend, half: entry }
                }),
                exit: straight.get(k + 1).map_or(
                    Corner { half: exit, ..Corner::default() },
                    |after| Corner { beyond: after.first, bend: after.bend, half: exit },
                ),
            };
            let (op, line) = (waiting.index, waiting.span.line);
            let step = Step { op, line, kind: StepKind::Thread(stretch) };
            self.outbox.hand_on(step, &self.limits, emit);
        }
    }

    /// How the tool comes off the work in this chain; `None` where nothing says from where it was
    /// fed in.
    fn way_out(&self, first: &Waiting, straight: &[Straight]) -> Option<WayOut> {
        let along = first.order.axis;
        let infeed = if along == Axis::X { Axis::Z } else { Axis::X };
        let (a, i) = (along.index(), infeed.index());
        let main = straight.iter().max_by(|p, q| p.turns().total_cmp(&q.turns()))?;
        // a chain that feeds the tool in by itself begins where it is clear
        let began = straight.first()?.from[i];
        let stood = if began == main.from[i] { self.came_from.of(i)? } else { began };
        let outward = (stood - main.from[i]).signum();
        if stood == main.from[i] || main.first.get(a).is_none_or(|slope| *slope == 0.0) {
            return None;
        }
        let places = straight.iter().flat_map(|s| [s.from[i], s.to[i]]);
        let clear = places.fold(stood, |far, x| if (x - far) * outward > 0.0 { x } else { far });
        let spin = self.spindles.get(SPINDLE)?.ordered;
        let sense = if spin < Spin::ZERO { -1.0 } else { 1.0 };
        let pass = Pass {
            axis: along,
            start: Length::mm(main.from[a]),
            angle: first.order.start_angle + Angle::rev(sense * main.from_turn),
            end: Length::mm(main.to[a]),
            from: Length::mm(straight.first()?.from[a]),
            surface: first.order.surface,
            lead: Lead::mm_per_rev(main.first[a] * sense),
            growth: LeadGrowth::mm_per_rev2(main.bend[a]),
            spin,
        };
        let (cut, clear) = (TiedCut::Thread, Length::mm(clear));
        Some(WayOut { cut, spindle: SPINDLE as u8, infeed, clear, outward, pass: Some(pass) })
    }

    /// Each corner's half length in turns; `None` if the chain is refused.
    fn corners(
        &mut self,
        chain: &[Waiting],
        straight: &[Straight],
        spin: Spin,
    ) -> Option<Vec<f64>> {
        let before = self.findings.len();
        let mut axes: [Option<AxisLimits>; THREADING_AXES] = [None; THREADING_AXES];
        for (waiting, at) in chain.iter().zip(straight) {
            for i in (0..THREADING_AXES).filter(|&i| at.from[i] != at.to[i]) {
                axes[i] = self.limits.axes[i];
                let Some(limits) = axes[i] else {
                    self.findings.add_missing_axis(waiting.span, Axis::ALL[i]);
                    continue;
                };
                let slope = at.first[i].abs().max(at.last[i].abs());
                let (speed, most) = (slope * spin.value(), limits.feed_speed.value() / FASTER);
                if speed > most * (1.0 + 1e-9) {
                    let works = Spin::rev_per_s(most / slope);
                    let grown =
                        if at.last[i].abs() > at.first[i].abs() { " at the end" } else { "" };
                    let text = format!(
                        "{} of {} per revolution{grown} at S{} are {}, and the axis feeds at {} with the spindle's \
                         tolerance: S{} works",
                        length(&self.frame, slope),
                        Axis::ALL[i].letter(),
                        number(spin.in_rpm()),
                        feed(&self.frame, speed * 60.0),
                        bare_length(&self.frame, most * 60.0),
                        number(whole_rpm(works)),
                    );
                    self.findings.add(Diagnostic::error("M0423", waiting.span, text));
                }
            }
        }
        if self.findings.len() > before {
            return None;
        }
        let corners = halves(straight, &axes, spin.value());
        if let Some(k) = too_short(straight, &corners) {
            // h falls with the speed: the highest whole number of revolutions per minute that works
            let fits = |rpm: f64| {
                let n = Spin::rpm(rpm).value();
                too_short(straight, &halves(straight, &axes, n)).is_none()
            };
            let (mut low, mut high) = (0.0, libm::floor(spin.in_rpm()) + 1.0);
            while high - low > 1.0 {
                let middle = libm::floor(f64::midpoint(low, high));
                if fits(middle) { low = middle } else { high = middle }
            }
            let (turns, needs) = (straight[k].turns(), corners[k] + corners[k + 1]);
            let why = if needs.is_finite() {
                format!("the axes need {} to come up to the lead and down again", number(needs))
            } else {
                "the axes cannot speed up as the lead grows".into()
            };
            let text = format!(
                "a stretch of {} rev at S{}, and {why}: S{} works",
                number(turns),
                number(spin.in_rpm()),
                number(low),
            );
            self.findings.add(
                Diagnostic::error("M0422", chain[k].span, text)
                    .with_help("or start farther from the material, and end in a wider groove"),
            );
            return None;
        }
        Some(corners)
    }

    /// A left-hand thread on a machine that turns its work is said: few programs mean one.
    fn judge_hand(&mut self, first: &Waiting, straight: &[Straight]) {
        let axis = Axis::Z.index();
        if !self.turns_work || first.order.axis != Axis::Z {
            return;
        }
        let Some(main) = straight.iter().max_by(|p, q| p.turns().total_cmp(&q.turns())) else {
            return;
        };
        let backwards = self.spindles.get(SPINDLE).is_some_and(|s| s.ordered < Spin::ZERO);
        let to_chuck = main.to[axis] < main.from[axis];
        if backwards != to_chuck {
            return;
        }
        let (turns, way) = if backwards { ("M4", "towards") } else { ("M3", "away from") };
        let other = if backwards { "M3" } else { "M4" };
        let text = format!("{turns} and a feed {way} the chuck give a left-hand thread");
        let help = format!("{other} gives a right-hand one");
        self.findings.add(Diagnostic::warning("M0427", first.span, text).with_help(help));
    }

    /// The tool should be on its helix where the material begins.
    fn judge_run_in(&mut self, first: &Waiting, at: &Straight, half: f64, spin: Spin) {
        let axis = first.order.axis.index();
        let wanted = first.order.surface.value() - at.from[axis];
        let Some(room) = at.turns_to(axis, wanted) else { return };
        let slope = (at.first[axis] + at.bend[axis] / 2.0 * room).abs();
        if room < half && room > 0.0 {
            let letter = first.order.axis.letter();
            let starts = Length::mm((half - room) * slope);
            let text = format!(
                "at S{} the {letter} axis needs {} from its start to be on the thread, and the material begins after {}: \
                 its first {} will be wrong",
                number(spin.in_rpm()),
                length(&self.frame, half * slope),
                bare_length(&self.frame, room * slope),
                length(&self.frame, starts.value()),
            );
            let help =
                format!("start {} farther away", length_at_least(&self.frame, starts.value()));
            self.findings.add(Diagnostic::warning("M0426", first.span, text).with_help(help));
        }
    }
}

impl Straight {
    fn turns(&self) -> f64 {
        self.to_turn - self.from_turn
    }

    /// Turns after which an axis has gone so far, signed; `None` where it does not move that way.
    fn turns_to(&self, axis: usize, way: f64) -> Option<f64> {
        let (slope, bend) = (*self.first.get(axis)?, *self.bend.get(axis)?);
        let last = libm::sqrt((slope * slope + 2.0 * bend * way).max(0.0));
        let mean = f64::midpoint(slope, last.copysign(slope));
        (mean != 0.0).then_some(way / mean)
    }
}

/// Length of a straight way, mm.
fn far(from: &Vector, to: &Vector) -> f64 {
    libm::sqrt((0..THREADING_AXES).map(|i| (to[i] - from[i]) * (to[i] - from[i])).sum())
}

/// The lead at the end of a way of so many mm, mm/rev: λ² + 2·growth·way, its root; `None` if it is
/// used up before.
fn last_lead(order: &Threading, way: f64) -> Option<f64> {
    let (lead, growth) = (order.lead.value(), order.growth.value());
    let squared = lead * lead + 2.0 * growth * way;
    (squared > 0.0 && squared.is_finite()).then(|| libm::sqrt(squared))
}

/// The chain's stretches over the turns.
fn straighten(chain: &[Waiting]) -> Vec<Straight> {
    let mut turned = 0.0;
    let straight = |stretch: &Waiting| {
        let (from, to) = (linear(&stretch.from), linear(&stretch.order.to));
        let way = far(&from, &to);
        let (lead, growth) = (stretch.order.lead.value(), stretch.order.growth.value());
        let last = last_lead(&stretch.order, way).unwrap_or(lead);
        let turns = 2.0 * way / (lead + last);
        let from_turn = turned;
        turned += turns;
        let along = |mm: f64| core::array::from_fn(|i| (to[i] - from[i]) / way * mm);
        let (first, last, bend) = if growth == 0.0 {
            let slope = core::array::from_fn(|i| (to[i] - from[i]) / turns);
            (slope, slope, [0.0; THREADING_AXES])
        } else {
            (along(lead), along(last), along(growth))
        };
        Straight { from, to, from_turn, to_turn: turned, first, last, bend }
    };
    chain.iter().map(straight).collect()
}

/// Each corner's half length in turns.
fn halves(straight: &[Straight], axes: &[Option<AxisLimits>; THREADING_AXES], n: f64) -> Vec<f64> {
    let none = [0.0; THREADING_AXES];
    let corner = |k: usize| {
        let before = k.checked_sub(1).and_then(|k| straight.get(k));
        let (slope_before, bend_before) = before.map_or((none, none), |s| (s.last, s.bend));
        let (slope, bend) = straight.get(k).map_or((none, none), |s| (s.first, s.bend));
        let half = |i: usize| {
            let limits = axes[i]?;
            let change = Change {
                slope: slope[i] - slope_before[i],
                bend: bend[i] - bend_before[i],
                most_bend: bend[i].abs().max(bend_before[i].abs()),
            };
            Some(change.half(n * FASTER, limits.accel.value(), limits.feed_jerk.value()))
        };
        (0..THREADING_AXES).filter_map(half).fold(0.0, f64::max)
    };
    (0..=straight.len()).map(corner).collect()
}

/// The first stretch that has no room for its corners.
fn too_short(straight: &[Straight], corners: &[f64]) -> Option<usize> {
    (0..straight.len()).find(|k| corners[*k] + corners[k + 1] > straight[*k].turns())
}
