//! The machine file while it is written, and the remarks about it.
use super::ini::{Entry, Ini};
use std::fmt;

/// What a remark is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RemarkKind {
    /// A value of the configuration.
    Taken,
    /// The configuration does not say it; what is in the file works on most machines.
    Guessed,
    /// The machine needs it, and nothing in the configuration tells it: the value in the file only
    /// stands in for it.
    Missing,
    /// A pin of LinuxCNC's motion controller, and the one of Leadscrew in its place.
    Rewire,
    /// Not used, and why.
    Unread,
    /// It stopped the machine in LinuxCNC, and a person has to answer for it in the machine file
    /// before drives are led.
    Safety,
    /// There is no machine file because of it.
    Wrong,
}

impl RemarkKind {
    const fn word(self) -> &'static str {
        match self {
            Self::Taken => "taken",
            Self::Guessed => "guessed",
            Self::Missing => "missing",
            Self::Rewire => "rewire",
            Self::Unread => "not read",
            Self::Safety => "safety",
            Self::Wrong => "wrong",
        }
    }
}

/// One line about the import.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// What it is about.
    pub kind: RemarkKind,
    /// Which key of the machine file, or which pin; empty: none.
    pub key: String,
    /// What was put there, where it comes from, what would do.
    pub text: String,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, key, text } = self;
        let colon = if key.is_empty() { "" } else { ": " };
        write!(f, "{:8} {key}{colon}{text}", kind.word())
    }
}

/// The text so far, and the remarks.
#[derive(Debug, Default)]
pub(super) struct MachineWriter {
    pub(super) text: String,
    pub(super) remarks: Vec<Remark>,
    section: String,
}

/// Remarks begin in this column, as in the built-in machine models.
const COLUMN: usize = 38;

impl MachineWriter {
    /// `[name]`; keys are stated under it from here on. `key` is how remarks call it.
    pub(super) fn section(&mut self, heading: &str, key: &str) {
        if !heading.is_empty() {
            self.text += &format!("\n{heading}\n");
        }
        key.clone_into(&mut self.section);
    }

    /// A line of the file without a remark.
    pub(super) fn line(&mut self, key: &str, value: &str, why: &str) {
        let stated = format!("{key} = {value}");
        let width = COLUMN.max(stated.len() + 1);
        self.text += &format!("{stated:width$}# {why}\n");
    }

    pub(super) fn taken(&mut self, key: &str, value: &str, from: &str) {
        self.line(key, value, from);
        self.say(RemarkKind::Taken, key, &format!("{value} from {from}"));
    }

    pub(super) fn guessed(&mut self, key: &str, value: &str, why: &str) {
        self.line(key, value, &format!("guess: {why}"));
        self.say(RemarkKind::Guessed, key, &format!("{value}, {why}"));
    }

    pub(super) fn missing(&mut self, key: &str, value: &str, why: &str) {
        self.line(key, value, &format!("MISSING: {why}"));
        self.say(RemarkKind::Missing, key, &format!("{value} stands in for it: {why}"));
    }

    /// A remark about a key of this section.
    pub(super) fn say(&mut self, kind: RemarkKind, key: &str, text: &str) {
        let dot = if self.section.is_empty() || key.is_empty() { "" } else { "." };
        let key = format!("{}{dot}{key}", self.section);
        self.remarks.push(Remark { kind, key, text: text.to_owned() });
    }

    /// A value of the INI file that cannot be.
    pub(super) fn wrong(&mut self, text: String) {
        self.remarks.push(Remark { kind: RemarkKind::Wrong, key: String::new(), text });
    }

    /// The number of a key that is there; one that is none is wrong.
    pub(super) fn number(&mut self, ini: &Ini, section: &str, key: &str) -> Option<Cited> {
        let Some(entry) = ini.get(section, key) else {
            self.other_case(ini, section, key);
            return None;
        };
        match entry.number() {
            Ok(value) => Some(Cited { value, from: entry.cited() }),
            Err(why) => {
                if !self.remarks.iter().any(|remark| remark.text == why) {
                    self.wrong(why);
                }
                None
            }
        }
    }

    /// A key in small letters is none to LinuxCNC.
    fn other_case(&mut self, ini: &Ini, section: &str, key: &str) {
        let is_near = |entry: &&Entry| {
            entry.section.eq_ignore_ascii_case(section) && entry.key.eq_ignore_ascii_case(key)
        };
        if let Some(near) = ini.entries.iter().find(is_near) {
            let text = format!("{}: LinuxCNC reads [{section}]{key}, in capitals", near.cited());
            if !self.remarks.iter().any(|remark| remark.text == text) {
                self.remarks.push(Remark { kind: RemarkKind::Unread, key: String::new(), text });
            }
        }
    }
}

/// A number and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cited {
    pub(super) value: f64,
    pub(super) from: String,
}

impl Cited {
    pub(super) fn map(self, change: impl FnOnce(f64) -> f64) -> Self {
        Self { value: change(self.value), ..self }
    }
}

/// Loops that a servo period leaves time for: the drive closes its own.
pub(super) fn loops(w: &mut MachineWriter, gain_per_s: f64, period_us: f64) {
    const USUAL_US: f64 = 1000.0;
    const BANDWIDTH_HZ: f64 = 15.0;
    let slower = (USUAL_US / period_us).min(1.0);
    w.line("position_gain_per_s", &plain(gain_per_s * slower), "guess");
    w.line("velocity_bandwidth_hz", &plain(BANDWIDTH_HZ * slower), "guess");
    for key in ["velocity", "acceleration", "friction"] {
        w.line(&format!("{key}_feed_forward_percent"), "100", "guess");
    }
}

/// A number as a machine file has it: at most six decimals.
pub(super) fn plain(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// A text as TOML has it.
pub(super) fn quoted(text: &str) -> String {
    let kept = |c: char| if c == '"' || c == '\\' || c.is_control() { ' ' } else { c };
    format!("\"{}\"", text.chars().take(200).map(kept).collect::<String>().trim())
}
