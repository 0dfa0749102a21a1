//! What is wrong with a sequence as a whole: each of its three kinds of changes is gone through
//! with what is known of tools, outputs and inputs after each step.
//!
//! ```text
//!   a tool for another one      returns, fetches
//!   the spindle is emptied      returns, fetches-none
//!   the first tool              returns-none, fetches
//! ```
use super::sequence::NamedSignals;
use canon::{Handover, Sequence, SequenceStep, SignalStates, ToolChange};

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
const CHANGES: [(ToolChange, &str); 3] = [
    (ToolChange { from: 1, returns_to: 1, to: 2, fetched_from: 2 }, "one tool for another"),
    (ToolChange { from: 1, returns_to: 1, to: 0, fetched_from: 0 }, "the spindle emptied"),
    (ToolChange { from: 0, returns_to: 0, to: 2, fetched_from: 2 }, "the first tool"),
];

/// Everything that is wrong with it, each in a sentence.
pub(super) fn problems(
    sequence: &Sequence,
    guards: Option<&Guards>,
    signals: NamedSignals<'_>,
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
    change: &'a ToolChange,
    kind: &'a str,
    guards: Option<&'a Guards>,
    signals: NamedSignals<'a>,
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

#[cfg(test)]
mod tests {
    use crate::machine::{embedded, parse};

    /// What is found where one part of the umbrella mill's file is another.
    fn found(from: &str, to: &str) -> String {
        let text = embedded("umbrella-mill").unwrap();
        assert!(text.contains(from), "the file does not say {from}");
        let findings = parse(&text.replace(from, to), 0).unwrap_err();
        let each =
            findings.iter().map(|d| format!("{} line {}: {}", d.code, d.span.line, d.message));
        each.collect::<Vec<_>>().join("\n")
    }

    fn check(from: &str, to: &str, expected: &[&str]) {
        let found = found(from, to);
        for sentence in expected {
            assert!(found.contains(sentence), "expected \"{sentence}\", found:\n{found}");
        }
    }

    #[test]
    fn what_is_shipped_is_in_order() {
        let machine = parse(embedded("umbrella-mill").unwrap(), 0).unwrap();
        assert_eq!(machine.tool_change_sequence.unwrap().steps.len(), 15);
    }

    #[test]
    fn each_wait_has_a_limit_and_each_signal_is_there() {
        check(
            "wait = { \"drawbar open\" = true, \"drawbar closed\" = false }, limit_s = 2, usual_s = 0.3, hands",
            "wait = { \"drawbar opened\" = true }, usual_s = 0.3, hands",
            &[
                "no input is named \"drawbar opened\": expected one of",
                "hands over a tool, and nothing proves it: expected wait = { \"drawbar open\" = true }",
            ],
        );
        check(
            "move = { z_mm = 0 }, wait = { \"tool in taper\" = false }, limit_s = 1",
            "move = { z_mm = 0 }, wait = { \"tool in taper\" = false }",
            &["step \"clear above\" waits without a limit: expected `limit_s`"],
        );
        check(
            "set = { drawbar = false }, wait = { \"drawbar closed\" = true, \"drawbar open\" = false }, limit_s = 2, usual_s = 0.3 }",
            "set = { drawbar = false } }",
            &["step \"close\" switches outputs, and nothing says when that is done"],
        );
    }

    #[test]
    fn no_axis_moves_towards_a_clamped_tool_and_none_drops() {
        // Z goes up before the drawbar is open
        check(
            "{ name = \"unclamp\"",
            "{ name = \"up\", when = \"returns\", move = { z_mm = 0 } },\n  { name = \"unclamp\"",
            &[
                "step 7 \"up\" moves an axis while a pocket is at the spindle and the tool is clamped",
            ],
        );
        // the drawbar opens before the carousel has come
        check(
            "{ name = \"swing in\", when = \"returns\"",
            "{ name = \"open early\", when = \"returns\", set = { drawbar = true }, wait = { \"drawbar open\" = true }, limit_s = 2 },\n  { name = \"swing in\", when = \"returns\"",
            &["step 6 \"open early\" releases the tool, and no pocket is at the spindle"],
        );
        check(
            "{ name = \"unclamp\"",
            "{ name = \"turn\", when = \"returns fetches\", index = \"fetched\" },\n  { name = \"unclamp\"",
            &["step 7 \"turn\" turns the carousel while a pocket holds the tool of the spindle"],
        );
    }

    #[test]
    fn every_step_is_reached_has_a_way_back_and_leads_to_the_rest_state() {
        check(
            "when = \"fetches-none\"",
            "when = \"returns-none fetches-none\"",
            &[
                "step 15 \"close\" is never reached",
                "a change (the spindle emptied) ends with output \"drawbar\" on, and begins with it off",
            ],
        );
        check(
            "set = { drawbar = false, \"carousel in\" = false, \"carousel out\" = true }",
            "set = { \"carousel in\" = false, \"carousel out\" = true }",
            &[
                "step 7 \"unclamp\" has no way back: nothing before it says what output \"drawbar\" was",
            ],
        );
        check(
            "hands_over = \"to-spindle\"",
            "dwell_s = 0",
            &[
                "the spindle has not the tool that is fetched: expected a step with hands_over = \"to-spindle\"",
            ],
        );
        check(
            "move = { z_mm = -100, mm_per_min = 20_000 }",
            "move = { z_mm = -500 }",
            &["step \"lower\" moves Z to -500: outside its travel from -400 to 0 mm"],
        );
    }
}
