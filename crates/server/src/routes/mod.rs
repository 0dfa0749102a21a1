//! The table of addresses: router and OpenAPI document are made from it, so that each address
//! stands in both.
mod openapi;
mod programs;
mod requests;
mod runs;
mod sessions;
mod shows;

pub use openapi::openapi;

use crate::answer::ApiError;
use crate::app::App;
use crate::wire::{
    AcceptedBody, AlarmBody, EventsBody, FeatureBody, FolderBody, MachineBody, OffsetBody,
    OperatorBody, OperatorOrder, ProgramBody, RequestBody, RunDetailBody, RunTraceBody, RunsBody,
    SavedBody, SessionBody, SessionOrder, ToolBody,
};
use axum::Router;
use axum::http::StatusCode;
use axum::routing::{MethodRouter, get, post, put};
use control::operation::Status;
use openapi::Shape;
use std::sync::Arc;

/// An address, and what it does.
struct Route {
    method: &'static str,
    /// Below `/api/v1`, as axum writes it.
    path: &'static str,
    summary: &'static str,
    body: Shape,
    answer: Shape,
    handler: MethodRouter<Arc<App>>,
}

/// What all addresses begin with.
const BASE: &str = "/api/v1";

fn row(
    method: &'static str,
    path: &'static str,
    summary: &'static str,
    [body, answer]: [Shape; 2],
    handler: MethodRouter<Arc<App>>,
) -> Route {
    Route { method, path, summary, body, answer, handler }
}

/// All of them.
fn table() -> Vec<Route> {
    let parts = [of_the_control(), of_programs(), of_lists(), of_runs(), of_clients()];
    parts.into_iter().flatten().collect()
}

/// How the control is, and what it is asked for.
fn of_the_control() -> Vec<Route> {
    let no = Shape::Nothing;
    vec![
        row(
            "get",
            "/status",
            "How the control is",
            [no, Shape::of::<Status>()],
            get(shows::status),
        ),
        row(
            "get",
            "/events",
            "What has happened since the event `after`",
            [no, Shape::of::<EventsBody>()],
            get(shows::events),
        ),
        row(
            "post",
            "/request",
            "Ask the control for something",
            [Shape::of::<RequestBody>(), Shape::of::<AcceptedBody>()],
            post(requests::request),
        ),
        row(
            "get",
            "/machine",
            "The machine",
            [no, Shape::of::<MachineBody>()],
            get(shows::machine),
        ),
        row(
            "get",
            "/program",
            "The program that is loaded, or null",
            [no, Shape::of::<ProgramBody>()],
            get(shows::program),
        ),
    ]
}

/// The folder of programs.
fn of_programs() -> Vec<Route> {
    let no = Shape::Nothing;
    vec![
        row(
            "get",
            "/programs",
            "The folder of programs",
            [no, Shape::of::<FolderBody>()],
            get(programs::list),
        ),
        row("get", "/programs/{*path}", "A program's text", [no, Shape::Text], get(programs::read)),
        row(
            "put",
            "/programs/{*path}",
            "Write a program",
            [Shape::Text, Shape::of::<SavedBody>()],
            put(programs::save),
        ),
        row(
            "post",
            "/programs/{*path}",
            "Write a program that is not there yet",
            [Shape::Text, Shape::of::<SavedBody>()],
            post(programs::upload),
        ),
    ]
}

/// What is listed.
fn of_lists() -> Vec<Route> {
    let no = Shape::Nothing;
    vec![
        row(
            "get",
            "/offsets",
            "Work offsets",
            [no, Shape::list_of::<OffsetBody>()],
            get(shows::offsets),
        ),
        row("get", "/tools", "Tools", [no, Shape::list_of::<ToolBody>()], get(shows::tools)),
        row(
            "get",
            "/features",
            "What was cut, as it was judged",
            [no, Shape::list_of::<FeatureBody>()],
            get(shows::features),
        ),
        row(
            "get",
            "/alarms",
            "Alarms, oldest first",
            [no, Shape::list_of::<AlarmBody>()],
            get(shows::alarms),
        ),
    ]
}

/// The history of runs.
fn of_runs() -> Vec<Route> {
    let no = Shape::Nothing;
    vec![
        row(
            "get",
            "/runs",
            "Programs that were executed, the latest first",
            [no, Shape::of::<RunsBody>()],
            get(runs::list),
        ),
        row(
            "get",
            "/runs/{id}",
            "A run: features and alarms",
            [no, Shape::of::<RunDetailBody>()],
            get(runs::detail),
        ),
        row("get", "/runs/{id}/report", "Its report, a page", [no, Shape::Text], get(runs::report)),
        row(
            "get",
            "/runs/{id}/certificate",
            "Its certificate",
            [no, Shape::Any],
            get(runs::certificate),
        ),
        row(
            "get",
            "/runs/{id}/trace",
            "Signals of its trace, least and greatest value by column",
            [no, Shape::of::<RunTraceBody>()],
            get(runs::trace),
        ),
    ]
}

/// Clients, and this document.
fn of_clients() -> Vec<Route> {
    let no = Shape::Nothing;
    vec![
        row(
            "post",
            "/session",
            "Open a session",
            [Shape::of::<SessionOrder>(), Shape::of::<SessionBody>()],
            post(sessions::open),
        ),
        row(
            "get",
            "/operator",
            "Who commands",
            [no, Shape::of::<OperatorBody>()],
            get(sessions::operator),
        ),
        row(
            "post",
            "/operator",
            "Ask for the right to command, hand it over, keep it, give it back",
            [Shape::of::<OperatorOrder>(), Shape::of::<OperatorBody>()],
            post(sessions::order),
        ),
        row(
            "get",
            "/ws",
            "WebSocket: status, events, features, scope, requests",
            [no, Shape::Nothing],
            get(crate::socket::open),
        ),
        row(
            "get",
            "/lsp",
            "WebSocket: the language server",
            [no, Shape::Nothing],
            get(crate::language::open),
        ),
        row("get", "/openapi.json", "This document", [no, Shape::Any], get(shows::document)),
    ]
}

/// The disk may be slow: not in a thread that answers others.
async fn on_disk<T: Send + 'static>(
    app: &Arc<App>,
    work: impl FnOnce(&App) -> T + Send + 'static,
) -> Result<T, ApiError> {
    let app = Arc::clone(app);
    let done = tokio::task::spawn_blocking(move || work(&app)).await;
    done.map_err(|e| ApiError::new(StatusCode::INTERNAL_SERVER_ERROR, e.to_string()))
}

/// The router of the API.
pub(crate) fn router() -> Router<Arc<App>> {
    table().into_iter().fold(Router::new(), |router, row| {
        router.route(&format!("{BASE}{}", row.path), row.handler)
    })
}
