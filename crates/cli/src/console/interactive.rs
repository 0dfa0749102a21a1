//! A terminal before a control: machine time passes as on the wall, lines are edited, completed and remembered.
//!
//! ```text
//!   this thread    reedline: a line ──► channel ──► control's thread: request, periods by the clock
//!                  printer ◄── what happened ◄────────┘
//! ```
use super::command::WORDS;
use super::session::{Failure, Session};
use super::{Ending, show};
use crate::say;
use control::Refused;
use control::operation::{Control, ControlOptions};
use reedline::{
    DefaultCompleter, DefaultPrompt, DefaultPromptSegment, ExternalPrinter, Reedline, Signal,
};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel};
use std::time::Duration;
use units::Time;

/// The control is looked after so often.
const TURN: Duration = Duration::from_millis(2);
/// A machine that is further behind the clock than this gives up the rest.
const MOST_BEHIND: Time = Time::s(0.1);

/// What the control's thread answers to a line.
enum LineResult {
    /// It is done; the status line.
    Done(String),
    /// It has failed; the status line.
    Failed(String, String),
    /// It was the last one.
    Over,
}

/// Until the operator quits.
pub(super) fn run(options: ControlOptions) -> Result<Ending, Refused> {
    let printer = ExternalPrinter::<String>::default();
    let (lines, typed) = channel::<String>();
    let (answers, answered) = channel::<LineResult>();
    let (up, is_up) = channel::<Result<(), Refused>>();
    let out = printer.sender();
    let thread = std::thread::Builder::new().name("control".into());
    let thread = thread.spawn(move || lead(options, &up, &typed, &answers, &out));
    let thread = thread.map_err(|e| Refused::because(format!("cannot start a thread: {e}")))?;
    is_up.recv().map_err(|_| Refused::because("the control has ended"))??;
    say::out("the control is on, its drives are off; help lists what can be typed\n")?;
    let words = WORDS.iter().map(|(words, _)| (*words).to_owned()).collect();
    let mut editor = Reedline::create()
        .with_completer(Box::new(DefaultCompleter::new_with_wordlen(words, 2)))
        .with_external_printer(printer);
    let mut state = String::from("READY");
    loop {
        let prompt = DefaultPrompt::new(
            DefaultPromptSegment::Basic(state.clone()),
            DefaultPromptSegment::Empty,
        );
        let line = match editor.read_line(&prompt) {
            Ok(Signal::Success(line)) => line,
            Ok(_) => "quit".to_owned(),
            Err(e) => return Err(Refused::because(format!("cannot read the terminal: {e}"))),
        };
        if line.trim().is_empty() {
            continue;
        }
        if lines.send(line).is_err() {
            break;
        }
        match answered.recv() {
            Ok(LineResult::Done(now)) => state = now,
            Ok(LineResult::Failed(why, now)) => {
                say::err(&format!("{why}\n"));
                state = now;
            }
            Ok(LineResult::Over) | Err(_) => break,
        }
    }
    drop(lines);
    let _ = thread.join(); // it has nothing more to say
    Ok(Ending::Good)
}

/// The control's thread.
fn lead(
    options: ControlOptions,
    up: &Sender<Result<(), Refused>>,
    typed: &Receiver<String>,
    answers: &Sender<LineResult>,
    out: &SyncSender<String>,
) {
    let control = match Control::new(options) {
        Ok(control) => control,
        Err(refused) => {
            let _ = up.send(Err(refused));
            return;
        }
    };
    if up.send(Ok(())).is_err() {
        return;
    }
    let mut session = Session::new(control);
    session.keep_time();
    loop {
        match typed.recv_timeout(TURN) {
            Ok(line) => {
                let done = session.execute(&line);
                say_all(&mut session, out);
                let now = show::line(&session.control.status());
                let answer = match done {
                    Ok(true) => LineResult::Done(now),
                    Ok(false) => LineResult::Over,
                    Err(Failure::NotMet(why) | Failure::Refused(why)) => {
                        LineResult::Failed(why, now)
                    }
                };
                let is_over = matches!(answer, LineResult::Over);
                if answers.send(answer).is_err() || is_over {
                    break;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        let behind = -session.ahead();
        if behind > MOST_BEHIND {
            session.keep_time(); // the machine has stood still meanwhile
        }
        session.pass(behind.min(MOST_BEHIND).max(Time::ZERO));
        say_all(&mut session, out);
    }
    session.come_to_rest();
}

fn say_all(session: &mut Session, out: &SyncSender<String>) {
    for line in session.take_said().lines() {
        let _ = out.try_send(line.to_owned()); // a terminal that is gone, or does not keep up
    }
}
