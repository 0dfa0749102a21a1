//! What cannot be ordered while the tool is kept beside the path.
//!
//! A block's orders come in a fixed sequence: first switches, tools and the plane, then G40 to G42,
//! then offsets, path control and the rest. So what comes before it meets what the blocks before
//! have left, and what comes after it meets what this block begins or ends.
use crate::{
    codes::{GGroup, MGroup},
    coordinates::offsets,
    dialect::rules::StartUp,
    fault::{Outcome, error},
    modes::Modes,
    state::executor::Settings,
    words::Words,
};
use canon::Plane;

pub(crate) fn check_compensated(words: &Words, modes: &Modes, settings: &Settings) -> Outcome {
    let code = words.g(GGroup::Compensation);
    // other controls than LinuxCNC restate and end modes in one block with whatever they like
    let strict = !settings.rules.restates_modes;
    let before = modes.compensating() && (strict || code != Some(400));
    let after = match code {
        Some(400) => false,
        Some(_) => strict,
        None => modes.compensating(),
    };
    let what = None.or_else(|| forbidden_before(words, modes).filter(|_| before)).or_else(|| {
        forbidden_after(words, modes, strict, settings.rules.start_up).filter(|_| after)
    });
    let Some(what) = what else { return Ok(()) };
    let text = format!("{what} while cutter radius compensation is on");
    let help = "write G40 in a block before it, and G41 or G42 in one after it";
    Err(error("I0544", words.place.span, text).with_help(help).into())
}

fn forbidden_before(words: &Words, modes: &Modes) -> Option<&'static str> {
    let plane = match words.g(GGroup::Plane) {
        Some(170) => modes.plane != Plane::XY,
        Some(180) => modes.plane != Plane::ZX,
        other => other.is_some(),
    };
    match () {
        () if plane => Some("the plane cannot be changed"),
        () if words.m(MGroup::Tool).is_some() => Some("the tool cannot be changed"),
        () if words.m(MGroup::Overrides).is_some() => Some("overrides cannot be switched"),
        () if words.m(MGroup::Outputs) == Some(66) => Some("inputs cannot be waited for"),
        () if words.m(MGroup::Outputs).is_some() => Some("outputs cannot be switched"),
        () => None,
    }
}

fn forbidden_after(
    words: &Words,
    modes: &Modes,
    strict: bool,
    start_up: StartUp,
) -> Option<&'static str> {
    let other = |code| strict || offsets::system_of(code) != modes.system;
    match () {
        () if words.g(GGroup::ToolLength).is_some() => {
            Some("the tool length offset cannot be changed")
        }
        () if words.g(GGroup::PathControl).is_some() => Some("the path control cannot be changed"),
        () if words.g(GGroup::WorkOffset).is_some_and(other) => {
            Some("the work offset cannot be called")
        }
        () => match words.g(GGroup::NonModal)? {
            // Fanuc's controls end it on the way to the intermediate point, and start it up again
            // behind it
            280 | 300 if start_up == StartUp::BesideNext => None,
            280 | 281 | 300 | 301 => Some("the reference points cannot be used"),
            520 | 920..=923 => Some("the offsets of G52 and G92 cannot be changed"),
            530 => Some("G53 cannot be used"),
            _ => None,
        },
    }
}
