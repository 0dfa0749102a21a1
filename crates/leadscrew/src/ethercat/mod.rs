//! Drives on an EtherCAT network: led by the servo process, and emulated with a simulated machine
//! behind them.
//!
//! ```text
//!   machine file ─► expected_network() ─► Master ─► Bus ◄─ frames ─► drives
//!                └► machine_drives()   ─► MachineDrives ◄─► Handover ◄─► ServoProcess ═ control
//!
//!   simulator    EmulatedMachine: esc's devices, their motors the simulated machine's
//! ```
#[cfg(target_os = "linux")]
mod emulate;
mod emulated;
mod lead;
#[cfg(target_os = "linux")]
mod network_interface;
mod settings;

#[cfg(target_os = "linux")]
pub use emulate::{EmulatedDrivesOptions, emulate_drives};
pub use emulated::EmulatedMachine;
pub use lead::{DrivesReport, EthercatDrives, Handover};
#[cfg(target_os = "linux")]
pub use network_interface::NetworkInterface;
pub use settings::{expected_network, machine_drives};
