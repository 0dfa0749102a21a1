//! What is to be published next, out of the agent's buffer.
//!
//! ```text
//!   buffer   first ······ documents ··· items ···· next
//!                         ▲ of Sample   ▲ of each data item: how far they are on their way
//! ```
//!
//! Both go on from what the broker has acknowledged last when a connection begins. Nothing is kept
//! here but two numbers.
use super::topics::{Message, Topics};
use ::mtconnect::{Agent, AssetQuery, CurrentQuery, JsonForm, SampleQuery};
use std::collections::{HashMap, VecDeque};
use std::time::Duration;
use std::time::Instant;

/// A document of what is true comes so often, as that of the standard's own agent does.
const CURRENT: Duration = Duration::from_secs(10);
/// Observations of a document.
const MOST_OF_A_DOCUMENT: u32 = 200;
/// Observations that are made ready by themselves at once.
const MOST_ITEMS: usize = 100;

/// What is no longer kept, and was never published: from this observation to that one.
pub(super) type Lost = (u64, u64);

/// What is to be published.
pub(super) struct Outbox {
    topics: Topics,
    ready: VecDeque<Message>,
    document: u64,
    item: u64,
    /// What is true is published then.
    current_at: Instant,
    /// When each asset that was published had been changed.
    assets: HashMap<String, u64>,
}

impl Outbox {
    /// For a connection that begins: the broker has these and all before; what it keeps for others
    /// it may have lost.
    pub(super) fn begin(
        topics: Topics,
        agent: &Agent,
        (document, item): (u64, u64),
        now: Instant,
    ) -> Self {
        let ready = [topics.is_available(), topics.probe(agent.device_json())];
        let mut outbox = Self {
            topics,
            ready: ready.into(),
            document,
            item,
            current_at: now,
            assets: HashMap::new(),
        };
        // where something is lost, it comes when that is found
        if outbox.item >= agent.first() {
            outbox.items_again(agent);
        }
        outbox
    }

    /// The next message.
    pub(super) fn pop(&mut self) -> Option<Message> {
        self.ready.pop_front()
    }

    /// The next observation that is made ready by itself.
    pub(super) const fn next_item(&self) -> u64 {
        self.item
    }

    pub(super) fn is_empty(&self) -> bool {
        self.ready.is_empty()
    }

    /// Make ready what there is, unless something is ready; what is lost, if anything.
    pub(super) fn fill(&mut self, agent: &Agent, (now, unix_ms): (Instant, u64)) -> Option<Lost> {
        if !self.ready.is_empty() {
            return None;
        }
        let first = agent.first();
        let lost = (self.item < first).then(|| (self.item, first - 1));
        if lost.is_some() {
            self.item = first;
            self.items_again(agent);
            self.current_at = now;
        }
        self.document = self.document.max(first);
        self.assets(agent, unix_ms);
        if now >= self.current_at {
            self.current_at = now + CURRENT;
            if let Ok(document) = agent.current(&CurrentQuery::NOW, unix_ms) {
                self.ready.push_back(self.topics.current(document.json(JsonForm::Grouped)));
            }
        }
        let query = SampleQuery::all_from(self.document, MOST_OF_A_DOCUMENT);
        if let Ok(chunk) = agent.sample(&query, unix_ms)
            && !chunk.is_empty
        {
            let document = chunk.document.json(JsonForm::Grouped);
            self.ready.push_back(self.topics.sample(document, chunk.next));
            self.document = chunk.next;
        }
        for message in agent.messages(self.item, MOST_ITEMS) {
            self.item = message.sequence + 1;
            self.ready.push_back(self.topics.item(message));
        }
        lost
    }

    /// What is true where the items go on.
    fn items_again(&mut self, agent: &Agent) {
        let messages = agent.messages_before(self.item);
        self.ready.extend(messages.into_iter().map(|message| self.topics.item_again(message)));
    }

    fn assets(&mut self, agent: &Agent, unix_ms: u64) {
        let is_new = |(id, changed): &(&str, u64)| self.assets.get(*id) != Some(changed);
        let new: Vec<_> = agent.assets_changed().filter(is_new).collect();
        for (id, changed) in new {
            if let Ok(document) = agent.assets(&AssetQuery::one(id), unix_ms) {
                self.ready.push_back(self.topics.asset(id, document.json(JsonForm::Grouped)));
            }
            self.assets.insert(id.to_owned(), changed);
        }
    }
}
