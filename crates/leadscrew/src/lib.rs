//! Leadscrew: an open numerical control for spindle-synchronised machining.
//!
//! A [`Program`] is brought to a machine, checked, timed, and run on the simulated machine; the
//! workpiece is judged.
//!
//! ```no_run
//! use leadscrew::{Ending, Program, RunOptions};
//!
//! let job = Program::open("programs/plate-12xM6.ngc")?.on("tapping-center")?;
//! let mut finished = job.run(&RunOptions::default())?;
//! assert_eq!(finished.ending(), Ending::Good);
//! std::fs::write("report.html", finished.report())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ```text
//!   Program ──on──► Job ─┬─ check ─► findings
//!                        ├─ time  ─► Times
//!                        └─ run   ─► Finished ─► certificate, report
//!   DrivesProcess: kernel and servo thread as a process of their own
//!   simulator: the simulated machine as a process of its own, for controls that connect
//!   doctor: whether this computer can lead a machine
//!   studies: compare (holders), compensation (cams), polygon (from a form to the block that cuts it)
//! ```
#![forbid(unsafe_code)]

mod certificate;
pub mod commission;
pub mod compare;
pub mod compensation;
pub mod doctor;
pub mod editor;
pub mod ethercat;
mod link;
mod machine;
pub mod polygon;
mod program;
mod replay;
mod run;
mod run_outputs;
mod servo_process;
pub mod simulator;
pub mod time;

pub use control::Refused;
pub use control::config::machine_file::MachineSource;
pub use control::job::ProgramOptions;
pub use link::NotReady;
pub use machine::Machine;
pub use program::{Job, Program};
pub use run::{Ending, Finished, Run, RunOptions, Synchronisation, material};
pub use servo_process::{DrivesOptions, DrivesProcess};
