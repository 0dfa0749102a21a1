//! What is looked at before any handler: by which name the server is called, from which page, by
//! whom; and what every answer says to a browser.
//!
//! A page of another site can make a browser send requests to 127.0.0.1, and a name of that site
//! can be made to lead there (DNS rebinding). So the `Host` must be a name of this server, and an
//! `Origin`, which every browser sends with what changes something, must be the same.
use crate::access::{Access, Admission};
use crate::answer::ApiError;
use crate::app::App;
use crate::connections::Connection;
use crate::paced::Paced;
use crate::reserved::REQUESTS;
use crate::rights::{Denied, Shown};
use crate::role::Role;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;
use std::time::Duration;

/// Header with the secret of a session.
pub(crate) const SESSION: &str = "x-leadscrew-session";
/// Time between two checks that a credential is still valid.
const LOOKED_AT: Duration = Duration::from_millis(500);

/// What a browser may load for the page: nothing from elsewhere, no script and no style that is not
/// a file of ours. What the page sets of styles by script goes through the CSSOM, which the policy
/// does not concern.
const POLICY: &str = "default-src 'self'; script-src 'self'; style-src 'self'; \
    img-src 'self' data: blob:; connect-src 'self'; worker-src 'self' blob:; object-src 'none'; \
    base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// Before and after every handler, that of the page too.
pub(crate) async fn guard(app: Arc<App>, request: Request, next: Next) -> Response {
    let path = request.uri().path();
    let is_data = ["/api/", "/mtconnect", "/metrics"].iter().any(|base| path.starts_with(base));
    let (may_stop, has_body) = (path == REQUESTS, has_body(request.headers()));
    if !may_stop {
        app.pace.turn().await;
    }
    let mut response = match look(&app, &request, is_data) {
        Ok(()) => next.run(request).await,
        Err(error) => error.into_response(),
    };
    // a stop has been asked for before its turn, and its answer waits for that; so does what is
    // refused
    if may_stop && response.extensions_mut().remove::<Paced>().is_none() {
        app.pace.turn().await;
    }
    let is_unread = UNREAD.contains(&response.status());
    let headers = response.headers_mut();
    if has_body && is_unread {
        headers.insert(header::CONNECTION, HeaderValue::from_static("close"));
    }
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

/// What is answered before a body is read. The connection ends with it: what is left of the body
/// would be taken for the next request, and a client that is not told of it finds the end instead
/// of an answer.
const UNREAD: [StatusCode; 6] = [
    StatusCode::UNAUTHORIZED,
    StatusCode::FORBIDDEN,
    StatusCode::NOT_FOUND,
    StatusCode::METHOD_NOT_ALLOWED,
    StatusCode::PAYLOAD_TOO_LARGE,
    StatusCode::SERVICE_UNAVAILABLE,
];

fn has_body(headers: &HeaderMap) -> bool {
    let length = headers.get(header::CONTENT_LENGTH);
    headers.contains_key(header::TRANSFER_ENCODING) || length.is_some_and(|length| length != "0")
}

fn look(app: &App, request: &Request, is_data: bool) -> Result<(), ApiError> {
    let headers = request.headers();
    let host = one(headers, &header::HOST)?.unwrap_or_default().to_ascii_lowercase();
    if !app.hosts.contains(&host) {
        return Err(ApiError::new(
            StatusCode::FORBIDDEN,
            format!("this server is not called \"{}\"", host.chars().take(80).collect::<String>()),
        )
        .with_remedy(format!("call it {}", app.hosts.join(" or "))));
    }
    let path = request.uri().path();
    let is_socket =
        matches!(path, "/api/v1/ws" | "/api/v1/lsp") || headers.contains_key(header::UPGRADE);
    let changes = is_socket || !is_read(request.method());
    let is_ours = |from: &HeaderValue| is_of(from, app.scheme, &host);
    let is_from_elsewhere = changes && !headers.get_all(header::ORIGIN).iter().all(is_ours);
    // browsers say so of what a page of another site asks for, of reading too
    let is_of_another_site =
        is_data && headers.get("sec-fetch-site").is_some_and(|site| site == "cross-site");
    if is_from_elsewhere || is_of_another_site {
        let reason = "a page from elsewhere may not lead this machine";
        return Err(ApiError::new(StatusCode::FORBIDDEN, reason));
    }
    Ok(())
}

/// Before the handler of an address of the table: who asks, and whether he may.
pub(crate) async fn admit(
    app: Arc<App>,
    admission: Admission,
    mut request: Request,
    next: Next,
) -> Response {
    let headers = request.headers();
    match admission.access {
        Access::Anyone => {}
        Access::Watcher => match watcher(&app, headers) {
            Ok(_) if !has_place(&request, Role::Viewer) => return no_place(),
            Ok(watcher) => drop(request.extensions_mut().insert(watcher)),
            Err(why) => return (admission.refused)(&app, headers, why),
        },
        Access::Viewer | Access::Operator => {
            let query = request.uri().query().filter(|_| admission.is_opened_in_a_window);
            let secret = match one(headers, &HeaderName::from_static(SESSION)) {
                Ok(secret) => secret.or(query.and_then(session_of)).filter(|id| !id.is_empty()),
                Err(error) => return error.into_response(),
            };
            let token = match bearer(headers) {
                Ok(token) => token,
                Err(error) => return error.into_response(),
            };
            match app.rights().identify(token, secret, app.clock.now()) {
                Ok(who) if admission.access == Access::Operator && who.role == Role::Viewer => {
                    return (admission.refused)(&app, headers, Denied::Viewer);
                }
                Ok(who) if !has_place(&request, who.role) => return no_place(),
                Ok(who) => drop(request.extensions_mut().insert(who)),
                Err(why) => return (admission.refused)(&app, headers, why),
            }
        }
    }
    next.run(request).await
}

/// Whether the connection has a place among those of its role.
fn has_place(request: &Request, role: Role) -> bool {
    let connection = request.extensions().get::<Arc<Connection>>();
    connection.is_none_or(|connection| connection.is_of(role))
}

fn no_place() -> Response {
    let reason = "too many connections of viewers have something under way";
    ApiError::new(StatusCode::SERVICE_UNAVAILABLE, reason).into_response()
}

/// Who only reads what is observed of the machine, and opens no session.
#[derive(Clone, Debug)]
pub(crate) struct Watcher(Shown);

impl Watcher {
    /// Until what it was admitted with has ended.
    pub(crate) async fn ended(&self, app: &App) {
        while app.rights().role_of(&self.0, app.clock.now()).is_ok() {
            tokio::time::sleep(LOOKED_AT).await;
        }
    }
}

fn watcher(app: &App, headers: &HeaderMap) -> Result<Watcher, Denied> {
    let token = bearer(headers).map_err(|_| Denied::NoToken)?;
    let shown = app.rights().shown_by(token, app.clock.now())?;
    app.rights().role_of(&shown, app.clock.now())?;
    Ok(Watcher(shown))
}

/// Until a session has ended.
pub(crate) async fn ended(app: &App, session: crate::rights::SessionId) {
    while !app.rights().has_ended(session, app.clock.now()) {
        tokio::time::sleep(LOOKED_AT).await;
    }
}

/// A refusal in the form that all have.
pub(crate) fn refused(_: &App, _: &HeaderMap, why: Denied) -> Response {
    ApiError::from(why).into_response()
}

/// The token that is sent.
pub(crate) fn bearer(headers: &HeaderMap) -> Result<Option<&str>, ApiError> {
    let value = one(headers, &header::AUTHORIZATION)?;
    Ok(value.and_then(|value| value.strip_prefix("Bearer ")).map(str::trim))
}

/// Is this the origin of a page of ours? One that cannot be read is not.
fn is_of(origin: &HeaderValue, scheme: &str, host: &str) -> bool {
    let from = origin.to_str().ok().and_then(|origin| origin.split_once("://"));
    from.is_some_and(|(by, from)| by == scheme && from.eq_ignore_ascii_case(host))
}

const fn is_read(method: &Method) -> bool {
    matches!(*method, Method::GET | Method::HEAD)
}

/// `session=…` of a query.
fn session_of(query: &str) -> Option<&str> {
    query.split('&').find_map(|pair| pair.strip_prefix("session="))
}

/// The value of a header that says who asks: there is one at most, and it is text. What cannot be
/// read is not taken for nothing.
fn one<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Result<Option<&'a str>, ApiError> {
    let mut values = headers.get_all(name).iter();
    let value = values.next().map(HeaderValue::to_str).transpose();
    match (value, values.next()) {
        (Ok(value), None) => Ok(value),
        _ => Err(ApiError::new(
            StatusCode::BAD_REQUEST,
            format!("the header {name} is there once at most, and is text"),
        )),
    }
}
