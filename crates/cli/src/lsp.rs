//! `leadscrew lsp`: the language server on standard input and output.
use control::Refused;
use control::job::options::ProgramOptions;
use leadscrew::editor::{Files, Machines};
use lsp_server::Connection;

/// Serve one editor. True if it took leave in order.
pub(crate) fn command(source: ProgramOptions) -> Result<bool, Refused> {
    let (connection, threads) = Connection::stdio();
    let host = Machines { source, around: Files };
    let served = lsp::serve(&connection, &host);
    drop(connection);
    let served = served.map_err(|e| Refused::because(format!("the editor broke off: {e}")))?;
    threads.join().map_err(|e| Refused::because(format!("the editor's pipe broke: {e}")))?;
    Ok(served)
}
