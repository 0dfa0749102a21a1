//! The states of a drive by its status word, and the control word that brings it a step nearer to
//! where it is wanted: pure functions (IEC 61800-7-201, CiA 402).
//!
//! ```text
//!   status   xxxx xxxx x0xx 0000  not ready to switch on     x01x 0111  operation enabled
//!            xxxx xxxx x1xx 0000  switch on disabled         x00x 0111  quick stop active
//!            xxxx xxxx x01x 0001  ready to switch on         x0xx 1111  fault reaction active
//!            xxxx xxxx x01x 0011  switched on                x0xx 1000  fault
//!   control  0000 disable voltage · 0006 shutdown · 0007 switch on · 000F enable · 0002 quick stop ·
//!            0080 reset of a fault, by its edge
//! ```

/// State of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PdsState {
    /// Start of its electronics.
    NotReadyToSwitchOn,
    /// It waits for the order to get ready.
    SwitchOnDisabled,
    /// It waits for the order to switch on.
    ReadyToSwitchOn,
    /// It has voltage and no torque.
    SwitchedOn,
    /// It follows its setpoints.
    OperationEnabled,
    /// It brakes.
    QuickStopActive,
    /// It has found a fault and reacts.
    FaultReactionActive,
    /// It has found a fault, and waits for the reset.
    Fault,
}

/// State wanted of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wanted {
    /// No torque.
    #[default]
    Off,
    /// It follows its setpoints.
    On,
    /// It brakes by itself, and has no torque then.
    QuickStop,
}

/// Control word: nothing is ordered, and no voltage is wanted.
pub const DISABLE_VOLTAGE: u16 = 0x0000;
/// Control word: quick stop.
pub const QUICK_STOP: u16 = 0x0002;
/// Control word: get ready to switch on.
pub const SHUTDOWN: u16 = 0x0006;
/// Control word: switch on, or disable operation.
pub const SWITCH_ON: u16 = 0x0007;
/// Control word: follow the setpoints.
pub const ENABLE_OPERATION: u16 = 0x000F;
/// Bit of the control word whose rising edge resets a fault.
pub const FAULT_RESET: u16 = 0x0080;

/// Returns the state of a status word; `None` where it is none of the standard's.
pub const fn state(status: u16) -> Option<PdsState> {
    Some(match status & 0x6F {
        0x00 | 0x20 => PdsState::NotReadyToSwitchOn,
        0x40 | 0x60 => PdsState::SwitchOnDisabled,
        0x21 => PdsState::ReadyToSwitchOn,
        0x23 => PdsState::SwitchedOn,
        0x27 => PdsState::OperationEnabled,
        0x07 => PdsState::QuickStopActive,
        0x0F | 0x2F => PdsState::FaultReactionActive,
        0x08 | 0x28 => PdsState::Fault,
        _ => return None,
    })
}

/// Returns the control word of the next step from a status word to the state that is wanted. With
/// `reset`, the bit that resets a fault is set while there is one.
#[allow(clippy::match_same_arms)] // a row is a state and what is wanted of it
pub const fn control_word(status: u16, wanted: Wanted, reset: bool) -> u16 {
    let Some(state) = state(status) else { return DISABLE_VOLTAGE };
    match (state, wanted) {
        (PdsState::Fault, _) if reset => FAULT_RESET,
        (PdsState::Fault | PdsState::FaultReactionActive | PdsState::NotReadyToSwitchOn, _) => {
            DISABLE_VOLTAGE
        }
        (PdsState::QuickStopActive, Wanted::QuickStop) => QUICK_STOP,
        (PdsState::QuickStopActive, _) => DISABLE_VOLTAGE,
        (PdsState::SwitchOnDisabled, Wanted::On) => SHUTDOWN,
        (PdsState::ReadyToSwitchOn, Wanted::On) => SWITCH_ON,
        (PdsState::SwitchedOn | PdsState::OperationEnabled, Wanted::On) => ENABLE_OPERATION,
        (PdsState::OperationEnabled, Wanted::QuickStop) => QUICK_STOP,
        (PdsState::OperationEnabled, Wanted::Off) => SWITCH_ON,
        (PdsState::SwitchedOn, _) => SHUTDOWN,
        (PdsState::ReadyToSwitchOn | PdsState::SwitchOnDisabled, _) => DISABLE_VOLTAGE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_with_a_fault_is_never_told_to_enable() {
        for status in 0..=u16::MAX {
            let faulty = matches!(
                state(status),
                Some(PdsState::Fault | PdsState::FaultReactionActive) | None
            );
            for wanted in [Wanted::Off, Wanted::On, Wanted::QuickStop] {
                for reset in [false, true] {
                    let control = control_word(status, wanted, reset);
                    assert!(
                        !faulty || control.trailing_zeros() >= 4,
                        "{status:04X}: {control:04X}"
                    );
                    assert!(control & FAULT_RESET == 0 || state(status) == Some(PdsState::Fault));
                    let enables = control & 0x0F == ENABLE_OPERATION;
                    assert!(!enables || wanted == Wanted::On);
                }
            }
        }
    }
}
