//! Joining what is programmed into one path.
//!
//! ```text
//!   long ────────┐            long moves keep their middle; each corner between two of them gets one blend;
//!        zone  ╭─╯            where moves are short, one curve is fitted through many of them
//!       ╭──────╯
//!  long │                     P: the joined path is nowhere farther than P from the programmed one
//! ```
//!
//! A corner's slopes differ by |t₁ − t₀| = 2·k (k = sin(θ/2) for two lines that turn by θ). The
//! blend goes from h before the corner to h after it, with the position, slope and bend that the
//! path has there: between two lines as `corner` has it, or as `quintic_blend` where they are
//! short; else it is the polynomial of the fifth degree with a length of 2·h, which passes the
//! corner at a distance of ⅜·h·k, and a jump of the bend by Δ costs about Δ·h²/17 more.
//!
//! A move is long if three blends fit into it at both of its ends, narrow ones where a sharp corner
//! has a choice; a curve that was chopped finely has small corners, which would allow blends much
//! longer than its moves, and therefore none of them is.
use super::corner::Bend;
use super::fastest::Rests;
use super::fit;
use super::joint::{Joint, SHARE, Segment, Waiting, difference, distance, joint};
use alloc::vec::Vec;
use motion::{Curve, Derivatives, Entry, Limits, Line, Piece, Point, Polynomial, Shape, measure};

/// So many moves are fitted at once, and more where the way they go is shorter than starting and
/// stopping take, up to the most.
const ZONE: usize = 256;
const MOST: usize = 2048;
/// Of these, so many wait for what comes next, and so large a share of the way.
const KEPT: usize = 64;
const KEPT_SHARE: f64 = 0.25;
/// A move that begins farther from where the last one ended does not go on from it, mm: the path
/// rests between them.
const SAME_PLACE: f64 = 1e-3;
/// From programmed moves to pieces, as they come. See the module's header.
#[derive(Clone, Debug, Default)]
pub struct Joiner {
    /// From the last long move on: it is the first, its part up to `begun` has been handed on.
    waiting: Vec<Waiting>,
    begun: f64,
    /// Where the path is, if it left the programmed one within a zone.
    at: Option<Derivatives>,
    /// How the next piece joins the one before; `None`: smoothly.
    entry: Option<Entry>,
    /// A line that may still be merged with the next one, and how far off its inner points are.
    line: Option<(Segment, f64)>,
    bend: Bend,
    limits: Limits,
    fitter: fit::Fitter,
}

impl Joiner {
    /// Nothing yet, at rest; curves suit axes with these limits.
    pub fn new(limits: &Limits) -> Self {
        let (entry, bend, limits) = (Some(Entry::Rest), Bend::of(limits), *limits);
        Self { entry, bend, limits, ..Self::default() }
    }

    /// Go on with a move that begins where the last one ended. Pieces that are decided go to
    /// `emit`, in order.
    pub fn push(&mut self, segment: Segment, emit: &mut impl FnMut(Piece)) {
        if let Some((line, off)) = self.line.take() {
            match merged(&line, &segment, off) {
                Some(merged) => {
                    self.line = Some(merged);
                    return;
                }
                None => self.append(&unmerged(&line, off), emit),
            }
        }
        if matches!(segment.curve, Curve::Line(_)) && segment.tolerance > 0.0 {
            self.line = Some((segment, 0.0));
        } else {
            self.append(&segment, emit);
        }
    }

    /// The path stops at the end of the last move, exactly. What comes next begins from rest.
    pub fn finish(&mut self, emit: &mut impl FnMut(Piece)) {
        if let Some((line, off)) = self.line.take() {
            self.append(&unmerged(&line, off), emit);
        }
        if !self.waiting.is_empty() {
            self.decide(&Joint::none(Entry::Rest), emit);
            let last = self.waiting.len() - 1;
            if last > 0 {
                self.zone(last, self.waiting[last].length(), true, emit);
            } else {
                self.middle(self.waiting[0].length(), emit);
            }
            self.waiting.clear();
        }
        self.begun = 0.0;
        self.at = None;
        self.entry = Some(Entry::Rest);
    }

    /// Whether pieces wait for what comes next.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty() && self.line.is_none()
    }

    /// The operation of the first move that waits.
    pub fn next_op(&self) -> Option<u32> {
        let waiting = self.waiting.first().map(|one| one.segment.op);
        waiting.or_else(|| self.line.map(|(segment, _)| segment.op))
    }

    fn append(&mut self, segment: &Segment, emit: &mut impl FnMut(Piece)) {
        let length = segment.curve.length();
        let (start, end) = (segment.curve.at(0.0), segment.curve.at(length));
        let rest = Joint::none(Entry::Rest);
        let meets = |last: &&Waiting| distance(&last.end.q, &start.q) <= SAME_PLACE;
        let joint = (self.waiting.last().filter(meets))
            .map_or(rest, |last| joint(last, segment, &start, self.bend));
        if !self.waiting.is_empty() {
            self.decide(&joint, emit);
            if joint.reach == 0.0 {
                self.meet(joint.entry, emit);
            }
        }
        let way = self.waiting.last().map_or(0.0, |last| last.way) + length;
        self.waiting.push(Waiting { segment: *segment, start, end, joint, way });
        let (count, gone) = (self.waiting.len(), way - self.waiting[0].way);
        if count > MOST || count > ZONE && gone > self.runway(segment) {
            self.part(emit);
        }
    }

    /// How far it takes to start and to stop.
    fn runway(&self, segment: &Segment) -> f64 {
        let bounds = if segment.rapid { &self.limits.rapid } else { &self.limits.feed };
        let least = |limits: &Point| limits.iter().fold(f64::INFINITY, |m: f64, x| m.min(*x));
        let speed = segment.feed.min(least(&bounds.speed));
        speed * speed / least(&bounds.accel)
    }

    /// The last move's both joints are known: if it is long, what lies before is decided.
    fn decide(&mut self, after: &Joint, emit: &mut impl FnMut(Piece)) {
        let last = self.waiting.len() - 1;
        let (length, before) = (self.waiting[last].length(), self.waiting[last].joint);
        if last == 0 || length < before.claim() + after.claim() {
            return;
        }
        let begins = if last == 1 { before.reach } else { before.aside(length - after.reach) };
        self.zone(last, begins, false, emit);
        self.waiting.drain(..last);
        self.begun = begins;
        self.at = None;
    }

    /// No blend with the next move: hand on all that waits.
    fn meet(&mut self, entry: Entry, emit: &mut impl FnMut(Piece)) {
        let last = self.waiting.len() - 1;
        let length = self.waiting[last].length();
        if last > 0 {
            self.zone(last, length, entry == Entry::Rest, emit);
        } else {
            self.middle(length, emit);
        }
        self.waiting.clear();
        (self.begun, self.at, self.entry) = (0.0, None, (entry != Entry::Smooth).then_some(entry));
    }

    /// Hand on the first move as it is, up to a parameter.
    fn middle(&mut self, to: f64, emit: &mut impl FnMut(Piece)) {
        let first = self.waiting[0].segment;
        if to > self.begun {
            let (begin, length) = (self.begun, to - self.begun);
            self.hand_on(&first, &first.curve, (begin, length), emit);
        }
        self.begun = to;
    }

    fn hand_on(
        &mut self,
        of: &Segment,
        curve: &Curve,
        (begin, length): (f64, f64),
        emit: &mut impl FnMut(Piece),
    ) {
        let entry = self.entry.take().unwrap_or(Entry::Smooth);
        let Segment { feed, rapid, op, line, .. } = *of;
        emit(Piece { curve: *curve, begin, length, feed, rapid, entry, op, line });
    }

    /// From the first move to so far into move `last`, to rest there or not.
    fn zone(&mut self, last: usize, end: f64, rest: bool, emit: &mut impl FnMut(Piece)) {
        let length = self.waiting[0].length();
        let joint = self.waiting[1].joint;
        let reach = joint.reach;
        let whole = end >= self.waiting[last].length();
        if self.at.is_none() && length - self.begun > reach {
            // of a short first move, too, keep what the blend leaves
            let leaves = if last == 1 { reach } else { joint.aside(length - self.begun) };
            if last == 1 || length - leaves - self.begun > joint.narrow {
                self.middle(length - leaves, emit);
            }
        }
        let meets = |at: f64| (at - reach).abs() < 1e-9;
        if last == 1 && self.at.is_none() && !whole && meets(end) && meets(length - self.begun) {
            return self.corner(end, emit);
        }
        let from = self.at.unwrap_or_else(|| self.waiting[0].segment.curve.at(self.begun));
        let to = self.waiting[last].segment.curve.at(end);
        let rests = Rests { begin: self.entry == Some(Entry::Rest), end: rest };
        let limits = (&self.limits, rests);
        self.fitter.fit(&self.waiting[..=last], self.begun, end, &from, &to, limits);
        for span in 0..self.fitter.spans() {
            let (of, curve) = self.fitter.span(span, &self.waiting);
            self.hand_on(&of, &Curve::Polynomial(curve), (0.0, curve.length), emit);
        }
    }

    /// One blend between two long moves.
    fn corner(&mut self, reach: f64, emit: &mut impl FnMut(Piece)) {
        let [before, after] = [self.waiting[0], self.waiting[1]];
        let [first, second] = sides(&before.segment, &after.segment);
        if let Some(corner) = after.joint.corner {
            let slopes = (&before.end.q1, &after.start.q1);
            corner.pieces(&after.start.q, slopes, |from, to, length, is_before| {
                let curve = Polynomial::between(from, to, length);
                let of = if is_before { &first } else { &second };
                self.hand_on(of, &Curve::Polynomial(curve), (0.0, length), emit);
            });
            return;
        }
        let (length, mut h) = (before.length(), reach);
        let tolerance = after.joint.tolerance * SHARE;
        let curve = loop {
            let (from, to) = (before.segment.curve.at(length - h), after.segment.curve.at(h));
            let blend = Polynomial::between(&from, &to, after.joint.ratio * h);
            let straight =
                [before, after].iter().all(|of| matches!(of.segment.curve, Curve::Line(_)));
            if straight || far(&blend, &before, &after, h) <= tolerance {
                break blend;
            }
            h *= 0.8;
        };
        self.rest_of(&before, (length - reach, reach - h), emit);
        let (length, curve) = (curve.length, Curve::Polynomial(curve));
        if first.feed == second.feed && first.rapid == second.rapid {
            self.hand_on(&first, &curve, (0.0, length), emit);
        } else {
            self.hand_on(&first, &curve, (0.0, length / 2.0), emit);
            self.hand_on(&second, &curve, (length / 2.0, length / 2.0), emit);
        }
        self.rest_of(&after, (h, reach - h), emit);
    }

    /// What a blend that is shorter than it may be leaves of a move.
    fn rest_of(&mut self, of: &Waiting, (begin, length): (f64, f64), emit: &mut impl FnMut(Piece)) {
        if length > 1e-9 {
            self.hand_on(&of.segment, &of.segment.curve, (begin, length), emit);
        }
    }

    /// A long row of short moves: hand on the first part of the curve through them.
    fn part(&mut self, emit: &mut impl FnMut(Piece)) {
        let last = self.waiting.len() - 2; // the last one's end is not known to be good
        let from = self.at.unwrap_or_else(|| self.waiting[0].segment.curve.at(self.begun));
        let end = self.waiting[last].length();
        let to = self.waiting[last].end;
        let rests = Rests { begin: self.entry == Some(Entry::Rest), end: false };
        let limits = (&self.limits, rests);
        self.fitter.fit(&self.waiting[..=last], self.begun, end, &from, &to, limits);
        let keep = self.fitter.start_of(last + 1 - KEPT.min(last));
        let keep = keep.min((1.0 - KEPT_SHARE) * self.fitter.total());
        let mut count = 0;
        while count < self.fitter.spans() && self.fitter.knot(count + 1) < keep {
            count += 1;
        }
        // something must go: else the first moves would wait for ever
        let count = count.max(self.fitter.spans() / 2).max(1);
        let mut at = from;
        for span in 0..count {
            let (of, curve) = self.fitter.span(span, &self.waiting);
            at = curve.at(curve.length);
            self.hand_on(&of, &Curve::Polynomial(curve), (0.0, curve.length), emit);
        }
        let (done, begun) = self.fitter.place(self.fitter.knot(count));
        self.waiting.drain(..done);
        self.begun = begun;
        self.at = Some(at);
    }
}

/// What a blend of two moves serves up to its middle, and behind it: each half is run as the move
/// is that it lies along.
fn sides(before: &Segment, after: &Segment) -> [Segment; 2] {
    let Segment { feed, rapid, .. } = *after;
    [*before, Segment { feed, rapid, ..*before }]
}

/// Distance of a blend from the two moves that it joins.
fn far(blend: &Polynomial, before: &Waiting, after: &Waiting, h: f64) -> f64 {
    let length = before.length();
    (1..16)
        .map(|n| {
            let s = f64::from(n) / 8.0 * h;
            let p = if s < h {
                before.segment.curve.at(length - h + s).q
            } else {
                after.segment.curve.at(s - h).q
            };
            distance(&blend.position(s), &p)
        })
        .fold(0.0, f64::max)
}

/// What merging has left of Q is P's again.
fn unmerged(line: &Segment, off: f64) -> Segment {
    Segment { tolerance: line.tolerance + (line.merge - off).max(0.0), ..*line }
}

/// Two lines as one, if what lies between them is near enough to it.
fn merged(first: &Segment, second: &Segment, off: f64) -> Option<(Segment, f64)> {
    let (Curve::Line(a), Curve::Line(b)) = (&first.curve, &second.curve) else { return None };
    let same = first.feed == second.feed
        && first.rapid == second.rapid
        && first.tolerance == second.tolerance
        && first.merge == second.merge;
    if !same {
        return None;
    }
    let way = difference(&b.to, &a.from);
    let length = measure(&way);
    let whole = a.length + b.length;
    if length < 0.5 * whole {
        return None;
    }
    let f = a.length / whole;
    let between: Point = core::array::from_fn(|i| a.from[i] + f * way[i]);
    let off = off + distance(&between, &a.to);
    let line = Line { from: a.from, to: b.to, length };
    (off <= first.merge).then_some((Segment { curve: Curve::Line(line), ..*first }, off))
}
