//! The folder of programs. Writing is for who commands: a program under a running machine is not
//! another client's to change.
use super::on_disk;
use crate::answer::{ApiError, bytes, json};
use crate::app::App;
use crate::folder::{FolderError, LARGEST_PROGRAM};
use crate::guard::Who;
use crate::wire::SavedBody;
use axum::Extension;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

pub(super) async fn list(State(app): State<Arc<App>>) -> Result<Response, ApiError> {
    Ok(json(&on_disk(&app, |app| app.folder.list()).await?))
}

pub(super) async fn read(
    State(app): State<Arc<App>>,
    Path(path): Path<String>,
) -> Result<Response, ApiError> {
    let text = on_disk(&app, move |app| app.folder.read(&path)).await??;
    Ok(([(header::CONTENT_TYPE, "text/plain; charset=utf-8")], text).into_response())
}

pub(super) async fn save(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    Path(path): Path<String>,
    body: Body,
) -> Result<Response, ApiError> {
    write(app, who, path, body, true).await
}

pub(super) async fn upload(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    Path(path): Path<String>,
    body: Body,
) -> Result<Response, ApiError> {
    write(app, who, path, body, false).await
}

async fn write(
    app: Arc<App>,
    who: Who,
    path: String,
    body: Body,
    overwrites: bool,
) -> Result<Response, ApiError> {
    app.rights().may_command(&who.session, false, app.clock.now())?;
    let text = bytes(body, LARGEST_PROGRAM, app.timeouts.body).await?;
    let saved = SavedBody { path: path.clone(), bytes: text.len() as u64 };
    let written: Result<(), FolderError> =
        on_disk(&app, move |app| app.folder.write(&path, &text, overwrites)).await?;
    written?;
    Ok(json(&saved))
}
