//! Axes moved by hand: a lease that ends, ends of travel, drives off and on; seen on a simulated
//! machine.
use crate::common::*;
use bus::{Machine, State};
use canon::{Axis, Position};
use kernel::{Kernel, ManualOrder, ManualRefusal};
use motion::{Goal, OnlineLimits, Step, StepKind};
use sim::SimulatedMachine;
use units::{Angle, Spin, Time};

const LIMITS: OnlineLimits = OnlineLimits { speed: 100.0, accel: 2000.0, jerk: 50_000.0 };
/// With these limits 100 mm/s are gone after v/a + a/j = 90 ms, 45 periods of jerk among them: 4.5
/// mm.
const BRAKING_MM: f64 = 4.6;

struct Bench {
    machine: SimulatedMachine,
    kernel: Kernel,
}

impl Bench {
    fn new() -> Self {
        let config = machine(1);
        let kernel = Kernel::new(control(&config));
        let machine = SimulatedMachine::new(config).expect("the test's machine can be built");
        let mut bench = Self { machine, kernel };
        bench.run(0.1);
        assert!(bench.kernel.is_ready());
        bench
    }

    fn run(&mut self, seconds: f64) {
        let end = self.now() + Time::s(seconds);
        while self.now() < end {
            let command = self.kernel.tick(self.machine.feedback());
            self.machine.exchange(&command);
        }
    }

    fn now(&self) -> Time {
        self.machine.feedback().time
    }

    fn x(&self) -> f64 {
        self.machine.feedback().axes[0].position.value()
    }

    fn order(&self, goal: Goal, ends: (f64, f64), lease_s: Option<f64>) -> ManualOrder {
        let lease = lease_s.map(|lasts| self.now() + Time::s(lasts));
        ManualOrder { goal, limits: LIMITS, ends, lease }
    }
}

#[test]
fn an_axis_stops_within_its_braking_distance_when_its_lease_is_over() {
    let mut bench = Bench::new();
    let order = bench.order(Goal::Speed(100.0), (-500.0, 500.0), Some(0.5));
    bench.kernel.move_manually(Axis::X, order).unwrap();
    bench.run(0.5);
    assert_eq!(bench.kernel.report().state, State::Manual);
    let at_end = bench.x();
    bench.run(1.0);
    assert!(!bench.kernel.is_moving_manually());
    let further = bench.x() - at_end;
    assert!((0.5..BRAKING_MM).contains(&further), "{further} mm");
    assert_eq!(bench.kernel.faults(), []);
}

#[test]
fn an_axis_stops_at_the_end_of_its_travel() {
    let mut bench = Bench::new();
    let order = bench.order(Goal::Speed(100.0), (-500.0, 30.0), Some(5.0));
    bench.kernel.move_manually(Axis::X, order).unwrap();
    bench.run(2.0);
    let x = bench.x();
    assert!((x - 30.0).abs() < 0.005, "{x} mm");
    assert_eq!(bench.kernel.faults(), []);
}

#[test]
fn a_position_is_reached_and_can_be_changed_on_the_way() {
    let mut bench = Bench::new();
    for (goal, seconds) in [(40.0, 0.2), (-10.0, 2.0)] {
        let order = bench.order(Goal::Position(goal), (-500.0, 500.0), None);
        bench.kernel.move_manually(Axis::X, order).unwrap();
        bench.run(seconds);
    }
    let x = bench.x();
    assert!((x + 10.0).abs() < 0.005 && !bench.kernel.is_moving_manually(), "{x} mm");
}

#[test]
fn steps_wait_until_axes_that_are_moved_by_hand_stand_and_none_is_moved_while_steps_wait() {
    let mut bench = Bench::new();
    let order = bench.order(Goal::Position(10.0), (-500.0, 500.0), None);
    bench.kernel.move_manually(Axis::X, order).unwrap();
    let from = Position::xyz(10.0, 0.0, 0.0);
    let step = |kind| Step { op: 0, line: 1, kind };
    bench.kernel.push(&step(line(from, Position::xyz(20.0, 0.0, 0.0), 50.0, true))).unwrap();
    bench.kernel.push(&step(StepKind::End)).unwrap();
    assert_eq!(bench.kernel.move_manually(Axis::X, order), Err(ManualRefusal::Busy));
    bench.run(3.0);
    assert_eq!(bench.kernel.report().state, State::Ended);
    assert_eq!(bench.kernel.faults(), []);
    let x = bench.x();
    assert!((x - 20.0).abs() < 0.005, "{x} mm");
    // the program is over: another motion by hand, once it is cleared
    assert!(bench.kernel.clear());
    let order = bench.order(Goal::Position(5.0), (-500.0, 500.0), None);
    bench.kernel.move_manually(Axis::X, order).unwrap();
}

#[test]
fn with_the_drives_off_nothing_is_moved_and_they_come_up_where_the_axis_stands() {
    let mut bench = Bench::new();
    let order = bench.order(Goal::Position(10.0), (-500.0, 500.0), None);
    bench.kernel.move_manually(Axis::X, order).unwrap();
    assert!(!bench.kernel.switch_off(), "an axis moves");
    bench.run(1.0);
    assert!(bench.kernel.switch_off());
    let order = bench.order(Goal::Position(0.0), (-500.0, 500.0), None);
    assert_eq!(bench.kernel.move_manually(Axis::X, order), Err(ManualRefusal::NotReady));
    bench.run(0.1);
    assert_eq!(bench.kernel.report().state, State::Idle);
    bench.kernel.switch_on();
    bench.run(0.2);
    assert!(bench.kernel.is_ready());
    let x = bench.x();
    assert!((x - 10.0).abs() < 0.01, "{x} mm");
}

#[test]
fn what_no_axis_can_obey_is_refused() {
    let mut bench = Bench::new();
    let sound = bench.order(Goal::Speed(10.0), (-500.0, 500.0), Some(1.0));
    assert_eq!(bench.kernel.move_manually(Axis::B, sound), Err(ManualRefusal::NoAxis));
    for unsound in [
        ManualOrder { goal: Goal::Speed(f64::NAN), ..sound },
        ManualOrder { goal: Goal::Position(f64::INFINITY), ..sound },
        ManualOrder { limits: OnlineLimits { accel: 0.0, ..LIMITS }, ..sound },
        ManualOrder { ends: (1.0, -1.0), ..sound },
    ] {
        let refused = bench.kernel.move_manually(Axis::X, unsound);
        assert_eq!(refused, Err(ManualRefusal::NotANumber), "{unsound:?}");
    }
}

#[test]
fn a_spindle_turns_by_hand_until_its_lease_is_over_and_is_oriented() {
    let mut bench = Bench::new();
    let spin = |bench: &Bench| bench.machine.truth().expect("simulated").spins[0];
    let until = bench.now() + Time::s(2.0);
    bench.kernel.turn_manually(0, Spin::rpm(300.0), until).unwrap();
    bench.run(1.8);
    assert!((spin(&bench) - Spin::rpm(300.0)).abs() < Spin::rpm(3.0), "{}", spin(&bench));
    assert!(bench.kernel.is_moving_manually());
    bench.run(2.0);
    assert!(spin(&bench).abs() < Spin::rpm(0.5) && bench.kernel.is_standing());
    bench.kernel.orient_manually(0, Angle::deg(90.0)).unwrap();
    bench.run(2.0);
    let turns = bench.machine.feedback().spindles[0].angle.value();
    assert!((turns - turns.floor() - 0.25).abs() < 1e-3, "{turns} rev");
    let soon = bench.now() + Time::s(1.0);
    let refused = bench.kernel.turn_manually(0, Spin::rpm(1e6), soon);
    assert_eq!(refused, Err(ManualRefusal::NotANumber));
    assert_eq!(bench.kernel.turn_manually(1, Spin::rpm(10.0), soon), Err(ManualRefusal::NoAxis));
    assert_eq!(bench.kernel.faults(), []);
}

#[test]
fn a_control_that_is_off_leaves_the_tool_in_the_spindle_that_it_finds_there() {
    let mut config = machine(1);
    let (tool, length, kind) = (7, units::Length::mm(120.0), sim::ToolKind::Other);
    config.magazine.push(sim::Tool { number: tool, length, kind });
    config.tool = tool;
    let mut kernel = Kernel::new(control(&config));
    let machine = SimulatedMachine::new(config).expect("the test's machine can be built");
    assert!(kernel.switch_off());
    let mut bench = Bench { machine, kernel };
    bench.run(0.1);
    assert_eq!(bench.machine.feedback().tool, Some(tool));
}
