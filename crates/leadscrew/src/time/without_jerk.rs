//! What the limits of jerk cost: the same program planned without them, in a thread of its own
//! beside the plan that it is run by.
use super::Added;
use canon::{Op, ProgramFrame};
use control::config;
use control::job::{Session, Source, preflight};
use plan::Planner;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};
use units::{CoordinateJerk, Time};

/// Operations go to the thread so many at once, and so many times as many may wait there.
const TOGETHER: usize = 256;
const WAITING: usize = 16;

/// An operation, with its number and how the program is written there.
type Numbered = (u32, Op, ProgramFrame);

/// The same program planned as if no axis had a limit of jerk, beside what it is planned for.
pub struct WithoutJerk {
    batch: Vec<Numbered>,
    planned: PlannedIn,
}

/// Where it is planned.
enum PlannedIn {
    Beside(SyncSender<Vec<Numbered>>, JoinHandle<Time>),
    /// There is no thread to be had.
    Here(Box<FreePlan>),
}

/// A plan without limits of jerk, and its time.
struct FreePlan {
    planner: Planner,
    added: Added,
}

impl FreePlan {
    fn new(session: &mut Session, options: plan::Options) -> Self {
        let limited = session.machine.axes.clone();
        let free = CoordinateJerk::new(f64::INFINITY);
        for axis in session.machine.axes.iter_mut().flatten() {
            (axis.jerk_feed, axis.jerk_rapid) = (free, free);
        }
        let planner = preflight::ahead(session, options);
        let added = Added::new(config::planner(&session.machine));
        session.machine.axes = limited;
        Self { planner, added }
    }

    fn take(&mut self, batch: &[Numbered]) {
        let Self { planner, added } = self;
        for (index, op, frame) in batch {
            planner.written_in(*frame);
            planner.push(*index, op, &mut |step| {
                added.step(&step);
            });
        }
    }

    fn motion(mut self) -> Time {
        let Self { planner, added } = &mut self;
        planner.finish(&mut |step| {
            added.step(&step);
        });
        added.motion()
    }
}

impl WithoutJerk {
    /// `None`: no axis has such a limit.
    pub fn of(session: &mut Session, options: plan::Options) -> Option<Self> {
        let free = CoordinateJerk::new(f64::INFINITY);
        let mut axes = session.machine.axes.iter().flatten();
        if axes.all(|axis| axis.jerk_feed == free && axis.jerk_rapid == free) {
            return None;
        }
        let (tell, told) = sync_channel::<Vec<Numbered>>(WAITING);
        let mut plan = FreePlan::new(session, options);
        let work = move || {
            for batch in told {
                plan.take(&batch);
            }
            plan.motion()
        };
        let thread = Builder::new().name("without-jerk".into()).spawn(work);
        let planned = match thread {
            Ok(thread) => PlannedIn::Beside(tell, thread),
            Err(_) => PlannedIn::Here(Box::new(FreePlan::new(session, options))),
        };
        Some(Self { batch: Vec::new(), planned })
    }

    /// One more operation.
    pub fn op(&mut self, index: u32, op: &Op, frame: ProgramFrame) {
        self.batch.push((index, op.clone(), frame));
        if self.batch.len() >= TOGETHER {
            self.hand_over();
        }
    }

    fn hand_over(&mut self) {
        let batch = std::mem::take(&mut self.batch);
        match &mut self.planned {
            // a thread that has ended before has panicked, which is said when it is joined
            PlannedIn::Beside(tell, _) => _ = tell.send(batch),
            PlannedIn::Here(plan) => plan.take(&batch),
        }
    }

    /// All operations of a program.
    pub fn all(&mut self, source: &mut impl Source) {
        while let Some((index, op)) = source.next() {
            self.op(index, &op, source.frame());
        }
    }

    /// Time in motion, after the last operation.
    pub fn motion(mut self) -> Time {
        self.hand_over();
        match self.planned {
            PlannedIn::Beside(tell, thread) => {
                drop(tell);
                thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            }
            PlannedIn::Here(plan) => plan.motion(),
        }
    }
}
