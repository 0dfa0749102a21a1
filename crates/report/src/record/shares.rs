//! Where the time went: per state of the control, for the whole run and for each tool. While a cam
//! is ground the control waits for turns of the work: that is no idling, and is counted apart.
use super::Turning;
use bus::State;
use units::Time;

/// States there are; `State` is numbered from 0 in the order of its variants.
pub(crate) const STATES: usize = State::Ended as usize + 1;
/// Tools that get a line of their own; the time of further ones counts for the run only.
const TOOLS: usize = 64;

/// Time per state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shares {
    seconds: [f64; STATES],
    /// Cams ground, and turns of the work in the air.
    turning: [f64; 2],
}

impl Shares {
    /// Time spent in a state.
    pub(crate) fn of(&self, state: State) -> Time {
        Time::s(self.seconds[state as usize])
    }

    /// Time for which the work turned under or before the wheel.
    pub(crate) const fn turning(&self, kind: Turning) -> Time {
        Time::s(self.turning[kind as usize])
    }

    const fn add(&mut self, state: State, turning: Option<Turning>, seconds: f64) {
        match turning {
            Some(kind) => self.turning[kind as usize] += seconds,
            None => self.seconds[state as usize] += seconds,
        }
    }

    /// Time spent altogether, up to the program's end.
    pub(crate) fn total(&self) -> Time {
        let ended = State::Ended as usize;
        let running = self.seconds.iter().enumerate().filter(|&(state, _)| state != ended);
        Time::s(running.map(|(_, s)| s).sum::<f64>() + self.turning.iter().sum::<f64>())
    }
}

/// Shares of the run and of each tool.
#[derive(Clone, Debug, Default)]
pub(crate) struct SharesByTool {
    pub(crate) run: Shares,
    /// Tool number and its shares, in the order first used.
    pub(crate) tools: Vec<(u32, Shares)>,
    current: usize,
}

impl SharesByTool {
    /// Count a period. While the changer is at work (`None`) it counts for the tool before.
    pub(crate) fn push(
        &mut self,
        state: State,
        turning: Option<Turning>,
        tool: Option<u32>,
        period: Time,
    ) {
        let seconds = period.value();
        if !seconds.is_finite() || seconds <= 0.0 {
            return;
        }
        self.run.add(state, turning, seconds);
        if let Some(number) = tool
            && self.tools.get(self.current).is_none_or(|t| t.0 != number)
        {
            self.current = self.slot(number);
        }
        if let Some((_, shares)) = self.tools.get_mut(self.current) {
            shares.add(state, turning, seconds);
        }
    }

    fn slot(&mut self, number: u32) -> usize {
        let found = self.tools.iter().position(|t| t.0 == number);
        found.unwrap_or_else(|| {
            if self.tools.len() < TOOLS {
                self.tools.push((number, Shares::default()));
                self.tools.len() - 1
            } else {
                TOOLS // no such slot: counted for the run only
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_counted_per_state_and_per_tool_and_a_change_belongs_to_the_tool_before_it() {
        let mut shares = SharesByTool::default();
        for (state, tool, seconds) in [
            (State::Rapid, Some(1), 0.5),
            (State::Feed, Some(1), 2.0),
            (State::ToolChange, None, 1.5),
            (State::TapIn, Some(2), 0.25),
            (State::Rapid, Some(1), 0.25),
            (State::Ended, Some(1), 9.0),
        ] {
            shares.push(state, None, tool, Time::s(seconds));
        }
        assert_eq!(shares.run.total(), Time::s(4.5));
        assert_eq!(shares.run.of(State::Rapid), Time::s(0.75));
        let totals: Vec<_> = shares.tools.iter().map(|(n, s)| (*n, s.total().value())).collect();
        assert_eq!(totals, [(1, 4.25), (2, 0.25)]);
    }

    #[test]
    fn a_cam_that_is_ground_is_neither_a_dwell_nor_a_wait() {
        let mut shares = SharesByTool::default();
        shares.push(State::Dwell, Some(Turning::Grinding), Some(1), Time::s(3.0));
        shares.push(State::Dwell, None, Some(1), Time::s(0.5));
        assert_eq!(shares.run.turning(Turning::Grinding), Time::s(3.0));
        assert_eq!(shares.run.of(State::Dwell), Time::s(0.5));
        assert_eq!(shares.run.total(), Time::s(3.5));
    }

    #[test]
    fn a_thousand_tools_take_no_more_room_than_the_first_sixty_four() {
        let mut shares = SharesByTool::default();
        for number in 0..1000 {
            shares.push(State::Feed, None, Some(number), Time::s(1.0));
        }
        assert_eq!(shares.tools.len(), TOOLS);
        assert_eq!(shares.run.total(), Time::s(1000.0));
    }
}
