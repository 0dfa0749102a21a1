//! `leadscrew control`: a control that stays on, led from a terminal or by a script, a request a
//! line.
//!
//! ```text
//!   line ─► command: a request, a wait, a question ─► session ─► control::Control
//!                                                       │  └─ periods, as long as a wait lasts
//!   script: machine time runs only while a line waits   └► what happened, how it is
//!   terminal: the control is hosted in a thread of its own, paced by the clock; the script's words are typed
//! ```
mod command;
mod interactive;
mod session;
mod show;
mod wait;

use crate::args::ControlArgs;
use crate::say;
use canon::{Axis, Position};
use command::Command;
use control::Refused;
use control::operation::{Control, ControlOptions};
use session::{Failure, Session};
use std::io::{IsTerminal, Read};
use std::path::Path;
use units::Coordinate;

/// How a script has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Every request was accepted, every wait was met.
    Good,
    /// A wait was not met.
    NotMet,
    /// A request was refused, or a line is none.
    Refused,
}

/// Largest script.
const LONGEST_SCRIPT: u64 = 1 << 20;

/// Lead a control.
pub(crate) fn command(args: &ControlArgs, quiet: bool) -> Result<Ending, Refused> {
    let options = ControlOptions {
        program: args.source.on_a_machine(),
        seed: args.seed,
        state: args.state.clone(),
        drives: args.drives.clone().unwrap_or_default(),
        real_time: args.real_time.then(control::RealTimeOptions::default),
        clamped: args.clamped.as_deref().map(clamped).transpose()?.unwrap_or_default(),
    };
    let file = args.script.as_deref().filter(|path| *path != Path::new("-"));
    let is_typed = args.script.is_none() && std::io::stdin().is_terminal();
    let script = match file {
        Some(path) => Some(store::read_bytes(path, "a script", LONGEST_SCRIPT)?),
        None if is_typed => None,
        None => Some(from_standard_input()?),
    };
    let Some(script) = script else { return interactive::run(options) };
    let name = args.script.as_ref().map_or("-".into(), |path| path.display().to_string());
    let script = String::from_utf8(script)
        .map_err(|e| Refused::because(format!("{name}: expected text in UTF-8: {e}")))?;
    run_script(Control::new(options)?, &name, &script, quiet)
}

fn from_standard_input() -> Result<Vec<u8>, Refused> {
    let mut text = Vec::new();
    let read = std::io::stdin().take(LONGEST_SCRIPT).read_to_end(&mut text);
    read.map_err(|e| Refused::because(format!("cannot read standard input: {e}")))?;
    Ok(text)
}

/// Lines as they stand, with their numbers and what they mean; else each that means nothing.
fn read_script<'a>(
    name: &str,
    script: &'a str,
) -> Result<Vec<(usize, &'a str, Command)>, Vec<String>> {
    let (mut lines, mut wrong) = (Vec::new(), Vec::new());
    for (number, line) in (1..).zip(script.lines().map(str::trim)) {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match Command::read(line) {
            Ok(command) => lines.push((number, line, command)),
            Err(sentence) => wrong.push(format!("{name}:{number}: {sentence}\n")),
        }
    }
    if wrong.is_empty() { Ok(lines) } else { Err(wrong) }
}

/// Line by line; the first that fails ends it. Nothing is done where a line means nothing.
fn run_script(control: Control, name: &str, script: &str, quiet: bool) -> Result<Ending, Refused> {
    let lines = match read_script(name, script) {
        Ok(lines) => lines,
        Err(wrong) => {
            say::err(&wrong.concat());
            return Ok(Ending::Refused);
        }
    };
    let mut session = Session::new(control);
    for (number, line, command) in lines {
        if !quiet {
            say::out(&format!("> {line}\n"))?;
        }
        let done = session.execute(line, command);
        if !quiet {
            say::out(&session.take_said())?;
        }
        match done {
            Ok(true) => {}
            Ok(false) => break,
            Err(failure) => {
                let (ending, sentence) = match failure {
                    Failure::NotMet(sentence) => (Ending::NotMet, sentence),
                    Failure::Refused(sentence) => (Ending::Refused, sentence),
                };
                session.come_to_rest();
                say::err(&format!("{name}:{number}: {sentence}\n"));
                return Ok(ending);
            }
        }
    }
    let open = session.come_to_rest();
    if !quiet {
        say::out(&session.take_said())?;
    }
    Ok(match open {
        None => Ending::Good,
        Some(sentence) => {
            say::err(&format!("{name}: {sentence}\n"));
            Ending::NotMet
        }
    })
}

/// `X0.4,Y-0.3,Z1.2`, millimetres.
pub(crate) fn clamped(text: &str) -> Result<Position, Refused> {
    let mut shift = Position::default();
    for word in text.split(',').map(str::trim) {
        let axis = word.chars().next().and_then(Axis::from_letter);
        let value = word.get(1..).and_then(|number| number.parse::<f64>().ok());
        let (Some(axis), Some(value)) = (axis, value.filter(|value| value.is_finite())) else {
            return Err(Refused::because(format!(
                "--clamped: expected axes with millimetres, as in X0.4,Y-0.3,Z1.2, found \"{word}\""
            )));
        };
        shift = shift.with(axis, Coordinate::new(value));
    }
    Ok(shift)
}
