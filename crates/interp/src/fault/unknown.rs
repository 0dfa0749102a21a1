//! What is not known since a block was refused, and which findings follow from that alone.
//!
//! A finding that asks for what is unknown ([`needs`]) is not told: it would say again what the
//! first refusal has said, or what is not so. One that says that something is missing makes that
//! unknown itself, so that it is told once and not in each of a hundred lines.

use crate::codes::{Letters, index};
/// What is not known since a block was refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unknown(pub(crate) u32);

/// What a finding with this code takes for known.
pub(crate) fn needs(code: &str) -> u32 {
    match code {
        "I0408" | "I0425" | "I0426" => Unknown::FEED,
        "I0434" | "I0532" | "I0567" | "I0597" | "I0703" => Unknown::SPEED,
        "I0427" => Unknown::SENSE | Unknown::SPEED,
        "I1032" | "I1006" => Unknown::BLOCKS,
        "I1041" | "I1042" | "I1043" | "I1044" | "I1045" | "I1046" | "I1047" | "I1048" => {
            Unknown::MAPPING
        }
        "I0512" | "I0513" | "I0514" | "I0515" | "I0568" | "I0702" => Unknown::SENSE,
        "I1031" | "I0109" | "I0110" | "I0112" | "I0504" | "I0505" | "I0507" | "I0508" | "I0516"
        | "I0534" | "I0594" => Unknown::MOTION,
        "I0413" | "I0414" | "I0417" | "I0418" | "I0433" | "I0701" | "I0705" | "I0709" => {
            Unknown::PLACE | Unknown::DISTANCE
        }
        "I0410" | "I0411" | "I0412" | "I0541" | "I0706" => Unknown::PLANE,
        "I0540" | "I0544" | "I0550" => Unknown::COMPENSATION,
        "I0545" | "I0546" | "I0547" | "I0548" => {
            Unknown::PLACE | Unknown::TOOL | Unknown::COMPENSATION
        }
        _ => 0,
    }
}

/// What words with these letters set.
pub(crate) fn said_by(letters: Letters) -> u32 {
    let has = |letter: u8| letters >> index(letter) & 1 == 1;
    let mut unknown = 0;
    for (axis, letter) in b"XYZABCUVW".iter().enumerate() {
        unknown |= u32::from(has(*letter)) << axis;
    }
    for (letter, what) in [
        (b'@', Unknown::PLACE),
        (b'^', Unknown::PLACE),
        (b'F', Unknown::FEED),
        (b'S', Unknown::SPEED),
        (b'T', Unknown::TOOL),
        (b'D', Unknown::TOOL),
        (b'G', Unknown::MOTION | Unknown::PLANE | Unknown::COMPENSATION | Unknown::MAPPING),
        (b'M', Unknown::SENSE | Unknown::TOOL),
        (b'R', Unknown::MOTION),
        (b'Q', Unknown::MOTION),
    ] {
        unknown |= if has(letter) { what } else { 0 };
    }
    unknown
}

/// The letters of a text, comments apart.
pub(crate) fn letters_of(text: &[u8]) -> Letters {
    let (mut letters, mut inside) = (0, false);
    for byte in text {
        match byte.to_ascii_uppercase() {
            b'(' => inside = true,
            b')' => inside = false,
            b';' if !inside => break,
            letter @ (b'A'..=b'Z' | b'@' | b'^' | b'$') if !inside => letters |= 1 << index(letter),
            _ => {}
        }
    }
    letters
}

/// Letters of the words whose values are computed.
pub(crate) fn computed(block: &gcode::Block) -> Letters {
    let words = block.words.iter().filter(|w| matches!(w.value, gcode::Value::Expression(_)));
    words.map(|word| 1 << index(word.letter.to_ascii_uppercase())).fold(0, |all, bit| all | bit)
}

/// Whether anything in a block is computed.
pub(crate) fn computes(block: &gcode::Block) -> bool {
    computed(block) != 0 || !block.assignments.is_empty() || block.o.is_some()
}

impl Unknown {
    /// Where the axes stand: a bit each.
    pub(crate) const PLACE: u32 = (1 << 9) - 1;
    pub(crate) const FEED: u32 = 1 << 9;
    pub(crate) const SPEED: u32 = 1 << 10;
    pub(crate) const SENSE: u32 = 1 << 11;
    pub(crate) const TOOL: u32 = 1 << 12;
    /// Which motion or cycle is in force, and the words it keeps.
    pub(crate) const MOTION: u32 = 1 << 13;
    pub(crate) const PLANE: u32 = 1 << 14;
    pub(crate) const COMPENSATION: u32 = 1 << 15;
    pub(crate) const PARAMETERS: u32 = 1 << 16;
    /// Which numbered blocks there are: one that is looked for cannot be read.
    pub(crate) const BLOCKS: u32 = 1 << 18;
    /// Fanuc's rotation, scaling, mirror image, polar coordinates.
    pub(crate) const MAPPING: u32 = 1 << 19;
    /// G90 or G91.
    pub(crate) const DISTANCE: u32 = 1 << 17;

    pub(crate) const fn clear(&mut self, unknown: u32) {
        self.0 &= !unknown;
    }

    pub(crate) const fn add(&mut self, unknown: u32) {
        self.0 |= unknown;
    }

    pub(crate) const fn has(self, unknown: u32) -> bool {
        self.0 & unknown != 0
    }

    /// Both.
    pub(crate) const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether a numbered block is not found because it cannot be read.
    pub(crate) fn hide_blocks(self, code: &str) -> bool {
        self.has(needs(code) & Self::BLOCKS)
    }

    /// Whether what was found in a block may follow from a refusal before it.
    pub(crate) fn may_cause(self, code: &str, block: &gcode::Block) -> bool {
        self.explain(code) || self.has(Self::PARAMETERS) && computes(block)
    }

    /// After an error of an operation: what it has missed, which is told once.
    pub(crate) fn miss(&mut self, code: &str) {
        self.add(needs(code) & !(Self::PLACE | Self::DISTANCE));
    }

    /// Everything.
    pub(crate) const ALL: Self = Self(u32::MAX);

    /// Whether a finding says what may follow from a refusal before it.
    pub(crate) fn explain(self, code: &str) -> bool {
        self.has(needs(code))
    }
}
