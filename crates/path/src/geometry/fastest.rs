//! Of all curves of a given basis that are within the tolerance, the one that is fastest.
//!
//! ```text
//!   minimise ∫ du/√b    so that   |q″·b + ½·q′·b′| ≤ A    √b·|q‴·b + 3/2·q″·b′ + ½·q′·b″| ≤ J    |q′|·√b ≤ V, F
//!   over P and β                  |q − p| ≤ P at every sample
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | q(u) = Σ Nⱼ·Pⱼ | the curve, a cubic spline of the parameter |
//! | b(u) = u̇² = Σ Mⱼ·βⱼ | the square of the parameter's speed, a quadratic spline with the same knots |
//!
//! Shape and speed are looked for together, with the squared speed as unknown (Verscheure et
//! al., *Time-optimal path tracking for robots*, 2009), by a barrier method (Boyd and
//! Vandenberghe, *Convex Optimization*, 2004, ch. 11): what is minimised is
//!
//! ```text
//!   ∫ (1 − μ·Σ log(1 − x²)) du/√b         x: what is to be at most 1 of the above; μ becomes smaller and smaller
//! ```
//!
//! with the eighth power in place of the square where x is how far the curve is off (p and P as
//! `fit` has them): to be near is worth nothing within the tolerance, and what is straight should
//! not bend for it. x is a product of shape and speed, so this is not convex: the method begins at
//! the curve that bends least and takes Gauss's steps, which only count x's own first derivatives,
//! no farther than the goal falls. The speeds found serve to find the shape alone; `law` plans the
//! time along it.
use super::gathered::Gathered;
use super::load::{At, LimitPoint, Loads, SAY, SAY_B, mix};
use super::sample::Sample;
use super::spline::{Halved, Knots};
use crate::banded::Banded;
use crate::law::TOP_SPEED;
use alloc::vec::Vec;
use motion::{Limits, Point};

/// Steps are enough when they gain less than this share of μ.
const GAIN: f64 = 1e-2;
/// How often a step is halved at most, and the share of its promise that it must keep.
const HALVINGS: usize = 12;
const KEPT: f64 = 0.1;
/// Share of the tolerance that is used at least, and how much more than where it begins.
const NEAR: f64 = 0.988;
const ROOM: f64 = 0.003;
/// Samples of a span that count, as a rule, and how far off others must be to count too, over the
/// tolerance.
const SAMPLES: usize = 8;
const FAR: f64 = 0.6;
/// Share of the limits to begin with, and how often that is lowered, to what share of it.
const BEGIN: f64 = 0.5;
const LOWERED: usize = 64;
const LOWER: f64 = 0.8;
/// Of the matrix' diagonal: where control points move along the curve it stays nearly the same, and
/// a step would be lost in what the equations hardly determine (Marquardt, *An Algorithm for
/// Least-Squares Estimation of Nonlinear Parameters*, 1963).
const DAMPING: f64 = 1e-6;
/// Control points at each end that are given.
const GIVEN: usize = 3;
/// Places of a span, and the shares of its time that those at its ends and the one in its middle
/// stand for (Simpson's rule).
const PLACES: usize = 3;
const END: f64 = 1.0 / 6.0;
const MIDDLE: f64 = 4.0 / 6.0;

/// Whether the path is at rest at its beginning and end.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rests {
    pub(crate) begin: bool,
    pub(crate) end: bool,
}

/// A part of the search: μ, and how many steps there are at most.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage {
    mu: f64,
    steps: usize,
}

const WITHOUT_JERK: [Stage; 2] = [Stage { mu: 0.05, steps: 8 }, Stage { mu: 0.005, steps: 4 }];
const WITH_JERK: [Stage; 3] =
    [Stage { mu: 0.05, steps: 8 }, Stage { mu: 0.02, steps: 6 }, Stage { mu: 0.005, steps: 4 }];

impl Stage {
    /// One after another, with more knots from one to the next: with a limit of jerk more of them,
    /// as q‴ does not change between two knots.
    pub(crate) fn all(limits: &Limits) -> &'static [Self] {
        if limits.has_jerk() { &WITH_JERK } else { &WITHOUT_JERK }
    }
}

/// A sample of the tolerance.
#[derive(Clone, Copy, Debug)]
struct Held<const N: usize> {
    first: usize,
    basis: [f64; SAY],
    p: [f64; N],
    /// Square of how far the curve may be off.
    square: f64,
}

impl<const N: usize> Held<N> {
    fn apart(&self, control: &[[f64; N]]) -> [f64; N] {
        let mut q = [0.0; N];
        for (n, p) in self.basis.iter().zip(&control[self.first..self.first + SAY]) {
            for i in 0..N {
                q[i] += n * p[i];
            }
        }
        (0..N).for_each(|i| q[i] -= self.p[i]);
        q
    }
}

/// A span: the time that it takes, the first of its samples, and how many there are.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    time: f64,
    held: usize,
    count: usize,
}

/// Memory of the method, for N axes; B = N + 1 unknowns belong together, a control point and one β.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fastest<const N: usize, const B: usize> {
    held: Vec<Held<N>>,
    control: Vec<[f64; N]>,
    beta: Vec<f64>,
    /// Where the step began.
    control_before: Vec<[f64; N]>,
    beta_before: Vec<f64>,
    spans: Vec<Span>,
    /// The span where a limit was found not to be kept.
    tight: usize,
    matrix: Banded<B, SAY>,
    gradient: Vec<[f64; B]>,
    step: Vec<[f64; B]>,
}

impl<const N: usize, const B: usize> Fastest<N, B> {
    /// Whether the curve as it is lets the feed be reached all along it: then there is nothing to
    /// gain.
    pub(crate) fn is_at_feed(
        &mut self,
        control: &[Point],
        places: &[LimitPoint],
        limits: &Limits,
    ) -> bool {
        self.take(control);
        let loads = Loads::<N>::of(limits);
        places.iter().all(|place| {
            let b = place.feed * place.feed;
            let at = At::resting(place, &self.control, b);
            let mut most = at.feed(place) * b;
            loads.each(place, &at, |_, load| most = most.max(load.value.abs()));
            most <= 1.0 + 1e-9
        })
    }

    /// Time that a span took where the search was last.
    pub(crate) fn time(&self, span: usize) -> f64 {
        self.spans[span].time
    }

    /// Move the control points to where the curve is fastest; `false`: they are as they were.
    /// `halved`: the stage before ended where this one begins, with these knots, and there are more
    /// of them now.
    pub(crate) fn find(
        &mut self,
        control: &mut [Point],
        places: &[LimitPoint],
        samples: &[Sample],
        (limits, rests): (&Limits, Rests),
        (stage, halved): (Stage, Option<(Knots, &Halved)>),
    ) -> bool {
        let loads = Loads::of(limits);
        self.take(control);
        self.hold(samples);
        match halved {
            Some((old, halved)) => self.halve(old, halved),
            None => self.start(places, &loads, rests),
        }
        let mu = stage.mu;
        if !self.lower(places, &loads, mu) {
            return false;
        }
        for _ in 0..stage.steps {
            let time = self.weigh(places);
            let now = self.goal::<true>(places, &loads, mu);
            let slope = self.solve(rests);
            if -slope < GAIN * mu * time || !self.go(places, &loads, (now, slope, mu)) {
                break;
            }
        }
        for (wide, place) in control.iter_mut().zip(&self.control) {
            wide[..N].copy_from_slice(place);
        }
        true
    }

    /// The same speeds with more knots between the old ones.
    fn halve(&mut self, old: Knots, halved: &Halved) {
        let spans = (0..old.spans()).map(|span| {
            let rows = old.rows(span, old.0[span]).square;
            rows.map(|row| mix(&row, &self.beta[span..]))
        });
        let spans: Vec<[f64; SAY_B]> = spans.collect();
        self.beta.clear();
        self.beta.extend(halved.control(|span, u: [f64; 2]| {
            let ([x, y], [c0, c1, c2]) = (u.map(|u| u - old.0[span]), spans[span]);
            c0 + c1 * (x + y) / 2.0 + c2 / 2.0 * x * y
        }));
    }

    fn take(&mut self, control: &[Point]) {
        self.control.clear();
        self.control.extend(control.iter().map(|p| -> [f64; N] { core::array::from_fn(|i| p[i]) }));
    }

    fn hold(&mut self, samples: &[Sample]) {
        self.held.clear();
        let mut counts = alloc::vec![0_usize; self.control.len() - GIVEN];
        for sample in samples {
            counts[sample.first] += 1;
        }
        self.spans.clear();
        self.spans.resize(counts.len(), Span::default());
        self.tight = 0;
        for (index, sample) in samples.iter().enumerate().filter(|(_, s)| s.per_square > 0.0) {
            let Sample { first, basis, tolerance, .. } = *sample;
            let p = core::array::from_fn(|i| sample.p[i]);
            let mut held = Held { first, basis, p, square: 1.0 };
            let off = held.apart(&self.control);
            let off = off.chunks(3).map(|d| d.iter().map(|d| d * d).sum()).fold(0.0, f64::max);
            let share = libm::sqrt(off) / tolerance;
            // where there are many, some stand for all
            let each = counts[first].div_ceil(SAMPLES);
            if share < FAR && !index.is_multiple_of(each) {
                continue;
            }
            let near = tolerance * NEAR.max(share + ROOM);
            held.square = near * near;
            self.spans[first].count += 1;
            self.held.push(held);
        }
        let mut begin = 0;
        for span in &mut self.spans {
            span.held = begin;
            begin += span.count;
        }
    }

    /// Speeds to begin with: below what shape and limits allow.
    fn start(&mut self, places: &[LimitPoint], loads: &Loads<N>, rests: Rests) {
        let spans = self.control.len() - GIVEN;
        let (mut most, mut ways) = (alloc::vec![f64::INFINITY; spans], alloc::vec![0.0; spans]);
        for place in places {
            let one = At::resting(place, &self.control, 1.0);
            let mut b = (BEGIN / one.feed(place)).min(TOP_SPEED * TOP_SPEED);
            for i in 0..N {
                b = b.min(BEGIN / loads.accel(place, &one, i).value.abs());
                let jerk = BEGIN / loads.jerk(place, &one, i).value.abs();
                let speed = loads.speed(place, &one, i).value;
                b = b.min(libm::cbrt(jerk * jerk)).min(BEGIN / (speed * speed));
            }
            most[place.span] = most[place.span].min(b);
            ways[place.span] += place.weight;
        }
        let growth = |way: f64| BEGIN * way / loads.slackest();
        for (rest, k) in [(rests.begin, 0), (rests.end, spans - 1)] {
            if rest {
                most[k] = most[k].min(growth(ways[k]));
            }
        }
        for k in 1..spans {
            most[k] = most[k].min(most[k - 1] + growth(ways[k]));
        }
        for k in (1..spans).rev() {
            most[k - 1] = most[k - 1].min(most[k] + growth(ways[k - 1]));
        }
        self.beta.clear();
        self.beta.extend((0..spans + 2).map(|j| {
            let near = &most[j.saturating_sub(2)..=j.min(spans - 1)];
            near.iter().fold(f64::INFINITY, |m: f64, b| m.min(*b))
        }));
    }

    /// Lower the speeds until all limits are kept; `false`: that did not help.
    fn lower(&mut self, places: &[LimitPoint], loads: &Loads<N>, mu: f64) -> bool {
        (0..LOWERED).any(|_| {
            self.weigh(places);
            let good = self.goal::<false>(places, loads, mu).is_finite();
            if !good {
                self.beta.iter_mut().for_each(|b| *b *= LOWER);
            }
            good
        })
    }

    /// Time that each span takes, and all of them.
    fn weigh(&mut self, places: &[LimitPoint]) -> f64 {
        let mut total = 0.0;
        for (span, places) in self.spans.iter_mut().zip(places.chunks_exact(PLACES)) {
            let time = |place: &LimitPoint| place.weight / libm::sqrt(place.square(&self.beta));
            span.time = places.iter().map(time).sum();
            total += span.time;
        }
        total
    }

    /// What is minimised, infinity where a limit is not kept; with `SLOPES` its gradient and
    /// matrix, too.
    fn goal<const SLOPES: bool>(
        &mut self,
        places: &[LimitPoint],
        loads: &Loads<N>,
        mu: f64,
    ) -> f64 {
        let Self { held, spans, control, beta, matrix, gradient, tight, .. } = self;
        if SLOPES {
            matrix.clear(control.len());
            gradient.clear();
            gradient.resize(control.len(), [0.0; B]);
        }
        let (mut goal, mut gathered) = (0.0, Gathered::<N>::new());
        let of_span = |span: usize, gathered: &mut Gathered<N>| {
            let Span { time, held: from, count } = spans[span];
            let mut goal = 0.0;
            for place in &places[PLACES * span..][..PLACES] {
                let at = At::of(place, control, beta);
                let weight = mu * time * if place.middle { MIDDLE } else { END };
                goal += moving::<N, SLOPES>(place, &at, loads, weight, gathered);
            }
            let weight = mu * time / count.max(1) as f64;
            goal + near::<N, SLOPES>(&held[from..][..count], control, weight, gathered)
        };
        // where a step went too far it is likely to do so again
        if !SLOPES && !of_span(*tight, &mut gathered).is_finite() {
            return f64::INFINITY;
        }
        for span in 0..spans.len() {
            goal += of_span(span, &mut gathered);
            if SLOPES {
                gathered.put(span, matrix, gradient);
            } else if !goal.is_finite() {
                *tight = span;
                return f64::INFINITY;
            }
        }
        if goal.is_finite() { goal } else { f64::INFINITY }
    }

    /// The step; by how much the goal falls along it.
    fn solve(&mut self, rests: Rests) -> f64 {
        let count = self.control.len();
        let given = |j: usize, axis: usize| {
            if axis < N {
                j < GIVEN || j >= count - GIVEN
            } else {
                j == count - 1 || rests.begin && j == 0 || rests.end && j == count - 2
            }
        };
        for j in (0..GIVEN).chain(count - GIVEN..count) {
            for axis in (0..B).filter(|axis| given(j, *axis)) {
                self.matrix.fix(j, axis);
                self.gradient[j][axis] = 0.0;
            }
        }
        self.step.clear();
        self.step.extend(self.gradient.iter().map(|g| g.map(|g| -g)));
        self.matrix.damp(DAMPING);
        self.matrix.factor();
        self.matrix.solve_one(&mut self.step);
        let all = self.step.as_flattened().iter().zip(self.gradient.as_flattened());
        all.map(|(step, g)| step * g).sum()
    }

    /// Go along the step as far as the goal falls; `false`: not at all.
    fn go(
        &mut self,
        places: &[LimitPoint],
        loads: &Loads<N>,
        (now, slope, mu): (f64, f64, f64),
    ) -> bool {
        self.control_before.clone_from(&self.control);
        self.beta_before.clone_from(&self.beta);
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            for (j, step) in self.step.iter().enumerate() {
                for (axis, step) in step[..N].iter().enumerate() {
                    self.control[j][axis] = self.control_before[j][axis] + share * step;
                }
                if let Some(beta) = self.beta.get_mut(j) {
                    *beta = self.beta_before[j] + share * step[N];
                }
            }
            if self.goal::<false>(places, loads, mu) <= now + KEPT * share * slope {
                return true;
            }
            share *= 0.5;
        }
        core::mem::swap(&mut self.control, &mut self.control_before);
        core::mem::swap(&mut self.beta, &mut self.beta_before);
        false
    }
}

/// A place's part of the goal.
fn moving<const N: usize, const SLOPES: bool>(
    place: &LimitPoint,
    at: &At<N>,
    loads: &Loads<N>,
    weight: f64,
    gathered: &mut Gathered<N>,
) -> f64 {
    let (b, root) = (at.b[0], libm::sqrt(at.b[0]));
    let mut room = 1.0;
    if place.middle {
        let slow = at.feed(place);
        let left = 1.0 - slow * b;
        room *= left.max(0.0);
        if SLOPES {
            gathered.pace(place, at, slow, (weight / left, weight / (left * left)));
        }
    }
    loads.each(place, at, |axis, load| {
        // −log(1 − x²)
        let (x, left) = (load.value, 1.0 - load.value * load.value);
        room *= left.max(0.0);
        if SLOPES {
            let (once, twice) = (2.0 * x / left, 2.0 * (1.0 + x * x) / (left * left));
            gathered.load(axis, load, &place.rows, (weight * once, weight * twice));
        }
    });
    if SLOPES {
        let time = (-0.5 * place.weight / (b * root), 0.75 * place.weight / (b * b * root));
        gathered.speed(&place.rows.square[0], time);
    }
    place.weight / root - weight * libm::log(room)
}

/// The part of a span's samples.
fn near<const N: usize, const SLOPES: bool>(
    held: &[Held<N>],
    control: &[[f64; N]],
    weight: f64,
    gathered: &mut Gathered<N>,
) -> f64 {
    let mut room = 1.0;
    for held in held {
        let (over, d) = (1.0 / held.square, held.apart(control));
        for (group, d) in d.chunks(3).enumerate() {
            let &[x, y, z] = d else { continue };
            // −log(1 − r⁴), r = d²/P²
            let r = (x * x + y * y + z * z) * over;
            let (cube, left) = (r * r * r, 1.0 - r * r * r * r);
            room *= left.max(0.0);
            if SLOPES {
                let once = 8.0 * cube / left * over;
                let twice = (48.0 * r * r + 16.0 * cube * cube) / (left * left) * over * over;
                gathered.near(group, &held.basis, &[x, y, z], (weight * once, weight * twice));
            }
        }
    }
    -weight * libm::log(room)
}
