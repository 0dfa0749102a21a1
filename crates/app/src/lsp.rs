//! `leadscrew lsp`: the language server on standard input and output.
use crate::args::ProgramArgs;
use crate::refused::Refused;
use crate::session::Session;
use lsp_server::Connection;
use std::path::PathBuf;

/// Serve one editor. True if it took leave in order.
pub(crate) fn command(source: &ProgramArgs) -> Result<bool, Refused> {
    let (connection, threads) = Connection::stdio();
    let host = Machines { source: source.clone() };
    let served = lsp::serve(&connection, &host);
    drop(connection);
    let served = served.map_err(|e| Refused::because(format!("the editor broke off: {e}")))?;
    threads.join().map_err(|e| Refused::because(format!("the editor's pipe broke: {e}")))?;
    Ok(served)
}

/// What programs meet: the machine, the tools and the files beside them.
struct Machines {
    source: ProgramArgs,
}

impl lsp::Host for Machines {
    fn setup(&self, uri: &str, text: &[u8]) -> Result<interp::Setup, String> {
        // A text without a file meets what lies in the folder the server was started in.
        let path = path(uri).unwrap_or_else(|| PathBuf::from("unsaved.ngc"));
        match Session::load(&self.source, &path, text) {
            Ok(session) => Ok(session.interp_setup()),
            Err(refused) => Err(refused.sentence()),
        }
    }

    fn subprogram(&self, uri: &str, name: &str) -> Option<String> {
        if name.contains(['/', '\\']) || name.contains("..") {
            return None;
        }
        let file = path(uri)?.parent()?.join(format!("{name}.ngc"));
        let folder = uri.rsplit_once('/')?.0;
        file.is_file().then(|| format!("{folder}/{name}.ngc"))
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uri_is_a_path_with_its_escapes_undone() {
        assert_eq!(path("file:///a%20b/c.ngc"), Some(PathBuf::from("/a b/c.ngc")));
        assert_eq!(path("file:///100%/c"), Some(PathBuf::from("/100%/c")));
        assert_eq!(path("untitled:1"), None);
    }
}
