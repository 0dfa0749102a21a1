//! What comes of a tool that is led by hand: no axis, no drive, only the work.
use super::*;
use crate::Holder;
use crate::fixtures::{m6, stock, tapping_center};
use crate::oracle::thread::force_at_offset;
use crate::tapping::plateau_torque;
use core::f64::consts::TAU;
use units::{Angle, Lead, Stiffness};

const DRILL: u32 = 1;
const TAP: u32 = 2;

/// A tool led by hand: no axis, no drive, only the work.
struct Hand {
    cutting: Cutting,
    /// Of the axis over the point at which the tip touches the surface, mm.
    z: f64,
    turns: f64,
    worst: Load,
    /// Done on the tool since the beginning, J; and how far below zero that ever was.
    work: f64,
    returned: f64,
}

impl Hand {
    fn new(stock: Stock, magazine: Vec<Tool>) -> Self {
        let cutting = Cutting::new(stock, magazine, ForceScatter::even());
        Self { cutting, z: 1.0, turns: 0.0, worst: Load::default(), work: 0.0, returned: 0.0 }
    }

    fn usual() -> Self {
        Self::new(stock(), tapping_center().magazine)
    }

    fn with_tap(tap: Tap) -> Self {
        let tool = Tool { number: TAP, length: Length::mm(100.0), kind: ToolKind::Tap(tap) };
        Self::new(stock(), vec![tool])
    }

    fn take(&mut self, tool: u32, x_mm: f64) -> &mut Self {
        self.cutting.begin_period(Some(tool), [Length::mm(x_mm), Length::ZERO]);
        self
    }

    /// Lead it in a straight line of (z, turns) at a spindle speed that is well above rounding.
    fn lead(&mut self, z: f64, turns: f64) -> Load {
        let steps = 4000;
        let (dz, dt) = ((z - self.z) / f64::from(steps), (turns - self.turns) / f64::from(steps));
        let omega = 100.0 * if dt == 0.0 { 0.0 } else { dt.signum() };
        self.worst = Load::default();
        let tool_length = self.cutting.mounted.map_or(0.0, |t| t.length.value());
        for _ in 0..steps {
            let before = self.cutting.load();
            self.z += dz;
            self.turns += dt;
            let axis = self.cutting.stock.top.value() + tool_length + self.z;
            if !self.cutting.is_idle(axis) {
                self.cutting.step(axis, self.turns, omega);
            }
            let load = self.cutting.load();
            self.worst.torque = self.worst.torque.max(load.torque.abs());
            self.worst.force = self.worst.force.max(load.force.abs());
            self.work += f64::midpoint(before.torque, load.torque) * dt * TAU
                - f64::midpoint(before.force, load.force) * dz * 1e-3;
            self.returned = self.returned.max(-self.work);
        }
        (self.z, self.turns) = (z, turns); // without the rounding of the steps
        // the machine tells where it is once a period
        self.cutting.begin_period(self.cutting.mounted.map(|t| t.number), self.cutting.at);
        self.cutting.load()
    }
}

#[test]
fn an_m6_tap_in_c45_takes_its_torque_over_the_chamfer_and_little_on_the_way_out() {
    let mut hand = Hand::usual();
    hand.take(TAP, 0.0).lead(0.0, 1.0);
    let half_chamfer = hand.lead(-1.25, 2.25).torque;
    let plateau = hand.lead(-2.5, 3.5).torque;
    let deep = hand.lead(-12.0, 13.0).torque;
    // 1.73 N·m; friction tail of 5 % for each 6 mm of depth
    assert!((half_chamfer - 1.73 * (0.5 + 0.05 * 1.25 / 6.0)).abs() < 0.01, "{half_chamfer}");
    assert!((plateau - 1.73 * (1.0 + 0.05 * 2.5 / 6.0)).abs() < 0.01, "{plateau}");
    assert!((deep - 1.73 * 1.1).abs() < 0.01, "{deep}");
    let out = -hand.lead(-6.0, 7.0).torque;
    assert!((0.1..=0.3).contains(&(out / 1.73)), "{out}");
    assert!(hand.worst.torque > 0.6 * 1.73, "the chip's root: {}", hand.worst.torque);
    hand.lead(1.0, 0.0);
    assert_eq!(hand.cutting.load(), Load::default());
    assert!(!hand.cutting.is_broken());
}

#[test]
fn a_sync_offset_presses_holder_and_flanks_by_their_springs_in_a_row() {
    for holder in [
        Holder { stiffness: Stiffness::n_per_mm(20_000.0), travel: None },
        Holder { stiffness: Stiffness::n_per_mm(500.0), travel: Some(Length::mm(0.5)) },
        Holder { stiffness: Stiffness::n_per_mm(20.0), travel: Some(Length::mm(8.0)) },
    ] {
        let tap = Tap { holder, ..m6() };
        let mut hand = Hand::with_tap(tap);
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        hand.lead(-6.0, 6.0);
        let force = hand.lead(-6.05, 6.0).force; // 50 µm too deep
        let flank = tap.flank_stiffness;
        let exact = force_at_offset(Length::mm(0.05), holder.stiffness, flank, tap.flank_play);
        assert!((force - exact.value()).abs() < 1e-3 * exact.value(), "{force} N, {exact}");
        let bent = hand.cutting.deflection().value();
        assert!((bent - exact.value() / holder.stiffness.value()).abs() < 1e-6, "{bent} mm");
    }
}

#[test]
fn a_tension_compression_holder_forgives_what_breaks_a_tap_in_a_collet() {
    let soft = Holder { stiffness: Stiffness::n_per_mm(20.0), travel: Some(Length::mm(8.0)) };
    for (holder, breaks) in [(m6().holder, true), (soft, false)] {
        let mut hand = Hand::with_tap(Tap { holder, ..m6() });
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        hand.lead(-6.0, 6.0);
        hand.lead(-8.0, 6.0); // the spindle stands, the axis goes on by two millimetres
        assert_eq!(hand.cutting.is_broken(), breaks);
    }
}

#[test]
fn an_extended_holder_keeps_the_tap_in_the_thread_until_it_is_screwed_out() {
    let holder = Holder { stiffness: Stiffness::n_per_mm(20.0), travel: Some(Length::mm(8.0)) };
    let mut hand = Hand::with_tap(Tap { holder, ..m6() });
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    hand.lead(-5.0, 5.0);
    hand.lead(1.0, 5.0); // pulled up without turning: 6 mm on 20 N/mm
    let force = hand.cutting.load().force;
    assert!((force + 119.9).abs() < 0.2, "{force} N");
    hand.lead(1.0, 0.0);
    assert_eq!(hand.cutting.load().force, 0.0);
}

/// τ = 0.11·3900 N/mm², A = 0.875·π·6 mm: 7.07 kN for a millimetre of full thread, and the core
/// tears at 17.6 kN. The chamfer is 2.5 mm long.
#[test]
fn a_tap_that_is_pulled_straight_out_strips_a_short_thread_and_breaks_in_a_long_one() {
    let pulled_at = |depth: f64| {
        let mut hand = Hand::usual();
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        hand.lead(-12.0, 12.0);
        hand.lead(-depth, depth);
        hand.lead(5.0, depth);
        hand
    };
    let short = pulled_at(3.0);
    let exact = 0.11 * 3900.0 * 0.875 * core::f64::consts::PI * 6.0 * (2.5 / 2.0 + 0.5);
    assert!((short.worst.force - exact).abs() < 0.01 * exact, "{} N, {exact}", short.worst.force);
    assert!(!short.cutting.is_broken() && short.cutting.load() == Load::default());
    // a third of a pitch: held by a few low teeth, which give by a tenth of a pitch
    let last = pulled_at(0.3);
    let (tap, share) = (m6(), 0.3 / 2.5);
    let (offset, flank) = (Length::mm(0.1), tap.flank_stiffness * share);
    let exact = force_at_offset(offset, tap.holder.stiffness, flank, tap.flank_play).value();
    assert!((last.worst.force - exact).abs() < 0.03 * exact, "{} N, {exact}", last.worst.force);
    assert!(!last.cutting.is_broken() && last.cutting.off_helix(0.0, 0.0).is_none());
    assert!(pulled_at(6.0).cutting.is_broken());
}

#[test]
fn force_on_the_helix_and_torque_exchange_power_without_loss() {
    let mut hand = Hand::usual();
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    hand.lead(-6.0, 6.0);
    let level = |hand: &mut Hand, z: f64| hand.lead(z, 6.0);
    // two offsets of equal size press equally; the screw's part of the torque changes its sign,
    // and without rotation there is no friction in it
    let (low, high) = (level(&mut hand, -6.05), level(&mut hand, -5.95));
    let screw = low.force * 1.0 / TAU * 1e-3;
    assert!((low.torque + screw).abs() < 1e-9, "{} {screw}", low.torque);
    assert!((low.torque + high.torque).abs() < 1e-9);
}

#[test]
fn over_a_way_in_and_out_the_work_takes_energy_and_never_gives_any() {
    let soft = Holder { stiffness: Stiffness::n_per_mm(500.0), travel: Some(Length::mm(0.5)) };
    for (holder, offset) in [(m6().holder, 0.0), (m6().holder, 0.03), (soft, -0.2)] {
        let mut hand = Hand::with_tap(Tap { holder, ..m6() });
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        for (z, turns) in [
            (-3.0, 3.0),
            (-6.0 + offset, 6.0),
            (-6.0 - offset, 6.0),
            (-5.0 + offset, 5.0),
            (-7.0, 7.0 + offset),
            (1.0 + offset, -1.0),
        ] {
            hand.lead(z, turns);
        }
        // at least the chips of seven turns: mean torque 1.73 N·m less the chamfer's way in
        let chips = 1.73 * (7.0 - 1.25) * TAU;
        assert!(!hand.cutting.is_broken());
        assert!(hand.work > chips && hand.work < 2.0 * chips, "{} J, {chips} J", hand.work);
        assert!(hand.returned < 1e-3 * chips, "{} J more than was stored", hand.returned);
    }
}

#[test]
fn a_second_tap_in_the_same_hole_follows_the_first_ones_helix() {
    let soft = Holder { stiffness: Stiffness::n_per_mm(20.0), travel: Some(Length::mm(8.0)) };
    let mut hand = Hand::with_tap(Tap { holder: soft, ..m6() });
    hand.take(TAP, 0.0).lead(0.0, 0.25);
    hand.lead(-6.0, 6.25);
    hand.lead(1.0, -0.75);
    let before = hand.cutting.holes()[0].thread;
    // a tenth of a turn off: the tap is drawn over by a tenth of a millimetre, less half the play
    hand.lead(0.0, 10.35);
    hand.lead(-5.5, 15.85);
    let bent = hand.cutting.deflection().value();
    assert!((bent - 0.095).abs() < 1e-4 || (bent + 0.095).abs() < 1e-4, "{bent} mm");
    assert!(hand.cutting.load().torque < 0.5, "no new chip: {:?}", hand.cutting.load());
    hand.lead(1.0, 9.35);
    let after = hand.cutting.holes()[0].thread;
    let phase = |t: Option<crate::Thread>| {
        t.map(|t| (t.phase_tip.value() + t.phase_angle.value()).rem_euclid(1.0))
    };
    assert_eq!(hand.cutting.holes().len(), 1);
    let (a, b) = (phase(before).expect("tapped"), phase(after).expect("tapped"));
    assert!((a - b).abs() < 1e-9, "{a} {b}");
}

#[test]
fn a_tool_that_stops_at_the_surface_is_out_and_may_go_elsewhere() {
    // a stroke from the surface and back to it, some micrometres off in either sense, in the axis
    // and in the spindle
    for (tip, turns) in [(0.0, 0.0), (-0.004, 0.0), (0.003, 0.002), (-0.002, 0.004), (0.0, 0.015)] {
        let mut hand = Hand::usual();
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        hand.lead(-8.0, 8.0);
        hand.lead(tip, turns);
        hand.take(TAP, 30.0).lead(tip, turns); // sideways at the surface
        hand.lead(30.0, turns);
        hand.take(TAP, 60.0); // and high above it
        assert!(!hand.cutting.is_broken(), "the axis {tip} mm, the spindle {turns} rev off");
        // the next hole begins there as well
        hand.lead(tip, turns);
        hand.lead(-8.0, 8.0);
        assert_eq!(hand.cutting.holes().len(), 2);
        assert!(hand.cutting.load().torque > 0.5, "{:?}", hand.cutting.load());
    }
}

#[test]
fn a_tap_that_touches_the_surface_before_it_turns_to_its_angle_is_held_by_no_helix() {
    let mut hand = Hand::usual();
    hand.take(TAP, 0.0).lead(-0.003, 0.0); // the rapid to R0 overshoots
    hand.lead(-0.001, 0.4); // the spindle turns to where the thread shall start
    hand.lead(-8.0, 8.4);
    assert!(hand.worst.force < 100.0, "{:?}", hand.worst);
    hand.lead(0.001, 0.4);
    hand.take(TAP, 30.0);
    assert!(!hand.cutting.is_broken());
}

#[test]
fn a_drill_that_stops_at_the_surface_is_out() {
    for tip in [0.0, -0.004, 0.003] {
        let mut hand = Hand::usual();
        hand.take(DRILL, 0.0).lead(0.0, 0.0);
        hand.lead(-8.0, 80.0);
        hand.lead(tip, 90.0);
        hand.take(DRILL, 30.0).lead(tip, 95.0);
        assert!(!hand.cutting.is_broken(), "{tip} mm off");
    }
}

#[test]
fn a_tap_moved_sideways_in_its_thread_breaks_however_it_came_there() {
    let mut hand = Hand::usual();
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    hand.lead(-8.0, 8.0);
    hand.lead(-0.5, 0.5);
    hand.take(TAP, 30.0);
    assert!(hand.cutting.is_broken());
}

#[test]
fn a_tap_at_the_bottom_of_its_hole_breaks_and_one_that_stops_above_does_not() {
    for (depth, breaks) in [(8.4, false), (8.9, true)] {
        let mut hand = Hand::usual();
        hand.take(DRILL, 5.0).lead(0.0, 0.0);
        hand.lead(-10.0, 100.0); // full diameter down to 8.498 mm
        hand.lead(1.0, 110.0);
        hand.take(TAP, 5.0).lead(0.0, 110.0);
        hand.lead(-depth, 110.0 + depth);
        assert_eq!(hand.cutting.is_broken(), breaks, "{depth} mm");
        assert_eq!(hand.cutting.holes().len(), 1);
        assert!(!hand.cutting.holes()[0].assumed);
    }
}

#[test]
fn a_tap_without_a_hole_finds_an_assumed_one_or_breaks() {
    for assume_predrilled in [true, false] {
        let stock = Stock { assume_predrilled, ..stock() };
        let mut hand = Hand::new(stock, tapping_center().magazine);
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        hand.lead(-5.0, 5.0);
        assert_eq!(hand.cutting.is_broken(), !assume_predrilled);
        assert_eq!(hand.cutting.holes()[0].assumed, assume_predrilled);
    }
}

#[test]
fn a_tap_set_beside_a_drilled_hole_breaks_even_where_holes_are_assumed() {
    let mut hand = Hand::usual();
    hand.take(DRILL, 5.0).lead(0.0, 0.0);
    hand.lead(-20.0, 200.0);
    hand.lead(1.0, 210.0);
    hand.take(TAP, 5.5).lead(0.0, 210.0);
    hand.lead(-5.0, 215.0);
    assert!(hand.cutting.is_broken());
}

#[test]
fn too_narrow_a_hole_breaks_the_tap_at_the_stated_torque() {
    // 4.4 mm instead of 5: what the formula asks exceeds what an M6 can bear
    let bore = Bore { diameter: Length::mm(4.4), tip_depth: Length::mm(50.0), cone: Length::ZERO };
    let hole = Hole { bores: vec![bore], ..Hole::at(Length::ZERO, Length::ZERO) };
    let stock = Stock { holes: vec![hole], cutting_n_per_mm2: 9000.0, ..stock() };
    let asked = plateau_torque(9000.0, 1.15, 6.0, 4.4);
    let mut hand = Hand::new(stock, tapping_center().magazine);
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    hand.lead(-6.0, 6.0);
    let limit = 1000.0 * core::f64::consts::PI * 3.6_f64.powi(3) / 16.0 * 1e-3;
    assert!(asked > limit && hand.cutting.is_broken(), "{asked} {limit}");
    assert!(hand.worst.torque < limit && hand.worst.torque > 0.99 * limit, "{:?}", hand.worst);
}

#[test]
fn a_left_hand_tap_goes_in_counter_clockwise() {
    for (turns, breaks) in [(-6.0, false), (6.0, true)] {
        let mut hand = Hand::with_tap(Tap { lead: Lead::mm_per_rev(-1.0), ..m6() });
        hand.take(TAP, 0.0).lead(0.0, 0.0);
        let load = hand.lead(-6.0, turns);
        assert_eq!(hand.cutting.is_broken(), breaks);
        assert!(breaks || load.torque < -1.7, "{load:?}");
    }
}

#[test]
fn a_tap_moved_sideways_in_its_hole_breaks() {
    let mut hand = Hand::usual();
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    hand.lead(-5.0, 5.0);
    hand.take(TAP, 0.5);
    assert!(!hand.cutting.is_broken());
    hand.take(TAP, 0.7);
    assert!(hand.cutting.is_broken());
}

#[test]
fn a_broken_tap_stays_broken_when_it_comes_back_from_the_magazine() {
    let mut hand = Hand::usual();
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    hand.lead(-5.0, 0.0);
    assert!(hand.cutting.is_broken());
    hand.lead(1.0, 0.0);
    assert!(!hand.take(DRILL, 0.0).cutting.is_broken());
    assert!(hand.take(TAP, 0.0).cutting.is_broken());
}

#[test]
fn beside_the_work_nothing_is_cut() {
    let sides = crate::Sides {
        x_from: Length::mm(-10.0),
        x_to: Length::mm(10.0),
        y_from: Length::mm(-10.0),
        y_to: Length::mm(10.0),
    };
    let mut hand = Hand::new(Stock { sides: Some(sides), ..stock() }, tapping_center().magazine);
    hand.take(DRILL, 20.0).lead(0.0, 0.0);
    hand.lead(-10.0, 0.0);
    assert!(hand.cutting.holes().is_empty() && !hand.cutting.is_broken());
}

#[test]
fn in_a_through_hole_the_torque_falls_as_the_chamfer_leaves() {
    let mut hand =
        Hand::new(Stock { thickness: Some(Length::mm(8.0)), ..stock() }, tapping_center().magazine);
    hand.take(TAP, 0.0).lead(0.0, 0.0);
    let inside = hand.lead(-8.0, 8.0).torque;
    let through = hand.lead(-11.0, 11.0).torque;
    assert!(inside > 1.7 && through < 0.2, "{inside} {through}");
}

#[test]
fn a_spot_drilled_mark_is_no_hole_for_a_tap() {
    let spot = ToolKind::Drill { diameter: Length::mm(10.0), point_angle: Angle::deg(90.0) };
    let magazine = vec![
        Tool { number: DRILL, length: Length::mm(80.0), kind: spot },
        Tool { number: TAP, length: Length::mm(100.0), kind: ToolKind::Tap(m6()) },
    ];
    let mut hand = Hand::new(stock(), magazine);
    hand.take(DRILL, 0.0).lead(0.0, 0.0);
    hand.lead(-2.0, 20.0);
    hand.lead(1.0, 30.0);
    hand.take(TAP, 0.0).lead(0.0, 30.0);
    hand.lead(-5.0, 35.0);
    let hole = &hand.cutting.holes()[0];
    assert!(hole.assumed && hole.bores.len() == 2 && hole.thread.is_some(), "{hole:?}");
}
