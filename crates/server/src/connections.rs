//! Open connections: where there are too many, an idle one is closed for a new one, and viewers
//! leave places for operators.
//!
//! ```text
//!   accepted ──► no request yet ──► a viewer's (192 at once with a request under way)
//!                   │          └──► an operator's
//!                   └─ closed first, the one that has been silent for longest
//! ```
use crate::role::Role;
use axum::body::{Body, Bytes, HttpBody};
use control::clock::now;
use hyper::body::{Frame, SizeHint};
use std::collections::HashMap;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::Instant;
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};

/// Connections at once.
const MOST: usize = 256;
/// Most connections of viewers with something under way.
const MOST_VIEWERS: usize = 192;

/// The connections that are open.
#[derive(Debug, Default)]
pub(crate) struct Connections {
    open: Mutex<HashMap<u64, Open>>,
}

#[derive(Debug)]
struct Open {
    /// Role of the last request; `None` before the first, and where it needs no role.
    role: Option<Role>,
    /// Answers that are on their way.
    under_way: usize,
    /// When something has come, or an answer has ended.
    heard: Instant,
    closes: Arc<Notify>,
}

/// A connection, as long as it is open.
#[derive(Debug)]
pub(crate) struct Connection {
    number: u64,
    all: Arc<Connections>,
    closes: Arc<Notify>,
}

impl Connections {
    fn lock(&self) -> MutexGuard<'_, HashMap<u64, Open>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for a new connection; `None`: on all others something is under way.
    pub(crate) fn open(self: &Arc<Self>, number: u64) -> Option<Arc<Connection>> {
        let mut open = self.lock();
        if open.len() >= MOST {
            let silent = open.iter().filter(|(_, one)| one.under_way == 0);
            // those that have asked for nothing first, then as long as they are silent
            let first = silent.min_by_key(|(_, one)| (one.role.is_some(), one.heard));
            let first = first.map(|(number, _)| *number)?;
            if let Some(gone) = open.remove(&first) {
                gone.closes.notify_one();
            }
        }
        let closes = Arc::new(Notify::new());
        let (role, under_way, heard) = (None, 0, now());
        open.insert(number, Open { role, under_way, heard, closes: Arc::clone(&closes) });
        Some(Arc::new(Connection { number, all: Arc::clone(self), closes }))
    }
}

impl Connection {
    /// Until it has to give way.
    pub(crate) async fn gives_way(&self) {
        self.closes.notified().await;
    }

    /// A request has come; it is under way as long as the result is kept.
    pub(crate) fn asks(self: &Arc<Self>) -> UnderWay {
        self.change(|open| open.under_way += 1);
        UnderWay(Arc::clone(self))
    }

    fn change(&self, change: impl FnOnce(&mut Open)) {
        if let Some(open) = self.all.lock().get_mut(&self.number) {
            open.heard = now();
            change(open);
        }
    }

    /// Who asks is known; false: there are too many who only watch.
    pub(crate) fn is_of(&self, role: Role) -> bool {
        let mut all = self.all.lock();
        if let Some(open) = all.get_mut(&self.number) {
            open.role = Some(role);
        }
        let is_viewers = |one: &&Open| one.role == Some(Role::Viewer) && one.under_way > 0;
        role == Role::Operator || all.values().filter(is_viewers).count() <= MOST_VIEWERS
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.all.lock().remove(&self.number);
    }
}

/// A request that is answered.
#[derive(Debug)]
pub(crate) struct UnderWay(Arc<Connection>);

impl Drop for UnderWay {
    fn drop(&mut self) {
        self.0.change(|open| open.under_way = open.under_way.saturating_sub(1));
    }
}

/// The body of an answer, which is under way until it has been taken.
pub(crate) struct AnsweredBody {
    body: Body,
    /// Ends with it.
    _under_way: UnderWay,
}

impl AnsweredBody {
    pub(crate) const fn new(body: Body, under_way: UnderWay) -> Self {
        Self { body, _under_way: under_way }
    }
}

impl HttpBody for AnsweredBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// Places of one kind, some of which viewers cannot take.
#[derive(Debug)]
pub(crate) struct Places {
    all: Arc<Semaphore>,
    viewers: Arc<Semaphore>,
}

/// A place, as long as it is kept.
#[derive(Debug)]
pub(crate) struct TakenPlace {
    _all: OwnedSemaphorePermit,
    _of_viewers: Option<OwnedSemaphorePermit>,
}

impl Places {
    /// Creates this many places, with the most that viewers may take.
    pub(crate) fn new(all: usize, viewers: usize) -> Self {
        Self { all: Arc::new(Semaphore::new(all)), viewers: Arc::new(Semaphore::new(viewers)) }
    }

    /// One of them, if there is one for this role.
    pub(crate) fn take(&self, role: Role) -> Option<TakenPlace> {
        let of_viewers = match role {
            Role::Operator => None,
            Role::Viewer => Some(Arc::clone(&self.viewers).try_acquire_owned().ok()?),
        };
        let all = Arc::clone(&self.all).try_acquire_owned().ok()?;
        Some(TakenPlace { _all: all, _of_viewers: of_viewers })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_silent_gives_way_and_who_is_answered_does_not() {
        let all = Arc::new(Connections::default());
        let open: Vec<_> = (0..MOST as u64).map(|n| all.open(n).expect("room")).collect();
        // the first is answered, the second has been, the third has said nothing for longest
        let busy = open[0].asks();
        assert!(open[1].is_of(Role::Operator));
        let another = all.open(1000).expect("the third gives way");
        let is_open = |number: u64| all.lock().contains_key(&number);
        assert!(is_open(0) && is_open(1) && !is_open(2) && is_open(1000));
        drop(another);
        assert!(!is_open(1000));
        let answers: Vec<_> = open.iter().map(Connection::asks).collect();
        let _last = all.open(1001).expect("one has gone").asks();
        assert!(all.open(1002).is_none(), "all are answered");
        drop((busy, answers));
        assert!(all.open(1002).is_some());
    }

    #[test]
    fn viewers_leave_places_for_operators() {
        let places = Places::new(3, 2);
        let viewers: Vec<_> = (0..2).map(|_| places.take(Role::Viewer).expect("room")).collect();
        assert!(places.take(Role::Viewer).is_none());
        let operator = places.take(Role::Operator);
        assert!(operator.is_some() && places.take(Role::Operator).is_none());
        drop(viewers);
        assert!(places.take(Role::Operator).is_some());

        let all = Arc::new(Connections::default());
        let open: Vec<_> = (0..=MOST_VIEWERS as u64).map(|n| all.open(n).expect("room")).collect();
        let mut answers: Vec<_> = open.iter().map(Connection::asks).collect();
        let (last, watch) = open.split_last().expect("there are some");
        assert!(watch.iter().all(|one| one.is_of(Role::Viewer)));
        assert!(!last.is_of(Role::Viewer), "one too many");
        assert!(last.is_of(Role::Operator));
        answers.truncate(MOST_VIEWERS - 1);
        assert!(last.is_of(Role::Viewer));
    }
}
