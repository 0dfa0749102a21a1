//! Machines made of equations: what the control moves when there is no real machine.
//!
//! ```text
//!              Command                          Feedback, Truth
//!   control ────────────► SimulatedMachine ─────────────────────► control, judge
//!                          │ axes      two masses, play, LuGre friction, encoder, switches, hard stops
//!                          │ spindles  inertia, lag, torque and power limit, encoder
//!                          │ changer   tools from a magazine
//!                          ├ bar       a single point in it: groove, force, torque
//!                          ├ work      drill and tap in it: holes, torque, force, breakage
//!                          └ grinder   a wheel against a cam's blank: force, deflection, spark-out, wear
//! ```
//!
//! The crate knows the bus and quantities, nothing else: no program, no plan, no control. It is
//! built from a plain [`Config`], it is seeded, and two runs of the same inputs are the same to the
//! last bit. The closed forms it is tested against are public, in [`oracle`].

mod axis;
mod carousel;
mod changer;
mod clutch;
mod config;
mod cutting;
mod drilling;
mod encoder;
mod fault;
mod friction;
mod grinding;
mod lag;
mod machine;
mod measured;
mod mishaps;
pub mod oracle;
mod plain_drive;
mod plant;
mod position_drive;
mod rng;
mod run_down;
mod scatter;
mod seat;
mod signals;
mod spindle;
mod tapping;
mod tool;
mod touch;
mod travel;
mod turning;
mod wear;
mod work;

pub use axis::AxisModel;
pub use carousel::{CarouselMishap, CarouselModel, CarouselTruth};
pub use config::Config;
pub use encoder::{AxisEncoder, SpindleEncoder};
pub use fault::{Fault, Faulty, LeftAlone, Planned, Trigger};
pub use friction::Lugre;
pub use grinding::{Blank, Grinding, NODES, Wheel};
pub use machine::SimulatedMachine;
pub use measured::{MeasuredTorque, MeasuredTorques};
pub use mishaps::Mishaps;
pub use plain_drive::PlainDrive;
pub use plant::{AxisErrors, AxisScatter, ScrewGrowth, SpindleScatter};
pub use position_drive::PositionDrive;
pub use run_down::{Bus, RunDown};
pub use scatter::drawn;
pub use signals::{Input, InputSource};
pub use spindle::SpindleModel;
pub use tool::{CLUTCH_RUN_OUT, Clutch, HOLDER_STOP, Holder, Tap, Tool, ToolKind};
pub use touch::{Boss, ToolSetter, TouchProbe};
pub use travel::{HomeSwitch, IndexMarks, PowerOn, Travel};
pub use turning::{Bar, Edges, Insert, KIENZLE, Kienzle, PolygonCutter};
pub use wear::TapWear;
pub use work::{Bore, Hole, SAME_HOLE, Sides, Stock, Thread};

#[cfg(test)]
extern crate self as sim;
#[cfg(test)]
#[path = "../tests/fixtures/mod.rs"]
mod fixtures;
