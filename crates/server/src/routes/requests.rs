//! What the control is asked for.
use crate::answer::{ApiError, json, object};
use crate::app::App;
use crate::rights::Who;
use crate::wire::AcceptedBody;
use axum::Extension;
use axum::body::Body;
use axum::extract::State;
use axum::response::Response;
use std::sync::Arc;

pub(super) async fn request(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    body: Body,
) -> Result<Response, ApiError> {
    let body = object(body, app.timeouts.body).await?;
    let accepted = app.request(who.session, body).await?;
    Ok(json(&AcceptedBody::of(&accepted, &|text| app.folder.shown(text))))
}
