//! Torque over the depth of a hole, in bins of equal length, on the way in and on the way out.

/// Bins over the depth, each way.
pub const BINS: usize = 24;

/// Which way a tap goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeWay {
    /// Into the hole.
    In,
    /// Out of it.
    Out,
}

impl StrokeWay {
    /// Both, in the order in which arrays have them.
    pub const BOTH: [Self; 2] = [Self::In, Self::Out];

    /// Its place in arrays of two.
    pub const fn index(self) -> usize {
        match self {
            Self::In => 0,
            Self::Out => 1,
        }
    }
}

/// Mean cutting torque of each bin of one stroke, N·m; positive against the rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DepthTorque {
    /// Mean of each bin, in and out; zero where nothing was measured.
    pub mean: [[f32; BINS]; 2],
    /// A bit for each bin in which something was measured, in and out.
    pub measured: [u32; 2],
}

impl DepthTorque {
    /// Mean of a bin, N·m; `None` where nothing was measured.
    pub fn at(&self, way: StrokeWay, bin: usize) -> Option<f64> {
        let is_measured = self.measured[way.index()] >> bin & 1 == 1;
        is_measured.then(|| f64::from(self.mean[way.index()][bin]))
    }

    /// Mean of all bins of a way, N·m.
    pub fn mean(&self, way: StrokeWay) -> Option<f64> {
        let bins = (0..BINS).filter_map(|bin| self.at(way, bin));
        let (sum, count) = bins.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
        (count > 0.0).then(|| sum / count)
    }

    /// Largest mean on a way, N·m, with its bin.
    pub fn largest(&self, way: StrokeWay) -> Option<(usize, f64)> {
        let bins = (0..BINS).filter_map(|bin| Some((bin, self.at(way, bin)?)));
        bins.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Sums over the bins of a stroke under way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthSums {
    sum: [[f64; BINS]; 2],
    count: [[u32; BINS]; 2],
}

/// The bin of a share of the depth; the surface is 0, the bottom 1.
pub fn bin_of(share: f64) -> usize {
    ((share.clamp(0.0, 1.0) * BINS as f64) as usize).min(BINS - 1)
}

impl DepthSums {
    /// Nothing measured.
    pub const NONE: Self = Self { sum: [[0.0; BINS]; 2], count: [[0; BINS]; 2] };

    /// Takes one reading at a share of the depth.
    pub fn add(&mut self, way: StrokeWay, share: f64, torque: f64) {
        let bin = bin_of(share);
        self.sum[way.index()][bin] += torque;
        self.count[way.index()][bin] += 1;
    }

    /// Mean of a bin, N·m; `None` where nothing was measured.
    pub fn mean(&self, way: StrokeWay, bin: usize) -> Option<f64> {
        let count = self.count[way.index()][bin];
        (count > 0).then(|| self.sum[way.index()][bin] / f64::from(count))
    }

    /// Means so far.
    pub fn means(&self) -> DepthTorque {
        let mut means = DepthTorque::default();
        for way in 0..2 {
            for bin in 0..BINS {
                let count = self.count[way][bin];
                if count > 0 {
                    means.mean[way][bin] = (self.sum[way][bin] / f64::from(count)) as f32;
                    means.measured[way] |= 1 << bin;
                }
            }
        }
        means
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bin_is_the_mean_of_what_was_measured_in_it_and_an_empty_one_has_none() {
        let mut sums = DepthSums::NONE;
        for torque in [1.0, 3.0] {
            sums.add(StrokeWay::In, 0.5 / BINS as f64, torque);
        }
        sums.add(StrokeWay::Out, 1.0, 0.25);
        let means = sums.means();
        assert_eq!(means.at(StrokeWay::In, 0), Some(2.0));
        assert_eq!(means.at(StrokeWay::In, 1), None);
        assert_eq!(means.largest(StrokeWay::Out), Some((BINS - 1, 0.25)));
    }
}
