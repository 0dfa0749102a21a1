//! What the `MTConnect` agent observes, published to an MQTT broker.
//!
//! ```text
//!   agent's buffer ─► Outbox ─► Session ─► broker        nothing comes back but acknowledgements
//!        ▲                        │
//!        └── goes on from ◄── last acknowledged
//! ```
//!
//! | file | is |
//! |---|---|
//! | `address` | broker, user, topics: as they are typed |
//! | `link` | TCP and TLS |
//! | `session` | a connection, from its beginning to its end |
//! | `outbox` | what is to be published next |
//! | `topics` | on which topic |
//! | `sentence` | why there is no connection |
//!
//! Read-only by construction: it subscribes to nothing, and has no way to ask a control for
//! anything. While there is no connection, observations wait in the agent's buffer, whose size is
//! stated; nothing else is kept.
mod address;
mod link;
mod outbox;
mod sentence;
mod session;
mod topics;

pub use address::{BrokerAddress, BrokerLogin, TopicPrefix};

use crate::monitoring::Monitoring;
use crate::tokens::hex;
use control::clock::now;
use link::Link;
use outbox::Lost;
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use topics::{Carries, Topics};

/// A connection that has lasted for so long was a good one.
const GOOD: Duration = Duration::from_secs(10);

/// Longest waits for a broker; [`BrokerTimeouts::default`] has those of a shop.
#[derive(Clone, Copy, Debug)]
pub struct BrokerTimeouts {
    /// After a connection has ended, the first attempt comes after this time.
    pub retry: Duration,
    /// Each next attempt comes after twice as long, at most this.
    pub longest_retry: Duration,
    /// A broker that acknowledges nothing for this time does not do so any more.
    pub acknowledgement: Duration,
}

impl Default for BrokerTimeouts {
    fn default() -> Self {
        Self {
            retry: Duration::from_millis(250),
            longest_retry: Duration::from_secs(30),
            acknowledgement: Duration::from_secs(20),
        }
    }
}

/// How observations are published.
pub struct PublishOptions {
    /// Where.
    pub broker: BrokerAddress,
    /// As whom.
    pub login: Option<BrokerLogin>,
    /// File of certificates (PEM) that vouch for the broker; `None`: those that this computer
    /// trusts.
    pub authorities: Option<PathBuf>,
    /// With what topics begin.
    pub topic: TopicPrefix,
    /// How long the broker is waited for.
    pub timeouts: BrokerTimeouts,
    /// Told, in a sentence, when there is a connection, when there is none, and what was lost.
    pub told: Box<dyn Fn(&str) + Send + Sync>,
}

/// Publishes what an agent observes.
pub(crate) struct Publisher {
    link: Link,
    login: Option<BrokerLogin>,
    topics: Topics,
    timeouts: BrokerTimeouts,
    client_id: String,
    monitoring: Arc<Monitoring>,
    told: Box<dyn Fn(&str) + Send + Sync>,
    /// The last sentence.
    said: Mutex<String>,
    figures: Figures,
}

/// How far it is.
#[derive(Default)]
struct Figures {
    is_connected: AtomicBool,
    connections: AtomicU64,
    /// The broker has all documents of the observations before this one, …
    document: AtomicU64,
    /// … and all observations by themselves before this one.
    item: AtomicU64,
    published: AtomicU64,
    lost: AtomicU64,
}

impl Figures {
    fn acknowledged(&self, carries: Carries) {
        match carries {
            Carries::State => {}
            Carries::Document(next) => self.document.store(next, Relaxed),
            Carries::Items(next) => {
                self.item.store(next, Relaxed);
                self.published.fetch_add(1, Relaxed);
            }
        }
    }
}

/// How publishing goes, for those that look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PublishStatus {
    pub(crate) is_connected: bool,
    /// Connections that a broker has accepted.
    pub(crate) connections: u64,
    /// Observations that a broker has acknowledged.
    pub(crate) published: u64,
    /// Observations that wait, or are on their way.
    pub(crate) waiting: u64,
    /// Observations that were no longer kept when there was a connection again.
    pub(crate) lost: u64,
}

impl Publisher {
    /// Of what an agent observes.
    pub(crate) fn new(
        options: PublishOptions,
        monitoring: Arc<Monitoring>,
    ) -> Result<Self, String> {
        let PublishOptions { broker, login, authorities, topic, timeouts, told } = options;
        let link = Link::of(broker, authorities.as_deref())?;
        let agent = monitoring.agent();
        let topics = Topics::of(&topic, agent.uuid());
        // the same for all connections of this agent: the broker gives up an older one that has
        // broken off
        let digest = Sha256::digest(format!("{}\n{}\n{}", agent.uuid(), agent.instance(), topic.0));
        let client_id = format!("leadscrew{}", &hex(&digest)[..14]);
        drop(agent);
        let (document, item) = (AtomicU64::new(1), AtomicU64::new(1));
        let figures = Figures { document, item, ..Figures::default() };
        let said = Mutex::default();
        Ok(Self { link, login, topics, timeouts, client_id, monitoring, told, said, figures })
    }

    /// How it goes.
    pub(crate) fn status(&self) -> PublishStatus {
        let next = self.monitoring.agent().next();
        let Figures { is_connected, connections, item, published, lost, .. } = &self.figures;
        PublishStatus {
            is_connected: is_connected.load(Relaxed),
            connections: connections.load(Relaxed),
            published: published.load(Relaxed),
            waiting: next.saturating_sub(item.load(Relaxed)),
            lost: lost.load(Relaxed),
        }
    }

    /// Connection after connection, for ever.
    pub(crate) async fn run(self: Arc<Self>) {
        let mut wait = self.timeouts.retry;
        loop {
            let begun = now();
            let why = session::run(&self).await;
            self.figures.is_connected.store(false, Relaxed);
            self.tell(format!("MQTT: {why}; observations wait, and it is tried again"));
            if now() - begun > GOOD {
                wait = self.timeouts.retry;
            }
            tokio::time::sleep(wait).await;
            wait = (wait * 2).min(self.timeouts.longest_retry);
        }
    }

    fn is_connected(&self) {
        self.figures.is_connected.store(true, Relaxed);
        self.figures.connections.fetch_add(1, Relaxed);
        self.tell(format!("MQTT: connected to {}", self.link.address));
    }

    fn has_lost(&self, (from, to): Lost) {
        self.figures.item.fetch_max(to + 1, Relaxed);
        self.figures.document.fetch_max(to + 1, Relaxed);
        self.figures.lost.fetch_add(to + 1 - from, Relaxed);
        self.tell(format!(
            "MQTT: observations {from} to {to} are lost to the broker: the last {} are kept",
            self.monitoring.agent().most()
        ));
    }

    /// What was said last is not said again.
    fn tell(&self, sentence: String) {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        if *said != sentence {
            (self.told)(&sentence);
            *said = sentence;
        }
    }
}
