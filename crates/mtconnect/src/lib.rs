//! An `MTConnect` 2.4 agent of one machine: what it is made of, what was observed of it, and the
//! documents that a client reads.
//!
//! ```text
//!   machine file ─► Device (components, data items)
//!                      │                                ┌─► Devices, Streams, Assets, Error ─► XML, or JSON where it is asked for
//!   pictures, events ─► feed ─► Buffer (sequence numbers)┘
//!                                  ▲
//!   query ─► path, from, count, at ┘
//! ```
//!
//! | file | is |
//! |---|---|
//! | `device`, `items` | the device model: components and data items of a machine |
//! | `buffer` | observations with sequence numbers; what is true at each of them |
//! | `feed` | from a control's pictures and events to observations |
//! | `path` | the part of `XPath` that names components and data items |
//! | `query` | the parameters of a request, with their limits |
//! | `agent` | what is answered |
//! | `topics` | what is published: each observation by itself, the device, its assets |
//! | `documents`, `element` | documents, as a tree and as text |
//!
//! It is read-only by construction: it has pictures and events, and no way to ask a control for
//! anything. Words and numbers are the standard's; what only Leadscrew knows (sync error, class,
//! verdict, recovery) stands in its own namespace, whose schema is [`SCHEMA`].
#![forbid(unsafe_code)]

mod agent;
mod buffer;
mod device;
mod documents;
mod element;
mod feed;
mod items;
mod path;
mod query;
mod topics;

pub use agent::{Agent, Chunk, Identity};
pub use buffer::MOST_OBSERVATIONS;
pub use element::{Element, JsonForm};
pub use feed::Observable;
pub use query::{
    AssetQuery, CurrentQuery, ErrorCode, MOST_COUNT, ProbeQuery, QueryError, SampleQuery,
};
pub use topics::ItemMessage;

/// The schema of what Leadscrew adds to the standard's streams.
pub const SCHEMA: &str = include_str!("../schemas/leadscrew-streams-1.0.xsd");
