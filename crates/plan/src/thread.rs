//! Turned threads: where the tool is for each angle of the spindle.
//!
//! A chain of stretches is one function of the turns φ since the spindle passed the start angle: straight lines with
//! one slope each, mm per revolution, and a corner wherever the slope changes. At both ends of the chain the slope
//! changes from and to zero.
//!
//! ```text
//!   q ▲              ●━━━━━━━  stands at the end          a corner is rounded over ±h turns about it:
//!     │            ╱ ▲
//!     │          ╱   corner of rate − 0                   q = line before + (difference of slopes)·R(φ − φ_corner)
//!     │    ●───╱     (and its h, early enough)
//!     │  ╱                                                R(x) = h·(3/16 + u/2 + 3u²/8 − u⁴/16),  u = x/h ∈ [−1, 1]
//!     │━● ◄ start: begins h turns before φ = 0                   0 before, x after; R″ = ¾·(1 − u²)/h
//!     └─┴────┴─────► φ
//! ```
//!
//! So the tool is exactly on `start + lead·φ` outside the corners, whatever the speed: passes over a thread find the
//! groove of the pass before, at the same speed or another. The run-in takes h·lead of path behind the start.
//!
//! With n revolutions a second and a slope that changes by Δ, the corner costs an acceleration of ¾·Δ·n²/h and a jerk
//! of 3/2·Δ·n³/h²; the planner makes h long enough for both.
use units::Angle;

/// The axes that thread: X, Y, Z.
pub const THREADING_AXES: usize = 3;

/// Coordinates of the axes that thread, mm, or their derivatives by turns.
pub(crate) type Vector = [f64; THREADING_AXES];

/// One straight stretch of a turned thread, with the corners at both ends of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreadStretch {
    /// The spindle that leads.
    pub spindle: u8,
    /// Spindle angle at which the chain starts; `None`: it goes on from the stretch before.
    pub start: Option<Angle>,
    /// The chain ends with this one.
    pub ends: bool,
    /// Where the corners of the programmed path are, mm.
    pub from: Vector,
    /// Likewise.
    pub to: Vector,
    /// Turns since the start angle at the first corner.
    pub from_turn: f64,
    /// Likewise at the second.
    pub to_turn: f64,
    /// The corner at the beginning.
    pub entry: Corner,
    /// The corner at the end.
    pub exit: Corner,
}

/// A corner, as the stretch next to it needs to know it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// Slope on the other side of it, mm/rev.
    pub beyond: Vector,
    /// It is rounded over so many turns to each side.
    pub half: f64,
}

/// Where the tool is, and its derivatives by turns.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OnThread {
    /// mm.
    pub q: Vector,
    /// mm/rev.
    pub rate: Vector,
    /// mm/rev².
    pub bend: Vector,
    /// mm/rev³.
    pub third: Vector,
}

impl ThreadStretch {
    /// Slope of the straight line, mm/rev.
    pub fn slope(&self) -> Vector {
        let turns = self.to_turn - self.from_turn;
        core::array::from_fn(|i| (self.to[i] - self.from[i]) / turns)
    }

    /// Turns at which it begins: a chain begins before its start angle, with the run-in.
    pub fn begins(&self) -> f64 {
        if self.start.is_some() { self.from_turn - self.entry.half } else { self.from_turn }
    }

    /// Turns at which it is over.
    pub fn is_over_at(&self) -> f64 {
        if self.ends { self.to_turn + self.exit.half } else { self.to_turn }
    }

    /// Where the tool is at so many turns since the start angle.
    pub fn at(&self, turn: f64) -> OnThread {
        let slope = self.slope();
        let (x, y) = (turn - self.from_turn, turn - self.to_turn);
        let (into, out_of) = (rounded(x, self.entry.half), rounded(y, self.exit.half));
        let mut on = OnThread::default();
        for (i, slope) in slope.into_iter().enumerate() {
            let before = self.entry.beyond[i];
            let (first, second) = (slope - before, self.exit.beyond[i] - slope);
            let [q, rate, bend, third] =
                core::array::from_fn(|k| first * into[k] + second * out_of[k]);
            on.q[i] = self.from[i] + before * x + q;
            on.rate[i] = before + rate;
            on.bend[i] = bend;
            on.third[i] = third;
        }
        on
    }
}

impl Corner {
    /// Turns to each side of a corner over which a slope may change by `change`, mm/rev, at `n` rev/s, where an axis
    /// is limited to `accel`, mm/s², and `jerk`, mm/s³.
    pub(crate) fn half(change: f64, n: f64, accel: f64, jerk: f64) -> f64 {
        let change = change.abs();
        if change == 0.0 {
            return 0.0;
        }
        let by_accel = 0.75 * change * n * n / accel;
        by_accel.max(libm::sqrt(1.5 * change * n * n * n / jerk))
    }
}

/// R(x) of the module's header and its derivatives: value, slope, second, third.
fn rounded(x: f64, half: f64) -> [f64; 4] {
    if x <= -half {
        return [0.0; 4];
    }
    if x >= half {
        return [x, 1.0, 0.0, 0.0];
    }
    let u = x / half;
    let squared = u * u;
    [
        half * (3.0 / 16.0 + u / 2.0 + 3.0 / 8.0 * squared - squared * squared / 16.0),
        0.5 + 0.75 * u - 0.25 * u * squared,
        0.75 * (1.0 - squared) / half,
        -1.5 * u / (half * half),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A thread of 2 mm from Z5 to Z−20, out along a taper of 45°.
    fn chain(half: [f64; 3]) -> [ThreadStretch; 2] {
        let (along, out) = ([0.0, 0.0, -2.0], [2.0, 0.0, -2.0]);
        let middle = [-10.0, 0.0, -20.0];
        let thread = ThreadStretch {
            spindle: 0,
            start: Some(Angle::ZERO),
            ends: false,
            from: [-10.0, 0.0, 5.0],
            to: middle,
            from_turn: 0.0,
            to_turn: 12.5,
            entry: Corner { beyond: [0.0; 3], half: half[0] },
            exit: Corner { beyond: out, half: half[1] },
        };
        let exit = ThreadStretch {
            start: None,
            ends: true,
            from: middle,
            to: [-8.0, 0.0, -22.0],
            from_turn: 12.5,
            to_turn: 13.5,
            entry: Corner { beyond: along, half: half[1] },
            exit: Corner { beyond: [0.0; 3], half: half[2] },
            ..thread
        };
        [thread, exit]
    }

    #[test]
    fn outside_the_corners_the_tool_is_on_the_helix_through_the_start_at_the_start_angle() {
        let [thread, exit] = chain([0.8, 0.1, 0.2]);
        for turn in [0.8, 3.0, 12.4] {
            let on = thread.at(turn);
            assert!((on.q[2] - (5.0 - 2.0 * turn)).abs() < 1e-12 && on.q[0] == -10.0, "{on:?}");
            assert!(on.bend.iter().all(|bend| bend.abs() < 1e-9));
        }
        assert!((exit.at(13.0).q[0] - -9.0).abs() < 1e-12);
        let ends =
            [(exit.at(exit.is_over_at()), exit.to), (thread.at(thread.begins()), thread.from)];
        for (on, corner) in ends {
            assert!((0..3).all(|i| (on.q[i] - corner[i]).abs() < 1e-12), "{on:?}");
        }
    }

    proptest! {
        /// Position, slope and bend have no step anywhere, and the next one is their derivative.
        #[test]
        fn a_chain_is_smooth_and_its_derivatives_are_its_own(turn in -0.9_f64..13.75) {
            let chain = chain([0.8, 0.1, 0.2]);
            let at = |turn: f64| if turn < 12.5 { chain[0].at(turn) } else { chain[1].at(turn) };
            let step = 1e-5;
            let (before, now, after) = (at(turn - step), at(turn), at(turn + step));
            for i in 0..3 {
                let central = |of: fn(&OnThread) -> Vector| (of(&after)[i] - of(&before)[i]) / (2.0 * step);
                prop_assert!((central(|on| on.q) - now.rate[i]).abs() < 1e-7);
                prop_assert!((central(|on| on.rate) - now.bend[i]).abs() < 3e-3);
            }
        }

        /// The acceleration and the jerk of a corner are what the planner has made it long enough for.
        #[test]
        fn a_corner_keeps_the_limits(change in 0.1_f64..5.0, n in 1.0_f64..60.0, at in -1.0_f64..1.0) {
            let (accel, jerk) = (4e3, 3e5);
            let half = Corner::half(change, n, accel, jerk);
            let [_, _, bend, third] = rounded(at * half, half);
            prop_assert!(change * bend * n * n <= accel * (1.0 + 1e-9));
            prop_assert!(change * third.abs() * n * n * n <= jerk * (1.0 + 1e-9));
        }
    }
}
