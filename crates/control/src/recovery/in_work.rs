//! Whether a tool is in the work: what the machine keeps by itself, what the sync record says, and
//! what the encoders show.
//!
//! | machine keeps | sync record | answer |
//! |---|---|---|
//! | tool 11, number 7 | of number 7, in the work | it is: recovery, unless the encoders show it outside |
//! | tool 11, number 7 | none, of another number, or that it is out | the record is missing, old or of another folder: nothing moves |
//! | nothing, the last was 7 | of number 7, in the work | taken out after the record was written |
//! | nothing, the last was 6 | of number 7, in the work | the control died before the tool went in |
//! | nothing, the last was 9 | of number 7, in the work | they contradict one another: nothing moves |
//! | nothing | that it is out, or none | nothing is in the work, on the machine's word |
//!
//! The control states the tool after its record is on the disk, and takes that back before the
//! record says so: at every instant the record of a tool that the machine keeps is on the disk.
//! Where it is not, the folder is not the one, or not as it was.
use crate::services::sync_record;
use store::sync_record::SyncRecord;
use wire::Welcome;

/// See the module's header.
#[derive(Debug)]
pub enum InWork {
    /// No tool is, and how that is known.
    Nothing(String),
    /// This one is.
    Tool(Box<SyncRecord>),
    /// That cannot be told, and why.
    Unknown(String),
}

/// What is known. `folder`: where the record is looked for.
pub fn judge(record: Option<SyncRecord>, welcome: &Welcome, folder: &str) -> InWork {
    let evidence = &welcome.evidence;
    let record = record.filter(|record| record.stage.is_in_work() || evidence.in_work.is_some());
    match (evidence.in_work, record) {
        (None, None) => InWork::Nothing("the machine keeps that no tool is in its work".into()),
        (None, Some(record)) if record.engagement == evidence.last => InWork::Nothing(format!(
            "the machine keeps that tool {} has come out of the work since the sync record was written",
            record.stroke.tool
        )),
        (None, Some(record)) if record.engagement == evidence.last + 1 => InWork::Nothing(format!(
            "the machine keeps that tool {} had not gone into the work yet",
            record.stroke.tool
        )),
        (None, Some(record)) => InWork::Unknown(format!(
            "the sync record in {folder} tells of tool {} in the work (engagement {}), and the machine keeps that nothing is in its \
             work and that its last engagement was {}: the record is from another time",
            record.stroke.tool, record.engagement, evidence.last
        )),
        (Some(kept), None) => InWork::Unknown(format!(
            "the machine keeps that tool {} is in its work (engagement {}), and there is no sync record in {folder}: what the tool cuts \
             and the way out are not known",
            kept.tool, kept.number
        )),
        (Some(kept), Some(record))
            if record.stage.is_in_work()
                && (record.engagement, record.stroke.tool) == (kept.number, kept.tool) =>
        {
            if sync_record::in_work(&record, &welcome.observed.feedback) {
                return InWork::Tool(Box::new(record));
            }
            InWork::Nothing(
                "the sync record and the machine tell of a tool in the work, and the encoders that it is out of it"
                    .into(),
            )
        }
        (Some(kept), Some(record)) => InWork::Unknown(format!(
            "the machine keeps that tool {} is in its work (engagement {}), and the sync record in {folder} is of tool {}, engagement \
             {}{}: it is old, or of another folder",
            kept.tool,
            kept.number,
            record.stroke.tool,
            record.engagement,
            if record.stage.is_in_work() { "" } else { ", and says that it is out" }
        )),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::recovery::no_tool;
    use bus::{EngagedTool, EngagementEvidence, RunDownKind};
    use store::sync_record::{Identity, Stage, Stroke};
    use units::Coordinate;
    use units::{Length, Time};
    use wire::Observed;

    const INSIDE: Length = Length::mm(-12.0);

    fn record(engagement: u64, stage: Stage) -> SyncRecord {
        let identity = Identity { machine: "m".into(), serial: 1, epoch: 1 };
        let none = no_tool(&identity);
        let stroke = Stroke { tool: 11, bottom: Length::mm(-20.0), ..none.stroke.clone() };
        SyncRecord { engagement, stage, stroke, ..none }
    }

    /// Of a machine whose last engagement this was, and whose Z stands there.
    pub(in crate::recovery) fn welcome(last: u64, in_work: Option<u64>, z: Length) -> Welcome {
        let mut observed = Observed::default();
        observed.feedback.axes[2].position = Coordinate::linear(z);
        let in_work =
            in_work.map(|number| EngagedTool { number, tool: 11, ..EngagedTool::default() });
        Welcome {
            machine: "m".into(),
            serial: 1,
            epoch: 1,
            period: Time::s(250e-6),
            real_time: false,
            turns_lost: [false; bus::SPINDLES],
            stop: RunDownKind::None,
            evidence: EngagementEvidence { last, in_work, ..EngagementEvidence::default() },
            observed,
        }
    }

    /// "nothing", "tool" or "unknown".
    fn judged(record: Option<SyncRecord>, welcome: &Welcome) -> (&'static str, String) {
        match judge(record, welcome, "FOLDER") {
            InWork::Nothing(why) => ("nothing", why),
            InWork::Tool(_) => ("tool", String::new()),
            InWork::Unknown(why) => ("unknown", why),
        }
    }

    #[test]
    fn a_tool_that_the_machine_keeps_is_recovered_by_its_own_record_alone() {
        let in_work = welcome(7, Some(7), INSIDE);
        let own = record(7, Stage::Inward);
        assert_eq!(judged(Some(own.clone()), &in_work).0, "tool");
        assert_eq!(judged(Some(own), &welcome(7, Some(7), Length::ZERO)).0, "nothing");
        for other in [record(7, Stage::Out), record(6, Stage::Inward), record(8, Stage::Outward)] {
            let (answer, why) = judged(Some(other), &in_work);
            assert!(answer == "unknown" && why.contains("FOLDER"), "{why}");
        }
        let mut of_another = record(7, Stage::Inward);
        of_another.stroke.tool = 3;
        assert_eq!(judged(Some(of_another), &in_work).0, "unknown");
    }

    #[test]
    fn no_record_is_no_proof_where_the_machine_keeps_a_tool() {
        let (answer, why) = judged(None, &welcome(7, Some(7), INSIDE));
        assert!(answer == "unknown" && why.contains("no sync record in FOLDER"), "{why}");
    }

    #[test]
    fn a_machine_that_keeps_nothing_is_believed_unless_the_record_is_from_another_time() {
        for (number, stage, answer) in [
            (7, Stage::Inward, "nothing"),
            (8, Stage::Inward, "nothing"),
            (6, Stage::Inward, "unknown"),
            (9, Stage::Outward, "unknown"),
            (3, Stage::Out, "nothing"),
            (7, Stage::Recovered, "nothing"),
        ] {
            let found = judged(Some(record(number, stage)), &welcome(7, None, INSIDE));
            assert_eq!(found.0, answer, "{number} {stage:?}: {}", found.1);
        }
        assert_eq!(judged(None, &welcome(0, None, INSIDE)).0, "nothing");
    }
}
