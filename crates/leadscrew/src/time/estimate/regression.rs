//! What a second of rough time takes, of stretches of which some were planned.
//!
//! ```text
//!   tᵢ/cᵢ │          ●  ╱          x: moves a second of rough time, known of all that were kept
//!         │     ●   ╱ ●
//!         │   ● ╱ ●                r at the x of all of them, by the line; by the mean where
//!         └───────────── x         the line foretells no better
//! ```
//!
//! How far off: Student's quantile for 99 % times the scatter around the line, as far as x is from
//! the middle of what was planned (Cochran, *Sampling Techniques*, ch. 7, the regression
//! estimator); half of what is like nothing that was planned.
use units::Time;

/// How fewer than these scatter is not known.
const SCATTER: usize = 8;
/// Quantile of the normal distribution: 99 % lie within.
const NORMAL: f64 = 2.576;
/// A stretch is like those that were planned unless its x is beyond theirs by such a factor; what
/// is not may take so much more or less than the mean says, as a share.
const LIKE: f64 = 1.25;
const UNLIKE: f64 = 0.5;
/// The line is used if its predicted residual sum of squares is so much of the mean's at most.
const BETTER: f64 = 0.5;

/// A stretch that was planned, per second of its rough time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Observed {
    pub(super) moves: f64,
    pub(super) rough: Time,
    pub(super) feed: f64,
    pub(super) rapid: f64,
}

impl Observed {
    fn total(&self) -> f64 {
        self.feed + self.rapid
    }
}

/// Those that were kept and stand for all: moves a second, and for how much rough time.
pub(super) struct Population {
    pub(super) each: Vec<(f64, Time)>,
    /// Rough time of all.
    pub(super) rest: Time,
    /// All were kept.
    pub(super) is_whole: bool,
}

/// Time of a second of rough time, and how far it may be off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratio {
    pub(super) feed: f64,
    pub(super) rapid: f64,
    pub(super) off: f64,
}

/// See the module's header.
pub(super) fn find(observed: &[Observed], all: &Population) -> Ratio {
    let mean =
        |of: fn(&Observed) -> f64| observed.iter().map(of).sum::<f64>() / observed.len() as f64;
    let (feed, rapid) = (mean(|one| one.feed), mean(|one| one.rapid));
    if observed.len() < SCATTER {
        return Ratio { feed, rapid, off: 1.0 };
    }
    let like = Like::of(observed, all);
    let seen: Time = observed.iter().fold(Time::ZERO, |sum, one| sum + one.rough);
    let unseen = (1.0 - seen / all.rest).max(0.0);
    let line = |of: fn(&Observed) -> f64| {
        let points: Vec<_> = observed.iter().map(|one| (one.moves, of(one))).collect();
        Regression::through(&points)
    };
    let total = line(Observed::total);
    let unlike = UNLIKE * like.others * (feed + rapid);
    let is_line = total.press <= BETTER * total.press_of_mean;
    if !is_line {
        let free = total.count - 1.0;
        let variance = unseen * total.scatter_of_mean / free / total.count;
        return Ratio { feed, rapid, off: quantile(free) * variance.sqrt() + unlike };
    }
    // those that are like nothing that was planned take what the mean says
    let at = |of: fn(&Observed) -> f64| {
        line(of).slope * (like.moves - total.middle) * (1.0 - like.others)
    };
    let free = total.count - 2.0;
    // where there are few, some lead the line more than the others
    let scatter = (total.scatter / free).max(total.press / total.count);
    let away = (like.moves - total.middle).powi(2) / total.spread;
    let variance =
        unseen * scatter * (1.0 / total.count + away) + total.slope * total.slope * like.variance;
    Ratio {
        feed: feed + at(|one| one.feed),
        rapid: rapid + at(|one| one.rapid),
        off: quantile(free) * variance.sqrt() + unlike,
    }
}

/// Those that are like the planned ones: their moves a second, how exactly that is known, and the
/// share of the time that is not like them.
struct Like {
    moves: f64,
    variance: f64,
    others: f64,
}

impl Like {
    fn of(observed: &[Observed], all: &Population) -> Self {
        let least = observed.iter().fold(f64::INFINITY, |least, one| one.moves.min(least)) / LIKE;
        let most = observed.iter().fold(0.0, |most: f64, one| one.moves.max(most)) * LIKE;
        let (mut time, mut sum, mut squares, mut others, mut count) =
            (Time::ZERO, Time::ZERO, Time::ZERO, Time::ZERO, 0.0);
        for (moves, rough) in &all.each {
            if (least..=most).contains(moves) {
                time += *rough;
                sum += *rough * *moves;
                squares += *rough * (moves * moves);
                count += 1.0;
            } else {
                others += *rough;
            }
        }
        let moves = sum / time;
        let spread = (squares / time - moves * moves).max(0.0);
        let variance = if all.is_whole { 0.0 } else { spread / count };
        Self { moves, variance, others: others / (time + others) }
    }
}

/// The straight line of least squares.
#[derive(Clone, Copy, Debug)]
struct Regression {
    count: f64,
    /// Mean of x, and the sum of squares around it.
    middle: f64,
    spread: f64,
    slope: f64,
    /// Squares of what is off it, and off the mean.
    scatter: f64,
    scatter_of_mean: f64,
    /// Predicted residual sum of squares: how far each is off the line, or the mean, of all others;
    /// no number where there is no line.
    press: f64,
    press_of_mean: f64,
}

impl Regression {
    fn through(points: &[(f64, f64)]) -> Self {
        let count = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let (middle, level) = (mean(|point| point.0), mean(|point| point.1));
        let sum = |of: &dyn Fn(f64, f64) -> f64| {
            points.iter().map(|(x, y)| of(x - middle, y - level)).sum::<f64>()
        };
        let spread = sum(&|x, _| x * x);
        let slope = if spread > 0.0 { sum(&|x, y| x * y) / spread } else { 0.0 };
        let off = |x: f64, y: f64| y - slope * x;
        let left = |x: f64| 1.0 - 1.0 / count - x * x / spread;
        Self {
            count,
            middle,
            spread,
            slope,
            scatter: sum(&|x, y| off(x, y).powi(2)),
            scatter_of_mean: sum(&|_, y| y * y),
            press: sum(&|x, y| (off(x, y) / left(x)).powi(2)),
            press_of_mean: sum(&|_, y| (y * count / (count - 1.0)).powi(2)),
        }
    }
}

/// Student's quantile, from the normal one (Cornish and Fisher).
fn quantile(free: f64) -> f64 {
    let z = NORMAL;
    z + (z.powi(3) + z) / (4.0 * free)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * free.powi(2))
        + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z)
            / (384.0 * free.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A program's stretches: their kind by chance, and what each takes more or less by chance.
    struct Chance(u64);

    impl Chance {
        /// Evenly from 0 to 1 (Knuth's linear congruence).
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }

        /// About normal, of variance 1.
        fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.next()).sum::<f64>() - 6.0
        }
    }

    /// How many of 1000 samples of 9 to 13 stretches of 500 are off by more than they say.
    fn missed(kind: fn(&mut Chance) -> (f64, f64, f64)) -> usize {
        let mut chance = Chance(4);
        let mut miss = 0;
        for _ in 0..1000 {
            // rough time, moves a second, what a second of it takes
            let all: Vec<_> = (0..500).map(|_| kind(&mut chance)).collect();
            let rest: f64 = all.iter().map(|one| one.0).sum();
            let truth = all.iter().map(|one| one.0 * one.2).sum::<f64>() / rest;
            let step = rest / (9.0 + 4.0 * chance.next());
            let (mut at, mut end, mut observed) = (step * chance.next(), 0.0, Vec::new());
            for (rough, moves, takes) in &all {
                end += rough;
                if end > at {
                    at += step;
                    let rough = Time::s(*rough);
                    observed.push(Observed { moves: *moves, rough, feed: *takes, rapid: 0.0 });
                }
            }
            let each = all.iter().map(|one| (one.1, Time::s(one.0))).collect();
            let all = Population { each, rest: Time::s(rest), is_whole: true };
            let found = find(&observed, &all);
            miss += usize::from((found.feed - truth).abs() > found.off);
        }
        miss
    }

    #[test]
    fn what_is_said_holds_for_99_of_100_programs() {
        let alike = missed(|chance| {
            (1.0 + chance.next(), 10.0 + chance.next(), 1.0 + 0.03 * chance.normal())
        });
        assert!(alike <= 10, "all alike: {alike} of 1000");
        // outlines have many moves a second, pockets few; stretches are made of both
        let mixed = missed(|chance| {
            let outline = if chance.next() < 0.8 { 0.1 * chance.next() } else { chance.next() };
            let moves = 130.0 * outline + 2.0;
            (4.0 - 3.0 * outline, moves, 0.98 - 0.1 * outline + 0.01 * chance.normal())
        });
        assert!(mixed <= 10, "of two kinds: {mixed} of 1000");
        // one in 500 is nothing like the others
        let rare = missed(|chance| {
            let moves = 160.0 + 0.1 * chance.next();
            if chance.next() < 0.002 { (1.0, 20.0, 1.4) } else { (1.0, moves, 1.0) }
        });
        assert!(rare <= 10, "with rare ones: {rare} of 1000");
    }

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (free, table) in
            [(8.0, 3.355), (15.0, 2.947), (31.0, 2.744), (63.0, 2.656), (127.0, 2.615)]
        {
            let found = quantile(free);
            assert!((found - table).abs() < 0.004, "{free}: {found}");
        }
    }
}
