//! `leadscrew recover`: what is known of a tool in the work after the control has died, and the way
//! out.
pub(crate) mod advice;
mod say;

use crate::args::{Format, RecoverArgs};
use control::Refused;
use control::job::DEFAULT_MACHINE;
use control::recovery::{Known, Outcome, RecoveryOptions, recover};

/// Do it; whether nothing is left in the work.
pub(crate) fn command(args: &RecoverArgs) -> Result<bool, Refused> {
    let answer = recover(&options(args), &mut |known| picture(args, &known))?;
    let text = match args.format {
        Format::Json => say::json(args, &answer),
        Format::Text => say::text(args, &answer),
    };
    crate::say::out(&text)?;
    Ok(matches!(answer.outcome, Outcome::Recovered | Outcome::Nothing))
}

fn options(args: &RecoverArgs) -> RecoveryOptions {
    RecoveryOptions {
        socket: args.simulator.clone(),
        machine: args.machine.clone().unwrap_or_else(|| DEFAULT_MACHINE.into()),
        state: args.state.clone(),
        dry_run: args.dry_run,
        way: args.way.into(),
        tool_is_free: args.tool_is_free,
    }
}

/// Draw what is known before anything moves.
fn picture(args: &RecoverArgs, known: &Known<'_>) -> Result<Option<String>, Refused> {
    let Some(path) = &args.picture else { return Ok(None) };
    let picture = match known {
        Known::OnThread(record, findings) => Some(say::picture(record, findings)),
        Known::OffWork(record, feedback, file) => say::picture_of_pass(record, feedback, file),
    };
    let Some(picture) = picture else {
        let why = "there is no picture: only taps and threads of one lead go back along a line";
        return Ok(Some(why.into()));
    };
    store::output::write_file(path, picture.as_bytes())?;
    Ok(None)
}
