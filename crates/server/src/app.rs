//! What all handlers share.
use crate::answer::ApiError;
use crate::clock::Clock;
use crate::connections::Places;
use crate::folder::Folder;
use crate::metrics::metering::Metering;
use crate::monitoring::Monitoring;
use crate::mqtt::Publisher;
use crate::paced::RequestPace;
use crate::rights::{Rights, SessionId};
use crate::runs::Runs;
use crate::timeouts::ClientTimeouts;
use crate::tokens::Tokens;
use crate::wire::RequestBody;
use control::job::{Interruption, ProgramOptions};
use control::operation::Accepted;
use control::operation::hosted::{Client, Picture, RequestAnswer};
use serde_json::{Map, Value};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{oneshot, watch};

/// Sockets that are open at once, and those that viewers may have of them.
const MOST_SOCKETS: (usize, usize) = (64, 48);

/// Editors at once, and those of viewers: each has a thread that interprets.
const MOST_EDITORS: (usize, usize) = (4, 2);

/// The fields of a status by their names.
pub(crate) type Fields = Map<String, Value>;

/// What programs that only watch may read; `None`: they may not.
pub(crate) struct Watching {
    /// The `MTConnect` agent.
    pub(crate) monitoring: Option<Arc<Monitoring>>,
    /// What Prometheus reads.
    pub(crate) metering: Option<Arc<Metering>>,
    /// What is published to a broker.
    pub(crate) publisher: Option<Arc<Publisher>>,
}

/// What all handlers share.
pub(crate) struct App {
    pub(crate) client: Client,
    pub(crate) folder: Folder,
    pub(crate) runs: Runs,
    /// How programs are read.
    pub(crate) program: ProgramOptions,
    /// Editors with a language server.
    pub(crate) editors: Places,
    pub(crate) watching: Watching,
    /// Told of each picture.
    pub(crate) pictures: watch::Receiver<u64>,
    pub(crate) sockets: Places,
    /// Names by which clients may call this server, with its port.
    pub(crate) hosts: Vec<String>,
    /// With what its addresses begin: `http` or `https`.
    pub(crate) scheme: &'static str,
    pub(crate) timeouts: ClientTimeouts,
    /// How many requests are answered in a second.
    pub(crate) pace: RequestPace,
    /// By which sessions and tokens end.
    pub(crate) clock: Clock,
    rights: Mutex<Rights>,
    /// The fields of the latest picture, made once for all clients.
    fields: Mutex<(u64, Arc<Fields>)>,
}

impl App {
    /// Of a control and a folder.
    pub(crate) fn new(
        client: Client,
        (folder, runs, program): (Folder, Runs, ProgramOptions),
        (tokens, watching): (Option<Tokens>, Watching),
        pictures: watch::Receiver<u64>,
        (scheme, hosts): (&'static str, Vec<String>),
        (timeouts, clock): (ClientTimeouts, Clock),
    ) -> Self {
        Self {
            client,
            folder,
            runs,
            program,
            editors: Places::new(MOST_EDITORS.0, MOST_EDITORS.1),
            watching,
            pictures,
            sockets: Places::new(MOST_SOCKETS.0, MOST_SOCKETS.1),
            hosts,
            scheme,
            timeouts,
            pace: RequestPace::default(),
            rights: Mutex::new(Rights::new(tokens, clock.clone())),
            clock,
            fields: Mutex::default(),
        }
    }

    /// Sessions, for a moment: never across an await.
    pub(crate) fn rights(&self) -> MutexGuard<'_, Rights> {
        let mut rights = self.rights.lock().unwrap_or_else(PoisonError::into_inner);
        rights.see_panel(self.client.panel_count(), self.clock.now());
        rights
    }

    /// The fields of a picture's status.
    pub(crate) fn fields(&self, picture: &Picture) -> Arc<Fields> {
        let mut kept = self.fields.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.0 != picture.number {
            let mut status = picture.status.clone();
            if let Some(program) = &mut status.program {
                program.name = self.folder.shown(&program.name);
            }
            if let Some(loading) = &mut status.loading {
                loading.name = self.folder.shown(&loading.name);
            }
            if let Some(left) = &mut status.left_in_work {
                left.program = left.program.take().map(|name| self.folder.shown(&name));
            }
            // numbers, strings and names alone
            let fields = match serde_json::to_value(&status) {
                Ok(Value::Object(fields)) => fields,
                _ => Fields::new(),
            };
            *kept = (picture.number, Arc::new(fields));
        }
        Arc::clone(&kept.1)
    }

    /// Ask the control for something, for a session that may.
    pub(crate) async fn request(
        &self,
        session: SessionId,
        body: RequestBody,
    ) -> Result<Accepted, ApiError> {
        self.ask(session, body)?.answer(&self.folder).await
    }

    /// The same, without its answer: what is asked for is asked for in this order.
    pub(crate) fn ask(
        &self,
        session: SessionId,
        body: RequestBody,
    ) -> Result<AwaitedAnswer, ApiError> {
        self.rights().may_command(session, body.is_stop(), self.clock.now())?;
        let request = body.read(self.client.machine(), &self.folder)?;
        let (sender, receiver) = oneshot::channel();
        let waits = Arc::new(());
        let waiting = Arc::downgrade(&waits);
        let is_gone = Interruption::by(move || waiting.strong_count() == 0);
        self.client.ask_unless(is_gone, request, move |answer| {
            let _ = sender.send(answer); // who asked is gone
        })?;
        Ok(AwaitedAnswer { receiver, waits })
    }
}

/// A request whose answer is awaited; dropped, what is read for it is broken off.
pub(crate) struct AwaitedAnswer {
    receiver: oneshot::Receiver<RequestAnswer>,
    waits: Arc<()>,
}

impl AwaitedAnswer {
    pub(crate) async fn answer(self, folder: &Folder) -> Result<Accepted, ApiError> {
        let Self { receiver, waits } = self;
        let answer = receiver.await;
        drop(waits); // not before
        let answer = answer.map_err(|_| {
            ApiError::new(axum::http::StatusCode::SERVICE_UNAVAILABLE, "the control has ended")
        })?;
        answer.map_err(|refusal| ApiError::from(refusal).shown(|text| folder.shown(text)))
    }
}
