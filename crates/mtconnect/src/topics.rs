//! What is published without being asked for: each observation on a topic of its data item, as the
//! standard's own agent writes it.
//!
//! ```json
//! {"dataItemId": "path_execution", "type": "EXECUTION", "category": "EVENT", "timestamp": "2026-11-25T10:36:52.345Z",
//!  "result": "ACTIVE", "sequence": 1234, "instanceId": 1795603012345}
//! ```
//!
//! An observation is known again by `instanceId` and `sequence`: a reader that gets it twice drops
//! the second.
use crate::agent::Agent;
use crate::buffer::{Observation, StateAt, Value};
use crate::documents::date;
use crate::element::JsonForm;
use crate::items::Category;
use serde_json::{Map, json};

/// An observation as it is published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ItemMessage {
    /// Its sequence number.
    pub sequence: u64,
    /// Id of its data item.
    pub item: String,
    /// JSON in one line.
    pub json: Vec<u8>,
}

impl Agent {
    /// Number of the first observation that is kept; of the next one where none is.
    pub fn first(&self) -> u64 {
        self.buffer.first()
    }

    /// Observations that are kept at most.
    pub const fn most(&self) -> usize {
        self.buffer.most()
    }

    /// The device's uuid.
    pub fn uuid(&self) -> &str {
        &self.device.uuid
    }

    /// Of this agent's buffer: sequence numbers begin anew with another one.
    pub const fn instance(&self) -> u64 {
        self.identity.instance
    }

    /// What was observed, from an observation on, so many at most.
    pub fn messages(&self, from: u64, count: usize) -> Vec<ItemMessage> {
        self.buffer.from(from).take(count).map(|seen| self.message(seen)).collect()
    }

    /// The last observation of each data item before this one, oldest first; of a condition each
    /// that is wrong. None: it is not kept.
    pub fn messages_before(&self, sequence: u64) -> Vec<ItemMessage> {
        let state = self.buffer.before(sequence);
        let mut seen: Vec<_> = state.iter().flat_map(StateAt::all).collect();
        seen.sort_by_key(|seen| seen.sequence);
        seen.into_iter().map(|seen| self.message(seen)).collect()
    }

    /// The device, as it is published.
    pub fn device_json(&self) -> Vec<u8> {
        self.device.element().json(JsonForm::Grouped)
    }

    /// Each asset, and when it was changed last, ms since 1970.
    pub fn assets_changed(&self) -> impl Iterator<Item = (&str, u64)> {
        self.feed.assets.iter().map(|asset| (asset.id.as_str(), asset.unix_ms))
    }

    fn message(&self, seen: &Observation) -> ItemMessage {
        let item = &self.device.items[seen.item];
        let mut members = Map::new();
        let mut insert = |name: &str, value: serde_json::Value| {
            members.insert(name.to_owned(), value);
        };
        insert("dataItemId", item.id.as_str().into());
        insert("type", item.kind.name.into());
        if let Some(sub) = item.kind.sub {
            insert("subType", sub.into());
        }
        insert("timestamp", date(seen.unix_ms).into());
        insert("category", item.kind.category.name().into());
        if item.kind.category == Category::Condition {
            let level = match &seen.value {
                Value::Normal => "NORMAL",
                Value::Fault(_) => "FAULT",
                _ => "UNAVAILABLE",
            };
            insert("level", level.into());
            if let Value::Fault(fault) = &seen.value {
                insert("nativeCode", fault.native_code.as_str().into());
                insert("conditionId", fault.id.as_str().into());
                insert("message", fault.text.as_str().into());
            }
        } else {
            insert("result", result(&seen.value, usize::from(item.kind.decimals)).into());
        }
        insert("sequence", seen.sequence.into());
        insert("instanceId", self.identity.instance.into());
        let json = serde_json::to_vec(&members).unwrap_or_default(); // strings, numbers and names alone
        ItemMessage { sequence: seen.sequence, item: item.id.clone(), json }
    }
}

/// A result, which is a text whatever it is of.
fn result(value: &Value, digits: usize) -> String {
    match value {
        Value::Unavailable | Value::Normal | Value::Fault(_) => "UNAVAILABLE".to_owned(),
        Value::Word(word) => (*word).to_owned(),
        Value::Text(text) => text.to_string(),
        Value::Number(value) => format!("{value:.digits$}"),
        Value::Count(count) => count.to_string(),
        Value::Assets(count) => json!({ crate::documents::CUTTING_TOOL: count }).to_string(),
    }
}
