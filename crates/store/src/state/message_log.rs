//! The log of what programs have said to their operator: `messages.jsonl`, a line each.
//!
//! It is for people, and nothing is read from it; so its lines are appended without a seal. Of a
//! large one the file before it is kept as `messages.jsonl.previous`, and no other.
use std::fs::{self, OpenOptions};
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

/// Append a message.
///
/// # Errors
/// The disk refuses.
pub fn append(folder: &Path, entry: &LoggedMessage) -> io::Result<()> {
    let path = folder.join(FILE);
    if fs::metadata(&path).is_ok_and(|about| about.len() >= LARGEST) {
        fs::rename(&path, folder.join(super::previous(FILE)))?;
    }
    let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
    let line = serde_json::to_string(entry)?;
    writeln!(file, "{line}")
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
}
