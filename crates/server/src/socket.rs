//! WebSocket: a whole status, then what changes; events and features; requests and their answers.
//!
//! A client that does not read is not waited for: while a frame of it is on its way no other one is
//! made, and the next delta is against what it had last. What the systems between take on its
//! behalf is no reading: it is asked for a sign ([`ASKED`]), which comes when it has read so far,
//! and after [`SENT`] without one it is gone.
use crate::answer::ApiError;
use crate::app::{App, Fields};
use crate::guard;
use crate::paced::SocketPace;
use crate::rights::Who;
use crate::scope::Scope;
use crate::wire::{AcceptedBody, EventBody, FeatureBody, OperatorBody, RequestBody};
use axum::Extension;
use axum::body::Bytes;
use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use control::operation::Accepted;
use control::operation::hosted::Picture;
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::task::JoinSet;
use tokio::time::MissedTickBehavior;

/// A frame is sent within so long, or the client is gone.
const SENT: Duration = Duration::from_secs(2);
/// A client is asked so often whether it has read so far.
const ASKED: Duration = Duration::from_millis(250);
/// Largest message of a client.
const LARGEST_MESSAGE: usize = crate::answer::LARGEST_JSON;

/// Requests of one client that wait for their answers; one more is refused, unless it is a stop.
const MOST_ASKED: usize = 16;

/// What a client says.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
enum Said {
    Request {
        #[serde(default)]
        id: u64,
        request: RequestBody,
    },
    Scope {
        signals: Vec<String>,
    },
}

/// The client is gone.
struct Gone;

pub(crate) async fn open(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    upgrade: Result<WebSocketUpgrade, axum::extract::ws::rejection::WebSocketUpgradeRejection>,
) -> Response {
    let Ok(upgrade) = upgrade else {
        let reason = "this address takes a WebSocket";
        return ApiError::new(StatusCode::UPGRADE_REQUIRED, reason).into_response();
    };
    let Some(place) = app.sockets.take(who.role) else {
        let reason = "too many clients have a socket open";
        return ApiError::new(StatusCode::SERVICE_UNAVAILABLE, reason).into_response();
    };
    let upgrade = upgrade.max_message_size(LARGEST_MESSAGE).max_frame_size(LARGEST_MESSAGE);
    upgrade.on_upgrade(move |socket| async move {
        app.rights().socket(who.session, true, app.clock.now());
        let mut talk = Talk::new(Arc::clone(&app), who, socket);
        tokio::select! {
            Err(Gone) = talk.until_gone() => {}
            () = guard::ended(&app, who.session) => {}
        }
        app.rights().socket(who.session, false, app.clock.now());
        drop(place);
    })
}

/// The answer to a request, as it is sent.
fn answer_body(app: &App, id: u64, answer: Result<Accepted, ApiError>) -> Value {
    let shown = |text: &str| app.folder.shown(text);
    let mut body = match answer {
        Ok(accepted) => serde_json::to_value(AcceptedBody::of(&accepted, &shown)),
        Err(error) => serde_json::to_value(error.body()),
    }
    .unwrap_or_default(); // strings and numbers alone
    (body["type"], body["id"]) = ("answer".into(), id.into());
    body
}

/// A socket, and what its client has.
struct Talk {
    app: Arc<App>,
    who: Who,
    socket: WebSocket,
    seq: u64,
    status: Option<Arc<Fields>>,
    /// The last event that was sent.
    event: u64,
    features: usize,
    operator: Option<OperatorBody>,
    scope: Option<Scope>,
    /// Answers that the control still owes it.
    answers: JoinSet<Value>,
    pace: SocketPace,
}

impl Talk {
    fn new(app: Arc<App>, who: Who, socket: WebSocket) -> Self {
        let (_, _, event) = app.client.events_after(u64::MAX);
        let features = app.client.latest().features.len();
        Self {
            app,
            who,
            socket,
            seq: 0,
            status: None,
            event,
            features,
            operator: None,
            scope: None,
            answers: JoinSet::new(),
            pace: SocketPace::default(),
        }
    }

    async fn until_gone(&mut self) -> Result<(), Gone> {
        let mut pictures = self.app.pictures.clone();
        pictures.mark_unchanged(); // what there is now is told at once
        self.tell_all().await?;
        let mut asks = tokio::time::interval(ASKED);
        asks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        // since when a question is not answered
        let mut asked_at: Option<Instant> = None;
        loop {
            tokio::select! {
                said = self.socket.recv() => match said {
                    Some(Ok(Message::Text(text))) => self.hear(text.as_str()).await?,
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(Gone),
                    Some(Ok(Message::Pong(_))) => asked_at = None,
                    Some(Ok(_)) => {} // a ping is answered by the library
                },
                _ = asks.tick() => match asked_at {
                    Some(since) if self.app.clock.now() - since >= SENT => return Err(Gone),
                    Some(_) => {}
                    None => {
                        asked_at = Some(self.app.clock.now());
                        self.send(Message::Ping(Bytes::new())).await?;
                    }
                },
                Some(Ok(answer)) = self.answers.join_next() => {
                    self.send(Message::Text(answer.to_string().into())).await?;
                }
                changed = pictures.changed() => {
                    changed.map_err(|_| Gone)?; // the control has ended
                    self.tell_all().await?;
                }
            }
        }
    }

    /// Everything that is new.
    async fn tell_all(&mut self) -> Result<(), Gone> {
        let picture = self.app.client.latest();
        self.tell_status(&picture).await?;
        self.tell_events().await?;
        self.tell_features(&picture).await?;
        let operator = self.app.rights().shown(self.app.clock.now());
        let is_known = self.operator.as_ref().is_some_and(|known| {
            (&known.holder, &known.asked_by) == (&operator.holder, &operator.asked_by)
        });
        if !is_known {
            self.tell("operator", &operator).await?;
            self.operator = Some(operator);
        }
        if let Some(frame) = self.scope.as_mut().and_then(Scope::frame) {
            self.send(Message::Binary(frame.into())).await?;
        }
        Ok(())
    }

    async fn tell_status(&mut self, picture: &Picture) -> Result<(), Gone> {
        let fields = self.app.fields(picture);
        self.seq += 1;
        let message = match &self.status {
            None => json!({ "type": "status", "seq": self.seq, "status": &*fields }),
            Some(before) => {
                let changed =
                    fields.iter().filter(|(name, value)| before.get(*name) != Some(*value));
                let changed: Fields =
                    changed.map(|(name, value)| (name.clone(), value.clone())).collect();
                json!({ "type": "delta", "seq": self.seq, "status": changed })
            }
        };
        self.status = Some(fields);
        self.send(Message::Text(message.to_string().into())).await
    }

    async fn tell_events(&mut self) -> Result<(), Gone> {
        let (events, lost, last) = self.app.client.events_after(self.event);
        self.event = last;
        if lost > 0 {
            self.tell("lost", &json!({ "what": "events", "count": lost })).await?;
        }
        for event in events {
            let body = EventBody::of(&event, &|text| self.app.folder.shown(text));
            self.tell("event", &body).await?;
        }
        Ok(())
    }

    async fn tell_features(&mut self, picture: &Picture) -> Result<(), Gone> {
        let from = self.features.min(picture.features.len());
        self.features = picture.features.len();
        for feature in &picture.features[from..] {
            let body = FeatureBody::of(feature);
            self.tell("feature", &json!({ "feature": body })).await?;
        }
        Ok(())
    }

    /// What a client has said.
    async fn hear(&mut self, text: &str) -> Result<(), Gone> {
        match serde_json::from_str(text) {
            Ok(Said::Request { id, request }) => {
                let too_many = if request.is_stop() {
                    None
                } else if self.answers.len() >= MOST_ASKED {
                    Some(format!("{MOST_ASKED} requests of this socket have no answer yet"))
                } else {
                    let slower = "this socket asks too often: 500 requests a second are answered";
                    (!self.pace.has_turn()).then(|| slower.to_owned())
                };
                let asked = match too_many {
                    None => self.app.ask(self.who.session, request),
                    Some(reason) => Err(ApiError::new(StatusCode::SERVICE_UNAVAILABLE, reason)),
                };
                match asked {
                    Ok(asked) => {
                        let app = Arc::clone(&self.app);
                        self.answers.spawn(async move {
                            let answer = asked.answer(&app.folder).await;
                            answer_body(&app, id, answer)
                        });
                        Ok(())
                    }
                    // at once, so that refusals do not pile up
                    Err(error) => {
                        let body = answer_body(&self.app, id, Err(error));
                        self.send(Message::Text(body.to_string().into())).await
                    }
                }
            }
            Ok(Said::Scope { signals }) => match Scope::of(&self.app.client, signals) {
                Ok(scope) => {
                    self.scope = scope;
                    Ok(())
                }
                Err(reason) => self.refuse(&reason).await,
            },
            Err(e) => self.refuse(&format!("not what is expected: {e}")).await,
        }
    }

    async fn refuse(&mut self, reason: &str) -> Result<(), Gone> {
        let error = ApiError::new(StatusCode::BAD_REQUEST, reason);
        let mut body = serde_json::to_value(error.body()).unwrap_or_default(); // strings alone
        body["id"] = Value::Null;
        self.tell("answer", &body).await
    }

    /// An object, with its type.
    async fn tell(&mut self, kind: &str, body: &impl serde::Serialize) -> Result<(), Gone> {
        let mut message = serde_json::to_value(body).unwrap_or_default(); // an object of ours
        message["type"] = kind.into();
        self.send(Message::Text(message.to_string().into())).await
    }

    async fn send(&mut self, message: Message) -> Result<(), Gone> {
        match tokio::time::timeout(SENT, self.socket.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) | Err(_) => Err(Gone),
        }
    }
}
