//! Sequences: what a function of the machine consists of, such as a tool change, as named steps.
//!
//! ```text
//!   rest state ─► step ─► step ─► … ─► rest state      each step:  operator, orientation, move, index,
//!        ▲          │ back │ back                                  outputs, dwell, then the inputs that prove it
//!        └──────────┴──────┘
//! ```
//!
//! The way back of a step follows from the steps before it: the outputs that it switched become
//! what they were, the inputs that it waited for too, axes return, the carousel turns back.
use crate::Axis;
use alloc::{string::String, vec::Vec};
use units::{Angle, Length, Speed, Time};

/// Digital signals, each by its number and state.
pub type SignalStates = Vec<(u8, bool)>;

/// A function of the machine as steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// Its name.
    pub name: String,
    /// Outputs in the state in which it begins and ends.
    pub rest_outputs: SignalStates,
    /// Inputs in the same state.
    pub rest_inputs: SignalStates,
    /// Longest time until they are so.
    pub rest_longest: Time,
    /// The steps, in their order.
    pub steps: Vec<SequenceStep>,
    /// The carousel that its steps turn.
    pub carousel: Option<Carousel>,
}

/// One step of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceStep {
    /// Its name.
    pub name: String,
    /// When it is done at all.
    pub when: When,
    /// Sentence for the operator, who confirms it before anything else of the step.
    pub operator: Option<String>,
    /// Angle at which the first spindle is held, and longest time to it.
    pub orient: Option<(Angle, Time)>,
    /// Machine coordinates to which axes move; empty: none moves.
    pub to: Vec<(Axis, Length)>,
    /// Speed of the move; `None`: as a rapid.
    pub speed: Option<Speed>,
    /// Pocket that the carousel turns to the spindle.
    pub index: Option<Pocket>,
    /// Outputs that it switches.
    pub outputs: SignalStates,
    /// Time that it lasts whatever inputs say.
    pub dwell: Time,
    /// Inputs that prove it done.
    pub inputs: SignalStates,
    /// Longest time until they are so.
    pub longest: Time,
    /// Usual time until they are so.
    pub usual: Time,
    /// Where it hands a tool over, once its inputs have proved it.
    pub handover: Option<Handover>,
    /// Only a person undoes it.
    pub undone_by_hand: bool,
}

/// When a step is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct When {
    /// `Some(true)`: a tool was in the spindle at the beginning; `Some(false)`: none was.
    pub returns: Option<bool>,
    /// `Some(true)`: a tool shall be in it at the end; `Some(false)`: none shall.
    pub fetches: Option<bool>,
}

/// A pocket, as a step names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pocket {
    /// That of the tool that was in the spindle at the beginning.
    Returned,
    /// That of the tool that shall be in it.
    Fetched,
}

/// Between spindle and magazine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handover {
    /// From the spindle to its pocket.
    ToPocket,
    /// From its pocket to the spindle.
    ToSpindle,
}

/// A carousel that a motor turns from pocket to pocket, as a Geneva drive does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carousel {
    /// Number of pockets.
    pub pockets: u32,
    /// Output that turns it to the next higher pocket.
    pub forward: u8,
    /// Output that turns it to the next lower one; `None`: it turns one way only.
    pub backward: Option<u8>,
    /// Input that turns on as a pocket arrives at the spindle.
    pub count: u8,
    /// Input that turns on as pocket 1 arrives.
    pub reference: Option<u8>,
    /// Longest time from one pocket to the next.
    pub longest: Time,
    /// Usual time from one pocket to the next.
    pub usual: Time,
}

/// Which tool is where.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Magazine {
    /// Tool in each pocket, pocket 1 first; 0 is none.
    pub pockets: Vec<u32>,
    /// Tool in the spindle; 0 is none.
    pub spindle: u32,
    /// Pocket to which that tool returns; 0: none is known.
    pub home: u32,
    /// Pocket at the spindle; `None`: not known.
    pub at: Option<u32>,
}

/// A tool change: from which tool to which, and their pockets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ToolChange {
    /// Tool in the spindle at the beginning; 0 is none.
    pub from: u32,
    /// Pocket to which it returns; 0 is none.
    pub returns_to: u32,
    /// Tool in the spindle at the end; 0 is none.
    pub to: u32,
    /// Pocket from which it comes; 0 is none.
    pub fetched_from: u32,
}

/// How far a sequence is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SequenceStage {
    /// Index of the step that is done now, from 0.
    pub step: usize,
    /// It is being undone.
    pub back: bool,
    /// The tools.
    pub change: ToolChange,
}

/// How a sequence that was left half way goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resume {
    /// Where it was left.
    pub stage: SequenceStage,
    /// It is undone.
    pub back: bool,
    /// Only the next step is done.
    pub one_step: bool,
}

impl When {
    /// Whether a step is done in this change.
    pub fn holds(self, change: &ToolChange) -> bool {
        self.returns.is_none_or(|returns| returns == (change.from != 0))
            && self.fetches.is_none_or(|fetches| fetches == (change.to != 0))
    }
}

impl Magazine {
    /// Number of the pocket that holds a tool.
    pub fn pocket_of(&self, tool: u32) -> Option<u32> {
        let at = self.pockets.iter().position(|held| *held == tool && tool != 0)?;
        Some(at as u32 + 1)
    }

    /// The change to a tool: the one in the spindle returns to where it came from, or to the first
    /// empty pocket. `None`: the tool is in no pocket, or no pocket is empty.
    pub fn change_to(&self, tool: u32) -> Option<ToolChange> {
        let is_free = |pocket: u32| {
            pocket != 0 && self.pockets.get(pocket as usize - 1).is_some_and(|held| *held == 0)
        };
        let empty = || (1..=self.pockets.len() as u32).find(|pocket| is_free(*pocket));
        let returns_to = match (self.spindle, self.pockets.is_empty()) {
            (0, _) | (_, true) => 0,
            _ if is_free(self.home) => self.home,
            _ => empty()?,
        };
        let fetched_from = match (tool, self.pockets.is_empty()) {
            (0, _) | (_, true) => 0,
            _ => self.pocket_of(tool)?,
        };
        Some(ToolChange { from: self.spindle, returns_to, to: tool, fetched_from })
    }

    /// A tool is handed over; `back`: the handover is undone.
    pub fn hand_over(&mut self, handover: Handover, change: &ToolChange, back: bool) {
        let mut put = |pocket: u32, tool: u32| {
            if let Some(held) =
                (pocket as usize).checked_sub(1).and_then(|i| self.pockets.get_mut(i))
            {
                *held = tool;
            }
        };
        (self.spindle, self.home) = match (handover, back) {
            (Handover::ToPocket, false) => {
                put(change.returns_to, change.from);
                (0, 0)
            }
            (Handover::ToPocket, true) => {
                put(change.returns_to, 0);
                (change.from, change.returns_to)
            }
            (Handover::ToSpindle, false) => {
                put(change.fetched_from, 0);
                (change.to, change.fetched_from)
            }
            (Handover::ToSpindle, true) => {
                put(change.fetched_from, change.to);
                (0, 0)
            }
        };
    }

    /// All tools in it and in the spindle, in rising order.
    pub fn tools(&self) -> Vec<u32> {
        let all = self.pockets.iter().copied().chain([self.spindle]);
        let mut tools: Vec<u32> = all.filter(|tool| *tool != 0).collect();
        tools.sort_unstable();
        tools
    }
}

impl Carousel {
    /// The shorter way from one pocket to another: pockets to pass, and whether backwards.
    pub const fn way(&self, from: u32, to: u32) -> (u32, bool) {
        let forward = (to + self.pockets - from) % self.pockets;
        let backward = self.pockets - forward;
        if self.backward.is_some() && backward < forward {
            (backward, true)
        } else {
            (forward, false)
        }
    }
}

impl Sequence {
    /// Indices of the steps of a change, in their order.
    pub fn steps_of<'a>(&'a self, change: &'a ToolChange) -> impl Iterator<Item = usize> + 'a {
        let all = self.steps.iter().enumerate();
        all.filter(|(_, step)| step.when.holds(change)).map(|(index, _)| index)
    }

    /// Outputs and inputs as they are known to be before a step of a change: from the rest state
    /// and all that the steps before it have switched and waited for.
    pub fn before(&self, step: usize, change: &ToolChange) -> (SignalStates, SignalStates) {
        let (mut outputs, mut inputs) = (self.rest_outputs.clone(), self.rest_inputs.clone());
        for index in self.steps_of(change).take_while(|index| *index < step) {
            let done = &self.steps[index];
            set_all(&mut outputs, &done.outputs);
            set_all(&mut inputs, &done.inputs);
        }
        (outputs, inputs)
    }

    /// Inputs as they should be once a step is done, or once it is undone.
    pub fn expected(&self, stage: &SequenceStage) -> SignalStates {
        let (_, mut inputs) = self.before(stage.step, &stage.change);
        if let Some(step) = self.steps.get(stage.step).filter(|_| !stage.back) {
            set_all(&mut inputs, &step.inputs);
        }
        inputs
    }
}

/// Sets signals, and adds those that were not known.
fn set_all(signals: &mut SignalStates, to: &[(u8, bool)]) {
    for (number, on) in to {
        match signals.iter_mut().find(|(known, _)| known == number) {
            Some((_, state)) => *state = *on,
            None => signals.push((*number, *on)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn a_carousel_turns_the_shorter_way() {
        let both = Carousel {
            pockets: 12,
            forward: 0,
            backward: Some(1),
            count: 0,
            reference: None,
            longest: Time::s(1.0),
            usual: Time::ZERO,
        };
        assert_eq!(both.way(1, 4), (3, false));
        assert_eq!(both.way(2, 11), (3, true));
        assert_eq!(both.way(5, 5), (0, false));
        assert_eq!(Carousel { backward: None, ..both }.way(2, 11), (9, false));
    }

    #[test]
    fn a_tool_returns_to_where_it_came_from_and_no_tool_is_lost() {
        let mut magazine = Magazine { pockets: vec![1, 2, 0, 4], spindle: 3, home: 3, at: Some(1) };
        let all = magazine.tools();
        let change = magazine.change_to(4).unwrap();
        assert_eq!(change, ToolChange { from: 3, returns_to: 3, to: 4, fetched_from: 4 });
        let before = magazine.clone();
        magazine.hand_over(Handover::ToPocket, &change, false);
        magazine.hand_over(Handover::ToSpindle, &change, false);
        assert_eq!((magazine.spindle, magazine.home, magazine.tools()), (4, 4, all));
        magazine.hand_over(Handover::ToSpindle, &change, true);
        magazine.hand_over(Handover::ToPocket, &change, true);
        assert_eq!(magazine, before);
        assert_eq!(magazine.change_to(9), None);
    }
}
