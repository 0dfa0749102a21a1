//! Homing on a simulated machine that is switched on somewhere: references to a count, limits kept,
//! and every switch, mark, stop or wire that is not where it should be an alarm.
use crate::common::*;
use bus::{Feedback, Machine, State};
use canon::{Axis, Position};
use kernel::{
    EventKind, FaultKind, HomingMethod, HomingOrder, Kernel, ManualOrder, ManualRefusal, Order,
    Reaction,
};
use motion::{Goal, OnlineLimits, Step};
use proptest::prelude::*;
use sim::{HomeSwitch, IndexMarks, PowerOn, SimulatedMachine, Travel};
use test_support::size;
use units::{Coordinate, Length, Stiffness};

const COUNT_MM: f64 = 50e-6;
const STIFFNESS: Stiffness = Stiffness::n_per_mm(80_000.0);
/// What stands along X: travel from -60 to 0, limit switches and hard stops beyond, the switch half
/// a turn before the mark.
const ALONG: Travel = Travel {
    stops: Some((Coordinate::new(-66.0), Coordinate::new(6.0), STIFFNESS)),
    limit_switches: Some((Coordinate::new(-63.0), Coordinate::new(3.0))),
    home_switch: Some(HomeSwitch {
        from: Coordinate::new(-7.0),
        to: Coordinate::new(100.0),
        every: None,
        hysteresis: Coordinate::new(0.05),
    }),
    index: Some(IndexMarks { at: Coordinate::new(1.0), every: Coordinate::new(16.0) }),
    absolute: false,
};
const ORDER: HomingOrder = HomingOrder {
    method: HomingMethod::SwitchAndIndex,
    positive: true,
    off_switch: false,
    fast: 50.0,
    slow: 20.0,
    accel: 2000.0,
    jerk: 200_000.0,
    reference: 1.0,
    search: 74.0,
    index_spacing: 16.0,
    pull_off: 1.0,
    force_share: 0.1,
};

/// The same for a reference at the other end.
fn mirrored(along: &Travel) -> Travel {
    let swap = |(from, to): (Coordinate, Coordinate)| (-to, -from);
    Travel {
        stops: along.stops.map(|(from, to, k)| (-to, -from, k)),
        limit_switches: along.limit_switches.map(swap),
        home_switch: along.home_switch.map(|cam| HomeSwitch {
            from: -cam.to,
            to: -cam.from,
            ..cam
        }),
        index: along.index.map(|marks| IndexMarks { at: -marks.at, ..marks }),
        ..*along
    }
}

struct Bench {
    machine: SimulatedMachine,
    kernel: Kernel,
    /// How the machine is wired.
    wiring: fn(&mut Feedback),
    events: Vec<EventKind>,
    /// Farthest that the setpoint went beyond its limits of speed, acceleration and jerk, as a
    /// share of them.
    most: [f64; 3],
    last: (f64, f64, f64),
    farthest: f64,
    force: f64,
}

impl Bench {
    /// X alone, with a scale, standing at `start`; `None`: by the seed.
    fn new(along: &Travel, start: Option<f64>, seed: u64) -> Self {
        Self::wired(along, start, seed, |_| {})
    }

    fn wired(along: &Travel, start: Option<f64>, seed: u64, wiring: fn(&mut Feedback)) -> Self {
        let mut config = machine(1);
        config.axes.truncate(1);
        config.spindles.clear();
        (config.substep, config.seed) = (units::Time::s(25e-6), seed);
        let axis = &mut config.axes[0].1;
        axis.travel = *along;
        axis.encoder = scale(Coordinate::new(COUNT_MM));
        axis.start = Coordinate::new(start.unwrap_or(0.0));
        config.power_on = if start.is_some() { PowerOn::Known } else { PowerOn::Unknown };
        let mut kernel = Kernel::new(control(&config));
        kernel.forget_home(Axis::X);
        let machine = SimulatedMachine::new(config).expect("the test's machine can be built");
        let mut bench = Self {
            machine,
            kernel,
            wiring,
            events: Vec::new(),
            most: [0.0; 3],
            last: (f64::NAN, 0.0, 0.0),
            farthest: 0.0,
            force: 0.0,
        };
        bench.run(0.1);
        assert!(bench.kernel.is_ready());
        bench
    }

    fn feedback(&self) -> Feedback {
        let mut said = *self.machine.feedback();
        (self.wiring)(&mut said);
        said
    }

    fn tick(&mut self) {
        let command = self.kernel.tick(&self.feedback());
        self.machine.exchange(&command);
        // by the encoder's zero at the start, so that a new name of the place is no step
        let setpoint = self.kernel.setpoint(Axis::X).expect("the machine has X");
        let at = (setpoint - self.kernel.zero(Axis::X)).value();
        let h = PERIOD.value();
        let (last, speed, accel) = self.last;
        let now = (at - last) / h;
        let (change, jerk) = ((now - speed) / h, ((now - speed) / h - accel) / h);
        if now.is_finite() {
            let limits = [ORDER.fast, ORDER.accel, ORDER.jerk];
            for ((most, value), limit) in self.most.iter_mut().zip([now, change, jerk]).zip(limits)
            {
                *most = most.max(value.abs() / limit);
            }
            self.last = (at, now, change);
        } else {
            self.last = (at, 0.0, 0.0);
        }
        let truth = self.machine.truth().expect("it is simulated");
        self.farthest = self.farthest.max(truth.axes[0].value().abs());
        self.force = self.force.max(truth.axis_forces[0].value().abs());
        while let Some(event) = self.kernel.next_event() {
            self.events.push(event.kind);
        }
    }

    fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / PERIOD.value()).round() as u32 {
            self.tick();
        }
    }

    /// Home, to the end or to an alarm; whether it is homed.
    fn home(&mut self, order: &HomingOrder) -> bool {
        self.kernel.home(Axis::X, order).expect("it can be homed");
        let mut left = 60.0 / PERIOD.value();
        while self.kernel.homing().next().is_some() && left > 0.0 {
            self.tick();
            left -= 1.0;
        }
        self.run(0.05);
        self.kernel.is_homed(Axis::X)
    }

    fn move_to(&mut self, place: f64) {
        let limits = OnlineLimits { speed: 50.0, accel: 2000.0, jerk: 200_000.0 };
        let ends = (f64::NEG_INFINITY, f64::INFINITY);
        let order = ManualOrder { goal: Goal::Position(place), limits, ends, lease: None };
        self.kernel.move_manually(Axis::X, order).expect("it can be moved");
        while self.kernel.is_moving_manually() {
            self.tick();
        }
        self.run(0.02);
    }

    /// How far what the control calls the position is from where the axis is.
    fn off(&self) -> f64 {
        let reading = self.machine.feedback().axes[0].position + self.kernel.zero(Axis::X);
        (reading - self.truth()).value()
    }

    fn truth(&self) -> Coordinate {
        self.machine.truth().expect("it is simulated").axes[0]
    }

    fn alarm(&self) -> (FaultKind, f64, f64) {
        let fault = self.kernel.faults().first().expect("an alarm");
        (fault.kind, fault.value, fault.limit)
    }

    fn deviation(&self) -> Option<Coordinate> {
        let homed = self.events.iter().rev().find_map(|event| match event {
            EventKind::Homed { deviation, .. } => Some(*deviation),
            _ => None,
        });
        homed.expect("it was homed")
    }

    /// Nothing was asked of the axis that its limits forbid. The jerk is told by third differences
    /// of positions: an axis that is within 0.1 nm of its goal is taken there at once, which is 3.2
    /// % of what the jerk allows in three periods.
    fn kept_limits(&self) -> bool {
        let [speed, accel, jerk] = self.most;
        speed < 1.001 && accel < 1.001 && jerk < 1.04
    }
}

#[test]
fn an_axis_that_is_switched_on_anywhere_is_homed_to_a_count_of_its_encoder() {
    for (seed, positive) in (1..=12).map(|seed| (seed, seed % 2 == 0)) {
        let along = if positive { ALONG } else { mirrored(&ALONG) };
        let reference = if positive { 1.0 } else { -1.0 };
        let mut bench = Bench::new(&along, None, seed);
        let stood = bench.truth().value();
        assert!(
            bench.home(&HomingOrder { positive, reference, ..ORDER }),
            "{stood}: {:?}",
            bench.kernel.faults()
        );
        let off = bench.off();
        assert!(off.abs() <= COUNT_MM, "from {stood} mm: {off} mm off");
        assert!(bench.truth().abs() < Coordinate::linear(Length::um(3.0)), "{:?}", bench.truth());
        assert!(bench.deviation().is_none(), "it was not known before");
        assert!(bench.kept_limits(), "{:?}", bench.most);
        assert_eq!(bench.kernel.faults(), []);
    }
}

#[test]
fn two_hundred_homings_find_the_same_place_to_a_count() {
    for seed in 1..=10 {
        let mut bench = Bench::new(&ALONG, None, seed);
        let order = HomingOrder { slow: 40.0, ..ORDER };
        assert!(bench.home(&order));
        for times in 0..20 {
            bench.move_to(-12.0 + f64::from(times) * 0.613 + seed as f64 * 0.0137);
            assert!(bench.home(&order));
            let by = bench.deviation().expect("it was known before").value();
            assert!(by.abs() <= COUNT_MM, "homing {times} of seed {seed}: {by} mm");
        }
    }
}

#[test]
fn an_axis_that_stands_on_its_switch_backs_off_it_first() {
    for start in [-6.9, -3.0, 2.0, 5.9] {
        let mut bench = Bench::new(&ALONG, Some(start), 1);
        assert!(bench.home(&ORDER), "{start}: {:?}", bench.kernel.faults());
        assert!(bench.off().abs() <= COUNT_MM, "{start}: {}", bench.off());
    }
}

#[test]
fn an_axis_beyond_a_short_cam_comes_back_from_the_limit_switch() {
    let cam = HomeSwitch {
        from: Coordinate::new(-20.0),
        to: Coordinate::new(-15.0),
        ..ALONG.home_switch.unwrap()
    };
    let index = Some(IndexMarks { at: Coordinate::new(-12.0), every: Coordinate::new(16.0) });
    let along = Travel { home_switch: Some(cam), index, ..ALONG };
    for start in [-40.0, -17.0, -10.0, 2.0, 4.0] {
        let mut bench = Bench::new(&along, Some(start), 1);
        assert!(
            bench.home(&HomingOrder { reference: -12.0, ..ORDER }),
            "{start}: {:?}",
            bench.kernel.faults()
        );
        assert!(bench.off().abs() <= COUNT_MM, "{start}: {}", bench.off());
    }
}

#[test]
fn off_the_switch_the_mark_inside_the_travel_is_found_and_the_edge_at_which_it_lets_go() {
    // marks at 1, -15, -31; the switch is let go of at -7.05
    for (seed, positive) in (1..=8).map(|seed| (seed, seed % 2 == 0)) {
        let (along, sense) = if positive { (ALONG, 1.0) } else { (mirrored(&ALONG), -1.0) };
        let order = HomingOrder { positive, off_switch: true, reference: -15.0 * sense, ..ORDER };
        let mut bench = Bench::new(&along, None, seed);
        assert!(bench.home(&order), "{:?}", bench.kernel.faults());
        assert!(bench.off().abs() <= COUNT_MM, "{} mm", bench.off());
        assert!((bench.truth().value() + 16.0 * sense).abs() < 3e-3, "{:?}", bench.truth());
        bench.move_to(-40.0 * sense);
        assert!(bench.home(&order));
        assert!(bench.deviation().expect("it was known before").abs().value() <= COUNT_MM);
        assert!(bench.kept_limits(), "{:?}", bench.most);
        let edge = HomingOrder { method: HomingMethod::Switch, reference: -7.05 * sense, ..order };
        assert!(bench.home(&edge));
        let a_period = ORDER.slow * PERIOD.value();
        assert!(bench.off().abs() <= a_period + COUNT_MM, "{} mm", bench.off());
    }
    let order = HomingOrder { off_switch: true, reference: -15.0, ..ORDER };
    for start in [-6.9, 2.0, 5.9] {
        let mut bench = Bench::new(&ALONG, Some(start), 1);
        assert!(bench.home(&order), "{start}: {:?}", bench.kernel.faults());
        assert!(bench.off().abs() <= COUNT_MM, "{start}: {}", bench.off());
    }
}

#[test]
fn without_a_mark_the_edge_of_the_switch_is_the_reference_to_what_the_axis_moves_in_a_period() {
    let order = HomingOrder { method: HomingMethod::Switch, reference: -7.0, ..ORDER };
    let mut bench = Bench::new(&ALONG, None, 3);
    assert!(bench.home(&order));
    let a_period = ORDER.slow * PERIOD.value();
    assert!(bench.off().abs() <= a_period + COUNT_MM, "{} mm", bench.off());
}

#[test]
fn the_next_mark_alone_is_enough_where_only_one_is_on_the_way() {
    let order = HomingOrder { method: HomingMethod::Index, ..ORDER };
    let mut bench = Bench::new(&ALONG, Some(-9.0), 3);
    assert!(bench.home(&order));
    assert!(bench.off().abs() <= COUNT_MM, "{} mm", bench.off());
}

#[test]
fn a_hard_stop_is_found_with_no_more_than_the_allowed_force() {
    let order = HomingOrder {
        method: HomingMethod::HardStop,
        slow: 5.0,
        reference: 6.0,
        pull_off: 6.0,
        ..ORDER
    };
    for seed in [4, 5] {
        let mut bench = Bench::new(&ALONG, None, seed);
        bench.force = 0.0;
        assert!(bench.home(&order), "{:?}", bench.kernel.faults());
        let allowed = 0.1 * 60.0 * std::f64::consts::TAU / 16e-3;
        assert!(bench.force <= allowed * 1.001, "{} N of {allowed}", bench.force);
        // the stop gives way by the force over its stiffness; what runs into it with v·√(k·m) comes
        // on top: m = 1279 kg
        let gives = (allowed + 0.005 * (8e7_f64 * 1279.0).sqrt()) / 8e4;
        assert!(bench.farthest < 66.0_f64.max(6.0 + gives), "{}", bench.farthest);
        assert!(bench.off().abs() < allowed / 8e4 + 0.002, "{} mm", bench.off());
        assert!(bench.truth().abs() < Coordinate::new(0.05), "{:?}", bench.truth());
        bench.move_to(-20.0);
        assert!(bench.home(&order));
        let by = bench.deviation().expect("it was known before").of_linear().in_um();
        assert!(by.abs() < 5.0, "{by} µm");
    }
}

#[test]
fn an_encoder_that_knows_and_an_operator_who_says_move_nothing() {
    let mut bench = Bench::new(&ALONG, Some(-30.0), 1);
    let absolute = HomingOrder { method: HomingMethod::Absolute, reference: 2.5, ..ORDER };
    bench.kernel.home(Axis::X, &absolute).unwrap();
    bench.run(0.1);
    let at = |bench: &Bench| bench.kernel.tool_side(Axis::X).unwrap().value();
    assert!(bench.kernel.is_homed(Axis::X) && (at(&bench) + 27.5).abs() < 1e-3, "{}", at(&bench));
    let given = HomingOrder { method: HomingMethod::Given, reference: 11.0, ..ORDER };
    bench.kernel.home(Axis::X, &given).unwrap();
    bench.run(0.1);
    assert!((at(&bench) - 11.0).abs() < 1e-3, "{}", at(&bench));
    assert!(
        (bench.truth() + Coordinate::new(30.0)).abs() < Coordinate::linear(Length::um(1.0)),
        "{:?}",
        bench.truth()
    );
    assert!(bench.most[0] == 0.0, "the setpoint did not move: {:?}", bench.most);
}

#[test]
fn a_switch_that_is_not_there_is_an_alarm_after_the_whole_way() {
    // no limit switch either: the search is bounded by its distance
    let along = Travel { home_switch: None, limit_switches: None, stops: None, ..ALONG };
    let mut bench = Bench::new(&along, Some(-30.0), 1);
    assert!(!bench.home(&ORDER));
    let (kind, value, limit) = bench.alarm();
    assert_eq!((kind, limit), (FaultKind::HomeSwitchNotFound, 74.0));
    assert!((value - 74.0).abs() < 0.1, "{value}");
    // with limit switches the axis comes back from one to the other
    let along = Travel { home_switch: None, ..ALONG };
    let mut bench = Bench::new(&along, Some(-30.0), 1);
    assert!(!bench.home(&ORDER));
    assert_eq!(bench.alarm().0, FaultKind::HomeSwitchNotFound);
    assert!(bench.farthest < 66.0, "{}", bench.farthest);
}

#[test]
fn a_switch_that_is_connected_the_wrong_way_round_is_an_alarm() {
    let along = Travel { home_switch: None, ..ALONG };
    let mut bench = Bench::wired(&along, Some(-30.0), 1, |said| said.axes[0].home_switch = true);
    assert!(!bench.home(&ORDER));
    assert_eq!(bench.alarm().0, FaultKind::HomeSwitchNotReleased);
}

#[test]
fn a_mark_that_does_not_come_and_one_at_the_switchs_edge_are_alarms() {
    let mut bench = Bench::wired(&ALONG, Some(-30.0), 1, |said| said.axes[0].index = None);
    assert!(!bench.home(&ORDER));
    // the limit switch comes 10 mm behind the edge, before 1.2 times 16 mm have been searched
    assert_eq!(bench.alarm().0, FaultKind::IndexNotFound);
    for at in [-6.5, 8.5] {
        let index = Some(IndexMarks { at: Coordinate::new(at), every: Coordinate::new(16.0) });
        let along = Travel { index, limit_switches: None, ..ALONG };
        let along = Travel { stops: None, ..along };
        let mut bench = Bench::new(&along, Some(-30.0), 1);
        assert!(!bench.home(&ORDER), "{at}");
        let (kind, apart, _) = bench.alarm();
        assert_eq!(kind, FaultKind::IndexAtSwitch, "{at}");
        assert!((apart - 0.5).abs() < 0.01, "{apart}");
    }
}

#[test]
fn an_encoder_that_counts_the_wrong_way_is_found_within_millimetres() {
    fn backwards(said: &mut Feedback) {
        let axis = &mut said.axes[0];
        axis.position = -axis.position;
        axis.motor = axis.motor.map(|motor| -motor);
        axis.index = axis.index.map(|at| -at);
    }
    for seed in 1..=8 {
        let mut bench = Bench::wired(&ALONG, None, seed, backwards);
        let from = bench.truth();
        assert!(!bench.home(&ORDER));
        assert_eq!(bench.alarm().0, FaultKind::MovesAgainstOrder);
        assert_eq!(FaultKind::MovesAgainstOrder.reaction(), Reaction::Disable);
        bench.run(1.0);
        let way = (bench.truth() - from).abs().value();
        assert!(way < 6.0, "it ran {way} mm");
    }
    // and in a jog before homing as well
    let mut bench = Bench::wired(&ALONG, Some(-30.0), 1, backwards);
    let limits = OnlineLimits { speed: 50.0, accel: 2000.0, jerk: 200_000.0 };
    let order = ManualOrder { goal: Goal::Speed(20.0), limits, ends: (-1e9, 1e9), lease: None };
    bench.kernel.move_manually(Axis::X, order).unwrap();
    bench.run(1.0);
    assert_eq!(bench.alarm().0, FaultKind::MovesAgainstOrder);
    assert!(
        (bench.truth() + Coordinate::new(30.0)).abs() < Coordinate::new(6.0),
        "{:?}",
        bench.truth()
    );
}

#[test]
fn limit_switches_that_are_exchanged_are_an_alarm() {
    let cam = HomeSwitch { from: Coordinate::new(4.0), ..ALONG.home_switch.unwrap() };
    let along = Travel { home_switch: Some(cam), ..ALONG };
    let mut bench =
        Bench::wired(&along, Some(-20.0), 1, |said| said.axes[0].limit_switches.reverse());
    assert!(!bench.home(&ORDER));
    assert_eq!(bench.alarm().0, FaultKind::WrongLimitSwitch);
    assert!(bench.farthest < 60.0, "{}", bench.farthest);
}

#[test]
fn a_hold_stops_homing_and_the_axis_is_not_homed() {
    let mut bench = Bench::new(&ALONG, Some(-50.0), 1);
    bench.kernel.home(Axis::X, &ORDER).unwrap();
    bench.run(0.3);
    assert_eq!(bench.kernel.report().state, State::Manual);
    bench.kernel.order(Order::FeedHold);
    bench.run(0.3);
    assert!(bench.kernel.homing().next().is_none() && !bench.kernel.is_homed(Axis::X));
    assert!(bench.events.contains(&EventKind::HomingStopped { axis: Axis::X }));
    assert!(bench.kernel.is_standing() && bench.kept_limits(), "{:?}", bench.most);
}

#[test]
fn a_program_moves_no_axis_that_is_not_homed() {
    let mut bench = Bench::new(&ALONG, Some(-30.0), 1);
    let from = Position::xyz(-30.0, 0.0, 0.0);
    let kind = line(from, Position::xyz(-20.0, 0.0, 0.0), 50.0, true);
    bench.kernel.push(&Step { op: 0, line: 1, kind }).unwrap();
    bench.run(0.1);
    assert_eq!(bench.alarm().0, FaultKind::NotHomed);
    assert!(
        (bench.truth() + Coordinate::new(30.0)).abs() < Coordinate::linear(Length::um(5.0)),
        "{:?}",
        bench.truth()
    );
}

#[test]
fn what_cannot_be_homed_is_refused() {
    let mut bench = Bench::new(&ALONG, Some(-30.0), 1);
    assert_eq!(bench.kernel.home(Axis::B, &ORDER), Err(ManualRefusal::NoAxis));
    for unsound in [
        HomingOrder { fast: f64::NAN, ..ORDER },
        HomingOrder { slow: 60.0, ..ORDER },
        HomingOrder { search: 0.0, ..ORDER },
        HomingOrder { index_spacing: 0.0, ..ORDER },
        HomingOrder { reference: f64::INFINITY, ..ORDER },
        HomingOrder { method: HomingMethod::HardStop, force_share: 0.0, ..ORDER },
    ] {
        let refused = bench.kernel.home(Axis::X, &unsound);
        assert_eq!(refused, Err(ManualRefusal::NotANumber), "{unsound:?}");
    }
    bench.kernel.home(Axis::X, &ORDER).unwrap();
    assert_eq!(bench.kernel.home(Axis::X, &ORDER), Err(ManualRefusal::Busy));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(size::of(24, 480)))]
    #[test]
    fn wherever_it_stands_and_its_switch_is_an_axis_is_homed_within_its_limits(
        start in -65.0..5.0_f64,
        edge in -40.0..-2.0_f64,
        behind in 1.0..15.0_f64,
        hysteresis in 0.0..0.4_f64,
        fast in 5.0..50.0_f64,
        share in 0.1..1.0_f64,
        positive: bool,
    ) {
        let sense = if positive { 1.0 } else { -1.0 };
        let cam = HomeSwitch {
            from: Coordinate::new(edge),
            hysteresis: Coordinate::new(hysteresis),
            ..ALONG.home_switch.unwrap()
        };
        let index = Some(IndexMarks { at: Coordinate::new(edge + behind), every: Coordinate::new(16.0) });
        // the mark lies before the limit switch
        let room = (edge + behind + 3.0).max(3.0);
        let stops = Some((Coordinate::new(-66.0), Coordinate::new(room + 3.0), STIFFNESS));
        let limit_switches = Some((Coordinate::new(-63.0), Coordinate::new(room)));
        let along = Travel { home_switch: Some(cam), index, stops, limit_switches, ..ALONG };
        let along = if positive { along } else { mirrored(&along) };
        let order = HomingOrder {
            fast,
            slow: (fast * share).max(5.0),
            positive,
            reference: sense * (edge + behind),
            search: 90.0,
            ..ORDER
        };
        let mut bench = Bench::new(&along, Some(sense * start), 1);
        prop_assert!(bench.home(&order), "{:?}", bench.kernel.faults());
        prop_assert!(bench.off().abs() <= COUNT_MM, "{} mm", bench.off());
        prop_assert!(bench.kept_limits(), "{:?}", bench.most);
        prop_assert!(bench.farthest < 66.0_f64.max(room + 3.0) + 1e-3, "{} mm", bench.farthest);
    }
}
