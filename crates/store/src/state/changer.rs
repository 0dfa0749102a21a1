//! Where the tools of a changer are that a sequence works, and how far a tool change is.
use super::Datum;
use super::data::{from_toml, to_toml};
use serde::{Deserialize, Serialize};

/// Most pockets.
const MOST_POCKETS: usize = 1000;

/// Where the tools are, and the step that was begun last of a tool change that is not over.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChangerRecord {
    /// Tool in each pocket, pocket 1 first; 0 is none.
    pub pockets: Vec<u32>,
    /// Tool in the spindle; 0 is none.
    pub spindle: u32,
    /// Pocket to which that tool returns; 0: none is known.
    pub home: u32,
    /// Pocket at the spindle; 0: not known.
    pub at: u32,
    /// The tool change that is not over.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_way: Option<HalfWay>,
}

/// A tool change that is not over.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfWay {
    /// Name of the sequence.
    pub sequence: String,
    /// Name of the step that was begun last.
    pub step: String,
    /// It was being undone.
    pub back: bool,
    /// Tool in the spindle at the beginning; 0 is none.
    pub from: u32,
    /// Pocket to which it returns; 0 is none.
    pub returns_to: u32,
    /// Tool in the spindle at the end; 0 is none.
    pub to: u32,
    /// Pocket from which it comes; 0 is none.
    pub fetched_from: u32,
}

impl Datum for ChangerRecord {
    const FILE: &'static str = "changer.toml";
    const KIND: &'static str = "changer";

    fn body(&self) -> String {
        to_toml(self)
    }

    fn parse(body: &str) -> Result<Self, String> {
        let read: Self = from_toml(body)?;
        let most = read.pockets.len();
        if most > MOST_POCKETS {
            return Err(format!("{most} pockets: {MOST_POCKETS} are possible"));
        }
        let mut tools: Vec<u32> = read.pockets.iter().copied().chain([read.spindle]).collect();
        tools.retain(|tool| *tool != 0);
        tools.sort_unstable();
        let mut pairs = tools.iter().zip(tools.iter().skip(1));
        if let Some((twice, _)) = pairs.find(|(one, next)| one == next) {
            return Err(format!("tool {twice} is in two places"));
        }
        for pocket in [read.home, read.at] {
            if pocket as usize > most {
                return Err(format!("pocket {pocket}: there are pockets 1 to {most}"));
            }
        }
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_was_written_and_a_tool_is_in_one_place() {
        let half_way = HalfWay {
            sequence: "tool change".into(),
            step: "unclamp".into(),
            from: 3,
            returns_to: 3,
            ..HalfWay::default()
        };
        let record = ChangerRecord {
            pockets: vec![1, 2, 0],
            spindle: 3,
            home: 3,
            at: 1,
            half_way: Some(half_way),
        };
        assert_eq!(ChangerRecord::parse(&record.body()), Ok(record.clone()));
        let twice = ChangerRecord { spindle: 2, ..record };
        assert_eq!(ChangerRecord::parse(&twice.body()), Err("tool 2 is in two places".into()));
    }
}
