//! The same engine by the clock: kernel and machine in a thread of their own, everything else
//! beside it.
//!
//! ```text
//!   control's thread                                        servo thread, one turn per servo period
//!     feeder    ── steps ────────────────────────────────►  steps into the kernel's queue
//!                ◄──────────────────── empty steps ──────   (their memory is released where it was taken)
//!     requests  ── Request ─────────────────────────────►   served between two ticks
//!                ◄──────────────────── Reply, Picture ───
//!     observers ◄── Record: sample, picture ─────────────   tick, exchange with the machine
//!     services  ◄── events, answers, record requests ────
//! ```
//!
//! Every arrow is a ring of fixed size for one writer and one reader; the servo thread waits for
//! none of them, takes no lock, and its control part takes no memory between the start and the end
//! of a program. What it cannot hand on is counted. The first tick comes when the feeder has filled
//! its ring, or has half a second of motion in it, and from then on a program whose course asks
//! nothing of the other thread is executed as in lock-step, to the last bit.
mod bridge;
mod kernel_link;
mod machine_link;
mod metrics;
mod scheduling;
mod servo;

pub(crate) use kernel_link::KernelLink;
pub(crate) use machine_link::MachineLink;
pub use metrics::RealTimeFigures;
pub(crate) use metrics::ServoMetrics;
pub use scheduling::{WAKE_UP_FILE, numbers_of_list, run_by_deadline, run_last, servo_core};
pub(crate) use servo::{ServoThread, prepare, strike};

/// Steps on their way to the kernel, beside those in its own queue.
const STEPS: usize = 1024;
/// Records that the other thread has not looked at yet: a second at 4 kHz.
const RECORDS: usize = 4096;
/// What the kernel has said.
const SAID: usize = 1024;
/// Requests under way.
const REQUESTS: usize = 16;

/// How the servo thread is run.
#[derive(Clone, Copy, Debug)]
pub struct RealTimeOptions {
    /// Priority of the servo thread among those that the operating system runs by deadline
    /// (`SCHED_FIFO`), 1 to 99.
    pub priority: u8,
    /// Called with the control's part of each period; it calls what it is given. Tests look here
    /// for what may not happen.
    pub around: fn(&mut dyn FnMut()),
}

impl Default for RealTimeOptions {
    fn default() -> Self {
        Self { priority: 80, around: |part| part() }
    }
}
