//! What a machine's file says of the actuators that may swing.
use super::servo::Servo;
use super::slide::Slide;
use canon::{Harmonic, Oscillating, Oscillation, Polygon};
use forms::polygon::{Actuator, Drive, Effort, Form, Limits};
use std::f64::consts::{PI, TAU};
use store::machine::{Axis, MachineFile, PositionFrom, Spindle};
use sync::Complex;
use units::{Coordinate, Spin};

/// What a commissioning leaves undecided of a screw's stiffness, as a share.
pub const STIFFNESS: f64 = 0.15;
/// What it leaves undecided of friction and play, as a share.
pub const FRICTION: f64 = 0.20;
/// Share of an axis' force that an oscillation may use: the rest is for the cut and for control.
const PLANNED_SHARE: f64 = 0.9;
/// Share of an axis' speed, acceleration and jerk that an oscillation may use: the rest is for
/// fading it in and for moves of that axis meanwhile.
const SWING_SHARE: f64 = 0.9;
/// An actuator of this machine, swinging at this speed of the work; `None` if the machine lacks it.
/// `measured`: what an air cut has shown of its loop, harmonic by harmonic; else what the machine's
/// file says of it.
pub fn drive(
    machine: &MachineFile,
    actuator: Actuator,
    form: &Form,
    work: Spin,
    harmonics: usize,
    measured: &[[f64; 2]],
) -> Option<Drive> {
    let limits = limits(machine, actuator, form, work)?;
    let answer = Answer::new(machine, actuator, form, work)?;
    let response = (0..harmonics).map(|h| {
        let frequency = work.value().abs() * form.base() * (h + 1) as f64;
        let measured = measured.get(h).map(|[re, im]| Complex { re: *re, im: *im });
        let answer = answer.at(frequency, measured);
        [answer.re, answer.im]
    });
    Some(Drive { actuator, limits, response: response.collect() })
}

/// What a loop makes of what is ordered, as the machine's file has it.
pub enum Answer {
    /// A slide: as it is believed to be.
    Sliding(Servo, Slide),
    /// The tool spindle.
    Turning(Servo),
}

impl Answer {
    /// Of an actuator of this machine, swinging at this speed of the work.
    pub fn new(machine: &MachineFile, actuator: Actuator, form: &Form, work: Spin) -> Option<Self> {
        let control = &machine.control;
        match on(actuator) {
            Oscillating::Axis(letter) => {
                let axis = machine.axes.iter().flatten().find(|axis| axis.letter == letter)?;
                let frequency = work.value().abs() * form.base();
                let most = farthest(&limits(machine, actuator, form, work)?, frequency);
                let believed = Slide::swinging(axis, frequency, most);
                let servo = Servo::of_axis(axis, control);
                Some(Self::Sliding(servo, believed))
            }
            Oscillating::ToolPhase => {
                let spindle = machine.spindles.get(1)?;
                Some(Self::Turning(Servo::of_spindle(spindle, control)))
            }
        }
    }

    /// At a frequency in Hz. `measured`: what an air cut has shown of it.
    pub fn at(&self, frequency: f64, measured: Option<Complex>) -> Complex {
        measured.unwrap_or_else(|| match self {
            Self::Sliding(servo, slide) => servo.sliding(frequency, slide, slide),
            Self::Turning(servo) => servo.turning(frequency),
        })
    }
}

/// A slide that swings, and how far its friction and play may take it off at a reversal, as far as
/// they are not known.
pub struct Reversing {
    servo: Servo,
    slide: Slide,
    off_mm: f64,
}

impl Reversing {
    /// Of what repeats so many times a second; `None`: it is no slide.
    pub fn of(machine: &MachineFile, swing: &Oscillation, repeats: Spin) -> Option<Self> {
        let (axis, frequency, size) = slide_of(machine, swing, repeats)?;
        let held = axis.friction.static_force.value() / axis.structure.stiffness.value();
        let play = axis.structure.backlash.value() / 2.0;
        // the fundamental of a motion that is off by as much, now this way and now that way
        let off_mm = (held * (STIFFNESS + FRICTION) + play * FRICTION) * 4.0 / PI;
        let slide = Slide::swinging(axis, frequency, size);
        Some(Self { servo: Servo::of_axis(axis, &machine.control), slide, off_mm })
    }

    /// What the machine's file says of the answer at a frequency, where a reversal explains how a
    /// swing of this size came.
    pub fn explains(&self, hz: f64, came: Complex, swing: f64) -> Option<Complex> {
        let file = self.servo.sliding(hz, &self.slide, &self.slide);
        ((came - file).size() * swing <= self.off_mm).then_some(file)
    }
}

/// The axis that swings, and the frequency and amplitude of its strongest harmonic.
fn slide_of<'m>(
    machine: &'m MachineFile,
    swing: &Oscillation,
    repeats: Spin,
) -> Option<(&'m Axis, f64, f64)> {
    let Oscillating::Axis(letter) = swing.on else { return None };
    let axis = machine.axes.iter().flatten().find(|axis| axis.letter == letter)?;
    let size = |h: &&Harmonic| h.cosine.hypot(h.sine);
    let swinging = swing.harmonics.iter().filter(|h| h.per_turn > 0);
    let most = swinging.max_by(|a, b| size(a).total_cmp(&size(b)))?;
    Some((axis, f64::from(most.per_turn) * repeats.abs().value(), size(&most)))
}

/// The screw of an axis that swings, which repeats so many times a second, where a motor's encoder
/// does not see its far end.
pub fn screw(machine: &MachineFile, swing: &Oscillation, repeats: Spin) -> Option<Slide> {
    let (axis, frequency, size) = slide_of(machine, swing, repeats)?;
    matches!(axis.position_from, PositionFrom::Motor { .. })
        .then(|| Slide::swinging(axis, frequency, size))
}

/// What an actuator of this machine can do; `None` if the machine lacks it.
fn limits(machine: &MachineFile, actuator: Actuator, form: &Form, work: Spin) -> Option<Limits> {
    Some(match on(actuator) {
        Oscillating::Axis(letter) => {
            let axis = machine.axes.iter().flatten().find(|axis| axis.letter == letter)?;
            let middle = match actuator {
                Actuator::CentreLine => {
                    machine.setup.g54.along(letter) + Coordinate::linear(form.centres())
                }
                Actuator::Across | Actuator::ToolPhase => machine.setup.g54.along(letter),
            };
            let travel = (middle - axis.travel.from).min(axis.travel.to - middle).value();
            slide(axis, travel)
        }
        Oscillating::ToolPhase => turning(machine.spindles.get(1)?, work * form.ratio()),
    })
}

/// What swings, as the program says it.
pub const fn on(actuator: Actuator) -> Oscillating {
    match actuator {
        Actuator::CentreLine => Oscillating::Axis(canon::Axis::X),
        Actuator::Across => Oscillating::Axis(canon::Axis::Y),
        Actuator::ToolPhase => Oscillating::ToolPhase,
    }
}

/// Largest speed, acceleration and jerk of what swings, mm and s or rev and s.
pub fn most(machine: &MachineFile, on: Oscillating, polygon: &Polygon, work: Spin) -> [f64; 3] {
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
