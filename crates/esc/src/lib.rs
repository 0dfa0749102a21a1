//! Emulated EtherCAT devices: what a master finds on the wire, without a wire.
//!
//! ```text
//!   frame ─► Segment::pass ─► coupler ─► drive ─► drive ─► … ─► I/O ─┐
//!   frame ◄──────────────────────────────────────────────────────────┘
//!
//!   device:  Esc            registers 0000-0FFF, FMMUs, sync managers, EEPROM, clock
//!              │ AL control, mailbox, process data, SYNC0
//!              ▼
//!            application    object dictionary (CoE), CiA 402 drive, digital I/O, encoder
//! ```
//!
//! A frame is processed on the fly: each device executes each datagram as it passes. Time is an
//! argument of [`NetworkSegment::pass`], in nanoseconds, so that two runs of the same frames at the
//! same times are bit-identical. What is known of devices that behave otherwise than the standards
//! have it is a switch of [`Quirks`].
//!
//! Sources: ETG.1000.4 (data link layer), ETG.1000.6 (application layer), ETG.1020 (protocol
//! enhancements), ETG.2010 (SII), ETG.6010 and IEC 61800-7-201 (CiA 402), the register description
//! of Beckhoff's ESC data sheet, section II.

mod al;
mod clock;
mod coe;
mod controller;
mod device;
mod devices;
mod eeprom;
mod fmmu;
mod frame;
mod memory;
mod profile;
mod quirks;
mod registers;
mod segment;
mod sii;
mod sync_manager;

pub use al::{AlCode, AlState, TRANSITIONS, Transition};
pub use coe::{
    Abort, Access, Allowed, DataType, Dictionary, Emergency, Handle, Object, ObjectEntry,
    ObjectKind, ObjectValue,
};
pub use device::{Device, Latency};
pub use devices::{DriveModel, coupler, digital_io, drive, encoder};
pub use frame::{Datagram, DatagramCommand, EMPTY_FRAME, datagrams, has_ethercat_type};
pub use profile::{DriveState, HomingSwitches, Motor, MotorOrder, next_state, status_word};
pub use quirks::Quirks;
pub use segment::{NetworkSegment, Passed};
pub use sii::Identity;
