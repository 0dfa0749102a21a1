//! What goes wrong with taps by chance, hole by hole: chips that stay in the flutes, cores that are
//! cracked.
//!
//! ```text
//!   torque │            ╱  Tc·r·((h − h₀)/D)²      packed: below h₀ the flutes are full, and what is
//!          │   ______ ╱                            cut further is pressed against the thread
//!          │  ╱      ¦
//!          └─┴───────┴──────► depth h              on the way out the plug is dragged along: a share of that
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | Tc | torque of the plateau of this hole | N·m |
//! | h₀ | depth from which on the flutes are full, by chance in each packed hole | mm |
//! | r | rise at one diameter below h₀ | 1 |
//!
//! That packed chips rise progressively, and that a plug which is turned back takes a third of what
//! pressed it, are estimates. A cracked core bears a share of what a sound one does.
use crate::rng::Rng;

/// Torque of a plug on the way out over that which it took at the bottom (estimate).
const DRAGGED_SHARE: f64 = 0.35;

/// How often taps meet what, and how much of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mishaps {
    /// Chance that chips pack in a hole.
    pub packing: f64,
    /// From how many diameters of depth on, at the least and at the most.
    pub packed_from: (f64, f64),
    /// r, at the most; a hole has half of it or more.
    pub packed_rise: f64,
    /// Chance that a tap's core is cracked when it comes to a hole.
    pub crack: f64,
    /// Share of its strength that a cracked core has.
    pub cracked_strength: f64,
}

/// What one hole meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mishap {
    /// h₀ in diameters; infinite: no chips pack.
    pub(crate) packed_from: f64,
    /// r.
    pub(crate) packed_rise: f64,
    /// Share of its strength that the tap's core has.
    pub(crate) strength: f64,
}

impl Mishap {
    /// Nothing goes wrong.
    pub(crate) const NONE: Self =
        Self { packed_from: f64::INFINITY, packed_rise: 0.0, strength: 1.0 };

    /// Torque of packed chips over that of the plateau, at a depth and with the deepest so far, in
    /// diameters.
    pub(crate) fn packed_share(&self, depth: f64, deepest: f64) -> f64 {
        let below = deepest - self.packed_from;
        if below <= 0.0 {
            return 0.0;
        }
        let plug = self.packed_rise * below * below;
        if depth >= deepest { plug } else { DRAGGED_SHARE * plug * (depth / deepest).max(0.0) }
    }
}

/// Draws what each hole meets, by chance.
#[derive(Clone, Debug)]
pub(crate) struct Draw {
    of: Mishaps,
    rng: Rng,
}

impl Draw {
    pub(crate) const fn new(of: Mishaps, rng: Rng) -> Self {
        Self { of, rng }
    }

    /// What the next hole meets.
    pub(crate) fn next(&mut self) -> Mishap {
        let Mishaps { packing, packed_from: (least, most), packed_rise, .. } = self.of;
        let [pack, from, rise, crack] = core::array::from_fn(|_| self.rng.unit());
        let mut mishap = Mishap::NONE;
        if pack < packing {
            mishap.packed_from = least + (most - least) * from;
            mishap.packed_rise = packed_rise * (0.5 + 0.5 * rise);
        }
        if crack < self.of.crack {
            mishap.strength = self.of.cracked_strength;
        }
        mishap
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Mishaps = Mishaps {
        packing: 0.5,
        packed_from: (1.0, 2.0),
        packed_rise: 1.0,
        crack: 0.1,
        cracked_strength: 0.15,
    };

    #[test]
    fn holes_meet_each_mishap_as_often_as_its_chance_says() {
        let mut draw = Draw::new(HALF, Rng::new(7));
        let drawn: Vec<Mishap> = (0..4000).map(|_| draw.next()).collect();
        let share = |is: fn(&Mishap) -> bool| {
            drawn.iter().filter(|mishap| is(mishap)).count() as f64 / drawn.len() as f64
        };
        assert!((share(|m| m.packed_from.is_finite()) - 0.5).abs() < 0.03);
        assert!((share(|m| m.strength < 1.0) - 0.1).abs() < 0.02);
    }

    #[test]
    fn packed_chips_rise_with_the_square_of_the_depth_below_full_flutes_and_are_dragged_out() {
        let mishap = Mishap { packed_from: 1.0, packed_rise: 0.8, strength: 1.0 };
        assert_eq!(mishap.packed_share(0.9, 0.9), 0.0);
        assert!((mishap.packed_share(3.0, 3.0) - 3.2).abs() < 1e-12);
        assert!((mishap.packed_share(1.5, 3.0) - 0.35 * 3.2 / 2.0).abs() < 1e-12);
    }
}
