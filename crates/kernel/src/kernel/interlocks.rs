//! Doors and other interlocks: what they hold, and how it goes on.
//!
//! ```text
//!   feed inhibited     axes come to rest as for a hold, a tap in its thread with its spindle;
//!                      they go on when it is no longer
//!   spindle inhibited  the same first, then the spindle stops; afterwards the spindle, then the axes
//! ```
//!
//! So no spindle is taken away from under a tool that moves, and what is coupled stays on its
//! coupling. Homing, and taking a tool out, are not held.
use super::Kernel;
use crate::execute::Activity;
use crate::operator::Inhibit;
use crate::spindle::SpindleLoop;
use crate::threading::Chain;
use crate::waiting::WaitFor;
use bus::Feedback;
use units::Time;

/// What follows from interlocks.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Interlocks {
    /// A spindle comes back to its speed.
    returns: bool,
    /// Since when something is held.
    since: Time,
}

impl Interlocks {
    pub(super) const fn since(&self) -> Time {
        self.since
    }
}

impl Kernel {
    /// Takes what interlocks say in this period.
    pub(super) fn read_interlocks(&mut self, feedback: &Feedback) {
        let panel = &feedback.panel;
        let may_stop = self.needs_no_turning();
        let (mut asked, mut returns) = (false, self.interlocks.returns);
        for (index, spindle) in self.drives.spindles.iter().enumerate() {
            let is_asked = panel.spindle_inhibit[index] && spindle.is_some();
            let was = self.drives.stopped[index];
            self.drives.stopped[index] = is_asked && (was || may_stop);
            returns |= was && !is_asked;
            asked |= is_asked;
        }
        let ended = returns && !self.interlocks.returns;
        let changes = self.drives.spindles.iter().flatten().any(SpindleLoop::is_changing);
        self.interlocks.returns = returns && (ended || changes);
        let inhibit =
            Inhibit { feed: panel.feed_inhibit, spindle: asked || self.interlocks.returns };
        if !self.operator.inhibit().holds() {
            self.interlocks.since = self.now;
        }
        self.operator.take_inhibit(inhibit);
    }

    /// Axes stand, and nothing goes by a spindle's turns: a spindle may be stopped.
    fn needs_no_turning(&self) -> bool {
        let by_turns = matches!(
            self.activity,
            Activity::Revolving { .. }
                | Activity::Fading { .. }
                | Activity::Engaging(_)
                | Activity::Consulting { .. }
        );
        let tied = self.coupled().is_some()
            || self.recovering.is_some()
            || self.withdrawing.is_some()
            || self.retreating.is_some()
            || self.drives.chain.as_ref().is_some_and(|chain| !Chain::is_standing(chain));
        let mut axes = self.drives.axes.iter().enumerate();
        let stand = axes.all(|(index, axis)| {
            axis.as_ref().is_none_or(|axis| axis.target.speed == 0.0)
                || self.drives.coupled.is_superposed(index)
        });
        stand && !by_turns && !tied
    }

    /// Something of a program is held, or the operator has ordered rest: an interlock that is open
    /// beside a machine without anything to do is no hold.
    pub(super) fn has_something_held(&self) -> bool {
        self.operator.is_ordered_to_rest() || !self.queue.is_empty()
    }

    /// What an interlock makes a program wait for.
    pub(super) const fn interlock(&self) -> Option<WaitFor> {
        let Inhibit { feed, spindle } = self.operator.inhibit();
        match (feed, spindle) {
            (true, _) => Some(WaitFor::FeedInterlock),
            (false, true) => Some(WaitFor::SpindleInterlock),
            (false, false) => None,
        }
    }
}
