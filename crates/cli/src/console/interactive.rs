//! A terminal before a control: machine time passes as on the wall, lines are edited, completed and
//! remembered.
//!
//! ```text
//!   this thread    reedline: a line ──► command ──► control::operation::hosted, which paces the control
//!   printer        what happened ◄── events of the hosted control
//! ```
use super::command::{Command, WORDS};
use super::session::{Failure, happened, request};
use super::{Ending, show};
use crate::say;
use control::Refused;
use control::operation::hosted::{Client, HostOptions, Hosted};
use control::operation::{Control, ControlOptions, Jog, Request};
use reedline::{
    DefaultCompleter, DefaultPrompt, DefaultPromptSegment, ExternalPrinter, Reedline, Signal,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use units::Time;

/// A wait looks so often.
const LOOK: Duration = Duration::from_millis(5);
/// A continuous jog is asked for again so often: half its lease.
const RENEWED: Duration = Duration::from_millis(100);

/// Until the operator quits.
pub(super) fn run(options: ControlOptions) -> Result<Ending, Refused> {
    let hosted = Hosted::start(options, HostOptions::default())?;
    let client = hosted.client();
    let printer = ExternalPrinter::<String>::default();
    let is_over = Arc::new(AtomicBool::new(false));
    let thread = {
        let (client, out, is_over) = (client.clone(), printer.sender(), Arc::clone(&is_over));
        let thread = std::thread::Builder::new().name("printer".into());
        thread.spawn(move || {
            let mut last = 0;
            while !is_over.load(Ordering::Relaxed) {
                let (events, _, newest) = client.events_after(last);
                last = newest;
                for event in events {
                    let line =
                        format!("  {:8.3} s  {}", event.time.value(), happened(&event.event));
                    let _ = out.try_send(line); // a terminal that is gone, or does not keep up
                }
                std::thread::sleep(LOOK);
            }
        })
    };
    let thread = thread.map_err(|e| Refused::because(format!("cannot start a thread: {e}")))?;
    say::out("the control is on, its drives are off; help lists what can be typed\n")?;
    let words = WORDS.iter().map(|(words, _)| (*words).to_owned()).collect();
    let mut editor = Reedline::create()
        .with_completer(Box::new(DefaultCompleter::new_with_wordlen(words, 2)))
        .with_external_printer(printer);
    loop {
        let prompt = DefaultPrompt::new(
            DefaultPromptSegment::Basic(show::line(&client.latest().status)),
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
        match execute(&client, &line) {
            Ok(Some(said)) => say::out(&said)?,
            Ok(None) => break,
            Err(Failure::NotMet(why) | Failure::Refused(why)) => say::err(&format!("{why}\n")),
        }
    }
    is_over.store(true, Ordering::Relaxed);
    let _ = thread.join(); // it has nothing more to say
    Ok(Ending::Good)
}

/// A line, and what is printed; `None`: the last one.
fn execute(client: &Client, line: &str) -> Result<Option<String>, Failure> {
    let show = |shown: fn(&Control) -> String| on(client, move |control| shown(control));
    Ok(Some(match Command::read(line).map_err(Failure::Refused)? {
        Command::Request(asked) => notes(&ask(client, asked)?),
        Command::Leased(asked, lasts) => {
            let end = now(client) + lasts;
            while now(client) < end {
                ask(client, asked.clone())?;
                let left = Duration::from_secs_f64((end - now(client)).value().max(0.0));
                std::thread::sleep(RENEWED.min(left));
            }
            notes(&ask(client, Request::JogStop)?)
        }
        Command::Wait(condition, within) => {
            let end = now(client) + within;
            loop {
                let wanted = condition.clone();
                if on(client, move |control| wanted.holds(control))? {
                    break;
                }
                let status = &client.latest().status;
                if now(client) >= end || condition.is_answered_at_once() {
                    return Err(Failure::not_met(line, within, status));
                }
                std::thread::sleep(LOOK);
            }
            format!("  {}\n", show::line(&client.latest().status))
        }
        Command::Pass(time) => {
            let end = now(client) + time;
            while now(client) < end {
                std::thread::sleep(LOOK);
            }
            String::new()
        }
        Command::Status(as_json) => {
            on(client, move |control| show::status(&control.status(), as_json))?
        }
        Command::Features => show(show::features)?,
        Command::Sequence => show(show::sequence)?,
        Command::Alarms => show(show::alarms)?,
        Command::Offsets => show(show::offsets)?,
        Command::Tools => show(show::tools)?,
        Command::Help => show::help(),
        Command::Quit => return Ok(None),
    }))
}

/// Machine time.
fn now(client: &Client) -> Time {
    Time::s(client.latest().status.time_s)
}

fn ask(client: &Client, asked: Request) -> Result<Vec<String>, Failure> {
    on(client, move |control| request(control, &asked))?
}

fn notes(notes: &[String]) -> String {
    notes.iter().flat_map(|note| ["  ", note, "\n"]).collect()
}

/// In the control's thread.
fn on<T: Send + 'static>(
    client: &Client,
    work: impl FnOnce(&mut Control) -> T + Send + 'static,
) -> Result<T, Failure> {
    client.with(work).ok_or_else(|| Failure::Refused("the control has ended".to_owned()))
}

/// A continuous jog is renewed in time.
const _: () = assert!(RENEWED.as_millis() as f64 / 1e3 <= Jog::LEASE.value() / 2.0);
