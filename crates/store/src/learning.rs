//! What a control has learnt, from run to run: a file that a person can read, whole or not there.
//!
//! ```text
//!   leadscrew-learning 2
//!   machine tapping-center 5bd1e995          name, and a mark of the file that described it
//!   stroke tool 3 lead -1 spin 100 return -100 turns 30 in 0.61 out 0.61
//!   state strokes 12 gain 0.7 strikes 0 first 0.0009 best 0.0003 early 0
//!   feed 0 0 1.25 …                          nm, a cell after the other, in and then out
//!   spindle 0 0 …                            10⁻⁹ rev
//!   end 7a1b2c3d                             mark of all that stands above
//! ```
//!
//! Units of `stroke`: mm/rev, rev/s, rev, s; of `state`: mm, and rev for `early`: the turns by which a spindle that is
//! followed by its encoder must be told to turn back earlier than its machine's file makes one think. Version 1 had no
//! `early`; it is read as 0. The marks are FNV-1a of 32 bits (Fowler, Noll, Vo):
//! they recognise a file that was cut short or edited, and a machine that is another one or has been
//! changed since: what was learnt on it is no longer true.
use crate::{Error, SMALL_FILE_LIMIT, output, read_text, text::Lines};
use diag::Diagnostic;
use std::{fmt::Write, path::Path};

/// Records that a file may have.
const MOST_RECORDS: usize = 64;
/// Cells that a correction may have.
const MOST_CELLS: usize = 1 << 16;
/// Nanometres in a millimetre.
const NANO: f64 = 1e-6;
/// Billionths.
const BILLIONTH: f64 = 1e-9;

/// One kind of stroke and what was learnt of it, in the units of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LearningRecord {
    /// The tool.
    pub tool: u32,
    /// Lead, speeds in and out, revolutions, times in and out: mm/rev, rev/s, rev, s.
    pub stroke: [f64; 6],
    /// Strokes learnt from.
    pub strokes: u32,
    /// Gain in force.
    pub gain: f64,
    /// Times that it made things worse.
    pub strikes: u8,
    /// First and best score, mm.
    pub scores: [f64; 2],
    /// Turns by which an encoder-following spindle is turned back earlier than planned.
    pub early: f64,
    /// Correction of the feed, mm.
    pub feed: Vec<f64>,
    /// Correction of the spindle, rev.
    pub spindle: Vec<f64>,
}

/// A file of learning records.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LearningRecords {
    /// Name of the machine.
    pub machine: String,
    /// Mark of the machine's file.
    pub mark: u32,
    /// All of them.
    pub list: Vec<LearningRecord>,
}

/// FNV-1a of 32 bits.
pub fn mark(text: &str) -> u32 {
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

impl LearningRecords {
    /// Their text.
    pub fn to_text(&self) -> String {
        let mut text =
            format!("leadscrew-learning 2\nmachine {} {:08x}\n", self.machine, self.mark);
        for record in &self.list {
            let [lead, spin, back, turns, into, out] = record.stroke;
            let [first, best] = record.scores;
            let (strokes, gain, strikes) = (record.strokes, record.gain, record.strikes);
            let early = record.early;
            // writing to a String cannot fail
            let _ = writeln!(
                text,
                "stroke tool {} lead {lead} spin {spin} return {back} turns {turns} in {into} out {out}\n\
                 state strokes {strokes} gain {gain} strikes {strikes} first {first} best {best} early {early}",
                record.tool
            );
            cells(&mut text, "feed", &record.feed, NANO);
            cells(&mut text, "spindle", &record.spindle, BILLIONTH);
        }
        let end = mark(&text);
        let _ = writeln!(text, "end {end:08x}");
        text
    }

    /// Read them from text.
    ///
    /// # Errors
    /// The first thing that is wrong with it: nothing of a damaged file is used.
    pub fn parse(text: &str) -> Result<Self, Vec<Diagnostic>> {
        let mut lines = text.split_inclusive('\n');
        let mut at = 0;
        let mut next = || {
            let line = lines.next()?;
            let start = at;
            at += line.len();
            Some((start, line.trim_end()))
        };
        let places = Lines::of(text, 0);
        let wrong = |start: usize, sentence: String| {
            vec![Diagnostic::error("S0901", places.span(&(start..start)), sentence)]
        };
        let mut read = Self::default();
        let mut header = false;
        while let Some((start, line)) = next() {
            let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
            let good = match word {
                "leadscrew-learning" => {
                    header = rest == "1" || rest == "2";
                    header.then_some(())
                }
                _ if !header => None,
                "machine" => read.machine_line(rest),
                "stroke" if read.list.len() < MOST_RECORDS => read.stroke_line(rest),
                "state" => read.list.last_mut().and_then(|l| l.state_line(rest)),
                "feed" => read.list.last_mut().and_then(|l| values(&mut l.feed, rest, NANO)),
                "spindle" => {
                    read.list.last_mut().and_then(|l| values(&mut l.spindle, rest, BILLIONTH))
                }
                "end" if u32::from_str_radix(rest, 16) == Ok(mark(&text[..start])) => {
                    return Ok(read);
                }
                "end" => {
                    let sentence = "the file has been changed since it was written: delete it, and learning begins anew";
                    return Err(wrong(start, sentence.into()));
                }
                _ => None,
            };
            if good.is_none() {
                let sentence = if header {
                    format!("expected a line of a learning file, found `{}`", clip(line))
                } else {
                    "expected a learning file, which begins with `leadscrew-learning 2`".into()
                };
                return Err(wrong(start, sentence));
            }
        }
        Err(wrong(
            text.len(),
            "the file has no end: it was cut short; delete it, and learning begins anew".into(),
        ))
    }

    /// Read them from a file for a machine; `None` if there is no file yet.
    ///
    /// # Errors
    /// When the file cannot be read, or is damaged, or belongs to another machine or to this one before it was
    /// changed.
    pub fn load(path: &Path, machine: &str, mark: u32) -> Result<Option<Self>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let text = read_text(path, "a learning file", SMALL_FILE_LIMIT * 8)?;
        let refused = |findings| Error::refused(path, text.clone(), findings);
        let read = Self::parse(&text).map_err(refused)?;
        let line = Lines::of(&text, 0).span(&(text.find('\n').map_or(0, |n| n + 1)..text.len()));
        if read.machine != machine {
            let sentence = format!(
                "this was learnt on {}, and the machine is {machine}: give another file with --learning",
                read.machine
            );
            return Err(refused(vec![Diagnostic::error("S0902", line, sentence)]));
        }
        if read.mark != mark {
            let sentence = "the machine's file has been changed since this was learnt: delete it, and learning begins anew";
            return Err(refused(vec![Diagnostic::error("S0903", line, sentence)]));
        }
        Ok(Some(read))
    }

    /// Write them to a file, whole or not at all.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        output::write_file(path, self.to_text().as_bytes())
    }

    fn machine_line(&mut self, rest: &str) -> Option<()> {
        let (name, mark) = rest.rsplit_once(' ')?;
        self.mark = u32::from_str_radix(mark, 16).ok()?;
        name.clone_into(&mut self.machine);
        Some(())
    }

    fn stroke_line(&mut self, rest: &str) -> Option<()> {
        let [tool, stroke @ ..] =
            named(rest, ["tool", "lead", "spin", "return", "turns", "in", "out"])?;
        self.list.push(LearningRecord { tool: whole(tool)?, stroke, ..LearningRecord::default() });
        Some(())
    }
}

impl LearningRecord {
    fn state_line(&mut self, rest: &str) -> Option<()> {
        let of_version_1 = ["strokes", "gain", "strikes", "first", "best"];
        let ([strokes, gain, strikes, scores @ ..], early) =
            if let Some(values) = named(rest, of_version_1) {
                (values, 0.0)
            } else {
                let (rest, early) = rest.rsplit_once(" early ")?;
                (named(rest, of_version_1)?, early.parse().ok().filter(|v: &f64| v.is_finite())?)
            };
        (self.strokes, self.gain, self.scores) = (whole(strokes)?, gain, scores);
        self.early = early;
        self.strikes = u8::try_from(whole(strikes)?).ok()?;
        ((0.0..=2.0).contains(&gain)).then_some(())
    }
}

fn cells(text: &mut String, name: &str, values: &[f64], unit: f64) {
    text.push_str(name);
    for value in values {
        // a thousandth of a nanometre is far below any encoder
        let _ = write!(text, " {}", (value / unit * 1e3).round() / 1e3);
    }
    text.push('\n');
}

fn values(into: &mut Vec<f64>, rest: &str, unit: f64) -> Option<()> {
    for word in rest.split_whitespace() {
        let value: f64 = word.parse().ok().filter(|v: &f64| v.is_finite())?;
        if into.len() == MOST_CELLS {
            return None;
        }
        into.push(value * unit);
    }
    Some(())
}

/// Numbers after their names, in this order.
fn named<const N: usize>(rest: &str, names: [&str; N]) -> Option<[f64; N]> {
    let mut words = rest.split_whitespace();
    let mut found = [0.0; N];
    for (slot, name) in found.iter_mut().zip(names) {
        words.next().filter(|word| *word == name)?;
        *slot = words.next()?.parse().ok().filter(|v: &f64| v.is_finite())?;
    }
    words.next().is_none().then_some(found)
}

fn whole(value: f64) -> Option<u32> {
    (value >= 0.0 && value <= f64::from(u32::MAX) && value.fract() == 0.0).then_some(value as u32)
}

fn clip(line: &str) -> String {
    line.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn learning_records() -> LearningRecords {
        let record = LearningRecord {
            tool: 3,
            stroke: [-1.0, 100.0, -100.0, 30.0, 0.61, 0.625],
            strokes: 12,
            gain: 0.7,
            strikes: 1,
            scores: [9e-4, 3e-4],
            early: 0.25,
            feed: vec![0.0, 1.25e-6, -3e-6],
            spindle: vec![0.0, 2e-9],
        };
        LearningRecords { machine: "tapping-center".into(), mark: 7, list: vec![record] }
    }

    fn sentence(text: &str) -> String {
        let found = LearningRecords::parse(text).unwrap_err();
        format!("{} {} {}", found[0].span.line, found[0].code, found[0].message)
    }

    #[test]
    fn the_mark_is_the_published_one() {
        // FNV-1a test suite of its authors: "" and "foobar"
        assert_eq!((mark(""), mark("foobar")), (0x811c_9dc5, 0xbf9c_f968));
    }

    #[test]
    fn what_is_written_reads_back_the_same() {
        let read = LearningRecords::parse(&learning_records().to_text()).unwrap();
        assert_eq!(read.to_text(), learning_records().to_text());
        assert_eq!(read.list[0].stroke, learning_records().list[0].stroke);
        assert_eq!(read.list[0].early, 0.25);
    }

    #[test]
    fn a_file_of_the_first_version_knows_no_stopping_angle() {
        let body = learning_records()
            .to_text()
            .replace("learning 2", "learning 1")
            .replace(" early 0.25", "");
        let body = &body[..body.find("end ").unwrap()];
        let read = LearningRecords::parse(&format!("{body}end {:08x}\n", mark(body))).unwrap();
        assert_eq!((read.list[0].strokes, read.list[0].early), (12, 0.0));
    }

    #[test]
    fn a_file_cut_short_or_edited_is_recognised() {
        let text = learning_records().to_text();
        let cut = &text[..text.len() - 14];
        assert!(sentence(cut).contains("cut short"), "{}", sentence(cut));
        assert!(sentence(&text.replace("1.25", "2.25")).contains("changed"));
        assert!(sentence("#1 = 3\n").contains("begins with"));
    }

    #[test]
    fn a_file_of_another_or_a_changed_machine_is_recognised() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("learnt.txt");
        assert_eq!(LearningRecords::load(&path, "tapping-center", 7).unwrap(), None);
        learning_records().save(&path).unwrap();
        assert!(LearningRecords::load(&path, "tapping-center", 7).unwrap().is_some());
        let said =
            |machine, mark| LearningRecords::load(&path, machine, mark).unwrap_err().to_string();
        assert!(said("vfd-mill", 7).contains("learnt on tapping-center"));
        assert!(said("tapping-center", 8).contains("has been changed"));
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "(leadscrew-learning 1\n)?([-a-z0-9. \n]|\\PC){0,80}") {
            let _ = LearningRecords::parse(&text);
        }
    }
}
