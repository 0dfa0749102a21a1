//! From the machine file's one description to what each crate asks for: the only place that knows
//! all of them.
//!
//! ```text
//!                      ┌─► simulator   sim::Config          the simulated machine
//!                      ├─► homing      kernel::HomingOrder  how its axes find out where they are
//!   store::MachineFile ┼─► control     kernel::Config       the loops
//!   canon::ToolLibrary ┼─► planner     plan::MachineLimits  what may be asked of the machine
//!                      ├─► ratings     Ratings              what drives can hold for ever
//!                      └─► judge       verify::Config       what was asked of the work
//! ```
mod changer;
mod compensation;
mod control;
mod homing;
mod judge;
pub mod machine_file;
mod planner;
mod ratings;
mod scatter;
mod simulator;

pub use changer::magazine;
pub use control::{control, encoder, unreferenced};
pub use homing::{AxisHoming, homing};
pub use judge::{judge, tolerances};
pub use planner::{path_limits, planner};
pub use ratings::{AxisRating, Ratings, SpindleRating, ratings};
pub use scatter::{alignment, judged_tools, real_tools};
pub use simulator::{
    bar, inputs, left_alone, measured_torques, plain_drive, position_drives, simulator,
    simulator_of_part, start, touched,
};
