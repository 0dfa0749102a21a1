//! Seeded chance: the same seed is the same machine, bit by bit.
//!
//! `SplitMix64` (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA
//! 2014, figure 17): a counter in steps of the golden ratio, stirred. It is tiny, has no bad seeds,
//! and two streams from neighbouring seeds are not alike.

/// A stream of pseudorandom numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rng {
    counter: u64,
}

impl Rng {
    /// The stream that belongs to a seed.
    pub(crate) const fn new(seed: u64) -> Self {
        Self { counter: seed }
    }

    /// Another stream, for a part whose draws shall not depend on how often others draw.
    pub(crate) fn branch(&mut self) -> Self {
        Self::new(self.bits())
    }

    /// Another stream still, one for each number.
    pub(crate) fn stirred(&mut self, number: u64) -> Self {
        Self::new(self.bits() ^ Self::new(number).bits())
    }

    /// The next 64 bits.
    fn bits(&mut self) -> u64 {
        self.counter = self.counter.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = self.counter;
        x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    }

    /// Evenly spread over 0 ≤ x < 1, in steps of 2⁻⁵³.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly spread over −1 ≤ x < 1.
    pub(crate) fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Normally distributed, mean 0 and standard deviation 1 (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.unit(), self.unit());
        (-2.0 * u.ln()).sqrt() * (core::f64::consts::TAU * v).cos()
    }

    /// Nearly normally distributed, mean 0 and standard deviation 1, within 3.5: the sum of four
    /// even numbers of 16 bits, in a tenth of the time of [`Self::normal`].
    pub(crate) fn bell(&mut self) -> f64 {
        /// Of the sum of four numbers that are even over a range of 65,536.
        const DEVIATION: f64 = 65_536.0 / 1.732_050_807_568_877_3;
        const MEAN: f64 = 2.0 * 65_535.0;
        let bits = self.bits();
        let sum: u64 = (0..4).map(|part| bits >> (16 * part) & 0xFFFF).sum();
        (sum as f64 - MEAN) / DEVIATION
    }

    /// A factor near one: what scatters by `share` (0.03 is ±3 %).
    pub(crate) fn factor(&mut self, share: f64) -> f64 {
        1.0 + share * self.signed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_numbers_of_seed_1234567_are_those_of_the_reference_implementation() {
        // Vigna's splitmix64.c, as quoted in Rosetta Code's task "Pseudo-random
        // numbers/Splitmix64".
        let mut rng = Rng::new(1_234_567);
        let first: Vec<u64> = (0..5).map(|_| rng.bits()).collect();
        assert_eq!(
            first,
            [
                6_457_827_717_110_365_317,
                3_203_168_211_198_807_973,
                9_817_491_932_198_370_423,
                4_593_380_528_125_082_431,
                16_408_922_859_458_223_821,
            ]
        );
    }

    #[test]
    fn the_mean_of_many_is_one_half() {
        let mut rng = Rng::new(7);
        let mean = (0..100_000).map(|_| rng.unit()).sum::<f64>() / 100_000.0;
        // standard deviation of that mean is 1/√(12·10⁵) = 0.0009
        assert!((mean - 0.5).abs() < 0.004, "{mean}");
    }
}
