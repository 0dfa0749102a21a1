//! The control: a program executed on a machine; the loop, what feeds it, what serves it and what observes it.
//!
//! ```text
//!   Ops ─► feeder: Planner ─► steps ─► executor: Kernel::tick ──Command──► machine
//!                                        ▲    │                              │
//!                   services: sync record,    └──────────Feedback◄───────────┤ Sample
//!                   learning, measuring, stops                               │
//!                                                 observers: judge, watch, recorder, trace, log
//! ```
//!
//! One thread does all of it, period by period: two runs of the same inputs are the same to the last bit.
#![forbid(unsafe_code)]

pub mod clock;
pub mod config;
mod executor;
mod feeder;
pub mod job;
mod missed;
pub mod observers;
pub mod operation;
mod override_pace;
pub mod plant;
pub mod polygon;
pub mod recovery;
mod refused;
mod run;
pub mod script;
pub mod services;
mod stall;
pub mod stops;
mod timings;

pub use executor::{Executor, period};
pub use feeder::Feeder;
pub use observers::Observers;
pub use operation::{Control, ControlOptions};
pub use plant::Plant;
pub use refused::Refused;
pub use run::{Loaded, Outcome, ProgramRun, Running};
pub use services::Services;
pub use timings::{TickTimes, Timings};
