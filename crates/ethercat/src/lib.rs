//! The master of an EtherCAT network of drives: from a scan of the wire to cyclic setpoints.
//!
//! ```text
//!   Master::start   scan ─► identity ─► PDOs, read back ─► clock ─► SAFE-OP ─► cyclic data ─► OP
//!   Bus::cycle      one frame: FRMW of the reference clock, LRW of the process image, AL states
//!                     │ lost, short, late, foreign: counted, and the outputs go out again
//!                     ▼
//!   DriveAxis       status word ─► control word, one transition a cycle; the target is the actual
//!                   position until the drive is enabled
//!   MachineDrives   feedback and commands of a machine: counts ─► mm, power, terminals
//! ```
//!
//! Datagrams, EEPROM, mailbox and state requests are `ethercrab`'s; this crate polls it by hand, so
//! that it needs no executor, no thread and, once started, no memory. Time is what the
//! [`FrameLink`] says: virtual in tests, the computer's clock on a wire. The bus is the master of
//! time; the reference clock is read and, after the start, never written.

mod bus;
pub mod cia402;
mod clock;
mod drive;
mod error;
mod exchange;
mod image;
mod link;
mod machine;
mod master;
mod network;
mod pace;
mod pdo;
mod scan;

pub use self::bus::{Bus, Counters, Cycle, Reply};
pub use drive::{DriveAxis, DriveCommand, DriveFeedback};
pub use error::StartError;
pub use exchange::{Emergency, Losses};
pub use image::{Image, ImagePlace};
pub use link::FrameLink;
pub use machine::{Ahead, AxisInputs, CountScale, DriveFault, LedDrive, MachineDrives, Terminal};
pub use master::{Master, Storage};
pub use network::{AxisSlot, Device, DeviceIdentity, DriveMode, Network, Pdo, PdoEntry, Sdo, Sync};
pub use pace::Pacer;
