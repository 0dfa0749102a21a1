//! What the planner makes of operations: one test program, so that it is linked once.
#![allow(dead_code, unreachable_pub)] // tests may panic, and what they share is not used by each

mod common;

mod any_program;
mod arcs;
mod bar;
mod blending;
mod clearances;
mod clutch;
mod contact;
mod heat;
mod pecks;
mod planner;
mod profiles;
mod refusals;
mod repacing;
mod sampling;
mod side_by_side;
mod splines;
mod strokes;
mod surface_speed;
mod threading;
