//! How long the server waits for a client.
use std::time::Duration;

/// Longest waits for a client; [`ClientTimeouts::default`] has those of a shop.
#[derive(Clone, Copy, Debug)]
pub struct ClientTimeouts {
    /// A header comes within this time; also the longest silence between two requests.
    pub header: Duration,
    /// A body comes within this time.
    pub body: Duration,
    /// A client takes some of its answer within this time.
    pub answer: Duration,
}

impl Default for ClientTimeouts {
    fn default() -> Self {
        let ten = Duration::from_secs(10);
        Self { header: ten, body: ten, answer: ten }
    }
}
