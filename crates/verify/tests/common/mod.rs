//! Synthetic records: samples made from closed forms, as a perfect or a wrong machine would leave
//! them. Nothing here runs a kernel or a simulator.
//!
//! The tap of these records starts 2 mm above the surface at axis Z −48, goes 14 mm below it and
//! returns; the spindle runs along a raised cosine, so that it starts, turns back and ends at rest.
#![allow(dead_code, unreachable_pub)] // each test file uses its part
use bus::{Sample, State, Truth};
use canon::{
    Axis, Flute, Holder, Hole, Op, OpKind, Position, Span, Tap, TapTool, Tool, ToolKind,
    ToolLibrary,
};
use units::{Angle, Coordinate, Force, Lead, Length, Spin, Stiffness, Time, Torque};
use verify::{Config, Feature, FeatureKind, Judge, Stock, Thread};

/// Servo period of the records, s.
pub const PERIOD_S: f64 = 250e-6;
/// Tool length of all tools, mm.
pub const LENGTH_MM: f64 = 100.0;
/// Coordinate of axis Z with the tip on the surface, mm.
pub const SURFACE_MM: f64 = -50.0;

/// A tap of this designation with nothing oversize.
pub fn tap_tool(number: u32, designation: &str, lead_mm: f64) -> Tool {
    Tool {
        number,
        pocket: number,
        length: Length::mm(LENGTH_MM),
        diameter: Length::mm(6.0),
        kind: ToolKind::Tap(TapTool {
            designation: designation.into(),
            lead: Lead::mm_per_rev(lead_mm),
            chamfer_pitches: 2.5,
            thread_length: Length::mm(25.0),
            flute: Flute::SpiralFlute,
            oversize: Length::ZERO,
            holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
            max_torque: None,
        }),
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}

/// A 118° drill.
pub fn drill(number: u32, diameter_mm: f64) -> Tool {
    Tool {
        diameter: Length::mm(diameter_mm),
        kind: ToolKind::Drill { point_angle: Angle::deg(118.0) },
        ..tap_tool(number, "M6", 1.0)
    }
}

/// T1 a 5 mm drill, T2 M6, T3 M8 left-hand, T4 1/4-20 UNC, T5 an M6 tap with another name in the
/// table.
pub fn tools() -> ToolLibrary {
    ToolLibrary::new([
        drill(1, 5.0),
        tap_tool(2, "M6x1", 1.0),
        tap_tool(3, "M8x1.25-LH", -1.25),
        tap_tool(4, "1/4-20 UNC", 1.27),
        tap_tool(5, "six by one", 1.0),
    ])
}

/// A block of 400 × 300 × 40 mm whose top is the work's zero, under the tools above.
pub fn stock() -> Stock {
    stock_at(SURFACE_MM - LENGTH_MM, SURFACE_MM - LENGTH_MM)
}

/// The same with its top and the work's zero at these coordinates of the tip.
pub fn stock_at(top_mm: f64, zero_mm: f64) -> Stock {
    let mm = |v: [f64; 3]| v.map(Length::mm);
    Stock {
        from: mm([-200.0, -150.0, top_mm - 40.0]),
        to: mm([200.0, 150.0, top_mm]),
        zero: mm([0.0, 0.0, zero_mm]),
    }
}

/// These tools and that stock, nothing special.
pub fn config(tools: ToolLibrary) -> Config {
    Config { stock: Some(stock()), ..Config::new(tools) }
}

/// What a record is made of.
#[derive(Clone, Debug)]
pub struct Record {
    pub tool: u32,
    /// Of the block; negative is left-hand.
    pub lead_mm: f64,
    pub depth_mm: f64,
    pub programmed_mm: f64,
    pub rpm: f64,
    /// Spindle angle at the start, rev.
    pub start_rev: f64,
    pub at_mm: [f64; 2],
    pub start_angle: Option<Angle>,
    pub torque_n_m: f64,
}

impl Record {
    pub fn new(tool: u32, lead_mm: f64) -> Self {
        Self {
            tool,
            lead_mm,
            depth_mm: 14.0,
            programmed_mm: 14.0,
            rpm: 3000.0,
            start_rev: 1234.25,
            at_mm: [30.0, 20.0],
            start_angle: None,
            torque_n_m: 1.7,
        }
    }

    pub fn tap(&self) -> Tap {
        let [x, y] = self.at_mm;
        Tap {
            axis: Axis::Z,
            start: Position::xyz(x, y, SURFACE_MM + 2.0),
            bottom: Length::mm(SURFACE_MM - self.programmed_mm),
            surface: Length::mm(SURFACE_MM),
            zero: Length::mm(SURFACE_MM),
            own_zero: None,
            lead: Lead::mm_per_rev(self.lead_mm),
            spin: Spin::rpm(self.rpm),
            return_spin: Spin::rpm(self.rpm),
            return_acceleration: canon::ReturnAcceleration::AsSet,
            dwell: Time::ZERO,
            start_angle: self.start_angle,
            peck: None,
        }
    }

    pub fn op(&self, line: u32) -> Op {
        Op { span: span(line), kind: OpKind::Tap(self.tap()) }
    }

    /// Samples of op `index`. `error_mm(depth, outward)` is what the edges stand too deep when the
    /// ideal helix stands at `depth` (mm below the surface).
    pub fn samples(&self, index: u32, error_mm: impl Fn(f64, bool) -> f64) -> Vec<Sample> {
        let stroke_mm = self.depth_mm + 2.0;
        let turns = stroke_mm / self.lead_mm; // signed: left-hand turns backwards
        // raised cosine of peak speed rpm: turns/2·ω = n → ω = 2·n/turns
        let omega = 2.0 * (self.rpm / 60.0) / turns.abs();
        let count = (std::f64::consts::TAU / omega / PERIOD_S).ceil() as usize;
        (0..=count)
            .map(|k| {
                let phase = (k as f64 / count as f64) * std::f64::consts::TAU;
                let turned = turns * (1.0 - phase.cos()) / 2.0;
                let outward = phase > std::f64::consts::PI;
                let ideal_mm = turned * self.lead_mm - 2.0;
                let z_mm = SURFACE_MM - ideal_mm - error_mm(ideal_mm, outward);
                self.sample(index, k, turned, z_mm, outward)
            })
            .collect()
    }

    fn sample(&self, index: u32, k: usize, turned: f64, z_mm: f64, outward: bool) -> Sample {
        let mut sample = Sample::default();
        let truth = Truth {
            axes: axes(self.at_mm, z_mm),
            spindles: [Angle::rev(self.start_rev + turned), Angle::ZERO],
            spins: [Spin::rpm(self.rpm), Spin::ZERO],
            cutting_torque: Torque::n_m(self.torque_n_m),
            cutting_force: Force::n(-40.0),
            ..Truth::default()
        };
        sample.feedback.time = Time::s(k as f64 * PERIOD_S);
        sample.feedback.tool = Some(self.tool);
        sample.report.op = index;
        sample.report.state = if outward { State::TapOut } else { State::TapIn };
        sample.truth = Some(truth);
        sample
    }
}

fn axes([x, y]: [f64; 2], z: f64) -> [Coordinate; bus::AXES] {
    let mut axes = [Coordinate::ZERO; bus::AXES];
    axes[0] = Coordinate::new(x);
    axes[1] = Coordinate::new(y);
    axes[2] = Coordinate::new(z);
    axes
}

pub fn span(line: u32) -> Span {
    Span { line, ..Span::default() }
}

/// Run one record through a judge.
pub fn judge_with(config: Config, record: &Record, error_mm: impl Fn(f64, bool) -> f64) -> Feature {
    let mut judge = Judge::new(config);
    judge.op(0, &record.op(10));
    for sample in record.samples(0, error_mm) {
        judge.sample(&sample);
    }
    let mut features = judge.finish();
    assert_eq!(features.len(), 1);
    features.remove(0)
}

/// The same with the tools above and nothing special.
pub fn judge(record: &Record, error_mm: impl Fn(f64, bool) -> f64) -> Feature {
    judge_with(config(tools()), record, error_mm)
}

pub fn thread(feature: &Feature) -> &Thread {
    match &feature.kind {
        FeatureKind::Thread(thread) => thread,
        other => panic!("expected a thread, found {other:?}"),
    }
}

/// What a drilling cycle orders at X30 Y20: a Hole op, then the moves of its block.
pub fn hole_ops(line: u32, at_mm: [f64; 2], depth_mm: f64) -> [Op; 3] {
    let [x, y] = at_mm;
    let at = Position::xyz(x, y, SURFACE_MM + 2.0);
    let bottom = Length::mm(SURFACE_MM - depth_mm);
    let surface = Length::mm(SURFACE_MM);
    let hole = Hole { axis: Axis::Z, at, bottom, surface, zero: surface, own_zero: None };
    let kinds = [
        OpKind::Hole(hole),
        OpKind::Rapid { to: at.with(Axis::Z, Coordinate::linear(bottom)) },
        OpKind::Rapid { to: at },
    ];
    kinds.map(|kind| Op { span: span(line), kind })
}

/// A drill that goes from 2 mm above the surface to `depth_mm` and back, at 1 mm per 25 samples.
pub fn drilling(first_op: u32, tool: u32, at_mm: [f64; 2], depth_mm: f64) -> Vec<Sample> {
    let steps = ((depth_mm + 2.0) * 25.0).ceil() as usize;
    (0..=2 * steps)
        .map(|k| {
            let part = 1.0 - (k as f64 / steps as f64 - 1.0).abs();
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(k as f64 * PERIOD_S);
            sample.feedback.tool = Some(tool);
            sample.report.op = first_op + if k <= steps { 1 } else { 2 };
            let z_mm = SURFACE_MM + 2.0 - part * (depth_mm + 2.0);
            let torque = if z_mm < SURFACE_MM { Torque::n_m(1.2) } else { Torque::ZERO };
            sample.truth =
                Some(Truth { axes: axes(at_mm, z_mm), cutting_torque: torque, ..Truth::default() });
            sample
        })
        .collect()
}
