//! Diameters and lengths of a turned thread from its grooves.
//!
//! ```text
//!   D2s            2·level: simple pitch diameter, least and largest of all grooves
//!   |ΔPn|          largest difference of two grooves' deviations within a length of engagement, 6.7·P·d^0.2
//!   D2v            the one that a full-form gauge feels: outside the largest D2s + √3·|ΔPn|, inside the least D2s − √3·|ΔPn|
//!   full thread    from the first groove whose root is deep enough to the last, and a pitch
//!   run-out        from there to where the tool last touched
//! ```
//!
//! A pitch at each end is left out of the diameters: the first one is cut by the bar's end, the
//! last one by the run-out.
use super::profile::Groove;
use crate::insert::Side;
use units::Length;

/// How near a root must come to a limit, mm: the grid's and the arithmetic's rounding.
const NEAR_MM: f64 = 0.002;
/// Grooves of one depth differ by less than this, mm, or by this share of the depth.
const ALIKE: (f64, f64) = (0.02, 0.04);
/// Grooves farther apart than this along all sections, in pitches, have a gap between them.
const GAP: f64 = 1.6;

/// What was measured of a turned thread.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedSizes {
    /// Major diameter, least and largest: of the crests outside, of the roots inside.
    pub major: [Length; 2],
    /// Simple pitch diameter, least and largest.
    pub pitch: [Length; 2],
    /// Virtual pitch diameter.
    pub virtual_pitch: Length,
    /// Minor diameter, least and largest: of the roots outside, of the crests inside.
    pub minor: [Length; 2],
    /// Largest cumulative pitch error within a length of engagement.
    pub pitch_error: Length,
    /// Largest distance of a flank from the V through the pitch diameter, along the axis.
    pub flank_error: Length,
    /// Radial overlap with the flanks of a mating thread of the basic profile, as a share of that
    /// profile's 5/8·H.
    pub flank_contact: f64,
    /// Width of the groove where the crest of the Go gauge must find room, least.
    pub width_at_go: Length,
    /// Length of full thread.
    pub full_length: Length,
    /// From the end of the bar, or where the thread is to begin, to the full thread.
    pub run_in: Length,
    /// From the full thread to where the insert last touched.
    pub run_out: Length,
}

/// What the grooves are measured against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Against {
    pub(super) side: Side,
    pub(super) pitch: f64,
    /// Machine Z between which the full thread is expected, rising.
    pub(super) expected: [f64; 2],
    /// Machine Z where the thread begins, and where the tool last touched.
    pub(super) ends: [f64; 2],
    /// Height to which a full root comes at least, by the Go gauge.
    pub(super) full_root: Option<f64>,
    /// Height of the mating thread's crests.
    pub(super) mate: Option<f64>,
    pub(super) engagement: f64,
}

/// Least and largest.
fn extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

/// Median of a value over grooves; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

impl Against {
    /// The longest run of grooves that are full, from and to.
    fn full_run(&self, grooves: &[Groove]) -> Option<[f64; 2]> {
        let root = median(grooves.iter().map(|groove| groove.root).collect());
        let crest = median(grooves.iter().map(|groove| groove.crests[0]).collect());
        let alike = root + ALIKE.0.max(ALIKE.1 * (crest - root));
        let deep = self.full_root.map_or(alike, |go| go.max(root) + NEAR_MM);
        let mut best: Option<[f64; 2]> = None;
        let mut run: Option<[f64; 2]> = None;
        for groove in grooves.iter().filter(|groove| groove.root <= deep) {
            run = match run {
                Some([from, to]) if groove.z - to < GAP * self.pitch => Some([from, groove.z]),
                _ => Some([groove.z, groove.z]),
            };
            let longer = |[from, to]: [f64; 2]| best.is_none_or(|[a, b]| to - from > b - a);
            best = run.filter(|run| longer(*run)).or(best);
        }
        best
    }

    /// Everything, if there is a turn of full thread between its ends.
    pub(super) fn sizes(&self, all: &[Groove]) -> Option<TurnedSizes> {
        let [low, high] = self.expected;
        let inside = |groove: &&Groove| groove.z > low + self.pitch && groove.z < high - self.pitch;
        let grooves: Vec<Groove> = all.iter().filter(inside).copied().collect();
        let [from, to] = self.full_run(all)?;
        if grooves.is_empty() {
            return None;
        }
        // heights of an inside are radii with their sign changed: the least height is the largest
        // diameter
        let diameters = |[low, high]: [f64; 2]| match self.side {
            Side::External => [low, high].map(|h| Length::mm(2.0 * h)),
            Side::Internal => [high, low].map(|h| Length::mm(-2.0 * h)),
        };
        let roots = diameters(extremes(grooves.iter().map(|groove| groove.root)));
        let crests = diameters(extremes(grooves.iter().flat_map(|groove| groove.crests)));
        let pitch = diameters(extremes(grooves.iter().map(|groove| groove.level)));
        let pitch_error = self.pitch_error(&grooves);
        let jam = Length::mm(3.0_f64.sqrt() * pitch_error);
        let (major, minor, virtual_pitch) = match self.side {
            Side::External => (crests, roots, pitch[1] + jam),
            Side::Internal => (roots, crests, pitch[0] - jam),
        };
        let flanks = self.pitch * 5.0 / 8.0 * crate::insert::TRIANGLE;
        let lowest_crest = extremes(grooves.iter().map(|groove| groove.crests[0]))[0];
        let begins = self.ends[0];
        let ends = self.ends[1];
        let (near, far) =
            if (begins - from).abs() < (begins - to).abs() { (from, to) } else { (to, from) };
        let half = self.pitch / 2.0;
        Some(TurnedSizes {
            major,
            pitch,
            virtual_pitch,
            minor,
            pitch_error: Length::mm(pitch_error),
            flank_error: Length::mm(
                grooves.iter().map(|groove| groove.flank_error).fold(0.0, f64::max),
            ),
            flank_contact: self
                .mate
                .map_or(0.0, |mate| ((lowest_crest - mate) / flanks).clamp(0.0, 1.0)),
            width_at_go: Length::mm(
                grooves.iter().map(|groove| groove.width_at_go).fold(f64::INFINITY, f64::min),
            ),
            full_length: Length::mm(to - from + self.pitch),
            run_in: Length::mm(((begins - near).abs() - half).max(0.0)),
            run_out: Length::mm(((ends - far).abs() - half).max(0.0)),
        })
    }

    fn pitch_error(&self, grooves: &[Groove]) -> f64 {
        let mut most = 0.0_f64;
        let mut last = 0;
        for (first, groove) in grooves.iter().enumerate() {
            while last < grooves.len() && grooves[last].z - groove.z <= self.engagement {
                last += 1;
            }
            let [low, high] = extremes(grooves[first..last].iter().map(|g| g.deviation));
            most = most.max(high - low);
        }
        most
    }
}
