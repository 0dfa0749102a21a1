//! The time that `ethercrab` reads: the one that was set last in the thread that polls it.
//!
//! `ethercrab` asks `embassy-time` how late it is; that asks the one driver of the program, which
//! is here. Each thread has a time of its own, set from its [`crate::FrameLink`] before it polls:
//! two masters in two threads, or two tests, do not know of one another.
use core::task::Waker;
use embassy_time_driver::{Driver, TICK_HZ, time_driver_impl};
use std::cell::Cell;

thread_local! {
    static NOW_NS: Cell<u64> = const { Cell::new(0) };
}

/// Sets the time of this thread.
pub(crate) fn set(now_ns: u64) {
    NOW_NS.set(now_ns);
}

/// Time of this thread.
pub(crate) fn now_ns() -> u64 {
    NOW_NS.get()
}

struct ThreadClock;

impl Driver for ThreadClock {
    fn now(&self) -> u64 {
        let ticks = u128::from(now_ns()) * u128::from(TICK_HZ) / 1_000_000_000;
        ticks as u64
    }

    /// Nothing is woken: the exchange polls whenever a frame has come or time has passed.
    fn schedule_wake(&self, _at: u64, _waker: &Waker) {}
}

time_driver_impl!(static CLOCK: ThreadClock = ThreadClock);
