//! A session of a control with a servo process.
use crate::ServoSide;
use bus::{AXES, SPINDLES, WatchedInputs};
use kernel::FaultKind;
use servo::Seat;
use units::Time;

/// What a process leads, and what is said of it.
#[derive(Clone, Debug)]
pub struct ServoProcessOptions {
    /// Name by which a control finds it.
    pub name: String,
    /// Name of the machine that it leads; `None`: it does not know, as HAL does not.
    pub machine: Option<String>,
    /// Which axes it has.
    pub axes: [bool; AXES],
    /// Number of its spindles.
    pub spindles: usize,
    /// Said where no period has come yet.
    pub not_called: &'static str,
    /// What is said of an axis, by its letter, that it lacks.
    pub axis_missing: fn(char) -> String,
    /// What is said of inputs that nothing drives, by their names.
    pub undriven: fn(&str) -> String,
}

/// A control that leads the machine, and the kernel that it leads.
pub(crate) struct ControlSession {
    pub(crate) seat: Seat<ServoSide>,
    /// Time after which axes and spindles are where their drives were commanded to be.
    pub(crate) obeys_after: ([Time; AXES], [Time; SPINDLES]),
    /// Inputs that something must drive.
    pub(crate) watched: WatchedInputs,
    /// Longest silence of its control, ns.
    pub(crate) most_silent_ns: i64,
}

impl ControlSession {
    /// Its control is gone, or not to be believed.
    pub(crate) fn is_lost(&mut self, now_ns: i64, period_ns: u64) -> Option<FaultKind> {
        let silent = self.seat.rings.silence(now_ns, period_ns);
        if self.seat.rings.is_damaged() {
            Some(FaultKind::ControlSenseless)
        } else if silent > self.most_silent_ns || self.seat.rings.is_ended() {
            Some(FaultKind::ControlSilent)
        } else {
            None
        }
    }
}
