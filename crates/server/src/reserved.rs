//! Connections that are kept for stops: beside all others, however many those are.
//!
//! ```text
//!   a request is under way on 256 ─► the next ones, 16 at once: one request each, within a second
//!                                  ├─ a stop: asked of the control
//!                                  └─ anything else: 503        one more: the oldest of them is closed
//! ```
//!
//! No client keeps one by saying nothing: it is closed for the next one.
use crate::answer::ApiError;
use axum::Router;
use axum::extract::Request;
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse as _, Response};
use std::collections::VecDeque;
use std::time::Duration;
use tokio::task::AbortHandle;

/// Connections for stops at once.
const MOST: usize = 16;
/// A header comes within so long.
pub(crate) const HEADER_COMES: Duration = Duration::from_secs(1);
/// Request and answer take no longer.
pub(crate) const LASTS: Duration = Duration::from_secs(3);
/// The address at which the control is asked for something.
pub(crate) const REQUESTS: &str = "/api/v1/request";

/// A request came by one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForStops;

/// What is answered to everything else.
pub(crate) fn too_many() -> ApiError {
    ApiError::new(StatusCode::SERVICE_UNAVAILABLE, "too many connections are open")
        .with_remedy("emergency_stop, stop, feed_hold and jog_stop are answered all the same")
}

/// The same addresses, of which only requests are answered.
pub(crate) fn router(all: Router) -> Router {
    all.layer(axum::middleware::from_fn(only_requests))
}

async fn only_requests(mut request: Request, next: Next) -> Response {
    if request.method() != Method::POST || request.uri().path() != REQUESTS {
        return too_many().into_response();
    }
    request.extensions_mut().insert(ForStops);
    next.run(request).await
}

/// Those that are open, oldest first.
#[derive(Debug, Default)]
pub(crate) struct Reserved(VecDeque<AbortHandle>);

impl Reserved {
    /// One more is open.
    pub(crate) fn open(&mut self, connection: AbortHandle) {
        self.0.retain(|open| !open.is_finished());
        if self.0.len() == MOST
            && let Some(oldest) = self.0.pop_front()
        {
            oldest.abort();
        }
        self.0.push_back(connection);
    }
}
