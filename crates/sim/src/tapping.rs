//! A tap at work: the helix it must follow, the torque it takes, and when it breaks.
//!
//! ```text
//!   torque │       ╭─── plateau, rising a little with depth (friction tail)
//!          │      ╱    │
//!          │    ╱      │ reversal: the chip's root is sheared (spike), then
//!          │  ╱        │╲___________________ friction of the flanks alone
//!          └─┴─────────┴──────────────────► angle
//!            chamfer enters
//!
//!   Tc = tan 30°·kc·K·(D − D₀)²·(D + 2·D₀)/24000          plateau, N·m
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | kc, K | specific cutting force, factor of the flute form | N/mm², 1 |
//! | D, D₀, P | nominal diameter, bored hole, pitch | mm |
//! | H | lead as Z travel per positive turn: −lead | mm/rev |
//! | e, δ | offset of the spindle from the helix, deflection of the tap | mm |
//! | F | force of the thread on the tap, along +Z | N |
//!
//! Where the tap first bites, spindle angle and Z fix the helix for good; it is kept with the hole,
//! and a second tap of the same lead follows it. The axial balance of [`crate::seat`] gives δ and
//! F. A force on a helix is a torque too, F·H/2π; with it the contact neither makes nor loses
//! energy. Flanks pressed by F also rub.
//!
//! Deeper than the bored hole's full diameter, or than its own thread, the tap jams: its tip stands
//! on the ground while the helix screws it on, so torque climbs by newton metres per hundredth of a
//! millimetre.
//!
//! Pulled off its helix near the surface, where few and low teeth hold it, the tap shears them out
//! of the work and is free:
//!
//! ```text
//!   F > τ·A·∫₀ʰ min(s/c, 1) ds      h of the helix in the work, c the chamfer, A = 0.875·π·D (thread of a nut, FED-STD-H28)
//! ```
//!
//! It breaks where the shear stress by von Mises in its core, √(τ² + σ²/3) at 0.6·D, exceeds
//! [`SHEAR_LIMIT_N_PER_MM2`]: 9.2 N·m for M6, and within 4 % the known figures from M3 (1.1) to M12
//! (73).
//!
//! Source of Tc: the tap makers' torque formula (triangular chip of a 60° thread, sheared at kc).
//! Estimates: the friction tail, the share on reversal (10–30 %), the spike.
use crate::Tap;
use crate::clutch::Coupling;
use crate::friction::{between, smooth_sign};
use crate::mishaps::Mishap;
use crate::seat::Seat;
use crate::work::{AT_SURFACE_MM, ENTERED_MM, Hole, Stock, Thread};
use bus::ToolBreak;
use core::f64::consts::{PI, TAU};
use units::{Angle, Force, Length, Torque};

/// Shear strength of a tap's core, N/mm²: high-speed steel, from known break torques.
pub(crate) const SHEAR_LIMIT_N_PER_MM2: f64 = 1000.0;
/// Core of a tap over its nominal diameter.
const CORE: f64 = 0.6;
/// Torque that friction adds for each diameter of depth, as a share of Tc (estimate).
const TAIL_PER_DIAMETER: f64 = 0.05;
/// Torque of flanks in a thread that is cut already, as a share of Tc (published: 10–30 %).
const RETURN_SHARE: f64 = 0.2;
/// Height of the spike at reversal, as a share of Tc (estimate).
const CHIP_ROOT_SHARE: f64 = 0.5;
/// Over which angle the chip's root is sheared, rev (estimate: a third of the way to the next
/// flute).
const CHIP_ROOT_REV: f64 = 0.1;
/// Friction of pressed flanks, steel on steel with cutting oil (estimate).
const FLANK_FRICTION: f64 = 0.15;
/// Speed over which friction changes its sign, rad/s.
pub(crate) const ROUNDING_RAD_PER_S: f64 = 2.0;
/// A thread of less than this share of a pitch holds no tap: a tenth of a turn of its first tooth
/// (estimate).
const HOLDS_PITCHES: f64 = 0.1;
/// Shear strength τ of the work over its specific cutting force: C45 has 430 of 3900 N/mm².
const SHEAR_OF_CUTTING: f64 = 0.11;
/// Area that is sheared when a thread is stripped, over π·D and its length: of a nut's thread at
/// the tap's crests.
const STRIPPED_AREA: f64 = 0.875;
/// So much of a pitch a ridge is pushed along before it is sheared off (estimate).
const RIDGE_PITCHES: f64 = 0.1;
/// So far beside its first scratch a tap at the surface begins another, mm: on its helix it stands
/// nearer than that.
const SCRATCH_MM: f64 = 1e-3;
/// A tap pushed sideways by this share of its diameter breaks.
pub(crate) const SIDEWAYS_SHARE: f64 = 0.1;

/// What the work does to the machine: force on the Z axis along +Z, N; torque against positive
/// rotation, N·m, and how much of it is friction, which can hold a spindle but never turn it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Load {
    pub(crate) force: f64,
    pub(crate) torque: f64,
    pub(crate) friction: f64,
}

/// Where the tool is: its tip if nothing deflected it, mm; the spindle, rev and rad/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    pub(crate) tip: f64,
    pub(crate) angle: f64,
    pub(crate) omega: f64,
}

/// The tap makers' formula for the plateau, N·m.
pub(crate) fn plateau_torque(kc: f64, flute_factor: f64, diameter: f64, bored: f64) -> f64 {
    let wall = (diameter - bored).max(0.0);
    (PI / 6.0).tan() * kc * flute_factor * wall * wall * (diameter + 2.0 * bored) / 24_000.0
}

/// The core of a tap or drill: what torque and pull stress.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    /// τ for each N·m, N/mm².
    shear_per_n_m: f64,
    /// σ/√3 for each N, N/mm².
    tension_per_n: f64,
    /// What it bears, N/mm².
    limit: f64,
}

impl Core {
    /// Of a tool of this diameter, mm.
    pub(crate) fn of(diameter: f64) -> Self {
        let core = CORE * diameter;
        Self {
            shear_per_n_m: 16.0 * 1e3 / (PI * core.powi(3)),
            tension_per_n: 4.0 / (PI * core * core * 3.0_f64.sqrt()),
            limit: SHEAR_LIMIT_N_PER_MM2,
        }
    }

    /// What breaks it: this torque and pull, beside what it bears of each alone.
    pub(crate) fn broken_by(&self, (torque, force): (f64, f64)) -> ToolBreak {
        ToolBreak::Stress {
            torque: Torque::n_m(torque.abs()),
            force: Force::n(force.abs()),
            most_torque: Torque::n_m(self.limit / self.shear_per_n_m),
            most_force: Force::n(self.limit / self.tension_per_n),
        }
    }

    /// It bears this torque and pull together.
    #[inline]
    pub(crate) fn bears(&self, torque: f64, force: f64) -> bool {
        let (shear, tension) = (self.shear_per_n_m * torque, self.tension_per_n * force);
        shear * shear + tension * tension <= self.limit * self.limit
    }
}

/// A tap in its hole. Lengths in mm, depths from the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tapping {
    /// Index of the hole.
    pub(crate) hole: usize,
    seat: Seat,
    core: Core,
    per_pitch: f64,
    /// Z travel per positive turn.
    lead: f64,
    /// Torque of an axial force on the helix, N·m/N.
    screw: f64,
    /// Torque of the friction of flanks pressed by a force, N·m/N.
    rubbing: f64,
    per_chamfer: f64,
    tail_per_depth: f64,
    plateau: f64,
    top: f64,
    thickness: f64,
    /// Depth at which the tap jams.
    ground: f64,
    helix_angle: f64,
    helix_tip: f64,
    clutch: Option<Coupling>,
    /// Where the spindle stood, and where the tap stands, rev; one and the same without a clutch.
    spindle: f64,
    angle: f64,
    /// Depth of the helix up to which the thread is cut, and was when the tap came.
    cut_to: f64,
    cut_before: f64,
    /// The helix was there before this tap came.
    guided: bool,
    chip_root: bool,
    /// Force that strips a millimetre of full thread, N/mm.
    strips: f64,
    /// How far the axis holds the tap above its helix when that begins, mm; infinite for one that
    /// is free already.
    pulled: f64,
    deflection: f64,
    deepest: f64,
    mishap: Mishap,
    diameter: f64,
    /// Torque and force that its core bore last, N·m and N.
    stress: (f64, f64),
}

impl Tapping {
    /// The tap touches the surface over a hole. `scale` is this hole's scatter of the cutting
    /// force, `slip` how far a clutch has left the tap ahead of the spindle, rev.
    pub(crate) fn begin(
        tap: &Tap,
        (stock, floor): (&Stock, f64),
        hole: usize,
        pose: &Pose,
        scale: f64,
        slip: f64,
    ) -> Self {
        let tap_angle = pose.angle + slip;
        let (diameter, lead) = (tap.diameter.value(), -tap.lead.value());
        let pitch = lead.abs();
        let made = &stock.holes[hole];
        let (bored, bored_to) = pilot(made, diameter, pitch);
        let thickness = stock.thickness.map_or(f64::INFINITY, Length::value) - floor;
        let bored_to = (bored_to - floor).max(0.0);
        let kc = stock.cutting_n_per_mm2 * scale;
        let ground = if bored_to >= thickness { f64::INFINITY } else { bored_to };
        // a thread shorter than one pitch guides nothing
        let guide = made.thread.filter(|t| t.lead == tap.lead && t.tip_depth.value() > pitch);
        let (helix_angle, helix_tip) = guide.map_or((tap_angle, pose.tip), |t| {
            let (angle, tip) = (t.phase_angle.value(), t.phase_tip.value());
            // of the helix' turns, the one nearest to the tap
            let turns = ((pose.tip - tip) / lead - (tap_angle - angle)).round();
            (angle - turns, tip)
        });
        let above = pose.tip - helix_tip - lead * (tap_angle - helix_angle);
        Self {
            hole,
            seat: Seat::new(tap),
            core: Core::of(diameter),
            per_pitch: 1.0 / pitch,
            lead,
            screw: lead / TAU * 1e-3,
            // half the pitch diameter D − 0.6495·P (ISO 68-1)
            rubbing: FLANK_FRICTION * (diameter - 0.6495 * pitch) / 2.0 * 1e-3,
            per_chamfer: 1.0 / (tap.chamfer_pitches * pitch),
            tail_per_depth: TAIL_PER_DIAMETER / diameter,
            plateau: plateau_torque(kc, tap.flute_factor, diameter, bored),
            top: stock.top.value() - floor,
            thickness,
            ground: ground.min(tap.thread_length.value()),
            helix_angle,
            helix_tip,
            clutch: tap.clutch.as_ref().map(Coupling::new),
            spindle: pose.angle,
            angle: tap_angle,
            cut_to: guide.map_or(0.0, |t| t.tip_depth.value()),
            cut_before: guide.map_or(0.0, |t| t.tip_depth.value()),
            guided: guide.is_some(),
            chip_root: false,
            strips: SHEAR_OF_CUTTING * kc * STRIPPED_AREA * PI * diameter,
            pulled: above.max(0.0) + RIDGE_PITCHES * pitch,
            deflection: 0.0,
            deepest: 0.0,
            mishap: Mishap::NONE,
            diameter,
            stress: (0.0, 0.0),
        }
    }

    /// The same tap, which meets this in its hole.
    pub(crate) fn meeting(mut self, mishap: Mishap) -> Self {
        self.core.limit *= mishap.strength;
        self.mishap = mishap;
        self
    }

    /// Both the tap and the spindle are clear of the work: above its surface, or back at it. A
    /// stroke that begins and ends at the surface (R0) ends at it as exactly as axis and spindle
    /// stop, which is never exactly.
    #[inline]
    pub(crate) fn is_out(&self, pose: &Pose) -> bool {
        if self.is_stripped() {
            return pose.tip >= self.top;
        }
        let angle = if self.clutch.is_some() { self.angle } else { pose.angle };
        let helix = self.helix(angle);
        if pose.tip >= self.top && helix >= self.top {
            return true;
        }
        let holds = (HOLDS_PITCHES * self.lead.abs()).max(AT_SURFACE_MM);
        self.deepest > ENTERED_MM
            && pose.tip >= self.top - AT_SURFACE_MM
            && helix >= self.top - holds
    }

    /// Depth of thread that this tap has cut here, mm.
    pub(crate) fn newly_cut(&self) -> f64 {
        self.cut_to - self.cut_before
    }

    /// How far the tap stands ahead of the spindle, rev.
    pub(crate) fn slip(&self) -> f64 {
        self.angle - self.spindle
    }

    /// Turn the tap with the spindle, as far as a clutch lets it; whether it was driven.
    fn follow(&mut self, pose: &Pose) -> bool {
        let turned = pose.angle - self.spindle;
        self.spindle = pose.angle;
        let Some(mut clutch) = self.clutch else {
            self.angle = pose.angle;
            return true;
        };
        let engaged = |helix: f64| self.share_of_chamfer(self.top - helix.min(pose.tip));
        let slide = |angle: f64| {
            let helix = self.helix(angle);
            -self.seat.deflection(pose.tip - helix, engaged(helix))
        };
        let share = self.seat.holder_share(engaged(self.helix(self.angle)));
        let is_inward = turned * self.lead < 0.0;
        let (angle, driven) =
            clutch.follow(self.angle, turned, is_inward, slide, share * self.lead.abs());
        self.angle = angle;
        self.clutch = Some(clutch);
        driven
    }

    /// How far the axis holds the tip off the helix that was cut, mm; `None` for a tap that has
    /// sheared it.
    pub(crate) fn off_helix(&self, tip: f64, angle: f64) -> Option<f64> {
        (!self.is_stripped()).then(|| tip - self.helix(angle))
    }

    /// It has sheared the thread that held it.
    const fn is_stripped(&self) -> bool {
        self.pulled == f64::INFINITY
    }

    /// Shear the thread where a pull of `force`, N, on a tap held `above` its helix is more than it
    /// bears.
    fn strip(&mut self, above: f64, helix_depth: f64, force: f64) {
        let chamfer = self.per_chamfer.recip();
        let (low, full) = (between(helix_depth, 0.0, chamfer), (helix_depth - chamfer).max(0.0));
        let bears = self.strips * (low * low / (2.0 * chamfer) + full);
        if above > self.pulled && force.abs() > bears {
            self.pulled = f64::INFINITY;
        }
    }

    /// Where the helix puts the tip at a spindle angle.
    fn helix(&self, angle: f64) -> f64 {
        self.helix_tip + self.lead * (angle - self.helix_angle)
    }

    /// The tap at this pose, after one physics step; `None` where it breaks.
    #[inline]
    pub(crate) fn step(&mut self, pose: &Pose) -> Option<Load> {
        let driven = self.follow(pose);
        if self.is_stripped() {
            return self.free(pose);
        }
        self.scratch(pose);
        let helix = self.helix(self.angle);
        // an extended holder leaves the tap in the thread after the spindle has gone up
        let engaged = self.share_of_chamfer(self.top - helix.min(pose.tip));
        self.deflection = self.seat.deflection(pose.tip - helix, engaged);
        let force = self.seat.force(self.deflection);
        self.strip(pose.tip - helix, self.top - helix, force);
        let depth = self.top - pose.tip - self.deflection;
        self.deepest = self.deepest.max(depth);
        let jam = self.seat.flank_force((self.top - helix).min(depth) - self.ground);

        let pressed = force.abs() + jam;
        let packed = self.mishap.packed_share(depth / self.diameter, self.deepest / self.diameter);
        let against = self.cutting_torque(self.top - helix, depth, engaged)
            + self.plateau * packed
            + self.rubbing * pressed;
        if !driven {
            // the thread itself holds the tap: it is self-locking
            self.stress = (0.0, pressed);
            return self.core.bears(0.0, pressed).then_some(Load { force, ..Load::default() });
        }
        let torque =
            against * smooth_sign(pose.omega / ROUNDING_RAD_PER_S) + (force - jam) * self.screw;
        self.stress = (torque, pressed);
        self.core.bears(torque, pressed).then_some(Load { force, torque, friction: against })
    }

    /// A tap in a thread that it has sheared: nothing holds it but the ground.
    fn free(&mut self, pose: &Pose) -> Option<Load> {
        self.deflection = 0.0;
        let jam = self.seat.flank_force(self.top - pose.tip - self.ground);
        self.stress = (0.0, jam);
        self.core.bears(0.0, jam).then_some(Load { force: jam, ..Load::default() })
    }

    /// A tap that rests at the surface while it turns scratches it: no helix holds it until it goes
    /// in on one.
    fn scratch(&mut self, pose: &Pose) {
        let rests = !self.guided && self.deepest < AT_SURFACE_MM;
        if rests && (pose.tip - self.helix(self.angle)).abs() > SCRATCH_MM {
            (self.helix_angle, self.helix_tip) = (self.angle, pose.tip);
            self.cut_to = 0.0;
        }
    }

    /// Torque of chips and flanks, without what presses the flanks.
    fn cutting_torque(&mut self, helix_depth: f64, depth: f64, engaged: f64) -> f64 {
        if helix_depth >= self.cut_to {
            self.cut_to = helix_depth;
            self.chip_root = true;
            let share = engaged - self.share_of_chamfer(depth - self.thickness);
            let tail = self.tail_per_depth * depth.clamp(0.0, self.thickness);
            return self.plateau * (share + tail);
        }
        let back = (self.cut_to - helix_depth) * self.per_pitch;
        self.chip_root &= back < CHIP_ROOT_REV;
        let root =
            if self.chip_root { CHIP_ROOT_SHARE * (1.0 - back / CHIP_ROOT_REV) } else { 0.0 };
        self.plateau * engaged * (RETURN_SHARE + root)
    }

    /// How much of the chamfer lies above a depth.
    fn share_of_chamfer(&self, depth: f64) -> f64 {
        between(depth * self.per_chamfer, 0.0, 1.0)
    }

    /// Offset of the cutting edges from where the axis holds them, mm.
    pub(crate) const fn deflection(&self) -> f64 {
        self.deflection
    }

    /// What breaks it as it is stressed now.
    pub(crate) fn broken_by(&self) -> ToolBreak {
        self.core.broken_by(self.stress)
    }

    /// Write down what was cut.
    pub(crate) fn record(&self, tap: &Tap, hole: &mut Hole) {
        let before =
            hole.thread.filter(|t| t.lead == tap.lead).map_or(0.0, |t| t.tip_depth.value());
        hole.thread = Some(Thread {
            diameter: tap.diameter,
            lead: tap.lead,
            phase_angle: Angle::rev(self.helix_angle),
            phase_tip: Length::mm(self.helix_tip),
            tip_depth: Length::mm(self.deepest.max(before)),
        });
    }
}

/// The hole is so wide that the tap meets nothing.
pub(crate) fn is_too_wide(hole: &Hole, tap: &Tap) -> bool {
    pilot(hole, tap.diameter.value(), tap.lead.value().abs()).0 >= tap.diameter.value()
}

/// The bore a tap will find: its diameter and its full depth. Bores narrower than D − 2P are no
/// help to a tap.
fn pilot(hole: &Hole, diameter: f64, pitch: f64) -> (f64, f64) {
    hole.bores
        .iter()
        .map(|bore| (bore.diameter.value(), bore.full_depth().value()))
        .filter(|(bored, to)| *bored >= diameter - 2.0 * pitch && *to > 0.0)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0.0, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn m6_in_c45_takes_1_73_newton_metres() {
        let torque = plateau_torque(3900.0, 1.15, 6.0, 5.0);
        assert!((torque - 1.73).abs() < 0.005, "{torque} N·m");
    }

    #[test]
    fn taps_break_at_the_known_torques() {
        // size, N·m: machine makers' and tap makers' figures; the law is within 5 % of all
        for (size, known) in [
            (3.0, 1.1),
            (4.0, 2.7),
            (5.0, 5.3),
            (6.0, 9.2),
            (8.0, 22.0),
            (10.0, 42.0),
            (12.0, 73.0),
        ] {
            let core = Core::of(size);
            assert!(core.bears(known * 0.95, 0.0) && !core.bears(known * 1.05, 0.0), "M{size}");
        }
    }

    #[test]
    fn pull_and_torque_break_a_tap_together_by_von_mises() {
        // τ² + σ²/3 = 1: 60 % of the one goes with 80 % of the other
        let torque = 0.6 * 1000.0 * PI * 3.6_f64.powi(3) / 16.0 * 1e-3;
        let force = 0.8 * 1000.0 * 3.0_f64.sqrt() * PI * 3.6 * 3.6 / 4.0;
        let core = Core::of(6.0);
        assert!(core.bears(torque * 0.999_999, force) && !core.bears(torque * 1.000_001, force));
    }
}
