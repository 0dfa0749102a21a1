//! Sessions, to whom they belong, and which of them commands.
//!
//! ```text
//!   free ──first request──► held by A ──B asks──► held by A, B asks ──grant, or 10 s──► held by B
//!    ▲                         │  ▲                      │
//!    └── release, or A is gone ┘  └────────keep──────────┘
//! ```
//!
//! A session is found by its secret, which the server has drawn, or by the credential of who asks
//! (a token, or that he is on this computer), which has one session of its own. Within the server
//! it is a [`SessionId`], a number that no client can write. A name is for people to read: none is
//! looked up. What a session may do is looked up at its credential each time, so that it ends when
//! the token is taken out of the file, and when its time is over.
//!
//! What stops the machine is allowed to every session of the role operator. Who presses a key of
//! the panel stands at the machine: the panel commands from then on, until no key of it has been
//! pressed for [`HANDS_OVER`].
use crate::clock::Clock;
use crate::role::Role;
use crate::tokens::{Known, NoToken, Tokens, hash, random};
use crate::wire::{OperatorBody, OperatorOrder};
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Sessions that there may be.
const MOST_SESSIONS: usize = 64;
/// Most sessions of viewers: the rest is for operators.
const MOST_VIEWERS: usize = 32;
/// The right is handed over to the session that asks for it after so long without an answer, and is
/// free again when its holder has been gone for so long.
pub(crate) const HANDS_OVER: Duration = Duration::from_secs(10);
/// A session that has been gone for so long is forgotten.
const FORGOTTEN: Duration = Duration::from_hours(1);
/// Longest name of a session.
const LONGEST_NAME: usize = 40;
/// Name of clients on this computer that do not give one.
const LOCAL: &str = "local";
/// How the panel beside the machine is named.
const PANEL: &str = "the panel";

/// What helps where a token has expired.
pub(crate) const NEW_TOKEN: &str =
    "make another one with leadscrew serve --new-token FILE, in the file that the server uses";

/// Why something is not allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Denied {
    /// The session is not known.
    Unknown,
    /// There is no token, or it is not known.
    NoToken,
    /// The token that the session was opened with is over.
    Expired,
    /// The token that the session was opened with is no longer in the file.
    Revoked,
    /// The session was opened with another token than the one that is sent.
    AnothersSession,
    /// The role does not allow it.
    Viewer,
    /// Another session commands.
    Held(String),
    /// Only who commands can do that.
    NotHolder,
    /// There are too many sessions.
    Full,
    /// The system gives no random numbers.
    NoSecret(String),
    /// A name is needed.
    Name,
}

impl core::fmt::Display for Denied {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Unknown => f.write_str("the session is not known"),
            Self::NoToken => f.write_str("a token is needed, and this is none"),
            Self::Expired => f.write_str("the token has expired"),
            Self::Revoked => f.write_str("the token is no longer in the file of tokens"),
            Self::AnothersSession => f.write_str("the session was opened with another token"),
            Self::Viewer => f.write_str("a viewer may not command the machine"),
            Self::Held(name) => write!(f, "{name} commands the machine"),
            Self::NotHolder => f.write_str("this session does not command the machine"),
            Self::Full => write!(
                f,
                "there are {MOST_SESSIONS} sessions already, or {MOST_VIEWERS} of viewers"
            ),
            Self::NoSecret(why) => f.write_str(why),
            Self::Name => {
                write!(f, "a session has a name of 1 to {LONGEST_NAME} letters, digits and signs")
            }
        }
    }
}

impl From<NoToken> for Denied {
    fn from(why: NoToken) -> Self {
        match why {
            NoToken::Unknown => Self::NoToken,
            NoToken::Expired => Self::Expired,
        }
    }
}

impl Denied {
    /// What would make it possible.
    pub(crate) const fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Unknown => Some("open a session with POST /api/v1/session"),
            Self::NoToken => Some("send it as Authorization: Bearer, or open a session with it"),
            Self::Expired | Self::Revoked => Some(NEW_TOKEN),
            Self::AnothersSession => Some("open a session with this token"),
            Self::Held(_) => Some("ask for the right to command"),
            _ => None,
        }
    }
}

/// What a client has shown of itself.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Credential {
    /// It is on this computer, and the server asks for no tokens.
    ThisComputer,
    /// A token, by its hash.
    Token(String),
}

/// A credential that was shown, and until when it lasts at most.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    credential: Credential,
    until: Option<Instant>,
}

/// A session within the server: a number, which is neither sent nor received.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct SessionId(u64);

/// Who asks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Who {
    /// Its session.
    pub(crate) session: SessionId,
    /// What it may do.
    pub(crate) role: Role,
}

/// A session that was opened.
#[derive(Debug)]
pub(crate) struct Opened {
    /// What its client sends from now on.
    pub(crate) secret: String,
    /// As the others see it: no other session has this name.
    pub(crate) name: String,
    /// Who it is.
    pub(crate) who: Who,
}

#[derive(Clone, Debug)]
struct Session {
    /// Hash of what its client sends; `None`: it is its credential's own.
    secret: Option<String>,
    name: String,
    shown: Shown,
    sockets: usize,
    seen: Instant,
}

/// Sessions, and the right to command.
#[derive(Debug, Default)]
pub(crate) struct Rights {
    /// Who is answered; `None`: this computer.
    tokens: Option<Tokens>,
    /// By which tokens end.
    clock: Clock,
    sessions: HashMap<SessionId, Session>,
    /// Sessions that there have been.
    count: u64,
    holder: Option<SessionId>,
    asked: Option<(SessionId, Instant)>,
    /// Keys of the panel that have been pressed, and when the last one was.
    panel: (u64, Option<Instant>),
}

impl Rights {
    /// Of who has a token; `None`: of who is on this computer.
    pub(crate) fn new(tokens: Option<Tokens>, clock: Clock) -> Self {
        Self { tokens, clock, ..Self::default() }
    }

    /// The file of tokens was read anew: what was opened with one that is not in it has ended.
    pub(crate) fn replace(&mut self, tokens: Tokens) {
        self.tokens = Some(tokens);
    }

    /// What a token, or the lack of one, shows of a client.
    ///
    /// # Errors
    /// Tokens are asked for, and this is none.
    pub(crate) fn shown_by(&self, token: Option<&str>, now: Instant) -> Result<Shown, Denied> {
        let Some(tokens) = &self.tokens else {
            return Ok(Shown { credential: Credential::ThisComputer, until: None });
        };
        let Known { sha256, left, .. } =
            tokens.find(token.unwrap_or_default(), self.clock.unix_ms())?;
        let until = left.and_then(|left| now.checked_add(left));
        Ok(Shown { credential: Credential::Token(sha256), until })
    }

    /// What who has shown this may do now.
    ///
    /// # Errors
    /// It has ended.
    pub(crate) fn role_of(&self, shown: &Shown, now: Instant) -> Result<Role, Denied> {
        if shown.until.is_some_and(|until| now >= until) {
            return Err(Denied::Expired);
        }
        match (&shown.credential, &self.tokens) {
            (Credential::ThisComputer, None) => Ok(Role::Operator),
            (Credential::Token(sha256), Some(tokens)) => {
                match tokens.of_hash(sha256, self.clock.unix_ms()) {
                    Ok(known) => Ok(known.role),
                    Err(NoToken::Expired) => Err(Denied::Expired),
                    Err(NoToken::Unknown) => Err(Denied::Revoked),
                }
            }
            _ => Err(Denied::Revoked),
        }
    }

    /// Who asks, by the token and the secret of a session that it sends; it is here.
    ///
    /// # Errors
    /// Neither is known, or the one does not belong to the other.
    pub(crate) fn identify(
        &mut self,
        token: Option<&str>,
        secret: Option<&str>,
        now: Instant,
    ) -> Result<Who, Denied> {
        let session = match secret {
            Some(secret) => {
                let sought = hash(secret);
                let is_it = |session: &Session| session.secret.as_ref() == Some(&sought);
                let found = self.sessions.iter().find(|(_, session)| is_it(session));
                let (id, session) = found.ok_or(Denied::Unknown)?;
                if self.tokens.is_some() && token.is_some() {
                    let shown = self.shown_by(token, now)?;
                    if shown.credential != session.shown.credential {
                        return Err(Denied::AnothersSession);
                    }
                }
                *id
            }
            None => self.own_of(self.shown_by(token, now)?, now)?,
        };
        let role = self.seen(session, now)?;
        Ok(Who { session, role })
    }

    /// The session of a credential itself, of clients that open none.
    fn own_of(&mut self, shown: Shown, now: Instant) -> Result<SessionId, Denied> {
        let is_own = |session: &Session| {
            session.secret.is_none() && session.shown.credential == shown.credential
        };
        if let Some((id, _)) = self.sessions.iter().find(|(_, session)| is_own(session)) {
            return Ok(*id);
        }
        let name = match (&shown.credential, &self.tokens) {
            (Credential::Token(sha256), Some(tokens)) => {
                tokens.of_hash(sha256, self.clock.unix_ms())?.name
            }
            _ => LOCAL.to_owned(),
        };
        Ok(self.add(None, &name, shown, now))
    }

    fn add(&mut self, secret: Option<String>, name: &str, shown: Shown, now: Instant) -> SessionId {
        let id = SessionId(self.count);
        self.count += 1;
        let name = self.free_name(name, &shown.credential, secret.is_some());
        self.sessions.insert(id, Session { secret, name, shown, sockets: 0, seen: now });
        id
    }

    /// A name that no other session and no other token has: with a number behind it, if need be.
    fn free_name(&self, name: &str, of: &Credential, is_chosen: bool) -> String {
        let is_of_another = |name: &str| match (&self.tokens, of) {
            (Some(tokens), Credential::Token(own)) => tokens.is_of_another(name, own),
            _ => name == LOCAL,
        };
        let is_taken = |name: &str| {
            name == PANEL
                || (is_chosen && is_of_another(name))
                || self.sessions.values().any(|session| session.name == name)
        };
        let numbered = (2..).map(|n| format!("{name} {n}"));
        // of the numbers one is free, as there is no end of them
        core::iter::once(name.to_owned())
            .chain(numbered)
            .find(|name| !is_taken(name))
            .unwrap_or_default()
    }

    /// Opens a session for who has shown this.
    ///
    /// # Errors
    /// There are too many, or its name is none.
    pub(crate) fn open(
        &mut self,
        name: &str,
        shown: Shown,
        now: Instant,
    ) -> Result<Opened, Denied> {
        let name = name.trim();
        let is_read = |c: char| c.is_alphanumeric() || c.is_ascii_graphic() || c == ' ';
        if name.is_empty() || name.chars().count() > LONGEST_NAME || !name.chars().all(is_read) {
            return Err(Denied::Name);
        }
        let role = self.role_of(&shown, now)?;
        self.make_room(role, now)?;
        let secret = random::<16>().map_err(Denied::NoSecret)?;
        let session = self.add(Some(hash(&secret)), name, shown, now);
        let name = self.name_of(session);
        Ok(Opened { secret, name, who: Who { session, role } })
    }

    /// The session that has been gone for longest gives way to another one of its role.
    fn make_room(&mut self, role: Role, now: Instant) -> Result<(), Denied> {
        let mut sessions = core::mem::take(&mut self.sessions);
        sessions.retain(|_, session| {
            session.sockets > 0
                || (now - session.seen < FORGOTTEN && self.role_of(&session.shown, now).is_ok())
        });
        self.sessions = sessions;
        let opened = || self.sessions.iter().filter(|(_, session)| session.secret.is_some());
        let is_viewer = |session: &Session| self.role_of(&session.shown, now) == Ok(Role::Viewer);
        let is_full = opened().count() >= MOST_SESSIONS;
        let viewers = opened().filter(|(_, session)| is_viewer(session)).count();
        let is_full_of_viewers = role == Role::Viewer && viewers >= MOST_VIEWERS;
        if !is_full && !is_full_of_viewers {
            return Ok(());
        }
        let oldest = opened().filter(|(id, session)| {
            session.sockets == 0
                && now - session.seen > HANDS_OVER
                && self.holder != Some(**id)
                && (role == Role::Operator || is_viewer(session))
        });
        let oldest = oldest.min_by_key(|(_, session)| session.seen).map(|(id, _)| *id);
        self.sessions.remove(&oldest.ok_or(Denied::Full)?);
        Ok(())
    }

    /// What a session may do; it is here.
    fn seen(&mut self, id: SessionId, now: Instant) -> Result<Role, Denied> {
        let session = self.sessions.get(&id).ok_or(Denied::Unknown)?;
        let role = self.role_of(&session.shown, now)?;
        if let Some(session) = self.sessions.get_mut(&id) {
            session.seen = now;
        }
        Ok(role)
    }

    /// Whether a session has ended, with its token or without.
    pub(crate) fn has_ended(&self, id: SessionId, now: Instant) -> bool {
        let session = self.sessions.get(&id);
        session.is_none_or(|session| self.role_of(&session.shown, now).is_err())
    }

    /// A socket of it is opened (true) or gone.
    pub(crate) fn socket(&mut self, id: SessionId, is_open: bool, now: Instant) {
        if let Some(session) = self.sessions.get_mut(&id) {
            session.seen = now;
            session.sockets =
                if is_open { session.sockets + 1 } else { session.sockets.saturating_sub(1) };
        }
    }

    /// Keys of the panel that have been pressed until now: a new one takes the right.
    pub(crate) fn see_panel(&mut self, count: u64, now: Instant) {
        if count != self.panel.0 {
            self.panel = (count, Some(now));
            self.holder = None;
        }
    }

    fn panel_commands(&self, now: Instant) -> bool {
        self.panel.1.is_some_and(|last| now - last < HANDS_OVER)
    }

    /// What time has decided.
    fn settle(&mut self, now: Instant) {
        let is_gone = |id: SessionId| {
            let session = self.sessions.get(&id);
            let is_away = |s: &Session| s.sockets == 0 && now - s.seen >= HANDS_OVER;
            self.has_ended(id, now) || session.is_some_and(is_away)
        };
        let asked = self.asked.filter(|(id, _)| !is_gone(*id));
        let holder = self.holder.filter(|id| !is_gone(*id));
        (self.asked, self.holder) = (asked, holder);
        if let Some((id, since)) = self.asked
            && !self.panel_commands(now)
            && (self.holder.is_none() || now - since >= HANDS_OVER)
        {
            self.holder = Some(id);
            self.asked = None;
        }
    }

    /// Whether a session may ask something of the control; the first that does has the right.
    ///
    /// # Errors
    /// It may not, and why.
    pub(crate) fn may_command(
        &mut self,
        id: SessionId,
        is_stop: bool,
        now: Instant,
    ) -> Result<(), Denied> {
        let role = self.seen(id, now)?;
        self.settle(now);
        if role == Role::Viewer {
            return Err(Denied::Viewer);
        }
        match self.holder {
            Some(holder) if holder == id => Ok(()),
            _ if is_stop => Ok(()),
            Some(holder) => Err(Denied::Held(self.name_of(holder))),
            None if self.panel_commands(now) => Err(Denied::Held(PANEL.to_owned())),
            None => {
                self.holder = Some(id);
                Ok(())
            }
        }
    }

    /// It has the right now.
    pub(crate) fn commands(&mut self, id: SessionId, now: Instant) -> bool {
        self.settle(now);
        self.holder == Some(id)
    }

    /// Ask for the right, hand it over, keep it, give it back.
    ///
    /// # Errors
    /// The session may not.
    pub(crate) fn order(
        &mut self,
        id: SessionId,
        order: OperatorOrder,
        now: Instant,
    ) -> Result<(), Denied> {
        let role = self.seen(id, now)?;
        self.settle(now);
        if role == Role::Viewer {
            return Err(Denied::Viewer);
        }
        let holds = self.holder == Some(id);
        let is_free = self.holder.is_none() && !self.panel_commands(now);
        match order {
            OperatorOrder::Ask {} => match &self.asked {
                _ if is_free => self.holder = Some(id),
                None if !holds => self.asked = Some((id, now)),
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
            holder: match self.holder {
                None => self.panel_commands(now).then(|| PANEL.to_owned()),
                Some(id) => Some(self.name_of(id)),
            },
            asked_by: self.asked.map(|(id, _)| self.name_of(id)),
            hands_over_in_s: self.asked.map(|(_, since)| left(since)),
        }
    }

    fn name_of(&self, id: SessionId) -> String {
        self.sessions.get(&id).map_or_else(String::new, |session| session.name.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tokens::NewToken;

    const HOUR: Duration = Duration::from_hours(1);

    /// A session of this computer, with a socket.
    fn desk(rights: &mut Rights, name: &str, now: Instant) -> SessionId {
        let shown = rights.shown_by(None, now).expect("this computer");
        let id = rights.open(name, shown, now).expect("room").who.session;
        rights.socket(id, true, now);
        id
    }

    fn of_two(now: Instant) -> (Rights, SessionId, SessionId) {
        let mut rights = Rights::default();
        let [a, b] = ["desk a", "desk b"].map(|name| desk(&mut rights, name, now));
        (rights, a, b)
    }

    /// Of two tokens, and these.
    fn of_tokens(valid: Duration) -> (Rights, NewToken, NewToken, tempfile::TempDir) {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("tokens.toml");
        let operator = Tokens::add(&path, "operator", Role::Operator, valid).expect("made");
        let viewer = Tokens::add(&path, "wall", Role::Viewer, valid).expect("made");
        let rights = Rights::new(Some(Tokens::read(&path).expect("read")), Clock::default());
        (rights, operator, viewer, dir)
    }

    #[test]
    fn a_key_of_the_panel_takes_the_right_until_none_has_been_pressed_for_a_while() {
        let now = control::clock::now();
        let (mut rights, a, b) = of_two(now);
        assert_eq!(rights.may_command(a, false, now), Ok(()));
        rights.see_panel(0, now);
        assert_eq!(rights.may_command(a, false, now), Ok(()), "no key has been pressed");
        rights.see_panel(1, now);
        let held = Err(Denied::Held(PANEL.to_owned()));
        for id in [a, b] {
            assert_eq!(rights.may_command(id, false, now), held);
            assert_eq!(rights.may_command(id, true, now), Ok(()), "everyone may stop");
        }
        assert_eq!(rights.shown(now).holder.as_deref(), Some(PANEL));
        let later = now + HANDS_OVER / 2;
        rights.see_panel(2, later);
        rights.order(b, OperatorOrder::Ask {}, later).expect("an operator");
        let over = later + HANDS_OVER;
        assert_eq!(rights.may_command(b, false, later + HANDS_OVER / 2), held);
        assert_eq!(
            rights.may_command(a, false, over).map_err(|why| why.to_string()),
            Err("desk b commands the machine".to_owned())
        );
        assert_eq!(rights.may_command(b, false, over), Ok(()), "who has asked has it");
        let shown = rights.shown_by(None, now).expect("this computer");
        let named = rights.open(PANEL, shown, over).expect("room").name;
        assert_eq!(named, "the panel 2", "no session is taken for the panel");
    }

    #[test]
    fn nothing_that_can_be_guessed_is_a_session() {
        let now = control::clock::now();
        let (mut rights, operator, viewer, _dir) = of_tokens(HOUR);
        rights.identify(Some(&operator.token), None, now).expect("the operator");
        let shown = rights.shown_by(Some(&operator.token), now).expect("known");
        let opened = rights.open("desk", shown, now).expect("room");
        let forged = ["of operator", "operator", "desk", "local", "of local", "0", "1", ""];
        for secret in forged.map(str::to_owned).into_iter().chain([hash(&opened.secret)]) {
            for token in [None, Some("x"), Some(&*operator.token), Some(&*viewer.token)] {
                let who = rights.identify(token, Some(&secret), now);
                assert_eq!(who.map(|_| ()), Err(Denied::Unknown), "{secret:?}, {token:?}");
            }
        }
        assert_eq!(opened.secret.len(), 32, "16 bytes");
        assert!(rights.identify(None, Some(&opened.secret), now).is_ok());
    }

    #[test]
    fn a_session_is_of_the_token_that_opened_it_and_of_no_other() {
        let now = control::clock::now();
        let (mut rights, operator, viewer, _dir) = of_tokens(HOUR);
        let shown = rights.shown_by(Some(&operator.token), now).expect("known");
        let secret = rights.open("desk", shown, now).expect("room").secret;
        let mut of = |token: Option<&str>| rights.identify(token, Some(&secret), now);
        assert_eq!(of(Some(&operator.token)).map(|who| who.role), Ok(Role::Operator));
        assert_eq!(of(Some(&viewer.token)).map(|_| ()), Err(Denied::AnothersSession));
        assert_eq!(of(Some("x")).map(|_| ()), Err(Denied::NoToken));
    }

    #[test]
    fn a_session_ends_with_its_token_and_gives_the_right_back() {
        let now = control::clock::now();
        let (mut rights, operator, _viewer, dir) = of_tokens(HOUR);
        let path = dir.path().join("tokens.toml");
        let next = Tokens::add(&path, "tablet", Role::Operator, HOUR * 9).expect("made");
        rights.replace(Tokens::read(&path).expect("read"));
        let open = |rights: &mut Rights, token: &NewToken| {
            let shown = rights.shown_by(Some(&token.token), now).expect("known");
            rights.open("desk", shown, now).expect("room").who.session
        };
        let (first, tablet) = (open(&mut rights, &operator), open(&mut rights, &next));
        for id in [first, tablet] {
            rights.socket(id, true, now);
        }
        assert_eq!(rights.may_command(first, false, now), Ok(()));
        assert!(!rights.has_ended(first, now));
        let over = now + HOUR;
        assert!(rights.has_ended(first, over));
        for is_stop in [false, true] {
            assert_eq!(rights.may_command(first, is_stop, over), Err(Denied::Expired));
        }
        assert_eq!(rights.may_command(tablet, false, over), Ok(()), "the right is free");
    }

    #[test]
    fn a_token_that_is_taken_out_of_the_file_ends_all_that_was_opened_with_it() {
        let now = control::clock::now();
        let (mut rights, operator, viewer, dir) = of_tokens(HOUR);
        let shown = rights.shown_by(Some(&operator.token), now).expect("known");
        let opened = rights.open("desk", shown.clone(), now).expect("room");
        assert_eq!(rights.may_command(opened.who.session, false, now), Ok(()));
        let path = dir.path().join("tokens.toml");
        Tokens::revoke(&path, "operator").expect("it was there");
        rights.replace(Tokens::read(&path).expect("read"));
        assert!(rights.has_ended(opened.who.session, now));
        let session = rights.identify(None, Some(&opened.secret), now);
        assert_eq!(session.map(|_| ()), Err(Denied::Revoked));
        let token = rights.identify(Some(&operator.token), None, now);
        assert_eq!(token.map(|_| ()), Err(Denied::NoToken));
        assert_eq!(rights.role_of(&shown, now), Err(Denied::Revoked));
        assert_eq!(rights.shown(now).holder, None, "the right is free");
        assert!(rights.identify(Some(&viewer.token), None, now).is_ok());
    }

    #[test]
    fn no_two_sessions_have_one_name_and_none_has_that_of_a_token_of_another_one() {
        let now = control::clock::now();
        let (mut rights, operator, viewer, _dir) = of_tokens(HOUR);
        let mut open = |token: &NewToken, name: &str| {
            let shown = rights.shown_by(Some(&token.token), now).expect("known");
            rights.open(name, shown, now).expect("room").name
        };
        assert_eq!(open(&operator, "desk"), "desk");
        assert_eq!(open(&viewer, "desk"), "desk 2");
        assert_eq!(open(&viewer, "operator"), "operator 2");
        assert_eq!(open(&operator, "operator"), "operator");
    }

    #[test]
    fn viewers_leave_room_for_operators() {
        let now = control::clock::now();
        let (mut rights, operator, viewer, _dir) = of_tokens(HOUR);
        let shown = rights.shown_by(Some(&viewer.token), now).expect("known");
        for _ in 0..MOST_VIEWERS {
            rights.open("wall", shown.clone(), now).expect("room");
        }
        assert_eq!(rights.open("wall", shown.clone(), now).map(|_| ()), Err(Denied::Full));
        let of_operator = rights.shown_by(Some(&operator.token), now).expect("known");
        for _ in MOST_VIEWERS..MOST_SESSIONS {
            rights.open("desk", of_operator.clone(), now).expect("room");
        }
        assert_eq!(rights.open("desk", of_operator, now).map(|_| ()), Err(Denied::Full));
        let later = now + HANDS_OVER * 2;
        assert!(rights.open("wall", shown, later).is_ok(), "who is gone gives way");
    }

    #[test]
    fn the_first_that_asks_for_something_commands_and_another_one_may_only_stop() {
        let now = control::clock::now();
        let (mut rights, a, b) = of_two(now);
        assert_eq!(rights.may_command(a, false, now), Ok(()));
        assert_eq!(rights.may_command(b, false, now), Err(Denied::Held("desk a".into())));
        assert_eq!(rights.may_command(b, true, now), Ok(()));
        assert!(rights.commands(a, now), "a stop by another one takes nothing away");
    }

    #[test]
    fn the_right_is_handed_over_by_its_holder_or_after_ten_seconds() {
        let now = control::clock::now();
        let (mut rights, a, b) = of_two(now);
        rights.may_command(a, false, now).expect("free");
        rights.order(b, OperatorOrder::Ask {}, now).expect("an operator");
        assert!(rights.commands(a, now + Duration::from_secs(9)));
        assert!(rights.commands(b, now + HANDS_OVER));
        let later = now + HANDS_OVER;
        rights.order(a, OperatorOrder::Ask {}, later).expect("an operator");
        assert_eq!(rights.order(a, OperatorOrder::Grant {}, later), Err(Denied::NotHolder));
        rights.order(b, OperatorOrder::Keep {}, later).expect("it holds it");
        assert!(rights.commands(b, later + HANDS_OVER * 2), "it was kept");
        let later = later + HANDS_OVER * 2;
        rights.order(a, OperatorOrder::Ask {}, later).expect("an operator");
        rights.order(b, OperatorOrder::Grant {}, later).expect("it holds it");
        assert!(rights.commands(a, later));
    }

    #[test]
    fn a_holder_that_is_gone_holds_nothing() {
        let now = control::clock::now();
        let (mut rights, a, b) = of_two(now);
        rights.may_command(a, false, now).expect("free");
        rights.socket(a, false, now);
        assert!(rights.may_command(b, false, now + Duration::from_secs(9)).is_err());
        assert_eq!(rights.may_command(b, false, now + HANDS_OVER), Ok(()));
    }

    #[test]
    fn a_viewer_commands_nothing_not_even_a_stop() {
        let now = control::clock::now();
        let (mut rights, _operator, viewer, _dir) = of_tokens(HOUR);
        let id = rights.identify(Some(&viewer.token), None, now).expect("known").session;
        assert_eq!(rights.may_command(id, true, now), Err(Denied::Viewer));
        assert_eq!(rights.order(id, OperatorOrder::Ask {}, now), Err(Denied::Viewer));
    }
}
