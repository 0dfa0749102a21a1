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
//! Shape and speed are looked for together, with the squared speed as unknown (Verscheure et al., *Time-optimal path tracking
//! for robots*, 2009), by a barrier method (Boyd and Vandenberghe, *Convex Optimization*, 2004, ch. 11): what is minimised is
//!
//! ```text
//!   ∫ (1 − μ·Σ log(1 − x²)) du/√b         x: what is to be at most 1 of the above; μ becomes smaller and smaller
//! ```
//!
//! with the eighth power in place of the square where x is how far the curve is off: to be near the programmed path is worth
//! nothing within the tolerance, and what is straight should not bend for it. x is a product of shape and speed, so this is
//! not convex: the method begins at the curve that bends least and takes Gauss's steps, which only count x's own first
//! derivatives, no farther than the goal falls. The speeds found serve to find the shape alone; `law` plans the time along it.
use super::banded::Banded;
use super::fit::Sample;
use super::load::{At, Load, Loads, Place, SAY, SAY_B};
use super::{AXES, Limits, Point};
use crate::law::TOP_SPEED;
use alloc::vec::Vec;

/// μ: at first, at last, and from one to the next.
const FIRST: f64 = 0.1;
const LAST: f64 = 0.01;
const CUT: f64 = 0.1;
/// Steps with one μ at most; fewer when they gain less than this share of it.
const STEPS: usize = 8;
const GAIN: f64 = 1e-2;
/// How often a step is halved at most, and the share of its promise that it must keep.
const HALVINGS: usize = 12;
const KEPT: f64 = 0.1;
/// Share of the tolerance that is used at least, and how much more than where it begins.
const NEAR: f64 = 0.988;
const ROOM: f64 = 0.003;
/// Samples of a span that count, as a rule, and how far off others must be to count too, over the tolerance.
const SAMPLES: u32 = 8;
const FAR: f64 = 0.6;
/// Share of the limits to begin with, and how often that is lowered, to what share of it.
const BEGIN: f64 = 0.5;
const LOWERED: usize = 64;
const LOWER: f64 = 0.8;
/// Against rounding: of the matrix' diagonal.
const REGULAR: f64 = 1e-9;
/// Control points at each end that are given.
const GIVEN: usize = 3;

/// Whether the path is at rest at its beginning and end.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rests {
    pub(crate) begin: bool,
    pub(crate) end: bool,
}

/// A sample of the tolerance.
#[derive(Clone, Copy, Debug)]
struct Held<const N: usize> {
    first: usize,
    basis: [f64; SAY],
    p: [f64; N],
    /// Square of how far the curve may be off.
    square: f64,
    /// Time it stands for.
    time: f64,
}

impl<const N: usize> Held<N> {
    fn apart(&self, control: &[[f64; N]]) -> [f64; N] {
        let mut d = self.p.map(|p| -p);
        for (n, p) in self.basis.iter().zip(&control[self.first..]) {
            for i in 0..N {
                d[i] += n * p[i];
            }
        }
        d
    }
}

/// Memory of the method, for N axes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fastest<const N: usize> {
    held: Vec<Held<N>>,
    control: Vec<[f64; N]>,
    beta: Vec<f64>,
    /// Where the step began.
    control_before: Vec<[f64; N]>,
    beta_before: Vec<f64>,
    /// Time that a place stands for.
    times: Vec<f64>,
    spans: Vec<(f64, u32)>,
    matrix: Banded,
    gradient: Vec<f64>,
    step: Vec<f64>,
}

/// Unknowns that belong together: a control point, and one β.
const fn block(axes: usize) -> usize {
    axes + 1
}

impl<const N: usize> Fastest<N> {
    /// Whether the curve as it is lets the feed be reached all along it: then there is nothing to gain.
    pub(crate) fn is_at_feed(
        &mut self,
        control: &[Point],
        places: &[Place],
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

    /// Move the control points to where the curve is fastest; `false`: they are as they were.
    pub(crate) fn find(
        &mut self,
        control: &mut [Point],
        places: &[Place],
        samples: &[Sample],
        (limits, rests): (&Limits, Rests),
    ) -> bool {
        let loads = Loads::of(limits);
        self.take(control);
        self.hold(samples);
        if !self.start(places, &loads, rests) {
            return false;
        }
        let mut mu = FIRST;
        loop {
            for _ in 0..STEPS {
                let time = self.weigh(places);
                let now = self.goal(places, &loads, mu);
                self.derive(places, &loads, mu);
                let slope = self.solve(rests);
                if -slope < GAIN * mu * time || !self.go(places, &loads, (now, slope, mu)) {
                    break;
                }
            }
            if mu <= LAST {
                break;
            }
            mu = (mu * CUT).max(LAST);
        }
        for (wide, place) in control.iter_mut().zip(&self.control) {
            wide[..N].copy_from_slice(place);
        }
        true
    }

    fn take(&mut self, control: &[Point]) {
        self.control.clear();
        self.control.extend(control.iter().map(|p| -> [f64; N] { core::array::from_fn(|i| p[i]) }));
    }

    fn hold(&mut self, samples: &[Sample]) {
        self.held.clear();
        self.spans.clear();
        self.spans.resize(self.control.len() - GIVEN, (0.0, 0));
        for sample in samples {
            self.spans[sample.first].1 += 1;
        }
        for (index, sample) in samples.iter().enumerate().filter(|(_, s)| s.per_square > 0.0) {
            let Sample { first, basis, tolerance, .. } = *sample;
            let p = core::array::from_fn(|i| sample.p[i]);
            let mut held = Held { first, basis, p, square: 1.0, time: 0.0 };
            let off = held.apart(&self.control);
            let off = off.chunks(3).map(|d| d.iter().map(|d| d * d).sum()).fold(0.0, f64::max);
            let share = libm::sqrt(off) / tolerance;
            // where there are many, some stand for all
            let each = self.spans[first].1.div_ceil(SAMPLES) as usize;
            if share < FAR && !index.is_multiple_of(each) {
                continue;
            }
            let near = tolerance * NEAR.max(share + ROOM);
            held.square = near * near;
            self.held.push(held);
        }
    }

    /// Speeds to begin with: below what shape and limits allow.
    fn start(&mut self, places: &[Place], loads: &Loads<N>, rests: Rests) -> bool {
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
        (0..LOWERED).any(|_| {
            self.weigh(places);
            let good = self.goal(places, loads, FIRST).is_finite();
            if !good {
                self.beta.iter_mut().for_each(|b| *b *= LOWER);
            }
            good
        })
    }

    /// Time that places and samples stand for, and in all.
    fn weigh(&mut self, places: &[Place]) -> f64 {
        self.times.clear();
        self.spans.clear();
        self.spans.resize(self.control.len() - GIVEN, (0.0, 0));
        let mut total = 0.0;
        for place in places {
            let time = place.weight / libm::sqrt(place.square(&self.beta));
            total += time;
            self.spans[place.span].0 += time;
            self.times.push(time);
        }
        for held in &self.held {
            self.spans[held.first].1 += 1;
        }
        for held in &mut self.held {
            let (time, count) = self.spans[held.first];
            held.time = time / f64::from(count);
        }
        total
    }

    /// What is minimised; infinity where a limit is not kept.
    fn goal(&self, places: &[Place], loads: &Loads<N>, mu: f64) -> f64 {
        let (mut time, mut barrier) = (0.0, 0.0);
        // rooms are multiplied before the logarithm is taken, NAN: one is not there
        let and = |room: f64, left: f64| if left > 0.0 { room * left } else { f64::NAN };
        for (place, weight) in places.iter().zip(&self.times) {
            let at = At::of(place, &self.control, &self.beta);
            let b = at.b[0];
            let mut room = if place.middle { and(1.0, 1.0 - at.feed(place) * b) } else { 1.0 };
            loads.each(place, &at, |_, load| room = and(room, 1.0 - load.value * load.value));
            if room.is_nan() || b <= 0.0 {
                return f64::INFINITY;
            }
            time += place.weight / libm::sqrt(b);
            barrier -= weight * libm::log(room);
        }
        for held in &self.held {
            let mut room = 1.0;
            for d in held.apart(&self.control).chunks(3) {
                let off = d.iter().map(|d| d * d).sum::<f64>() / held.square;
                room = and(room, 1.0 - off * off * off * off);
            }
            if room.is_nan() {
                return f64::INFINITY;
            }
            barrier -= held.time * libm::log(room);
        }
        time + mu * barrier
    }

    /// Gradient and matrix of the goal.
    fn derive(&mut self, places: &[Place], loads: &Loads<N>, mu: f64) {
        let Self { held, control, beta, times, matrix, gradient, .. } = self;
        let block = block(N);
        matrix.clear(control.len() * block, SAY * block);
        gradient.clear();
        gradient.resize(control.len() * block, 0.0);
        for (place, time) in places.iter().zip(times.iter()) {
            let (at, weight) = (At::of(place, control, beta), mu * time);
            let (b, root) = (at.b[0], libm::sqrt(at.b[0]));
            let speeds: [usize; SAY_B] = core::array::from_fn(|k| (place.span + k) * block + N);
            matrix.rank_one(&speeds, &place.rows.square[0], 0.75 * place.weight / (b * b * root));
            for (i, by) in speeds.iter().zip(&place.rows.square[0]) {
                gradient[*i] -= 0.5 * place.weight / (b * root) * by;
            }
            if place.middle {
                pace(matrix, gradient, place, &at, (at.feed(place), weight));
            }
            loads.each(place, &at, |axis, load| {
                push::<N>(matrix, gradient, (place, axis), load, weight);
            });
        }
        for held in held.iter() {
            let d = held.apart(control);
            for (group, d) in d.chunks(3).enumerate() {
                // f = −log(1 − r⁴), r = d²/P²
                let r = d.iter().map(|d| d * d).sum::<f64>() / held.square;
                let left = 1.0 - r * r * r * r;
                let first = 8.0 * r * r * r / left * mu * held.time / held.square;
                let second = (12.0 * r * r + 4.0 * r * r * r * r * r * r) / (left * left);
                let weight = 4.0 * second * mu * held.time / (held.square * held.square);
                for (j, n) in held.basis.iter().enumerate() {
                    let first_row = (held.first + j) * block + 3 * group;
                    for (i, d_i) in d.iter().enumerate() {
                        gradient[first_row + i] += first * n * d_i;
                        let row = matrix.row(first_row + i);
                        for (k, m) in held.basis[j..].iter().enumerate() {
                            let share = n * m;
                            let from = if k == 0 { i } else { 0 };
                            row[k * block] += share * first;
                            let to = &mut row[k * block + from - i..];
                            for (to, d_l) in to.iter_mut().zip(&d[from..]) {
                                *to += share * weight * d_i * d_l;
                            }
                        }
                    }
                }
            }
        }
    }

    /// The step; by how much the goal falls along it.
    fn solve(&mut self, rests: Rests) -> f64 {
        let (block, count) = (block(N), self.control.len());
        let given = |j: usize, axis: usize| {
            if axis < N {
                j < GIVEN || j >= count - GIVEN
            } else {
                j == count - 1 || rests.begin && j == 0 || rests.end && j == count - 2
            }
        };
        for j in (0..GIVEN).chain(count - GIVEN..count) {
            for axis in (0..block).filter(|axis| given(j, *axis)) {
                self.matrix.fix(j * block + axis);
                self.gradient[j * block + axis] = 0.0;
            }
        }
        self.step.clear();
        self.step.extend(self.gradient.iter().map(|g| -g));
        self.matrix.solve(&mut self.step, REGULAR);
        self.step.iter().zip(&self.gradient).map(|(step, g)| step * g).sum()
    }

    /// Go along the step as far as the goal falls; `false`: not at all.
    fn go(
        &mut self,
        places: &[Place],
        loads: &Loads<N>,
        (now, slope, mu): (f64, f64, f64),
    ) -> bool {
        self.control_before.clone_from(&self.control);
        self.beta_before.clone_from(&self.beta);
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            for (j, step) in self.step.chunks(block(N)).enumerate() {
                for (axis, step) in step[..N].iter().enumerate() {
                    self.control[j][axis] = self.control_before[j][axis] + share * step;
                }
                if let Some(beta) = self.beta.get_mut(j) {
                    *beta = self.beta_before[j] + share * step[N];
                }
            }
            if self.goal(places, loads, mu) <= now + KEPT * share * slope {
                return true;
            }
            share *= 0.5;
        }
        core::mem::swap(&mut self.control, &mut self.control_before);
        core::mem::swap(&mut self.beta, &mut self.beta_before);
        false
    }
}

/// The feed's part of gradient and matrix; `slow` as [`Loads::feed`] has it.
fn pace<const N: usize>(
    matrix: &mut Banded,
    gradient: &mut [f64],
    place: &Place,
    at: &At<N>,
    (slow, weight): (f64, f64),
) {
    let (b, square) = (at.b[0], place.feed * place.feed);
    let left = 1.0 - slow * b;
    let (slopes, shares) = (&place.rows.cubic[0], &place.rows.square[0]);
    let way = if at.counts_way() { 2.0 * b / square } else { 0.0 };
    // by unknown: blocks of a control point and one β
    let mut by = [0.0; SAY * block(AXES)];
    for (k, slope) in slopes.iter().enumerate() {
        for (i, q) in at.q[0].iter().enumerate() {
            by[k * block(N) + i] = way * q * slope;
        }
        by[k * block(N) + N] = shares.get(k).map_or(0.0, |share| slow * share);
    }
    let by = &by[..SAY * block(N)];
    let first = place.span * block(N);
    matrix.rank_one_of_all(first, by, weight / (left * left));
    for (i, by) in by.iter().enumerate() {
        gradient[first + i] += weight / left * by;
    }
    for (k, one) in slopes.iter().enumerate() {
        for (j, other) in slopes.iter().enumerate().skip(k) {
            let bend = weight / left * way * one * other;
            for i in 0..N {
                matrix.add(first + k * block(N) + i, first + j * block(N) + i, bend);
            }
        }
    }
}

/// A load's part of gradient and matrix.
fn push<const N: usize>(
    matrix: &mut Banded,
    gradient: &mut [f64],
    (place, axis): (&Place, usize),
    load: &Load,
    weight: f64,
) {
    let (p, b) = (load.by_control(&place.rows), load.by_beta(&place.rows));
    // the unknowns in the order that they have
    let by = [p[0], b[0], p[1], b[1], p[2], b[2], p[3]];
    let unknowns: [usize; SAY + SAY_B] = core::array::from_fn(|k| {
        (place.span + k / 2) * block(N) + if k % 2 == 0 { axis } else { N }
    });
    let (x, left) = (load.value, 1.0 - load.value * load.value);
    let (first, second) = (2.0 * x / left, 2.0 * (1.0 + x * x) / (left * left));
    matrix.rank_one(&unknowns, &by, weight * second);
    for (i, by) in unknowns.iter().zip(by) {
        gradient[*i] += weight * first * by;
    }
}
