//! The `MTConnect` agent over HTTP: below `/mtconnect`, read by GET alone.
//!
//! ```text
//!   probe                            what the machine is made of
//!   current ?path &at|interval       what is true
//!   sample  ?path &from &count &to   what was observed; &interval &heartbeat: a stream, multipart/x-mixed-replace
//!   asset, asset/ID;ID               cutting tools
//!   schemas/…                        the schema of what is ours
//! ```
//!
//! A device may stand before the request: `/mtconnect/tapping-center/current`. Nothing is kept for
//! a client that streams but the number of its next observation: one that reads too slowly is told
//! that it is out of range, and its stream ends.
use crate::access::Watched;
use crate::app::App;
use crate::guard::{self, Watcher};
use crate::monitoring::{MOST_STREAMS, Monitoring};
use crate::rights::Denied;
use ::mtconnect::{
    AssetQuery, CurrentQuery, Element, ErrorCode, JsonForm, Observable, ProbeQuery, QueryError,
    SampleQuery,
};
use axum::Extension;
use axum::body::{Body, Bytes, HttpBody};
use axum::extract::rejection::PathRejection;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::any;
use control::clock::{now, unix_ms};
use hyper::body::Frame;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;

/// No stream has documents more often: pictures come no sooner.
const LEAST_INTERVAL: Duration = Duration::from_millis(20);
/// A document of a stream is taken within so long, or its client is gone.
const SENT: Duration = Duration::from_secs(10);
/// Between two documents of a stream.
const BOUNDARY: &str = "leadscrew-mtconnect-document";

/// Pictures and events become observations, until the control has ended.
pub(crate) async fn feed(app: Arc<App>, monitoring: Arc<Monitoring>, pace: f64) {
    let mut pictures = app.pictures.clone();
    let mut last = 0;
    while {
        last = observe(&app, &monitoring, last, pace);
        pictures.changed().await.is_ok()
    } {}
}

/// What there is to observe after an event; the last event that there is.
fn observe(app: &App, monitoring: &Monitoring, after: u64, pace: f64) -> u64 {
    // events first: a picture that is taken afterwards is no older
    let (events, lost, last) = app.client.events_after(after);
    let picture = app.client.latest();
    let shown = |text: &str| app.folder.shown(text);
    let unix_ms = unix_ms();
    let seen =
        Observable { picture: &picture, events: &events, lost, unix_ms, pace, shown: &shown };
    let next = {
        let mut agent = monitoring.agent();
        agent.observe(&seen);
        agent.next()
    };
    monitoring.grown.send_if_modified(|known| {
        let is_new = *known != next;
        *known = next;
        is_new
    });
    last
}

/// With what its addresses begin.
pub(crate) const ROOT: &str = "/mtconnect";

/// Its addresses.
pub(crate) fn routes() -> Vec<Watched> {
    let root = |state: State<Arc<App>>, watcher: Extension<Watcher>, request: Request| async move {
        answer(state, watcher, "", &request)
    };
    let below = |state: State<Arc<App>>,
                 watcher: Extension<Watcher>,
                 path: Result<Path<String>, PathRejection>,
                 request: Request| async move {
        // what is no UTF-8 names nothing that there is
        let path = path.as_ref().map_or("?", |Path(path)| path.as_str());
        answer(state, watcher, path, &request)
    };
    vec![
        Watched { path: ROOT, refused, handler: any(root) },
        Watched { path: "/mtconnect/", refused, handler: any(root) },
        Watched { path: "/mtconnect/{*path}", refused, handler: any(below) },
    ]
}

/// Who is not admitted is told so in the form of the standard.
fn refused(app: &App, headers: &HeaderMap, why: Denied) -> Response {
    let Some(monitoring) = &app.watching.monitoring else {
        return guard::refused(app, headers, why);
    };
    let text = match why {
        Denied::NoToken => "a token is needed: send it as Authorization: Bearer".to_owned(),
        why => why.to_string(),
    };
    let error = QueryError::new(ErrorCode::Unauthorized, text);
    let document = monitoring.agent().error(&error, unix_ms());
    Notation::asked(headers).response(status(error.code), &document)
}

/// How documents are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Notation {
    Xml,
    Json,
}

impl Notation {
    fn asked(headers: &HeaderMap) -> Self {
        let accept = headers.get(header::ACCEPT).and_then(|value| value.to_str().ok());
        let is_json = accept
            .is_some_and(|accept| accept.contains("application/json") && !accept.contains("xml"));
        if is_json { Self::Json } else { Self::Xml }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Xml => "text/xml",
            Self::Json => "application/json",
        }
    }

    fn write(self, document: &Element) -> Vec<u8> {
        match self {
            Self::Xml => document.xml(),
            Self::Json => document.json(JsonForm::Listed),
        }
    }

    fn response(self, status: StatusCode, document: &Element) -> Response {
        (status, [(header::CONTENT_TYPE, self.name())], self.write(document)).into_response()
    }
}

const fn status(code: ErrorCode) -> StatusCode {
    match code {
        ErrorCode::Unauthorized => StatusCode::UNAUTHORIZED,
        ErrorCode::NoDevice
        | ErrorCode::OutOfRange
        | ErrorCode::InvalidUri
        | ErrorCode::AssetNotFound => StatusCode::NOT_FOUND,
        ErrorCode::TooMany | ErrorCode::InvalidRequest | ErrorCode::InvalidPath => {
            StatusCode::BAD_REQUEST
        }
        ErrorCode::Unsupported => StatusCode::METHOD_NOT_ALLOWED,
        ErrorCode::InternalError => StatusCode::SERVICE_UNAVAILABLE,
    }
}

fn answer(
    State(app): State<Arc<App>>,
    Extension(watcher): Extension<Watcher>,
    path: &str,
    request: &Request,
) -> Response {
    let form = Notation::asked(request.headers());
    // there is one where its addresses are
    let Some(monitoring) = app.watching.monitoring.clone() else {
        return StatusCode::NOT_FOUND.into_response();
    };
    match Asked::of(&monitoring, path, request) {
        Ok(Asked::Document(document)) => form.response(StatusCode::OK, &document),
        Ok(Asked::Schema) => {
            let kind = [(header::CONTENT_TYPE, "application/xml")];
            (kind, ::mtconnect::SCHEMA).into_response()
        }
        Ok(Asked::Stream(stream)) => stream.begin(app, watcher, monitoring, form),
        Err(error) => {
            let document = monitoring.agent().error(&error, unix_ms());
            form.response(status(error.code), &document)
        }
    }
}

/// What a request asks for.
enum Asked {
    Document(Element),
    Schema,
    Stream(Stream),
}

impl Asked {
    fn of(monitoring: &Monitoring, path: &str, request: &Request) -> Result<Self, QueryError> {
        if *request.method() != Method::GET {
            let text = "an agent is only read: GET";
            return Err(QueryError::new(ErrorCode::Unsupported, text));
        }
        let query = request.uri().query().unwrap_or_default();
        let segments: Vec<&str> = path.split('/').filter(|part| !part.is_empty()).collect();
        let (asked, rest) = match segments.as_slice() {
            [] => ("probe", None),
            [asked] => (*asked, None),
            ["asset" | "assets", ids] => ("assets", Some(*ids)),
            ["schemas", "leadscrew-streams-1.0.xsd"] => return Ok(Self::Schema),
            [device, asked @ ("probe" | "current" | "sample" | "asset" | "assets")] => {
                monitoring.agent().is_device(device)?;
                (*asked, None)
            }
            _ => ("", None),
        };
        let (agent, time) = (monitoring.agent(), unix_ms());
        match asked {
            "probe" => {
                ProbeQuery::parse(query)?;
                Ok(Self::Document(agent.probe(time)))
            }
            "current" => {
                let query = CurrentQuery::parse(query)?;
                let document = agent.current(&query, time)?;
                Ok(match query.interval {
                    None => Self::Document(document),
                    Some(interval) => Self::Stream(Stream::of(What::Current(query), interval)),
                })
            }
            "sample" => {
                let query = SampleQuery::parse(query)?;
                let chunk = agent.sample(&query, time)?;
                Ok(match query.interval {
                    None => Self::Document(chunk.document),
                    Some(interval) => Self::Stream(Stream::of(What::Sample(query), interval)),
                })
            }
            "asset" | "assets" => {
                let query = AssetQuery::parse(rest.unwrap_or_default(), query)?;
                agent.assets(&query, time).map(Self::Document)
            }
            _ => {
                let text = "there is no such request: probe, current, sample, asset are";
                Err(QueryError::new(ErrorCode::InvalidUri, text))
            }
        }
    }
}

/// What a stream has.
enum What {
    Current(CurrentQuery),
    Sample(SampleQuery),
}

/// A stream that was asked for.
struct Stream {
    what: What,
    interval: Duration,
}

/// What comes next of a stream.
enum Next {
    /// A document; another one is there at once.
    Document(Element, bool),
    /// Nothing was observed.
    Nothing,
    /// The last one.
    Last(Element),
}

impl Stream {
    fn of(what: What, interval: Duration) -> Self {
        Self { what, interval: interval.max(LEAST_INTERVAL) }
    }

    fn begin(
        self,
        app: Arc<App>,
        watcher: Watcher,
        monitoring: Arc<Monitoring>,
        form: Notation,
    ) -> Response {
        let Ok(permit) = Arc::clone(&monitoring.streams).try_acquire_owned() else {
            let text = format!("{MOST_STREAMS} streams are open, and no more are served");
            let error = QueryError::new(ErrorCode::InternalError, text);
            let document = monitoring.agent().error(&error, unix_ms());
            return form.response(status(error.code), &document);
        };
        let (sender, documents) = mpsc::channel(1);
        tokio::spawn(async move {
            tokio::select! {
                () = self.run(&monitoring, form, &sender) => {}
                () = watcher.ended(&app) => {}
            }
            drop(permit);
        });
        let kind = format!("multipart/x-mixed-replace;boundary={BOUNDARY}");
        ([(header::CONTENT_TYPE, kind)], Body::new(Documents(documents))).into_response()
    }

    async fn run(mut self, monitoring: &Monitoring, form: Notation, to: &mpsc::Sender<Bytes>) {
        let mut grown = monitoring.grown.subscribe();
        let mut last_sent = None;
        loop {
            grown.mark_unchanged();
            match self.next(monitoring, last_sent) {
                Next::Document(document, is_more) => {
                    if !send(to, form, &document).await {
                        return;
                    }
                    last_sent = Some(now());
                    if !is_more {
                        tokio::select! {
                            () = to.closed() => return,
                            () = tokio::time::sleep(self.interval) => {}
                        }
                    }
                }
                Next::Last(document) => {
                    send(to, form, &document).await;
                    return;
                }
                Next::Nothing => {
                    let beat = self.heartbeat().saturating_sub(ago(last_sent));
                    tokio::select! {
                        () = to.closed() => return,
                        changed = grown.changed() => if changed.is_err() { return },
                        () = tokio::time::sleep(beat) => {}
                    }
                }
            }
        }
    }

    fn heartbeat(&self) -> Duration {
        match &self.what {
            What::Current(_) => self.interval,
            What::Sample(query) => query.heartbeat,
        }
    }

    fn next(&mut self, monitoring: &Monitoring, last_sent: Option<Instant>) -> Next {
        let (agent, time) = (monitoring.agent(), unix_ms());
        let heartbeat = self.heartbeat();
        let error = match &mut self.what {
            What::Current(query) => match agent.current(query, time) {
                Ok(document) => return Next::Document(document, false),
                Err(error) => error,
            },
            What::Sample(query) => match agent.sample(query, time) {
                Ok(chunk) => {
                    *query = query.at(chunk.next);
                    let is_silent = last_sent.is_some() && ago(last_sent) < heartbeat;
                    if chunk.is_empty && is_silent {
                        return Next::Nothing;
                    }
                    return Next::Document(chunk.document, chunk.is_full);
                }
                Err(error) => error,
            },
        };
        Next::Last(agent.error(&error, time))
    }
}

fn ago(then: Option<Instant>) -> Duration {
    then.map_or(Duration::MAX, |then| now() - then)
}

/// A part of a stream; false: the client is gone.
async fn send(to: &mpsc::Sender<Bytes>, form: Notation, document: &Element) -> bool {
    let body = form.write(document);
    let (kind, length) = (form.name(), body.len());
    let head = format!("--{BOUNDARY}\r\nContent-type: {kind}\r\nContent-length: {length}\r\n\r\n");
    let part = [head.as_bytes(), &body, b"\r\n"].concat();
    matches!(tokio::time::timeout(SENT, to.send(part.into())).await, Ok(Ok(())))
}

/// The body of a stream.
struct Documents(mpsc::Receiver<Bytes>);

impl HttpBody for Documents {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.0.poll_recv(context).map(|part| part.map(|part| Ok(Frame::data(part))))
    }
}
