//! The blend of a corner of two lines.
//!
//! ```text
//!            ╱·──────────────     q = corner + α·t₀ + β·t₁     β = B(t), α = −B(1 − t), 0 ≤ t ≤ 1
//!          ╱ m·2k                 B = −w + g·b(t),   b″ = t/r up to 1,   B(½) = m
//!   ──────╲╱ w·sin θ              before and after it, over σ·w: from the line to so far outside of it, and back
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | t₀, t₁ | slopes before and after: \|t₁ − t₀\| = 2·k, k = sin(θ/2) |
//! | t | time of the turn, over its whole |
//! | r | part of it in which an acceleration grows |
//! | w | swing to the outer side |
//! | m | way along both lines in the middle |
//!
//! One axis comes to rest while the other one leaves it: how long both may do so at once is the
//! time that a blend saves over a stop. b is how an axis leaves rest: with an acceleration that is
//! there at once, or one that grows all the time where jerk is limited. Swinging out before it
//! turns lets the path begin to turn much sooner within the same distance. In its middle it is P
//! from both lines, m·sin θ = P, but no farther from an acute corner than from a right angle's,
//! √2·P: m·2·k = √2·P.
//!
//! The pieces run by s, with ds/dt = dα/dt + dβ/dt: slope and bend are those of the lines at both
//! ends, and in the middle s runs evenly with t.
use motion::{AXES, Derivatives, Limits, Point};

/// How the bend of a corner grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Bend {
    /// In a small part of the turn: for axes without a limit of jerk.
    Quick,
    /// All along the turn: for axes with one.
    #[default]
    Even,
}

impl Bend {
    /// What suits axes with these limits.
    pub(crate) fn of(limits: &Limits) -> Self {
        if limits.has_jerk() { Self::Even } else { Self::Quick }
    }

    /// r.
    fn ramp(self) -> f64 {
        match self {
            Self::Quick => QUICK,
            Self::Even => 1.0,
        }
    }

    /// σ, as short as it may be and as long as is of use: with the longer one, at the speeds there
    /// are so near a stop, the swing takes less than the axes can do.
    fn lead(self) -> [f64; 2] {
        match self {
            Self::Quick => [35.0, 70.0],
            Self::Even => [130.0, 225.0],
        }
    }

    /// A turn reaches no farther than so much of the shorter move: else its axes would, on their
    /// way to the next rest, have to slow down again within it.
    fn part(self) -> f64 {
        match self {
            Self::Quick => 1.0,
            Self::Even => 0.05,
        }
    }

    /// b, b′, b″.
    fn leaving(self, t: f64) -> [f64; 3] {
        let r = self.ramp();
        if t <= r {
            return [t * t * t / (6.0 * r), t * t / (2.0 * r), t / r];
        }
        [t * t / 2.0 - r * t / 2.0 + r * r / 6.0, t - r / 2.0, 1.0]
    }

    /// Where the pieces of a turn meet.
    fn knots(self) -> &'static [f64] {
        match self {
            Self::Quick => &[0.0, QUICK, MIDDLE, 1.0 - QUICK, 1.0],
            Self::Even => &[0.0, 0.1, 0.27, MIDDLE, 0.73, 0.9, 1.0],
        }
    }
}

/// Half of the time of a turn: pieces meet there.
const MIDDLE: f64 = 0.5;
/// r of the quick one.
const QUICK: f64 = 0.02;

/// A blend reaches no farther than the shorter move over this: two of them find place on a move.
pub(crate) const ROOM: f64 = 2.04;

/// A corner is passed no farther away than so many tolerances: as a right angle is, within P of
/// both lines.
pub(crate) const DEEPEST: f64 = core::f64::consts::SQRT_2;

/// max(sin θ, √2·k): a place m along both lines is so many m from them, or from their corner over
/// [`DEEPEST`].
pub(crate) fn off(k: f64, side: f64) -> f64 {
    side.max(2.0 * k / DEEPEST)
}

/// Shape of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// w.
    swing: f64,
    /// g.
    growth: f64,
    /// σ·w.
    lead: f64,
    bend: Bend,
}

impl Corner {
    /// Between two lines whose slopes differ by 2·k, within a distance of `p`; `side` is how far
    /// from a line a step along the other one leads at most, `shorter` the length of the shorter
    /// line. It swings out as far as there is room; where jerk is limited, as far as it may, or not
    /// at all. `None`: the lines are too short for it.
    pub(crate) fn of(k: f64, side: f64, p: f64, shorter: f64, bend: Bend) -> Option<Self> {
        let (half, whole) = (bend.leaving(0.5)[0], bend.leaving(1.0)[0]);
        let (m, over) = (p / off(k, side), whole / half);
        let (room, most) = (shorter / ROOM - m * over, p.min(p / side));
        // reach = (w + m)·over − w + σ·w
        let [short, long] = bend.lead().map(|lead| lead + over - 1.0);
        if m * over > bend.part() * shorter || bend == Bend::Even && room < short * most {
            return None;
        }
        let along = (room / most).clamp(short, long);
        let swing = (room / along).clamp(0.0, most);
        let lead = (along - over + 1.0) * swing;
        Some(Self { swing, growth: (swing + m) / half, lead, bend })
    }

    /// How far it reaches along both lines.
    pub(crate) fn reach(&self) -> f64 {
        self.b(1.0)[0] + self.lead
    }

    /// B, B′, B″.
    fn b(&self, t: f64) -> [f64; 3] {
        let [b, first, second] = self.bend.leaving(t);
        [self.growth * b - self.swing, self.growth * first, self.growth * second]
    }

    /// Its pieces, by where they begin and end, how long they are, and whether they come before its
    /// middle: at the corner `at`, with slopes `t0` and `t1`.
    pub(crate) fn pieces(
        &self,
        at: &Point,
        (t0, t1): (&Point, &Point),
        mut give: impl FnMut(&Derivatives, &Derivatives, f64, bool),
    ) {
        // from shares of both slopes
        let place = |shares: [[f64; 2]; 3]| {
            let of = |[a, b]: [f64; 2]| core::array::from_fn(|i| a * t0[i] + b * t1[i]);
            let q: Point = of(shares[0]);
            let q = core::array::from_fn(|i| at[i] + q[i]);
            Derivatives { q, q1: of(shares[1]), q2: of(shares[2]), q3: [0.0; AXES] }
        };
        let off = [0.0; 2];
        let mut from = place([[-self.reach(), 0.0], [1.0, 0.0], off]);
        let mut go = |to: Derivatives, length: f64, is_before: bool| {
            if length > 0.0 {
                give(&from, &to, length, is_before);
            }
            from = to;
        };
        go(place(self.turning(0.0)), self.lead, true);
        for pair in self.bend.knots().windows(2) {
            let length = self.s(pair[1]) - self.s(pair[0]);
            go(place(self.turning(pair[1])), length, pair[1] <= MIDDLE);
        }
        go(place([[0.0, self.reach()], [0.0, 1.0], off]), self.lead, false);
    }

    /// α and β in the turn, with their derivatives by s.
    fn turning(&self, t: f64) -> [[f64; 2]; 3] {
        let ([a, a1, a2], [b, b1, b2]) = (self.b(1.0 - t), self.b(t));
        let pace = a1 + b1;
        let slope = [a1 / pace, b1 / pace];
        let more = b2 - a2;
        let bend =
            [(-a2 - slope[0] * more) / (pace * pace), (b2 - slope[1] * more) / (pace * pace)];
        [[-a, b], slope, bend]
    }

    /// s at a time of the turn.
    fn s(&self, t: f64) -> f64 {
        self.b(t)[0] - self.b(1.0 - t)[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;
    use alloc::vec::Vec;
    use motion::Polynomial;

    /// A right angle at the origin, from −X to +Y.
    fn blend(corner: Corner) -> Vec<Polynomial> {
        let along = |axis: usize| core::array::from_fn(|i| f64::from(u8::from(i == axis)));
        let mut pieces = Vec::new();
        corner.pieces(&[0.0; AXES], (&along(0), &along(1)), |from, to, length, _| {
            pieces.push(Polynomial::between(from, to, length));
        });
        pieces
    }

    fn right_angle(room: f64, bend: Bend) -> Corner {
        let shorter = ROOM * room;
        Corner::of(core::f64::consts::FRAC_1_SQRT_2, 1.0, 0.01, shorter, bend).expect("long lines")
    }

    #[test]
    fn both_sides_of_a_right_angle_are_used() {
        for bend in [Bend::Quick, Bend::Even] {
            let corner = right_angle(10.0, bend);
            let pieces = blend(corner);
            let points: Vec<Point> = pieces
                .iter()
                .flat_map(|piece| {
                    (0..=200).map(|n| piece.position(piece.length() * f64::from(n) / 200.0))
                })
                .collect();
            let inside = points.iter().map(|q| q[1].min(-q[0])).fold(0.0, f64::max);
            assert!((inside - 0.01).abs() < 1e-6, "is {inside} from both lines");
            let least = points.iter().map(|q| q[1]).fold(0.0, f64::min);
            assert!((least + 0.01).abs() < 1e-6, "swings out by {least}");
            let first = points[0];
            assert!((first[0] + corner.reach()).abs() < 1e-12 && first[1].abs() < 1e-12);
        }
    }

    #[test]
    fn where_there_is_no_room_the_blend_keeps_to_the_inner_side() {
        assert_eq!(right_angle(0.03, Bend::Quick).swing, 0.0);
        assert_eq!(blend(right_angle(0.03, Bend::Quick)).len(), 4);
        let short = Corner::of(core::f64::consts::FRAC_1_SQRT_2, 1.0, 0.01, 2.8, Bend::Even);
        assert_eq!(short, None, "130·P and more to either side");
    }

    #[test]
    fn a_little_more_room_is_a_little_more_swing_and_then_a_longer_way() {
        let corner = |room: f64| right_angle(room, Bend::Quick);
        let (a, b, c) = (corner(0.2), corner(0.21), corner(0.5));
        assert!(a.swing > 0.0 && a.swing < b.swing && (a.reach() - 0.2).abs() < 1e-12);
        assert!((a.lead - 35.0 * a.swing).abs() < 1e-12, "{a:?}");
        assert!((c.swing - 0.01).abs() < 1e-12 && c.lead > 0.4, "{c:?}");
        assert!((c.reach() - 0.5).abs() < 1e-12);
    }

    #[test]
    fn its_pieces_go_on_in_slope_and_bend() {
        for (room, bend) in [(0.1, Bend::Quick), (0.3, Bend::Quick), (10.0, Bend::Even)] {
            for pair in blend(right_angle(room, bend)).windows(2) {
                let (a, b) = (pair[0].at(pair[0].length()), pair[1].at(0.0));
                for i in 0..2 {
                    assert!((a.q[i] - b.q[i]).abs() < 1e-12 && (a.q1[i] - b.q1[i]).abs() < 1e-9);
                    assert!((a.q2[i] - b.q2[i]).abs() < 1e-6);
                }
            }
        }
    }
}
