//! The folder of programs. Writing is for who commands: a program under a running machine is not
//! another client's to change; and who replaces one says which, or that it may be any.
use super::on_disk;
use crate::answer::{ApiError, bytes, json};
use crate::app::App;
use crate::folder::{LARGEST_PROGRAM, ProgramText, Replaces};
use crate::rights::Who;
use crate::wire::SavedBody;
use axum::Extension;
use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use std::sync::Arc;

pub(super) async fn list(State(app): State<Arc<App>>) -> Result<Response, ApiError> {
    Ok(json(&on_disk(&app, |app| app.folder.list()).await?))
}

/// `?before=true`, `?replace=true`.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ProgramQuery {
    /// The version that was replaced last.
    #[serde(default)]
    before: bool,
    /// Whichever program is there may be replaced.
    #[serde(default)]
    replace: bool,
    /// Of a session: read elsewhere.
    #[serde(default, rename = "session")]
    _session: Option<String>,
}

type Query = Result<axum::extract::Query<ProgramQuery>, QueryRejection>;

fn asked(query: Query) -> Result<ProgramQuery, ApiError> {
    let wrong = |e: QueryRejection| ApiError::new(StatusCode::BAD_REQUEST, e.body_text());
    query.map(|axum::extract::Query(asked)| asked).map_err(wrong)
}

pub(super) async fn read(
    State(app): State<Arc<App>>,
    Path(path): Path<String>,
    query: Query,
) -> Result<Response, ApiError> {
    let ProgramQuery { before, .. } = asked(query)?;
    let program =
        on_disk(
            &app,
            move |app| {
                if before { app.folder.read_before(&path) } else { app.folder.read(&path) }
            },
        );
    let ProgramText { text, version } = program.await??;
    let kind = "text/plain; charset=utf-8".to_owned();
    Ok(([(header::CONTENT_TYPE, kind), (header::ETAG, tag(&version))], text).into_response())
}

pub(super) async fn save(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    Path(path): Path<String>,
    query: Query,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, ApiError> {
    let replaces = replaced(&asked(query)?, &headers)?;
    write(app, who, path, body, replaces).await
}

pub(super) async fn upload(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    Path(path): Path<String>,
    headers: HeaderMap,
    body: Body,
) -> Result<Response, ApiError> {
    whole(&headers)?;
    write(app, who, path, body, Replaces::Nothing).await
}

fn tag(version: &str) -> String {
    format!("\"{version}\"")
}

/// A part of a program is none.
fn whole(headers: &HeaderMap) -> Result<(), ApiError> {
    if headers.contains_key(header::CONTENT_RANGE) {
        let reason = "a program is written whole, and this is a part of one (Content-Range)";
        return Err(ApiError::new(StatusCode::BAD_REQUEST, reason));
    }
    Ok(())
}

/// What a client says of the program that is to be replaced.
fn replaced(asked: &ProgramQuery, headers: &HeaderMap) -> Result<Replaces, ApiError> {
    whole(headers)?;
    let mut versions = Vec::new();
    for value in headers.get_all(header::IF_MATCH) {
        for tag in value.to_str().unwrap_or_default().split(',').map(str::trim) {
            if tag == "*" {
                return Ok(Replaces::Any);
            }
            // one that is no tag of ours matches nothing
            versions.push(tag.trim_matches('"').to_owned());
        }
    }
    Ok(match (versions.is_empty(), asked.replace) {
        (false, _) => Replaces::Version(versions),
        (true, true) => Replaces::Any,
        (true, false) => Replaces::Nothing,
    })
}

async fn write(
    app: Arc<App>,
    who: Who,
    path: String,
    body: Body,
    replaces: Replaces,
) -> Result<Response, ApiError> {
    app.rights().may_command(who.session, false, app.clock.now())?;
    let text = bytes(body, LARGEST_PROGRAM, app.timeouts.body).await?;
    let (place, length) = (path.clone(), text.len() as u64);
    let written = on_disk(&app, move |app| app.folder.write(&place, &text, &replaces));
    let version = written.await??;
    let etag = tag(&version);
    let saved = SavedBody { path, bytes: length, version };
    Ok(([(header::ETAG, etag)], json(&saved)).into_response())
}
