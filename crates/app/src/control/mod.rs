//! A program executed on a machine: the loop, what feeds it, what serves it and what observes it.
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
mod executor;
mod feeder;
mod missed;
mod observers;
mod override_pace;
mod run;
mod services;
mod stall;
mod timings;

pub(crate) use executor::{Executor, period};
pub(crate) use feeder::Feeder;
pub(crate) use observers::Observers;
pub(crate) use run::{Loaded, Outcome, ProgramRun};
pub(crate) use services::Services;
pub(crate) use timings::{TickTimes, Timings};
