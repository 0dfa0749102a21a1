//! Who may use an address of the server: said where the address is, looked at before its handler.
use crate::app::App;
use crate::rights::Denied;
use axum::http::HeaderMap;
use axum::response::Response;
use axum::routing::MethodRouter;
use std::sync::Arc;

/// Who may use an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Everyone who reaches the server: it shows nothing of the machine.
    Anyone,
    /// Who has a token of any role, where tokens are asked for; a session is none.
    Watcher,
    /// Every session, every token.
    Viewer,
    /// Sessions and tokens of the role operator.
    Operator,
}

/// An address as it is written for those who ask who may use what.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// `get`, `put`, `post`; `any`: each of them.
    pub method: &'static str,
    /// As axum writes it, with its parameters in braces.
    pub path: String,
    /// Who may use it.
    pub access: Access,
}

/// How who asks is admitted.
#[derive(Clone, Copy)]
pub(crate) struct Admission {
    pub(crate) access: Access,
    /// A browser opens it in a window of its own, or as a socket, and says who asks in the address.
    pub(crate) is_opened_in_a_window: bool,
    /// In which form he is refused.
    pub(crate) refused: fn(&App, &HeaderMap, Denied) -> Response,
}

/// An address below which the machine is watched, and in which form who may not is refused.
pub(crate) struct Watched {
    /// As axum writes it.
    pub(crate) path: &'static str,
    pub(crate) refused: fn(&App, &HeaderMap, Denied) -> Response,
    pub(crate) handler: MethodRouter<Arc<App>>,
}
