//! The history of runs: a folder for each, with what `leadscrew run` would leave behind.
//!
//! ```text
//!   STATE/runs/.ID-…/           while it is written; of what a killed server has left a run is made
//!         │                     that was cut off, from what was kept as it was cut
//!         └─ rename ─► ID/      whole: run.json, report.html, certificate.json, trace.parquet
//! ```
//!
//! The oldest give way when there are more than may be, or when they are larger together.
mod columns;
mod record;

pub(crate) use record::Recorder;

use crate::wire::{RunBody, RunDetailBody, RunTraceBody, RunsBody};
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};
use store::begun_run::{BegunRun, FILES as BEGUN};

/// Runs in one answer.
const MOST_LISTED: usize = 200;
/// Names of folders that are being written begin with it.
const HIDDEN: char = '.';
/// What the list says of a run, and all that it made.
const RUN: &str = "run.json";
/// Largest file of a run that is answered whole: a trace is read by its columns.
const LARGEST_FILE: u64 = 256 << 20;
/// The page for people.
pub(crate) const REPORT: &str = "report.html";
/// What programs rely on.
pub(crate) const CERTIFICATE: &str = "certificate.json";
/// Every period.
pub(crate) const TRACE: &str = "trace.parquet";

/// How much is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeptRuns {
    /// Runs at most.
    pub most: usize,
    /// All of them together, bytes.
    pub most_bytes: u64,
}

impl Default for KeptRuns {
    /// Two hundred runs, 2 GiB.
    fn default() -> Self {
        Self { most: 200, most_bytes: 2 << 30 }
    }
}

/// What is looked for.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Search {
    /// The program's name contains it.
    program: Option<String>,
    verdict: Option<String>,
    /// It ended at this moment or later.
    from_unix_ms: Option<u64>,
    /// It ended before this moment.
    to_unix_ms: Option<u64>,
}

impl Search {
    fn finds(&self, run: &RunBody) -> bool {
        let program = self.program.as_ref().map(|part| part.to_lowercase());
        program.is_none_or(|part| run.program.to_lowercase().contains(&part))
            && self.verdict.as_ref().is_none_or(|verdict| run.verdict == *verdict)
            && self.from_unix_ms.is_none_or(|from| run.ended_unix_ms >= from)
            && self.to_unix_ms.is_none_or(|to| run.ended_unix_ms < to)
    }
}

/// The folder; without one nothing is kept, and nothing found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Runs {
    folder: Option<PathBuf>,
    kept: KeptRuns,
}

impl Runs {
    /// In a state folder; of what was not finished a run is made that was cut off, or it is
    /// removed. `shown` makes of a program's path what clients see of it.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub(crate) fn open(
        state: Option<&Path>,
        kept: KeptRuns,
        shown: &dyn Fn(&str) -> String,
    ) -> Result<Self, String> {
        let Some(folder) = state.map(|state| state.join("runs")) else {
            return Ok(Self::default());
        };
        fs::create_dir_all(&folder)
            .map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
        let runs = Self { folder: Some(folder), kept };
        for unfinished in runs.names().into_iter().filter(|name| name.starts_with(HIDDEN)) {
            if runs.finish_cut_off(&unfinished, shown).is_some() {
                continue;
            }
            let _ = fs::remove_dir_all(runs.path(&unfinished)); // it is tried again at the next start
        }
        Ok(runs)
    }

    /// A run that was under way when the server was killed; `None`: nothing is known of it.
    fn finish_cut_off(&self, hidden: &str, shown: &dyn Fn(&str) -> String) -> Option<()> {
        let (id, _) = hidden.strip_prefix(HIDDEN)?.rsplit_once('-')?;
        let (from, to) = (self.path(hidden), self.path(id));
        let (begun, cut) = BegunRun::read(&from)?;
        if !is_id(id) || to.exists() {
            return None;
        }
        let count = |verdict: &str| cut.iter().filter(|cut| cut.verdict == verdict).count();
        let failed = count("failed");
        let time_s = cut.last().map_or(0.0, |cut| cut.time_s);
        let run = RunBody {
            id: id.to_owned(),
            program: shown(&begun.program),
            program_sha256: begun.program_sha256,
            ended_unix_ms: begun.begun_unix_ms + (time_s.max(0.0) * 1e3) as u64,
            cycle_time_s: time_s,
            has_ended: false,
            was_cut_off: true,
            verdict: if failed > 0 { "failed" } else { "not_judged" }.to_owned(),
            good: count("good"),
            failed,
            not_judged: count("not_judged"),
            alarms: 0,
            has_trace: false,
            bytes: 0,
        };
        let detail = RunDetailBody { run, features: Vec::new(), alarms: Vec::new() };
        let text = serde_json::to_vec(&detail).ok()?;
        store::output::write_file(&from.join(RUN), &text).ok()?;
        // its trace has no end, and cannot be read
        for name in [TRACE, BEGUN[0], BEGUN[1]] {
            let _ = fs::remove_file(from.join(name));
        }
        fs::rename(&from, &to).ok()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.as_deref().unwrap_or(Path::new("")).join(name)
    }

    /// What lies in the folder.
    fn names(&self) -> Vec<String> {
        let Some(folder) = &self.folder else { return Vec::new() };
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }

    /// Ids, the latest first.
    fn ids(&self) -> Vec<String> {
        let mut ids: Vec<_> = self.names().into_iter().filter(|name| is_id(name)).collect();
        ids.sort_unstable_by(|a, b| b.cmp(a));
        ids
    }

    fn run(&self, id: &str) -> Option<RunBody> {
        #[derive(Deserialize)]
        struct Stored {
            run: RunBody,
        }
        let text = read(&self.path(id).join(RUN))?;
        serde_json::from_slice::<Stored>(&text).ok().map(|stored| stored.run)
    }

    /// The runs that a search finds.
    pub(crate) fn list(&self, search: &Search) -> RunsBody {
        let found = self.ids().into_iter().filter_map(|id| self.run(&id));
        let mut runs: Vec<_> =
            found.filter(|run| search.finds(run)).take(MOST_LISTED + 1).collect();
        let is_shortened = runs.len() > MOST_LISTED;
        runs.truncate(MOST_LISTED);
        RunsBody { runs, is_shortened, is_kept: self.folder.is_some() }
    }

    /// A file of a run.
    pub(crate) fn file(&self, id: &str, name: &str) -> Option<PathBuf> {
        (self.folder.is_some() && is_id(id)).then(|| self.path(id).join(name))
    }

    /// All that is known of a run, as JSON.
    pub(crate) fn detail(&self, id: &str) -> Option<Vec<u8>> {
        read(&self.file(id, RUN)?)
    }

    /// Columns of a run's trace; `None`: there is none.
    pub(crate) fn trace(
        &self,
        id: &str,
        asked: &TraceQuery,
    ) -> Option<Result<RunTraceBody, String>> {
        let path = self.file(id, TRACE).filter(|path| path.exists())?;
        Some(columns::read(&path, asked))
    }

    /// Where runs are recorded, if anywhere.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The oldest give way.
    pub(crate) fn make_room(&self) {
        let (mut count, mut bytes) = (0, 0_u64);
        for id in self.ids() {
            count += 1;
            bytes += size_of(&self.path(&id));
            // the latest stays, however large it is
            if count > 1 && (count > self.kept.most || bytes > self.kept.most_bytes) {
                let _ = fs::remove_dir_all(self.path(&id)); // it is tried again after the next run
            }
        }
    }
}

/// `?signals=a,b&from_s=…&to_s=…&columns=…`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TraceQuery {
    #[serde(default)]
    signals: String,
    from_s: Option<f64>,
    to_s: Option<f64>,
    columns: Option<usize>,
}

/// A file of a run; `None`: there is none, or it is none that was kept.
pub(crate) fn read(path: &Path) -> Option<Vec<u8>> {
    store::read_bytes(path, "a file of a run", LARGEST_FILE).ok()
}

/// Bytes of the files of a folder.
pub(crate) fn size_of(folder: &Path) -> u64 {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    files.filter_map(|file| file.metadata().ok()).map(|about| about.len()).sum()
}

/// Milliseconds since 1970, with a number of those within the same one: digits and `-` alone, so
/// that no path hides in it.
fn is_id(name: &str) -> bool {
    name.len() <= 24
        && name.starts_with(|c: char| c.is_ascii_digit())
        && name.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-')
}

#[cfg(test)]
mod tests {
    use super::*;
    use store::begun_run::CutFeature;

    #[test]
    fn a_run_that_a_kill_has_cut_off_is_in_the_history_with_what_it_had_cut() {
        let home = tempfile::tempdir().expect("a folder");
        let hidden = home.path().join("runs/.1790000000000-Xy12");
        fs::create_dir_all(&hidden).expect("a folder");
        let begun = BegunRun {
            program: "plate.ngc".into(),
            program_sha256: "ab".into(),
            begun_unix_ms: 1_790_000_000_000,
        };
        begun.write(&hidden).expect("written");
        for verdict in ["good", "failed", "good"] {
            let cut = CutFeature { verdict: verdict.into(), time_s: 2.5 };
            BegunRun::append(&hidden, &cut).expect("written");
        }
        fs::write(hidden.join(TRACE), "half a trace").expect("written");
        // one of which nothing is known
        fs::create_dir(home.path().join("runs/.1790000000001-Zz99")).expect("a folder");
        let runs =
            Runs::open(Some(home.path()), KeptRuns::default(), &str::to_owned).expect("it opens");
        let listed = runs.list(&Search::default()).runs;
        let [run] = listed.as_slice() else { panic!("{listed:?}") };
        assert_eq!((run.good, run.failed, run.cycle_time_s), (2, 1, 2.5));
        assert!(run.was_cut_off && !run.has_ended && !run.has_trace);
        assert_eq!(run.verdict, "failed");
        assert_eq!(runs.names(), ["1790000000000"]);
    }
}
