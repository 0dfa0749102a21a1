//! The thread that writes all that a control keeps.
//!
//! ```text
//!   control ──write──► a place a datum: the newest wins │ a queue of alarms ──► thread: write, fsync
//!      ▲                                                                           │
//!      ├── failed: said as notices ◄───────────────────────────────────────────────┤
//!   clients ◄── answers of requests that change what is kept ◄─────────────────────┘
//! ```
//!
//! However slow the disk is, what waits is bounded: of a datum that changes ten times meanwhile the
//! last version is written, and of alarms the last [`MOST_WAITING`]. What is written together is on
//! the disk together: one commit of the state folder.
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use store::state::StateFolder;

/// Alarms, and messages, that wait to be written; then the oldest is left out.
const MOST_WAITING: usize = 256;

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    Parameters,
    Tools,
    Settings,
    Program,
    Workpiece,
    Homing,
    /// Where the tools are, and how far a tool change is.
    Changer,
    /// That the operator has seen what differs.
    Acknowledgement,
    /// Each alarm is written.
    Alarm,
    /// Each message of a program, too.
    Message,
    /// That a tool is out, in the sync record; and the end of a program's record.
    Record,
}

impl Key {
    /// It is on the disk with a commit of the state folder.
    const fn is_of_state(self) -> bool {
        !matches!(self, Self::Message | Self::Record)
    }
}

/// Something that was to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ticket {
    number: u64,
    key: Key,
}

/// Writes something; why it could not, in a sentence.
pub(super) type Write = Box<dyn FnOnce(&mut StateFolder) -> Result<(), String> + Send>;
type Then = Box<dyn FnOnce(Result<(), String>) + Send>;

/// See the module's header; dropped, it writes what waits.
pub(super) struct StateWriter {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<WaitingWrites>,
    /// Something is to be written, or it is over.
    work: Condvar,
    /// Something was written.
    done: Condvar,
}

#[derive(Default)]
struct WaitingWrites {
    writes: VecDeque<(Ticket, Write)>,
    /// Numbers of the last ticket, and of the last one that was dealt with.
    last: Option<Ticket>,
    done: u64,
    /// What is being written.
    in_hand: Vec<Key>,
    /// What could not be written, with its ticket.
    failed: Vec<(Ticket, String)>,
    /// Alarms and messages that were left out.
    left_out: usize,
    then: Vec<(Ticket, Then)>,
    before: Option<Box<dyn FnMut() + Send>>,
    is_over: bool,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, WaitingWrites> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl StateWriter {
    pub(super) fn start(folder: StateFolder) -> std::io::Result<Self> {
        let shared = Arc::<Shared>::default();
        let own = Arc::clone(&shared);
        let thread = std::thread::Builder::new().name("keeping".into());
        let thread = thread.spawn(move || run(&own, folder))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Called in the thread before each write.
    pub(super) fn call_before(&self, before: Box<dyn FnMut() + Send>) {
        self.shared.lock().before = Some(before);
    }

    /// Write this, instead of what waits to be written of the same datum.
    pub(super) fn write(&mut self, key: Key, write: Write) -> Ticket {
        let mut state = self.shared.lock();
        let number = state.last.map_or(0, |last| last.number) + 1;
        let ticket = Ticket { number, key };
        match key {
            Key::Alarm | Key::Message => {
                let of_kind = |(ticket, _): &&(Ticket, Write)| ticket.key == key;
                if state.writes.iter().filter(of_kind).count() >= MOST_WAITING
                    && let Some(at) = state.writes.iter().position(|(t, _)| t.key == key)
                {
                    state.writes.remove(at);
                    state.left_out += 1;
                }
            }
            Key::Record => {}
            _ => state.writes.retain(|(ticket, _)| ticket.key != key),
        }
        state.writes.push_back((ticket, write));
        state.last = Some(ticket);
        self.shared.work.notify_one();
        ticket
    }

    /// Wait until a ticket is dealt with; why it is not on the disk, if it is not.
    pub(super) fn wait_for(&mut self, ticket: &Ticket) -> Result<(), String> {
        let mut state = self.shared.lock();
        while state.done < ticket.number {
            state = self.shared.done.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let result = state.result_of(*ticket);
        state.failed.clear();
        result
    }

    /// What was to be written last.
    pub(super) fn last(&self) -> Option<Ticket> {
        self.shared.lock().last
    }

    /// Something of this kind is not on the disk yet.
    pub(super) fn is_writing(&self, key: Key) -> bool {
        let state = self.shared.lock();
        state.in_hand.contains(&key) || state.writes.iter().any(|(ticket, _)| ticket.key == key)
    }

    /// Call this when a ticket is dealt with, in the thread that writes.
    pub(super) fn when_written(&self, ticket: Ticket, then: Then) {
        let mut state = self.shared.lock();
        if state.done < ticket.number {
            state.then.push((ticket, then));
        } else {
            let result = state.result_of(ticket);
            drop(state);
            then(result);
        }
    }

    /// What could not be written, in sentences.
    pub(super) fn take_failed(&mut self) -> Vec<String> {
        let mut state = self.shared.lock();
        if state.failed.is_empty() && state.left_out == 0 {
            return Vec::new();
        }
        let failed = state.failed.drain(..);
        let mut said: Vec<_> = failed.map(|(_, why)| why).collect();
        let left_out = std::mem::take(&mut state.left_out);
        if left_out > 0 {
            said.push(format!("{left_out} alarms or messages are not kept: the disk is too slow"));
        }
        said.dedup();
        said
    }
}

impl Drop for StateWriter {
    fn drop(&mut self) {
        self.shared.lock().is_over = true;
        self.shared.work.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // a thread that has panicked has said so
        }
    }
}

impl WaitingWrites {
    /// A later version of the same datum stands for it.
    fn result_of(&self, ticket: Ticket) -> Result<(), String> {
        let failed = self.failed.iter().find(|(failed, _)| failed.key == ticket.key);
        failed.map_or(Ok(()), |(_, why)| Err(why.clone()))
    }
}

/// The thread: what waits is written together, and then those are called who wait for it.
fn run(shared: &Shared, mut folder: StateFolder) {
    loop {
        let mut state = shared.lock();
        while state.writes.is_empty() && !state.is_over {
            state = shared.work.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if state.writes.is_empty() {
            return;
        }
        let writes = std::mem::take(&mut state.writes);
        let up_to = state.last.map_or(0, |last| last.number);
        state.in_hand = writes.iter().map(|(ticket, _)| ticket.key).collect();
        let mut before = state.before.take();
        drop(state);
        let mut failed = Vec::new();
        let tickets: Vec<Ticket> = writes.iter().map(|(ticket, _)| *ticket).collect();
        folder.begin_batch();
        for (ticket, write) in writes {
            if let Some(before) = &mut before {
                before();
            }
            if let Err(why) = write(&mut folder) {
                failed.push((ticket, why));
            }
        }
        if let Err(why) = folder.commit() {
            let of_state = tickets.into_iter().filter(|ticket| ticket.key.is_of_state());
            failed.extend(of_state.map(|ticket| (ticket, format!("it cannot be kept: {why}"))));
        }
        let mut state = shared.lock();
        state.before = state.before.take().or(before);
        state.failed.append(&mut failed);
        state.done = up_to;
        state.in_hand.clear();
        let (due, later) = state.then.drain(..).partition(|(t, _)| t.number <= up_to);
        state.then = later;
        let due: Vec<(Ticket, Then)> = due;
        let due: Vec<_> = due.into_iter().map(|(t, then)| (state.result_of(t), then)).collect();
        drop(state);
        shared.done.notify_all();
        for (result, then) in due {
            then(result);
        }
    }
}
