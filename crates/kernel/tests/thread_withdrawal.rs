//! Threads that a hold, an abort, an alarm or a lost encoder ends on the way: the tool leaves along
//! the helix, away from the work.
use crate::common::{control, machine};
use crate::threading::{ACCEL, FROM, LEAD, PERIOD_S, off_um, steps};
use canon::Axis;
use kernel::{EventKind, Kernel, Order, RecordRequest, WithdrawalPlan};
use motion::{Pass, TiedCut, WayOut};
use plan::StepKind;
use sim::SimulatedMachine;
use units::{Angle, Coordinate, Lead, LeadGrowth, Length, Spin};

/// Where the tool is clear of the work, X.
const CLEAR: f64 = 2.0;

fn way_out() -> WayOut {
    let pass = Pass {
        axis: Axis::Z,
        start: Length::mm(FROM),
        angle: Angle::rev(0.25),
        end: Length::mm(FROM - 15.0),
        from: Length::mm(FROM),
        surface: Length::mm(FROM - 1.0),
        lead: Lead::mm_per_rev(-LEAD),
        growth: LeadGrowth::ZERO,
        spin: Spin::rpm(1200.0),
    };
    let clear = Length::mm(CLEAR);
    WayOut {
        cut: TiedCut::Thread,
        spindle: 0,
        infeed: Axis::X,
        clear,
        outward: 1.0,
        pass: Some(pass),
    }
}

/// A thread whose way out is known, under way.
struct Bench {
    kernel: Kernel,
    machine: SimulatedMachine,
    feedback: bus::Feedback,
    /// X, Z and the spindle's turns, as they really are.
    at: [f64; 3],
    requests: Vec<RecordRequest>,
    /// What is wrong with what the machine says.
    wrong: Option<fn(&mut bus::Feedback, &bus::Feedback)>,
    /// What it said before that.
    before: bus::Feedback,
    /// What it was told last.
    told: bus::Command,
}

impl Bench {
    fn new() -> Self {
        let machine = machine(1);
        let mut kernel = Kernel::new(control(&machine));
        let mut steps = steps(1200.0);
        steps.insert(3, StepKind::WayOut(Some(way_out())));
        for (op, kind) in (0..).zip(steps) {
            kernel.push(&plan::Step { op, line: op + 1, kind }).expect("there is room");
        }
        let machine = SimulatedMachine::new(machine).expect("it can be built");
        let feedback = *bus::Machine::feedback(&machine);
        Self {
            kernel,
            machine,
            feedback,
            at: [0.0; 3],
            requests: Vec::new(),
            wrong: None,
            before: feedback,
            told: bus::Command::default(),
        }
    }

    fn tick(&mut self) {
        let command = self.kernel.tick(&self.feedback);
        self.requests.extend(self.kernel.next_record_request());
        self.told = command;
        self.feedback = *bus::Machine::exchange(&mut self.machine, &command);
        match self.wrong {
            Some(wrong) => wrong(&mut self.feedback, &self.before),
            None => self.before = self.feedback,
        }
        let truth = bus::Machine::truth(&self.machine).expect("it is simulated");
        self.at = [truth.axes[0].value(), truth.axes[2].value(), truth.spindles[0].value()];
    }

    fn until(&mut self, what: &str, done: impl Fn(&Self) -> bool) {
        for _ in 0..40_000 {
            if done(self) {
                return;
            }
            self.tick();
        }
        panic!("never: {what}; at {:?}, {:?}", self.at, self.kernel.faults());
    }

    /// Likewise; the largest distance from the helix while the tool was not clear, µm.
    fn off_until(&mut self, what: &str, done: impl Fn(&Self) -> bool) -> f64 {
        let mut worst = 0.0_f64;
        for _ in 0..40_000 {
            if done(self) {
                return worst;
            }
            self.tick();
            if self.at[0] < 0.99 * CLEAR {
                worst = worst.max(off_um(self.at[1], self.at[2], 1.0).abs());
            }
        }
        panic!("never: {what}; at {:?}, {:?}", self.at, self.kernel.faults());
    }

    fn rpm(&self) -> f64 {
        bus::Machine::truth(&self.machine).expect("it is simulated").spins[0].in_rpm()
    }
}

#[test]
fn a_hold_takes_the_tool_off_the_thread_along_its_helix_and_the_pass_is_turned_again() {
    let mut bench = Bench::new();
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
    bench.kernel.order(Order::FeedHold);
    let off = bench.off_until("held", |b| b.kernel.report().state == bus::State::Held);
    assert!(off > 0.0 && off < 10.0, "{off} µm off the helix while the tool left the work");
    let [x, z, _] = bench.at;
    assert!((x - CLEAR).abs() < 0.01 && z > FROM - 15.0, "X{x} Z{z}");
    assert!((bench.rpm() - 1200.0).abs() < 25.0, "the spindle turns on: {}", bench.rpm());
    bench.kernel.order(Order::Resume);
    let beside = |b: &Bench| b.at[1] > FROM - 0.01 && b.at[0] < 0.01;
    bench.until("back at the start", beside);
    bench.until("in the thread again", |b| b.at[1] < FROM - 3.0);
    let off = bench.off_until("at the end", |b| b.at[1] < FROM - 14.0);
    assert!(off > 0.0 && off < 5.0, "{off} µm off the groove that was there");
    bench.until("ended", |b| b.kernel.report().state == bus::State::Ended);
    assert!(bench.kernel.faults().is_empty(), "{:?}", bench.kernel.faults());
}

#[test]
fn a_hold_takes_the_tool_off_whatever_block_of_the_chain_is_under_way() {
    // the thread goes over into its taper at Z-20: some of these ways out begin in the one and end
    // in the other
    for tenths in 110..165 {
        let mut bench = Bench::new();
        let z = FROM - f64::from(tenths) / 10.0;
        bench.until("there", |b| b.at[1] < z);
        bench.kernel.order(Order::FeedHold);
        let (mut told, mut asked) = ([f64::NAN; 2], 0.0_f64);
        while !(bench.kernel.report().state == bus::State::Held || bench.kernel.is_idle()) {
            bench.tick();
            let x = bench.told.axes[0].position.value();
            asked = asked.max((x - 2.0 * told[0] + told[1]).abs() / (PERIOD_S * PERIOD_S));
            told = [x, told[0]];
        }
        assert!(asked < 3.0 * ACCEL, "Z{z}: X is asked for {asked:.0} mm/s²");
        assert!(bench.kernel.faults().is_empty(), "Z{z}: {:?}", bench.kernel.faults());
        assert!(bench.at[0] > 0.99 * CLEAR, "Z{z}: X{}", bench.at[0]);
    }
}

#[test]
fn an_abort_leaves_the_thread_and_forgets_the_rest() {
    let mut bench = Bench::new();
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
    bench.kernel.order(Order::Abort);
    let off = bench.off_until("over", |b| b.kernel.is_over());
    assert!(off < 10.0 && (bench.at[0] - CLEAR).abs() < 0.01, "{off} µm, {:?}", bench.at);
    assert!(bench.kernel.is_idle() && bench.kernel.way_out().is_none());
}

#[test]
fn an_alarm_takes_the_tool_off_the_thread_before_the_spindle_stops() {
    let mut bench = Bench::new();
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
    bench.kernel.report_alarm(kernel::Subject::Spindle(0));
    let off = bench.off_until("clear", |b| b.at[0] > 0.99 * CLEAR);
    assert!(off > 0.0 && off < 10.0, "{off} µm off the helix while the tool left the work");
    assert!(bench.rpm() > 1150.0, "the spindle turns until then: {}", bench.rpm());
    bench.until("at rest", |b| b.kernel.is_standing() && b.rpm().abs() < 0.1);
    assert!(bench.at[0] > 0.99 * CLEAR, "and the tool stays away: X{}", bench.at[0]);
}

#[test]
fn an_alarm_of_the_infeed_axis_stops_on_the_thread() {
    let mut bench = Bench::new();
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
    bench.kernel.report_alarm(kernel::Subject::Axis(Axis::X));
    let off = bench.off_until("at rest", |b| b.kernel.is_standing() && b.rpm().abs() < 0.1);
    assert!(off > 0.0 && off < 10.0 && bench.at[0] < 0.01, "{off} µm, {:?}", bench.at);
    assert!(bench.kernel.way_out().is_some(), "it has still to be taken out");
}

#[test]
fn a_tool_whose_infeed_axis_does_not_say_that_it_moved_counts_as_in_the_work() {
    for order in [None, Some(Order::Abort)] {
        let mut bench = Bench::new();
        bench.kernel.keep_records();
        bench.until("asked", |b| !b.requests.is_empty());
        bench.kernel.acknowledge(1);
        bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
        bench.wrong = Some(|now, before| now.axes[0].position = before.axes[0].position);
        match order {
            None => bench.kernel.report_alarm(kernel::Subject::Spindle(0)),
            Some(order) => bench.kernel.order(order),
        }
        for _ in 0..8000 {
            bench.tick();
        }
        assert!(bench.kernel.way_out().is_some(), "{order:?}: {:?}", bench.at);
        assert!(!bench.requests.contains(&RecordRequest::Out), "{order:?}: {:?}", bench.requests);
        // and an encoder that stands still is noticed before its axis has run away
        let faults = bench.kernel.faults();
        assert!(
            faults.iter().any(|f| f.subject == kernel::Subject::Axis(Axis::X)),
            "{order:?}: {faults:?}"
        );
        assert!(
            bench.at[0].abs() < 15.0,
            "it runs out, and is driven no further: X{}",
            bench.at[0]
        );
    }
}

#[test]
fn an_encoder_that_lies_in_a_thread_is_bridged_until_the_tool_is_off_it() {
    type Wrong = fn(&mut bus::Feedback, &bus::Feedback);
    let wrongs: [(&str, Wrong); 5] = [
        ("spindle slips", |now, _| now.spindles[0].angle += Angle::deg(3.0)),
        ("spindle says nothing", |now, _| now.spindles[0].angle = Angle::rev(f64::NAN)),
        ("Z jumps", |now, _| now.axes[2].position += Coordinate::new(0.1)),
        ("Z is stuck", |now, before| now.axes[2].position = before.axes[2].position),
        ("Z says nothing", |now, _| now.axes[2].position = Coordinate::new(f64::NAN)),
    ];
    for (what, wrong) in wrongs {
        let mut bench = Bench::new();
        bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
        bench.wrong = Some(wrong);
        let off = bench.off_until("clear", |b| b.at[0] > 0.99 * CLEAR);
        assert!(off < 20.0, "{what}: {off} µm off the helix while the tool left the work");
        bench.until("at rest", |b| b.kernel.is_standing() && b.rpm().abs() < 0.1);
        let faults = bench.kernel.faults();
        assert!(faults[0].kind == kernel::FaultKind::ReadingImplausible, "{what}: {faults:?}");
        assert!(bench.at[0] > 0.99 * CLEAR, "{what}: and the tool stays away: {:?}", bench.at);
    }
}

#[test]
fn an_infeed_axis_whose_reading_jumps_stops_everything_on_the_thread() {
    let mut bench = Bench::new();
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
    bench.wrong = Some(|now, _| now.axes[0].position += Coordinate::new(0.1));
    let off = bench.off_until("at rest", |b| b.kernel.is_standing() && b.rpm().abs() < 0.1);
    assert!(off < 20.0 && bench.at[0].abs() < 0.05, "{off} µm, {:?}", bench.at);
    assert!(bench.kernel.way_out().is_some(), "it has still to be taken out");
}

#[test]
fn a_spindle_or_an_axis_without_its_drive_does_not_keep_the_tool_in_the_thread() {
    type Wrong = fn(&mut bus::Feedback, &bus::Feedback);
    let gone: [(&str, Wrong); 2] = [
        ("spindle", |now, _| now.spindles[0].ready = false),
        ("Z", |now, _| now.axes[2].ready = false),
    ];
    for (what, wrong) in gone {
        let mut bench = Bench::new();
        bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
        bench.wrong = Some(wrong);
        bench.until("clear", |b| b.at[0] > 0.99 * CLEAR);
        bench.until("at rest", |b| b.kernel.is_standing() && b.rpm().abs() < 0.1);
        let fault = bench.kernel.faults()[0].kind;
        assert_eq!(fault, kernel::FaultKind::DriveNotReady, "{what}");
    }
}

#[test]
fn a_thread_waits_for_its_record_and_asks_for_it_on_the_way() {
    let mut bench = Bench::new();
    bench.kernel.keep_records();
    bench.until("asked", |b| !b.requests.is_empty());
    assert!(bench.at[1] > FROM, "while positioning: Z{}", bench.at[1]);
    let Some(RecordRequest::Inward(number, record)) = bench.requests.first().copied() else {
        panic!("{:?}", bench.requests)
    };
    assert_eq!(record.cut, Some(TiedCut::Thread));
    assert_eq!(record.retreat, Some((0, Length::mm(CLEAR), 1.0)));
    for _ in 0..4000 {
        bench.tick();
    }
    assert!(bench.at[1] > FROM - 0.1, "it has not waited: Z{}", bench.at[1]);
    bench.kernel.acknowledge(number);
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
}

#[test]
fn a_tool_that_was_left_in_a_thread_is_withdrawn_by_its_infeed_axis_first() {
    let mut bench = Bench::new();
    bench.until("in the thread", |b| b.at[1] < FROM - 8.0);
    // the control dies, and another one finds the tool in the work
    let still = bus::Command::default();
    for _ in 0..8000 {
        bench.feedback = *bus::Machine::exchange(&mut bench.machine, &still);
    }
    bench.kernel = Kernel::new(control(&machine(1)));
    let legs = [Some((Axis::X, Length::mm(CLEAR))), Some((Axis::Z, Length::mm(FROM)))];
    bench.kernel.withdraw(WithdrawalPlan { legs });
    let began = bench.feedback.time;
    bench.tick();
    let z = bench.at[1];
    bench.until("clear", |b| (b.at[0] - CLEAR).abs() < 0.005);
    assert!((bench.at[1] - z).abs() < 0.02, "Z moves before X is out: {z}, {}", bench.at[1]);
    bench.until("over", |b| b.kernel.is_over());
    assert!((bench.at[1] - FROM).abs() < 0.02, "{:?}", bench.at);
    let mut events = core::iter::from_fn(|| bench.kernel.next_event());
    let took = events.find_map(|e| match e.kind {
        EventKind::Withdrawn { duration } => Some(duration),
        _ => None,
    });
    let off = took.expect("it says so") - (bench.feedback.time - began);
    assert!(off.value().abs() < 0.001, "{off} off the time that it took");
}
