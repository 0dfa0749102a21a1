//! Chip removal on the way: when each thing happens, against closed forms, and what never happens.
//!
//! The machine is ideal: it does what it is told at once. Axes have no limit of jerk, the spindle a
//! constant acceleration A. Then speed over time is made of straight lines, and with S the speed of
//! the cut and U that of the removal the closed forms are (S+U)/A until −U, t = 2(S+U)/A in all
//! after drilling, 2U/A after a tap.
use crate::common::*;
use bus::{Command, Feedback, Machine, Sample, State};
use canon::{
    Axis, ChipRemoval, Feed, Flute, Holder, Hole, Op, OpKind, Position, Span, SpindleOrder, Tap,
    TapTool, ToolKind, ToolLibrary,
};
use kernel::{Event, EventKind, FaultKind};
use motion::{ChipThrow, Path};
use plan::{
    AxisLimits, MachineLimits, Options, Planner, SpindleLimits, Start, Tapping, ToolChange,
};
use plan::{SpindleStep, StepKind};
use proptest::prelude::*;
use test_support::size;
use units::{
    Coordinate, CoordinateAccel, CoordinateJerk, Force, Lead, Length, Power, Speed, Spin,
    Stiffness, Time, Torque,
};

/// Acceleration of the ideal spindle, rev/s²: J = 0.010 kg·m² and 42 N·m give 42/(2π·0.010) = 668
/// rev/s²; planned 85 %.
const A: f64 = 0.85 * 42.0 / (core::f64::consts::TAU * 0.010);
const R: f64 = -100.0;
const INITIAL: f64 = -50.0;
const BOTTOM: f64 = -140.0;

fn ideal() -> sim::Config {
    let mut machine = machine(0);
    for (_, axis) in &mut machine.axes {
        axis.backlash = Coordinate::ZERO;
    }
    let spindle = &mut machine.spindles[0];
    spindle.torque_lag = Time::ZERO;
    spindle.coulomb = Torque::ZERO;
    spindle.viscous_n_m_s_per_rad = 0.0;
    spindle.peak_power = Power::w(1e9);
    machine
}

fn limits(accel: f64) -> MachineLimits {
    let axis = AxisLimits {
        travel: None,
        accel: CoordinateAccel::new(accel),
        rapid_jerk: CoordinateJerk::new(f64::INFINITY),
        feed_jerk: CoordinateJerk::new(f64::INFINITY),
        ..Z_LIMITS
    };
    let spindle = SpindleLimits {
        friction: Torque::ZERO,
        viscous_n_m_s_per_rad: 0.0,
        peak_power: Power::w(1e9),
        torque_rise: Time::ZERO,
        ..SPINDLE_LIMITS
    };
    let mut axes = [None; 9];
    axes[..3].fill(Some(axis));
    MachineLimits {
        axes,
        spindles: vec![spindle],
        tool_change: ToolChange { z: None, x: None, y: None, pockets: 0, time: Time::s(0.9) },
        settling: Time::s(5e-3),
        tapping: Tapping::along_z(SPINDLE_LIMITS.margin),
        joining: plan::Joining::EXACT,
        signals: None,
    }
}

/// A tap in the spindle already: it drills air and taps air alike.
fn tools() -> ToolLibrary {
    let kind = ToolKind::Tap(TapTool {
        designation: "M6x1".into(),
        lead: Lead::mm_per_rev(1.0),
        chamfer_pitches: 2.5,
        thread_length: Length::mm(100.0),
        flute: Flute::SpiralFlute,
        oversize: Length::um(40.0),
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    });
    ToolLibrary::new([canon::Tool {
        number: 1,
        pocket: 1,
        length: Length::ZERO,
        diameter: Length::mm(6.0),
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }])
}

/// One repetition of a cycle.
#[derive(Clone, Copy, Debug)]
struct Repetition {
    x_mm: f64,
    tap: bool,
    /// U, rpm; 0: none.
    throw_rpm: f64,
    /// Up to here, from R.
    clear_mm: f64,
}

fn at(x: f64, z: f64) -> Position {
    Position::xyz(x, 0.0, z)
}

/// What the interpreter makes of G81 and G84 at S.
fn ops(s_rpm: f64, repetitions: &[Repetition]) -> Vec<Op> {
    let order = |order| OpKind::Spindle { spindle: 0, order };
    let turn = order(SpindleOrder::Turn(Spin::rpm(s_rpm)));
    let mut kinds = vec![turn, OpKind::Rapid { to: at(0.0, INITIAL) }];
    let mut height = INITIAL;
    for r in repetitions {
        kinds.push(OpKind::Rapid { to: at(r.x_mm, height) });
        kinds.push(OpKind::Rapid { to: at(r.x_mm, R) });
        let then = if r.tap {
            kinds.push(OpKind::Tap(Tap {
                axis: Axis::Z,
                start: at(r.x_mm, R),
                bottom: Length::mm(R - 10.0),
                surface: Length::mm(R - 2.0),
                zero: Length::mm(R - 2.0),
                own_zero: None,
                lead: Lead::mm_per_rev(1.0),
                spin: Spin::rpm(s_rpm.min(3000.0)),
                return_spin: Spin::rpm(s_rpm.min(3000.0)),
                return_acceleration: canon::ReturnAcceleration::AsSet,
                dwell: Time::ZERO,
                start_angle: None,
                peck: None,
            }));
            Spin::ZERO
        } else {
            let (axis, at_r) = (Axis::Z, at(r.x_mm, R));
            kinds.push(OpKind::Hole(Hole {
                axis,
                at: at_r,
                bottom: Length::mm(BOTTOM),
                surface: Length::mm(R),
                zero: Length::mm(R),
                own_zero: None,
            }));
            let feed = Feed::PerTime(Speed::mm_per_min(6000.0));
            kinds.push(OpKind::Line { to: at(r.x_mm, BOTTOM), feed });
            Spin::rpm(s_rpm)
        };
        if r.throw_rpm > 0.0 {
            kinds.push(order(SpindleOrder::ThrowChips(ChipRemoval {
                throw: Spin::rpm(-r.throw_rpm),
                then,
                axis: Axis::Z,
                level: Length::mm(R),
            })));
        }
        height = R + r.clear_mm;
        kinds.push(OpKind::Rapid { to: at(r.x_mm, height) });
    }
    kinds.push(OpKind::End);
    let span = |line| Span { file: 0, line, start: 0, end: 0 };
    (1..).zip(kinds).map(|(line, kind)| Op { span: span(line), kind }).collect()
}

fn steps(ops: &[Op], accel: f64) -> Vec<StepKind> {
    steps_within(limits(accel), ops)
}

/// What the embedded tapping centre may be asked: jerk, power, friction and all.
fn real_limits() -> MachineLimits {
    let mut axes = [None; 9];
    axes[..3].fill(Some(Z_LIMITS));
    MachineLimits { axes, spindles: vec![SPINDLE_LIMITS], ..limits(1.0) }
}

fn steps_within(limits: MachineLimits, ops: &[Op]) -> Vec<StepKind> {
    let options = Options {
        force_ramp: None,
        cutting_pressure_n_per_mm2: 1300.0,
        taps: plan::Unsynchronised::default(),
    };
    let start = Start { position: Position::default(), tool: 1 };
    let mut planner = Planner::new(limits, tools(), options, start);
    let mut steps = Vec::new();
    for (index, op) in (0..).zip(ops) {
        planner.push(index, op, &mut |step| steps.push(step.kind));
    }
    planner.finish(&mut |step| steps.push(step.kind));
    for finding in planner.take_findings() {
        assert!(!finding.is_error(), "{finding:?}");
    }
    steps
}

/// Obeys at once.
struct Obedient(Feedback, Spin);

impl Machine for Obedient {
    fn period(&self) -> Time {
        PERIOD
    }
    fn feedback(&self) -> &Feedback {
        &self.0
    }
    fn exchange(&mut self, command: &Command) -> &Feedback {
        self.0.time += PERIOD;
        self.0.tool = Some(command.tool);
        for (axis, told) in self.0.axes.iter_mut().zip(&command.axes) {
            axis.ready = true;
            if told.enable {
                axis.position = told.position;
            }
        }
        let (spindle, told) = (&mut self.0.spindles[0], &command.spindles[0]);
        spindle.ready = true;
        if told.enable {
            // the mean of this period's speed and the last one's: a ramp is a parabola of the angle
            spindle.angle += (self.1 + told.spin) * PERIOD * 0.5;
            self.1 = told.spin;
        }
        &self.0
    }
}

fn run_ideal(ops: &[Op], accel: f64) -> Run {
    let machine = ideal();
    let mut control = control(&machine);
    for axis in control.axes.iter_mut().flatten() {
        axis.weight = Force::ZERO;
        axis.stiffness = Stiffness::n_per_mm(1e12);
    }
    let mut plant = Obedient(Feedback::default(), Spin::ZERO);
    let run = run_on(&mut plant, &control, &steps(ops, accel), 200_000);
    assert!(run.kernel.is_over(), "the program did not end");
    run
}

fn when(events: &[Event], wanted: impl Fn(&EventKind) -> bool) -> Vec<f64> {
    events.iter().filter(|e| wanted(&e.kind)).map(|e| e.time.value()).collect()
}

fn removal_times(run: &Run) -> [Vec<f64>; 3] {
    [
        when(&run.events, |e| matches!(e, EventKind::ChipRemovalBegun { .. })),
        when(&run.events, |e| matches!(e, EventKind::ChipsThrown { .. })),
        when(&run.events, |e| matches!(e, EventKind::ChipRemovalEnded { .. })),
    ]
}

fn near(found: f64, wanted: f64, what: &str) {
    assert!((found - wanted).abs() < 1e-3, "{what}: {found:.5} s, closed form {wanted:.5} s");
}

#[test]
fn after_drilling_minus_u_is_reached_in_s_plus_u_over_a_and_plus_s_in_twice_that() {
    for (s, u, accel) in
        [(5000.0, 2000.0, 12_000.0), (3000.0, 500.0, 12_000.0), (6000.0, 5900.0, 8000.0)]
    {
        let one = Repetition { x_mm: -10.0, tap: false, throw_rpm: u, clear_mm: 50.0 };
        let run = run_ideal(&ops(s, &[one, Repetition { x_mm: -20.0, ..one }]), accel);
        assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
        let [begun, thrown, ended] = removal_times(&run);
        assert_eq!((begun.len(), thrown.len(), ended.len()), (2, 2, 2));
        for i in 0..2 {
            near(thrown[i] - begun[i], (s + u) / 60.0 / A, "until −U");
            near(ended[i] - begun[i], 2.0 * (s + u) / 60.0 / A, "in all");
        }
        let at_the_bottom = run.samples.iter().rfind(|s| s.report.op == 5);
        let left = at_the_bottom.expect("it has been at the bottom").feedback.time.value();
        // from the bottom up: acceleration a as far as v²/2a, then at v
        let (way, v) = (R - BOTTOM, 50_000.0 / 60.0);
        let ramp = v * v / (2.0 * accel);
        let rise =
            if way <= ramp { (2.0 * way / accel).sqrt() } else { v / accel + (way - ramp) / v };
        near(begun[0] - left, rise, "from the bottom to R");
    }
}

#[test]
fn after_a_tap_the_spindle_rests_again_after_2u_over_a() {
    let one = Repetition { x_mm: -10.0, tap: true, throw_rpm: 1500.0, clear_mm: 50.0 };
    let run = run_ideal(&ops(3000.0, &[one, Repetition { x_mm: -20.0, ..one }]), 12_000.0);
    assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
    let [begun, thrown, ended] = removal_times(&run);
    assert_eq!((begun.len(), thrown.len(), ended.len()), (2, 2, 2));
    for i in 0..2 {
        near(thrown[i] - begun[i], 1500.0 / 60.0 / A, "until −U");
        near(ended[i] - begun[i], 2.0 * 1500.0 / 60.0 / A, "in all");
    }
}

#[test]
fn the_cut_waits_at_r_for_what_the_travel_did_not_cover_and_no_longer() {
    // a retract to R alone and a short way over: most of the removal is left when the axis stands
    // at R
    let short = Repetition { x_mm: -1.0, tap: false, throw_rpm: 2000.0, clear_mm: 0.0 };
    let run = run_ideal(
        &ops(5000.0, &[short, Repetition { x_mm: -2.0, throw_rpm: 0.0, ..short }]),
        15_000.0,
    );
    let [begun, _, ended] = removal_times(&run);
    near(ended[0] - begun[0], 2.0 * 7000.0 / 60.0 / A, "in all");
    let cut = run
        .samples
        .iter()
        .find(|s| s.report.state == State::Feed && s.feedback.time.value() > begun[0]);
    let cut = cut.expect("there is a second cut");
    assert!(cut.feedback.time.value() - ended[0] < 2.0 * PERIOD.value(), "the cut dawdles");
    let waited = run
        .samples
        .iter()
        .filter(|s| s.report.state == State::SpindleWait && s.feedback.time.value() > begun[0]);
    assert!(waited.count() > 100, "it has to wait at R");
}

/// What may come after the last hole of a series, with M3 in force all the while.
fn endings() -> Vec<(&'static str, Vec<OpKind>)> {
    let stop = OpKind::Spindle { spindle: 0, order: SpindleOrder::Stop };
    let away = OpKind::Rapid { to: at(30.0, INITIAL) };
    let slower = OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(Spin::rpm(500.0)) };
    let feed = Feed::PerTime(Speed::mm_per_min(6000.0));
    let cut = OpKind::Line { to: at(40.0, INITIAL), feed };
    vec![
        ("M30", vec![stop.clone()]),
        ("G80 G0 X30, M5", vec![away.clone(), stop.clone()]),
        ("S500 G0 X30", vec![slower, away.clone()]),
        ("G0 X30, G1", vec![away, cut]),
        ("G4", vec![OpKind::Dwell { time: Time::s(0.01) }, stop]),
    ]
}

#[test]
fn the_chips_of_the_last_tap_fly_off_on_the_way_out_and_the_tool_does_not_wait_at_r() {
    for (name, ending) in endings() {
        let one = Repetition { x_mm: -10.0, tap: true, throw_rpm: 2500.0, clear_mm: 50.0 };
        let mut ops = ops(3000.0, &[one, Repetition { x_mm: -20.0, ..one }]);
        let last = ops.pop().expect("the end");
        let line = last.span.line;
        for (i, kind) in (0..).zip(ending.into_iter().chain([OpKind::End])) {
            let span = Span { line: line + i, ..last.span };
            ops.push(Op { span, kind });
        }
        let run = run_ideal(&ops, 12_000.0);
        assert!(run.kernel.faults().is_empty(), "{name}: {:?}", run.kernel.faults());
        let [begun, _, ended] = removal_times(&run);
        assert_eq!((begun.len(), ended.len()), (2, 2), "{name}");
        // from R up by 5 mm with an acceleration a: sqrt(2 s/a), the whole removal lasts longer
        // than that
        let rise = (2.0 * 5.0 / 12_000.0_f64).sqrt();
        let higher = run.samples.iter().find(|sample| {
            sample.feedback.time.value() > begun[1]
                && sample.feedback.axes[2].position.value() > R + 5.0
        });
        let left = higher.expect("it comes out").feedback.time.value() - begun[1];
        assert!(
            ended[1] - begun[1] > 2.0 * rise,
            "{name}: the removal is long enough to be hidden"
        );
        assert!(
            left < rise + 0.01,
            "{name}: out by 5 mm after {left:.3} s, without waiting {rise:.3} s"
        );
    }
}

/// By how much the spindle is astray in a cut: judged from the record alone, by what the program
/// wanted.
fn violations(run: &Run, s_rpm: f64) -> usize {
    let spin = |pair: &[Sample]| {
        (pair[1].spindle(0) - pair[0].spindle(0)) / (pair[1].feedback.time - pair[0].feedback.time)
    };
    run.samples
        .windows(2)
        .filter(|pair| pair[0].report.state == State::Feed && pair[1].report.state == State::Feed)
        .filter(|pair| (spin(pair) - Spin::rpm(s_rpm)).abs() > Spin::rpm(0.03 * s_rpm))
        .count()
}

fn repetition() -> impl Strategy<Value = Repetition> {
    let throw = prop_oneof![Just(0.0), 0.05..0.99f64];
    let clear = prop_oneof![Just(0.0), 1.0..60.0f64];
    (-200.0..0.0f64, any::<bool>(), throw, clear)
        .prop_map(|(x_mm, tap, throw_rpm, clear_mm)| Repetition { x_mm, tap, throw_rpm, clear_mm })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(60, 1200), ..ProptestConfig::default() })]

    #[test]
    fn no_program_cuts_with_the_spindle_wrong(
        s_rpm in 400.0..9000.0f64,
        mut repetitions in prop::collection::vec(repetition(), 1..5),
        accel in 2000.0..12_000.0f64,
    ) {
        for r in &mut repetitions {
            r.throw_rpm *= if r.tap { s_rpm.min(3000.0) } else { s_rpm };
        }
        let run = run_ideal(&ops(s_rpm, &repetitions), accel);
        prop_assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
        prop_assert_eq!(violations(&run, s_rpm), 0);
        let thrown = when(&run.events, |e| matches!(e, EventKind::ChipsThrown { .. })).len();
        prop_assert_eq!(thrown, repetitions.iter().filter(|r| r.throw_rpm > 0.0).count());
        let drilled = run.samples.windows(2).filter(|p| p[0].report.state != State::Feed && p[1].report.state == State::Feed);
        prop_assert_eq!(drilled.count(), repetitions.iter().filter(|r| !r.tap).count());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: size::of(10, 200), ..ProptestConfig::default() })]

    /// With friction, lag, power curve, backlash, and axes that bend: every servo period of every
    /// cut is looked at.
    #[test]
    fn no_program_cuts_with_the_spindle_wrong_on_the_real_machine_either(
        s_rpm in 400.0..9000.0f64,
        mut repetitions in prop::collection::vec(repetition(), 1..4),
    ) {
        for r in &mut repetitions {
            r.throw_rpm *= if r.tap { s_rpm.min(3000.0) } else { s_rpm };
        }
        let machine = machine(1);
        let steps = steps_within(real_limits(), &ops(s_rpm, &repetitions));
        let run = run(&machine, &control(&machine), &steps);
        prop_assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
        let cuts = run.samples.iter().filter(|s| s.report.state == State::Feed);
        for sample in cuts {
            let spin = sample.truth.expect("simulated").spins[0].in_rpm();
            prop_assert!((spin - s_rpm).abs() < 0.05 * s_rpm, "{spin} rpm in a cut at S{s_rpm}");
        }
        let thrown = when(&run.events, |e| matches!(e, EventKind::ChipsThrown { .. })).len();
        prop_assert_eq!(thrown, repetitions.iter().filter(|r| r.throw_rpm > 0.0).count());
    }
}

/// Steps that no planner makes: a cut right behind the order to throw chips off.
fn careless(then_rpm: f64) -> Vec<StepKind> {
    let spindle = |order| StepKind::Spindle { spindle: 0, order };
    let ramp = |from: f64, to: f64| limits(1e4).spindles[0].ramp(Spin::rpm(from), Spin::rpm(to));
    let turn = SpindleStep::Turn { spin: Spin::rpm(3000.0), ramp: ramp(0.0, 3000.0).into() };
    let throw = SpindleStep::Throw(Box::new(ChipThrow {
        throw: Spin::rpm(-1000.0),
        against: ramp(3000.0, -1000.0),
        then: Spin::rpm(then_rpm),
        back: ramp(-1000.0, then_rpm),
        axis: Axis::Z,
        level: Length::mm(-1e3),
        upwards: true,
    }));
    let path = Path::Line { from: Position::default(), to: Position::xyz(0.0, 0.0, -20.0) };
    let cut = motion::Move {
        path,
        profile: plan::rest_to_rest(20.0, 50.0, 1000.0, 1e5),
        rapid: false,
        per_revolution: false,
        exact_stop: true,
        floats: false,
        programmed: None,
    };
    vec![spindle(turn), await_speed(), spindle(throw), StepKind::Move(cut.into()), StepKind::End]
}

#[test]
fn a_cut_during_a_removal_is_alarm_204_at_once_and_the_machine_stops() {
    let machine = ideal();
    let run = run(&machine, &control(&machine), &careless(3000.0));
    let fault = run.kernel.faults().first().expect("an alarm");
    assert_eq!(fault.kind, FaultKind::WrongSpinInCut);
    assert_eq!(fault.kind.number(), 204);
    let deepest = run.deepest_mm();
    assert!(deepest > -0.5, "it went on to {deepest} mm");
}

#[test]
fn a_removal_before_it_does_not_touch_a_taps_depth() {
    let tap = Repetition { x_mm: -10.0, tap: true, throw_rpm: 2000.0, clear_mm: 20.0 };
    let run = run_ideal(&ops(3000.0, &[tap, tap]), 10_000.0);
    assert!(run.kernel.faults().is_empty(), "{:?}", run.kernel.faults());
    let ends = run.events.iter().filter_map(|e| match e.kind {
        EventKind::TapEnded(figures) => Some(figures.depth_error.in_um().abs()),
        _ => None,
    });
    let ends: Vec<_> = ends.collect();
    assert_eq!(ends.len(), 2);
    assert!(ends.iter().all(|e| *e < 5.0), "{ends:?} µm");
}
