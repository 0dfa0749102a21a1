//! Turned threads: chains, their corners, and what is refused with the number that works.
use crate::common;
use crate::common::{findings, machine, mm, program, rapid, steps, turn};
use canon::{Axis, OpKind, Position, Threading};
use motion::{ThreadStretch, TiedCut, WayOut};
use plan::{Planner, Start, StepKind};
use proptest::prelude::*;
use test_support::size;
use units::{Angle, Lead, LeadGrowth};

/// The axes of the machine in `common`: 10 m/s² across, 15 m/s² along Z, jerk 500 m/s³.
const JERK: f64 = 5e5;

fn thread(x: f64, z: f64, lead: f64) -> OpKind {
    growing(x, z, lead, 0.0)
}

/// The lead grows by so much in each turn.
fn growing(x: f64, z: f64, lead: f64, growth: f64) -> OpKind {
    OpKind::Threading(Threading {
        to: Position::xyz(x, 0.0, z),
        lead: Lead::mm_per_rev(lead),
        growth: LeadGrowth::mm_per_rev2(growth),
        start_angle: Angle::ZERO,
        axis: Axis::Z,
        surface: mm(-10.0),
    })
}

fn stretches(kinds: impl IntoIterator<Item = OpKind>) -> Vec<ThreadStretch> {
    let stretch = |step: plan::Step| match step.kind {
        StepKind::Thread(stretch) => Some(stretch),
        _ => None,
    };
    steps(kinds).into_iter().filter_map(stretch).collect()
}

#[test]
fn stretches_one_after_another_are_one_chain_and_a_rapid_ends_it() {
    let found = stretches([
        turn(1000.0),
        rapid(0.0, 0.0, -5.0),
        thread(0.0, -25.0, 2.0),
        thread(2.0, -27.0, 8.0_f64.sqrt()),
        rapid(5.0, 0.0, -5.0),
        thread(5.0, -25.0, 2.0),
    ]);
    let [thread, taper, second] = &found[..] else { panic!("{found:?}") };
    assert_eq!((thread.start, thread.ends), (Some(Angle::ZERO), false));
    assert_eq!((taper.start, taper.ends), (None, true));
    assert_eq!((second.start, second.ends), (Some(Angle::ZERO), true));
    assert_eq!((thread.to_turn, taper.from_turn), (10.0, 10.0));
    assert!((taper.to_turn - 11.0).abs() < 1e-12);
    // Z goes on with the same lead, X begins: the corner is X's alone
    assert!(
        (thread.exit.beyond[0] - 2.0).abs() < 1e-12 && (thread.exit.beyond[2] + 2.0).abs() < 1e-12
    );
    assert_eq!(thread.exit.half, taper.entry.half);
}

#[test]
fn a_run_in_is_as_long_as_acceleration_and_jerk_need_it() {
    let rpm = 3000.0;
    let found = stretches([turn(rpm), rapid(0.0, 0.0, -5.0), thread(0.0, -45.0, 2.0)]);
    let n = rpm / 60.0 * 1.05; // the spindle may be faster than it was told by as much
    let by_accel: f64 = 0.75 * 2.0 * n * n / 15e3;
    let by_jerk = (1.5 * 2.0 * n * n * n / JERK).sqrt();
    assert!((found[0].entry.half - by_accel.max(by_jerk)).abs() < 1e-9, "{found:?}");
}

#[test]
fn a_thread_that_is_too_short_for_its_speed_is_refused_with_the_speed_that_works() {
    let at = |rpm: f64| findings([turn(rpm), rapid(0.0, 0.0, -9.0), thread(0.0, -11.0, 2.0)]);
    let refused = at(6000.0);
    let works: f64 = refused
        .split(": S")
        .nth(1)
        .and_then(|text| text.split(' ').next())
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{refused}"));
    assert!(refused.starts_with("M0422"), "{refused}");
    assert!(!at(works).contains("M0422"), "{}", at(works));
    assert!(at(works + 1.0).contains("M0422"));
}

#[test]
fn a_lead_that_an_axis_cannot_feed_is_refused_with_the_speed_that_works() {
    // 50 m/min and 5 % for the spindle: 20 mm at S2380
    let at = |rpm: f64| findings([turn(rpm), rapid(0.0, 0.0, -5.0), thread(0.0, -295.0, 20.0)]);
    assert!(at(2500.0).contains("S2380 works"), "{}", at(2500.0));
    assert!(!at(2380.0).contains("M0423"), "{}", at(2380.0));
}

#[test]
fn a_thread_with_a_spindle_at_rest_is_refused_and_a_short_run_in_is_said() {
    let still = findings([rapid(0.0, 0.0, -5.0), thread(0.0, -25.0, 2.0)]);
    assert!(still.contains("M0421"), "{still}");
    let near = findings([turn(3000.0), rapid(0.0, 0.0, -9.9), thread(0.0, -45.0, 2.0)]);
    assert!(near.starts_with("M0426 Warning"), "{near}");
    let far = findings([turn(3000.0), rapid(0.0, 0.0, -5.0), thread(0.0, -45.0, 2.0)]);
    assert_eq!(far, "");
}

#[test]
fn a_left_hand_thread_is_said_where_the_work_turns_and_nowhere_else() {
    let found = |rpm: f64, ends: [f64; 2], turning: bool| {
        let start = Start { position: Position::xyz(0.0, 0.0, 0.0), tool: 0 };
        let planner =
            Planner::new(machine(), canon::ToolLibrary::default(), common::OPTIONS, start);
        let mut planner = if turning { planner.turning_work() } else { planner };
        let ops = program([turn(rpm), rapid(0.0, 0.0, ends[0]), thread(0.0, ends[1], 2.0)]);
        for (index, op) in (0..).zip(&ops) {
            planner.push(index, op, &mut |_| ());
        }
        planner.finish(&mut |_| ());
        let said = planner.take_findings();
        said.iter().filter(|d| d.code == "M0427").map(|d| d.message.clone()).collect::<Vec<_>>()
    };
    let said = "M4 and a feed towards the chuck give a left-hand thread";
    assert_eq!(found(-1000.0, [-5.0, -45.0], true), [said]);
    assert_eq!(
        found(1000.0, [-45.0, -5.0], true),
        ["M3 and a feed away from the chuck give a left-hand thread"]
    );
    assert!(found(1000.0, [-5.0, -45.0], true).is_empty());
    assert!(found(-1000.0, [-45.0, -5.0], true).is_empty());
    assert!(found(-1000.0, [-5.0, -45.0], false).is_empty(), "a mill's spindle holds the tool");
}

fn ways_out(kinds: impl IntoIterator<Item = OpKind>) -> Vec<WayOut> {
    let way_out = |step: plan::Step| match step.kind {
        StepKind::WayOut(way_out) => way_out,
        _ => None,
    };
    steps(kinds).into_iter().filter_map(way_out).collect()
}

#[test]
fn a_pass_is_left_to_where_the_tool_stood_before_it_was_fed_in() {
    for (rpm, lead) in [(1000.0, -2.0), (-1000.0, 2.0)] {
        let found = ways_out([
            turn(rpm),
            rapid(30.0, 0.0, -1.0),
            rapid(11.0, 0.0, -5.0),
            rapid(9.5, 0.0, -5.0),
            thread(9.5, -25.0, 2.0),
        ]);
        let [way_out] = &found[..] else { panic!("{found:?}") };
        assert_eq!((way_out.cut, way_out.infeed), (TiedCut::Thread, Axis::X));
        assert_eq!((way_out.clear, way_out.outward), (mm(11.0), 1.0));
        let pass = way_out.pass.expect("a thread is cut in passes");
        assert_eq!(
            (pass.axis, pass.start, pass.end, pass.from),
            (Axis::Z, mm(-5.0), mm(-25.0), mm(-5.0))
        );
        assert_eq!(pass.lead, Lead::mm_per_rev(lead));
        assert!(way_out.inside(mm(9.5)) == mm(1.5) && way_out.inside(mm(12.0)) == mm(-1.0));
    }
}

#[test]
fn a_thread_in_a_bore_is_left_towards_its_middle() {
    let found = ways_out([
        turn(1000.0),
        rapid(8.0, 0.0, -5.0),
        rapid(9.5, 0.0, -5.0),
        thread(9.5, -25.0, 2.0),
    ]);
    assert_eq!((found[0].clear, found[0].outward), (mm(8.0), -1.0));
}

#[test]
fn a_chain_that_goes_out_farther_than_it_came_in_is_left_as_far() {
    let found = ways_out([
        turn(1000.0),
        rapid(11.0, 0.0, -5.0),
        rapid(9.5, 0.0, -5.0),
        thread(9.5, -25.0, 2.0),
        thread(12.0, -27.5, 12.5_f64.sqrt()),
    ]);
    assert_eq!(found[0].clear, mm(12.0));
}

#[test]
fn a_chain_that_feeds_in_by_itself_is_left_to_where_it_began() {
    let found = ways_out([
        turn(1000.0),
        rapid(30.0, 0.0, -1.0),
        rapid(11.0, 0.0, -5.0),
        thread(9.0, -7.0, 8.0_f64.sqrt()),
        thread(9.0, -25.0, 2.0),
    ]);
    assert_eq!(found[0].clear, mm(11.0));
    let pass = found[0].pass.expect("a thread is cut in passes");
    // the straight part begins a turn later, and the whole chain where it was
    assert_eq!((pass.start, pass.from), (mm(-7.0), mm(-5.0)));
    assert!((pass.angle - Angle::rev(1.0)).abs().value() < 1e-12, "{pass:?}");
}

#[test]
fn a_lead_that_grows_makes_as_many_turns_as_its_closed_form_says() {
    // 2·20 + 0.1·20²/2 = 60 mm in 20 turns, up to 4 mm; then 2.5 turns of that, and 1 mm less in
    // each of 2
    let found = stretches([
        turn(600.0),
        rapid(0.0, 0.0, -5.0),
        growing(0.0, -65.0, 2.0, 0.1),
        growing(0.0, -75.0, 4.0, 0.0),
        growing(0.0, -81.0, 4.0, -1.0),
    ]);
    let turns: Vec<_> = found.iter().map(|s| (s.from_turn, s.to_turn)).collect();
    let wanted = [(0.0, 20.0), (20.0, 22.5), (22.5, 24.5)];
    for (found, wanted) in turns.iter().zip(wanted) {
        assert!(
            (found.0 - wanted.0).abs() < 1e-12 && (found.1 - wanted.1).abs() < 1e-12,
            "{turns:?}"
        );
    }
    let slopes: Vec<_> = found.iter().map(|s| s.slopes().map(|slope| slope[2])).collect();
    let wanted = [[-2.0, -4.0], [-4.0, -4.0], [-4.0, -2.0]];
    for (found, wanted) in slopes.iter().flatten().zip(wanted.iter().flatten()) {
        assert!((found - wanted).abs() < 1e-12, "{slopes:?}");
    }
    assert_eq!(found[0].bend, [0.0, 0.0, -0.1]);
    // from 4 mm that grow to 4 mm that do not: only the jerk of what stops growing
    let n: f64 = 10.0 * 1.05;
    let half = 1.125 * 0.1 * n.powi(3) / JERK;
    assert!((found[0].exit.half - half).abs() < 1e-9, "{} {half}", found[0].exit.half);
}

#[test]
fn a_taper_takes_x_and_z_through_the_same_share_of_their_ways() {
    let (z, x) = (-65.0, 15.0);
    let along = |mm: f64| mm * 0.25_f64.hypot(1.0);
    let found =
        stretches([turn(600.0), rapid(0.0, 0.0, -5.0), growing(x, z, along(2.0), along(0.1))]);
    for turn in [1.0, 7.0, 19.0] {
        let on = found[0].at(turn);
        let gone = 2.0 * turn + 0.05 * turn * turn;
        assert!(
            (on.q[2] - (-5.0 - gone)).abs() < 1e-9 && (on.q[0] - gone / 4.0).abs() < 1e-9,
            "{on:?}"
        );
    }
}

#[test]
fn a_lead_that_has_grown_too_much_for_its_axis_is_refused_with_the_speed_that_works() {
    // 50 m/min and 5 % for the spindle, and 20 mm at the end: S2380, as for a thread of 20 mm
    let at = |rpm: f64| {
        findings([turn(rpm), rapid(0.0, 0.0, -5.0), growing(0.0, -204.0, 2.0, 0.994_974_874)])
    };
    assert!(at(2500.0).contains("20 mm of Z per revolution at the end"), "{}", at(2500.0));
    assert!(at(2500.0).contains("S2380 works"), "{}", at(2500.0));
    assert!(!at(2380.0).contains("M0423"), "{}", at(2380.0));
    let used_up = findings([turn(600.0), rapid(0.0, 0.0, -5.0), growing(0.0, -25.0, 2.0, -0.1)]);
    assert!(used_up.starts_with("M0424"), "{used_up}");
    // growing by 200 mm in each turn takes 15 m/s² at 8.66 turns a second, and the spindle may be 5
    // % faster
    let fast =
        |rpm: f64| findings([turn(rpm), rapid(0.0, 0.0, -5.0), growing(0.0, -15.0, 2.0, 200.0)]);
    assert!(fast(600.0).contains("cannot speed up as the lead grows"), "{}", fast(600.0));
}

/// A chain as the property below has it: each stretch's end as Z and X, its lead and growth along
/// the path.
fn chained(leads: &[(f64, f64, f64)], taper: f64) -> Vec<(f64, f64, f64, f64)> {
    let (mut z, slant) = (-5.0, taper.hypot(1.0));
    leads
        .iter()
        .map(|&(lead, growth, turns)| {
            z -= lead * turns + growth * turns * turns / 2.0;
            ((-5.0 - z) * taper, z, lead * slant, growth * slant)
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(64, 1280)))]
    /// A chain of up to three stretches, with steps of the lead between them, in setpoints of 250
    /// µs at the fastest that the spindle may turn: on the closed form outside its corners, and
    /// within the limits of each axis, by differences.
    #[test]
    fn threads_of_changing_lead_keep_their_form_and_the_limits(
        rpm in 100.0_f64..4000.0,
        taper in -1.0_f64..1.0,
        leads in prop::collection::vec((0.5_f64..6.0, -0.9_f64..2.0, 2.0_f64..12.0), 1..4),
    ) {
        // growth, as a share of the lead over the whole stretch
        let leads: Vec<_> = leads.iter().map(|&(lead, share, turns)| (lead, share * lead / turns, turns)).collect();
        let chain = chained(&leads, taper);
        let ops = || [turn(rpm), rapid(0.0, 0.0, -5.0)].into_iter()
            .chain(chain.iter().map(|&(x, z, lead, growth)| growing(x, z, lead, growth)));
        prop_assume!(chain.last().is_some_and(|c| c.1 > -290.0));
        let told = findings(ops());
        prop_assume!(!told.contains("M042") || told.starts_with("M0426"));
        let found = stretches(ops());
        let n = rpm / 60.0 * 1.05;
        let end = found.last().map_or(0.0, ThreadStretch::is_over_at);
        let begin = found[0].begins();
        let at = |turn: f64| {
            found.iter().find(|s| turn < s.to_turn).unwrap_or(&found[found.len() - 1]).at(turn).q
        };
        // closed form
        let closed = |turn: f64| {
            let (mut z, mut began) = (-5.0, 0.0);
            for &(lead, growth, turns) in &leads {
                let x = (turn - began).clamp(0.0, turns);
                z -= lead * x + growth * x * x / 2.0;
                began += turns;
            }
            [(-5.0 - z) * taper, z]
        };
        let in_corner = |turn: f64| found.iter().any(|s| {
            (turn - s.from_turn).abs() < s.entry.half || (turn - s.to_turn).abs() < s.exit.half
        });
        let h = 250e-6;
        let periods = ((end - begin) / n / h) as usize + 6;
        let turn_of = |k: usize| begin - 3.0 * n * h + k as f64 * n * h;
        let points: Vec<_> = (0..periods).map(|k| at(turn_of(k))).collect();
        for (k, q) in points.iter().enumerate() {
            let turn = turn_of(k);
            if !in_corner(turn) {
                let [x, z] = closed(turn);
                prop_assert!((q[0] - x).abs() < 1e-7 && (q[2] - z).abs() < 1e-7, "turn {turn}: {q:?}, {x} {z}");
            }
        }
        let machine = common::machine();
        for axis in [0, 2] {
            let limits = machine.axes[axis].expect("X and Z are there");
            let most = |order: i32, bound: f64| {
                let found = points.windows(order as usize + 1).map(|w| {
                    let difference = match order {
                        1 => w[1][axis] - w[0][axis],
                        2 => w[2][axis] - 2.0 * w[1][axis] + w[0][axis],
                        _ => w[3][axis] - 3.0 * w[2][axis] + 3.0 * w[1][axis] - w[0][axis],
                    };
                    (difference / h.powi(order)).abs()
                });
                let found = found.fold(0.0, f64::max);
                (found <= bound * (1.0 + 1e-6) + 0.1, found)
            };
            let speed = most(1, limits.feed_speed.value());
            let accel = most(2, limits.accel.value());
            let jerk = most(3, limits.feed_jerk.value());
            prop_assert!(speed.0 && accel.0 && jerk.0, "axis {axis}: {speed:?} {accel:?} {jerk:?}");
        }
    }
}
