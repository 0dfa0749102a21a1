//! Sessions, and the right to command.
use crate::answer::{ApiError, json, object};
use crate::app::App;
use crate::guard::bearer;
use crate::rights::{Denied, Opened, Who};
use crate::wire::{SessionBody, SessionOrder};
use axum::Extension;
use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use std::sync::Arc;

pub(super) async fn open(
    State(app): State<Arc<App>>,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, ApiError> {
    let SessionOrder { name, token } = object(body, app.timeouts.body).await?;
    let sent = bearer(&headers)?;
    if token.as_deref().zip(sent).is_some_and(|(token, sent)| token != sent) {
        return Err(Denied::NoToken.into()); // two that differ say nothing
    }
    let now = app.clock.now();
    let mut rights = app.rights();
    let shown = rights.shown_by(token.as_deref().or(sent), now)?;
    let Opened { secret: session, name, who } = rights.open(&name, shown, now)?;
    let commands = rights.commands(who.session, now);
    Ok(json(&SessionBody { session, name, role: who.role.name(), commands }))
}

pub(super) async fn operator(State(app): State<Arc<App>>) -> Response {
    json(&app.rights().shown(app.clock.now()))
}

pub(super) async fn order(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    body: Body,
) -> Result<Response, ApiError> {
    let order = object(body, app.timeouts.body).await?;
    let mut rights = app.rights();
    rights.order(who.session, order, app.clock.now())?;
    Ok(json(&rights.shown(app.clock.now())))
}
