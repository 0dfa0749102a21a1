//! What the control is asked for.
use crate::answer::{ApiError, json, object};
use crate::app::App;
use crate::paced::Paced;
use crate::reserved::{ForStops, too_many};
use crate::rights::Who;
use crate::wire::{AcceptedBody, RequestBody};
use axum::Extension;
use axum::body::Body;
use axum::extract::State;
use axum::response::Response;
use std::sync::Arc;

pub(super) async fn request(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    for_stops: Option<Extension<ForStops>>,
    body: Body,
) -> Result<Response, ApiError> {
    let body: RequestBody = object(body, app.timeouts.body).await?;
    if for_stops.is_some() && !body.is_stop() {
        return Err(too_many());
    }
    let is_paced = !body.is_stop();
    if is_paced {
        app.pace.turn().await;
    }
    let accepted = app.request(who.session, body).await?;
    let mut answer = json(&AcceptedBody::of(&accepted, &|text| app.folder.shown(text)));
    if is_paced {
        answer.extensions_mut().insert(Paced);
    }
    Ok(answer)
}
