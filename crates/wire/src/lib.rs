//! The bus over a stream of bytes: control and machine simulator in two processes.
//!
//! ```text
//!   control                                                   machine simulator
//!     Hello ───────────────────────────────────────────────────►
//!     ◄─────────────────────── Welcome: which machine, which encoders, where it stands
//!     Command, tool in the work ───────────────────────────────►   each servo period
//!     ◄──────────────────────────────── Observed: feedback, and the truth where it is known
//!                        …
//!     the stream ends, or nothing comes: the drives' own watchdog stops the machine simulator
//! ```
//!
//! A frame, little-endian:
//!
//! | bytes | what |
//! |---|---|
//! | 2 | `LS` |
//! | 1 | version |
//! | 4 | sequence number |
//! | 2 | length of the payload |
//! | … | the message, as postcard writes it |
//! | 4 | CRC-32 of all before it |
//!
//! Each command says which tool the control has in the work. The machine keeps that
//! ([`bus::EngagementEvidence`]): when a control dies, the next one is told of the tool whatever
//! has become of its files, and may move nothing before it has stated it.
//!
//! A frame that is not whole, not this version's, or not in sequence ends the connection: what a
//! drive is told is certain, or it is not told. Neither is a command with a number that is none, or
//! that ties an axis or a spindle which there is not.
mod frame;
mod message;
mod remote;

pub use frame::{LONGEST, VERSION, decode, encode};
pub use message::{Hello, Message, Observed, Order, Welcome};
pub use remote::{Error, Port, Remote, order};
