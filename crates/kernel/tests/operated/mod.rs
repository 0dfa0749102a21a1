//! A kernel with its planner, an operator who may order anything at any instant, and axes that are
//! where they are told to be: X, Y, Z and C, all alike, C in degrees.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part
use super::common::{SPINDLE_LIMITS, control, machine};
use bus::{AXES, AxisFeedback, Feedback, SpindleFeedback};
use canon::{Op, Position, ToolLibrary};
use kernel::{Kernel, Order};
use plan::Step;
/// How long after now a new plan takes over.
const LEAD: Time = Time::s(0.25);

use plan::{
    AxisLimits, Joining, MachineLimits, OperatorSettings, Options, Planner, Start, TakeOver,
    Tapping, ToolChange,
};
use proptest::prelude::*;
use std::collections::VecDeque;
use units::{CoordinateAccel, CoordinateJerk, CoordinateSpeed, Time};

/// Index of C.
pub const C: usize = 5;
pub const PERIOD: f64 = 1e-3;
pub const SPEED: f64 = 200.0;
pub const ACCEL: f64 = 1000.0;

fn limits(jerk: f64) -> MachineLimits {
    let axis = AxisLimits {
        travel: None,
        rapid_speed: CoordinateSpeed::new(SPEED),
        feed_speed: CoordinateSpeed::new(SPEED),
        accel: CoordinateAccel::new(ACCEL),
        rapid_jerk: CoordinateJerk::new(jerk),
        feed_jerk: CoordinateJerk::new(jerk),
    };
    let mut axes = [None; 9];
    axes[..3].fill(Some(axis));
    axes[C] = Some(axis);
    MachineLimits {
        axes,
        spindles: vec![SPINDLE_LIMITS],
        tool_change: ToolChange { z: None, x: None, y: None, pockets: 0, time: Time::s(1.0) },
        settling: Time::ZERO,
        tapping: Tapping::along_z(0.9),
        joining: Joining { period: Time::s(PERIOD), ..Joining::EXACT },
        signals: None,
    }
}

const OPTIONS: Options = Options {
    force_ramp: None,
    cutting_pressure_n_per_mm2: 3900.0,
    taps: plan::Unsynchronised {
        method: plan::TapMethod::Synchronised,
        dwell: plan::DwellCheck::Refuse,
        drive: None,
    },
};

/// What these ops are planned as, from zero.
pub fn planned(ops: &[Op], jerk: f64) -> Vec<Step> {
    let start = Start { position: Position::default(), tool: 0 };
    let mut planner = Planner::new(limits(jerk), ToolLibrary::new([]), OPTIONS, start);
    let mut steps = Vec::new();
    for (index, op) in (0..).zip(ops) {
        planner.push(index, op, &mut |step| steps.push(step));
    }
    planner.finish(&mut |step| steps.push(step));
    steps
}

/// Setpoints, a period apart, and the line that each serves. The axes are where they were told to
/// be.
pub struct Seen {
    pub at: Vec<([f64; AXES], u32)>,
    pub faults: Vec<kernel::Fault>,
    pub ended: bool,
}

/// Orders by the period in which they come; at the end everything is let go, so that the program
/// ends.
pub fn run(ops: &[Op], jerk: f64, orders: &[(usize, Order)]) -> Seen {
    run_replanning(ops, jerk, orders, false)
}

/// The same; `ahead`: a new plan takes over from a moment ahead, as it has to where planning takes
/// time.
pub fn run_replanning(ops: &[Op], jerk: f64, orders: &[(usize, Order)], ahead: bool) -> Seen {
    let limits = limits(jerk);
    let mut config = control(&machine(0));
    config.period = Time::s(PERIOD);
    config.motion = limits.motion(1.0);
    config.axes[C] = config.axes[0];
    for axis in config.axes.iter_mut().flatten() {
        // the axes are where they are told to be
        axis.encoder.place = kernel::EncoderPlace::Scale;
        axis.weight = units::Force::ZERO;
    }
    let mut kernel = Kernel::new(config);
    let start = Start { position: Position::default(), tool: 0 };
    let mut planner = Planner::new(limits, ToolLibrary::new([]), OPTIONS, start);
    let (mut queue, mut sent) = (VecDeque::<Step>::new(), Vec::new());
    let (mut open, mut settings) = (true, OperatorSettings::default());
    settings.stops = orders.contains(&(0, Order::SingleBlock(true)));
    planner.set_operator(settings);
    for (index, op) in (0..).zip(ops) {
        planner.push(index, op, &mut |step| queue.push_back(step));
    }
    // the run stays open while the first orders come, as it does with a long program
    let mut feedback = Feedback::default();
    let mut seen = Seen { at: Vec::new(), faults: Vec::new(), ended: false };
    let last = orders.iter().map(|(tick, _)| *tick).max().unwrap_or(0);
    for tick in 0..200_000 {
        for (_, order) in orders.iter().filter(|(at, _)| *at == tick) {
            kernel.order(*order);
        }
        if tick > last && kernel.operator().wants_rest() && kernel.is_standing() {
            kernel.order(Order::Resume);
        }
        if tick == last + 1 {
            kernel.order(Order::FeedOverride(kernel.operator().share(false).max(1.0)));
            kernel.order(Order::RapidOverride(1.0));
        }
        let operator = kernel.operator();
        let now = OperatorSettings {
            share: operator.share(false).max(1.0),
            stops: operator.single_block(),
        };
        if now.share > settings.share || (now.stops && !settings.stops) {
            if ahead {
                let (under_way, steps) = (kernel.under_way(), kernel.steps());
                let first = sent.len() - steps;
                if let Some(TakeOver { stays, at }) =
                    plan::take_over(sent[first..].iter(), under_way, LEAD)
                    && kernel.give_up(steps - stays, at)
                {
                    let anew = if at.is_some() { first } else { first + stays };
                    let mut again = sent[anew..].to_vec();
                    again.extend(queue.drain(..));
                    sent.truncate(first + stays);
                    if let (Some(at), Some(last)) = (at, sent.last_mut()) {
                        plan::cut(last, at);
                    }
                    planner.repace(now, again, at, &mut |step| queue.push_back(step));
                    settings = now;
                }
            } else if let Some(back) = kernel.hand_back() {
                let mut steps = sent.split_off(sent.len() - back.steps);
                steps.extend(queue.drain(..));
                planner.repace(now, steps, back.done, &mut |step| queue.push_back(step));
                settings = now;
            }
        } else {
            settings = now;
        }
        if queue.is_empty() && open && !kernel.is_full() {
            open = false;
            planner.finish(&mut |step| queue.push_back(step));
        }
        while queue.front().is_some_and(|step| kernel.push(step).is_ok()) {
            sent.extend(queue.pop_front());
        }
        feedback.time = Time::s(tick as f64 * PERIOD);
        feedback.tool = Some(0);
        let command = kernel.tick(&feedback);
        for (axis, told) in feedback.axes.iter_mut().zip(&command.axes) {
            *axis = AxisFeedback {
                position: told.position,
                motor: Some(told.position),
                ready: true,
                ..AxisFeedback::default()
            };
        }
        feedback.spindles =
            [SpindleFeedback { ready: true, ..SpindleFeedback::default() }; bus::SPINDLES];
        let q = core::array::from_fn(|i| command.axes[i].position.value());
        seen.at.push((q, kernel.report().line));
        if kernel.is_over() {
            seen.ended = kernel.report().state == bus::State::Ended;
            break;
        }
    }
    seen.faults = kernel.faults().to_vec();
    seen
}

/// Largest speed, acceleration and jerk of an axis, over their limits.
pub fn loads(seen: &Seen, jerk: f64) -> [f64; 3] {
    let mut most = [0.0_f64; 3];
    for four in seen.at.windows(4) {
        for i in [0, 1, 2, C] {
            let q: [f64; 4] = core::array::from_fn(|k| four[k].0[i]);
            most[0] = most[0].max((q[1] - q[0]).abs() / PERIOD / SPEED);
            most[1] = most[1].max((q[2] - 2.0 * q[1] + q[0]).abs() / PERIOD.powi(2) / ACCEL);
            let third = q[3] - 3.0 * q[2] + 3.0 * q[1] - q[0];
            most[2] = most[2].max(third.abs() / PERIOD.powi(3) / jerk);
        }
    }
    most
}

/// Where X, Y and Z are.
pub const fn xyz([x, y, z, ..]: [f64; AXES]) -> [f64; 3] {
    [x, y, z]
}

/// From a point to a line between two.
pub fn distance(p: [f64; 3], [a, b]: [[f64; 3]; 2]) -> f64 {
    let d: [f64; 3] = core::array::from_fn(|i| b[i] - a[i]);
    let square: f64 = d.iter().map(|x| x * x).sum();
    let along: f64 = (0..3).map(|i| (p[i] - a[i]) * d[i]).sum();
    let f = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (0..3).map(|i| (p[i] - a[i] - f * d[i]).powi(2)).sum::<f64>().sqrt()
}

/// What an operator may order.
pub fn order() -> impl Strategy<Value = Order> {
    prop_oneof![
        4 => (0.0..2.0_f64).prop_map(Order::FeedOverride),
        1 => Just(Order::FeedOverride(2.0)),
        2 => Just(Order::FeedHold),
        2 => Just(Order::Resume),
        1 => any::<bool>().prop_map(Order::SingleBlock),
        2 => (0.0..1.0_f64).prop_map(Order::RapidOverride),
    ]
}
