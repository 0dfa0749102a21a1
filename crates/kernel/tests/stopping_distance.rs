//! How far a move goes that an alarm stops: no farther than its own end, and straight on.
use crate::common::*;
use crate::operated;
use canon::{Op, OpKind, Position, Span};
use kernel::{Config, FaultKind, Kernel};
use motion::{Bounds, Limits};
use sim::SimulatedMachine;
use units::CoordinateAccel;

/// Limits of each axis, mm/s, mm/s², mm/s³.
const BOUNDS: Bounds =
    Bounds { speed: [operated::SPEED; 9], accel: [operated::ACCEL; 9], jerk: [f64::INFINITY; 9] };
/// A fifth of that, as on machines whose rapids brake harder than their small moves.
const APPROACH: CoordinateAccel = CoordinateAccel::new(operated::ACCEL / 5.0);

/// Rest position of the setpoints when an alarm stops a rapid to `end` after `after` periods of its
/// motion; `None` if it was over before.
fn rests_at(end: Position, after: usize) -> Option<[f64; 3]> {
    let place = Span { file: 0, line: 1, start: 0, end: 0 };
    let rapid = [Op { span: place, kind: OpKind::Rapid { to: end } }];
    let motion = Limits { feed: BOUNDS, rapid: BOUNDS };
    let mut config = Config { motion, ..control(&machine(0)) };
    config.axes.iter_mut().flatten().for_each(|axis| axis.approach.1 = APPROACH);
    let mut kernel = Kernel::new(config);
    for step in operated::planned(&rapid, 50e3) {
        kernel.push(&step).expect("it is a short program");
    }
    let mut machine = SimulatedMachine::new(machine(0)).expect("the test's machine can be built");
    let mut feedback = *bus::Machine::feedback(&machine);
    let (mut moved, mut is_stopped) = (0, false);
    let mut at = [0.0; 3];
    for _ in 0..20_000 {
        let command = kernel.tick(&feedback);
        let next = [0, 1, 2].map(|axis| command.axes[axis].position.value());
        let way = [0, 1, 2].map(|axis| (next[axis] - at[axis]).abs()).iter().sum::<f64>();
        at = next;
        moved += usize::from(way > 1e-3);
        if moved == after && !is_stopped {
            kernel.report_control(FaultKind::RequestsNotTaken);
            is_stopped = true;
        }
        if moved > 10 && way < 1e-9 {
            break;
        }
        feedback = *bus::Machine::exchange(&mut machine, &command);
    }
    is_stopped.then_some(at)
}

#[test]
fn an_alarm_in_a_rapid_stops_it_on_its_line_and_before_its_end() {
    let step = test_support::size::of(37, 1);
    for end in [[80.0, 0.0, 0.0], [60.0, 35.0, -25.0], [3.0, -90.0, -1.0]] {
        let [x, y, z]: [f64; 3] = end;
        let length = (x * x + y * y + z * z).sqrt();
        let mut before = 0.0;
        let mut instants = 0;
        for after in (20..).step_by(step) {
            let Some(at) = rests_at(Position::xyz(x, y, z), after) else { break };
            instants += 1;
            let along = (at[0] * x + at[1] * y + at[2] * z) / length;
            let off = [0, 1, 2].map(|i| at[i] - end[i] * along / length);
            let off = off.iter().map(|way| way * way).sum::<f64>().sqrt();
            assert!(off < 0.01, "stopped after {after} periods it is {off} mm off the line");
            assert!(along < length + 0.01, "after {after} periods: {} mm beyond", along - length);
            assert!(along > before - 1e-6, "{along} mm after {after} periods, {before} mm before");
            before = along;
        }
        assert!(instants > 10, "{instants} instants");
    }
}
