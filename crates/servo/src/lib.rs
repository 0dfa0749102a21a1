//! What a servo thread does between its rings and the kernel, in whichever process it runs; and
//! what crosses those rings, as bytes.
//!
//! ```text
//!   control                                        servo thread, a turn per servo period
//!     steps     ───────────────────────────────►   into the kernel's queue
//!     requests  ── Request ────────────────────►   served between two ticks
//!                ◄──────────────── Replied ────
//!     observers ◄── Record: sample, picture ───    after each tick
//!     services  ◄── Said: events, answers, … ──
//!     any thread ── StopLane: flags ───────────►   before all others, in the next period
//! ```
//!
//! [`Seat`] is the right-hand side over rings of any kind ([`Rings`]): within a process they hold
//! the values themselves, between two processes bytes in shared memory. [`encode`] and [`decode`]
//! make these bytes, without taking memory. What comes out of bytes is believed to be of its type
//! and nothing more: [`decode`] refuses numbers that are none, lengths beyond all bounds and what
//! follows the end; [`check_step`] and [`check_request`] refuse what names a spindle or an axis
//! that no machine has.
mod bytes;
mod check;
mod message;
mod period;
mod seat;
mod stop_lane;

pub use bytes::{Unreadable, decode, encode};
pub use check::{Senseless, check_request, check_step};
pub use message::{Record, Replied, Said, SetUp};
pub use period::{PeriodAnswer, answer};
pub use seat::{Rings, Seat};
pub use stop_lane::{LaneStop, StopLane, stop};
