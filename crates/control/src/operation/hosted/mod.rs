//! A control in a thread of its own, paced by the clock: what a panel, a terminal and a server
//! share.
//!
//! ```text
//!   clients ──request──► bounded channel ──► control's thread: Control::begin, periods by the clock
//!           ──stop─────► a flag that the next servo period reads, and a place before the channel
//!      ▲                                          │ 50 times a second        │ each period
//!      │                                          ▼                          ▼
//!      ├── latest() ◄─────────────────────── Picture (latest wins)     Recording of signals
//!      ├── events_after(id) ◄─────────────── ring of events                  │
//!      └── rows_from(row) ◄──── ring of rows ◄──────────────────┘
//! ```
//!
//! A text that a request needs is proved in a thread beside it, while the control goes on. A client
//! takes what it wants, when it wants: the thread keeps one picture and two rings, whose sizes are
//! fixed, and knows no client. So a client that is slow, or gone, costs it nothing; what the client
//! has missed is counted when it asks again.
mod journal;
mod lead;
mod loads;
mod panel;
mod picture;
mod recording;
mod refusal;
mod renewal;
mod stops;
mod timing;

pub use journal::{Journal, Journaled, MOST_EVENTS};
pub use picture::{Picture, WorkOffset};
use recording::Recording;
pub use recording::SignalRows;
pub use refusal::{FindingData, RefusalData, RefusalKind};

use super::control::{Control, ControlOptions};
use super::ended::EndedProgram;
use super::event::Event;
use super::request::{Accepted, Request};
use super::signals::Signals;
use crate::Refused;
use crate::job::Interruption;
use lead::{Job, WaitingRequest};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use stops::Stops;
use store::machine::MachineFile;
use units::Time;

/// Requests that wait for the control; one more is refused.
const MOST_JOBS: usize = 64;

/// What a request is answered.
pub type RequestAnswer = Result<Accepted, RefusalData>;

/// How a control is hosted.
pub struct HostOptions {
    /// Machine time that passes in a second on the wall: 1, but in tests.
    pub pace: f64,
    /// Called in the control's thread after each picture; it must not wait.
    pub published: Box<dyn FnMut() + Send>,
    /// Each program is recorded.
    pub recording: Option<ProgramRecording>,
    /// Called in the thread that writes what is kept, before each write.
    pub before_write: Box<dyn FnMut() + Send>,
}

/// Programs are recorded in folders below one.
pub struct ProgramRecording {
    /// That one.
    pub folder: PathBuf,
    /// Called in the control's thread when a program is over; it must not wait. An error is said to
    /// the operator.
    pub ended: EndedTaken,
}

/// Takes programs that are over.
pub type EndedTaken = Box<dyn FnMut(EndedProgram) -> Result<(), String> + Send>;

impl Default for HostOptions {
    fn default() -> Self {
        let (published, before_write) = (Box::new(|| ()), Box::new(|| ()));
        Self { pace: 1.0, published, recording: None, before_write }
    }
}

/// What the control's thread and its clients share.
struct Shared {
    picture: Mutex<Arc<Picture>>,
    journal: Mutex<Journal>,
    recording: Recording,
    machine: MachineFile,
    signals: Signals,
    stops: Stops,
    /// [`Client::panel_count`].
    panel_count: AtomicU64,
}

/// A control in a thread; when it is dropped the control comes to rest and is switched off.
pub struct Hosted {
    client: Client,
    thread: Option<JoinHandle<()>>,
}

/// One of those who lead or watch it; cheap to copy.
#[derive(Clone)]
pub struct Client {
    jobs: SyncSender<Job>,
    shared: Arc<Shared>,
}

impl Hosted {
    /// Switch a control on in a thread of its own.
    ///
    /// # Errors
    /// The control's, or no thread can be started.
    pub fn start(options: ControlOptions, host: HostOptions) -> Result<Self, Refused> {
        let (jobs, asked) = sync_channel(MOST_JOBS);
        let (up, is_up) = channel();
        let thread = std::thread::Builder::new().name("control".into());
        let back = jobs.clone();
        let thread = thread.spawn(move || lead::run(options, host, &up, back, &asked));
        let thread = thread.map_err(|e| Refused::because(format!("cannot start a thread: {e}")))?;
        let shared = is_up.recv().map_err(|_| Refused::because("the control has ended"))??;
        Ok(Self { client: Client { jobs, shared }, thread: Some(thread) })
    }

    /// A client of it.
    pub fn client(&self) -> Client {
        self.client.clone()
    }
}

impl Drop for Hosted {
    fn drop(&mut self) {
        if self.client.jobs.send(Job::End).is_ok()
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join(); // a thread that has panicked has said so
        }
    }
}

impl Client {
    /// How often a panel beside the machine has begun or changed something: who presses its keys
    /// commands the machine.
    pub fn panel_count(&self) -> u64 {
        self.shared.panel_count.load(Ordering::Acquire)
    }

    /// Ask for something and go on; the answer is handed to `answer` in a thread of the control's,
    /// which must not wait there. A stop waits behind nothing: it acts from the next servo period
    /// on.
    ///
    /// # Errors
    /// Too much waits for the control already, or it has ended: `answer` is not called.
    pub fn ask(
        &self,
        request: Request,
        answer: impl FnOnce(RequestAnswer) + Send + 'static,
    ) -> Result<(), RefusalData> {
        self.ask_unless(Interruption::default(), request, answer)
    }

    /// The same; what has to be read for it is broken off when who asked is gone.
    ///
    /// # Errors
    /// As [`Self::ask`].
    pub fn ask_unless(
        &self,
        is_gone: Interruption,
        request: Request,
        answer: impl FnOnce(RequestAnswer) + Send + 'static,
    ) -> Result<(), RefusalData> {
        if let Some(stop) = stops::kind(&request) {
            return self.shared.stops.ask(stop, Box::new(answer));
        }
        let after = self.shared.stops.mark();
        let asked = WaitingRequest { request, is_gone, after, answer: Box::new(answer) };
        self.jobs.try_send(Job::Request(asked)).map_err(|error| match error {
            TrySendError::Full(_) => RefusalData::busy(MOST_JOBS),
            TrySendError::Disconnected(_) => RefusalData::ended(),
        })
    }

    /// Ask for something and wait for the answer.
    ///
    /// # Errors
    /// Why it was refused.
    pub fn request(&self, request: Request) -> RequestAnswer {
        let (sender, receiver): (_, Receiver<RequestAnswer>) = channel();
        self.ask(request, move |answer| {
            let _ = sender.send(answer); // who asked is gone
        })?;
        receiver.recv().unwrap_or_else(|_| Err(RefusalData::ended()))
    }

    /// For a front end in the same process: something short that is done in the control's thread,
    /// and what comes of it; `None`: the control has ended.
    pub fn with<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut Control) -> T + Send + 'static,
    ) -> Option<T> {
        let (sender, receiver) = channel();
        let work = move |control: &mut Control| {
            let _ = sender.send(work(control)); // who asked is gone
        };
        self.jobs.send(Job::Work(Box::new(work))).ok()?;
        receiver.recv().ok()
    }

    /// How the control was a moment ago.
    pub fn latest(&self) -> Arc<Picture> {
        Arc::clone(&held(&self.shared.picture))
    }

    /// What has happened after an event, oldest first; how many are no longer kept; the last one
    /// that there is.
    pub fn events_after(&self, id: u64) -> (Vec<Journaled>, u64, u64) {
        held(&self.shared.journal).after(id)
    }

    /// Something that who leads or watches the control should know, said by what works beside it.
    pub fn notice(&self, text: impl Into<String>) {
        let time = Time::s(self.latest().status.time_s);
        held(&self.shared.journal).push(time, Event::Notice(text.into()));
    }

    /// Record signals, as long as the answer is kept.
    pub fn record(&self) -> Recorded {
        self.shared.recording.join();
        Recorded(Arc::clone(&self.shared))
    }

    /// The machine's file.
    pub fn machine(&self) -> &MachineFile {
        &self.shared.machine
    }

    /// The signals, in the order of a row.
    pub fn signals(&self) -> &Signals {
        &self.shared.signals
    }
}

/// Signals that are recorded for a client.
pub struct Recorded(Arc<Shared>);

impl Recorded {
    /// Rows from this one on, in blocks, as far as they are still kept; oldest first.
    pub fn rows_from(&self, row: u64) -> Vec<Arc<SignalRows>> {
        self.0.recording.rows_from(row)
    }
}

impl Drop for Recorded {
    fn drop(&mut self) {
        self.0.recording.leave();
    }
}

/// A lock is only ever held to copy a few values: what a thread that has panicked leaves is whole.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
