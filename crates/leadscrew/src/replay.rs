//! What the part of a program before the line or hole at which it is begun has left in the work:
//! simulated, without moving the machine that is controlled.
//!
//! ```text
//!   operations before ─► a machine of the same seed, and a judge ─► holes, threads, turned bar, ground blanks
//!                                                                     ├─► the simulated machine of the run
//!                                                                     └─► the judge of the run
//! ```
//!
//! What is left out in fact was cut before, by the same program: so the whole of it is simulated,
//! not its nominal form. Features of that part are no features of the run.
use crate::link;
use crate::program::Job;
use control::drives::simulated;
use control::{Loaded, ProgramRun, Refused};
use kernel::Kernel;
use sim::SimulatedMachine;
use std::sync::Arc;
use units::Time;

/// The work before the run begins.
pub(crate) struct Replay {
    /// The machine that has cut it.
    pub(crate) machine: SimulatedMachine,
    /// What the judge has seen of it.
    pub(crate) work: verify::Work,
    /// The alarm that ended the simulation before its end.
    pub(crate) alarm: Option<String>,
}

/// What a part of a program is replayed with.
pub(crate) struct With<'a> {
    /// What is judged by.
    pub(crate) judge: &'a verify::Config,
    /// The kernel of the run.
    pub(crate) kernel: Kernel,
    /// Seed of the machine.
    pub(crate) seed: u64,
    /// Asked every period: whether it is to end at once.
    pub(crate) is_interrupted: fn() -> bool,
}

/// Servo periods between two looks of the progress bar.
const PROGRESS_EVERY: u64 = 4096;

impl Replay {
    /// The first `skip` operations of a job.
    ///
    /// # Errors
    /// The machine cannot be simulated.
    pub(crate) fn of(
        job: &Job,
        skip: usize,
        with: With<'_>,
        progress: &mut dyn FnMut(Time),
    ) -> Result<Self, Refused> {
        let session = &job.session;
        let machine = simulated::drives(link::simulated(job, with.seed)?, with.seed);
        let operations = Arc::new(job.operations().that_cut_before(skip));
        let planned = job.proved.as_ref().and_then(|proved| proved.known.planned);
        let loaded =
            Loaded { session, operations: &operations, restart: None, options: job.plan, planned };
        let mut run = ProgramRun::new(&loaded, machine, with.judge.clone());
        run.executor.kernel = with.kernel.into();
        let (mut running, mut executor) = run.begin();
        let mut periods = 0_u64;
        while !(with.is_interrupted)() && running.period(&mut executor).is_continue() {
            periods += 1;
            if periods.is_multiple_of(PROGRESS_EVERY) {
                progress(running.now());
            }
        }
        let ended = running.end();
        let work = ended.work();
        let outcome = ended.finish(&mut executor)?;
        let alarm = outcome.faults.first().map(ToString::to_string);
        let alarm = alarm.or_else(|| outcome.broke_off.into_iter().next());
        let ended = executor.into_machine();
        match ended.as_ref().and_then(|drives| drives.simulation()) {
            Some(simulated) => Ok(Self { machine: simulated.machine().clone(), work, alarm }),
            None => Err(Refused::because("a replay runs within this process")),
        }
    }
}
