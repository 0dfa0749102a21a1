//! The profile of a drive, CiA 402 (IEC 61800-7-201): states, modes of operation, homing, touch
//! probe, and the motor behind them.

mod axis;
mod homing;
mod motor;
mod objects;
mod probe;
mod states;
mod target;

pub(crate) use axis::EmulatedAxis;
pub use homing::HomingSwitches;
pub use motor::{Motor, MotorOrder};
pub(crate) use objects::{axis_objects, default_pdos, supported_modes};
pub use states::{DriveState, next_state, status_word};
