//! How many requests are answered in a second. Who floods the server waits for his turn, and takes
//! no processor meanwhile; a stop waits for none.
//!
//! ```text
//!   request ─► a turn is due each 0.5 ms, 400 may be taken at once ─► its handler ─► answer
//!   stop    ─► its handler ─────────────────────────────► a turn ───────────────► answer
//! ```
//!
//! A connection has one request under way. So no more wait than there are connections, none for
//! longer than these take.
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// In an answer: its request has waited for its turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paced;

/// Time from one turn to the next.
const EACH: Duration = Duration::from_micros(500);
/// Turns that may be taken at once after a pause.
const AT_ONCE: u32 = 400;
/// The same of the requests of one WebSocket, beyond which they are refused.
const OF_A_SOCKET: (Duration, u32) = (Duration::from_millis(2), 100);

/// Turns, one after another (the generic cell rate algorithm of ITU-T I.371).
#[derive(Debug)]
struct Turns {
    each: Duration,
    at_once: u32,
    /// When the next turn would be due, had none been saved.
    due: Option<Instant>,
}

impl Turns {
    const fn new(each: Duration, at_once: u32) -> Self {
        Self { each, at_once, due: None }
    }

    /// When a turn that would be taken now is due.
    fn next(&self, now: Instant) -> Instant {
        self.due.map_or(now, |due| due.max(now))
    }

    /// Gives a turn back that is not waited for any more.
    fn give_back(&mut self) {
        self.due = self.due.and_then(|due| due.checked_sub(self.each));
    }

    /// Takes a turn; how long until it has come.
    fn take(&mut self, now: Instant) -> Duration {
        let due = self.next(now);
        self.due = Some(due + self.each);
        due.saturating_duration_since(now + self.each * self.at_once)
    }
}

/// Turns of all requests of a server that are not stops.
#[derive(Debug)]
pub(crate) struct RequestPace(Mutex<Turns>);

impl Default for RequestPace {
    fn default() -> Self {
        Self(Mutex::new(Turns::new(EACH, AT_ONCE)))
    }
}

impl RequestPace {
    fn turns(&self) -> MutexGuard<'_, Turns> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the turn of a request.
    pub(crate) async fn turn(&self) {
        let wait = self.turns().take(control::clock::now());
        if wait > Duration::ZERO {
            let mut awaited = AwaitedTurn { pace: self, has_come: false };
            tokio::time::sleep(wait).await;
            awaited.has_come = true;
        }
    }
}

/// A turn that a request waits for. It is given back where the client breaks off: turns of clients
/// that are gone would hold up all others.
struct AwaitedTurn<'a> {
    pace: &'a RequestPace,
    has_come: bool,
}

impl Drop for AwaitedTurn<'_> {
    fn drop(&mut self) {
        if !self.has_come {
            self.pace.turns().give_back();
        }
    }
}

/// Turns of the requests of one WebSocket.
#[derive(Debug)]
pub(crate) struct SocketPace(Turns);

impl Default for SocketPace {
    fn default() -> Self {
        Self(Turns::new(OF_A_SOCKET.0, OF_A_SOCKET.1))
    }
}

impl SocketPace {
    /// Whether one more has its turn at once.
    pub(crate) fn has_turn(&mut self) -> bool {
        let now = control::clock::now();
        let ahead = self.0.next(now).saturating_duration_since(now);
        let has = ahead <= OF_A_SOCKET.0 * OF_A_SOCKET.1;
        if has {
            self.0.take(now);
        }
        has
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::future::Future as _;
    use std::task::{Context, Waker};

    #[test]
    fn so_many_come_at_once_and_each_other_one_a_turn_later() {
        let mut turns = Turns::new(Duration::from_millis(2), 3);
        let now = control::clock::now();
        let waits: Vec<_> = (0..6).map(|_| turns.take(now).as_millis()).collect();
        assert_eq!(waits, [0, 0, 0, 0, 2, 4]);
        let later = now + Duration::from_millis(9);
        assert_eq!(turns.take(later).as_millis(), 0, "12 ms are taken, 9 are over");
        let much_later = now + Duration::from_mins(1);
        let waits: Vec<_> = (0..5).map(|_| turns.take(much_later).as_millis()).collect();
        assert_eq!(waits, [0, 0, 0, 0, 2], "a pause is worth no more than four");
    }

    #[test]
    fn turns_of_requests_that_are_broken_off_hold_up_no_other() {
        let pace = RequestPace::default();
        let mut context = Context::from_waker(Waker::noop());
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        let runtime = runtime.expect("it is built");
        let _entered = runtime.enter();
        for _ in 0..100 * AT_ONCE {
            // who comes, and goes at once
            let mut turn = std::pin::pin!(pace.turn());
            let _ = turn.as_mut().poll(&mut context);
        }
        let wait = pace.turns().take(control::clock::now());
        assert!(wait <= EACH, "{wait:?}");
    }

    #[test]
    fn a_socket_that_floods_is_refused_and_goes_on_afterwards() {
        let mut socket = SocketPace::default();
        let taken = (0..1000).filter(|_| socket.has_turn()).count();
        assert!((100..200).contains(&taken), "{taken}");
    }
}
