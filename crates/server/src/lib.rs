//! A control over the network: HTTP and WebSocket under `/api/v1`, and the page.
//!
//! ```text
//!   listener ─► connection (limits, timeouts) ─► guard (Host, Origin, session) ─► routes ─┬─► control::operation::hosted::Client
//!                                                                                         ├─► folder of programs
//!                                                                                         └─► page
//! ```
//!
//! | file | is |
//! |---|---|
//! | `listen` | addresses, connections, their limits; `timeouts` how long a client is waited for |
//! | `guard` | who may ask at all: Host, Origin, session, token; headers of every answer |
//! | `rights` | sessions, and which of them commands; `clock` by which they end |
//! | `tokens`, `tls` | the file of tokens; the certificate |
//! | `routes` | the table of addresses, from which router and OpenAPI document are made; a file per concern |
//! | `socket` | WebSocket: status, events, features, requests; `scope` its binary frames |
//! | `mtconnect` | the `MTConnect` agent's addresses and streams |
//! | `mqtt` | what the agent observes, published to a broker |
//! | `metrics` | what Prometheus reads |
//! | `language` | the language server for an editor of the page |
//! | `wire` | what goes over the wire, as types |
//! | `runs` | the history of runs: folders, what is kept, columns of traces |
//! | `folder` | the folder of programs |
//! | `page` | the page that is embedded |
//!
//! Nothing here waits for a client while the control waits, and every queue has an end.
#![forbid(unsafe_code)]

mod answer;
mod app;
mod clock;
mod folder;
mod guard;
mod language;
mod listen;
mod metrics;
mod monitoring;
mod mqtt;
mod mtconnect;
mod page;
mod reserved;
mod rights;
mod routes;
mod runs;
mod scope;
mod socket;
mod timeouts;
mod tls;
mod tokens;
pub mod types;
mod wire;

pub use ::mtconnect::MOST_OBSERVATIONS;
pub use clock::Clock;
pub use listen::{Refused, Server, ServerOptions};
pub use mqtt::{BrokerAddress, BrokerLogin, BrokerTimeouts, PublishOptions, TopicPrefix};
pub use rights::Role;
pub use routes::openapi;
pub use runs::KeptRuns;
pub use timeouts::ClientTimeouts;
pub use tls::Certificate;
pub use tokens::{NewToken, Tokens};
