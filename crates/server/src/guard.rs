//! What is looked at before any handler: by which name the server is called, from which page, by
//! whom; and what every answer says to a browser.
//!
//! A page of another site can make a browser send requests to 127.0.0.1, and a name of that site
//! can be made to lead there (DNS rebinding). So the `Host` must be a name of this server, and an
//! `Origin`, which every browser sends with what changes something, must be the same.
use crate::answer::ApiError;
use crate::app::App;
use crate::rights::{Denied, Role};
use crate::tokens::{Known, NoToken};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;
use std::time::Duration;

/// Header with the session's id.
pub(crate) const SESSION: &str = "x-leadscrew-session";
/// The session of clients on this computer that do not say who they are.
const LOCAL: &str = "local";

/// What a browser may load for the page: nothing from elsewhere, no script and no style that is not
/// a file of ours. What the page sets of styles by script goes through the CSSOM, which the policy
/// does not concern.
const POLICY: &str = "default-src 'self'; script-src 'self'; style-src 'self'; \
    img-src 'self' data: blob:; connect-src 'self'; worker-src 'self' blob:; object-src 'none'; \
    base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// Who asks.
#[derive(Clone, Debug)]
pub(crate) struct Who {
    pub(crate) session: String,
}

/// Before and after every handler.
pub(crate) async fn guard(
    State(app): State<Arc<App>>,
    mut request: Request,
    next: Next,
) -> Response {
    let path = request.uri().path();
    let is_data = ["/api/", "/mtconnect", "/metrics"].iter().any(|base| path.starts_with(base));
    let mut response = match look(&app, &mut request) {
        Ok(()) => next.run(request).await,
        Err(error) => error.into_response(),
    };
    let headers = response.headers_mut();
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    // a report has a policy of its own
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
    headers.entry(header::X_FRAME_OPTIONS).or_insert(HeaderValue::from_static("DENY"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    if is_data {
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    }
    response
}

fn look(app: &App, request: &mut Request) -> Result<(), ApiError> {
    let headers = request.headers();
    let host = text(headers, header::HOST.as_str()).unwrap_or_default().to_ascii_lowercase();
    if !app.hosts.contains(&host) {
        return Err(ApiError::new(
            StatusCode::FORBIDDEN,
            format!("this server is not called \"{}\"", host.chars().take(80).collect::<String>()),
        )
        .with_remedy(format!("call it {}", app.hosts.join(" or "))));
    }
    let path = request.uri().path();
    let is_socket = matches!(path, "/api/v1/ws" | "/api/v1/lsp");
    let changes = is_socket || !is_read(request.method());
    if changes && headers.get_all(header::ORIGIN).iter().any(|from| !is_of(from, &host)) {
        let reason = "a page from elsewhere may not lead this machine";
        return Err(ApiError::new(StatusCode::FORBIDDEN, reason));
    }
    let is_open =
        !path.starts_with("/api/") || matches!(path, "/api/v1/session" | "/api/v1/openapi.json");
    if !is_open {
        // what a browser opens in a window of its own says who asks in its address
        let is_opened = is_socket || is_file_of_a_run(path);
        let asked_in_address = request.uri().query().filter(|_| is_opened).and_then(session_of);
        let who = identify(app, headers, asked_in_address)?;
        request.extensions_mut().insert(who);
    }
    Ok(())
}

/// A file that is opened in a window of its own.
fn is_file_of_a_run(path: &str) -> bool {
    let of_a_run = path.strip_prefix("/api/v1/runs/").and_then(|rest| rest.split_once('/'));
    of_a_run.is_some_and(|(_, file)| matches!(file, "report" | "certificate"))
}

/// Is this the origin of a page of ours? One that cannot be read is not.
fn is_of(origin: &HeaderValue, host: &str) -> bool {
    let from = origin.to_str().ok().and_then(|origin| origin.split_once("://"));
    from.is_some_and(|(_, from)| from.eq_ignore_ascii_case(host))
}

const fn is_read(method: &Method) -> bool {
    matches!(*method, Method::GET | Method::HEAD)
}

/// `session=…` of a query.
fn session_of(query: &str) -> Option<&str> {
    query.split('&').find_map(|pair| pair.strip_prefix("session="))
}

fn text<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    headers.get(name).and_then(|value| value.to_str().ok())
}

/// Who asks: by session, by token, or from this computer.
fn identify(app: &App, headers: &HeaderMap, address: Option<&str>) -> Result<Who, ApiError> {
    let now = app.clock.now();
    if let Some(session) = text(headers, SESSION).or(address).filter(|id| !id.is_empty()) {
        app.rights().seen(session, now)?;
        return Ok(Who { session: session.to_owned() });
    }
    let Known { name, role, left } = match &app.tokens {
        None => Known { name: LOCAL.to_owned(), role: Role::Operator, left: None },
        Some(tokens) => {
            let bearer = text(headers, header::AUTHORIZATION.as_str());
            let token = bearer.and_then(|value| value.strip_prefix("Bearer "));
            tokens.find(token.unwrap_or_default(), app.clock.unix_ms()).map_err(no_token)?
        }
    };
    // its id cannot be one that was drawn: those have no blank
    let session = format!("of {name}");
    app.rights().open(&session, &name, (role, left), now)?;
    app.rights().seen(&session, now)?;
    Ok(Who { session })
}

/// Who only reads what is observed of the machine needs a token where there are some, and opens no
/// session; for how long it lasts.
pub(crate) fn may_watch(app: &App, headers: &HeaderMap) -> Result<Option<Duration>, NoToken> {
    let Some(tokens) = &app.tokens else { return Ok(None) };
    let bearer = text(headers, header::AUTHORIZATION.as_str());
    let token = bearer.and_then(|value| value.strip_prefix("Bearer "));
    tokens.find(token.unwrap_or_default(), app.clock.unix_ms()).map(|known| known.left)
}

/// Without a token nothing is told.
pub(crate) fn no_token(why: NoToken) -> ApiError {
    if why == NoToken::Expired {
        return Denied::Expired.into();
    }
    ApiError::new(StatusCode::UNAUTHORIZED, "a token is needed, and this is none")
        .with_remedy("send it as Authorization: Bearer, or open a session with it")
}
