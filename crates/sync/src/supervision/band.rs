//! What good holes have been like: mean and spread of the torque over depth, for each kind of
//! stroke, and how it has changed from hole to hole since.
//!
//! ```text
//!   hole    1 … 10     reference: mean m and spread s of each bin (used from hole 5 on)
//!   then               ratio r = Σ m·c / Σ m²  of each good hole; level L follows it, a line is laid through it
//!   upper bound        L·m·(1 + share) + 3·s          lower bound   L·m·0.1
//! ```
//!
//! The reference is that of a new tap and is not learnt further, so that a tap which gets duller
//! does not take its band along unseen: the level does that, up to [`WORN`], and the line says how
//! fast.
use super::depth::{BINS, DepthTorque, StrokeWay};
use super::own::OwnTorque;
use libm::sqrt;
use units::{Lead, Length, Spin};

/// Good holes from which on a band is used.
pub const FEWEST_HOLES: u32 = 5;
/// Good holes that make the reference.
pub const REFERENCE_HOLES: u32 = 10;
/// Torque of a tap over that of its first holes from which on it is worn: monitors are set to 1.5
/// to 2 times the torque of a new tap.
pub const WORN: f64 = 1.5;
/// By this share a hole may be off the mean of the holes before while no band is in use yet.
pub const LEARNING_SHARE: f64 = 0.5;
/// Share of the level below which a tap cuts nothing.
pub const LOWER_SHARE: f64 = 0.35;
/// Share of the level below which nothing turns in the work: flanks in a thread that is there
/// already take 10 to 30 %.
pub const GONE_SHARE: f64 = 0.1;
/// Bins with at least this share of the largest mean say how hard a tap cuts.
const FULL_SHARE: f64 = 0.5;
/// Spreads above the mean.
const SPREADS: f64 = 3.0;
/// Share of the newest hole in the level.
const LEVEL_GAIN: f64 = 0.25;
/// Holes that the line needs.
const TREND_HOLES: f64 = 8.0;
/// A slope is one from this many standard errors on.
const SURE_ERRORS: f64 = 4.0;

/// What kind of stroke a band belongs to: of another one the spindle's own torque is another, too.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BandKey {
    /// The tool.
    pub tool: u32,
    /// Travel per positive turn.
    pub lead: Lead,
    /// Signed speed inwards.
    pub spin: Spin,
    /// Signed speed outwards.
    pub return_spin: Spin,
    /// From where it begins to the surface.
    pub run_in: Length,
    /// From the surface to the bottom.
    pub depth: Length,
}

impl BandKey {
    /// The same kind of stroke, to rounding.
    pub fn is_like(&self, other: &Self) -> bool {
        const ROUNDING: f64 = 1e-6;
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING;
        self.tool == other.tool
            && near(self.lead.value(), other.lead.value())
            && near(self.spin.value(), other.spin.value())
            && near(self.return_spin.value(), other.return_spin.value())
            && near(self.run_in.value(), other.run_in.value())
            && near(self.depth.value(), other.depth.value())
    }
}

/// A straight line through the ratios of good holes, by least squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trend {
    /// Holes.
    pub holes: f64,
    /// Sums of number, its square, ratio, its square, and number times ratio.
    pub sums: [f64; 5],
}

/// What the line says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Slope {
    /// Change of the ratio with each hole.
    pub per_hole: f64,
    /// Its standard error.
    pub error: f64,
    /// Ratio at the last hole.
    pub now: f64,
}

impl Slope {
    /// Larger than chance makes it.
    pub fn is_sure(&self) -> bool {
        self.per_hole > SURE_ERRORS * self.error
    }

    /// Holes until the tap is worn, where that is sure.
    pub fn holes_left(&self) -> Option<f64> {
        self.is_sure().then(|| ((WORN - self.now) / self.per_hole).max(0.0))
    }
}

impl Trend {
    fn add(&mut self, ratio: f64) {
        let x = self.holes;
        self.holes += 1.0;
        for (sum, term) in self.sums.iter_mut().zip([x, x * x, ratio, ratio * ratio, x * ratio]) {
            *sum += term;
        }
    }

    /// The line; `None` from too few holes.
    pub fn slope(&self) -> Option<Slope> {
        let n = self.holes;
        if n < TREND_HOLES {
            return None;
        }
        let [x, xx, r, rr, xr] = self.sums;
        let (sxx, sxr, srr) = (xx - x * x / n, xr - x * r / n, rr - r * r / n);
        let per_hole = sxr / sxx;
        let rest = (srr - per_hole * sxr).max(0.0) / (n - 2.0);
        let now = r / n + per_hole * (n - 1.0 - x / n);
        Some(Slope { per_hole, error: sqrt(rest / sxx), now })
    }
}

/// A kind of stroke and what its good holes were like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrokeBand {
    /// Kind of stroke.
    pub key: BandKey,
    /// Good holes that the reference is made of.
    pub holes: u32,
    /// Mean of each bin, in and out, N·m.
    pub mean: [[f64; BINS]; 2],
    /// Sum of squares about it, N²·m².
    pub squares: [[f64; BINS]; 2],
    /// Ratio to the reference that is expected of the next hole.
    pub level: f64,
    /// How the ratio changes.
    pub trend: Trend,
    /// What the spindle's own torque is with this tool.
    pub own: OwnTorque,
}

impl StrokeBand {
    /// Of which nothing is known.
    pub fn new(key: BandKey) -> Self {
        Self { key, level: 1.0, ..Self::default() }
    }

    /// A tap that cuts nothing is known from the first good hole on.
    pub const fn has_lower(&self) -> bool {
        self.holes > 0
    }

    /// It is made of enough holes to be used.
    pub const fn is_known(&self) -> bool {
        self.holes >= FEWEST_HOLES
    }

    /// Largest mean on the way in, N·m.
    pub fn plateau(&self) -> f64 {
        self.mean[0].iter().copied().fold(0.0, f64::max)
    }

    /// A bin in which the whole chamfer cuts, as far as the reference says.
    pub fn is_full(&self, bin: usize) -> bool {
        self.mean[0][bin] >= FULL_SHARE * self.plateau() && self.plateau() > 0.0
    }

    /// Standard deviation of a bin from hole to hole, N·m; infinite before there are two.
    pub fn spread(&self, way: StrokeWay, bin: usize) -> f64 {
        if self.holes < 2 {
            return f64::INFINITY;
        }
        sqrt(self.squares[way.index()][bin] / f64::from(self.holes - 1))
    }

    /// What is expected at a bin, N·m.
    pub fn expected(&self, way: StrokeWay, bin: usize) -> f64 {
        self.level * self.mean[way.index()][bin]
    }

    /// Bound above which a reading is too high at a bin, N·m, and how far a good reading is below
    /// it. A reading belongs to a place within its bin: the neighbours' means count. At the bottom
    /// the chip's root is sheared on the way out with a torque like that on the way in.
    pub fn upper(&self, way: StrokeWay, bin: usize, share: f64) -> (f64, f64) {
        let near = bin.saturating_sub(1)..=(bin + 1).min(BINS - 1);
        let on = |way: StrokeWay| {
            let means = near.clone().map(|bin| self.expected(way, bin));
            means.fold(0.0, f64::max)
        };
        let spread = near.clone().map(|bin| self.spread(way, bin)).fold(0.0, f64::max);
        let turns = way == StrokeWay::Out && bin + 2 >= BINS;
        let mean = if turns { on(StrokeWay::Out).max(on(StrokeWay::In)) } else { on(way) };
        let distance = share * mean.max(FULL_SHARE * self.level * self.plateau());
        (mean + distance + SPREADS * spread, distance)
    }

    /// Bound below which a tap cuts nothing at a bin on the way in, N·m, and how far a good reading
    /// is above it; `None` where a good one is too small for that.
    pub fn lower(&self, bin: usize) -> Option<(f64, f64)> {
        let near = bin.saturating_sub(1)..=(bin + 1).min(BINS - 1);
        if !near.clone().all(|bin| self.is_full(bin)) {
            return None;
        }
        let mean = near.map(|bin| self.expected(StrokeWay::In, bin)).fold(f64::INFINITY, f64::min);
        Some((GONE_SHARE * mean, (1.0 - GONE_SHARE) * mean))
    }

    /// Ratio of a hole to the reference, over the bins in which the whole chamfer cuts.
    pub fn ratio(&self, torque: &DepthTorque) -> Option<f64> {
        let (mut both, mut own) = (0.0, 0.0);
        for bin in (0..BINS).filter(|bin| self.is_full(*bin)) {
            let mean = self.mean[0][bin];
            both += mean * torque.at(StrokeWay::In, bin)?;
            own += mean * mean;
        }
        (own > 0.0).then(|| both / own)
    }

    /// Learns from a good hole.
    pub fn learn(&mut self, torque: &DepthTorque) {
        if self.holes >= FEWEST_HOLES
            && let Some(ratio) = self.ratio(torque)
        {
            self.level += LEVEL_GAIN * (ratio - self.level);
            if self.holes >= REFERENCE_HOLES {
                self.trend.add(ratio);
            }
        }
        if self.holes >= REFERENCE_HOLES {
            return;
        }
        self.holes += 1;
        let n = f64::from(self.holes);
        for way in StrokeWay::BOTH {
            for bin in 0..BINS {
                let Some(value) = torque.at(way, bin) else { continue };
                let (mean, squares) =
                    (&mut self.mean[way.index()][bin], &mut self.squares[way.index()][bin]);
                let off = value - *mean;
                *mean += off / n;
                *squares += off * (value - *mean);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hole with this torque in all bins on the way in, a fifth of it on the way out.
    fn hole(torque: f64) -> DepthTorque {
        let all = (1 << BINS) - 1;
        let mean = [[torque as f32; BINS], [torque as f32 / 5.0; BINS]];
        DepthTorque { mean, measured: [all; 2] }
    }

    #[test]
    fn mean_and_spread_of_the_reference_are_those_of_its_holes() {
        let mut band = StrokeBand::new(BandKey::default());
        for torque in [1.0, 2.0, 3.0, 2.0, 2.0] {
            band.learn(&hole(torque));
        }
        assert!(band.is_known());
        assert!((band.mean[0][7] - 2.0).abs() < 1e-6);
        assert!((band.spread(StrokeWay::In, 7) - 0.5_f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn a_tap_that_gets_duller_by_a_hundredth_a_hole_is_seen_to_and_its_band_goes_with_it() {
        let mut band = StrokeBand::new(BandKey::default());
        for number in 0..60 {
            // a hundredth a hole, and a hundredth to and fro
            let noise = if number % 2 == 0 { 0.01 } else { -0.01 };
            band.learn(&hole(2.0 * (1.0 + 0.01 * f64::from(number) + noise)));
        }
        let slope = band.trend.slope().unwrap();
        // of the reference, which is the mean of the first ten: 1.045 of a new tap
        assert!((slope.per_hole - 0.01 / 1.045).abs() < 1e-4, "{slope:?}");
        assert!(slope.is_sure() && slope.error < 1e-3);
        assert!(band.level > 1.45 && band.level < 1.6, "{}", band.level);
        assert!((slope.holes_left().unwrap()) < 5.0);
    }

    #[test]
    fn even_holes_show_no_slope() {
        let mut band = StrokeBand::new(BandKey::default());
        for number in 0..40 {
            band.learn(&hole(2.0 + 0.05 * f64::from(number * 7 % 5) - 0.1));
        }
        assert!(!band.trend.slope().unwrap().is_sure());
    }

    #[test]
    fn the_upper_bound_is_above_the_mean_by_its_share_and_the_lower_one_a_tenth_of_it() {
        let mut band = StrokeBand::new(BandKey::default());
        for _ in 0..FEWEST_HOLES {
            band.learn(&hole(2.0));
        }
        let (upper, distance) = band.upper(StrokeWay::In, 12, 0.25);
        assert!((upper - 2.5).abs() < 1e-6 && (distance - 0.5).abs() < 1e-6);
        let (lower, distance) = band.lower(12).unwrap();
        assert!((lower - 0.2).abs() < 1e-6 && (distance - 1.8).abs() < 1e-6);
        // out: 0.4 and a quarter of half of the way in; at the bottom as on the way in
        assert!((band.upper(StrokeWay::Out, 12, 0.25).0 - 0.65).abs() < 1e-6);
        assert!((band.upper(StrokeWay::Out, BINS - 1, 0.25).0 - 2.5).abs() < 1e-6);
    }
}
