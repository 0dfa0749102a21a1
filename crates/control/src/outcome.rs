//! What is known of a run when it is over.
use crate::job::Left;
use crate::services::CamHost;
use crate::{RealTimeFigures, TickTimes, Timings};
use kernel::{Event, Fault};
use report::Recorder;
use std::collections::BTreeMap;
use units::Time;
use verify::{Feature, Watch};

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
    /// The least time of motion that was planned and waited behind a stretch that flows on, while more was to come.
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
    /// Why the machine simulator is gone, if it is; why the record is not on the disk, if it is not.
    pub broke_off: Vec<String>,
}

/// A thread that is cut again after its tap was taken out was recovered, though the judge has not seen it.
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
