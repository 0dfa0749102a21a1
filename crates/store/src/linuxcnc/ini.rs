//! LinuxCNC's INI files.
//!
//! ```text
//!   # or ; at the start of a line: a remark        #INCLUDE FILE: the lines of that file
//!   [SECTION]                                      KEY = value, which goes on after a \ at the end of the line
//! ```
use std::cell::Cell;
use std::fmt;

/// Files that a configuration may have, INI and HAL.
pub(super) const MOST_FILES: usize = 64;

/// A line of a configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CitedLine {
    /// File, as it was named.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
}

impl fmt::Display for CitedLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.file, self.line)
    }
}

/// A key with its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Of which section.
    pub section: String,
    /// Its name.
    pub key: String,
    /// What it says, without white space around it.
    pub value: String,
    /// Where.
    pub place: CitedLine,
    /// Who has looked at it.
    looked: Cell<LookedAt>,
}

/// Who has looked at an entry.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct LookedAt {
    import: bool,
    hal: bool,
}

impl Entry {
    /// As it is cited: `mill.ini:83 [JOINT_0]HOME`.
    pub fn cited(&self) -> String {
        format!("{} [{}]{}", self.place, self.section, self.key)
    }

    /// True where the import has asked for it.
    pub(super) const fn is_asked(&self) -> bool {
        self.looked.get().import
    }

    /// True where a HAL file has its value put in.
    pub(super) const fn is_in_hal(&self) -> bool {
        self.looked.get().hal
    }

    /// Its number, which a remark may follow.
    ///
    /// # Errors
    /// A sentence about what it is instead.
    pub fn number(&self) -> Result<f64, String> {
        let text = self.value.split(['#', ';']).next().unwrap_or_default().trim();
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("{}: found `{}`, expected a number", self.cited(), self.value)),
        }
    }

    /// Whether it says yes: `1`, `YES`, `TRUE`, `ON` in any case of letters.
    pub fn is_yes(&self) -> bool {
        let word = self.value.split_whitespace().next().unwrap_or_default();
        ["1", "yes", "true", "on", "y", "t"].iter().any(|yes| word.eq_ignore_ascii_case(yes))
    }
}

/// A configuration's keys, in the order of its lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ini {
    /// All of them.
    pub entries: Vec<Entry>,
    /// Lines that are neither key nor section nor remark, and files that are not there.
    pub unread: Vec<String>,
    /// Names of compensation files, and their texts or why there is none.
    compensation: Vec<(String, Result<String, String>)>,
}

impl Ini {
    /// Read a text, and what it includes by `file`, which answers with a file's text, or why there
    /// is none.
    pub fn read(
        name: &str,
        text: &str,
        file: &mut dyn FnMut(&str) -> Result<String, String>,
    ) -> Self {
        let (mut ini, mut section, mut left) = (Self::default(), String::new(), MOST_FILES);
        ini.lines(name, text, &mut section, &mut left, file);
        let tables = ini.entries.iter().filter(|entry| entry.key == "COMP_FILE").take(left);
        ini.compensation = tables.map(|entry| (entry.value.clone(), file(&entry.value))).collect();
        ini
    }

    /// The text of a compensation file.
    ///
    /// # Errors
    /// Why there is none.
    pub(super) fn compensation(&self, name: &str) -> Result<&str, &str> {
        let found = self.compensation.iter().find(|(own, _)| own == name);
        match found {
            Some((_, Ok(text))) => Ok(text),
            Some((_, Err(why))) => Err(why),
            None => Err("is not read: the configuration has too many files"),
        }
    }

    fn lines(
        &mut self,
        name: &str,
        text: &str,
        section: &mut String,
        left: &mut usize,
        file: &mut dyn FnMut(&str) -> Result<String, String>,
    ) {
        for (line, words) in joined(text) {
            let place = CitedLine { file: name.to_owned(), line };
            if let Some(included) = words.strip_prefix("#INCLUDE") {
                let included = included.trim();
                let text = if *left == 0 {
                    Err(format!("more than {MOST_FILES} files"))
                } else {
                    *left -= 1;
                    file(included)
                };
                match text {
                    Ok(text) => self.lines(included, &text, section, left, file),
                    Err(why) => self.unread.push(format!("{place} #INCLUDE {included}: {why}")),
                }
            } else if words.is_empty() || words.starts_with(['#', ';']) {
            } else if let Some(named) = words.strip_prefix('[') {
                named.split(']').next().unwrap_or_default().trim().clone_into(section);
            } else if let Some((key, value)) = words.split_once('=') {
                let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
                let (section, looked) = (section.clone(), Cell::default());
                self.entries.push(Entry { section, key, value, place, looked });
            } else {
                self.unread.push(format!("{place}: found `{words}`, expected KEY = VALUE"));
            }
        }
    }

    /// The first of that name.
    pub fn get(&self, section: &str, key: &str) -> Option<&Entry> {
        let found = self.first(section, key)?;
        found.looked.set(LookedAt { import: true, ..found.looked.get() });
        Some(found)
    }

    /// The same, for a HAL file.
    pub(super) fn of_hal(&self, section: &str, key: &str) -> Option<&Entry> {
        let found = self.first(section, key)?;
        found.looked.set(LookedAt { hal: true, ..found.looked.get() });
        Some(found)
    }

    fn first(&self, section: &str, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.section == section && entry.key == key)
    }

    /// All of that name.
    pub fn all<'a>(&'a self, section: &'a str, key: &'a str) -> impl Iterator<Item = &'a Entry> {
        self.entries.iter().filter(move |entry| entry.section == section && entry.key == key)
    }

    /// Whether there is such a section with something in it.
    pub fn has(&self, section: &str) -> bool {
        self.entries.iter().any(|entry| entry.section == section)
    }
}

/// Lines with their numbers, without white space around them; one that ends with a backslash goes
/// on in the next.
pub(super) fn joined(text: &str) -> Vec<(usize, String)> {
    let mut lines: Vec<(usize, String)> = Vec::new();
    let mut goes_on = false;
    for (at, line) in text.lines().enumerate() {
        let line = line.trim();
        let (words, more) = match line.strip_suffix('\\') {
            Some(words) => (words.trim_end(), true),
            None => (line, false),
        };
        match lines.last_mut().filter(|_| goes_on) {
            Some((_, before)) => {
                before.push(' ');
                before.push_str(words);
            }
            None => lines.push((at + 1, words.to_owned())),
        }
        goes_on = more && !words.starts_with(['#', ';']);
    }
    lines
}
