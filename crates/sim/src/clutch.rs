//! A clutch holder: splines that drive only while the tap is not pulled out too far, and a pawl for
//! the way back.
//!
//! ```text
//!            │ arbor   │                    s: how far the tap has been pulled out of its home, against the spring
//!            │ ╔═════╗ │ splines mesh over D
//!      home  │ ║     ║ │               s < D            splines: tap turns with the spindle, both ways
//!     s = 0 ─┤ ║     ║ ├─ s            s ≥ D, inwards   parted: tap stands, spindle turns on
//!            │ ╚══╤══╝ │               s ≥ D, outwards  after β the pawl is in its notch: tap turns back
//!            └────┼────┘
//!                 ▼ tap
//!
//!            s reaches D                spindle turned back by β
//!   Splines ────────────► Free { gap } ──────────────────────────► Free { 0 }: driven by the pawl
//!      ▲                     │  ▲ inwards: the pawl slips over the notch, gap = β
//!      └──── s below D ──────┘  └┘
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s, D | slide, length of the splines | mm |
//! | β | spindle angle until the pawl drives, counted from the reversal | rev |
//! | H | lead of the tap | mm/rev |
//!
//! The splines part *within* a physics step: of that step the tap turns only the share that brings
//! s to D, so the depth does not depend on the step. The spring, the home stop's cushion and the
//! stop beyond the splines are the axial springs of [`crate::seat`]. Neglected: the friction of the
//! splines, the torque that lifts the pawl, and that splines mesh at whole teeth only.
//!
//! Source: JPS6020134B2, figures 2 and 4.
use crate::Clutch;

/// Splines mesh again this far below D, mm: nearer than that they have not left it.
const MESH_MM: f64 = 1e-6;

/// What drives the tap.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Link {
    /// The splines, both ways.
    Splines,
    /// Nothing inwards; the pawl outwards, once the spindle has turned back by `gap`, rev.
    Free { gap: f64 },
}

/// A clutch at work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coupling {
    spline: f64,
    backlash: f64,
    link: Link,
}

impl Coupling {
    /// At home.
    pub(crate) const fn new(clutch: &Clutch) -> Self {
        Self {
            spline: clutch.spline_length.value(),
            backlash: clutch.pawl_backlash.value(),
            link: Link::Splines,
        }
    }

    /// Where the tap stands after the spindle has turned by `turned`, from `angle`, both in rev,
    /// and whether it was driven. `slide` says how far out a tap at an angle is, mm; it grows by
    /// `per_rev` with each turn inwards.
    pub(crate) fn follow(
        &mut self,
        angle: f64,
        turned: f64,
        is_inward: bool,
        slide: impl Fn(f64) -> f64,
        per_rev: f64,
    ) -> (f64, bool) {
        if let Link::Free { .. } = self.link
            && slide(angle) < self.spline - MESH_MM
        {
            self.link = Link::Splines;
        }
        match self.link {
            Link::Splines => {
                let to = angle + turned;
                let over = slide(to) - self.spline;
                if over < 0.0 {
                    return (to, true);
                }
                self.link = Link::Free { gap: self.backlash };
                if !is_inward {
                    return (to, true); // the axis has pulled them apart
                }
                let beyond = if per_rev > 0.0 { over / per_rev } else { 0.0 };
                (to - beyond.min(turned.abs()).copysign(turned), true)
            }
            Link::Free { .. } if is_inward => {
                self.link = Link::Free { gap: self.backlash };
                (angle, false)
            }
            Link::Free { gap } => {
                let left = gap - turned.abs();
                self.link = Link::Free { gap: left.max(0.0) };
                if left > 0.0 { (angle, false) } else { (angle - left.copysign(-turned), true) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cutting::{Cutting, ForceScatter};
    use crate::fixtures::{m6, stock};
    use crate::{Holder, Tap, Tool, ToolKind};
    use core::f64::consts::TAU;
    use units::{Angle, Length, Stiffness};

    /// Revolutions a second: S3000; with M6 that is 50 mm/s.
    const N: f64 = 50.0;
    /// D, mm, and β, rev.
    const SPLINES: f64 = 5.0;
    const BACKLASH: f64 = 0.1;
    const STEP: f64 = 25e-6;
    const RAPID: f64 = 800.0;

    /// One cycle with an ideal spindle (straight ramps) and a feed that starts and stops at once.
    struct Cycle {
        /// R plane over the work, feed stroke, mm; dwell and stopping time, s.
        clearance: f64,
        stroke: f64,
        dwell: f64,
        stopping: f64,
        compression: f64,
    }

    /// What came of it.
    #[derive(Debug)]
    struct Made {
        depth: f64,
        /// Slide on the way back, 5 mm below the R plane.
        left: f64,
        slide_max: f64,
        force_max: f64,
        broken: bool,
        holder_home: bool,
    }

    impl Cycle {
        fn usual(dwell: f64) -> Self {
            Self { clearance: 2.0, stroke: 12.0, dwell, stopping: 0.08, compression: 0.0 }
        }

        /// Distance fed below R, mm.
        fn fed(&self, t: f64) -> f64 {
            let (down, back) = (self.stroke / N, self.stroke / N + 2.0 * self.dwell);
            if t < down {
                N * t
            } else if t < back {
                self.stroke
            } else if t < back + down {
                self.stroke - N * (t - back)
            } else {
                -RAPID * (t - back - down)
            }
        }

        /// Spindle angle and speed: +n, then from the reversal on a straight ramp to −n.
        fn turned(&self, t: f64) -> (f64, f64) {
            let reversal = self.stroke / N + self.dwell;
            let (since, accel) = (t - reversal, N / self.stopping);
            if since < 0.0 {
                return (N * t, N);
            }
            let ramp = since.min(2.0 * self.stopping);
            let turned = N * reversal + N * ramp - accel * ramp * ramp / 2.0;
            (turned - N * (since - ramp), N - accel * ramp)
        }

        /// With an ideal seat: no play, stiff flanks, a weak spring.
        fn run(&self) -> Made {
            let clutch = Clutch {
                spline_length: Length::mm(SPLINES),
                pawl_backlash: Angle::rev(BACKLASH),
                compression: Length::mm(self.compression),
            };
            let tap = Tap {
                flank_play: Length::ZERO,
                flank_stiffness: Stiffness::n_per_mm(1e6),
                holder: Holder { stiffness: Stiffness::n_per_mm(5.0), travel: None },
                clutch: Some(clutch),
                ..m6()
            };
            self.run_with(tap)
        }

        fn run_with(&self, tap: Tap) -> Made {
            let tool = Tool { number: 1, length: Length::mm(100.0), kind: ToolKind::Tap(tap) };
            let work = stock();
            let r_plane = (work.top + tool.length).value() + self.clearance;
            let mut cutting = Cutting::new(work, vec![tool], ForceScatter::even());
            cutting.begin_period(Some(1), [Length::ZERO; 2]);
            let mut made = Made {
                depth: 0.0,
                left: 0.0,
                slide_max: 0.0,
                force_max: 0.0,
                broken: false,
                holder_home: false,
            };
            let returned = 2.0 * (self.stroke / N + self.dwell);
            let end = returned + 0.5;
            for step in 1..(end / STEP) as u32 {
                let t = f64::from(step) * STEP;
                let (axis, (angle, spin)) = (r_plane - self.fed(t), self.turned(t));
                if !cutting.is_idle(axis) {
                    cutting.step(axis, angle, spin * TAU);
                }
                let slide = -cutting.deflection().value();
                made.slide_max = made.slide_max.max(slide);
                made.force_max = made.force_max.max(cutting.load().force.abs());
                if t <= returned - 5.0 / N {
                    made.left = slide;
                }
                cutting.begin_period(Some(1), [Length::ZERO; 2]);
            }
            made.depth = cutting.holes()[0].thread.map_or(0.0, |thread| thread.tip_depth.value());
            made.broken = cutting.is_broken();
            made.holder_home = cutting.deflection() == Length::ZERO;
            made
        }
    }

    #[test]
    fn the_depth_is_the_feed_less_the_clearance_plus_the_splines_whatever_the_dwell_and_the_coast()
    {
        for (dwell, stopping) in
            [(0.19, 0.08), (0.2, 0.08), (0.22, 0.08), (0.14, 0.05), (0.17, 0.05), (0.25, 0.1)]
        {
            let made = Cycle { stopping, ..Cycle::usual(dwell) }.run();
            assert!((made.depth - (12.0 - 2.0 + 5.0)).abs() < 1e-3, "{dwell} s: {made:?}");
            assert!((made.slide_max - SPLINES).abs() < 1e-3, "{made:?}");
        }
    }

    #[test]
    fn of_too_short_a_dwell_the_coast_goes_into_the_depth() {
        // t_stop ≤ e < t_d = 0.1 s: depth = feed − clr + H·n·(e + t_stop/2), while that is less
        // than D
        let with = |dwell| Cycle { stopping: 0.02, ..Cycle::usual(dwell) }.run();
        for dwell in [0.03, 0.05, 0.07] {
            let (made, exact) = (with(dwell), 10.0 + N * (dwell + 0.01));
            assert!((made.depth - exact).abs() < 1e-3, "{dwell} s: {} for {exact}", made.depth);
        }
        let made = with(0.095);
        assert!((made.depth - 15.0).abs() < 1e-3, "min(D, …): {made:?}");
    }

    #[test]
    fn the_slide_left_at_the_exit_is_the_closed_form() {
        // s_exit = D − H·[n(e − 1.5·t_stop) − β] = 5 − 50·(e − 0.12) + 0.1
        for dwell in [0.185, 0.20, 0.215] {
            let made = Cycle::usual(dwell).run();
            let exact = SPLINES - (N * (dwell - 1.5 * 0.08) - BACKLASH);
            assert!((made.left - exact).abs() < 1e-3, "{dwell} s: {} for {exact}", made.left);
            assert!(!made.broken && made.holder_home, "{made:?}");
        }
    }

    #[test]
    fn more_slide_left_than_clearance_pulls_the_tap_through_its_thread_at_rapid() {
        // s_exit 5.1 mm with 2 mm of clearance: at R the tap is still 3 mm in its thread
        let made = Cycle::usual(0.12).run();
        assert!(made.left > 4.9, "{made:?}");
        // a millimetre of full thread bears 7.07 kN, and the chamfer is 2.5 mm long
        let strips = |depth: f64| 7074.0 * (1.25 + depth - 2.5);
        assert!(made.force_max > strips(2.6) && made.force_max < strips(3.2), "{made:?}");
        // in the window nothing is pulled
        assert!(Cycle::usual(0.20).run().force_max < 100.0);
    }

    #[test]
    fn too_long_a_dwell_drives_the_holder_against_its_home_and_a_cushion_forgives_it() {
        // s_exit = 5 − 50·(0.25 − 0.12) + 0.1 = −1.4 mm
        let hard = Cycle::usual(0.25).run();
        assert!(hard.broken || hard.force_max > 1000.0, "{hard:?}");
        let soft = Cycle { compression: 3.0, ..Cycle::usual(0.25) }.run();
        assert!(!soft.broken && soft.force_max < 5.0 * 6.0, "{soft:?}");
    }

    #[test]
    fn the_axial_force_is_the_springs() {
        // 5 N/mm pulled out by 5 mm
        let made = Cycle::usual(0.20).run();
        assert!((made.force_max - 25.0).abs() < 0.1, "{made:?}");
    }

    #[test]
    fn while_the_splines_are_apart_the_tap_does_not_load_the_spindle_and_stands() {
        let slide_at = |angle: f64| angle; // 1 mm a turn, mm
        let clutch = Clutch {
            spline_length: Length::mm(5.0),
            pawl_backlash: Angle::rev(0.1),
            compression: Length::ZERO,
        };
        let mut coupling = Coupling::new(&clutch);
        assert_eq!(coupling.follow(4.0, 0.5, true, slide_at, 1.0), (4.5, true));
        let (stopped, driven) = coupling.follow(4.5, 2.0, true, slide_at, 1.0);
        assert!((stopped - 5.0).abs() < 1e-12 && driven);
        assert_eq!(coupling.follow(stopped, 3.0, true, slide_at, 1.0), (stopped, false));
        // back: a tenth of a turn free, then the pawl
        assert_eq!(coupling.follow(stopped, -0.06, false, slide_at, 1.0), (stopped, false));
        let (back, driven) = coupling.follow(stopped, -0.06, false, slide_at, 1.0);
        assert!((back - (stopped - 0.02)).abs() < 1e-12 && driven);
        // below D the splines drive again, both ways
        let (again, driven) = coupling.follow(back, 0.01, true, slide_at, 1.0);
        assert!((again - (back + 0.01)).abs() < 1e-12 && driven);
    }
}
