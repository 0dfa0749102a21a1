//! What requests need, asked of the control as it is now.
use super::control::Control;
use super::state::{EmergencyStop, Execution, Need, Power};

impl Control {
    /// Whether something that a request needs is so; if not, in particular what is not.
    pub(super) fn meets(&self, need: &Need) -> Result<(), Need> {
        let kernel = &self.executor.kernel;
        let is_met = match need {
            Need::EmergencyStopArmed => self.emergency_stop() == EmergencyStop::Armed,
            Need::EmergencyStopTriggered => self.emergency_stop() == EmergencyStop::Triggered,
            Need::NoAlarm => kernel.faults().is_empty(),
            Need::PowerOn => self.power == Power::On && kernel.is_ready() && !self.is_resetting,
            Need::Homed(_) => match self.first_not_homed() {
                Some(axis) => return Err(Need::Homed(Some(axis.letter()))),
                None => true,
            },
            Need::NoProgramUnderWay if self.is_being_stopped() => {
                return self.meets(&Need::ProgramNotStopped { tool_in_work: false });
            }
            Need::NoProgramUnderWay => self.under_way.is_none() && !self.is_recovering,
            Need::ProgramUnderWay => self.under_way.is_some(),
            Need::ProgramNotStopped { .. } => {
                let tool_in_work = self.is_tap_in_thread();
                let stopped = Need::ProgramNotStopped { tool_in_work };
                return if self.is_being_stopped() { Err(stopped) } else { Ok(()) };
            }
            Need::ProgramHeld => {
                self.is_hold_asked
                    || matches!(
                        self.execution,
                        Execution::FeedHold
                            | Execution::Interrupted
                            | Execution::ProgramStopped
                            | Execution::OptionalStop
                    )
            }
            Need::ProgramWaitsForConfirmation => {
                matches!(self.execution, Execution::ProgramStopped | Execution::OptionalStop)
            }
            Need::ProgramLoaded => self.loaded.is_some(),
            Need::Standstill => kernel.is_off() || kernel.is_standing(),
            Need::NoManualMotion => !kernel.is_moving_manually() && !self.is_referencing(),
            Need::TapInThread => self.is_tap_in_thread(),
            Need::NoTapInThread => !self.is_tap_in_thread(),
            Need::NotRecovering => !self.is_recovering,
            Need::StateAcknowledged => self.state_changes.is_empty(),
            Need::FeedNotInhibited => !self.executor.machine.feedback().panel.feed_inhibit,
            Need::SpindleNotInhibited => {
                let inhibited = self.executor.machine.feedback().panel.spindle_inhibit;
                inhibited == [false; bus::SPINDLES]
            }
            Need::SequenceHalfWay => self.half_way().is_some(),
            Need::NoSequenceHalfWay => self.half_way().is_none(),
        };
        if is_met { Ok(()) } else { Err(need.clone()) }
    }

    /// The program under way was given up by a stop, and what moves comes to rest.
    pub(super) fn is_being_stopped(&self) -> bool {
        let is_aborted = self.executor.kernel.operator().wants_abort();
        self.under_way.as_ref().is_some_and(|under_way| under_way.is_given_up || is_aborted)
    }
}
