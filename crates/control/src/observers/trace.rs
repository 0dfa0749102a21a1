//! The trace is written beside the simulation, by a thread of its own.
//!
//! ```text
//!   simulation ──batch of samples──► bounded channel ──► trace thread ──► trace.parquet
//!              ◄──empty batch──────  bounded channel ◄──
//! ```
//!
//! Batches go round: nothing is allocated once the run is under way, and a slow disk makes the
//! simulation wait instead of filling the memory.
use bus::Sample;
use std::{
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    thread::JoinHandle,
};
use store::trace::Writer;

/// Samples in one batch.
const BATCH: usize = 1024;
/// Batches under way.
const BATCHES: usize = 8;

/// The simulation's end.
pub struct TraceThread {
    batch: Vec<Sample>,
    full: SyncSender<Vec<Sample>>,
    empty: Receiver<Vec<Sample>>,
    thread: JoinHandle<Result<(), store::Error>>,
}

impl TraceThread {
    /// Start the thread.
    ///
    /// # Errors
    /// A thread that the operating system does not give.
    pub fn start(mut writer: Writer) -> std::io::Result<Self> {
        let (full, batches) = sync_channel::<Vec<Sample>>(BATCHES);
        let (give_back, empty) = sync_channel(BATCHES + 1);
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
        Ok(Self { batch: Vec::with_capacity(BATCH), full, empty, thread })
    }

    /// Record a servo period. A writer that failed is not fed any more; [`TraceThread::finish`]
    /// says why.
    pub fn push(&mut self, sample: &Sample) {
        self.batch.push(*sample);
        if self.batch.len() == BATCH {
            let next = self.empty.recv().unwrap_or_default();
            let full = std::mem::replace(&mut self.batch, next);
            let _ = self.full.send(full);
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
            Ok(result) => result,
            // a panic of the writer is a defect of ours: let it be seen as one
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}
