//! The history of runs: what was executed, how it was judged, and what is left of it on the disk.
use super::on_disk;
use crate::answer::{ApiError, json};
use crate::app::App;
use crate::runs::{CERTIFICATE, REPORT, Search, TraceQuery, read as read_file};
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

/// A report has its script and its style within it, and asks for nothing; in a frame of the page it
/// is on its own.
const POLICY_OF_REPORT: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; frame-ancestors 'self'; sandbox allow-scripts";

fn wrong(query: &QueryRejection) -> ApiError {
    ApiError::new(StatusCode::BAD_REQUEST, query.body_text())
}

fn missing() -> ApiError {
    ApiError::new(StatusCode::NOT_FOUND, "there is no such run, or it has no such file")
        .with_remedy("GET runs lists them")
}

pub(super) async fn list(
    State(app): State<Arc<App>>,
    query: Result<Query<Search>, QueryRejection>,
) -> Result<Response, ApiError> {
    let Query(search) = query.map_err(|e| wrong(&e))?;
    Ok(json(&on_disk(&app, move |app| app.runs.list(&search)).await?))
}

pub(super) async fn detail(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Response, ApiError> {
    let found = on_disk(&app, move |app| app.runs.detail(&id)).await?;
    let text = found.ok_or_else(missing)?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

pub(super) async fn report(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Response, ApiError> {
    let text = file(&app, id, REPORT).await?;
    let headers = [
        (header::CONTENT_TYPE, "text/html; charset=utf-8"),
        (header::CONTENT_SECURITY_POLICY, POLICY_OF_REPORT),
        (header::X_FRAME_OPTIONS, "SAMEORIGIN"),
    ];
    Ok((headers, text).into_response())
}

pub(super) async fn certificate(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Response, ApiError> {
    let text = file(&app, id, CERTIFICATE).await?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

async fn file(app: &Arc<App>, id: String, name: &'static str) -> Result<Vec<u8>, ApiError> {
    let read = move |app: &App| read_file(&app.runs.file(&id, name)?);
    on_disk(app, read).await?.ok_or_else(missing)
}

pub(super) async fn trace(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
    query: Result<Query<TraceQuery>, QueryRejection>,
) -> Result<Response, ApiError> {
    let Query(asked) = query.map_err(|e| wrong(&e))?;
    let found = on_disk(&app, move |app| app.runs.trace(&id, &asked)).await?;
    let columns = found.ok_or_else(missing)?;
    let columns = columns.map_err(|why| ApiError::new(StatusCode::UNPROCESSABLE_ENTITY, why))?;
    Ok(json(&columns))
}
