//! The `MTConnect` agent, and what tells its streams that there is something new.
use crate::tokens::hex;
use ::mtconnect::{Agent, Identity};
use control::clock::unix_ms;
use control::operation::hosted::Client;
use sha2::{Digest, Sha256};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{Semaphore, watch};

/// Streams at once.
pub(crate) const MOST_STREAMS: usize = 64;

/// The agent, and what tells its streams that there is something new.
pub(crate) struct Monitoring {
    agent: Mutex<Agent>,
    /// The next sequence number.
    pub(crate) grown: watch::Sender<u64>,
    pub(crate) streams: Arc<Semaphore>,
}

impl Monitoring {
    /// Of a control; so many observations are kept.
    pub(crate) fn new(client: &Client, most: usize) -> Self {
        let machine = client.machine();
        let unix_ms = unix_ms();
        let identity = Identity { uuid: uuid(&machine.name), instance: unix_ms.max(1), unix_ms };
        Self {
            agent: Mutex::new(Agent::new(machine, identity, most)),
            grown: watch::Sender::new(1),
            streams: Arc::new(Semaphore::new(MOST_STREAMS)),
        }
    }

    /// For a moment: never across an await.
    pub(crate) fn agent(&self) -> MutexGuard<'_, Agent> {
        self.agent.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The same for this computer and this machine each time: by the id that its system was installed
/// with.
fn uuid(machine: &str) -> String {
    let system = std::fs::read_to_string("/etc/machine-id").unwrap_or_default();
    let digest = hex(&Sha256::digest(format!("{}\n{machine}", system.trim())));
    // RFC 9562: version 8 is made by a rule of one's own
    let parts = [&digest[..8], &digest[8..12], &digest[13..16], &digest[17..20], &digest[20..32]];
    format!("{}-{}-8{}-8{}-{}", parts[0], parts[1], parts[2], parts[3], parts[4])
}
