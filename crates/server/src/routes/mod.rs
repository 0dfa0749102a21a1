//! The table of addresses: router and OpenAPI document are made from it, so that each address
//! stands in both.
mod openapi;
mod programs;
mod requests;
mod runs;
mod sessions;
mod shows;

pub use openapi::openapi;

use crate::access::{Access, Address, Admission, Watched};
use crate::answer::ApiError;
use crate::app::App;
use crate::wire::{
    AcceptedBody, AlarmBody, EventsBody, FeatureBody, FolderBody, MachineBody, OffsetBody,
    OperatorBody, OperatorOrder, ProgramBody, RequestBody, RunDetailBody, RunTraceBody, RunsBody,
    SavedBody, SessionBody, SessionOrder, ToolBody,
};
use crate::{guard, metrics, mtconnect};
use Access::{Anyone, Operator, Viewer};
use axum::Router;
use axum::http::{Method, StatusCode};
use axum::routing::{MethodRouter, get, post, put};
use control::operation::Status;
use openapi::Shape;
use std::sync::Arc;

/// An address, and what it does.
struct Route {
    method: &'static str,
    /// Below its base, as axum writes it.
    path: &'static str,
    summary: &'static str,
    admission: Admission,
    body: Shape,
    answer: Shape,
    handler: MethodRouter<Arc<App>>,
}

impl Route {
    /// An address that is not of the API: programs that watch know it.
    fn of_watchers(watched: Watched) -> Self {
        let Watched { path, refused, handler } = watched;
        let admission =
            Admission { access: Access::Watcher, is_opened_in_a_window: false, refused };
        let (body, answer) = (Shape::Nothing, Shape::Any);
        Self { method: "any", path, summary: "", admission, body, answer, handler }
    }

    /// Its session may stand in its address.
    const fn opened_in_a_window(mut self) -> Self {
        self.admission.is_opened_in_a_window = true;
        self
    }
}

/// What all addresses of the API begin with.
const BASE: &str = "/api/v1";

fn row(
    method: &'static str,
    path: &'static str,
    (access, summary): (Access, &'static str),
    [body, answer]: [Shape; 2],
    handler: MethodRouter<Arc<App>>,
) -> Route {
    let admission = Admission { access, is_opened_in_a_window: false, refused: guard::refused };
    Route { method, path, summary, admission, body, answer, handler }
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
            (Viewer, "How the control is"),
            [no, Shape::of::<Status>()],
            get(shows::status),
        ),
        row(
            "get",
            "/events",
            (Viewer, "What has happened since the event `after`"),
            [no, Shape::of::<EventsBody>()],
            get(shows::events),
        ),
        row(
            "post",
            "/request",
            (Operator, "Ask the control for something"),
            [Shape::of::<RequestBody>(), Shape::of::<AcceptedBody>()],
            post(requests::request),
        ),
        row(
            "get",
            "/machine",
            (Viewer, "The machine"),
            [no, Shape::of::<MachineBody>()],
            get(shows::machine),
        ),
        row(
            "get",
            "/program",
            (Viewer, "The program that is loaded, or null"),
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
            (Viewer, "The folder of programs"),
            [no, Shape::of::<FolderBody>()],
            get(programs::list),
        ),
        row(
            "get",
            "/programs/{*path}",
            (Viewer, "A program's text"),
            [no, Shape::Text],
            get(programs::read),
        ),
        row(
            "put",
            "/programs/{*path}",
            (Operator, "Write a program"),
            [Shape::Text, Shape::of::<SavedBody>()],
            put(programs::save),
        ),
        row(
            "post",
            "/programs/{*path}",
            (Operator, "Write a program that is not there yet"),
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
            (Viewer, "Work offsets"),
            [no, Shape::list_of::<OffsetBody>()],
            get(shows::offsets),
        ),
        row(
            "get",
            "/tools",
            (Viewer, "Tools"),
            [no, Shape::list_of::<ToolBody>()],
            get(shows::tools),
        ),
        row(
            "get",
            "/features",
            (Viewer, "What was cut, as it was judged"),
            [no, Shape::list_of::<FeatureBody>()],
            get(shows::features),
        ),
        row(
            "get",
            "/alarms",
            (Viewer, "Alarms, oldest first"),
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
            (Viewer, "Programs that were executed, the latest first"),
            [no, Shape::of::<RunsBody>()],
            get(runs::list),
        ),
        row(
            "get",
            "/runs/{id}",
            (Viewer, "A run: features and alarms"),
            [no, Shape::of::<RunDetailBody>()],
            get(runs::detail),
        ),
        row(
            "get",
            "/runs/{id}/report",
            (Viewer, "Its report, a page"),
            [no, Shape::Text],
            get(runs::report),
        )
        .opened_in_a_window(),
        row(
            "get",
            "/runs/{id}/certificate",
            (Viewer, "Its certificate"),
            [no, Shape::Any],
            get(runs::certificate),
        )
        .opened_in_a_window(),
        row(
            "get",
            "/runs/{id}/trace",
            (Viewer, "Signals of its trace, least and greatest value by column"),
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
            (Anyone, "Open a session"),
            [Shape::of::<SessionOrder>(), Shape::of::<SessionBody>()],
            post(sessions::open),
        ),
        row(
            "get",
            "/operator",
            (Viewer, "Who commands"),
            [no, Shape::of::<OperatorBody>()],
            get(sessions::operator),
        ),
        row(
            "post",
            "/operator",
            (Operator, "Ask for the right to command, hand it over, keep it, give it back"),
            [Shape::of::<OperatorOrder>(), Shape::of::<OperatorBody>()],
            post(sessions::order),
        ),
        row(
            "get",
            "/ws",
            (Viewer, "WebSocket: status, events, features, scope, requests"),
            [no, Shape::Nothing],
            get(crate::socket::open),
        )
        .opened_in_a_window(),
        row(
            "get",
            "/lsp",
            (Viewer, "WebSocket: the language server"),
            [no, Shape::Nothing],
            get(crate::language::open),
        )
        .opened_in_a_window(),
        row(
            "get",
            "/openapi.json",
            (Anyone, "This document"),
            [no, Shape::Any],
            get(shows::document),
        ),
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

/// All addresses of the server but those of the page's files.
fn all() -> Vec<(String, Route)> {
    let api = table().into_iter().map(|route| (format!("{BASE}{}", route.path), route));
    let watched = mtconnect::routes().into_iter().chain(metrics::routes());
    let watched = watched.map(Route::of_watchers);
    api.chain(watched.map(|route| (route.path.to_owned(), route))).collect()
}

/// Who may use which address: of all that the router is made from.
pub fn addresses() -> Vec<Address> {
    let address = |(path, route): (String, Route)| Address {
        method: route.method,
        path,
        access: route.admission.access,
    };
    all().into_iter().map(address).collect()
}

/// An address that is served, with all of its methods.
struct Served {
    path: String,
    methods: Vec<&'static str>,
    handlers: MethodRouter<Arc<App>>,
}

/// The router of all addresses that are served: nobody comes to a handler unless he is admitted.
pub(crate) fn router(app: &Arc<App>) -> Router<Arc<App>> {
    let is_served = |path: &str| {
        (app.watching.monitoring.is_some() || !path.starts_with(mtconnect::ROOT))
            && (app.watching.metering.is_some() || !path.starts_with(metrics::ROOT))
    };
    let mut served: Vec<Served> = Vec::new();
    for (path, route) in all().into_iter().filter(|(path, _)| is_served(path)) {
        let (app, admission) = (Arc::clone(app), route.admission);
        let admit = move |request, next| guard::admit(Arc::clone(&app), admission, request, next);
        let handler = route.handler.layer(axum::middleware::from_fn(admit));
        match served.last_mut().filter(|before| before.path == path) {
            Some(before) => {
                before.methods.push(route.method);
                before.handlers = std::mem::take(&mut before.handlers).merge(handler);
            }
            None => served.push(Served { path, methods: vec![route.method], handlers: handler }),
        }
    }
    served.into_iter().fold(Router::new(), |router, Served { path, methods, handlers }| {
        // one that takes any method says itself which it answers
        let is_any = methods.contains(&"any");
        let others = move |method: Method| async move { wrong_method(&method, &methods) };
        router.route(&path, if is_any { handlers } else { handlers.fallback(others) })
    })
}

/// A method that an address does not take.
fn wrong_method(method: &Method, methods: &[&str]) -> ApiError {
    let mut taken: Vec<String> = methods.iter().map(|method| method.to_uppercase()).collect();
    if methods.contains(&"get") {
        taken.push("HEAD".to_owned());
    }
    ApiError::wrong_method(method, &taken.join(","))
}
