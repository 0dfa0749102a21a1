//! A session of a control with a servo process.
use crate::ServoSide;
use bus::{AXES, SPINDLES};
use kernel::FaultKind;
use servo::Seat;
use units::Time;

/// What a process leads, and what is said of it.
#[derive(Clone, Debug)]
pub struct ServoProcessOptions {
    /// Name by which a control finds it.
    pub name: String,
    /// Which axes it has.
    pub axes: [bool; AXES],
    /// Number of its spindles.
    pub spindles: usize,
    /// Said where no period has come yet.
    pub not_called: &'static str,
    /// How the process gets an axis that it lacks; its letter follows.
    pub axis_missing: &'static str,
}

/// A control that leads the machine, and the kernel that it leads.
pub(crate) struct ControlSession {
    pub(crate) seat: Seat<ServoSide>,
    /// Drives obey so much later than they are told.
    pub(crate) obeys_after: ([Time; AXES], [Time; SPINDLES]),
    /// For so long its control may show no sign of life, ns.
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
