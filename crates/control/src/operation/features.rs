//! What was cut from a workpiece: counted, the newest of it kept to be shown.
use crate::job::ClampedStock;
use std::collections::VecDeque;
use store::state::WorkpieceRecord;
use verify::{Feature, Undone, Verdict};

/// Features of programs before the last one that are kept to be shown.
pub const MOST_SHOWN: usize = 500;

/// What was cut from a workpiece, by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct FeatureCount {
    /// Within tolerance.
    pub good: usize,
    /// Out of it.
    pub failed: usize,
    /// Not judged.
    pub not_judged: usize,
}

/// What is known of the workpiece.
#[derive(Debug, Default)]
pub(super) struct WorkpieceLog {
    /// Its number on this machine, from 1, its name, and what was cut from it by programs before
    /// the last one.
    pub(super) record: WorkpieceRecord,
    /// The newest features of programs before the last one.
    pub(super) shown: VecDeque<Feature>,
    /// What a program has stated of it.
    pub(super) stock: ClampedStock,
    /// What was cut, by a control before this one too, is another list than before.
    pub(super) changes: u64,
}

/// The workpiece, for a panel.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(ts_rs::TS, utoipa::ToSchema))]
pub struct WorkpieceStatus {
    /// Its number on this machine, from 1.
    pub number: u32,
    /// Its name; `null`: it has none.
    pub name: Option<String>,
    /// Programs that were started on it.
    pub programs: u32,
    /// It has ended: the next start begins another one.
    pub is_ended: bool,
    /// Features of it that are counted and no longer listed.
    pub unlisted: usize,
}

impl WorkpieceLog {
    /// As a control before this one has left it.
    pub(super) fn of(record: Option<WorkpieceRecord>) -> Self {
        let record = record.unwrap_or_else(|| WorkpieceRecord { number: 1, ..Default::default() });
        Self { record, ..Self::default() }
    }

    /// Features of a program that is over.
    pub(super) fn keep(&mut self, features: Vec<Feature>) {
        let FeatureCount { good, failed, not_judged } = count(&features);
        self.record.good += good as u64;
        self.record.failed += failed as u64;
        self.record.not_judged += not_judged as u64;
        self.changes += u64::from(!features.is_empty());
        self.shown.extend(features);
        let more = self.shown.len().saturating_sub(MOST_SHOWN);
        self.shown.drain(..more);
    }

    /// A feature of a program before was destroyed; `None`: it is no longer kept.
    pub(super) fn take_back(&mut self, undone: &Undone) -> Option<Feature> {
        let feature = self.shown.iter_mut().rfind(|feature| feature.op == undone.op)?;
        let of = |verdict: &Verdict, record: &mut WorkpieceRecord, by: fn(u64) -> u64| {
            let count = match verdict {
                Verdict::Pass => &mut record.good,
                Verdict::NotJudged { .. } => &mut record.not_judged,
                Verdict::Fail { .. } => &mut record.failed,
            };
            *count = by(*count);
        };
        of(&feature.verdict, &mut self.record, |count| count.saturating_sub(1));
        feature.changed(undone);
        of(&feature.verdict, &mut self.record, |count| count + 1);
        self.changes += 1;
        Some(feature.clone())
    }

    /// What programs before the last one have cut.
    pub(super) fn counted(&self) -> FeatureCount {
        let WorkpieceRecord { good, failed, not_judged, .. } = self.record;
        let of = |count: u64| usize::try_from(count).unwrap_or(usize::MAX);
        FeatureCount { good: of(good), failed: of(failed), not_judged: of(not_judged) }
    }
}

pub(super) fn count(features: &[Feature]) -> FeatureCount {
    let mut count = FeatureCount::default();
    for feature in features {
        match feature.verdict {
            Verdict::Pass => count.good += 1,
            Verdict::Fail { .. } => count.failed += 1,
            Verdict::NotJudged { .. } => count.not_judged += 1,
        }
    }
    count
}

/// A feature and its verdict, in one line.
pub fn said_of(feature: &Feature) -> String {
    let (line, kind) = (feature.line, feature.kind_name());
    match feature.verdict.reason() {
        None => format!("line {line}: {kind}: good"),
        Some(reason) if matches!(feature.verdict, Verdict::NotJudged { .. }) => {
            format!("line {line}: {kind}: not judged: {reason}")
        }
        Some(reason) => format!("line {line}: {kind}: out of tolerance: {reason}"),
    }
}
