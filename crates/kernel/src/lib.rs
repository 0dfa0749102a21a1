//! The control: one function per servo period, from what the machine says to what it shall do.
//!
//! ```text
//!            motion::Step (bounded queue)
//!                  │
//!   Feedback ─► tick ─► Command       1 readings, observers     4 setpoints of spindles
//!                  │                  2 faults                  5 servo loops
//!                  └─► Report, events 3 steps: moves, taps      6 report
//! ```
//!
//! The kernel has no clock (time arrives in `Feedback`), no heap after [`Kernel::new`], no thread,
//! no `Result` from the tick: what goes wrong is a [`Fault`], and the machine is stopped the way it
//! asks for. A function can be proved by calling it: the same inputs give the same outputs, to
//! the bit.
#![no_std]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod axis;
mod chips;
mod compensation;
mod config;
mod coupled;
mod drives;
mod encoder_check;
mod encoder_plausibility;
mod event;
mod execute;
mod fault;
mod feedback_age;
mod friction;
mod homing;
mod kernel;
mod learning_records;
mod manual;
mod moving;
mod operator;
mod picture;
mod plans;
mod problems;
mod queue;
mod record_requests;
mod recovering;
mod requests;
mod retreating;
mod sequence_steps;
mod servo;
mod setpoint_monitor;
mod sight;
mod signals;
mod spindle;
mod spindle_monitor;
mod stroke;
mod supervised;
mod supervision;
mod tapping;
mod terms;
mod threading;
mod time_scaling;
mod track;
mod waiting;
mod waits;
mod withdrawing;

pub use compensation::{AxisCompensation, DeviationTables, SpindleCompensation};
pub use config::{
    AxisControl, AxisEncoder, AxisFriction, AxisWindows, Config, EncoderCheckControl, EncoderPlace,
    FeedForward, OverloadReaction, OwnRamps, Pause, PhaseLoss, SpindleControl, SpindleFriction,
    SpindleWindows, Subject, SupervisionControl, TorqueReading, Waits,
};
pub use coupled::TABLES;
pub use event::{EVENTS, Event, EventKind, RecoveryFigures, TapFigures};
pub use fault::{AlarmList, Fault, FaultKind, Reaction};
pub use homing::{HomingMethod, HomingOrder};
pub use kernel::{FAULTS, Kernel};
pub use learning_records::LEARNING_RECORDS;
pub use manual::{ManualOrder, ManualRefusal};
pub use operator::{Inhibit, Notice, Operator, Order, Overrides};
pub use picture::Picture;
pub use problems::Problem;
pub use queue::{CHIP_REMOVALS, Full, MOVES, QUEUE, RAMPS, STRETCHES, TAPS};
pub use record_requests::{RECORD_WAIT, RecordRequest, WorkRecord};
pub use recovering::RecoveryPlan;
pub use requests::{Reply, Request};
pub use signals::{Answer, Answered};
pub use supervised::{Crossing, Supervised, TorqueBound};
pub use supervision::BANDS;
pub use sync::{
    CELLS, Correction, Deviation, DeviationPoint, DeviationTable, DeviationWave, Figures, Learning,
    LearningRecord, MAX_TRANSPORT, Periodic, Prediction, StrokeKey, SyncMode, Windows,
};
pub use waiting::{WaitFor, Waiting};
pub use withdrawing::WithdrawalPlan;
