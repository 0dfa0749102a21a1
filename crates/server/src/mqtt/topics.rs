//! The topics, as the standard's own agent has them, and what is published on each.
//!
//! ```text
//!   MTConnect/Probe/UUID                       the device                                     kept by the broker
//!   MTConnect/Probe/UUID/Availability          AVAILABLE; by the last will UNAVAILABLE        kept
//!   MTConnect/Current/UUID                     Streams: what is true, every 10 s              kept
//!   MTConnect/Sample/UUID                      Streams: what was observed
//!   MTConnect/Asset/UUID/ID                    Assets: a cutting tool                         kept
//!   MTConnect/Devices/UUID/Observations/ITEM   an observation, its data item's last one       kept
//! ```
use super::address::TopicPrefix;
use ::mtconnect::ItemMessage;

/// Something to publish.
#[derive(Debug)]
pub(super) struct Message {
    pub(super) topic: String,
    pub(super) payload: Vec<u8>,
    /// The broker keeps it for those that come later.
    pub(super) is_kept: bool,
    pub(super) carries: Carries,
}

/// What is known to be with the broker when a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Carries {
    /// Nothing that is counted.
    State,
    /// A document of all observations before this one.
    Document(u64),
    /// All observations by themselves before this one.
    Items(u64),
}

/// Topics of a device.
#[derive(Clone, Debug)]
pub(super) struct Topics {
    prefix: String,
    uuid: String,
}

impl Topics {
    pub(super) fn of(prefix: &TopicPrefix, uuid: &str) -> Self {
        Self { prefix: prefix.0.clone(), uuid: uuid.to_owned() }
    }

    pub(super) fn availability(&self) -> String {
        format!("{}/Probe/{}/Availability", self.prefix, self.uuid)
    }

    pub(super) fn is_available(&self) -> Message {
        kept(self.availability(), b"AVAILABLE".to_vec())
    }

    pub(super) fn probe(&self, device: Vec<u8>) -> Message {
        kept(format!("{}/Probe/{}", self.prefix, self.uuid), device)
    }

    pub(super) fn current(&self, document: Vec<u8>) -> Message {
        kept(format!("{}/Current/{}", self.prefix, self.uuid), document)
    }

    pub(super) fn sample(&self, document: Vec<u8>, next: u64) -> Message {
        let topic = format!("{}/Sample/{}", self.prefix, self.uuid);
        Message { topic, payload: document, is_kept: false, carries: Carries::Document(next) }
    }

    pub(super) fn asset(&self, id: &str, document: Vec<u8>) -> Message {
        kept(format!("{}/Asset/{}/{}", self.prefix, self.uuid, level(id)), document)
    }

    /// An observation that is published for the first time.
    pub(super) fn item(&self, message: ItemMessage) -> Message {
        let carries = Carries::Items(message.sequence + 1);
        Message { carries, ..self.item_again(message) }
    }

    /// One that the broker may have lost.
    pub(super) fn item_again(&self, message: ItemMessage) -> Message {
        let topic = format!("{}/Devices/{}/Observations/{}", self.prefix, self.uuid, message.item);
        kept(topic, message.json)
    }
}

const fn kept(topic: String, payload: Vec<u8>) -> Message {
    Message { topic, payload, is_kept: true, carries: Carries::State }
}

/// A name as one level of a topic.
fn level(name: &str) -> String {
    let is_of_topics = |c: char| matches!(c, '/' | '+' | '#') || c.is_control();
    name.chars().map(|c| if is_of_topics(c) { '_' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_those_of_the_standards_own_agent() {
        let prefix = TopicPrefix::parse("MTConnect").expect("it is one");
        let topics = Topics::of(&prefix, "4711");
        assert_eq!(topics.availability(), "MTConnect/Probe/4711/Availability");
        assert_eq!(topics.sample(Vec::new(), 7).topic, "MTConnect/Sample/4711");
        assert_eq!(topics.asset("a/b#.T1", Vec::new()).topic, "MTConnect/Asset/4711/a_b_.T1");
        let message = ItemMessage { sequence: 6, item: "avail".into(), json: Vec::new() };
        let message = topics.item(message);
        assert_eq!(message.topic, "MTConnect/Devices/4711/Observations/avail");
        assert_eq!(message.carries, Carries::Items(7));
    }
}
