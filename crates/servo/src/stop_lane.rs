//! Stops that wait in no queue: flags that the next servo period reads.
//!
//! ```text
//!   any thread ──ask──► a flag a kind ──next period──► the kernel, before its tick
//!        └──────────────── the same request in its queue ──► the control: mode, answer, events
//! ```
//!
//! A flag only brings to rest what moves; what the control makes of the stop follows with the
//! request. Two askers of one stop in one period are one stop. Where nothing moves that a kind of
//! stop is for, its flag does nothing: it is not kept for what begins later.
use core::sync::atomic::{AtomicU32, Ordering};
use kernel::{FaultKind, Kernel, Order};

/// A stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LaneStop {
    /// Hold the feed.
    FeedHold,
    /// Give the program up.
    Stop,
    /// Bring to rest what is moved by hand, and what is homed.
    JogStop,
    /// All outputs off, as by the emergency stop chain.
    EmergencyStop,
    /// Halt: the servo thread did not take what the control has asked of it.
    NotTaken,
}

impl LaneStop {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::FeedHold, Self::Stop, Self::JogStop, Self::EmergencyStop, Self::NotTaken];

    const fn bit(self) -> u32 {
        1 << self as u32
    }

    /// Its flag is set.
    pub const fn is_in(self, flags: u32) -> bool {
        flags & self.bit() != 0
    }
}

/// Flags that any thread sets and the servo thread takes.
#[derive(Debug, Default)]
pub struct StopLane(AtomicU32);

impl StopLane {
    /// Sets the flag of a stop: the next period acts on it.
    pub fn ask(&self, stop: LaneStop) {
        self.0.fetch_or(stop.bit(), Ordering::Release);
    }

    /// Sets the flags of another lane.
    pub fn ask_all(&self, flags: u32) {
        self.0.fetch_or(flags, Ordering::Release);
    }

    /// Takes back the flag of a stop, which the next period would act on.
    pub fn withdraw(&self, stop: LaneStop) {
        self.0.fetch_and(!stop.bit(), Ordering::AcqRel);
    }

    /// Takes all flags that are set.
    pub fn take(&self) -> u32 {
        // a period in which nothing is asked writes nothing
        if self.0.load(Ordering::Relaxed) == 0 { 0 } else { self.0.swap(0, Ordering::AcqRel) }
    }
}

/// Acts on flags, before a tick.
pub fn stop(kernel: &mut Kernel, flags: u32) {
    if flags == 0 {
        return;
    }
    if LaneStop::EmergencyStop.is_in(flags) {
        kernel.report_control(FaultKind::EmergencyStop);
    } else if LaneStop::NotTaken.is_in(flags) {
        kernel.report_control(FaultKind::RequestsNotTaken);
    }
    // a tool that is being taken out goes on: what it ends in is the safest place
    let executes = !kernel.is_idle() && !kernel.is_off() && !kernel.is_recovering();
    if executes && LaneStop::Stop.is_in(flags) {
        kernel.order(Order::Abort);
    } else if executes && LaneStop::FeedHold.is_in(flags) && !kernel.operator().is_ordered_to_rest()
    {
        kernel.order(Order::FeedHold);
    }
    if LaneStop::JogStop.is_in(flags) {
        if kernel.homing().next().is_some() {
            kernel.order(Order::FeedHold);
        }
        kernel.rest_manually();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stop_has_a_flag_of_its_own_and_is_taken_once() {
        let lane = StopLane::default();
        assert_eq!(lane.take(), 0);
        for stop in LaneStop::ALL {
            lane.ask(stop);
            lane.ask(stop);
            let flags = lane.take();
            let set = LaneStop::ALL.into_iter().filter(|other| other.is_in(flags));
            assert!(set.eq([stop]), "{stop:?}");
            assert_eq!(lane.take(), 0, "{stop:?}");
        }
    }

    #[test]
    fn a_stop_that_is_taken_back_leaves_the_others() {
        let lane = StopLane::default();
        for stop in LaneStop::ALL {
            lane.ask(stop);
        }
        lane.withdraw(LaneStop::EmergencyStop);
        let flags = lane.take();
        for stop in LaneStop::ALL {
            assert_eq!(stop.is_in(flags), stop != LaneStop::EmergencyStop, "{stop:?}");
        }
    }
}
