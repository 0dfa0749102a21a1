//! What a machine's file says of the actuators that may swing.
use super::slide::Slide;
use canon::{Oscillating, Polygon};
use forms::polygon::{Actuator, Drive, Effort, Form, Limits, Loop};
use std::f64::consts::TAU;
use store::machine::{Axis, MachineFile, Spindle};
use units::Spin;

/// Share of an axis' force that an oscillation may use: the rest is for the cut and for control.
const PLANNED_SHARE: f64 = 0.9;
/// Share of an axis' speed, acceleration and jerk that an oscillation may use: the rest is for fading it in and for moves
/// of that axis meanwhile.
const SWING_SHARE: f64 = 0.9;
/// What a loop makes of a harmonic that was not measured.
const ASSUMED: [f64; 2] = [1.0, 0.0];

/// An actuator of this machine, swinging at this speed of the work; `None` if the machine lacks it. `measured`: what
/// an air cut has shown of its loop, harmonic by harmonic; else the loop is taken to be as good as its feed-forwards.
pub(super) fn drive(
    machine: &MachineFile,
    actuator: Actuator,
    form: &Form,
    work: Spin,
    harmonics: usize,
    measured: &[[f64; 2]],
) -> Option<Drive> {
    let frequency = |h: usize| work.value().abs() * form.base() * (h + 1) as f64;
    let (limits, answer): (Limits, Box<dyn Fn(f64) -> [f64; 2]>) = match on(actuator) {
        Oscillating::Axis(letter) => {
            let axis = machine.axes.iter().flatten().find(|axis| axis.letter == letter)?.clone();
            let middle = match actuator {
                Actuator::CentreLine => machine.setup.g54.along(letter) + form.centres(),
                Actuator::Across | Actuator::ToolPhase => machine.setup.g54.along(letter),
            };
            let travel = (middle - axis.travel.from).min(axis.travel.to - middle).value();
            let limits = slide(&axis, travel);
            let moved = Slide::swinging(&axis, frequency(0), farthest(&limits, frequency(0)));
            (limits, Box::new(move |f| [moved.answer(f).re, moved.answer(f).im]))
        }
        Oscillating::ToolPhase => {
            let spindle = machine.spindles.get(1)?.clone();
            let tool = work * form.ratio();
            (turning(&spindle, tool), Box::new(move |f| answer(&spindle, f)))
        }
    };
    let response = (0..harmonics).map(|h| {
        let ([a, b], [c, d]) = (answer(frequency(h)), measured.get(h).copied().unwrap_or(ASSUMED));
        [a * c - b * d, a * d + b * c]
    });
    Some(Drive { actuator, limits, response: response.collect() })
}

/// What swings, as the program says it.
pub(super) const fn on(actuator: Actuator) -> Oscillating {
    match actuator {
        Actuator::CentreLine => Oscillating::Axis(canon::Axis::X),
        Actuator::Across => Oscillating::Axis(canon::Axis::Y),
        Actuator::ToolPhase => Oscillating::ToolPhase,
    }
}

/// Largest speed, acceleration and jerk of what swings, mm and s or rev and s.
pub(super) fn most(
    machine: &MachineFile,
    on: Oscillating,
    polygon: &Polygon,
    work: Spin,
) -> [f64; 3] {
    let limits = match on {
        Oscillating::Axis(letter) => {
            let axis = machine.axes.iter().flatten().find(|axis| axis.letter == letter);
            axis.map(|axis| slide(axis, f64::INFINITY))
        }
        Oscillating::ToolPhase => {
            let tool = machine.spindles.get(usize::from(polygon.tool));
            tool.map(|tool| turning(tool, work * polygon.ratio.value()))
        }
    };
    limits.map_or([0.0; 3], |l| {
        let by_effort =
            l.effort.map_or(f64::INFINITY, |e| (e.most - e.constant).max(0.0) / e.per_acceleration);
        [l.speed, l.acceleration.min(by_effort), l.jerk]
    })
}

fn slide(axis: &Axis, travel: f64) -> Limits {
    let mass = axis.drive.motor_mass() + axis.moving_mass;
    Limits {
        travel: travel.max(0.0),
        speed: axis.feed_most.value() * SWING_SHARE,
        acceleration: axis.acceleration.value() * SWING_SHARE,
        jerk: axis.jerk_feed.value() * SWING_SHARE,
        effort: Some(Effort {
            per_acceleration: mass.value() * 1e-3,
            per_speed: axis.friction.viscous_n_s_per_m * 1e-3,
            constant: axis.friction.coulomb.value(),
            most: axis.drive.peak_force().value() * PLANNED_SHARE,
        }),
    }
}

fn turning(spindle: &Spindle, tool: Spin) -> Limits {
    let viscous = spindle.friction.viscous_n_m_s_per_rad;
    let power = spindle.peak_power.value() / tool.in_rad_per_s().abs().max(1e-9);
    let most = spindle.peak_torque.value().min(power) * spindle.planned_share;
    let rise = spindle.peak_torque.value() / spindle.torque_rise.value().max(1e-6);
    Limits {
        travel: 0.25,
        speed: (spindle.max - tool.abs()).value().max(0.0),
        acceleration: f64::INFINITY,
        jerk: rise / (spindle.inertia.value() * TAU),
        effort: Some(Effort {
            per_acceleration: spindle.inertia.value() * TAU,
            per_speed: viscous * TAU,
            constant: spindle.friction.coulomb.value() + viscous * tool.in_rad_per_s().abs(),
            most,
        }),
    }
}

/// The largest amplitude at a frequency in Hz that limits allow, mm.
fn farthest(limits: &Limits, frequency: f64) -> f64 {
    let w = TAU * frequency.max(1e-6);
    let most = [limits.speed / w, limits.acceleration / (w * w), limits.jerk / (w * w * w)];
    most.into_iter().fold(limits.travel, f64::min)
}

/// The spindle's loop; the control takes delay and lag of the torque off beforehand.
fn answer(spindle: &Spindle, frequency: f64) -> [f64; 2] {
    Loop {
        position_gain: spindle.loops.position_gain_per_s,
        velocity_bandwidth: spindle.loops.velocity_bandwidth_hz,
        damping: 0.0,
        torque_lag: 0.0,
        delay: 0.0,
    }
    .at(frequency)
}
