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
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};
use units::{Length, Spin};

/// A spindle that turns slower stands: its sense is that of before.
pub const STANDSTILL: Spin = Spin::rpm(3.0);

/// In the word of the engagement: a tool is in the work …
const IN_WORK: u64 = 1;
/// … touches it …
const TOUCHES: u64 = 2;
/// … and may be broken; the upper half is its number.
const MAY_BE_BROKEN: u64 = 4;

/// How spindle and axis came to rest while no control led them, the least certain last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum RunDownKind {
    /// They were led all the time.
    #[default]
    None,
    /// The kernel has stopped them together.
    Coupled,
    /// The outputs went off while the spindle turned.
    Coasted,
}

/// A tool that a control has led into the work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolInWork {
    /// The tool.
    pub tool: u32,
    /// It is certainly in the workpiece.
    pub touches: bool,
    /// A recovery that has begun to move it knows that it may be broken.
    pub may_be_broken: bool,
    /// How far the axis was from its coupling at most.
    pub sync_error: Length,
}

/// What is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RetainedState {
    /// Changes each time the component is loaded: encoders may have been set back between.
    pub loaded: u64,
    /// Number of the last engagement; 0: there was none.
    pub last: u64,
    /// The tool that is in the work now.
    pub in_work: Option<ToolInWork>,
    /// How the spindle turned last while an axis was tied to it: with growing angle; `None`: not
    /// yet.
    pub is_positive: Option<bool>,
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
        RetainedState {
            loaded: word(head::LOADED),
            last,
            in_work: (engaged & IN_WORK != 0).then(|| ToolInWork {
                tool: (engaged >> 32) as u32,
                touches: engaged & TOUCHES != 0,
                may_be_broken: engaged & MAY_BE_BROKEN != 0,
                sync_error: Length::mm(while_led.max(since)),
            }),
            is_positive: match word(head::SENSE) {
                1 if is_of_last => Some(true),
                2 if is_of_last => Some(false),
                _ => None,
            },
            stop: match word(head::STOP) {
                1 if is_of_last => RunDownKind::Coupled,
                2.. if is_of_last => RunDownKind::Coasted,
                _ => RunDownKind::None,
            },
        }
    }

    /// This tool is in the work as engagement `number`; `None`: none is. Where the control dies
    /// between two of these words, the tool has not gone in yet: it goes in when this is written.
    pub fn engage(&self, engagement: Option<(u64, ToolInWork)>) {
        let Some((number, tool)) = engagement else {
            return self.word(head::ENGAGED).store(0, Release);
        };
        if self.word(head::ENGAGEMENT).load(Relaxed) != number {
            self.word(head::ENGAGED).store(0, Release);
        }
        self.word(head::ERROR_BEFORE).store(tool.sync_error.value().to_bits(), Release);
        self.word(head::ENGAGEMENT).store(number, Release);
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
    if let Some(spin) = period.spin.filter(|spin| spin.abs() > STANDSTILL) {
        word(head::SENSE).store(if spin > Spin::ZERO { 1 } else { 2 }, Release);
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
