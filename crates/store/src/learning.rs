//! What a control has learnt of its taps, from run to run.
//!
//! ```text
//!   version = 3
//!   machine = "tapping-center"
//!   mark = "5bd1e995"
//!   [[stroke]]                        one kind of stroke: a tool at one lead, depth and speed
//!   tool = 3
//!   lead_mm_per_rev = -1.0
//!   spin_rev_per_s = 100.0            in, …
//!   return_spin_rev_per_s = -100.0    … and out
//!   …
//!   feed_nm = [0.0, 0.0, 1.25, …]     correction of the feed, a cell after the other, in and then out
//!   spindle_1e9_rev = [0.0, …]        likewise of the spindle
//! ```
//!
//! `early_rev` is by how many turns a spindle that is followed by its encoder must be told to turn
//! back earlier than its machine's file makes one think. What all such files have in common is in
//! `kept_file`.
use crate::kept_file::{self, KeptFile, Whose};
use crate::{Error, SMALL_FILE_LIMIT};
use diag::Diagnostic;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Records that a file may have.
const MOST_RECORDS: usize = 64;
/// Bins that a band may have, each way.
const MOST_BINS: usize = 1024;
/// Cells that a correction may have.
const MOST_CELLS: usize = 1 << 16;

/// One kind of stroke and what was learnt of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearningRecord {
    /// The tool.
    pub tool: u32,
    /// Lead, signed as on the way in.
    pub lead_mm_per_rev: f64,
    /// Speed on the way in.
    pub spin_rev_per_s: f64,
    /// Speed on the way out.
    pub return_spin_rev_per_s: f64,
    /// Turns from the start to the bottom.
    pub turns_rev: f64,
    /// Time on the way in.
    pub time_in_s: f64,
    /// Time on the way out.
    pub time_out_s: f64,
    /// Strokes learnt from.
    pub strokes: u32,
    /// Gain in force.
    pub gain: f64,
    /// Times that it made things worse.
    pub strikes: u8,
    /// Score of the first stroke.
    pub first_mm: f64,
    /// The best score.
    pub best_mm: f64,
    /// Turns by which an encoder-following spindle is turned back earlier than planned.
    pub early_rev: f64,
    /// Correction of the feed.
    pub feed_nm: Vec<f64>,
    /// Correction of the spindle, billionths of a turn.
    pub spindle_1e9_rev: Vec<f64>,
}

/// A file of learning records.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearningRecords {
    version: u32,
    /// Name of the machine.
    pub machine: String,
    /// Mark of what the records depend on in the machine's file.
    pub mark: String,
    /// All of them.
    #[serde(default, rename = "stroke")]
    pub list: Vec<LearningRecord>,
    /// What good holes were like, for supervision by torque.
    #[serde(default, rename = "band", skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<BandRecord>,
}

/// What good holes of one kind of stroke were like.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BandRecord {
    /// The tool.
    pub tool: u32,
    /// Travel per positive turn.
    pub lead_mm_per_rev: f64,
    /// Speed on the way in.
    pub spin_rev_per_s: f64,
    /// Speed on the way out.
    pub return_spin_rev_per_s: f64,
    /// From where it begins to the surface.
    pub run_in_mm: f64,
    /// From the surface to the bottom.
    pub depth_mm: f64,
    /// Good holes that it is made of.
    pub holes: u32,
    /// Torque of the last good holes over that of these.
    pub level: f64,
    /// Mean of each bin of the depth, on the way in.
    pub mean_in_n_m: Vec<f64>,
    /// On the way out.
    pub mean_out_n_m: Vec<f64>,
    /// Sum of squares about the mean, on the way in.
    pub squares_in: Vec<f64>,
    /// On the way out.
    pub squares_out: Vec<f64>,
    /// Holes in the line through the torques since.
    pub trend_holes: f64,
    /// Its sums.
    pub trend_sums: [f64; 5],
    /// Sums of the spindle's own torque above the work.
    pub own_squares: [f64; 3],
    /// The same with what was measured.
    pub own_products: [f64; 2],
}

impl BandRecord {
    fn makes_sense(&self) -> bool {
        let bins = [&self.mean_in_n_m, &self.mean_out_n_m, &self.squares_in, &self.squares_out];
        let figures = [
            self.lead_mm_per_rev,
            self.spin_rev_per_s,
            self.return_spin_rev_per_s,
            self.run_in_mm,
            self.depth_mm,
            self.level,
            self.trend_holes,
        ];
        let sums = self.trend_sums.iter().chain(&self.own_squares).chain(&self.own_products);
        figures.iter().chain(sums).chain(bins.into_iter().flatten()).all(|value| value.is_finite())
            && bins.iter().all(|list| list.len() <= MOST_BINS)
    }
}

/// The mark of a text.
pub fn mark(text: &str) -> u32 {
    kept_file::mark(text)
}

/// A correction as it is written: a thousandth of a nanometre is far below any encoder.
pub fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

impl LearningRecord {
    fn makes_sense(&self) -> bool {
        let figures = [
            self.lead_mm_per_rev,
            self.spin_rev_per_s,
            self.return_spin_rev_per_s,
            self.turns_rev,
            self.time_in_s,
            self.time_out_s,
            self.first_mm,
            self.best_mm,
            self.early_rev,
        ];
        let cells = [&self.feed_nm, &self.spindle_1e9_rev];
        figures.iter().chain(cells.into_iter().flatten()).all(|value| value.is_finite())
            && cells.iter().all(|cells| cells.len() <= MOST_CELLS)
            && (0.0..=2.0).contains(&self.gain)
    }
}

impl KeptFile for LearningRecords {
    const WHAT: &'static str = "a learning file";
    const VERSION: u32 = 3;
    const LONGEST: u64 = SMALL_FILE_LIMIT * 8;
    const CODES: [&'static str; 3] = ["S0901", "S0902", "S0903"];
    const INSTEAD: &'static str =
        "give another file with --learning, or delete this one, and learning begins anew";

    fn whose(&self) -> Whose<'_> {
        Whose { version: self.version, machine: &self.machine, mark: &self.mark }
    }

    fn makes_sense(&self) -> Result<(), String> {
        if self.list.len() > MOST_RECORDS {
            return Err(format!("more than {MOST_RECORDS} kinds of stroke"));
        }
        if self.bands.len() > MOST_RECORDS {
            return Err(format!("more than {MOST_RECORDS} bands"));
        }
        if let Some(at) = self.bands.iter().position(|band| !band.makes_sense()) {
            return Err(format!("band {}: expected finite numbers", at + 1));
        }
        let bad = self.list.iter().position(|record| !record.makes_sense());
        bad.map_or(Ok(()), |at| {
            Err(format!("stroke {}: expected finite numbers, and a gain from 0 to 2", at + 1))
        })
    }
}

impl LearningRecords {
    /// Of this machine.
    pub fn new(machine: &str, mark: u32, list: Vec<LearningRecord>) -> Self {
        let version = Self::VERSION;
        let mark = format!("{mark:08x}");
        Self { version, machine: machine.into(), mark, list, bands: Vec::new() }
    }

    /// The same with what good holes were like.
    #[must_use]
    pub fn with(self, bands: Vec<BandRecord>) -> Self {
        Self { bands, ..self }
    }

    /// Read them from text.
    ///
    /// # Errors
    /// What is wrong with it: nothing of a damaged file is used.
    pub fn parse(text: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::read(text)
    }

    /// Read them from a file for a machine; `None` if there is no file yet.
    ///
    /// # Errors
    /// When the file cannot be read, or is damaged, or belongs to another machine or to this one
    /// before it was changed.
    pub fn load(path: &Path, machine: &str, mark: u32) -> Result<Option<Self>, Error> {
        Self::read_for(path, machine, mark)
    }

    /// Write them to a file, whole or not at all.
    ///
    /// # Errors
    /// When the file system refuses.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        self.write(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn learning_records() -> LearningRecords {
        let record = LearningRecord {
            tool: 3,
            lead_mm_per_rev: -1.0,
            spin_rev_per_s: 100.0,
            return_spin_rev_per_s: -100.0,
            turns_rev: 30.0,
            time_in_s: 0.61,
            time_out_s: 0.625,
            strokes: 12,
            gain: 0.7,
            strikes: 1,
            first_mm: 9e-4,
            best_mm: 3e-4,
            early_rev: 0.25,
            feed_nm: vec![0.0, 1.25, -3.0],
            spindle_1e9_rev: vec![0.0, 2.0],
        };
        LearningRecords::new("tapping-center", 7, vec![record])
    }

    fn sentence(text: &str) -> String {
        let found = LearningRecords::parse(text).unwrap_err();
        format!("{} {} {}", found[0].span.line, found[0].code, found[0].message)
    }

    #[test]
    fn what_is_written_reads_back_the_same() {
        assert_eq!(LearningRecords::parse(&learning_records().text()).unwrap(), learning_records());
    }

    #[test]
    fn a_file_cut_short_or_edited_is_recognised() {
        let text = learning_records().text();
        let cut = &text[..text.find("# end").unwrap()];
        assert!(sentence(cut).contains("cut short"), "{}", sentence(cut));
        assert!(sentence(&text.replace("1.25", "2.25")).contains("changed"));
        assert!(sentence("#1 = 3\n").contains("S0901"));
        for end in 0..text.len() - 1 {
            assert!(LearningRecords::parse(&text[..end]).is_err(), "cut at {end}");
        }
    }

    #[test]
    fn numbers_that_cannot_be_are_refused() {
        let changes: [fn(&mut LearningRecord); 3] =
            [|r| r.gain = 2.5, |r| r.early_rev = f64::NAN, |r| r.feed_nm[1] = f64::INFINITY];
        for change in changes {
            let mut records = learning_records();
            change(&mut records.list[0]);
            assert!(sentence(&records.text()).contains("stroke 1"), "{records:?}");
        }
        let mut many = learning_records();
        many.list = vec![many.list[0].clone(); MOST_RECORDS + 1];
        assert!(sentence(&many.text()).contains("more than 64"));
    }

    #[test]
    fn a_file_of_another_or_a_changed_machine_is_recognised() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("learnt.toml");
        assert_eq!(LearningRecords::load(&path, "tapping-center", 7).unwrap(), None);
        learning_records().save(&path).unwrap();
        assert!(LearningRecords::load(&path, "tapping-center", 7).unwrap().is_some());
        let said =
            |machine, mark| LearningRecords::load(&path, machine, mark).unwrap_err().to_string();
        assert!(said("vfd-mill", 7).contains("this is of tapping-center"));
        assert!(said("tapping-center", 8).contains("has been changed"));
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "(version = 3\n)?([-a-z0-9.\\[\\]=\"# \n]|\\PC){0,80}") {
            let _ = LearningRecords::parse(&text);
        }
    }
}
