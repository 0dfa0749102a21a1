//! Closed forms worked by hand: on each, PS, PE, the stop and the answer are plain numbers.
use super::*;
use proptest::prelude::*;

const NEAR: f64 = 1e-9;

fn point(rev: f64, mm: f64) -> Point {
    Point { angle: Angle::rev(rev), place: Length::mm(mm) }
}

#[track_caller]
fn near(found: f64, expected: f64, what: &str) {
    assert!((found - expected).abs() < NEAR, "{what}: {found}, expected {expected}");
}

/// M8×1.25, 20 mm deep, from 5 mm above: 20 turns.
fn m8(direction: Direction) -> Stored {
    Stored::line(point(3.0, 5.0), point(23.0, -20.0), direction).unwrap()
}

#[track_caller]
fn projects(stored: &Stored, stop: Point, mover: Mover, to: Point) {
    let found = stored.project(stop, Way::Direct);
    assert_eq!(found.mover, Some(mover));
    near(found.to.angle.value(), to.angle.value(), "Sc");
    near(found.to.place.value(), to.place.value(), "Zc");
    near(stored.error(found.to).value(), 0.0, "distance of Pc from the line");
    assert_eq!((found.from, found.unloaded), (stop, stop));
}

#[test]
fn inwards_a_feed_that_overran_goes_back() {
    // half way by the spindle (z = -7.5), the feed 0.3 mm beyond it
    let stored = m8(Direction::Inward);
    let stop = point(13.0, -7.8);
    let Progress { spindle, feed } = stored.progress(stop);
    near(spindle, 0.5, "uS");
    near(feed.unwrap(), 0.512, "uZ");
    near(stored.error(stop).value(), -0.3, "error");
    near(stored.phase_difference(stop).value(), 0.24, "phase difference");
    projects(&stored, stop, Mover::Feed, point(13.0, -7.5));
}

#[test]
fn inwards_a_spindle_that_overran_turns_back() {
    // z = -7.5 belongs to 13 turns; the spindle is 0.24 of a turn beyond them
    projects(&m8(Direction::Inward), point(13.24, -7.5), Mover::Spindle, point(13.0, -7.5));
}

#[test]
fn outwards_the_same_points_are_answered_by_the_other_axis() {
    // coming out, a feed that is too deep has been left behind by the spindle
    projects(&m8(Direction::Outward), point(13.0, -7.8), Mover::Spindle, point(13.24, -7.8));
    projects(&m8(Direction::Outward), point(13.24, -7.5), Mover::Feed, point(13.24, -7.8));
}

#[test]
fn a_tap_over_the_work_goes_straight_to_its_start() {
    let found = m8(Direction::Inward).project(point(9.0, 1.0), Way::Straight);
    assert_eq!((found.mover, found.unloaded), (Some(Mover::Feed), point(9.0, 1.0)));
    assert_eq!(found.to, point(9.0, 5.0));
}

#[test]
fn nothing_is_unloaded_to_deeper_than_the_stroke() {
    // a spindle that overran at the bottom by a quarter of a turn: the feed would have to go 0.3125
    // mm below PE
    let way = Way::UnloadFirst(Seat { play: Length::ZERO, is_stiff: true });
    let stop = point(23.25, -20.0);
    let found = m8(Direction::Inward).project(stop, way);
    assert_eq!((found.unloaded, found.mover), (stop, Some(Mover::Spindle)));
    near(found.to.angle.value(), 23.0, "Sc");
    // the same quarter of a turn half way is unloaded by the feed
    let half = m8(Direction::Inward).project(point(13.25, -7.5), way);
    near(half.unloaded.place.value(), -7.8125, "unloaded");
}

#[test]
fn an_error_of_more_than_a_lead_is_still_one_error() {
    // the spindle coasted 2.4 turns on: 3 mm
    let stop = point(18.4, -11.25);
    let stored = m8(Direction::Inward);
    near(stored.error(stop).value(), 3.0, "error");
    projects(&stored, stop, Mover::Spindle, point(16.0, -11.25));
}

#[test]
fn a_left_hand_thread_is_cut_with_the_spindle_reversed() {
    // M8×1.25 LH from 2 mm above to 18 mm: 16 turns the other way round
    let stored = Stored::line(point(-1.0, 2.0), point(-17.0, -18.0), Direction::Inward).unwrap();
    near(stored.lead().value(), 1.25, "lead");
    // at -9 turns z should be -8; the feed is at -8.1
    projects(&stored, point(-9.0, -8.1), Mover::Feed, point(-9.0, -8.0));
    // at -9.08 it should be -8.1; the feed is at -8
    projects(&stored, point(-9.08, -8.0), Mover::Spindle, point(-9.0, -8.0));
}

#[test]
fn a_tap_that_goes_towards_plus_is_no_different() {
    // a back-side thread: 2 mm a turn, from 0 up to 10 mm
    let stored = Stored::line(point(0.0, 0.0), point(5.0, 10.0), Direction::Inward).unwrap();
    projects(&stored, point(2.0, 4.2), Mover::Feed, point(2.0, 4.0));
    projects(&stored, point(2.1, 4.0), Mover::Spindle, point(2.0, 4.0));
}

#[test]
fn an_inch_thread_gives_millimetres_exactly() {
    // 1/4-20: 0.05 in a turn, 0.75 in deep from 0.25 in above: 20 turns
    let inch = |rev: f64, inch: f64| Point { angle: Angle::rev(rev), place: Length::inch(inch) };
    let stored = Stored::line(inch(0.0, 0.25), inch(20.0, -0.75), Direction::Inward).unwrap();
    near(stored.lead().value(), -1.27, "lead");
    // after 8 turns -0.15 in; the feed stands at -0.16 in
    projects(&stored, inch(8.0, -0.16), Mover::Feed, inch(8.0, -0.15));
    near(stored.error(inch(8.0, -0.16)).value(), -0.254, "error");
}

#[test]
fn counts_of_both_encoders_are_as_good_as_turns_and_millimetres() {
    // 4096 counts a turn, 1 µm a count; 0.8 mm a turn: PS (0, 4000), PE (81920, -12000)
    let counts = |spindle: f64, axis: f64| point(spindle / 4096.0, axis * 1e-3);
    let stored =
        Stored::line(counts(0.0, 4000.0), counts(81_920.0, -12_000.0), Direction::Inward).unwrap();
    // 30 720 counts are 7.5 turns: z = 4 - 6 = -2 mm; the feed has 2100 counts
    projects(&stored, counts(30_720.0, -2100.0), Mover::Feed, counts(30_720.0, -2000.0));
    // and the other way: -2 mm belongs to 30 720 counts, the spindle has 512 more
    projects(&stored, counts(31_232.0, -2000.0), Mover::Spindle, counts(30_720.0, -2000.0));
}

#[test]
fn in_the_bottom_dwell_the_stop_counts_as_inward() {
    // at PE the spindle sags an eighth of a turn on: it turns back
    projects(&m8(Direction::Inward), point(23.125, -20.0), Mover::Spindle, point(23.0, -20.0));
    // the ram sags by 40 µm: the feed goes back up
    projects(&m8(Direction::Inward), point(23.0, -20.04), Mover::Feed, point(23.0, -20.0));
}

#[test]
fn on_the_line_nobody_moves() {
    let found = m8(Direction::Outward).project(point(7.0, 0.0), Way::Direct);
    assert_eq!((found.mover, found.to), (None, point(7.0, 0.0)));
}

#[test]
fn a_stiff_holder_is_unloaded_by_the_feed_before_the_spindle_turns() {
    let seat = Seat { play: Length::um(10.0), is_stiff: true };
    // the spindle overran by 0.24 turns: the feed stands 0.3 mm above the line
    let stored = m8(Direction::Inward);
    let found = stored.project(point(13.24, -7.5), Way::UnloadFirst(seat));
    near(found.unloaded.place.value(), -7.8 + 0.005, "unloaded at half the play");
    near(found.unloaded.angle.value(), 13.24, "the spindle stands meanwhile");
    assert_eq!(found.mover, Some(Mover::Spindle));
    near(found.to.angle.value(), 13.24 - 0.004, "the spindle takes the rest");
    near(found.to.place.value(), -7.795, "Zc");
    near(stored.error(found.to).value(), 0.0, "on the line");
}

#[test]
fn a_soft_holder_or_a_small_error_needs_no_unloading() {
    let stored = m8(Direction::Inward);
    let stop = point(13.24, -7.5);
    let soft = Seat { play: Length::um(10.0), is_stiff: false };
    assert_eq!(stored.project(stop, Way::UnloadFirst(soft)), stored.project(stop, Way::Direct));
    let stiff = Seat { is_stiff: true, ..soft };
    let stop = point(13.0, -7.504);
    assert_eq!(stored.project(stop, Way::UnloadFirst(stiff)), stored.project(stop, Way::Direct));
}

#[test]
fn the_turn_comes_from_z_where_half_a_lead_is_not_exceeded() {
    let stored = m8(Direction::Inward);
    // really at 13.24 turns and 0.3 mm off; the encoder says 0.24 of a turn
    let bound = Length::mm(0.6);
    let angle = stored.turn(Angle::rev(0.24), Length::mm(-7.5), bound).unwrap();
    near(angle.value(), 13.24, "θ");
    // whatever turn the encoder counts from
    let angle = stored.turn(Angle::rev(-40.76), Length::mm(-7.5), bound).unwrap();
    near(angle.value(), 13.24, "θ");
}

#[test]
fn a_bound_of_half_a_lead_or_more_is_refused_with_both_numbers() {
    let refusal = m8(Direction::Inward)
        .turn(Angle::rev(0.24), Length::mm(-7.5), Length::mm(0.625))
        .unwrap_err();
    let (bound, limit) = (Length::mm(0.625), Length::mm(0.625));
    assert_eq!(refusal, Refusal::SeveralTurns { bound, limit });
    assert!(std::format!("{refusal}").contains("0.625 mm"), "{refusal}");
}

#[test]
fn readings_that_no_turn_explains_are_refused() {
    // 0.3 mm off with any turn nearest, but it is known to be within 0.1 mm
    let refusal = m8(Direction::Inward)
        .turn(Angle::rev(0.24), Length::mm(-7.5), Length::mm(0.1))
        .unwrap_err();
    let Refusal::NoTurn { distance, bound } = refusal else { panic!("{refusal}") };
    near(distance.value(), 0.3, "distance");
    near(bound.value(), 0.1, "bound");
}

#[test]
fn points_that_make_no_line_are_refused() {
    let line = |a, b| Stored::line(a, b, Direction::Inward).unwrap_err();
    assert_eq!(line(point(1.0, 0.0), point(1.0, -5.0)), Refusal::NoTravel);
    assert_eq!(line(point(1.0, f64::NAN), point(2.0, -5.0)), Refusal::NotFinite);
    let level = Stored::line(point(0.0, 1.0), point(5.0, 1.0), Direction::Inward).unwrap();
    let turn = level.turn(Angle::rev(0.2), Length::mm(1.0), Length::um(1.0));
    assert_eq!(turn, Err(Refusal::Level));
}

proptest! {
    #[test]
    fn pc_is_on_the_line_one_axis_has_moved_and_towards_where_it_came_from(
        lead in prop_oneof![-3.0..-0.2f64, 0.2..3.0f64], turns in prop_oneof![-40.0..-2.0f64, 2.0..40.0f64],
        share in 0.0..1.0f64, off in -4.0..4.0f64, inward in any::<bool>(), s0 in -1e3..1e3f64,
    ) {
        prop_assume!(off.abs() > 1e-6);
        let direction = if inward { Direction::Inward } else { Direction::Outward };
        let stored =
            Stored::line(point(s0, 10.0), point(s0 + turns, 10.0 + lead * turns), direction).unwrap();
        let stop = point(s0 + share * turns, 10.0 + lead * share * turns + off);
        let found = stored.project(stop, Way::Direct);
        prop_assert!(stored.error(found.to).value().abs() < NEAR);
        let u = stored.progress(stop);
        let by_the_rule = direction.sign() * (u.feed.unwrap() - u.spindle);
        let back = direction.sign() * turns.signum();
        match found.mover.unwrap() {
            Mover::Feed => {
                prop_assert!(by_the_rule > 0.0 && found.to.angle == stop.angle);
                prop_assert!((found.to.place - stop.place).value() * lead * back < 0.0);
            }
            Mover::Spindle => {
                prop_assert!(by_the_rule < 0.0 && found.to.place == stop.place);
                prop_assert!((found.to.angle - stop.angle).value() * back < 0.0);
            }
        }
    }

    #[test]
    fn the_turn_found_is_the_real_one(
        lead in prop_oneof![-3.0..-0.2f64, 0.2..3.0f64], at in -30.0..30.0f64, part in -0.49..0.49f64, lost in -50..50i32,
    ) {
        let stored = Stored::line(point(0.0, 0.0), point(20.0, 20.0 * lead), Direction::Inward).unwrap();
        let (z, bound) = (lead * (at + part), Length::mm(lead.abs() * 0.495));
        let found = stored.turn(Angle::rev(at + f64::from(lost)), Length::mm(z), bound).unwrap();
        prop_assert!((found.value() - at).abs() < NEAR);
    }
}
