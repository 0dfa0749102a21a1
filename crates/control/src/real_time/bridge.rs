//! In place of the servo thread: a thread that hands on, between the control's rings and those of a
//! servo thread in another process.
//!
//! ```text
//!   control's thread ◄─ rings ─► this one ◄─ shared memory ─► the component in HAL's servo thread: Seat, kernel
//! ```
//!
//! Its looks are the control's sign of life. It is an ordinary thread: what it does late is late
//! for the feeder and for observers, never for the kernel.
use super::ServoMetrics;
use super::servo::{KernelAndMachine, Over, ServoRings};
use crate::clock::now;
use crate::drives::{SeatText, SharedSeat};
use kernel::{Kernel, Reply, Request};
use servo::{Replied, Rings as _, SetUp};
use shm::ControlSide;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Between two looks.
const LOOK: Duration = Duration::from_micros(500);
/// A component that has not counted a period for so long is not moved by HAL any more; a computer
/// without a real-time kernel that is busy holds its threads up for less.
const STANDS_STILL: Duration = Duration::from_secs(2);
/// From one look to the next no more counts of that: a computer that stands still moves nothing.
const HELD_UP: Duration = Duration::from_millis(20);
/// For so long a session may take to begin: the one before comes to rest first.
const BEGINS: Duration = Duration::from_secs(10);
/// For so long the component may take to let go.
const LETS_GO: Duration = Duration::from_secs(10);

/// The thread and what it shares with who has started it: to stop, what to count, why it has ended.
pub(super) type Shared = (Arc<AtomicBool>, Arc<ServoMetrics>, Arc<OnceLock<String>>);

struct Bridge {
    side: ControlSide,
    rings: ServoRings,
    text: SeatText,
    metrics: Arc<ServoMetrics>,
    unobserved: u64,
    /// The last count of its periods, when that was looked at, and for how long it has been the
    /// same.
    periods: u64,
    looked: Instant,
    stands_still: Duration,
}

/// Begin a session with the component, and then hand on until told to stop.
///
/// # Errors
/// The component does not take the control, and why.
pub(super) fn start(
    rings: ServoRings,
    (kernel, mut machine): KernelAndMachine,
    (stop, metrics, why): Shared,
    over: Over,
) -> Result<JoinHandle<KernelAndMachine>, String> {
    let seat = machine.seat().ok_or("this machine has its kernel in this process")?;
    let (side, text) = (begin(seat, &kernel)?, seat.text);
    let (periods, looked, stands_still) = (side.periods(), now(), Duration::ZERO);
    let mut bridge =
        Bridge { side, rings, text, metrics, unobserved: 0, periods, looked, stands_still };
    let thread = std::thread::Builder::new().name("bridge".into());
    let thread = thread.spawn(move || {
        let _over = over;
        while !stop.load(Ordering::Acquire) {
            if let Err(lost) = bridge.turn() {
                let _ = why.set(lost); // it ends once
                break;
            }
            std::thread::sleep(LOOK);
        }
        bridge.end();
        (kernel, machine)
    });
    thread.map_err(|e| format!("no thread can be started: {e}"))
}

/// A session with the component, with a kernel as this one.
fn begin(seat: &mut SharedSeat, kernel: &Kernel) -> Result<ControlSide, String> {
    let name = seat.text.name;
    let mut side = seat.side.take().ok_or_else(|| format!("{name} has been led already"))?;
    let set_up = SetUp {
        config: kernel.config().clone(),
        silent_after: seat.silent_after,
        obeys_after: seat.obeys_after,
        spindles_obey_after: seat.spindles_obey_after,
        watched: seat.watched,
    };
    side.ask(&set_up).map_err(|why| why.to_string())?;
    let asked = now();
    while !side.has_begun().map_err(|why| why.to_string())? {
        if now() - asked > BEGINS {
            return Err(format!("{name} does not answer: {}", seat.text.does_not_begin));
        }
        side.beat();
        std::thread::sleep(LOOK);
    }
    Ok(side)
}

impl Bridge {
    /// Hand on what there is.
    fn turn(&mut self) -> Result<(), String> {
        self.side.beat();
        self.side.stop(self.rings.stops());
        self.is_moved()?;
        self.send_steps();
        self.send_requests()?;
        while let Some(replied) = self.side.reply() {
            let _ = self.rings.replies.push(replied); // one is asked for at a time
        }
        self.hear();
        Ok(())
    }

    /// The component is there, and HAL moves it.
    fn is_moved(&mut self) -> Result<(), String> {
        let (periods, at) = (self.side.periods(), now());
        let since = (at - self.looked).min(HELD_UP);
        self.looked = at;
        if periods == self.periods {
            self.stands_still += since;
        } else {
            (self.periods, self.stands_still) = (periods, Duration::ZERO);
        }
        if !self.side.is_ours() {
            return Err(format!("{} has ended the session", self.text.name));
        }
        if self.stands_still > STANDS_STILL {
            return Err(self.text.stands_still.into());
        }
        Ok(())
    }

    /// Steps as far as in the usual course.
    fn send_steps(&mut self) {
        while !self.side.has_enough_steps() && self.send_step() {}
    }

    fn send_step(&mut self) -> bool {
        let Some(step) = self.rings.next_step() else { return false };
        let is_sent = self.side.send_step(&step);
        self.rings.release(step);
        is_sent
    }

    /// Requests, each after all steps that were sent before it.
    fn send_requests(&mut self) -> Result<(), String> {
        while let Some(request) = self.rings.next_request() {
            while self.send_step() {}
            if let Request::PutTable(_, table) = request {
                // tables do not go to another process: it is answered here that there was no place
                // for it
                let picture = self.side.picture().ok_or("no period has been heard of yet")?;
                let (number, taken) = (picture.number, picture.taken);
                let reply = Reply::Table(Err(table));
                self.rings.reply(Replied { reply, number, picture: picture.picture, taken });
                continue;
            }
            if !self.side.send_request(&request) {
                return Err(format!("{} takes no requests any more", self.text.name));
            }
        }
        Ok(())
    }

    /// What was said up to a record is heard before it is looked at.
    fn hear(&mut self) {
        let records = self.side.records_waiting();
        while let Some(said) = self.side.said() {
            self.rings.say(said);
        }
        for _ in 0..records {
            let Some(record) = self.side.record() else { break };
            self.metrics.period();
            if self.rings.records.push(record).is_err() {
                self.metrics.unobserved();
            }
        }
        while self.unobserved < self.side.unobserved() {
            self.metrics.unobserved();
            self.unobserved += 1;
        }
    }

    /// The component stops what moves, and lets go.
    fn end(&mut self) {
        self.side.end();
        let asked = now();
        while self.side.is_ours() && now() - asked < LETS_GO && self.is_moved().is_ok() {
            self.side.beat();
            self.hear();
            std::thread::sleep(LOOK);
        }
    }
}
