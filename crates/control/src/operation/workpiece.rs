//! The workpiece on the machine: what was cut from it, and when it begins and ends.
//!
//! ```text
//!   begin (a request; a start from the beginning, where the machine's file says so) ─► cut, counted ─► end
//!                       └── features of programs before: counted, the last of them kept, all in the log
//! ```
//!
//! The judge has the features of the last program alone: those of the programs before are counted,
//! and the newest of them are kept to be shown. Each is in `features.jsonl` of the state folder, as
//! long as that is not full, and in the history of runs.
use super::control::Control;
use super::features::{FeatureCount, WorkpieceLog, WorkpieceStatus, count, said_of};
use super::request::{Accepted, Refusal};
use super::writer::Key;
use crate::clock::unix_ms;
use crate::config;
use crate::job::mill_stock::MilledStock;
use crate::job::{ClampedStock, Session};
use store::begun_run::{BegunRun, CutFeature};
use store::state::{StateFolder, WorkpieceRecord, message_log};
use verify::{Feature, Judge, Verdict};

/// Longest name of a workpiece.
const LONGEST_NAME: usize = 200;

impl Control {
    /// What the last program has cut so far.
    fn of_last_program(&self) -> &[Feature] {
        match &self.under_way {
            Some(under_way) => under_way.running.judged_so_far(),
            None => self.workpiece.judge.features(),
        }
    }

    /// What was cut from the workpiece, with its verdicts: the newest.
    pub(super) fn judged(&self) -> Vec<Feature> {
        self.cut.shown.iter().chain(self.of_last_program()).cloned().collect()
    }

    /// Two lists of features of the same version are the same.
    pub(super) fn features_version(&self) -> (u64, usize, usize, bool) {
        let changed = self.verdicts_changed(0).len();
        (self.cut.changes, self.of_last_program().len(), changed, self.under_way.is_some())
    }

    /// Places of features of the last program whose verdict was changed after they were judged:
    /// those of the changes from this one on.
    pub(super) fn verdicts_changed(&self, change: usize) -> &[usize] {
        match &self.under_way {
            Some(under_way) => under_way.running.changed_since(change),
            None => self.workpiece.judge.changed_since(change),
        }
    }

    /// Reports the verdicts that have changed since they were reported.
    pub(super) fn tell_changed(&mut self) {
        let changed = self.verdicts_changed(self.told_changes);
        if changed.is_empty() {
            return;
        }
        let told = self.of_last_program().get(..self.told_features).unwrap_or_default();
        let again: Vec<Feature> =
            changed.iter().filter_map(|place| told.get(*place)).cloned().collect();
        let removed = changed.iter().filter(|place| **place == Judge::REMOVED).count();
        self.told_changes += changed.len();
        self.told_features = self.told_features.saturating_sub(removed);
        for feature in again {
            self.keep_feature(&feature);
            self.events.notice(format!("a verdict has changed: {}", said_of(&feature)));
        }
        self.keep_workpiece_or_say();
    }

    /// What the last program has destroyed of the programs before is counted so.
    pub(super) fn take_back_features(&mut self) {
        for undone in self.workpiece.judge.take_undone() {
            if let Some(feature) = self.cut.take_back(&undone) {
                self.keep_feature(&feature);
                self.events.notice(format!("a verdict has changed: {}", said_of(&feature)));
            }
        }
    }

    pub(super) fn counted(&self) -> FeatureCount {
        let (before, last) = (self.cut.counted(), count(self.of_last_program()));
        FeatureCount {
            good: before.good + last.good,
            failed: before.failed + last.failed,
            not_judged: before.not_judged + last.not_judged,
        }
    }

    /// The workpiece, for a panel.
    pub fn workpiece_status(&self) -> WorkpieceStatus {
        let WorkpieceRecord { number, name, programs, is_ended, .. } = self.cut.record.clone();
        let name = Some(name).filter(|name| !name.is_empty());
        let FeatureCount { good, failed, not_judged } = self.cut.counted();
        let unlisted = (good + failed + not_judged).saturating_sub(self.cut.shown.len());
        WorkpieceStatus { number, name, programs, is_ended, unlisted }
    }

    /// What the last program has cut is counted, and the judge forgets it.
    pub(super) fn put_aside_features(&mut self) {
        let features = self.workpiece.judge.take_features();
        self.cut.keep(features);
        (self.told_features, self.told_changes) = (0, 0);
    }

    /// A program begins: on another workpiece, if the one before has ended or the machine's file
    /// says that each start from the beginning does that.
    pub(super) fn start_on_workpiece(&mut self, from_the_beginning: bool) {
        self.put_aside_features();
        let each = self.base.machine.control.start_begins_workpiece && from_the_beginning;
        if self.cut.record.is_ended || each && self.cut.record.programs > 0 {
            self.next_workpiece(String::new());
        }
        self.cut.record.programs += 1;
        self.keep_workpiece_or_say();
    }

    /// What is clamped when the next program begins, as a program before has stated it.
    pub(super) fn stock_of_next(&self) -> ClampedStock {
        let begins_another =
            self.base.machine.control.start_begins_workpiece && self.cut.record.programs > 0;
        if self.cut.record.is_ended || begins_another {
            return ClampedStock::default();
        }
        self.cut.stock
    }

    fn next_workpiece(&mut self, name: String) {
        let number = self.cut.record.number + 1;
        let changes = self.cut.changes + 1;
        let record = WorkpieceRecord { number, name, ..WorkpieceRecord::default() };
        self.cut = WorkpieceLog { record, changes, ..WorkpieceLog::default() };
        let material = self.base.machine.setup.stock.material;
        self.workpiece.judge = Judge::new(verify::Config {
            tools: config::judged_tools(&self.base.machine, &self.base.tools, self.seed, 1),
            ..self.base.judge(material, &self.work_zero)
        });
        (self.told_features, self.told_changes) = (0, 0);
        if let Some((stock, bar)) = simulated_stock(&self.base, self.seed, &self.work_zero) {
            self.executor.machine.clamp_stock(stock, bar);
        }
        self.executor.machine.renew_work();
    }

    /// A program begins that states its stock: judge and simulated machine have it as `run` does.
    pub(super) fn clamp_stated(&mut self, session: &Session, text: &[u8], ops: &[canon::Op]) {
        if !session.has_stated_stock() {
            return;
        }
        let zero = session.work_zero();
        let material = session.machine.setup.stock.material;
        let config = session.judge(material, &zero);
        let block = MilledStock::stated_in(text, session);
        let milled = MilledStock::of(text, session, ops).found(session);
        let (stock, gear_blank) = (block.or(config.stock), block);
        let stated = verify::Config { stock, gear_blank, mill_stock: milled, ..config };
        self.workpiece.judge.is_clamped(&stated);
        self.cut.stock = session.clamped();
        if let Some((stock, bar)) = simulated_stock(session, self.seed, &zero) {
            self.executor.machine.clamp_stock(stock, bar);
        }
    }

    /// Another workpiece is clamped.
    pub(super) fn begin_workpiece(&mut self, name: Option<&str>) -> Result<Accepted, Refusal> {
        let name = name.unwrap_or_default().trim();
        if name.len() > LONGEST_NAME || name.chars().any(char::is_control) {
            return Err(Refusal::because(format!(
                "a workpiece's name is one line of {LONGEST_NAME} bytes at most"
            )));
        }
        let before = self.workpiece_said();
        self.put_aside_features();
        self.next_workpiece(name.to_owned());
        self.keep_workpiece()?;
        Ok(Accepted { notes: vec![before, format!("{} begins", self.workpiece_name())] })
    }

    /// The workpiece is done.
    pub(super) fn end_workpiece(&mut self) -> Result<Accepted, Refusal> {
        if self.cut.record.is_ended {
            let name = self.workpiece_name();
            return Err(Refusal::because(format!("{name} has ended already: begin the next one")));
        }
        self.put_aside_features();
        self.cut.record.is_ended = true;
        if let Err(why) = self.keep_workpiece() {
            self.cut.record.is_ended = false;
            return Err(why);
        }
        Ok(Accepted { notes: vec![self.workpiece_said()] })
    }

    fn workpiece_name(&self) -> String {
        let WorkpieceRecord { number, name, .. } = &self.cut.record;
        if name.is_empty() {
            format!("workpiece {number}")
        } else {
            format!("workpiece {number} ({name})")
        }
    }

    fn workpiece_said(&self) -> String {
        let FeatureCount { good, failed, not_judged } = self.counted();
        let name = self.workpiece_name();
        format!("{name}: {good} features good, {failed} out of tolerance, {not_judged} not judged")
    }

    /// The workpiece is on the disk, with what the last program has cut so far.
    pub(super) fn keep_workpiece(&mut self) -> Result<(), Refusal> {
        let FeatureCount { good, failed, not_judged } = self.counted();
        let (good, failed, not_judged) = (good as u64, failed as u64, not_judged as u64);
        let record = WorkpieceRecord { good, failed, not_judged, ..self.cut.record.clone() };
        self.kept.save(Key::Workpiece, move |folder| folder.save_workpiece(&record))
    }

    pub(super) fn keep_workpiece_or_say(&mut self) {
        if let Err(why) = self.keep_workpiece() {
            self.events.notice(why.to_string());
        }
    }

    /// A feature is in the log, a line of JSON.
    pub(super) fn keep_feature(&mut self, feature: &Feature) {
        if self.kept.folder().is_none() {
            return;
        }
        let verdict = match feature.verdict {
            Verdict::Pass => "good",
            Verdict::Fail { .. } => "failed",
            Verdict::NotJudged { .. } => "not_judged",
        };
        let under_way = self.under_way.as_ref();
        let run = under_way.and_then(|u| Some((u.folder.as_ref()?.path(""), u.running.begun())));
        let last = || self.last_program.as_ref().map(|last| last.path.clone());
        let program = under_way.map(|u| u.name.clone()).or_else(last).unwrap_or_default();
        let cut = run.map(|(folder, begun)| {
            let time_s = (self.now() - begun).value();
            (folder, CutFeature { verdict: verdict.to_owned(), time_s })
        });
        let entry = message_log::LoggedFeature {
            unix_ms: unix_ms(),
            program,
            verdict,
            workpiece: self.cut.record.number,
            line: feature.line,
            text: said_of(feature),
        };
        let write = move |folder: &mut StateFolder| {
            let logged = message_log::append_feature(folder.path(), &entry);
            let of_run = cut.map_or(Ok(()), |(run, cut)| BegunRun::append(&run, &cut));
            logged.and(of_run).map_err(|why| format!("a feature is not in the log: {why}"))
        };
        if let Err(why) = self.kept.write(Key::Message, Box::new(write)) {
            self.events.notice(why);
        }
    }
}

/// What a simulated machine clamps for a session.
fn simulated_stock(
    session: &Session,
    seed: u64,
    zero: &canon::Position,
) -> Option<(sim::Stock, Option<sim::Bar>)> {
    let (plant, material) = (session.plant(), session.machine.setup.stock.material);
    let simulated = config::simulator(plant, &session.tools, material, seed, zero);
    let bar = config::bar(plant, &simulated);
    simulated.stock.map(|stock| (stock, bar))
}
