//! Where the groove of a turned thread lies on the bar, and what another one is to it.
use super::law::Law;
use crate::insert::{Form, Side};
use canon::{Axis, Hand};

/// A groove lies within another if it is off it by less than this share of the pitch.
const SAME_GROOVE: f64 = 0.25;
/// A place that is passed nearer than this was cut before, mm.
const NEAR_MM: f64 = 0.1;
/// Tapers are the same within this: a micrometre over a centimetre.
const SAME_SLOPE: f64 = 1e-4;
/// Ends of a thread that bar and run-out spoil, in pitches.
const SPOILT_PITCHES: f64 = 1.5;

/// What a block's groove is to a thread that is there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Relation {
    Apart,
    Same,
    AnotherStart,
    /// Off its grooves by this, mm; `None`: another lead or hand.
    Across(Option<f64>),
}

/// Where a groove lies on the bar.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lie {
    pub(super) side: Side,
    /// Lead along Z, signed by hand; 0: it is not the same everywhere, or the thread does not run
    /// along Z.
    pub(super) lead: f64,
    /// How steep a taper is; 0: it is straight.
    pub(super) slope: f64,
    pub(super) starts: u32,
    /// Where its deepest pass lies, as a place along Z at the first section, within a lead.
    pub(super) phase: f64,
    /// Machine Z between which it lies, rising.
    pub(super) span: [f64; 2],
    pub(super) form: Form,
    /// How deep it is, mm.
    pub(super) depth: f64,
}

impl Lie {
    pub(super) fn relation(&self, new: &Self) -> Relation {
        let [low, high] = [self.span[0].max(new.span[0]), self.span[1].min(new.span[1])];
        if self.side != new.side || high - low < self.lead.abs().max(0.5) / 2.0 {
            return Relation::Apart;
        }
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-4 * a.abs().max(b.abs());
        if self.lead == 0.0 || new.lead == 0.0 || !same(self.lead, new.lead) {
            return Relation::Across(None);
        }
        if (self.slope - new.slope).abs() > SAME_SLOPE {
            return Relation::Across(None);
        }
        if self.slope > 0.0 {
            return Relation::Same; // of a taper no more is known
        }
        let pitch = self.lead.abs() / f64::from(self.starts);
        let off = new.phase - self.phase;
        let off = (off - pitch * (off / pitch).round()).abs();
        if off < SAME_GROOVE * pitch {
            return Relation::Same;
        }
        // two grooves beside one another leave the crest between them
        let between = self.form.flanks(self.depth) + new.form.flanks(new.depth);
        if off >= between * 0.98 { Relation::AnotherStart } else { Relation::Across(Some(off)) }
    }

    /// It reaches as far as the other one, but for the ends that bar and run-out spoil.
    pub(super) fn covers(&self, other: &Self) -> bool {
        let uncut = SPOILT_PITCHES * self.lead.abs();
        self.span[0] <= other.span[0] + uncut && self.span[1] >= other.span[1] - uncut
    }

    /// The insert was in the material, or in a groove that is there.
    pub(super) fn touches(&self) -> bool {
        self.depth > -NEAR_MM
    }
}

/// Where the deepest crossings of a helix lie, as a place at the first section within a lead.
pub(super) fn phase(
    crossings: &[crate::bar::Crossing],
    side: Side,
    lead: f64,
    [low, high]: [f64; 2],
) -> f64 {
    const ALIKE_MM: f64 = 0.02;
    let height = |radius: f64| if side == Side::External { radius } else { -radius };
    let within = || crossings.iter().filter(|at| (low..=high).contains(&at.z));
    let least = within().map(|at| height(at.radius)).fold(f64::INFINITY, f64::min);
    let (mut sin, mut cos) = (0.0, 0.0);
    for at in within().filter(|at| height(at.radius) < least + ALIKE_MM) {
        let z = at.z - lead * at.section as f64 / crate::bar::SECTIONS as f64;
        let (s, c) = (std::f64::consts::TAU * z / lead.abs()).sin_cos();
        (sin, cos) = (sin + s, cos + c);
    }
    sin.atan2(cos) / std::f64::consts::TAU * lead.abs()
}

/// Lead of a thread that can be compared with others: along Z, of one lead.
pub(super) fn lead_of(law: &Law<'_>, hand: Hand) -> f64 {
    let is_plain = law.axis() == Axis::Z && !law.varies();
    if is_plain { hand.sign() * law.main().lead().abs() } else { 0.0 }
}

/// Grooves of several starts that are wider than they are apart.
pub(super) fn overlap(form: &Form, depth: f64, pitch: f64, starts: u32) -> Option<String> {
    let width = 2.0 * form.flanks(depth);
    (starts > 1 && depth > 0.0 && width > pitch * 1.02).then(|| {
        format!("cut across itself: {starts} grooves {width:.3} mm wide lie {pitch:.3} mm apart")
    })
}
