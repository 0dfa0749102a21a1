//! A run that was begun and is not over: what is known of it while its folder is still hidden, for
//! the history of a control that is killed meanwhile.
//!
//! ```text
//!   RUNS/.ID-Xy12/begun.json   program, hash, when
//!               /cut.jsonl     a verdict a line, as features are judged
//! ```
use crate::regular;
use serde::{Deserialize, Serialize};
use std::io::{self, Write as _};
use std::path::Path;

/// Names of the two files: they are not part of a run that is over.
pub const FILES: [&str; 2] = ["begun.json", "cut.jsonl"];
/// Bytes that they may have.
const LARGEST: u64 = 64 << 20;

/// What is known when a program begins.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BegunRun {
    /// The program.
    pub program: String,
    /// SHA-256 of its text.
    pub program_sha256: String,
    /// When it was begun, ms since 1970.
    pub begun_unix_ms: u64,
}

/// A feature of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CutFeature {
    /// `good`, `failed`, `not_judged`.
    pub verdict: String,
    /// Machine time since the program began, s.
    pub time_s: f64,
}

impl BegunRun {
    /// Writes it into the folder of the run.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        let mut file = regular::create(&folder.join(FILES[0]))?;
        file.write_all(&serde_json::to_vec(self)?)?;
        file.sync_all()?;
        regular::create(&folder.join(FILES[1]))?.sync_all()
    }

    /// What a folder says of a run that was begun in it; `None`: nothing.
    pub fn read(folder: &Path) -> Option<(Self, Vec<CutFeature>)> {
        let read = |name| crate::read_bytes(&folder.join(name), "a run that was begun", LARGEST);
        let begun = serde_json::from_slice(&read(FILES[0]).ok()?).ok()?;
        let cut = read(FILES[1]).unwrap_or_default();
        let lines = cut.split(|byte| *byte == b'\n');
        // a line that was cut short is none
        Some((begun, lines.filter_map(|line| serde_json::from_slice(line).ok()).collect()))
    }

    /// One more feature; of a run that is over meanwhile, nothing.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn append(folder: &Path, feature: &CutFeature) -> io::Result<()> {
        let file = regular::append_to_existing(&folder.join(FILES[1]));
        let mut file = match file {
            Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
            other => other?,
        };
        let mut line = serde_json::to_vec(feature)?;
        line.push(b'\n');
        file.write_all(&line)?;
        file.sync_data()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_is_broken_off_says_what_it_had_cut_and_a_half_line_counts_nothing() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(BegunRun::read(folder.path()), None);
        let begun = BegunRun { program: "part.ngc".into(), ..BegunRun::default() };
        begun.write(folder.path()).unwrap();
        let feature = CutFeature { verdict: "good".into(), time_s: 1.5 };
        for _ in 0..3 {
            BegunRun::append(folder.path(), &feature).unwrap();
        }
        let file = folder.path().join(FILES[1]);
        let mut text = std::fs::read(&file).unwrap();
        text.truncate(text.len() - 4);
        std::fs::write(file, text).unwrap();
        assert_eq!(BegunRun::read(folder.path()), Some((begun, vec![feature; 2])));
    }

    #[test]
    fn of_a_run_that_is_over_nothing_more_is_written() {
        let folder = tempfile::tempdir().unwrap();
        BegunRun::append(folder.path(), &CutFeature::default()).unwrap();
        assert!(!folder.path().join(FILES[1]).exists());
    }
}
