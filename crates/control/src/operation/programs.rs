//! Programs and blocks that are typed: loaded, searched, started, held, ended.
//!
//! ```text
//!   load ─► Loaded ─(search)─► restart ─► start ─► UnderWay ─► end: what it leaves stays in force
//!                                                     │
//!   typed blocks ─────────────────────────────────────┘
//! ```
use super::control::Control;
use super::ended::EndedProgram;
use super::keeping::take_left;
use super::proof::{Basis, Fit, Proof};
use super::request::{Accepted, Refusal, Request};
use super::state::{ExecutionEvent, Mode};
use super::tool_path::ToolPath;
use super::under_way::{Loaded, LoadedProgram, Searched, UnderWay, count_from};
use crate::job::preflight::wrong_from;
use crate::job::restart::{self, Restart};
use crate::job::{Session, Texts};
use crate::observers::use_up;
use crate::{Loaded as Ready, Refused, Running};
use bus::State;
use canon::{Axis, Op, OpKind, Position, SpindleOrder};
use diag::{Diagnostic, Severity};
use kernel::Order;
use std::sync::Arc;
use store::state::LastProgram;
use store::sync_record::{Stage, SyncRecord};

/// Findings of a program that is accepted which are said.
const MOST_NOTES: usize = 20;

impl Control {
    /// A request whose text is fit to be executed.
    pub(super) fn execute_fit(&mut self, request: &Request, fit: Fit) -> Result<Accepted, Refusal> {
        match request {
            Request::Search(from, is_confirmed) => self.search(*from, *is_confirmed, fit),
            Request::Start => self.start(fit),
            _ => self.execute_typed(fit),
        }
    }

    /// Load a text that was proved on this basis.
    pub(super) fn load(&mut self, fit: Fit, basis: Basis) -> Result<Accepted, Refusal> {
        let Fit { path, name, text, proved, .. } = &fit;
        let planned = proved.known.planned;
        let count = proved.operations.all().len();
        let time = planned.map_or_else(
            || "its time is being planned".into(),
            |time| format!("planned {:.1} s", time.value()),
        );
        let mut notes = vec![format!("{name}: {count} operations, {time}")];
        notes.extend(notes_of(&proved.known.findings));
        // how far the last program came is kept until one is started
        notes.extend(self.changed_since(&fit, &fit.sha256()));
        let way = self.path_through(proved.operations.all());
        let shown = Arc::new(LoadedProgram { name: name.clone(), text: text.clone(), path: way });
        let (path, name) = (path.clone(), name.clone());
        let reads_files = fit.reads_files();
        let dialect = fit.session.dialect;
        let proof = Some(Proof::of(basis, Some(fit)));
        self.loaded =
            Some(Loaded { path, dialect, name, proof, reads_files, from: None, planned, shown });
        self.execution_after(ExecutionEvent::Reset);
        Ok(Accepted { notes })
    }

    /// The program that is loaded, as a picture shows it.
    pub fn loaded_program(&self) -> Option<Arc<LoadedProgram>> {
        self.loaded.as_ref().map(|loaded| Arc::clone(&loaded.shown))
    }

    /// The way of the tool through operations that begin here, in the work offset in force.
    fn path_through(&self, ops: &[Op]) -> ToolPath {
        let system = self.work_offset();
        let zero = [Axis::X, Axis::Y, Axis::Z].map(|axis| self.zero_of(system, axis).value());
        let length_of = |number: u32| {
            self.data.tools.get(number).map_or(0.0, |tool| (tool.length + tool.wear.length).value())
        };
        ToolPath::of(ops, self.position(), zero, length_of(self.mounted()), &length_of)
    }

    /// Why a place in this program may not be where it was: the program was left half done, and its
    /// texts are others since.
    fn changed_since(&self, fit: &Fit, sha256: &str) -> Option<String> {
        let last = self.last_program.as_ref()?;
        let is_half_done = last.line > 0 && !last.is_completed;
        let is_this = is_same_place(&last.path, &fit.name);
        (is_half_done && is_this && last.sha256 != sha256).then(|| {
            format!(
                "{} was changed since it was left at line {}, in feature {}: its lines and holes may not be those that were cut",
                fit.session.texts(&fit.text).described(&fit.name), last.line, last.feature
            )
        })
    }

    /// Why a program is not begun in its middle beside this sync record: a recovery took a tool out
    /// of other texts of it, and nothing that this control remembers is newer.
    pub(super) fn changed_since_recovery(
        &self,
        record: Option<&SyncRecord>,
        name: &str,
        texts: &Texts<'_>,
    ) -> Option<String> {
        let place = &record.filter(|record| record.stage == Stage::Recovered)?.place;
        let file = |name: &str| std::path::Path::new(name).file_name().map(ToOwned::to_owned);
        let is_known =
            |last: &LastProgram| is_same_place(&last.path, name) && last.sha256 == texts.sha256();
        let searched = self.loaded.as_ref().and_then(|loaded| loaded.from.as_ref());
        let is_confirmed = searched.is_some_and(|searched| searched.is_confirmed);
        let is_other = file(&place.program) == file(name) && place.checksum != texts.crc32();
        (is_other && !is_confirmed && !self.last_program.as_ref().is_some_and(is_known)).then(|| {
            format!(
                "{} was changed since a tool was taken out of it at line {}, hole {}: its lines and holes may not be those that were cut; compare them, then search with \"program changed\" (program_changed)",
                texts.described(name), place.line, place.hole
            )
        })
    }

    /// Where the program would be begun, and what is restored before its first move.
    fn search(
        &mut self,
        from: restart::From,
        is_confirmed: bool,
        fit: Fit,
    ) -> Result<Accepted, Refusal> {
        let sha256 = fit.sha256();
        if let Some(why) = self.changed_since(&fit, &sha256)
            && !is_confirmed
        {
            return Err(Refusal::because(format!(
                "{why}; compare them, then search with \"program changed\" (program_changed)"
            )));
        }
        let found = find(&fit, from).map(|restart| restored(&fit.session, &restart));
        let basis = self.basis();
        let Some(loaded) = &mut self.loaded else { return Ok(Accepted::default()) };
        loaded.proof = Some(Proof::of(basis, Some(fit)));
        let notes = found?;
        loaded.from = Some(Searched { from, sha256, is_confirmed });
        Ok(Accepted { notes })
    }

    fn start(&mut self, fit: Fit) -> Result<Accepted, Refusal> {
        let searched = self.loaded.as_ref().and_then(|loaded| loaded.from.clone());
        let restart = searched.map(|searched| found_again(&fit, &searched)).transpose()?;
        let session = &fit.session;
        let notes = restart.as_ref().map_or_else(Vec::new, |restart| restored(session, restart));
        self.begin_text(Mode::Automatic, fit, restart)?;
        if let Some(loaded) = &mut self.loaded {
            loaded.from = None;
        }
        Ok(Accepted { notes })
    }

    fn execute_typed(&mut self, fit: Fit) -> Result<Accepted, Refusal> {
        let notes = notes_of(&fit.proved.known.findings);
        self.begin_text(Mode::ManualDataInput, fit, None)?;
        Ok(Accepted { notes })
    }

    fn begin_text(
        &mut self,
        mode: Mode,
        fit: Fit,
        restart: Option<Restart>,
    ) -> Result<(), Refusal> {
        let Fit { path, name, text, session, proved, timeline } = fit;
        if !self.executor.kernel.clear() {
            return Err(Refusal::because("an axis still moves: wait until it stands"));
        }
        let options = session.plan_options(session.machine.setup.stock.material);
        let loaded = Ready {
            session: &session,
            operations: &proved.operations,
            restart: restart.as_ref(),
            options,
            planned: proved.known.planned,
        };
        if let Some(grinding) = session.cams.grinding(&self.work_zero) {
            self.executor
                .machine
                .clamp(grinding)
                .map_err(|why| Refusal::because(why.to_string()))?;
        }
        let writer = self.record_writer(&session, (&name, &text), restart.as_ref())?;
        match mode {
            Mode::Automatic => {
                self.begin_last_program(&name, session.texts(&text).sha256());
                self.start_on_workpiece(restart.is_none());
            }
            Mode::ManualDataInput | Mode::Manual => self.put_aside_features(),
        }
        self.clamp_stated(&session, &text, proved.operations.all());
        let first = self.next_op;
        let mut workpiece = self.workpiece.clone();
        workpiece.watch.begin_program();
        workpiece.judge.may_grind(session.cams.library.clone());
        workpiece.judge.holes_are_there(session.pre_drilled);
        let mut running = Running::attended(&loaded, workpiece, first, &mut self.executor);
        running.count_tool_use(self.mounted());
        running.record_marks(self.changer.is_some());
        if let Some(writer) = writer {
            running.keep_sync_record(writer, &mut self.executor);
        }
        let folder = match mode {
            Mode::Automatic => self.begin_record(&session, (&name, &text), &mut running),
            Mode::ManualDataInput | Mode::Manual => None,
        };
        let executed = (first, self.now());
        self.under_way = Some(UnderWay {
            running,
            name,
            path,
            session,
            text,
            proved,
            folder,
            timeline,
            executed,
            first,
            restart,
            is_given_up: false,
        });
        (self.is_hold_asked, self.message) = (false, None);
        self.enter(mode);
        self.execution_after(ExecutionEvent::Start);
        Ok(())
    }

    /// How far a program of other texts came counts no more.
    fn begin_last_program(&mut self, name: &str, sha256: String) {
        let is_same = |last: &LastProgram| last.path == name && last.sha256 == sha256;
        if !self.last_program.as_ref().is_some_and(is_same) {
            let path = name.to_owned();
            self.last_program = Some(LastProgram { path, sha256, ..LastProgram::default() });
        }
    }

    /// How far the program that is loaded has come: its operations count from `first`, and so many
    /// features are its own.
    pub(super) fn note_progress(&mut self, first: u32, cut: u32, is_completed: bool) {
        let report = self.executor.kernel.report();
        if let Some(last) = &mut self.last_program {
            (last.line, last.operation) = (report.line, report.op.saturating_sub(first));
            (last.feature, last.is_completed) = (cut, is_completed);
        }
    }

    pub(super) fn hold(&mut self) -> Result<Accepted, Refusal> {
        self.is_hold_asked = true;
        self.order(Order::FeedHold)
    }

    pub(super) fn resume(&mut self) -> Result<Accepted, Refusal> {
        self.is_hold_asked = false;
        self.order(Order::Resume)
    }

    pub(super) fn confirm(&mut self) -> Result<Accepted, Refusal> {
        self.order(Order::Confirm)
    }

    pub(super) fn give_up(&mut self) -> Result<Accepted, Refusal> {
        self.is_hold_asked = true;
        if let Some(under_way) = &mut self.under_way {
            under_way.is_given_up = true;
        }
        self.order(Order::Abort)
    }

    pub(super) fn skip_blocks(&mut self, level: u8, on: bool) -> Result<Accepted, Refusal> {
        if !(1..=9).contains(&level) {
            return Err(Refusal::because(format!(
                "there is no block skip {level}: its levels are 1 to 9"
            )));
        }
        self.options.program.block_skip.retain(|skipped| *skipped != level);
        if on {
            self.options.program.block_skip.push(level);
        }
        self.keep_settings()?;
        Ok(Accepted::default())
    }

    /// A program is over: it has ended, was given up, or an alarm has stopped it. What it leaves
    /// stays in force.
    pub(super) fn end_program(&mut self) {
        if self.executor.kernel.report().state == State::Ended {
            self.hear_program(true);
        }
        let Some(under_way) = self.under_way.take() else { return };
        let is_typed = under_way.proved.operations.is_typed();
        let name = under_way.name.clone();
        let report = self.executor.kernel.report();
        let has_ended = report.state == State::Ended;
        let given_up = (!has_ended).then(|| under_way.left_at(report.op));
        self.take_engagement(under_way.running.engaged());
        let mut ended = under_way.running.end();
        self.workpiece = ended.workpiece();
        self.next_op = ended.next_operation();
        if has_ended {
            self.workpiece.judge.settle(self.next_op);
        } else {
            self.workpiece.judge.give_up(report.op);
        }
        let left = ended.left().or(given_up);
        take_left(self, left.unwrap_or_else(|| under_way.proved.operations.left().clone()));
        use_up(&mut self.data.tools, &ended.take_tool_use());
        if !is_typed {
            let cut = count_from(under_way.first, self.workpiece.judge.features());
            self.note_progress(under_way.first, cut, has_ended);
        }
        self.keep_all();
        if !has_ended {
            self.everything_was_stopped();
        }
        let (outcome, unwritten) = ended.finish_beside(&mut self.executor);
        self.keep_record(unwritten.record);
        let told = self.told_loss();
        for why in outcome.broke_off.iter().filter(|why| told.as_ref() != Some(*why)) {
            self.events.notice(why.clone());
        }
        self.keep_workpiece_or_say();
        let UnderWay { path, text, session, proved, first, folder, .. } = under_way;
        if let Some(folder) = folder {
            let name = name.clone();
            let (alarms, seed, trace) = (Vec::new(), self.seed, unwritten.trace);
            let ended = EndedProgram {
                folder,
                trace,
                name,
                path,
                text,
                session,
                proved,
                outcome,
                alarms,
                seed,
            };
            self.ended = Some(ended.alone(first));
        }
        let is_stopped_by_alarm = !self.executor.kernel.faults().is_empty();
        if !is_stopped_by_alarm {
            self.executor.kernel.clear();
        }
        self.is_hold_asked = false;
        let event = if has_ended { ExecutionEvent::End } else { ExecutionEvent::GiveUp };
        self.execution_after(event);
        if !has_ended && !is_stopped_by_alarm {
            self.events.notice(format!("{name} was given up"));
        }
    }
}

/// Whether two paths name the same file, by their names alone: a control waits for no disk.
fn is_same_place(a: &str, b: &str) -> bool {
    let plain = |path: &str| {
        let mut names = std::path::PathBuf::new();
        for name in std::path::absolute(path).unwrap_or_else(|_| path.into()).components() {
            match name {
                std::path::Component::ParentDir => _ = names.pop(),
                name => names.push(name),
            }
        }
        names
    };
    a == b || plain(a) == plain(b)
}

/// The place that was searched, in the texts in which it was found.
fn found_again(fit: &Fit, searched: &Searched) -> Result<Restart, Refusal> {
    if fit.sha256() != searched.sha256 {
        return Err(Refusal::because(format!(
            "a file that {} calls was changed since the place to begin at was found: compare it, then search again",
            fit.name
        )));
    }
    find(fit, searched.from)
}

fn find(fit: &Fit, from: restart::From) -> Result<Restart, Refusal> {
    let Fit { name, text, session, proved, .. } = fit;
    let (start, top) = (session.interp_setup().start, session.machine.tool_change.z);
    let restart =
        restart::find(proved.operations.all(), from, &start, top).map_err(Refusal::because)?;
    let options = session.plan_options(session.machine.setup.stock.material);
    let wrong = wrong_from(session, &proved.operations, options, &restart);
    if !wrong.is_empty() {
        let drawn = session.drawn.clone();
        return Err(Refused::program(name.clone(), text.clone(), drawn, wrong).into());
    }
    Ok(restart)
}

/// What is restored before a program that is begun in its middle makes its first move, a sentence
/// each.
fn restored(session: &Session, restart: &Restart) -> Vec<String> {
    let mut said =
        vec![format!("begins at line {}, {} features are left out", restart.line, restart.holes)];
    said.extend(restart.prelude.iter().filter_map(|op| sentence(session, op)));
    said
}

fn sentence(session: &Session, op: &Op) -> Option<String> {
    Some(match &op.kind {
        OpKind::ChangeTool { number: 0 } => "no tool".into(),
        OpKind::ChangeTool { number } => {
            let tool = session.tools.get(*number)?;
            let length = tool.length.value();
            format!("T{number} {}, length {length:.3} mm", tool.description)
        }
        OpKind::Spindle { spindle, order } => match order {
            SpindleOrder::Turn(spin) => {
                let code = if spin.in_rpm() < 0.0 { "M4" } else { "M3" };
                format!("spindle {spindle}: {code} S{:.0}", spin.in_rpm().abs())
            }
            SpindleOrder::Stop => format!("spindle {spindle}: M5"),
            SpindleOrder::ConstantSurfaceSpeed { speed, .. } => {
                format!("spindle {spindle}: G96, {:.0} m/min", speed.value().abs() * 0.06)
            }
            SpindleOrder::Orient { .. } | SpindleOrder::ThrowChips(_) => return None,
        },
        OpKind::Coolant { mist, flood } => match (mist, flood) {
            (false, false) => "coolant off".into(),
            (true, false) => "coolant: mist".into(),
            (false, true) => "coolant: flood".into(),
            (true, true) => "coolant: mist and flood".into(),
        },
        OpKind::Rapid { to } => format!("rapid to {}", place(session, to)),
        _ => return None,
    })
}

/// A place in machine coordinates.
fn place(session: &Session, to: &Position) -> String {
    let axes = session.machine.axes.iter().flatten();
    let words = axes.map(|axis| {
        format!("{}{}", axis.letter.letter(), axis.letter.reading(to.along(axis.letter)))
    });
    format!("{} of the machine", words.collect::<Vec<_>>().join(" "))
}

/// What was found in a text that is accepted.
fn notes_of(findings: &[Diagnostic]) -> Vec<String> {
    let warnings = findings.iter().filter(|finding| finding.severity != Severity::Error);
    warnings
        .take(MOST_NOTES)
        .map(|finding| format!("line {}: {}", finding.span.line, finding.message))
        .collect()
}
