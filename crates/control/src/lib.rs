//! The control: a program executed on a machine; the loop, what feeds it, what serves it and what
//! observes it.
//!
//! ```text
//!   Ops ─► feeder: Planner ─► steps ─► executor: Kernel::tick ──Command──► machine
//!                                        ▲    │                              │
//!                   services: sync record,    └──────────Feedback◄───────────┤ Sample
//!                   learning, measuring, stops                               │
//!                                                 observers: judge, watch, recorder, trace, log
//! ```
//!
//! In lock-step one thread does all of it, period by period: two runs of the same inputs are the
//! same to the last bit. In real time kernel and machine have a thread of their own (`real_time`),
//! and everything else is as it was.
#![forbid(unsafe_code)]

mod ahead;
pub mod clock;
pub mod config;
pub mod drives;
mod executor;
mod feeder;
mod handles;
pub mod job;
mod messages;
mod missed;
pub mod observers;
pub mod operation;
mod outcome;
mod override_pace;
pub mod polygon;
mod real_time;
pub mod recovery;
mod refused;
mod run;
pub mod script;
pub mod services;
mod stall;
pub mod stops;
mod timings;

pub use drives::{Door, Drives, DrivesChoice};
pub use executor::{Executor, period};
pub use feeder::Feeder;
pub use handles::{KernelHandle, MachineHandle};
pub use observers::Observers;
pub use operation::{Control, ControlOptions};
pub use outcome::{EndedRun, Outcome};
pub use real_time::{
    RealTimeFigures, RealTimeOptions, WAKE_UP_FILE, numbers_of_list, run_by_deadline, run_last,
    servo_core,
};
pub use refused::Refused;
pub use run::{Loaded, ProgramRun, Running};
pub use services::Services;
pub use timings::{TickTimes, Timings};
