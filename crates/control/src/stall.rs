//! How long a run may stand still before it is given up: every wait of the control has its own
//! limit, but an operator's has none.
use crate::KernelHandle;
use bus::{AXES, Command, State};
use units::{Coordinate, Time};

/// A run may stand for this much longer than all of it was planned to take: waits differ from their
/// estimates.
const STANDS: f64 = 3.0;
const STANDS_AT_LEAST: Time = Time::s(60.0);
/// The slowest run that is waited for: at one percent of its speed.
const SLOWEST: f64 = 100.0;

/// See the module's header.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StallGuard {
    planned: Option<Time>,
    stands: Time,
    moved: Time,
    last: [Coordinate; AXES],
}

impl StallGuard {
    /// With a run that begins now and was planned to take so long, if that is known.
    pub(crate) fn new(planned: Option<Time>, now: Time) -> Self {
        let stands = STANDS_AT_LEAST.max(planned.unwrap_or(Time::ZERO) * STANDS);
        Self { planned, stands, moved: now, last: [Coordinate::ZERO; AXES] }
    }

    /// Why the run is given up, if it is.
    pub(crate) fn ends(
        &mut self,
        command: &Command,
        (begun, now): (Time, Time),
        kernel: &KernelHandle,
    ) -> Option<String> {
        let operator = kernel.operator();
        let waiting = kernel.waiting();
        let ends_by_itself = waiting.is_some_and(|waiting| waiting.limit.is_some());
        let at = command.axes.each_ref().map(|axis| axis.position);
        // an axis that follows a spindle moves on through a hold: it goes nowhere
        let is_held = operator.wants_rest() && kernel.report().state == State::Held;
        if !is_held && (at != self.last || ends_by_itself) {
            (self.last, self.moved) = (at, now);
        }
        if now - self.moved >= self.stands {
            let why = if operator.wants_rest() {
                ": the operator holds it, and no resume comes"
            } else if operator.share(false) == 0.0 {
                ": the operator's override is 0 %"
            } else {
                &waiting
                    .map_or_else(String::new, |waiting| format!(": it waits for {}", waiting.what))
            };
            let stands = self.stands.value();
            return Some(format!("given up after {stands:.0} s in which nothing went on{why}"));
        }
        let whole = self.stands * SLOWEST;
        let planned = self.planned.filter(|_| now - begun >= whole)?.value();
        let took = (now - begun).value();
        Some(format!("given up after {took:.0} s, where {planned:.0} s were planned"))
    }
}
