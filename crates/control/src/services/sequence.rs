//! Marks of machine sequences: each is recorded before the step that it names begins.
//!
//! ```text
//!   planner ── marks ──► [ n: stage, magazine ] ◄── the kernel consults n
//!                                 │
//!            lock-step, batch: answered at once      a control: answered once it is on the disk
//! ```
use crate::KernelHandle;
use canon::{SequenceStage, ToolChange};
use motion::SEQUENCE_MARKS;
use plan::SequenceMark;
use sim::CarouselTruth;
use std::collections::VecDeque;
use store::machine::MachineFile;
use units::Time;

/// A mark that the kernel has come to, and when.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachedMark {
    /// The mark.
    pub mark: SequenceMark,
    /// Machine time.
    pub at: Time,
}

/// A tool change as it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct MadeChange {
    /// Its tools.
    pub change: ToolChange,
    /// From the first step to the end; `None`: it did not come to its end.
    pub took: Option<Time>,
    /// Steps, each by its index and its duration.
    pub steps: Vec<(usize, Time)>,
}

/// Tool changes by a sequence, a line each, with the steps that took longest; empty if there was
/// none.
pub fn text(changes: &[MadeChange], machine: &MachineFile) -> String {
    const MOST_CHANGES: usize = 10;
    const LONGEST_STEPS: usize = 3;
    let Some(sequence) = &machine.tool_change_sequence else { return String::new() };
    let mut said = String::new();
    for made in changes.iter().take(MOST_CHANGES) {
        let ToolChange { from, to, .. } = made.change;
        let mut steps = made.steps.clone();
        steps.sort_by(|a, b| b.1.value().total_cmp(&a.1.value()));
        let longest: Vec<String> = steps
            .iter()
            .take(LONGEST_STEPS)
            .filter_map(|(step, took)| {
                let name = &sequence.steps.get(*step)?.name;
                Some(format!("{name} {:.2} s", took.value()))
            })
            .collect();
        let took = made.took.map_or_else(
            || format!("left in its step {}", made.steps.len() + 1),
            |took| format!("{:.2} s in {} steps", took.value(), made.steps.len()),
        );
        said += &format!(
            "{}, T{from} to T{to}: {took}; longest {}\n",
            sequence.name,
            longest.join(", ")
        );
    }
    if changes.len() > MOST_CHANGES {
        said += &format!("and {} more of them\n", changes.len() - MOST_CHANGES);
    }
    said
}

/// What went wrong in a simulated carousel, a line each.
pub fn wrong(carousel: Option<&CarouselTruth>) -> String {
    let Some(truth) = carousel else { return String::new() };
    let mut said = String::new();
    for what in &truth.described {
        said = said + "collision in the tool changer: " + what + "\n";
    }
    if truth.collisions as usize > truth.described.len() {
        said += &format!("{} collisions in the tool changer in all\n", truth.collisions);
    }
    for tool in &truth.dropped {
        said += &format!("T{tool} dropped from the spindle\n");
    }
    said
}

/// What answers the kernel's marks.
#[derive(Debug, Default)]
pub struct SequenceHost {
    /// Marks that the kernel has not come to, in their order.
    ahead: VecDeque<SequenceMark>,
    /// Marks that it has come to, for who records them.
    reached: VecDeque<ReachedMark>,
    /// All of them, in their order, without the tools.
    log: Vec<(Option<SequenceStage>, Time)>,
    /// Someone records marks, and answers them after that.
    pub(crate) is_recorded: bool,
    /// Number of the mark that was reached last.
    last: Option<u16>,
}

impl SequenceHost {
    /// Steps are planned, and these marks are among them.
    pub(crate) fn planned(&mut self, marks: Vec<SequenceMark>) {
        self.ahead.extend(marks);
    }

    /// The kernel has come to a mark, if it has.
    pub(crate) fn consult(&mut self, kernel: &mut KernelHandle, now: Time) {
        let consulted = kernel.consulted().filter(|number| *number >= SEQUENCE_MARKS);
        let Some(number) = consulted.filter(|number| self.last != Some(*number)) else { return };
        self.last = Some(number);
        while let Some(mark) = self.ahead.pop_front() {
            if mark.number == number {
                self.log.push((mark.stage, now));
                if self.is_recorded {
                    self.reached.push_back(ReachedMark { mark, at: now });
                }
                break;
            }
        }
        if !self.is_recorded {
            kernel.answer();
        }
    }

    /// Tool changes, as they were made.
    pub(crate) fn changes(&self) -> Vec<MadeChange> {
        let mut made: Vec<MadeChange> = Vec::new();
        let mut under_way: Option<(SequenceStage, Time, Time)> = None;
        for (stage, at) in &self.log {
            if let (Some((step, begun, since)), Some(last)) = (under_way, made.last_mut()) {
                last.steps.push((step.step, *at - since));
                last.took = stage.is_none().then(|| *at - begun);
            }
            under_way = stage.map(|stage| {
                let begun = under_way.map_or(*at, |(_, begun, _)| begun);
                if under_way.is_none() {
                    made.push(MadeChange { change: stage.change, took: None, steps: Vec::new() });
                }
                (stage, begun, *at)
            });
        }
        made
    }

    /// The next mark that the kernel has come to.
    pub fn next_reached(&mut self) -> Option<ReachedMark> {
        self.reached.pop_front()
    }
}
