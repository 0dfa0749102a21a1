//! Kernel and control in two processes of one computer: rings in shared memory.
//!
//! ```text
//!   control's process                    shared memory                     process of the servo thread
//!     ControlSide    set-up   ───────►   rings of fixed slots  ───────►    SetUps      beside the servo thread
//!                    requests, steps ─►  counts, signs of life ───────►    ServoSide   in it
//!                    ◄──────── replies, said, records  ◄───────────────
//! ```
//!
//! Neither side trusts what it reads ([`mapping`](Mapping): nothing but atomic words;
//! [`ring`](RingReader): counts and lengths that cannot be are damage; [`servo::decode`]: nothing
//! but what can be). A side that ends, however it ends, leaves the other one running.
mod attendant;
mod control_side;
mod layout;
mod mapping;
mod retained;
mod ring;
mod servo_process;
mod servo_side;
mod session;

pub use control_side::{ControlSide, Error};
pub use layout::{BUILD_MARK, BUILD_WORDS, STEPS_BEFORE, STEPS_USUAL, memory_name};
pub use mapping::Mapping;
pub use retained::{RetainedMemory, RetainedState, TiedPeriod};
pub use ring::{Damaged, Place, RingReader, RingWriter};
pub use servo_process::{Fieldbus, Marks, ServoProcess, WriteTo};
pub use servo_side::{Made, ServoSide, SetUps, make};
pub use session::ServoProcessOptions;
