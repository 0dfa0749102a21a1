//! The grooves of a turned thread in axial sections of the bar, and their measures.
//!
//! ```text
//!   height ▲   crest ┌──╮      ╭──┐     height: radius outside, minus radius inside, so that more is more material
//!          │            ╲    ╱          pitch level ℓ: where the groove is P/2 wide; ∅ 2·ℓ is the simple pitch diameter (ISO 5408)
//!          │        ℓ ─ ─╲P/2╱─ ─       a groove that is not so wide at its crest is extended by its flanks
//!          │         root ╰──╯
//!          └─────────────────────► z    middle of the groove at ℓ, less the helix at that section: pitch deviation
//! ```
use crate::bar::{SECTIONS, TurnedBar};
use crate::insert::Side;

/// Less than this is no cut, mm: noise of a record, and marks of the turning before.
pub(super) const TOUCH_MM: f64 = 0.005;
/// Halvings of the pitch level's bracket.
const HALVINGS: u32 = 40;
/// Levels at which the flanks are compared with a V.
const LEVELS: u32 = 8;
/// Of the flank's height next to the crest and to the root this share is not compared.
const ENDS: f64 = 0.1;

/// What is looked for in the sections.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) side: Side,
    /// Machine Z of the tip between which the thread is expected, rising.
    pub(super) range: [f64; 2],
    /// Travel along Z per turn of the work, signed: positive is right hand.
    pub(super) lead: f64,
    /// Of half the insert's angle.
    pub(super) half_tan: f64,
    /// Height below which a groove lies; `None`: half of what is there.
    pub(super) middle: Option<f64>,
}

/// A groove in one section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Groove {
    /// Middle at the pitch level, machine Z.
    pub(super) z: f64,
    pub(super) root: f64,
    /// The lower one of the crests beside it, and the higher one.
    pub(super) crests: [f64; 2],
    /// Where it is half a pitch wide.
    pub(super) level: f64,
    /// Width at the level where the Go gauge's crest must find room; `None` where it does not reach
    /// that level.
    pub(super) width_at_go: f64,
    /// Largest distance of a flank from the V through the pitch level, along the axis.
    pub(super) flank_error: f64,
    /// Middle less the helix, by the middle of all.
    pub(super) deviation: f64,
}

/// One section between two places.
struct Section {
    first: usize,
    before: Vec<f64>,
    heights: Vec<f64>,
    middle: Option<f64>,
}

impl Section {
    fn new(frame: &Frame, bars: [&TurnedBar; 2], section: usize) -> Self {
        let [before, after] = bars;
        let (places, step) = after.places();
        let rear = after.stock().rear.value();
        let index = |z: f64| ((z - rear) / step).clamp(0.0, places as f64) as usize;
        let [first, last] = frame.range.map(index);
        let within = |bar: &TurnedBar| -> Vec<f64> {
            bar.heights(section, frame.side).skip(first).take(last - first).collect()
        };
        Self { first, before: within(before), heights: within(after), middle: frame.middle }
    }

    fn is_touched(&self, at: usize) -> bool {
        self.before[at] - self.heights[at] > TOUCH_MM
    }

    /// Deepest place of each groove that lies wholly within, and the grooves' number.
    fn roots(&self) -> Vec<usize> {
        let touched = (0..self.heights.len()).filter(|at| self.is_touched(*at));
        let (mut root, mut crest) = (f64::INFINITY, f64::NEG_INFINITY);
        for at in touched {
            (root, crest) = (root.min(self.heights[at]), crest.max(self.before[at]));
        }
        let middle = self.middle.unwrap_or_else(|| f64::midpoint(root, crest));
        let (mut roots, mut begun) = (Vec::new(), None);
        for at in 0..=self.heights.len() {
            let inside =
                at < self.heights.len() && self.is_touched(at) && self.heights[at] < middle;
            match (begun, inside) {
                (None, true) => begun = Some(at),
                (Some(from), false) => {
                    begun = None;
                    if from > 0 && at < self.heights.len() {
                        roots.push(self.deepest(from, at));
                    }
                }
                _ => {}
            }
        }
        roots
    }

    /// Middle of the deepest places from `from` to before `to`.
    fn deepest(&self, from: usize, to: usize) -> usize {
        let least = self.heights[from..to].iter().copied().fold(f64::INFINITY, f64::min);
        let is = |at: &usize| self.heights[*at] <= least + 1e-9;
        let low = (from..to).find(is).unwrap_or(from);
        let high = (from..to).rev().find(is).unwrap_or(from);
        usize::midpoint(low, high)
    }

    fn highest(&self, from: usize, to: usize) -> f64 {
        self.heights[from..=to].iter().copied().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Places, not whole, at which the groove's flanks reach a level; `None` where one does not.
    fn flanks(&self, root: usize, ends: [usize; 2], level: f64) -> Option<[f64; 2]> {
        let between = |inner: usize, outer: usize| {
            let (low, high) = (self.heights[inner], self.heights[outer]);
            let share = if high > low { (level - low) / (high - low) } else { 1.0 };
            inner as f64 + share * (outer as f64 - inner as f64)
        };
        let left = (ends[0]..root).rev().find(|at| self.heights[*at] >= level)?;
        let right = (root + 1..=ends[1]).find(|at| self.heights[*at] >= level)?;
        Some([between(left + 1, left), between(right - 1, right)])
    }
}

/// Distance of neighbouring grooves along the axis, as a whole share of the lead: the number of
/// starts. `None` where there are not two.
pub(super) fn starts(frame: &Frame, bars: [&TurnedBar; 2]) -> Option<u32> {
    let (_, step) = bars[1].places();
    let (mut length, mut count) = (0, 0);
    for section in 0..SECTIONS {
        let roots = Section::new(frame, bars, section).roots();
        if let (Some(first), Some(last)) = (roots.first(), roots.last()) {
            (length, count) = (length + last - first, count + roots.len() - 1);
        }
    }
    let pitch = length as f64 * step / f64::from(u32::try_from(count).ok().filter(|n| *n > 0)?);
    Some((frame.lead.abs() / pitch).round().clamp(1.0, 1000.0) as u32)
}

/// Machine Z between which the passes have taken something off the bar, in any section.
pub(super) fn touched(side: Side, bars: [&TurnedBar; 2]) -> Option<[f64; 2]> {
    let mut ends: Option<[f64; 2]> = None;
    for section in 0..SECTIONS {
        let pairs = bars[0].heights(section, side).zip(bars[1].heights(section, side));
        for (place, _) in pairs.enumerate().filter(|(_, (before, after))| before - after > TOUCH_MM)
        {
            let z = bars[1].z(place);
            let [low, high] = ends.unwrap_or([z, z]);
            ends = Some([low.min(z), high.max(z)]);
        }
    }
    ends
}

/// All grooves that lie wholly within, by rising Z. `go`: the level at which the Go gauge's crest
/// must find room.
pub(super) fn grooves(
    frame: &Frame,
    bars: [&TurnedBar; 2],
    pitch: f64,
    go: Option<f64>,
) -> Vec<Groove> {
    let mut all = Vec::new();
    for index in 0..SECTIONS {
        let section = Section::new(frame, bars, index);
        let roots = section.roots();
        for (k, root) in roots.iter().enumerate() {
            let low = if k > 0 { roots[k - 1] } else { 0 };
            let high = roots.get(k + 1).copied().unwrap_or(section.heights.len() - 1);
            let mut groove = measured(&section, *root, [low, high], frame, pitch, go, bars[1]);
            // where the helix is in this section: z rises by the lead while the work turns once
            groove.deviation = groove.z - frame.lead * index as f64 / SECTIONS as f64;
            all.push(groove);
        }
    }
    all.sort_by(|a, b| a.z.total_cmp(&b.z));
    if let Some(reference) = all.get(all.len() / 2).map(|groove| groove.deviation) {
        for groove in &mut all {
            let off = groove.deviation - reference;
            groove.deviation = off - pitch * (off / pitch).round();
        }
    }
    all
}

fn measured(
    section: &Section,
    root: usize,
    ends: [usize; 2],
    frame: &Frame,
    pitch: f64,
    go: Option<f64>,
    bar: &TurnedBar,
) -> Groove {
    let (_, step) = bar.places();
    let width =
        |level: f64| section.flanks(root, ends, level).map(|[left, right]| (right - left) * step);
    let crests = [section.highest(ends[0], root), section.highest(root, ends[1])];
    let (crest, bottom) = (crests[0].min(crests[1]), section.heights[root]);
    let half_pitch = pitch / 2.0;
    let at_crest = width(crest).unwrap_or(0.0);
    let level = if at_crest < half_pitch {
        crest + (half_pitch - at_crest) / (2.0 * frame.half_tan)
    } else {
        let (mut low, mut high) = (bottom, crest);
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if width(middle).is_some_and(|w| w < half_pitch) { low = middle } else { high = middle }
        }
        f64::midpoint(low, high)
    };
    let middle = section
        .flanks(root, ends, level.min(crest))
        .map_or(root as f64, |[left, right]| f64::midpoint(left, right));
    let foot = go.unwrap_or(bottom).max(bottom);
    let flank_error = (0..=LEVELS)
        .filter_map(|k| {
            let share = ENDS + (1.0 - 2.0 * ENDS) * f64::from(k) / f64::from(LEVELS);
            let at = foot + share * (crest - foot);
            let v = half_pitch + 2.0 * (at - level) * frame.half_tan;
            Some((width(at)? - v).abs() / 2.0)
        })
        .fold(0.0, f64::max);
    Groove {
        z: bar.z(section.first) + middle * step,
        root: bottom,
        crests: [crest, crests[0].max(crests[1])],
        level,
        width_at_go: go.and_then(width).unwrap_or(0.0),
        flank_error: if crest > foot { flank_error } else { 0.0 },
        deviation: 0.0,
    }
}
