//! A tapping centre, its control, and words to drive it: the simulated machine has the figures of
//! the machine file `tapping-center`; the kernel is told the same.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part
use bus::{Machine, Sample};
use canon::{Axis, Position};
use core::f64::consts::TAU;
use kernel::{
    AxisControl, AxisFriction, AxisWindows, Config, EncoderPlace, Event, FeedForward, Kernel,
    Pause, SpindleControl, SpindleFriction, SpindleWindows, SyncMode, Waits, Windows,
};
use motion::{Limiting, Move, Path, Phase, Profile, TapLimiting, TapPlan};
use plan::{AxisLimits, SpindleLimits, StrokeRequest};
use plan::{SpindleStep, Step, StepKind};
use sim::{AxisEncoder, AxisModel, SimulatedMachine, SpindleModel};
use units::{
    Angle, Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Force, Inertia, Lead,
    Length, Mass, Power, Speed, Spin, SpinAccel, Time, Torque,
};

/// The tapping centre of the simulator's own tests.
#[path = "../../../sim/tests/fixtures/mod.rs"]
mod fixtures;

pub const PERIOD: Time = Time::s(250e-6);

fn axis(table_kg: f64, weight_share: f64) -> AxisModel {
    AxisModel {
        table: Mass::kg(table_kg),
        backlash: Coordinate::linear(Length::um(1.0)),
        weight_share,
        brake: weight_share > 0.0,
        ..fixtures::z_axis()
    }
}

/// The machine.
pub fn machine(command_delay: usize) -> sim::Config {
    sim::Config {
        period: PERIOD,
        substep: Time::s(12.5e-6),
        command_delay,
        axes: vec![(0, axis(200.0, 0.0)), (1, axis(350.0, 0.0)), (2, axis(150.0, 1.0))],
        spindles: vec![SpindleModel {
            rounding: Spin::rev_per_s(1.0 / TAU),
            start: Angle::rev(0.3),
            ..fixtures::spindle()
        }],
        magazine: Vec::new(),
        tool_change_time: Time::s(0.9),
        carousel: None,
        stock: None,
        ..fixtures::tapping_center()
    }
}

/// The same machine whose friction, play and cutting force are off by up to this share.
pub fn scattered(mut machine: sim::Config, share: f64, seed: u64) -> sim::Config {
    let by = units::Spread::uniform(share);
    (machine.scatter, machine.seed) = (units::Spread { per: units::Per::Hole, ..by }, seed);
    for (_, axis) in &mut machine.axes {
        (axis.scatter.backlash, axis.scatter.friction) = (by, by);
    }
    for spindle in &mut machine.spindles {
        spindle.scatter.friction = by;
    }
    machine
}

/// The machine with the tap of an order in its spindle, and C45 steel below it.
pub fn machine_with_work(command_delay: usize, order: &TapOrder, diameter_mm: f64) -> sim::Config {
    let mut machine = machine(command_delay);
    let length = Length::mm(100.0);
    let lead = if order.left { -order.lead_mm } else { order.lead_mm };
    let tap = sim::Tap {
        diameter: Length::mm(diameter_mm),
        lead: Lead::mm_per_rev(lead),
        thread_length: Length::mm(40.0),
        ..fixtures::m6()
    };
    machine.magazine = vec![sim::Tool { number: 1, length, kind: sim::ToolKind::Tap(tap) }];
    machine.tool = 1;
    machine.stock =
        Some(sim::Stock { top: Length::mm(order.surface_mm) - length, ..fixtures::stock() });
    machine
}

fn axis_control(model: &AxisModel) -> AxisControl {
    let friction = &model.friction;
    AxisControl {
        position_gain: 80.0,
        velocity_bandwidth_hz: 70.0,
        feed_forward: FeedForward::FULL,
        motor_mass: model.motor_mass(),
        table_mass: model.table,
        weight: Force::n(-9.806_65 * model.table.value() * model.weight_share),
        friction: AxisFriction {
            coulomb: friction.coulomb,
            breakaway: friction.breakaway,
            stribeck: friction.stribeck,
            bristle_stiffness: friction.bristle_stiffness,
            bristle_damping_n_s_per_m: friction.bristle_damping_n_s_per_m,
            viscous_n_s_per_m: friction.viscous_n_s_per_m,
        },
        stiffness: model.stiffness,
        backlash: model.backlash,
        encoder: match model.encoder {
            AxisEncoder::Motor { counts_per_rev } => kernel::AxisEncoder {
                place: EncoderPlace::Motor,
                motor_count: None,
                count: model.screw_lead / f64::from(counts_per_rev),
            },
            AxisEncoder::Scale { resolution, motor_counts_per_rev } => kernel::AxisEncoder {
                place: EncoderPlace::Scale,
                motor_count: motor_counts_per_rev
                    .map(|counts| model.screw_lead / f64::from(counts)),
                count: resolution,
            },
        },
        peak_force: model.peak_force(),
        force_lag: model.force_lag,
        approach: (CoordinateSpeed::new(50.0), CoordinateAccel::new(2000.0)),
        travel: None,
        windows: AxisWindows {
            in_position: Coordinate::linear(Length::um(5.0)),
            settle: Time::s(5e-3),
            following_warn: Coordinate::linear(Length::um(200.0)),
            following_stop: Coordinate::linear(Length::um(2000.0)),
        },
    }
}

/// No limit that an override could break.
pub const UNLIMITED: motion::Bounds = motion::Bounds {
    speed: [f64::INFINITY; 9],
    accel: [f64::INFINITY; 9],
    jerk: [f64::INFINITY; 9],
};

/// The control of a machine.
pub fn control(machine: &sim::Config) -> Config {
    let mut axes = [None; bus::AXES];
    for (index, model) in &machine.axes {
        axes[*index] = Some(axis_control(model));
    }
    let mut spindles = [None; bus::SPINDLES];
    for (slot, model) in spindles.iter_mut().zip(&machine.spindles) {
        *slot = Some(SpindleControl {
            position_gain: 80.0,
            velocity_bandwidth_hz: 120.0,
            feed_forward: FeedForward::FULL,
            inertia: model.inertia,
            friction: SpindleFriction {
                coulomb: model.coulomb,
                rounding: model.rounding,
                viscous_n_m_s_per_rad: model.viscous_n_m_s_per_rad,
            },
            highest: Spin::rpm(10_000.0),
            peak_torque: model.peak_torque,
            peak_power: model.peak_power,
            torque_lag: model.torque_lag,
            encoder_count: Angle::rev(1.0 / f64::from(model.encoder.counts_per_rev)),
            observer_bandwidth_hz: 200.0,
            orient: (Spin::rpm(300.0), SpinAccel::rev_per_s2(100.0)),
            own_ramps: None,
            closes_position: false,
            orients: false,
            follows_orders: true,
            encoder_check: None,
            windows: SpindleWindows {
                at_speed: 0.02,
                in_cut: 0.25,
                at_rest: Spin::rpm(3.0),
                oriented: Angle::deg(0.1),
                following_stop: Angle::deg(90.0),
            },
        });
    }
    Config {
        period: machine.period,
        command_delay: machine.period * machine.command_delay as f64,
        axes,
        spindles,
        synchronisation: SyncMode::CommandSynchronised,
        sync_windows: Windows { warn: Length::um(20.0), stop: Length::um(300.0) },
        waits: Waits {
            ready: Time::s(1.0),
            at_speed: Time::s(5.0),
            oriented: Time::s(3.0),
            in_position: Time::s(2.0),
            tool_change: Time::s(30.0),
        },
        motion: motion::Limits { feed: UNLIMITED, rapid: UNLIMITED },
        phase_loss: None,
        overrides: kernel::Overrides::USUAL,
        pause: Pause::GoOn,
        probe_guard: true,
        learning: None,
        compensation: kernel::DeviationTables::default(),
        supervision: None,
    }
}

pub const SPINDLE_LIMITS: SpindleLimits = SpindleLimits {
    inertia: Inertia::kg_m2(0.010),
    peak_torque: Torque::n_m(42.0),
    continuous_torque: units::Torque::n_m(1e9),
    thermal_time: units::Time::s(60.0),
    peak_power: Power::w(15_000.0),
    friction: Torque::n_m(0.3),
    viscous_n_m_s_per_rad: 0.0012,
    max_speed: Spin::rpm(10_000.0),
    tapping_max: Spin::rpm(6000.0),
    margin: 0.85,
    torque_rise: Time::s(0.006),
};

pub const Z_LIMITS: AxisLimits = AxisLimits {
    travel: None,
    rapid_speed: CoordinateSpeed::linear(Speed::mm_per_min(50_000.0)),
    feed_speed: CoordinateSpeed::linear(Speed::mm_per_min(30_000.0)),
    accel: CoordinateAccel::new(15_000.0),
    rapid_jerk: CoordinateJerk::new(8e5),
    feed_jerk: CoordinateJerk::new(8e5),
};

/// A scale beside the motor's own encoder.
pub fn scale(resolution: Coordinate) -> AxisEncoder {
    AxisEncoder::Scale { resolution, motor_counts_per_rev: Some(1 << 20) }
}

/// A tap to make: M6 at 6000 rpm, 30 mm of stroke, unless told otherwise.
#[derive(Clone, Copy, Debug)]
pub struct TapOrder {
    pub lead_mm: f64,
    pub rpm: f64,
    pub from_mm: f64,
    pub surface_mm: f64,
    pub to_mm: f64,
    /// How much deeper the tap has room.
    pub room_mm: f64,
    pub dwell_s: f64,
    pub ramp_s: Option<f64>,
    pub start_angle: Option<Angle>,
    pub left: bool,
    /// Torque of the cut that the stroke is planned with.
    pub cut_n_m: f64,
}

pub const M6: TapOrder = TapOrder {
    lead_mm: 1.0,
    rpm: 6000.0,
    from_mm: -100.0,
    surface_mm: -102.0,
    to_mm: -130.0,
    room_mm: 3.0,
    dwell_s: 0.0,
    ramp_s: None,
    start_angle: None,
    left: false,
    cut_n_m: 0.0,
};

impl TapOrder {
    pub fn plan(&self) -> Box<TapPlan> {
        let request = StrokeRequest {
            revolutions: Angle::rev((self.to_mm - self.from_mm).abs() / self.lead_mm),
            spin: Spin::rpm(self.rpm),
            lead: Lead::mm_per_rev(self.lead_mm),
            cut: Torque::n_m(self.cut_n_m),
            spindle_accel: None,
            force_ramp: self.ramp_s.map(Time::s),
        };
        let stroke = request.plan(&SPINDLE_LIMITS, &Z_LIMITS).profile;
        let hand = if self.left { -1.0 } else { 1.0 };
        Box::new(TapPlan {
            axis: Axis::Z,
            spindle: 0,
            start: Position::xyz(0.0, 0.0, self.from_mm),
            bottom: Length::mm(self.to_mm),
            deepest: Length::mm(self.to_mm - self.room_mm),
            end: Length::mm(self.from_mm),
            surface: Length::mm(self.surface_mm),
            lead: Lead::mm_per_rev(-self.lead_mm * hand),
            spin: Spin::rpm(self.rpm * hand),
            return_spin: Spin::rpm(-self.rpm * hand),
            inward: stroke,
            dwell: Time::s(self.dwell_s),
            outward: stroke,
            start_angle: self.start_angle,
            turns_at_speed: true,
            limiting: TapLimiting {
                speed: Limiting::ProgrammedSpeed,
                ramp: Limiting::ProgrammedSpeed,
            },
            torque_expected: Torque::n_m(self.cut_n_m),
            torque_limit: None,
        })
    }
}

/// A straight move with constant jerk phases, slow enough for any axis here.
pub fn line(from: Position, to: Position, speed: f64, exact_stop: bool) -> StepKind {
    let path = Path::Line { from, to };
    let (length, jerk) = (path.length(), 1e5);
    // speed up and down in two halves of constant jerk each, t = 2·√(v/j)
    let half = (speed / jerk).sqrt();
    let ramp = speed * half; // way of one ramp of duration 2·half
    assert!(length >= 2.0 * ramp, "the test's move is too short for its speed");
    let mut profile = Profile::EMPTY;
    let (mut s, mut v, mut a) = (0.0, 0.0, 0.0);
    let cruise = (length - 2.0 * ramp) / speed;
    for (duration, j) in [(half, jerk), (half, -jerk), (cruise, 0.0), (half, -jerk), (half, jerk)] {
        let piece = Phase { duration, s, v, a, j };
        let end = piece.at(duration);
        (s, v, a) = (end.s, end.v, if j == 0.0 { 0.0 } else { end.a });
        assert!(profile.push(piece));
    }
    StepKind::Move(Box::new(Move {
        path,
        profile,
        rapid: true,
        per_revolution: false,
        exact_stop,
        floats: false,
        programmed: None,
    }))
}

/// A straight ramp of the spindle from one speed to another, at an acceleration the drive has
/// anywhere.
pub fn turn(from_rpm: f64, to_rpm: f64) -> StepKind {
    let (from, to) = (from_rpm / 60.0, to_rpm / 60.0);
    let a = 200.0 * (to - from).signum();
    let mut ramp = Profile::EMPTY;
    assert!(ramp.push(Phase { duration: (to - from) / a, s: 0.0, v: from, a, j: 0.0 }));
    let order = SpindleStep::Turn { spin: Spin::rpm(to_rpm), ramp: ramp.into() };
    StepKind::Spindle { spindle: 0, order }
}

pub fn await_speed() -> StepKind {
    StepKind::Spindle { spindle: 0, order: SpindleStep::AwaitSpeed }
}

/// Down to the R plane, tap, end.
pub fn tapping(order: &TapOrder) -> Vec<StepKind> {
    let start = Position::xyz(0.0, 0.0, order.from_mm);
    vec![line(Position::default(), start, 300.0, true), StepKind::Tap(order.plan()), StepKind::End]
}

pub struct Run {
    pub samples: Vec<Sample>,
    pub events: Vec<Event>,
    pub kernel: Kernel,
    pub seconds: f64,
}

/// Drive steps on a machine until the program is over, ten seconds at most.
pub fn run(machine: &sim::Config, control: &Config, steps: &[StepKind]) -> Run {
    let mut machine =
        SimulatedMachine::new(machine.clone()).expect("the test's machine can be built");
    run_on(&mut machine, control, steps, 40_000)
}

pub fn run_on(
    machine: &mut dyn Machine,
    control: &Config,
    steps: &[StepKind],
    ticks: usize,
) -> Run {
    run_kernel_on(Kernel::new(control.clone()), machine, steps, ticks)
}

pub fn run_kernel_on(
    kernel: Kernel,
    machine: &mut dyn Machine,
    steps: &[StepKind],
    ticks: usize,
) -> Run {
    run_ordered(kernel, machine, steps, ticks, &[])
}

/// With orders of the operator, by the tick before which they come.
pub fn run_ordered(
    mut kernel: Kernel,
    machine: &mut dyn Machine,
    steps: &[StepKind],
    ticks: usize,
    orders: &[(usize, kernel::Order)],
) -> Run {
    let step = |(op, kind): (u32, &StepKind)| Step { op, line: op + 1, kind: kind.clone() };
    let steps: Vec<Step> = (0..).zip(steps).map(step).collect();
    let mut waiting = steps.iter().peekable();
    let (mut samples, mut events) = (Vec::new(), Vec::new());
    let mut feedback = *machine.feedback();
    for tick in 0..ticks {
        for (_, order) in orders.iter().filter(|(at, _)| *at == tick) {
            kernel.order(*order);
        }
        while waiting.next_if(|step| kernel.push(step).is_ok()).is_some() {}
        let truth = machine.truth().copied();
        let command = kernel.tick(&feedback);
        samples.push(Sample { feedback, command, report: kernel.report(), truth });
        feedback = *machine.exchange(&command);
        while let Some(event) = kernel.next_event() {
            events.push(event);
        }
        if kernel.is_over() {
            break;
        }
    }
    let seconds = feedback.time.value();
    Run { samples, events, kernel, seconds }
}

impl Run {
    /// True distance of Z from the helix of a tap, µm, at each sample while it is synchronised and
    /// below the surface: from the moment the tap began, by the machine's truth.
    pub fn sync_errors_um(&self, order: &TapOrder) -> Vec<f64> {
        let lead = if order.left { order.lead_mm } else { -order.lead_mm };
        let first = self.samples.iter().find(|s| s.report.state == bus::State::TapIn);
        let Some(first) = first else { return Vec::new() };
        // the coupling runs through the R plane and the angle at which the spindle was held
        let theta0 = self.anchor(first);
        self.synchronised()
            .filter(|s| s.axis(2).value() <= order.surface_mm)
            .map(|s| {
                (s.axis(2).value() - order.from_mm - lead * (s.spindle(0).value() - theta0)) * 1e3
            })
            .collect()
    }

    /// The same where no sample is known.
    pub fn theta0(&self) -> f64 {
        let first = self.samples.iter().find(|s| s.report.state == bus::State::TapIn);
        self.anchor(first.expect("a tap began"))
    }

    /// The commanded angle at the R plane: the last one before the tap went in.
    fn anchor(&self, first: &Sample) -> f64 {
        let index =
            self.samples.iter().position(|s| core::ptr::eq(s, first)).expect("it is one of them");
        self.samples[index - 1].command.spindles[0].angle.value()
    }

    pub fn synchronised(&self) -> impl Iterator<Item = &Sample> {
        use bus::State::{TapBottom, TapIn, TapOut};
        self.samples.iter().filter(|s| matches!(s.report.state, TapIn | TapBottom | TapOut))
    }

    /// Deepest true position of Z.
    pub fn deepest_mm(&self) -> f64 {
        self.samples.iter().map(|s| s.axis(2).value()).fold(f64::MAX, f64::min)
    }
}

pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| most.max(v.abs()))
}

pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
