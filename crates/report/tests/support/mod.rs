//! A plate in a made-up world: drilled and tapped holes with a plausible spindle, for looking at
//! the page and for testing it. Nothing here is simulated: every curve is a formula with a known
//! answer.
//!
//! ```text
//!   v(θ) = min(run-up, run-down)   dv/dt = 0.85·min(M, P/2πn)/(2πJ)   e = friction + ripple + hook at the bottom
//! ```
#![allow(dead_code, unreachable_pub)] // a module of tests and examples: each takes its part
use bus::{Sample, State, Truth};
use canon::{Axis, Op, OpKind, Position, Span, Tap, Tool, ToolKind, ToolLibrary};
use report::{Alarm, Limits, Note, Origin, Recorder, Run};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use units::{Angle, Coordinate, Force, Lead, Length, Power, Spin, Time, Torque};
use verify::{
    Feature, FeatureKind, Gauge, Hand, Hole, ProfilePoint, Thread, ThreadClass, Tolerances, Verdict,
};

const PERIOD: f64 = 250e-6;
const INERTIA: f64 = 0.010;
const PEAK: f64 = 42.0;
const POWER: f64 = 15_000.0;
/// R plane over the surface, and depth below it.
pub const CLEARANCE: f64 = 3.0;
pub const DEPTH: f64 = 15.0;
/// Surface, as machine coordinate of the axis with the tap in the spindle.
const SURFACE: f64 = -200.0;
const TAP_LENGTH: f64 = 92.0;
const DRILL_LENGTH: f64 = 110.0;

/// What happens in the made-up world.
#[derive(Clone, Copy, PartialEq)]
pub enum Mishap {
    None,
    /// The n-th thread is cut with a drive at its limit.
    Saturated(usize),
    /// The n-th tap faults on its way out and the run stops there.
    Faulted(usize),
}

/// A finished world: what the report is made from.
pub struct World {
    pub run: Run,
    pub recorder: Recorder,
    pub features: Vec<Feature>,
}

pub fn tools() -> ToolLibrary {
    let tool = |number, length, diameter, kind, description: &str| Tool {
        number,
        pocket: number,
        length: Length::mm(length),
        diameter: Length::mm(diameter),
        kind,
        description: description.into(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    ToolLibrary::new([
        tool(
            2,
            DRILL_LENGTH,
            5.0,
            ToolKind::Drill { point_angle: Angle::deg(118.0) },
            "drill 5.0 HSS-E",
        ),
        tool(3, TAP_LENGTH, 6.0, ToolKind::Other, "tap M6 6H spiral flute"),
    ])
}

pub fn run(program: &str) -> Run {
    Run {
        version: "0.1.0".into(),
        program: program.into(),
        machine: "tapping-center".into(),
        dialect: "linuxcnc".into(),
        material: "C45".into(),
        seed: 1,
        tools: tools(),
        origin: Some(Origin {
            name: "G54".into(),
            at: Position::xyz(150.0, 100.0, SURFACE - TAP_LENGTH),
        }),
        cycle_time: Time::ZERO,
        ended: true,
        alarms: Vec::new(),
        notes: Vec::new(),
        tolerances: Tolerances::default(),
        limits: Limits {
            torque: Limits::torque_curve(Torque::n_m(PEAK), Power::w(POWER), Spin::rpm(10_000.0)),
            sync_warn: Length::um(25.0),
            sync_stop: Length::um(100.0),
        },
        limiting: BTreeMap::new(),
        stops: Vec::new(),
        motion: None,
        listing: Vec::new(),
    }
}

/// A machine that goes from place to place and feeds its recorder.
struct Machine {
    recorder: Recorder,
    /// Everything the recorder was given, if that is wanted.
    given: Given,
    now: f64,
    at: [f64; 3],
    theta: f64,
    tool: Option<u32>,
    op: u32,
    line: u32,
}

impl Machine {
    fn sample(&self, state: State) -> Sample {
        let mut sample = Sample::default();
        sample.feedback.time = Time::s(self.now);
        sample.feedback.tool = self.tool;
        sample.report.state = state;
        sample.report.op = self.op;
        sample.report.line = self.line;
        let mut truth = Truth::default();
        for (axis, value) in self.at.into_iter().enumerate() {
            sample.feedback.axes[axis].position = Coordinate::new(value);
            sample.command.axes[axis].position = Coordinate::new(value);
            truth.axes[axis] = Coordinate::new(value);
        }
        sample.feedback.spindles[0].angle = Angle::rev(self.theta);
        sample.command.spindles[0].angle = Angle::rev(self.theta);
        truth.spindles[0] = Angle::rev(self.theta);
        sample.truth = Some(truth);
        sample
    }

    fn give(&mut self, sample: &Sample) {
        self.recorder.sample(sample);
        if let Some((_, samples)) = &mut self.given {
            samples.push(*sample);
        }
        self.now += PERIOD;
    }

    fn announce(&mut self, op: &Op) {
        self.recorder.op(self.op, op);
        if let Some((ops, _)) = &mut self.given {
            ops.push((self.op, op.clone()));
        }
    }

    fn wait(&mut self, state: State, seconds: f64) {
        for _ in 0..(seconds / PERIOD) as usize {
            let sample = self.sample(state);
            self.give(&sample);
        }
    }

    /// Along a line, smoothly, with a spindle that turns or not.
    fn go(&mut self, state: State, to: [f64; 3], speed: f64, rpm: f64) {
        let from = self.at;
        let distance = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
        let periods = ((distance / speed + 0.05) / PERIOD) as usize;
        for k in 1..=periods {
            let u = k as f64 / periods as f64;
            let s = u * u * (3.0 - 2.0 * u);
            self.at = std::array::from_fn(|i| from[i] + (to[i] - from[i]) * s);
            self.theta += rpm / 60.0 * PERIOD;
            let mut sample = self.sample(state);
            if let Some(truth) = &mut sample.truth {
                truth.spins[0] = Spin::rpm(rpm);
            }
            self.give(&sample);
        }
    }
}

/// Speed (rev/s) over turns (rev) of a stroke from rest to rest under the power curve.
fn speeds(turns: f64) -> impl Fn(f64) -> f64 {
    let steps = 4000;
    let step = turns / f64::from(steps);
    let mut run_up = vec![0.0f64];
    for i in 0..steps as usize {
        let v = run_up[i];
        let torque = PEAK.min(POWER / (TAU * v.max(1e-3)));
        let accel = 0.85 * torque / (TAU * INERTIA);
        run_up.push((v * v + 2.0 * accel * step).sqrt().min(100.0));
    }
    let at = move |u: f64| {
        let place = u.clamp(0.0, turns) / step;
        let i = (place as usize).min(steps as usize - 1);
        // v² is straight over the turns at constant acceleration
        let (a, b) = (run_up[i].powi(2), run_up[i + 1].powi(2));
        (a + (b - a) * (place - i as f64)).sqrt()
    };
    move |u: f64| at(u).min(at(turns - u)).max(0.4)
}

/// The axis' error, µm, plus is deeper, after some turns.
pub fn error_um(u: f64, turns: f64, out: bool, saturated: bool) -> f64 {
    let ripple = 0.5 * (u * TAU * 3.0).sin();
    let hook = 5.0 * (-(turns - u) / 0.25).exp();
    let bulge = if saturated { 55.0 * (-((u / turns - 0.55) / 0.16).powi(2)).exp() } else { 0.0 };
    if out { 1.2 + ripple + hook + 0.4 * bulge } else { -1.4 + ripple - 0.3 * hook - bulge }
}

fn tap_op(x: f64, y: f64) -> Tap {
    Tap {
        axis: Axis::Z,
        start: Position::xyz(x, y, SURFACE + CLEARANCE),
        bottom: Length::mm(SURFACE - DEPTH),
        surface: Length::mm(SURFACE),
        zero: Length::mm(SURFACE),
        own_zero: None,
        lead: Lead::mm_per_rev(1.0),
        spin: Spin::rpm(6000.0),
        return_spin: Spin::rpm(6000.0),
        return_acceleration: canon::ReturnAcceleration::AsSet,
        dwell: Time::ZERO,
        start_angle: None,
        peck: None,
    }
}

fn stroke(machine: &mut Machine, x: f64, y: f64, out: bool, saturated: bool, until: f64) {
    let turns = CLEARANCE + DEPTH;
    let speed = speeds(turns);
    let theta0 = machine.theta - if out { turns } else { 0.0 };
    let (mut done, mut before) = (0.0, 0.0);
    while done < turns * until {
        let v = speed(done);
        done = (done + v * PERIOD).min(turns);
        let u = if out { turns - done } else { done };
        machine.theta = theta0 + u;
        machine.at = [x, y, SURFACE + CLEARANCE - u];
        let mut sample = machine.sample(if out { State::TapOut } else { State::TapIn });
        let cutting = if !out && u > CLEARANCE {
            1.7 * ((u - CLEARANCE) / 2.5).min(1.0) + 0.02 * u
        } else {
            0.0
        };
        let cutting = if out && u > CLEARANCE { -0.3 } else { cutting };
        let sense = if out { -1.0 } else { 1.0 };
        let accel = (v - before) / PERIOD;
        before = v;
        let limit = PEAK.min(POWER / (TAU * v.max(1.0)));
        let wanted = accel * TAU * INERTIA * sense + cutting;
        let at_limit = saturated && wanted.abs() > 0.7 * limit;
        if let Some(truth) = &mut sample.truth {
            truth.axes[2] -= Coordinate::linear(Length::um(error_um(u, turns, out, saturated)));
            truth.spins[0] = Spin::rev_per_s(v * sense);
            let factor = if at_limit { 1.0 / 0.85 } else { 1.0 };
            truth.spindle_torques[0] = Torque::n_m((wanted * factor).clamp(-limit, limit));
            truth.cutting_torque = Torque::n_m(cutting);
            truth.cutting_force = Force::n(-30.0 * sense);
        }
        sample.feedback.spindles[0].saturated = at_limit;
        machine.give(&sample);
    }
}

/// In the material.
fn contact() -> verify::Contact {
    verify::Contact { reach: Some(Length::mm(10.0)), ..verify::Contact::default() }
}

pub fn hole(op: u32, line: u32, x: f64, y: f64) -> Feature {
    let hole = Hole {
        x: Length::mm(x),
        y: Length::mm(y),
        depth: Length::mm(19.003),
        full_diameter_depth: Length::mm(17.5),
        depth_error: Length::um(3.0),
        position_error: Length::um(2.0),
        diameter: Length::mm(5.0),
        chip_removal: false,
    };
    let kind = FeatureKind::Hole(hole);
    let (time, duration) = (Time::s(1.0), Time::s(0.8));
    Feature {
        op,
        line,
        tool: Some(2),
        time,
        duration,
        verdict: Verdict::Pass,
        contact: contact(),
        kind,
    }
}

pub fn thread(op: u32, line: u32, x: f64, y: f64, bad: bool) -> Feature {
    let turns = CLEARANCE + DEPTH;
    let profile: Vec<_> = (0..=150)
        .map(|i| {
            let depth = f64::from(i) * 0.1;
            let e = |out| error_um(depth + CLEARANCE, turns, out, bad);
            let around = |e: f64| Some([Length::um(e - 0.4), Length::um(e + 0.4)]);
            ProfilePoint {
                tip_depth: Length::mm(depth),
                inward: around(e(false)),
                outward: around(e(true)),
                widening: Some(Length::um((e(true) - e(false)).abs())),
            }
        })
        .collect();
    let ends = profile.iter().flat_map(|p| [p.inward, p.outward]).flatten().flatten();
    let sync_error_max = ends.map(Length::abs).fold(Length::ZERO, Length::max);
    let widening = profile.iter().filter_map(|p| p.widening).fold(Length::ZERO, Length::max);
    let margin = Length::um(118.0) - widening * 3f64.sqrt();
    let verdict = if bad {
        let reason = format!(
            "the groove is {:.0} µm wider than 6H allows: the No-go gauge enters",
            -margin.in_um()
        );
        Verdict::Fail { reason }
    } else {
        Verdict::Pass
    };
    let thread = Thread {
        x: Length::mm(x),
        y: Length::mm(y),
        position_error: Length::um(2.0),
        size: "M6x1".into(),
        hand: Hand::Right,
        lead: Lead::mm_per_rev(1.0),
        depth: Length::mm(DEPTH - 2.5),
        tip_depth: Length::mm(DEPTH + 0.0023),
        depth_error: Length::um(2.3),
        spin_max: Spin::rpm(5210.0),
        sync_error_max,
        sync_error_rms: sync_error_max * 0.3,
        sync_error_depth: Length::mm(if bad { 6.9 } else { 15.0 }),
        lead_error: Length::um(1.1),
        groove_widening: widening,
        widest_depth: Length::mm(12.4),
        pitch_diameter: Length::mm(5.35 + 0.032) + widening * 3f64.sqrt(),
        virtual_pitch_diameter: Length::mm(5.382),
        minor_diameter: Length::mm(5.0),
        hole: verify::KnownHole::Seen,
        class: (!bad).then_some(ThreadClass::H6),
        class_asked: ThreadClass::H6,
        margin,
        limiting_gauge: if bad { Gauge::NoGo } else { Gauge::Go },
        go_margin: Length::um(32.0),
        no_go_margin: margin,
        minor_margin: Length::um(83.0),
        pitch_diameter_tolerance: Length::um(150.0),
        torque_max: Some(Torque::n_m(2.06)),
        torque_in: Some(Torque::n_m(2.06 + 0.01 * f64::from(line % 7))),
        torque_out: Some(Torque::n_m(0.35)),
        torque_expected: Some(Torque::n_m(1.73)),
        axial_force_max: Some(Force::n(30.0)),
        start_angle: Some(Angle::deg(12.0)),
        chip_removal: false,
        recovered: false,
        profile,
    };
    let kind = FeatureKind::Thread(Box::new(thread));
    let (time, duration) = (Time::s(9.0), Time::s(0.5));
    Feature { op, line, tool: Some(3), time, duration, verdict, contact: contact(), kind }
}

/// Drills and taps a grid of columns × rows holes.
pub fn plate(columns: usize, rows: usize, mishap: Mishap) -> World {
    cut(columns, rows, mishap, None).0
}

/// Ops, with their indices, and samples of a good plate.
pub fn samples(columns: usize, rows: usize) -> (Vec<(u32, Op)>, Vec<Sample>) {
    cut(columns, rows, Mishap::None, Some(Default::default())).1.expect("they were asked for")
}

type Given = Option<(Vec<(u32, Op)>, Vec<Sample>)>;

fn cut(columns: usize, rows: usize, mishap: Mishap, given: Given) -> (World, Given) {
    let recorder = Recorder::new(&tools());
    let mut machine = Machine {
        recorder,
        given,
        now: 0.0,
        at: [0.0, 0.0, -20.0],
        theta: 0.0,
        tool: Some(2),
        op: 0,
        line: 12,
    };
    let mut run = run("plate-12xM6.ngc");
    let mut features = Vec::new();
    let place = |i: usize| {
        let (column, row) = (i % columns, i / columns);
        let column = if row % 2 == 1 { columns - 1 - column } else { column };
        (150.0 + 15.0 + 30.0 * column as f64, 100.0 + 15.0 + 25.0 * row as f64)
    };
    let drill_surface = SURFACE + DRILL_LENGTH - TAP_LENGTH;
    machine.wait(State::SpindleWait, 0.3);
    for i in 0..columns * rows {
        let (x, y) = place(i);
        machine.op += 1;
        machine.go(State::Rapid, [x, y, drill_surface + CLEARANCE + 20.0], 600.0, 3000.0);
        machine.go(State::Rapid, [x, y, drill_surface + CLEARANCE], 600.0, 3000.0);
        machine.go(State::Feed, [x, y, drill_surface - 19.0], 40.0, 3000.0);
        machine.go(State::Rapid, [x, y, drill_surface + CLEARANCE], 600.0, 3000.0);
        features.push(hole(machine.op, 12 + i as u32, x, y));
    }
    machine.go(State::Rapid, [0.0, 0.0, -20.0], 600.0, 0.0);
    machine.tool = None;
    machine.wait(State::ToolChange, 1.8);
    machine.tool = Some(3);
    for i in 0..columns * rows {
        let (x, y) = place(i);
        machine.op += 1;
        machine.line = 30 + i as u32;
        machine.go(State::Rapid, [x, y, SURFACE + CLEARANCE], 600.0, 0.0);
        machine.wait(State::Settle, 0.02);
        let kind = OpKind::Tap(tap_op(x, y));
        machine.announce(&Op { span: Span::default(), kind });
        let bad = mishap == Mishap::Saturated(i);
        run.limiting.insert(machine.op, "spindle power above 3410 rpm (15 kW); 6000 rpm are not reached in 18 turns, 5210 rpm are".into());
        stroke(&mut machine, x, y, false, bad, 1.0);
        if mishap == Mishap::Faulted(i) {
            stroke(&mut machine, x, y, true, false, 0.4);
            machine.wait(State::Faulted, 0.2);
            run.ended = false;
            run.alarms.push(Alarm {
                number: 301,
                text: "The tap left its coupling by 104 µm in the material (stop limit 100 µm)."
                    .into(),
                remedy: Some("Drive the tap out with `leadscrew recover`.".into()),
                line: machine.line,
                time: Time::s(machine.now),
            });
            features.push(thread(machine.op, machine.line, x, y, true));
            break;
        }
        stroke(&mut machine, x, y, true, bad, 1.0);
        features.push(thread(machine.op, machine.line, x, y, bad));
    }
    if run.ended {
        machine.go(State::Rapid, [0.0, 0.0, -20.0], 600.0, 0.0);
        machine.wait(State::Ended, 0.1);
    }
    run.cycle_time = Time::s(machine.now);
    run.notes.push(Note {
        warning: false,
        text: "Holes of T3 are drilled by T2 in this program; nothing was assumed.".into(),
        line: 0,
    });
    (World { run, recorder: machine.recorder, features }, machine.given)
}
