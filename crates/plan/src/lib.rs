//! From operations to motion: paths with time along them, spindle profiles, and the refusal of what
//! a machine cannot do, before it moves.
//!
//! ```text
//!   canon::Op ─► Planner (limits of the machine) ─► crate::Step ─► kernel (evaluates, bounded cost)
//! ```
//!
//! | file | answers |
//! |---|---|
//! | `planner` | which steps an op becomes, in which order; what refuses it |
//! | `along`, `travel` | how fast a path may be run; whether it stays within the travel |
//! | `stroke`, `curve` | a tap's spindle profile; the drive's torque and power curve |
//! | `ramp` | the fastest change of speed under a ceiling and a jerk |
//! | `coupled` | tables of what is superposed on an axis |
//! | `tap_check`, `holes` | taps that cannot come out right |
//! | `planner::contact`, `stock`, `bar`, `chip` | the tool against the stock: what would break it |
//! | `run` | moves that go on into one another (crate `path`) |
//! | `sample` | a sample of such moves: what a long program takes, without planning all of it |
//! | `ends` | where the program's lines end on a joined path |
//! | `repace` | what was handed on and not yet done, planned anew: for more feed, for stops at each line |
//! | `timing` | one law of time along a path, as steps |
//! | `clock` | how long steps will take |
//! | `words` | places, lengths and feeds as the program writes them |
//!
//! Findings have codes that stay: M0301 travel, M0302 coordinate, M0303 feed, M0304 feed clipped,
//! M0305 axis missing, M0306 G95 at rest, M0307 cutting at rest, M0308 spindle speed, M0309 tool
//! missing, M0310 G96 where the tool turns, M0319 G96, M0311 arc, M0312 dwell, M0313 spindle
//! missing, M0314 endless block, M0315 no drill, M0317 pocket, M0318 continuous torque, M0375 tool
//! in no pocket, M0376 pocket at the spindle not known; taps: M0320 feed axis too slow, M0321
//! tapping maximum, M0322 flutes, M0323 hole depth, M0324 hole not drilled here, M0325 hole
//! diameter, M0326 lead, M0327 hand, M0328 no tap, M0329 no tool, M0330 another axis moves, M0331
//! spindle too weak, M0332 return slowed, M0333 no tap at all, M0334 not along the tool axis, M0335
//! beside its hole, M0336 blind hole too near for this spindle, M0337 no angle, M0338 a spindle
//! that coasts when the control dies; clutch and floating holders: M0340 dwell, M0341 depth, M0342
//! travel, M0343 words; chip removal: M0350 too fast for the spindle, M0351 not against the cut;
//! M0355 a face thread, tap or gear with G96, M0356 a thread with it; tool and stock: M0360 rapid
//! into it, M0361 sideways in it, M0362 fed at rest, M0363 fed too fast, M0364 tap without its
//! cycle, M0365 length offset, M0370 no such input, M0371 no such output, M0372 no probe, M0373 no
//! tool of those selected, M0374 deep without pecks, M0366 nothing is cut, M0367 reach, M0368
//! chamfer, M0369 zero, M0434 depth of a hob, M0435 another hob, M0436 blank of a gear; polygon
//! turning: M0401 spindles missing, M0402 ratio, M0403 work spindle at rest, M0404 tool spindle too
//! fast; cam grinding: M0411 no such profile, M0412 nothing sampled, M0413 not measured, M0414 too
//! fast, M0415 wheel too near; turned threads: M0421 spindle at rest, M0422 stretch too short,
//! M0423 axis too slow, M0424 lead, M0425 another axis, M0426 run-in too short, M0427 left hand.
#![no_std]
#![allow(clippy::large_types_passed_by_value)] // a path is moved once, into its step
extern crate alloc;

mod along;
mod bar;
mod beside;
mod bodies;
mod boxed;
mod cams;
mod chip;
mod clock;
mod clutch;
mod coupled;
mod curve;
mod edges;
mod ends;
mod findings;
mod heat;
mod holes;
mod left_alone;
mod limits;
mod outbox;
mod planner;
mod ramp;
mod repace;
mod run;
mod sample;
mod settings;
mod signals;
mod stock;
mod stroke;
mod take_over;
mod tap_check;
mod thread;
mod timing;
mod travel;
mod way_out;
mod words;

pub use bar::Bar;
pub use beside::SideBySide;
pub use bodies::{Bodies, Cylinder, Turret};
pub use boxed::{Boxed, SpindleStep, Step, StepKind};
pub use cams::{CamCommand, Cams, Course, TURN_ENDED, WheelWear, turned};
pub use clock::Clock;
pub use clutch::{ClutchCycle, DwellWindow};
pub use coupled::{OSCILLATION_SEEN, Table, sampled};
pub use left_alone::{coasts, overrun, survives};
pub use limits::{
    AxisLimits, Coasts, DwellCheck, Effort, Joining, MachineLimits, Options, OwnRamps, PlainDrive,
    Retract, SignalNames, SpindleLimits, TapMethod, Tapping, ToolChange, Unsynchronised,
};
pub use planner::{Changer, Planner, Preflight, SequenceMark, Start, preflight};
pub use ramp::rest_to_rest;
pub use sample::{FeedAndRapid, Sample, Stretch};
pub use settings::OperatorSettings;
pub use stock::Stock;
pub use stroke::{Stroke, StrokeRequest, tapping_torque};
pub use take_over::{TakeOver, cut, take_over};
