//! A machine with its control and its judge, in a tap: to be copied, struck, and taken out.
use super::draw::Part;
use super::fate::{End, Fate};
use super::work::{Work, op, tool};
use crate::common::*;
use bus::{DriveReaction, Machine, Sample, Truth};
use canon::ToolLibrary;
use kernel::{EventKind, Kernel, Notice, Order, RecoveryPlan};
use sim::{Bus, Fault, Faulty, LeftAlone, SimulatedMachine};
use sync::leaving::{Leaving, Setting};
use sync::recovery::{Point, Stored, Way};
use units::{Accel, Angle, Coordinate, Length, Speed, Spin, SpinAccel, Time};
use verify::{FeatureKind, Judge};

/// A tip that is not even so deep has cut nothing that could be certified.
const HAS_CUT: Length = Length::mm(0.1);

/// A machine with its control and its judge, in the tap.
#[derive(Clone)]
pub struct Bench {
    pub machine: Faulty<SimulatedMachine>,
    pub kernel: Kernel,
    judge: Judge,
    stored: Option<Stored>,
    surface: Length,
    start_mm: f64,
    setting: Setting,
    /// Largest distance from the line in the material since it was last asked.
    worst: Length,
    broken: bool,
    coming_out: bool,
    notices: Vec<Notice>,
}

impl Bench {
    /// At the R plane, the tap in the spindle.
    pub fn new(work: &Work, reaction: DriveReaction, seed: u64) -> Self {
        let mut model = machine_with_work(1, &work.order, work.diameter_mm);
        model.axes.retain(|(index, _)| *index == 2);
        model.axes[0].1.start = Coordinate::new(work.order.from_mm);
        model.substep = Time::s(25e-6);
        model = scattered(model, 0.05, seed);
        for tool in &mut model.magazine {
            if let sim::ToolKind::Tap(tap) = &mut tool.kind {
                tap.holder = work.holder;
                tap.flank_play = Length::um(0.5);
            }
        }
        let bus = Bus { farad: 820e-6, volt: 565.0, trip_volt: 250.0 };
        let alone = LeftAlone {
            config: model.clone(),
            watchdog: Time::s(5e-3),
            on_silence: reaction,
            on_power_loss: reaction,
            bus: (reaction != DriveReaction::Off).then_some(bus),
        };
        let mut kernel = Kernel::new(control(&model));
        for kind in tapping(&work.order).into_iter().skip(1) {
            kernel.push(&plan::Step { op: 0, line: 1, kind }).unwrap();
        }
        let machine = SimulatedMachine::new(model).unwrap();
        let mut judge = Judge::new(verify::Config::new(ToolLibrary::new([tool(work)])));
        judge.op(0, &op(&work.order));
        Self {
            machine: Faulty::new(machine, &[], seed).left_alone(alone),
            kernel,
            judge,
            stored: None,
            surface: Length::mm(work.order.surface_mm),
            start_mm: work.order.from_mm,
            setting: Setting {
                surface: Length::mm(work.order.surface_mm),
                holder: work.holder.stiffness,
                travel: work.holder.travel.unwrap_or_default(),
                diameter: Length::mm(work.diameter_mm),
            },
            worst: Length::ZERO,
            broken: false,
            coming_out: false,
            notices: Vec::new(),
        }
    }

    fn truth(&self) -> Truth {
        *self.machine.truth().unwrap()
    }

    fn point(&self) -> Point {
        let truth = self.truth();
        Point { angle: truth.spindles[0], place: truth.axes[2].of_linear() }
    }

    fn look(&mut self, sample: &Sample) {
        self.judge.sample(sample);
        let truth = self.truth();
        self.broken |= truth.tool_broken;
        if let Some(stored) = self.stored.filter(|_| truth.axes[2].of_linear() < self.surface) {
            self.worst = self.worst.max(stored.error(self.point()).abs());
        }
    }

    /// One period.
    pub fn tick(&mut self) {
        let (feedback, truth) = (*self.machine.feedback(), self.machine.truth().copied());
        let mut sample = Sample { feedback, truth, ..Sample::default() };
        if self.machine.is_abandoned() {
            sample.report = self.kernel.report();
            sample.report.state = bus::State::Faulted;
            self.look(&sample);
            self.machine.wait();
            return;
        }
        sample.command = self.kernel.tick(&feedback);
        sample.report = self.kernel.report();
        while let Some(event) = self.kernel.next_event() {
            match event.kind {
                EventKind::OnCoupling => (self.coming_out, self.worst) = (true, Length::ZERO),
                EventKind::Operator(notice) => self.notices.push(notice),
                _ => {}
            }
        }
        self.look(&sample);
        self.machine.exchange(&sample.command);
        self.stored = self.kernel.engaged().or(self.stored);
    }

    /// Ticks until something is so; whether it came within a time.
    fn until(&mut self, seconds: f64, what: impl Fn(&Self) -> bool) -> bool {
        let end = self.machine.feedback().time + Time::s(seconds);
        while !what(self) {
            if self.machine.feedback().time > end {
                return false;
            }
            self.tick();
        }
        true
    }

    /// The tap is coupled.
    pub fn go_into_tap(&mut self) {
        assert!(self.until(10.0, |b| b.kernel.engaged().is_some()), "the tap begins");
        self.tick();
    }

    /// Whether the tap is still under way.
    pub fn is_tapping(&self) -> bool {
        self.kernel.engaged().is_some()
    }

    /// Where in its stroke it is; before the stroke begins, on its way in.
    pub fn part(&self) -> Part {
        match self.kernel.report().state {
            bus::State::TapBottom => Part::Bottom,
            bus::State::TapOut => Part::Out,
            _ => Part::In,
        }
    }

    /// Whether the thread is in the class that was asked, and said to be recovered, as it would be
    /// certified now.
    fn judged(&self) -> (bool, bool) {
        let features = self.judge.clone().finish();
        match features.first().map(|f| &f.kind) {
            Some(FeatureKind::Thread(thread)) => (thread.class_name() == "6H", thread.recovered),
            _ => (false, false),
        }
    }

    /// Wait until nothing turns or moves, ten seconds at most: a spindle without its drive may
    /// creep for longer, turned by a tap that is pressed.
    fn run_down(&mut self) {
        let mut still = 0;
        let mut before = self.truth().axes[2];
        for _ in 0..40_000 {
            self.tick();
            let truth = self.truth();
            let stands = !self.machine.is_running_down()
                && truth.spins[0].abs() < Spin::rpm(1.0)
                && (truth.axes[2] - before).abs() < Coordinate::new(2.5e-5);
            before = truth.axes[2];
            still = if stands { still + 1 } else { 0 };
            if still > 200 {
                return;
            }
        }
    }

    /// The tap is in the work, or so near above it that it may touch: else nothing is to be done.
    fn is_in_work(&self) -> bool {
        let z = self.truth().axes[2].of_linear();
        let at_start = (z - Length::mm(self.start_mm)).abs() < Length::um(20.0);
        z < self.surface + Length::mm(1.0) && !at_start
    }

    /// Strike here, and see what becomes of it.
    pub fn strike(mut self, case: &Case) -> Fate {
        self.worst = Length::ZERO;
        self.machine.strike(case.fault);
        // what the kernel makes of it, where it lives
        self.run_down();
        if self.broken {
            return Fate::of(End::BrokenByStop);
        }
        let Some(stored) = self.stored else {
            return Fate::of(End::Lost("nothing was coupled".into()));
        };
        let off_um = stored.error(self.point()).in_um().abs();
        let (class_at_stop, _) = self.judged();
        if !self.is_in_work() {
            return Fate { class_at_stop, ..Fate::of(End::Nothing) };
        }
        let inside = self.truth().axes[2].of_linear() < self.surface;
        let has_cut = self.truth().axes[2].of_linear() < self.surface - HAS_CUT;
        let feedback = self.machine.machine().feedback();
        let at = Point {
            angle: feedback.spindles[0].angle,
            place: feedback.axes[2].position.of_linear(),
        };
        let way = match stored.leaving(at, &self.setting) {
            Ok(Leaving::Along) => case.way,
            Ok(Leaving::Straight) => Way::Straight,
            Err(why) => return Fate { off_um, ..Fate::of(End::Refused(why.to_string())) },
        };
        self.machine.mend();
        self.kernel.recover(RecoveryPlan {
            axis: canon::Axis::Z,
            spindle: 0,
            stored,
            turn: Angle::ZERO,
            way,
            spin: (Spin::rpm(600.0), SpinAccel::rev_per_s2(50.0)),
            feed: (Speed::mm_per_s(2.0), Accel::mm_per_s2(100.0)),
        });
        self.until(30.0, |b| b.kernel.is_over());
        let (in_class, said_recovered) = self.judged();
        let end = if self.broken {
            End::BrokenOnTheWay
        } else if !self.kernel.faults().is_empty() {
            End::Lost(format!("{}", self.kernel.faults()[0]))
        } else if self.is_in_work() {
            End::Lost("no end of the recovery".into())
        } else if has_cut && !said_recovered {
            End::Lost("out, and not certified as recovered".into())
        } else {
            End::Recovered
        };
        Fate {
            end,
            off_um,
            helix_um: if inside { self.worst.in_um() } else { 0.0 },
            class_at_stop,
            class_lost: class_at_stop && inside && !in_class,
        }
    }

    /// Stop here with the drives alive, then take the tap out: the distance from the line in the
    /// stop, and on the way out, µm.
    pub fn stop(mut self, how: Stop) -> Result<(f64, f64), String> {
        self.worst = Length::ZERO;
        match how {
            Stop::Hold => self.kernel.order(Order::FeedHold),
            Stop::Abort => self.kernel.order(Order::Abort),
            // the reading of the guided axis is well; the spindle's drive complains of something
            // else
            Stop::Alarm => self.kernel.report_alarm(kernel::Subject::Spindle(0)),
        }
        if !self.until(5.0, |b| b.kernel.is_standing()) {
            return Err("it never stood".into());
        }
        let in_stop = self.worst.in_um();
        self.worst = Length::ZERO;
        self.kernel.order(Order::Retract);
        self.until(10.0, |b| {
            b.notices.contains(&Notice::Out) || b.kernel.is_over() && !b.is_tapping()
        });
        if self.truth().axes[2].of_linear() < self.surface {
            return Err(format!("it did not come out: {:?}", self.notices));
        }
        if self.broken { Err("the tap broke".into()) } else { Ok((in_stop, self.worst.in_um())) }
    }
}

/// What happens, and how the tap is brought back onto its helix.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub fault: Fault,
    pub way: Way,
}

/// How a tap is stopped with the drives alive.
#[derive(Clone, Copy, Debug)]
pub enum Stop {
    Hold,
    Abort,
    Alarm,
}
