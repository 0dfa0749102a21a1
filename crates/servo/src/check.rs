//! Whether a step or a request that came out of bytes can be meant: what it names is there, its
//! counts fit its arrays.
//!
//! Whether it may be *done* is no matter of this: the kernel watches setpoints, travel, references
//! and speeds itself, whatever was planned.
use bus::SPINDLES;
use core::fmt;
use kernel::Request;
use motion::{
    AXES, Curve, Follow, Inline, PHASES, Shape as _, Step, StepKind, Superpose, Superposed,
};

/// A step or a request that names what no machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Senseless {
    /// A spindle of this number.
    Spindle(usize),
    /// An axis of this number.
    Axis(usize),
    /// So many phases of a stretch.
    Phases(usize),
    /// A path whose length is below zero.
    Length,
}

impl fmt::Display for Senseless {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Spindle(number) => {
                write!(f, "a message names spindle {number}: there are {SPINDLES} at most")
            }
            Self::Axis(number) => {
                write!(f, "a message names axis {number}: there are {AXES} at most")
            }
            Self::Phases(count) => {
                write!(f, "a stretch of a path has {count} phases: 1 to {PHASES} are possible")
            }
            Self::Length => f.write_str("a path has a length below zero"),
        }
    }
}

impl std::error::Error for Senseless {}

fn spindle(number: impl Into<usize>) -> Result<(), Senseless> {
    let number = number.into();
    if number < SPINDLES { Ok(()) } else { Err(Senseless::Spindle(number)) }
}

fn follow(plan: &Follow) -> Result<(), Senseless> {
    let count = usize::from(plan.count);
    if !(1..=PHASES).contains(&count) {
        return Err(Senseless::Phases(count));
    }
    let of_curve = match &plan.piece.curve {
        Curve::Line(line) => line.length,
        Curve::Arc(arc) => arc.length,
        Curve::Bezier(curve) => curve.length(),
        Curve::Polynomial(curve) => curve.length,
    };
    if plan.piece.length < 0.0 || of_curve < 0.0 {
        return Err(Senseless::Length);
    }
    match &plan.piece.curve {
        Curve::Arc(arc) => match arc.plane.iter().find(|axis| **axis >= AXES) {
            Some(axis) => Err(Senseless::Axis(*axis)),
            None => Ok(()),
        },
        Curve::Line(_) | Curve::Bezier(_) | Curve::Polynomial(_) => Ok(()),
    }
}

fn superpose(order: &Superpose) -> Result<(), Senseless> {
    spindle(order.master)?;
    match order.on {
        Superposed::Spindle(number) => spindle(number),
        Superposed::Axis(_) => Ok(()),
    }
}

/// Whether a step can be meant.
///
/// # Errors
/// What it names, and no machine has.
pub fn check_step(step: &Step<Inline>) -> Result<(), Senseless> {
    match &step.kind {
        StepKind::Follow(plan) => follow(plan),
        StepKind::Tap(plan) => spindle(plan.spindle),
        StepKind::Thread(stretch) => spindle(stretch.spindle),
        StepKind::WayOut(Some(way)) => spindle(way.spindle),
        StepKind::Engage(gear) => spindle(gear.follower).and_then(|()| spindle(gear.master)),
        StepKind::Superpose(order) => superpose(order),
        StepKind::Spindle { spindle: number, .. }
        | StepKind::Release { follower: number }
        | StepKind::Revolve { spindle: number, .. } => spindle(*number),
        StepKind::Move(_)
        | StepKind::Dwell(_)
        | StepKind::WayOut(None)
        | StepKind::AwaitFades
        | StepKind::Consult(_)
        | StepKind::ChangeTool { .. }
        | StepKind::Coolant { .. }
        | StepKind::FeedOverride(_)
        | StepKind::SpindleOverride(_)
        | StepKind::Output(_)
        | StepKind::Input(_)
        | StepKind::Inputs(_)
        | StepKind::Count(_)
        | StepKind::Guard { .. }
        | StepKind::Probe { .. }
        | StepKind::UserCode(_)
        | StepKind::Pause { .. }
        | StepKind::End => Ok(()),
    }
}

/// Whether a request can be meant.
///
/// # Errors
/// What it names, and no machine has.
pub fn check_request(request: &Request) -> Result<(), Senseless> {
    match request {
        Request::TurnManually(number, ..) | Request::OrientManually(number, _) => spindle(*number),
        Request::Recover(plan) => spindle(plan.spindle),
        Request::Superpose(order) => superpose(order),
        Request::Order(_)
        | Request::SwitchOn
        | Request::SwitchOff
        | Request::Clear
        | Request::ClearOutputs
        | Request::MoveManually(..)
        | Request::RestManually
        | Request::Home(..)
        | Request::ForgetHome(_)
        | Request::Withdraw(_)
        | Request::GoOn
        | Request::HandBack
        | Request::UnderWay
        | Request::GiveUp { .. }
        | Request::PutTable(..)
        | Request::Answer
        | Request::KeepRecords
        | Request::Acknowledge(_)
        | Request::NotWritten
        | Request::ForgetBands(_) => Ok(()),
    }
}
