//! Logs, a line each: what programs have said to their operator, `messages.jsonl`, and what was
//! cut, `features.jsonl`.
//!
//! They are for people, and nothing is read from them; so their lines are appended without a seal.
//! Of a large one the file before it is kept as `NAME.previous`, and no other.
use crate::regular;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

/// Its name.
pub const FILE: &str = "messages.jsonl";
/// A larger one is put aside, bytes.
const LARGEST: u64 = 1 << 20;

/// A message.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LoggedMessage {
    /// When, ms since 1970.
    pub unix_ms: u64,
    /// Machine time, s.
    pub time_s: f64,
    /// The program …
    pub program: String,
    /// … and its line.
    pub line: u32,
    /// What it says.
    pub text: String,
}

/// Name of the log of features, and its size at which it is put aside, bytes.
const FEATURES: &str = "features.jsonl";
const LARGEST_OF_FEATURES: u64 = 16 << 20;

/// A feature that was cut.
#[derive(Clone, Debug, serde::Serialize)]
pub struct LoggedFeature {
    /// When it was judged, ms since 1970.
    pub unix_ms: u64,
    /// The program that cut it.
    pub program: String,
    /// Number of the workpiece on this machine.
    pub workpiece: u32,
    /// Its line in the program.
    pub line: u32,
    /// `good`, `failed`, `not_judged`.
    pub verdict: &'static str,
    /// What it is, and its verdict.
    pub text: String,
}

/// Append a message.
///
/// # Errors
/// The disk refuses.
pub fn append(folder: &Path, entry: &LoggedMessage) -> io::Result<()> {
    append_line(folder, FILE, LARGEST, entry)
}

/// Append a feature.
///
/// # Errors
/// The disk refuses.
pub fn append_feature(folder: &Path, entry: &LoggedFeature) -> io::Result<()> {
    append_line(folder, FEATURES, LARGEST_OF_FEATURES, entry)
}

fn append_line(
    folder: &Path,
    name: &str,
    largest: u64,
    entry: &impl serde::Serialize,
) -> io::Result<()> {
    let appended = || -> io::Result<()> {
        let path = folder.join(name);
        if fs::metadata(&path).is_ok_and(|about| about.len() >= largest) {
            fs::rename(&path, folder.join(super::previous(name)))?;
        }
        let line = serde_json::to_string(entry)?;
        writeln!(regular::append(&path)?, "{line}")
    };
    appended().map_err(|e| io::Error::new(e.kind(), format!("{name}: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_appended_and_the_log_never_grows_beyond_two_files_of_its_size() {
        let folder = tempfile::tempdir().unwrap();
        let text = "x".repeat(100_000);
        let entry =
            LoggedMessage { unix_ms: 1, time_s: 0.5, program: "part.ngc".into(), line: 7, text };
        for _ in 0..40 {
            append(folder.path(), &entry).unwrap();
        }
        let sizes = fs::read_dir(folder.path()).unwrap().map(|f| f.unwrap().metadata().unwrap());
        let sizes: Vec<_> = sizes.map(|about| about.len()).collect();
        assert_eq!(sizes.len(), 2);
        assert!(sizes.iter().all(|size| *size < LARGEST + 200_000), "{sizes:?}");
    }

    #[test]
    #[cfg(unix)]
    fn a_log_that_is_a_named_pipe_is_refused_by_its_name_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        for name in [FILE, FEATURES] {
            let made = std::process::Command::new("mkfifo").arg(folder.path().join(name)).status();
            assert!(made.unwrap().success());
        }
        let message = append(
            folder.path(),
            &LoggedMessage {
                unix_ms: 1,
                time_s: 0.5,
                program: "part.ngc".into(),
                line: 7,
                text: "x".into(),
            },
        );
        let feature = append_feature(
            folder.path(),
            &LoggedFeature {
                unix_ms: 1,
                program: "part.ngc".into(),
                workpiece: 1,
                line: 7,
                verdict: "good",
                text: "a hole".into(),
            },
        );
        for (name, logged) in [(FILE, message), (FEATURES, feature)] {
            let why = logged.unwrap_err().to_string();
            assert!(why.starts_with(&format!("{name}: it is a named pipe")), "{why}");
            assert!(why.ends_with("remove it"), "{why}");
        }
    }
}
