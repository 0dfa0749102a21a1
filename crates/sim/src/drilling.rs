//! A drill at work: thrust and torque from the thickness of its chip.
//!
//! ```text
//!        │ │ D                f   feed per turn
//!        │ │                  F = ½·kc·f·(De − d)/2·sin κ         thrust, N
//!        ╲ ╱ κ = σ/2          M = kc·f·(De² − d²)/8000            torque, N·m
//!         V                   De  diameter the cone has reached, d a wider part already open
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | kc | specific cutting force | N/mm² |
//! | D, σ | diameter, full point angle | mm, ° |
//! | f | feed per turn: what the tip has gained over the last half turn (two lips), times two | mm/rev |
//! | g | how far the tip has come off the ground since | mm |
//!
//! The chip of either lip is f/2 thick; when the tip backs off by g it thins by g, so f − 2g
//! counts. The chisel edge, which adds to the thrust at the centre, is left out. A drill that is
//! fed without turning forward piles up f. It breaks where its core is stressed beyond what a tap's
//! core bears (see [`crate::tapping`]; estimate): a 5 mm drill at 5.3 N·m, four times what a sane
//! feed takes.
//!
//! Source: feed force Ff ≈ ½·kc·Dc/2·fn·sin κr and power Pc = fn·vc·Dc·kc/240·10³ (Sandvik
//! Coromant, *Metal Cutting Technology*, drilling formulas); M follows from Pc = 2π·n·M. A hole
//! opened before takes its share away.
use crate::friction::smooth_sign;
use crate::tapping::{Core, Load, Pose, ROUNDING_RAD_PER_S};
use crate::work::{AT_SURFACE_MM, Bore, ENTERED_MM, Hole, Stock};
use units::{Angle, Length};

/// Lips of a drill.
const LIPS: f64 = 2.0;
/// A drill pushed sideways by this share of its diameter breaks.
pub(crate) const SIDEWAYS_SHARE: f64 = 0.25;

/// A drill in its hole. Lengths in mm, depths from the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drilling {
    /// Index of the hole.
    pub(crate) hole: usize,
    bore: usize,
    core: Core,
    diameter: f64,
    cone: f64,
    sine: f64,
    kc: f64,
    top: f64,
    floor: f64,
    thickness: f64,
    feed: f64,
    angle: f64,
    /// Torque and force that its core bore last, N·m and N.
    stress: (f64, f64),
    /// Deepest since it came in.
    deepest: f64,
}

impl Drilling {
    /// The drill touches the surface, or the floor of what was milled so deep below it. `scale` is
    /// this hole's scatter of the cutting force.
    pub(crate) fn begin(
        diameter: Length,
        point_angle: Angle,
        (stock, floor): (&mut Stock, f64),
        hole: usize,
        pose: &Pose,
        scale: f64,
    ) -> Self {
        let half_point = point_angle.in_rad() / 2.0;
        let cone = diameter.value() / 2.0 / half_point.tan();
        let bores = &mut stock.holes[hole].bores;
        let same = |bore: &Bore| bore.diameter == diameter && bore.cone == Length::mm(cone);
        let bore = bores.iter().position(same).unwrap_or_else(|| {
            bores.push(Bore { diameter, tip_depth: Length::ZERO, cone: Length::mm(cone) });
            bores.len() - 1
        });
        let open = &mut bores[bore].tip_depth;
        *open = open.max(Length::mm(floor));
        Self {
            hole,
            bore,
            core: Core::of(diameter.value()),
            diameter: diameter.value(),
            cone,
            sine: half_point.sin(),
            kc: stock.cutting_n_per_mm2 * scale,
            top: stock.top.value(),
            floor,
            thickness: stock.thickness.map_or(f64::INFINITY, Length::value),
            feed: 0.0,
            angle: pose.angle,
            stress: (0.0, 0.0),
            deepest: 0.0,
        }
    }

    /// The drill is clear of the work: above its surface, or back at it.
    #[inline]
    pub(crate) fn is_out(&self, pose: &Pose) -> bool {
        let floor = self.top - self.floor;
        let back = self.deepest > self.floor + ENTERED_MM && pose.tip >= floor - AT_SURFACE_MM;
        pose.tip >= floor || back
    }

    /// The drill at this pose, after one physics step; `None` where it breaks.
    #[inline]
    pub(crate) fn step(&mut self, pose: &Pose, hole: &mut Hole) -> Option<Load> {
        let depth = self.top - pose.tip;
        self.deepest = self.deepest.max(depth);
        let ground = hole.bores[self.bore].tip_depth.value();
        let gained = (depth - ground).max(0.0);
        // only forward rotation cuts
        let turned = (pose.angle - self.angle).max(0.0);
        self.angle = pose.angle;
        self.feed = (self.feed + LIPS * gained) / (1.0 + LIPS * turned);
        if gained > 0.0 {
            hole.bores[self.bore].tip_depth = Length::mm(depth);
        }
        let chip = self.feed - LIPS * (ground - depth).max(0.0);
        if chip <= 0.0 {
            return Some(Load::default());
        }
        let outer = self.diameter * (depth / self.cone).clamp(0.0, 1.0);
        let inner = self.open_diameter(depth, hole).min(outer);
        let force = 0.5 * self.kc * chip * (outer - inner) / 2.0 * self.sine;
        let torque = self.kc * chip * (outer * outer - inner * inner) / 8000.0;
        self.stress = (torque, force);
        if !self.core.bears(torque, force) {
            return None;
        }
        let turning = torque * smooth_sign(pose.omega / ROUNDING_RAD_PER_S);
        Some(Load { force, torque: turning, friction: torque })
    }

    /// What breaks it as it is stressed now.
    pub(crate) fn broken_by(&self) -> bus::ToolBreak {
        self.core.broken_by(self.stress)
    }

    /// What is open already at the tip: by other bores, or because the tip is through.
    fn open_diameter(&self, depth: f64, hole: &Hole) -> f64 {
        let through = self.diameter * ((depth - self.thickness) / self.cone).clamp(0.0, 1.0);
        let others = hole.bores.iter().enumerate().filter(|(at, _)| *at != self.bore);
        others
            .filter(|(_, bore)| bore.full_depth().value() >= depth)
            .map(|(_, bore)| bore.diameter.value())
            .fold(through, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::stock;

    /// Feed a 5 mm drill down to `depth` at a feed per turn; the last load, and the hole.
    fn drilled(depth: f64, feed: f64, bores: Vec<Bore>) -> (Option<Load>, Hole) {
        let mut stock = stock();
        stock.holes.push(Hole { bores, ..Hole::at(Length::ZERO, Length::ZERO) });
        let top = stock.top.value();
        let omega = 2.0 * core::f64::consts::PI * 50.0;
        let start = Pose { tip: top, angle: 0.0, omega };
        let mut drill =
            Drilling::begin(Length::mm(5.0), Angle::deg(118.0), (&mut stock, 0.0), 0, &start, 1.0);
        let steps = (depth / (feed * 50.0 * 25e-6)).ceil().max(2000.0) as usize;
        let mut load = None;
        for i in 1..=steps {
            let share = i as f64 / steps as f64;
            let pose = Pose { tip: top - depth * share, angle: depth / feed * share, omega };
            load = drill.step(&pose, &mut stock.holes[0]);
            if load.is_none() {
                break;
            }
        }
        (load, stock.holes.remove(0))
    }

    #[test]
    fn a_5_mm_drill_in_c45_at_a_tenth_of_a_millimetre_takes_the_published_thrust_and_torque() {
        let (load, _) = drilled(10.0, 0.1, Vec::new());
        let load = load.expect("a sane feed");
        // ½·3900·0.1·2.5·sin 59° = 417.9 N; 3900·0.1·25/8000 = 1.219 N·m
        assert!((load.force - 417.9).abs() < 0.5, "{} N", load.force);
        assert!((load.torque - 1.219).abs() < 0.002, "{} N·m", load.torque);
    }

    #[test]
    fn the_hole_is_as_deep_as_the_tip_went_and_full_as_deep_less_the_cone() {
        let (_, hole) = drilled(10.0, 0.1, Vec::new());
        let bore = hole.bores[0];
        assert!((bore.tip_depth.value() - 10.0).abs() < 1e-12);
        // 2.5 mm / tan 59° = 1.502 mm
        assert!((bore.full_depth().value() - 8.498).abs() < 1e-3, "{}", bore.full_depth());
    }

    #[test]
    fn in_an_open_hole_it_cuts_only_what_is_left() {
        let open =
            Bore { diameter: Length::mm(4.0), tip_depth: Length::mm(30.0), cone: Length::ZERO };
        let (load, hole) = drilled(10.0, 0.1, vec![open]);
        let load = load.expect("a sane feed");
        assert!((load.force - 417.9 * 0.2).abs() < 0.2, "{} N", load.force);
        assert!((load.torque - 1.219 * (1.0 - 0.64)).abs() < 0.002, "{} N·m", load.torque);
        assert_eq!(hole.bores.len(), 2);
    }

    #[test]
    fn a_drill_breaks_at_a_feed_that_stresses_its_core_beyond_its_limit() {
        assert!(drilled(10.0, 0.3, Vec::new()).0.is_some());
        assert!(drilled(10.0, 0.5, Vec::new()).0.is_none());
    }

    #[test]
    fn a_drill_fed_without_turning_breaks() {
        let (load, hole) = drilled(10.0, 1e6, Vec::new());
        assert_eq!(load, None);
        assert!(hole.bores[0].tip_depth.value() < 2.0, "{:?}", hole.bores[0]);
    }
}
