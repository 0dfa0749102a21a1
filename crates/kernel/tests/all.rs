//! What the kernel does on the simulated machine: one test program, so that it is linked once.
#![allow(
    clippy::large_stack_arrays,
    clippy::large_types_passed_by_value,
    clippy::unwrap_used,
    dead_code,
    unreachable_pub
)] // tests may panic, and what they share is not used by each

mod campaign;
mod common;
mod operated;

mod chip_removal;
mod compensation;
mod config;
mod coupled;
mod curves;
mod encoder_check;
mod end_of_travel;
mod faults;
mod following;
mod guards;
mod homing;
mod interlocks;
mod learning;
mod limits;
mod lost_feedback;
mod manual;
mod orientation;
mod overrides;
mod own_ramps;
mod plant;
mod plate;
mod position_drive;
mod program;
mod properties;
mod rough;
mod signals;
mod slots;
mod spindle_override;
mod stop_campaign;
mod stopping_distance;
mod stops;
mod stuck_spindle;
mod supervision;
mod supervision_campaign;
mod surface_speed;
mod tapping;
mod thread_withdrawal;
mod threading;
mod turning_back;
