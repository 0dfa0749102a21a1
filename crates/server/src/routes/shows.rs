//! What can be seen: all of it from the latest picture, without a word to the control.
use crate::answer::{ApiError, json};
use crate::app::App;
use crate::wire::{
    AlarmBody, EventBody, EventsBody, FeatureBody, MachineBody, OffsetBody, ProgramBody, ToolBody,
};
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::Response;
use serde::Deserialize;
use std::sync::Arc;

pub(super) async fn status(State(app): State<Arc<App>>) -> Response {
    json(&*app.fields(&app.client.latest()))
}

/// `?after=N`.
#[derive(Deserialize)]
pub(super) struct EventsAfter {
    #[serde(default)]
    after: u64,
}

pub(super) async fn events(
    State(app): State<Arc<App>>,
    query: Result<Query<EventsAfter>, axum::extract::rejection::QueryRejection>,
) -> Result<Response, ApiError> {
    let Query(EventsAfter { after }) = query.map_err(|_| {
        ApiError::new(StatusCode::BAD_REQUEST, "after is the number of an event, from 0")
    })?;
    let (events, lost, last) = app.client.events_after(after);
    let shown = |text: &str| app.folder.shown(text);
    let events = events.iter().map(|event| EventBody::of(event, &shown)).collect();
    Ok(json(&EventsBody { events, last, lost }))
}

pub(super) async fn machine(State(app): State<Arc<App>>) -> Response {
    json(&MachineBody::of(app.client.machine(), app.client.signals().names()))
}

pub(super) async fn program(State(app): State<Arc<App>>) -> Response {
    let picture = app.client.latest();
    let shown = |text: &str| app.folder.shown(text);
    json(&picture.program.as_deref().map(|program| ProgramBody::of(program, &shown)))
}

pub(super) async fn offsets(State(app): State<Arc<App>>) -> Response {
    let picture = app.client.latest();
    let active = &picture.status.work_offset;
    let offsets = picture.offsets.iter().map(|offset| OffsetBody::of(offset, active));
    json(&offsets.collect::<Vec<_>>())
}

pub(super) async fn tools(State(app): State<Arc<App>>) -> Response {
    json(&app.client.latest().tools.iter().map(ToolBody::of).collect::<Vec<_>>())
}

pub(super) async fn features(State(app): State<Arc<App>>) -> Response {
    json(&app.client.latest().features.iter().map(FeatureBody::of).collect::<Vec<_>>())
}

pub(super) async fn alarms(State(app): State<Arc<App>>) -> Response {
    let shown = |text: &str| app.folder.shown(text);
    let picture = app.client.latest();
    json(&picture.alarms.iter().map(|alarm| AlarmBody::of(alarm, &shown)).collect::<Vec<_>>())
}

pub(super) async fn document() -> Response {
    json(&super::openapi())
}
