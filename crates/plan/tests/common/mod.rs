//! The tapping-centre of docs and machine file, as the planner sees it, and words to write programs
//! with.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part
use canon::{
    Axis, Feed, Flute, Holder, Hole, Op, OpKind, Position, Span, SpindleOrder, Tap, TapTool, Tool,
    ToolKind, ToolLibrary,
};
use plan::Step;
use plan::{
    AxisLimits, MachineLimits, Options, Planner, SpindleLimits, Start, Tapping, ToolChange,
};
use units::{
    Angle, Coordinate, CoordinateAccel, CoordinateJerk, CoordinateSpeed, Inertia, Lead, Length,
    Power, Speed, Spin, Stiffness, Time, Torque,
};

pub fn mm(x: f64) -> Length {
    Length::mm(x)
}

pub const SPINDLE: SpindleLimits = SpindleLimits {
    inertia: Inertia::kg_m2(0.010),
    peak_torque: Torque::n_m(42.0),
    continuous_torque: units::Torque::n_m(1e9),
    thermal_time: units::Time::s(60.0),
    peak_power: Power::w(15_000.0),
    friction: Torque::n_m(0.3),
    viscous_n_m_s_per_rad: 0.0012,
    max_speed: Spin::rpm(10_000.0),
    tapping_max: Spin::rpm(6000.0),
    margin: 0.9,
    torque_rise: Time::s(0.005),
};

pub fn axis(low: f64, high: f64, accel_m_per_s2: f64) -> AxisLimits {
    AxisLimits {
        travel: Some((Coordinate::new(low), Coordinate::new(high))),
        rapid_speed: CoordinateSpeed::linear(Speed::mm_per_min(50_000.0)),
        feed_speed: CoordinateSpeed::linear(Speed::mm_per_min(50_000.0)),
        accel: CoordinateAccel::new(accel_m_per_s2 * 1e3),
        rapid_jerk: CoordinateJerk::new(1e6),
        feed_jerk: CoordinateJerk::new(5e5),
    }
}

pub fn machine() -> MachineLimits {
    let mut axes = [None; 9];
    axes[0] = Some(axis(-250.0, 250.0, 10.0));
    axes[1] = Some(axis(-200.0, 200.0, 10.0));
    axes[2] = Some(axis(-300.0, 0.0, 15.0));
    MachineLimits {
        axes,
        spindles: vec![SPINDLE],
        tool_change: ToolChange {
            z: Some(Length::ZERO),
            x: None,
            y: None,
            pockets: 0,
            time: Time::s(1.5),
        },
        settling: Time::ZERO,
        tapping: Tapping::along_z(SPINDLE.margin),
        joining: plan::Joining::EXACT,
        signals: None,
    }
}

pub const OPTIONS: Options = Options {
    force_ramp: None,
    cutting_pressure_n_per_mm2: 3900.0,
    taps: plan::Unsynchronised {
        method: plan::TapMethod::Synchronised,
        dwell: plan::DwellCheck::Refuse,
        drive: None,
    },
};

/// A drill that needs no pecks.
pub fn drill(number: u32, diameter: f64, length: f64) -> Tool {
    let kind = ToolKind::Drill { point_angle: Angle::deg(118.0) };
    let body = canon::Body { depth_without_pecks: Some(mm(100.0)), ..canon::Body::default() };
    Tool { body, ..tool(number, diameter, length, kind) }
}

pub fn tap_tool(number: u32, designation: &str, diameter: f64, lead: f64) -> Tool {
    let kind = ToolKind::Tap(TapTool {
        designation: designation.into(),
        lead: Lead::mm_per_rev(lead),
        chamfer_pitches: 2.5,
        thread_length: mm(32.0),
        flute: Flute::SpiralFlute,
        oversize: Length::um(40.0),
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    });
    tool(number, diameter, 100.0, kind)
}

pub fn tool(number: u32, diameter: f64, length: f64, kind: ToolKind) -> Tool {
    let (diameter, length) = (mm(diameter), mm(length));
    Tool {
        number,
        pocket: number,
        length,
        diameter,
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    }
}

/// T1 drill 5.0, T2 tap M6×1, T3 left-hand M6×1, T4 drill 6.8, T5 tap M8×1.25, T6 drill 5.6, T7
/// drill 6.5.
pub fn tools() -> ToolLibrary {
    ToolLibrary::new([
        drill(1, 5.0, 120.0),
        tap_tool(2, "M6x1", 6.0, 1.0),
        tap_tool(3, "M6x1 LH", 6.0, -1.0),
        drill(4, 6.8, 120.0),
        tap_tool(5, "M8x1.25", 8.0, 1.25),
        drill(6, 5.6, 120.0),
        drill(7, 6.5, 120.0),
    ])
}

/// Work's zero: the stock's top lies here for a tool of length 0.
pub const TOP: f64 = -250.0;

/// A tap of the tool of length 100 mm, in work coordinates: from `r` above the top to `z` below it.
pub fn tap(x: f64, y: f64, r: f64, z: f64, lead: f64, rpm: f64) -> Tap {
    Tap {
        axis: Axis::Z,
        start: Position::xyz(x, y, TOP + 100.0 + r),
        bottom: mm(TOP + 100.0 + z),
        surface: mm(TOP + 100.0),
        zero: mm(TOP + 100.0),
        own_zero: None,
        lead: Lead::mm_per_rev(lead),
        spin: Spin::rpm(rpm),
        return_spin: Spin::rpm(rpm),
        return_acceleration: canon::ReturnAcceleration::AsSet,
        dwell: Time::ZERO,
        start_angle: None,
        peck: None,
    }
}

/// A hole of the drill of length 120 mm.
pub fn hole(x: f64, y: f64, z: f64) -> OpKind {
    OpKind::Hole(Hole {
        axis: Axis::Z,
        at: Position::xyz(x, y, TOP + 120.0 + 2.0),
        bottom: mm(TOP + 120.0 + z),
        surface: mm(TOP + 120.0),
        zero: mm(TOP + 120.0),
        own_zero: None,
    })
}

pub fn rapid(x: f64, y: f64, z: f64) -> OpKind {
    OpKind::Rapid { to: Position::xyz(x, y, z) }
}

pub fn line(x: f64, y: f64, z: f64, mm_per_min: f64) -> OpKind {
    OpKind::Line { to: Position::xyz(x, y, z), feed: Feed::PerTime(Speed::mm_per_min(mm_per_min)) }
}

pub fn turn(rpm: f64) -> OpKind {
    OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(Spin::rpm(rpm)) }
}

pub fn change(number: u32) -> OpKind {
    OpKind::ChangeTool { number }
}

/// Ops in a row, one a line, counted from 1.
pub fn program(kinds: impl IntoIterator<Item = OpKind>) -> Vec<Op> {
    let place = |line| Span { file: 0, line, start: 0, end: 0 };
    (1..).zip(kinds).map(|(line, kind)| Op { span: place(line), kind }).collect()
}

pub fn planner_at(position: Position, tool: u32) -> Planner {
    Planner::new(machine(), tools(), OPTIONS, Start { position, tool })
}

/// All steps of a program on another machine, from machine zero.
pub fn steps_on(limits: MachineLimits, kinds: impl IntoIterator<Item = OpKind>) -> Vec<Step> {
    steps_of(Planner::new(limits, tools(), OPTIONS, Start::default()), kinds)
}

/// All steps of a program from machine zero.
pub fn steps(kinds: impl IntoIterator<Item = OpKind>) -> Vec<Step> {
    steps_of(planner_at(Position::default(), 0), kinds)
}

pub fn steps_of(mut planner: Planner, kinds: impl IntoIterator<Item = OpKind>) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut emit = |step| steps.push(step);
    for (index, op) in (0..).zip(&program(kinds)) {
        planner.push(index, op, &mut emit);
    }
    planner.finish(&mut emit);
    steps
}

/// All findings of a program, one a line, as text.
pub fn findings(kinds: impl IntoIterator<Item = OpKind>) -> String {
    findings_of(planner_at(Position::default(), 0), kinds)
}

pub fn findings_of(planner: Planner, kinds: impl IntoIterator<Item = OpKind>) -> String {
    let found = plan::preflight(planner, &program(kinds)).findings;
    let line = |d: &diag::Diagnostic| {
        let help = d.help.as_ref().map_or(String::new(), |h| format!("\n    help: {h}"));
        format!("{} {:?} line {}: {}{help}\n", d.code, d.severity, d.span.line, d.message)
    };
    found.iter().map(line).collect()
}
