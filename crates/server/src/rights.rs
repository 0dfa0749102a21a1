//! Sessions, and which of them commands.
//!
//! ```text
//!   free ──first request──► held by A ──B asks──► held by A, B asks ──grant, or 10 s──► held by B
//!    ▲                         │  ▲                      │
//!    └── release, or A is gone ┘  └────────keep──────────┘
//! ```
//!
//! What stops the machine is allowed to every session of the role operator.
use crate::wire::{OperatorBody, OperatorOrder};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Sessions that there may be.
const MOST_SESSIONS: usize = 64;
/// The right is handed over to the session that asks for it after so long without an answer, and is
/// free again when its holder has been gone for so long.
pub(crate) const HANDS_OVER: Duration = Duration::from_secs(10);
/// A session that has been gone for so long is forgotten.
const FORGOTTEN: Duration = Duration::from_hours(1);
/// Longest name of a session.
const LONGEST_NAME: usize = 40;

/// What helps where a token has expired.
pub(crate) const NEW_TOKEN: &str =
    "make another one with leadscrew serve --new-token FILE, and start the server again";

/// What a session may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// See.
    Viewer,
    /// See and command.
    Operator,
}

impl Role {
    /// As files and answers have it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Viewer => "viewer",
            Self::Operator => "operator",
        }
    }
}

/// Why something is not allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Denied {
    /// The session or the token is not known.
    Unknown,
    /// The token that the session was opened with is over.
    Expired,
    /// The role does not allow it.
    Viewer,
    /// Another session commands.
    Held(String),
    /// Only who commands can do that.
    NotHolder,
    /// There are too many sessions.
    Full,
    /// A name is needed.
    Name,
}

impl core::fmt::Display for Denied {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unknown => f.write_str("the session is not known"),
            Self::Expired => f.write_str("the token has expired"),
            Self::Viewer => f.write_str("a viewer may not command the machine"),
            Self::Held(name) => write!(f, "{name} commands the machine"),
            Self::NotHolder => f.write_str("this session does not command the machine"),
            Self::Full => write!(f, "there are {MOST_SESSIONS} sessions already"),
            Self::Name => write!(f, "a session has a name of 1 to {LONGEST_NAME} characters"),
        }
    }
}

impl Denied {
    /// What would make it possible.
    pub(crate) const fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Unknown => Some("open a session with POST /api/v1/session"),
            Self::Expired => Some(NEW_TOKEN),
            Self::Held(_) => Some("ask for the right to command"),
            _ => None,
        }
    }
}

#[derive(Clone, Debug)]
struct Session {
    name: String,
    role: Role,
    sockets: usize,
    seen: Instant,
    /// Its token is over then; `None`: never, or there is none.
    until: Option<Instant>,
}

impl Session {
    fn has_expired(&self, now: Instant) -> bool {
        self.until.is_some_and(|until| now >= until)
    }
}

/// Sessions, and the right to command.
#[derive(Debug, Default)]
pub(crate) struct Rights {
    sessions: HashMap<String, Session>,
    holder: Option<String>,
    asked: Option<(String, Instant)>,
}

impl Rights {
    /// A new session with this id; `left`: its token lasts so long.
    ///
    /// # Errors
    /// There are too many, or its name is none.
    pub(crate) fn open(
        &mut self,
        id: &str,
        name: &str,
        (role, left): (Role, Option<Duration>),
        now: Instant,
    ) -> Result<(), Denied> {
        let name = name.trim();
        if name.is_empty() || name.chars().count() > LONGEST_NAME || name.contains(char::is_control)
        {
            return Err(Denied::Name);
        }
        self.sessions.retain(|_, session| session.sockets > 0 || now - session.seen < FORGOTTEN);
        if self.sessions.len() >= MOST_SESSIONS && !self.sessions.contains_key(id) {
            // the one that has been gone for longest makes room
            let oldest = self.sessions.iter().filter(|(key, session)| {
                session.sockets == 0
                    && now - session.seen > HANDS_OVER
                    && self.holder.as_ref() != Some(*key)
            });
            let oldest = oldest.min_by_key(|(_, session)| session.seen).map(|(key, _)| key.clone());
            self.sessions.remove(&oldest.ok_or(Denied::Full)?);
        }
        let until = left.and_then(|left| now.checked_add(left));
        let session = Session { name: name.to_owned(), role, sockets: 0, seen: now, until };
        self.sessions.entry(id.to_owned()).or_insert(session);
        Ok(())
    }

    /// Who it is; it is here.
    ///
    /// # Errors
    /// It is not known.
    pub(crate) fn seen(&mut self, id: &str, now: Instant) -> Result<(String, Role), Denied> {
        let session = self.sessions.get_mut(id).ok_or(Denied::Unknown)?;
        if session.has_expired(now) {
            return Err(Denied::Expired);
        }
        session.seen = now;
        Ok((session.name.clone(), session.role))
    }

    /// Its token is over.
    pub(crate) fn has_expired(&self, id: &str, now: Instant) -> bool {
        self.sessions.get(id).is_some_and(|session| session.has_expired(now))
    }

    /// A socket of it is opened (true) or gone.
    pub(crate) fn socket(&mut self, id: &str, is_open: bool, now: Instant) {
        if let Some(session) = self.sessions.get_mut(id) {
            session.seen = now;
            session.sockets =
                if is_open { session.sockets + 1 } else { session.sockets.saturating_sub(1) };
        }
    }

    /// What time has decided.
    fn settle(&mut self, now: Instant) {
        let is_gone = |id: &String| {
            let session = self.sessions.get(id);
            session.is_none_or(|s| {
                s.has_expired(now) || (s.sockets == 0 && now - s.seen >= HANDS_OVER)
            })
        };
        if self.asked.as_ref().is_some_and(|(id, _)| is_gone(id)) {
            self.asked = None;
        }
        if self.holder.as_ref().is_some_and(is_gone) {
            self.holder = None;
        }
        if let Some((id, since)) = &self.asked
            && (self.holder.is_none() || now - *since >= HANDS_OVER)
        {
            self.holder = Some(id.clone());
            self.asked = None;
        }
    }

    /// Whether a session may ask something of the control; the first that does has the right.
    ///
    /// # Errors
    /// It may not, and why.
    pub(crate) fn may_command(
        &mut self,
        id: &str,
        is_stop: bool,
        now: Instant,
    ) -> Result<(), Denied> {
        let (_, role) = self.seen(id, now)?;
        self.settle(now);
        if role == Role::Viewer {
            return Err(Denied::Viewer);
        }
        match &self.holder {
            Some(holder) if holder == id => Ok(()),
            _ if is_stop => Ok(()),
            Some(holder) => Err(Denied::Held(self.name_of(holder))),
            None => {
                self.holder = Some(id.to_owned());
                Ok(())
            }
        }
    }

    /// It has the right now.
    pub(crate) fn commands(&mut self, id: &str, now: Instant) -> bool {
        self.settle(now);
        self.holder.as_deref() == Some(id)
    }

    /// Ask for the right, hand it over, keep it, give it back.
    ///
    /// # Errors
    /// The session may not.
    pub(crate) fn order(
        &mut self,
        id: &str,
        order: OperatorOrder,
        now: Instant,
    ) -> Result<(), Denied> {
        let (_, role) = self.seen(id, now)?;
        self.settle(now);
        if role == Role::Viewer {
            return Err(Denied::Viewer);
        }
        let holds = self.holder.as_deref() == Some(id);
        match order {
            OperatorOrder::Ask {} => match (&self.holder, &self.asked) {
                (None, _) => self.holder = Some(id.to_owned()),
                (Some(_), None) if !holds => self.asked = Some((id.to_owned(), now)),
                _ => {} // it has it, or another one has asked before
            },
            _ if !holds => return Err(Denied::NotHolder),
            OperatorOrder::Grant {} => {
                if let Some((next, _)) = self.asked.take() {
                    self.holder = Some(next);
                }
            }
            OperatorOrder::Keep {} => self.asked = None,
            OperatorOrder::Release {} => {
                self.holder = None;
                self.settle(now);
            }
        }
        Ok(())
    }

    /// Who commands, for everyone to see.
    pub(crate) fn shown(&mut self, now: Instant) -> OperatorBody {
        self.settle(now);
        let left = |since: Instant| HANDS_OVER.saturating_sub(now - since).as_secs_f64();
        OperatorBody {
            holder: self.holder.as_ref().map(|id| self.name_of(id)),
            asked_by: self.asked.as_ref().map(|(id, _)| self.name_of(id)),
            hands_over_in_s: self.asked.as_ref().map(|(_, since)| left(*since)),
        }
    }

    fn name_of(&self, id: &str) -> String {
        self.sessions.get(id).map_or_else(String::new, |session| session.name.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_two(now: Instant) -> Rights {
        let mut rights = Rights::default();
        for id in ["a", "b"] {
            rights.open(id, &format!("desk {id}"), (Role::Operator, None), now).expect("room");
            rights.socket(id, true, now);
        }
        rights
    }

    #[test]
    fn the_first_that_asks_for_something_commands_and_another_one_may_only_stop() {
        let now = control::clock::now();
        let mut rights = of_two(now);
        assert_eq!(rights.may_command("a", false, now), Ok(()));
        assert_eq!(rights.may_command("b", false, now), Err(Denied::Held("desk a".into())));
        assert_eq!(rights.may_command("b", true, now), Ok(()));
        assert!(rights.commands("a", now), "a stop by another one takes nothing away");
    }

    #[test]
    fn a_session_ends_with_its_token_and_gives_the_right_back() {
        let now = control::clock::now();
        let mut rights = of_two(now);
        let minute = Duration::from_mins(1);
        rights.open("t", "tablet", (Role::Operator, Some(minute)), now).expect("room");
        rights.socket("t", true, now);
        assert_eq!(rights.may_command("t", false, now), Ok(()));
        assert!(!rights.has_expired("t", now));
        let over = now + minute;
        assert!(rights.has_expired("t", over));
        assert_eq!(rights.may_command("t", false, over), Err(Denied::Expired));
        assert_eq!(rights.may_command("t", true, over), Err(Denied::Expired));
        assert_eq!(rights.may_command("a", false, over), Ok(()), "the right is free");
    }

    #[test]
    fn the_right_is_handed_over_by_its_holder_or_after_ten_seconds() {
        let now = control::clock::now();
        let mut rights = of_two(now);
        rights.may_command("a", false, now).expect("free");
        rights.order("b", OperatorOrder::Ask {}, now).expect("an operator");
        assert!(rights.commands("a", now + Duration::from_secs(9)));
        assert!(rights.commands("b", now + HANDS_OVER));
        let later = now + HANDS_OVER;
        rights.order("a", OperatorOrder::Ask {}, later).expect("an operator");
        assert_eq!(rights.order("a", OperatorOrder::Grant {}, later), Err(Denied::NotHolder));
        rights.order("b", OperatorOrder::Keep {}, later).expect("it holds it");
        assert!(rights.commands("b", later + HANDS_OVER * 2), "it was kept");
        let later = later + HANDS_OVER * 2;
        rights.order("a", OperatorOrder::Ask {}, later).expect("an operator");
        rights.order("b", OperatorOrder::Grant {}, later).expect("it holds it");
        assert!(rights.commands("a", later));
    }

    #[test]
    fn a_holder_that_is_gone_holds_nothing() {
        let now = control::clock::now();
        let mut rights = of_two(now);
        rights.may_command("a", false, now).expect("free");
        rights.socket("a", false, now);
        assert!(rights.may_command("b", false, now + Duration::from_secs(9)).is_err());
        assert_eq!(rights.may_command("b", false, now + HANDS_OVER), Ok(()));
    }

    #[test]
    fn a_viewer_commands_nothing_not_even_a_stop() {
        let now = control::clock::now();
        let mut rights = Rights::default();
        rights.open("v", "wall", (Role::Viewer, None), now).expect("room");
        assert_eq!(rights.may_command("v", true, now), Err(Denied::Viewer));
        assert_eq!(rights.order("v", OperatorOrder::Ask {}, now), Err(Denied::Viewer));
    }
}
