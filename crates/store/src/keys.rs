//! Reading TOML so that every mistake is found at once.
//!
//! Deriving a deserialiser stops at the first mistake. Here the document is first parsed as it
//! stands, with the place of every value; then the reader asks for each key by name and bounds. A
//! key that is missing, of the wrong type or out of bounds is noted and answered with a harmless
//! value, and reading goes on; a key that no reader asked for is unknown, and its nearest neighbour
//! in spelling is offered. Only if nothing was noted does the caller get what was read.
//!
//! | code | what was found |
//! |---|---|
//! | S0401 | not TOML |
//! | S0402 | unknown key |
//! | S0403 | missing key or section |
//! | S0404 | wrong type |
//! | S0405 | number not finite or out of bounds |
//! | S0406 | values that contradict each other |
//! | S0407 | unknown name where one of a list is expected |
//! | S0408 | how many findings are not shown (note) |
mod lists;
mod recording;
mod values;
pub(crate) use recording::asked;
use values::{as_number, type_name};

use crate::asked_key::{AskedKey, choices, numbers, wholes};
use crate::bases::bases;
use crate::nearest::nearest;
use crate::text::{Lines, in_order};
use diag::Diagnostic;
use std::{
    cell::RefCell,
    ops::{Range, RangeInclusive},
};
use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// Read a document whole: the value, or everything that is wrong with it in the order of the text.
pub(crate) fn read<T>(
    text: &str,
    file: u16,
    read: impl FnOnce(&mut Keys<'_>) -> T,
) -> Result<T, Vec<Diagnostic>> {
    read_over(text, file, "", &|_| None, read)
}

/// Read a document whole that may say with the key `extends` on which other one it is based:
/// `base_of` knows the texts by name. What the document does not state is as the base has it, table
/// by table; `[[tables]]` are paired in their order. A base may extend another one.
pub(crate) fn read_over<T>(
    text: &str,
    file: u16,
    extends: &'static str,
    base_of: &dyn Fn(&str) -> Option<&'static str>,
    read: impl FnOnce(&mut Keys<'_>) -> T,
) -> Result<T, Vec<Diagnostic>> {
    let lines = Lines::of(text, file);
    let (root, mistakes) = DeTable::parse_recoverable(text);
    if !mistakes.is_empty() {
        // what a broken text means is a guess: its other findings would be noise
        let noted = |e: &toml::de::Error| {
            let message = format!("not TOML: {}", e.message().replace('\n', ", "));
            Diagnostic::error("S0401", lines.span(&e.span().unwrap_or(0..0)), message)
        };
        return Err(in_order(mistakes.iter().map(noted).collect()));
    }
    let bases = bases(root.get_ref(), extends, base_of)
        .map_err(|(at, message)| vec![Diagnostic::error("S0407", lines.span(&at), message)])?;
    let findings = Findings { lines, list: RefCell::default() };
    let below = bases.iter().collect();
    let mut keys = Keys::new("the file".into(), root.get_ref(), 0..0, Some(&findings), below);
    if !extends.is_empty() {
        keys.ask(extends);
    }
    let value = read(&mut keys);
    keys.finish();
    match findings.list.into_inner() {
        list if list.is_empty() => Ok(value),
        list => Err(in_order(list)),
    }
}

struct Findings {
    lines: Lines,
    list: RefCell<Vec<Diagnostic>>,
}

/// One table of the document, and which of its keys were asked for.
pub(crate) struct Keys<'d> {
    name: String,
    table: &'d DeTable<'d>,
    /// The same table in the documents that this one is based on, the nearest first.
    bases: Vec<&'d DeTable<'d>>,
    place: Range<usize>,
    asked: Vec<&'d str>,
    /// `None` below a section that is missing: one finding for it is enough.
    findings: Option<&'d Findings>,
    /// Notes each key that is asked for.
    recorder: Option<&'d RefCell<Vec<AskedKey>>>,
}

impl<'d> Keys<'d> {
    fn new(
        name: String,
        table: &'d DeTable<'d>,
        place: Range<usize>,
        findings: Option<&'d Findings>,
        bases: Vec<&'d DeTable<'d>>,
    ) -> Self {
        Self { name, table, bases, place, asked: Vec::new(), findings, recorder: None }
    }

    /// A table that is missing: nothing is found in it, and one finding for that is enough.
    pub(crate) fn missing(empty: &'d DeTable<'d>) -> Self {
        Self::new(String::new(), empty, 0..0, None, Vec::new())
    }

    /// What a key is, here or in the nearest base that states it.
    fn get(&self, key: &str) -> Option<&'d Spanned<DeValue<'d>>> {
        self.table.get(key).or_else(|| self.bases.iter().find_map(|base| base.get(key)))
    }

    /// A number within bounds.
    pub(crate) fn number(&mut self, key: &'static str, bounds: RangeInclusive<f64>) -> f64 {
        let harmless = *bounds.start();
        self.record(key, true, || numbers(&bounds));
        self.required(key).and_then(|v| self.checked(key, v, &bounds)).unwrap_or(harmless)
    }

    /// A number within bounds whose key had another name in the version before, which is read as
    /// well.
    pub(crate) fn renamed(
        &mut self,
        key: &'static str,
        before: &'static str,
        bounds: RangeInclusive<f64>,
    ) -> f64 {
        let old = self.table.contains_key(before) && !self.table.contains_key(key);
        self.number(if old { before } else { key }, bounds)
    }

    /// A number within bounds, or "unlimited".
    pub(crate) fn limit(&mut self, key: &'static str, bounds: RangeInclusive<f64>) -> f64 {
        self.record(key, true, || format!("{}, or \"unlimited\"", numbers(&bounds)));
        match self.get(key).map(Spanned::get_ref) {
            Some(value) if value.as_str() == Some("unlimited") => {
                self.ask(key);
                f64::INFINITY
            }
            Some(value) if value.as_str().is_some() => {
                if let Some(value) = self.ask(key) {
                    self.wrong_type(key, value, "a number, or \"unlimited\"");
                }
                *bounds.start()
            }
            Some(_) | None => self.number(key, bounds),
        }
    }

    /// A number within bounds, if it is stated.
    pub(crate) fn optional(
        &mut self,
        key: &'static str,
        bounds: RangeInclusive<f64>,
    ) -> Option<f64> {
        self.record(key, false, || numbers(&bounds));
        self.ask(key).and_then(|v| self.checked(key, v, &bounds))
    }

    /// A whole number within bounds.
    pub(crate) fn whole(&mut self, key: &'static str, bounds: RangeInclusive<u32>) -> u32 {
        let harmless = *bounds.start();
        self.record(key, true, || wholes(&bounds));
        let Some(value) = self.required(key) else { return harmless };
        self.checked_whole(key, value, &bounds).unwrap_or(harmless)
    }

    /// A whole number within bounds, if it is stated.
    pub(crate) fn optional_whole(
        &mut self,
        key: &'static str,
        bounds: RangeInclusive<u32>,
    ) -> Option<u32> {
        self.record(key, false, || wholes(&bounds));
        self.ask(key).and_then(|v| self.checked_whole(key, v, &bounds))
    }

    /// Yes or no.
    pub(crate) fn flag(&mut self, key: &'static str) -> bool {
        self.record(key, true, || "true or false".into());
        let Some(value) = self.required(key) else { return false };
        value.get_ref().as_bool().unwrap_or_else(|| {
            self.wrong_type(key, value, "true or false");
            false
        })
    }

    /// Text.
    pub(crate) fn text(&mut self, key: &'static str) -> String {
        self.record(key, true, || "text".into());
        self.required(key).and_then(|v| self.checked_text(key, v)).unwrap_or_default()
    }

    /// Text, if it is stated.
    pub(crate) fn optional_text(&mut self, key: &'static str) -> Option<String> {
        self.record(key, false, || "text".into());
        self.ask(key).and_then(|v| self.checked_text(key, v))
    }

    /// All entries of this table and of those that it is based on as text, whose keys its reader
    /// accepts; the others are unknown keys.
    pub(crate) fn texts<T>(&mut self, accept: impl Fn(&str) -> Option<T>) -> Vec<(T, String)> {
        let mut found = Vec::new();
        for table in std::iter::once(self.table).chain(self.bases.clone()) {
            for (key, value) in table {
                let name: &'d str = key.get_ref();
                let Some(accepted) = accept(name).filter(|_| !self.asked.contains(&name)) else {
                    continue;
                };
                self.asked.push(name);
                found.extend(self.checked_text(name, value).map(|text| (accepted, text)));
            }
        }
        found
    }

    /// One of a list of names.
    pub(crate) fn choice<T: Copy>(&mut self, key: &'static str, names: &[(&str, T)]) -> T {
        self.record(key, true, || choices(names));
        self.required(key).and_then(|v| self.checked_choice(key, v, names)).unwrap_or(names[0].1)
    }

    /// One of a list of names, if it is stated.
    pub(crate) fn optional_choice<T: Copy>(
        &mut self,
        key: &'static str,
        names: &[(&str, T)],
    ) -> Option<T> {
        self.record(key, false, || choices(names));
        self.ask(key).and_then(|v| self.checked_choice(key, v, names))
    }

    /// A table within this one.
    pub(crate) fn section<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Keys<'_>) -> T,
    ) -> T {
        if self.ask(key).is_some_and(|v| v.get_ref().is_table()) {
            return self.within(key, read);
        }
        if let Some(value) = self.ask(key) {
            self.wrong_type(key, value, "a table");
        } else {
            self.note("S0403", &self.place, format!("{} lacks the section [{key}]", self.name));
        }
        let empty = DeTable::new();
        let mut keys = Keys::missing(&empty);
        (keys.name, keys.recorder) = (self.path_to(key), self.recorder);
        read(&mut keys)
    }

    /// A table within this one, if it is there.
    pub(crate) fn optional_section<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(&mut Keys<'_>) -> T,
    ) -> Option<T> {
        if self.ask(key).is_none() {
            if self.recorder.is_some() {
                self.section(key, read);
            }
            return None;
        }
        Some(self.section(key, read))
    }

    fn within<T>(&self, key: &'static str, read: impl FnOnce(&mut Keys<'_>) -> T) -> T {
        let empty = DeTable::new();
        let bases: Vec<_> =
            self.bases.iter().filter_map(|base| base.get(key)?.get_ref().as_table()).collect();
        let (table, place) = match self.table.get(key).map(|v| (v.get_ref(), v.span())) {
            Some((DeValue::Table(table), place)) => (table, place),
            // stated by a base alone: its place in this text is where it could have been stated
            None if !bases.is_empty() => (&empty, self.place.clone()),
            Some(_) | None => {
                let mut keys = Keys::missing(&empty);
                (keys.name, keys.recorder) = (self.path_to(key), self.recorder);
                return read(&mut keys);
            }
        };
        let mut keys = Keys::new(self.path_to(key), table, place, self.findings, bases);
        keys.recorder = self.recorder;
        let value = read(&mut keys);
        keys.finish();
        value
    }

    /// An array of tables: `[[key]]`, with at least one and at most `most` of them.
    pub(crate) fn sections<T>(
        &mut self,
        key: &'static str,
        most: usize,
        mut read: impl FnMut(&mut Keys<'_>) -> T,
    ) -> Vec<T> {
        let Some(value) = self.required(key) else { return Vec::new() };
        let Some(array) = value.get_ref().as_array() else {
            self.wrong_type(key, value, &format!("tables headed [[{key}]]"));
            return Vec::new();
        };
        if array.is_empty() || array.len() > most {
            let found = array.len();
            let message = format!("[[{key}]]: expected 1 to {most} of them, found {found}");
            self.note("S0405", &value.span(), message);
            return Vec::new();
        }
        let mut values = Vec::with_capacity(array.len());
        let own = self.table.contains_key(key);
        let empty = DeTable::new();
        for (at, item) in array.iter().enumerate() {
            let below = |base: &&'d DeTable<'d>| -> Option<&'d DeTable<'d>> {
                base.get(key)?.get_ref().as_array()?.get(at)?.get_ref().as_table()
            };
            let bases = self.bases.iter().filter_map(below).collect();
            let DeValue::Table(table) = item.get_ref() else {
                self.wrong_type(key, item, &format!("a table headed [[{key}]]"));
                continue;
            };
            // stated by a base alone: its place in this text is where it could have been stated
            let (table, place) =
                if own { (table, item.span()) } else { (&empty, self.place.clone()) };
            let mut keys = Keys::new(format!("[[{key}]]"), table, place, self.findings, bases);
            keys.recorder = self.recorder;
            values.push(read(&mut keys));
            keys.finish();
        }
        values
    }

    /// Note that a value contradicts another.
    pub(crate) fn conflict(&self, key: &'static str, message: impl Into<String>) {
        self.note("S0406", &self.place_of(key), message.into());
    }

    /// Note that a text is none of what is expected.
    pub(crate) fn unknown_name(&self, key: &str, message: impl Into<String>) {
        self.note("S0407", &self.place_of(key), message.into());
    }

    /// Whether a key is stated at all.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// Whether this document states a key itself, and not one that it is based on.
    pub(crate) fn states(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    /// Where a key's value stands; the table itself where the key is missing.
    pub(crate) fn span_of(&self, key: &str) -> diag::Span {
        self.findings.map_or_else(diag::Span::default, |f| f.lines.span(&self.place_of(key)))
    }

    fn place_of(&self, key: &str) -> Range<usize> {
        self.table.get(key).map_or_else(|| self.place.clone(), Spanned::span)
    }

    fn path_to(&self, key: &str) -> String {
        match self.name.strip_prefix('[').and_then(|n| n.strip_suffix(']')) {
            Some(parent) => format!("[{}.{key}]", parent.trim_matches(['[', ']'])),
            None => format!("[{key}]"),
        }
    }

    fn ask(&mut self, key: &'static str) -> Option<&'d Spanned<DeValue<'d>>> {
        if !self.asked.contains(&key) {
            self.asked.push(key);
        }
        self.get(key)
    }

    fn required(&mut self, key: &'static str) -> Option<&'d Spanned<DeValue<'d>>> {
        let value = self.ask(key);
        if value.is_none() {
            self.note("S0403", &self.place, format!("{} lacks the key `{key}`", self.name));
        }
        value
    }

    fn checked(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        bounds: &RangeInclusive<f64>,
    ) -> Option<f64> {
        let Some(number) = as_number(value.get_ref()) else {
            self.wrong_type(key, value, "a number");
            return None;
        };
        if bounds.contains(&number) {
            return Some(number);
        }
        let (low, high) = (bounds.start(), bounds.end());
        let message = format!("`{key}` is {number}: expected a number from {low} to {high}");
        self.note("S0405", &value.span(), message);
        None
    }

    fn checked_whole(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        bounds: &RangeInclusive<u32>,
    ) -> Option<u32> {
        let Some(number) =
            value.get_ref().is_integer().then(|| as_number(value.get_ref())).flatten()
        else {
            self.wrong_type(key, value, "a whole number");
            return None;
        };
        let (low, high) = (*bounds.start(), *bounds.end());
        if (f64::from(low)..=f64::from(high)).contains(&number) {
            return Some(number as u32);
        }
        let message = format!("`{key}` is {number}: expected a whole number from {low} to {high}");
        self.note("S0405", &value.span(), message);
        None
    }

    fn checked_text(&self, key: &str, value: &Spanned<DeValue<'_>>) -> Option<String> {
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.wrong_type(key, value, "text in quotes");
        }
        text.map(str::to_owned)
    }

    fn checked_choice<T: Copy>(
        &self,
        key: &str,
        value: &Spanned<DeValue<'_>>,
        names: &[(&str, T)],
    ) -> Option<T> {
        let text = self.checked_text(key, value)?;
        let found = names.iter().find(|(name, _)| *name == text);
        if found.is_none() {
            let all = names.iter().map(|(name, _)| format!("\"{name}\"")).collect::<Vec<_>>();
            let message = format!("`{key}` is \"{text}\": expected {}", all.join(" or "));
            self.note("S0407", &value.span(), message);
        }
        found.map(|(_, value)| *value)
    }

    fn wrong_type(&self, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
        let found = type_name(value.get_ref());
        let message = format!("`{key}` is {found}: expected {expected}");
        self.note("S0404", &value.span(), message);
    }

    fn note(&self, code: &'static str, place: &Range<usize>, message: String) {
        if let Some(findings) = self.findings {
            let finding = Diagnostic::error(code, findings.lines.span(place), message);
            findings.list.borrow_mut().push(finding);
        }
    }

    /// Note the keys that no reader asked for.
    fn finish(self) {
        for key in self.table.keys() {
            let name: &str = key.get_ref();
            if self.asked.contains(&name) {
                continue;
            }
            let message = match nearest(name, &self.asked) {
                Some(near) => {
                    format!("unknown key `{name}` in {}: did you mean `{near}`?", self.name)
                }
                None => format!("unknown key `{name}` in {}", self.name),
            };
            self.note("S0402", &key.span(), message);
        }
    }
}
