//! Tapping cycles as operations: leads, senses, waits, and what they are refused for.

use crate::shop::{ends, ops_of, refused, shop, the_tap};
use canon::{OpKind, ReturnAcceleration};
use interp::Setup;
use units::{Angle, Lead, Length, Spin, SpinAccel, Time};

#[test]
fn g84_is_one_tap_whose_lead_is_feed_over_speed() {
    let program = "T2 M6\nG43\nG10 L2 P1 X100 Y100 Z-400\nS1000 M3 F1000\nG0 Z5\nG98 G84 X10 Y20 Z-12 R2\nG80";
    let ops = ops_of(&shop(), program);
    let tap = the_tap(&ops);
    assert_eq!(tap.start.linear.map(Length::value), [110.0, 120.0, -298.0]);
    assert_eq!((tap.bottom, tap.surface), (Length::mm(-312.0), Length::mm(-300.0)));
    assert_eq!(
        (tap.lead, tap.spin, tap.return_spin),
        (Lead::mm_per_rev(1.0), Spin::rpm(1000.0), Spin::rpm(1000.0))
    );
    assert_eq!(tap.start_angle, Some(Angle::ZERO));
    assert_eq!(
        ends(&ops).last(),
        Some(&[110.0, 120.0, -295.0]),
        "G98 goes back to the initial level"
    );
}

#[test]
fn g84_with_feed_per_revolution_takes_f_as_its_lead_and_g74_is_left_hand() {
    let ops = ops_of(&shop(), "G95 F1.25 S800 M3\nG0 Z5\nG99 G84 Z-10 R2 P0.5");
    assert_eq!(the_tap(&ops).lead, Lead::mm_per_rev(1.25));
    assert_eq!(the_tap(&ops).dwell, Time::s(0.5));
    let ops = ops_of(&shop(), "G95 F1.25 S800 M4\nG0 Z5\nG99 G74 Z-10 R2");
    assert_eq!(the_tap(&ops).lead, Lead::mm_per_rev(-1.25));
}

#[test]
fn g33_1_starts_where_the_axis_stands_at_the_index_and_comes_back_there() {
    let ops = ops_of(&shop(), "G20 S500 M3\nG0 X1 Z0.2\nG33.1 Z-0.5 K0.05 I2\nG0 Z1");
    let tap = the_tap(&ops);
    assert!((tap.start.linear[2].value() - 5.08).abs() < 1e-12);
    assert!((tap.bottom.value() + 12.7).abs() < 1e-12);
    assert!(tap.surface.value().abs() < 1e-12);
    assert!((tap.lead.value() - 1.27).abs() < 1e-12);
    assert_eq!(
        (tap.spin, tap.return_spin, tap.start_angle),
        (Spin::rpm(500.0), Spin::rpm(1000.0), Some(Angle::ZERO))
    );
}

#[test]
fn m4_into_minus_z_is_a_left_hand_thread() {
    assert_eq!(
        the_tap(&ops_of(&shop(), "S500 M4\nG0 Z2\nG33.1 Z-5 K1")).lead,
        Lead::mm_per_rev(-1.0)
    );
}

#[test]
fn an_xy_word_inside_a_tap_is_refused_with_its_place() {
    let fault = refused(&shop(), "S500 M3\nG0 X10 Y4 Z5\nG33.1 X12 Y6 Z-20 K1.25", "I0705");
    assert!(fault.is_error());
    assert_eq!(fault.span.line, 3);
    assert_eq!(fault.message, "a tap moves along one axis, but this one would move X and Y and Z");
}

#[test]
fn a_tap_without_p_waits_as_long_as_the_last_cycle_that_did() {
    let drilled = "S800 M3 F1000\nG0 Z5\nG82 X1 Z-1 R2 P.25\nG81 X2 R2 Z-1\nG80";
    let tap = the_tap(&ops_of(&shop(), &format!("{drilled}\nG84 X3 Z-10 R2")));
    assert_eq!(tap.dwell, units::Time::s(0.25));
    let tap = the_tap(&ops_of(&shop(), &format!("{drilled}\nG84 X3 Z-10 R2 P0")));
    assert_eq!(tap.dwell, units::Time::ZERO);
    let fanuc = Setup { dialect: interp::Dialect::Fanuc, ..shop() };
    let tap =
        the_tap(&ops_of(&fanuc, "S800 M3 F1000\nG0 Z5.\nG82 X1. Z-1. R2. P250\nG84 X3. Z-10. R2."));
    assert_eq!(tap.dwell, units::Time::ZERO);
}

#[test]
fn a_tap_without_f_takes_the_pitch_of_the_tap_and_says_so() {
    let program = "T2 M6\nM29 S1000\nG0 Z5\nM29 S1000\nG84 Z-10 R2\nX10\nG80";
    let found = refused(&shop(), program, "I0534");
    assert_eq!(found.span.line, 3, "the move between M29 and its cycle");
    let ops = ops_of(&shop(), "T2 M6\nG0 Z5\nM29 S1000\nG99 G84 Z-10 R2");
    assert_eq!(the_tap(&ops).lead, Lead::mm_per_rev(1.0));
    let note = refused(&shop(), "T2 M6\nG0 Z5\nM29 S1000\nG99 G84 Z-10 R2\nX3\nX6", "I0712");
    assert_eq!(
        (note.span.line, note.message.as_str()),
        (4, "no F is in force: the lead is that of T2 (M6x1), 1 mm per revolution")
    );
    let inches = ops_of(&shop(), "G20 T2 M6\nG0 Z1\nM29 S1000\nG99 G84 Z-0.5 R0.1");
    assert_eq!(the_tap(&inches).lead, Lead::mm_per_rev(1.0), "a pitch has its own unit");
}

#[test]
fn a_rounded_feed_or_lead_follows_the_taps_own() {
    // M6x1: what a post leaves of F, K and G95 in either unit
    for (program, word) in [
        ("S1003 M3\nG99 G84 Z-10 R2 F1000", "F1000 is rounded from F1003"),
        ("G95 S700 M3\nG99 G84 Z-10 R2 F1.004", "F1.004 is rounded from F1"),
        ("G20 S700 M3\nG99 G84 Z-0.4 R0.1 F27.6", "F27.6 is rounded from F27.5591"),
        ("G20 G95 S700 M3\nG99 G84 Z-0.4 R0.1 F0.0394", "F0.0394 is rounded from F0.0393701"),
        ("G20 S700 M3\nG33.1 Z-0.4 K0.0394", "K0.0394 is rounded from K0.0393701"),
        ("S700 M3\nG33.1 Z-10 K0.998", "K0.998 is rounded from K1"),
    ] {
        let program = format!("T2 M6\nG0 Z5\n{program}");
        assert_eq!(the_tap(&ops_of(&shop(), &program)).lead, Lead::mm_per_rev(1.0), "{program}");
        let note = refused(&shop(), &program, "I0716");
        let lead = if program.contains("G20") { "0.0393701 in" } else { "1 mm" };
        let rest = format!(": the lead of T2 (M6x1) is followed, {lead} per revolution");
        assert_eq!(note.message, format!("{word}{rest}"), "{program}");
    }
    // what no post makes of it is what was written, and is judged before motion
    for (program, lead) in [
        ("S700 M3\nG99 G84 Z-10 R2 F701", 701.0 / 700.0),
        ("G95 S700 M3\nG99 G84 Z-10 R2 F0.99", 0.99),
        ("S700 M3\nG33.1 Z-10 K1.01", 1.01),
    ] {
        let ops = ops_of(&shop(), &format!("T2 M6\nG0 Z5\n{program}"));
        assert!((the_tap(&ops).lead.value() - lead).abs() < 1e-12, "{program}");
    }
}

#[test]
fn m29_needs_no_m3_and_holds_for_the_holes_of_its_cycle() {
    let program = "T2 M6\nG95 F1\nG0 Z5\nM29 S1000\nG99 G84 X0 Z-10 R2\nX10\nX20\nG80";
    let taps = ops_of(&shop(), program).iter().filter(|o| matches!(o.kind, OpKind::Tap(_))).count();
    assert_eq!(taps, 3);
    refused(&shop(), "T2 M6\nG95 F1 S1000\nG0 Z5\nG99 G84 X0 Z-10 R2", "I0512");
    let again = "T2 M6\nG95 F1\nG0 Z5\nM29 S1000\nG99 G84 X0 Z-10 R2\nG80\nG84 X10 Z-10 R2";
    assert_eq!(refused(&shop(), again, "I0512").span.line, 7, "G80 ends rigid mode");
}

#[test]
fn g84_2_and_g84_3_are_rigid_by_themselves_right_and_left_hand() {
    let start = "G95 F1.25 S800\nG0 Z5\nG99";
    let right = ops_of(&shop(), &format!("{start} G84.2 Z-10 R2"));
    assert_eq!(the_tap(&right).lead, Lead::mm_per_rev(1.25));
    let left = ops_of(&shop(), &format!("{start} G84.3 Z-10 R2"));
    assert_eq!(the_tap(&left).lead, Lead::mm_per_rev(-1.25));
}

#[test]
fn a_tap_takes_its_start_angle_its_return_speed_and_its_pecks_from_words() {
    let program = |words: &str| format!("G95 F1.25 S800 M3\nG0 Z5\nG99 G84 Z-10 R2 {words}");
    let tap = the_tap(&ops_of(&shop(), &program("A90 J2 Q4")));
    assert_eq!(tap.start_angle, Some(Angle::rev(0.25)));
    assert_eq!(tap.return_spin, Spin::rpm(1600.0));
    assert_eq!(tap.peck, Some(Length::mm(4.0)));
    assert_eq!(the_tap(&ops_of(&shop(), &program("J1500"))).return_spin, Spin::rpm(1500.0));
    assert_eq!(the_tap(&ops_of(&shop(), &program(""))).peck, None);
    let acceleration = |words: &str| the_tap(&ops_of(&shop(), &program(words))).return_acceleration;
    assert_eq!(acceleration(""), ReturnAcceleration::AsSet);
    assert_eq!(acceleration("I1"), ReturnAcceleration::AsSet);
    assert_eq!(acceleration("I0.4"), ReturnAcceleration::Share(0.4));
    assert_eq!(acceleration("I250"), ReturnAcceleration::Limit(SpinAccel::rev_per_s2(250.0)));
    let wild = refused(&shop(), &program("I0.001"), "I0539");
    assert!(wild.message.contains("0.01 to 1") && wild.message.ends_with("found 0.001"));
    refused(&shop(), &program("J0"), "I0535");
    refused(&shop(), &program("Q-1"), "I0536");
    let small = refused(&shop(), &program("Q0.01"), "I0538");
    assert_eq!(small.message, "Q0.01 would make more than 200 pecks: at least 0.06 is needed");
    let inch = "G20 G95 F0.05 S800 M3\nG0 Z1\nG99 G84 Z-0.5 R0.1 Q0.2";
    assert!((the_tap(&ops_of(&shop(), inch)).peck.unwrap().value() - 5.08).abs() < 1e-12);
}

#[test]
fn the_plane_cannot_change_in_rigid_mode_and_g96_has_no_place_in_it() {
    let start = "G95 F1\nG0 X5 Y5 Z5\nM29 S1000\n";
    assert_eq!(refused(&shop(), &format!("{start}G18\nG84 Z-10 R2"), "I0533").span.line, 4);
    refused(&shop(), &format!("{start}G99 G84 Z-10 R2\nG18 Y-10 R2"), "I0533");
    refused(&shop(), "G96 S100 M3\nM29 S1000", "I0531");
    refused(&shop(), "M29", "I0532");
    assert!(ops_of(&shop(), &format!("{start}G99 G84 Z-10 R2\nG80 G18")).len() > 3);
}
