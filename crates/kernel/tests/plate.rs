//! A plate as the planner orders it: tool changes, rapids over three axes, drilling, rigid taps.
use crate::common::*;
use bus::{Machine, State};
use canon::{
    Axis, Feed, Flute, Holder, Hole, Op, OpKind, Position, Span, SpindleOrder, Tap, TapTool,
    ToolKind, ToolLibrary,
};
use kernel::{EventKind, Kernel, TapFigures};
use plan::Step;
use plan::{AxisLimits, MachineLimits, Options, Planner, Start, Tapping, ToolChange};
use sim::SimulatedMachine;
use units::{Angle, Coordinate, CoordinateAccel, Lead, Length, Speed, Spin, Stiffness, Time};

/// Machine Z of the work's surface.
const TOP: f64 = -300.0;
const DRILL: f64 = 120.0;
const TAP: f64 = 100.0;

fn mm(value: f64) -> Length {
    Length::mm(value)
}

fn limits() -> MachineLimits {
    let axis = |accel: f64, low: f64| AxisLimits {
        travel: Some((Coordinate::new(low), Coordinate::ZERO)),
        accel: CoordinateAccel::new(accel),
        ..Z_LIMITS
    };
    let mut axes = [None; 9];
    axes[0] = Some(axis(10_000.0, -500.0));
    axes[1] = Some(axis(10_000.0, -400.0));
    axes[2] = Some(axis(15_000.0, -400.0));
    MachineLimits {
        axes,
        spindles: vec![SPINDLE_LIMITS],
        tool_change: ToolChange {
            z: Some(Length::ZERO),
            x: None,
            y: None,
            pockets: 0,
            time: Time::s(0.9),
        },
        settling: Time::s(5e-3),
        tapping: Tapping::along_z(SPINDLE_LIMITS.margin),
        joining: plan::Joining::EXACT,
        signals: None,
    }
}

fn tools() -> ToolLibrary {
    let tool = |number, length: f64, diameter: f64, kind| canon::Tool {
        number,
        pocket: number,
        length: mm(length),
        diameter: mm(diameter),
        kind,
        description: String::new(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: false,
    };
    let m6 = ToolKind::Tap(TapTool {
        designation: "M6x1".into(),
        lead: Lead::mm_per_rev(1.0),
        chamfer_pitches: 2.5,
        thread_length: mm(40.0),
        flute: Flute::SpiralFlute,
        oversize: Length::um(40.0),
        holder: Holder::Rigid { stiffness: Stiffness::n_per_mm(20_000.0) },
        max_torque: None,
    });
    let drill = ToolKind::Drill { point_angle: Angle::deg(118.0) };
    ToolLibrary::new([tool(1, DRILL, 5.0, drill), tool(2, TAP, 6.0, m6)])
}

fn at(x: f64, y: f64, above: f64, length: f64) -> Position {
    Position::xyz(x, y, TOP + length + above)
}

/// Drill 20 mm and tap 15 mm deep at each place.
fn ops(places: &[(f64, f64)]) -> Vec<Op> {
    let turn = |rpm| OpKind::Spindle { spindle: 0, order: SpindleOrder::Turn(Spin::rpm(rpm)) };
    let mut kinds = vec![OpKind::ChangeTool { number: 1 }, turn(6000.0)];
    for &(x, y) in places {
        kinds.push(OpKind::Rapid { to: at(x, y, 50.0, DRILL) });
        kinds.push(OpKind::Hole(Hole {
            axis: Axis::Z,
            at: at(x, y, 2.0, DRILL),
            bottom: mm(TOP + DRILL - 20.0),
            surface: mm(TOP + DRILL),
            zero: mm(TOP + DRILL),
            own_zero: None,
        }));
        kinds.push(OpKind::Rapid { to: at(x, y, 2.0, DRILL) });
        let feed = Feed::PerTime(Speed::mm_per_min(1200.0));
        kinds.push(OpKind::Line { to: at(x, y, -20.0, DRILL), feed });
        kinds.push(OpKind::Rapid { to: at(x, y, 50.0, DRILL) });
    }
    kinds.extend([OpKind::ChangeTool { number: 2 }, turn(3000.0)]);
    for &(x, y) in places {
        kinds.push(OpKind::Rapid { to: at(x, y, 50.0, TAP) });
        kinds.push(OpKind::Rapid { to: at(x, y, 3.0, TAP) });
        kinds.push(OpKind::Tap(Tap {
            axis: Axis::Z,
            start: at(x, y, 3.0, TAP),
            bottom: mm(TOP + TAP - 15.0),
            surface: mm(TOP + TAP),
            zero: mm(TOP + TAP),
            own_zero: None,
            lead: Lead::mm_per_rev(1.0),
            spin: Spin::rpm(6000.0),
            return_spin: Spin::rpm(6000.0),
            return_acceleration: canon::ReturnAcceleration::AsSet,
            dwell: Time::ZERO,
            start_angle: None,
            peck: None,
        }));
        kinds.push(OpKind::Rapid { to: at(x, y, 50.0, TAP) });
    }
    kinds.push(OpKind::End);
    let span = |line| Span { file: 0, line, start: 0, end: 0 };
    (1..).zip(kinds).map(|(line, kind)| Op { span: span(line), kind }).collect()
}

fn planned(places: &[(f64, f64)]) -> (Vec<Step>, Time) {
    let options = Options {
        force_ramp: None,
        cutting_pressure_n_per_mm2: 3900.0,
        taps: plan::Unsynchronised::default(),
    };
    let start = Start { position: Position::default(), tool: 0 };
    let mut planner = Planner::new(limits(), tools(), options, start);
    let mut steps = Vec::new();
    for (index, op) in (0..).zip(&ops(places)) {
        planner.push(index, op, &mut |step| steps.push(step));
    }
    planner.finish(&mut |step| steps.push(step));
    assert_eq!(planner.take_findings(), []);
    (steps, planner.duration())
}

fn plate() -> sim::Config {
    let order = TapOrder { from_mm: TOP + TAP + 3.0, surface_mm: TOP + TAP, ..M6 };
    let mut machine = machine_with_work(1, &order, 6.0);
    machine.magazine[0].number = 2;
    let (diameter, point_angle) = (mm(5.0), Angle::deg(118.0));
    let kind = sim::ToolKind::Drill { diameter, point_angle };
    machine.magazine.push(sim::Tool { number: 1, length: mm(DRILL), kind });
    machine.tool = 0;
    machine.stock.as_mut().expect("it has stock").assume_predrilled = false;
    machine
}

#[test]
fn a_plate_is_drilled_and_tapped_to_the_end_within_10_um_and_the_planned_time() {
    let places = [(-100.0, -50.0), (-150.0, -50.0), (-150.0, -120.0), (-240.0, -200.0)];
    let (steps, duration) = planned(&places);
    let mut machine = SimulatedMachine::new(plate()).expect("the test's machine can be built");
    let mut kernel = Kernel::new(control(&plate()));
    let mut waiting = steps.iter().peekable();
    let mut feedback = *machine.feedback();
    let mut taps: Vec<TapFigures> = Vec::new();
    let (mut ticks, mut broken, mut worst_mm) = (0u32, false, 0.0f64);
    while !kernel.is_over() && ticks < 400_000 {
        while waiting.next_if(|step| kernel.push(step).is_ok()).is_some() {}
        let command = kernel.tick(&feedback);
        let truth = machine.truth().expect("it is simulated");
        broken |= truth.tool_broken;
        for index in 0..3 {
            worst_mm =
                worst_mm.max((truth.axes[index] - command.axes[index].position).abs().value());
        }
        while let Some(event) = kernel.next_event() {
            if let EventKind::TapEnded(figures) = event.kind {
                taps.push(figures);
            }
        }
        feedback = *machine.exchange(&command);
        ticks += 1;
    }
    assert_eq!(kernel.faults(), []);
    assert_eq!((kernel.report().state, broken, taps.len()), (State::Ended, false, places.len()));
    for tap in &taps {
        assert!(tap.sync.max < Length::um(5.0) && tap.sync.periods > 1000, "{tap:?}");
        assert!(tap.depth_error.abs() < Length::um(5.0) && !tap.saturated, "{tap:?}");
    }
    // the whole way, rapids at 10 and 15 m/s² included
    assert!(worst_mm < 0.05, "{worst_mm} mm from the setpoint");
    let seconds = f64::from(ticks) * PERIOD.value();
    assert!((seconds / duration.value() - 1.0).abs() < 0.05, "{seconds} s, planned {duration}");
}
