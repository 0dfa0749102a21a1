//! The states of a drive as a table.
//!
//! ```text
//!   Not ready ─► Switch on disabled ─► Ready to switch on ─► Switched on ─► Operation enabled
//!                       ▲  ▲                                                      │
//!                       │  └───────────── Quick stop active ◄─────────────────────┤
//!                       └── Fault ◄── Fault reaction active ◄── from every state ─┘
//! ```
//!
//! The control word orders by its bits 0 to 3, and bit 7 resets a fault at its rising edge.

/// State of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DriveState {
    /// Start of its electronics.
    #[default]
    NotReadyToSwitchOn,
    /// High voltage may not be applied.
    SwitchOnDisabled,
    /// High voltage may be applied.
    ReadyToSwitchOn,
    /// High voltage is applied; no torque.
    SwitchedOn,
    /// It follows its setpoints.
    OperationEnabled,
    /// It brakes, or stands with torque.
    QuickStopActive,
    /// A fault was found, and it reacts.
    FaultReactionActive,
    /// A fault was found; no torque.
    Fault,
}

use DriveState::{
    Fault, FaultReactionActive, NotReadyToSwitchOn, OperationEnabled, QuickStopActive,
    ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn,
};

/// Bit of the control word that resets a fault.
const RESET: u16 = 0x80;

/// Where each order leads, by state: disable voltage, quick stop, shutdown, switch on, enable
/// operation.
#[rustfmt::skip]
const ORDERS: [(DriveState, [DriveState; 5]); 5] = [
    (SwitchOnDisabled, [SwitchOnDisabled, SwitchOnDisabled, ReadyToSwitchOn, SwitchOnDisabled, SwitchOnDisabled]),
    (ReadyToSwitchOn,  [SwitchOnDisabled, SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn,       SwitchedOn]),
    (SwitchedOn,       [SwitchOnDisabled, SwitchOnDisabled, ReadyToSwitchOn, SwitchedOn,       OperationEnabled]),
    (OperationEnabled, [SwitchOnDisabled, QuickStopActive,  ReadyToSwitchOn, SwitchedOn,       OperationEnabled]),
    (QuickStopActive,  [SwitchOnDisabled, QuickStopActive,  QuickStopActive, QuickStopActive,  QuickStopActive]),
];

/// Returns the order of a control word as a column of the table.
fn order(control: u16) -> usize {
    match control {
        c if c & 2 == 0 => 0,
        c if c & 4 == 0 => 1,
        c if c & 1 == 0 => 2,
        c if c & 8 == 0 => 3,
        _ => 4,
    }
}

/// Returns the state that a control word leads to, one transition a call. `before` is the control
/// word of the last call: a fault is reset by the edge of bit 7 alone.
pub fn next_state(state: DriveState, control: u16, before: u16) -> DriveState {
    match state {
        NotReadyToSwitchOn => SwitchOnDisabled,
        Fault if control & !before & RESET != 0 => SwitchOnDisabled,
        Fault | FaultReactionActive => Fault,
        _ => {
            let row = ORDERS.iter().find(|(of, _)| *of == state);
            row.map_or(state, |(_, to)| to[order(control)])
        }
    }
}

/// Returns the status word of a state: its bits 0 to 3, 5 and 6, bit 4 (voltage), bit 9 (remote).
pub fn status_word(state: DriveState) -> u16 {
    let bits = match state {
        NotReadyToSwitchOn => 0x0000,
        SwitchOnDisabled => 0x0040,
        ReadyToSwitchOn => 0x0021,
        SwitchedOn => 0x0023,
        OperationEnabled => 0x0027,
        QuickStopActive => 0x0007,
        FaultReactionActive => 0x000F,
        Fault => 0x0008,
    };
    let has_voltage = matches!(state, SwitchedOn | OperationEnabled | QuickStopActive);
    bits | 0x0200 | u16::from(has_voltage) << 4
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_control_words_enable_a_drive() {
        let states = [6, 7, 15].iter().scan(SwitchOnDisabled, |state, control| {
            *state = next_state(*state, *control, 0);
            Some(*state)
        });
        assert_eq!(states.collect::<Vec<_>>(), [ReadyToSwitchOn, SwitchedOn, OperationEnabled]);
    }

    #[test]
    fn a_fault_is_reset_by_an_edge_and_by_nothing_else() {
        for control in 0..=u16::MAX {
            assert_eq!(next_state(Fault, control, control), Fault);
            let expected = if control & 0x80 == 0 { Fault } else { SwitchOnDisabled };
            assert_eq!(next_state(Fault, control, 0), expected);
        }
    }

    #[test]
    fn only_the_enable_order_enables() {
        for control in 0..=u16::MAX {
            let enables = next_state(SwitchedOn, control, 0) == OperationEnabled;
            assert_eq!(enables, control & 0x0F == 0x0F);
        }
    }
}
