//! The language server for an editor of the page: LSP over a WebSocket, a JSON-RPC message in each
//! text frame.
//!
//! ```text
//!   socket ──► bounded queue ──► thread "lsp": lsp::serve ──► bounded queue ──► thread "lsp-out" ──► socket
//! ```
//!
//! Programs are named `program:/folder/name.ngc`, by their path in the folder of programs; nothing
//! outside it is read. A message that does not find room in time ends the conversation: the editor
//! begins a new one.
use crate::answer::ApiError;
use crate::app::App;
use crate::folder::LARGEST_PROGRAM;
use crate::guard;
use crate::page_words::on_page;
use crate::rights::Who;
use axum::Extension;
use axum::extract::State;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use control::operation::Found;
use control::operation::hosted::Picture;
use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use leadscrew::editor::{Machines, Surroundings, escaped, unescaped};
use lsp_server::Connection;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::mpsc;

/// Largest message: a program, with the escapes of JSON.
const LARGEST_MESSAGE: usize = 2 * LARGEST_PROGRAM;
/// Messages that wait, either way.
const MOST_WAITING: usize = 64;
/// A frame is sent within so long, or the editor is gone.
const SENT: Duration = Duration::from_secs(10);
/// The language server takes a message within so long: it reads on between two slices of a program.
const TAKEN: Duration = Duration::from_secs(30);
/// Room in the queue is looked for so often.
const LOOK: Duration = Duration::from_millis(5);
/// How programs are named.
const SCHEME: &str = "program:/";

pub(crate) async fn open(
    State(app): State<Arc<App>>,
    Extension(who): Extension<Who>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response {
    let Ok(upgrade) = upgrade else {
        let reason = "this address takes a WebSocket";
        return ApiError::new(StatusCode::UPGRADE_REQUIRED, reason).into_response();
    };
    let Some(place) = app.editors.take(who.role) else {
        let reason = "too many editors have a language server";
        return ApiError::new(StatusCode::SERVICE_UNAVAILABLE, reason).into_response();
    };
    let upgrade = upgrade.max_message_size(LARGEST_MESSAGE).max_frame_size(LARGEST_MESSAGE);
    upgrade.on_upgrade(move |socket| async move {
        if let Some((to_server, from_server)) = start(Arc::clone(&app)) {
            tokio::select! {
                () = talk(socket, &app, &to_server, from_server) => {}
                () = guard::ended(&app, who.session) => {}
            }
        }
        drop(place);
    })
}

/// The language server in a thread of its own, and one that waits for what it says; `None`: there
/// are no threads.
fn start(app: Arc<App>) -> Option<(Sender<lsp_server::Message>, mpsc::Receiver<String>)> {
    let (to_server, heard) = bounded(MOST_WAITING);
    let (said, from_server) = bounded(MOST_WAITING);
    let (frames, texts) = mpsc::channel(MOST_WAITING);
    let out = std::thread::Builder::new().name("lsp-out".into());
    out.spawn(move || write(&from_server, &frames)).ok()?;
    let host = Machines::new(app.program.clone(), Shop(app));
    let serve = move || {
        let connection = Connection { sender: said, receiver: heard };
        // an editor that breaks the protocol has ended the conversation
        let _ = lsp::serve(&connection, &host);
    };
    std::thread::Builder::new().name("lsp".into()).spawn(serve).ok()?;
    Some((to_server, texts))
}

/// What the language server says becomes text, until either of the two is gone.
fn write(from_server: &Receiver<lsp_server::Message>, frames: &mpsc::Sender<String>) {
    for message in from_server {
        let mut value = serde_json::to_value(&message).unwrap_or_default(); // names, numbers and strings
        value["jsonrpc"] = "2.0".into();
        if value["method"] == "textDocument/publishDiagnostics" {
            for finding in value["params"]["diagnostics"].as_array_mut().into_iter().flatten() {
                put_on_page(&mut finding["message"]);
                for label in finding["relatedInformation"].as_array_mut().into_iter().flatten() {
                    put_on_page(&mut label["message"]);
                }
            }
        }
        if frames.blocking_send(value.to_string()).is_err() {
            return;
        }
    }
}

/// A text in the words of the page.
fn put_on_page(text: &mut serde_json::Value) {
    if let Some(said) = text.as_str() {
        *text = on_page(said).into();
    }
}

async fn talk(
    mut socket: WebSocket,
    app: &App,
    to_server: &Sender<lsp_server::Message>,
    mut from_server: mpsc::Receiver<String>,
) {
    let mut pictures = app.pictures.clone();
    let (mut has_begun, mut met) = (false, Met::of(&app.client.latest()));
    loop {
        tokio::select! {
            heard = socket.recv() => match heard {
                Some(Ok(Message::Text(text))) => {
                    let Ok(message) = serde_json::from_str(text.as_str()) else { return };
                    has_begun |= is_initialized(&message);
                    if !give(to_server, message).await {
                        return;
                    }
                }
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => {} // a ping is answered by the library
            },
            text = from_server.recv() => {
                let Some(text) = text else { return };
                let sent = tokio::time::timeout(SENT, socket.send(Message::Text(text.into())));
                if !matches!(sent.await, Ok(Ok(()))) {
                    return;
                }
            }
            Ok(()) = pictures.changed(), if has_begun => {
                let now = Met::of(&app.client.latest());
                if !met.is_as(&now) && !give(to_server, changed()).await {
                    return;
                }
                met = now;
            }
        }
    }
}

/// The editor's last word of the greeting: from now on it may be told something.
fn is_initialized(message: &lsp_server::Message) -> bool {
    matches!(message, lsp_server::Message::Notification(told) if told.method == "initialized")
}

/// What programs meet has changed.
fn changed() -> lsp_server::Message {
    let method = "workspace/didChangeConfiguration".to_owned();
    let params = serde_json::json!({ "settings": null });
    lsp_server::Message::Notification(lsp_server::Notification { method, params })
}

/// What findings depend on, of a control.
struct Met {
    picture: Arc<Picture>,
    offset: String,
}

impl Met {
    fn of(picture: &Arc<Picture>) -> Self {
        Self { picture: Arc::clone(picture), offset: picture.status.work_offset.clone() }
    }

    /// A tool's use counts only where it reaches its end: it grows with each hole that is cut.
    fn is_as(&self, other: &Self) -> bool {
        let (a, b) = (&self.picture, &other.picture);
        let same = |a: &canon::Tool, b: &canon::Tool| {
            let of_unused = |tool: &canon::Tool| {
                let mut tool = tool.clone();
                tool.life.used = canon::ToolUse::default();
                tool
            };
            of_unused(a) == of_unused(b) && a.life.reached() == b.life.reached()
        };
        let are_same = |a: &[canon::Tool], b: &[canon::Tool]| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        };
        self.offset == other.offset
            && (Arc::ptr_eq(&a.offsets, &b.offsets) || a.offsets == b.offsets)
            && (Arc::ptr_eq(&a.tools, &b.tools) || are_same(&a.tools, &b.tools))
    }
}

/// False: the language server has ended, or does not take it in time.
async fn give(to_server: &Sender<lsp_server::Message>, message: lsp_server::Message) -> bool {
    let mut message = message;
    let end = control::clock::now() + TAKEN;
    loop {
        match to_server.try_send(message) {
            Ok(()) => return true,
            Err(TrySendError::Full(back)) if control::clock::now() < end => message = back,
            Err(_) => return false,
        }
        tokio::time::sleep(LOOK).await;
    }
}

/// The folder of programs, and the control with its tools and offsets as they are by now.
struct Shop(Arc<App>);

impl Surroundings for Shop {
    fn path(&self, uri: &str) -> PathBuf {
        let named = uri.strip_prefix(SCHEME).and_then(unescaped);
        let place = named.and_then(|path| self.0.folder.place(path.trim_start_matches('/')));
        place.unwrap_or_else(|| self.0.folder.root().join("unsaved.ngc"))
    }

    fn uri(&self, path: &Path) -> Option<String> {
        let within = self.0.folder.within(path)?;
        Some(format!("{SCHEME}{}", escaped(&within)))
    }

    fn found(&self) -> Option<Found> {
        self.0.client.with(|control| control.found())
    }
}
