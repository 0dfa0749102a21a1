//! What a chain of blocks orders of a turned thread: where the tool belongs at each turn of the
//! spindle.
//!
//! ```text
//!   along a block's way s, after n turns of it:      s(n) = λ·n + κ·n²/2        λ lead, κ its growth, both along the way
//!                          and the other way round:  n(s) = 2s / (λ + √(λ² + 2κs))
//!   its lead there:                                  λ + κ·n
//! ```
//!
//! Blocks that go on in the same direction are one thread. Where the lead steps from one to the
//! next no axis can follow, and a revolution to each side is not judged.
use canon::{Axis, Position, Threading};
use units::{Angle, Length};

/// Turns before a chain's end that are run-out.
pub(super) const RUN_OUT: f64 = 1.0;
/// Turns to each side of a step of the lead that are not judged.
const STEP: f64 = 1.0;
/// A step of the lead by less, mm, is none: rounding it takes less than 0.2 µm.
const SAME_LEAD: f64 = 1e-3;
/// A thread is at least this share of its chain's way along the axis.
const MOST_OF_A_CHAIN: f64 = 0.5;
/// Cosine of the angle between ways that are one line: apart by 1e-5.
const SAME_WAY: f64 = 1.0 - 5e-11;

/// One stretch of a pass as ordered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub(super) op: u32,
    pub(super) from: Position,
    pub(super) order: Threading,
    /// Where the tool stood before it was fed in.
    pub(super) stood: Position,
    /// Turns since the start angle where it begins, and how many it takes.
    pub(super) before: f64,
    pub(super) turns: f64,
    /// The spindle turns backwards.
    pub(super) is_reversed: bool,
    /// The chain has turned back where it begins: in its first revolution the axis is on no helix.
    pub(super) turns_back: bool,
}

impl Stretch {
    pub(super) fn new(op: u32, from: &Position, order: &Threading, stood: Position) -> Self {
        let (from, order) = (*from, *order);
        let (before, turns, is_reversed, turns_back) = (0.0, 0.0, false, false);
        let mut new = Self { op, from, order, stood, before, turns, is_reversed, turns_back };
        new.turns = new.turn_at(new.length());
        new
    }

    /// With a spindle that turns so.
    pub(super) const fn turned(self, is_reversed: bool) -> Self {
        Self { is_reversed, ..self }
    }

    /// Another one goes back over it, along Z, with the hand that this one has not.
    pub(super) fn is_crossed_by(&self, other: &Self) -> bool {
        let hand = |s: &Self| s.way() * if s.is_reversed { -1.0 } else { 1.0 };
        let is_along = self.order.axis == Axis::Z && other.order.axis == Axis::Z;
        is_along && hand(self) * hand(other) < 0.0 && self.common(other) > 0.0
    }

    /// Length along the axis that both pass, mm.
    fn common(&self, other: &Self) -> f64 {
        let ([low, high], [from, to]) = (self.along(), other.along());
        high.min(to) - low.max(from)
    }

    /// Between which places of the axis it lies, mm.
    fn along(&self) -> [f64; 2] {
        let axis = self.order.axis;
        let [a, b] = [self.from.along(axis).value(), self.order.to.along(axis).value()];
        [a.min(b), a.max(b)]
    }

    fn delta(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| (self.order.to.linear[i] - self.from.linear[i]).value())
    }

    /// Of the whole way, mm.
    fn length(&self) -> f64 {
        let [dx, dy, dz] = self.delta();
        dx.hypot(dy).hypot(dz)
    }

    /// Along the thread, mm.
    pub(super) fn way(&self) -> f64 {
        let axis = self.order.axis;
        (self.order.to.along(axis) - self.from.along(axis)).value()
    }

    /// Turns since its beginning after so much of the way, mm; before it begins they are negative.
    fn turn_at(&self, way: f64) -> f64 {
        let (lead, growth) = (self.order.lead.value(), self.order.growth.value());
        2.0 * way / (lead + (lead * lead + 2.0 * growth * way).max(0.0).sqrt())
    }

    /// How far along its way it is after so many turns, mm.
    fn way_at(&self, turn: f64) -> f64 {
        (self.order.lead.value() + self.order.growth.value() / 2.0 * turn) * turn
    }

    /// Lead along the thread's axis after so many turns, signed, mm.
    fn lead_at(&self, turn: f64) -> f64 {
        (self.order.lead.value() + self.order.growth.value() * turn) * self.way() / self.length()
    }

    /// By how much that grows with each revolution, signed, mm.
    pub(super) fn growth(&self) -> f64 {
        self.order.growth.value() * self.way() / self.length()
    }

    /// Lead along the thread's axis where it begins, signed, mm.
    pub(super) fn lead(&self) -> f64 {
        self.lead_at(0.0)
    }

    /// Another pass over the same thread: it has its lead, and half of its way at least.
    pub(super) fn is_under(&self, other: &Self) -> bool {
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-4 * a.abs().max(b.abs());
        let (a, b) = (&self.order, &other.order);
        let ([low, high], [from, to]) = (self.along(), other.along());
        a.axis == b.axis
            && same(a.lead.value(), b.lead.value())
            && same(a.growth.value(), b.growth.value())
            && self.common(other) >= 0.5 * (high - low).max(to - from)
    }

    fn goes_on_as(&self, other: &Self) -> bool {
        let (a, b) = (self.delta(), other.delta());
        let dot: f64 = (0..3).map(|i| a[i] * b[i]).sum();
        dot >= SAME_WAY * self.length() * other.length()
    }
}

/// Stretches one after another that are one thread; true: most of their chain goes elsewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law<'a>(&'a [Stretch], bool);

impl<'a> Law<'a> {
    /// The longest stretch of a pass, and what goes on from it in the same direction, before and
    /// after.
    pub(super) fn of(pass: &'a [Stretch]) -> Option<Self> {
        let longest =
            (0..pass.len()).max_by(|a, b| pass[*a].way().abs().total_cmp(&pass[*b].way().abs()))?;
        let same = |k: usize| pass[k].goes_on_as(&pass[longest]);
        let first = (0..longest).rev().take_while(|k| same(*k)).last().unwrap_or(longest);
        let last = (longest + 1..pass.len()).take_while(|k| same(*k)).last().unwrap_or(longest);
        let way = |stretches: &[Stretch]| stretches.iter().map(|s| s.way().abs()).sum::<f64>();
        let law = &pass[first..=last];
        Some(Self(law, way(law) < MOST_OF_A_CHAIN * way(pass)))
    }

    pub(super) fn first(&self) -> &'a Stretch {
        &self.0[0]
    }

    pub(super) fn last(&self) -> &'a Stretch {
        &self.0[self.0.len() - 1]
    }

    /// The longest of them.
    pub(super) fn main(&self) -> &'a Stretch {
        let longest = |a: &&Stretch, b: &&Stretch| a.way().abs().total_cmp(&b.way().abs());
        self.0.iter().max_by(longest).unwrap_or(self.first())
    }

    pub(super) fn axis(&self) -> Axis {
        self.first().order.axis
    }

    /// +1 or −1: the way along the axis.
    pub(super) fn sign(&self) -> f64 {
        self.first().way().signum()
    }

    /// Turns from its beginning to its end.
    pub(super) fn turns(&self) -> f64 {
        self.last().before + self.last().turns - self.first().before
    }

    /// Turns since its beginning at which the tool belongs at a place of the axis.
    pub(super) fn turn_at(&self, place: f64) -> f64 {
        let along = |stretch: &Stretch| {
            let from = stretch.from.along(stretch.order.axis).value();
            (place - from) / stretch.way() * stretch.length()
        };
        let on = self.0.iter().find(|stretch| along(stretch) <= stretch.length());
        let on = on.unwrap_or(self.last());
        on.before - self.first().before + on.turn_at(along(on))
    }

    /// The stretch at so many turns since the beginning, and its own turns there.
    fn on(&self, turn: f64) -> (&'a Stretch, f64) {
        let turn = turn + self.first().before;
        let on = self.0.iter().find(|stretch| turn <= stretch.before + stretch.turns);
        let on = on.unwrap_or(self.last());
        (on, turn - on.before)
    }

    /// Place along the axis after so many turns, mm.
    pub(super) fn place(&self, turn: f64) -> f64 {
        let (on, turn) = self.on(turn);
        let share = on.way_at(turn) / on.length();
        on.from.along(on.order.axis).value() + share * on.way()
    }

    /// Share of the whole way at a place of the axis.
    pub(super) fn share(&self, place: f64) -> f64 {
        let [from, to] = self.ends().map(|end| end.along(self.axis()).value());
        (place - from) / (to - from)
    }

    /// Where it begins and where it ends.
    pub(super) fn ends(&self) -> [Position; 2] {
        [self.first().from, self.last().order.to]
    }

    /// A step of the lead is near, or where its chain has turned back.
    pub(super) fn is_at_step(&self, turn: f64) -> bool {
        if self.first().turns_back && turn < STEP {
            return true;
        }
        let turn = turn + self.first().before;
        self.0.windows(2).any(|pair| {
            let step = pair[1].lead_at(0.0) - pair[0].lead_at(pair[0].turns);
            step.abs() > SAME_LEAD && (turn - pair[1].before).abs() < STEP
        })
    }

    /// Its lead is not the same everywhere.
    pub(super) fn varies(&self) -> bool {
        self.0.iter().any(|stretch| stretch.order.growth.value() != 0.0)
            || self.0.windows(2).any(|p| (p[1].lead() - p[0].lead()).abs() > SAME_LEAD)
    }

    /// The surface of the first stretch that passes one; `None` where the thread begins and ends in
    /// the material.
    fn passed(&self) -> Option<Length> {
        let inside = |stretch: &&Stretch| {
            stretch.order.surface != stretch.from.along(stretch.order.axis).of_linear()
        };
        self.0.iter().find(inside).map(|stretch| stretch.order.surface)
    }

    /// It runs out of the work, towards its free end: along +Z.
    pub(super) fn runs_out(&self) -> bool {
        self.axis() == Axis::Z && self.sign() > 0.0
    }

    /// Where the material begins, in the direction of the cut: the surface that is passed, or where
    /// a thread begins that runs out of the work.
    pub(super) fn surface(&self) -> Length {
        match self.passed() {
            Some(surface) if !self.runs_out() => surface,
            _ => self.ends()[0].along(self.axis()).of_linear(),
        }
    }

    /// Places of the axis where the material begins and where the thread ends.
    pub(super) fn span(&self) -> [Length; 2] {
        let end = self.passed().filter(|_| self.runs_out());
        [self.surface(), end.unwrap_or(self.ends()[1].along(self.axis()).of_linear())]
    }

    /// The tool is to come out of the air, or to go into it: the thread is to reach the end of the
    /// work.
    pub(super) fn is_open(&self) -> bool {
        self.passed().is_some()
    }

    /// Why nothing is known of the form that a chain of blocks has; `None`: it is a helix or a
    /// spiral.
    pub(super) fn has_no_geometry(&self) -> Option<String> {
        self.1.then(|| {
            "not judged: the blocks of its chain go on in different directions, and no form is known of what they turn together".into()
        })
    }

    /// Its ends are as far from the axis as one another.
    pub(super) fn is_straight(&self) -> bool {
        let [from, to] = self.ends();
        let axis = self.axis().index();
        (0..3).all(|i| i == axis || (to.linear[i] - from.linear[i]).abs() < Length::um(1.0))
    }

    /// How much farther from the axis it is at its end than at its beginning, by its length along
    /// Z (magnitude).
    pub(super) fn slope(&self) -> f64 {
        let [from, to] = self.ends();
        let [x, y] = [0, 1].map(|i| (to.linear[i] - from.linear[i]).value());
        if self.is_straight() {
            0.0
        } else {
            x.hypot(y) / (to.linear[2] - from.linear[2]).value().abs()
        }
    }

    pub(super) fn start_angle(&self) -> Angle {
        self.first().order.start_angle
    }
}
