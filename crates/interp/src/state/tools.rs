//! The tools that a program may call, and what the control believes about them.
use crate::{
    call::ToolEntry,
    codes::number::near_whole,
    fault::{Outcome, error, refuse},
    setup::{MissingTools, WearOffsets},
    words::Words,
};
use canon::{Tool, ToolKind, ToolLibrary};
use diag::{Diagnostic, Span};
use std::collections::{BTreeMap, BTreeSet};
use units::Length;

/// The entries that a program has written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ToolTable {
    entries: BTreeMap<u32, ToolEntry>,
}

impl ToolTable {
    /// Whether a program has written this one.
    pub(crate) fn has(&self, number: u32) -> bool {
        self.entries.contains_key(&number)
    }

    pub(crate) fn write(&mut self, entry: ToolEntry) {
        self.entries.insert(entry.number, entry);
    }
}

/// The tools of a program.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Tools {
    /// Those of the library, and stand-ins for the ones that it lacks.
    pub(crate) library: ToolLibrary,
    /// What becomes of a number that the library does not have.
    pub(crate) missing: MissingTools,
    /// Those of the library are an example, and not the shop's.
    pub(crate) are_examples: bool,
    /// Offsets that hold wear alone.
    pub(crate) wear: WearOffsets,
    /// Offsets whose effect on G41 and G42 was reported.
    pub(crate) reported: BTreeSet<u32>,
    /// What the tool table says, where a program has changed it.
    pub(crate) written: ToolTable,
}

impl Tools {
    /// The entry of a tool; for one that is not in the table, of nothing.
    pub(crate) fn entry(&self, number: u32) -> ToolEntry {
        if let Some(entry) = self.written.entries.get(&number) {
            return *entry;
        }
        let mut entry = ToolEntry { number, ..ToolEntry::default() };
        // a stand-in has the diameter that the program states of it, and no length
        if let Some(tool) = self.library.get(number) {
            entry.offset[2] = tool.worn_length().value();
            entry.diameter = tool.worn_diameter().value();
        }
        entry
    }

    /// True if something states the diameter of a tool: a table, the program, or its comment.
    pub(crate) fn states_diameter(&self, number: u32) -> bool {
        let is_stated = |tool: &Tool| !tool.stand_in || tool.diameter > Length::ZERO;
        self.written.has(number) || self.library.get(number).is_none_or(is_stated)
    }

    /// The comment that states that an offset holds wear alone, unless the program has written it.
    pub(crate) fn wear_alone(&self, number: u32) -> Option<&str> {
        self.wear.stated(number).filter(|_| !self.written.has(number))
    }

    /// The comment that states a tool's diameter, where no table and no block does.
    pub(crate) fn by_comment(&self, number: u32) -> Option<&str> {
        let tool = self.library.get(number).filter(|tool| tool.stand_in)?;
        let is_stated = tool.diameter > Length::ZERO && !self.written.has(number);
        is_stated.then_some(tool.description.as_str())
    }

    /// The description of an example's tool whose diameter nothing else states.
    pub(crate) fn by_example(&self, number: u32) -> Option<&str> {
        let tool = self.library.get(number).filter(|tool| self.are_examples && !tool.stand_in)?;
        (!self.written.has(number)).then_some(tool.description.as_str())
    }

    /// What programs have written of lengths and diameters is in the library by now, or was edited
    /// there.
    pub(crate) fn follow_library(&mut self) {
        for (number, entry) in &mut self.written.entries {
            if let Some(tool) = self.library.get(*number) {
                entry.offset[2] = tool.worn_length().value();
                entry.diameter = tool.worn_diameter().value();
            }
        }
    }

    /// Where a tool is kept; that of no tool, and of one that the table lacks, is 0.
    pub(crate) fn pocket(&self, number: u32) -> u32 {
        self.library.get(number).map_or(0, |tool| tool.pocket)
    }

    /// The number after a letter, which must be a tool of the table, or 0.
    pub(crate) fn word(&mut self, words: &Words, letter: u8) -> Outcome<u32> {
        let value = words.get(letter).unwrap_or(0.0);
        let span = words.span(letter);
        match near_whole(value) {
            Some(0) => Ok(0),
            Some(number) if number > 0 => {
                let number = u32::try_from(number).unwrap_or(u32::MAX);
                let offset = letter != b'T' && self.written.has(number);
                if offset || self.library.get(number).is_some() {
                    return Ok(number);
                }
                match self.missing {
                    MissingTools::Refuse => Err(self.unknown(number, span).into()),
                    MissingTools::StandIn => {
                        self.library.insert(stand_in(number));
                        Ok(number)
                    }
                }
            }
            _ => refuse(
                "I0610",
                span,
                format!(
                    "expected a tool number (0, 1, 2, …) after {}, found {value}",
                    letter as char
                ),
            ),
        }
    }

    fn unknown(&self, number: u32, span: Span) -> Diagnostic {
        let known: Vec<_> = self.library.iter().map(|t| t.number.to_string()).collect();
        let help = match known.len() {
            0 => "the tool table is empty".to_owned(),
            1..=24 => format!("it has {}", known.join(", ")),
            n => format!("it has {} and {} more", known[..24].join(", "), n - 24),
        };
        error("I0611", span, format!("tool {number} is not in the tool table")).with_help(help)
    }
}

/// A tool of no length that makes nothing judged.
fn stand_in(number: u32) -> Tool {
    Tool {
        number,
        pocket: number,
        length: Length::ZERO,
        diameter: Length::ZERO,
        kind: ToolKind::Other,
        description: "stand-in".into(),
        wear: canon::ToolWear::default(),
        life: canon::ToolLife::default(),
        body: canon::Body::default(),
        stand_in: true,
    }
}
