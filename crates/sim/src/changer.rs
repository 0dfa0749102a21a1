//! The tool changer: an order, a while without a tool, the new tool.
//!
//! ```text
//!              order differs                 time over, tool in the magazine
//!   Holds(a) ─────────────────► Changing(b) ────────────────────────────────► Holds(b)
//!                                 │    ▲
//!                                 └────┘ another order: begins anew
//! ```
//!
//! A tool that the magazine lacks never arrives: `Feedback::tool` stays `None`, as on a machine
//! whose changer searches in vain.
use units::Time;

/// What the changer is at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Changer {
    /// This tool is in the spindle; 0 is none.
    Holds(u32),
    /// On the way to this tool.
    Changing {
        /// The tool.
        to: u32,
        /// Until it is there.
        left: Time,
    },
}

impl Changer {
    /// One servo period with this order in force.
    pub(crate) fn next(
        self,
        order: u32,
        takes: Time,
        period: Time,
        has: impl Fn(u32) -> bool,
    ) -> Self {
        // a change that is over within rounding of the last period is over
        let soon = period * 1e-6;
        let (to, left) = match self {
            Self::Holds(tool) if tool == order => return self,
            Self::Changing { to, left } if to == order => (to, left - period),
            Self::Holds(_) | Self::Changing { .. } => (order, takes - period),
        };
        if left <= soon && has(to) { Self::Holds(to) } else { Self::Changing { to, left } }
    }

    /// The tool in the spindle.
    pub(crate) const fn tool(self) -> Option<u32> {
        match self {
            Self::Holds(tool) => Some(tool),
            Self::Changing { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_takes_its_time_and_then_the_new_tool_is_there() {
        let mut changer = Changer::Holds(0);
        let mut seen = Vec::new();
        for _ in 0..6 {
            changer = changer.next(3, Time::s(1e-3), Time::s(250e-6), |_| true);
            seen.push(changer.tool());
        }
        assert_eq!(seen, [None, None, None, Some(3), Some(3), Some(3)]);
    }

    #[test]
    fn a_tool_that_the_magazine_lacks_never_arrives() {
        let mut changer = Changer::Holds(1);
        for _ in 0..100 {
            changer = changer.next(9, Time::s(1e-3), Time::s(250e-6), |n| n != 9);
        }
        assert_eq!(changer.tool(), None);
        for _ in 0..4 {
            changer = changer.next(1, Time::s(1e-3), Time::s(250e-6), |n| n != 9);
        }
        assert_eq!(changer.tool(), Some(1));
    }
}
