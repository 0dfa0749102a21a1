//! Programs that have ended become runs of the history: certificate, report and what the list says,
//! written in a thread of its own, so that neither the control nor a client waits for them.
//!
//! ```text
//!   control's thread ──EndedProgram──► bounded queue ──► thread "runs": Finished ─► report.html, certificate.json, run.json
//! ```
use super::{CERTIFICATE, REPORT, RUN, Runs, TRACE};
use crate::wire::{AlarmBody, FeatureBody, RunBody, RunDetailBody};
use control::clock::unix_ms;
use control::operation::EndedProgram;
use control::operation::hosted::{Client, ProgramRecording};
use control::run_last;
use leadscrew::Finished;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use store::certificate::Verdict;
use store::output::Folder;

/// Programs that wait to be written; one more is not kept, and that is said.
const MOST_WAITING: usize = 8;

/// The thread that writes; when it is dropped it has written what it was given.
pub(crate) struct Recorder {
    thread: Option<JoinHandle<()>>,
    told: ToldClient,
}

/// Who is told what the disk has not taken; the control starts after the thread that writes.
type ToldClient = Arc<OnceLock<Client>>;

impl Recorder {
    /// Start it, if anything is to be kept. `shown` makes of a program's path what clients see of
    /// it.
    ///
    /// # Errors
    /// The system gives no thread.
    pub(crate) fn start(
        runs: &Runs,
        shown: impl Fn(&str) -> String + Send + 'static,
    ) -> Result<(Self, Option<ProgramRecording>), String> {
        let told = ToldClient::default();
        let Some(folder) = runs.folder() else { return Ok((Self { thread: None, told }, None)) };
        let (sender, receiver) = sync_channel(MOST_WAITING);
        let own = runs.clone();
        let thread = std::thread::Builder::new().name("runs".into());
        let tells = Arc::clone(&told);
        let thread = thread.spawn(move || write_all(&own, &shown, &tells, &receiver));
        let thread = thread.map_err(|e| format!("cannot start a thread: {e}"))?;
        let ended = Box::new(move |ended| give(&sender, ended));
        let recording = ProgramRecording { folder: folder.to_owned(), ended };
        Ok((Self { thread: Some(thread), told }, Some(recording)))
    }

    /// From now on this control's clients are told what is not kept, and why.
    pub(crate) fn tell(&self, client: Client) {
        let _ = self.told.set(client); // it is told of one control
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // a thread that has panicked has said so
        }
    }
}

fn give(sender: &SyncSender<EndedProgram>, ended: EndedProgram) -> Result<(), String> {
    sender.try_send(ended).map_err(|error| match error {
        TrySendError::Full(_) => format!("{MOST_WAITING} wait to be written already"),
        TrySendError::Disconnected(_) => "nothing writes it any more".into(),
    })
}

fn write_all(
    runs: &Runs,
    shown: &dyn Fn(&str) -> String,
    told: &OnceLock<Client>,
    ended: &Receiver<EndedProgram>,
) {
    run_last();
    for mut program in ended {
        program.name = shown(&program.name);
        let name = program.name.clone();
        // the disk is full or gone: the folder vanishes, and the next one is tried
        if let Err(why) = write(program)
            && let Some(client) = told.get()
        {
            client.notice(format!("the run of {name} is not kept: {why}"));
        }
        runs.make_room();
    }
}

fn write(mut ended: EndedProgram) -> Result<(), String> {
    if let Some(trace) = ended.trace.take() {
        trace.finish().map_err(|e| e.to_string())?;
    }
    let alarms = ended.alarms.iter();
    let alarms: Vec<_> = alarms.map(|alarm| AlarmBody::of(alarm, &str::to_owned)).collect();
    let (mut finished, folder) = Finished::of_control(ended);
    let page = finished.report();
    folder.write(REPORT, page.as_bytes()).map_err(|e| e.to_string())?;
    let certificate = finished.certificate();
    folder.write(CERTIFICATE, certificate.to_json().as_bytes()).map_err(|e| e.to_string())?;
    let (id, bytes) = about(&folder);
    let run = RunBody {
        id,
        program: certificate.program.clone(),
        program_sha256: certificate.inputs.program_sha256.clone(),
        ended_unix_ms: unix_ms(),
        cycle_time_s: finished.outcome.cycle_time.value(),
        has_ended: certificate.ended,
        was_cut_off: false,
        verdict: match certificate.verdict {
            Verdict::Pass => "good",
            Verdict::Fail => "failed",
            Verdict::NotJudged => "not_judged",
        }
        .to_owned(),
        good: certificate.count.passed,
        failed: certificate.count.failed,
        not_judged: certificate.count.not_judged,
        alarms: alarms.len(),
        has_trace: folder.path(TRACE).exists(),
        bytes,
    };
    let features = finished.features().iter().map(FeatureBody::of).collect();
    let detail = RunDetailBody { run, features, alarms };
    let text = serde_json::to_vec(&detail).map_err(|e| e.to_string())?;
    folder.write(RUN, &text).map_err(|e| e.to_string())?;
    for name in store::begun_run::FILES {
        let _ = std::fs::remove_file(folder.path(name)); // it is in the way of nothing
    }
    folder.finish().map_err(|e| e.to_string())?;
    Ok(())
}

/// The run's id, which is the name that its folder will have, and its bytes so far.
fn about(folder: &Folder) -> (String, u64) {
    let name = folder.destination().file_name().unwrap_or_default();
    let made = folder.path(REPORT);
    let bytes = made.parent().map_or(0, super::size_of);
    (name.to_string_lossy().into_owned(), bytes)
}
