//! The application layer's state machine as a table: 25 transitions, each allowed, checked or
//! refused.
//!
//! ```text
//!   INIT ◄──► PRE-OP ◄──► SAFE-OP ◄──► OP      up a step at a time, down any number of steps
//!     ▲
//!     └──► BOOT                                only from INIT, only back to INIT
//! ```
//!
//! A refusal leaves the device where it was, sets bit 4 of the status and gives the reason in 0134;
//! until that is acknowledged (bit 4 of the control) every other request is ignored
//! (ETG.1000.6, 6.4; ETG.1020, codes).

/// Bit 4: error, in the status; acknowledgement, in the control.
pub(crate) const ERROR: u8 = 0x10;

/// State of a device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum AlState {
    /// No communication of the application layer.
    #[default]
    Init = 1,
    /// The mailbox works.
    PreOp = 2,
    /// Firmware can be loaded.
    Boot = 3,
    /// Inputs are valid, outputs are held in a safe state.
    SafeOp = 4,
    /// Inputs and outputs are valid.
    Op = 8,
}

impl AlState {
    /// All states, in the order of the table.
    pub const ALL: [Self; 5] = [Self::Init, Self::PreOp, Self::Boot, Self::SafeOp, Self::Op];

    /// Returns the state of a code; `None` where there is none.
    pub fn of(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|state| *state as u8 == code)
    }

    fn row(self) -> usize {
        match self {
            Self::Init => 0,
            Self::PreOp => 1,
            Self::Boot => 2,
            Self::SafeOp => 3,
            Self::Op => 4,
        }
    }
}

/// Why a transition was refused, or a state left; code of register 0134.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum AlCode {
    /// There is no way from this state to that one.
    InvalidRequestedStateChange = 0x0011,
    /// There is no such state.
    UnknownRequestedState = 0x0012,
    /// The device has no bootstrap state.
    BootstrapNotSupported = 0x0013,
    /// Sync managers 0 and 1 are not as the device needs them.
    InvalidMailboxConfiguration = 0x0016,
    /// No outputs have come.
    NoValidOutputs = 0x0019,
    /// No outputs have come for longer than the watchdog allows.
    SyncManagerWatchdog = 0x001B,
    /// The sync manager of the outputs does not fit the assigned PDOs.
    InvalidOutputConfiguration = 0x001D,
    /// The sync manager of the inputs does not fit the assigned PDOs.
    InvalidInputConfiguration = 0x001E,
    /// SYNC0 does not come.
    NoSyncError = 0x002D,
    /// The activation of SYNC0 and SYNC1 is not the one that the device needs.
    InvalidDcSyncConfiguration = 0x0030,
    /// The device cannot run at this cycle time.
    InvalidSyncCycleTime = 0x0035,
}

/// What a request does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transition {
    /// Nothing: the device is there.
    Stay,
    /// Goes down: always possible.
    Down,
    /// Goes up if the mailbox is configured.
    StartMailbox,
    /// Goes to BOOT if the device has it.
    StartBootstrap,
    /// Goes up if process data are configured.
    StartInputs,
    /// Goes up if outputs come, and SYNC0 if it was asked for.
    StartOutputs,
    /// Is refused: there is no such way.
    Refuse,
}

use Transition::{Down, Refuse, StartBootstrap, StartInputs, StartMailbox, StartOutputs, Stay};

/// What a request does, by the state of a device (rows) and the one requested (columns), each in
/// the order of [`AlState::ALL`].
pub const TRANSITIONS: [[Transition; 5]; 5] = [
    // INIT       PRE-OP        BOOT            SAFE-OP      OP
    [Stay, StartMailbox, StartBootstrap, Refuse, Refuse], // INIT
    [Down, Stay, Refuse, StartInputs, Refuse],            // PRE-OP
    [Down, Refuse, Stay, Refuse, Refuse],                 // BOOT
    [Down, Down, Refuse, Stay, StartOutputs],             // SAFE-OP
    [Down, Down, Refuse, Down, Stay],                     // OP
];

/// Returns what a request does.
pub(crate) fn transition(from: AlState, to: AlState) -> Transition {
    TRANSITIONS[from.row()][to.row()]
}
