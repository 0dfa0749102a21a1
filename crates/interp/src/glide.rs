//! Lines when nobody listens: where they lead, in a fraction of the time that executing them takes.
//!
//! ```text
//!   G1 X10 Y[#1*2] F500    its words set the place, the feed and the motion, and nothing else
//!   G91                    its word sets how the next ones count
//! ```
//!
//! Whoever asks how things stand behind an edit executes up to hundreds of thousands of blocks that it has moved.
//! All that is not plainly such a block, or meets a mode in which it means more, is executed as ever.
use crate::{
    execute::Executor,
    refused::Doubts,
    rigid::Rigid,
    setup::Dialect,
    state::{FeedMode, Motion},
};
use gcode::{Block, Value, Word};

/// What a block of lines says.
#[derive(Default)]
struct Said {
    motion: Option<Motion>,
    incremental: Option<bool>,
    feed: Option<f64>,
    axes: [f64; 9],
    /// Which axes: a bit each.
    named: u16,
}

impl Executor {
    /// Do what the block says, if that is all it takes; else false, and nothing is done.
    pub(crate) fn glides(&mut self, block: &Block) -> bool {
        if self.words.heard || !self.is_plain() {
            return false;
        }
        let Some(said) = self.said(block) else { return false };
        let motion = said.motion.unwrap_or(self.state.motion);
        let feed = said.feed.unwrap_or(self.state.feed);
        if said.named == 0 && said.motion.is_some()
            || said.named != 0 && motion == Motion::Feed && feed <= 0.0
        {
            return false;
        }
        let state = &mut self.state;
        state.line = block.span.line;
        state.feed = feed;
        state.incremental = said.incremental.unwrap_or(state.incremental);
        if said.named == 0 {
            return true;
        }
        for (axis, at) in state.at.iter_mut().enumerate() {
            if said.named >> axis & 1 == 1 {
                let word = said.axes[axis];
                *at = if state.incremental { *at + word } else { word };
            }
        }
        (state.motion, state.sticky, state.initial, state.spline_leaves) =
            (motion, None, None, None);
        true
    }

    /// Whether lines are nothing but lines here.
    fn is_plain(&self) -> bool {
        let state = &self.state;
        self.dialect == Dialect::LinuxCnc
            && state.doubts == Doubts::default()
            && matches!(state.motion, Motion::Rapid | Motion::Feed)
            && state.feed_mode == FeedMode::PerMinute
            && state.compensation.is_none()
            && state.left_beside.is_none()
            && state.nurbs.is_none()
            && state.rigid == Rigid::Off
            && self.recording.is_none()
            && !(self.compensating || state.diameter)
            && !(state.cam || state.hobbing || state.polygon)
    }

    fn said(&self, block: &Block) -> Option<Said> {
        if !(block.assignments.is_empty() && block.comments.is_empty()) {
            return None;
        }
        let mut said = Said::default();
        for word in &block.words {
            let value = match word.value {
                Value::Number(number) => number,
                value @ Value::Expression(_) => {
                    self.values().evaluate(block, value, word.span).ok()?
                }
            };
            said.take(word, value)?;
        }
        Some(said)
    }
}

impl Said {
    fn take(&mut self, word: &Word, value: f64) -> Option<()> {
        let axis = match word.letter {
            b'X'..=b'Z' => word.letter - b'X',
            b'A'..=b'C' => word.letter - b'A' + 3,
            b'U'..=b'W' => word.letter - b'U' + 6,
            b'F' if self.feed.is_none() && value > 0.0 => {
                self.feed = Some(value);
                return Some(());
            }
            b'G' => return self.take_code(value),
            _ => return None,
        };
        let bit = 1 << axis;
        if self.named & bit != 0 {
            return None;
        }
        self.named |= bit;
        self.axes[usize::from(axis)] = value;
        Some(())
    }

    fn take_code(&mut self, value: f64) -> Option<()> {
        let motion = match value {
            0.0 => Motion::Rapid,
            1.0 => Motion::Feed,
            90.0 | 91.0 if self.incremental.is_none() => {
                self.incremental = Some(value == 91.0);
                return Some(());
            }
            _ => return None,
        };
        if self.motion.replace(motion).is_some() {
            return None;
        }
        Some(())
    }
}
