//! LinuxCNC's HAL files, as far as they say what a machine is: values that are set, and which pins
//! a signal connects.
//!
//! ```text
//!   setp encoder.0.position-scale [SPINDLE_0]ENCODER_SCALE      net spindle-pos encoder.0.position => spindle.0.revs
//! ```
//!
//! `[SECTION]KEY` and `[SECTION](KEY)` stand for what the INI file says.
use super::ini::{CitedLine, Ini, MOST_FILES, joined};

/// What HAL files have set and connected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hal {
    /// Pins and parameters that are set: name, value, where.
    pub values: Vec<(String, String, CitedLine)>,
    /// Pins on signals: signal, pin, where.
    pub pins: Vec<(String, String, CitedLine)>,
    /// What was not read, and why.
    pub unread: Vec<String>,
    /// Files that wire something and were not seen: which, and why.
    pub unseen: Vec<(String, String)>,
    files: usize,
}

impl Hal {
    /// Read a file's text, and what it sources by `file`, which answers with a file's text, or why
    /// there is none.
    pub fn read(
        &mut self,
        name: &str,
        text: &str,
        ini: &Ini,
        file: &mut dyn FnMut(&str) -> Result<String, String>,
    ) {
        self.files += 1;
        for (line, words) in joined(text) {
            if words.starts_with('#') {
                continue;
            }
            let place = CitedLine { file: name.to_owned(), line };
            self.line(&words, &place, ini, file);
        }
    }

    /// One command of `halcmd`.
    pub fn line(
        &mut self,
        words: &str,
        place: &CitedLine,
        ini: &Ini,
        file: &mut dyn FnMut(&str) -> Result<String, String>,
    ) {
        let words: Vec<String> = words
            .split_whitespace()
            .take_while(|word| !word.starts_with('#'))
            .filter(|word| !matches!(*word, "=>" | "<=" | "<=>"))
            .map(|word| replaced(word.trim_matches('"'), ini))
            .collect();
        let of: Vec<&str> = words.iter().map(String::as_str).collect();
        match of.as_slice() {
            ["setp", name, value, ..] | [name, "=", value] => {
                self.values.push(((*name).to_owned(), (*value).to_owned(), place.clone()));
            }
            ["net" | "linksp", signal, pins @ ..] => {
                for pin in pins {
                    self.pins.push(((*signal).to_owned(), (*pin).to_owned(), place.clone()));
                }
            }
            ["linkpp", first, second] => {
                for pin in [first, second] {
                    self.pins.push(((*first).to_owned(), (*pin).to_owned(), place.clone()));
                }
            }
            ["linkps", pin, signal] => {
                self.pins.push(((*signal).to_owned(), (*pin).to_owned(), place.clone()));
            }
            ["source", named] => {
                let text = if self.files >= MOST_FILES {
                    Err(format!("more than {MOST_FILES} files"))
                } else {
                    file(named)
                };
                match text {
                    Ok(text) => self.read(named, &text, ini, file),
                    Err(why) => {
                        self.unseen.push(((*named).to_owned(), format!("source, {place}, {why}")));
                    }
                }
            }
            _ => {}
        }
    }

    /// The last value of a pin or parameter.
    pub fn value(&self, name: &str) -> Option<(&str, &CitedLine)> {
        let found = self.values.iter().rev().find(|(of, _, _)| of == name);
        found.map(|(_, value, place)| (value.as_str(), place))
    }

    /// The other pins of the signal that a pin is on.
    pub fn beside<'a>(
        &'a self,
        pin: &'a str,
    ) -> impl Iterator<Item = &'a (String, String, CitedLine)> {
        let on = self.pins.iter().filter(move |(_, of, _)| of == pin);
        on.flat_map(move |(signal, _, _)| {
            self.pins.iter().filter(move |(of, other, _)| of == signal && other != pin)
        })
    }
}

/// A word with what stands for the INI file's values replaced; one that it does not have stays.
fn replaced(word: &str, ini: &Ini) -> String {
    let Some((before, rest)) = word.split_once('[') else { return word.to_owned() };
    let Some((section, rest)) = rest.split_once(']') else { return word.to_owned() };
    let bracketed = rest.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let (key, after) = bracketed.unwrap_or_else(|| {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        rest.split_at(end.unwrap_or(rest.len()))
    });
    match ini.of_hal(section, key) {
        Some(entry) => format!("{before}{}{after}", entry.value),
        None => word.to_owned(),
    }
}
