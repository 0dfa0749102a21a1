//! What a control that is switched on finds in the work of its machine, left there by a control
//! before it, and the way out.
use super::in_work::{self, InWork};
use super::{Findings, Leg, RecoveryWay, Withdrawal, find, not_by_recovery, withdraw};
use bus::EngagedTool;
use kernel::{RecoveryPlan, WithdrawalPlan};
use store::machine::MachineFile;
use store::sync_record::SyncRecord;
use sync::recovery::{Mover, Way};
use wire::Welcome;

/// A tool that a control has left.
pub(crate) enum LeftTool {
    /// On its thread.
    OnThread(Box<SyncRecord>, Box<Findings>),
    /// It is not screwed to the work.
    OffWork(Box<SyncRecord>, Box<Withdrawal>),
    /// Nothing may move it, or it is not known; and why.
    Unmoved(Option<Box<SyncRecord>>, String),
}

/// How a kernel takes it out whose axes have the encoders' own zeros.
pub(crate) enum WayOut {
    /// Along its thread.
    Along(RecoveryPlan),
    /// Along its infeed axis.
    Off(WithdrawalPlan),
}

/// What is in the work; `None`: nothing, as far as machine, record and encoders know. `folder`:
/// where the record was looked for.
pub(crate) fn left(
    record: Option<SyncRecord>,
    welcome: &Welcome,
    folder: &str,
    file: &MachineFile,
) -> Option<LeftTool> {
    let known = record.clone().filter(|record| record.stage.is_in_work()).map(Box::new);
    let record = match in_work::judge(record, welcome, folder) {
        InWork::Nothing(_) => return None,
        InWork::Unknown(why) => return Some(LeftTool::Unmoved(known, why)),
        InWork::Tool(record) => record,
    };
    if let Some(why) = not_by_recovery(&record, &welcome.observed.feedback) {
        return Some(LeftTool::Unmoved(Some(record), why));
    }
    if let Some(retreat) = record.stroke.retreat {
        let way = withdraw::find(&record.stroke, retreat, welcome, file);
        return Some(LeftTool::OffWork(record, Box::new(way)));
    }
    let found = find::find(&record.stroke, record.stage, welcome, file, RecoveryWay::UnloadFirst);
    Some(match found {
        Ok(findings) => LeftTool::OnThread(record, Box::new(findings)),
        Err(why) => LeftTool::Unmoved(Some(record), why),
    })
}

impl LeftTool {
    /// What was written down of it.
    pub(crate) fn record(&self) -> Option<&SyncRecord> {
        match self {
            Self::OnThread(record, _) | Self::OffWork(record, _) => Some(record),
            Self::Unmoved(record, _) => record.as_deref(),
        }
    }

    /// What the machine is to keep of it from before it is moved.
    pub(crate) fn mark(&self, kept: Option<EngagedTool>) -> Option<EngagedTool> {
        match self {
            Self::OnThread(_, findings) => findings.mark(kept),
            Self::OffWork(..) | Self::Unmoved(..) => kept,
        }
    }

    /// How it is taken out.
    ///
    /// # Errors
    /// Why it is not.
    pub(crate) fn way_out(&self, file: &MachineFile) -> Result<WayOut, String> {
        match self {
            Self::OnThread(record, findings) => {
                find::plan(file, &record.stroke, findings).map(WayOut::Along)
            }
            Self::OffWork(_, way) => {
                let leg = |leg: Leg| (leg.axis, leg.to);
                let legs = [Some(leg(way.infeed)), way.along.map(leg)];
                Ok(WayOut::Off(WithdrawalPlan { legs }))
            }
            Self::Unmoved(_, why) => Err(why.clone()),
        }
    }

    /// What moves first, in a sentence.
    pub(crate) fn moves_first(&self) -> Option<String> {
        match self {
            Self::Unmoved(..) => None,
            Self::OffWork(_, way) => {
                let Leg { axis, from, to } = way.infeed;
                let letter = axis.letter();
                let then = way.along.map_or_else(String::new, |leg| {
                    let letter = leg.axis.letter();
                    format!(", then {letter} goes back to where the pass began")
                });
                Some(format!(
                    "{letter} takes the tool {:.3} mm off the work{then}.",
                    (to - from).value().abs()
                ))
            }
            Self::OnThread(record, findings) => {
                let letter = canon::Axis::ALL[usize::from(record.stroke.axis)].letter();
                let way = &findings.projection;
                let along =
                    format!("the spindle turns back and {letter} follows it along the thread.");
                Some(match way.mover {
                    _ if findings.way == Way::Straight => {
                        format!("{letter} goes straight out: the tip stands over the work.")
                    }
                    _ if way.unloaded != way.from => {
                        let by = (way.unloaded.place - way.from.place).in_um();
                        format!(
                            "{letter} moves {by:+.1} µm, to where nothing presses; then {along}"
                        )
                    }
                    Some(Mover::Feed) => {
                        let by = (way.to.place - way.from.place).in_um();
                        format!("{letter} moves {by:+.1} µm, back onto the thread; then {along}")
                    }
                    Some(Mover::Spindle) => {
                        let by = (way.to.angle - way.from.angle).in_deg();
                        format!("The spindle turns {by:+.2}°, back onto the thread; then {along}")
                    }
                    None => format!("The tap is on its thread: {along}"),
                })
            }
        }
    }
}
