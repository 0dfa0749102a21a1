//! Turned threads: stretches are gathered until the chain is over, then their corners are rounded and all is judged.
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
use crate::path::Path;
use crate::step::{Step, StepKind};
use crate::tap_check::whole_rpm;
use crate::thread::{Corner, THREADING_AXES, ThreadStretch, Vector};
use crate::way_out::{Pass, TiedCut, WayOut};
use alloc::{format, vec::Vec};
use canon::{Axis, Position, Threading};
use diag::{Diagnostic, Span};
use units::{Angle, Lead, Length, Spin};

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
    slope: Vector,
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
            let text =
                format!("expected a lead above zero, found {} mm", number(order.lead.value()));
            self.findings.add(Diagnostic::error("M0424", job.span, text));
        }
        self.findings.len() > before
    }

    /// No more stretches come.
    pub(super) fn end_thread(&mut self, emit: &mut dyn FnMut(Step)) {
        let chain = core::mem::take(&mut self.chain);
        let Some(first) = chain.first() else { return };
        let mut turned = 0.0;
        let straight: Vec<Straight> = chain
            .iter()
            .map(|stretch| {
                let (from, to) = (linear(&stretch.from), linear(&stretch.order.to));
                let squares = (0..THREADING_AXES).map(|i| (to[i] - from[i]) * (to[i] - from[i]));
                let turns = libm::sqrt(squares.sum()) / stretch.order.lead.value();
                let from_turn = turned;
                turned += turns;
                let slope = core::array::from_fn(|i| (to[i] - from[i]) / turns);
                Straight { from, to, from_turn, to_turn: turned, slope }
            })
            .collect();
        let spin = self.spindles.get(SPINDLE).map_or(Spin::ZERO, |s| s.ordered.abs());
        let Some(corners) = self.corners(&chain, &straight, spin) else { return };
        self.judge_run_in(first, &straight[0], corners[0].1, spin);
        let last = chain.len() - 1;
        self.outbox.release(&[], &self.limits, emit);
        if let Some(way_out) = self.way_out(first, &straight) {
            let (op, line) = (first.index, first.span.line);
            let step = Step { op, line, kind: StepKind::WayOut(Some(way_out)) };
            self.outbox.hand_on(step, &self.limits, emit);
        }
        for (k, (waiting, at)) in chain.iter().zip(&straight).enumerate() {
            let beyond = |k: Option<usize>| {
                k.and_then(|k| straight.get(k)).map_or([0.0; THREADING_AXES], |s| s.slope)
            };
            let stretch = ThreadStretch {
                spindle: SPINDLE as u8,
                start: (k == 0).then_some(waiting.order.start_angle),
                ends: k == last,
                from: at.from,
                to: at.to,
                from_turn: at.from_turn,
                to_turn: at.to_turn,
                entry: Corner { beyond: beyond(k.checked_sub(1)), half: corners[k].1 },
                exit: Corner { beyond: beyond(Some(k + 1)), half: corners[k + 1].1 },
            };
            let (op, line) = (waiting.index, waiting.span.line);
            let step = Step { op, line, kind: StepKind::Thread(stretch) };
            self.outbox.hand_on(step, &self.limits, emit);
        }
    }

    /// How the tool comes off the work in this chain; `None` where nothing says from where it was fed in.
    fn way_out(&self, first: &Waiting, straight: &[Straight]) -> Option<WayOut> {
        let along = first.order.axis;
        let infeed = if along == Axis::X { Axis::Z } else { Axis::X };
        let (a, i) = (along.index(), infeed.index());
        let longest = |s: &&Straight| s.to_turn - s.from_turn;
        let main = straight.iter().max_by(|p, q| longest(p).total_cmp(&longest(q)))?;
        // a chain that feeds the tool in by itself begins where it is clear
        let began = straight.first()?.from[i];
        let stood = if began == main.from[i] { self.came_from.of(i)? } else { began };
        let outward = (stood - main.from[i]).signum();
        if stood == main.from[i] || main.slope.get(a).is_none_or(|slope| *slope == 0.0) {
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
            lead: Lead::mm_per_rev(main.slope[a] * sense),
            spin,
        };
        let (cut, clear) = (TiedCut::Thread, Length::mm(clear));
        Some(WayOut { cut, spindle: SPINDLE as u8, infeed, clear, outward, pass: Some(pass) })
    }

    /// The corners, each as the axis that decides and its half length; `None` if the chain is refused.
    fn corners(
        &mut self,
        chain: &[Waiting],
        straight: &[Straight],
        spin: Spin,
    ) -> Option<Vec<(usize, f64)>> {
        let before = self.findings.len();
        let mut axes: [Option<AxisLimits>; THREADING_AXES] = [None; THREADING_AXES];
        for (waiting, at) in chain.iter().zip(straight) {
            for i in (0..THREADING_AXES).filter(|&i| at.slope[i] != 0.0) {
                axes[i] = self.limits.axes[i];
                let Some(limits) = axes[i] else {
                    let letter = Axis::ALL[i].letter();
                    let text =
                        format!("the machine has no {letter} axis, and the program moves it");
                    self.findings.add(Diagnostic::error("M0305", waiting.span, text));
                    continue;
                };
                let (speed, most) =
                    (at.slope[i].abs() * spin.value(), limits.feed_speed.value() / FASTER);
                if speed > most * (1.0 + 1e-9) {
                    let works = Spin::rev_per_s(most / at.slope[i].abs());
                    let text = format!(
                        "{} mm of {} per revolution at S{} are {} mm/min, and the axis feeds at {} with the spindle's \
                         tolerance: S{} works",
                        number(at.slope[i].abs()),
                        Axis::ALL[i].letter(),
                        number(spin.in_rpm()),
                        number(speed * 60.0),
                        number(most * 60.0),
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
            let needs = corners[k].1 + corners[k + 1].1;
            let text = format!(
                "a stretch of {} rev at S{}, and the axes need {} to come up to the lead and down again: S{} works",
                number(straight[k].to_turn - straight[k].from_turn),
                number(spin.in_rpm()),
                number(needs),
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

    /// The tool should be on its helix where the material begins.
    fn judge_run_in(&mut self, first: &Waiting, at: &Straight, half: f64, spin: Spin) {
        let axis = first.order.axis.index();
        let Some(slope) = at.slope.get(axis).copied().filter(|s| *s != 0.0) else { return };
        let room = (first.order.surface.value() - at.from[axis]) / slope;
        if room < half && room > 0.0 {
            let letter = first.order.axis.letter();
            let starts = Length::mm((half - room) * slope.abs());
            let text = format!(
                "at S{} the {letter} axis needs {} mm from its start to be on the thread, and the material begins after {}: \
                 its first {} mm will be wrong",
                number(spin.in_rpm()),
                number(half * slope.abs()),
                number(room * slope.abs()),
                number(starts.value()),
            );
            let help =
                format!("start {} mm farther away", number(libm::ceil(starts.in_um()) / 1e3));
            self.findings.add(Diagnostic::warning("M0426", first.span, text).with_help(help));
        }
    }
}

/// Each corner's half length in turns, and the axis that decides it.
fn halves(
    straight: &[Straight],
    axes: &[Option<AxisLimits>; THREADING_AXES],
    n: f64,
) -> Vec<(usize, f64)> {
    let none = [0.0; THREADING_AXES];
    let slope = |k: Option<usize>| k.and_then(|k| straight.get(k)).map_or(none, |s| s.slope);
    let corner = |k: usize| {
        let (before, after) = (slope(k.checked_sub(1)), slope(Some(k)));
        let half = |i: usize| {
            let limits = axes[i]?;
            let (accel, jerk) = (limits.accel.value(), limits.feed_jerk.value());
            Some((i, Corner::half(after[i] - before[i], n * FASTER, accel, jerk)))
        };
        (0..THREADING_AXES)
            .filter_map(half)
            .fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most })
    };
    (0..=straight.len()).map(corner).collect()
}

/// The first stretch that has no room for its corners.
fn too_short(straight: &[Straight], corners: &[(usize, f64)]) -> Option<usize> {
    let lacks = |k: &usize| {
        corners[*k].1 + corners[k + 1].1 > straight[*k].to_turn - straight[*k].from_turn
    };
    (0..straight.len()).find(lacks)
}
