//! The page, which is embedded in the program: nothing of it is asked for elsewhere.
use crate::tokens::hex;
use axum::body::Body;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, Response, StatusCode, header};
use flate2::Compression;
use flate2::write::GzEncoder;
use rust_embed::{EmbeddedFile, RustEmbed};
use std::collections::HashMap;
use std::io::Write as _;
use std::sync::{Arc, Mutex, PoisonError};

/// The page as it was built.
#[derive(RustEmbed)]
#[folder = "page/"]
struct Files;

/// Shorter files are not compressed.
const SHORTEST: usize = 1024;
/// What is shown where there is no such file: the page finds its way by itself.
const INDEX: &str = "index.html";

/// The page's files, compressed when they are first asked for.
#[derive(Default)]
pub(crate) struct Page {
    compressed: Mutex<HashMap<String, Arc<Vec<u8>>>>,
}

impl Page {
    /// A file.
    pub(crate) fn answer(&self, request: &Request) -> Response<Body> {
        if !matches!(*request.method(), Method::GET | Method::HEAD) {
            return plain(StatusCode::METHOD_NOT_ALLOWED, "the page is only read\n");
        }
        let path = request.uri().path().trim_start_matches('/');
        let name = if path.is_empty() { INDEX } else { path };
        let is_file = name.rsplit('/').next().is_some_and(|last| last.contains('.'));
        match Files::get(name) {
            Some(file) => self.file(name, &file, request.headers()),
            None if is_file => plain(StatusCode::NOT_FOUND, "there is no such file\n"),
            None => match Files::get(INDEX) {
                Some(file) => self.file(INDEX, &file, request.headers()),
                None => plain(StatusCode::NOT_FOUND, "this program was built without its page\n"),
            },
        }
    }

    fn file(&self, name: &str, file: &EmbeddedFile, asked: &HeaderMap) -> Response<Body> {
        let hash = hex(&file.metadata.sha256_hash()[..16]);
        let tag = format!("\"{hash}\"");
        let mut response = Response::new(Body::empty());
        let headers = response.headers_mut();
        if let Ok(tag) = HeaderValue::from_str(&tag) {
            headers.insert(header::ETAG, tag);
        }
        headers.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        // names under assets/ have the hash of what is in them
        let lasts = if name.starts_with("assets/") {
            "public, max-age=31536000, immutable"
        } else {
            "no-cache"
        };
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static(lasts));
        let known = asked.get(header::IF_NONE_MATCH).and_then(|value| value.to_str().ok());
        if known.is_some_and(|known| known.contains(&tag)) {
            *response.status_mut() = StatusCode::NOT_MODIFIED;
            return response;
        }
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(kind(name)));
        let takes = asked.get(header::ACCEPT_ENCODING).and_then(|value| value.to_str().ok());
        let takes_gzip = takes.is_some_and(|takes| takes.contains("gzip"));
        let body = if takes_gzip && is_text(name) && file.data.len() >= SHORTEST {
            headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
            Body::from(self.gzip(name, &file.data).to_vec())
        } else {
            Body::from(file.data.to_vec())
        };
        *response.body_mut() = body;
        response
    }

    fn gzip(&self, name: &str, data: &[u8]) -> Arc<Vec<u8>> {
        let mut compressed = self.compressed.lock().unwrap_or_else(PoisonError::into_inner);
        let made = compressed.entry(name.to_owned()).or_insert_with(|| {
            let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
            // into memory: nothing fails there
            let _ = encoder.write_all(data);
            Arc::new(encoder.finish().unwrap_or_default())
        });
        Arc::clone(made)
    }
}

fn plain(status: StatusCode, text: &'static str) -> Response<Body> {
    let mut response = Response::new(Body::from(text));
    *response.status_mut() = status;
    let kind = HeaderValue::from_static("text/plain; charset=utf-8");
    response.headers_mut().insert(header::CONTENT_TYPE, kind);
    response
}

fn is_text(name: &str) -> bool {
    let kind = kind(name);
    kind.contains("charset")
        || kind.ends_with("json")
        || kind.ends_with("xml")
        || kind.ends_with("wasm")
}

fn kind(name: &str) -> &'static str {
    match name.rsplit('.').next().unwrap_or_default() {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "ico" => "image/x-icon",
        "woff2" => "font/woff2",
        "json" | "map" => "application/json",
        "webmanifest" => "application/manifest+json",
        "wasm" => "application/wasm",
        "txt" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
