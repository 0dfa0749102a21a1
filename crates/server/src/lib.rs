//! A control over the network: HTTP and WebSocket under `/api/v1`, and the page.
//!
//! ```text
//!   listener ─► connection (limits, timeouts) ─► guard (Host, Origin) ─► routes (access) ─┬─► control::operation::hosted::Client
//!                                                                                         ├─► folder of programs
//!                                                                                         └─► page
//! ```
//!
//! | file | is |
//! |---|---|
//! | `listen` | addresses, and what is served there; `connections` those that are open, their limits; `timeouts` how long a client is waited for |
//! | `guard`, `access` | who may ask at all: Host, Origin, session, token; headers of every answer |
//! | `rights` | sessions, to whom they belong, which of them commands; `clock` by which they end |
//! | `tokens`, `revoking` | the file of tokens, which is read anew when it has changed; `role` what they allow |
//! | `tls`, `secret` | the certificate; files that are their owner's alone |
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

mod access;
mod answer;
mod app;
mod clock;
mod connections;
#[cfg(test)]
mod flooded_tests;
mod folder;
mod guard;
mod language;
mod listen;
mod metrics;
mod monitoring;
mod mqtt;
mod mtconnect;
mod paced;
mod page;
mod page_words;
mod reserved;
mod revoking;
mod rights;
mod role;
mod routes;
mod runs;
mod scope;
mod secret;
mod socket;
mod timeouts;
mod tls;
mod tokens;
pub mod types;
mod wire;

pub use ::mtconnect::MOST_OBSERVATIONS;
pub use access::{Access, Address};
pub use clock::Clock;
pub use listen::{Refused, Server, ServerOptions};
pub use mqtt::{BrokerAddress, BrokerLogin, BrokerTimeouts, PublishOptions, TopicPrefix};
pub use role::Role;
pub use routes::{addresses, openapi};
pub use runs::KeptRuns;
pub use timeouts::ClientTimeouts;
pub use tls::Certificate;
pub use tokens::{NewToken, Tokens};
