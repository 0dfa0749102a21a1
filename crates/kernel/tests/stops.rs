//! Stops in the middle of a tap with the drives alive, what may follow them, and the way out after
//! a stop without.
use crate::common::*;
use bus::{Command, Machine, Sample, State};
use kernel::{EventKind, Kernel, Notice, Order, RecoveryPlan};
use sim::SimulatedMachine;
use sync::recovery::{Direction, Mover, Point, Stored, Way};
use units::{Accel, Angle, Coordinate, Length, Speed, Spin, SpinAccel, Time};

/// A machine, its control, and what has been seen.
struct Bench {
    machine: SimulatedMachine,
    kernel: Kernel,
    samples: Vec<Sample>,
    events: Vec<EventKind>,
}

impl Bench {
    fn new(order: &TapOrder) -> Self {
        let model = machine(0);
        let mut kernel = Kernel::new(control(&model));
        for (line, kind) in tapping(order).into_iter().enumerate() {
            kernel.push(&plan::Step { op: 0, line: line as u32 + 1, kind }).unwrap();
        }
        let machine = SimulatedMachine::new(model).unwrap();
        Self { machine, kernel, samples: Vec::new(), events: Vec::new() }
    }

    fn tick(&mut self) {
        let feedback = *self.machine.feedback();
        let command = self.kernel.tick(&feedback);
        let (report, truth) = (self.kernel.report(), self.machine.truth().copied());
        self.samples.push(Sample { feedback, command, report, truth });
        while let Some(event) = self.kernel.next_event() {
            self.events.push(event.kind);
        }
        self.machine.exchange(&command);
    }

    /// Go on until something is so, ten seconds at most.
    #[track_caller]
    fn until(&mut self, what: impl Fn(&Self) -> bool) -> &mut Self {
        for _ in 0..40_000 {
            if what(self) {
                return self;
            }
            self.tick();
        }
        panic!("it never came: {:?}, {:?}", self.kernel.report(), self.events)
    }

    fn last(&self) -> &Sample {
        self.samples.last().unwrap()
    }

    fn said(&self, notice: Notice) -> bool {
        self.events.contains(&EventKind::Operator(notice))
    }

    fn z(&self) -> f64 {
        self.last().axis(2).value()
    }

    /// Largest distance from the helix since a sample, µm.
    fn off_um(&self, since: usize, theta0: f64, order: &TapOrder) -> f64 {
        let sense = if order.left { -1.0 } else { 1.0 };
        let off = |s: &Sample| {
            let turned = (s.spindle(0).value() - theta0) * sense;
            (s.axis(2).value() - order.from_mm + order.lead_mm * turned) * 1e3
        };
        self.samples[since..].iter().map(off).fold(0.0, |most, e| f64::max(most, e.abs()))
    }
}

fn turns(bench: &Bench) -> f64 {
    bench.last().spindle(0).value()
}

/// Run into the tap until the axis is at a height over the surface, going in or out; the angle at
/// which it started.
fn at_depth(order: &TapOrder, z: f64, state: State) -> (Bench, f64) {
    let mut bench = Bench::new(order);
    bench.until(|b| b.events.contains(&EventKind::TapStarted));
    // the angle that was held before it went in
    let theta0 = bench.samples[bench.samples.len() - 2].command.spindles[0].angle.value();
    bench.until(|b| {
        let z = order.surface_mm + z;
        let there = if state == State::TapIn { b.z() < z } else { b.z() > z };
        b.kernel.report().state == state && there
    });
    (bench, theta0)
}

const EVERYWHERE: [(f64, State); 7] = [
    (1.9, State::TapIn),
    (-0.5, State::TapIn),
    (-5.0, State::TapIn),
    (-20.0, State::TapIn),
    (-27.9, State::TapIn),
    (-15.0, State::TapOut),
    (0.5, State::TapOut),
];

#[test]
fn a_hold_stops_spindle_and_feed_together_on_the_helix_wherever_it_comes() {
    for left in [false, true] {
        let order = TapOrder { left, ..M6 };
        for (z, state) in EVERYWHERE {
            let (mut bench, theta0) = at_depth(&order, z, state);
            let since = bench.samples.len();
            bench.kernel.order(Order::FeedHold);
            bench.until(|b| b.kernel.report().state == State::Held || b.kernel.is_over());
            for _ in 0..400 {
                bench.tick();
            }
            let off = bench.off_um(since, theta0, &order);
            assert!(off < 10.0, "{z} mm, {state:?}, left {left}: {off} µm");
            let deepest = bench.samples.iter().map(|s| s.axis(2).value()).fold(f64::MAX, f64::min);
            assert!(deepest > order.to_mm - 0.005, "{z} mm: {deepest} mm");
            let spin = bench.last().truth.unwrap().spins[0].in_rpm();
            assert!(spin.abs() < 1.0, "{z} mm: {spin} rpm");
        }
    }
}

#[test]
fn after_a_hold_the_tap_goes_on_along_its_helix_and_ends_as_if_nothing_had_been() {
    for (z, state) in [(-5.0, State::TapIn), (-25.0, State::TapOut)] {
        let (mut bench, theta0) = at_depth(&M6, z, state);
        let since = bench.samples.len();
        bench.kernel.order(Order::FeedHold);
        bench.until(|b| b.said(Notice::HeldInThread));
        bench.kernel.order(Order::Resume);
        bench.until(|b| b.events.iter().any(|e| matches!(e, EventKind::TapEnded(_))));
        let deepest = bench.samples.iter().map(|s| s.axis(2).value()).fold(f64::MAX, f64::min);
        assert!((deepest - M6.to_mm).abs() < 0.005, "{deepest} mm");
        assert!((bench.z() - M6.from_mm).abs() < 0.005, "{} mm", bench.z());
        let off = bench.off_um(since, theta0, &M6);
        assert!(off < 10.0, "{z} mm: {off} µm");
    }
}

#[test]
fn a_held_tap_backs_out_when_told_and_may_begin_again() {
    let (mut bench, theta0) = at_depth(&M6, -9.0, State::TapIn);
    let since = bench.samples.len();
    bench.kernel.order(Order::FeedHold);
    bench.until(|b| b.said(Notice::HeldInThread));
    assert_eq!(bench.kernel.report().state, State::Held);
    bench.kernel.order(Order::Retract);
    bench.until(|b| b.said(Notice::Out) && b.kernel.is_standing());
    assert!((bench.z() - M6.from_mm).abs() < 0.005, "{} mm", bench.z());
    bench.kernel.order(Order::Resume);
    bench.until(|b| b.events.iter().any(|e| matches!(e, EventKind::TapEnded(_))));
    let deepest = bench.samples.iter().map(|s| s.axis(2).value()).fold(f64::MAX, f64::min);
    assert!((deepest - M6.to_mm).abs() < 0.005, "{deepest} mm");
    assert!(bench.off_um(since, theta0, &M6) < 10.0);
}

#[test]
fn an_abort_in_the_thread_waits_for_the_way_out_before_the_rest_is_forgotten() {
    let (mut bench, _) = at_depth(&M6, -6.0, State::TapIn);
    bench.kernel.order(Order::Abort);
    bench.until(|b| b.said(Notice::HeldInThread));
    assert!(!bench.kernel.is_over());
    bench.kernel.order(Order::Resume);
    bench.tick();
    assert!(bench.said(Notice::NothingToResume));
    bench.kernel.order(Order::Retract);
    bench.until(|b| b.kernel.is_over());
    assert!(bench.said(Notice::Aborted) && bench.kernel.is_idle());
    assert!(bench.z() > M6.surface_mm);
}

#[test]
fn an_override_in_a_tap_is_said_to_be_locked_and_changes_nothing() {
    let (mut bench, theta0) = at_depth(&M6, -5.0, State::TapIn);
    bench.kernel.order(Order::FeedOverride(0.1));
    bench.until(|b| b.kernel.report().state == State::TapOut);
    assert!(bench.said(Notice::OverrideLocked));
    assert!(bench.off_um(bench.samples.len() - 40, theta0, &M6) < 10.0);
    assert_eq!(bench.kernel.operator().share(false), 0.1);
}

#[test]
fn after_an_alarm_with_drives_alive_the_tap_can_be_taken_out() {
    let mut config = control(&machine(0));
    config.sync_windows.stop = Length::um(20.0);
    let order = TapOrder { ramp_s: Some(0.22), ..M6 };
    let mut bench = Bench::new(&order);
    bench.kernel = Kernel::new(config);
    for kind in tapping(&order) {
        bench.kernel.push(&plan::Step { op: 0, line: 1, kind }).unwrap();
    }
    bench.until(|b| b.kernel.report().state == State::Faulted && b.kernel.is_standing());
    assert!(bench.z() < order.surface_mm);
    let since = bench.samples.len();
    bench.kernel.order(Order::Retract);
    bench.until(|b| b.said(Notice::Out));
    assert!(bench.z() > order.surface_mm && bench.kernel.report().state == State::Faulted);
    assert!(bench.samples[since..].iter().all(|s| !s.truth.unwrap().tool_broken));
}

/// The spindle turned and the axis moved apart with the drives off; recovery brings them out.
fn recovered(spindle_rev: f64, z_mm: f64, way: Way) -> (Bench, Stored) {
    let mut model = machine(0);
    model.spindles[0].start = Angle::rev(spindle_rev);
    model.axes.iter_mut().find(|(index, _)| *index == 2).unwrap().1.start = Coordinate::new(z_mm);
    let kernel = Kernel::new(control(&model));
    let machine = SimulatedMachine::new(model).unwrap();
    let mut bench = Bench { machine, kernel, samples: Vec::new(), events: Vec::new() };
    let point = |rev, mm| Point { angle: Angle::rev(rev), place: Length::mm(mm) };
    let stored = Stored::line(point(0.0, 2.0), point(14.0, -12.0), Direction::Inward).unwrap();
    bench.kernel.recover(plan(stored, way));
    bench.until(|b| b.kernel.is_over());
    (bench, stored)
}

fn plan(stored: Stored, way: Way) -> RecoveryPlan {
    RecoveryPlan {
        axis: canon::Axis::Z,
        spindle: 0,
        stored,
        turn: Angle::ZERO,
        way,
        spin: (Spin::rpm(120.0), SpinAccel::rev_per_s2(20.0)),
        feed: (Speed::mm_per_s(2.0), Accel::mm_per_s2(100.0)),
    }
}

/// What drives said before they were switched off arrives some periods later: it says nothing of
/// drives that are switched on again meanwhile.
#[test]
fn a_recovery_right_after_an_emergency_stop_waits_for_the_drives() {
    for (delay, pause) in [(0, 0), (0, 1), (2, 0), (2, 1), (2, 3), (2, 40)] {
        let mut model = machine(delay);
        model.axes.iter_mut().find(|(index, _)| *index == 2).unwrap().1.start =
            Coordinate::new(0.5);
        let kernel = Kernel::new(control(&model));
        let machine = SimulatedMachine::new(model).unwrap();
        let mut bench = Bench { machine, kernel, samples: Vec::new(), events: Vec::new() };
        (0..400).for_each(|_| bench.tick());
        let pressed = bus::Feedback { emergency_stop: true, ..*bench.machine.feedback() };
        let command = bench.kernel.tick(&pressed);
        assert!(!command.axes[2].enable);
        bench.machine.exchange(&command);
        (0..pause).for_each(|_| bench.tick());
        let point = |rev, mm| Point { angle: Angle::rev(rev), place: Length::mm(mm) };
        let stored = Stored::line(point(0.0, 2.0), point(14.0, -12.0), Direction::Inward).unwrap();
        bench.kernel.recover(plan(stored, Way::Straight));
        bench.until(|b| b.kernel.is_over() || !b.kernel.faults().is_empty());
        assert_eq!(bench.kernel.faults(), [], "{delay} periods on the way, {pause} later");
        assert!((bench.z() - 2.0).abs() < 0.003, "{} mm", bench.z());
    }
}

#[test]
fn recovery_brings_back_the_axis_that_overran_and_leaves_along_the_helix() {
    // at 8 turns z should be -6: the feed is 0.4 mm too deep, then the spindle half a turn too far
    for (rev, z, mover) in [(8.0, -6.4, Mover::Feed), (8.5, -6.0, Mover::Spindle)] {
        let (bench, stored) = recovered(rev, z, Way::Direct);
        let begun = bench.events.iter().find_map(|e| match e {
            EventKind::RecoveryBegun { mover, .. } => Some(*mover),
            _ => None,
        });
        assert_eq!(begun, Some(Some(mover)));
        let ended = bench.events.iter().find_map(|e| match e {
            EventKind::RecoveryEnded(figures) => Some(*figures),
            _ => None,
        });
        let figures = ended.expect("it came to its end");
        assert!(figures.helix_error_max < Length::um(5.0), "{figures:?}");
        let at = |s: &Sample| Point { angle: s.spindle(0), place: s.axis(2).of_linear() };
        let engaged = bench.samples.iter().rposition(|s| stored.error(at(s)).in_um().abs() > 5.0);
        let on = engaged.expect("it began off the helix") + 1;
        assert!(bench.samples.len() - on > 4000, "most of the way is on the helix");
        assert!((bench.z() - 2.0).abs() < 0.003 && turns(&bench).abs() < 0.003);
        assert!(bench.kernel.faults().is_empty());
    }
}

#[test]
fn nothing_but_the_guided_axis_and_spindle_moves_in_a_recovery() {
    let (bench, _) = recovered(8.5, -6.0, Way::Direct);
    for s in &bench.samples {
        let off: Command = s.command;
        assert!(off.axes[0].speed.value() == 0.0 && off.axes[1].speed.value() == 0.0);
    }
    assert!(bench.last().feedback.time > Time::s(1.0));
}

#[test]
fn over_the_work_the_feed_alone_goes_to_the_start() {
    let (bench, _) = recovered(8.0, 0.5, Way::Straight);
    assert!((bench.z() - 2.0).abs() < 0.003, "{} mm", bench.z());
    assert!((turns(&bench) - 8.0).abs() < 0.002, "the spindle stands: {} rev", turns(&bench));
    assert!(bench.samples.iter().all(|s| s.axis(2).value() > 0.49), "never deeper");
}
