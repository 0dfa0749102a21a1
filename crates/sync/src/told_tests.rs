//! A drive with a delay and a ramp of its own, which brakes slower than its file says.
use super::*;
use crate::Halt;
use crate::strokes::StrokePoint;
use units::{Accel, Lead, Length, Speed, SpinAccel};

const PERIOD: f64 = 250e-6;

/// The planned stroke is of no use to such a spindle.
struct Unplanned;

impl Stroke for Unplanned {
    fn at(&self, _: Time) -> StrokePoint {
        StrokePoint::default()
    }
    fn duration(&self) -> Time {
        Time::ZERO
    }
    fn length(&self) -> Angle {
        Angle::ZERO
    }
    fn brake(&self) -> Time {
        Time::ZERO
    }
}

fn tap_at(rpm: f64, early: Angle, known: bool, dwell: Time, sense: f64) -> Tap<'static, Unplanned> {
    let stopping = Stopping { delay: Time::s(0.01), decel: SpinAccel::rev_per_s2(67.0) };
    let spin = Spin::rpm(rpm * sense);
    Tap {
        lead: Lead::mm_per_rev(-1.25 * sense),
        start: Length::mm(5.0),
        bottom: Length::mm(-25.0),
        end: Length::mm(5.0),
        spin,
        inward: &Unplanned,
        dwell,
        outward: &Unplanned,
        start_angle: None,
        encoder_following: true,
        early,
        spoken: Some(Spoken {
            speeds: (spin, -spin),
            stopping,
            uncertainty: if known { 0.002 } else { 0.2 },
            late: if known { Time::s(0.7e-3) } else { Time::ZERO },
            creep: Spin::rpm(0.1 * rpm),
            at_speed: known,
        }),
        approach: (Speed::mm_per_s(50.0), Accel::mm_per_s2(500.0)),
        halt: Halt {
            level: SpinAccel::rev_per_s2(67.0),
            power: f64::INFINITY,
            jerk: units::SpinJerk::rev_per_s3(1e4),
            slow: (Spin::rpm(300.0), SpinAccel::rev_per_s2(67.0)),
            on: (spin.abs(), SpinAccel::rev_per_s2(67.0)),
            clear: Length::mm(5.0),
        },
    }
}

fn tap(early: Angle, known: bool, dwell: Time, sense: f64) -> Tap<'static, Unplanned> {
    tap_at(2000.0, early, known, dwell, sense)
}

/// What became of a tap: turns beyond the bottom, turns beyond the start on the way out, what was
/// taught, time.
struct Seen {
    beyond_bottom: f64,
    beyond_start: f64,
    taught: Option<Angle>,
    seconds: f64,
}

/// Periods of the drive's delay, by its file.
const DELAY: usize = 40;

/// Run it on a drive whose deceleration is 85 % of what its file says.
fn run(tap: &Tap<Unplanned>) -> Seen {
    run_held(tap, DELAY, 0.0..0.0)
}

/// The same with a delay of so many periods, held for a while.
fn run_held(tap: &Tap<Unplanned>, delay: usize, holds: core::ops::Range<f64>) -> Seen {
    let (seen, cycle, _) = run_ordered(tap, delay, holds, 0.0..0.0);
    assert_eq!(cycle, Cycle::Done);
    seen
}

/// The same, told to come out for a while; with the cycle and the angle at its end, or after twenty
/// seconds.
fn run_ordered(
    tap: &Tap<Unplanned>,
    delay: usize,
    holds: core::ops::Range<f64>,
    outs: core::ops::Range<f64>,
) -> (Seen, Cycle, f64) {
    run_braking(tap, 0.85, delay, holds, outs)
}

/// The same on a drive whose deceleration is another share of what its file says.
fn run_braking(
    tap: &Tap<Unplanned>,
    share: f64,
    delay: usize,
    holds: core::ops::Range<f64>,
    outs: core::ops::Range<f64>,
) -> (Seen, Cycle, f64) {
    let (decel, accel) = (share * 67.0, 67.0);
    let mut orders = std::collections::VecDeque::from(std::vec![0.0; delay]);
    let (mut angle, mut spin, mut cycle) = (0.0_f64, 0.0_f64, Cycle::new());
    let mut seen = Seen { beyond_bottom: -100.0, beyond_start: -100.0, taught: None, seconds: 0.0 };
    let sense = tap.spin.value().signum();
    let turns = ((tap.bottom - tap.start) / tap.lead).value();
    while cycle != Cycle::Done && seen.seconds < 20.0 {
        let ask = cycle.ask(tap, Time::ZERO);
        let wanted = match ask {
            Ask::Speed(rotation) => rotation.spin.value(),
            Ask::Rest => 0.0,
            Ask::Hold(_) | Ask::Angle(_) => panic!("it cannot be held"),
        };
        orders.push_back(wanted);
        let told = orders.pop_front().unwrap();
        let falls = told.abs() < spin.abs() || told * spin < 0.0;
        let most = if falls { decel } else { accel } * PERIOD;
        let before = spin;
        spin += (told - spin).clamp(-most, most);
        angle += f64::midpoint(before, spin) * PERIOD;
        let master = Rotation {
            angle: Angle::rev(angle),
            spin: Spin::rev_per_s(spin),
            accel: SpinAccel::rev_per_s2((spin - before) / PERIOD),
        };
        let tick = Tick {
            elapsed: Time::s(PERIOD),
            master,
            followed: master,
            at_rest: wanted == 0.0 && spin == 0.0,
            held: None,
            rest: holds.contains(&seen.seconds),
            out: outs.contains(&seen.seconds),
        };
        cycle = cycle.next(tap, &tick);
        seen.taught = seen.taught.or(cycle.taught());
        seen.seconds += PERIOD;
        if cycle.phase() != Phase::Prepare {
            seen.beyond_bottom = seen.beyond_bottom.max(angle * sense - turns * sense);
            seen.beyond_start = seen.beyond_start.max(-angle * sense);
        }
    }
    (seen, cycle, angle)
}

/// Half of the way in a period at creep, and at speed.
const AT_CREEP: f64 = 200.0 / 60.0 * PERIOD;
const AT_SPEED: f64 = 2000.0 / 60.0 * PERIOD;

#[test]
fn the_first_stroke_creeps_to_the_bottom_and_teaches_how_the_drive_really_stops() {
    for (dwell, sense) in [(0.0, 1.0), (0.1, 1.0), (0.0, -1.0)] {
        let seen = run(&tap(Angle::ZERO, false, Time::s(dwell), sense));
        assert!(seen.beyond_bottom.abs() < 2.0 * AT_CREEP, "{} rev", seen.beyond_bottom);
        // n²/2a with 0.85·a is longer by 0.176 of it
        let n = 2000.0 / 60.0;
        let longer = n * n / (2.0 * 67.0) * (1.0 / 0.85 - 1.0);
        let taught = seen.taught.expect("it slowed down").value();
        assert!((taught - longer).abs() < 0.02, "{taught} rev taught, {longer} rev longer");
        assert!(seen.beyond_start.abs() < 0.1, "{} rev", seen.beyond_start);
    }
}

#[test]
fn the_second_stroke_turns_back_straight_from_its_speed_and_meets_the_bottom() {
    let first = run(&tap(Angle::ZERO, false, Time::ZERO, 1.0));
    let second = run(&tap(first.taught.unwrap(), true, Time::ZERO, 1.0));
    // 1.25 mm a turn: within 25 µm
    assert!(second.beyond_bottom.abs() < 2.0 * AT_SPEED + 0.01, "{} rev", second.beyond_bottom);
    assert!(second.seconds < first.seconds - 0.05, "{} s, {} s", first.seconds, second.seconds);
}

#[test]
fn a_drive_believed_without_learning_would_overrun_by_its_error() {
    let believed = run(&tap(Angle::ZERO, true, Time::ZERO, 1.0));
    assert!(believed.beyond_bottom > 1.0, "{} rev", believed.beyond_bottom);
}

#[test]
fn whatever_the_speed_the_second_stroke_meets_the_bottom_even_if_the_stroke_is_too_short_for_it() {
    for rpm in [500.0, 1000.0, 2000.0, 3000.0] {
        let first = run(&tap_at(rpm, Angle::ZERO, false, Time::ZERO, 1.0));
        let taught = first.taught.expect("it slowed down");
        let second = run(&tap_at(rpm, taught, true, Time::ZERO, 1.0));
        for beyond in [first.beyond_bottom, second.beyond_bottom] {
            assert!(beyond.abs() * 1.25 < 0.025, "{rpm} rpm: {beyond} rev");
        }
    }
}

/// Half a scan sooner or later: straight from 35 rev/s, still rising, that is n·δ·(1 + a/d) beyond
/// the bottom, and from the creep a tenth of n·δ at most.
#[test]
fn a_learnt_stroke_that_creeps_meets_the_bottom_however_late_its_drive_obeys() {
    let first = run(&tap_at(3000.0, Angle::ZERO, false, Time::ZERO, 1.0));
    let taught = first.taught.expect("it slowed down");
    let straight = tap_at(3000.0, taught, true, Time::ZERO, 1.0);
    let mut creeps = tap_at(3000.0, taught, true, Time::ZERO, 1.0);
    creeps.spoken = creeps.spoken.map(|spoken| Spoken { at_speed: false, ..spoken });
    let (n, a, d) = (37.0, 67.0, 0.85 * 67.0); // 24 turns: n²/2a + n²/2d
    for (delay, periods) in [(DELAY - 2, -2.0), (DELAY + 2, 2.0)] {
        let exact = n * periods * PERIOD * (1.0 + a / d);
        let seen = run_held(&straight, delay, 0.0..0.0);
        let off = (seen.beyond_bottom - exact).abs();
        assert!(off < 0.3 * exact.abs(), "{} rev, {exact} rev", seen.beyond_bottom);
        let seen = run_held(&creeps, delay, 0.0..0.0);
        let most = 0.1 * 50.0 * (2.0 + 0.5) * PERIOD;
        assert!(seen.beyond_bottom.abs() < most, "{} rev at a creep", seen.beyond_bottom);
        assert!(seen.seconds < first.seconds, "{} s, {} s", seen.seconds, first.seconds);
    }
}

#[test]
fn a_stroke_that_is_held_on_its_way_in_goes_on_to_its_bottom() {
    for at in [0.1, 0.6, 1.0] {
        let seen = run_held(&tap(Angle::ZERO, false, Time::ZERO, 1.0), DELAY, at..at + 1.5);
        // too little way is left for the drive to show how it stops: short of the bottom, then,
        // never beyond
        let beyond = seen.beyond_bottom;
        assert!((-0.1..0.01).contains(&beyond), "held at {at} s: {beyond} rev");
    }
}

/// Told to come out until it is out, and beyond that: it stands where its way out ends, and is told
/// nothing more.
#[test]
fn a_tap_that_is_told_to_come_out_stands_where_it_is_clear_however_long_it_is_told_so() {
    for (at, sense) in [(0.3, 1.0), (0.6, 1.0), (1.0, 1.0), (0.6, -1.0)] {
        let tap = tap(Angle::ZERO, false, Time::ZERO, sense);
        let (seen, cycle, angle) = run_ordered(&tap, DELAY, at..1e3, at + 2.0..1e3);
        assert!(cycle.is_standing() && seen.seconds >= 20.0, "{cycle:?}");
        // what the drive brakes slower than its file says is not known yet
        let turns = angle * sense;
        let slower = (2000.0_f64 / 60.0).powi(2) / (2.0 * 67.0) * (1.0 / 0.85 - 1.0);
        assert!((-slower - 0.1..0.1).contains(&turns), "held at {at} s: {turns} turns from clear");
        assert_eq!(cycle.ask(&tap, Time::ZERO), Ask::Speed(Rotation::default()));
    }
}

/// From a uniform ramp that is anything within what the file leaves open: not beyond the bottom,
/// not far before it, what it teaches is right, and it takes longer than a known stroke by no more
/// than the closed form of what is left open costs.
#[test]
fn a_first_stroke_goes_on_between_and_takes_little_longer_than_a_known_one() {
    for rpm in [500.0, 1000.0, 2000.0, 2500.0] {
        for share in [0.84, 0.9, 1.0, 1.2, 1.5] {
            let n = rpm / 60.0;
            let run = |known: bool, early: Angle| {
                let tap = tap_at(rpm, early, known, Time::ZERO, 1.0);
                let (seen, cycle, _) = run_braking(&tap, share, DELAY, 0.0..0.0, 0.0..0.0);
                assert_eq!(cycle, Cycle::Done);
                seen
            };
            let first = run(false, Angle::ZERO);
            let of = std::format!("{rpm} rpm, {share} of the deceleration");
            assert!(first.beyond_bottom < 1e-3, "{of}: {} rev beyond", first.beyond_bottom);
            assert!(first.beyond_bottom > -0.01, "{of}: {} rev short", first.beyond_bottom);
            // n²/2a more than by the file
            let longer = n * n / (2.0 * 67.0) * (1.0 / share - 1.0);
            let taught = first.taught.expect("it has slowed down");
            assert!((taught.value() - longer).abs() < 1e-3, "{of}: {taught:?}");
            let known = run(true, taught);
            // what is left open is turned at the speed between instead of at n, and a quarter of it
            // at the creep
            let open = n * n / 134.0 * 1.2 - n * n / (134.0 * share);
            let rest = 0.25 * 0.2 * 0.49 * n * n / (134.0 * share);
            let late = 4e-3 * n;
            let costs = (open + late) * (1.0 / 0.7 - 1.0) / n + (rest + 0.7 * late) / (0.1 * n);
            // 20 ms at its creep, three delays, and at the creep what would be too short a time at
            // the speed between
            let most = 1.15 * costs + 0.02 + 3.0 * 0.01 + 0.7 * 0.01 / 0.1;
            let more = first.seconds - known.seconds;
            assert!(more < most, "{of}: {more} s more, {most} at most");
        }
    }
}
