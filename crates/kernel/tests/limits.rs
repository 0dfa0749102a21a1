//! What is emitted never asks more of an axis than its limits: setpoints of a whole polygon
//! program, by their differences.
//!
//! ```text
//!   v = Δx/T     a = Δ²x/T²     j = Δ³x/T³      T servo period; each is a mean of what happens in between
//! ```
use crate::common::{PERIOD, Run, control, machine, run_ordered};
use canon::{
    Arc, Axis, Feed, Harmonic, Op, OpKind, Oscillating, Oscillation, Plane, Polygon, Position,
    Ratio, Span, SpindleOrder, ToolLibrary,
};
use core::f64::consts::TAU;
use kernel::{Kernel, Order, Periodic};
use plan::{
    AxisLimits, MachineLimits, Options, Planner, SpindleLimits, Start, Tapping, ToolChange,
};
use sim::SimulatedMachine;
use units::{
    Angle, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Inertia, Lead, Length, Power, Speed,
    Spin, Time, Torque,
};

const AXIS: AxisLimits = AxisLimits {
    travel: None,
    rapid_speed: CoordinateSpeed::new(400.0),
    feed_speed: CoordinateSpeed::new(200.0),
    accel: CoordinateAccel::new(8000.0),
    rapid_jerk: CoordinateJerk::new(500e3),
    feed_jerk: CoordinateJerk::new(500e3),
};

const SPINDLE: SpindleLimits = SpindleLimits {
    inertia: Inertia::kg_m2(0.010),
    peak_torque: Torque::n_m(42.0),
    continuous_torque: units::Torque::n_m(1e9),
    thermal_time: units::Time::s(60.0),
    peak_power: Power::w(15_000.0),
    friction: Torque::n_m(0.3),
    viscous_n_m_s_per_rad: 0.0012,
    max_speed: Spin::rpm(6000.0),
    tapping_max: Spin::rpm(6000.0),
    margin: 0.85,
    torque_rise: Time::s(0.006),
};

const RPM: f64 = 300.0;
/// Facets.
const M: u32 = 4;

/// A swing along X whose jerk is this share of its limit, on two harmonics.
fn swing(share: f64) -> Oscillation {
    // the jerk of a·(cos Mφ + sin 2Mφ/8) is a·w³·(sin Mφ − cos 2Mφ), 2·a·w³ at most
    let a = share * 500e3 / (2.0 * (TAU * f64::from(M) * RPM / 60.0).powi(3));
    let harmonics = vec![
        Harmonic { per_turn: M, cosine: a, sine: 0.0 },
        Harmonic { per_turn: 2 * M, cosine: 0.0, sine: a / 8.0 },
    ];
    Oscillation { on: Oscillating::Axis(Axis::X), harmonics }
}

fn cut(x: f64, z: f64) -> OpKind {
    cut_at(x, z, 100.0)
}

fn cut_at(x: f64, z: f64, mm_per_s: f64) -> OpKind {
    let feed = Feed::PerTime(Speed::mm_per_s(mm_per_s));
    OpKind::Line { to: Position::xyz(x, 0.0, z), feed }
}

fn cut_per_turn(x: f64, z: f64, mm: f64) -> OpKind {
    let feed = Feed::PerRevolution(Lead::mm_per_rev(mm));
    OpKind::Line { to: Position::xyz(x, 0.0, z), feed }
}

/// A quarter of a circle of 5 mm, on from where a cut along Z ends.
fn quarter() -> OpKind {
    let arc =
        Arc { plane: Plane::ZX, centre: [-20.0, -65.0].map(Length::mm), sweep: Angle::rev(0.25) };
    let feed = Feed::PerTime(Speed::mm_per_s(100.0));
    OpKind::Arc { to: Position::xyz(-65.0, 0.0, -25.0), arc, feed }
}

/// In on X while it swings, cuts from X−60 Z−5 on, out again, all faster than the swing would leave
/// time for.
fn program(oscillation: Oscillation, cuts: &[OpKind]) -> Vec<Op> {
    let rapid = |x, z| OpKind::Rapid { to: Position::xyz(x, 0.0, z) };
    let polygon = Polygon {
        work: 0,
        tool: 1,
        ratio: Ratio { follower: 2, master: 1 },
        phase: Angle::ZERO,
        oscillations: vec![oscillation],
        auto: None,
        by_distance: Vec::new(),
        wanted: Vec::new(),
        compensated: false,
        zero: Position::default(),
        own_zero: None,
    };
    let before = [
        rapid(-30.0, -5.0),
        OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(Spin::rpm(RPM)) },
        OpKind::Polygon(polygon),
        rapid(-60.0, -5.0),
    ];
    let after = [rapid(-30.0, -30.0), OpKind::PolygonEnd, rapid(0.0, 0.0), OpKind::End];
    let kinds = before.into_iter().chain(cuts.iter().cloned()).chain(after);
    let place = |line| Span { file: 0, line, start: 0, end: 0 };
    (1..).zip(kinds).map(|(line, kind)| Op { span: place(line), kind }).collect()
}

fn limits() -> MachineLimits {
    let mut axes = [None; 9];
    axes[..3].fill(Some(AXIS));
    MachineLimits {
        axes,
        spindles: vec![SPINDLE; 2],
        tool_change: ToolChange { z: None, x: None, y: None, pockets: 0, time: Time::ZERO },
        settling: Time::ZERO,
        tapping: Tapping::along_z(0.85),
        joining: plan::Joining::EXACT,
        signals: None,
    }
}

/// Planned and run on the simulated machine.
fn run_program(ops: &[Op]) -> Run {
    run_with(ops, &[])
}

/// The same, with orders of the operator by their ticks.
fn run_with(ops: &[Op], orders: &[(usize, Order)]) -> Run {
    let options = Options {
        force_ramp: None,
        cutting_pressure_n_per_mm2: 3900.0,
        taps: plan::Unsynchronised::default(),
    };
    let start = Start { position: Position::default(), tool: 0 };
    let mut planner = Planner::new(limits(), ToolLibrary::new([]), options, start);
    let mut steps = Vec::new();
    for (index, op) in (0..).zip(ops) {
        planner.push(index, op, &mut |step: plan::Step| steps.push(step.kind));
    }
    planner.finish(&mut |step: plan::Step| steps.push(step.kind));
    let refused: Vec<_> =
        planner.take_findings().into_iter().filter(diag::Diagnostic::is_error).collect();
    assert!(refused.is_empty(), "{refused:?}");
    let mut plant = machine(1);
    plant.spindles.push(plant.spindles[0]);
    let mut control = control(&plant);
    control.motion = limits().motion(1.0);
    // fades as moves at approach speed do, and no slower
    for axis in control.axes.iter_mut().flatten() {
        axis.approach = (CoordinateSpeed::new(50.0), CoordinateAccel::new(1000.0));
    }
    let mut kernel = Kernel::new(control);
    for table in planner.take_tables() {
        let nodes = Periodic::new(&table.nodes).expect("it is a table");
        kernel.put_table(table.id, nodes).expect("there is room");
    }
    let mut plant = SimulatedMachine::new(plant).expect("it can be built");
    run_ordered(kernel, &mut plant, &steps, 80_000, orders)
}

/// Largest speed, acceleration and jerk of an axis' setpoints, from the first move on: before it
/// they are where the encoders find the axes when the machine is switched on.
fn largest(run: &Run, axis: usize) -> [f64; 3] {
    let moving = run.samples.iter().skip_while(|s| s.report.state == bus::State::Idle);
    let mut line: Vec<f64> = moving.map(|s| s.command.axes[axis].position.value()).collect();
    [(); 3].map(|()| {
        line = line.windows(2).map(|pair| (pair[1] - pair[0]) / PERIOD.value()).collect();
        line.iter().fold(0.0_f64, |most, x| most.max(x.abs()))
    })
}

/// Run these cuts beside a swing that is at its limit; jerk may be over its own by a share.
#[track_caller]
fn within_limits(cuts: &[OpKind], over: f64) -> Run {
    let run = run_program(&program(swing(0.9), cuts));
    assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
    assert_eq!(run.kernel.report().state, bus::State::Ended);
    for axis in [0, 2] {
        let [speed, accel, jerk] = largest(&run, axis);
        println!("axis {axis}: {speed:.1} mm/s, {accel:.0} mm/s², {jerk:.0} mm/s³");
        let rounded = 1.0 + 1e-9;
        assert!(speed <= 400.0 * rounded && accel <= 8000.0 * rounded, "{axis}: {speed} {accel}");
        assert!(jerk <= 500e3 * (1.0 + over), "{axis}: {jerk}");
    }
    run
}

#[test]
fn a_swing_at_its_limit_its_fades_and_moves_beside_it_stay_within_the_axis_limits() {
    let run = within_limits(&[cut(-65.0, -30.0)], 1e-6);
    // and it is no empty promise: X gets near its jerk
    assert!(largest(&run, 0)[2] > 0.88 * 500e3, "{:?}", largest(&run, 0));
}

#[test]
fn moves_beside_a_swing_take_longer_than_without_one() {
    let seconds = |share| run_program(&program(swing(share), &[cut(-65.0, -30.0)])).seconds;
    // four moves with a tenth of the jerk: each more than twice as long as with all of it
    let (beside, alone) = (seconds(0.9), seconds(1e-6));
    assert!(beside > alone + 0.2, "{beside} s, {alone} s");
}

/// What the law of time along joined paths is held to, tighter than where all its limits bind at
/// once.
const JOINED: f64 = 0.01;

#[test]
fn corners_between_cuts_stay_within_the_limits_whether_the_path_turns_or_its_feed_changes() {
    within_limits(&[cut(-60.0, -20.0), cut(-62.0, -20.0), cut(-62.0, -30.0)], JOINED);
    within_limits(&[cut(-60.0, -20.0), cut(-60.01, -30.0)], JOINED);
    within_limits(&[cut_at(-60.0, -20.0, 100.0), cut_at(-60.0, -30.0, 20.0)], JOINED);
    within_limits(&[cut(-60.0, -20.0), quarter(), cut(-70.0, -25.0)], JOINED);
}

#[test]
fn so_do_cuts_with_a_feed_per_revolution() {
    within_limits(&[cut_per_turn(-60.0, -20.0, 10.0), cut_per_turn(-60.0, -30.0, 3.0)], JOINED);
    within_limits(&[cut_per_turn(-60.0, -20.0, 10.0), cut_per_turn(-62.0, -30.0, 3.0)], JOINED);
}

/// Holds, and a feed turned down, while X cuts beside a swing that takes half of its jerk: they may
/// use the other half.
#[test]
fn a_hold_beside_a_swing_gets_what_the_swing_leaves() {
    let ops = program(swing(0.5), &[cut(-65.0, -10.0), cut(-100.0, -10.0)]);
    let plain = run_program(&ops);
    let cutting = |s: &bus::Sample| s.report.state == bus::State::Feed;
    let begins = plain.samples.iter().position(cutting).expect("it cuts");
    let ends = plain.samples.iter().rposition(cutting).expect("it cuts");
    for part in 1..8 {
        let at = begins + (ends - begins) * part / 8;
        let orders = [
            (at, Order::FeedOverride(0.4)),
            (at + 150, Order::FeedHold),
            (at + 1500, Order::Resume),
            (at + 1600, Order::FeedOverride(1.0)),
        ];
        let run = run_with(&ops, &orders);
        assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
        assert_eq!(run.kernel.report().state, bus::State::Ended);
        assert!(run.seconds > plain.seconds + 0.2, "it was not held");
        let [speed, accel, jerk] = largest(&run, 0);
        println!("held in period {at}: {speed:.1} mm/s, {accel:.0} mm/s², {jerk:.0} mm/s³");
        let rounded = 1.0 + 1e-9;
        assert!(speed <= 400.0 * rounded && accel <= 8000.0 * rounded, "{speed} {accel}");
        assert!(jerk <= 500e3 * (1.0 + JOINED), "{jerk}");
    }
}
