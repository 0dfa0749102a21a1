//! The state model of a control that stays on: what it is, what can be asked of it, and what each request needs.
//!
//! | file | is |
//! |---|---|
//! | `request` | everything that can be asked for, and what it needs |
//! | `state` | execution, mode, power, emergency stop; the transitions |
mod request;
mod state;

pub use request::{Jog, Refusal, Request};
pub use state::{EmergencyStop, Execution, ExecutionEvent, Mode, Need, Power};
