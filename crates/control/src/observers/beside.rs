//! Observers where there is time for them: in the thread that feeds the kernel, or beside it.
//!
//! ```text
//!   run ── operations, samples, events, in their order ──► the observers' thread ──► features as they are judged
//!    └──────── at a stop and at the end: the observers themselves ◄┘
//! ```
//!
//! In real time the judge may take a while for a feature that is finished; what is asked of the
//! control meanwhile does not wait for it. In lock-step, where a second core is idle, a run is
//! shorter by what the observers take. Samples go by the batch then: nothing that the run does
//! depends on when they are seen, so two runs of the same inputs stay bit-identical.
use super::Observers;
use bus::Sample;
use canon::{Op, ProgramFrame, ToolUse};
use kernel::Event;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;
use verify::{Feature, Judge};

/// What the observers have not looked at yet: some seconds of samples; then the run waits for them,
/// and the servo thread does not.
const WAITING: usize = 8192;
/// Samples in a batch, in lock-step.
pub(crate) const BATCH: usize = 64;

/// See the module's header.
pub(crate) enum Observing {
    /// In this thread.
    Here(Box<Observers>),
    /// In their own.
    Beside(Beside),
}

/// Observers in a thread of their own.
pub(crate) struct Beside {
    /// The samples of a batch that is not full.
    samples: Vec<Sample>,
    batch: usize,
    looks: SyncSender<Look>,
    /// Until it has ended.
    thread: Option<JoinHandle<Option<Box<Observers>>>>,
    judged: Receiver<JudgedAt>,
    features: Vec<Feature>,
    /// Places of features whose verdict was changed later, in that order.
    changed: Vec<usize>,
    /// What each tool had cut when the last of them was judged.
    tool_use: ToolUses,
    breaches: Arc<AtomicUsize>,
    /// The operator's share of the spindle speed, as they know it.
    share: Option<f64>,
}

/// What each tool has cut, by its number.
type ToolUses = BTreeMap<u32, ToolUse>;

/// A feature at its place in the list, new or changed, or the end of a list that is sent anew; what
/// each tool had cut by then.
type JudgedAt = (usize, Option<Feature>, ToolUses);

/// What there is to look at.
enum Look {
    Op(u32, Box<Op>, ProgramFrame),
    Samples(Vec<Sample>),
    SpindleOverride(f64),
    Event(Event),
}

/// What the thread tells while it looks.
struct NewFeatures {
    features: Sender<JudgedAt>,
    count: usize,
    /// Changes of verdicts that were sent.
    changes: usize,
    breaches: Arc<AtomicUsize>,
}

impl Observing {
    /// In a thread of their own from now on, if there can be one; they are shown so many samples at
    /// a time.
    pub(crate) fn begin_beside(&mut self, batch: usize) -> Result<(), String> {
        let Self::Here(observers) = self else { return Ok(()) };
        let (hand_over, handed_over) = channel::<Box<Observers>>();
        let (looks, looked_at) = sync_channel(WAITING / batch);
        let (tell, judged) = channel();
        let breaches = Arc::new(AtomicUsize::new(0));
        let features = observers.judge.features().to_vec();
        let tool_use = observers.tool_use();
        let changed = observers.judge.changed_since(0).to_vec();
        let (count, changes) = (features.len(), changed.len());
        let known = Arc::clone(&breaches);
        let told = NewFeatures { features: tell, count, changes, breaches: known };
        let thread = std::thread::Builder::new().name("observers".into());
        let thread = thread
            .spawn(move || look(handed_over.recv().ok(), &looked_at, told))
            .map_err(|e| format!("cannot start the observers' thread: {e}"))?;
        let (samples, thread) = (Vec::with_capacity(batch), Some(thread));
        let beside = Beside {
            samples,
            batch,
            looks,
            thread,
            judged,
            features,
            changed,
            tool_use,
            breaches,
            share: None,
        };
        if let Self::Here(observers) = std::mem::replace(self, Self::Beside(beside)) {
            let _ = hand_over.send(observers); // it waits for them
        }
        Ok(())
    }

    /// In this thread from now on, when they have looked at all there is.
    pub(crate) fn come_back(&mut self) {
        if let Self::Beside(beside) = self {
            let observers = beside.end();
            *self = Self::Here(observers);
        }
    }

    /// The observers, when they have looked at all there is.
    pub(crate) fn end(self) -> Box<Observers> {
        match self {
            Self::Here(observers) => observers,
            Self::Beside(mut beside) => beside.end(),
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
            Self::Beside(beside) => {
                beside.samples.push(*sample);
                if beside.samples.len() >= beside.batch {
                    beside.show();
                }
            }
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

    /// Places of features whose verdict was changed after they were judged: those of the changes
    /// from this one on.
    pub(crate) fn changed_since(&self, change: usize) -> &[usize] {
        match self {
            Self::Here(observers) => observers.judge.changed_since(change),
            Self::Beside(beside) => beside.changed.get(change..).unwrap_or_default(),
        }
    }

    /// What each tool had cut when the last feature was judged, or since.
    pub(crate) fn tool_use(&self) -> ToolUses {
        match self {
            Self::Here(observers) => observers.tool_use(),
            Self::Beside(beside) => beside.tool_use.clone(),
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
    /// The observers, when they have looked at all there is; the thread has ended.
    fn end(&mut self) -> Box<Observers> {
        self.show();
        self.looks = sync_channel(0).0; // nothing more comes
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(Some(observers))) => observers,
            Some(Ok(None)) => {
                unreachable!("the observers are handed over before anything else is")
            }
            Some(Err(panicked)) => std::panic::resume_unwind(panicked),
            None => unreachable!("a thread that has ended is beside nothing any more"),
        }
    }

    fn look(&mut self, look: Look) {
        self.show();
        self.send(look);
    }

    /// The samples that were not shown yet.
    fn show(&mut self) {
        if !self.samples.is_empty() {
            let next = Vec::with_capacity(self.batch);
            let samples = std::mem::replace(&mut self.samples, next);
            self.send(Look::Samples(samples));
        }
    }

    fn send(&mut self, look: Look) {
        // a thread that has broken down is told of at the end
        let _ = self.looks.send(look);
        for (place, feature, tool_use) in self.judged.try_iter() {
            match (feature, self.features.get_mut(place)) {
                (Some(feature), Some(known)) => {
                    *known = feature;
                    self.changed.push(place);
                }
                (Some(feature), None) => self.features.push(feature),
                (None, _) => {
                    self.features.clear();
                    self.changed.push(Judge::REMOVED);
                }
            }
            self.tool_use = tool_use;
        }
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
            Look::Samples(samples) => samples.iter().for_each(|sample| observers.sample(sample)),
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
        let judged = observers.judge.features();
        let send = |place: usize| {
            let feature = judged.get(place).cloned();
            let _ = self.features.send((place, feature, observers.tool_use())); // the run may be over
        };
        let changed = observers.judge.changed_since(self.changes);
        let (removed, changed): (Vec<usize>, Vec<usize>) =
            changed.iter().partition(|place| **place == Judge::REMOVED);
        if !removed.is_empty() {
            self.count = 0;
            self.changes += removed.len();
            removed.into_iter().for_each(send);
        }
        (self.count..judged.len()).for_each(send);
        self.count = judged.len();
        self.changes += changed.len();
        changed.into_iter().for_each(send);
        self.breaches.store(observers.watch.breaches().len(), Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::{ProgramOptions, Session};
    use crate::observers::{Observer, Workpiece};
    use canon::OpKind;
    use kernel::EventKind;
    use std::path::Path;
    use std::sync::Mutex;
    use units::Time;

    type Seen = Arc<Mutex<Vec<String>>>;

    struct Log(Seen);

    impl Observer for Log {
        fn sample(&mut self, sample: &Sample) {
            self.0.lock().unwrap().push(format!("{}", sample.feedback.time.value()));
        }
        fn event(&mut self, event: &Event) {
            self.0.lock().unwrap().push(format!("event of line {}", event.line));
        }
        fn message(&mut self, line: u32, text: &str) {
            self.0.lock().unwrap().push(format!("line {line}: {text}"));
        }
    }

    /// Observers in this thread, and what they have seen.
    fn observing() -> (Observing, Seen) {
        let options = ProgramOptions::on("tapping-center");
        let session = Session::load(&options, Path::new("p.ngc"), b"M2\n").unwrap();
        let material = store::machine::StockMaterial::named("C45").unwrap();
        let workpiece = Workpiece::new(session.judge(material, &session.work_zero()));
        let (mut observers, seen) = (Observers::new(&session, workpiece), Seen::default());
        observers.others.push(Box::new(Log(Arc::clone(&seen))));
        (Observing::Here(Box::new(observers)), seen)
    }

    /// These periods, with an event in some of them and an operation in others.
    fn show(observing: &mut Observing, periods: std::ops::Range<u32>) {
        for n in periods {
            let mut sample = Sample::default();
            sample.feedback.time = Time::s(f64::from(n));
            observing.sample(&sample);
            if n % 50 == 7 {
                let (time, kind) = (sample.feedback.time, EventKind::DrivesReady);
                observing.event(&Event { time, op: 0, line: n, kind });
            }
            if n % 70 == 9 {
                let kind = OpKind::Message(format!("at {n}").into());
                observing.op(
                    n,
                    &Op { span: canon::Span::default(), kind },
                    ProgramFrame::default(),
                );
            }
        }
    }

    #[test]
    fn beside_the_run_they_see_the_same_in_the_same_order_also_when_they_come_back_in_between() {
        let ((mut here, expected), (mut beside, seen)) = (observing(), observing());
        show(&mut here, 0..1000);
        beside.begin_beside(BATCH).unwrap();
        show(&mut beside, 0..333);
        beside.come_back();
        assert!(beside.here().is_some());
        show(&mut beside, 333..400);
        beside.begin_beside(BATCH).unwrap();
        assert!(beside.here().is_none());
        show(&mut beside, 400..1000);
        here.end();
        beside.end();
        let expected = expected.lock().unwrap();
        assert_eq!(expected.len(), 1000 + 20 + 15);
        assert_eq!(*seen.lock().unwrap(), *expected);
    }
}
