//! Turned threads: where the tool is for each angle of the spindle.
//!
//! A chain of stretches is one function of the turns φ since the spindle passed the start angle.
//! Each stretch runs along one straight line, `s·x + b·x²/2` along it in the x turns since it
//! began: its slope s, mm per revolution, grows by its bend b in each (zero where the lead is
//! constant). There is a corner wherever slope or bend change; at both ends of the chain they
//! change from and to zero.
//!
//! ```text
//!   q ▲              ●━━━━━━━  stands at the end          a corner is rounded over ±h turns about it:
//!     │            ╱ ▲
//!     │          ╱   corner of rate − 0                   q = law before + Δs·R(x) + Δb·P(x),  x = φ − φ_corner
//!     │    ●───╱     (and its h, early enough)
//!     │  ╱                                                R(x) = h·(3/16 + u/2 + 3u²/8 − u⁴/16)      u = x/h ∈ [−1, 1]
//!     │━● ◄ start: begins h turns before φ = 0            P(x) = h²·(3u/32 + u²/4 + 3u³/16 − u⁵/32)
//!     └─┴────┴─────► φ                                    both 0 before; x and x²/2 after
//! ```
//!
//! R″ = ¾·(1 − u²)/h, and P″ = ½ + 9u/8 − 5u³/8 goes from 0 to 1, by 0.081 beyond both on its way:
//! a smooth step that does not would leave the law after it shifted.
//!
//! So the tool is exactly on `start + lead·φ + growth·φ²/2` outside the corners, whatever the
//! speed: passes over a thread find the groove of the pass before, at the same speed or another.
//! The run-in takes h·lead of path behind the start.
//!
//! With n revolutions a second the corner costs an acceleration of at most ¾·|Δs|·n²/h +
//! (|b| + 0.081·|Δb|)·n², b the larger of both, and a jerk of at most 3/2·|Δs|·n³/h² +
//! 9/8·|Δb|·n³/h; the planner makes h long enough for both.
use units::Angle;

/// The axes that thread: X, Y, Z.
pub const THREADING_AXES: usize = 3;
/// Coordinates of the axes that thread, mm, or their derivatives by turns.
pub type Vector = [f64; THREADING_AXES];

/// One stretch of a turned thread, straight in space, with the corners at both ends of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// By how much the slope grows with each revolution, mm/rev².
    pub bend: Vector,
    /// The corner at the beginning.
    pub entry: Corner,
    /// The corner at the end.
    pub exit: Corner,
}

/// A corner, as the stretch next to it needs to know it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Corner {
    /// Slope on the other side of it, mm/rev.
    pub beyond: Vector,
    /// Bend on the other side of it, mm/rev².
    pub bend: Vector,
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
    /// Slope where it begins and where it ends, mm/rev.
    pub fn slopes(&self) -> [Vector; 2] {
        let turns = self.to_turn - self.from_turn;
        let slope = |at: f64| {
            let of = |i: usize| (self.to[i] - self.from[i]) / turns + self.bend[i] * turns * at;
            core::array::from_fn(of)
        };
        [slope(-0.5), slope(0.5)]
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
        let [first, last] = self.slopes();
        let (x, y) = (turn - self.from_turn, turn - self.to_turn);
        let (into, out_of) = (Rounded::at(x, self.entry.half), Rounded::at(y, self.exit.half));
        let mut on = OnThread::default();
        for i in 0..THREADING_AXES {
            let (before, after) = (self.entry.bend[i], self.exit.bend[i]);
            let beyond = self.entry.beyond[i];
            let entered = into.of(first[i] - beyond, self.bend[i] - before);
            let left = out_of.of(self.exit.beyond[i] - last[i], after - self.bend[i]);
            on.q[i] = self.from[i] + (beyond + before / 2.0 * x) * x + entered[0] + left[0];
            on.rate[i] = beyond + before * x + entered[1] + left[1];
            on.bend[i] = before + entered[2] + left[2];
            on.third[i] = entered[3] + left[3];
        }
        on
    }
}

/// R and P of the module's header, each with its derivatives: value, slope, second, third.
struct Rounded {
    slope: [f64; 4],
    bend: [f64; 4],
}

impl Rounded {
    fn at(x: f64, half: f64) -> Self {
        if x <= -half {
            return Self { slope: [0.0; 4], bend: [0.0; 4] };
        }
        if x >= half {
            return Self { slope: [x, 1.0, 0.0, 0.0], bend: [x * x / 2.0, x, 1.0, 0.0] };
        }
        let u = x / half;
        let squared = u * u;
        Self {
            slope: [
                half * (3.0 / 16.0 + u / 2.0 + 3.0 / 8.0 * squared - squared * squared / 16.0),
                0.5 + 0.75 * u - 0.25 * u * squared,
                0.75 * (1.0 - squared) / half,
                -1.5 * u / (half * half),
            ],
            bend: [
                half * half * u * (3.0 / 32.0 + u / 4.0 + squared * (3.0 / 16.0 - squared / 32.0)),
                half * (3.0 / 32.0 + u / 2.0 + squared * (9.0 / 16.0 - 5.0 / 32.0 * squared)),
                0.5 + u * (9.0 / 8.0 - 5.0 / 8.0 * squared),
                (9.0 / 8.0 - 15.0 / 8.0 * squared) / half,
            ],
        }
    }

    fn of(&self, slope: f64, bend: f64) -> [f64; 4] {
        core::array::from_fn(|k| slope * self.slope[k] + bend * self.bend[k])
    }
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
            bend: [0.0; 3],
            entry: Corner { half: half[0], ..Corner::default() },
            exit: Corner { beyond: out, half: half[1], ..Corner::default() },
        };
        let exit = ThreadStretch {
            start: None,
            ends: true,
            from: middle,
            to: [-8.0, 0.0, -22.0],
            from_turn: 12.5,
            to_turn: 13.5,
            entry: Corner { beyond: along, half: half[1], ..Corner::default() },
            exit: Corner { half: half[2], ..Corner::default() },
            ..thread
        };
        [thread, exit]
    }

    /// A thread that begins with 2 mm at Z5 and grows by 0.1 mm in each of 10 turns, to 3 mm; on
    /// with that for 5 turns.
    fn growing(half: [f64; 3]) -> [ThreadStretch; 2] {
        let (middle, bend) = ([0.0, 0.0, -20.0], [0.0, 0.0, -0.1]);
        let grows = ThreadStretch {
            spindle: 0,
            start: Some(Angle::ZERO),
            ends: false,
            from: [0.0, 0.0, 5.0],
            to: middle,
            from_turn: 0.0,
            to_turn: 10.0,
            bend,
            entry: Corner { half: half[0], ..Corner::default() },
            exit: Corner { beyond: [0.0, 0.0, -3.0], half: half[1], ..Corner::default() },
        };
        let goes_on = ThreadStretch {
            start: None,
            ends: true,
            from: middle,
            to: [0.0, 0.0, -35.0],
            from_turn: 10.0,
            to_turn: 15.0,
            bend: [0.0; 3],
            entry: Corner { beyond: [0.0, 0.0, -3.0], bend, half: half[1] },
            exit: Corner { half: half[2], ..Corner::default() },
            ..grows
        };
        [grows, goes_on]
    }

    #[test]
    fn a_lead_that_grows_has_gone_as_far_as_the_closed_form_says() {
        let [grows, goes_on] = growing([0.5, 0.3, 0.7]);
        assert_eq!(grows.slopes().map(|slope| slope[2]), [-2.0, -3.0]);
        for turn in [0.5, 1.0, 4.25, 9.7] {
            let wanted = 5.0 - (2.0 * turn + 0.1 * turn * turn / 2.0);
            let on = grows.at(turn);
            assert!((on.q[2] - wanted).abs() < 1e-12 && (on.bend[2] + 0.1).abs() < 1e-12, "{on:?}");
        }
        assert!((goes_on.at(12.0).q[2] - -26.0).abs() < 1e-12);
        let ends = [(goes_on.at(15.7), goes_on.to), (grows.at(-0.5), grows.from)];
        for (on, corner) in ends {
            assert!((on.q[2] - corner[2]).abs() < 1e-12 && on.rate[2].abs() < 1e-12, "{on:?}");
        }
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
            for chain in [chain([0.8, 0.1, 0.2]), growing([0.8, 0.1, 0.2])] {
                let turn = turn / 12.5 * chain[0].to_turn;
                let at = |turn: f64| if turn < chain[0].to_turn { chain[0].at(turn) } else { chain[1].at(turn) };
                let step = 1e-5;
                let (before, now, after) = (at(turn - step), at(turn), at(turn + step));
                for i in 0..3 {
                    let central = |of: fn(&OnThread) -> Vector| (of(&after)[i] - of(&before)[i]) / (2.0 * step);
                    prop_assert!((central(|on| on.q) - now.rate[i]).abs() < 1e-7);
                    prop_assert!((central(|on| on.rate) - now.bend[i]).abs() < 3e-3);
                }
            }
        }
    }
}
