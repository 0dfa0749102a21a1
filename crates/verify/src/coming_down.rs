//! Features that are made by a tool which comes down on the block along its own axis: where, and
//! what it is.
use crate::Config;
use crate::judge::{OrderedFeature, What};
use crate::thread;
use crate::workpiece::Under;
use canon::{Axis, Position, Tool};

impl OrderedFeature {
    /// A hole or a tap.
    pub(crate) const fn is_along_its_tool(&self) -> bool {
        matches!(self.what, What::Hole(_) | What::Tap(_))
    }

    /// Where it comes down on the block, and what does; `None`: not along the spindle.
    pub(crate) fn under(&self, tool: Option<&Tool>, config: &Config) -> Option<([f64; 2], Under)> {
        let tool = tool?;
        let at = |at: &Position| [at.linear[0].value(), at.linear[1].value()];
        match &self.what {
            What::Hole(hole) if hole.axis == Axis::Z => {
                let radius = tool.diameter.value() / 2.0;
                Some((at(&hole.at), Under::Drill { radius }))
            }
            What::Tap(tap) if tap.axis == Axis::Z => {
                Some((at(&tap.start), thread::under(tap, tool, config.class)))
            }
            _ => None,
        }
    }
}
