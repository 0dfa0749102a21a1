//! What the torque over depth says of a hole and of its tap.
//!
//! ```text
//!   q = torque / expected          first  mean q of the first usable bins,  last  of the last ones
//!
//!        ────────  q ≈ 1           within the band
//!    ────────      q > 1 all along hole too small         ___ q < 1 all along     hole too large
//!            ╱     rises below     chips packed           ───╲___ falls to 0      broken
//!                                                         ___ ≈ 0 all along       cuts nothing
//! ```
//!
//! A tap that is worn is not seen in one hole: [`StrokeBand::trend`] says it. What two causes can
//! make is said not to be sure.
use super::band::{LEARNING_SHARE, LOWER_SHARE, StrokeBand, WORN};
use super::depth::{BINS, DepthTorque, StrokeWay};

/// Bins with less than this share of the largest mean are not looked at.
const USABLE_SHARE: f64 = 0.3;
/// Bins at either end of a hole whose mean is taken.
const ENDS: usize = 3;
/// So many times `first` may `last` be in a hole that is too small all along.
const EVEN: f64 = 1.3;
/// Torque on the way out over that expected, from which on chips are dragged along.
const DRAGGED: f64 = 1.6;
/// Usable bins at the end in which nothing is cut any more.
const GONE_BINS: usize = 2;
/// Usable bins from which on the course over depth is sure.
const SURE_BINS: usize = 5;

/// What a hole was.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Diagnosis {
    /// Within the band of the good holes before.
    WithinBand,
    /// No band is in use yet: so many good holes are known.
    Learning(u32),
    /// No band is in use yet, and the torque is this many times that of the holes before.
    UnlikeOthers(f64),
    /// Too high from the first thread on, by this factor: no pre-drilled hole, one too small, or
    /// harder material.
    HoleTooSmall(f64),
    /// Too low from the first thread on, by this factor.
    HoleTooLarge(f64),
    /// Next to nothing from the first thread on: no material, a hole as wide as the tap, or no tap.
    CutsNothing,
    /// Too high towards the bottom or on the way out, by this factor.
    ChipsPacked(f64),
    /// Within the band, whose level has risen by this factor since the first holes.
    Worn(f64),
    /// Gone from this share of the depth on.
    Broken(f64),
    /// Too high by this factor, with no course over depth that says why.
    AboveBand(f64),
    /// Not looked at: the stroke was stopped on its way by something else.
    Interrupted,
}

/// A diagnosis, and whether another cause is unlikely.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Diagnosed {
    /// What the hole was.
    pub what: Diagnosis,
    /// No other cause is likely.
    pub is_sure: bool,
}

impl Diagnosed {
    const fn new(what: Diagnosis, is_sure: bool) -> Self {
        Self { what, is_sure }
    }

    /// The hole is one to learn from.
    pub const fn is_good(self) -> bool {
        matches!(self.what, Diagnosis::WithinBand | Diagnosis::Learning(_) | Diagnosis::Worn(_))
    }
}

/// Ratios of the usable bins on the way in, with their bins.
struct Ratios {
    bins: [(usize, f64); BINS],
    count: usize,
}

impl Ratios {
    fn of(torque: &DepthTorque, band: &StrokeBand) -> Self {
        let mut ratios = Self { bins: [(0, 0.0); BINS], count: 0 };
        // in the last one the spindle turns back
        for bin in 0..BINS - 1 {
            let usable = band.mean[0][bin] >= USABLE_SHARE * band.plateau();
            let Some(value) = torque.at(StrokeWay::In, bin).filter(|_| usable) else { continue };
            ratios.bins[ratios.count] = (bin, value / band.expected(StrokeWay::In, bin));
            ratios.count += 1;
        }
        ratios
    }

    fn list(&self) -> &[(usize, f64)] {
        &self.bins[..self.count]
    }

    fn mean(list: &[(usize, f64)]) -> f64 {
        list.iter().map(|(_, q)| q).sum::<f64>() / list.len() as f64
    }

    /// Means of the first and of the last bins.
    fn ends(&self) -> (f64, f64) {
        let ends = ENDS.min(self.count);
        (Self::mean(&self.list()[..ends]), Self::mean(&self.list()[self.count - ends..]))
    }

    /// The share of the depth from which on nothing is cut any more, if something was before.
    fn gone_from(&self) -> Option<f64> {
        let list = self.list();
        let gone = list.iter().rev().take_while(|(_, q)| *q < LOWER_SHARE).count();
        let before = &list[..list.len() - gone];
        let cut = before.iter().any(|(_, q)| *q > 1.0 - LEARNING_SHARE);
        let (bin, _) = *list.get(list.len() - gone)?;
        (gone >= GONE_BINS && cut).then(|| bin as f64 / BINS as f64)
    }
}

/// Torque on the way out over that expected; `None` where none was measured all the way.
fn dragged(torque: &DepthTorque, band: &StrokeBand) -> Option<f64> {
    let (mut sum, mut expected) = (0.0, 0.0);
    for bin in 0..BINS - 2 {
        sum += torque.at(StrokeWay::Out, bin)?;
        expected += band.expected(StrokeWay::Out, bin);
    }
    (expected > 0.0).then(|| sum / expected)
}

/// What a hole was; `share`: by how much a good one may be off, `least`: mean torque on
/// the way in below which nothing is cut, or nothing that can be read, N·m.
pub fn diagnose(torque: &DepthTorque, band: &StrokeBand, share: f64, least: f64) -> Diagnosed {
    if !band.is_known() {
        return while_learning(torque, band, least);
    }
    over_depth(torque, band, share)
}

/// What a stroke was that its lower bound has stopped at this share of the depth.
pub fn diagnose_gone(torque: &DepthTorque, band: &StrokeBand, at: f64) -> Diagnosed {
    let ratios = Ratios::of(torque, band);
    let cut = ratios.list().iter().filter(|(_, q)| *q > 1.0 - LEARNING_SHARE).count();
    if cut > 0 {
        return Diagnosed::new(Diagnosis::Broken(at), cut > GONE_BINS);
    }
    Diagnosed::new(Diagnosis::CutsNothing, false)
}

/// The course of the torque over depth, beside a band that is in use.
fn over_depth(torque: &DepthTorque, band: &StrokeBand, share: f64) -> Diagnosed {
    let ratios = Ratios::of(torque, band);
    if ratios.count == 0 {
        // above the band before the chamfer was in
        return Diagnosed::new(Diagnosis::HoleTooSmall(1.0 + share), false);
    }
    let (first, last) = ratios.ends();
    let mean = Ratios::mean(ratios.list());
    let out = dragged(torque, band);
    let many = ratios.count >= SURE_BINS;
    if let Some(depth) = ratios.gone_from() {
        return Diagnosed::new(Diagnosis::Broken(depth), out.is_none_or(|q| q < LOWER_SHARE));
    }
    if mean < LOWER_SHARE {
        return Diagnosed::new(Diagnosis::CutsNothing, many);
    }
    if first > 1.0 + share {
        // cut short in the chamfer there is no course to speak of
        let even = last < EVEN * first || !many;
        let what = if even { Diagnosis::HoleTooSmall(mean) } else { Diagnosis::AboveBand(last) };
        return Diagnosed::new(what, even && many);
    }
    if last > 1.0 + share {
        return Diagnosed::new(Diagnosis::ChipsPacked(last), many && first < 1.0 + share / 2.0);
    }
    if let Some(out) = out.filter(|out| *out > DRAGGED) {
        return Diagnosed::new(Diagnosis::ChipsPacked(out), false);
    }
    if mean < 1.0 - share {
        let even = first < 1.0 - share / 2.0 && last < 1.0 - share / 2.0;
        return Diagnosed::new(Diagnosis::HoleTooLarge(mean), even && many);
    }
    if band.level >= WORN {
        let sure = band.trend.slope().is_some_and(|slope| slope.is_sure());
        return Diagnosed::new(Diagnosis::Worn(band.level), sure);
    }
    Diagnosed::new(Diagnosis::WithinBand, true)
}

/// No band is in use: a hole that is far from those before is not learnt from.
fn while_learning(torque: &DepthTorque, band: &StrokeBand, least: f64) -> Diagnosed {
    if band.holes == 0 && torque.mean(StrokeWay::In).is_none_or(|mean| mean < least) {
        return Diagnosed::new(Diagnosis::CutsNothing, false);
    }
    let ratio = band.ratio(torque).filter(|_| band.holes > 0);
    let far = ratio.filter(|ratio| (ratio - 1.0).abs() > LEARNING_SHARE);
    let what = far.map_or(Diagnosis::Learning(band.holes + 1), Diagnosis::UnlikeOthers);
    Diagnosed::new(what, false)
}

/// What a stroke was that was stopped at a limit, without a band; `early`: at this share of the
/// depth, where the tap has not cut more than its chamfer yet.
pub fn diagnose_alone(torque: &DepthTorque, early: bool) -> Diagnosed {
    let Some((_, largest)) = torque.largest(StrokeWay::In) else {
        return Diagnosed::new(Diagnosis::AboveBand(1.0), false);
    };
    let measured = (0..BINS).filter_map(|bin| torque.at(StrokeWay::In, bin));
    let full = measured.filter(|value| *value > USABLE_SHARE * largest);
    let (sum, count) = full.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    let factor = largest * count / sum;
    let what = if early {
        Diagnosis::HoleTooSmall(factor.max(1.0))
    } else {
        Diagnosis::AboveBand(factor.max(1.0))
    };
    Diagnosed::new(what, false)
}

#[cfg(test)]
mod tests {
    use super::super::band::{BandKey, FEWEST_HOLES};
    use super::*;

    const SHARE: f64 = 0.25;

    /// A hole: 2 N·m in, 0.4 out, each times a factor of the share of the depth.
    fn hole(way_in: impl Fn(f64) -> f64, way_out: impl Fn(f64) -> f64) -> DepthTorque {
        let mut torque = DepthTorque { measured: [(1 << BINS) - 1; 2], ..DepthTorque::default() };
        for bin in 0..BINS {
            let at = (bin as f64 + 0.5) / BINS as f64;
            torque.mean[0][bin] = (2.0 * way_in(at)) as f32;
            torque.mean[1][bin] = (0.4 * way_out(at)) as f32;
        }
        torque
    }

    fn band() -> StrokeBand {
        let mut band = StrokeBand::new(BandKey::default());
        for _ in 0..FEWEST_HOLES {
            band.learn(&hole(|_| 1.0, |_| 1.0));
        }
        band
    }

    fn said(torque: DepthTorque) -> Diagnosed {
        diagnose(&torque, &band(), SHARE, 0.3)
    }

    #[test]
    fn each_course_over_depth_has_its_name() {
        let one = |_: f64| 1.0;
        let sure = |what| Diagnosed { what, is_sure: true };
        assert_eq!(said(hole(one, one)), sure(Diagnosis::WithinBand));
        let small = said(hole(|_| 1.4, |_| 1.4));
        assert!(matches!(small.what, Diagnosis::HoleTooSmall(q) if (q - 1.4).abs() < 1e-6));
        assert!(small.is_sure);
        let large = said(hole(|_| 0.6, |_| 0.6));
        assert!(matches!(large.what, Diagnosis::HoleTooLarge(q) if (q - 0.6).abs() < 1e-6));
        assert_eq!(said(hole(|_| 0.05, |_| 0.0)), sure(Diagnosis::CutsNothing));
        let packed = said(hole(|at| 1.0 + 1.5 * (at - 0.5).max(0.0), |_| 2.0));
        assert!(matches!(packed.what, Diagnosis::ChipsPacked(_)) && packed.is_sure, "{packed:?}");
        let broken = said(hole(|at| if at < 0.6 { 1.0 } else { 0.0 }, |_| 0.0));
        assert!(matches!(broken.what, Diagnosis::Broken(at) if (at - 0.6).abs() < 0.05));
        assert!(broken.is_sure);
    }

    #[test]
    fn chips_that_are_dragged_out_are_suspected_and_not_sure() {
        let dragged = said(hole(|_| 1.0, |_| 2.0));
        assert!(matches!(dragged.what, Diagnosis::ChipsPacked(_)) && !dragged.is_sure);
    }

    #[test]
    fn before_there_is_a_band_a_hole_far_from_the_others_is_not_learnt_from() {
        let mut band = StrokeBand::new(BandKey::default());
        let good = hole(|_| 1.0, |_| 1.0);
        assert_eq!(diagnose(&good, &band, SHARE, 0.3).what, Diagnosis::Learning(1));
        band.learn(&good);
        let odd = diagnose(&hole(|_| 2.0, |_| 2.0), &band, SHARE, 0.3);
        assert!(matches!(odd.what, Diagnosis::UnlikeOthers(_)) && !odd.is_good());
    }

    #[test]
    fn a_level_that_has_risen_by_half_is_a_worn_tap_and_sure_where_the_line_is() {
        let mut band = band();
        for number in 0..60 {
            band.learn(&hole(|_| 1.0 + 0.012 * f64::from(number), |_| 1.0));
        }
        let level = band.level;
        let worn = diagnose(&hole(|_| level, |_| level), &band, SHARE, 0.3);
        assert!(matches!(worn.what, Diagnosis::Worn(_)) && worn.is_sure, "{worn:?}");
        let mut jumped = self::band();
        jumped.level = 1.6;
        let worn = diagnose(&hole(|_| 1.6, |_| 1.6), &jumped, SHARE, 0.3);
        assert!(matches!(worn.what, Diagnosis::Worn(_)) && !worn.is_sure);
    }
}
