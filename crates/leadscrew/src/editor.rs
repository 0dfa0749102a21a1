//! What an editor's programs meet: the machine, the tools and the files beside them, for the
//! language server.
use control::job::choice::{self, Choice};
use control::job::options::ProgramOptions;
use control::job::{Interruption, Session, preflight, subprograms};
use control::operation::Found;
use diag::Diagnostic;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{
    Arc, Mutex, PoisonError,
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
    source: ProgramOptions,
    /// Files.
    around: S,
    /// Programs that are read as ones for another dialect, by their URIs.
    read_as: Mutex<BTreeMap<String, interp::Dialect>>,
}

impl<S: Surroundings> Machines<S> {
    /// Programs that meet this machine, and these files.
    pub fn new(source: ProgramOptions, around: S) -> Self {
        Self { source, around, read_as: Mutex::default() }
    }

    /// What a program is loaded with.
    fn source(&self, uri: &str) -> ProgramOptions {
        let known = self.read_as.lock().unwrap_or_else(PoisonError::into_inner);
        let dialect = known.get(uri).copied().or(self.source.dialect);
        ProgramOptions { dialect, ..self.source.clone() }
    }

    fn load(&self, uri: &str, text: &[u8]) -> Result<Session, String> {
        let options = choice::by_words(&self.source(uri), text);
        let session = Session::load(&options, &self.around.path(uri), text);
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
        let source = self.source(uri);
        let session = Session::load(&source, &program, b"").ok()?;
        let grammar = session.dialect.grammar();
        let (options, machine) = (&source, &session.machine);
        self.around.uri(&subprograms::file_of(options, machine, &program, name, grammar)?)
    }

    fn read_as(&self, uri: &str, dialect: Option<interp::Dialect>) {
        let mut known = self.read_as.lock().unwrap_or_else(PoisonError::into_inner);
        match dialect {
            Some(dialect) => _ = known.insert(uri.to_owned(), dialect),
            None => _ = known.remove(uri),
        }
    }

    fn preflight(&self, uri: &str, text: &[u8]) -> Box<dyn lsp::Preflight> {
        if self.source.chooses {
            let (options, path) = (self.source(uri), self.around.path(uri));
            return Box::new(Running::start(Met::Chosen(Box::new(options), path), text.to_vec()));
        }
        Box::new(Running::start(Met::Loaded(self.load(uri, text).map(Box::new)), text.to_vec()))
    }
}

/// What a program meets.
enum Met {
    /// What was named, and loaded.
    Loaded(Result<Box<Session>, String>),
    /// What its own words choose.
    Chosen(Box<ProgramOptions>, PathBuf),
}

impl Met {
    /// The program's session, and what was chosen.
    fn session(self, text: &[u8]) -> Result<(Session, Vec<Diagnostic>), String> {
        match self {
            Self::Loaded(session) => session.map(|session| (*session, Vec::new())),
            Self::Chosen(options, path) => {
                let choice = choice::choose(&options, &path, text);
                let Choice { options, notes, .. } = choice.map_err(|refused| refused.sentence())?;
                let session = Session::load(&options, &path, text);
                session.map(|session| (session, notes)).map_err(|refused| refused.sentence())
            }
        }
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
    fn start(met: Met, text: Vec<u8>) -> Self {
        let (tell, answer) = sync_channel(1);
        let (tell_time, planned) = sync_channel(1);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let work = move || {
            // an editor that has closed the file does not listen
            let (mut session, notes) = match met.session(&text) {
                Ok(known) => known,
                Err(trouble) => {
                    _ = tell.send(Err(trouble));
                    return;
                }
            };
            session.interruption = Interruption::by(move || stopped.load(Ordering::Relaxed));
            let options = session.plan_options(session.machine.setup.stock.material);
            let mut found = preflight::judge(&mut session, &text, options);
            found.splice(0..0, notes);
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
