//! Observers where there is time for them: in the thread that feeds the kernel, or beside it, in
//! real time.
//!
//! ```text
//!   run ── operations, samples, events, in their order ──► the observers' thread ──► features as they are judged
//!    └──────────────── at the end: the observers themselves ◄──────┘
//! ```
//!
//! The judge may think for a while about a feature that is finished; what is asked of the control
//! meanwhile does not wait for it.
use super::Observers;
use bus::Sample;
use canon::{Op, ProgramFrame};
use kernel::Event;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;
use verify::Feature;

/// What the observers have not looked at yet: some seconds of samples; then the run waits for them,
/// and the servo thread does not.
const WAITING: usize = 8192;

/// See the module's header.
pub(crate) enum Observing {
    /// In this thread.
    Here(Box<Observers>),
    /// In their own.
    Beside(Beside),
}

/// Observers in a thread of their own.
pub(crate) struct Beside {
    looks: SyncSender<Look>,
    thread: JoinHandle<Option<Box<Observers>>>,
    judged: Receiver<Feature>,
    features: Vec<Feature>,
    breaches: Arc<AtomicUsize>,
    /// The operator's share of the spindle speed, as they know it.
    share: Option<f64>,
}

/// What there is to look at.
enum Look {
    Op(u32, Box<Op>, ProgramFrame),
    Sample(Box<Sample>),
    SpindleOverride(f64),
    Event(Event),
}

/// What the thread tells while it looks.
struct NewFeatures {
    features: Sender<Feature>,
    count: usize,
    breaches: Arc<AtomicUsize>,
}

impl Observing {
    /// In a thread of their own from now on, if there can be one.
    pub(crate) fn begin_beside(&mut self) -> Result<(), String> {
        let Self::Here(observers) = self else { return Ok(()) };
        let (hand_over, handed_over) = channel::<Box<Observers>>();
        let (looks, looked_at) = sync_channel(WAITING);
        let (tell, judged) = channel();
        let breaches = Arc::new(AtomicUsize::new(0));
        let features = observers.judge.features().to_vec();
        let (count, known) = (features.len(), Arc::clone(&breaches));
        let told = NewFeatures { features: tell, count, breaches: known };
        let thread = std::thread::Builder::new().name("observers".into());
        let thread = thread
            .spawn(move || look(handed_over.recv().ok(), &looked_at, told))
            .map_err(|e| format!("cannot start the observers' thread: {e}"))?;
        let beside = Beside { looks, thread, judged, features, breaches, share: None };
        if let Self::Here(observers) = std::mem::replace(self, Self::Beside(beside)) {
            let _ = hand_over.send(observers); // it waits for them
        }
        Ok(())
    }

    /// The observers, when they have looked at all there is.
    pub(crate) fn end(self) -> Box<Observers> {
        let Beside { looks, thread, .. } = match self {
            Self::Here(observers) => return observers,
            Self::Beside(beside) => beside,
        };
        drop(looks); // nothing more comes
        match thread.join() {
            Ok(Some(observers)) => observers,
            Ok(None) => unreachable!("the observers are handed over before anything else is"),
            Err(panicked) => std::panic::resume_unwind(panicked),
        }
    }

    /// In this thread, with all that is asked of them there.
    pub(crate) fn here(&mut self) -> Option<&mut Observers> {
        match self {
            Self::Here(observers) => Some(observers),
            Self::Beside(_) => None,
        }
    }

    /// An operation is planned.
    pub(crate) fn op(&mut self, index: u32, op: &Op, frame: ProgramFrame) {
        match self {
            Self::Here(observers) => observers.op(index, op, frame),
            Self::Beside(beside) => beside.look(Look::Op(index, Box::new(op.clone()), frame)),
        }
    }

    /// What was heard and commanded in a period.
    pub(crate) fn sample(&mut self, sample: &Sample) {
        match self {
            Self::Here(observers) => observers.sample(sample),
            Self::Beside(beside) => beside.look(Look::Sample(Box::new(*sample))),
        }
    }

    /// The operator's share of the spindle speed.
    pub(crate) fn spindle_override(&mut self, share: f64) {
        match self {
            Self::Here(observers) => observers.watch.spindle_override(share),
            Self::Beside(beside) => {
                if beside.share.replace(share) != Some(share) {
                    beside.look(Look::SpindleOverride(share));
                }
            }
        }
    }

    /// What the kernel has said.
    pub(crate) fn event(&mut self, event: &Event) {
        match self {
            Self::Here(observers) => observers.event(event),
            Self::Beside(beside) => beside.look(Look::Event(*event)),
        }
    }

    /// What was cut and judged so far.
    pub(crate) fn features(&self) -> &[Feature] {
        match self {
            Self::Here(observers) => observers.judge.features(),
            Self::Beside(beside) => &beside.features,
        }
    }

    /// How often what may never happen did.
    pub(crate) fn breach_count(&self) -> usize {
        match self {
            Self::Here(observers) => observers.watch.breaches().len(),
            Self::Beside(beside) => beside.breaches.load(Relaxed),
        }
    }
}

impl Beside {
    fn look(&mut self, look: Look) {
        // a thread that has broken down is told of at the end
        let _ = self.looks.send(look);
        self.features.extend(self.judged.try_iter());
    }
}

/// The observers' thread.
fn look(
    observers: Option<Box<Observers>>,
    looks: &Receiver<Look>,
    mut told: NewFeatures,
) -> Option<Box<Observers>> {
    let mut observers = observers?;
    for look in looks {
        match look {
            Look::Op(index, op, frame) => observers.op(index, &op, frame),
            Look::Sample(sample) => observers.sample(&sample),
            Look::SpindleOverride(share) => observers.watch.spindle_override(share),
            Look::Event(event) => observers.event(&event),
        }
        told.tell(&observers);
    }
    Some(observers)
}

impl NewFeatures {
    /// What is new.
    fn tell(&mut self, observers: &Observers) {
        for feature in observers.judge.features().iter().skip(self.count) {
            let _ = self.features.send(feature.clone()); // the run may be over
            self.count += 1;
        }
        self.breaches.store(observers.watch.breaches().len(), Relaxed);
    }
}
