//! What is wrong with a sequence as a whole: each of its three kinds of changes is gone through
//! with what is known of tools, outputs and inputs after each step.
//!
//! ```text
//!   a tool for another one      returns, fetches
//!   the spindle is emptied      returns, fetches-none
//!   the first tool              returns-none, fetches
//! ```
use super::sequence::Signals;
use canon::{Change, Handover, Sequence, SequenceStep, SignalStates};

/// Inputs by which sequences with a carousel are checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Guards {
    /// On: a pocket is at the spindle.
    pub(super) pocket_at_spindle: u8,
    /// On: the drawbar is open, and a tool in the spindle is held by nothing else.
    pub(super) tool_released: u8,
    /// On: the drawbar is closed. It is neither while it moves.
    pub(super) tool_clamped: u8,
}

/// The three kinds of changes, and what each is.
const CHANGES: [(Change, &str); 3] = [
    (Change { from: 1, returns_to: 1, to: 2, fetched_from: 2 }, "one tool for another"),
    (Change { from: 1, returns_to: 1, to: 0, fetched_from: 0 }, "the spindle emptied"),
    (Change { from: 0, returns_to: 0, to: 2, fetched_from: 2 }, "the first tool"),
];

/// Everything that is wrong with it, each in a sentence.
pub(super) fn problems(
    sequence: &Sequence,
    guards: Option<&Guards>,
    signals: Signals<'_>,
) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut add = |text: String| {
        if !found.contains(&text) {
            found.push(text);
        }
    };
    for (index, step) in sequence.steps.iter().enumerate() {
        let place = place(index, step);
        if sequence.steps[..index].iter().any(|other| other.name == step.name) {
            add(format!("{place}: another step has the same name"));
        }
        if !CHANGES.iter().any(|(change, _)| step.when.holds(change)) {
            add(format!(
                "{place} is never reached: no tool change is both returns-none and fetches-none"
            ));
        }
        if step.index.is_some() && sequence.carousel.is_none() {
            add(format!("{place} turns a carousel: expected [tool_change.carousel]"));
        }
    }
    for (change, kind) in &CHANGES {
        let mut walk =
            Walk { sequence, change, kind, guards, signals, inputs: sequence.rest_inputs.clone() };
        walk.check(&mut add);
    }
    found
}

fn place(index: usize, step: &SequenceStep) -> String {
    format!("step {} \"{}\"", index + 1, step.name)
}

/// One kind of change, step by step.
struct Walk<'a> {
    sequence: &'a Sequence,
    change: &'a Change,
    kind: &'a str,
    guards: Option<&'a Guards>,
    signals: Signals<'a>,
    /// Inputs that are known.
    inputs: SignalStates,
}

impl Walk<'_> {
    fn check(&mut self, add: &mut impl FnMut(String)) {
        let mut tool = self.change.from;
        for index in self.sequence.steps_of(self.change) {
            let step = &self.sequence.steps[index];
            let place = place(index, step);
            self.check_way_back(index, step, &place, add);
            self.check_hardware(step, tool, &place, add);
            for (number, on) in &step.inputs {
                match self.inputs.iter_mut().find(|(known, _)| known == number) {
                    Some((_, state)) => *state = *on,
                    None => self.inputs.push((*number, *on)),
                }
            }
            match step.handover {
                Some(Handover::ToPocket) if tool != 0 => tool = 0,
                Some(Handover::ToSpindle) if tool == 0 && self.change.to != 0 => {
                    tool = self.change.to;
                }
                Some(_) => add(format!(
                    "{place} hands over a tool, and there is none to hand over in this change ({}): expected `when`",
                    self.kind
                )),
                None => {}
            }
        }
        self.check_end(tool, add);
    }

    /// It ends as it began, with the tool that is wanted.
    fn check_end(&self, tool: u32, add: &mut impl FnMut(String)) {
        let kind = self.kind;
        if tool != self.change.to {
            let (has, wanted) = if self.change.to == 0 {
                ("still the tool", "hands_over = \"to-pocket\"")
            } else {
                ("not the tool that is fetched", "hands_over = \"to-spindle\"")
            };
            add(format!(
                "at the end of a change ({kind}) the spindle has {has}: expected a step with {wanted}"
            ));
        }
        let (outputs, _) = self.sequence.before(usize::MAX, self.change);
        let ends = [
            (&self.sequence.rest_outputs, &outputs, &self.signals.outputs.digital, "output"),
            (&self.sequence.rest_inputs, &self.inputs, &self.signals.inputs.digital, "input"),
        ];
        for (rest, end, names, sort) in ends {
            for (number, on) in rest {
                let at_end = end.iter().find(|(known, _)| known == number);
                if at_end.is_some_and(|(_, state)| state != on) {
                    let (name, is) = (name(names, *number), state(!*on));
                    add(format!(
                        "a change ({kind}) ends with {sort} \"{name}\" {is}, and begins with it {}: expected the last steps to lead back to `rest`",
                        state(*on)
                    ));
                }
            }
        }
    }

    /// What a step switches and waits for was known before it, so that it can be undone.
    fn check_way_back(
        &self,
        index: usize,
        step: &SequenceStep,
        place: &str,
        add: &mut impl FnMut(String),
    ) {
        if step.undone_by_hand {
            return;
        }
        let (outputs, _) = self.sequence.before(index, self.change);
        for (number, _) in &step.outputs {
            if !outputs.iter().any(|(known, _)| known == number) {
                let name = name(&self.signals.outputs.digital, *number);
                add(format!(
                    "{place} has no way back: nothing before it says what output \"{name}\" was; state it in `rest`, or undo = \"by-hand\""
                ));
            }
        }
        if step.operator.is_some() {
            add(format!(
                "{place} has no way back: what a person did, a person undoes; expected undo = \"by-hand\""
            ));
        }
    }

    /// No axis moves towards a clamped tool, no tool drops.
    fn check_hardware(
        &self,
        step: &SequenceStep,
        tool: u32,
        place: &str,
        add: &mut impl FnMut(String),
    ) {
        let Some(guards) = self.guards else { return };
        let is_on =
            |input: u8| self.inputs.iter().find(|(known, _)| *known == input).map(|(_, on)| *on);
        let waits = |input: u8, on: bool| step.inputs.contains(&(input, on));
        let at_spindle = is_on(guards.pocket_at_spindle);
        let released = is_on(guards.tool_released);
        let names = &self.signals.inputs.digital;
        let (at_name, released_name) =
            (name(names, guards.pocket_at_spindle), name(names, guards.tool_released));
        if !step.to.is_empty() && at_spindle != Some(false) && released != Some(true) {
            add(format!(
                "{place} moves an axis while a pocket is at the spindle and the tool is clamped (\"{at_name}\" on, \"{released_name}\" not): expected the drawbar open before it"
            ));
        }
        if step.index.is_some() && at_spindle != Some(false) && tool != 0 {
            add(format!(
                "{place} turns the carousel while a pocket holds the tool of the spindle (\"{at_name}\" on)"
            ));
        }
        if waits(guards.tool_released, true) && tool != 0 && at_spindle != Some(true) {
            add(format!(
                "{place} releases the tool, and no pocket is at the spindle (\"{at_name}\" is not known to be on): it would drop"
            ));
        }
        let proof = match step.handover {
            Some(Handover::ToPocket) => Some(guards.tool_released),
            Some(Handover::ToSpindle) => Some(guards.tool_clamped),
            None => None,
        };
        if let Some(input) = proof.filter(|input| !waits(*input, true)) {
            let proves = name(names, input);
            add(format!(
                "{place} hands over a tool, and nothing proves it: expected wait = {{ \"{proves}\" = true }}"
            ));
        }
    }
}

fn name(names: &[(u8, String)], number: u8) -> String {
    let known = names.iter().find(|(known, _)| *known == number);
    known.map_or_else(|| number.to_string(), |(_, name)| name.clone())
}

const fn state(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}
