//! The groove a tap leaves, binned over depth while the samples stream by.
//!
//! Turning and advancing on one ideal helix, a rigid tap follows itself and the groove is as wide
//! as its tooth. What the edges stand off that helix,
//!
//! ```text
//!   e = depth − a·(θ − θ₀)          a: advance per revolution; e > 0: deeper than the helix
//! ```
//!
//! moves the *whole* tap along the axis, and every tooth cuts where it stands:
//!
//! ```text
//!   depth of a place p in the thread        tip depths at which that place is touched
//!   ──┬────────────────────────────► tip    p + c/2 … p + c + P   leading teeth: chamfer above the
//!     p      p+c/2      p+c+P               pitch line and the first full pitch; no clearance
//!     │        ├─leading──┼─following─►     beyond p + c + P      following teeth: thinner by back
//!                                           taper, they touch only beyond ± clearance/2
//! ```
//!
//! (c: chamfer length, P: pitch.) The groove at p lies between the extremes of e over both, inwards
//! and outwards: w(p) = max(leading, following − clearance/2) − min(leading, following +
//! clearance/2). The lead error is read where the first full tooth stands, p + c, as the range of
//! the groove's middle over any two places within the engagement length.
//!
//! Bounded memory: extremes per bin of P/8, and running sums for the fit of θ₀ (least squares over
//! the spindle's path, lead given: the mean of e weighted with |dθ|).

/// Bins per pitch: finer than the chamfer's steps, coarser than the path of one servo period.
const BINS_PER_PITCH: f64 = 8.0;
/// No thread has more; a deeper one gets wider bins.
const MOST_BINS: usize = 2048;

/// Least and largest e of a bin or window; empty while `least > largest`.
#[derive(Clone, Copy, Debug)]
struct Range {
    least: f64,
    largest: f64,
}

impl Range {
    const EMPTY: Self = Self { least: f64::INFINITY, largest: f64::NEG_INFINITY };

    fn take(&mut self, e: f64) {
        self.least = self.least.min(e);
        self.largest = self.largest.max(e);
    }

    fn or(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), largest: self.largest.max(other.largest) }
    }

    fn known(self) -> Option<Self> {
        (self.least <= self.largest).then_some(self)
    }

    fn middle(self) -> Option<f64> {
        self.known().map(|r| f64::midpoint(r.least, r.largest))
    }

    /// Drawn in by `by` on both sides: what a tooth thinner by 2·`by` would touch. May be inside
    /// out.
    fn less(self, by: f64) -> Self {
        Self { least: self.least + by, largest: self.largest - by }
    }

    fn relative_to(self, zero: f64) -> Option<[f64; 2]> {
        self.known().map(|r| [r.least - zero, r.largest - zero])
    }
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    inward: Range,
    outward: Range,
}

impl Bin {
    const EMPTY: Self = Self { inward: Range::EMPTY, outward: Range::EMPTY };

    fn both(self) -> Range {
        self.inward.or(self.outward)
    }

    /// Touched on the way in and on the way out.
    fn is_complete(&self) -> bool {
        self.inward.known().is_some() && self.outward.known().is_some()
    }
}

/// Where the edges stood at one sample.
#[derive(Clone, Copy, Debug)]
struct Stand {
    depth_mm: f64,
    theta_rev: f64,
    e_mm: f64,
    bin: usize,
}

/// Extremes of e over depth, and the fit of the helix.
#[derive(Clone, Debug)]
pub(crate) struct Groove {
    pitch_mm: f64,
    /// Depth gained per revolution in the spindle's positive sense; negative for a left-hand
    /// thread.
    advance_mm_per_rev: f64,
    bin_mm: f64,
    bins: Vec<Bin>,
    /// θ and depth of the first sample: e counts from there until the helix is fitted.
    origin: Option<(f64, f64)>,
    previous: Option<Stand>,
    outward: bool,
    /// Extremes of e with the tip depth at each.
    least: (f64, f64),
    largest: (f64, f64),
    /// ∫|dθ|, ∫e|dθ|, ∫e²|dθ|.
    sums: [f64; 3],
}

/// What a tap looks like to its groove, mm.
#[allow(clippy::struct_field_names)] // the ending is the unit
#[derive(Clone, Copy, Debug)]
pub(crate) struct TapForm {
    /// Length of the chamfer.
    pub(crate) chamfer_mm: f64,
    /// Play of the following teeth.
    pub(crate) clearance_mm: f64,
    /// Length over which pitch errors add up for a gauge.
    pub(crate) engagement_mm: f64,
}

/// How far the edges were off the fitted helix, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(clippy::struct_field_names)] // the ending is the unit
pub(crate) struct OffHelix {
    pub(crate) largest_mm: f64,
    /// Depth of the tip at the largest.
    pub(crate) depth_mm: f64,
    /// Root of the mean square over the spindle's path.
    pub(crate) rms_mm: f64,
}

/// What that did to the thread, mm.
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(clippy::struct_field_names)] // the ending is the unit
pub(crate) struct GrooveCut {
    pub(crate) lead_error_mm: f64,
    /// w of the widest place.
    pub(crate) widening_mm: f64,
    pub(crate) widest_depth_mm: f64,
    /// w of each place of the full thread, by bin.
    pub(crate) widenings_mm: Vec<f64>,
}

/// Error at one depth of the tip, mm: least and largest distance from the fitted helix.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_field_names)] // the ending is the unit
pub(crate) struct Slice {
    pub(crate) depth_mm: f64,
    pub(crate) inward_mm: Option<[f64; 2]>,
    pub(crate) outward_mm: Option<[f64; 2]>,
}

impl Groove {
    /// For a thread of this pitch and about this depth.
    pub(crate) fn new(pitch_mm: f64, advance_mm_per_rev: f64, depth_mm: f64) -> Self {
        let bin_mm = (pitch_mm / BINS_PER_PITCH).max(depth_mm / (MOST_BINS as f64 - 64.0));
        Self {
            pitch_mm,
            advance_mm_per_rev,
            bin_mm,
            bins: Vec::with_capacity((depth_mm / bin_mm) as usize + 8),
            origin: None,
            previous: None,
            outward: false,
            least: (f64::INFINITY, 0.0),
            largest: (f64::NEG_INFINITY, 0.0),
            sums: [0.0; 3],
        }
    }

    /// The edges at this depth (> 0), the spindle at this angle.
    pub(crate) fn sample(&mut self, depth_mm: f64, theta_rev: f64) {
        let (theta0, depth0) = *self.origin.get_or_insert((theta_rev, depth_mm));
        let e_mm = (depth_mm - depth0) - self.advance_mm_per_rev * (theta_rev - theta0);
        let bin = ((depth_mm / self.bin_mm) as usize).min(MOST_BINS - 1);
        let now = Stand { depth_mm, theta_rev, e_mm, bin };
        if let Some(before) = self.previous {
            self.pass(before, now);
        }
        if bin >= self.bins.len() {
            self.bins.resize(bin + 1, Bin::EMPTY);
        }
        self.range_at(bin).take(e_mm);
        if e_mm < self.least.0 {
            self.least = (e_mm, depth_mm);
        }
        if e_mm > self.largest.0 {
            self.largest = (e_mm, depth_mm);
        }
        self.previous = Some(now);
    }

    /// The edges have left the material.
    pub(crate) fn leave(&mut self) {
        self.previous = None;
    }

    fn range_at(&mut self, bin: usize) -> &mut Range {
        if self.outward { &mut self.bins[bin].outward } else { &mut self.bins[bin].inward }
    }

    /// From one sample to the next: the sense of turning, the sums, the bins skipped between them.
    fn pass(&mut self, before: Stand, now: Stand) {
        let turned = now.theta_rev - before.theta_rev;
        if turned != 0.0 {
            self.outward = turned * self.advance_mm_per_rev < 0.0;
        }
        // e taken as linear between samples: exact integrals of e and e²
        let (a, b) = (before.e_mm, now.e_mm);
        self.sums[0] += turned.abs();
        self.sums[1] += turned.abs() * f64::midpoint(a, b);
        self.sums[2] += turned.abs() * (a * a + a * b + b * b) / 3.0;

        let (low, high) =
            if before.bin < now.bin { (before.bin, now.bin) } else { (now.bin, before.bin) };
        if high >= self.bins.len() {
            self.bins.resize(high + 1, Bin::EMPTY);
        }
        for bin in low + 1..high {
            let depth = self.centre_mm(bin);
            let part = (depth - before.depth_mm) / (now.depth_mm - before.depth_mm);
            self.range_at(bin).take(a + (b - a) * part);
        }
    }

    /// e of the fitted helix: the mean over the spindle's path.
    fn fitted_mm(&self) -> f64 {
        if self.sums[0] > 0.0 { self.sums[1] / self.sums[0] } else { 0.0 }
    }

    /// Spindle angle at which the fitted helix passes a depth; `None` if nothing was cut.
    pub(crate) fn theta_rev_at(&self, depth_mm: f64) -> Option<f64> {
        let (theta0, depth0) = self.origin?;
        Some(theta0 + (depth_mm - depth0 - self.fitted_mm()) / self.advance_mm_per_rev)
    }

    /// How far the edges were off the fitted helix.
    pub(crate) fn off_helix(&self) -> OffHelix {
        if self.origin.is_none() {
            return OffHelix::default();
        }
        let zero = self.fitted_mm();
        let (low, high) = (zero - self.least.0, self.largest.0 - zero);
        let mean_square = if self.sums[0] > 0.0 { self.sums[2] / self.sums[0] } else { 0.0 };
        OffHelix {
            largest_mm: low.max(high),
            depth_mm: if low > high { self.least.1 } else { self.largest.1 },
            rms_mm: (mean_square - zero * zero).max(0.0).sqrt(),
        }
    }

    /// What that did to a thread of this full depth.
    pub(crate) fn cut(&self, form: &TapForm, full_depth_mm: f64) -> GrooveCut {
        let widenings_mm = self.widenings(form, full_depth_mm);
        // of equals the shallowest
        let widest = (0..widenings_mm.len())
            .rev()
            .max_by(|a, b| widenings_mm[*a].total_cmp(&widenings_mm[*b]));
        GrooveCut {
            lead_error_mm: self.lead_error_mm(form),
            widening_mm: widest.map_or(0.0, |bin| widenings_mm[bin]),
            widest_depth_mm: widest.map_or(0.0, |bin| self.centre_mm(bin)),
            widenings_mm,
        }
    }

    /// The error over depth, for pictures.
    pub(crate) fn profile(&self) -> impl Iterator<Item = Slice> {
        let zero = self.fitted_mm();
        self.bins.iter().enumerate().map(move |(i, bin)| Slice {
            depth_mm: self.centre_mm(i),
            inward_mm: bin.inward.relative_to(zero),
            outward_mm: bin.outward.relative_to(zero),
        })
    }

    fn centre_mm(&self, bin: usize) -> f64 {
        (bin as f64 + 0.5) * self.bin_mm
    }

    /// w of every place of the full thread, by bin.
    fn widenings(&self, form: &TapForm, full_depth_mm: f64) -> Vec<f64> {
        let last = self.bins.len();
        let places = ((full_depth_mm / self.bin_mm).ceil() as usize).min(last);
        let first_touch = (form.chamfer_mm / 2.0 / self.bin_mm) as usize;
        let leading = ((form.chamfer_mm + self.pitch_mm) / self.bin_mm).ceil() as usize + 1;
        let mut following = vec![Range::EMPTY; last + 1];
        for bin in (0..last).rev() {
            following[bin] = following[bin + 1].or(self.bins[bin].both());
        }
        let place = |p: usize| {
            let (from, to) = ((p + first_touch).min(last), (p + leading).min(last));
            let near = self.bins[from..to].iter().fold(Range::EMPTY, |all, bin| all.or(bin.both()));
            let all = near.or(following[to].less(form.clearance_mm / 2.0));
            all.known().map_or(0.0, |range| range.largest - range.least)
        };
        (0..places).map(place).collect()
    }

    /// Largest range of the groove's middle within any stretch of the engagement length. Depths
    /// touched one way only (at the very bottom) have no middle, unless the tap never came out at
    /// all.
    fn lead_error_mm(&self, form: &TapForm) -> f64 {
        let first = ((form.chamfer_mm / self.bin_mm) as usize).min(self.bins.len());
        let stretch = ((form.engagement_mm / self.bin_mm) as usize).max(1) + 1;
        let there_and_back = self.bins[first..].iter().any(Bin::is_complete);
        let middle = |bin: &Bin| {
            let counts = bin.is_complete() || !there_and_back;
            counts.then(|| bin.both().middle()).flatten()
        };
        let middles: Vec<_> = self.bins[first..].iter().map(middle).collect();
        (0..middles.len())
            .map(|from| {
                let to = (from + stretch).min(middles.len());
                let mut range = Range::EMPTY;
                middles[from..to].iter().flatten().for_each(|middle| range.take(*middle));
                range.known().map_or(0.0, |r| r.largest - r.least)
            })
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORM: TapForm = TapForm { chamfer_mm: 2.5, clearance_mm: 0.0, engagement_mm: 10.0 };

    /// In to 14 mm and out again on a lead of 1 mm, so many samples a turn, e in mm.
    fn groove(samples_per_rev: f64, from_rev: f64, e: impl Fn(f64, bool) -> f64) -> Groove {
        let mut groove = Groove::new(1.0, 1.0, 14.0);
        let count = (14.0 * samples_per_rev) as i32;
        for k in -count..=count {
            let depth = 14.0 * (1.0 - f64::from(k.abs()) / f64::from(count)) + 0.05;
            groove.sample(depth + e(depth, k > 0), from_rev + depth);
        }
        groove
    }

    #[test]
    fn a_record_so_coarse_that_it_skips_bins_measures_the_same() {
        let offset = |_: f64, out: bool| if out { 0.010 } else { 0.0 };
        for samples_per_rev in [50.0, 8.0, 3.0] {
            let groove = groove(samples_per_rev, 0.0, offset);
            let cut = groove.cut(&FORM, 11.5);
            assert!(
                (cut.widening_mm - 0.010).abs() < 1e-9,
                "{samples_per_rev}: {}",
                cut.widening_mm
            );
            let mut filled = groove.profile().skip(1).take(100);
            assert!(filled.all(|s| s.inward_mm.is_some() && s.outward_mm.is_some()));
        }
    }

    #[test]
    fn a_spindle_that_has_turned_a_day_is_as_exact_as_a_fresh_one() {
        // 24 h at 10 000 rpm: 14.4 million turns
        let cut = groove(40.0, 14.4e6, |_, out| if out { 0.010 } else { 0.0 }).cut(&FORM, 11.5);
        assert!((cut.widening_mm - 0.010).abs() < 1e-8, "{}", cut.widening_mm);
    }

    #[test]
    fn standing_still_weighs_nothing_in_the_fit() {
        let mut waited = groove(40.0, 0.0, |depth, _| 0.004 * depth.sin());
        let before = waited.off_helix();
        for _ in 0..100_000 {
            waited.sample(0.05 + 0.004 * 0.05_f64.sin(), 0.05);
        }
        assert!((waited.off_helix().rms_mm - before.rms_mm).abs() < 1e-12);
    }

    #[test]
    fn memory_is_bounded_however_deep_or_fine_the_thread() {
        let mut groove = Groove::new(0.001, 0.001, 1e9);
        for k in 0..10_000 {
            groove.sample(f64::from(k) * 1e6, f64::from(k));
        }
        assert!(groove.bins.len() <= MOST_BINS);
    }

    /// The definition, without bins: the range of e over all stands of the tap that touch place p,
    /// following teeth only as far as they stand out of their play.
    fn by_definition(stands: &[(f64, f64)], p: f64, form: &TapForm) -> f64 {
        let (mut least, mut largest) = (f64::INFINITY, f64::NEG_INFINITY);
        for &(depth, e) in stands.iter().filter(|(depth, _)| *depth >= p + form.chamfer_mm / 2.0) {
            let follows = depth > p + form.chamfer_mm + 1.0;
            let play = if follows { form.clearance_mm / 2.0 } else { 0.0 };
            least = least.min(e + play);
            largest = largest.max(e - play);
        }
        largest - least
    }

    #[test]
    fn bins_measure_what_the_definition_says_to_within_their_width() {
        let e = |depth: f64, out: bool| {
            let way = if out { -0.6 } else { 1.0 };
            0.02 * (0.7 * depth).sin() * way + 0.001 * depth
        };
        let steepest_mm_per_mm = 0.02 * 0.7 + 0.001;
        let groove = groove(40.0, 0.0, e);
        for clearance_mm in [0.0, 0.008, 0.030] {
            let form = TapForm { clearance_mm, ..FORM };
            let stands: Vec<_> = (0..=5600)
                .map(|k| 14.0 * (1.0 - (f64::from(k) / 2800.0 - 1.0).abs()))
                .enumerate()
                .map(|(k, depth)| (depth, e(depth, k > 2800)))
                .collect();
            for (bin, w) in groove.cut(&form, 11.5).widenings_mm.into_iter().enumerate() {
                let exact = by_definition(&stands, groove.centre_mm(bin), &form);
                let within = 2.0 * 2.0 * steepest_mm_per_mm * groove.bin_mm;
                assert!((w - exact).abs() < within, "bin {bin}: {w} for {exact}");
            }
        }
    }
}
