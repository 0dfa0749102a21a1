//! What an editor's programs meet: the machine, the tools and the files beside them, for the
//! language server.
use control::job::options::ProgramOptions;
use control::job::{Interruption, Session, preflight, subprograms};
use control::operation::Found;
use diag::Diagnostic;
use std::path::{Path, PathBuf};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
    mpsc::{Receiver, TryRecvError, sync_channel},
};

/// Where an editor's programs lie, and what is not in files.
pub trait Surroundings {
    /// The file of a program, which need not be there.
    fn path(&self, uri: &str) -> PathBuf;
    /// The URI of a file; `None`: the editor is not shown it.
    fn uri(&self, path: &Path) -> Option<String>;
    /// What a program meets on a control as it is by now; `None`: what the files say.
    fn found(&self) -> Option<Found> {
        None
    }
}

/// Programs by their `file:` URIs.
pub struct Files;

impl Surroundings for Files {
    /// A text without a file meets what lies in the folder the server was started in.
    fn path(&self, uri: &str) -> PathBuf {
        path_of(uri).unwrap_or_else(|| PathBuf::from("unsaved.ngc"))
    }

    fn uri(&self, path: &Path) -> Option<String> {
        Some(written(&std::path::absolute(path).ok()?))
    }
}

/// What programs meet.
pub struct Machines<S> {
    /// Machine, tools, dialect.
    pub source: ProgramOptions,
    /// Files.
    pub around: S,
}

impl<S: Surroundings> Machines<S> {
    fn load(&self, uri: &str, text: &[u8]) -> Result<Session, String> {
        let session = Session::load(&self.source, &self.around.path(uri), text);
        let mut session = session.map_err(|refused| refused.sentence())?;
        if let Some(found) = self.around.found() {
            found.put_into(&mut session);
        }
        Ok(session)
    }
}

impl<S: Surroundings> lsp::Host for Machines<S> {
    fn setup(&self, uri: &str, text: &[u8]) -> Result<interp::Setup, String> {
        self.load(uri, text).map(|session| session.interp_setup())
    }

    fn subprogram(&self, uri: &str, name: &str) -> Option<String> {
        let program = self.around.path(uri);
        let session = Session::load(&self.source, &program, b"").ok()?;
        let grammar = session.dialect.grammar();
        let (options, machine) = (&self.source, &session.machine);
        self.around.uri(&subprograms::file_of(options, machine, &program, name, grammar)?)
    }

    fn preflight(&self, uri: &str, text: &[u8]) -> Box<dyn lsp::Preflight> {
        Box::new(Running::start(self.load(uri, text), text.to_vec()))
    }
}

/// The preflight of `check`, in a thread of its own: an editor that asks meanwhile is answered.
struct Running {
    answer: Receiver<Result<Vec<Diagnostic>, String>>,
    planned: Receiver<Option<f64>>,
    /// The editor has cancelled the request.
    stop: Arc<AtomicBool>,
}

impl Running {
    fn start(session: Result<Session, String>, text: Vec<u8>) -> Self {
        let (tell, answer) = sync_channel(1);
        let (tell_time, planned) = sync_channel(1);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let work = move || {
            // an editor that has closed the file does not listen
            let mut session = match session {
                Ok(session) => session,
                Err(trouble) => {
                    _ = tell.send(Err(trouble));
                    return;
                }
            };
            session.interruption = Interruption::by(move || stopped.load(Ordering::Relaxed));
            let options = session.plan_options(session.machine.setup.stock.material);
            let found = preflight::judge(&mut session, &text, options);
            let is_refused = found.iter().any(Diagnostic::is_error);
            _ = tell.send(Ok(found));
            if !is_refused && let Some(time) = preflight::time(&session, &text, options) {
                _ = tell_time.send(Some(time.value()));
            }
        };
        // without a thread the sender is gone, which `take` says
        _ = std::thread::Builder::new().name("preflight".into()).spawn(work);
        Self { answer, planned, stop }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

impl lsp::Preflight for Running {
    fn take(&mut self) -> Option<Result<Vec<Diagnostic>, String>> {
        match self.answer.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err("the program could not be checked against the machine".into()))
            }
        }
    }

    fn planned(&mut self) -> Option<Option<f64>> {
        match self.planned.try_recv() {
            Ok(planned) => Some(planned),
            Err(TryRecvError::Empty) => None,
            // it is refused
            Err(TryRecvError::Disconnected) => Some(None),
        }
    }
}

/// The path of a `file:` URI.
fn path_of(uri: &str) -> Option<PathBuf> {
    unescaped(uri.strip_prefix("file://")?).map(PathBuf::from)
}

/// A path of a URI with its escapes undone; `None`: it is no text.
pub fn unescaped(path: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(path.len());
    let mut rest = path.as_bytes();
    while let Some((first, others)) = rest.split_first() {
        let escaped = (*first == b'%')
            .then(|| std::str::from_utf8(others.get(..2)?).ok())
            .flatten()
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &others[2..] } else { others };
    }
    String::from_utf8(bytes).ok()
}

/// The `file:` URI of a path.
fn written(path: &Path) -> String {
    format!("file://{}", escaped(path))
}

/// A path as a URI has it.
pub fn escaped(path: &Path) -> String {
    let mut uri = String::new();
    for byte in path.as_os_str().as_encoded_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(byte) {
            uri.push(*byte as char);
        } else {
            uri += &format!("%{byte:02X}");
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_written_so_that_it_is_read_again() {
        let odd = Path::new("/a b/ü%c/d.ngc");
        assert_eq!(written(odd), "file:///a%20b/%C3%BC%25c/d.ngc");
        assert_eq!(path_of(&written(odd)).as_deref(), Some(odd));
    }

    #[test]
    fn a_uri_is_a_path_with_its_escapes_undone() {
        assert_eq!(path_of("file:///a%20b/c.ngc"), Some(PathBuf::from("/a b/c.ngc")));
        assert_eq!(path_of("file:///100%/c"), Some(PathBuf::from("/100%/c")));
        assert_eq!(path_of("untitled:1"), None);
    }
}
