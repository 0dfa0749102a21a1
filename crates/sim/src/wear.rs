//! How a tap gets duller: its cutting torque rises with the length of thread that it has cut.
//!
//! ```text
//!   Tc │                      ╱ life: Tc₀·(1 + r)
//!      │             ___╱───╱
//!      │  ___───────               Tc = Tc₀·(1 + r·(x/L))      x thread cut, L life of this very tap
//!      └───────────────────────► x
//! ```
//!
//! Tap makers state tool life as a length of thread, some 5 to 20 m for high-speed steel in C45,
//! and torque monitors are set to about half again to twice the torque of a new tap. That the rise
//! is linear between the two is an estimate, and so is how much the lives of taps differ.
use crate::rng::Rng;
use units::Length;

/// How taps wear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TapWear {
    /// L: thread that a tap cuts in its life.
    pub life: Length,
    /// r: by how much its torque has risen by then, as a share.
    pub rise: f64,
    /// By how much the lives of taps differ, as a share, each by its own draw.
    pub scatter: f64,
}

/// What the taps of a magazine have cut.
#[derive(Clone, Debug)]
pub(crate) struct Worn {
    model: TapWear,
    rng: Rng,
    /// By tool: thread cut, and its life, mm.
    taps: Vec<(u32, f64, f64)>,
}

impl Worn {
    pub(crate) const fn new(model: TapWear, rng: Rng) -> Self {
        Self { model, rng, taps: Vec::new() }
    }

    /// Factor on the cutting force of a tap as worn as it is.
    pub(crate) fn factor(&mut self, tool: u32) -> f64 {
        let rise = self.model.rise;
        let (_, cut, life) = self.of(tool);
        1.0 + rise * *cut / *life
    }

    /// A tap has cut so much thread, mm.
    pub(crate) fn cut(&mut self, tool: u32, thread_mm: f64) {
        self.of(tool).1 += thread_mm.max(0.0);
    }

    fn of(&mut self, tool: u32) -> &mut (u32, f64, f64) {
        let at = self.taps.iter().position(|tap| tap.0 == tool).unwrap_or_else(|| {
            let life = self.model.life.value() * self.rng.factor(self.model.scatter);
            self.taps.push((tool, 0.0, life));
            self.taps.len() - 1
        });
        &mut self.taps[at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_the_end_of_its_life_a_tap_has_the_stated_rise_and_another_tap_none() {
        let model = TapWear { life: Length::mm(10_000.0), rise: 0.6, scatter: 0.0 };
        let mut worn = Worn::new(model, Rng::new(1));
        for _ in 0..500 {
            worn.cut(3, 20.0);
        }
        assert!((worn.factor(3) - 1.6).abs() < 1e-9);
        assert_eq!(worn.factor(6), 1.0);
    }

    #[test]
    fn lives_differ_by_the_seed_and_the_tap() {
        let model = TapWear { life: Length::mm(10_000.0), rise: 0.6, scatter: 0.3 };
        let after = |seed, tool| {
            let mut worn = Worn::new(model, Rng::new(seed));
            for tool in [3, 6] {
                worn.cut(tool, 1000.0);
            }
            worn.factor(tool)
        };
        assert_eq!(after(1, 3), after(1, 3));
        assert!(after(1, 3) != after(2, 3) && after(1, 3) != after(1, 6));
    }
}
