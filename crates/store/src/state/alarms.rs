//! The history of alarms: a line of JSON each, appended and put on the disk one by one.
//!
//! ```text
//!   {"nth":7,"alarm":{"number":2101,"text":"…",…},"checksum":1234567890}
//! ```
//!
//! Alarms are counted from 1 as long as the folder lives: one that is missing between two, or after
//! the last, is noticed.
//!
//! A line that was cut short by a power cut, or changed, does not fit its checksum and is passed
//! over. Of more than [`MOST_ALARMS`] the older half is forgotten.
use super::plain;
use crate::{Error, output, regular};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;

/// Alarms that are kept.
pub const MOST_ALARMS: usize = 1000;
/// Longest text of an alarm, bytes; a longer one is cut.
const LONGEST_TEXT: usize = 1000;

/// An alarm that was raised.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlarmRecord {
    /// Its number, as docs/alarms.md lists it.
    pub number: u32,
    /// Its sentence.
    pub text: String,
    /// What the operator can do.
    pub remedy: String,
    /// When, in milliseconds since 1970-01-01 UTC.
    pub unix_ms: u64,
    /// The program under way, if one was.
    pub program: Option<String>,
    /// Its line.
    pub line: Option<u32>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct AlarmLine {
    /// Which alarm of this folder it is, from 1; `None`: of a folder where they were not counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    nth: Option<u64>,
    alarm: AlarmRecord,
    checksum: u32,
}

/// What is kept in the file.
#[derive(Debug, Default)]
pub(super) struct AlarmFile {
    alarms: Vec<AlarmRecord>,
    /// Which alarm of this folder the last one is.
    last: u64,
    /// Alarms that were there, between the first and the last, and are not.
    missing: u64,
    /// The file has lines that do not count: it is replaced at the next alarm.
    is_dirty: bool,
}

impl AlarmFile {
    pub(super) const NAME: &'static str = "alarms.jsonl";
    pub(super) const LARGEST: u64 = 8 << 20;

    /// The alarms in a file's bytes, and how many lines do not count.
    pub(super) fn parse(bytes: &[u8]) -> (Self, usize) {
        let (mut alarms, mut bad) = (Vec::new(), 0);
        let (mut first, mut last) = (None, 0);
        for line in bytes.split_inclusive(|b| *b == b'\n') {
            match read_line(line) {
                Some((nth, alarm)) => {
                    last = nth.unwrap_or(last + 1);
                    first = first.or(Some(last));
                    alarms.push(alarm);
                }
                None => bad += 1,
            }
        }
        // of very many the older ones were forgotten
        let first = first.filter(|_| alarms.len() >= MOST_ALARMS / 2).unwrap_or(1);
        let missing = (last + 1).saturating_sub(first).saturating_sub(alarms.len() as u64);
        let more = alarms.len().saturating_sub(MOST_ALARMS);
        alarms.drain(..more);
        (Self { alarms, last, missing, is_dirty: bad > 0 || more > 0 }, bad)
    }

    /// Which alarm of this folder the last one is.
    pub(super) const fn last(&self) -> u64 {
        self.last
    }

    /// The last one that was kept is this one: returns how many are missing, and counts those that
    /// are there anew.
    pub(super) fn hold_to(&mut self, last: u64) -> u64 {
        let missing = self.missing + last.saturating_sub(self.last);
        if missing > 0 {
            self.last = self.alarms.len() as u64;
            self.is_dirty = true;
        }
        self.missing = 0;
        missing
    }

    /// Writes the file anew, if it has lines that do not count.
    pub(super) fn repair(&mut self, folder: &Path) -> Result<(), Error> {
        if self.is_dirty {
            let before = self.last - self.alarms.len() as u64;
            let numbered = self.alarms.iter().zip(before + 1..);
            let text: String = numbered.map(|(alarm, nth)| line(alarm, nth)).collect();
            output::replace(&folder.join(Self::NAME), text.as_bytes())?;
            self.is_dirty = false;
        }
        Ok(())
    }

    pub(super) fn alarms(&self) -> &[AlarmRecord] {
        &self.alarms
    }

    pub(super) const fn must_be_written_anew(&mut self) {
        self.is_dirty = true;
    }

    /// One more, on the disk when this returns.
    pub(super) fn add(&mut self, folder: &Path, mut alarm: AlarmRecord) -> Result<(), Error> {
        cut(&mut alarm.text);
        cut(&mut alarm.remedy);
        alarm.program.as_mut().map(cut);
        self.alarms.push(alarm);
        self.last += 1;
        let path = folder.join(Self::NAME);
        let is_full = self.alarms.len() > MOST_ALARMS;
        if is_full || self.is_dirty {
            if is_full {
                self.alarms.drain(..self.alarms.len() - MOST_ALARMS / 2);
            }
            self.is_dirty = true;
            return self.repair(folder);
        }
        let text = self.alarms.last().map(|alarm| line(alarm, self.last)).unwrap_or_default();
        let appended = append(folder, &path, &text);
        if appended.is_err() {
            // part of the line may be there
            self.is_dirty = true;
        }
        appended.map_err(|cause| Error::file("write", &path, cause))
    }
}

fn append(folder: &Path, path: &Path, text: &str) -> io::Result<()> {
    let mut file = plain::options().create(true).append(true).open(path)?;
    regular::must_be_regular(&file)?;
    let is_new = file.metadata()?.len() == 0;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    if is_new { output::sync_folder(folder) } else { Ok(()) }
}

/// An alarm as its line. It has names, numbers and text alone: that cannot fail.
fn line(alarm: &AlarmRecord, nth: u64) -> String {
    let (nth, checksum) = (Some(nth), checksum(Some(nth), alarm));
    let mut text = serde_json::to_string(&AlarmLine { nth, alarm: alarm.clone(), checksum })
        .unwrap_or_default();
    text.push('\n');
    text
}

fn checksum(nth: Option<u64>, alarm: &AlarmRecord) -> u32 {
    let mut text = serde_json::to_vec(alarm).unwrap_or_default();
    text.extend(nth.iter().flat_map(|nth| nth.to_le_bytes()));
    crc32fast::hash(&text)
}

fn read_line(line: &[u8]) -> Option<(Option<u64>, AlarmRecord)> {
    let read: AlarmLine = serde_json::from_slice(line.strip_suffix(b"\n")?).ok()?;
    (checksum(read.nth, &read.alarm) == read.checksum).then_some((read.nth, read.alarm))
}

fn cut(text: &mut String) {
    let end = text.floor_char_boundary(LONGEST_TEXT);
    text.truncate(end);
}
