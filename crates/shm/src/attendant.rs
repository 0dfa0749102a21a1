//! The thread beside the servo thread: it makes the kernels that controls ask for, because that
//! takes memory, and releases them.
use crate::session::{ControlSession, ServoProcessOptions};
use crate::{Made, ServoSide, SetUps};
use bus::{AXES, WatchedInputs};
use kernel::Kernel;
use rtrb::{Consumer, Producer};
use servo::{Seat, SetUp};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Acquire};
use std::thread::JoinHandle;
use std::time::Duration;

/// It looks so often whether a control asks.
const LOOK: Duration = Duration::from_millis(10);
/// The servo thread runs within so long after the process has begun.
const FIRST_PERIOD: Duration = Duration::from_secs(2);
/// By so much of itself the period that is kept may differ from the one that the control was set
/// up for.
const PERIOD_SHARE: f64 = 1e-3;
/// A control may be silent for so long at most, s.
const LONGEST_SILENCE_S: f64 = 5.0;

/// Letters of the axes, in the order of their numbers.
const LETTERS: [char; AXES] = ['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'];

/// The thread, until it is dropped.
#[derive(Debug)]
pub(crate) struct Attendant {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What it works with.
pub(crate) struct Desk {
    pub(crate) made: Arc<Made>,
    pub(crate) has: ServoProcessOptions,
    /// The servo period that is kept, ns; 0: not known yet.
    pub(crate) period: Arc<AtomicU64>,
    /// Inputs that something drives, by their bits.
    pub(crate) driven: Arc<AtomicU64>,
    /// To the servo thread.
    pub(crate) begin: Producer<Box<ControlSession>>,
    /// Back from it.
    pub(crate) over: Consumer<Box<ControlSession>>,
}

impl Attendant {
    /// The thread begins.
    ///
    /// # Errors
    /// The operating system has none.
    pub(crate) fn start(mut desk: Desk) -> Result<Self, String> {
        let stop = Arc::new(AtomicBool::new(false));
        let mut set_ups = SetUps::new(&desk.made);
        let told = Arc::clone(&stop);
        let thread = std::thread::Builder::new().name("leadscrew".into());
        let thread = thread.spawn(move || {
            while !told.load(Acquire) {
                while desk.over.pop().is_ok() {} // its memory is released here
                desk.attend(&mut set_ups);
                std::thread::sleep(LOOK);
            }
        });
        let thread = thread.map_err(|e| format!("no thread can be started: {e}"))?;
        Ok(Self { stop, thread: Some(thread) })
    }
}

impl Drop for Attendant {
    fn drop(&mut self) {
        self.stop.store(true, std::sync::atomic::Ordering::Release);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join(); // one that has panicked has said so
        }
    }
}

impl Desk {
    fn attend(&mut self, set_ups: &mut SetUps) {
        while let Some((session, asked)) = set_ups.take() {
            let made = asked.and_then(|set_up| self.session(session, set_up));
            let handed = made.and_then(|session| {
                self.begin
                    .push(session)
                    .map_err(|_| "a control that came before has not begun yet".to_owned())
            });
            if let Err(why) = handed {
                set_ups.refuse(session, &why);
            }
        }
    }

    /// The period that is kept; a process that has just begun is given a moment. 0: none is.
    fn first_period(&self) -> u64 {
        for _ in 0..FIRST_PERIOD.as_millis() / LOOK.as_millis() {
            match self.period.load(Acquire) {
                0 => std::thread::sleep(LOOK),
                period => return period,
            }
        }
        0
    }

    /// A kernel as it was asked for, or why there is none.
    fn session(&self, session: u32, set_up: SetUp) -> Result<Box<ControlSession>, String> {
        let mut wrong = Vec::new();
        set_up.config.problems(|problem| wrong.push(problem.to_string()));
        if !wrong.is_empty() {
            return Err(wrong.join("; "));
        }
        let (period, asked) = (self.first_period(), set_up.config.period.value());
        if period == 0 {
            return Err(self.has.not_called.into());
        }
        let keeps = period as f64 / 1e9;
        if (asked - keeps).abs() > keeps * PERIOD_SHARE {
            return Err(format!(
                "the servo thread has a period of {} µs and the machine's file one of {} µs: control.servo_period_us = {} would fit",
                keeps * 1e6,
                asked * 1e6,
                keeps * 1e6
            ));
        }
        let axes = set_up.config.axes.iter().zip(self.has.axes).zip(LETTERS);
        for ((asked, has), letter) in axes {
            if asked.is_some() && !has {
                let missing = (self.has.axis_missing)(letter);
                return Err(format!("the machine has an axis {letter}, and {missing}"));
            }
        }
        let spindles = set_up.config.spindles.iter().flatten().count();
        if spindles > self.has.spindles {
            return Err(format!(
                "the machine has {spindles} spindles, and {} are led here",
                self.has.spindles
            ));
        }
        let driven = WatchedInputs::of_bits(self.driven.load(Acquire));
        let undriven: Vec<String> =
            set_up.watched.without(driven).map(|input| input.to_string()).collect();
        if !undriven.is_empty() {
            return Err((self.has.undriven)(&undriven.join(", ")));
        }
        let silent = set_up.silent_after.value();
        if !(silent >= keeps && silent <= LONGEST_SILENCE_S) {
            return Err(format!(
                "a control may be silent for {keeps} to {LONGEST_SILENCE_S} s, and this one asks for {silent} s"
            ));
        }
        let most_silent_ns = (silent * 1e9) as i64;
        let mut kernel = Box::new(Kernel::new(set_up.config));
        kernel.switch_off(); // until its control says otherwise
        let seat = Seat::new(kernel, ServoSide::new(&self.made, session));
        let obeys_after = (set_up.obeys_after, set_up.spindles_obey_after);
        Ok(Box::new(ControlSession { seat, obeys_after, watched: set_up.watched, most_silent_ns }))
    }
}
