//! Whether a drive shall have torque: a fault is reset when its control asks for power anew, and by
//! nothing else.
//!
//! ```text
//!   Off ──power, no fault──► On ──fault──► Failed ──no power──► Off
//!    │                       ▲
//!    └──power, fault──► Resetting ──fault is gone
//! ```
//!
//! A drive whose fault is reset while it is wanted on would enable itself again: `Failed` wants it
//! off until its control has taken the power away.
use crate::cia402::{PdsState, Wanted};

/// What is wanted of the power of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Power {
    #[default]
    Off,
    Resetting,
    On,
    Failed,
}

impl Power {
    /// Goes on by a period; true if the fault is to be reset.
    pub(crate) fn next(self, enable: bool, state: Option<PdsState>) -> (Self, bool) {
        let faulty = matches!(state, Some(PdsState::Fault | PdsState::FaultReactionActive));
        match (self, enable) {
            (_, false) => (Self::Off, false),
            (Self::Off, true) if faulty => (Self::Resetting, true),
            (Self::Resetting, true) if faulty => (Self::Resetting, false),
            (Self::On, true) if faulty => (Self::Failed, false),
            (Self::Off | Self::Resetting | Self::On, true) => (Self::On, false),
            (Self::Failed, true) => (Self::Failed, false),
        }
    }

    /// State wanted of the drive.
    pub(crate) const fn wanted(self) -> Wanted {
        match self {
            Self::On => Wanted::On,
            Self::Off | Self::Resetting | Self::Failed => Wanted::Off,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use PdsState::{Fault, OperationEnabled, SwitchOnDisabled};

    /// Power after periods of what is asked and what the drive says, and resets that were ordered.
    fn after(periods: &[(bool, PdsState)]) -> (Power, usize) {
        periods.iter().fold((Power::Off, 0), |(power, resets), (enable, state)| {
            let (next, reset) = power.next(*enable, Some(*state));
            (next, resets + usize::from(reset))
        })
    }

    #[test]
    fn a_drive_that_fails_stays_off_until_power_is_asked_for_anew() {
        let failed = [(true, SwitchOnDisabled), (true, OperationEnabled), (true, Fault)];
        assert_eq!(after(&failed), (Power::Failed, 0));
        // its fault goes by itself: it is not switched on by that
        let mut gone = failed.to_vec();
        gone.push((true, SwitchOnDisabled));
        assert_eq!(after(&gone), (Power::Failed, 0));
        let mut again = failed.to_vec();
        again.extend([(false, Fault), (true, Fault), (true, Fault), (true, SwitchOnDisabled)]);
        assert_eq!(after(&again), (Power::On, 1));
    }
}
