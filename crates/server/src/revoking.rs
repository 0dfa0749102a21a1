//! Tokens that are taken out of their file while it is used.
use crate::app::App;
use crate::tokens::{LOOKED_AT, Tokens};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// Reads the file anew when it has changed. While there is none that can be read nobody is
/// admitted: who takes the file away, or breaks it, shuts the server.
pub(crate) async fn watch(app: Arc<App>, path: PathBuf) {
    let mut known = stamp(&path);
    loop {
        tokio::time::sleep(LOOKED_AT).await;
        let now = stamp(&path);
        if now == known {
            continue;
        }
        known = now;
        let (place, app) = (path.clone(), Arc::clone(&app));
        let read = tokio::task::spawn_blocking(move || Tokens::read(&place)).await;
        let tokens = read.unwrap_or_else(|e| Err(e.to_string())).unwrap_or_else(|why| {
            app.client.notice(format!("no token is valid now: {why}"));
            Tokens::default()
        });
        app.rights().replace(tokens);
    }
}

/// By what a file is seen to have changed: time, length, and which file it is.
fn stamp(path: &Path) -> Option<(SystemTime, u64, u64)> {
    let about = std::fs::metadata(path).ok()?;
    #[cfg(unix)]
    let number = std::os::unix::fs::MetadataExt::ino(&about);
    #[cfg(not(unix))]
    let number = 0;
    Some((about.modified().ok()?, about.len(), number))
}
