//! A control and what is typed to it: requests are made, waits let machine time pass, what happens
//! is said.
use super::command::Command;
use super::show;
use crate::refusal;
use control::operation::{Control, Event, Jog, Refusal, Request, Status, said_of};
use units::Time;

/// Why a line has failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// What was waited for did not come.
    NotMet(String),
    /// The request was refused, or the line is none.
    Refused(String),
}

impl Failure {
    /// What a line waited for did not come within this time.
    pub(super) fn not_met(line: &str, within: Time, status: &Status) -> Self {
        let (within, status) = (within.value(), show::line(status));
        Self::NotMet(format!("\"{line}\" was not met within {within:.3} s; it is: {status}"))
    }

    /// What a line waited for cannot come any more.
    fn never_met(line: &str, why: &str, status: &Status) -> Self {
        let status = show::line(status);
        Self::NotMet(format!("\"{line}\" cannot be met any more: {why}; it is: {status}"))
    }
}

/// Ask the control; what is to be known of it.
pub(super) fn request(control: &mut Control, request: &Request) -> Result<Vec<String>, Failure> {
    match control.request(request) {
        Ok(accepted) => Ok(accepted.notes),
        Err(Refusal::Request(refused)) => Err(Failure::Refused(refusal::plain(&refused))),
        Err(refusal @ Refusal::State(_)) => Err(Failure::Refused(format!("refused: {refusal}"))),
    }
}

/// What has happened, for people.
pub(super) fn happened(event: &Event) -> String {
    match event {
        Event::Execution(execution) => execution.name().to_owned(),
        Event::Mode(mode) => mode.name().to_owned(),
        Event::DrivesReady => "the drives are ready".to_owned(),
        Event::Alarm(alarm) => format!("{}\n            {}", alarm.text, alarm.remedy),
        Event::Notice(text) => text.clone(),
        Event::Feature(feature) => said_of(feature),
    }
}

/// A continuous jog is asked for again after this share of its lease.
const RENEWED: f64 = 0.5;
/// An alarm that stands for so long, with everything at rest, lets nothing happen that a line could
/// wait for.
const STOPPED_FOR: Time = Time::s(1.0);
/// How long moving things may take to come to rest at the end.
const COMES_TO_REST: Time = Time::s(120.0);

/// A control, and what is to be printed.
pub(crate) struct Session {
    pub(crate) control: Control,
    said: String,
}

impl Session {
    /// With a control that was switched on just now.
    pub(crate) const fn new(control: Control) -> Self {
        Self { control, said: String::new() }
    }

    /// What is to be printed since the last time.
    pub(crate) fn take_said(&mut self) -> String {
        std::mem::take(&mut self.said)
    }

    fn say(&mut self, text: &str) {
        self.said.push_str("  ");
        self.said.push_str(text);
        self.said.push('\n');
    }

    /// A line and what it means; false: the last one.
    pub(crate) fn execute(&mut self, line: &str, command: Command) -> Result<bool, Failure> {
        match command {
            Command::Request(request) => self.request(&request)?,
            Command::Leased(request, lasts) => self.leased(&request, lasts)?,
            Command::Wait(condition, within) => {
                let end = self.control.now() + within;
                let mut stopped_at = None;
                while !condition.holds(&self.control) {
                    if let Some(why) = self.stopped_for_good(&mut stopped_at) {
                        return Err(Failure::never_met(line, &why, &self.control.status()));
                    }
                    if self.control.now() >= end || condition.is_answered_at_once() {
                        let status = self.control.status();
                        return Err(Failure::not_met(line, within, &status));
                    }
                    self.period();
                }
                let status = show::line(&self.control.status());
                self.say(&status);
            }
            Command::Pass(time) => self.pass(time),
            Command::Status(as_json) => {
                let status = self.control.status();
                self.said.push_str(&show::status(&status, as_json));
            }
            Command::Features => self.said.push_str(&show::features(&self.control)),
            Command::Sequence => self.said.push_str(&show::sequence(&self.control)),
            Command::Alarms => self.said.push_str(&show::alarms(&self.control)),
            Command::Offsets => self.said.push_str(&show::offsets(&self.control)),
            Command::Tools => self.said.push_str(&show::tools(&self.control)),
            Command::Help => self.said.push_str(&show::help()),
            Command::Quit => return Ok(false),
        }
        Ok(true)
    }

    /// Why nothing changes any more unless it is asked for, once that is so for a while; since when
    /// it is.
    fn stopped_for_good(&self, since: &mut Option<Time>) -> Option<String> {
        let Some(why) = self.control.stopped_by() else {
            *since = None;
            return None;
        };
        let now = self.control.now();
        let stopped_at = *since.get_or_insert(now);
        (now - stopped_at >= STOPPED_FOR).then_some(why)
    }

    fn request(&mut self, request: &Request) -> Result<(), Failure> {
        for note in self::request(&mut self.control, request)? {
            self.say(&note);
        }
        self.happened();
        Ok(())
    }

    /// Ask again and again, as a panel does while a key is pressed.
    fn leased(&mut self, request: &Request, lasts: Time) -> Result<(), Failure> {
        let end = self.control.now() + lasts;
        while self.control.now() < end {
            self.request(request)?;
            let renewed = self.control.now() + Jog::LEASE * RENEWED;
            while self.control.now() < renewed.min(end) {
                self.period();
            }
        }
        self.request(&Request::JogStop)
    }

    /// Let machine time pass.
    pub(crate) fn pass(&mut self, time: Time) {
        let end = self.control.now() + time;
        while self.control.now() < end {
            self.period();
        }
    }

    /// A servo period, and what happened in it.
    pub(crate) fn period(&mut self) {
        self.control.period();
        self.control.answer_panel();
        self.happened();
    }

    fn happened(&mut self) {
        while let Some(event) = self.control.next_event() {
            let text = self::happened(&event);
            let now = self.control.now().value();
            self.say(&format!("{now:8.3} s  {text}"));
        }
    }

    /// The last line was read: nothing goes on moving without anybody to lead it. What was left
    /// open.
    pub(crate) fn come_to_rest(&mut self) -> Option<String> {
        let moved = self.control.is_moving_manually();
        let execution = self.control.execution();
        let open = if execution.is_under_way() {
            let _ = self.control.request(&Request::Stop); // a program is under way
            Some(format!("the script ends while a program is {}: it is given up", execution.name()))
        } else if moved {
            let _ = self.control.request(&Request::JogStop); // always accepted
            Some("the script ends in the middle of a jog: it is brought to rest".to_owned())
        } else {
            None
        };
        let end = self.control.now() + COMES_TO_REST;
        while open.is_some() && !self.control.is_at_standstill() && self.control.now() < end {
            self.period();
        }
        open
    }
}
