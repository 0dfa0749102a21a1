//! The tool table as the control sees it: G10 L1, L10 and L11 change it, G41 and G43 read it.
//!
//! The tools themselves stay what they are ([`ToolLibrary`](canon::ToolLibrary)); what a program
//! writes is only what the control believes about them.
//!
//! ```text
//!   L1    the words are the offsets themselves
//!   L10   with these offsets (and G43) this place is called what the words say, in the work offset in force
//!   L11   the same in G59.3
//! ```
//!
//! `R` nose radius, `I` and `J` front and back angle, `Q` orientation 0 to 9 (lathe tools).
//!
//! Source: LinuxCNC 2.9 manual, "G10 L1", "G10 L10", "G10 L11".
use crate::{
    call::{Call, Sink},
    execute::Executor,
    fault::{Outcome, error, refuse},
    frame::{self, Frame, Point},
};
use std::collections::BTreeMap;

/// G59.3, which L11 measures in.
const FIXTURE: u8 = 9;

/// What the control believes about a tool: mm and degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolEntry {
    /// Number of the tool.
    pub number: u32,
    /// Offsets of all axes.
    pub offset: Point,
    /// Diameter.
    pub diameter: f64,
    /// Front angle.
    pub front_angle: f64,
    /// Back angle.
    pub back_angle: f64,
    /// Orientation of a lathe tool, 0 to 9.
    pub orientation: u32,
}

/// The entries that a program has written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ToolTable {
    written: BTreeMap<u32, ToolEntry>,
}

impl ToolTable {
    /// Whether a program has written this one.
    pub(crate) fn has(&self, number: u32) -> bool {
        self.written.contains_key(&number)
    }

    pub(crate) fn write(&mut self, entry: ToolEntry) {
        self.written.insert(entry.number, entry);
    }
}

impl Executor {
    /// The entry of a tool; for one that is not in the table, of nothing.
    pub(crate) fn tool_entry(&self, number: u32) -> ToolEntry {
        if let Some(entry) = self.tool_table.written.get(&number) {
            return *entry;
        }
        let mut entry = ToolEntry { number, ..ToolEntry::default() };
        if let Some(tool) = self.tools.get(number) {
            entry.offset[2] = tool.length.value();
            entry.diameter = tool.diameter.value();
        }
        entry
    }

    /// G10 L1, L10, L11; L0 reads the table anew, which is as the program has left it.
    pub(crate) fn set_tool<S: Sink>(&mut self, kind: u32, sink: &mut S) -> Outcome {
        if kind == 0 {
            if self.state.current_tool != 0 {
                let text = "G10 L0 reads the tool table anew: the spindle must be empty";
                return Err(error("I0621", self.words.place.span, text)
                    .with_help("write T0 M6 before it")
                    .into());
            }
            self.say(sink, &Call::ReloadTools);
            return Ok(());
        }
        if self.words.get(b'P').is_none() {
            let text = format!("G10 L{kind} needs P, the number of a tool");
            return refuse("I0620", self.words.place.span, text);
        }
        let number = self.tool_word(b'P')?;
        if number == 0 {
            let text = "the empty spindle has no entry in the tool table: P is 1 or more";
            return refuse("I0620", self.words.span(b'P'), text);
        }
        if !self.words.any(crate::codes::AXES | crate::codes::set("RIJQ")) {
            let text = format!(
                "G10 L{kind} needs what it shall set: axis words, R (the radius), I, J (a lathe tool's angles) or Q (where it points)"
            );
            return refuse("I0622", self.words.place.span, text);
        }
        let mut entry = self.tool_entry(number);
        let mm = self.state.units.in_mm();
        if kind == 1 {
            frame::scale(&mut entry.offset, 1.0 / mm);
            entry.offset = self.with_words(entry.offset);
        } else {
            entry.offset = self.offset_by_position(kind, entry.offset);
        }
        frame::scale(&mut entry.offset, mm);
        if let Some(radius) = self.words.get(b'R') {
            entry.diameter = 2.0 * radius * mm;
        }
        entry.front_angle = self.words.get(b'I').unwrap_or(entry.front_angle);
        entry.back_angle = self.words.get(b'J').unwrap_or(entry.back_angle);
        entry.orientation = self.words.whole(b'Q', 9)?.unwrap_or(entry.orientation);
        self.tool_table.written.insert(number, entry);
        let rank = self.tools.iter().position(|t| t.number == number).map_or(0, |i| i as u32 + 1);
        self.say(sink, &Call::ToolTableEntry { rank, entry });
        let current = number == self.state.current_tool;
        if current {
            self.state.loaded = entry;
        }
        if current || self.stand_alone && self.pocket(number) == self.state.current_pocket {
            self.say(sink, &Call::ToolTableEntry { rank: 0, entry });
        }
        Ok(())
    }

    /// The tool offset with which this place is called what the words say; program units.
    fn offset_by_position(&self, kind: u32, mut offset: Point) -> Point {
        frame::scale(&mut offset, 1.0 / self.state.units.in_mm());
        let machine = self.state.frame.to_machine(&self.state.at);
        let mut frame: Frame = self.state.frame;
        if kind == 11 {
            let (origin, rotation) = self.system(usize::from(FIXTURE));
            frame.origin = origin;
            frame.added = [0.0; 9];
            frame.rotate(rotation);
        }
        frame.tool = [0.0; 9];
        let wanted = self.with_words(frame.to_program(&machine));
        let without = frame.to_machine(&wanted);
        for (axis, slot) in offset.iter_mut().enumerate() {
            if self.axis_word(axis).is_some() || axis < 2 && frame.rotation() != 0.0 {
                *slot = machine[axis] - without[axis];
            }
        }
        offset
    }

    /// Refuse a number of a `G10 L` that is none.
    pub(crate) fn unknown_g10(&self, kind: u32) -> Outcome<u32> {
        let text = format!("G10 takes L0, L1, L2, L10, L11 or L20, found L{kind}");
        Err(error("I0615", self.words.span(b'L'), text).into())
    }
}
