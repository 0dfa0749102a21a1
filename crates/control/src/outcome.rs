//! What is known of a run when it is over.
use crate::job::Left;
use crate::observers::{ToolUseCount, TraceThread, Workpiece};
use crate::services::supervision::SupervisedStroke;
use crate::services::{CamHost, RecordWriter};
use crate::{Executor, Feeder, Observers, RealTimeFigures, Services, TickTimes, Timings};
use bus::State;
use canon::ToolUse;
use kernel::{Event, Fault};
use report::Recorder;
use std::collections::BTreeMap;
use sync::supervision::band::StrokeBand;
use units::Time;
use verify::{Feature, IdleTurns, Watch};

/// What came of a run.
pub struct Outcome {
    /// What was cut.
    pub features: Vec<Feature>,
    /// What pictures need.
    pub recorder: Recorder,
    /// What may never happen, and whether it did.
    pub watch: Watch,
    /// How long the machine took.
    pub cycle_time: Time,
    /// The program came to its end.
    pub ended: bool,
    /// Alarms.
    pub faults: Vec<Fault>,
    /// Warnings at run time.
    pub warnings: Vec<Event>,
    /// What kept each tap from being faster, by the index of its op.
    pub limiting: BTreeMap<u32, String>,
    /// Drills and taps that were at the spindle drive's limit, by the index of their op.
    pub saturated: BTreeMap<u32, u32>,
    /// Holes that the program tapped but did not drill.
    pub assumed_holes: usize,
    /// What supervision by torque saw of each stroke.
    pub supervised: Vec<SupervisedStroke>,
    /// What good holes have been like.
    pub bands: Vec<StrokeBand>,
    /// What repeated taps have learnt.
    pub learning_records: Vec<sync::LearningRecord>,
    /// What was measured and taught of cams.
    pub cams: CamHost,
    /// What a wheel's idle turns would have ground.
    pub idle: Vec<verify::GroundCam>,
    /// How long it took here.
    pub timings: Timings,
    /// How long its ticks took here.
    pub ticks: TickTimes,
    /// How the servo thread has kept its time, if there was one.
    pub real_time: Option<RealTimeFigures>,
    /// What the operating system has refused of what real time needs, in sentences.
    pub not_granted: Vec<String>,
    /// The least time of motion that was planned and waited behind a stretch that flows on, while
    /// more was to come.
    pub least_ahead: Option<Time>,
    /// What stopped it from outside, and what became of that.
    pub happened: Vec<String>,
    /// Faults that were told to happen and have not, in sentences.
    pub not_triggered: Vec<String>,
    /// Stops in a thread, and the ways out.
    pub stops: Vec<report::ThreadStop>,
    /// Tools taken off work that they were not screwed to.
    pub withdrawn: Vec<crate::stops::Withdrawn>,
    /// What the program has left behind, where that was known only when it ran.
    pub left: Option<Left>,
    /// Tool changes by a machine sequence, one after the other.
    pub changes: Vec<crate::services::sequence::MadeChange>,
    /// What is true of the simulated carousel at the end.
    pub carousel: Option<sim::CarouselTruth>,
    /// What is gone of the machine and why, if it is; why the record is not on the disk, if it is
    /// not.
    pub broke_off: Vec<String>,
}

/// A thread that is cut again after its tap was taken out was recovered, though the judge has not
/// seen it.
pub(crate) fn told_of_recovery(mut features: Vec<Feature>, op: Option<u32>) -> Vec<Feature> {
    for feature in features.iter_mut().filter(|feature| Some(feature.op) == op) {
        if let verify::FeatureKind::Thread(thread) = &mut feature.kind {
            thread.recovered = true;
        }
    }
    features
}

/// What was done in periods that no observer has seen is not judged.
pub(crate) fn unobserved(figures: &RealTimeFigures) -> Option<String> {
    let count = figures.unobserved;
    (count > 0).then(|| {
        format!(
            "{count} servo periods were not observed, as this computer had no time for it: what was cut in them is not judged"
        )
    })
}

/// What of a run is still to be put on the disk.
pub struct Unwritten {
    /// Every period.
    pub trace: Option<TraceThread>,
    /// The sync record.
    pub record: Option<RecordWriter>,
}

/// What is said of a sync record that is not on the disk.
pub(crate) fn unwritten_record(why: &str) -> String {
    format!("the sync record cannot be written: {why}")
}

/// A run of which nothing more is executed.
pub struct EndedRun {
    pub(crate) feeder: Feeder,
    pub(crate) services: Services,
    pub(crate) observers: Observers,
    pub(crate) begun: Time,
    pub(crate) now: Time,
    pub(crate) faults: Vec<Fault>,
    pub(crate) broke_off: Vec<String>,
    pub(crate) periods: u64,
    pub(crate) real_time: Option<RealTimeFigures>,
}

impl EndedRun {
    /// The workpiece as it has become.
    pub fn workpiece(&self) -> Workpiece {
        let Observers { judge, watch, .. } = &self.observers;
        Workpiece { judge: judge.clone(), watch: watch.clone() }
    }

    /// What is left of the work, as the judge has seen it.
    pub fn work(&self) -> verify::Work {
        self.observers.judge.clone().into_work()
    }

    /// The number of the operation that would be read next.
    pub fn next_operation(&self) -> u32 {
        self.feeder.ops.next_number()
    }

    /// What the program leaves behind, where that is known only when it has run.
    pub fn left(&self) -> Option<Left> {
        self.feeder.ops.left()
    }

    /// What each tool has cut.
    pub fn take_tool_use(&mut self) -> BTreeMap<u32, ToolUse> {
        self.observers.tool_use.as_mut().map(ToolUseCount::take).unwrap_or_default()
    }

    /// All is over: what came of it, when all of it is on the disk.
    ///
    /// # Errors
    /// The trace cannot be written.
    pub fn finish(self, executor: &mut Executor) -> Result<Outcome, store::Error> {
        let (mut outcome, unwritten) = self.finish_beside(executor);
        let Unwritten { trace, record } = unwritten;
        let why = record.and_then(RecordWriter::finish);
        if let Some(trace) = trace {
            trace.finish()?;
        }
        outcome.broke_off.extend(why.map(|why| unwritten_record(&why)));
        Ok(outcome)
    }

    /// All is over: what came of it, and what is still to be put on the disk.
    pub fn finish_beside(self, executor: &mut Executor) -> (Outcome, Unwritten) {
        let Self { feeder, services, observers, begun, now, periods, real_time, .. } = self;
        let (mut faults, mut broke_off) = (self.faults, self.broke_off);
        // a way out of a thread after the last stop is no part of the cycle
        let took = now - begun;
        let not_granted = std::mem::take(&mut executor.refused);
        let ticks = std::mem::replace(&mut executor.ticks, TickTimes::new(false));
        let Executor { kernel, machine, .. } = executor;
        let Services { record_writer, mut cams, polygons, sequences, mut stops } = services;
        let Observers { judge, mut timings, trace, .. } = observers;
        let features = timings.judging(|| judge.finish());
        timings.stop(periods, took);
        let lost = machine.lost().filter(|why| !broke_off.contains(why));
        let recovered = record_writer.as_ref().and_then(RecordWriter::recovered);
        broke_off.extend(lost);
        if faults.is_empty() {
            faults.extend_from_slice(kernel.faults());
        }
        cams.end(feeder.planner.worn());
        cams.keep(polygons.said, polygons.kept);
        let ended = kernel.report().state == State::Ended;
        let outcome = Outcome {
            features: told_of_recovery(features, recovered),
            recorder: observers.recorder,
            watch: observers.watch,
            cycle_time: took,
            ended,
            faults,
            warnings: observers.warnings,
            limiting: feeder.limiting,
            saturated: observers.saturated,
            assumed_holes: machine.assumed_holes(),
            supervised: observers.supervised,
            bands: kernel.here().map_or(Vec::new(), |k| k.bands().to_vec()),
            learning_records: kernel.here().map_or(Vec::new(), |k| k.learning_records().to_vec()),
            cams,
            idle: observers.idle.map(IdleTurns::finish).unwrap_or_default(),
            timings,
            ticks,
            real_time,
            not_granted,
            least_ahead: feeder.ahead.least(),
            not_triggered: stops.not_triggered(took, ended),
            happened: observers.confirmed.into_iter().chain(stops.happened).collect(),
            stops: stops.threads,
            withdrawn: stops.withdrawn,
            left: feeder.ops.left(),
            changes: sequences.changes(),
            carousel: machine.carousel(),
            broke_off,
        };
        (outcome, Unwritten { trace, record: record_writer })
    }
}
