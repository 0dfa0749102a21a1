//! Axes coupled to a spindle: the coupling, its measure, the master's observer, and the rigid tap.
//!
//! ```text
//!    z │                          a follower axis is a function of a master angle:
//!      │ start                        z = g(θ)
//!   z₀ ┼──●                       tapping: a line.  Engage it, measure it (e = z − g(θ)),
//!      │    ╲   e { ○ measured    obey it from a *commanded* or from a *measured* θ.
//!      │      ╲
//!      └──┼──────────► θ
//!         θ₀
//! ```
//!
//! Nothing here knows programs, clocks or drives: angles and positions come in, angles and
//! positions go out, once a period.
#![no_std]
extern crate alloc;
#[cfg(test)]
extern crate std;

mod blend;
mod compensate;
mod coupling;
mod deviation;
mod drive_ramp;
mod gear;
mod halting;
pub mod iteration;
mod learning;
pub mod leaving;
mod measure;
mod mode;
mod monitor;
mod observer;
mod periodic;
pub mod recovery;
mod repetition;
mod smooth;
mod spectrum;
mod stopping;
mod strokes;
mod superposed;
pub mod supervision;
mod tapping;
mod told;

pub use blend::{Blend, BlendPoint};
pub use compensate::{
    DriveLoops, MOST_BOOST, NotMeasured, Response, ShiftOverSpeed, advanced, whole_addresses,
};
pub use coupling::{Coupling, Follower, Line, Rotation};
pub use deviation::{Deviation, DeviationPoint, DeviationTable, DeviationValue, DeviationWave};
pub use drive_ramp::DriveRamp;
pub use gear::{Engagement, Engaging, Gear, Travel};
pub use halting::{Braking, Course, Goal, Halt, Halting};
pub use iteration::{IterationProgress, Taught};
pub use learning::{CELLS, Channel, Correction, Learning, LearningRecord, StrokeKey};
pub use measure::{Estimate, HARMONICS, MeasureError, Pair, PhaseError, fold, phase_error};
pub use mode::{MAX_TRANSPORT, Prediction, SyncMode};
pub use monitor::{Figures, Monitor, Verdict, Windows};
pub use observer::{Observer, Tracker};
pub use periodic::{FEWEST_NODES, MOST_NODES, Periodic, PeriodicError, PeriodicPoint};
pub use repetition::{Repetition, RepetitionOptions};
pub use smooth::SmoothObserver;
pub use spectrum::{Complex, Spectrum};
pub use stopping::{Stopping, stopping_angle};
pub use strokes::{Stroke, StrokePoint};
pub use superposed::{Fade, Swing};
pub use tapping::{Ask, Cycle, Phase, Tap, Tick};
pub use told::{Slowing, Spoken, Told};
