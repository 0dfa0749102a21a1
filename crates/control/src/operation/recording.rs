//! What is cut is judged and told, and programs are recorded, each in a folder of its own.
use super::control::Control;
use super::ended::EndedProgram;
use super::event::Event;
use crate::clock::unix_ms;
use crate::job::Session;
use crate::observers::TraceThread;
use crate::{Running, config};
use report::Recorder;
use std::path::{Path, PathBuf};
use store::begun_run::BegunRun;
use store::output::Folder;
use store::trace::{Columns, Writer};
use verify::Feature;

/// The trace of a run, in its folder.
const TRACE: &str = "trace.parquet";

impl Control {
    /// What a program has left half cut is judged when its tool is out.
    pub(super) fn settle(&mut self) {
        let is_over = self.executor.kernel.is_standing() && !self.is_recovering;
        if !self.workpiece.judge.is_settled() && is_over && !self.is_tap_in_thread() {
            self.workpiece.judge.settle(self.next_op);
        }
        self.take_back_features();
        self.tell_changed();
        let judged = self.workpiece.judge.features();
        let new = judged.get(self.told_features..).unwrap_or_default().to_vec();
        self.told_features = judged.len();
        if !new.is_empty() {
            self.tell_features(new);
            self.keep_workpiece_or_say();
        }
    }

    /// Features that were judged just now are told, and in the log.
    pub(super) fn tell_features(&mut self, new: Vec<Feature>) {
        for feature in new {
            self.keep_feature(&feature);
            self.events.push(Event::Feature(Box::new(feature)));
        }
    }

    /// From now on record each program, with every period, in a folder of its own below this one.
    pub fn record_programs(&mut self, folder: PathBuf) {
        self.runs = Some(folder);
    }

    /// The program that has ended since the last time, if it was recorded.
    pub fn take_ended(&mut self) -> Option<EndedProgram> {
        self.ended.take()
    }

    /// Begin to record a program; that it cannot be is said, and the program runs all the same.
    pub(super) fn begin_record(
        &mut self,
        session: &Session,
        (name, text): (&str, &[u8]),
        running: &mut Running,
    ) -> Option<Folder> {
        let begun =
            self.runs.as_deref().map(|runs| begin(runs, session, (name, text), self.seed))?;
        match begun {
            Ok((folder, trace)) => {
                running.record(recorder(session), trace);
                Some(folder)
            }
            Err(why) => {
                self.events.notice(format!("this run is not recorded: {why}"));
                None
            }
        }
    }
}

fn recorder(session: &Session) -> Recorder {
    Recorder::new(&session.tools).limited(config::path_limits(&session.machine))
}

/// A folder with the moment as its name, and the thread that writes the trace into it.
fn begin(
    runs: &Path,
    session: &Session,
    (name, text): (&str, &[u8]),
    seed: u64,
) -> Result<(Folder, TraceThread), String> {
    let begun_unix_ms = unix_ms();
    let folder = Folder::begin(&runs.join(begun_unix_ms.to_string())).map_err(|e| e.to_string())?;
    let program_sha256 = store::certificate::sha256(text);
    let begun = BegunRun { program: name.to_owned(), program_sha256, begun_unix_ms };
    begun.write(&folder.path("")).map_err(|e| e.to_string())?;
    let seed = seed.to_string();
    let about = [
        ("leadscrew", env!("CARGO_PKG_VERSION")),
        ("program", name),
        ("machine", session.machine.name.as_str()),
        ("seed", seed.as_str()),
    ];
    let columns = Columns::of(&session.machine);
    let writer = Writer::create(&folder.path(TRACE), columns, &about).map_err(|e| e.to_string())?;
    let trace =
        TraceThread::start_beside(writer).map_err(|e| format!("no thread for the trace: {e}"))?;
    Ok((folder, trace))
}
