//! The blend of a corner of two lines as one polynomial, where they are short and jerk is limited.
//!
//! ```text
//!          ·──────────────     q(s) = corner − y(L−s)·t₀ + y(s)·t₁,   0 ≤ s ≤ L = ρ·h
//!        ╱  m·2k·h             y the polynomial of the fifth degree from 0 to h with slopes 0 and 1, no bend at either end
//!       ╱│
//!   ───╲╱ w·h·sin θ            in the middle  y = m·h,  m = (16 − 5·ρ)/32;   at its lowest  y = −w·h
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | t₀, t₁ | slopes before and after: \|t₁ − t₀\| = 2·k, k = sin(θ/2) |
//! | h | reach along both moves |
//! | ρ | length of the blend's parameter, over h |
//!
//! With ρ = 2 the path runs on the inner side alone. A longer parameter lets it swing out to the
//! other side before it turns, so that it may begin to turn much sooner within the same distance: h
//! is largest where both sides are used alike. Its bend grows more gently then, too, which is what
//! jerk asks for. Corners of a few degrees are passed nearly at the feed, which ṡ may not exceed;
//! there ρ = 2 is faster, as the path is hardly longer than its chord.

use super::corner::off;

/// Corners with a smaller k have ρ = 2: 23°.
const SHALLOW: f64 = 0.2;

/// Parameter of a blend that stays on the inner side.
pub(crate) const INNER: f64 = 2.0;

/// From here on the path swings out as far as it may, up to where it would pass the corner itself.
const SWINGING: [f64; 2] = [3.0, 3.2];

/// How often a bracket of ρ is halved.
const HALVINGS: usize = 24;

/// Reach and shape of a blend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct QuinticBlend {
    /// h.
    pub(crate) reach: f64,
    /// ρ.
    pub(crate) ratio: f64,
}

impl QuinticBlend {
    /// Between two lines whose slopes differ by 2·k, within a distance of `p`; `side` is how far
    /// from a line a step along the other one leads at most. It swings out as far as a reach of
    /// `room` lets it.
    pub(crate) fn of(k: f64, side: f64, p: f64, room: f64) -> Self {
        let off = off(k, side);
        let with = |ratio: f64| {
            let most = (off * middle(ratio)).max(lowest(ratio) * side);
            Self { reach: p / most, ratio }
        };
        if k < SHALLOW || Self::narrow(off, p) >= room {
            return Self { reach: Self::narrow(off, p), ratio: INNER };
        }
        let both = with(halved(SWINGING, |ratio| off * middle(ratio) > lowest(ratio) * side));
        if both.reach <= room {
            return both;
        }
        with(halved([INNER, both.ratio], |ratio| with(ratio).reach <= room))
    }

    /// Reach of one on the inner side alone, 3/16·h·max(sin θ, √2·k) = P.
    pub(crate) fn narrow(off: f64, p: f64) -> f64 {
        p / (off * middle(INNER))
    }
}

/// Where what holds at the lower end holds no longer.
fn halved([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let ratio = f64::midpoint(low, high);
        if holds(ratio) { low = ratio } else { high = ratio }
    }
    low
}

/// m.
fn middle(ratio: f64) -> f64 {
    (16.0 - 5.0 * ratio) / 32.0
}

/// w; zero where it does not swing out: y′ = s²·(3·c₃ + 4·c₄·s + 5·c₅·s²).
fn lowest(ratio: f64) -> f64 {
    let c3 = 10.0 - 4.0 * ratio;
    if c3 >= 0.0 {
        return 0.0;
    }
    // over s/L; each coefficient of y over h
    let (c4, c5) = (7.0 * ratio - 15.0, 6.0 - 3.0 * ratio);
    let root = libm::sqrt((16.0 * c4 * c4 - 60.0 * c3 * c5).max(0.0));
    let s = -6.0 * c3 / (4.0 * c4 + root);
    -(s * s * s * (c3 + s * (c4 + s * c5)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AXES, Derivatives, Shape};
    use motion::Polynomial;

    /// sin 45°.
    const K: f64 = core::f64::consts::FRAC_1_SQRT_2;

    /// A right angle at the origin, from −X to +Y.
    fn blend(blended: QuinticBlend) -> Polynomial {
        let at = |q: [f64; 2], q1: [f64; 2]| {
            let wide =
                |p: [f64; 2]| core::array::from_fn(|k: usize| if k < 2 { p[k] } else { 0.0 });
            Derivatives { q: wide(q), q1: wide(q1), q2: [0.0; AXES], q3: [0.0; AXES] }
        };
        let h = blended.reach;
        Polynomial::between(
            &at([-h, 0.0], [1.0, 0.0]),
            &at([0.0, h], [0.0, 1.0]),
            blended.ratio * h,
        )
    }

    #[test]
    fn both_sides_of_a_right_angle_are_used_alike() {
        let path = blend(QuinticBlend::of(K, 1.0, 0.01, 10.0));
        let middle = path.at(path.length() / 2.0).q;
        assert!((middle[0] + 0.01).abs() < 1e-6 && (middle[1] - 0.01).abs() < 1e-6, "{middle:?}");
        let least = (0..=1000)
            .map(|n| path.at(path.length() * f64::from(n) / 1000.0).q[1])
            .fold(0.0, f64::min);
        assert!((least + 0.01).abs() < 1e-6, "{least}");
    }

    #[test]
    fn where_there_is_no_room_the_blend_keeps_to_the_inner_side() {
        let blended = QuinticBlend::of(K, 1.0, 0.01, 0.0);
        // 3/16·h from both lines
        assert_eq!(blended.ratio, INNER);
        assert!((blended.reach - 0.01 * 16.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn it_reaches_as_far_as_there_is_room() {
        for room in [0.06, 0.1, 0.2, 0.3] {
            let blended = QuinticBlend::of(K, 1.0, 0.01, room);
            assert!((blended.reach - room).abs() < 1e-4 * room, "{blended:?} for {room}");
        }
    }
}
