//! The history of alarms: a line of JSON each, appended and put on the disk one by one.
//!
//! ```text
//!   {"alarm":{"number":2101,"text":"…",…},"checksum":1234567890}
//! ```
//!
//! A line that was cut short by a power cut, or changed, does not fit its checksum and is passed
//! over. Of more than [`MOST_ALARMS`] the older half is forgotten.
use super::plain;
use crate::{Error, output};
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
    alarm: AlarmRecord,
    checksum: u32,
}

/// What is kept in the file.
#[derive(Debug, Default)]
pub(super) struct AlarmFile {
    alarms: Vec<AlarmRecord>,
    /// The file has lines that do not count: it is replaced at the next alarm.
    is_dirty: bool,
}

impl AlarmFile {
    pub(super) const NAME: &'static str = "alarms.jsonl";
    pub(super) const LARGEST: u64 = 8 << 20;

    /// The alarms in a file's bytes, and how many lines do not count.
    pub(super) fn parse(bytes: &[u8]) -> (Self, usize) {
        let (mut alarms, mut bad) = (Vec::new(), 0);
        for line in bytes.split_inclusive(|b| *b == b'\n') {
            match read_line(line) {
                Some(alarm) => alarms.push(alarm),
                None => bad += 1,
            }
        }
        let more = alarms.len().saturating_sub(MOST_ALARMS);
        alarms.drain(..more);
        (Self { alarms, is_dirty: bad > 0 || more > 0 }, bad)
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
        let path = folder.join(Self::NAME);
        let is_full = self.alarms.len() > MOST_ALARMS;
        if is_full || self.is_dirty {
            if is_full {
                self.alarms.drain(..self.alarms.len() - MOST_ALARMS / 2);
            }
            let text: String = self.alarms.iter().map(line).collect();
            output::write_file(&path, text.as_bytes())?;
            self.is_dirty = false;
            return Ok(());
        }
        let text = self.alarms.last().map(line).unwrap_or_default();
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
    let is_new = file.metadata()?.len() == 0;
    file.write_all(text.as_bytes())?;
    file.sync_all()?;
    if is_new { output::sync_folder(folder) } else { Ok(()) }
}

/// An alarm as its line. It has names, numbers and text alone: that cannot fail.
fn line(alarm: &AlarmRecord) -> String {
    let checksum = checksum(alarm);
    let mut text =
        serde_json::to_string(&AlarmLine { alarm: alarm.clone(), checksum }).unwrap_or_default();
    text.push('\n');
    text
}

fn checksum(alarm: &AlarmRecord) -> u32 {
    crc32fast::hash(&serde_json::to_vec(alarm).unwrap_or_default())
}

fn read_line(line: &[u8]) -> Option<AlarmRecord> {
    let read: AlarmLine = serde_json::from_slice(line.strip_suffix(b"\n")?).ok()?;
    (checksum(&read.alarm) == read.checksum).then_some(read.alarm)
}

fn cut(text: &mut String) {
    let end = text.floor_char_boundary(LONGEST_TEXT);
    text.truncate(end);
}
