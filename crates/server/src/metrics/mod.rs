//! `/metrics`: what Prometheus and its like read of the machine, by GET alone.
//!
//! ```text
//!   events   ─► counters, histograms ┐
//!   pictures ─► gauges               ┴─► OpenMetrics 1.0, or the older text format where that is asked for
//! ```
//!
//! A text is made at most once for each picture, however many ask for it.
mod adding;
pub(crate) mod metering;
mod process;
mod publishing;
mod registry;
mod text;

use crate::access::Watched;
use crate::answer::ApiError;
use crate::app::App;
use crate::guard;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::any;
use metering::Metering;
use std::sync::Arc;

/// `OpenMetrics`, as its clients ask for it.
const OPEN: &str = "application/openmetrics-text";

/// Events are counted, until the control has ended.
pub(crate) async fn feed(app: Arc<App>, metering: Arc<Metering>) {
    let mut pictures = app.pictures.clone();
    let mut last = 0;
    while {
        last = count(&app, &metering, last);
        pictures.changed().await.is_ok()
    } {}
}

/// What has happened after an event; the last event that there is.
fn count(app: &App, metering: &Metering, after: u64) -> u64 {
    let (events, _, last) = app.client.events_after(after);
    if !events.is_empty() {
        let picture = app.client.latest();
        let program =
            picture.status.program.as_ref().map(|program| app.folder.shown(&program.name));
        metering.count(&events, program.as_deref().unwrap_or_default());
    }
    last
}

/// With what its address begins.
pub(crate) const ROOT: &str = "/metrics";

/// Its address.
pub(crate) fn routes() -> Vec<Watched> {
    vec![Watched { path: ROOT, refused: guard::refused, handler: any(answer) }]
}

async fn answer(State(app): State<Arc<App>>, request: Request) -> Response {
    // there are some where their address is
    let Some(metering) = &app.watching.metering else {
        return StatusCode::NOT_FOUND.into_response();
    };
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return ApiError::wrong_method(request.method(), "GET,HEAD").into_response();
    }
    let texts = metering.texts(&app.client.latest(), app.watching.publisher.as_deref());
    if is_open(request.headers()) {
        let kind = format!("{OPEN}; version=1.0.0; charset=utf-8");
        ([(header::CONTENT_TYPE, kind)], texts.open).into_response()
    } else {
        let kind = "text/plain; version=0.0.4; charset=utf-8";
        ([(header::CONTENT_TYPE, kind)], texts.plain).into_response()
    }
}

/// Whether `OpenMetrics` is asked for.
fn is_open(headers: &HeaderMap) -> bool {
    let accept = headers.get(header::ACCEPT).and_then(|value| value.to_str().ok());
    accept.is_some_and(|accept| accept.contains(OPEN))
}
