//! The history of runs.
use super::feature::FeatureBody;
use super::lists::AlarmBody;
use serde::{Deserialize, Serialize};

/// A program that was executed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RunBody {
    /// Its id; a later run has a greater one.
    pub id: String,
    /// The program.
    pub program: String,
    /// SHA-256 of its text: runs of the same text have the same.
    pub program_sha256: String,
    /// When it ended, ms since 1970.
    #[ts(type = "number")]
    pub ended_unix_ms: u64,
    /// How long the machine took, s.
    pub cycle_time_s: f64,
    /// The program came to its end.
    pub has_ended: bool,
    /// The control ended, or was killed, while it was under way: what is known of it was kept as it
    /// was cut.
    #[serde(default)]
    pub was_cut_off: bool,
    /// `good`, `failed`, `not_judged`: of the whole run.
    pub verdict: String,
    /// Features that are within tolerance.
    pub good: usize,
    /// Features that are out of it.
    pub failed: usize,
    /// Features that were not judged.
    pub not_judged: usize,
    /// Alarms.
    pub alarms: usize,
    /// Its trace is kept.
    pub has_trace: bool,
    /// Bytes on the disk.
    #[ts(type = "number")]
    pub bytes: u64,
}

/// Runs that were asked for.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RunsBody {
    /// The latest first.
    pub runs: Vec<RunBody>,
    /// There are more.
    pub is_shortened: bool,
    /// Runs are kept: there is a folder for them.
    pub is_kept: bool,
}

/// A run, with what it made.
#[derive(Clone, Debug, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RunDetailBody {
    /// What the list says of it.
    pub run: RunBody,
    /// What was cut, as it was judged.
    pub features: Vec<FeatureBody>,
    /// What stopped it.
    pub alarms: Vec<AlarmBody>,
}

/// A part of a run's trace, in columns of equal length of time.
#[derive(Clone, Debug, Default, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RunTraceBody {
    /// Names of all signals of the trace.
    pub available: Vec<String>,
    /// Time of the first row, from the run's beginning, s.
    pub from_s: f64,
    /// Time of the last row, s.
    pub to_s: f64,
    /// Time of each column's first row, s.
    pub time_s: Vec<f64>,
    /// The signals that were asked for.
    pub signals: Vec<RunTraceSignal>,
}

/// A signal of a trace.
#[derive(Clone, Debug, Default, Serialize, ts_rs::TS, utoipa::ToSchema)]
pub(crate) struct RunTraceSignal {
    /// Its name.
    pub name: String,
    /// Least value of each column; null where there is none.
    pub least: Vec<Option<f64>>,
    /// Greatest value of each column.
    pub most: Vec<Option<f64>>,
}
