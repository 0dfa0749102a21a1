//! A control and what is typed to it: requests are made, waits let machine time pass, what happens is said.
use super::command::Command;
use super::show;
use crate::refusal;
use control::clock::now;
use control::operation::{Control, Event, Jog, Refusal, Request};
use std::time::{Duration, Instant};
use units::Time;

/// Why a line has failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// What was waited for did not come.
    NotMet(String),
    /// The request was refused, or the line is none.
    Refused(String),
}

/// A continuous jog is asked for again after this share of its lease.
const RENEWED: f64 = 0.5;
/// Machine time may be so far ahead of the wall's: no shorter sleep is worth it.
const AHEAD: Time = Time::s(0.002);
/// How long moving things may take to come to rest at the end.
const COMES_TO_REST: Time = Time::s(120.0);

/// A control, and what is to be printed.
pub(crate) struct Session {
    pub(crate) control: Control,
    said: String,
    /// Machine time passes as on the wall: from this moment, at which it was this.
    clock: Option<(Instant, Time)>,
}

impl Session {
    /// With a control that was switched on just now.
    pub(crate) const fn new(control: Control) -> Self {
        Self { control, said: String::new(), clock: None }
    }

    /// From now on machine time passes as on the wall.
    pub(crate) fn keep_time(&mut self) {
        self.clock = Some((now(), self.control.now()));
    }

    /// How far machine time is ahead of the wall's.
    pub(crate) fn ahead(&self) -> Time {
        let Some((began, at)) = self.clock else { return Time::ZERO };
        self.control.now() - at - Time::s((now() - began).as_secs_f64())
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

    /// A line; false: the last one.
    pub(crate) fn execute(&mut self, line: &str) -> Result<bool, Failure> {
        match Command::read(line).map_err(Failure::Refused)? {
            Command::Request(request) => self.request(&request)?,
            Command::Leased(request, lasts) => self.leased(&request, lasts)?,
            Command::Wait(condition, within) => {
                let end = self.control.now() + within;
                while !condition.holds(&self.control) {
                    if self.control.now() >= end || condition.is_answered_at_once() {
                        let status = show::line(&self.control.status());
                        return Err(Failure::NotMet(format!(
                            "\"{line}\" was not met within {:.3} s; it is: {status}",
                            within.value()
                        )));
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
            Command::Alarms => self.said.push_str(&show::alarms(&self.control)),
            Command::Offsets => self.said.push_str(&show::offsets(&self.control)),
            Command::Tools => self.said.push_str(&show::tools(&self.control)),
            Command::Help => self.said.push_str(&show::help()),
            Command::Quit => return Ok(false),
        }
        Ok(true)
    }

    fn request(&mut self, request: &Request) -> Result<(), Failure> {
        match self.control.request(request) {
            Ok(accepted) => {
                for note in accepted.notes {
                    self.say(&note);
                }
                self.happened();
                Ok(())
            }
            Err(Refusal::Request(refused)) => Err(Failure::Refused(refusal::plain(&refused))),
            Err(refusal @ Refusal::State(_)) => {
                Err(Failure::Refused(format!("refused: {refusal}")))
            }
        }
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
        self.happened();
        let ahead = self.ahead();
        if ahead > AHEAD {
            std::thread::sleep(Duration::from_secs_f64(ahead.value()));
        }
    }

    fn happened(&mut self) {
        while let Some(event) = self.control.next_event() {
            let text = match event {
                Event::Execution(execution) => execution.name().to_owned(),
                Event::Mode(mode) => mode.name().to_owned(),
                Event::DrivesReady => "the drives are ready".to_owned(),
                Event::Alarm(alarm) => format!("{}\n            {}", alarm.text, alarm.remedy),
                Event::Notice(text) | Event::Feature(text) => text,
            };
            let now = self.control.now().value();
            self.say(&format!("{now:8.3} s  {text}"));
        }
    }

    /// The last line was read: nothing goes on moving without anybody to lead it. What was left open.
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
