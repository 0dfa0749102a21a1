//! The trace is written beside the simulation, by a thread of its own.
//!
//! ```text
//!   simulation ──batch of samples──► bounded channel ──► trace thread ──► trace.parquet
//!              ◄──empty batch──────  bounded channel ◄──
//! ```
//!
//! Batches go round: nothing is allocated once the run is under way, and a slow disk makes the
//! simulation wait instead of filling the memory. A control that stays on waits for no disk: a
//! trace whose disk is [`MOST_BATCHES`] behind is given up.
use bus::Sample;
use std::{
    sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel},
    thread::JoinHandle,
};
use store::trace::Writer;

/// Samples in one batch.
const BATCH: usize = 1024;
/// Batches under way.
const BATCHES: usize = 8;
/// The same before a control that waits for no disk: 16 s at 4 kHz.
const MOST_BATCHES: usize = 64;

/// The simulation's end.
pub struct TraceThread {
    batch: Vec<Sample>,
    full: SyncSender<Vec<Sample>>,
    empty: Receiver<Vec<Sample>>,
    thread: JoinHandle<Result<(), store::Error>>,
    /// Batches that were made.
    made: usize,
    waits: bool,
    is_given_up: bool,
}

impl TraceThread {
    /// Start the thread.
    ///
    /// # Errors
    /// A thread that the operating system does not give.
    pub fn start(writer: Writer) -> std::io::Result<Self> {
        Self::begin(writer, true)
    }

    /// Start the thread, for a control that does not wait for it.
    ///
    /// # Errors
    /// As [`TraceThread::start`].
    pub fn start_beside(writer: Writer) -> std::io::Result<Self> {
        Self::begin(writer, false)
    }

    fn begin(mut writer: Writer, waits: bool) -> std::io::Result<Self> {
        let most = if waits { BATCHES } else { MOST_BATCHES };
        let (full, batches) = sync_channel::<Vec<Sample>>(most);
        let (give_back, empty) = sync_channel(most + 1);
        for _ in 0..BATCHES {
            // the channel has room for all of them: this cannot fail
            let _ = give_back.send(Vec::with_capacity(BATCH));
        }
        let work = move || {
            for mut batch in batches {
                for sample in &batch {
                    writer.push(sample)?;
                }
                batch.clear();
                // the run is over and its end of the channel closed: empty batches are not needed
                let _ = give_back.send(batch);
            }
            writer.finish()
        };
        let thread = std::thread::Builder::new().name("trace".into()).spawn(work)?;
        let batch = Vec::with_capacity(BATCH);
        Ok(Self { batch, full, empty, thread, made: BATCHES, waits, is_given_up: false })
    }

    /// Record a servo period. A writer that failed is not fed any more; [`TraceThread::finish`]
    /// says why.
    pub fn push(&mut self, sample: &Sample) {
        if self.is_given_up {
            return;
        }
        self.batch.push(*sample);
        if self.batch.len() == BATCH {
            let Some(next) = self.next_batch() else {
                self.is_given_up = true;
                return;
            };
            let full = std::mem::replace(&mut self.batch, next);
            let _ = self.full.send(full); // as many as there are find room
        }
    }

    /// An empty batch; `None`: the disk is too far behind.
    fn next_batch(&mut self) -> Option<Vec<Sample>> {
        if self.waits {
            return Some(self.empty.recv().unwrap_or_default());
        }
        match self.empty.try_recv() {
            Ok(batch) => Some(batch),
            // a writer that failed has said why
            Err(TryRecvError::Disconnected) => Some(Vec::new()),
            Err(TryRecvError::Empty) if self.made < MOST_BATCHES => {
                self.made += 1;
                Some(Vec::with_capacity(BATCH))
            }
            Err(TryRecvError::Empty) => None,
        }
    }

    /// Write the rest, close the file, end the thread.
    ///
    /// # Errors
    /// A file that could not be written.
    pub fn finish(self) -> Result<(), store::Error> {
        let _ = self.full.send(self.batch);
        drop(self.full);
        match self.thread.join() {
            Ok(Ok(())) if self.is_given_up => {
                let cause = "the disk is too slow for it".into();
                Err(store::Error::Trace { action: "write", path: "trace.parquet".into(), cause })
            }
            Ok(result) => result,
            // a panic of the writer is a defect of ours: let it be seen as one
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}
