//! Answers: JSON, or a refusal in the one form that all have.
use crate::folder::FolderError;
use crate::page_words::on_page;
use crate::rights::Denied;
use crate::wire::RefusalBody;
use axum::body::{Body, to_bytes};
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use control::operation::hosted::{RefusalData, RefusalKind};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::time::Duration;
/// Largest body that is JSON.
pub(crate) const LARGEST_JSON: usize = 64 << 10;
/// Characters of a client's method that are shown.
const LONGEST_METHOD: usize = 20;

/// What is wrong, with its status.
#[derive(Debug)]
pub(crate) struct ApiError {
    status: StatusCode,
    body: RefusalBody,
    /// Methods that the address takes.
    allow: Option<String>,
}

impl ApiError {
    /// A sentence.
    pub(crate) fn new(status: StatusCode, reason: impl Into<String>) -> Self {
        let body = RefusalBody { reason: reason.into(), ..RefusalBody::default() };
        Self { status, body, allow: None }
    }

    /// With what would make it possible.
    pub(crate) fn with_remedy(mut self, remedy: impl Into<String>) -> Self {
        self.body.remedy = Some(remedy.into());
        self
    }

    /// A method that an address does not take; `allow`: those that it takes, as axum lists them.
    pub(crate) fn wrong_method(method: &Method, allow: &str) -> Self {
        let mut taken: Vec<_> = allow.split(',').map(str::trim).collect();
        taken.sort_unstable();
        let listed = match taken.split_last() {
            Some((last, [])) => (*last).to_owned(),
            Some((last, before)) => format!("{} and {last}", before.join(", ")),
            None => String::new(),
        };
        let method: String = method.as_str().chars().take(LONGEST_METHOD).collect();
        let reason = format!("{method} is no method of this address: it takes {listed}");
        Self { allow: Some(taken.join(", ")), ..Self::new(StatusCode::METHOD_NOT_ALLOWED, reason) }
    }

    /// What is answered.
    pub(crate) const fn body(&self) -> &RefusalBody {
        &self.body
    }

    /// With the text as clients see it.
    pub(crate) fn shown(mut self, shown: impl Fn(&str) -> String) -> Self {
        self.body.reason = shown(&self.body.reason);
        self
    }
}

impl From<RefusalData> for ApiError {
    fn from(refusal: RefusalData) -> Self {
        let status = match refusal.kind {
            RefusalKind::State => StatusCode::CONFLICT,
            RefusalKind::Request => StatusCode::UNPROCESSABLE_ENTITY,
            RefusalKind::Busy => StatusCode::SERVICE_UNAVAILABLE,
        };
        let RefusalData { reason, remedy, mut findings, .. } = refusal;
        for finding in &mut findings {
            finding.message = on_page(&finding.message);
            finding.help = finding.help.as_deref().map(on_page);
        }
        let (reason, remedy) = (on_page(&reason), remedy.as_deref().map(on_page));
        let body = RefusalBody { accepted: false, reason, remedy, findings };
        Self { status, body, allow: None }
    }
}

impl From<Denied> for ApiError {
    fn from(denied: Denied) -> Self {
        let status = match denied {
            Denied::Unknown
            | Denied::NoToken
            | Denied::Expired
            | Denied::Revoked
            | Denied::AnothersSession => StatusCode::UNAUTHORIZED,
            Denied::Viewer => StatusCode::FORBIDDEN,
            Denied::Held(_) | Denied::NotHolder => StatusCode::CONFLICT,
            Denied::Full => StatusCode::SERVICE_UNAVAILABLE,
            Denied::Name => StatusCode::UNPROCESSABLE_ENTITY,
            Denied::NoSecret(_) => StatusCode::INTERNAL_SERVER_ERROR,
        };
        let error = Self::new(status, denied.to_string());
        match denied.remedy() {
            Some(remedy) => error.with_remedy(remedy),
            None => error,
        }
    }
}

impl From<FolderError> for ApiError {
    fn from(error: FolderError) -> Self {
        let status = match error {
            FolderError::NotAPath(_) => StatusCode::UNPROCESSABLE_ENTITY,
            FolderError::Missing(_) => StatusCode::NOT_FOUND,
            FolderError::Exists(..) => StatusCode::CONFLICT,
            FolderError::Disk(_) => StatusCode::INTERNAL_SERVER_ERROR,
        };
        let refusal = Self::new(status, error.to_string());
        match error {
            FolderError::Exists(_, remedy) => refusal.with_remedy(remedy),
            _ => refusal,
        }
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = json(&self.body);
        *response.status_mut() = self.status;
        if let Some(allow) = self.allow.and_then(|allow| HeaderValue::from_str(&allow).ok()) {
            response.headers_mut().insert(header::ALLOW, allow);
        }
        response
    }
}

/// A value as JSON.
pub(crate) fn json(value: &impl Serialize) -> Response {
    match serde_json::to_vec(value) {
        Ok(bytes) => ([(header::CONTENT_TYPE, "application/json")], bytes).into_response(),
        Err(e) => (StatusCode::INTERNAL_SERVER_ERROR, e.to_string()).into_response(),
    }
}

/// A body, no larger and no later than it may be.
pub(crate) async fn bytes(
    body: Body,
    most: usize,
    within: Duration,
) -> Result<axum::body::Bytes, ApiError> {
    match tokio::time::timeout(within, to_bytes(body, most)).await {
        Ok(Ok(bytes)) => Ok(bytes),
        Ok(Err(_)) => Err(ApiError::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            format!("the body is too large or was broken off: {most} bytes at most"),
        )),
        Err(_) => Err(ApiError::new(
            StatusCode::REQUEST_TIMEOUT,
            format!("the body has not come within {} s", within.as_secs_f64()),
        )),
    }
}

/// A body as the object that is expected.
pub(crate) async fn object<T: DeserializeOwned>(
    body: Body,
    within: Duration,
) -> Result<T, ApiError> {
    let bytes = bytes(body, LARGEST_JSON, within).await?;
    serde_json::from_slice(&bytes)
        .map_err(|e| ApiError::new(StatusCode::BAD_REQUEST, format!("not what is expected: {e}")))
}
