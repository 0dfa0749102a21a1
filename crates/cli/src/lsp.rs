//! `leadscrew lsp`: the language server on standard input and output.
use control::Refused;
use control::job::Session;
use control::job::options::ProgramOptions;
use diag::Diagnostic;
use lsp_server::Connection;
use std::path::{Path, PathBuf};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
    mpsc::{Receiver, TryRecvError, sync_channel},
};

/// Serve one editor. True if it took leave in order.
pub(crate) fn command(source: ProgramOptions) -> Result<bool, Refused> {
    let (connection, threads) = Connection::stdio();
    let host = Machines { source };
    let served = lsp::serve(&connection, &host);
    drop(connection);
    let served = served.map_err(|e| Refused::because(format!("the editor broke off: {e}")))?;
    threads.join().map_err(|e| Refused::because(format!("the editor's pipe broke: {e}")))?;
    Ok(served)
}

/// What programs meet: the machine, the tools and the files beside them.
struct Machines {
    source: ProgramOptions,
}

impl lsp::Host for Machines {
    fn setup(&self, uri: &str, text: &[u8]) -> Result<interp::Setup, String> {
        match Session::load(&self.source, &program(uri), text) {
            Ok(session) => Ok(session.interp_setup()),
            Err(refused) => Err(refused.sentence()),
        }
    }

    fn subprogram(&self, uri: &str, name: &str) -> Option<String> {
        let program = program(uri);
        let session = Session::load(&self.source, &program, b"").ok()?;
        let grammar = session.dialect.grammar();
        let (options, machine) = (&self.source, &session.machine);
        let file = control::job::subprograms::file_of(options, machine, &program, name, grammar)?;
        Some(written(&std::path::absolute(file).ok()?))
    }

    fn preflight(&self, uri: &str, text: &[u8]) -> Box<dyn lsp::Preflight> {
        Box::new(Running::start(self.source.clone(), program(uri), text.to_vec()))
    }
}

/// The preflight of `check`, in a thread of its own: an editor that asks meanwhile is answered.
struct Running {
    answer: Receiver<Result<Vec<Diagnostic>, String>>,
    /// The editor has cancelled the request.
    stop: Arc<AtomicBool>,
}

impl Running {
    fn start(source: ProgramOptions, program: PathBuf, text: Vec<u8>) -> Self {
        let (tell, answer) = sync_channel(1);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let work = move || {
            let found = Session::load(&source, &program, &text).map(|mut session| {
                let options = session.plan_options(session.machine.setup.stock.material);
                let goes_on = || !stopped.load(Ordering::Relaxed);
                control::job::preflight::judge(&mut session, &text, options, &goes_on)
            });
            // an editor that has closed the file does not listen
            _ = tell.send(found.map_err(|refused| refused.sentence()));
        };
        // without a thread the sender is gone, which `take` says
        _ = std::thread::Builder::new().name("preflight".into()).spawn(work);
        Self { answer, stop }
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
}

/// The file of a program. A text without one meets what lies in the folder the server was started in.
fn program(uri: &str) -> PathBuf {
    path(uri).unwrap_or_else(|| PathBuf::from("unsaved.ngc"))
}

/// The path of a `file:` URI.
fn path(uri: &str) -> Option<PathBuf> {
    let path = uri.strip_prefix("file://")?;
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
    String::from_utf8(bytes).ok().map(PathBuf::from)
}

/// The `file:` URI of a path.
fn written(path: &Path) -> String {
    let mut uri = "file://".to_owned();
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
        assert_eq!(path(&written(odd)).as_deref(), Some(odd));
    }

    #[test]
    fn a_uri_is_a_path_with_its_escapes_undone() {
        assert_eq!(path("file:///a%20b/c.ngc"), Some(PathBuf::from("/a b/c.ngc")));
        assert_eq!(path("file:///100%/c"), Some(PathBuf::from("/100%/c")));
        assert_eq!(path("untitled:1"), None);
    }
}
