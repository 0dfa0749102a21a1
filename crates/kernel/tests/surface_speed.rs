//! Constant surface speed: the spindle goes by X, n = v / 2π·|x − axis|, and never above its limit.
use crate::common::*;
use bus::{Sample, State};
use canon::Position;
use core::f64::consts::TAU;
use kernel::Order;
use motion::{Move, Path, Phase, Profile, SurfaceSpeed};
use plan::{SpindleStep, StepKind};
use units::{Length, Speed, Spin, Time};

/// 100 m/min about X-30, 3000 rpm at most.
const AXIS_MM: f64 = -30.0;
const SPEED_MM_PER_S: f64 = 100e3 / 60.0;
const LIMIT: Spin = Spin::rpm(3000.0);

fn surface(sign: f64) -> StepKind {
    let surface = SurfaceSpeed {
        speed: Speed::mm_per_s(sign * SPEED_MM_PER_S),
        limit: LIMIT,
        axis: Length::mm(AXIS_MM),
    };
    let order = SpindleStep::Surface { surface, ramp: Profile::EMPTY.into() };
    StepKind::Spindle { spindle: 0, order }
}

/// X on a radius.
fn at(radius: f64) -> Position {
    Position::xyz(AXIS_MM + radius, 0.0, 0.0)
}

/// Feed at a constant rate from one radius to another: mm/s, or mm/rev.
fn face(from: f64, to: f64, feed: f64, per_revolution: bool) -> StepKind {
    let path = Path::Line { from: at(from), to: at(to) };
    let mut profile = Profile::EMPTY;
    let duration = path.length() / feed;
    assert!(profile.push(Phase { duration, s: 0.0, v: feed, a: 0.0, j: 0.0 }));
    StepKind::Move(Box::new(Move {
        path,
        profile,
        rapid: false,
        per_revolution,
        exact_stop: true,
        floats: false,
        programmed: None,
    }))
}

fn rpm(sample: &Sample) -> f64 {
    sample.truth.unwrap().spins[0].in_rpm()
}

/// The closed form, by the place where the tool is.
fn wanted_rpm(sample: &Sample) -> f64 {
    let radius = (sample.axis(0).value() - AXIS_MM).abs();
    (60.0 * SPEED_MM_PER_S / (TAU * radius)).min(LIMIT.in_rpm())
}

fn run_here(steps: &[StepKind], orders: &[(usize, Order)]) -> Run {
    let machine = machine(1);
    let control = control(&machine);
    let mut real = sim::SimulatedMachine::new(machine).unwrap();
    let seen = run_ordered(kernel::Kernel::new(control), &mut real, steps, 60_000, orders);
    assert_eq!(seen.kernel.faults(), []);
    assert_eq!(seen.kernel.report().state, State::Ended);
    seen
}

/// "At speed" is a window of some per cent; this is about what follows once the loop has settled in
/// it.
fn settled() -> StepKind {
    StepKind::Dwell(Time::s(0.3))
}

/// From a radius of 30 mm, at speed.
fn facing(cut: StepKind) -> Vec<StepKind> {
    vec![surface(1.0), await_speed(), settled(), cut, StepKind::End]
}

fn cut(seen: &Run) -> impl Iterator<Item = &Sample> {
    seen.samples.iter().filter(|s| s.report.state == State::Feed)
}

#[test]
fn in_a_facing_cut_the_speed_follows_the_diameter_up_to_the_limit() {
    let seen = run_here(&facing(face(30.0, 0.5, 10.0, false)), &[]);
    let worst = cut(&seen).map(|s| (rpm(s) / wanted_rpm(s) - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 0.01, "{} % off", worst * 100.0);
    let (first, last) = (cut(&seen).next().unwrap(), cut(&seen).last().unwrap());
    assert!((rpm(first) - 530.5).abs() < 5.0, "{} rpm at a radius of 30", rpm(first));
    assert!((rpm(last) - 3000.0).abs() < 10.0, "{} rpm at the centre", rpm(last));
}

#[test]
fn feed_per_revolution_goes_by_the_turns_and_lasts_as_the_integral_says() {
    let seen = run_here(&facing(face(30.0, 0.5, 0.3, true)), &[]);
    let turns = cut(&seen).last().unwrap().spindle(0) - cut(&seen).next().unwrap().spindle(0);
    assert!((turns.value() - 29.5 / 0.3).abs() < 0.1, "{} turns", turns.value());
    // t = ∫ 2πr/(v·f)·dr down to the radius of the limit, then turns at the limit
    let knee = SPEED_MM_PER_S / (TAU * LIMIT.value());
    let by_surface = TAU / 2.0 * (900.0 - knee * knee) / (SPEED_MM_PER_S * 0.3);
    let wanted = by_surface + (knee - 0.5) / 0.3 / LIMIT.value();
    let lasted = cut(&seen).count() as f64 * PERIOD.value();
    assert!((lasted / wanted - 1.0).abs() < 0.01, "{lasted} s, {wanted} s");
}

#[test]
fn at_the_axis_of_the_work_and_beyond_it_the_limit_holds_in_either_sense() {
    let steps = [surface(-1.0), await_speed(), face(30.0, -3.0, 10.0, false), StepKind::End];
    let seen = run_here(&steps, &[]);
    let fastest = seen.samples.iter().map(rpm).fold(0.0, f64::min);
    assert!((-3030.0..-2990.0).contains(&fastest), "{fastest} rpm");
}

#[test]
fn after_it_a_speed_in_revolutions_is_held_wherever_x_goes() {
    let mut steps = facing(face(30.0, 10.0, 10.0, false));
    steps.pop();
    let back = [
        turn(1500.0, 800.0),
        await_speed(),
        settled(),
        face(10.0, 30.0, 10.0, false),
        StepKind::End,
    ];
    steps.extend(back);
    let seen = run_here(&steps, &[]);
    for sample in cut(&seen).filter(|s| s.report.op == 6) {
        assert!((rpm(sample) - 800.0).abs() < 8.0, "{} rpm", rpm(sample));
    }
}

#[test]
fn the_operators_override_acts_on_it_and_the_limit_on_both() {
    let orders = [(0, Order::SpindleOverride(1.2))];
    let seen = run_here(&facing(face(30.0, 0.5, 10.0, false)), &orders);
    for sample in cut(&seen) {
        let radius = (sample.axis(0).value() - AXIS_MM).abs();
        let wanted = (1.2 * 60.0 * SPEED_MM_PER_S / (TAU * radius)).min(LIMIT.in_rpm());
        assert!((rpm(sample) / wanted - 1.0).abs() < 0.02, "{} rpm, {wanted}", rpm(sample));
    }
}
