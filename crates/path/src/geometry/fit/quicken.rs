//! From the curve that bends least to the fastest one.
//!
//! The search has stages. From one to the next there are more knots, where a span takes long; the
//! last curve that is within the tolerance is the one that stays.
use super::{BETWEEN, Fitter, serves};
use crate::geometry::fastest::{Rests, Stage};
use crate::geometry::joint::{Segment, Waiting, distance};
use crate::geometry::knots::Way;
use crate::geometry::load::LimitPoint;
use crate::geometry::sample::Sample;
use crate::geometry::spline::{Halved, Knots};
use crate::law::{shortest_oscillation, step};
use alloc::vec::Vec;
use motion::{Curve, Limits, Point, Polynomial};

/// Control points that a curve has at least if it is worth looking for a faster one: some of them
/// must be free.
const FEWEST: usize = 8;
/// Knots that are nearer to each other than so many tolerances get none between them.
const CLOSEST: f64 = 2.1;
/// A span gets none either unless it takes so many times a step of the law, or a quarter of an
/// oscillation within the tolerance: its halves take less by as much as it takes more.
const LONG: f64 = core::f64::consts::SQRT_2;
/// No step counts as longer than this, s.
const LONGEST_COUNTED_STEP: f64 = 6e-3;
/// So many spans at each end count as long in any case: of their control points three are given.
const ENDS: usize = 4;
/// How much sharper its sharpest bend may be.
const SHARPER: f64 = 8.0;

impl Fitter {
    /// From the curve that bends least to the fastest one, where the first does not let the feed be
    /// reached.
    pub(super) fn quicken(&mut self, way: &Way, limits: &Limits, rests: Rests) {
        // a programmed spline may end in a bend of a thousandth of a millimetre, which fixes the
        // curve's knots there
        let spline = |one: &Waiting| matches!(one.segment.curve, Curve::Bezier(_));
        if self.axes == 0 || self.control.len() < FEWEST || way.moves.iter().any(spline) {
            return;
        }
        self.look_at_limits(way);
        let (linear, all) = (&mut self.fastest_linear, &mut self.fastest_of_all);
        let at_feed = if self.axes <= 3 {
            linear.is_at_feed(&self.control, &self.places, limits)
        } else {
            all.is_at_feed(&self.control, &self.places, limits)
        };
        if at_feed {
            return;
        }
        let sharpest = self.sharpest();
        self.keep();
        let (mut found, mut is_good) = (true, false);
        for (number, stage) in Stage::all(limits).iter().enumerate() {
            if !found {
                break;
            }
            if is_good {
                self.keep();
            }
            found = if number == 0 {
                self.search((limits, rests), (*stage, None))
            } else {
                let old = self.knots.clone();
                let halved = self.refine(way, limits);
                self.search((limits, rests), (*stage, Some((Knots(&old), &halved))))
            };
            is_good = found && self.is_good(sharpest);
        }
        if !is_good {
            core::mem::swap(&mut self.kept.0, &mut self.knots);
            core::mem::swap(&mut self.kept.1, &mut self.control);
        }
    }

    /// The curve as it is, in case that one that is faster is not good.
    fn keep(&mut self) {
        self.kept.0.clone_from(&self.knots);
        self.kept.1.clone_from(&self.control);
    }

    /// Whether it is within the tolerance, and where it is slow, where a bend is free, no bend has
    /// become so sharp that the law's cells would miss it.
    fn is_good(&mut self, sharpest: f64) -> bool {
        let near =
            |sample: &Sample| distance(&self.at(sample), &sample.p) <= sample.tolerance * BETWEEN;
        let is_near = self.samples.iter().all(near);
        is_near && self.sharpest() <= SHARPER * sharpest && self.keeps_between()
    }

    /// One stage of the search for the fastest curve; knots of the one before, and new ones.
    fn search(
        &mut self,
        limits: (&Limits, Rests),
        stage: (Stage, Option<(Knots, &Halved)>),
    ) -> bool {
        let (linear, all) = (&mut self.fastest_linear, &mut self.fastest_of_all);
        let (control, places, samples) = (&mut self.control, &self.places, &self.samples);
        if self.axes <= 3 {
            linear.find(control, places, samples, limits, stage)
        } else {
            all.find(control, places, samples, limits, stage)
        }
    }

    /// Sharpest bend at a knot.
    fn sharpest(&self) -> f64 {
        let bend = |(knot, (shares, _)): (usize, &([f64; 3], f64))| {
            let of = |i: usize| (0..3).map(|n| shares[n] * self.control[knot + n][i]).sum::<f64>();
            (0..self.axes).map(|i| of(i).abs()).fold(0.0, f64::max)
        };
        self.bends.iter().enumerate().map(bend).fold(0.0, f64::max)
    }

    /// Places where speed, acceleration and jerk are looked at: both ends and the middle of each
    /// span.
    fn look_at_limits(&mut self, way: &Way) {
        self.places.clear();
        let knots = Knots(&self.knots);
        for span in 0..knots.spans() {
            let (from, h) = (knots.0[span], knots.0[span + 1] - knots.0[span]);
            let Segment { feed, rapid, .. } = serves(way, from, from + h);
            let last = span + 1 == knots.spans();
            // Simpson's rule
            for (share, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
                let (rows, weight) = (knots.rows(span, from + share * h), weight * h / 6.0);
                let (again, middle) = (share == 1.0 && !last, share == 0.5);
                self.places.push(LimitPoint { span, rows, weight, feed, rapid, again, middle });
            }
        }
    }

    /// The same curve with more knots, as long as they are not too near to each other: along the
    /// way, and in time.
    fn refine(&mut self, way: &Way, limits: &Limits) -> Halved {
        let spans: Vec<Polynomial> = (0..self.spans()).map(|span| self.polynomial(span)).collect();
        let old = core::mem::take(&mut self.knots);
        let (linear, all) = (&self.fastest_linear, &self.fastest_of_all);
        let time = |span| if self.axes <= 3 { linear.time(span) } else { all.time(span) };
        let longest = step(limits).min(LONGEST_COUNTED_STEP);
        let near = |span: usize| {
            let (a, b) = (old[span], old[span + 1]);
            let tolerance = serves(way, a, b).tolerance;
            let ends = span < ENDS || span + ENDS >= old.len() - 1;
            let enough = LONG * longest.min(shortest_oscillation(tolerance, limits));
            !ends && time(span) < enough || b - a < CLOSEST * tolerance
        };
        let halved = Knots(&old).halved(near);
        self.control.clear();
        self.control.extend(halved.control(|span, u: [f64; 3]| -> Point {
            let ([x, y, z], [c0, c1, c2, c3, ..]) = (u.map(|u| u - old[span]), &spans[span].c);
            core::array::from_fn(|i| {
                c0[i]
                    + c1[i] * (x + y + z) / 3.0
                    + c2[i] * (x * y + x * z + y * z) / 3.0
                    + c3[i] * x * y * z
            })
        }));
        self.knots.clone_from(&halved.knots);
        self.sample(way);
        self.twist();
        self.look_at_limits(way);
        halved
    }
}
