//! Draws of values that vary: between machines, between workpieces, between holes.
//!
//! Each value takes one draw of its stream, whatever its distribution: another value keeps its own
//! draw when this one is declared otherwise. An amplitude is drawn without its sign: evenly up to
//! d, as the size of a triangular draw, or, where both components of an offset are normal, by the
//! distribution of Rayleigh.
use crate::rng::Rng;
use units::{Distribution, FARTHEST_DEVIATIONS, Per, Spread};

/// The stream of a part is another one than that of the machine that makes it.
const OF_PART: u64 = 0x5041_5254_0000_0000;

/// The value of this seed and part, about zero, in a stream of its own.
pub fn drawn(spread: &Spread, seed: u64, stream: u64, part: u32) -> f64 {
    Draws::new(Rng::new(seed ^ stream), part).signed(spread)
}

/// A stream of draws for one workpiece on one machine. The first workpiece has the machine's own
/// draws.
#[derive(Clone, Debug)]
pub(crate) struct Draws {
    rng: Rng,
    part: u32,
}

impl Draws {
    pub(crate) const fn new(rng: Rng, part: u32) -> Self {
        Self { rng, part }
    }

    /// What the next value is drawn from.
    fn next(&mut self, per: Per) -> Rng {
        let before = self.rng.clone();
        let own = self.rng.branch();
        match (per, self.part) {
            (Per::Machine, _) | (_, 0 | 1) => before,
            (Per::Part | Per::Hole, part) => of_part(own, part),
        }
    }

    /// To either side of zero.
    pub(crate) fn signed(&mut self, spread: &Spread) -> f64 {
        let mut rng = self.next(spread.per);
        spread.by
            * match spread.distribution {
                Distribution::Uniform => rng.signed(),
                Distribution::Triangular => rng.unit() + rng.unit() - 1.0,
                Distribution::Normal => loop {
                    let drawn = rng.normal();
                    if drawn.abs() <= FARTHEST_DEVIATIONS {
                        break drawn;
                    }
                },
            }
    }

    /// A factor near one.
    pub(crate) fn factor(&mut self, spread: &Spread) -> f64 {
        1.0 + self.signed(spread)
    }

    /// An amplitude: 0 or more.
    pub(crate) fn amplitude(&mut self, spread: &Spread) -> f64 {
        let mut rng = self.next(spread.per);
        spread.by
            * match spread.distribution {
                Distribution::Uniform => rng.unit(),
                Distribution::Triangular => (rng.unit() + rng.unit() - 1.0).abs(),
                Distribution::Normal => loop {
                    let drawn = rng.normal().hypot(rng.normal());
                    if drawn <= FARTHEST_DEVIATIONS {
                        break drawn;
                    }
                },
            }
    }

    /// What follows in the stream, of this machine.
    pub(crate) fn unit(&mut self) -> f64 {
        self.rng.unit()
    }
}

/// The stream of a workpiece; the first one has the stream as it is.
pub(crate) fn of_part(mut stream: Rng, part: u32) -> Rng {
    if part <= 1 { stream } else { stream.stirred(OF_PART ^ u64::from(part)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Distribution; 3] =
        [Distribution::Uniform, Distribution::Triangular, Distribution::Normal];

    fn spread(distribution: Distribution, per: Per) -> Spread {
        Spread { by: 2.0, distribution, per }
    }

    /// Mean and standard deviation of many machines.
    fn moments(draw: impl Fn(&mut Draws) -> f64) -> (f64, f64) {
        let n = 20_000;
        let of = |seed| draw(&mut Draws::new(Rng::new(seed), 1));
        let mean = (0..n).map(of).sum::<f64>() / n as f64;
        let square = (0..n).map(|seed| (of(seed) - mean).powi(2)).sum::<f64>() / n as f64;
        (mean, square.sqrt())
    }

    #[test]
    fn deviations_are_those_of_the_distributions() {
        // 1/√3, 1/√6; a normal one cut at 3: √(1 − 6·φ(3)/(2·Φ(3) − 1)) = 0.98658
        for (distribution, expected) in ALL.into_iter().zip([1.154_70, 0.816_50, 1.973_16]) {
            let one = spread(distribution, Per::Machine);
            let (mean, deviation) = moments(|draws| draws.signed(&one));
            assert!(mean.abs() < 0.05, "{distribution:?}: mean {mean}");
            assert!((deviation / expected - 1.0).abs() < 0.02, "{distribution:?}: {deviation}");
        }
    }

    #[test]
    fn amplitudes_are_evenly_spread_triangular_or_of_rayleigh() {
        // means of d = 2: d/2, d/3, and d·√(π/2) less what is cut off beyond 3·d:
        // (√(π/2)·erf(3/√2) − 3·e^−4.5)/(1 − e^−4.5) = 1.2335
        for (distribution, expected) in ALL.into_iter().zip([1.0, 2.0 / 3.0, 2.467]) {
            let one = spread(distribution, Per::Machine);
            let (mean, _) = moments(|draws| draws.amplitude(&one));
            assert!((mean / expected - 1.0).abs() < 0.02, "{distribution:?}: {mean}");
        }
    }

    #[test]
    fn no_draw_is_farther_than_the_most() {
        for distribution in ALL {
            let one = spread(distribution, Per::Part);
            for part in 0..5000 {
                let draws = || Draws::new(Rng::new(9), part);
                assert!(draws().signed(&one).abs() <= one.most(), "{distribution:?}, {part}");
                let amplitude = draws().amplitude(&one);
                assert!((0.0..=one.most()).contains(&amplitude), "{distribution:?}, {part}");
            }
        }
    }

    #[test]
    fn a_machine_keeps_its_value_from_part_to_part_and_a_part_has_its_own() {
        for distribution in ALL {
            let of = |per, part| drawn(&spread(distribution, per), 3, 7, part);
            assert_eq!(of(Per::Machine, 1), of(Per::Machine, 2));
            assert_eq!(of(Per::Part, 1), of(Per::Machine, 1), "the first part is the machine's");
            assert!(of(Per::Part, 2) != of(Per::Part, 1) && of(Per::Part, 3) != of(Per::Part, 2));
            assert_eq!(of(Per::Part, 3), of(Per::Part, 3));
        }
    }

    #[test]
    fn what_follows_in_a_stream_does_not_depend_on_how_a_value_is_spread() {
        let after = |distribution, per, part| {
            let mut draws = Draws::new(Rng::new(5), part);
            draws.signed(&spread(distribution, per));
            draws.amplitude(&spread(distribution, per));
            draws.unit()
        };
        for distribution in ALL {
            assert_eq!(after(distribution, Per::Part, 9), after(ALL[0], Per::Machine, 1));
        }
    }
}
