//! Taking a tool out after a stop that was tied to a spindle, but not screwed to the work: one axis
//! after the other.
//!
//! ```text
//!   a pass over a thread    X to where the tool is clear ─► Z to where the pass began ─► over
//!   cam, polygon, gear      X to where the tool is clear ─► over
//! ```
//!
//! No spindle turns, and where it stands does not matter: in a groove, on a flank or on a cam a
//! tool is held by nothing on the side from which it came. Each leg ends at a place, so it can be
//! killed and begun again.
use crate::config::Subject;
use crate::drives::{Drives, Finding};
use crate::fault::FaultKind;
use crate::retreating::Retreating;
use units::{Axis, Coordinate};
use units::{Length, Time};

/// Which axes move, one after the other, and where to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WithdrawalPlan {
    /// The infeed axis first.
    pub legs: [Option<(Axis, Length)>; 2],
}

/// See the module's header.
#[derive(Clone, Debug)]
pub(crate) struct Withdrawing {
    plan: WithdrawalPlan,
    at: usize,
    leg: Option<Retreating>,
    began: Time,
}

impl Withdrawing {
    pub(crate) const fn new(plan: WithdrawalPlan, now: Time) -> Self {
        Self { plan, at: 0, leg: None, began: now }
    }

    /// The drives come up for it.
    pub(crate) const fn begins(&mut self, now: Time) {
        self.began = now;
    }

    /// It is out.
    pub(crate) const fn is_done(&self) -> bool {
        self.at >= self.plan.legs.len()
    }

    /// When it began.
    pub(crate) const fn began(&self) -> Time {
        self.began
    }

    /// A period on; whether it is out now, and was not before.
    pub(crate) fn advance(&mut self, dt: f64, drives: &mut Drives) -> Result<bool, Finding> {
        let Some(leg) = self.plan.legs.get(self.at) else { return Ok(false) };
        let Some((axis, to)) = *leg else {
            self.at += 1;
            return Ok(self.is_done());
        };
        let leg = match self.leg.take() {
            Some(leg) => leg,
            None => Retreating::gently(axis, Coordinate::linear(to), drives).ok_or((
                FaultKind::NotConfigured,
                Subject::Axis(axis),
                0.0,
                0.0,
            ))?,
        };
        let leg = self.leg.insert(leg);
        leg.advance(dt, false, drives);
        if leg.is_out() {
            self.leg = None;
            self.at += 1;
        }
        Ok(self.is_done())
    }
}
