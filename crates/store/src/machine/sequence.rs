//! Sequences of the machine: what a tool change consists of.
//!
//! ```toml
//! [tool_change.carousel]                    # a drive that turns it from pocket to pocket
//! forward = "carousel forward"              # outputs and inputs by the names of [outputs] and [inputs]
//! count = "carousel pocket"
//!
//! [[sequences]]
//! name = "tool change"
//! on = "tool-change"
//! rest = { set = { drawbar = false }, wait = { "drawbar open" = false }, limit_s = 3 }
//! steps = [
//!   { name = "unclamp", set = { drawbar = true }, wait = { "drawbar open" = true }, limit_s = 2 },
//! ]
//! ```
use super::axis::FARTHEST_MM;
use super::sequence_check::{Guards, problems};
use super::signals::Names;
use crate::keys::Keys;
use canon::{Carousel, Handover, Pocket, Sequence, SequenceStep, SignalStates, When};
use units::{Angle, Length, Speed, Time};

/// Most steps of a sequence.
const MOST_STEPS: usize = 64;
/// Longest wait of a step, s.
const LONGEST_S: f64 = 3600.0;

/// Inputs and outputs of the machine, by their names.
#[derive(Clone, Copy)]
pub(super) struct NamedSignals<'a> {
    pub(super) inputs: &'a Names,
    pub(super) outputs: &'a Names,
}

/// A carousel, and the inputs by which its sequences are checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarouselFile {
    /// What the control turns.
    pub carousel: Carousel,
    guards: Guards,
}

impl CarouselFile {
    /// `[tool_change.carousel]`.
    pub(super) fn read(keys: &mut Keys<'_>, signals: NamedSignals<'_>, pockets: u32) -> Self {
        let output =
            |keys: &mut Keys<'_>, key| named(keys, key, &signals.outputs.digital, "output");
        let input = |keys: &mut Keys<'_>, key| named(keys, key, &signals.inputs.digital, "input");
        if !(1..=200).contains(&pockets) {
            let text = format!(
                "a carousel has 1 to 200 pockets, and `pockets` of [tool_change] is {pockets}"
            );
            keys.conflict("", text);
        }
        let carousel = Carousel {
            pockets: pockets.max(1),
            forward: output(keys, "forward").unwrap_or(0),
            backward: optional(keys, "backward", &signals.outputs.digital, "output"),
            count: input(keys, "count").unwrap_or(0),
            reference: optional(keys, "reference", &signals.inputs.digital, "input"),
            longest: Time::s(keys.number("pocket_limit_s", 0.01..=LONGEST_S)),
            usual: Time::s(keys.number("pocket_s", 0.0..=LONGEST_S)),
        };
        let guards = Guards {
            pocket_at_spindle: input(keys, "pocket_at_spindle").unwrap_or(0),
            tool_released: input(keys, "tool_released").unwrap_or(0),
            tool_clamped: input(keys, "tool_clamped").unwrap_or(0),
        };
        Self { carousel, guards }
    }
}

/// `[[sequences]]`: so far, of the tool change alone.
pub(super) fn read(
    keys: &mut Keys<'_>,
    signals: NamedSignals<'_>,
    carousel: Option<CarouselFile>,
) -> Sequence {
    keys.choice("on", &[("tool-change", ())]);
    let name = keys.text("name");
    let (rest_outputs, rest_inputs, rest_longest) = keys.section("rest", |keys| {
        let (set, wait) = (outputs(keys, signals), inputs(keys, signals));
        let longest = keys.optional("limit_s", 0.01..=LONGEST_S);
        if longest.is_none() && !wait.is_empty() {
            keys.conflict("wait", "a wait has a limit: expected `limit_s` in [rest]");
        }
        (set, wait, Time::s(longest.unwrap_or(0.0)))
    });
    let steps = keys.sections("steps", MOST_STEPS, |keys| step(keys, signals));
    let carousel_of = carousel.map(|file| file.carousel);
    let sequence =
        Sequence { name, rest_outputs, rest_inputs, rest_longest, steps, carousel: carousel_of };
    let guards = carousel.map(|file| file.guards);
    for problem in problems(&sequence, guards.as_ref(), signals) {
        keys.conflict("steps", problem);
    }
    sequence
}

fn step(keys: &mut Keys<'_>, signals: NamedSignals<'_>) -> SequenceStep {
    let name = keys.text("name");
    let (to, speed) = keys
        .optional_section("move", |keys| {
            let axes =
                [("x_mm", canon::Axis::X), ("y_mm", canon::Axis::Y), ("z_mm", canon::Axis::Z)];
            let to: Vec<_> = axes
                .into_iter()
                .filter_map(|(key, axis)| {
                    let place = keys.optional(key, -FARTHEST_MM..=FARTHEST_MM)?;
                    Some((axis, Length::mm(place)))
                })
                .collect();
            if to.is_empty() {
                keys.conflict(
                    "",
                    format!("step \"{name}\" moves no axis: expected x_mm, y_mm or z_mm"),
                );
            }
            let speed = keys.optional("mm_per_min", 1.0..=1e6);
            (to, speed.map(|speed| Speed::mm_per_s(speed / 60.0)))
        })
        .unwrap_or_default();
    let longest = keys.optional("limit_s", 0.01..=LONGEST_S);
    let limit = Time::s(longest.unwrap_or(0.0));
    let orient = keys.optional("orient_deg", -360.0..=360.0);
    let step = SequenceStep {
        when: when(keys),
        operator: keys.optional_text("operator"),
        orient: orient.map(|deg| (Angle::rev(deg / 360.0), limit)),
        to,
        speed,
        index: keys.optional_choice(
            "index",
            &[("returned", Pocket::Returned), ("fetched", Pocket::Fetched)],
        ),
        outputs: outputs(keys, signals),
        dwell: Time::s(keys.optional("dwell_s", 0.0..=LONGEST_S).unwrap_or(0.0)),
        inputs: inputs(keys, signals),
        longest: limit,
        usual: Time::s(keys.optional("usual_s", 0.0..=LONGEST_S).unwrap_or(0.0)),
        handover: keys.optional_choice(
            "hands_over",
            &[("to-pocket", Handover::ToPocket), ("to-spindle", Handover::ToSpindle)],
        ),
        undone_by_hand: keys.optional_choice("undo", &[("by-hand", true)]).unwrap_or(false),
        name,
    };
    check_alone(&step, longest.is_some(), keys);
    step
}

/// What is wrong with a step whatever the others are.
fn check_alone(step: &SequenceStep, has_limit: bool, keys: &Keys<'_>) {
    let name = &step.name;
    if !has_limit && !step.inputs.is_empty() {
        let text = format!(
            "step \"{name}\" waits without a limit: expected `limit_s`, such as twice what it takes"
        );
        keys.conflict("wait", text);
    }
    if !has_limit && step.orient.is_some() {
        let text =
            format!("step \"{name}\" orients the spindle without a limit: expected `limit_s`");
        keys.conflict("orient_deg", text);
    }
    if step.outputs.len() + step.to.len() == 0
        && step.inputs.is_empty()
        && (step.orient.is_none() && step.index.is_none() && step.operator.is_none())
        && step.dwell <= Time::ZERO
    {
        let text = format!(
            "step \"{name}\" does nothing: expected set, wait, move, index, orient_deg, dwell_s or operator"
        );
        keys.conflict("name", text);
    }
    if !step.outputs.is_empty() && step.inputs.is_empty() && step.dwell <= Time::ZERO {
        let text = format!(
            "step \"{name}\" switches outputs, and nothing says when that is done: expected `wait` with an input, or `dwell_s`"
        );
        keys.conflict("set", text);
    }
    if step.longest > Time::ZERO && step.usual > step.longest {
        let (usual, limit) = (step.usual.value(), step.longest.value());
        let text = format!("step \"{name}\" usually takes {usual} s, above its limit of {limit} s");
        keys.conflict("usual_s", text);
    }
}

fn when(keys: &mut Keys<'_>) -> When {
    let mut when = When::default();
    let Some(text) = keys.optional_text("when") else { return when };
    for word in text.split_whitespace() {
        match word {
            "returns" => when.returns = Some(true),
            "returns-none" => when.returns = Some(false),
            "fetches" => when.fetches = Some(true),
            "fetches-none" => when.fetches = Some(false),
            _ => keys.unknown_name(
                "when",
                format!("`when` says \"{word}\": expected returns, returns-none, fetches or fetches-none"),
            ),
        }
    }
    when
}

fn outputs(keys: &mut Keys<'_>, signals: NamedSignals<'_>) -> SignalStates {
    states(keys, "set", &signals.outputs.digital, "output")
}

fn inputs(keys: &mut Keys<'_>, signals: NamedSignals<'_>) -> SignalStates {
    states(keys, "wait", &signals.inputs.digital, "input")
}

fn states(
    keys: &mut Keys<'_>,
    key: &'static str,
    names: &[(u8, String)],
    kind: &str,
) -> SignalStates {
    let stated = keys.optional_section(key, |keys| {
        let flags = keys.flags();
        let mut states = Vec::new();
        for (name, on) in flags {
            match number_of(&name, names, kind) {
                Ok(number) => states.push((number, on)),
                Err(why) => keys.unknown_name(&name, why),
            }
        }
        states
    });
    stated.unwrap_or_default()
}

/// The signal that a key names.
pub(super) fn named(
    keys: &mut Keys<'_>,
    key: &'static str,
    names: &[(u8, String)],
    kind: &str,
) -> Option<u8> {
    let name = keys.text(key);
    if name.is_empty() {
        return None;
    }
    number_of(&name, names, kind).map_err(|why| keys.unknown_name(key, why)).ok()
}

/// The signal that a key names, if it is stated.
fn optional(
    keys: &mut Keys<'_>,
    key: &'static str,
    names: &[(u8, String)],
    kind: &str,
) -> Option<u8> {
    let name = keys.optional_text(key)?;
    number_of(&name, names, kind).map_err(|why| keys.unknown_name(key, why)).ok()
}

fn number_of(name: &str, names: &[(u8, String)], kind: &str) -> Result<u8, String> {
    let mut of = names.iter().filter(|(_, known)| known == name).map(|(number, _)| *number);
    match (of.next(), of.next()) {
        (Some(number), None) => Ok(number),
        (Some(one), Some(other)) => Err(format!(
            "two {kind}s are named \"{name}\": {one} and {other}; expected a name of its own for each"
        )),
        (None, _) => {
            let all: Vec<String> = names.iter().map(|(_, name)| format!("\"{name}\"")).collect();
            Err(format!("no {kind} is named \"{name}\": expected one of {}", all.join(", ")))
        }
    }
}
