//! Steps of machine sequences: waiting for several inputs, and counting edges while a motor turns.
//!
//! ```text
//!   Inputs   a ──────┐ bounces ┌┐┌─────────     all as they must be, without a break, for `steady`
//!            b ──────┴─────────┴┴┴── steady ─► done
//!
//!   Count    motor    ┌──────────────────┐      on while edges are missing, off as the last one comes
//!            input  ──┘ ┌──┐    ┌──┐    ┌┴─     an edge: off for `steady`, then on for `steady`
//! ```
//!
//! The motor is off whenever no step counts: a stop, an alarm or a reset leaves nothing turning.
use crate::config::Subject;
use crate::fault::FaultKind;
use bus::Signals;
use motion::{EdgeCount, InputsWait};

/// What is wrong: the alarm, what has raised it, the value, its limit.
type InputFault = (FaultKind, Subject, f64, f64);

/// A wait for inputs under way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Awaited {
    /// Time since it began, s.
    pub(crate) waited_s: f64,
    /// Time for which all inputs have been as they must be, s.
    steady_s: f64,
}

impl Awaited {
    /// One period; whether the wait is over.
    pub(crate) fn advance(
        &mut self,
        wait: &InputsWait,
        dt: f64,
        inputs: &Signals,
    ) -> Result<bool, InputFault> {
        let wrong = wait.wrong(inputs.digital);
        self.waited_s += dt;
        self.steady_s = if wrong == 0 { self.steady_s + dt } else { 0.0 };
        if wrong == 0 && self.steady_s >= wait.steady.value() {
            return Ok(true);
        }
        if self.waited_s > wait.longest.value() {
            let input = wrong.trailing_zeros().min(63) as u8;
            let kind = FaultKind::InputsNotSeen;
            return Err((kind, Subject::Input(input), self.waited_s, wait.longest.value()));
        }
        Ok(false)
    }
}

/// Inputs that must stay as they are wherever something moves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Guard {
    on: u64,
    off: u64,
    /// Time for which one has not been as it must be, s.
    wrong_s: f64,
}

impl Guard {
    /// Time for which an input may be otherwise: contacts bounce, s.
    const BOUNCES_S: f64 = 0.01;

    pub(crate) const fn new(on: u64, off: u64) -> Self {
        Self { on, off, wrong_s: 0.0 }
    }

    /// One period in which something moves.
    pub(crate) fn check(&mut self, dt: f64, inputs: &Signals) -> Result<(), InputFault> {
        let wrong = self.on & !inputs.digital | self.off & inputs.digital;
        self.wrong_s = if wrong == 0 { 0.0 } else { self.wrong_s + dt };
        if self.wrong_s > Self::BOUNCES_S {
            let input = wrong.trailing_zeros().min(63) as u8;
            let found = (self.wrong_s, Self::BOUNCES_S);
            return Err((FaultKind::InputLost, Subject::Input(input), found.0, found.1));
        }
        Ok(())
    }
}

/// A count of edges under way.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Counted {
    /// Edges seen.
    edges: u8,
    /// The input as it was last steady; `None` at the beginning.
    steady: Option<bool>,
    /// The input as it is, and time since it changed, s.
    now: (bool, f64),
    /// Time since the last edge, s.
    pub(crate) waited_s: f64,
}

impl Counted {
    /// One period; whether all edges have come.
    pub(crate) fn advance(
        &mut self,
        count: &EdgeCount,
        dt: f64,
        inputs: &Signals,
    ) -> Result<bool, InputFault> {
        let on = inputs.is_on(count.input);
        self.now = if on == self.now.0 { (on, self.now.1 + dt) } else { (on, dt) };
        self.waited_s += dt;
        if self.now.1 >= count.steady.value() && self.steady != Some(on) {
            let is_edge = on && self.steady == Some(false);
            self.steady = Some(on);
            if is_edge {
                self.edges += 1;
                self.waited_s = 0.0;
            }
        }
        if self.edges >= count.edges {
            return Ok(true);
        }
        if self.waited_s > count.longest.value() {
            let (kind, limit) = (FaultKind::InputsNotSeen, count.longest.value());
            return Err((kind, Subject::Input(count.input), self.waited_s, limit));
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use units::Time;

    fn inputs(on: bool) -> Signals {
        let mut inputs = Signals::default();
        inputs.switch(3, on);
        inputs
    }

    #[test]
    fn inputs_that_bounce_end_a_wait_only_once_they_are_steady() {
        let wait = InputsWait {
            on: 1 << 3,
            off: 0,
            steady: Time::s(0.003),
            longest: Time::s(0.1),
            usual: Time::ZERO,
        };
        let mut awaited = Awaited::default();
        let seen = [true, false, true, true, false, true, true, true, true];
        let ended = seen.iter().position(|on| awaited.advance(&wait, 0.001, &inputs(*on)).unwrap());
        assert_eq!(ended, Some(7));
    }

    #[test]
    fn a_wait_that_lasts_too_long_names_its_input() {
        let wait = InputsWait {
            on: 1 << 3,
            off: 0,
            steady: Time::ZERO,
            longest: Time::s(0.005),
            usual: Time::ZERO,
        };
        let mut awaited = Awaited::default();
        let ended = (0..9).find_map(|_| awaited.advance(&wait, 0.001, &inputs(false)).err());
        let (kind, subject, ..) = ended.unwrap();
        assert_eq!((kind, subject), (FaultKind::InputsNotSeen, Subject::Input(3)));
    }

    #[test]
    fn a_guarded_input_may_bounce_and_not_go() {
        let mut guard = Guard::new(1 << 3, 0);
        for on in [true, false, true].into_iter().cycle().take(90) {
            guard.check(0.004, &inputs(on)).unwrap();
        }
        let ended = (0..9).position(|_| guard.check(0.004, &inputs(false)).is_err());
        assert_eq!(ended, Some(2));
    }

    #[test]
    fn an_edge_counts_once_however_its_contact_bounces() {
        let count = EdgeCount {
            output: 0,
            input: 3,
            edges: 2,
            steady: Time::s(0.002),
            longest: Time::s(1.0),
            usual: Time::ZERO,
        };
        // on from the beginning is no edge
        let seen: Vec<bool> = "1110001010111100001011".chars().map(|one| one == '1').collect();
        let mut counted = Counted::default();
        let ended =
            seen.iter().position(|on| counted.advance(&count, 0.001, &inputs(*on)).unwrap());
        assert_eq!(ended, Some(21));
    }
}
