//! Doors that hold the feed and a spindle: what is coupled stays on its coupling, and what was held
//! goes on by itself.
use crate::common::*;
use bus::{Machine, Panel, Sample, State};
use canon::Position;
use kernel::{EventKind, Kernel, ManualOrder, ManualRefusal, Notice, Order};
use motion::{Goal, OnlineLimits};
use plan::StepKind;
use sim::SimulatedMachine;
use sync::recovery::Point;
use test_support::size;
use units::{Angle, Spin, Time};

/// A machine with doors, its control, and what has been seen.
struct Bench {
    machine: SimulatedMachine,
    kernel: Kernel,
    doors: Panel,
    samples: Vec<Sample>,
    events: Vec<EventKind>,
    /// Largest distance from the coupling in the material, µm.
    off_um: f64,
    deepest_mm: f64,
}

const FEED: Panel = Panel { feed_inhibit: true, ..CLOSED };
const SPINDLE: Panel = Panel { spindle_inhibit: [true, false], ..CLOSED };
const BOTH: Panel = Panel { feed_inhibit: true, ..SPINDLE };
const CLOSED: Panel = Panel::NONE;

impl Bench {
    fn new(steps: Vec<StepKind>) -> Self {
        let model = machine(0);
        let mut kernel = Kernel::new(control(&model));
        for (line, kind) in steps.into_iter().enumerate() {
            kernel.push(&plan::Step { op: 0, line: line as u32 + 1, kind }).unwrap();
        }
        Self {
            machine: SimulatedMachine::new(model).unwrap(),
            kernel,
            doors: CLOSED,
            samples: Vec::new(),
            events: Vec::new(),
            off_um: 0.0,
            deepest_mm: 0.0,
        }
    }

    fn tick(&mut self) {
        let feedback = bus::Feedback { panel: self.doors, ..*self.machine.feedback() };
        let command = self.kernel.tick(&feedback);
        let (report, truth) = (self.kernel.report(), self.machine.truth().copied());
        if let (Some(stored), Some(truth)) = (self.kernel.engaged(), truth) {
            let place = truth.axes[2].of_linear();
            if place.value() < M6.surface_mm {
                let at = Point { angle: truth.spindles[0], place };
                self.off_um = self.off_um.max(stored.error(at).in_um().abs());
            }
            self.deepest_mm = self.deepest_mm.min(place.value());
        }
        self.samples.push(Sample { feedback, command, report, truth });
        while let Some(event) = self.kernel.next_event() {
            self.events.push(event.kind);
        }
        self.machine.exchange(&command);
    }

    fn pass(&mut self, seconds: f64) {
        for _ in 0..(seconds / 250e-6) as usize {
            self.tick();
        }
    }

    /// Go on until something is so, ten seconds at most.
    #[track_caller]
    fn until(&mut self, what: impl Fn(&Self) -> bool) {
        for _ in 0..40_000 {
            if what(self) {
                return;
            }
            self.tick();
        }
        panic!("it never came: {:?}, {:?}", self.kernel.report(), self.events)
    }

    fn said(&self, notice: Notice) -> bool {
        self.events.contains(&EventKind::Operator(notice))
    }

    /// Speed of X as it is told, mm/s, and of the spindle as it turns, rpm.
    fn speeds(&self) -> (f64, f64) {
        let last = self.samples.last().unwrap();
        let spin = last.truth.unwrap().spins[0].in_rpm();
        (last.command.axes[0].speed.value(), spin)
    }

    fn has_ended(&self) -> bool {
        self.kernel.report().state == State::Ended
    }
}

/// A number from 0 to 1 that a case and a place in it always have.
fn drawn(case: usize, place: u64) -> f64 {
    let mut x = (case as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ place << 32;
    x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ x >> 31) >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn a_door_that_is_opened_at_any_instant_keeps_every_tap_on_its_helix() {
    let start = Position::xyz(0.0, 0.0, M6.from_mm);
    // slowly: the bench has no limit of acceleration, and a hold stops a move at once
    let approach = line(Position::default(), start, 50.0, true);
    let steps = || vec![approach.clone(), StepKind::Tap(M6.plan()), StepKind::End];
    let mut whole = Bench::new(steps());
    whole.until(|b| b.kernel.engaged().is_some());
    let began = whole.samples.len();
    whole.until(Bench::has_ended);
    let lasts_s = (whole.samples.len() - began) as f64 * 250e-6;
    for case in 0..size::of(9, 200) {
        let mut bench = Bench::new(steps());
        bench.until(|b| b.samples.len() + 200 > began);
        for opening in 0..2 {
            bench.pass(drawn(case, 3 * opening) * lasts_s * 0.7);
            bench.doors = [FEED, SPINDLE, BOTH][case % 3];
            bench.pass(0.02 + drawn(case, 3 * opening + 1) * 0.8);
            bench.doors = CLOSED;
        }
        bench.until(Bench::has_ended);
        assert_eq!(bench.kernel.faults(), [], "case {case}");
        assert!(bench.off_um < 10.0, "case {case}: {} µm off its helix", bench.off_um);
        let deep = bench.deepest_mm;
        assert!((deep - M6.to_mm).abs() < 0.005, "case {case}: {deep} mm");
        assert!(!bench.samples.last().unwrap().truth.unwrap().tool_broken, "case {case}");
    }
}

#[test]
fn in_the_thread_a_door_stops_spindle_and_feed_together_until_it_is_closed() {
    for doors in [FEED, SPINDLE] {
        let mut bench = Bench::new(tapping(&M6));
        bench.until(|b| b.deepest_mm < M6.surface_mm - 6.0);
        bench.doors = doors;
        bench.until(|b| b.said(Notice::InhibitedInThread));
        bench.pass(0.1);
        let stands = bench.deepest_mm;
        assert!(bench.speeds().1.abs() < 1.0 && stands > M6.to_mm + 1.0);
        assert_eq!(bench.kernel.report().state, State::Held);
        let waits = bench.kernel.waiting().unwrap();
        assert!(waits.what.to_string().contains("no longer inhibited") && waits.limit.is_none());
        // nobody makes it go on while the door is open
        bench.kernel.order(Order::Resume);
        bench.pass(0.2);
        assert!((bench.deepest_mm - stands).abs() < 0.005);
        // the tool comes out on the operator's word
        if doors == FEED {
            bench.kernel.order(Order::Retract);
            bench.until(|b| b.said(Notice::Out));
            assert!(bench.off_um < 10.0, "{}", bench.off_um);
        }
    }
}

/// X goes 60 mm at 50 mm/s with the spindle at 1000 rpm.
fn cut() -> Bench {
    let to = Position::xyz(60.0, 0.0, 0.0);
    let move_ = line(Position::default(), to, 50.0, true);
    let mut bench = Bench::new(vec![turn(0.0, 1000.0), await_speed(), move_, StepKind::End]);
    bench.until(|b| !b.samples.is_empty() && b.speeds().0 > 45.0);
    bench
}

#[test]
fn a_feed_that_is_inhibited_rests_with_the_spindle_turning_and_goes_on_by_itself() {
    let mut bench = cut();
    bench.doors = FEED;
    bench.until(|b| b.said(Notice::Inhibited));
    bench.pass(0.3);
    let (feed, spin) = bench.speeds();
    assert!(feed == 0.0 && (spin - 1000.0).abs() < 20.0, "{feed} mm/s, {spin} rpm");
    bench.doors = CLOSED;
    bench.until(Bench::has_ended);
    assert_eq!(bench.kernel.faults(), []);
}

#[test]
fn a_spindle_stops_after_the_axes_and_has_its_speed_again_before_they_go_on() {
    let mut bench = cut();
    bench.doors = SPINDLE;
    bench.until(|b| b.speeds().1.abs() < 1.0);
    let fed = |s: &&Sample| s.command.axes[0].speed.value() != 0.0;
    let slowest_with_feed = |samples: &[Sample]| {
        let spins = samples.iter().filter(fed).map(|s| s.truth.unwrap().spins[0].in_rpm());
        spins.fold(f64::MAX, f64::min)
    };
    let first = bench.samples.iter().position(|s| fed(&s)).unwrap();
    assert!(slowest_with_feed(&bench.samples[first..]) > 950.0);
    bench.pass(0.5);
    let since = bench.samples.len();
    bench.doors = CLOSED;
    bench.until(Bench::has_ended);
    assert!(slowest_with_feed(&bench.samples[since..]) > 950.0);
    assert_eq!(bench.kernel.faults(), []);
}

#[test]
fn the_operators_hold_outlasts_the_door() {
    let mut bench = cut();
    bench.doors = FEED;
    bench.pass(0.2);
    bench.kernel.order(Order::FeedHold);
    bench.doors = CLOSED;
    bench.pass(0.3);
    assert_eq!((bench.kernel.report().state, bench.speeds().0), (State::Held, 0.0));
    bench.kernel.order(Order::Resume);
    bench.until(Bench::has_ended);
}

#[test]
fn by_hand_nothing_begins_and_what_moves_comes_to_rest() {
    let mut bench = Bench::new(Vec::new());
    bench.until(|b| b.kernel.is_ready());
    let jog = ManualOrder {
        goal: Goal::Speed(20.0),
        limits: OnlineLimits { speed: 50.0, accel: 500.0, jerk: 1e4 },
        ends: (f64::NEG_INFINITY, f64::INFINITY),
        lease: Some(Time::s(100.0)),
    };
    bench.kernel.move_manually(units::Axis::X, jog).unwrap();
    bench.kernel.turn_manually(0, Spin::rpm(300.0), Time::s(100.0)).unwrap();
    bench.pass(0.5);
    bench.doors = FEED;
    bench.pass(0.5);
    let (feed, spin) = bench.speeds();
    assert!(feed == 0.0 && (spin - 300.0).abs() < 10.0, "{feed} mm/s, {spin} rpm");
    let again = bench.kernel.move_manually(units::Axis::X, jog);
    assert_eq!(again, Err(ManualRefusal::Inhibited));
    bench.doors = SPINDLE;
    bench.pass(1.0);
    assert!(bench.speeds().1.abs() < 1.0);
    assert_eq!(
        bench.kernel.turn_manually(0, Spin::rpm(300.0), Time::s(100.0)),
        Err(ManualRefusal::Inhibited)
    );
    assert_eq!(bench.kernel.orient_manually(0, Angle::ZERO), Err(ManualRefusal::Inhibited));
    bench.kernel.turn_manually(0, Spin::ZERO, Time::s(100.0)).unwrap();
    bench.kernel.move_manually(units::Axis::X, jog).unwrap();
    bench.pass(0.3);
    assert!(bench.speeds().0 > 10.0, "a spindle's door does not hold the axes of a hand");
    assert_eq!(bench.kernel.report().state, State::Manual);
}
