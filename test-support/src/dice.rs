//! What campaigns and tests of programs at random draw.

/// Numbers at random, the same on every machine (`SplitMix64`, Steele, Lea and Flood 2014); the seed is all it is made of.
#[derive(Clone, Debug)]
pub struct Dice(pub u64);

impl Dice {
    /// Any whole number, each as often as another.
    pub const fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From `low` to below `high`, evenly.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.draw() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// True in this share of cases, 0 to 1.
    pub fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    /// One of a list that is not empty.
    pub fn one_of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[(self.draw() % list.len() as u64) as usize]
    }
}
