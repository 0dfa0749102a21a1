//! What the component keeps of a tool in the work, whatever becomes of the control and of its
//! files: a few words of the shared memory.
//!
//! ```text
//!   control    engagement: number, tool ───────────► kept ◄── sense, sync error, stop   the servo thread, each period
//!                                                      │
//!   control dies, another one finds the component ─────┴───► number and tool, and how the drives came to rest
//! ```
//!
//! It lasts as long as the component is loaded. Each word is whole whatever is written there; what
//! cannot be is read as nothing.
use crate::layout::head;
use crate::mapping::Mapping;
use bus::{EngagedTool, EngagementEvidence, RunDownKind, SpindleSense};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use units::{Length, Spin};

/// In the word of the engagement: a tool is in the work …
const IN_WORK: u64 = 1;
/// … touches it …
const TOUCHES: u64 = 2;
/// … and may be broken; the upper half is its number.
const MAY_BE_BROKEN: u64 = 4;

/// What is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RetainedState {
    /// Changes each time the component is loaded: encoders may have been set back between.
    pub loaded: u64,
    /// A tool in the work.
    pub evidence: EngagementEvidence,
    /// How the drives came to rest.
    pub stop: RunDownKind,
}

/// The control's hold of these words.
#[derive(Clone, Debug)]
pub struct RetainedMemory(Arc<Mapping>);

impl RetainedMemory {
    pub(crate) fn new(memory: &Arc<Mapping>) -> Self {
        Self(Arc::clone(memory))
    }

    fn word(&self, at: usize) -> &AtomicU64 {
        &self.0.words()[at]
    }

    /// As it is now.
    pub fn state(&self) -> RetainedState {
        let word = |at: usize| self.word(at).load(Acquire);
        let (last, engaged) = (word(head::ENGAGEMENT), word(head::ENGAGED));
        let is_of_last = word(head::KEPT_OF) == last;
        let length = |at: usize| Some(f64::from_bits(word(at))).filter(|v| v.is_finite());
        let while_led = length(head::ERROR_BEFORE).unwrap_or(0.0);
        let since = length(head::ERROR_SINCE).filter(|_| is_of_last).unwrap_or(0.0);
        let in_work = (engaged & IN_WORK != 0).then(|| EngagedTool {
            number: last,
            tool: (engaged >> 32) as u32,
            touches: engaged & TOUCHES != 0,
            may_be_broken: engaged & MAY_BE_BROKEN != 0,
            sync_error: Length::mm(while_led.max(since)),
        });
        let sense = match word(head::SENSE) {
            1 if is_of_last => SpindleSense::Positive,
            2 if is_of_last => SpindleSense::Negative,
            _ => SpindleSense::Unknown,
        };
        RetainedState {
            loaded: word(head::LOADED),
            evidence: EngagementEvidence { last, in_work, sense },
            stop: match word(head::STOP) {
                1 if is_of_last => RunDownKind::Coupled,
                2 if is_of_last => RunDownKind::QuickStop,
                3.. if is_of_last => RunDownKind::Coasted,
                _ => RunDownKind::None,
            },
        }
    }

    /// Keeps the tool that is in the work. Where the control dies between two of these words, the
    /// tool has not gone in yet: it goes in when this is written.
    pub fn engage(&self, tool: Option<EngagedTool>) {
        let Some(tool) = tool else {
            return self.word(head::ENGAGED).store(0, Release);
        };
        if self.word(head::ENGAGEMENT).load(Relaxed) != tool.number {
            self.word(head::ENGAGED).store(0, Release);
        }
        self.word(head::ERROR_BEFORE).store(tool.sync_error.value().to_bits(), Release);
        self.word(head::ENGAGEMENT).store(tool.number, Release);
        let flags =
            u64::from(tool.touches) * TOUCHES + u64::from(tool.may_be_broken) * MAY_BE_BROKEN;
        self.word(head::ENGAGED).store(u64::from(tool.tool) << 32 | flags | IN_WORK, Release);
    }
}

/// What the servo thread says of a period, of a tool that may be in the work.
#[derive(Clone, Copy, Debug, Default)]
pub struct TiedPeriod {
    /// How fast the spindle turns that an axis is tied to.
    pub spin: Option<Spin>,
    /// How far the axis is from its coupling.
    pub sync_error: Option<Length>,
    /// How the drives are coming to rest without a control, if they are.
    pub stop: RunDownKind,
}

/// The servo thread's part: what it keeps of a period. No call of the system, no memory.
pub(crate) fn keep(memory: &Mapping, period: &TiedPeriod) {
    let word = |at: usize| &memory.words()[at];
    if word(head::ENGAGED).load(Acquire) & IN_WORK == 0 {
        return;
    }
    let number = word(head::ENGAGEMENT).load(Acquire);
    if word(head::KEPT_OF).load(Relaxed) != number {
        for at in [head::SENSE, head::STOP, head::ERROR_SINCE] {
            word(at).store(0, Relaxed);
        }
        word(head::KEPT_OF).store(number, Release);
    }
    if let Some(sense) = period.spin.and_then(SpindleSense::of) {
        word(head::SENSE).store(sense as u64, Release);
    }
    if let Some(error) = period.sync_error {
        let before = f64::from_bits(word(head::ERROR_SINCE).load(Relaxed));
        let most = if before.is_finite() { before } else { 0.0 };
        word(head::ERROR_SINCE).store(error.value().abs().max(most).to_bits(), Release);
    }
    let stop = period.stop as u64;
    if stop > word(head::STOP).load(Relaxed) {
        word(head::STOP).store(stop, Release);
    }
}

#[cfg(test)]
#[path = "retained_tests.rs"]
mod tests;
