//! Sessions, and the right to command.
use crate::answer::{ApiError, json, object};
use crate::app::App;
use crate::guard::{Who, no_token};
use crate::rights::Role;
use crate::tokens::random;
use crate::wire::{SessionBody, SessionOrder};
use axum::Extension;
use axum::body::Body;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use std::sync::Arc;

pub(super) async fn open(State(app): State<Arc<App>>, body: Body) -> Result<Response, ApiError> {
    let SessionOrder { name, token } = object(body, app.timeouts.body).await?;
    let (role, left) = match &app.tokens {
        None => (Role::Operator, None),
        Some(tokens) => {
            let known = tokens
                .find(token.as_deref().unwrap_or_default(), app.clock.unix_ms())
                .map_err(no_token)?;
            (known.role, known.left)
        }
    };
    let session =
        random::<16>().map_err(|why| ApiError::new(StatusCode::INTERNAL_SERVER_ERROR, why))?;
    let mut rights = app.rights();
    rights.open(&session, &name, (role, left), app.clock.now())?;
    let commands = rights.commands(&session, app.clock.now());
    let name = name.trim().to_owned();
    Ok(json(&SessionBody { session, name, role: role.name(), commands }))
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
    rights.order(&who.session, order, app.clock.now())?;
    Ok(json(&rights.shown(app.clock.now())))
}
