//! The campaign of stops: whatever ends a tap, wherever it comes, the tap leaves along its own helix.
//!
//! ```text
//!   one run into the tap ──┬── t₁: clone, strike, run down, mend, recover, measure
//!                          ├── t₂: clone, …
//!                          └── …              the machine, its control and the judge are copied at each instant
//! ```
//!
//! Measured by the machine's truth: the distance of the axis from the coupling's line while the recovery takes the tap
//! out through the work, whether the tap broke, and the class of what was cut, at the stop and after the recovery.
#![allow(clippy::unwrap_used)] // a test may panic
use crate::common::*;
use bus::{Machine, Sample, Truth};
use canon::{Flute, Op, OpKind, Span, TapTool, Tool, ToolKind, ToolLibrary};
use kernel::{EventKind, Kernel, Notice, Order, RecoveryPlan};
use sim::{Bus, Fault, Faulty, LeftAlone, Reaction, SimulatedMachine};
use std::fmt::Write as _;
use sync::recovery::{Point, Seat, Stored, Way};
use units::{Accel, Angle, Lead, Length, Speed, Spin, SpinAccel, Stiffness, Time};
use verify::{FeatureKind, Judge};

/// A tap may stand this far from its helix on the way out, µm.
pub const HELIX_UM: f64 = 20.0;
/// And this far while it is stopped with the drives alive.
pub const COUPLED_UM: f64 = 10.0;

/// What is tapped.
#[derive(Clone, Copy)]
pub struct Work {
    pub size: &'static str,
    pub diameter_mm: f64,
    pub order: TapOrder,
    pub holder: sim::Holder,
}

/// A rigid holder.
pub const RIGID: sim::Holder =
    sim::Holder { stiffness: Stiffness::n_per_mm(20_000.0), travel: None };

/// M8×1.25, 20 mm deep at 1000 rpm, from 2 mm above.
pub const M8: Work = Work {
    size: "M8x1.25",
    diameter_mm: 8.0,
    order: TapOrder {
        lead_mm: 1.25,
        rpm: 1000.0,
        from_mm: -100.0,
        surface_mm: -102.0,
        to_mm: -122.0,
        dwell_s: 0.05,
        ramp_s: None,
        start_angle: Some(Angle::ZERO),
        left: false,
    },
    holder: RIGID,
};

/// A machine with its control and its judge, in the tap.
#[derive(Clone)]
pub struct Bench {
    pub machine: Faulty<SimulatedMachine>,
    pub kernel: Kernel,
    judge: Judge,
    stored: Option<Stored>,
    surface: Length,
    /// Largest distance from the line in the material since it was last asked.
    worst: Length,
    broken: bool,
    coming_out: bool,
    notices: Vec<Notice>,
}

impl Bench {
    /// At the R plane, the tap in the spindle.
    pub fn new(work: &Work, reaction: Reaction, seed: u64) -> Self {
        let mut model = machine_with_work(1, &work.order, work.diameter_mm);
        model.axes.retain(|(index, _)| *index == 2);
        model.axes[0].1.start = Length::mm(work.order.from_mm);
        model.substep = Time::s(25e-6);
        (model.scatter, model.seed) = (0.05, seed);
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
            bus: (reaction != Reaction::Coast).then_some(bus),
        };
        let mut kernel = Kernel::new(control(&model));
        for kind in tapping(&work.order).into_iter().skip(1) {
            kernel.push(plan::Step { op: 0, line: 1, kind }).unwrap();
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
            worst: Length::ZERO,
            broken: false,
            coming_out: false,
            notices: Vec::new(),
        }
    }

    fn truth(&self) -> Truth {
        self.machine.truth().unwrap()
    }

    fn point(&self) -> Point {
        let truth = self.truth();
        Point { angle: truth.spindles[0], place: truth.axes[2] }
    }

    fn look(&mut self, sample: &Sample) {
        self.judge.sample(sample);
        let truth = self.truth();
        self.broken |= truth.tool_broken;
        if let Some(stored) = self.stored.filter(|_| truth.axes[2] < self.surface) {
            self.worst = self.worst.max(stored.error(self.point()).abs());
        }
    }

    /// One period.
    pub fn tick(&mut self) {
        let feedback = self.machine.feedback();
        let mut sample = Sample { feedback, truth: self.machine.truth(), ..Sample::default() };
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

    fn class(&self) -> String {
        let features = self.judge.clone().finish();
        match features.first().map(|f| &f.kind) {
            Some(FeatureKind::Thread(thread)) => thread.class_name().to_owned(),
            _ => String::new(),
        }
    }

    fn in_class(&self) -> bool {
        self.class() == "6H"
    }

    /// Wait until nothing turns or moves, ten seconds at most: a spindle without its drive may creep for longer, turned
    /// by a tap that is pressed.
    fn run_down(&mut self) {
        let mut still = 0;
        let mut before = self.truth().axes[2];
        for _ in 0..40_000 {
            self.tick();
            let truth = self.truth();
            let stands = truth.spins[0].abs() < Spin::rpm(1.0)
                && (truth.axes[2] - before).abs() < Length::mm(2.5e-5);
            before = truth.axes[2];
            still = if stands { still + 1 } else { 0 };
            if still > 200 {
                return;
            }
        }
    }

    /// Strike here, and see what becomes of it.
    pub fn strike(mut self, fault: Fault, way: Way) -> Fate {
        self.machine.strike(fault);
        // what the kernel makes of it, where it lives
        self.run_down();
        let stop = self.truth();
        let broken_by_stop = self.broken;
        let Some(stored) = self.stored else { return Fate::failed("nothing was coupled") };
        let off = stored.error(self.point());
        let (class_at_stop, inside) = (self.in_class(), stop.axes[2] < self.surface);
        self.machine.mend();
        self.kernel.recover(RecoveryPlan {
            axis: canon::Axis::Z,
            spindle: 0,
            stored,
            turn: Angle::ZERO,
            way,
            spin: (Spin::rpm(600.0), SpinAccel::rev_per_s2(50.0)),
            feed: (Speed::mm_per_s(2.0), Accel::mm_per_s2(100.0)),
            retreat: None,
        });
        let over = self.until(30.0, |b| b.kernel.is_over());
        if !over || !self.kernel.faults().is_empty() {
            return Fate::failed(&format!("no end of the recovery: {:?}", self.kernel.faults()));
        }
        Fate {
            off_um: off.in_um().abs(),
            helix_um: if inside { self.worst.in_um() } else { 0.0 },
            broken_by_stop,
            broken: self.broken,
            class_kept: !class_at_stop || !inside || self.in_class(),
            class_at_stop,
            out: self.truth().axes[2] > self.surface,
            failed: None,
        }
    }

    /// Stop here with the drives alive, then take the tap out: the distance from the line meanwhile, µm.
    pub fn stop(mut self, how: Stop) -> Result<f64, String> {
        self.worst = Length::ZERO;
        match how {
            Stop::Hold => self.kernel.order(Order::FeedHold),
            Stop::Abort => self.kernel.order(Order::Abort),
            // the reading of the guided axis is well; the spindle's drive complains of something else
            Stop::Alarm => self.kernel.report_alarm(kernel::Subject::Spindle(0)),
        }
        if !self.until(5.0, |b| b.kernel.is_standing()) {
            return Err("it never stood".into());
        }
        let worst = self.worst.in_um();
        self.kernel.order(Order::Retract);
        self.until(10.0, |b| {
            b.notices.contains(&Notice::Out) || b.kernel.is_over() && !b.is_tapping()
        });
        if self.truth().axes[2] < self.surface {
            return Err(format!("it did not come out: {:?}", self.notices));
        }
        if self.broken { Err("the tap broke".into()) } else { Ok(worst.max(self.worst.in_um())) }
    }
}

/// How a tap is stopped with the drives alive.
#[derive(Clone, Copy, Debug)]
pub enum Stop {
    Hold,
    Abort,
    Alarm,
}

/// What became of one case.
#[derive(Clone, Debug)]
#[allow(clippy::struct_excessive_bools)] // independent facts, each counted on its own
pub struct Fate {
    pub off_um: f64,
    pub helix_um: f64,
    pub broken_by_stop: bool,
    pub broken: bool,
    pub class_at_stop: bool,
    pub class_kept: bool,
    pub out: bool,
    pub failed: Option<String>,
}

impl Fate {
    fn failed(why: &str) -> Self {
        Self {
            off_um: 0.0,
            helix_um: 0.0,
            broken_by_stop: false,
            broken: false,
            class_at_stop: false,
            class_kept: true,
            out: false,
            failed: Some(why.into()),
        }
    }
}

/// Many of them.
#[derive(Default)]
pub struct Tally {
    pub cases: u32,
    pub recovered: u32,
    pub broken: u32,
    pub broken_by_stop: u32,
    pub unexplained: u32,
    pub class_lost: u32,
    pub in_class_at_stop: u32,
    pub off_um: f64,
    pub helix_um: f64,
    pub first_failure: Option<String>,
}

impl Tally {
    pub fn add(&mut self, fate: &Fate, what: &str) {
        self.cases += 1;
        self.off_um = self.off_um.max(fate.off_um);
        self.helix_um = self.helix_um.max(fate.helix_um);
        self.broken += u32::from(fate.broken);
        self.broken_by_stop += u32::from(fate.broken_by_stop);
        self.in_class_at_stop += u32::from(fate.class_at_stop);
        self.class_lost += u32::from(!fate.class_kept);
        let good = fate.out && fate.helix_um <= HELIX_UM && !fate.broken && fate.failed.is_none();
        self.recovered += u32::from(good);
        self.unexplained += u32::from(!good && !fate.broken);
        if (!good || !fate.class_kept) && self.first_failure.is_none() {
            self.first_failure = Some(format!("{what}: {fate:?}"));
        }
    }

    pub fn row(&self, name: &str) -> String {
        format!(
            "{name:<44} {:>6} {:>9} {:>7} {:>7} {:>11} {:>10.1} {:>11.2} {:>6}/{}",
            self.cases,
            self.recovered,
            0,
            self.broken,
            self.unexplained,
            self.off_um,
            self.helix_um,
            self.class_lost,
            self.in_class_at_stop
        )
    }

    pub fn head() -> String {
        format!(
            "{:<44} {:>6} {:>9} {:>7} {:>7} {:>11} {:>10} {:>11} {:>6}",
            "",
            "cases",
            "recovered",
            "refused",
            "broken",
            "unexplained",
            "stop µm",
            "way out µm",
            "class lost/at stop"
        )
    }

    #[track_caller]
    pub fn check(&self) {
        let mut why = String::new();
        let _ = write!(why, "{:?}", self.first_failure);
        assert_eq!((self.broken, self.unexplained, self.class_lost), (0, 0, 0), "{why}");
        assert_eq!(self.recovered, self.cases, "{why}");
    }
}

/// A stop at every so many periods of a tap.
pub fn sweep(work: &Work, fault: Fault, reaction: Reaction, every: usize, way: Way) -> Tally {
    let (mut bench, mut tally) = (Bench::new(work, reaction, 1), Tally::default());
    bench.go_into_tap();
    while bench.is_tapping() {
        let time = bench.machine.feedback().time;
        tally.add(&bench.clone().strike(fault, way), &format!("{} at {time}", fault.name()));
        for _ in 0..every {
            bench.tick();
        }
    }
    tally
}

/// Sizes that are drawn: name, diameter, pitch.
const SIZES: [(&str, f64, f64); 9] = [
    ("M3x0.5", 3.0, 0.5),
    ("M4x0.7", 4.0, 0.7),
    ("M5x0.8", 5.0, 0.8),
    ("M6x1", 6.0, 1.0),
    ("M8x1.25", 8.0, 1.25),
    ("M10x1.5", 10.0, 1.5),
    ("M12x1.75", 12.0, 1.75),
    ("M14x2", 14.0, 2.0),
    ("M16x2", 16.0, 2.0),
];

/// Chance with a seed: `SplitMix64` (Steele, Lea, Flood 2014).
pub struct Dice(pub u64);

impl Dice {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }

    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// Size, hand, speed, depth and holder at random.
    pub fn work(&mut self) -> Work {
        let (size, diameter_mm, lead_mm) = self.one_of(&SIZES);
        let depth = (diameter_mm * self.between(0.8, 2.0)).max(4.0 * lead_mm);
        let soft =
            sim::Holder { stiffness: Stiffness::n_per_mm(500.0), travel: Some(Length::mm(0.5)) };
        Work {
            size,
            diameter_mm,
            holder: if self.unit() < 0.7 { RIGID } else { soft },
            order: TapOrder {
                lead_mm,
                rpm: self.between(200.0, (9000.0 / diameter_mm).min(3000.0)).round(),
                to_mm: -102.0 - depth,
                dwell_s: 0.0,
                left: self.unit() < 0.3,
                ..M8.order
            },
        }
    }
}

/// Cases at random: `count` from a seed, for each reaction of the drives.
pub fn random(count: u32, seed: u64, reaction: Reaction, faults: &[Fault]) -> Tally {
    let mut tally = Tally::default();
    for number in 0..count {
        let mut dice = Dice(seed ^ (u64::from(number) << 32));
        let (work, fault) = (dice.work(), dice.one_of(faults));
        let way = if dice.unit() < 0.5 { Way::Direct } else { unload(&work) };
        let mut bench = Bench::new(&work, reaction, u64::from(number));
        bench.go_into_tap();
        // somewhere between the beginning and the end of it, by its planned time
        let plan = work.order.plan();
        let whole = plan.inward.duration() + plan.outward.duration() + work.order.dwell_s;
        let ticks = (dice.unit() * whole / PERIOD.value()) as usize;
        for _ in 0..ticks {
            bench.tick();
        }
        let what = format!(
            "case {number}: {} {} at {} rpm, {} {reaction:?} at {}, {way:?}",
            work.size,
            if work.order.left { "left" } else { "right" },
            work.order.rpm,
            fault.name(),
            bench.machine.feedback().time
        );
        tally.add(&bench.strike(fault, way), &what);
    }
    tally
}

/// Unload first, where it is worth it.
pub fn unload(work: &Work) -> Way {
    Way::UnloadFirst(Seat { play: Length::um(0.5), is_stiff: work.holder.travel.is_none() })
}

fn tool(work: &Work) -> Tool {
    let hand = if work.order.left { -1.0 } else { 1.0 };
    Tool {
        number: 1,
        pocket: 1,
        length: Length::mm(100.0),
        diameter: Length::mm(work.diameter_mm),
        kind: ToolKind::Tap(TapTool {
            designation: work.size.to_owned(),
            lead: Lead::mm_per_rev(hand * work.order.lead_mm),
            chamfer_pitches: 2.5,
            thread_length: Length::mm(60.0),
            flute: Flute::SpiralFlute,
            oversize: Length::um(30.0),
            holder: canon::Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        }),
        description: String::new(),
        stand_in: false,
    }
}

fn op(order: &TapOrder) -> Op {
    let plan = order.plan();
    let hand = if order.left { -1.0 } else { 1.0 };
    Op {
        span: Span { line: 1, ..Span::default() },
        kind: OpKind::Tap(canon::Tap {
            axis: canon::Axis::Z,
            start: plan.start,
            bottom: plan.bottom,
            surface: plan.surface,
            lead: Lead::mm_per_rev(hand * order.lead_mm),
            spin: Spin::rpm(order.rpm),
            return_spin: Spin::rpm(order.rpm),
            dwell: plan.dwell,
            start_angle: None,
            peck: None,
        }),
    }
}
